// The only file that uses the image viewer (NiiVue 0.69): from creation to disposal. It draws; it takes no input at all
// (inputs.ts does), and after each of its frames the tiles say where every pixel of that frame lies. Points are R, A, S
// in mm.
import { Niivue, SLICE_TYPE } from '@niivue/niivue'

import { kPlanes, type Rectangle, type Tile, type View } from './geometry'
import type { Vec3 } from '../robot'
import type { Colour } from './tissues'

const kLarge = 0.66 // of the width
const kProbe_px = 10

const kFrom: [number, number] = [160, 15] // azimuth and elevation of the 3-D view at first: from the front, a little above

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
  private due: number | null = null // a frame that was asked for
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
    ;[viewer.scene.renderAzimuth, viewer.scene.renderElevation] = kFrom
    await viewer.attachToCanvas(canvas)
    await viewer.loadFromArrayBuffer(volume, 'volume.nii')
    const scene = new Scene(viewer)
    viewer.drawn = () => drawn(scene)
    return scene
  }

  // Gives the drawing context back: a browser has sixteen.
  dispose(): void {
    this.viewer.drawn = null
    if (this.due !== null) cancelAnimationFrame(this.due)
    this.viewer.cleanup()
    this.viewer.gl.getExtension('WEBGL_lose_context')?.loseContext()
  }

  // One large view, and all three small ones beside it. The plane along the needle is not drawn here.
  arrange(large: View): void {
    const type = { axial: SLICE_TYPE.AXIAL, coronal: SLICE_TYPE.CORONAL, sagittal: SLICE_TYPE.SAGITTAL, '3-D': SLICE_TYPE.RENDER }
    this.viewer.setCustomLayout([
      ...(large === 'needle' ? [] : [{ sliceType: type[large], position: [0, 0, kLarge, 1] as [number, number, number, number] }]),
      ...kPlanes.map((small, n) => ({
        sliceType: type[small],
        position: [kLarge, n / 3, 1 - kLarge, 1 / 3] as [number, number, number, number],
      })),
    ])
  }

  // The large view's part of the canvas, CSS pixels.
  get largeBox(): Rectangle {
    const { width, height } = this.viewer.canvas!.getBoundingClientRect()
    return { left: 0, top: 0, width: width * kLarge, height }
  }

  // A label map over the image, of 16-bit whole numbers (labelFile() in voxels.ts); `colourOf` a value, or null: not painted.
  async paint(labels: ArrayBuffer, values: number[], colourOf: (value: number) => Colour | null): Promise<void> {
    const colours = [0, ...values].map((value) => colourOf(value))
    const channel = (n: number) => colours.map((colour) => colour?.[n] ?? 0)
    await this.viewer.loadFromArrayBuffer(labels, 'labels.nii')
    this.viewer.volumes[1]!.setColormapLabel({
      R: channel(0), G: channel(1), B: channel(2),
      A: colours.map((colour) => (colour ? 255 : 0)),
      I: [0, ...values],
      labels: colours.map(() => ''),
    })
    this.setOpacity(0)
  }
  setOpacity(opacity: number): void {
    if (this.viewer.volumes.length > 1) this.viewer.setOpacity(1, opacity)
  }

  // The 3-D view, degrees.
  turn(azimuth: number, elevation: number): void {
    const { scene } = this.viewer
    scene.renderAzimuth = (scene.renderAzimuth + azimuth + 360) % 360
    scene.renderElevation = Math.min(Math.max(scene.renderElevation + elevation, -90), 90)
    // Slow without a graphics card: once a frame at most.
    this.due ??= requestAnimationFrame(() => {
      this.due = null
      this.viewer.drawScene()
    })
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
    this.viewer.scene.volScaleMultiplier = zoom
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
    const { scene } = this.viewer
    scene.pan2Dxyzmm = [0, 0, 0, 1] as never
    scene.volScaleMultiplier = 1
    ;[scene.renderAzimuth, scene.renderElevation] = kFrom
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
    if (width < 4 * kProbe_px || height < 4 * kProbe_px) return null
    const ratio = this.ratio
    const box = { left: left / ratio, top: top / ratio, width: width / ratio, height: height / ratio }
    if (slice.axCorSag > 2) return this.renderTile(n, box)
    const [x, y] = [(left + width / 2) / ratio, (top + height / 2) / ratio]
    const at = (px: number, py: number) => this.mmOf(this.fracAt(n, px, py))
    const middle = at(x, y)
    const step = (p: Vec3): Vec3 => p.map((v, i) => (v - middle[i]!) / kProbe_px) as Vec3
    const right = step(at(x + kProbe_px, y))
    const down = step(at(x, y + kProbe_px))
    const origin = middle.map((v, i) => v - right[i]! * x - down[i]! * y) as Vec3
    const plane = kPlanes[slice.axCorSag]!
    return { n, plane, ...box, origin, right, down }
  }

  // The viewer's own projection, which has no perspective: pixels are linear in mm.
  private renderTile(n: number, box: Rectangle): Tile {
    const { scene } = this.viewer
    const ratio = this.ratio
    const whole = [box.left, box.top, box.width, box.height].map((v) => v * ratio)
    const [map] = this.viewer.calculateMvpMatrix(null, whole as never, scene.renderAzimuth, scene.renderElevation) as unknown as [number[]]
    const px = (row: 0 | 1) => {
      const half = row === 0 ? box.width / 2 : -box.height / 2
      const per_mm: Vec3 = [map[row]! * half, map[4 + row]! * half, map[8 + row]! * half]
      return { per_mm, at0: (row === 0 ? box.left + box.width / 2 : box.top + box.height / 2) + map[12 + row]! * half }
    }
    const [x, y] = [px(0), px(1)]
    const step = (a: Vec3): Vec3 => a.map((v) => v / (a[0] ** 2 + a[1] ** 2 + a[2] ** 2)) as Vec3
    const [right, down] = [step(x.per_mm), step(y.per_mm)]
    const origin = right.map((v, i) => -v * x.at0 - down[i]! * y.at0) as Vec3
    return { n, plane: '3-D', ...box, origin, right, down }
  }
}
