// Screenshot and accessibility of every state of the page. Image, plan and page are real; the robot's state is given
// here. The baselines are those of Debian's Chromium with fonts-dejavu-core; renew them with `./dev browser states
// --update-snapshots=all`.
import { expect, type Page, test } from '@playwright/test'

import config from './support/playwright.config'
import { PageOperator } from './support/page_operator'
import { expectAccessible } from './support/accessibility'
import { Robot } from './support/robot'
import { checkedOf, kCold, kScenes, no, showScene } from './support/scenes'
import { lastEvent, type Message, freezePage } from './support/tap'

// A part of a tile that is drawn again has other edges than the whole of it: by a few pixels, as the moment has it.
const launchOptions = config.use!.launchOptions!
test.use({ launchOptions: { ...launchOptions, args: [...launchOptions.args!, '--disable-partial-raster'] } })

const robot = new Robot()
let checked: Message
test.describe.configure({ mode: 'serial' })
test.beforeAll(async () => {
  await robot.start()
  checked = checkedOf(robot.folder)
})
test.afterAll(() => robot.stop())

// The age of the last message is masked: it depends on the machine.
async function expectBaseline(page: Page, name: string): Promise<void> {
  await expect(page.locator('[data-name=Link]')).toHaveText('0 ms')
  await page.evaluate(() => {
    const sheet = new CSSStyleSheet()
    sheet.replaceSync('.alarm::before { opacity: 1 !important }') // not as the moment of a flashing border has it
    document.adoptedStyleSheets = [sheet]
  })
  await expect(page).toHaveScreenshot(`${name}.png`, { mask: [page.locator('[data-name=Link]')], timeout: 30_000 })
}

test('Image: the page before anything is open', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await freezePage(page, { mode: 'Safe', step: 'Image', disabled: no({ ...kCold, arm: 'Confirm the plan first.' }) })
  await expectBaseline(page, 'image')
  await expectAccessible(page)
})

test('Plan: before and after the points are set', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await operator.openSeries()
  await expectAccessible(page)
  await operator.setPoints()
  await freezePage(page, { mode: 'Safe', step: 'Plan', disabled: no({ ...kCold, arm: 'Confirm the plan first.', plan: '' }) })
  await expectBaseline(page, 'plan')
  await expectAccessible(page)
})

for (const scene of kScenes)
  test(`${scene.name}: ${JSON.stringify(scene.state.mode as string)}`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    if (scene.kept) await operator.reopen() // where the points were not set just now: the crosshair as at first
    await showScene(operator, scene, checked)
    // A baseline is of the given depth: a tip a hundredth of a millimetre beside it is a dashed ring with other pixels.
    if (scene.kept && scene.state.depth) {
      const [tip, entry] = [await operator.mm('tip'), await operator.mm('entry')]
      expect(Math.hypot(...tip.map((value, axis) => value - entry[axis]!))).toBeCloseTo(scene.state.depth as number, 2)
    }
    if (scene.kept) await expectBaseline(page, scene.name)
    await expectAccessible(page)
  })

test('a plan that is refused says why and what to do', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const refused = { refusal: 'the target lies behind the longest needle', remedy: 'choose a nearer target', stages: [], layers: [] }
  await freezePage(page, { mode: 'Safe', step: 'Plan' }, [{ ...(await lastEvent(page, 'Planned')), ...refused }])
  await expect(page.locator('[data-name=refusal]')).toContainText('No plan: the target lies behind the longest needle')
  await expectAccessible(page)
})
