// A folder with several series: one can be chosen; those that cannot be opened show the reason.
import { execFileSync } from 'node:child_process'
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'

import { expect, test } from '@playwright/test'

import { kActsMax, kFurtherActsMax, PageOperator } from './support/page_operator'
import { expectAccessible } from './support/accessibility'
import { note, round } from './support/figures'
import { meter } from './support/memory'
import { kProgram, Robot } from './support/robot'
import { lastEvent } from './support/tap'

const folder = mkdtempSync(join(tmpdir(), 'biopsy-series-'))
let robot: Robot

// Beside the planning image: seven further series of the same patient, one of another patient, and a file that is no
// image. Each name is as long as the one that it replaces.
test.beforeAll(async () => {
  const run = join(folder, 'run')
  const images = join(folder, 'images')
  execFileSync(kProgram, ['dry-run', 'gap', '--out', run], { stdio: 'ignore' })
  cpSync(join(run, 'planning'), join(images, 'planning'), { recursive: true })
  const uid = (of: string) => /^series .*\n +(\S+)$/m.exec(execFileSync(kProgram, ['image', join(images, of)]).toString())![1]!
  const planning = uid('planning')
  const copy = (to: string, end: string, description: string, patient: string) => {
    mkdirSync(join(images, to))
    for (const slice of readdirSync(join(images, 'planning'))) {
      const bytes = readFileSync(join(images, 'planning', slice)).toString('latin1')
      const other = bytes.replaceAll(planning, planning.slice(0, -3) + end).replaceAll('muscle, gap, liver', description)
      writeFileSync(join(images, to, slice), other.replaceAll('PHANTOM', patient), 'latin1')
    }
  }
  copy('second', '001', 'second acquisition', 'PHANTOM')
  for (const n of [3, 4, 5, 6, 7, 8]) copy(`further-${n}`, `00${n}`, `further series   ${n}`.slice(0, 18), 'PHANTOM')
  copy('other-patient', '002', 'another one here!!', 'MRJONES')
  writeFileSync(join(images, 'lost.nii'), Buffer.alloc(400))
  robot = new Robot(['--image', images, '--series', planning, '--entry=-4.396,33.092,51.854', '--target=-6.6,33.1,50.7'])
  await robot.start()
})
test.afterAll(async () => {
  await robot?.stop()
  rmSync(folder, { recursive: true, force: true })
})

test('a series of the folder can be chosen; one that cannot be opened shows the reason', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  const list = page.locator('.empty li')
  await expect(list).toHaveCount(10)
  await expect(page.getByText('sample')).toHaveCount(0)
  await expect(list.filter({ hasText: 'lost.nii' }).getByRole('button')).toHaveAttribute('aria-disabled', 'true')
  await expect(list.filter({ hasText: 'lost.nii' }).locator('.why')).not.toBeEmpty()
  await expectAccessible(page)

  await operator.button(/Open muscle, gap, liver/).click()
  await operator.imageShown()
  await operator.setPoints()
  await operator.click('Confirm this plan')
  await expect(page.getByRole('checkbox')).toHaveCount(3)
})

// From the list, whatever an earlier test opened.
async function openFirst(operator: PageOperator): Promise<void> {
  await operator.open()
  if ((await lastEvent(operator.page, 'State')).step !== 'Image') {
    await operator.imageShown()
    await operator.button('Other series').click()
  }
  await operator.click(/Open muscle, gap, liver/)
  await expect(operator.page.locator('.caption')).toContainText('muscle, gap, liver', { timeout: 30_000 })
  await operator.imageShown()
}

test('opening another series clears points and plan', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await openFirst(operator)
  const before = (await lastEvent(page, 'Opened')).series.series_uid
  await operator.click('Other series')
  await operator.button(/second acquisition/).click()
  await expect(page.locator('.caption')).toContainText('second acquisition', { timeout: 30_000 })
  await operator.imageShown()
  expect((await lastEvent(page, 'Opened')).series.series_uid).not.toBe(before)
  await expect(page.locator('dd[data-name=entry]')).toHaveText('not set')
  await expect(operator.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await operator.setPoints()
  await expect(page.locator('[data-name=planned-depth]')).toBeVisible()

  await operator.click('Other series')
  const otherPatient = page.locator('.empty li').filter({ hasText: 'another one here!!' })
  await otherPatient.getByRole('button').click()
  await expect(otherPatient.locator('.why')).toContainText('another patient', { timeout: 30_000 })
  await expect(otherPatient.getByRole('button')).toHaveAttribute('aria-disabled', 'true')
  await operator.button(/second acquisition/).click() // back to the one that is open
  await operator.imageShown()
})

// Without tissues to name, what is said of the pointer is short beside other words.
test('whatever lies under the pointer, the image stays where it is', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await openFirst(operator)
  const image = page.locator('.slices')
  for (const width of [1920, 1820, 1740, 1600]) {
    await page.setViewportSize({ width, height: 1080 })
    await page.mouse.move(5, 5)
    const at = await image.boundingBox()
    const large = (await page.locator('[data-tile^=large] rect').first().boundingBox())!
    for (const share of [0.02, 0.5, 0.98]) {
      await page.mouse.move(large.x + share * large.width, large.y + share * large.height)
      await expect(page.locator('[data-name=pointed]')).toContainText('pointer')
      expect(await image.boundingBox(), `${width}`).toEqual(at)
    }
  }
})

test('three targets on images of a patient: deliberate acts of each', async ({ page }) => {
  test.setTimeout(400_000)
  const operator = new PageOperator(page, robot.url)
  await openFirst(operator)
  await operator.setPoints()
  await operator.confirmPlan()
  await operator.recover()
  await operator.arm()
  await operator.insert()
  await operator.click('Accept this depth')
  await expect(page.locator('[aria-current=step]')).toContainText(/Accepted|The run is over/)
  expect(operator.acts).toBeLessThanOrEqual(kActsMax)
  for (const share of [0.9, 0.9]) expect(await operator.furtherTarget(share)).toBeLessThanOrEqual(kFurtherActsMax)
  await operator.retractAccepted()
})

// A browser has sixteen drawing contexts, and takes the oldest away from whoever opens one more.
const kReopenings = process.env.SOAK_MINUTES ? 100 : 25
const kObjectsVary = 200 // of ten thousand: what the page happens to draw
const kWarm = Math.floor(kReopenings / 2) // caches of the browser and 30 s of plots are filled by then
test(`the image opened ${kReopenings} times keeps its drawing context`, async ({ page }) => {
  test.setTimeout(kReopenings * 10_000)
  const complaints: string[] = []
  page.on('console', (message) => /context/i.test(message.text()) && complaints.push(message.text()))
  const operator = new PageOperator(page, robot.url)
  await openFirst(operator)
  const measure = await meter(page, robot.pid('biopsy-console'))
  let warm = await measure()
  for (let n = 0; n < kReopenings; ++n) {
    if (n === kWarm) warm = await measure()
    await operator.click('Other series')
    await expect(page.locator('body[data-image=shown]')).toHaveCount(0)
    await operator.button(/second acquisition/).click()
    await operator.imageShown()
  }
  const end = await measure()
  await operator.button('axial').click()
  await expect(page.locator('[data-tile="large axial"]')).toBeAttached()
  note({
    reopenings: kReopenings,
    reopenings_page_heap_MB: [round(warm.heap_MB), round(end.heap_MB)],
    reopenings_page_objects: [warm.objects, end.objects],
    reopenings_page_nodes: [warm.nodes, end.nodes],
    reopenings_console_resident_MB: [round(warm.server_MB), round(end.server_MB)],
  })
  expect(end.heap_MB - warm.heap_MB).toBeLessThan(1)
  expect(end.objects - warm.objects).toBeLessThan(kObjectsVary)
  expect(end.server_MB - warm.server_MB).toBeLessThan(2)
  expect(end.nodes - warm.nodes).toBeLessThan(100)
  expect(complaints.filter((text) => /too many|lost|oldest/i.test(text))).toEqual([])
  expect(await page.evaluate(() => document.querySelector('canvas')!.getContext('webgl2')!.isContextLost())).toBe(false)
})
