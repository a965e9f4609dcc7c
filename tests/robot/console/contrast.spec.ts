// Every control in every state of the page, at rest, under the pointer, held down and focused, in grey and in dark: its
// words stand out from what is behind them.
import { expect, type Page, test } from '@playwright/test'

import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { checkedOf, kScenes, showScene } from './support/scenes'
import type { Message } from './support/tap'

const kContrast = 4.5

const robot = new Robot()
let checked: Message
test.beforeAll(async () => {
  await robot.start()
  checked = checkedOf(robot.folder)
})
test.afterAll(() => robot.stop())

// Contrast of WCAG 2 between the words of button `n` and the first opaque ground behind them.
async function contrastOf(page: Page, n: number): Promise<{ name: string; contrast: number }> {
  return page.evaluate((index) => {
    const button = document.querySelectorAll<HTMLElement>('button, a.button')[index]!
    const rgb = (text: string) => text.match(/[\d.]+/g)!.map(Number)
    const light = (color: number[]) => {
      const [r, g, b] = color.slice(0, 3).map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4))
      return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!
    }
    let ground = [0, 0, 0, 0]
    for (let behind: HTMLElement | null = button; behind && (ground[3] ?? 1) === 0; behind = behind.parentElement)
      ground = rgb(getComputedStyle(behind).backgroundColor)
    const [a, b] = [light(rgb(getComputedStyle(button).color)), light(ground)]
    return { name: button.textContent!, contrast: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) }
  }, n)
}

async function expectReadable(page: Page, where: string): Promise<void> {
  const buttons = page.locator('button, a.button')
  const poor: string[] = []
  const look = async (n: number, how: string) => {
    const { name, contrast } = await contrastOf(page, n)
    if (contrast < kContrast) poor.push(`${where}, ${how}: ${name} ${contrast.toFixed(1)}`)
  }
  // One that changes the page is not held down: what it changes is a state of its own.
  const changes = /Dark|Alarms|Acknowledge|sound|Open|Print|Close|Other series|Ruler|axial|coronal|sagittal|along the needle|3-D|side by side|slider|difference|^\?/
  for (let n = 0; n < (await buttons.count()); ++n) {
    await look(n, 'at rest')
    const box = await buttons.nth(n).boundingBox()
    if (!box) continue
    await buttons.nth(n).scrollIntoViewIfNeeded()
    const at = (await buttons.nth(n).boundingBox())!
    await page.mouse.move(at.x + at.width / 2, at.y + at.height / 2)
    await look(n, 'hover')
    if (changes.test((await buttons.nth(n).textContent())!)) continue
    await page.mouse.down()
    await page.waitForTimeout(30) // the page draws what is pressed
    await look(n, 'pressed')
    await page.mouse.up()
    await page.mouse.move(2, 2)
  }
  expect(poor).toEqual([])
}

for (const theme of ['grey', 'dark'])
  test(`every control is readable at rest, hovered and pressed: ${theme}`, async ({ page }) => {
    test.setTimeout(240_000)
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    if (theme === 'dark') await operator.button('Dark').click()
    for (const scene of kScenes) {
      await showScene(operator, scene, checked)
      await expectReadable(page, scene.name)
    }
  })

test('a held button is readable with the pointer on it', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await showScene(operator, kScenes.find(({ name }) => name === 'insert')!, checked)
  await operator.insertButton().hover()
  await page.mouse.down()
  await expect(operator.insertButton()).toHaveAttribute('aria-pressed', 'true')
  const all = await page.locator('button, a.button').allTextContents()
  expect((await contrastOf(page, all.indexOf('Hold to insert'))).contrast).toBeGreaterThanOrEqual(kContrast)
  await page.mouse.up()
})

// Of the plots' lines and their ground, by the pixels that are drawn.
test('the plots are as dark as the room, and their lines stand out', async ({ page }) => {
  await new PageOperator(page, robot.url).planned()
  for (const theme of ['grey', 'dark']) {
    if (theme === 'dark') await page.getByRole('button', { name: 'Dark' }).click()
    await expect(page.locator('.plot canvas')).toHaveCount(2)
    const plots = await page.locator('.plot').evaluateAll((all) =>
      all.map((plot) => {
        const light = (r: number, g: number, b: number) => (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255
        const [r, g, b] = getComputedStyle(plot).backgroundColor.match(/[\d.]+/g)!.map(Number)
        const canvas = plot.querySelector('canvas')!
        const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height)
        const lines: number[] = []
        for (let n = 0; n < data.length; n += 4) if (data[n + 3]! > 250) lines.push(light(data[n]!, data[n + 1]!, data[n + 2]!))
        return { ground: light(r!, g!, b!), darkest: lines.reduce((a, b) => Math.min(a, b)), brightest: lines.reduce((a, b) => Math.max(a, b)) }
      }),
    )
    for (const { ground, darkest, brightest } of plots) {
      if (theme === 'dark') expect(ground).toBeLessThan(0.15)
      expect(theme === 'dark' ? brightest - ground : ground - darkest).toBeGreaterThan(0.6)
    }
  }
})
