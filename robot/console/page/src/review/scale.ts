// One horizontal scale for lanes, plots and cursor: the axis' numbers stand left of it, in all of them.
import { signal } from '@preact/signals'

import { view } from './time'

export const kLeft_px = 92
export const kRight_px = 14
export const width = signal(800) // px, of the whole timeline

export const inner = () => Math.max(width.value - kLeft_px - kRight_px, 100)

export function xOf(time: number): number {
  const [from, to] = view.value
  return kLeft_px + ((time - from) / (to - from)) * inner()
}
export function timeAt(x: number): number {
  const [from, to] = view.value
  return from + ((x - kLeft_px) / inner()) * (to - from)
}
