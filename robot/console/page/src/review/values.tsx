// What the runs measured at the cursor, and how they differ.
import type { Span } from '../generated/messages'
import { mm } from '../viewer/geometry'
import { kStops } from './events'
import { type Run, runs } from './runs'
import { indexAt } from './samples'
import { ownTime } from './time'

interface Quantity {
  name: string
  unit: string
  digits: number
  of: (run: Run, index: number) => number | undefined
}

const column = (name: string, factor = 1) => (run: Run, index: number) => {
  const value = run.columns.get(name)?.[index]
  return value === undefined ? undefined : factor * value
}
const kQuantities: Quantity[] = [
  { name: 'Depth', unit: 'mm', digits: 3, of: column('displacement_mm') },
  { name: 'Target', unit: 'mm', digits: 3, of: column('setpoint_mm') },
  {
    name: 'Depth - target',
    unit: 'mm',
    digits: 3,
    of: (run, index) => run.columns.get('displacement_mm')![index]! - run.columns.get('setpoint_mm')![index]!,
  },
  { name: 'True tip', unit: 'mm', digits: 3, of: column('tip_mm') },
  { name: 'Voltage', unit: 'kV', digits: 3, of: column('voltage_V', 1e-3) },
  { name: 'Its monitor', unit: 'kV', digits: 3, of: column('monitor_kV') },
  { name: 'Its limit', unit: 'kV', digits: 3, of: column('envelope_kV') },
  { name: 'Current', unit: 'µA', digits: 2, of: column('current_uA') },
]

export function spanAt(run: Run, own: number): Span | undefined {
  return run.about.spans.findLast((span) => span.from <= own + 1e-9)
}

function needleText(run: Run, index: number): string {
  const locked = run.columns.get('locked')?.[index]
  return locked === undefined ? '–' : locked > 0 ? 'locked' : 'free'
}

const shownAs = (value: number | undefined, digits: number) => (value === undefined ? '–' : mm(value, digits))

export function Values() {
  const all = runs.value.map((run) => ({ run, index: indexAt(run, ownTime(run)) }))
  const both = all.length > 1
  const texts = (name: string, of: (run: Run, index: number) => string) => (
    <tr data-row={name}>
      <th scope="row">{name}</th>
      {all.map(({ run, index }) => (
        <td key={run.letter}>{index < 0 ? '–' : of(run, index)}</td>
      ))}
      {both && <td />}
    </tr>
  )
  const span = (run: Run, index: number) => spanAt(run, run.time[index]!)
  const shown = kQuantities.filter(({ of }) => all.some(({ run }) => of(run, 0) !== undefined))
  return (
    <section class="values" aria-label="values at the cursor">
      <table>
        <thead>
          <tr>
            <th scope="col">at the cursor</th>
            {all.map(({ run }) => (
              <th key={run.letter} scope="col" class={`run ${run.letter}`}>
                {both ? run.letter : 'run'}
              </th>
            ))}
            {both && <th scope="col">B - A</th>}
          </tr>
        </thead>
        <tbody>
          {texts('Its own time, s', (run, index) => run.time[index]!.toFixed(3))}
          {texts('State', (run, index) => span(run, index)?.mode.toUpperCase() ?? '–')}
          {texts('Step', (run, index) => String(span(run, index)?.step ?? '–'))}
          {texts('Stop', (run, index) => kStops[span(run, index)?.stop ?? 'None'])}
          {all.some(({ run }) => run.columns.has('locked')) && texts('Needle', needleText)}
          {shown.map(({ name, unit, digits, of }) => {
            const values = all.map(({ run, index }) => (index < 0 ? undefined : of(run, index)))
            const [a, b] = values
            return (
              <tr key={name} data-row={name}>
                <th scope="row">
                  {name}, {unit}
                </th>
                {values.map((value, n) => (
                  <td key={n}>{shownAs(value, digits)}</td>
                ))}
                {both && <td>{shownAs(a === undefined || b === undefined ? undefined : b - a, digits)}</td>}
              </tr>
            )
          })}
        </tbody>
      </table>
    </section>
  )
}
