// Points in R, A, S millimetres, and the flat tiles that show them.
import type { Vec3 } from '../robot'

export const add = (a: Vec3, b: Vec3, k = 1): Vec3 => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
export const minus = (a: Vec3, b: Vec3): Vec3 => add(a, b, -1)
export const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
export const length = (a: Vec3) => Math.sqrt(dot(a, a))
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
]

// One tile of the viewer, in CSS pixels: the pixel (x, y) shows the point origin + x * right + y * down.
export interface Rectangle {
  left: number
  top: number
  width: number
  height: number
}
export interface Tile extends Rectangle {
  n: number // of the viewer
  plane: View
  origin: Vec3 // mm at pixel (0, 0) of the canvas
  right: Vec3 // mm per pixel
  down: Vec3
}
export type Plane = 'axial' | 'coronal' | 'sagittal'
export const kPlanes: Plane[] = ['axial', 'coronal', 'sagittal']
// What the large view can show: a plane, the plane along the needle, or the whole from outside.
export type View = Plane | 'needle' | '3-D'
export const kNames: Record<View, string> = {
  axial: 'axial', coronal: 'coronal', sagittal: 'sagittal', needle: 'along the needle', '3-D': '3-D',
}

export const pointAt = (tile: Tile, x: number, y: number): Vec3 => add(add(tile.origin, tile.right, x), tile.down, y)

// Where a point is drawn, and how far in front of or behind the tile's plane it is; the 3-D view has no plane.
export function project(tile: Tile, p: Vec3): { x: number; y: number; off: number } {
  const d = minus(p, tile.origin)
  const n = cross(tile.right, tile.down)
  return {
    x: dot(d, tile.right) / dot(tile.right, tile.right),
    y: dot(d, tile.down) / dot(tile.down, tile.down),
    off: tile.plane === '3-D' ? 0 : dot(d, n) / length(n),
  }
}

// `rows`: 4x4, row by row, of a map with perpendicular axes.
export function voxelOf(rows: readonly number[], p: Vec3): Vec3 {
  const d: Vec3 = [p[0] - rows[3]!, p[1] - rows[7]!, p[2] - rows[11]!]
  const axis = (n: number): Vec3 => [rows[n]!, rows[4 + n]!, rows[8 + n]!]
  const along = (n: number) => dot(d, axis(n)) / dot(axis(n), axis(n))
  return [along(0), along(1), along(2)]
}

// The side of the patient that lies in this direction, as DICOM writes it: the largest part first, and others where they
// are a third of the whole.
const kOblique = 1 / 3
export function lettersOf(way: Vec3, sign: number): string {
  const share = (n: number) => Math.abs(way[n]!) / length(way)
  return [0, 1, 2]
    .sort((a, b) => share(b) - share(a))
    .filter((axis, n) => n === 0 || share(axis) > kOblique)
    .map((axis) => (sign * way[axis]! > 0 ? 'RAS' : 'LPI')[axis]!)
    .join('')
}

// Never "-0.00": what rounds to zero has no sign.
export const mm = (value: number, digits = 1) => {
  const text = value.toFixed(digits)
  return Number(text) === 0 ? text.replace('-', '') : text
}
export const ras = (p: Vec3) => {
  const letters = [p[0] < 0 ? 'L' : 'R', p[1] < 0 ? 'P' : 'A', p[2] < 0 ? 'I' : 'S']
  return p.map((v, n) => `${letters[n]} ${Math.abs(v).toFixed(1)}`).join('  ')
}
