// STOP, from the click to the moment when the stage itself reports 0 V.
import { expect, test } from '@playwright/test'

import { note, spread } from './figures'
import { Person } from './person'
import { Robot } from './robot'

const kStopMax_ms = 100
const kStops = 5

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

// When the browser got the event, ms since 1970: `event.timeStamp` is that of the input, not of its handler.
async function noteInput(person: Person, type: 'pointerdown' | 'keydown'): Promise<void> {
  await person.page.evaluate((name) => {
    delete document.body.dataset.input
    window.addEventListener(
      name,
      (event) => (document.body.dataset.input = String(Date.now() - (performance.now() - event.timeStamp))),
      { capture: true, once: true },
    )
  }, type)
}
const inputAt = async (person: Person) => Number(await person.page.locator('body').getAttribute('data-input'))

test('STOP takes the voltage off a moving needle within 100 ms of the click', async ({ page }) => {
  test.setTimeout(300_000)
  const person = new Person(page, robot.url)
  const times: number[] = []
  for (let n = 0; n < kStops; ++n) {
    await (n === 0 ? person.armed() : rearm(person))
    await person.insertButton().focus()
    await expect(async () => {
      await page.keyboard.up('Enter')
      await page.keyboard.down('Enter') // the mouse is for STOP
      await expect(person.mode()).toHaveAttribute('data-mode', 'Active', { timeout: 1000 })
    }).toPass()
    await noteInput(person, 'pointerdown')
    await person.button('STOP').hover()
    await page.mouse.down()
    await person.is('Trip')
    times.push(await robot.msToZero(await inputAt(person)))
    await page.mouse.up()
    await page.keyboard.up('Enter')
  }
  note({ stop_to_zero_ms: spread(times) })
  for (const ms of times) expect(ms).toBeLessThanOrEqual(kStopMax_ms)
})

async function rearm(person: Person): Promise<void> {
  await person.reset()
  await person.tickAll()
  await person.is('Ready')
  await person.arm()
}

test('Esc does the same, says so, and Reset is needed after', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  await person.moving()
  await noteInput(person, 'keydown')
  await page.keyboard.press('Escape')
  await person.is('Trip')
  expect(await robot.msToZero(await inputAt(person))).toBeLessThanOrEqual(kStopMax_ms)
  await page.mouse.up()
  await expect(person.alarm()).toContainText('E-120')
  await expect(person.alarm()).toContainText('STOP was pressed')
  await expect(person.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await person.reset()
})

test('STOP and the other buttons are whole and in view on small screens', async ({ page }) => {
  await new Person(page, robot.url).open()
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
