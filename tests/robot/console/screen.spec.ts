// On small screens and at 200 % zoom: every control of a decision is in view and uncovered in each state, the page does
// not scroll, and nothing lies over the alarms.
import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { checkedOf, kAlarm, kScenes, kSizes, kWarning, showScene } from './support/scenes'
import { freezePage, lastEvent, type Message } from './support/tap'

const robot = new Robot()
let checked: Message
test.beforeAll(async () => {
  await robot.start()
  checked = checkedOf(robot.folder)
})
test.afterAll(() => robot.stop())

// What lies at the middle and near the corners of each of these is it or part of it.
async function covered(page: Page, selector: string, all = true): Promise<string[]> {
  return page.evaluate(([wanted, hidden]) => {
    const out: string[] = []
    for (const one of document.querySelectorAll<HTMLElement>(wanted)) {
      if (!hidden && !one.checkVisibility()) continue
      const { left, top, right, bottom } = one.getBoundingClientRect()
      const name = one.textContent!.slice(0, 30)
      if (right - left < 40 || left < 0 || top < 0 || right > innerWidth || bottom > innerHeight) out.push(`${name}: out of view`)
      for (const [x, y] of [[(left + right) / 2, (top + bottom) / 2], [left + 8, top + 8], [right - 8, bottom - 8]] as const) {
        const there = document.elementFromPoint(x, y)
        if (!there || !(one === there || one.contains(there))) out.push(`${name}: under ${there?.className || there?.tagName}`)
      }
    }
    return out
  }, [selector, all] as const)
}

for (const [width, height] of kSizes)
  test(`decisions and alarms are in view at ${width} x ${height}`, async ({ page }) => {
    test.setTimeout(200_000)
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const decisions = '.acts .act button, .stopping button, .decide button, .alarm, .alarm > button, .top [data-name=mode], .top .who, [data-name=Depth], .image:not(:has(.confirm, .loss)) .readings'
    for (const scene of kScenes) {
      await showScene(operator, scene, checked)
      await page.waitForTimeout(100)
      expect(await covered(page, decisions), scene.name).toEqual([])
      const scrolls = await page.evaluate(() => [document.documentElement.scrollHeight > innerHeight, document.documentElement.scrollWidth > innerWidth])
      expect(scrolls, scene.name).toEqual([false, false])
      if (['confirm', 'trip', 'check'].includes(scene.name)) await expectAccessible(page)
    }
  })

// 1500 is between the laptop and the wide screen; the needle's lock takes the place beside the name.
for (const [width, height] of [...kSizes, [1500, 940]] as const)
  test(`the patient's name and ID are whole while the needle is locked at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    await showScene(operator, kScenes.find(({ name }) => name === 'confirm')!, checked)
    await freezePage(page, { mode: 'Hold', step: 'Confirm', locked: true, hold_left: 170 })
    await expect(page.locator('[data-name=locked]')).toBeVisible()
    await expect(page.locator('[data-name=short-scan]')).toHaveText('SIMULATED: an image takes 2 s here; a scanner takes 20 to 60 s.')
    const [who, bar] = await Promise.all(['.top .who', '.top'].map((one) => page.locator(one).evaluate((element) => {
      const { top, bottom } = element.getBoundingClientRect()
      return { top, bottom, width: element.clientWidth, needs: element.scrollWidth }
    })))
    expect(who!.top).toBeGreaterThanOrEqual(bar!.top)
    expect(who!.bottom).toBeLessThanOrEqual(bar!.bottom)
    expect(who!.needs).toBeLessThanOrEqual(who!.width)
  })

// Whoever accepts a depth sees the picture, the error and how long the needle is held, without scrolling.
for (const [width, height] of kSizes)
  test(`a depth is not accepted unseen at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    await showScene(operator, kScenes.find(({ name }) => name === 'confirm')!, checked)
    await expect(page.locator('[data-name=error]')).toHaveText('0.03 mm')
    expect(await covered(page, '.decide button, .confirm svg, [data-name=error], [data-name=hold-left]')).toEqual([])
  })

const kTools = ['Set entry', 'Set target', 'Undo', 'Redo', 'Other series', 'axial', 'coronal', 'sagittal', 'along the needle', '3-D', 'Zoom out', 'Zoom in', 'Fit view', 'Ruler', 'List of keys']

// The last: a window of a browser on the smaller laptop.
for (const [width, height] of [...kSizes, [1280, 600]] as const)
  test(`every tool of the viewer is reached without scrolling at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const welcome = await lastEvent(page, 'Welcome')
    await freezePage(page, { mode: 'Safe', step: 'Plan', alarms: [kWarning] }, [{ ...welcome, series: [welcome.series[0], { ...welcome.series[0], series_uid: '1.2' }] } as Message])
    await expect(operator.button('Other series')).toBeAttached()
    const sections = page.locator('.sections button')
    const reached = new Set<string>()
    const look = async () => {
      const scrolls = await page.locator('.picking').evaluate((bar) => [bar.scrollWidth - bar.clientWidth, bar.scrollHeight - bar.clientHeight])
      expect(scrolls).toEqual([0, 0])
      expect(await covered(page, '.picking button, .picking input', false)).toEqual([])
      for (const tool of kTools) if (await page.getByRole('button', { name: tool, exact: true }).isVisible()) reached.add(tool)
      for (const slider of [/slice/, /tissues/]) if (await page.getByRole('slider', { name: slider }).isVisible()) reached.add(String(slider))
      expect((await page.locator('.slices').boundingBox())!.height).toBeGreaterThan(140)
    }
    if (!(await sections.first().isVisible())) await look()
    else
      for (const section of await sections.all()) {
        await section.click()
        await look()
        await expectAccessible(page)
      }
    expect([...reached].sort()).toEqual([...kTools, '/slice/', '/tissues/'].sort())
  })

// Letters tell the sides of the patient: nothing is written over them.
for (const [width, height] of kSizes)
  test(`names, letters, scale bars and legend keep apart at ${width} x ${height}`, async ({ page }) => {
    test.setTimeout(200_000)
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const canvas = page.locator('canvas[tabindex]')
    const press = async (...keys: string[]) => {
      await canvas.focus()
      for (const key of keys) await page.keyboard.press(key)
      await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))))
    }
    const meet = () =>
      page.evaluate(() => {
        const out: string[] = []
        const legend = document.querySelector('.tissues')
        for (const tile of document.querySelectorAll<SVGGElement>('[data-tile]')) {
          const all = [...tile.querySelectorAll('.letter, .plane, .scale path, .scale text, .ruler text'), ...(legend ? [legend] : [])]
          const boxes = all.map((one) => ({ one, box: one.getBoundingClientRect() })).filter(({ box }) => box.width > 0)
          boxes.forEach(({ one: a, box: p }, n) =>
            boxes.slice(n + 1).forEach(({ one: b, box: q }) => {
              const part = a.parentElement === b.parentElement && a.closest('.scale')
              const across = Math.min(p.right, q.right) - Math.max(p.left, q.left)
              const down = Math.min(p.bottom - 4, q.bottom - 4) - Math.max(p.top + 4, q.top + 4) // of a line, the air
              if (!part && across > 0 && down > 0) out.push(`${tile.dataset.tile}: ${a.textContent || 'bar'} on ${b.textContent || 'bar'}`)
            }))
        }
        return out
      })
    await press('m')
    const large = (await page.locator('[data-tile^=large] rect').first().boundingBox())!
    await page.mouse.move(large.x + 20, large.y + 20)
    await page.mouse.down()
    await page.mouse.move(large.x + large.width - 14, large.y + large.height / 2 + 10, { steps: 3 }) // to the letter on the right
    await page.mouse.up()
    await press('m')
    for (const view of ['1', '2', '3', '4', '5']) {
      await press(view)
      expect(await meet(), `view ${view}`).toEqual([])
      await press(...Array(13).fill('+'))
      expect(await meet(), `view ${view}, zoomed`).toEqual([])
      await press('0')
    }
    await press('1', 'p')
    if (await operator.button('slices').isVisible()) await operator.button('slices').click()
    await expect(page.locator('.tissues')).toBeVisible()
    expect(await meet(), 'with the tissues').toEqual([])
    await press('p')
  })

// The newest of the 30 s is at their right end.
test('the plots show now at every size', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  for (const [width, height] of [...kSizes, [1440, 900], [1600, 900]] as const) {
    await page.setViewportSize({ width, height })
    for (const plot of await page.locator('.plot').all()) {
      const ends = () => plot.evaluate((one) => {
        const [whole, drawn] = [one.getBoundingClientRect(), one.querySelector('.u-over')!.getBoundingClientRect()]
        return { beyond: drawn.right - whole.right, below: one.scrollHeight - one.clientHeight, wide: drawn.width }
      })
      await expect.poll(async () => (await ends()).beyond, `${width} x ${height}`).toBeLessThanOrEqual(0)
      expect((await ends()).below, `${width} x ${height}`).toBeLessThanOrEqual(0)
      expect((await ends()).wide).toBeGreaterThan(200)
    }
  }
})

// Smaller laptops at 200 %: the page scrolls, between alarms and buttons that stay; nothing has to be scrolled sideways.
for (const [width, height] of [[683, 384], [640, 360]] as const)
  test(`a page that scrolls keeps alarms and STOP in view at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    for (const name of ['hold', 'confirm', 'trip']) {
      await showScene(operator, kScenes.find((scene) => scene.name === name)!, checked)
      for (const part of ['.plan h2', name === 'confirm' ? '.decide button >> nth=0' : '.picking button >> nth=0']) {
        const control = page.locator(part).first()
        await control.evaluate((one) => one.scrollIntoView({ block: 'center' }))
        expect(await covered(page, '.alarm, .stopping button, .act button'), `${name}, ${part}`).toEqual([])
        await control.click({ trial: true })
      }
      expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0)
    }
  })

// Numbers cut off, or to be found by scrolling sideways, are not read.
for (const [width, height] of kSizes)
  test(`the list of alarms is not cut at ${width} x ${height}`, async ({ page }) => {
    await page.setViewportSize({ width, height })
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const at = Date.now()
    const rows = [kAlarm, kWarning].map((alarm, n) => ({ number: n + 1, alarm, from_ms: at - 9000, to_ms: at - 2000, acknowledged_ms: at - 5000 }))
    await freezePage(page, { mode: 'Safe', step: 'Plan' }, [{ type: 'AlarmHistory', rows }])
    await operator.button(/^Alarms: /).click()
    const list = page.locator('.alarm-list')
    await expect(list.locator('tbody tr')).toHaveCount(2)
    expect(await list.evaluate((one) => one.scrollWidth - one.clientWidth)).toBe(0)
    await expect(list).toContainText(kAlarm.robot_did)
    await expectAccessible(page)
  })

test('forty series leave the alarms uncovered and can all be reached', async ({ page }) => {
  await page.setViewportSize({ width: 1366, height: 768 })
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  const welcome = await lastEvent(page, 'Welcome')
  const series = Array.from({ length: 40 }, (_, n) => ({ ...welcome.series[0], series_uid: `1.2.${n}`, description: `series ${n}` }))
  await page.evaluate((message) => window.tap.inject(message as never), { ...welcome, session: 'another', series } as Message)
  await expect(page.locator('.empty li')).toHaveCount(40)
  expect(await covered(page, '.alarm, .stopping button')).toEqual([])
  await page.locator('.empty li button').last().scrollIntoViewIfNeeded()
  expect(await covered(page, '.alarm, .stopping button, .empty li:last-child button')).toEqual([])
  await page.locator('.empty li button').first().scrollIntoViewIfNeeded()
  expect(await covered(page, '.empty li:first-child button')).toEqual([])
})
