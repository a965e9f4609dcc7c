// A depth is accepted while the needle is held where its image was taken, or not at all; the report says what ended the
// hold. The stage has no brake here, so that a hold lasts 10 s and not 3 min.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'

import { expect, type Page, test } from '@playwright/test'

import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'

const kHold_ms = 10_000

const folder = mkdtempSync(join(tmpdir(), 'biopsy-stage-'))
let robot: Robot
test.beforeAll(async () => {
  const calibrated = readFileSync(join(process.env.SOURCE!, 'sim/models/calibrated.toml'), 'utf8')
  const model = join(folder, 'without-brake.toml')
  writeFileSync(model, calibrated.replace(/^\[brake\]\n(?:.+\n)+/m, ''))
  expect(readFileSync(model, 'utf8').length).toBeLessThan(calibrated.length)
  robot = new Robot(['gap', '--model', model])
  await robot.start()
})
test.afterAll(async () => {
  await robot?.stop()
  rmSync(folder, { recursive: true, force: true })
})

// As another program, or a page that is late, would send it.
function acceptPastThePage(page: Page): Promise<{ done: boolean; what: string }> {
  return page.evaluate(() => {
    const link = window.tap.newest()
    return new Promise((resolve) => {
      link.addEventListener('message', (event) => {
        const message = JSON.parse(event.data)
        if (message.type === 'Answer' && message.id === 905) resolve(message)
      })
      link.send('{"type":"Judge","id":905,"stage":0,"judgement":"Accept"}')
    })
  })
}

for (const [how, leave, why] of [
  ['the hold has run out', async (operator: PageOperator) => {
    await expect(operator.mode()).not.toHaveAttribute('data-mode', 'Hold', { timeout: 2 * kHold_ms })
  }, 'held too long'],
  ['STOP', async (operator: PageOperator) => {
    await operator.page.keyboard.press('Escape')
    await operator.is('Trip')
  }, 'STOP was pressed'],
] as const)
  test(`after ${how} a depth is not accepted, and the report says so`, async ({ page }) => {
    test.setTimeout(240_000)
    const operator = new PageOperator(page, robot.url)
    await operator.ready()
    await operator.arm()
    await operator.insert()
    await expect(page.locator('[data-name=verdict]')).toHaveText('accept')
    await leave(operator)
    const accept = operator.button('Accept this depth')
    await expect(accept).toHaveAttribute('aria-disabled', 'true')
    await expect(page.locator('[data-name=why-not-accept]')).toHaveText(/no longer held|This run is over/)
    await accept.click({ force: true })
    const answer = await acceptPastThePage(page)
    expect(answer.done).toBe(false)
    expect(answer.what).not.toBe('')
    if (how !== 'STOP') await operator.click('Reject: retract, end')
    const report = page.getByRole('link', { name: /Not completed. Open the report/ })
    await expect(report).toBeVisible({ timeout: 30_000 })
    const text = await (await page.request.get(new URL((await report.getAttribute('href'))!, page.url()).href)).text()
    expect(text).toContain(why)
    expect(text).not.toMatch(/completed: the depth/i)
  })

test('back at the plan after an image that did not convince, the report of that run is there', async ({ page }) => {
  test.setTimeout(240_000)
  const operator = new PageOperator(page, robot.url)
  await operator.ready()
  await operator.arm()
  await operator.insert()
  await expect(page.locator('[data-name=verdict]')).toBeVisible()
  await operator.click('Adjust: retract, plan again')
  const report = page.getByRole('link', { name: 'Report of the last run' })
  await expect(report).toBeVisible({ timeout: 30_000 })
  await expect(operator.button('Confirm this plan')).toBeVisible()
  const text = await (await page.request.get(new URL((await report.getAttribute('href'))!, page.url()).href)).text()
  expect(text).toContain('adjusted by the operator')
})
