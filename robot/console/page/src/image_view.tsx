// The image, and what is done on it: crosshair by click, wheel and arrows; Set entry and Set target commit it.
import { useEffect, useRef } from 'preact/hooks'

import type { Mark } from './generated/messages'
import { add, kPlanes, length, ras, voxelOf } from './geometry'
import { ask, withToken } from './link'
import { Overlay } from './overlay'
import { opened, state, welcome, whyNot, type Vec3 } from './robot'
import { arrange, crosshair, large, moveTo, showVolume, tiles } from './viewer'

const kFine_mm = 0.1

function setPoint(mark: Mark): void {
  const series = opened.value?.series
  if (!series || !crosshair.value) return
  const voxel = voxelOf(series.ras_from_voxel, crosshair.value)
  void ask({ type: 'SetPoint', mark, series_uid: series.series_uid, voxel, ras_mm: crosshair.value })
}

// Along the large view: one voxel, or 0.1 mm with Shift.
function nudge(event: KeyboardEvent): void {
  const tile = tiles.value[0]
  const spacing = opened.value?.series.spacing[0] ?? 1
  if (!tile || !crosshair.value) return
  const ways: Record<string, [Vec3, number]> = {
    ArrowRight: [tile.right, 1],
    ArrowLeft: [tile.right, -1],
    ArrowDown: [tile.down, 1],
    ArrowUp: [tile.down, -1],
  }
  const way = ways[event.key]
  if (!way) return
  event.preventDefault()
  event.stopImmediatePropagation()
  const step = event.shiftKey ? kFine_mm : spacing
  moveTo(add(crosshair.value, way[0], (way[1] * step) / length(way[0])))
}

function Picking() {
  const why = whyNot.value
  return (
    <div class="picking">
      <button onClick={() => setPoint('Entry')} aria-disabled={why !== ''} title={why}>
        Set entry
      </button>
      <button onClick={() => setPoint('Target')} aria-disabled={why !== ''} title={why}>
        Set target
      </button>
      {kPlanes.map((plane) => (
        <button key={plane} aria-pressed={large.value === plane} onClick={() => arrange(plane)}>
          {plane}
        </button>
      ))}
    </div>
  )
}

function Shown() {
  const canvas = useRef<HTMLCanvasElement>(null)
  const series = opened.value!.series
  useEffect(() => {
    void showVolume(canvas.current!, withToken(opened.value!.volume)).then(() => {
      document.body.dataset.image = 'shown'
    })
    const keys = canvas.current!
    keys.addEventListener('keydown', nudge, { capture: true })
    return () => keys.removeEventListener('keydown', nudge, { capture: true })
  }, [series.series_uid])
  return (
    <>
      <canvas ref={canvas} tabIndex={0} aria-label="image: click or arrow keys move the crosshair, wheel the slice" />
      <Overlay />
      <p class="caption">
        {welcome.value?.simulated && <b>SIMULATED · </b>}
        {series.description}
        {series.oblique > 0.5 && ` · OBLIQUE ${series.oblique.toFixed(0)} deg`}
        {crosshair.value && <span data-name="place"> · {ras(crosshair.value)} mm</span>}
      </p>
      {!state.value?.disabled.plan.startsWith('It is confirmed') && <Picking />}
    </>
  )
}

function Empty() {
  const found = welcome.value
  if (!found) return <div class="empty">Waiting for the console…</div>
  return (
    <div class="empty">
      <p>{found.title}: open a series to begin.</p>
      {found.series.map((series) => (
        <button
          key={series.series_uid}
          aria-disabled={whyNot.value !== ''}
          onClick={() => void ask({ type: 'OpenSeries', series_uid: series.series_uid })}
        >
          Open {series.description || series.series_uid} · patient {series.patient_id || 'without ID'} ·{' '}
          {series.size.join(' x ')} voxels
        </button>
      ))}
      {whyNot.value && <p>{whyNot.value}</p>}
    </div>
  )
}

export function ImageView(props: { children?: preact.ComponentChildren }) {
  return (
    <main class="image" aria-label="image">
      {opened.value ? <Shown /> : <Empty />}
      {props.children}
    </main>
  )
}
