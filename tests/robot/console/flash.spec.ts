// An alarm that nobody acknowledges flashes for as long as it takes, and costs next to nothing. Here the browser puts its
// layers together without OpenGL, as where there is no graphics card: with OpenGL in software each change of the picture
// costs some 45 ms, however small it is.
import { expect, test } from '@playwright/test'

import config from './support/playwright.config'
import { browserLoad } from './support/browser_load'
import { note, round, spread } from './support/figures'
import { PageOperator } from './support/page_operator'
import { pause, Robot } from './support/robot'
import { kAlarm, kCold, kWarning } from './support/scenes'
import { freezePage } from './support/tap'

const launchOptions = config.use!.launchOptions!
test.use({ launchOptions: { ...launchOptions, args: [...launchOptions.args!, '--disable-gpu-compositing'] } })

const kSettle_ms = 700
const kMeasured_ms = 4000
const kPairs = 5 // flashing and acknowledged in turn, so that other work on the machine meets both; the median of the differences
const kMax_percent = 4 // of one core, more than the same page with the alarm acknowledged

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

for (const alarm of [kAlarm, kWarning])
  test(`a flashing ${alarm.severity} costs at most ${kMax_percent} % of a core`, async ({ page, browser }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const line = page.locator('.alarm')
    const show = (alarms: object[]) => freezePage(page, { mode: 'Safe', step: 'Check', alarms, disabled: kCold })
    const measure = async () => {
      await page.mouse.move(5, 5)
      await pause(kSettle_ms) // figures, not states
      return (await browserLoad(browser, kMeasured_ms)).all!
    }
    const differences: number[] = []
    for (let pair = 0; pair < kPairs; ++pair) {
      await show([])
      await expect(line).not.toHaveClass(new RegExp(alarm.severity))
      await show([alarm]) // a new one, which nobody has acknowledged
      await expect(line).toHaveClass(new RegExp(alarm.severity))
      await expect(line).not.toHaveClass(/acknowledged/)
      const flashing = await measure()
      await operator.button('Acknowledge').click()
      await expect(line).toHaveClass(/acknowledged/)
      differences.push(round(flashing - (await measure())))
    }
    note({ [`flashing_${alarm.severity}_cpu_percent`]: differences })
    expect(spread(differences).median).toBeLessThanOrEqual(kMax_percent)
  })
