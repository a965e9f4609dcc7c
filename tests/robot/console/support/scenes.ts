// States of the page, given by the tests: image and plan are those of a real robot.
import { execFileSync } from 'node:child_process'
import { readFileSync } from 'node:fs'
import { join } from 'node:path'

import { expect } from '@playwright/test'

import { kGapDepth_mm, type PageOperator } from './page_operator'
import { kProgram } from './robot'
import { freezePage, lastEvent, type Message } from './tap'

const kQuiet = { arm: '', insert: '', retract: '', reset: '', judge: '', accept: '', plan: '' }
// Screens, CSS px. The last: one of 1920 x 1080 at 200 %.
export const kSizes = [[1920, 1080], [1366, 768], [1280, 720], [1024, 768], [960, 540]] as const

export const no = (some: Partial<typeof kQuiet>) => ({ ...kQuiet, ...some })
export const kCold = no({ insert: 'Arm first.', retract: 'High voltage is off.', reset: 'Nothing to reset.', judge: 'No image was taken yet.', accept: 'No image was taken yet.', plan: 'It is confirmed.' })
const kHot = no({ arm: 'It is armed.', reset: 'Nothing to reset.', judge: 'No image was taken yet.', accept: 'No image was taken yet.', plan: 'It is confirmed.' })
export const kStopped = no({ ...kCold, arm: 'Stopped: Reset first.', reset: '' })
export const kAlarm = { severity: 'Alarm', code: 'E-120', what: 'STOP was pressed.', robot_did: 'High voltage off: nothing holds the needle.', to_do: 'Look at the needle, then Reset.' }
export const kStanding = { severity: 'Alarm', code: 'E-122', what: 'STOP was pressed.', robot_did: 'Not ready: it cannot be armed.', to_do: 'Reset, once it is clear why it was pressed.' }
export const kWarning = { severity: 'Warning', code: 'E-204', what: 'Depth limit reached (61.0 mm).', robot_did: 'Needle held.', to_do: 'Release, then Retract or Replan.' }
const kNoTip = { verdict: 'unsure', reason: 'No needle was found in the image.', tip_found: false, error: 0, confidence: 0.4 }

const kHeld = { mode: 'Hold', step: 'Confirm', stage_done: true, hold_left: 7.5, depth: 2.5, drive: 1.9, disabled: no({ ...kHot, judge: '', accept: '', insert: 'The plan is done: look at the image, then Retract.' }) }

// Name, State, further events, and whether a baseline is kept.
export type Scene = { name: string; state: Record<string, unknown>; more?: (checked: Message) => Message[]; kept?: boolean }
export const kScenes: Scene[] = [
  { name: 'check', state: { mode: 'Safe', step: 'Check', disabled: no({ ...kCold, arm: 'Tick all three checks first.' }) }, kept: true },
  { name: 'arm', state: { mode: 'Ready', step: 'Arm', ticks: [true, true, true], ticks_left: 48.5, disabled: kCold } },
  { name: 'arming', state: { mode: 'Ready', step: 'Arm', ticks: [true, true, true], held: ['Arm'], arm_held: 0.75, disabled: kCold } },
  { name: 'armed', state: { mode: 'Armed', step: 'Insert', armed_left: 51.5, disabled: kHot }, kept: true },
  { name: 'insert', state: { mode: 'Active', step: 'Insert', depth: 1.2, drive: 3.4, held: ['Insert'], disabled: kHot }, kept: true },
  { name: 'hold', state: { mode: 'Hold', step: 'Insert', hold_left: 8.5, depth: 1.2, drive: 2.1, alarms: [kWarning], disabled: kHot } },
  { name: 'scanner', state: { ...kHeld, scanner: 'Acquiring' } },
  { name: 'confirm', state: kHeld, more: (checked) => [checked], kept: true },
  { name: 'confirm-no-tip', state: { ...kHeld, disabled: no({ ...kHeld.disabled, accept: 'The image does not tell surely enough where the tip is.' }) }, more: (checked) => [{ ...checked, ...kNoTip }] },
  { name: 'trip', state: { mode: 'Trip', step: 'Confirm', depth: 0.4, alarms: [kAlarm], disabled: kStopped }, kept: true },
  { name: 'stop-in-ready', state: { mode: 'Safe', step: 'Arm', ticks: [true, true, true], alarms: [kStanding], disabled: kStopped } },
  { name: 'stopped', state: { mode: 'Trip', step: 'Confirm', report: '/report.html', alarms: [kAlarm], disabled: kStopped } },
  { name: 'watched', state: { mode: 'Active', step: 'Insert', depth: 1.2, drive: 3.4, controller: false, disabled: kHot } },
  { name: 'silent', state: { mode: 'Hold', step: 'Insert', measured: false, alarms: [{ ...kAlarm, code: 'E-121', what: 'The robot is silent.' }], disabled: kHot } },
]

// Of a rehearsal on a virtual clock: the same pictures each time. `folder` gets the rehearsal.
export function checkedOf(folder: string): Message {
  const run = join(folder, 'rehearsed')
  execFileSync(kProgram, ['dry-run', 'gap', '--out', run], { stdio: 'ignore' })
  const picture = (name: string) => readFileSync(join(run, `stage-1-${name}.png`)).toString('base64')
  return {
    type: 'Checked', stage: 0, verdict: 'accept', reason: 'Tip found at 2.53 mm, +0.03 mm from the planned 2.50 mm.',
    tip_found: true, planned: kGapDepth_mm, found: 2.53, sigma: 0.07, error: 0.03, lateral: 0.21, lateral_sigma: 0.12,
    angle: 1.4, angle_sigma: 2.3, confidence: 0.97, before_png: picture('before'), after_png: picture('after'),
    width: 512, height: 512, per_pixel: 0.0625, entry_px: [124, 256], axis: [1, 0],
  }
}

// The page in this state, whatever the robot does.
export async function showScene(operator: PageOperator, { state, more }: Scene, checked: Message): Promise<void> {
  const planned = { ...(await lastEvent(operator.page, 'Planned')), confirmed: true }
  await freezePage(operator.page, state, [planned as Message, ...(more?.(checked) ?? [])])
  await expect(operator.mode()).toHaveAttribute('data-mode', state.mode as string)
}
