// No finding of axe in any state of the page, with every control under the pointer and every control held down: in grey on
// the whole screen, in dark at 200 % zoom, since no rule depends on both. At rest on the whole screen: states.spec.ts;
// colours: contrast.spec.ts.
import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { checkedOf, kScenes, showScene } from './support/scenes'
import type { Message } from './support/tap'

const robot = new Robot()
let checked: Message
test.beforeAll(async () => {
  await robot.start()
  checked = checkedOf(robot.folder)
})
test.afterAll(() => robot.stop())

// Every control at once, as the browser itself would have one of them. The pointer cannot be on all.
async function force(page: Page, states: string[]): Promise<void> {
  const devtools = await page.context().newCDPSession(page)
  await devtools.send('DOM.enable')
  await devtools.send('CSS.enable')
  const { root } = await devtools.send('DOM.getDocument')
  const { nodeIds } = await devtools.send('DOM.querySelectorAll', { nodeId: root.nodeId, selector: 'button, a, input, label' })
  expect(nodeIds.length).toBeGreaterThan(5)
  for (const nodeId of nodeIds) await devtools.send('CSS.forcePseudoState', { nodeId, forcedPseudoClasses: states })
  const forced = await page.evaluate(() => document.querySelectorAll('button:hover').length)
  if (states.length > 0) expect(forced).toBeGreaterThan(3)
  await expectAccessible(page)
  await devtools.detach() // forces nothing any more
}

for (const [zoom, width, height, theme] of [[1, 1920, 1080, 'grey'], [2, 960, 540, 'dark']] as const)
  test.describe(`at ${100 * zoom} %, ${theme}`, () => {
    test.use({ viewport: { width, height }, deviceScaleFactor: zoom })
    test('no finding of axe with every control hovered, and pressed', async ({ page }) => {
      test.setTimeout(240_000)
      const operator = new PageOperator(page, robot.url)
      await operator.planned()
      if (theme === 'dark') await operator.button('Dark').click()
      await page.mouse.move(2, 2)
      for (const scene of kScenes)
        await test.step(scene.name, async () => {
          await showScene(operator, scene, checked)
          if (zoom > 1) await expectAccessible(page)
          await force(page, ['hover'])
          await force(page, ['hover', 'active'])
        })
    })
  })
