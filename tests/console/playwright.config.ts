import { defineConfig } from '@playwright/test'

// Headless Chromium draws the image with SwiftShader: the same bytes in every run.
export default defineConfig({
  testDir: '.',
  workers: 1, // the robot runs in real time
  timeout: 120_000,
  expect: { timeout: 15_000 },
  reporter: [['list']],
  use: {
    viewport: { width: 1920, height: 1080 },
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox',
             '--disable-accelerated-2d-canvas', '--disable-gpu-rasterization'],
    },
  },
})
