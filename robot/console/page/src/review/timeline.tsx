// Lanes and plots under one cursor, which is moved by pointer, wheel or key; above them the whole of the runs.
import { useEffect, useRef } from 'preact/hooks'

import { Lanes } from './lanes'
import { Plots } from './plots'
import { runs } from './runs'
import { inner, kLeft_px, timeAt, width, xOf } from './scale'
import { isZoomed, moveTo, now, onAxis, view, whole, zoomBy } from './time'

const kWheel = 1.25 // of the view, each step

// The primary button moves the cursor, in whole milliseconds; also outside of the element once it is pressed.
function dragging(timeOf: (event: PointerEvent) => number) {
  const move = (event: PointerEvent) => moveTo(Math.round(1000 * timeOf(event)) / 1000)
  return {
    onPointerDown: (event: PointerEvent) => {
      if (event.button !== 0) return
      ;(event.currentTarget as Element).setPointerCapture(event.pointerId)
      move(event)
    },
    onPointerMove: (event: PointerEvent) => {
      if ((event.currentTarget as Element).hasPointerCapture(event.pointerId)) move(event)
    },
  }
}

const within = (event: PointerEvent | WheelEvent) => event.clientX - (event.currentTarget as Element).getBoundingClientRect().left

function Overview() {
  const [first, last] = whole.value
  const place = (time: number) => kLeft_px + ((time - first) / (last - first)) * inner()
  const [from, to] = view.value
  return (
    <div
      class="overview"
      role="slider"
      tabIndex={0}
      aria-label="time"
      aria-valuemin={first}
      aria-valuemax={last}
      aria-valuenow={now.value}
      aria-valuetext={`${now.value.toFixed(3)} s`}
      {...dragging((event) => first + ((within(event) - kLeft_px) / inner()) * (last - first))}
    >
      <svg width={width.value} height="30" aria-hidden="true">
        <text x={kLeft_px - 14} y="21" text-anchor="end">
          whole
        </text>
        <rect class="track" x={kLeft_px} y="11" width={inner()} height="8" />
        {isZoomed.value && <rect class="window" x={place(from)} y="4" width={Math.max(place(to) - place(from), 3)} height="22" />}
        {runs.value.flatMap((run) =>
          run.about.hazards.map(({ at }) => <rect key={`${run.letter} ${at}`} class="hazard-mark" x={place(onAxis(run, at)) - 2} y="7" width="4" height="16" />),
        )}
        <circle class="thumb" cx={place(now.value)} cy="15" r="10" />
      </svg>
    </div>
  )
}

function Cursor() {
  const at = xOf(now.value)
  if (at < kLeft_px - 1 || at > kLeft_px + inner() + 1) return null
  return <div class="cursor" data-name="cursor" style={{ left: `${at}px` }} />
}

function HazardLines() {
  const [from, to] = view.value
  return (
    <>
      {runs.value.flatMap((run) =>
        run.about.hazards
          .map(({ at }) => onAxis(run, at))
          .filter((at) => at >= from && at <= to)
          .map((at) => <div key={`${run.letter} ${at}`} class="hazard-line" style={{ left: `${xOf(at)}px` }} />),
      )}
    </>
  )
}

export function Timeline() {
  const place = useRef<HTMLElement>(null)
  const scrubbed = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const observer = new ResizeObserver(() => void (width.value = place.current!.clientWidth))
    observer.observe(place.current!)
    // Not by a property: a wheel listener that stops scrolling may not be passive.
    const zoom = (event: WheelEvent) => {
      event.preventDefault()
      zoomBy(event.deltaY < 0 ? kWheel : 1 / kWheel, timeAt(within(event)))
    }
    scrubbed.current!.addEventListener('wheel', zoom, { passive: false })
    return () => observer.disconnect()
  }, [])
  return (
    <section class="timeline" aria-label="timeline" ref={place}>
      <Overview />
      <div class="scrubbed" ref={scrubbed} {...dragging((event) => timeAt(within(event)))}>
        <Lanes />
        <Plots />
        <HazardLines />
        <Cursor />
      </div>
    </section>
  )
}
