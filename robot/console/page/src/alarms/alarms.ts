// Alarms in the manner of IEC 60601-1-8: the robot's own and those of the page, and which of them are acknowledged.
import { computed, effect, signal } from '@preact/signals'

import type { Alarm, Severity } from '../generated/messages'
import { post } from '../link'
import { alarmHistory, controls, type Loss, loss, refused, restarted, state } from '../robot'

export const kPriority: Record<Severity, string> = { Alarm: 'high', Warning: 'medium', Notice: 'low' }
const kOrder: Severity[] = ['Alarm', 'Warning', 'Notice']

const kLost: Record<Loss, Pick<Alarm, 'what' | 'robot_did' | 'to_do'>> = {
  starting: { what: 'No link to the console yet.', robot_did: '', to_do: 'The page tries.' },
  silent: {
    what: 'The link to the console is silent.',
    robot_did: 'By itself the robot holds the needle, then takes the voltage off.',
    to_do: 'Use the hardware E-stop in an emergency. The page tries again.',
  },
  token: {
    what: 'The console does not accept this address.',
    robot_did: 'This page never controlled the robot, or does not any more.',
    to_do: 'Open the address that `biopsy up` printed last.',
  },
  full: {
    what: 'Eight pages are connected: there is no room for this one.',
    robot_did: 'The robot is controlled elsewhere.',
    to_do: 'Close one of them. The page tries again.',
  },
  ended: {
    what: 'Nothing answers at the address of the console.',
    robot_did: 'By itself the robot holds the needle, then takes the voltage off.',
    to_do: 'Use the hardware E-stop in an emergency. Then see `biopsy up`.',
  },
}

const kRestarted: Alarm = {
  severity: 'Warning',
  code: 'E-124',
  what: 'The console was started anew.',
  robot_did: 'The robot held the needle, then took the voltage off. Series and points are kept, the checks are gone.',
  to_do: 'Look at the needle. Then look at the plan and confirm it again.',
}

export const active = computed<Alarm[]>(() => {
  const all: Alarm[] = []
  // What the robot told before the link was lost need not be true any more: the list keeps it.
  if (loss.value && loss.value !== 'starting') all.push({ severity: 'Alarm', code: 'E-100', ...kLost[loss.value] })
  else if (!loss.value) all.push(...(state.value?.alarms ?? []))
  if (restarted.value && !loss.value) all.push(kRestarted)
  if (refused.value && !all.some((one) => one.code === refused.value!.code)) {
    const { code, what, robot_did, to_do } = refused.value
    all.push({ severity: 'Notice', code, what, robot_did, to_do })
  }
  return all.sort((a, b) => kOrder.indexOf(a.severity) - kOrder.indexOf(b.severity))
})

// By code and words: the same alarm with other words is another one.
export const keyOf = (alarm: Alarm) => `${alarm.code} ${alarm.what}`

// On this page, and by the page that controls, whichever was open then.
const acknowledgedHere = signal<ReadonlySet<string>>(new Set())
const acknowledged = computed<ReadonlySet<string>>(() => {
  const kept = (alarmHistory.value?.rows ?? []).filter((row) => row.to_ms === 0 && row.acknowledged_ms > 0)
  return new Set([...acknowledgedHere.value, ...kept.map((row) => keyOf(row.alarm))])
})
export const isAcknowledged = (alarm: Alarm) => acknowledged.value.has(keyOf(alarm))
export function acknowledge(): void {
  acknowledgedHere.value = new Set(active.value.map(keyOf))
  if (controls.value) post({ type: 'Acknowledge', newest: alarmHistory.value?.rows[0]?.number ?? 0 })
}

// What sounds: the highest priority that nobody has acknowledged.
export const loudest = computed(() => active.value.find((one) => !isAcknowledged(one))?.severity ?? null)

// What has ended is new when it comes again.
effect(() => {
  const keys = new Set(active.value.map(keyOf))
  const known = acknowledgedHere.value
  const still = new Set([...known].filter((key) => keys.has(key)))
  if (still.size !== known.size) acknowledgedHere.value = still
})
