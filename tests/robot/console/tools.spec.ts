// Tools of the viewer, by mouse and by keyboard; and what the page says of a plan before it is confirmed.
import { expect, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { distance, PageOperator, type Vec3 } from './support/page_operator'
import { pixelsPerMm } from './support/picture'
import { Robot } from './support/robot'
import { kCold, no } from './support/scenes'
import { freezePage, lastEvent } from './support/tap'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

test('the ruler measures what the scale bar says', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const scale = await pixelsPerMm(page)
  const before = await operator.mm('crosshair')
  await operator.button('Ruler').click()
  const box = (await page.locator('[data-tile^=large] rect').first().boundingBox())!
  const [x, y] = [box.x + box.width / 3, box.y + box.height / 3]
  await page.mouse.move(x, y)
  await page.mouse.down()
  await page.mouse.move(x + 120, y + 90, { steps: 3 })
  await page.mouse.up()
  const measured = Number(await page.locator('[data-tile^=large] [data-name=ruler]').getAttribute('data-mm'))
  expect(Math.abs(measured - 150 / scale)).toBeLessThan(0.1)
  expect(distance(await operator.mm('crosshair'), before)).toBe(0) // a ruler moves nothing else
  await operator.button('Ruler').click()
})

// DICOM PS3.3 C.7.6.1.1.1 names the sides; radiologists look from the feet and from the front, and in a sagittal plane the
// nose points to the left. That the picture is on these sides: overlay.spec.ts, by the voxels.
const kSides = {
  axial: { left: 'R', right: 'L', top: 'A', bottom: 'P' },
  coronal: { left: 'R', right: 'L', top: 'S', bottom: 'I' },
  sagittal: { left: 'A', right: 'P', top: 'S', bottom: 'I' },
}
test('the planes are in the convention of radiology, large and small', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const sidesOf = (tile: string) => page.locator(`[data-tile="${tile}"] .letter`).evaluateAll((all) =>
    Object.fromEntries(all.map((one) => [(one as SVGElement).dataset.edge, one.textContent![0]])))
  for (const [plane, sides] of Object.entries(kSides)) {
    await operator.button(plane).click()
    await expect(page.locator(`[data-tile="large ${plane}"]`)).toBeAttached()
    expect(await sidesOf(`large ${plane}`), plane).toEqual(sides)
    for (const [small, its] of Object.entries(kSides)) expect(await sidesOf(small), `small ${small}`).toEqual(its)
  }
  await operator.button('axial').click()
})

test('zoom, pan and window are read out, and fit takes them back', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const caption = page.locator('.caption')
  const read = async () => {
    const [, zoom, width, level] = /zoom ([\d.]+).*window (-?\d+) level (-?\d+)/.exec((await caption.textContent())!)!.map(Number)
    return { zoom: zoom!, width: width!, level: level! }
  }
  const [first, scale] = [await read(), await pixelsPerMm(page)]
  await expect(caption).not.toContainText('moved')
  for (let n = 0; n < 3; ++n) await operator.button('Zoom in').click()
  await expect.poll(async () => (await read()).zoom).toBeGreaterThan(first.zoom)
  await expect.poll(async () => Math.abs((await pixelsPerMm(page)) / scale - (await read()).zoom / first.zoom)).toBeLessThan(0.06)
  await expect(caption).toContainText('moved')
  const box = (await page.locator('[data-tile^=large] rect').first().boundingBox())!
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2]
  const drag = async (dx: number, dy: number) => {
    await page.mouse.move(x, y)
    await page.mouse.down({ button: 'right' })
    await page.mouse.move(x + dx, y + dy, { steps: 4 })
    await page.mouse.up({ button: 'right' })
  }
  await drag(100, 0) // as the list says: wider,
  await expect.poll(async () => (await read()).width).toBeGreaterThan(1.3 * first.width)
  await drag(0, -50) // and brighter, which is a lower level
  await expect.poll(async () => (await read()).level).toBeLessThan(first.level)
  await operator.button('Fit view').click()
  await expect(caption).not.toContainText('moved')
  expect(await read()).toEqual(first)
})

test('slice number, slider and keys agree', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const slice = async () => Number(await page.locator('[data-name=slice]').textContent())
  const from = await slice()
  const canvas = page.locator('canvas[tabindex]')
  await canvas.focus()
  await page.keyboard.press('PageUp')
  await expect.poll(slice).toBe(from + 1)
  await page.getByRole('slider', { name: /slice/ }).focus()
  await page.keyboard.press('ArrowRight')
  await expect.poll(slice).toBe(from + 2)
  const [series, before] = [(await lastEvent(page, 'Opened')).series, await operator.mm('crosshair')]
  await canvas.focus()
  await page.keyboard.press('PageDown')
  await expect.poll(async () => distance(await operator.mm('crosshair'), before)).toBeCloseTo(series.spacing[2], 2)
  await page.keyboard.press('2')
  await expect(page.locator('[data-tile="large coronal"]')).toBeAttached()
  await page.keyboard.press('1')
})

test('the crosshair is open in the middle', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  const mark = (await page.locator('[data-tile^=large] [data-name=target]').boundingBox())!
  const middle = { x: mark.x + mark.width / 2, y: mark.y + mark.height / 2 }
  // Sampled along the lines: how near they come to the middle of the mark.
  const nearest = await page.locator('[data-tile^=large] [data-name=cross]').evaluate((path: SVGPathElement, { x, y }) => {
    const canvas = path.ownerSVGElement!.getBoundingClientRect()
    const at = (n: number) => path.getPointAtLength(n)
    const lengths = Array.from({ length: Math.ceil(path.getTotalLength()) }, (_, n) => n)
    return Math.min(...lengths.map((n) => Math.hypot(at(n).x + canvas.x - x, at(n).y + canvas.y - y)))
  }, middle)
  expect(nearest).toBeGreaterThan(10)
  expect(nearest).toBeLessThan(25)
})

test('undo and redo of a point, by button and key; the server has the same', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const entry = async () => (await lastEvent(page, 'Planned')).target[0].ras as Vec3
  const first = await entry()
  await operator.clickAt('target')
  await page.locator('canvas[tabindex]').focus()
  await page.keyboard.press('Shift+ArrowUp')
  await operator.click('Set target')
  await expect.poll(async () => distance(await entry(), first)).toBeGreaterThan(0.05)
  const second = await entry()
  await operator.button('Undo').click()
  await expect.poll(async () => distance(await entry(), first)).toBeLessThan(0.001)
  await operator.button('Redo').click()
  await expect.poll(async () => distance(await entry(), second)).toBeLessThan(0.001)
  await page.locator('canvas[tabindex]').focus()
  await page.keyboard.press('Control+z')
  await expect.poll(async () => distance(await entry(), first)).toBeLessThan(0.001)
})

test('a key that is kept down sets and undoes once; two undos at once are two', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const target = async () => (await lastEvent(page, 'Planned')).target[0].ras as Vec3
  await operator.clickAt('target')
  const canvas = page.locator('canvas[tabindex]')
  const places = [await target()]
  for (let n = 0; n < 2; ++n) {
    await canvas.focus()
    await page.keyboard.press('Shift+ArrowUp')
    for (let repeats = 0; repeats < 20; ++repeats) await page.keyboard.down('t')
    await page.keyboard.up('t')
    await expect.poll(async () => distance(await target(), places.at(-1)!)).toBeGreaterThan(0.05)
    places.push(await target())
  }
  const is = (n: number) => expect.poll(async () => distance(await target(), places[n]!), `target ${n}`).toBeLessThan(0.001)
  await page.keyboard.down('Control')
  for (let repeats = 0; repeats < 20; ++repeats) await page.keyboard.down('z')
  await page.keyboard.up('z')
  await page.keyboard.up('Control')
  await is(1)
  await page.keyboard.press('Control+y')
  await is(2)
  await page.evaluate(() => {
    const undo = document.querySelector<HTMLButtonElement>('[aria-label=Undo]')!
    undo.click()
    undo.click()
  })
  await is(0)
  await page.keyboard.press('Control+y')
  await is(1)
  await page.keyboard.press('Control+y')
  await is(2)
})

test('? lists every input, and leaves STOP and the alarms in view', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await page.locator('canvas[tabindex]').focus()
  await page.keyboard.press('?')
  await expect(page.locator('.inputs dt')).toHaveCount(18)
  await expect(operator.button('STOP')).toBeInViewport({ ratio: 1 })
  await expect(page.locator('.alarm')).toBeInViewport({ ratio: 1 })
  await expectAccessible(page)
  await operator.button('Close the list').click()
  await expect(page.locator('.inputs')).toHaveCount(0)
})

test('the reach of the stage is drawn around the entry', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('entry')
  const reach = page.locator('[data-tile^=large] [data-name=reach]')
  const { reach: told } = await lastEvent(page, 'Opened')
  expect(told).toBe(11) // stroke of 12 mm less the margin of 1 mm
  const radius = await reach.evaluate((circle: SVGCircleElement) => circle.r.baseVal.value)
  expect(Math.abs(radius / (await pixelsPerMm(page)) - told)).toBeLessThan(0.1)
})

test('a plan that is thin is told before it is confirmed', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const planned = await lastEvent(page, 'Planned')
  const show = (layers: object[]) =>
    freezePage(page, { mode: 'Safe', step: 'Plan', disabled: no({ ...kCold, plan: '' }) }, [{ ...planned, confirmed: false, depth: 2.5, layers } as never])
  const warnings = page.locator('[data-name=warnings] li')
  await show([{ name: 'unknown', from: 0, to: 11 }])
  await expect(warnings).toContainText(['2.5 mm of the path are of unknown tissue.'])
  await show([{ name: 'liver', from: 0, to: 11 }])
  await expect(warnings).toContainText(['The entry lies in liver: the path does not begin at the skin.'])
  await show([{ name: 'skin', from: 0, to: 2.4 }, { name: 'liver', from: 2.4, to: 11 }])
  await expect(warnings).toContainText(['The target is 0.1 mm from the edge of liver.'])
  await show([{ name: 'skin', from: 0, to: 1 }, { name: 'liver', from: 1, to: 11 }])
  await expect(warnings.filter({ hasText: /tissue|entry lies|edge/ })).toHaveCount(0)
})
