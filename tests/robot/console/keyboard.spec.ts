// A whole procedure without a mouse: from the image to an accepted depth, to that of a further target, and retracted.
import { expect, type Page, test } from '@playwright/test'

import { note } from './support/figures'
import { KeyboardOperator } from './support/keyboard_operator'
import { distance, kActsMax, kEntry, kFurtherActsMax, kGapDepth_mm } from './support/page_operator'
import { Robot } from './support/robot'

const robot = new Robot()
test.describe.configure({ mode: 'serial' })
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

// No mouse at all: what the page gets of one is counted.
const countMouse = (page: Page) =>
  page.addInitScript(() => {
    const counted = window as unknown as { mouse: number }
    counted.mouse = 0
    for (const name of ['pointerdown', 'pointermove', 'wheel']) addEventListener(name, () => ++counted.mouse, true)
  })

test('from the image to an accepted depth, and of a further target, by keyboard alone', async ({ page }) => {
  test.setTimeout(400_000)
  await countMouse(page)
  const operator = new KeyboardOperator(page, robot.url)
  await operator.open()
  await operator.openSeries()
  await operator.clickAt('proposed-entry')
  await operator.press('e')
  ++operator.acts
  await expect(page.locator('dd[data-name=entry]')).not.toHaveText('not set')
  await operator.clickAt('proposed-target')
  await operator.setTarget()
  await expect(page.locator('[data-name=planned-depth]')).toBeVisible()
  expect(distance(await operator.mm('entry'), kEntry)).toBeLessThan(0.3)
  const depth = parseFloat((await page.locator('[data-name=planned-depth]').textContent())!)
  note({ keyboard_depth_error_mm: Math.abs(depth - kGapDepth_mm) })
  expect(Math.abs(depth - kGapDepth_mm)).toBeLessThan(0.3)
  await operator.confirmPlan()
  await operator.recover()
  await operator.arm()
  await operator.insert()
  await expect(page.locator('[data-name=verdict]')).toHaveText('accept')
  await operator.click('Accept this depth')
  await expect(page.locator('[aria-current=step]')).toContainText(/Accepted|The run is over/)
  note({ keyboard_keys: operator.keys, keyboard_acts: operator.acts })
  expect(operator.acts).toBeLessThanOrEqual(kActsMax)

  const further = await operator.furtherTarget(0.9)
  note({ keyboard_acts_of_a_further_target: further })
  expect(further).toBeLessThanOrEqual(kFurtherActsMax)
  await operator.retractAccepted()
  expect(await page.evaluate(() => (window as unknown as { mouse: number }).mouse)).toBe(0)
  // STOP, from wherever the focus is.
  await operator.press('Escape')
  await expect(operator.alarm()).toContainText('STOP was pressed')
})
