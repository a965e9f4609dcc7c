// Hold to run: losing pointer, focus or page holds the needle, and only a new press continues.
import { expect, type Locator, type Page, test } from '@playwright/test'

import { note } from './support/figures'
import { PageOperator } from './support/page_operator'
import { DevtoolsBrowser } from './support/devtools_browser'
import { Robot } from './support/robot'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

async function inserting(page: Page): Promise<PageOperator> {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  await operator.moving()
  return operator
}

test('releasing holds the needle, and continuing takes a new press with its own token', async ({ page }) => {
  const operator = await inserting(page)
  await page.mouse.up()
  await operator.isHeld()
  const before = robot.presses().length
  await operator.moving()
  await page.mouse.up()
  await operator.isHeld()
  const used = robot.presses()
  expect(used.length).toBeGreaterThan(before)
  expect(new Set(used).size).toBe(used.length)
})

test('a page frozen for 700 ms holds the needle, and its late heartbeats have no effect', async ({ page }) => {
  const operator = await inserting(page)
  const frozen = await page.evaluate(() => {
    const at = Date.now()
    for (const until = performance.now() + 700; performance.now() < until; );
    return at
  })
  note({ frozen_page_to_hold_ms: await robot.msToMode(frozen, 'hold') })
  await operator.isHeld()
  expect(robot.modesSince(frozen)).not.toContain('active')
  await expect(operator.insertButton()).toHaveAttribute('aria-pressed', 'false')
  await page.mouse.up()
})

test('a hidden tab holds the needle', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  await page.close()
  const browser = new DevtoolsBrowser()
  try {
    await browser.open(robot.url)
    await browser.until(`document.body.dataset.image === 'shown'`)
    const mode = `document.querySelector('[data-name=mode]').dataset.mode`
    for (let presses = 0; presses < 20 && (await browser.value(mode)) !== 'Active'; ++presses) {
      await browser.pressMouseOn('Hold to insert')
      await browser.until(`${mode} === 'Active' || !document.querySelector('[aria-pressed=true]:not(.picking *)')`)
    }
    const at = Date.now()
    await browser.openOtherTab()
    expect(await browser.value('document.visibilityState')).toBe('hidden')
    note({ hidden_tab_to_hold_ms: await robot.msToMode(at, 'hold') })
    await browser.bringBack()
    await browser.until(`document.visibilityState === 'visible' && ${mode} !== 'Active'`)
    expect(robot.modesSince(at)).not.toContain('active')
    await browser.releaseMouse()
  } finally {
    await browser.close()
  }
})

test('a window without keyboard focus holds the needle', async ({ page }) => {
  const operator = await inserting(page)
  await page.evaluate(() => window.dispatchEvent(new Event('blur')))
  await operator.isHeld()
  await page.mouse.up()
})

test('a lost pointer holds the needle', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  await page.evaluate(() => {
    window.addEventListener('pointerdown', (event) => (document.body.dataset.pointer = String(event.pointerId)), true)
  })
  // Captured at once, or by the first movement: the browser reports the loss of the second only.
  for (const captured of [false, true]) {
    await operator.moving()
    if (captured) await page.mouse.move(...(await middle(operator.insertButton())))
    await loseThePointer(page)
    await page.mouse.move(900, 500) // the loss is reported with the next event
    await operator.isHeld()
    await page.mouse.up()
  }
})

// A mouse reports pointerup only once its last button is up.
test('the button is released although another one of the mouse is down', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  for (const other of ['right', 'middle'] as const) {
    await operator.moving()
    await page.mouse.down({ button: other })
    await page.mouse.up({ button: 'left' })
    await operator.isHeld()
    await expect(operator.insertButton()).toHaveAttribute('aria-pressed', 'false')
    await page.mouse.up({ button: other })
  }
})

async function middle(button: Locator): Promise<[number, number]> {
  const box = (await button.boundingBox())!
  return [box.x + box.width / 2 + 3, box.y + box.height / 2]
}

const loseThePointer = (page: Page) =>
  page.evaluate(() => {
    const button = [...document.querySelectorAll('button')].find((one) => one.textContent === 'Hold to insert')!
    const pointer = Number(document.body.dataset.pointer)
    if (!button.hasPointerCapture(pointer)) throw new Error('the button had not captured the pointer')
    button.releasePointerCapture(pointer)
  })

test('a double click is two presses, and motion does not continue after it', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  const before = robot.presses().length
  await operator.insertButton().dblclick({ delay: 20 })
  await operator.isHeld()
  expect(robot.presses().length - before).toBeLessThanOrEqual(2)
})

test('a repeating key is one press', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  const before = robot.presses().length
  await operator.insertButton().focus()
  for (let n = 0; n < 20; ++n) await page.keyboard.down('Enter') // from the second on: a repeat
  await page.keyboard.up('Enter')
  await operator.isHeld()
  expect(robot.presses().length - before).toBe(1)
})

test('a page clock that is wrong by hours has no effect', async ({ page }) => {
  await page.addInitScript(() => {
    const wall = Date.now
    Date.now = () => wall() + 3_600_000
    const monotonic = performance.now.bind(performance)
    performance.now = () => monotonic() + 7.2e6
  })
  const operator = await inserting(page)
  await page.mouse.up()
  await operator.isHeld()
})

test('a page clock that jumps while the button is held holds the needle', async ({ page }) => {
  const operator = await inserting(page)
  await page.evaluate(() => {
    const monotonic = performance.now.bind(performance)
    performance.now = () => monotonic() - 60_000
  })
  await operator.isHeld()
  await page.mouse.up()
})
