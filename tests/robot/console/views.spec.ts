// The views beside the three planes, judged by the voxels of the files that they show: along the needle, tissues painted
// over, 3-D; and the reach before anything is set.
import { expect, type Page, test } from '@playwright/test'

import { expectAccessible } from './support/accessibility'
import { distance, PageOperator, type Vec3 } from './support/page_operator'
import { coloursOf, correlation, drawn, greyOf, type Nifti, pixelsPerMm, readVolume, valueAt, voxelAt } from './support/picture'
import { Robot } from './support/robot'
import { checkedOf, kScenes, showScene } from './support/scenes'
import { lastEvent } from './support/tap'

const robot = new Robot()
test.describe.configure({ mode: 'serial' }) // the first test needs a page without points
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

const minus = (a: Vec3, b: Vec3) => a.map((v, n) => v - b[n]!) as Vec3
const dot = (a: Vec3, b: Vec3) => a.reduce((sum, v, n) => sum + v * b[n]!, 0)
const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

const large = (page: Page, name: string) => page.locator(`[data-tile^=large] [data-name=${name}]`)
async function box(page: Page): Promise<{ x: number; y: number; width: number; height: number }> {
  return (await page.locator('[data-tile^=large] rect').first().boundingBox())!
}
async function press(page: Page, ...keys: string[]): Promise<void> {
  await page.locator('canvas[tabindex]').focus()
  for (const key of keys) await page.keyboard.press(key)
}

// Pixel of the canvas to mm: from three clicks, and where the page then says that its crosshair is.
async function mapOf(operator: PageOperator): Promise<(x: number, y: number) => Vec3> {
  const { page } = operator
  const canvas = (await page.locator('canvas[tabindex]').boundingBox())!
  const { x, y, width, height } = await box(page)
  const [cx, cy] = [Math.round(x - canvas.x + width / 2), Math.round(y - canvas.y + height / 2)]
  const at = async (px: number, py: number) => {
    const before = await operator.mm('crosshair')
    await page.mouse.click(canvas.x + px, canvas.y + py)
    await expect.poll(async () => distance(await operator.mm('crosshair'), before)).toBeGreaterThan(0)
    return operator.mm('crosshair')
  }
  const [a, b, c] = [await at(cx + 7, cy - 5), await at(cx + 67, cy - 5), await at(cx + 7, cy + 55)]
  const [right, down] = [minus(b, a), minus(c, a)]
  return (px, py) => a.map((v, n) => v + (right[n]! * (px - cx - 7)) / 60 + (down[n]! * (py - cy + 5)) / 60) as Vec3
}

test('before an entry is set, the reach is drawn around the crosshair and goes with it', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await operator.openSeries()
  const { reach } = await lastEvent(page, 'Opened')
  for (const [dx, dy] of [[-80, 40], [60, -30]] as const) {
    const { x, y, width, height } = await box(page)
    await page.mouse.click(x + width / 2 + dx, y + height / 2 + dy)
    await expect.poll(async () => {
      const circle = (await large(page, 'reach').boundingBox())!
      return Math.hypot(circle.x + circle.width / 2 - (x + width / 2 + dx), circle.y + circle.height / 2 - (y + height / 2 + dy))
    }).toBeLessThan(2)
    const radius = await large(page, 'reach').evaluate((circle: SVGCircleElement) => circle.r.baseVal.value)
    expect(Math.abs(radius / (await pixelsPerMm(page)) - reach)).toBeLessThan(0.1)
  }
  await expect(operator.button('3-D')).toHaveAttribute('aria-disabled', 'false')
})

for (const turns of [0, 7])
  test(`along the needle, turned by ${5 * turns} deg: the path runs down, the picture is that of the file`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const volume = await readVolume(page)
    await press(page, '4')
    await expect(page.locator('[data-tile="large needle"]')).toBeAttached()
    await press(page, ...Array(turns).fill('PageUp'))
    await expect(page.locator('[data-name=turned]')).toHaveText(String(5 * turns))
    const [entry, target, scale] = [await drawn(page, 'entry'), await drawn(page, 'target'), await pixelsPerMm(page)]
    // Both ends lie in the plane, and the way is drawn downwards, as long as it is.
    expect(Math.max(Math.abs(entry.off), Math.abs(target.off))).toBeLessThan(0.001)
    expect(Math.abs(target.x - entry.x)).toBeLessThan(0.1)
    expect((target.y - entry.y) / scale).toBeCloseTo(distance(entry.mm, target.mm), 2)
    const at = await mapOf(operator)
    // The map of the clicks: as large as the scale bar says, at right angles, and it holds entry and target.
    const [origin, right, down] = [at(0, 0), minus(at(1, 0), at(0, 0)), minus(at(0, 1), at(0, 0))]
    expect(Math.sqrt(dot(right, right)) * scale).toBeCloseTo(1, 2)
    expect(Math.sqrt(dot(down, down)) * scale).toBeCloseTo(1, 2)
    expect(Math.abs(dot(right, down)) * scale * scale).toBeLessThan(0.01)
    for (const mark of [entry, target]) expect(distance(at(mark.x, mark.y), mark.mm)).toBeLessThan(0.05)
    const normal = cross(right, down)
    for (const mark of [entry, target]) expect(Math.abs(dot(minus(mark.mm, origin), normal)) / Math.sqrt(dot(normal, normal))).toBeLessThan(0.02)
    // What is drawn there is what the file holds there.
    await page.mouse.move(5, 5)
    const grey = await greyOf(page)
    const [shown, meant]: [number[], number[]] = [[], []]
    for (let dy = -140; dy <= 140; dy += 5)
      for (let dx = -140; dx <= 140; dx += 5) {
        const value = grey(entry.x + dx, entry.y + dy)
        shown.push(value > 4 && value < 250 ? value : NaN)
        meant.push(valueAt(volume, voxelAt(volume, at(Math.floor(entry.x + dx) + 0.5, Math.floor(entry.y + dy) + 0.5))))
      }
    expect(shown.filter((value) => !Number.isNaN(value)).length).toBeGreaterThan(800)
    expect(correlation(shown, meant)).toBeGreaterThan(0.99)
    await expectAccessible(page)
    await press(page, '0', '1')
  })

function labelAt(labels: Nifti, p: Vec3): number {
  const v = voxelAt(labels, p).map(Math.round) as Vec3
  return v.every((n, axis) => n >= 0 && n < labels.size[axis]!) ? labels.voxels[v[0] + labels.size[0] * (v[1] + labels.size[1] * v[2])]! : -1
}
// All 27 voxels around it are of one label: no edge runs there.
function sureLabelAt(labels: Nifti, p: Vec3): number {
  const centre = labelAt(labels, p)
  for (const x of [-0.3, 0, 0.3]) for (const y of [-0.3, 0, 0.3]) for (const z of [-0.3, 0, 0.3])
    if (labelAt(labels, [p[0] + x, p[1] + y, p[2] + z]) !== centre) return -1
  return centre
}

for (const key of ['1', '4'])
  test(`tissues are painted where the label map has them, and named under the pointer: view ${key}`, async ({ page }) => {
    const operator = new PageOperator(page, robot.url)
    await operator.planned()
    const labels = await readVolume(page, 'labels')
    const { tissues } = await lastEvent(page, 'Opened')
    await operator.clickAt('target')
    await press(page, key)
    const at = await mapOf(operator)
    const [plain, { x, y, width, height }, canvas] = [await coloursOf(page), await box(page), (await page.locator('canvas[tabindex]').boundingBox())!]
    await press(page, 'p')
    await expect(page.locator('[data-name=opacity]')).toHaveText('35')
    await page.mouse.move(5, 5)
    const painted = await coloursOf(page)
    const hues = new Map<number, number[][]>()
    for (let py = 60; py < height - 60; py += 17)
      for (let px = 60; px < width - 60; px += 17) {
        const [cx, cy] = [x - canvas.x + px, y - canvas.y + py]
        const label = sureLabelAt(labels, at(cx, cy))
        if (label < 0) continue
        const [before, after] = [plain(cx, cy), painted(cx, cy)]
        if (label === 0) expect(after, `nothing is painted without a label at ${cx}, ${cy}`).toEqual(before)
        // after = before (1 - opacity) + colour * opacity
        else hues.set(label, [...(hues.get(label) ?? []), after.map((v, n) => (v - before[n]! * 0.65) / 0.35)])
      }
    expect(hues.size).toBeGreaterThan(1)
    const colours = [...hues.values()].map((all) => [0, 1, 2].map((n) => all.map((one) => one[n]!).sort((a, b) => a - b)[all.length >> 1]!))
    for (const [n, all] of [...hues.values()].entries())
      for (const one of all) expect(Math.max(...one.map((v, i) => Math.abs(v - colours[n]![i]!)))).toBeLessThan(30)
    expect(Math.max(...colours[0]!.map((v, i) => Math.abs(v - colours[1]![i]!)))).toBeGreaterThan(60)

    const named = new Set<string>()
    for (const [px, py] of [[0.45, 0.45], [0.5, 0.75], [0.47, 0.5], [0.6, 0.6], [0.52, 0.35]] as const) {
      const [cx, cy] = [Math.round(x - canvas.x + px * width), Math.round(y - canvas.y + py * height)]
      const label = sureLabelAt(labels, at(cx, cy))
      if (label < 0) continue
      await page.mouse.move(canvas.x + cx, canvas.y + cy)
      const name = tissues.find((one: { value: number }) => one.value === label)?.name ?? 'no label'
      await expect(page.locator('[data-name=tissue]')).toHaveText(name)
      named.add(name)
    }
    expect(named.size).toBeGreaterThan(0)
    await expectAccessible(page)
    await press(page, '0', '1', 'p')
  })

test('3-D from the front: sides, scale and marks fit the voxels of the file', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const volume = await readVolume(page)
  await press(page, '5')
  await expect(page.locator('[data-tile="large 3-D"]')).toBeAttached()
  const edges = async () => page.locator('[data-tile^=large] [data-edge]').evaluateAll((all) => Object.fromEntries(all.map((one) => [(one as SVGElement).dataset.edge, one.textContent])))
  const frames = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))
  await press(page, ...Array(4).fill('ArrowRight')) // from a view a little from the side
  await frames()
  await expect.poll(edges).toMatchObject({ left: 'R', right: 'L' })
  // Half a turn of 36 times 5 deg has R on the other side, and the way back leads to the same picture.
  const entry = await drawn(page, 'entry')
  await press(page, ...Array(36).fill('ArrowRight'))
  await expect.poll(edges).toMatchObject({ left: 'L', right: 'R' })
  await press(page, ...Array(36).fill('ArrowLeft'))
  await expect.poll(async () => Math.abs((await drawn(page, 'entry')).x - entry.x)).toBeLessThan(0.01)
  // The silhouette of the file, cast along the axes that the page names, is where the picture is.
  await page.mouse.move(5, 5)
  const grey = await greyOf(page)
  const { width, height } = await box(page)
  const lit = (x: number, y: number) => grey(x, y) > 40
  const columns = Array.from({ length: Math.floor(width) }, (_, x) => Array.from({ length: Math.floor(height / 4) }, (_, y) => lit(x, 4 * y)).some(Boolean))
  const [first, last] = [columns.indexOf(true), columns.lastIndexOf(true)]
  expect(last - first).toBeGreaterThan(100)
  const scale = await pixelsPerMm(page)
  const across = await large(page, 'entry').evaluate((g: SVGGElement) => (g.closest('[data-tile]') as SVGGElement).dataset.right!.split(',').map(Number) as [number, number, number])
  const unit = across.map((v) => v / Math.sqrt(dot(across, across))) as Vec3
  let [from, to] = [Infinity, -Infinity]
  const whole = [...volume.voxels].reduce((most, v) => Math.max(most, v), 0)
  for (let k = 0; k < volume.size[2]; k += 2)
    for (let j = 0; j < volume.size[1]; j += 2)
      for (let i = 0; i < volume.size[0]; i += 2) {
        if (volume.voxels[i + volume.size[0] * (j + volume.size[1] * k)]! < 0.3 * whole) continue
        const p = [0, 1, 2].map((n) => volume.rows[4 * n]! * i + volume.rows[4 * n + 1]! * j + volume.rows[4 * n + 2]! * k + volume.rows[4 * n + 3]!) as Vec3
        const along = dot(minus(p, entry.mm), unit)
        from = Math.min(from, along)
        to = Math.max(to, along)
      }
  expect(Math.abs(entry.x + from * scale - first) / scale).toBeLessThan(1)
  expect(Math.abs(entry.x + to * scale - last) / scale).toBeLessThan(1)
  await expectAccessible(page)
  await press(page, '0', '1')
})

test('before and after: side by side, slider, difference, by mouse and keyboard', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  const checked = checkedOf(robot.folder)
  await showScene(operator, kScenes.find((scene) => scene.name === 'confirm')!, checked)
  await expect(page.locator('.confirm figure')).toHaveCount(2)
  await expectAccessible(page)

  await operator.button('slider').focus()
  await page.keyboard.press('Enter')
  const slider = page.getByRole('slider', { name: /after, to the left/ })
  await slider.focus()
  await page.keyboard.press('Home')
  for (let n = 0; n < 30; ++n) await page.keyboard.press('ArrowRight')
  const shown = page.locator('.confirm svg')
  const width = await shown.locator('#after rect').evaluate((rect: SVGRectElement) => rect.width.baseVal.value)
  expect(width).toBeCloseTo(0.3 * checked.width, 0)
  await expect(page.locator('.confirm [data-name=found]')).toBeVisible()
  await expectAccessible(page)

  // The picture that the page makes, against the pictures that it got.
  await operator.button('difference').click()
  await expect(page.locator('canvas[data-name=difference]')).toBeVisible()
  const worst = () => page.evaluate(async ([before, after]) => {
    const pixels = async (png: string) => {
      const image = new Image()
      image.src = `data:image/png;base64,${png}`
      await image.decode()
      const canvas = document.createElement('canvas')
      ;[canvas.width, canvas.height] = [image.width, image.height]
      const drawing = canvas.getContext('2d')!
      drawing.drawImage(image, 0, 0)
      return drawing.getImageData(0, 0, image.width, image.height).data
    }
    const made = document.querySelector<HTMLCanvasElement>('canvas[data-name=difference]')!
    const [a, b, d] = [await pixels(before!), await pixels(after!), made.getContext('2d')!.getImageData(0, 0, made.width, made.height).data]
    let [wrong, changed] = [0, 0]
    for (let n = 0; n < d.length; n += 4) {
      wrong = Math.max(wrong, Math.abs(d[n]! - 128 - (b[n]! - a[n]!) / 2))
      changed = Math.max(changed, Math.abs(d[n]! - 128))
    }
    return { wrong, changed }
  }, [checked.before_png, checked.after_png])
  await expect.poll(async () => (await worst()).wrong).toBeLessThanOrEqual(1)
  expect((await worst()).changed, 'the needle is seen').toBeGreaterThan(30)
  await expect(operator.button('Accept this depth')).toBeInViewport({ ratio: 1 })
  await expectAccessible(page)
})
