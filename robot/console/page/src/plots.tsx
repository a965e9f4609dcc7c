// 30 s of depth against plan and of voltage in its envelope. Each 60 ms has its minimum and maximum, so a spike of one
// millisecond is drawn.
import 'uplot/dist/uPlot.min.css'

import { useEffect, useRef } from 'preact/hooks'
import uPlot from 'uplot'

import type { Telemetry } from './generated/messages'
import { kPlot_ms, telemetry } from './robot'
import { dark } from './theme'

const kDraw_ms = 250
const kDrawIdle_ms = 30_000 // where there is nothing to see but that time goes on: each sample is drawn once
type Columns = (number | null)[][]

const kSize = { width: 530, height: 128 } // CSS px at most; two of them fit below the three checks
const colour = (variable: string) => getComputedStyle(document.documentElement).getPropertyValue(variable).trim()
const line = (label: string, variable: string): uPlot.Series => ({ label, stroke: colour(variable), width: 1.5, points: { show: false } })

function options(title: string, unit: string, low: number, series: uPlot.Series[]): uPlot.Options {
  const axis = { stroke: colour('--ink'), font: '16px DejaVu Sans, sans-serif', grid: { stroke: colour('--grid') } }
  return {
    ...kSize,
    title,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false, range: [-kPlot_ms / 1000, 0] }, y: { range: (_u, min, max) => [Math.min(low, min), Math.max(max * 1.1, 1)] } },
    axes: [{ ...axis, size: 28, values: (_u, ticks) => ticks.map((t) => `${t} s`) }, { ...axis, size: 74, values: (_u, ticks) => ticks.map((t) => `${t} ${unit}`) }],
    series: [{}, ...series],
  }
}

// One column of pixels shows one sample: minimum, then maximum.
function columns(of: 'depth' | 'drive'): Columns {
  const now = telemetry.at(-1)?.time ?? 0
  const all: Columns = of === 'depth' ? [[], [], []] : [[], [], [], []]
  for (const sample of telemetry) {
    for (const value of of === 'depth' ? [sample.depth_low, sample.depth_high] : [sample.drive_low, sample.drive_high]) {
      all[0]!.push((sample.time - now) / 1000)
      all[1]!.push(value)
      all[2]!.push(of === 'depth' ? sample.setpoint : sample.envelope)
      if (of === 'drive') all[3]!.push(-sample.envelope)
    }
  }
  return all
}

// What can be seen on a plot: samples that are within the noise of each other look the same.
const kNoise: Record<keyof Telemetry, number> = {
  time: Infinity, depth_low: 0.15, depth_high: 0.15, setpoint: 0.01, drive_low: 0.05, drive_high: 0.05, envelope: 0.01,
}
const kSeen = Object.entries(kNoise) as [keyof Telemetry, number][]
const looksLike = (one: Telemetry, other: Telemetry) =>
  kSeen.every(([part, noise]) => Math.abs(one[part] - other[part]) <= noise)

// Nothing moves: all that is in view looks the same. Each sample is looked at once.
let steady: Telemetry | undefined
let changedAt = -Infinity
let lookedAt = -Infinity

function isStill(): boolean {
  const newest = telemetry.at(-1)
  if (newest === undefined) return true
  if (newest.time < lookedAt) steady = undefined // a new stage process has its own clock
  if (steady === undefined) changedAt = lookedAt = -Infinity
  for (const sample of telemetry.slice(telemetry.findLastIndex((one) => one.time <= lookedAt) + 1)) {
    steady ??= sample
    if (looksLike(sample, steady)) continue
    steady = sample
    changedAt = sample.time
  }
  lookedAt = newest.time
  return newest.time - changedAt > kPlot_ms
}

const plots = new Map<uPlot, 'depth' | 'drive'>()
let drawn: Telemetry | undefined

// Both at once: a picture costs the browser as much with one of them changed as with both.
function draw(): void {
  const newest = telemetry.at(-1)
  if (document.hidden || newest === drawn) return
  if (drawn && newest && newest.time - drawn.time < kDrawIdle_ms && newest.time >= drawn.time && isStill()) return
  drawn = newest
  for (const [plot, of] of plots) plot.setData(columns(of) as uPlot.AlignedData)
}

function Plot(props: { of: 'depth' | 'drive'; label: string; options: () => uPlot.Options }) {
  const place = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const plot = new uPlot(props.options(), columns(props.of) as uPlot.AlignedData, place.current!)
    plots.set(plot, props.of)
    // As wide as there is room: at the right end is now.
    const fit = new ResizeObserver(([room]) => {
      const width = Math.min(Math.floor(room!.contentRect.width), kSize.width)
      if (width > 0 && width !== plot.width) plot.setSize({ ...kSize, width })
    })
    fit.observe(place.current!)
    return () => {
      fit.disconnect()
      plots.delete(plot)
      plot.destroy()
    }
  }, [dark.value])
  return <div class="plot" ref={place} role="img" aria-label={props.label} />
}

const strong = () => (dark.value ? 'bright' : 'dark')
const weak = () => (dark.value ? 'dim' : 'pale')
const depthOptions = () =>
  options(`Depth (${strong()}) and plan (${weak()})`, 'mm', -0.2, [line('depth', '--ink'), line('plan', '--pale')])
const driveOptions = () =>
  options(`Drive voltage (${strong()}) in its limit (${weak()})`, 'kV', -1, [line('drive', '--ink'), line('limit', '--pale'), line('limit', '--pale')])

export function Plots() {
  useEffect(() => {
    const timer = setInterval(draw, kDraw_ms)
    return () => clearInterval(timer)
  }, [])
  return (
    <>
      <Plot of="depth" label="depth against plan, last 30 s" options={depthOptions} />
      <Plot of="drive" label="drive voltage and limit, last 30 s" options={driveOptions} />
    </>
  )
}
