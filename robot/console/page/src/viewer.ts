// The only file that uses the image viewer (NiiVue 0.69). Points are R, A, S in mm.
import { Niivue, SLICE_TYPE } from '@niivue/niivue'
import { signal } from '@preact/signals'

import { kPlanes, type Plane, type Tile } from './geometry'
import type { Vec3 } from './robot'

const kLarge = 0.66 // of the width
const kProbe_px = 10

export const crosshair = signal<Vec3 | null>(null)
export const tiles = signal<Tile[]>([])
export const large = signal<Plane>('axial')

let viewer: Niivue | null = null

export async function showVolume(canvas: HTMLCanvasElement, url: string): Promise<void> {
  const shown = new Niivue({
    isRadiologicalConvention: true,
    dragAndDropEnabled: false,
    isOrientationTextVisible: false, // overlay.tsx draws them on all four sides
    show3Dcrosshair: false,
    crosshairColor: [0.2, 0.85, 0.3, 0.8],
    crosshairWidth: 1,
    backColor: [0, 0, 0, 1],
    logLevel: 'error',
    sagittalNoseLeft: false,
    isResizeCanvas: true,
  })
  shown.opts.multiplanarShowRender = 0
  await shown.attachToCanvas(canvas)
  const answer = await fetch(url)
  if (!answer.ok) throw new Error(`the image did not arrive: ${answer.status}`)
  await shown.loadFromArrayBuffer(await answer.arrayBuffer(), 'volume.nii')
  shown.onLocationChange = follow
  viewer = shown
  arrange(large.value)
  canvas.addEventListener('wheel', () => setTimeout(follow), { passive: true })
  new ResizeObserver(() => setTimeout(follow)).observe(canvas)
}

// One large view, and all three small ones beside it.
export function arrange(plane: Plane): void {
  large.value = plane
  if (!viewer) return
  const type = { axial: SLICE_TYPE.AXIAL, coronal: SLICE_TYPE.CORONAL, sagittal: SLICE_TYPE.SAGITTAL }
  viewer.setCustomLayout([
    { sliceType: type[plane], position: [0, 0, kLarge, 1] },
    ...kPlanes.map((small, n) => ({
      sliceType: type[small],
      position: [kLarge, n / 3, 1 - kLarge, 1 / 3] as [number, number, number, number],
    })),
  ])
  follow()
}

export function moveTo(p: Vec3): void {
  if (!viewer) return
  const frac = viewer.mm2frac(p, 0, true)
  for (let n = 0; n < 3; ++n) frac[n] = Math.min(Math.max(frac[n]!, 0), 1)
  viewer.scene.crosshairPos = frac
  viewer.drawScene()
  follow()
}

function follow(): void {
  if (!viewer) return
  crosshair.value = mmOf(viewer.scene.crosshairPos as unknown as Vec3)
  tiles.value = viewer.screenSlices.map((_, n) => tileOf(n)).filter((tile) => tile !== null)
}

const mmOf = (frac: Vec3): Vec3 => {
  const p = viewer!.frac2mm(frac as never, 0, true)
  return [p[0]!, p[1]!, p[2]!]
}

// From three points of the tile as the viewer maps them, independent of its internal layout.
function tileOf(n: number): Tile | null {
  const slice = viewer!.screenSlices[n]!
  const ratio = viewer!.uiData.dpr ?? 1
  let [left, top, width, height] = slice.leftTopWidthHeight as [number, number, number, number]
  if (width < 0) [left, width] = [left + width, -width]
  if (slice.axCorSag > 2 || width < 4 * kProbe_px || height < 4 * kProbe_px) return null
  const x = left + width / 2
  const y = top + height / 2
  const at = (px: number, py: number) => mmOf(viewer!.screenXY2TextureFrac(px, py, n, false) as unknown as Vec3)
  const middle = at(x, y)
  const step = (p: Vec3): Vec3 => p.map((v, i) => ((v - middle[i]!) * ratio) / kProbe_px) as Vec3
  const right = step(at(x + kProbe_px, y))
  const down = step(at(x, y + kProbe_px))
  const origin = middle.map((v, i) => v - (right[i]! * x) / ratio - (down[i]! * y) / ratio) as Vec3
  const plane = kPlanes[slice.axCorSag]!
  return { plane, left: left / ratio, top: top / ratio, width: width / ratio, height: height / ratio, origin, right, down }
}
