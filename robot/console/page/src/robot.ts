// What is known of the robot, as signals: set by the link alone, read by the parts of the page.
import { computed, signal } from '@preact/signals'

import type { Answer, Checked, Opened, Planned, State, Telemetry, Welcome } from './generated/messages'

export type Vec3 = [number, number, number]

export const welcome = signal<Welcome | null>(null)
export const opened = signal<Opened | null>(null)
export const planned = signal<Planned | null>(null)
export const state = signal<State | null>(null)
export const checked = signal<Checked[]>([])
export const refused = signal<Answer | null>(null) // the last refusal, until something is done

// The link
export const connected = signal(false)
export let heardAt = 0 // performance.now() of the last message
export const linkAge = signal(0) // ms, in steps
export const heard = () => void (heardAt = performance.now())
export const kOld_ms = 200
const kLost_ms = 2500 // a robot that is silent lets the console speak once a second

export const isOld = computed(() => !connected.value || linkAge.value > kOld_ms)
// A cable that is cut does not close the socket: silence says it too.
export const linked = computed(() => connected.value && linkAge.value < kLost_ms)
export const controls = computed(() => linked.value && (state.value?.controller ?? false))
export const plan = computed(() => (planned.value?.stages.length ? planned.value : null))

// The last 30 s of plots; not signals: they are drawn by their own clock.
export const kPlot_ms = 30_000
export const telemetry: Telemetry[] = []

export function remember(sample: Telemetry): void {
  const last = telemetry.at(-1)
  if (last && sample.time < last.time) telemetry.length = 0 // another stage process: its own clock
  telemetry.push(sample)
  let old = 0
  while (telemetry[old]!.time < sample.time - kPlot_ms) ++old
  if (old > 100) telemetry.splice(0, old) // now and then, not each time
}

// Why the page cannot act at all; empty: it can.
export const whyNot = computed(() => {
  if (!linked.value) return 'No link to the console.'
  if (!controls.value) return 'Another page controls the robot; this one watches.'
  return ''
})
