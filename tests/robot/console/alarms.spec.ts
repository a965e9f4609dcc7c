// Alarms in the manner of IEC 60601-1-8: priorities with their flash rates and sounds, a pause, acknowledgement, a list
// with the past.
import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { distance, PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { kAlarm, kCold, kWarning } from './support/scenes'
import { freezePage, lastEvent } from './support/tap'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

const kNotice = { severity: 'Notice', code: 'E-230', what: 'The log is behind.', robot_did: 'Not ready.', to_do: 'Check the disk of the log.' }

// Records the pulses that the page asks its loudspeaker for.
async function listen(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const pulses: object[] = []
    Object.assign(window, { pulses })
    const start = OscillatorNode.prototype.start
    OscillatorNode.prototype.start = function (this: OscillatorNode, when = 0) {
      pulses.push({ from: when, to: 0, hz: this.frequency.value, asked_ms: performance.now() })
      Object.assign(this, { pulse: pulses.at(-1) })
      start.call(this, when)
    }
    const stop = OscillatorNode.prototype.stop
    OscillatorNode.prototype.stop = function (this: OscillatorNode & { pulse?: { to: number } }, when = 0) {
      if (this.pulse && when > 0) this.pulse.to = when
      stop.call(this, when)
    }
  })
}
type Pulse = { from: number; to: number; hz: number; asked_ms: number }
const pulses = (page: Page): Promise<Pulse[]> => page.evaluate(() => (window as unknown as { pulses: [] }).pulses)
// How many pulses each burst has. A burst is asked for at once; on a slow machine the next one has begun before anybody counts.
const sizesOfBursts = (all: Pulse[]): number[] => {
  const begins = all.flatMap(({ asked_ms }, n) => (n === 0 || asked_ms - all[n - 1]!.asked_ms > 1000 ? [n] : []))
  return begins.map((begin, n) => (begins[n + 1] ?? all.length) - begin)
}
const forget = (page: Page) => page.evaluate(() => void ((window as unknown as { pulses: unknown[] }).pulses.length = 0))

async function watched(page: Page): Promise<PageOperator> {
  await listen(page)
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await freezePage(page, { mode: 'Safe', step: 'Check', disabled: kCold })
  await page.mouse.click(700, 20) // a browser is silent before the first click
  // Without a graphics card the first picture of the image takes seconds, in which nothing else is drawn.
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))))
  return operator
}
const raise = (page: Page, alarms: object[]) => freezePage(page, { mode: 'Safe', step: 'Check', alarms, disabled: kCold })

// How often the border came and went, as it is seen.
const changesOfBorder = (page: Page, lasts_ms: number): Promise<number> =>
  page.locator('.alarm').evaluate(async (line, duration) => {
    const shown = () => getComputedStyle(line, '::before').opacity
    let [changes, before] = [0, shown()]
    for (const from = performance.now(); performance.now() - from < duration; await new Promise(requestAnimationFrame)) {
      const now = shown()
      if (now !== before) ++changes
      before = now
    }
    return changes
  }, lasts_ms)

for (const [alarm, priority, count, flashes_Hz] of [[kAlarm, 'high', 10, 2], [kWarning, 'medium', 3, 0.5], [kNotice, 'low', 2, 0]] as const)
  test(`an alarm of ${priority} priority: ${count} pulses, its flash rate`, async ({ page }) => {
    await watched(page)
    await raise(page, [alarm])
    const line = page.locator('.alarm')
    await expect(line).toHaveAttribute('data-priority', priority)
    await expect(line.locator('.mark')).toContainText(priority.toUpperCase())
    const watched_s = 4
    const wanted = 2 * watched_s * flashes_Hz
    const changes = await changesOfBorder(page, 1000 * watched_s)
    expect(changes).toBeGreaterThanOrEqual(Math.max(wanted - 1, 0))
    expect(changes).toBeLessThanOrEqual(wanted + Math.min(wanted, 1))
    await expect.poll(async () => new Set(sizesOfBursts(await pulses(page)))).toEqual(new Set([count]))
    for (const { from, to, hz } of await pulses(page)) {
      expect(hz).toBeGreaterThanOrEqual(150)
      expect(hz).toBeLessThanOrEqual(1000)
      expect(to - from).toBeGreaterThanOrEqual(priority === 'high' ? 0.075 : 0.125)
      expect(to - from).toBeLessThanOrEqual(priority === 'high' ? 0.2 : 0.25)
    }
    await expectAccessible(page)
  })

// A context that plays silence costs processor time.
test('the sound rests between two bursts, and comes again', async ({ page }) => {
  await page.addInitScript(() => {
    const Real = window.AudioContext
    window.AudioContext = class extends Real {
      constructor() {
        super()
        Object.assign(window, { audio: this })
      }
    }
  })
  await watched(page)
  await raise(page, [kAlarm])
  const audio = () => page.evaluate(() => (window as unknown as { audio: AudioContext }).audio.state)
  await expect.poll(audio).toBe('running')
  await expect.poll(audio).toBe('suspended')
  expect(await pulses(page)).toHaveLength(10)
  await expect.poll(async () => (await pulses(page)).length).toBe(20)
  await expect.poll(audio).toBe('running')
  await expect(page.locator('[data-name=audio-off]')).toHaveCount(0)
})

test('sound is paused and returns; acknowledging silences what is there, not what comes', async ({ page }) => {
  const operator = await watched(page)
  await operator.button('Alarms').first().waitFor()
  await raise(page, [kWarning])
  await expect.poll(async () => (await pulses(page)).length).toBe(3)
  await operator.button('Pause sound').click()
  await expect(page.locator('[data-name=audio-paused]')).toContainText(/Sound paused: 1[12]\d s/)
  await forget(page)
  await raise(page, [kAlarm, kWarning])
  await page.waitForTimeout(500)
  expect(await pulses(page)).toEqual([])
  await operator.button('Sound on').click()
  await expect.poll(async () => (await pulses(page)).length).toBe(10)

  await operator.button('Acknowledge').click()
  await expect(page.locator('.alarm')).toHaveClass(/acknowledged/)
  expect(await changesOfBorder(page, 1500)).toBe(0)
  expect(await page.locator('.alarm').evaluate((one) => getComputedStyle(one, '::before').opacity)).toBe('1')
  await expect(page.locator('[data-name=alarm]')).toContainText(kAlarm.code) // it stands as long as its cause
  await forget(page)
  await raise(page, [kAlarm, kWarning, kNotice])
  await expect.poll(async () => (await pulses(page)).length).toBe(2)
  await expect(page.locator('[data-name=alarm]')).toContainText(kNotice.code) // before those that are known
})

test('the list shows what is and what was, newest first', async ({ page }) => {
  const operator = await watched(page)
  const at = Date.now()
  const row = (number: number, alarm: object, from_ms: number, to_ms: number, acknowledged_ms: number) => ({ number, alarm, from_ms, to_ms, acknowledged_ms })
  const rows = [row(2, kAlarm, at - 1000, 0, 0), row(1, kWarning, at - 9000, at - 2000, at - 5000)]
  await freezePage(page, { mode: 'Safe', step: 'Check', alarms: [kAlarm], disabled: kCold }, [{ type: 'AlarmHistory', rows }])
  await operator.button(/^Alarms: 1/).click()
  const shown = page.locator('.alarm-list tbody tr')
  await expect(shown).toHaveCount(2)
  await expect(shown.nth(0)).toContainText(kAlarm.code)
  await expect(shown.nth(0)).toHaveAttribute('data-active', 'true')
  await expect(shown.nth(0).locator('td').nth(2)).toHaveText('no')
  await expect(shown.nth(1)).toContainText(kWarning.code)
  await expect(shown.nth(1)).toHaveAttribute('data-active', 'false')
  await expect(shown.nth(1).locator('td').nth(2)).toHaveText(/\d\d:\d\d:\d\d$/)
  await expectAccessible(page)
  // STOP and the alarms stay in reach.
  await expect(operator.button('STOP')).toBeInViewport({ ratio: 1 })
})

test('history, acknowledgement, series and points outlive a reload of the page and a restart of the console', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.ready()
  const points = await lastEvent(page, 'Planned')
  await page.keyboard.press('Escape')
  await expect(operator.alarm()).toContainText('STOP was pressed')
  await operator.button('Acknowledge').click()
  await expect(page.locator('.alarm')).toHaveClass(/acknowledged/)
  const stop = page.locator('.alarm-list tbody tr').filter({ hasText: 'STOP was pressed' }).first()
  const list = async () => {
    await operator.button(/^Alarms: /).click()
    await expect(stop.locator('td').nth(2)).toHaveText(/:/)
    return (await stop.locator('td').allTextContents()).filter((_, n) => n === 0 || n === 2)
  }
  const before = await list()

  await page.reload()
  await expect(operator.alarm()).toContainText('STOP was pressed')
  await expect(page.locator('.alarm')).toHaveClass(/acknowledged/) // nobody has to do it twice
  expect(await list()).toEqual(before)

  process.kill(robot.pid('biopsy-console'), 'SIGKILL')
  await expect(page.locator('[data-screen]')).toHaveAttribute('data-screen', 'ended')
  await expect(page.locator('[data-screen]')).toHaveCount(0, { timeout: 40_000 })
  await expect(page.locator('.alarm-list tbody tr').filter({ hasText: 'E-124' })).toHaveAttribute('data-active', 'true')
  await expect(page.locator('.alarm-list tbody tr').filter({ hasText: 'E-100' }).first()).toHaveAttribute('data-active', 'false')
  expect((await stop.locator('td').allTextContents()).filter((_, n) => n === 0 || n === 2)).toEqual(before)
  await operator.imageShown()
  const after = await lastEvent(page, 'Planned')
  expect(after.confirmed).toBe(false)
  for (const mark of ['entry', 'target'] as const)
    expect(distance(after[mark][0].ras, points[mark][0].ras)).toBeLessThan(1e-6)
  expect(after.depth).toBeCloseTo(points.depth, 6)
  await page.reload()
  await operator.ready()
  await expect(page.locator('[data-name=alarm]').filter({ hasText: 'E-124' })).toHaveCount(0)
})
