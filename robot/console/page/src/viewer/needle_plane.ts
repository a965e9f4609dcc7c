// The plane along the needle: the path runs from the top of the view down, whatever way the slices lie. It can be turned
// about the path, so that all that lies beside it is seen.
import { batch, computed, signal } from '@preact/signals'

import type { Vec3 } from '../robot'
import { add, cross, dot, length, minus, type Rectangle, type Tile } from './geometry'
import { path } from './path'
import type { Window } from './scene'
import { colourOf } from './tissues'
import { nearestAt, sampleRow, type Voxels } from './voxels'

const kShown_mm = 40 // at least, across the smaller side
const kShownPaths = 3 // lengths of the path
const kTooNear = 0.3 // of the needle to the patient's right-left axis, as a cosine
const kWholeTurn_deg = 360

export const turned = signal(0) // deg, about the path
const moved = signal<[number, number]>([0, 0]) // mm, right and down

const unit = (a: Vec3): Vec3 => a.map((v) => v / length(a)) as Vec3

// Across the needle: towards the patient's left as in the other views, or, for a needle that points there, backwards.
function across(down: Vec3): Vec3 {
  const flat = (a: Vec3) => add(a, down, -dot(a, down))
  const left = flat([-1, 0, 0])
  return unit(length(left) > kTooNear ? left : flat([0, -1, 0]))
}

export const hasNeedlePlane = computed(() => path.value !== null && length(minus(path.value.to, path.value.from)) > 0.01)

export function needleTile(box: Rectangle, zoom: number): Tile | null {
  if (!path.value || !hasNeedlePlane.value) return null
  const way = minus(path.value.to, path.value.from)
  const down = unit(way)
  const zero = across(down)
  const angle = (turned.value * Math.PI) / 180
  const right = add(zero.map((v) => v * Math.cos(angle)) as Vec3, cross(down, zero), Math.sin(angle))
  const perPixel = Math.max(kShown_mm, kShownPaths * length(way)) / Math.min(box.width, box.height) / zoom
  const scaled = (a: Vec3) => a.map((v) => v * perPixel) as Vec3
  const [r, d] = [scaled(right), scaled(down)]
  const middle = add(add(add(path.value.from, way, 0.5), right, moved.value[0]), down, moved.value[1])
  const origin = add(add(middle, r, -(box.left + box.width / 2)), d, -(box.top + box.height / 2))
  return { n: -1, plane: 'needle', ...box, origin, right: r, down: d }
}

export const turnBy = (deg: number) => void (turned.value = (turned.value + deg + kWholeTurn_deg) % kWholeTurn_deg)

export function panNeedle(tile: Tile, from: [number, number], to: [number, number]): void {
  const perPixel = length(tile.right)
  const [x, y] = moved.value
  moved.value = [x - (to[0] - from[0]) * perPixel, y - (to[1] - from[1]) * perPixel]
}
export const resetNeedle = () =>
  batch(() => {
    moved.value = [0, 0]
    turned.value = 0
  })

// Grey as in the other views; tissues painted over.
export function paintTile(picture: ImageData, tile: Tile, image: Voxels, window: Window, labels: Voxels | null, opacity: number): void {
  const { data, width, height } = picture
  const ratio = tile.width / width // CSS pixels per pixel of the picture
  const row = new Float32Array(width)
  const grey = 255 / Math.max(window.high - window.low, 1e-9)
  const step = tile.right.map((v) => v * ratio) as Vec3
  for (let y = 0; y < height; ++y) {
    const first = add(add(tile.origin, tile.right, tile.left + ratio / 2), tile.down, tile.top + ratio * (y + 0.5))
    sampleRow(image, first, step, window.low, row)
    for (let x = 0; x < width; ++x) {
      const at = 4 * (x + width * y)
      const value = Math.min(Math.max((row[x]! - window.low) * grey, 0), 255)
      data[at] = data[at + 1] = data[at + 2] = value
      data[at + 3] = 255
      if (!labels || opacity === 0) continue
      const label = nearestAt(labels, add(first, step, x))
      const colour = label === null ? null : colourOf(label)
      if (colour) for (let n = 0; n < 3; ++n) data[at + n] = value * (1 - opacity) + colour[n]! * opacity
    }
  }
}
