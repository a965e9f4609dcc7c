// What the page shows of the image, compared with the voxels of the file that it shows: not with its own arithmetic.
import { expect, type Page } from '@playwright/test'

import type { Vec3 } from './page_operator'
import { lastEvent } from './tap'

const kPatch_px = 150 // to each side
const kStep_px = 6
const kSearch_px = 6

export interface Nifti {
  size: Vec3
  rows: number[] // 3 x 4: RAS mm of a voxel
  voxels: Float32Array
}

// `which`: the image, or the label map.
export async function readVolume(page: Page, which: 'volume' | 'labels' = 'volume'): Promise<Nifti> {
  const { [which]: volume } = await lastEvent(page, 'Opened')
  const url = new URL(page.url())
  const answer = await page.request.get(`${url.origin}${volume}${url.search}`)
  const bytes = await answer.body()
  const at = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  const size = [1, 2, 3].map((n) => at.getInt16(40 + 2 * n, true)) as Vec3
  const rows = [...Array(12).keys()].map((n) => at.getFloat32(280 + 4 * n, true))
  return { size, rows, voxels: new Float32Array(bytes.buffer.slice(bytes.byteOffset + 352, bytes.byteOffset + bytes.byteLength)) }
}

// The axes of a voxel grid are perpendicular.
export function voxelAt({ rows }: Nifti, p: Vec3): Vec3 {
  const d = [p[0] - rows[3]!, p[1] - rows[7]!, p[2] - rows[11]!]
  return [0, 1, 2].map((n) => {
    const axis = [rows[n]!, rows[4 + n]!, rows[8 + n]!]
    return axis.reduce((sum, a, i) => sum + a * d[i]!, 0) / axis.reduce((sum, a) => sum + a * a, 0)
  }) as Vec3
}

export function valueAt({ size, voxels }: Nifti, v: Vec3): number {
  const low = v.map(Math.floor)
  let sum = 0
  for (let corner = 0; corner < 8; ++corner) {
    const [i, j, k] = low.map((n, axis) => Math.min(Math.max(n + ((corner >> axis) & 1), 0), size[axis]! - 1)) as Vec3
    const weight = v.reduce((w, n, axis) => w * ((corner >> axis) & 1 ? n - low[axis]! : 1 - n + low[axis]!), 1)
    sum += weight * voxels[i + size[0] * (j + size[1] * k)]!
  }
  return sum
}

// The picture alone. By hand: the page's content policy refuses the styles of a screenshot.
export async function bare(page: Page): Promise<Buffer> {
  const show = (shown: boolean) =>
    page.evaluate((visible) => {
      for (const over of document.querySelectorAll<SVGElement>('.overlay')) over.style.visibility = visible ? '' : 'hidden'
      for (const canvas of document.querySelectorAll('canvas')) canvas.style.outline = visible ? '' : 'none'
    }, shown)
  await show(false)
  const shot = await page.locator('.slices').screenshot()
  await show(true)
  return shot
}

// Of the picture without what is drawn over it: red, green and blue of each pixel.
export async function coloursOf(page: Page): Promise<(x: number, y: number) => [number, number, number]> {
  const shot = await bare(page)
  const { width, pixels } = await page.evaluate(async (base64) => {
    const picture = new Image()
    picture.src = `data:image/png;base64,${base64}`
    await picture.decode()
    const canvas = document.createElement('canvas')
    canvas.width = picture.width
    canvas.height = picture.height
    const drawn = canvas.getContext('2d')!
    drawn.drawImage(picture, 0, 0)
    const { data } = drawn.getImageData(0, 0, canvas.width, canvas.height)
    return { width: canvas.width, pixels: Array.from({ length: data.length / 4 }, (_, n) => (data[4 * n]! << 16) | (data[4 * n + 1]! << 8) | data[4 * n + 2]!) }
  }, shot.toString('base64'))
  return (x, y) => {
    const colour = pixels[Math.floor(y) * width + Math.floor(x)] ?? NaN
    return [colour >> 16, (colour >> 8) & 255, colour & 255]
  }
}

// Grey values, NaN where there is a colour.
export async function greyOf(page: Page): Promise<(x: number, y: number) => number> {
  const colours = await coloursOf(page)
  return (x, y) => {
    const [red, green] = colours(x, y)
    return Math.abs(red - green) > 6 ? NaN : red
  }
}

export function correlation(a: number[], b: number[]): number {
  const pairs = a.map((value, n) => [value, b[n]!] as const).filter(([one, other]) => !Number.isNaN(one + other))
  const mean = (of: 0 | 1) => pairs.reduce((sum, pair) => sum + pair[of], 0) / pairs.length
  const [ma, mb] = [mean(0), mean(1)]
  const cross = (f: (x: number, y: number) => number) => pairs.reduce((sum, [x, y]) => sum + f(x - ma, y - mb), 0)
  return cross((x, y) => x * y) / Math.sqrt(cross((x) => x * x) * cross((_x, y) => y * y))
}

// Of a mark in the large view: where it is drawn, and where it is meant, R, A, S in mm.
export async function drawn(page: Page, name: string): Promise<{ x: number; y: number; off: number; mm: Vec3 }> {
  const mark = page.locator(`[data-tile^=large] [data-name=${name}]`)
  return mark.evaluate((g: SVGGElement) => {
    const box = (g as SVGGElement).getBBox()
    const mm = g.dataset.mm!.split(',').map(Number) as [number, number, number]
    return { x: box.x + box.width / 2, y: box.y + box.height / 2, off: Number(g.dataset.offMm), mm }
  })
}

// How wide a millimetre is drawn: of the scale bar and what is written beside it.
export async function pixelsPerMm(page: Page): Promise<number> {
  const scale = page.locator('[data-tile^=large] .scale')
  const bar = await scale.locator('path').evaluate((path: SVGPathElement) => path.getBBox().width)
  return bar / parseFloat((await scale.locator('text').textContent())!)
}

const edge = (page: Page, name: string) => page.locator(`[data-tile^=large] [data-edge=${name}]`).textContent()

// Across and down, as voxel axis and direction: of the letters at the edges.
async function axes(page: Page, { rows }: Nifti): Promise<[Vec3, Vec3]> {
  const way = (letters: string): Vec3 => {
    const side = 'RASLPI'.indexOf(letters[0]!) // the largest part first
    const along = [0, 1, 2].map((n) => (side < 3 ? 1 : -1) * rows[4 * (side % 3) + n]!)
    const axis = along.reduce((best, value, n) => (Math.abs(value) > Math.abs(along[best]!) ? n : best), 0)
    const spacing = Math.hypot(rows[axis]!, rows[4 + axis]!, rows[8 + axis]!)
    return [0, 1, 2].map((n) => (n === axis ? Math.sign(along[n]!) / spacing : 0)) as Vec3
  }
  return [way((await edge(page, 'right'))!), way((await edge(page, 'bottom'))!)]
}

// How far the marks lie beside their voxels, mm: the same voxels must be seen around the target as in the file. Where
// else would the picture fit as well? The target must be near the slice that is shown.
export async function misplaced(page: Page, volume: Nifti): Promise<number> {
  const scale = await pixelsPerMm(page)
  const target = await drawn(page, 'target')
  const [across, down] = await axes(page, volume)
  const centre = voxelAt(volume, target.mm)
  const shown = voxelAt(volume, await crosshairOf(page)) // whose slice it is
  for (let n = 0; n < 3; ++n) if (across[n] === 0 && down[n] === 0) centre[n] = shown[n]!
  const grey = await greyOf(page)
  // Beside the large view begin others, and black.
  const view = await page.locator('[data-tile^=large] rect').first().evaluate((rect: SVGRectElement) => {
    const { x, y, width, height } = rect.getBBox()
    return { left: x, top: y, right: x + width, bottom: y + height }
  })
  const isInside = (x: number, y: number) =>
    x - kSearch_px >= view.left && x + kSearch_px < view.right && y - kSearch_px >= view.top && y + kSearch_px < view.bottom
  const places: [number, number][] = []
  for (let dy = -kPatch_px; dy <= kPatch_px; dy += kStep_px)
    for (let dx = -kPatch_px; dx <= kPatch_px; dx += kStep_px)
      if (isInside(target.x + dx, target.y + dy)) places.push([dx, dy])
  expect(places.length, 'places of the large view around the target').toBeGreaterThan(600)
  const meant = places.map(([dx, dy]) => valueAt(volume, centre.map((c, n) => c + (across[n]! * dx + down[n]! * dy) / scale) as Vec3))
  // What the viewer shows as black or white says nothing about where it is.
  const unclipped = places.map(([dx, dy]) => grey(target.x + dx, target.y + dy)).map((value) => value > 4 && value < 250)
  expect(unclipped.filter((one) => one).length, 'grey pixels around the target').toBeGreaterThan(places.length / 4)
  let best = { fit: -1, dx: 0, dy: 0 }
  for (let dy = -kSearch_px; dy <= kSearch_px; ++dy)
    for (let dx = -kSearch_px; dx <= kSearch_px; ++dx) {
      const fit = correlation(places.map(([px, py], n) => (unclipped[n] ? grey(target.x + px + dx, target.y + py + dy) : NaN)), meant)
      if (fit > best.fit) best = { fit, dx, dy }
    }
  expect(best.fit, 'likeness of the picture to the voxels of the file').toBeGreaterThan(0.95)
  return Math.hypot(best.dx, best.dy) / scale
}

async function crosshairOf(page: Page): Promise<Vec3> {
  const text = await page.locator('[data-name=crosshair]').first().getAttribute('data-mm')
  return text!.split(',').map(Number) as Vec3
}
