// On small screens and at 200 % zoom: every control of a decision is in view and uncovered in each state, the page does
// not scroll, and nothing lies over the alarms.
import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { checkedOf, kAlarm, kScenes, kWarning, showScene } from './support/scenes'
import { freezePage, lastEvent, type Message } from './support/tap'

// The last: a screen of 1920 x 1080 at 200 %.
const kSizes = [[1920, 1080], [1366, 768], [1280, 720], [1024, 768], [960, 540]] as const

const robot = new Robot()
let checked: Message
test.beforeAll(async () => {
  await robot.start()
  checked = checkedOf(robot.folder)
})
test.afterAll(() => robot.stop())

// What lies at the middle and near the corners of each of these is it or part of it.
async function covered(page: Page, selector: string): Promise<string[]> {
  return page.evaluate((wanted) => {
    const out: string[] = []
    for (const one of document.querySelectorAll<HTMLElement>(wanted)) {
      const { left, top, right, bottom } = one.getBoundingClientRect()
      const name = one.textContent!.slice(0, 30)
      if (right - left < 40 || left < 0 || top < 0 || right > innerWidth || bottom > innerHeight) out.push(`${name}: out of view`)
      for (const [x, y] of [[(left + right) / 2, (top + bottom) / 2], [left + 8, top + 8], [right - 8, bottom - 8]] as const) {
        const there = document.elementFromPoint(x, y)
        if (!there || !(one === there || one.contains(there))) out.push(`${name}: under ${there?.className || there?.tagName}`)
      }
    }
    return out
  }, selector)
}

for (const [width, height] of kSizes)
  test(`decisions and alarms are in view at ${width} x ${height}`, async ({ page }) => {
    test.setTimeout(200_000)
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const decisions = '.acts .act button, .stopping button, .decide button, .alarm, .alarm > button, .top [data-name=mode], .top .who, [data-name=Depth], .image:not(:has(.confirm, .loss)) .readings'
    for (const scene of kScenes) {
      await showScene(operator, scene, checked)
      await page.waitForTimeout(100)
      expect(await covered(page, decisions), scene.name).toEqual([])
      const scrolls = await page.evaluate(() => [document.documentElement.scrollHeight > innerHeight, document.documentElement.scrollWidth > innerWidth])
      expect(scrolls, scene.name).toEqual([false, false])
      if (['confirm', 'trip', 'check'].includes(scene.name)) await expectAccessible(page)
    }
  })

// Numbers cut off, or to be found by scrolling sideways, are not read.
for (const [width, height] of kSizes)
  test(`the list of alarms is not cut at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const at = Date.now()
    const rows = [kAlarm, kWarning].map((alarm, n) => ({ number: n + 1, alarm, from_ms: at - 9000, to_ms: at - 2000, acknowledged_ms: at - 5000 }))
    await freezePage(page, { mode: 'Safe', step: 'Plan' }, [{ type: 'AlarmHistory', rows }])
    await operator.button(/^Alarms: /).click()
    const list = page.locator('.alarm-list')
    await expect(list.locator('tbody tr')).toHaveCount(2)
    expect(await list.evaluate((one) => one.scrollWidth - one.clientWidth)).toBe(0)
    await expect(list).toContainText(kAlarm.robot_did)
    await expectAccessible(page)
  })

test('forty series leave the alarms uncovered and can all be reached', async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 })
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  const welcome = await lastEvent(page, 'Welcome')
  const series = Array.from({ length: 40 }, (_, n) => ({ ...welcome.series[0], series_uid: `1.2.${n}`, description: `series ${n}` }))
  await page.evaluate((message) => window.tap.inject(message as never), { ...welcome, session: 'another', series } as Message)
  await expect(page.locator('.empty li')).toHaveCount(40)
  expect(await covered(page, '.alarm, .stopping button')).toEqual([])
  await page.locator('.empty li button').last().scrollIntoViewIfNeeded()
  expect(await covered(page, '.alarm, .stopping button, .empty li:last-child button')).toEqual([])
  await page.locator('.empty li button').first().scrollIntoViewIfNeeded()
  expect(await covered(page, '.empty li:first-child button')).toEqual([])
})
