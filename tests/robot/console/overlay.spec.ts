// Positions drawn over the image, in mm of the patient: checked against the voxels of the file that the page shows, not
// against the page's own arithmetic.
import { expect, test } from '@playwright/test'

import { note, round } from './support/figures'
import { distance, PageOperator } from './support/page_operator'
import { drawn, misplaced, pixelsPerMm, readVolume } from './support/picture'
import { Robot } from './support/robot'
import { lastEvent, freezePage } from './support/tap'

const kNear_mm = 0.1
const kVoxel_mm = 0.25 // of the phantom; the comparison of images resolves two thirds of it

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

test('the marks lie on the voxels they mean, in each plane', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  const volume = await readVolume(page)
  const fits: number[] = []
  for (const plane of ['axial', 'coronal', 'sagittal']) {
    await operator.button(plane).click()
    await expect(page.locator(`[data-tile="large ${plane}"]`)).toBeAttached()
    const scale = await pixelsPerMm(page)
    const target = await drawn(page, 'target')
    const entry = await drawn(page, 'entry')
    expect(Math.abs(target.off)).toBeLessThan(kNear_mm) // the crosshair is on it
    fits.push(await misplaced(page, volume))
    // Entry and path are where they are relative to the target.
    const seen = Math.hypot(entry.x - target.x, entry.y - target.y) / scale
    expect(Math.abs(Math.hypot(seen, entry.off - target.off) - distance(entry.mm, target.mm))).toBeLessThan(kNear_mm)
    const path = await page.locator('[data-tile^=large] [data-name=path]').evaluate((line: SVGLineElement) =>
      [line.x1, line.y1, line.x2, line.y2].map((end) => end.baseVal.value))
    expect(Math.hypot(path[0]! - entry.x, path[1]! - entry.y) / scale).toBeLessThan(kNear_mm)
    expect(Math.hypot(path[2]! - target.x, path[3]! - target.y) / scale).toBeLessThan(kNear_mm)
  }
  note({ overlay_on_picture_mm: fits.map((one) => round(one, 2)) })
  for (const apart of fits) expect(apart).toBeLessThan(kVoxel_mm)
})

test('the live tip lies on the path at its depth, and hollow once it is old', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const depth = 1.5
  await freezePage(page, { mode: 'Active', step: 'Insert', depth })
  const [entry, target, tip] = await Promise.all(['entry', 'target', 'tip'].map((name) => drawn(page, name)))
  expect(Math.abs(distance(tip!.mm, entry!.mm) - depth)).toBeLessThan(kNear_mm)
  expect(distance(tip!.mm, entry!.mm) + distance(tip!.mm, target!.mm)).toBeCloseTo(distance(entry!.mm, target!.mm), 2)
  const share = depth / distance(entry!.mm, target!.mm)
  const scale = await pixelsPerMm(page)
  const [x, y] = [entry!.x + share * (target!.x - entry!.x), entry!.y + share * (target!.y - entry!.y)]
  expect(Math.hypot(tip!.x - x, tip!.y - y) / scale).toBeLessThan(kNear_mm)
  await expect(page.locator('[data-tile^=large] .tip .solid')).toHaveCount(1)

  await page.evaluate(() => clearInterval((window as unknown as { stillTimer: number }).stillTimer))
  await expect(page.locator('[data-tile^=large] .tip .hollow')).toHaveCount(1)
  await expect(page.locator('[data-tile^=large] .tip')).toContainText('OLD')
})

test('wheel and arrows move by what they say', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  const spacing = (await lastEvent(page, 'Opened')).series.spacing[0]
  const moved = async (key: string) => {
    const from = await operator.mm('crosshair')
    await page.keyboard.press(key)
    await expect.poll(async () => distance(await operator.mm('crosshair'), from)).toBeGreaterThan(0)
    return distance(await operator.mm('crosshair'), from)
  }
  await page.locator('canvas[tabindex]').focus()
  expect(await moved('ArrowRight')).toBeCloseTo(spacing, 2)
  expect(await moved('Shift+ArrowUp')).toBeCloseTo(0.1, 2)
  const start = await operator.mm('crosshair')
  // The first turn of the wheel also goes to the middle of a voxel.
  await page.mouse.wheel(0, 100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), start)).toBeGreaterThan(0)
  const before = await operator.mm('crosshair')
  await page.mouse.wheel(0, 100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), before)).toBeCloseTo(spacing, 2)
})
