import { execFileSync } from 'node:child_process'
import { readFileSync } from 'node:fs'
import { defineConfig } from '@playwright/test'

import { stretched } from './clock'

const baselines = process.env.BASELINES ?? 'baselines'
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium'

// Headless Chromium draws the image with SwiftShader: the same bytes in every run of one browser on one kind of
// processor. There pictures are compared to the last pixel; with another one 2 % of them may differ slightly.
function drawsAsTheBaselines(): boolean {
  const browser = execFileSync(chromium, ['--version'], { encoding: 'utf8' }).trim()
  const processor = /^model name[^:]*: (.*)$/m.exec(readFileSync('/proc/cpuinfo', 'utf8'))?.[1] ?? 'unknown'
  return readFileSync(`${baselines}/made-with.txt`, 'utf8').trim() === `${browser}\n${processor}`
}
const likeness = drawsAsTheBaselines() ? { threshold: 0, maxDiffPixels: 0 } : { threshold: 0.2, maxDiffPixelRatio: 0.02 }

export default defineConfig({
  testDir: '..',
  testIgnore: process.env.SOAK_MINUTES ? [] : ['soak.spec.ts'],
  workers: 1, // the robot runs in real time
  retries: 2, // a stalling host may stop a robot, but not repeatedly
  maxFailures: 1,
  timeout: stretched(120_000),
  globalTimeout: process.env.SOAK_MINUTES ? 0 : stretched(480_000),
  expect: { timeout: stretched(20_000), toHaveScreenshot: { ...likeness, animations: 'disabled' } },
  updateSnapshots: 'none',
  snapshotPathTemplate: `${baselines}/{arg}{ext}`,
  reporter: [['list']],
  use: {
    viewport: { width: 1920, height: 1080 },
    actionTimeout: stretched(30_000),
    launchOptions: {
      executablePath: chromium,
      args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox',
             '--disable-accelerated-2d-canvas', '--disable-gpu-rasterization', '--font-render-hinting=none',
             '--disable-lcd-text', '--force-color-profile=srgb'],
    },
  },
})
