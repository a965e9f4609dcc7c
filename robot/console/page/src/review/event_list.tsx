// What happened, as a list: the row at the cursor is marked, a click moves the cursor there. Only the rows in view exist.
import { signal, useSignalEffect } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'

import { current, type Happening, happenings, kKinds, listed, listedKinds, toggle } from './events'
import { runs } from './runs'
import { moveTo } from './time'

const kRow_px = 28
const kAround = 4 // rows beyond those in view

function Row(props: { of: Happening; n: number }) {
  const { of, n } = props
  return (
    <li style={{ top: `${n * kRow_px}px` }} data-kind={of.kind} aria-current={n === current.value ? 'true' : undefined}>
      <button tabIndex={-1} onClick={() => moveTo(of.at)}>
        <span class="at">{of.at.toFixed(3)}</span>
        {runs.value.length > 1 && <span class={`run ${of.run.letter}`}>{of.run.letter}</span>}
        <span class="kind">{of.kind}</span>
        <span class="text">{of.text}</span>
      </button>
    </li>
  )
}

const scrolled = signal(0) // px
const height = signal(200)

export function EventList() {
  const box = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const observer = new ResizeObserver(() => void (height.value = box.current!.clientHeight))
    observer.observe(box.current!)
    return () => observer.disconnect()
  }, [])
  useSignalEffect(() => {
    const top = Math.max(current.value, 0) * kRow_px
    const at = box.current!
    if (top < at.scrollTop || top + kRow_px > at.scrollTop + at.clientHeight) at.scrollTop = top - at.clientHeight / 2
  })
  const first = Math.max(Math.floor(scrolled.value / kRow_px) - kAround, 0)
  const rows = listed.value.slice(first, first + Math.ceil(height.value / kRow_px) + 2 * kAround)
  const shown = listed.value[current.value]
  return (
    <section class="events" aria-label="events">
      <div class="kinds" role="group" aria-label="which events are listed">
        {kKinds.map((kind) => (
          <button key={kind} data-kind={kind} aria-pressed={listedKinds.value.has(kind)} onClick={() => toggle(kind)}>
            {kind} <b>{happenings.value.filter((one) => one.kind === kind).length}</b>
          </button>
        ))}
      </div>
      <div class="list" ref={box} tabIndex={0} role="region" aria-label="list of events"
           onScroll={(event) => void (scrolled.value = event.currentTarget.scrollTop)}>
        <ol style={{ height: `${listed.value.length * kRow_px}px` }}>
          {rows.map((of, n) => (
            <Row key={first + n} of={of} n={first + n} />
          ))}
        </ol>
      </div>
      <p class="said" data-name="said">
        {shown ? `${shown.own.toFixed(3)} s${runs.value.length > 1 ? ` of ${shown.run.letter}` : ''}, ${shown.kind.toLowerCase()}: ${shown.text}` : 'Nothing has happened yet.'}
      </p>
    </section>
  )
}
