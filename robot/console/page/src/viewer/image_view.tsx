// The image with its marks and tools, or the list of series from which one is opened.
import { effect } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'

import { withToken } from '../address'
import type { Mark, Series, Step } from '../generated/messages'
import { send } from '../link'
import { disabledReason, opened, runOver, state, type Vec3, welcome } from '../robot'
import { listen } from './inputs'
import { Overlay } from './overlay'
import { NeedleCanvas } from './needle_canvas'
import { redo, setPoint, undo } from './points'
import { Caption, choosing, InputList, listed, Pointed, Toolbar } from './toolbar'
import { hideVolume, ruling, showVolume } from './view'

const kPlanning: Step[] = ['Plan', 'Check', 'Arm'] // steps in which points may be changed

effect(() => {
  if (opened.value) choosing.value = false
})

const mayPlan = () => runOver.value || kPlanning.includes(state.value?.step ?? 'Image')
const kActs = {
  undo: () => void (mayPlan() && undo()),
  redo: () => void (mayPlan() && redo()),
  set: (mark: Mark, p: Vec3) => void (mayPlan() && !disabledReason.value && setPoint(mark, p)),
  list: () => void (listed.value = !listed.value),
}

function Shown() {
  const canvas = useRef<HTMLCanvasElement>(null)
  useEffect(() => {
    let gone = false
    const silence = listen(canvas.current!, kActs)
    const { volume, labels } = opened.value!
    void showVolume(canvas.current!, withToken(volume), labels && withToken(labels), () => gone).then(() => {
      if (!gone) document.body.dataset.image = 'shown'
    })
    return () => {
      gone = true
      silence()
      hideVolume()
      delete document.body.dataset.image
    }
  }, [])
  return (
    <>
      <div class={ruling.value ? 'slices ruling' : 'slices'}>
        <canvas ref={canvas} tabIndex={0} aria-label="image: click or arrow keys move the crosshair, wheel the slice; ? lists all keys" />
        <NeedleCanvas />
        <Overlay />
        <InputList />
      </div>
      <Toolbar planning={mayPlan()} />
      <div class="readings">
        <Pointed />
        <Caption />
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
