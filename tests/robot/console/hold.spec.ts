// Hold to run: whatever takes the hand, the eye or the page away holds the needle, and only a new press goes on.
import { expect, type Locator, type Page, test } from '@playwright/test'

import { note } from './figures'
import { Person } from './person'
import { PlainBrowser } from './plain_browser'
import { Robot } from './robot'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

// A needle that moves because the button is held.
async function inserting(page: Page): Promise<Person> {
  const person = new Person(page, robot.url)
  await person.armed()
  await person.moving()
  return person
}

test('letting go holds, and going on takes a new press with a token of its own', async ({ page }) => {
  const person = await inserting(page)
  await page.mouse.up()
  await person.isHeld()
  const before = robot.presses().length
  await person.moving()
  await page.mouse.up()
  await person.isHeld()
  const used = robot.presses()
  expect(used.length).toBeGreaterThan(before)
  expect(new Set(used).size).toBe(used.length)
})

test('a page that freezes for 700 ms holds, and its late beats move nothing', async ({ page }) => {
  const person = await inserting(page)
  const frozen = await page.evaluate(() => {
    const at = Date.now()
    for (const until = performance.now() + 700; performance.now() < until; );
    return at
  })
  note({ frozen_page_to_hold_ms: await robot.msToMode(frozen, 'hold') })
  await person.isHeld()
  expect(robot.modesSince(frozen)).not.toContain('active')
  await expect(person.insertButton()).toHaveAttribute('aria-pressed', 'false') // nobody believes it is still held
  await page.mouse.up()
})

test('a tab that is hidden holds', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  await page.close()
  const browser = new PlainBrowser()
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

test('a window that loses the keyboard holds', async ({ page }) => {
  const person = await inserting(page)
  await page.evaluate(() => window.dispatchEvent(new Event('blur')))
  await person.isHeld()
  await page.mouse.up()
})

test('a pointer that is lost holds', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  await page.evaluate(() => {
    window.addEventListener('pointerdown', (event) => (document.body.dataset.pointer = String(event.pointerId)), true)
  })
  // Caught at once, or by the first movement: the browser tells the loss of the second only.
  for (const caught of [false, true]) {
    await person.moving()
    if (caught) await page.mouse.move(...(await middle(person.insertButton())))
    await loseThePointer(page)
    await page.mouse.move(900, 500) // the loss is told with the next event
    await person.isHeld()
    await page.mouse.up()
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
    if (!button.hasPointerCapture(pointer)) throw new Error('the button had not caught the pointer')
    button.releasePointerCapture(pointer)
  })

test('a double click is two presses, and nothing goes on after it', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  const before = robot.presses().length
  await person.insertButton().dblclick({ delay: 20 })
  await person.isHeld()
  expect(robot.presses().length - before).toBeLessThanOrEqual(2)
})

test('a key that repeats is one press', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  const before = robot.presses().length
  await person.insertButton().focus()
  for (let n = 0; n < 20; ++n) await page.keyboard.down('Enter') // from the second on: a repeat
  await page.keyboard.up('Enter')
  await person.isHeld()
  expect(robot.presses().length - before).toBe(1)
})

test('a page whose clock is wrong by hours works the same', async ({ page }) => {
  await page.addInitScript(() => {
    const wall = Date.now
    Date.now = () => wall() + 3_600_000
    const monotonic = performance.now.bind(performance)
    performance.now = () => monotonic() + 7.2e6
  })
  const person = await inserting(page)
  await page.mouse.up()
  await person.isHeld()
})

test('a page whose clock jumps while the button is held holds', async ({ page }) => {
  const person = await inserting(page)
  await page.evaluate(() => {
    const monotonic = performance.now.bind(performance)
    performance.now = () => monotonic() - 60_000
  })
  await person.isHeld()
  await page.mouse.up()
})
