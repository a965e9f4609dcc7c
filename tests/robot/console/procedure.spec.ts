// A whole procedure in a browser, from the image to an accepted depth and its report.
import { mkdirSync, readdirSync, readFileSync } from 'node:fs'
import { join } from 'node:path'
import { gzipSync } from 'node:zlib'

import { type Browser, expect, type Page, test } from '@playwright/test'

import { note, round } from './support/figures'
import { distance, kActsMax, kEntry, kFurtherActsMax, kGapDepth_mm, PageOperator } from './support/page_operator'
import { expectAccessible } from './support/accessibility'
import { kClockSpeed, stretched } from './support/clock'
import { pause, Robot } from './support/robot'

const kBundleMax_kB = 500
const kReadyMax_s = 3

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

// Share of one processor core: of the page's own thread, and of the whole browser including software rendering.
async function load(page: Page, browser: Browser): Promise<{ page: number; browser: number }> {
  const thread = await page.context().newCDPSession(page)
  const whole = await browser.newBrowserCDPSession()
  await thread.send('Performance.enable')
  const measure = async () => {
    const { metrics } = await thread.send('Performance.getMetrics')
    const of = (name: string) => metrics.find((metric) => metric.name === name)!.value
    const { processInfo } = await whole.send('SystemInfo.getProcessInfo')
    return { at: of('Timestamp'), page: of('TaskDuration'), browser: processInfo.reduce((sum, one) => sum + one.cpuTime, 0) }
  }
  const from = await measure()
  await pause(5000) // a figure, not a state
  const to = await measure()
  const share = (name: 'page' | 'browser') => (100 * (to[name] - from[name])) / (to.at - from.at)
  return { page: round(share('page')), browser: round(share('browser')) }
}

test('the page is small', () => {
  const files = readdirSync('dist', { recursive: true, withFileTypes: true }).filter((file) => file.isFile())
  const bytes = files.map((file) => gzipSync(readFileSync(join(file.path, file.name))).length)
  const total = bytes.reduce((sum, one) => sum + one, 0) / 1000
  note({ bundle_gzipped_kB: round(total) })
  expect(total).toBeGreaterThan(10)
  expect(total).toBeLessThanOrEqual(kBundleMax_kB)
})

test('from the image to an accepted depth, further targets, and the report', async ({ page, browser, context }) => {
  test.setTimeout(stretched(300_000))
  const faults: string[] = []
  page.on('console', (message) => message.type() === 'error' && faults.push(message.text()))
  page.on('pageerror', (error) => faults.push(error.message))
  const operator = new PageOperator(page, robot.url)
  const shoot = async (name: string) => {
    if (!process.env.PICTURES) return
    mkdirSync(process.env.PICTURES, { recursive: true })
    await page.screenshot({ path: join(process.env.PICTURES, `console-${name}.png`) })
  }

  // Image: the sample opens with one click, and nothing else can be pressed but STOP.
  await operator.open()
  const ready_s = (await page.evaluate(() => performance.now() / 1000)) / kClockSpeed
  note({ page_ready_s: round(ready_s, 2) })
  expect(ready_s).toBeLessThanOrEqual(kReadyMax_s)
  await expect(page.getByText('SIMULATED').first()).toBeVisible()
  await expect(page.getByText('built-in sample case')).toBeVisible()
  await expect(page.locator(':is(main, .plan, .acts) button:not([aria-disabled=true])')).toHaveText([/^Open the sample/, 'STOP'])
  await shoot('1-image')
  await expectAccessible(page)
  await operator.openSeries()

  // Plan
  await operator.setPoints()
  expect(distance(await operator.mm('entry'), kEntry)).toBeLessThan(0.3)
  const depth = parseFloat((await page.locator('[data-name=planned-depth]').textContent())!)
  note({ planned_depth_error_mm: round(Math.abs(depth - kGapDepth_mm), 2) })
  expect(Math.abs(depth - kGapDepth_mm)).toBeLessThan(0.3)
  await shoot('2-plan')
  await expectAccessible(page)
  const busy = await load(page, browser)
  note({ page_cpu_percent: busy.page, browser_cpu_percent: busy.browser })

  // Check, arm, insert, confirm
  await operator.confirmPlan()
  await operator.is('Ready')
  await shoot('3-check')
  await operator.arm()
  await shoot('4-arm')
  await operator.insert(async () => {
    await expect(page.locator('[data-name=locked]')).toHaveText('needle locked')
    await shoot('5-insert')
  })
  await expect(page.locator('[data-name=verdict]')).toHaveText('accept', { timeout: stretched(30_000) })
  const error = parseFloat((await page.locator('[data-name=error]').textContent())!)
  expect(Math.abs(error)).toBeLessThan(0.3)
  await shoot('6-confirm')
  await operator.click('Accept this depth')
  await expect(page.locator('[aria-current=step]')).toContainText(/Accepted|The run is over/)
  note({ acts: operator.acts })
  expect(operator.acts).toBeLessThanOrEqual(kActsMax)

  // Further targets: the image is there again by itself, and one act renews the checks.
  const further = [await operator.furtherTarget(0.85), await operator.furtherTarget(0.85)]
  note({ acts_of_further_targets: further })
  for (const acts of further) expect(acts).toBeLessThanOrEqual(kFurtherActsMax)

  // The report, to read and on paper
  await operator.retractAccepted()
  await shoot('7-report')
  await expectAccessible(page)
  const opening = context.waitForEvent('page')
  await page.getByRole('link', { name: /Open the report/ }).click()
  const printed = await opening
  expect(await printed.evaluate(() => window.opener)).toBeNull() // a dialog there stops nothing here
  await expect(printed.locator('body')).toContainText(/simulated/i)
  await expect(printed.locator('body')).toContainText(/completed/i)
  await expectAccessible(printed, ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'])
  await printed.emulateMedia({ media: 'print' })
  await expect(printed.locator('.watermark')).toBeVisible()
  const pdf = (await printed.pdf({ preferCSSPageSize: true })).toString('latin1')
  expect(pdf.startsWith('%PDF-')).toBe(true)
  expect(pdf.match(/\/Type \/Page\b(?!s)/g)!.length).toBeGreaterThan(0)
  expect(faults).toEqual([])
})
