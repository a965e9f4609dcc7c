import { defineConfig } from 'vite'
import { notices } from './notices'

// The viewer brings readers for images over the network, compressed by zstd; ours come plain from the server.
export default defineConfig({
  base: './',
  plugins: [notices()],
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  resolve: { alias: [{ find: /^zarrita$/, replacement: new URL('./src/no_zarr.ts', import.meta.url).pathname }] },
  build: {
    rollupOptions: { input: ['index.html', 'review.html'] }, // the console; finished runs
    target: 'es2022', modulePreload: false, assetsInlineLimit: 0, chunkSizeWarningLimit: 2000,
  },
})
