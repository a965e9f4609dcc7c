// What the image view shows and can be asked for: signals for the components, acts for buttons, pointer and keys.
import { computed, signal } from '@preact/signals'

import { opened, type Vec3 } from '../robot'
import { add, cross, dot, kPlanes, length, minus, type Plane, type Tile, voxelOf } from './geometry'
import { Scene, type Window } from './scene'

const kZoomMin = 0.5
const kZoomMax = 16
export const kZoomStep = 1.25

export const crosshair = signal<Vec3 | null>(null)
export const tiles = signal<Tile[]>([])
export const large = signal<Plane>('axial')
export const zoom = signal(1)
export const windowed = signal<Window>({ low: 0, high: 1 })
export const moved = signal(false) // zoomed or panned
export const ruling = signal(false) // a left drag measures
export const ruler = signal<{ from: Vec3; to: Vec3 } | null>(null)
export const crossed = signal(true) // the crosshair is drawn

let scene: Scene | null = null
let original: Window = { low: 0, high: 1 }

export async function showVolume(canvas: HTMLCanvasElement, url: string, isGone: () => boolean): Promise<void> {
  const answer = await fetch(url)
  if (!answer.ok) throw new Error(`the image did not arrive: ${answer.status}`)
  const shown = await Scene.open(canvas, await answer.arrayBuffer(), follow)
  if (isGone()) return shown.dispose()
  scene = shown
  original = shown.window
  windowed.value = original
  shown.arrange(large.value)
  follow(shown)
}

export function hideVolume(): void {
  scene?.dispose()
  scene = null
  crosshair.value = ruler.value = null
  tiles.value = []
  zoom.value = 1
  moved.value = ruling.value = false
}

function follow(of: Scene): void {
  crosshair.value = of.crosshair
  tiles.value = of.tiles()
  zoom.value = of.zoom
}

export function arrange(plane: Plane): void {
  large.value = plane
  scene?.arrange(plane)
}

export const moveTo = (p: Vec3) => scene?.moveTo(p)

// Slices

const kAlong: Record<Plane, number> = { axial: 2, coronal: 1, sagittal: 0 }

// The voxel axis through the slices of a plane: its direction towards S, A or R, the distance of two slices in mm, the
// number of slices, and which one a point lies in, from 0.
interface Stack {
  axis: Vec3
  spacing: number
  count: number
  at(p: Vec3): number
}
export function stackOf(tile: Tile): Stack {
  const series = opened.value!.series
  const rows = series.ras_from_voxel
  const normal = cross(tile.right, tile.down)
  const columns = [0, 1, 2].map((n) => [rows[n]!, rows[4 + n]!, rows[8 + n]!] as Vec3)
  const share = columns.map((column) => Math.abs(dot(column, normal)) / length(column))
  const n = share.indexOf(Math.max(...share))
  const column = columns[n]!
  const sign = column[kAlong[tile.plane]]! < 0 ? -1 : 1
  const count = series.size[n]!
  const at = (p: Vec3) => (sign > 0 ? voxelOf(rows, p)[n]! : count - 1 - voxelOf(rows, p)[n]!)
  return { axis: column.map((v) => (sign * v) / length(column)) as Vec3, spacing: length(column), count, at }
}

// In the plane nothing changes.
export function moveSlice(tile: Tile, slices: number): void {
  if (!crosshair.value) return
  const stack = stackOf(tile)
  const there = stack.at(crosshair.value) + slices
  if (there < -0.5 || there > stack.count - 0.5) return
  moveTo(add(crosshair.value, stack.axis, slices * stack.spacing))
}

export function toSlice(tile: Tile, slice: number): void {
  if (!crosshair.value) return
  const stack = stackOf(tile)
  moveTo(add(crosshair.value, stack.axis, (slice - stack.at(crosshair.value)) * stack.spacing))
}

export const largeTile = computed(() => tiles.value[0])

// Zoom, pan and window

export function zoomBy(factor: number): void {
  if (!scene) return
  scene.zoomTo(Math.min(Math.max(scene.zoom * factor, kZoomMin), kZoomMax))
  moved.value = true
}

export function pan(tile: Tile, from: [number, number], to: [number, number]): void {
  scene?.pan(tile.n, from, to)
  moved.value = true
}

export function resetView(): void {
  scene?.resetView()
  if (scene) setWindow(original)
  moved.value = false
}

function setWindow(to: Window): void {
  if (!scene) return
  scene.window = to
  windowed.value = to
}

// Wider by `width` and brighter by `level`, as shares of the present width.
export function changeWindow(width: number, level: number): void {
  const { low, high } = windowed.value
  const whole = original.high - original.low
  const now = high - low
  const wide = Math.min(Math.max(now * (1 + width), whole / 50), whole * 4)
  const middle = Math.min(Math.max((low + high) / 2 + level * now, original.low - whole), original.high + whole)
  setWindow({ low: middle - wide / 2, high: middle + wide / 2 })
  moved.value = true
}

export const rulerLength = computed(() => (ruler.value ? length(minus(ruler.value.to, ruler.value.from)) : 0))
export { kPlanes }
