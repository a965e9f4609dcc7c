// A folder with several series: a person chooses, and what cannot be opened says why.
import { execFileSync } from 'node:child_process'
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'

import { expect, test } from '@playwright/test'

import { Person } from './person'
import { everybodyCanUse } from './readable'
import { kProgram, Robot } from './robot'
import { heard } from './tap'

const folder = mkdtempSync(join(tmpdir(), 'biopsy-series-'))
let robot: Robot

// Beside the image for planning: the one with the needle in it, the same of another patient, and no image at all.
test.beforeAll(async () => {
  const run = join(folder, 'run')
  const images = join(folder, 'images')
  execFileSync(kProgram, ['dry-run', 'gap', '--out', run], { stdio: 'ignore' })
  cpSync(join(run, 'planning'), join(images, 'planning'), { recursive: true })
  cpSync(join(run, 'images/stage-1'), join(images, 'needle'), { recursive: true })
  const uid = (of: string) => /^series .*\n +(\S+)$/m.exec(execFileSync(kProgram, ['image', join(images, of)]).toString())![1]!
  const needle = uid('needle')
  mkdirSync(join(images, 'stranger'))
  for (const slice of readdirSync(join(images, 'needle'))) {
    const bytes = readFileSync(join(images, 'needle', slice)).toString('latin1')
    const other = bytes.replaceAll('PHANTOM', 'MRJONES').replaceAll(needle, needle.slice(0, -3) + '000')
    writeFileSync(join(images, 'stranger', slice), other.replaceAll('confirmation', 'another one!'), 'latin1')
  }
  writeFileSync(join(images, 'lost.nii'), Buffer.alloc(400))
  robot = new Robot(['--image', images, '--series', uid('planning'), '--entry=-4.396,33.092,51.854', '--target=-6.6,33.1,50.7'])
  await robot.start()
})
test.afterAll(async () => {
  await robot?.stop()
  rmSync(folder, { recursive: true, force: true })
})

test('a person chooses among the series of a folder, and what cannot be opened says why', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.open()
  const list = page.locator('.empty li')
  await expect(list).toHaveCount(4)
  await expect(page.getByText('sample')).toHaveCount(0)
  await expect(list.filter({ hasText: 'lost.nii' }).getByRole('button')).toHaveAttribute('aria-disabled', 'true')
  await expect(list.filter({ hasText: 'lost.nii' }).locator('.why')).not.toBeEmpty()
  await everybodyCanUse(page)

  await person.button(/Open muscle, gap, liver/).click()
  await person.imageShown()
  await person.setPoints()
  await person.click('Confirm this plan')
  await expect(page.getByRole('checkbox')).toHaveCount(3)
})

test('another series takes the plan of the one before with it', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.open()
  await person.imageShown()
  const before = (await heard(page, 'Opened')).series.series_uid
  await person.click('Other series')
  await person.button(/confirmation, stage 1/).click()
  await expect(page.locator('.caption')).toContainText('confirmation, stage 1', { timeout: 30_000 })
  await person.imageShown()
  expect((await heard(page, 'Opened')).series.series_uid).not.toBe(before)
  await expect(page.locator('dd[data-name=entry]')).toHaveText('not set')
  await expect(person.button(/^Arm/)).toHaveAttribute('aria-disabled', 'true')
  await person.setPoints()
  await expect(page.locator('[data-name=planned-depth]')).toBeVisible()

  await person.click('Other series')
  const stranger = page.locator('.empty li').filter({ hasText: 'another one!' })
  await stranger.getByRole('button').click()
  await expect(stranger.locator('.why')).toContainText('another patient', { timeout: 30_000 })
  await expect(stranger.getByRole('button')).toHaveAttribute('aria-disabled', 'true')
  await person.button(/confirmation, stage 1/).click() // back to the one that is open
  await person.imageShown()
})
