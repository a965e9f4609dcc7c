// Acts that a browser answers by itself, and that would take page, keyboard or STOP away from the operator; and STOP by
// means other than a plain click.
import { expect, type Page, test } from '@playwright/test'

import { distance, PageOperator } from './support/page_operator'
import { Robot } from './support/robot'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())
test.use({ hasTouch: true })

async function middleOf(page: Page, selector: string): Promise<{ x: number; y: number }> {
  const box = (await page.locator(selector).first().boundingBox())!
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 }
}

test('no menu, no file that is opened, no zoom by wheel, no page back, anywhere', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const left = await page.evaluate(() => {
    const places = ['.top', '.alarm', '.steps', 'canvas[tabindex]', '.picking', '.plan', '.acts', '.stopping button', '.act button']
    const given = { bubbles: true, cancelable: true }
    const acts: [string, () => Event][] = [
      ['menu', () => new MouseEvent('contextmenu', given)],
      ['file over it', () => new DragEvent('dragover', given)],
      ['file dropped', () => new DragEvent('drop', given)],
      ['drag of a link or text', () => new DragEvent('dragstart', given)],
      ['zoom', () => new WheelEvent('wheel', { ...given, ctrlKey: true, deltaY: 100 })],
      ['back', () => new MouseEvent('mouseup', { ...given, button: 3 })],
      ['forward', () => new MouseEvent('mouseup', { ...given, button: 4 })],
      ['scrolling by middle button', () => new MouseEvent('mousedown', { ...given, button: 1 })],
    ]
    return places.flatMap((place) => acts.filter(([, make]) => document.querySelector(place)!.dispatchEvent(make())).map(([name]) => `${name}: ${place}`))
  })
  expect(left).toEqual([])
})

test('two fingers do not zoom the page away from STOP', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const cdp = await page.context().newCDPSession(page)
  for (const place of ['canvas[tabindex]', '.plan', '.top', '.acts']) {
    await cdp.send('Input.synthesizePinchGesture', { ...(await middleOf(page, place)), scaleFactor: 2, gestureSourceType: 'touch' })
    expect(await page.evaluate(() => visualViewport!.scale), place).toBe(1)
  }
  await expect(operator.button('STOP')).toBeInViewport({ ratio: 1 })
})

test('on the image the first finger moves the crosshair, another one does not', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const cdp = await page.context().newCDPSession(page)
  const touch = (type: 'touchStart' | 'touchMove' | 'touchEnd', ...touchPoints: { x: number; y: number; id: number }[]) =>
    cdp.send('Input.dispatchTouchEvent', { type, touchPoints })
  const large = await middleOf(page, '[data-tile^=large] rect')
  const at = { x: large.x + 40, y: large.y + 20 } // the crosshair may be in the middle
  const first = { ...at, id: 1 }
  const before = await operator.mm('crosshair')
  await touch('touchStart', { ...first, x: at.x - 60 })
  await touch('touchMove', { ...first, x: at.x - 30 })
  await touch('touchMove', first)
  await expect.poll(async () => Math.abs((await operator.crossAt()).x - at.x)).toBeLessThan(2)
  expect(distance(await operator.mm('crosshair'), before)).toBeGreaterThan(0)
  const reached = await operator.mm('crosshair')
  const second = { x: at.x - 200, y: at.y - 100, id: 2 }
  await touch('touchStart', first, second)
  for (const n of [1, 2, 3]) await touch('touchMove', first, { ...second, x: second.x - 10 * n })
  expect(distance(await operator.mm('crosshair'), reached)).toBeLessThan(0.01)
  await touch('touchEnd')
})

// With a button down there is no pointerdown; on the image the mouse is captured besides. By voice there is a click alone.
for (const [how, stopBy] of [
  ['by voice or a screen reader', async (operator: PageOperator) => operator.button('STOP').evaluate((button: HTMLButtonElement) => button.click())],
  ['while the right button is down on the image', (operator: PageOperator) => stopFrom(operator, '[data-tile^=large] rect')],
  ['while the right button is down beside it', (operator: PageOperator) => stopFrom(operator, '.top')],
] as const)
  test(`STOP ${how}`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.ready()
    await stopBy(operator)
    await expect(operator.alarm()).toContainText('STOP was pressed')
    for (const button of ['left', 'right'] as const) await page.mouse.up({ button })
  })

async function stopFrom(operator: PageOperator, start: string): Promise<void> {
  const { page } = operator
  const [from, to] = [await middleOf(page, start), await middleOf(page, '.stopping button')]
  await page.mouse.move(from.x, from.y)
  await page.mouse.down({ button: 'right' })
  await page.mouse.move(to.x, to.y, { steps: 3 })
  await page.mouse.down({ button: 'left' })
}
