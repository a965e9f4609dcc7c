// A whole procedure in a browser, from the image to an accepted depth and its report.
import { mkdirSync, writeFileSync } from 'node:fs'
import { join } from 'node:path'

import AxeBuilder from '@axe-core/playwright'
import { expect, test } from '@playwright/test'

import { Console, distance, kEntry, kGapDepth_mm, Robot } from './robot'

const robot = new Robot(150)
const pictures = process.env.PICTURES
const figures: Record<string, number> = {}

test.beforeAll(() => robot.start())
test.afterAll(async () => {
  if (process.env.FIGURES) writeFileSync(process.env.FIGURES, JSON.stringify(figures, null, 2))
  await robot.stop()
})

test('from the image to an accepted depth in at most twelve acts', async ({ page }) => {
  const faults: string[] = []
  page.on('console', (message) => message.type() === 'error' && faults.push(message.text()))
  page.on('pageerror', (error) => faults.push(error.message))
  const person = new Console(page, robot.url)
  const shoot = async (name: string) => {
    if (!pictures) return
    mkdirSync(pictures, { recursive: true })
    await page.screenshot({ path: join(pictures, `console-${name}.png`) })
  }
  // Takes seconds: not while a hold runs out.
  const everybodyCanReadIt = async () => {
    const found = await new AxeBuilder({ page }).analyze()
    expect(found.violations.map((v) => `${v.id} ${v.nodes[0]?.target} ${v.nodes[0]?.failureSummary}`)).toEqual([])
  }

  const opened = Date.now()
  await person.open()
  figures.page_ready_s = (Date.now() - opened) / 1000
  await expect(page.getByText('SIMULATED').first()).toBeVisible()
  await shoot('1-image')
  await everybodyCanReadIt()
  const clicked = Date.now()
  await person.openSeries()
  figures.image_ready_s = (Date.now() - clicked) / 1000
  await person.setPoints()
  const entry = await person.mm('entry')
  expect(distance(entry, kEntry)).toBeLessThan(0.3)
  const depth = parseFloat((await page.locator('[data-name=planned-depth]').textContent())!)
  figures.planned_depth_error_mm = Math.abs(depth - kGapDepth_mm)
  expect(figures.planned_depth_error_mm).toBeLessThan(0.3)
  await shoot('2-plan')
  await everybodyCanReadIt()
  await person.confirmPlan()
  await person.is('Ready')
  await shoot('3-check')
  await everybodyCanReadIt()
  await person.arm()
  await shoot('4-arm')
  await person.insert()
  await shoot('5-insert')
  await expect(page.locator('[data-name=verdict]')).toHaveText('accept', { timeout: 30_000 })
  await shoot('6-confirm')
  await person.click('Accept this depth')
  await expect(page.locator('[aria-current=step]')).toContainText('Accepted')
  figures.acts = person.acts
  expect(person.acts).toBeLessThanOrEqual(12)
  if (await person.mode().getAttribute('data-mode') === 'Hold') await person.button('Retract').click()
  const link = page.getByRole('link', { name: /Accepted. Open the report/ })
  await expect(link).toBeVisible({ timeout: 30_000 })
  const report = await page.context().newPage()
  await report.goto(new URL((await link.getAttribute('href'))!, robot.url).href)
  await expect(report.locator('body')).toContainText(/simulated/i)
  await expect(report.locator('body')).toContainText(/completed/i)
  await shoot('7-report')
  await everybodyCanReadIt()
  expect(faults).toEqual([])
})
