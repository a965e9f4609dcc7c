// 30 s of depth against plan and of voltage in its envelope. Each 20 ms has its minimum and maximum, so a spike of one
// millisecond is drawn.
import 'uplot/dist/uPlot.min.css'

import { useEffect, useRef } from 'preact/hooks'
import uPlot from 'uplot'

import { kPlot_ms, telemetry } from './robot'

const kDraw_ms = 250
const kTogether = 3
type Columns = (number | null)[][]

const kInk = '#15191d'
const kPale = '#69737c'
const line = (label: string, stroke: string): uPlot.Series => ({ label, stroke, width: 1.5, points: { show: false } })

function options(title: string, unit: string, low: number, series: uPlot.Series[]): uPlot.Options {
  const axis = { stroke: kInk, font: '16px DejaVu Sans, sans-serif', grid: { stroke: '#b4babf' } }
  return {
    width: 530,
    height: 128, // two of them fit below the three checks
    title,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false, range: [-kPlot_ms / 1000, 0] }, y: { range: (_u, min, max) => [Math.min(low, min), Math.max(max * 1.1, 1)] } },
    axes: [{ ...axis, size: 28, values: (_u, ticks) => ticks.map((t) => `${t} s`) }, { ...axis, size: 74, values: (_u, ticks) => ticks.map((t) => `${t} ${unit}`) }],
    series: [{}, ...series],
  }
}

// One column of pixels shows three batches: minimum, then maximum.
function columns(of: 'depth' | 'drive'): Columns {
  const now = telemetry.at(-1)?.time ?? 0
  const all: Columns = of === 'depth' ? [[], [], []] : [[], [], [], []]
  for (let n = 0; n + kTogether <= telemetry.length; n += kTogether) {
    const some = telemetry.slice(n, n + kTogether)
    const sample = some[0]!
    const values =
      of === 'depth'
        ? [Math.min(...some.map((s) => s.depth_low)), Math.max(...some.map((s) => s.depth_high))]
        : [Math.min(...some.map((s) => s.drive_low)), Math.max(...some.map((s) => s.drive_high))]
    for (const value of values) {
      all[0]!.push((sample.time - now) / 1000)
      all[1]!.push(value)
      all[2]!.push(of === 'depth' ? sample.setpoint : sample.envelope)
      if (of === 'drive') all[3]!.push(-sample.envelope)
    }
  }
  return all
}

function Plot(props: { of: 'depth' | 'drive'; label: string; options: uPlot.Options }) {
  const place = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const plot = new uPlot(props.options, columns(props.of) as uPlot.AlignedData, place.current!)
    const timer = setInterval(() => !document.hidden && plot.setData(columns(props.of) as uPlot.AlignedData), kDraw_ms)
    return () => {
      clearInterval(timer)
      plot.destroy()
    }
  }, [])
  return <div class="plot" ref={place} role="img" aria-label={props.label} />
}

const kDepth = options('Depth (dark) and plan (pale)', 'mm', -0.2, [line('depth', kInk), line('plan', kPale)])
const kDrive = options('Drive voltage (dark) in its limit (pale)', 'kV', -1, [line('drive', kInk), line('limit', kPale), line('limit', kPale)])

export function Plots() {
  return (
    <>
      <Plot of="depth" label="depth against plan, last 30 s" options={kDepth} />
      <Plot of="drive" label="drive voltage and limit, last 30 s" options={kDrive} />
    </>
  )
}
