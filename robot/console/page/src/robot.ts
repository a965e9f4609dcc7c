// The state of the robot as signals: set by link.ts only, read by the components.
import { computed, signal } from '@preact/signals'

import type { AlarmHistory, Answer, Checked, Opened, Planned, State, Telemetry, Welcome } from './generated/messages'

export type Vec3 = [number, number, number]

export const welcome = signal<Welcome | null>(null)
export const opened = signal<Opened | null>(null)
export const planned = signal<Planned | null>(null)
export const state = signal<State | null>(null) // as shown: shown_state.ts
export const statesReceived = signal(0)
export const checked = signal<Checked[]>([])
export const alarmHistory = signal<AlarmHistory | null>(null) // as the console keeps it
export const refused = signal<Answer | null>(null) // the last refusal, until something is done

// The link
export const connected = signal(false)
export let lastMessageAt = 0 // performance.now(), ms
export const linkAge = signal(0) // ms, in steps
export const noteMessage = () => void (lastMessageAt = performance.now())
export const kOld_ms = 200
const kLost_ms = 1500 // without data from the robot the console sends once a second

// Why there is no connection, as far as the page can tell.
export type Loss = 'starting' | 'silent' | 'token' | 'full' | 'ended'
export const closed = signal<Loss>('starting') // of a connection that is not open

export const isOld = computed(() => !connected.value || linkAge.value > kOld_ms)
// A pulled cable does not close the socket: missing messages count as well.
export const linked = computed(() => connected.value && linkAge.value < kLost_ms)
export const loss = computed<Loss | null>(() => (linked.value ? null : connected.value ? 'silent' : closed.value))
// The console answers, the robot does not.
export const robotSilent = computed(() => linked.value && state.value !== null && !state.value.measured && everMeasured.value)
export const everMeasured = signal(false)
// An earlier start of the console knew a confirmed plan: until one is confirmed again.
export const restarted = signal(false)

export const kBack_mm = 0.1 // so near to 0 the needle is back
export const isKnown = computed(() => !isOld.value && (state.value?.measured ?? false))
export const depthIsKnown = computed(() => isKnown.value && (state.value?.depth_known ?? false))

export const controls = computed(() => linked.value && (state.value?.controller ?? false))
export const plan = computed(() => (planned.value?.stages.length ? planned.value : null))

// The needle is back and the report written: another run may be planned, or begun with its checks.
export const runOver = computed(() => state.value?.step === 'Confirm' && state.value.report !== '')

// The last 30 s of plots; not signals, since they are drawn on a timer.
export const kPlot_ms = 30_000
export const telemetry: Telemetry[] = []

export function appendTelemetry(sample: Telemetry): void {
  const last = telemetry.at(-1)
  if (last && sample.time < last.time) telemetry.length = 0 // a new stage process has its own clock
  telemetry.push(sample)
  let old = 0
  while (telemetry[old]!.time < sample.time - kPlot_ms) ++old
  if (old > 100) telemetry.splice(0, old) // seldom, since it moves the whole array
}

// Why every button is disabled; empty: they are not.
export const disabledReason = computed(() => {
  if (!linked.value) return 'No link to the console.'
  if (!controls.value) return 'Another page controls the robot.'
  return ''
})
