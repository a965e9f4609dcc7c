// The case's label map: names under the pointer, colours painted over the image.
import { signal } from '@preact/signals'

import { opened, type Vec3 } from '../robot'
import { nearestAt, type Voxels } from './voxels'

export type Colour = [number, number, number]
// Apart from each other for most kinds of colour vision, and none of them a colour of a mark.
const kColours: Colour[] = [
  [230, 159, 0], [86, 140, 233], [0, 158, 115], [213, 94, 0], [190, 170, 120], [120, 94, 240], [170, 68, 153], [136, 204, 90],
]
const kOpacityAtFirst = 0.35
export const kOpacityStep = 0.1

export const labels = signal<Voxels | null>(null)
export const opacity = signal(0) // of the colours; 0: not painted
let last = kOpacityAtFirst // to which the key brings them back

export function setOpacity(to: number): void {
  opacity.value = Math.min(Math.max(Math.round(100 * to) / 100, 0), 1)
  if (opacity.value > 0) last = opacity.value
}
export const paintOrNot = () => setOpacity(opacity.value > 0 ? 0 : last)

// Of what has no name and of 0, which is no tissue, nothing is painted.
export const coloured = () => (opened.value?.tissues ?? []).filter((tissue) => tissue.value > 0)
export function colourOf(value: number): Colour | null {
  const n = coloured().findIndex((tissue) => tissue.value === value)
  return n < 0 ? null : kColours[n % kColours.length]!
}

// Empty: no label map, or outside of it.
export function tissueAt(p: Vec3): string {
  const value = labels.value && nearestAt(labels.value, p)
  if (value === null) return ''
  return opened.value?.tissues.find((tissue) => tissue.value === value)?.name ?? (value === 0 ? 'no label' : `label ${value}`)
}
