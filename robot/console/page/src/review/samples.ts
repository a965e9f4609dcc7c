// Samples at a time and within a span of time.
import type { Run } from './runs'

// The last one at or before this time of the run; -1: before the first, or after the end.
export function indexAt(run: Run, own: number): number {
  if (own > run.end + 1e-9) return -1
  return firstAfter(run.time, own + 1e-9) - 1
}

export function firstAfter(time: Float64Array, at: number): number {
  let [low, high] = [0, time.length]
  while (low < high) {
    const middle = (low + high) >> 1
    if (time[middle]! > at) high = middle
    else low = middle + 1
  }
  return low
}

// The sample before or after the one that is shown.
export function neighbour(run: Run, own: number, step: 1 | -1): number {
  const shown = firstAfter(run.time, own + 1e-9) - 1
  return run.time[Math.min(Math.max(shown + step, 0), run.time.length - 1)]!
}

export interface Curve {
  at: number[] // s, of the run
  values: (number | null)[] // null: here samples are missing
}

const kGap_s = 0.01 // ten ticks

// What a screen of `places` columns can show of a column: each sample where they are few, otherwise the lowest and the
// highest of each place, so that no spike is lost.
export function curveOf(run: Run, values: Float64Array, from: number, to: number, places: number): Curve {
  const first = Math.max(firstAfter(run.time, from) - 1, 0)
  const last = Math.min(firstAfter(run.time, to), run.time.length - 1)
  const curve: Curve = { at: [], values: [] }
  const add = (index: number) => {
    curve.at.push(run.time[index]!)
    curve.values.push(values[index]!)
  }
  // Samples are missing before this one.
  const breaks = (index: number) => index > first && run.time[index]! - run.time[index - 1]! > kGap_s
  const breakAt = (index: number) => {
    curve.at.push((run.time[index - 1]! + run.time[index]!) / 2)
    curve.values.push(null)
  }
  const width = last - first > 2 * places ? (to - from) / places : 0
  for (let index = first; index <= last; ) {
    const until = from + width * (Math.floor((run.time[index]! - from) / width) + 1)
    let [low, high] = [index, index]
    if (breaks(index)) breakAt(index)
    for (++index; index <= last && run.time[index]! < until && !breaks(index); ++index) {
      if (values[index]! < values[low]!) low = index
      if (values[index]! > values[high]!) high = index
    }
    add(Math.min(low, high))
    if (low !== high) add(Math.max(low, high))
  }
  return curve
}
