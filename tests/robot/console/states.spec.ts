// Screenshot and accessibility of every state of the page. Image, plan and page are real; the robot's state is given
// here. The baselines are those of Debian's Chromium with fonts-dejavu-core; renew them with `./dev browser states
// --update-snapshots=all`.
import { execFileSync } from 'node:child_process'
import { readFileSync } from 'node:fs'
import { join } from 'node:path'

import { expect, type Page, test } from '@playwright/test'

import { kGapDepth_mm, PageOperator } from './page_operator'
import { expectAccessible } from './accessibility'
import { kProgram, Robot } from './robot'
import { lastEvent, type Message, freezePage } from './tap'

const robot = new Robot()
let checked: Message // of a rehearsal on a virtual clock: the same pictures each time
test.describe.configure({ mode: 'serial' })
test.beforeAll(async () => {
  await robot.start()
  const run = join(robot.folder, 'rehearsed')
  execFileSync(kProgram, ['dry-run', 'gap', '--out', run], { stdio: 'ignore' })
  const picture = (name: string) => readFileSync(join(run, `stage-1-${name}.png`)).toString('base64')
  checked = {
    type: 'Checked', stage: 0, verdict: 'accept', reason: 'Tip found at 2.53 mm, +0.03 mm from the planned 2.50 mm.',
    tip_found: true, planned: kGapDepth_mm, found: 2.53, sigma: 0.07, error: 0.03, confidence: 0.97,
    before_png: picture('before'), after_png: picture('after'), width: 512, height: 512, per_pixel: 0.0625,
    entry_px: [124, 256], axis: [1, 0],
  }
})
test.afterAll(() => robot.stop())

const kQuiet = { arm: '', insert: '', retract: '', reset: '', judge: '', accept: '', plan: '' }
const no = (some: Partial<typeof kQuiet>) => ({ ...kQuiet, ...some })
const kCold = no({ insert: 'Arm first.', retract: 'No voltage: the needle is back or on its way.', reset: 'Nothing to reset.', judge: 'No image was taken yet.', accept: 'No image was taken yet.', plan: 'It is confirmed.' })
const kHot = no({ arm: 'It is armed.', reset: 'Nothing to reset.', judge: 'No image was taken yet.', accept: 'No image was taken yet.', plan: 'It is confirmed.' })
const kStopped = no({ ...kCold, arm: 'Stopped: Reset first.', reset: '' })
const kAlarm = { severity: 'Alarm', code: 'E-120', what: 'STOP was pressed.', robot_did: 'High voltage off, needle falls back.', to_do: 'Look at the needle, then Reset.' }
const kWarning = { severity: 'Warning', code: 'E-204', what: 'Depth limit reached (61.0 mm).', robot_did: 'Needle held.', to_do: 'Release, then Retract or Replan.' }
const kNoTip = { verdict: 'unsure', reason: 'No needle was found in the image.', tip_found: false, error: 0, confidence: 0.4 }

const kHeld = { mode: 'Hold', step: 'Confirm', stage_done: true, hold_left: 7.5, depth: 2.5, drive: 1.9, disabled: no({ ...kHot, judge: '', accept: '', insert: 'The plan is done: look at the image, then Retract.' }) }

// Name, State, further events, and whether a baseline is kept.
type Scene = { name: string; state: Record<string, unknown>; more?: () => Message[]; kept?: boolean }
const kScenes: Scene[] = [
  { name: 'check', state: { mode: 'Safe', step: 'Check', disabled: no({ ...kCold, arm: 'Tick all three checks first.' }) }, kept: true },
  { name: 'arm', state: { mode: 'Ready', step: 'Arm', ticks: [true, true, true], ticks_left: 48.5, disabled: kCold } },
  { name: 'arming', state: { mode: 'Ready', step: 'Arm', ticks: [true, true, true], held: ['Arm'], arm_held: 0.75, disabled: kCold } },
  { name: 'armed', state: { mode: 'Armed', step: 'Insert', armed_left: 51.5, disabled: kHot }, kept: true },
  { name: 'insert', state: { mode: 'Active', step: 'Insert', depth: 1.2, drive: 3.4, held: ['Insert'], disabled: kHot }, kept: true },
  { name: 'hold', state: { mode: 'Hold', step: 'Insert', hold_left: 8.5, depth: 1.2, drive: 2.1, alarms: [kWarning], disabled: kHot } },
  { name: 'scanner', state: { ...kHeld, scanner: 'Acquiring' } },
  { name: 'confirm', state: kHeld, more: () => [checked], kept: true },
  { name: 'confirm-no-tip', state: { ...kHeld, disabled: no({ ...kHeld.disabled, accept: 'The image does not tell surely enough where the tip is.' }) }, more: () => [{ ...checked, ...kNoTip }] },
  { name: 'trip', state: { mode: 'Trip', step: 'Confirm', depth: 0.4, alarms: [kAlarm], disabled: kStopped }, kept: true },
  { name: 'stopped', state: { mode: 'Trip', step: 'Confirm', report: '/report.html', alarms: [kAlarm], disabled: kStopped } },
  { name: 'watched', state: { mode: 'Active', step: 'Insert', depth: 1.2, drive: 3.4, controller: false, disabled: kHot } },
  { name: 'silent', state: { mode: 'Hold', step: 'Insert', measured: false, alarms: [{ ...kAlarm, code: 'E-121', what: 'The robot is silent.' }], disabled: kHot } },
]

// The age of the last message is masked: it depends on the machine.
async function expectBaseline(page: Page, name: string): Promise<void> {
  await expect(page.locator('[data-name=Link]')).toHaveText('0 ms')
  await expect(page).toHaveScreenshot(`${name}.png`, { mask: [page.locator('[data-name=Link]')], timeout: 30_000 })
}

test('Image: the page before anything is open', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await freezePage(page, { mode: 'Safe', step: 'Image' })
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

for (const { name, state, more, kept } of kScenes)
  test(`${name}: ${JSON.stringify(state.mode as string)}`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const planned = { ...(await lastEvent(page, 'Planned')), confirmed: true }
    await freezePage(page, state, [planned, ...(more?.() ?? [])])
    await expect(operator.mode()).toHaveAttribute('data-mode', state.mode as string)
    if (kept) await expectBaseline(page, name)
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
