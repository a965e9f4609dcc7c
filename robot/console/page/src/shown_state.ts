// A State as the page shows it: in the steps that people read. One that shows the same as the one before is the one
// before, so that nothing is drawn again for it.
import type { State } from './generated/messages'

const kDepth_mm = 0.01 // the second decimal, which noise must not change
const kDrive_kV = 0.02
const kPerShown = 100 // both are shown with two decimals
const kMinute_s = 60

// What is shown, until the value differs from that.
const steady = (value: number, before: number | undefined, least: number) =>
  before !== undefined && Math.abs(value - before) < least ? before : Math.round(kPerShown * value) / kPerShown

export function shownState(now: State, before: State | null): State {
  const shown: State = {
    ...now,
    seq: 0,
    depth: steady(now.depth, before?.depth, kDepth_mm),
    drive: steady(now.drive, before?.drive, kDrive_kV),
    hold_left: Math.ceil(now.hold_left),
    armed_left: Math.ceil(now.armed_left),
    ticks_left: Math.ceil(now.ticks_left),
    carried_left: kMinute_s * Math.ceil(now.carried_left / kMinute_s),
    arm_held: Math.round(10 * now.arm_held) / 10,
  }
  return before && JSON.stringify(shown) === JSON.stringify(before) ? before : shown
}
