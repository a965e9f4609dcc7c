// Where the page stands in time. All runs have one axis; each can be placed on it by its start or its first insertion.
import { computed, signal } from '@preact/signals'

import { type Run, runs } from './runs'

export type Zero = 'start' | 'insertion'
export const zero = signal<Zero>('start')

// Where a run's own time is the axis' zero.
export function originOf(run: Run): number {
  if (zero.value === 'start') return 0
  return run.about.spans.find((span) => span.mode === 'Active')?.from ?? 0
}
export const onAxis = (run: Run, own: number) => own - originOf(run)
export const ownTime = (run: Run) => now.value + originOf(run)

export const whole = computed<[number, number]>(() => [
  Math.min(0, ...runs.value.map((run) => onAxis(run, run.time[0]!))),
  Math.max(1e-3, ...runs.value.map((run) => onAxis(run, run.end))),
])

export const now = signal(0) // s on the axis
const zoomed = signal<[number, number] | null>(null) // null: the whole
export const view = computed<[number, number]>(() => zoomed.value ?? whole.value)
export const isZoomed = computed(() => zoomed.value !== null)

const kViewMin_s = 0.02
const clamp = (value: number, low: number, high: number) => Math.min(Math.max(value, low), high)

export function moveTo(time: number): void {
  now.value = clamp(time, ...whole.value)
  if (!zoomed.value) return
  const [from, to] = zoomed.value
  if (now.value < from || now.value > to) show(now.value - (to - from) / 2, to - from)
}

function show(from: number, length: number): void {
  const [first, last] = whole.value
  if (length >= last - first) return void (zoomed.value = null)
  const start = clamp(from, first, last - length)
  zoomed.value = [start, start + length]
}

// About a time that stays where it is on the screen.
export function zoomBy(factor: number, about = now.value): void {
  const [from, to] = view.value
  const length = Math.max((to - from) / factor, kViewMin_s)
  show(about - ((about - from) / (to - from)) * length, length)
}
export const zoomOut = () => void (zoomed.value = null)

// What lies under the cursor stays there as far as the first run has it.
export function setZero(to: Zero): void {
  const first = runs.value[0]
  const own = first ? ownTime(first) : 0
  zero.value = to
  zoomed.value = null
  moveTo(first ? onAxis(first, own) : 0)
}
