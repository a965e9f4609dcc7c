// The rules of the console, each with somebody who tries to break it.
import { writeFileSync } from 'node:fs'

import { expect, type Page, test } from '@playwright/test'

import { Console, pause, Robot } from './robot'

const kStage_mm = 2.5
let robot: Robot
let domain = 151

test.beforeEach(async () => {
  robot = new Robot(domain++)
  await robot.start()
})
test.afterEach(() => robot.stop())

const depth = async (page: Page) => parseFloat((await page.locator('[data-name=Depth]').textContent())!)

// Presses until the needle moves, and keeps the button down.
async function moving(person: Console): Promise<void> {
  for (let presses = 0; presses < 10; ++presses) {
    if (!(await person.modeIs('Armed')) && !(await person.modeIs('Hold'))) await person.arm()
    await person.button('Hold to insert').hover()
    await person.page.mouse.down()
    for (let n = 0; n < 20; ++n) {
      await pause(25)
      if (await person.modeIs('Active')) return
    }
    await person.page.mouse.up()
    await pause(200)
  }
  throw new Error('the needle never moved')
}

// Whatever was done: the needle is held, short of its stage, and stays where it is.
async function isHeld(person: Console): Promise<void> {
  await expect.poll(() => person.mode().getAttribute('data-mode'), { intervals: [50] }).not.toBe('Active')
  const first = await depth(person.page)
  expect(first).toBeLessThan(kStage_mm - 0.2)
  await pause(700)
  expect(await person.modeIs('Active')).toBe(false)
}

test('letting go holds, and going on takes a new press', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.mouse.up()
  await isHeld(person)
  await moving(person)
  await page.mouse.up()
  const tokens = robot.acts().filter((act) => act.asked.includes('"Press"') && act.answer === 'done')
  const used = tokens.map((act) => JSON.parse(act.asked).token)
  expect(new Set(used).size).toBe(used.length)
})

test('a page that freezes for 700 ms holds, and its late beats move nothing', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.evaluate(() => {
    const until = performance.now() + 700
    while (performance.now() < until);
  })
  await isHeld(person)
  await page.mouse.up()
})

test('a tab that is hidden holds', async ({ page, context }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.evaluate(() => {
    Object.defineProperty(document, 'hidden', { value: true, configurable: true })
    document.dispatchEvent(new Event('visibilitychange'))
  })
  await isHeld(person)
  await page.mouse.up()
  await context.newPage()
})

test('a window that loses the keyboard or the pointer holds', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.evaluate(() => window.dispatchEvent(new Event('blur')))
  await isHeld(person)
  await page.mouse.up()
})

test('a link that is cut holds, and the page says so', async ({ page }) => {
  const person = new Console(page, robot.url)
  const sockets: { close(): Promise<void> }[] = []
  await page.routeWebSocket(/live/, (route) => {
    sockets.push(route.connectToServer())
  })
  await person.prepare()
  await moving(person)
  await sockets.at(-1)!.close()
  await expect(page.locator('[data-name=mode]')).toContainText('NO LINK')
  await expect(page.locator('[data-name=alarm]')).toContainText('E-100')
  await page.mouse.up()
  await expect(page.locator('[data-name=mode]')).not.toContainText('NO LINK')
  await isHeld(person)
})

test('a console that is killed leaves a needle that is held and let back', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  process.kill(robot.pid('biopsy-console'), 'SIGKILL')
  await expect(page.locator('[data-name=mode]')).toContainText('NO LINK')
  for (const name of [/^Arm/, 'Hold to insert', 'Retract', 'Reset'])
    await expect(person.button(name)).toHaveAttribute('aria-disabled', 'true')
  await page.mouse.up()
  expect(robot.modes().at(-1)).not.toBe('active')
})

test('a second page watches, and may only stop', async ({ page, context }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  const other = await context.newPage()
  const watcher = new Console(other, robot.url)
  await watcher.open()
  for (const name of [/^Arm/, 'Hold to insert', 'Retract'])
    await expect(watcher.button(name)).toHaveAttribute('aria-disabled', 'true')
  await expect(other.getByText('Another page controls the robot').first()).toBeVisible()
  await other.bringToFront()
  await watcher.button('STOP').dispatchEvent('pointerdown')
  await person.is('Trip')
})

test('STOP acts on pointer-down, Esc does the same, and Reset is needed after', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.keyboard.press('Escape')
  await person.is('Trip')
  await page.mouse.up()
  await expect(page.locator('[data-name=alarm]')).toContainText('E-120')
  await expect(person.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await pause(1000)
  await person.button('Reset').click()
  await expect.poll(() => person.mode().getAttribute('data-mode')).not.toBe('Trip')
})

test('a double click and a key that repeats are one press', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  await person.button('Hold to insert').dblclick({ delay: 20 })
  await isHeld(person)
  await person.button('Hold to insert').focus()
  for (let n = 0; n < 8; ++n) {
    await page.keyboard.down('Enter') // from the second on: a repeat
    await pause(30)
  }
  await page.keyboard.up('Enter')
  await isHeld(person)
})

test('a page whose clock is wrong by an hour works the same', async ({ page }) => {
  await page.addInitScript(() => {
    const now = Date.now
    Date.now = () => now() + 3_600_000
    const monotonic = performance.now.bind(performance)
    performance.now = () => monotonic() + 7.2e6
  })
  const person = new Console(page, robot.url)
  await person.prepare()
  await moving(person)
  await page.mouse.up()
  await isHeld(person)
})

test('a spent token, a wrong place and a strange message are refused in words', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.open()
  await person.openSeries()
  const answers = await page.evaluate(async () => {
    const socket = new WebSocket(`ws://${location.host}/live${location.search}`)
    const heard: { type: string; code: string; controller?: boolean }[] = []
    socket.onmessage = (event) => heard.push(JSON.parse(event.data))
    await new Promise((resolve) => (socket.onopen = resolve))
    socket.send('{"type":"Press","id":1,"button":"Insert","token":7,"page_ms":1}')
    socket.send('{"type":"Stop"}')
    socket.send('garbage')
    await new Promise((resolve) => setTimeout(resolve, 1500))
    return heard.filter((one) => one.type === 'Answer').map((one) => one.code)
  })
  expect(answers).toEqual(['E-101', 'E-110', 'E-110'])
})

test('STOP takes the voltage off within 100 ms of the click', async ({ page }) => {
  const person = new Console(page, robot.url)
  await person.prepare()
  const clicks: number[] = []
  for (let n = 0; n < 5; ++n) {
    await moving(person)
    await pause(300)
    clicks.push(
      await page.evaluate(() => {
        const stop = [...document.querySelectorAll('button')].find((one) => one.textContent === 'STOP')!
        const clicked = Date.now()
        stop.dispatchEvent(new PointerEvent('pointerdown', { bubbles: true }))
        return clicked
      }),
    )
    await person.is('Trip')
    await page.mouse.up()
    await pause(4000) // the run ends, and with it what was ticked
    await expect(async () => {
      await person.button('Reset').click({ timeout: 1000 })
      await pause(500)
      expect(await person.modeIs('Trip')).toBe(false)
    }).toPass()
    if (n === 4) break
    const boxes = page.getByRole('checkbox')
    await expect(boxes).toHaveCount(3)
    for (const box of await boxes.all()) {
      await box.click()
      await expect(box).toBeChecked()
    }
    await person.is('Ready')
  }
  const times = robot.msToZero(clicks)
  if (process.env.FIGURES) writeFileSync(`${process.env.FIGURES}.stop`, JSON.stringify({ stop_to_zero_ms: times }))
  for (const ms of times) expect(ms).toBeLessThanOrEqual(100)
})
