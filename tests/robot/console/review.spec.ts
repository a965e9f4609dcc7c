// The review page over runs that `dry-run` makes here: every figure that it shows is compared with the rows of run.csv
// and with report.json as they lie on the disk. No robot runs.
import { type ChildProcess, execFileSync, spawn, spawnSync } from 'node:child_process'
import { mkdtempSync, readdirSync, readFileSync, readlinkSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { dirname, join } from 'node:path'

import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { kProgram } from './support/robot'

const kConsole = join(dirname(kProgram), 'biopsy-console')

// run.csv, read by its header.
class Table {
  private rows: string[][]
  private names: string[]
  constructor(folder: string) {
    const [header, ...rows] = readFileSync(join(folder, 'run.csv'), 'utf8').trim().split('\n')
    this.names = header!.split(',')
    this.rows = rows.map((row) => row.split(','))
  }
  get end_s(): number {
    return Number(this.rows.at(-1)![0])
  }
  // The last row at or before this time.
  at(time_s: number): (name: string) => string {
    const row = this.rows.findLast((one) => Number(one[0]) <= time_s + 1e-9)!
    return (name) => row[this.names.indexOf(name)]!
  }
  first(mode: string): number {
    return Number(this.rows.find((row) => row[this.names.indexOf('mode')] === mode)![0])
  }
}

const folder = mkdtempSync(join(tmpdir(), 'biopsy-review-'))
const kRuns = { gap: join(folder, 'gap'), stopped: join(folder, 'stopped') }
let server: ChildProcess | undefined

async function serve(...runs: string[]): Promise<string> {
  server = spawn(kConsole, ['--review', ...runs], { stdio: ['ignore', 'pipe', 'inherit'] })
  return new Promise((resolve) => server!.stdout!.once('data', (text) => resolve(String(text).trim())))
}

test.beforeAll(() => {
  execFileSync(kProgram, ['dry-run', 'gap', '--seed', '4', '--out', kRuns.gap])
  // A drive that holds the needle without friction does not: the supervisor stops it (docs/tutorials/assessor.md).
  const air = ['docs/examples/air.toml', '--model', 'docs/examples/no-friction.toml']
  spawnSync(kProgram, ['dry-run', ...air, '--out', kRuns.stopped], { cwd: process.env.SOURCE })
})
test.afterEach(() => void server?.kill('SIGTERM'))
test.afterAll(() => rmSync(folder, { recursive: true, force: true }))

// Local addresses of a process' sockets, as the kernel lists them. `state`: only these; empty: all.
const kListens = '0A'
function addressesOf(pid: number, kind: string, state: string): string[] {
  const files = readdirSync(`/proc/${pid}/fd`).map((fd) => readlinkSync(`/proc/${pid}/fd/${fd}`))
  const inodes = new Set(files.flatMap((file) => /^socket:\[(\d+)\]$/.exec(file)?.[1] ?? []))
  const rows = readFileSync(`/proc/net/${kind}`, 'utf8').trim().split('\n').slice(1).map((line) => line.trim().split(/\s+/))
  return rows.filter((row) => inodes.has(row[9]!) && (state === '' || row[3] === state)).map((row) => row[1]!)
}

const shown = (page: Page, row: string, run = 0) => page.locator(`[data-row="${row}"] td`).nth(run)
const time = async (page: Page) => parseFloat((await page.locator('[data-name=time]').textContent())!)

// Every figure beside the plots is the row's at the time that the page shows.
async function expectRow(page: Page, table: Table, own_s: number, run = 0): Promise<void> {
  const row = table.at(own_s)
  await expect(shown(page, 'Its own time, s', run)).toHaveText(Number(row('time_s')).toFixed(3))
  await expect(shown(page, 'State', run)).toHaveText(row('mode').toUpperCase())
  await expect(shown(page, 'Step', run)).toHaveText(row('stage'))
  await expect(shown(page, 'Stop', run)).toHaveText(row('stop'))
  await expect(shown(page, 'Needle', run)).toHaveText(row('locked') === '1' ? 'locked' : 'free')
  const figures: [string, string, number][] = [
    ['Depth', 'displacement_mm', 1], ['Target', 'setpoint_mm', 1], ['True tip', 'tip_mm', 1], ['Voltage', 'voltage_V', 1e-3],
    ['Its monitor', 'monitor_kV', 1], ['Its limit', 'envelope_kV', 1],
  ]
  for (const [name, column, factor] of figures) {
    const text = await shown(page, name, run).textContent()
    expect(Math.abs(Number(text) - factor * Number(row(column))), `${name} at ${own_s} s`).toBeLessThanOrEqual(0.000501)
  }
}

test('scrubbed by keyboard, the figures are those of run.csv', async ({ page }) => {
  const table = new Table(kRuns.gap)
  await page.goto(await serve(kRuns.gap))
  await expect(page.locator('.review')).toBeVisible()
  await expectRow(page, table, 0)
  let at = 0
  const press = async (key: string, by: number) => {
    await page.keyboard.press(key)
    at = Math.min(Math.max(at + by, 0), table.end_s)
    await expect(page.locator('[data-name=time]')).toHaveText(`${at.toFixed(3)} s`)
    await expectRow(page, table, at)
  }
  for (let n = 0; n < 3; ++n) await press('Shift+ArrowRight', 1)
  for (let n = 0; n < 4; ++n) await press('ArrowRight', 0.1)
  await press('ArrowLeft', -0.1)
  await press('PageDown', 10)
  for (let n = 0; n < 5; ++n) await press('.', 0.001)
  await press(',', -0.001)
  await press('End', 1e9)
  await press('ArrowRight', 0.1)
  await press('Shift+ArrowLeft', -1)
  await press('PageUp', -10)
  await press('Home', -1e9)
  await press('ArrowLeft', -0.1)
})

// Plots are made anew when the page has found its size: where the element lies once it stays there.
async function settledBox(page: Page, selector: string) {
  let last = ''
  await expect.poll(async () => {
    const before = last
    last = JSON.stringify(await page.locator(selector).boundingBox())
    return last !== 'null' && last === before
  }).toBe(true)
  return JSON.parse(last) as { x: number; y: number; width: number; height: number }
}

test('scrubbed by mouse, over the plots and over the whole, also zoomed', async ({ page }) => {
  const table = new Table(kRuns.gap)
  await page.goto(await serve(kRuns.gap))
  const plot = await settledBox(page, '[data-plot=depth] .u-over')
  const y = plot.y + plot.height / 2
  await page.mouse.move(plot.x + 10, y)
  await page.mouse.down()
  for (const share of [0.1, 0.4, 0.75]) {
    await page.mouse.move(plot.x + share * plot.width, y, { steps: 4 })
    expect(Math.abs((await time(page)) - share * table.end_s)).toBeLessThan(0.01 * table.end_s)
    await expectRow(page, table, await time(page))
  }
  await page.mouse.up()
  await page.mouse.move(plot.x + 0.2 * plot.width, y)
  expect(Math.abs((await time(page)) - 0.75 * table.end_s), 'released, it stays').toBeLessThan(0.01 * table.end_s)
  // Eight steps of the wheel: what lies under the pointer stays there.
  for (let n = 0; n < 8; ++n) await page.mouse.wheel(0, -100)
  await expect(page.locator('.overview .window')).toBeVisible()
  await page.mouse.click(plot.x + 0.2 * plot.width, y)
  expect(Math.abs((await time(page)) - 0.2 * table.end_s)).toBeLessThan(0.01 * table.end_s)
  const box = (await page.getByRole('slider').boundingBox())!
  await page.mouse.click(plot.x + 0.9 * plot.width, box.y + box.height / 2)
  expect(Math.abs((await time(page)) - 0.9 * table.end_s)).toBeLessThan(0.01 * table.end_s)
  await expectRow(page, table, await time(page))
})

test('the image appears when it was taken, and is the one in the folder', async ({ page }) => {
  const report = JSON.parse(readFileSync(join(kRuns.gap, 'report.json'), 'utf8'))
  const step = report.stages.find((one: { image_s: number | null }) => one.image_s !== null)
  await page.goto(await serve(kRuns.gap))
  await expect(page.locator('[data-picture=A]')).toContainText('No image yet')
  for (const kind of ['Hazard', 'State', 'Log']) await page.locator(`.kinds [data-kind=${kind}]`).click()
  await page.keyboard.press('n')
  await expect(page.locator('[data-name=time]')).toHaveText(`${step.image_s.toFixed(3)} s`)
  const picture = page.locator('[data-picture=A]')
  await expect(picture).toContainText(`step ${step.number}, ${step.image_s.toFixed(3)} s, ${step.check.verdict}`)
  await expect(picture).toContainText(`tip at ${step.check.depth_mm.toFixed(2)} ± ${step.check.sigma_mm.toFixed(2)} mm`)
  for (const which of ['after', 'difference', 'before']) {
    await expect(picture.locator('img')).toHaveAttribute('alt', new RegExp(which))
    const sent = await page.request.get(new URL(await picture.locator('img').getAttribute('src') as string, page.url()).href)
    expect((await sent.body()).equals(readFileSync(join(kRuns.gap, `stage-${step.number}-${which}.png`)))).toBe(true)
    await page.keyboard.press('i')
  }
  await page.keyboard.press(',')
  await expect(picture).toContainText('No image yet')
})

test('a stop that nobody requested is a hazard at its time, and the states are those of run.csv', async ({ page }) => {
  const report = JSON.parse(readFileSync(join(kRuns.stopped, 'report.json'), 'utf8'))
  const table = new Table(kRuns.stopped)
  expect(report.trips.length).toBeGreaterThan(0)
  await page.goto(await serve(kRuns.stopped))
  await expect(page.locator('.outcome')).toHaveText('STOPPED')
  await expect(page.locator('.lane .hazard-mark')).toHaveCount(report.trips.length)
  for (const kind of ['State', 'Image', 'Log']) await page.locator(`.kinds [data-kind=${kind}]`).click()
  await page.keyboard.press('n')
  const [trip] = report.trips
  await expect(page.locator('[data-name=said]')).toContainText(`${trip.time_s.toFixed(3)} s, hazard: ${trip.reason} (${trip.stop})`)
  for (const kind of ['Hazard', 'State']) await page.locator(`.kinds [data-kind=${kind}]`).click()
  const armed = table.first('armed')
  await page.locator('.list li', { hasText: 'ARMED' }).first().click()
  expect(await time(page)).toBeCloseTo(armed, 3)
  await expectRow(page, table, armed)
})

test('two runs stand beside each other on one axis, from their start or from their first insertion', async ({ page }) => {
  const tables = [new Table(kRuns.gap), new Table(kRuns.stopped)]
  await page.goto(await serve(kRuns.gap, kRuns.stopped))
  await expect(page.locator('.lane')).toHaveCount(2)
  for (let n = 0; n < 2; ++n) await page.keyboard.press('Shift+ArrowRight')
  for (const run of [0, 1]) await expectRow(page, tables[run]!, 2, run)
  const depths = await Promise.all([0, 1, 2].map(async (column) => Number(await shown(page, 'Depth', column).textContent())))
  expect(Math.abs(depths[2]! - (depths[1]! - depths[0]!))).toBeLessThanOrEqual(0.0011)
  await page.keyboard.press('z')
  await page.keyboard.press('Home')
  for (const kind of ['Hazard', 'Image', 'Log']) await page.locator(`.kinds [data-kind=${kind}]`).click()
  await page.locator('.list li', { hasText: 'ACTIVE' }).first().click()
  await expect(page.locator('[data-name=time]')).toHaveText('0.000 s')
  for (const run of [0, 1]) await expectRow(page, tables[run]!, tables[run]!.first('active'), run)
  await page.keyboard.press('End')
  const longer = tables[0]!.end_s > tables[1]!.end_s ? 1 : 0
  await expect(shown(page, 'Depth', longer), 'of the run that has ended').toHaveText('–')
})

test('at 1280 x 720 all of it is in view, grey and dark, without a finding of axe', async ({ page }) => {
  await page.setViewportSize({ width: 1280, height: 720 })
  await page.goto(await serve(kRuns.gap, kRuns.stopped))
  await page.keyboard.press('PageDown')
  for (const _theme of ['grey', 'dark']) {
    const out = await page.evaluate(() => {
      const parts = document.querySelectorAll<HTMLElement>('.head, .controls button, .overview, .lane, .plotted, .events, .values tr, .pictures figure')
      return [...parts].filter((part) => {
        const { left, top, right, bottom } = part.getBoundingClientRect()
        return left < 0 || top < 0 || right > innerWidth || bottom > innerHeight || bottom - top < 10
      }).map((part) => part.outerHTML.slice(0, 80))
    })
    expect(out).toEqual([])
    expect(await page.evaluate(() => document.documentElement.scrollHeight > innerHeight || document.documentElement.scrollWidth > innerWidth)).toBe(false)
    await expectAccessible(page)
    await page.getByRole('button', { name: 'Dark' }).click()
  }
  await page.keyboard.press('?')
  await expect(page.locator('.keys')).toContainText('next sample')
  await expectAccessible(page)
})

// 1920 x 1080 at 200 %, a small laptop, and a narrow window: it scrolls, and nothing is squeezed, covered or off to the side.
test('in small windows all of it is reached by scrolling down', async ({ page }) => {
  await page.goto(await serve(kRuns.gap, kRuns.stopped))
  await page.keyboard.press('End')
  for (const [width, height] of [[960, 540], [1024, 768], [683, 384]] as const) {
    await page.setViewportSize({ width, height })
    const poor = await page.evaluate(() => {
      const out: string[] = []
      for (const [part, high] of [['.controls button', 38], ['.plotted', 70], ['.list', 150], ['.kinds button', 28], ['.values tr', 15], ['.pictures .frame', 200], ['.said', 20]] as const)
        for (const one of document.querySelectorAll(part)) {
          one.scrollIntoView({ block: 'center' })
          const { left, right, top, bottom } = one.getBoundingClientRect()
          const there = document.elementFromPoint((left + right) / 2, (top + bottom) / 2)
          if (bottom - top < high || left < 0 || right > innerWidth || !one.contains(there)) out.push(`${part}: ${left} to ${right}, ${top} to ${bottom}, ${there?.className}`)
        }
      return out
    })
    expect(poor, `${width} x ${height}`).toEqual([])
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0)
    await expectAccessible(page)
  }
})

test('a folder that is none is refused with what to do and exit code 2', () => {
  for (const wrong of [[folder], [join(folder, 'nothing')], [kRuns.gap, folder]]) {
    const { status, stderr } = spawnSync(kConsole, ['--review', ...wrong], { timeout: 20_000, encoding: 'utf8' })
    expect(status).toBe(2)
    expect(stderr).toMatch(/^error: .+\nwhere: .+\nto do: .+\n$/)
  }
})

test('it serves this machine only, no robot, and nothing without the token', async ({ page, request }) => {
  const url = await serve(kRuns.gap)
  const { origin, port, search } = new URL(url)
  expect(origin).toBe(`http://127.0.0.1:${port}`)
  expect((await request.get(`${origin}/runs`)).status()).toBe(403)
  expect((await request.get(`${origin}/run/0/samples`)).status()).toBe(403)
  expect((await request.get(`${origin}/runs${search}`)).status()).toBe(200)
  for (const path of ['/run/1/samples', '/run/0/../report.json', '/run/0/run.csv'])
    expect((await request.get(`${origin}${path}${search}`)).status(), path).toBe(404)
  // It listens once, on loopback; and has no socket of UDP, which the bus needs.
  expect(addressesOf(server!.pid!, 'tcp', kListens)).toEqual([`0100007F:${Number(port).toString(16).toUpperCase().padStart(4, '0')}`])
  for (const [kind, state] of [['tcp6', kListens], ['udp', ''], ['udp6', '']] as const)
    expect(addressesOf(server!.pid!, kind, state), kind).toEqual([])
  await page.goto(url)
  const live = await page.evaluate(
    (path) => new Promise((resolve) => {
      const socket = new WebSocket(path)
      socket.onopen = () => resolve('open')
      socket.onerror = () => resolve('refused')
    }),
    `ws://127.0.0.1:${port}/live${search}`,
  )
  expect(live).toBe('refused')
})
