// Alarms in the manner of IEC 60601-1-8: the robot's own and those of the page; which of them are acknowledged, and what
// there was since the page was opened.
import { computed, effect, signal } from '@preact/signals'

import type { Alarm, Severity } from '../generated/messages'
import { type Loss, loss, refused, restarted, state } from '../robot'

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
  robot_did: 'The robot held the needle, then took the voltage off. Points, plan and checks are gone.',
  to_do: 'Look at the needle. Then open the series again.',
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
const keyOf = (alarm: Alarm) => `${alarm.code} ${alarm.what}`

const acknowledged = signal<ReadonlySet<string>>(new Set())
export const isAcknowledged = (alarm: Alarm) => acknowledged.value.has(keyOf(alarm))
export const acknowledge = () => void (acknowledged.value = new Set(active.value.map(keyOf)))

// What sounds: the highest priority that nobody has acknowledged.
export const loudest = computed(() => active.value.find((one) => !isAcknowledged(one))?.severity ?? null)

export interface Past {
  alarm: Alarm
  from: Date
  to: Date | null
  acknowledged: Date | null
}
const kPastMax = 200
export const history = signal<Past[]>([]) // newest first

effect(() => {
  const now = new Date()
  const keys = new Map(active.value.map((alarm) => [keyOf(alarm), alarm]))
  const known = acknowledged.value
  const before = history.peek()
  let changed = false
  const after = before.map((one) => {
    const key = keyOf(one.alarm)
    if (one.to) return one
    if (!keys.has(key)) {
      changed = true
      return { ...one, to: now }
    }
    keys.delete(key)
    if (one.acknowledged || !known.has(key)) return one
    changed = true
    return { ...one, acknowledged: now }
  })
  if (changed || keys.size)
    history.value = [
      ...[...keys.values()].map((alarm) => ({ alarm, from: now, to: null, acknowledged: null })),
      ...after,
    ].slice(0, kPastMax)
  // What has ended is new when it comes again.
  const still = new Set([...known].filter((key) => active.value.some((alarm) => keyOf(alarm) === key)))
  if (still.size !== known.size) acknowledged.value = still
})
