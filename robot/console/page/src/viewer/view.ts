// What the image view shows and can be asked for: signals for the components, acts for buttons, pointer and keys.
import { computed, effect, signal } from '@preact/signals'

import { opened, type Vec3 } from '../robot'
import { add, cross, dot, kPlanes, length, minus, type Plane, type Tile, type View, voxelOf } from './geometry'
import { hasNeedlePlane, needleTile, panNeedle, resetNeedle, turnBy } from './needle_plane'
import { Scene, type Window } from './scene'
import { colourOf, coloured, labels, opacity, setOpacity } from './tissues'
import { labelFile, type Voxels, voxelsOf } from './voxels'

const kZoomMin = 0.5
const kZoomMax = 16
export const kZoomStep = 1.25

export const crosshair = signal<Vec3 | null>(null)
const drawn = signal<Tile[]>([]) // by the viewer, in its last frame
export const large = signal<View>('axial')
export const voxels = signal<Voxels | null>(null)
export const pointed = signal<Vec3 | null>(null) // under the pointer
export const zoom = signal(1)
export const windowed = signal<Window>({ low: 0, high: 1 })
export const moved = signal(false) // zoomed or panned
export const ruling = signal(false) // a left drag measures
export const ruler = signal<{ from: Vec3; to: Vec3 } | null>(null)
export const crossed = signal(true) // the crosshair is drawn

let scene: Scene | null = null
let original: Window = { low: 0, high: 1 }

async function load(url: string): Promise<ArrayBuffer> {
  const answer = await fetch(url)
  if (!answer.ok) throw new Error(`the image did not arrive: ${answer.status}`)
  return answer.arrayBuffer()
}

// `labelsUrl`: empty where there is no label map.
export async function showVolume(canvas: HTMLCanvasElement, url: string, labelsUrl: string, isGone: () => boolean): Promise<void> {
  const file = await load(url)
  const tissues = labelsUrl ? await load(labelsUrl) : null
  const shown = await Scene.open(canvas, file, follow)
  if (tissues && !isGone()) {
    labels.value = voxelsOf(tissues)
    const values = coloured().map((tissue) => tissue.value)
    await shown.paint(labelFile(labels.value, tissues), values, colourOf)
  }
  if (isGone()) return shown.dispose()
  voxels.value = voxelsOf(file)
  scene = shown
  if (large.value === 'needle' && !hasNeedlePlane.value) large.value = 'axial'
  original = shown.window
  windowed.value = original
  shown.arrange(large.value)
  follow(shown)
}

export function hideVolume(): void {
  scene?.dispose()
  scene = null
  crosshair.value = ruler.value = pointed.value = null
  voxels.value = labels.value = null
  drawn.value = []
  setOpacity(0)
  zoom.value = 1
  moved.value = ruling.value = false
}

function follow(of: Scene): void {
  crosshair.value = of.crosshair
  drawn.value = of.tiles()
  zoom.value = of.zoom
}

// The large view first.
export const tiles = computed<Tile[]>(() => {
  const needle = large.value === 'needle' && scene && drawn.value.length ? needleTile(scene.largeBox, zoom.value) : null
  return needle ? [needle, ...drawn.value] : drawn.value
})

export const whyNoNeedlePlane = computed(() => (hasNeedlePlane.value ? '' : 'Set entry and target first.'))

export function arrange(to: View): void {
  if (to === 'needle' && !hasNeedlePlane.value) return
  large.value = to
  pointed.value = null
  scene?.arrange(to)
}

effect(() => {
  const to = opacity.value // read in any case: there may be no image yet
  scene?.setOpacity(to)
})

export const moveTo = (p: Vec3) => scene?.moveTo(p)

// Slices

const kAlong: Record<Plane, number> = { axial: 2, coronal: 1, sagittal: 0 }

// The voxel axis through the slices of a plane: its direction towards S, A or R, the distance of two slices in mm, the
// number of slices, and which one a point lies in, from 0.
export interface Stack {
  axis: Vec3
  spacing: number
  count: number
  at(p: Vec3): number
}
export function stackOf(tile: Tile & { plane: Plane }): Stack {
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

export const isPlane = (tile: Tile): tile is Tile & { plane: Plane } => kPlanes.includes(tile.plane as Plane)

const kTurn_deg = 5

// In the plane nothing changes. The plane along the needle turns about it; the 3-D view, about the patient's long axis.
export function moveSlice(tile: Tile, slices: number): void {
  if (tile.plane === 'needle') turnBy(slices * kTurn_deg)
  if (tile.plane === '3-D') turn3d(slices * kTurn_deg, 0)
  if (!crosshair.value || !isPlane(tile)) return
  const stack = stackOf(tile)
  const there = stack.at(crosshair.value) + slices
  if (there < -0.5 || there > stack.count - 0.5) return
  moveTo(add(crosshair.value, stack.axis, slices * stack.spacing))
}

// Between slices too, mm.
export function moveThrough(tile: Tile, by: number): void {
  if (crosshair.value && isPlane(tile)) moveTo(add(crosshair.value, stackOf(tile).axis, by))
}

export const turn3d = (azimuth: number, elevation: number) => scene?.turn(azimuth, elevation)

export function toSlice(tile: Tile & { plane: Plane }, slice: number): void {
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
  if (tile.plane === 'needle') panNeedle(tile, from, to)
  else if (isPlane(tile)) scene?.pan(tile.n, from, to)
  else return
  moved.value = true
}

export function resetView(): void {
  resetNeedle()
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
