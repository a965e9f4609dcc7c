// For SOAK_MINUTES the page shows a ready robot: its memory does not grow, and STOP works afterwards.
import { expect, test } from '@playwright/test'

import { note, round } from './support/figures'
import { meter } from './support/memory'
import { PageOperator } from './support/page_operator'
import { pause, Robot } from './support/robot'

const kMinutes = Number(process.env.SOAK_MINUTES)
const kWarm_share = 0.25 // until then buffers fill: 30 s of plots
const kGrowthMax_MB = 5

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

test('memory of page and console does not grow', async ({ page }) => {
  test.setTimeout((kMinutes + 5) * 60_000)
  const operator = new PageOperator(page, robot.url)
  await operator.ready()
  const measure = await meter(page, robot.pid('biopsy-console'))
  await pause(kMinutes * 60_000 * kWarm_share)
  const from = await measure()
  await pause(kMinutes * 60_000 * (1 - kWarm_share))
  const to = await measure()
  note({
    soak_minutes: kMinutes,
    soak_page_heap_MB: [round(from.heap_MB), round(to.heap_MB)],
    soak_page_objects: [from.objects, to.objects],
    soak_page_nodes: [from.nodes, to.nodes],
    soak_console_resident_MB: [round(from.server_MB), round(to.server_MB)],
  })
  expect(to.heap_MB - from.heap_MB).toBeLessThan(kGrowthMax_MB)
  expect(to.server_MB - from.server_MB).toBeLessThan(kGrowthMax_MB)
  expect(to.nodes - from.nodes).toBeLessThan(200)
  await expect(operator.mode()).not.toContainText('NO LINK')
  await operator.button('STOP').hover()
  await page.mouse.down()
  await operator.is('Trip')
})
