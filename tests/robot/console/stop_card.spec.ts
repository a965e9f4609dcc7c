// After a stop the page says what happened, where the needle is as measured, and the steps back, with one lit control.
import { expect, test } from '@playwright/test'

import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { kAlarm, kScenes, kStanding, kStopped, no, showScene } from './support/scenes'
import { freezePage, lastEvent } from './support/tap'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

const kTrip = { mode: 'Trip', step: 'Confirm', alarms: [kAlarm], disabled: kStopped }
const kNone = { type: 'none' }

for (const [depth, says] of [[0.45, 'The needle is at 0.45 mm: not back.'], [-0.32, 'at -0.32 mm: not back'], [0.06, 'The needle is back: 0.06 mm measured.'], [-0.001, 'The needle is back: 0.00 mm measured.']] as const)
  test(`a trip with the needle at ${depth} mm`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    await showScene(operator, { name: 'trip', state: { ...kTrip, depth } }, kNone)
    const card = page.locator('[data-name=stop-card]')
    await expect(card).toContainText('STOP was pressed.')
    await expect(card.locator('[data-name=tip-now]')).toHaveText(says === 'at -0.32 mm: not back' ? `The needle is ${says}.` : says)
    await expect(page.locator('[data-lit=true]')).toHaveCount(1)
    await expect(page.locator('[data-lit=true]')).toHaveText('Reset')
    await expect(card.locator('[aria-current=step]')).toHaveText('Press Reset.')
    // Nothing else on the page says more than was measured.
    const text = (await page.locator('.page').innerText()).replaceAll(says, '')
    if (Math.abs(depth) > 0.1) expect(text).not.toMatch(/needle (is|went) back/i)
    expect(text).not.toContain('-0.00')
  })

test('without measurement nothing is said of where the needle is', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await showScene(operator, { name: 'trip', state: { ...kTrip, depth: 0, measured: false } }, kNone)
  await expect(page.locator('[data-name=tip-now]').first()).toHaveText('It is not known where the needle is.')
})

test('where the lasers do not tell, the page says that it is not known where the needle is', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await showScene(operator, { name: 'trip', state: { ...kTrip, depth: 0, depth_known: false } }, kNone)
  await expect(page.locator('[data-name=tip-now]').first()).toHaveText('It is not known where the needle is.')
  await expect(page.locator('b[data-name=Depth]')).toHaveText('not known')
  await expect(page.locator('[data-name=tip]')).toHaveCount(0)
})

test('the emergency stop is shown in every state while it is there', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  for (const { state } of kScenes)
    for (const estop of [true, false]) {
      await showScene(operator, { name: 'estop', state: { ...state, estop } }, kNone)
      await expect(page.locator('[data-name=estop]')).toHaveCount(estop ? 1 : 0)
    }
})

test('a page that only watches says where Reset is pressed', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await showScene(operator, { name: 'trip', state: { ...kTrip, depth: 0, controller: false } }, kNone)
  await expect(page.locator('[data-name=stop-card] li').last()).toHaveText('Press Reset on the page that controls the robot.')
  await expect(page.locator('[data-lit=true]')).toHaveCount(0)
})

test('where Reset needs the plan and the checks, they are the lit control, one after the other', async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 }) // where both do not fit below the card
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const planned = await lastEvent(page, 'Planned')
  const disabled = no({ ...kStopped, reset: 'Confirm the plan and tick the three checks first.', plan: '' })
  const lit = page.locator('[data-lit=true]')
  await freezePage(page, { ...kTrip, step: 'Plan', disabled, ticks: [false, false, false] }, [{ ...planned, confirmed: false }])
  await expect(lit).toHaveCount(1)
  await expect(lit).toHaveText('Confirm this plan')
  await expect(lit).toBeInViewport({ ratio: 1 })
  await freezePage(page, { ...kTrip, step: 'Check', disabled, ticks: [true, false, false] }, [{ ...planned, confirmed: true }])
  await expect(lit).toHaveCount(1)
  await expect(lit.getByRole('checkbox')).toHaveCount(3)
  await expect(lit).toBeInViewport({ ratio: 1 })
  await expect(page.locator('[data-name=stop-card] li')).toHaveText(['Look at the needle and at the patient.', 'Tick the three checks.', 'Press Reset.'])
})

test('STOP before arming stands: shown, kept, and taken back by Reset', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.ready()
  await operator.button('STOP').hover()
  await page.mouse.down()
  await page.mouse.up()
  await expect(operator.alarm()).toContainText('E-122')
  await expect(page.locator('[data-name=stop-card]')).toContainText('STOP was pressed.')
  await expect(page.locator('[data-lit=true]')).toHaveText('Reset')
  await expect(operator.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await page.reload() // it is the robot's, not the page's
  await expect(operator.alarm()).toContainText('E-122')
  await operator.button('Reset').click()
  await expect(page.locator('[data-name=stop-card]')).toHaveCount(0)
  await operator.is('Ready')
})

// The supervisor refuses it too: operator_session_test.
test('a depth cannot be accepted after the hold or after a trip', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const held = kScenes.find(({ name }) => name === 'confirm')!
  const checked = { type: 'Checked', stage: 0, verdict: 'accept', reason: '', tip_found: true, planned: 2.5, found: 2.5, sigma: 0.07, error: -0.001, lateral: 0.2, lateral_sigma: 0.1, angle: 1, angle_sigma: 2, confidence: 0.9, before_png: '', after_png: '', width: 64, height: 64, per_pixel: 0.5, entry_px: [1, 1], axis: [1, 0] }
  await showScene(operator, held, checked)
  await expect(page.locator('[data-name=error]')).toHaveText('0.00 mm')
  await expect(page.locator('[data-name=lateral]')).toHaveText('0.20 ± 0.10 mm')
  await expect(page.locator('[data-name=angle]')).toHaveText('1.0 ± 2.0 deg')
  await expect(operator.button('Accept this depth')).toHaveAttribute('aria-disabled', 'false')
  const why = 'The needle is no longer held where this image shows it: hold time exceeded.'
  await showScene(operator, { ...held, state: { ...held.state, mode: 'Trip', alarms: [kStanding], disabled: no({ ...kStopped, accept: why }) } }, checked)
  await expect(operator.button('Accept this depth')).toHaveAttribute('aria-disabled', 'true')
  await expect(page.locator('[data-name=why-not-accept]')).toHaveText(why)
})
