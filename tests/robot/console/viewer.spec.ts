// The image under the marks is moved by every means that the page offers, and attacked by others: the marks stay on their
// voxels, and inputs that are not on the page's own list change nothing.
import { expect, type Page, test } from '@playwright/test'

import { note, round } from './support/figures'
import { distance, PageOperator } from './support/page_operator'
import { bare, misplaced, type Nifti, pixelsPerMm, readVolume } from './support/picture'
import { Robot } from './support/robot'

const kVoxel_mm = 0.25 // of the phantom; the comparison of images resolves two thirds of it

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

async function large(page: Page): Promise<{ x: number; y: number; width: number; height: number }> {
  return (await page.locator('[data-tile^=large] rect').first().boundingBox())!
}

async function drag(page: Page, button: 'left' | 'middle' | 'right', by: [number, number]): Promise<void> {
  const { x, y, width, height } = await large(page)
  await page.mouse.move(x + width / 2, y + height / 2)
  await page.mouse.down({ button })
  await page.mouse.move(x + width / 2 + by[0], y + height / 2 + by[1], { steps: 4 })
  await page.mouse.up({ button })
}

// Drawn and composed: two frames later.
const settled = (page: Page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))

async function onTheVoxels(operator: PageOperator, volume: Nifti, what: string): Promise<number> {
  await settled(operator.page)
  const apart = await misplaced(operator.page, volume)
  note({ [`marks_after_${what}_mm`]: round(apart, 2) })
  expect(apart, what).toBeLessThan(kVoxel_mm)
  return apart
}

async function atTheTarget(page: Page): Promise<PageOperator> {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  return operator
}

test('a middle-button drag moves image and marks together', async ({ page }) => {
  const operator = await atTheTarget(page)
  const volume = await readVolume(page)
  await drag(page, 'middle', [90, -60])
  await onTheVoxels(operator, volume, 'middle_drag')
})

test('a right-button drag leaves the marks on their voxels', async ({ page }) => {
  const operator = await atTheTarget(page)
  const volume = await readVolume(page)
  await drag(page, 'right', [40, 25])
  await onTheVoxels(operator, volume, 'right_drag')
})

test('zoom, window, resize and change of planes leave the marks on their voxels', async ({ page }) => {
  const operator = await atTheTarget(page)
  const volume = await readVolume(page)
  const scale = await pixelsPerMm(page)
  await operator.button('Zoom in').click()
  await operator.button('Zoom in').click()
  await settled(page)
  expect(await pixelsPerMm(page)).toBeGreaterThan(1.3 * scale)
  await onTheVoxels(operator, volume, 'zoom')
  await drag(page, 'middle', [-70, 40])
  await onTheVoxels(operator, volume, 'zoom_and_drag')
  await page.locator('canvas[tabindex]').focus()
  await page.keyboard.press('BracketRight')
  await onTheVoxels(operator, volume, 'window_key')
  await page.setViewportSize({ width: 1500, height: 940 })
  await onTheVoxels(operator, volume, 'resize')
  await page.setViewportSize({ width: 1920, height: 1080 })
  for (const plane of ['coronal', 'sagittal', 'axial']) {
    await operator.button(plane).click()
    await onTheVoxels(operator, volume, `plane_${plane}`)
  }
  await operator.button('Fit view').click()
  await onTheVoxels(operator, volume, 'reset')
  expect(await pixelsPerMm(page)).toBeCloseTo(scale, 1)
})

test('keys and drops that the page does not list change nothing', async ({ page }) => {
  const operator = await atTheTarget(page)
  await page.mouse.move(5, 5)
  const before = await bare(page)
  const crosshair = await operator.mm('crosshair')
  const canvas = page.locator('canvas[tabindex]')
  await canvas.focus()
  for (const key of 'vhjklcurdsbgwyqnVHJKLCURCS') {
    await canvas.focus()
    await page.keyboard.press(key)
  }
  await canvas.dispatchEvent('drop')
  await canvas.dblclick({ position: { x: 3, y: 3 }, button: 'right' })
  await settled(page)
  expect(distance(await operator.mm('crosshair'), crosshair)).toBe(0)
  await page.mouse.move(5, 5)
  expect((await bare(page)).equals(before), 'the same picture').toBe(true)
})

test('a wheel step moves the slice and keeps a nudge', async ({ page }) => {
  const operator = await atTheTarget(page)
  await page.locator('canvas[tabindex]').focus()
  const from = await operator.mm('crosshair')
  await page.keyboard.press('Shift+ArrowUp')
  await expect.poll(async () => distance(await operator.mm('crosshair'), from)).toBeCloseTo(0.1, 2)
  const nudged = await operator.mm('crosshair')
  const { x, y, width, height } = await large(page)
  await page.mouse.move(x + width / 2, y + height / 2)
  await page.mouse.wheel(0, 100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), nudged)).toBeGreaterThan(0)
  await page.mouse.wheel(0, -100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), nudged)).toBeLessThan(0.001)
})

test('a touchpad moves by as much as a wheel, not a slice for each of its small steps', async ({ page }) => {
  const operator = await atTheTarget(page)
  const slice = async () => Number(await page.locator('[data-name=slice]').textContent())
  const from = await slice()
  const { x, y, width, height } = await large(page)
  await page.mouse.move(x + width / 2, y + height / 2)
  for (let n = 0; n < 30; ++n) await page.mouse.wheel(0, 4)
  await expect.poll(slice).toBe(from - 3)
  await page.mouse.wheel(0, -4)
  for (const notch of [-53, -120]) await page.mouse.wheel(0, notch)
  await expect.poll(slice).toBe(from - 1)
  await settled(operator.page)
  expect(await slice()).toBe(from - 1)
})
