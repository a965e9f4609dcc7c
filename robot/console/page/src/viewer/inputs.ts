// Every input that the image takes, and what each does; there is no other. The list is what `?` shows.
import type { Mark } from '../generated/messages'
import { opened, type Vec3 } from '../robot'
import { add, kPlanes, length, pointAt, type Tile } from './geometry'
import { kOpacityStep, opacity, paintOrNot, setOpacity } from './tissues'
import * as view from './view'

const kFine_mm = 0.1
const kWindow_px = 200 // of a drag doubles the window
const kWindowStep = 0.15
const kTurn_deg_px = 0.5 // of a drag in the 3-D view
const kTurn_deg = 5
const kNotch_px = 40 // of the wheel; browsers report 53 to 120

export const kList: [string, string][] = [
  ['click or left drag', 'move the crosshair (with Ruler: measure)'],
  ['wheel, Page Up, Page Down', 'one slice; along the needle and in 3-D: turn'],
  ['arrows', 'one voxel; in 3-D: turn, as a left drag'],
  ['Shift + arrows, Page Up or Down', '0.1 mm'],
  ['e, t', 'set entry, set target at the crosshair'],
  ['middle drag', 'pan'],
  ['right drag', 'window: right wider, up brighter'],
  ['Ctrl + wheel, + and -', 'zoom about the crosshair'],
  ['[ and ], ; and \'', 'window narrower, wider; darker, brighter'],
  ['0', 'fit: zoom, pan and window as at first'],
  ['1, 2, 3', 'axial, coronal, sagittal large'],
  ['4, 5', 'along the needle, 3-D'],
  ['p; , and .', 'tissues painted or not; fainter, stronger'],
  ['m', 'ruler on and off'],
  ['x', 'crosshair on and off'],
  ['Ctrl + Z, Ctrl + Y', 'undo and redo entry or target'],
  ['Esc, anywhere', 'STOP'],
  ['?', 'this list'],
]

// A key that is kept down moves and zooms on and on; it sets, switches, undoes once.
const kRepeated = /^(Arrow|Page)|^[-+=[\];',.]$/

export interface Acts {
  set(mark: Mark, p: Vec3): void
  undo(): void
  redo(): void
  list(): void
}

const tileAt = (x: number, y: number): Tile | undefined =>
  view.tiles.value.find((tile) => x >= tile.left && x < tile.left + tile.width && y >= tile.top && y < tile.top + tile.height)

// Returns what takes every listener away again.
export function listen(canvas: HTMLCanvasElement, acts: Acts): () => void {
  const over = new AbortController()
  const on = <Name extends keyof HTMLElementEventMap>(name: Name, act: (event: HTMLElementEventMap[Name]) => void) =>
    canvas.addEventListener(name, act, { signal: over.signal, passive: false })
  let dragged: { pointer: number; buttons: number; tile: Tile; button: number; last: [number, number]; from: Vec3 } | null = null
  let rolled = 0 // px of the wheel, since its last step

  const drop = () => void (dragged = null)

  on('pointerdown', (event) => {
    if (dragged) return
    const [x, y] = [event.offsetX, event.offsetY]
    const tile = tileAt(x, y)
    if (!tile || event.button > 2) return
    event.preventDefault()
    canvas.focus()
    canvas.setPointerCapture(event.pointerId)
    dragged = { pointer: event.pointerId, buttons: event.buttons, tile, button: event.button, last: [x, y], from: pointAt(tile, x, y) }
    if (event.button !== 0) return
    if (tile.plane === '3-D') return
    if (view.ruling.value) view.ruler.value = { from: dragged.from, to: dragged.from }
    else view.moveTo(dragged.from)
  })
  on('pointermove', (event) => {
    const [x, y] = [event.offsetX, event.offsetY]
    const over = tileAt(x, y)
    view.pointed.value = over && over.plane !== '3-D' ? pointAt(over, x, y) : null
    if (!dragged || dragged.pointer !== event.pointerId) return
    if (event.buttons !== dragged.buttons) return drop() // another button: nothing says which is meant
    const { tile, last } = dragged
    if (dragged.button === 1) view.pan(tile, last, [x, y])
    else if (dragged.button === 2) view.changeWindow((x - last[0]) / kWindow_px, (y - last[1]) / kWindow_px)
    else if (tile.plane === '3-D') view.turn3d((x - last[0]) * kTurn_deg_px, (y - last[1]) * kTurn_deg_px)
    else if (over?.n === tile.n) {
      // The slice of this tile does not change by a move in it: its points are those of the press.
      if (view.ruling.value) view.ruler.value = { from: dragged.from, to: pointAt(tile, x, y) }
      else view.moveTo(pointAt(tile, x, y))
    }
    dragged.last = [x, y]
  })
  on('pointerup', (event) => event.pointerId === dragged?.pointer && drop())
  on('pointercancel', (event) => event.pointerId === dragged?.pointer && drop())
  on('pointerleave', () => void (view.pointed.value = null))
  on('lostpointercapture', (event) => event.pointerId === dragged?.pointer && drop())
  on('contextmenu', (event) => event.preventDefault())
  on('dragover', (event) => event.preventDefault())
  on('drop', (event) => event.preventDefault())

  on('wheel', (event) => {
    event.preventDefault()
    const tile = tileAt(event.offsetX, event.offsetY)
    if (!tile || dragged || event.deltaY === 0) return
    // A wheel turns by notches, each at least a step; a touchpad by a few pixels.
    rolled = (Math.sign(rolled) === Math.sign(event.deltaY) ? rolled : 0) + (event.deltaMode === 0 ? event.deltaY : Math.sign(event.deltaY) * kNotch_px)
    if (Math.abs(rolled) < kNotch_px) return
    rolled = 0
    if (event.ctrlKey) view.zoomBy(event.deltaY < 0 ? view.kZoomStep : 1 / view.kZoomStep)
    else view.moveSlice(tile, event.deltaY < 0 ? 1 : -1)
  })

  on('keydown', (event) => {
    if (!actOn(event, acts)) return
    event.preventDefault()
    event.stopPropagation()
  })
  return () => over.abort()
}

// False: not on the list.
function actOn(event: KeyboardEvent, acts: Acts): boolean {
  const tile = view.largeTile.value
  const at = view.crosshair.value
  if (!tile || !at || event.altKey || event.metaKey) return false
  if (event.ctrlKey) {
    const again = event.key === 'y' || (event.key === 'Z' && event.shiftKey)
    if (!again && event.key !== 'z') return false
    if (event.repeat) return true
    if (again) acts.redo()
    else acts.undo()
    return true
  }
  const nudge = (way: Vec3, sign: number) => {
    if (tile.plane === '3-D') return view.turn3d(way === tile.right ? sign * kTurn_deg : 0, way === tile.down ? sign * kTurn_deg : 0)
    const step = event.shiftKey ? kFine_mm : (opened.value?.series.spacing[0] ?? 1)
    view.moveTo(add(at, way, (sign * step) / length(way)))
  }
  const through = (sign: number) => (event.shiftKey ? view.moveThrough(tile, sign * kFine_mm) : view.moveSlice(tile, sign))
  const keys: Record<string, () => void> = {
    ArrowRight: () => nudge(tile.right, 1),
    ArrowLeft: () => nudge(tile.right, -1),
    ArrowDown: () => nudge(tile.down, 1),
    ArrowUp: () => nudge(tile.down, -1),
    PageUp: () => through(1),
    PageDown: () => through(-1),
    '+': () => view.zoomBy(view.kZoomStep),
    '=': () => view.zoomBy(view.kZoomStep),
    '-': () => view.zoomBy(1 / view.kZoomStep),
    '[': () => view.changeWindow(-kWindowStep, 0),
    ']': () => view.changeWindow(kWindowStep, 0),
    ';': () => view.changeWindow(0, kWindowStep),
    "'": () => view.changeWindow(0, -kWindowStep),
    '0': view.resetView,
    '1': () => view.arrange(kPlanes[0]!),
    '2': () => view.arrange(kPlanes[1]!),
    '3': () => view.arrange(kPlanes[2]!),
    '4': () => view.arrange('needle'),
    '5': () => view.arrange('3-D'),
    p: paintOrNot,
    ',': () => setOpacity(opacity.value - kOpacityStep),
    '.': () => setOpacity(opacity.value + kOpacityStep),
    e: () => acts.set('Entry', at),
    t: () => acts.set('Target', at),
    m: () => void (view.ruling.value = !view.ruling.value),
    x: () => void (view.crossed.value = !view.crossed.value),
    '?': acts.list,
  }
  const act = Object.hasOwn(keys, event.key) ? keys[event.key] : undefined
  if (!event.repeat || kRepeated.test(event.key)) act?.()
  return act !== undefined
}
