// The only file that uses the image viewer (NiiVue 0.69): from creation to disposal. It draws; it takes no input at all
// (inputs.ts does), and after each of its frames the tiles say where every pixel of that frame lies. Points are R, A, S
// in mm.
import { Niivue, SLICE_TYPE } from '@niivue/niivue'

import { kPlanes, type Plane, type Tile } from './geometry'
import type { Vec3 } from '../robot'

const kLarge = 0.66 // of the width
const kProbe_px = 10

export interface Window {
  low: number
  high: number
}

// Tells of each frame: whatever made the viewer draw, the marks follow in the same frame.
class Drawing extends Niivue {
  drawn: (() => void) | null = null
  override drawScene(): string | void {
    const text = super.drawScene()
    this.drawn?.()
    return text
  }
}

export class Scene {
  private constructor(private viewer: Drawing) {}

  // `drawn` is called after each frame.
  static async open(canvas: HTMLCanvasElement, volume: ArrayBuffer, drawn: (scene: Scene) => void): Promise<Scene> {
    const viewer = new Drawing({
      interactive: false,
      isRadiologicalConvention: true,
      sagittalNoseLeft: true,
      dragAndDropEnabled: false,
      isOrientationTextVisible: false, // overlay.tsx draws them on all four sides
      show3Dcrosshair: false,
      crosshairWidth: 0, // overlay.tsx draws it, with a gap
      backColor: [0, 0, 0, 1],
      logLevel: 'error',
      isResizeCanvas: true,
    })
    viewer.opts.multiplanarShowRender = 0
    await viewer.attachToCanvas(canvas)
    await viewer.loadFromArrayBuffer(volume, 'volume.nii')
    const scene = new Scene(viewer)
    viewer.drawn = () => drawn(scene)
    return scene
  }

  // Gives the drawing context back: a browser has sixteen.
  dispose(): void {
    this.viewer.drawn = null
    this.viewer.cleanup()
    this.viewer.gl.getExtension('WEBGL_lose_context')?.loseContext()
  }

  // One large view, and all three small ones beside it.
  arrange(plane: Plane): void {
    const type = { axial: SLICE_TYPE.AXIAL, coronal: SLICE_TYPE.CORONAL, sagittal: SLICE_TYPE.SAGITTAL }
    this.viewer.setCustomLayout([
      { sliceType: type[plane], position: [0, 0, kLarge, 1] },
      ...kPlanes.map((small, n) => ({
        sliceType: type[small],
        position: [kLarge, n / 3, 1 - kLarge, 1 / 3] as [number, number, number, number],
      })),
    ])
  }

  get crosshair(): Vec3 {
    return this.mmOf(this.viewer.scene.crosshairPos as unknown as Vec3)
  }
  moveTo(p: Vec3): void {
    const frac = this.viewer.mm2frac(p, 0, true)
    for (let n = 0; n < 3; ++n) frac[n] = Math.min(Math.max(frac[n]!, 0), 1)
    this.viewer.scene.crosshairPos = frac
    this.viewer.drawScene()
  }

  get window(): Window {
    const volume = this.viewer.volumes[0]!
    return { low: volume.cal_min ?? 0, high: volume.cal_max ?? 1 }
  }
  set window({ low, high }: Window) {
    const volume = this.viewer.volumes[0]!
    volume.cal_min = low
    volume.cal_max = high
    this.viewer.updateGLVolume()
  }

  get zoom(): number {
    return this.viewer.scene.pan2Dxyzmm[3]!
  }
  // About the crosshair, which stays where it is on the screen.
  zoomTo(zoom: number): void {
    const pan = this.viewer.scene.pan2Dxyzmm
    const centre = this.viewer.frac2mm(this.viewer.scene.crosshairPos)
    for (let n = 0; n < 3; ++n) pan[n]! += (pan[3]! - zoom) * centre[n]!
    pan[3] = zoom
    this.viewer.drawScene()
  }
  // So that what is drawn at one pixel of a tile is drawn at the other.
  pan(tile: number, from: [number, number], to: [number, number]): void {
    const at = ([x, y]: [number, number]) => this.viewer.frac2mm(this.fracAt(tile, x, y) as never)
    const [a, b] = [at(from), at(to)]
    const pan = this.viewer.scene.pan2Dxyzmm
    for (let n = 0; n < 3; ++n) pan[n]! += pan[3]! * (b[n]! - a[n]!)
    this.viewer.drawScene()
  }
  resetView(): void {
    this.viewer.scene.pan2Dxyzmm = [0, 0, 0, 1] as never
    this.viewer.drawScene()
  }

  // Of the last frame, as the viewer maps it.
  tiles(): Tile[] {
    return this.viewer.screenSlices.map((_, n) => this.tileOf(n)).filter((tile) => tile !== null)
  }

  private mmOf(frac: Vec3): Vec3 {
    const p = this.viewer.frac2mm(frac as never, 0, true)
    return [p[0]!, p[1]!, p[2]!]
  }

  private get ratio(): number {
    return this.viewer.uiData.dpr ?? 1
  }

  // CSS pixels, which may lie outside of the tile: extended from two points in it.
  private fracAt(n: number, x: number, y: number): Vec3 {
    const slice = this.viewer.screenSlices[n]!
    const [left, top, width, height] = slice.leftTopWidthHeight as [number, number, number, number]
    const [cx, cy] = [left + width / 2, top + height / 2]
    const at = (px: number, py: number) => this.viewer.screenXY2TextureFrac(px, py, n, false) as unknown as Vec3
    const [middle, right, down] = [at(cx, cy), at(cx + kProbe_px, cy), at(cx, cy + kProbe_px)]
    return middle.map((v, i) => v + ((right[i]! - v) * (x * this.ratio - cx) + (down[i]! - v) * (y * this.ratio - cy)) / kProbe_px) as Vec3
  }

  // From three points of the tile as the viewer maps them, independent of its internal layout.
  private tileOf(n: number): Tile | null {
    const slice = this.viewer.screenSlices[n]!
    let [left, top, width, height] = slice.leftTopWidthHeight as [number, number, number, number]
    if (width < 0) [left, width] = [left + width, -width]
    if (slice.axCorSag > 2 || width < 4 * kProbe_px || height < 4 * kProbe_px) return null
    const ratio = this.ratio
    const [x, y] = [(left + width / 2) / ratio, (top + height / 2) / ratio]
    const at = (px: number, py: number) => this.mmOf(this.fracAt(n, px, py))
    const middle = at(x, y)
    const step = (p: Vec3): Vec3 => p.map((v, i) => (v - middle[i]!) / kProbe_px) as Vec3
    const right = step(at(x + kProbe_px, y))
    const down = step(at(x, y + kProbe_px))
    const origin = middle.map((v, i) => v - right[i]! * x - down[i]! * y) as Vec3
    const plane = kPlanes[slice.axCorSag]!
    return { n, plane, left: left / ratio, top: top / ratio, width: width / ratio, height: height / ratio, origin, right, down }
  }
}
