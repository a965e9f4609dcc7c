// Below the image: points, planes, tools, read-outs; and the list of inputs.
import { signal } from '@preact/signals'

import { disabledReason, opened, welcome } from '../robot'
import { kNames, length, minus, mm, ras, type View } from './geometry'
import { kList } from './inputs'
import { turnBy, turned } from './needle_plane'
import { entry } from './path'
import { redo, setPoint, undo, whyNoRedo, whyNoUndo } from './points'
import { coloured, colourOf, labels, opacity, setOpacity, tissueAt } from './tissues'
import * as view from './view'
import { nearestAt } from './voxels'

export const listed = signal(false) // the list of inputs is shown
export const choosing = signal(false) // the list of series is shown, to open another one

// Where there is no room for all tools (small.css) one section of them is unfolded.
const kSections = ['points', 'views', 'tools', 'slices'] as const
const section = signal<(typeof kSections)[number]>('points')

function Act(props: { name: string; text?: string; wide?: boolean; why?: string; pressed?: boolean; act: () => void }) {
  const why = props.why ?? ''
  return (
    <button
      class={props.text ? 'tool' : props.wide ? 'wide' : ''}
      aria-label={props.text ? props.name : undefined}
      aria-disabled={why !== ''}
      aria-pressed={props.pressed}
      title={why || (props.text ? props.name : '')}
      onClick={() => why === '' && props.act()}
    >
      {props.text ?? props.name}
    </button>
  )
}

function Points() {
  const why = disabledReason.value
  const at = view.crosshair.value
  return (
    <div class="group" data-section="points">
      <Act name="Set entry" why={why} act={() => at && void setPoint('Entry', at)} />
      <Act name="Set target" why={why} act={() => at && void setPoint('Target', at)} />
      <Act name="Undo" text="↶" why={why || whyNoUndo.value} act={() => void undo()} />
      <Act name="Redo" text="↷" why={why || whyNoRedo.value} act={() => void redo()} />
      {(welcome.value?.series.length ?? 0) > 1 && (
        <Act name="Other series" why={why} act={() => void (choosing.value = true)} />
      )}
    </div>
  )
}

function Views() {
  return (
    <div class="group" data-section="views">
      {(Object.keys(kNames) as View[]).map((one) => (
        <Act
          key={one}
          name={kNames[one]}
          wide={one === 'needle'}
          why={one === 'needle' ? view.whyNoNeedlePlane.value : ''}
          pressed={view.large.value === one}
          act={() => view.arrange(one)}
        />
      ))}
    </div>
  )
}

function Tools() {
  return (
    <div class="group" data-section="tools">
      <Act name="Zoom out" text="−" act={() => view.zoomBy(1 / view.kZoomStep)} />
      <Act name="Zoom in" text="+" act={() => view.zoomBy(view.kZoomStep)} />
      <Act name="Fit view" act={view.resetView} />
      <Act name="Ruler" pressed={view.ruling.value} act={() => void (view.ruling.value = !view.ruling.value)} />
      <Act name="List of keys" text="?" pressed={listed.value} act={() => void (listed.value = !listed.value)} />
    </div>
  )
}

// How strongly the tissues are painted over.
function Tissues() {
  if (!labels.value || !coloured().length) return null
  return (
    <label class="slice" data-section="slices">
      <span>
        tissues <b data-name="opacity">{mm(100 * opacity.value, 0)}</b> %
      </span>
      <input
        type="range"
        min="0"
        max="100"
        step="5"
        value={100 * opacity.value}
        onInput={(event) => setOpacity(Number(event.currentTarget.value) / 100)}
      />
    </label>
  )
}

// Over the image, where there is room.
function Legend() {
  if (!labels.value || opacity.value === 0) return null
  return (
    <ul class="tissues" data-section="slices" aria-label="colours of the tissues">
      {coloured().map(({ value, name }) => (
        <li key={value}>
          <svg width="16" height="16" aria-hidden="true">
            <rect width="16" height="16" fill={`rgb(${colourOf(value)!.join(' ')})`} />
          </svg>
          {name}
        </li>
      ))}
    </ul>
  )
}

// What lies under the pointer, or else under the crosshair: tissue, value, and whether the stroke reaches it.
export function Pointed() {
  const at = view.pointed.value ?? view.crosshair.value
  if (!at || !view.voxels.value || !opened.value) return null
  const value = nearestAt(view.voxels.value, at)
  const apart = entry.value ? length(minus(at, entry.value)) : null
  const { reach } = opened.value
  return (
    <p class="pointed" data-name="pointed">
      {view.pointed.value ? 'pointer' : 'crosshair'}
      {tissueAt(at) && (
        <span>
          : <b data-name="tissue">{tissueAt(at)}</b>
        </span>
      )}
      <span> · value {value === null ? 'outside' : mm(value, 0)}</span>
      {apart !== null && (
        <span data-name="from-entry">
          {' '}
          · {mm(apart)} mm from the entry{apart > reach && <b>: beyond the stroke of {mm(reach)} mm</b>}
        </span>
      )}
    </p>
  )
}

function Turned() {
  return (
    <label class="slice" data-section="slices">
      <span>
        turned <b data-name="turned">{turned.value}</b> deg
      </span>
      <input
        type="range"
        min="0"
        max="355"
        step="5"
        value={turned.value}
        onInput={(event) => turnBy(Number(event.currentTarget.value) - turned.value)}
      />
    </label>
  )
}

function Slice() {
  const tile = view.largeTile.value
  const at = view.crosshair.value
  if (tile?.plane === 'needle') return <Turned />
  if (!tile || !at || !view.isPlane(tile)) return null
  const stack = view.stackOf(tile)
  const slice = Math.min(Math.max(Math.round(stack.at(at)), 0), stack.count - 1)
  return (
    <label class="slice" data-section="slices">
      <span>
        {tile.plane} slice <b data-name="slice">{slice + 1}</b> of {stack.count}
      </span>
      <input
        type="range"
        min="1"
        max={stack.count}
        value={slice + 1}
        onInput={(event) => view.toSlice(tile, Number(event.currentTarget.value) - 1)}
      />
    </label>
  )
}

export function Toolbar(props: { planning: boolean }) {
  return (
    <div class="picking" data-shown={section.value}>
      <div class="sections" role="group" aria-label="tools shown">
        {kSections.map((one) => (
          <Act key={one} name={one} pressed={section.value === one} act={() => void (section.value = one)} />
        ))}
      </div>
      {props.planning && <Points />}
      <Views />
      <Tools />
      <Tissues />
      <Legend />
      <Slice />
    </div>
  )
}

const kDescription = 40 // letters of it; the top bar has all

export function Caption() {
  const series = opened.value!.series
  const { low, high } = view.windowed.value
  return (
    <p class="caption">
      {welcome.value?.simulated && <b>SIMULATED · </b>}
      <span data-name="description">{series.description.slice(0, kDescription)} · </span>
      {series.oblique > 0.5 && `OBLIQUE ${series.oblique.toFixed(0)} deg · `}
      <span data-name="zoom">zoom {mm(view.zoom.value)}</span>
      <span data-name="window">
        {' '}
        · window {mm(high - low, 0)} level {mm((low + high) / 2, 0)}
      </span>
      {view.moved.value && ' · moved'}
      {view.crosshair.value && <span data-name="place"> · {ras(view.crosshair.value)} mm</span>}
    </p>
  )
}

export function InputList() {
  if (!listed.value) return null
  return (
    <section class="inputs" aria-label="keys and mouse">
      <dl>
        {kList.map(([input, does]) => (
          <div key={input}>
            <dt>{input}</dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
      <button onClick={() => void (listed.value = false)}>Close the list</button>
    </section>
  )
}
