// All that happened in the runs, in order on the common axis.
import { computed, signal } from '@preact/signals'

import type { Mode, Span, StopCategory } from '../generated/messages'
import { mm } from '../viewer/geometry'
import { type Run, runs } from './runs'
import { now, onAxis } from './time'

export type Kind = 'Hazard' | 'State' | 'Image' | 'Log'
export const kKinds: Kind[] = ['Hazard', 'State', 'Image', 'Log']

export interface Happening {
  at: number // s on the axis
  own: number // s of its run
  run: Run
  kind: Kind
  text: string
}

export const kStops: Record<StopCategory, string> = { None: 'none', C2Hold: 'C2 hold', C1Ramp: 'C1 ramp', C0Off: 'C0 off' }
export const kStopped: Mode[] = ['Trip', 'Lock']

function spanText(span: Span, before: Span | undefined): string {
  const parts: string[] = []
  if (span.mode !== before?.mode) parts.push(span.mode.toUpperCase())
  if (span.step !== before?.step) parts.push(`step ${span.step}`)
  if (span.stop !== before?.stop) parts.push(span.stop === 'None' ? 'no stop' : `stop ${kStops[span.stop]}`)
  return parts.join(', ')
}

function happeningsOf(run: Run): Happening[] {
  const { about } = run
  const all: Omit<Happening, 'at' | 'run'>[] = [
    ...about.hazards.map(({ at, stop, reason }) => ({ own: at, kind: 'Hazard' as const, text: `${reason} (${kStops[stop]})` })),
    ...about.spans.map((span, n) => ({ own: span.from, kind: 'State' as const, text: spanText(span, about.spans[n - 1]) })),
    ...about.images.map((image) => ({
      own: image.at,
      kind: 'Image' as const,
      text:
        `step ${image.step}: ${image.verdict || 'not checked'}` +
        (image.tip_found ? `, tip at ${mm(image.found, 2)} ± ${mm(image.sigma, 2)} mm of ${mm(image.planned, 2)} mm` : ''),
    })),
    ...about.log.map(({ at, source, kind, text }) => ({ own: at, kind: 'Log' as const, text: `${source}, ${kind}: ${text}` })),
  ]
  return all.map((one) => ({ ...one, run, at: onAxis(run, one.own) }))
}

export const happenings = computed(() =>
  runs.value.flatMap(happeningsOf).sort((a, b) => a.at - b.at || kKinds.indexOf(a.kind) - kKinds.indexOf(b.kind)),
)

export const listedKinds = signal<ReadonlySet<Kind>>(new Set(kKinds))
export function toggle(kind: Kind): void {
  const kinds = new Set(listedKinds.value)
  if (!kinds.delete(kind)) kinds.add(kind)
  listedKinds.value = kinds
}
export const listed = computed(() => happenings.value.filter((one) => listedKinds.value.has(one.kind)))

// The last one that is listed at or before the cursor; -1: none yet.
const kSame_s = 1e-6
export const current = computed(() => {
  let [low, high] = [0, listed.value.length]
  while (low < high) {
    const middle = (low + high) >> 1
    if (listed.value[middle]!.at > now.value + kSame_s) high = middle
    else low = middle + 1
  }
  return low - 1
})

// The time of the next one, or of the one before.
export function nextTime(step: 1 | -1): number | undefined {
  if (step > 0) return listed.value[current.value + 1]?.at
  return listed.value.findLast((one) => one.at < now.value - kSame_s)?.at
}
