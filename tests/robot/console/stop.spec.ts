// STOP, from the click to the moment when the stage itself reports 0 V.
import { expect, test } from '@playwright/test'

import { note, spread } from './support/figures'
import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'

const kStopMax_ms = 100
const kStops = 5

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

// When the browser got the event, ms since 1970: `event.timeStamp` is that of the input, not of its handler.
async function noteInput(operator: PageOperator, type: 'pointerdown' | 'keydown'): Promise<void> {
  await operator.page.evaluate((name) => {
    delete document.body.dataset.input
    window.addEventListener(
      name,
      (event) => (document.body.dataset.input = String(Date.now() - (performance.now() - event.timeStamp))),
      { capture: true, once: true },
    )
  }, type)
}
const inputAt = async (operator: PageOperator) => Number(await operator.page.locator('body').getAttribute('data-input'))

test('STOP takes the voltage off a moving needle within 100 ms of the click', async ({ page }) => {
  test.setTimeout(300_000)
  const operator = new PageOperator(page, robot.url)
  const times: number[] = []
  for (let n = 0; n < kStops; ++n) {
    await (n === 0 ? operator.armed() : rearm(operator))
    await operator.insertButton().focus()
    await expect(async () => {
      await page.keyboard.up('Enter')
      await page.keyboard.down('Enter') // the mouse is needed for STOP
      await expect(operator.mode()).toHaveAttribute('data-mode', 'Active', { timeout: 1000 })
    }).toPass()
    await noteInput(operator, 'pointerdown')
    await operator.button('STOP').hover()
    await page.mouse.down()
    await operator.is('Trip')
    times.push(await robot.msToZero(await inputAt(operator)))
    await page.mouse.up()
    await page.keyboard.up('Enter')
  }
  note({ stop_to_zero_ms: spread(times) })
  for (const ms of times) expect(ms).toBeLessThanOrEqual(kStopMax_ms)
})

async function rearm(operator: PageOperator): Promise<void> {
  await operator.reset()
  await operator.tickAll()
  await operator.is('Ready')
  await operator.arm()
}

test('Esc does the same, with an alarm, and Reset is needed afterwards', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  await operator.moving()
  await noteInput(operator, 'keydown')
  await page.keyboard.press('Escape')
  await operator.is('Trip')
  expect(await robot.msToZero(await inputAt(operator))).toBeLessThanOrEqual(kStopMax_ms)
  await page.mouse.up()
  await expect(operator.alarm()).toContainText('E-120')
  await expect(operator.alarm()).toContainText('STOP was pressed')
  await expect(operator.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await operator.reset()
})

test('STOP and the other buttons are complete and visible on small screens', async ({ page }) => {
  await new PageOperator(page, robot.url).open()
  for (const [width, height] of [[1280, 720], [1366, 768], [1600, 900], [1700, 800]] as const) {
    await page.setViewportSize({ width, height })
    const buttons = page.locator('.acts .act button, .acts .stopping button')
    await expect(buttons).toHaveCount(5)
    const boxes = await Promise.all((await buttons.all()).map(async (button) => (await button.boundingBox())!))
    boxes.reduce((left, box) => {
      expect(box.x, `at ${width} x ${height}`).toBeGreaterThanOrEqual(left)
      expect(box.width).toBeGreaterThan(100)
      expect(box.y + box.height).toBeLessThanOrEqual(height)
      return box.x + box.width
    }, 0)
    expect(boxes[4]!.x + boxes[4]!.width).toBeLessThanOrEqual(width)
  }
})
