// Always in view: state, patient, depth, voltage, scanner, age of the link.
import { computed } from '@preact/signals'

import type { Mode } from './generated/messages'
import { depthIsKnown, isKnown, linkAge, linked, opened, state, welcome } from './robot'
import { dark } from './theme'
import { mm } from './viewer/geometry'

const kAge_ms = 200 // finer steps would paint the page again and again
const shownAge = computed(() => kAge_ms * Math.floor(linkAge.value / kAge_ms))

// A label, a shape and, for the two stopped modes, the only saturated colour.
const kShapes: Record<Mode, string> = {
  Boot: 'M4,14h20',
  Safe: 'M14,4a10,10 0 1,0 .1,0z',
  Ready: 'M4,14l7,8l13,-16',
  Armed: 'M14,3L25,24H3z',
  Active: 'M6,4L24,14L6,24z',
  Hold: 'M7,4v20M21,4v20',
  Retract: 'M22,4L4,14L22,24z',
  Trip: 'M5,5L23,23M23,5L5,23',
  Lock: 'M6,13h16v11h-16zM9,13v-4a5,5 0 0,1 10,0v4',
}

function Value(props: { name: string; text: string }) {
  return (
    <div class="value">
      {props.name}
      <b data-name={props.name}>{props.text}</b>
    </div>
  )
}

export function TopBar() {
  const now = state.value
  const series = opened.value?.series
  const mode = now?.mode ?? 'Boot'
  const stopped = mode === 'Trip' || mode === 'Lock'
  const known = isKnown.value && now
  return (
    <header class="top">
      <h1>Needle biopsy</h1>
      <div class="mode" data-name="mode" data-mode={mode}>
        <svg width="28" height="28" aria-hidden="true">
          <path d={kShapes[mode]} fill="none" stroke={stopped ? 'var(--alarm)' : 'var(--ink)'} stroke-width="3.5" />
        </svg>
        {linked.value ? mode.toUpperCase() : 'NO LINK'}
      </div>
      {known && now.locked && (
        <div class="locked" data-name="locked">
          needle locked
        </div>
      )}
      {linked.value && now?.estop && (
        <div class="estop" data-name="estop">
          E-STOP pressed or unread
        </div>
      )}
      {welcome.value?.simulated && <div class="simulated">SIMULATED</div>}
      <div class="who">
        {series ? (
          <>
            <b>{series.patient || 'no name'}</b> · ID {series.patient_id || 'none'}
            <br />
            {series.description || series.series_uid} · {series.date || 'no date'}
          </>
        ) : (
          'No series is open'
        )}
      </div>
      <Value name="Depth" text={!known ? 'OLD' : depthIsKnown.value ? `${mm(now.depth, 2)} mm` : 'not known'} />
      <Value name="Voltage" text={known ? `${mm(Math.abs(now.drive), 2)} kV` : 'OLD'} />
      <Value name="Scanner" text={linked.value ? (now?.scanner ?? 'Idle').toLowerCase() : 'OLD'} />
      <Value name="Link" text={linked.value ? `${shownAge.value} ms` : 'lost'} />
      <button aria-pressed={dark.value} onClick={() => void (dark.value = !dark.value)}>
        Dark
      </button>
    </header>
  )
}
