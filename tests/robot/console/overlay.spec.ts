// Positions drawn over the image, in mm of the patient: checked against the voxels of the file that the page shows, not
// against the page's own arithmetic.
import { expect, type Page, test } from '@playwright/test'

import { note, round } from './figures'
import { distance, PageOperator, type Vec3 } from './page_operator'
import { Robot } from './robot'
import { lastEvent, freezePage } from './tap'

const kNear_mm = 0.1
const kVoxel_mm = 0.25 // of the phantom; the comparison of images resolves two thirds of it
const kPatch_px = 150 // to each side
const kStep_px = 6
const kSearch_px = 6

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

interface Nifti {
  size: Vec3
  rows: number[] // 3 x 4: RAS mm of a voxel
  voxels: Float32Array
}

async function readVolume(page: Page): Promise<Nifti> {
  const { volume } = await lastEvent(page, 'Opened')
  const url = new URL(robot.url)
  const answer = await page.request.get(`${url.origin}${volume}${url.search}`)
  const bytes = await answer.body()
  const at = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  const size = [1, 2, 3].map((n) => at.getInt16(40 + 2 * n, true)) as Vec3
  const rows = [...Array(12).keys()].map((n) => at.getFloat32(280 + 4 * n, true))
  return { size, rows, voxels: new Float32Array(bytes.buffer.slice(bytes.byteOffset + 352, bytes.byteOffset + bytes.byteLength)) }
}

// The axes of a voxel grid are perpendicular.
function voxelAt({ rows }: Nifti, p: Vec3): Vec3 {
  const d = [p[0] - rows[3]!, p[1] - rows[7]!, p[2] - rows[11]!]
  return [0, 1, 2].map((n) => {
    const axis = [rows[n]!, rows[4 + n]!, rows[8 + n]!]
    return axis.reduce((sum, a, i) => sum + a * d[i]!, 0) / axis.reduce((sum, a) => sum + a * a, 0)
  }) as Vec3
}

function valueAt({ size, voxels }: Nifti, v: Vec3): number {
  const low = v.map(Math.floor)
  let sum = 0
  for (let corner = 0; corner < 8; ++corner) {
    const [i, j, k] = low.map((n, axis) => Math.min(Math.max(n + ((corner >> axis) & 1), 0), size[axis]! - 1)) as Vec3
    const weight = v.reduce((w, n, axis) => w * ((corner >> axis) & 1 ? n - low[axis]! : 1 - n + low[axis]!), 1)
    sum += weight * voxels[i + size[0] * (j + size[1] * k)]!
  }
  return sum
}

// Of the picture without what is drawn over it: grey values, NaN where the viewer's crosshair is.
async function greyOf(page: Page): Promise<(x: number, y: number) => number> {
  const shot = await page.locator('.slices').screenshot({ style: '.overlay { visibility: hidden }' })
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
    return { width: canvas.width, pixels: Array.from({ length: data.length / 4 }, (_, n) => (Math.abs(data[4 * n]! - data[4 * n + 1]!) > 6 ? -1 : data[4 * n]!)) }
  }, shot.toString('base64'))
  return (x, y) => {
    const grey = pixels[Math.floor(y) * width + Math.floor(x)] ?? -1
    return grey < 0 ? NaN : grey
  }
}

function correlation(a: number[], b: number[]): number {
  const pairs = a.map((value, n) => [value, b[n]!] as const).filter(([one, other]) => !Number.isNaN(one + other))
  const mean = (of: 0 | 1) => pairs.reduce((sum, pair) => sum + pair[of], 0) / pairs.length
  const [ma, mb] = [mean(0), mean(1)]
  const cross = (f: (x: number, y: number) => number) => pairs.reduce((sum, [x, y]) => sum + f(x - ma, y - mb), 0)
  return cross((x, y) => x * y) / Math.sqrt(cross((x) => x * x) * cross((_x, y) => y * y))
}

// Of a mark in the large view: where it is drawn, and where it is meant, R, A, S in mm.
async function drawn(page: Page, name: string): Promise<{ x: number; y: number; off: number; mm: Vec3 }> {
  const mark = page.locator(`[data-tile^=large] [data-name=${name}]`)
  return mark.evaluate((g: SVGGElement) => {
    const box = (g as SVGGElement).getBBox()
    const mm = g.dataset.mm!.split(',').map(Number) as [number, number, number]
    return { x: box.x + box.width / 2, y: box.y + box.height / 2, off: Number(g.dataset.offMm), mm }
  })
}

// How wide a millimetre is drawn: of the scale bar and what is written beside it.
async function pixelsPerMm(page: Page): Promise<number> {
  const scale = page.locator('[data-tile^=large] .scale')
  const bar = await scale.locator('path').evaluate((path: SVGPathElement) => path.getBBox().width)
  return bar / parseFloat((await scale.locator('text').textContent())!)
}

const edge = (page: Page, name: string) => page.locator(`[data-tile^=large] [data-edge=${name}]`).textContent()

// Across and down, as voxel axis and direction: of the letters at the edges.
async function axes(page: Page, { rows }: Nifti): Promise<[Vec3, Vec3]> {
  const way = (letter: string): Vec3 => {
    const side = 'RASLPI'.indexOf(letter)
    const along = [0, 1, 2].map((n) => (side < 3 ? 1 : -1) * rows[4 * (side % 3) + n]!)
    const axis = along.reduce((best, value, n) => (Math.abs(value) > Math.abs(along[best]!) ? n : best), 0)
    const spacing = Math.hypot(rows[axis]!, rows[4 + axis]!, rows[8 + axis]!)
    return [0, 1, 2].map((n) => (n === axis ? Math.sign(along[n]!) / spacing : 0)) as Vec3
  }
  return [way((await edge(page, 'right'))!), way((await edge(page, 'bottom'))!)]
}

test('the marks lie on the voxels they mean, in each plane', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  const volume = await readVolume(page)
  const fits: number[] = []
  for (const plane of ['axial', 'coronal', 'sagittal']) {
    await operator.button(plane).click()
    await expect(page.locator(`[data-tile="large ${plane}"]`)).toBeAttached()
    const scale = await pixelsPerMm(page)
    const target = await drawn(page, 'target')
    const entry = await drawn(page, 'entry')
    expect(Math.abs(target.off)).toBeLessThan(kNear_mm) // the crosshair is on it
    // Beside it the same voxels must be seen as in the file. Where else would the picture fit as well?
    const [across, down] = await axes(page, volume)
    const centre = voxelAt(volume, target.mm)
    const shown = voxelAt(volume, await operator.mm('crosshair')) // whose slice it is
    for (let n = 0; n < 3; ++n) if (across[n] === 0 && down[n] === 0) centre[n] = shown[n]!
    const grey = await greyOf(page)
    const places: [number, number][] = []
    for (let dy = -kPatch_px; dy <= kPatch_px; dy += kStep_px)
      for (let dx = -kPatch_px; dx <= kPatch_px; dx += kStep_px) places.push([dx, dy])
    const meant = places.map(([dx, dy]) => valueAt(volume, centre.map((c, n) => c + (across[n]! * dx + down[n]! * dy) / scale) as Vec3))
    // What the viewer shows as black or white says nothing about where it is.
    const unclipped = places.map(([dx, dy]) => grey(target.x + dx, target.y + dy)).map((value) => value > 4 && value < 250)
    let best = { fit: -1, dx: 0, dy: 0 }
    for (let dy = -kSearch_px; dy <= kSearch_px; ++dy)
      for (let dx = -kSearch_px; dx <= kSearch_px; ++dx) {
        const fit = correlation(places.map(([px, py], n) => (unclipped[n] ? grey(target.x + px + dx, target.y + py + dy) : NaN)), meant)
        if (fit > best.fit) best = { fit, dx, dy }
      }
    expect(best.fit).toBeGreaterThan(0.95)
    fits.push(Math.hypot(best.dx, best.dy) / scale)
    // Entry and path are where they are relative to the target.
    const seen = Math.hypot(entry.x - target.x, entry.y - target.y) / scale
    expect(Math.abs(Math.hypot(seen, entry.off - target.off) - distance(entry.mm, target.mm))).toBeLessThan(kNear_mm)
    const path = await page.locator('[data-tile^=large] [data-name=path]').evaluate((line: SVGLineElement) =>
      [line.x1, line.y1, line.x2, line.y2].map((end) => end.baseVal.value))
    expect(Math.hypot(path[0]! - entry.x, path[1]! - entry.y) / scale).toBeLessThan(kNear_mm)
    expect(Math.hypot(path[2]! - target.x, path[3]! - target.y) / scale).toBeLessThan(kNear_mm)
  }
  note({ overlay_on_picture_mm: fits.map((one) => round(one, 2)) })
  for (const apart of fits) expect(apart).toBeLessThan(kVoxel_mm)
})

test('the live tip lies on the path at its depth, and hollow once it is old', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const depth = 1.5
  await freezePage(page, { mode: 'Active', step: 'Insert', depth })
  const [entry, target, tip] = await Promise.all(['entry', 'target', 'tip'].map((name) => drawn(page, name)))
  expect(Math.abs(distance(tip!.mm, entry!.mm) - depth)).toBeLessThan(kNear_mm)
  expect(distance(tip!.mm, entry!.mm) + distance(tip!.mm, target!.mm)).toBeCloseTo(distance(entry!.mm, target!.mm), 2)
  const share = depth / distance(entry!.mm, target!.mm)
  const scale = await pixelsPerMm(page)
  const [x, y] = [entry!.x + share * (target!.x - entry!.x), entry!.y + share * (target!.y - entry!.y)]
  expect(Math.hypot(tip!.x - x, tip!.y - y) / scale).toBeLessThan(kNear_mm)
  await expect(page.locator('[data-tile^=large] .tip .solid')).toHaveCount(1)

  await page.evaluate(() => clearInterval((window as unknown as { stillTimer: number }).stillTimer))
  await expect(page.locator('[data-tile^=large] .tip .hollow')).toHaveCount(1)
  await expect(page.locator('[data-tile^=large] .tip')).toContainText('OLD')
})

test('wheel and arrows move by what they say', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await operator.clickAt('target')
  const spacing = (await lastEvent(page, 'Opened')).series.spacing[0]
  const moved = async (key: string) => {
    const from = await operator.mm('crosshair')
    await page.keyboard.press(key)
    await expect.poll(async () => distance(await operator.mm('crosshair'), from)).toBeGreaterThan(0)
    return distance(await operator.mm('crosshair'), from)
  }
  await page.locator('canvas[tabindex]').focus()
  expect(await moved('ArrowRight')).toBeCloseTo(spacing, 2)
  expect(await moved('Shift+ArrowUp')).toBeCloseTo(0.1, 2)
  const start = await operator.mm('crosshair')
  // The first turn of the wheel also goes to the middle of a voxel.
  await page.mouse.wheel(0, 100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), start)).toBeGreaterThan(0)
  const before = await operator.mm('crosshair')
  await page.mouse.wheel(0, 100)
  await expect.poll(async () => distance(await operator.mm('crosshair'), before)).toBeCloseTo(spacing, 2)
})
