// Which runs are shown and how they ended; the time, and what moves it.
import { withToken } from '../address'
import { dark } from '../theme'
import { listedKeys, toEvent } from './keys'
import { type Run, runs } from './runs'
import { isZoomed, now, setZero, zero, zoomBy, zoomOut } from './time'

function About(props: { run: Run }) {
  const { about, base, letter } = props.run
  return (
    <div class="about" data-run={letter}>
      {runs.value.length > 1 && <span class={`badge ${letter}`}>{letter}</span>}
      <div>
        <p class="title">
          <b>{about.title}</b>
          <span class="outcome" data-outcome={about.outcome}>
            {about.outcome.toUpperCase()}
          </span>
          {about.simulated && <span class="simulated">SIMULATED</span>}
        </p>
        <p class="verdict" title={about.verdict}>
          {about.verdict}
        </p>
        <p class="source" title={`${about.folder}. ${about.log_note}`}>
          <a href={withToken(`${base}report.html`)} target="_blank" rel="noreferrer">
            Report
          </a>{' '}
          · {about.folder} · seed {about.seed} · {about.log_note}
        </p>
      </div>
    </div>
  )
}

export function Head() {
  return (
    <header class="head">
      <h1>Review</h1>
      {runs.value.map((run) => (
        <About key={run.letter} run={run} />
      ))}
    </header>
  )
}

export function Controls() {
  return (
    <div class="controls" role="group" aria-label="time">
      <output data-name="time">{now.value.toFixed(3)} s</output>
      <button aria-label="event before" onClick={() => toEvent(-1)}>
        ‹ Event
      </button>
      <button aria-label="next event" onClick={() => toEvent(1)}>
        Event ›
      </button>
      <button aria-label="zoom in" onClick={() => zoomBy(2)}>
        +
      </button>
      <button aria-label="zoom out" onClick={() => zoomBy(0.5)}>
        −
      </button>
      <button aria-disabled={!isZoomed.value} onClick={zoomOut}>
        Whole
      </button>
      <button aria-pressed={zero.value === 'insertion'} onClick={() => setZero(zero.value === 'start' ? 'insertion' : 'start')}>
        0 s at insertion
      </button>
      <button aria-pressed={dark.value} onClick={() => void (dark.value = !dark.value)}>
        Dark
      </button>
      <button aria-label="keys" aria-expanded={listedKeys.value} onClick={() => void (listedKeys.value = !listedKeys.value)}>
        ?
      </button>
    </div>
  )
}
