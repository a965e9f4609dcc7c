// The image: crosshair by click, wheel and arrow keys; Set entry and Set target commit it.
import { effect, signal } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'

import type { Mark, Series, Step } from './generated/messages'
import { add, kPlanes, length, ras, voxelOf } from './geometry'
import { send, withToken } from './link'
import { Overlay } from './overlay'
import { opened, state, welcome, disabledReason, type Vec3 } from './robot'
import { arrange, crosshair, large, moveTo, showVolume, tiles } from './viewer'

const kFine_mm = 0.1
const kPlanning: Step[] = ['Plan', 'Check', 'Arm'] // steps in which points may be changed

const choosing = signal(false) // shows the list again, to open another series
effect(() => {
  if (opened.value) choosing.value = false
})

function setPoint(mark: Mark): void {
  const series = opened.value?.series
  if (!series || !crosshair.value) return
  const voxel = voxelOf(series.ras_from_voxel, crosshair.value)
  void send({ type: 'SetPoint', mark, series_uid: series.series_uid, voxel, ras_mm: crosshair.value })
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
  const why = disabledReason.value
  const several = (welcome.value?.series.length ?? 0) > 1
  return (
    <>
      <button onClick={() => setPoint('Entry')} aria-disabled={why !== ''} title={why}>
        Set entry
      </button>
      <button onClick={() => setPoint('Target')} aria-disabled={why !== ''} title={why}>
        Set target
      </button>
      {several && (
        <button onClick={() => why === '' && (choosing.value = true)} aria-disabled={why !== ''} title={why}>
          Other series
        </button>
      )}
    </>
  )
}

function Planes() {
  return (
    <>
      {kPlanes.map((plane) => (
        <button key={plane} aria-pressed={large.value === plane} onClick={() => arrange(plane)}>
          {plane}
        </button>
      ))}
    </>
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
    return () => {
      keys.removeEventListener('keydown', nudge, { capture: true })
      delete document.body.dataset.image
    }
  }, [])
  return (
    <>
      <div class="slices">
        <canvas ref={canvas} tabIndex={0} aria-label="image: click or arrow keys move the crosshair, wheel the slice" />
        <Overlay />
      </div>
      <div class="picking">
        {kPlanning.includes(state.value?.step ?? 'Image') && <Picking />}
        <Planes />
        <p class="caption">
          {welcome.value?.simulated && <b>SIMULATED · </b>}
          {series.description}
          {series.oblique > 0.5 && ` · OBLIQUE ${series.oblique.toFixed(0)} deg`}
          {crosshair.value && <span data-name="place"> · {ras(crosshair.value)} mm</span>}
        </p>
      </div>
    </>
  )
}

function OpenButton(props: { series: Series; sample: boolean }) {
  const { series } = props
  const reading = state.value?.reading ?? ''
  const why =
    disabledReason.value || series.problem || (reading && (reading === series.series_uid ? 'It is being read…' : 'Wait.'))
  const open = () => {
    if (opened.value?.series.series_uid === series.series_uid) choosing.value = false
    else void send({ type: 'OpenSeries', series_uid: series.series_uid })
  }
  return (
    <li>
      <button aria-disabled={why !== ''} onClick={() => why === '' && open()}>
        Open {props.sample && 'the sample: '}
        {series.description || series.series_uid}
        {series.modality && ` · ${series.modality}`}
        {series.patient_id && ` · patient ${series.patient_id}`}
        {series.date && ` · ${series.date}`}
        {series.size[0]! > 0 && ` · ${series.size.join(' x ')} voxels`}
      </button>
      {why && <span class="why">{why}</span>}
    </li>
  )
}

// The first view.
function SeriesList() {
  const found = welcome.value
  if (!found) return <div class="empty">Waiting for the console…</div>
  return (
    <div class="empty">
      <p>{found.title}: open a series to begin.</p>
      {found.sample && <p>This is a built-in sample case. It belongs to no patient.</p>}
      <ul>
        {found.series.map((series) => (
          <OpenButton key={series.series_uid} series={series} sample={found.sample} />
        ))}
      </ul>
    </div>
  )
}

export function ImageView(props: { children?: preact.ComponentChildren }) {
  const series = opened.value?.series
  return (
    <main class="image" aria-label="image">
      {series && !choosing.value ? <Shown key={series.series_uid} /> : <SeriesList />}
      {props.children}
    </main>
  )
}
