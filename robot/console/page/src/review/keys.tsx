// All keys of the page, and the list of them that `?` shows.
import { signal } from '@preact/signals'

import { nextTime } from './events'
import { nextWhich } from './pictures'
import { runs } from './runs'
import { neighbour } from './samples'
import { moveTo, now, onAxis, ownTime, setZero, whole, zero, zoomBy, zoomOut } from './time'

export const listedKeys = signal(false)

export function toEvent(step: 1 | -1): void {
  const time = nextTime(step)
  if (time !== undefined) moveTo(time)
}

function toSample(step: 1 | -1): void {
  const run = runs.value[0]!
  moveTo(onAxis(run, neighbour(run, ownTime(run), step)))
}

const by = (seconds: number) => () => moveTo(now.value + seconds)
interface Key {
  keys: string[]
  shown: string
  does: string
  act: () => void
}
const kKeys: Key[] = [
  { keys: ['ArrowLeft'], shown: '←', does: '0.1 s back', act: by(-0.1) },
  { keys: ['ArrowRight'], shown: '→', does: '0.1 s on', act: by(0.1) },
  { keys: ['Shift+ArrowLeft'], shown: 'Shift ←', does: '1 s back', act: by(-1) },
  { keys: ['Shift+ArrowRight'], shown: 'Shift →', does: '1 s on', act: by(1) },
  { keys: ['PageUp'], shown: 'Page up', does: '10 s back', act: by(-10) },
  { keys: ['PageDown'], shown: 'Page down', does: '10 s on', act: by(10) },
  { keys: [','], shown: ',', does: 'sample before, of A', act: () => toSample(-1) },
  { keys: ['.'], shown: '.', does: 'next sample, of A', act: () => toSample(1) },
  { keys: ['p', 'ArrowUp'], shown: 'p or ↑', does: 'event before', act: () => toEvent(-1) },
  { keys: ['n', 'ArrowDown'], shown: 'n or ↓', does: 'next event', act: () => toEvent(1) },
  { keys: ['Home'], shown: 'Home', does: 'beginning', act: () => moveTo(whole.value[0]) },
  { keys: ['End'], shown: 'End', does: 'end', act: () => moveTo(whole.value[1]) },
  { keys: ['+', '='], shown: '+ or wheel', does: 'zoom in', act: () => zoomBy(2) },
  { keys: ['-'], shown: '- or wheel', does: 'zoom out', act: () => zoomBy(0.5) },
  { keys: ['0'], shown: '0', does: 'whole run', act: zoomOut },
  { keys: ['z'], shown: 'z', does: 'zero of time: start or first insertion', act: () => setZero(zero.value === 'start' ? 'insertion' : 'start') },
  { keys: ['i'], shown: 'i', does: 'image before, after, difference', act: nextWhich },
  { keys: ['?'], shown: '?', does: 'this list', act: () => void (listedKeys.value = !listedKeys.value) },
]

// Shift counts only with arrows: elsewhere it is part of the character.
export function listen(): void {
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || runs.value.length === 0) return
    const name = event.shiftKey && event.key.startsWith('Arrow') ? `Shift+${event.key}` : event.key
    if (event.key === 'Escape') listedKeys.value = false
    const key = kKeys.find((one) => one.keys.includes(name))
    if (!key) return
    event.preventDefault()
    key.act()
  })
}

export function KeyList() {
  if (!listedKeys.value) return null
  return (
    <section class="keys" aria-label="keys">
      <h2>Keys</h2>
      <dl>
        {kKeys.map(({ shown, does }) => (
          <div key={shown}>
            <dt>{shown}</dt>
            <dd>{does}</dd>
          </div>
        ))}
      </dl>
      <button onClick={() => void (listedKeys.value = false)}>Close</button>
    </section>
  )
}
