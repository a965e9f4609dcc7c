// A volume as the server sends it: NIfTI of 32-bit floats, one axis of the file a voxel axis, R, A, S in mm.
import type { Vec3 } from '../robot'
import { voxelOf } from './geometry'

const kHeader = 352
const kSize_at = 42
const kRows_at = 280
const [kIntent_at, kType_at, kBits_at] = [68, 70, 72]
const kLabels = 1002
const kInt16 = 4

export interface Voxels {
  size: Vec3
  rows: number[] // 3x4, row by row: mm of a voxel
  values: Float32Array
}

export function voxelsOf(file: ArrayBuffer): Voxels {
  const header = new DataView(file, 0, kHeader)
  const size = [0, 1, 2].map((n) => header.getInt16(kSize_at + 2 * n, true)) as Vec3
  const rows = Array.from({ length: 12 }, (_, n) => header.getFloat32(kRows_at + 4 * n, true))
  return { size, rows, values: new Float32Array(file, kHeader) }
}

// Of the voxel that a point lies in; null: outside.
export function nearestAt({ size, rows, values }: Voxels, p: Vec3): number | null {
  const [i, j, k] = voxelOf(rows, p).map(Math.round) as Vec3
  if (i < 0 || j < 0 || k < 0 || i >= size[0] || j >= size[1] || k >= size[2]) return null
  return values[i + size[0] * (j + size[1] * k)]!
}

// Sampled along a row of points, from `first` in equal steps, mm: trilinear between voxels, `outside` beyond the outermost
// half voxel. Steps are made in voxels, since a map of a point costs more than the sample.
export function sampleRow(of: Voxels, first: Vec3, step: Vec3, outside: number, into: Float32Array): void {
  const { size: [nx, ny, nz], rows, values } = of
  const at = voxelOf(rows, first)
  const next = voxelOf(rows, [first[0] + step[0], first[1] + step[1], first[2] + step[2]])
  const [dx, dy, dz] = [next[0] - at[0], next[1] - at[1], next[2] - at[2]]
  for (let n = 0; n < into.length; ++n) {
    const x = at[0] + n * dx, y = at[1] + n * dy, z = at[2] + n * dz
    if (!(x >= -0.5 && y >= -0.5 && z >= -0.5 && x <= nx - 0.5 && y <= ny - 0.5 && z <= nz - 0.5)) {
      into[n] = outside
      continue
    }
    const cx = Math.min(Math.max(x, 0), nx - 1), cy = Math.min(Math.max(y, 0), ny - 1), cz = Math.min(Math.max(z, 0), nz - 1)
    const i = Math.min(Math.floor(cx), Math.max(nx - 2, 0)), j = Math.min(Math.floor(cy), Math.max(ny - 2, 0)), k = Math.min(Math.floor(cz), Math.max(nz - 2, 0))
    const [fx, fy, fz] = [cx - i, cy - j, cz - k]
    const sx = nx > 1 ? 1 : 0, sy = ny > 1 ? nx : 0, sz = nz > 1 ? nx * ny : 0
    const o = i + nx * (j + ny * k)
    const along = (from: number) => values[from]! * (1 - fx) + values[from + sx]! * fx
    const slice = (from: number) => along(from) * (1 - fy) + along(from + sy) * fy
    into[n] = slice(o) * (1 - fz) + slice(o + sz) * fz
  }
}

// The same as a label map that the viewer paints voxel by voxel: 16-bit whole numbers.
export function labelFile({ values }: Voxels, file: ArrayBuffer): ArrayBuffer {
  const made = new ArrayBuffer(kHeader + 2 * values.length)
  new Uint8Array(made).set(new Uint8Array(file, 0, kHeader))
  const header = new DataView(made)
  header.setInt16(kIntent_at, kLabels, true)
  header.setInt16(kType_at, kInt16, true)
  header.setInt16(kBits_at, 16, true)
  new Int16Array(made, kHeader).set(values)
  return made
}
