// Positions drawn over the image, in mm of the patient: checked against the voxels of the file that the page shows, not
// against the page's own arithmetic. And whatever is read out beside it, the image stays where it was clicked.
import { expect, test } from '@playwright/test'

import { note, round } from './support/figures'
import { distance, PageOperator } from './support/page_operator'
import { drawn, misplaced, pixelsPerMm, readVolume } from './support/picture'
import { Robot } from './support/robot'
import { kSizes } from './support/scenes'
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

test('whatever lies under the pointer, the image stays where it is', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  for (const [width, height] of kSizes) {
    await page.setViewportSize({ width, height })
    await page.mouse.move(5, 5)
    const image = page.locator('.slices')
    const at = await image.boundingBox()
    const large = (await page.locator('[data-tile^=large] rect').first().boundingBox())!
    await page.mouse.move(large.x + large.width - 3, large.y + large.height - 3)
    await expect(page.locator('[data-name=from-entry]')).toContainText('beyond the stroke')
    expect(await image.boundingBox(), `${width} x ${height}`).toEqual(at)
  }
})

// Numbers and signs change with each click: a line more of them would move the image from under the pointer.
test('whatever is read out, the image stays where it was clicked', async ({ page }) => {
  test.setTimeout(240_000)
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const image = page.locator('.slices')
  const canvas = page.locator('canvas[tabindex]')
  const sizes = [[1401, 900], [1569, 900], [1640, 1080], [1850, 1080], [1920, 1080]] as const
  for (const [width, height] of sizes) {
    await page.setViewportSize({ width, height })
    await page.mouse.move(5, 5)
    await expect(page.locator('[data-name=pointed]')).toContainText('crosshair')
    const at = (await image.boundingBox())!
    const read = async () => Promise.all((await page.locator('[data-tile] rect').all()).map(async (tile) => (await tile.boundingBox())!))
    let tiles = await read()
    await expect.poll(async () => { // drawn anew for this size
      const before = JSON.stringify(tiles)
      tiles = await read()
      return JSON.stringify(tiles) === before && tiles.every((tile) => tile.x >= at.x - 1 && tile.x + tile.width <= at.x + at.width + 1)
    }).toBe(true)
    for (const [n, tile] of tiles.entries())
      for (const [across, down] of [[0.05, 0.05], [0.95, 0.95]] as const) {
        const [x, y] = [tile.x + across * tile.width, tile.y + down * tile.height]
        await page.mouse.click(x, y)
        if (n === 0) await expect.poll(async () => Math.hypot((await operator.crossAt()).x - x, (await operator.crossAt()).y - y), `${width} x ${height}`).toBeLessThan(2)
        expect(await image.boundingBox(), `${width} x ${height}`).toEqual(at)
      }
    await canvas.focus()
    for (const key of ['+', ']', ']', "'", 'p']) await page.keyboard.press(key)
    expect(await image.boundingBox(), `${width} x ${height}, zoomed and windowed`).toEqual(at)
    await canvas.focus()
    for (const key of ['p', '0']) await page.keyboard.press(key)
  }
})
