// Depth and target of all runs in one plot; the voltage of each in its limit in one of its own. Drawn anew only when the
// view, the size or the theme changes: the cursor lies over them.
import 'uplot/dist/uPlot.min.css'

import { useSignalEffect } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'
import uPlot from 'uplot'

import { dark } from '../theme'
import { type Run, runs } from './runs'
import { curveOf } from './samples'
import { inner, kLeft_px, kRight_px, width } from './scale'
import { onAxis, originOf, view } from './time'

interface Line {
  run: Run
  column: string
  factor: number
  style: string // CSS variable of its colour
  width: number
}

const colour = (variable: string) => getComputedStyle(document.documentElement).getPropertyValue(variable).trim()

function table(lines: Line[]): uPlot.AlignedData {
  const tables = lines.map(({ run, column, factor }) => {
    const origin = originOf(run)
    const [from, to] = view.value
    const { at, values } = curveOf(run, run.columns.get(column)!, from + origin, to + origin, Math.round(inner()))
    return [at.map((time) => onAxis(run, time)), values.map((value) => (value === null ? null : factor * value))] as uPlot.AlignedData
  })
  return uPlot.join(tables)
}

// `least`: the range that is shown at least. Above the highest value there is room for the caption.
function options(unit: string, least: [number, number], lines: Line[], height: number, numbers: boolean): uPlot.Options {
  const axis = { stroke: colour('--ink'), font: '15px DejaVu Sans, sans-serif', grid: { stroke: colour('--grid'), width: 1 }, ticks: { stroke: colour('--grid') } }
  return {
    width: width.value,
    height,
    legend: { show: false },
    cursor: { show: false },
    padding: [8, kRight_px, numbers ? 0 : 8, 0],
    scales: { x: { time: false, range: () => [...view.value] }, y: { range: (_u, min, max) => [Math.min(least[0], 1.08 * min), Math.max(least[1], 1.35 * max)] } },
    axes: [
      { ...axis, size: numbers ? 30 : 0, values: (_u, ticks) => (numbers ? ticks.map((t) => `${Number(t.toFixed(6))} s`) : ticks.map(() => '')) },
      { ...axis, size: kLeft_px, space: 20, values: (_u, ticks) => ticks.map((t) => `${Number(t.toFixed(6))} ${unit}`) },
    ],
    series: [{}, ...lines.map((line) => ({ stroke: colour(line.style), width: line.width, points: { show: false } }))],
  }
}

function Plot(props: { name: string; label: string; unit: string; least: [number, number]; lines: Line[]; numbers?: boolean }) {
  const place = useRef<HTMLDivElement>(null)
  const plot = useRef<uPlot | null>(null)
  const redraw = () => {
    plot.current?.destroy()
    const height = place.current!.clientHeight
    plot.current = new uPlot(options(props.unit, props.least, props.lines, height, props.numbers ?? false), table(props.lines), place.current!)
  }
  useSignalEffect(() => {
    void [width.value, dark.value]
    redraw()
  })
  useEffect(() => {
    const observer = new ResizeObserver(() => plot.current && plot.current.height !== place.current!.clientHeight && redraw())
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      plot.current?.destroy()
    }
  }, [])
  return (
    <figure class="plotted" data-plot={props.name}>
      <figcaption>{props.label}</figcaption>
      <div ref={place} role="img" aria-label={props.label} />
    </figure>
  )
}

const depthLines = (run: Run): Line[] => [
  { run, column: 'setpoint_mm', factor: 1, style: `--pale-${run.letter}`, width: 3 },
  { run, column: 'displacement_mm', factor: 1, style: `--run-${run.letter}`, width: 1.5 },
]
const driveLines = (run: Run): Line[] => [
  { run, column: 'voltage_V', factor: 1e-3, style: `--run-${run.letter}`, width: 1.5 },
  { run, column: 'envelope_kV', factor: 1, style: `--pale-${run.letter}`, width: 2 },
  { run, column: 'envelope_kV', factor: -1, style: `--pale-${run.letter}`, width: 2 },
]

export function Plots() {
  const both = runs.value.length > 1
  return (
    <>
      <Plot name="depth" label="Depth, and target (pale)" unit="mm" least={[-0.2, 0.2]} lines={runs.value.flatMap(depthLines)} />
      {runs.value.map((run, n) => (
        <Plot
          key={run.letter}
          name={`drive ${run.letter}`}
          label={both ? `Voltage of ${run.letter}, and its limit (pale)` : 'Voltage, and its limit (pale)'}
          unit="kV"
          least={[-1, 1]}
          lines={driveLines(run)}
          numbers={n === runs.value.length - 1}
        />
      ))}
    </>
  )
}
