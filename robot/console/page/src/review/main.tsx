// The page of finished runs: nothing on it reaches a robot.
import { render } from 'preact'

import { EventList } from './event_list'
import { Controls, Head } from './head'
import { KeyList, listen } from './keys'
import { Pictures } from './pictures'
import { failure, load, runs } from './runs'
import { Timeline } from './timeline'
import { Values } from './values'

function Page() {
  if (failure.value)
    return (
      <p class="nothing" role="alert">
        {failure.value}
      </p>
    )
  if (runs.value.length === 0) return <p class="nothing">Reading the runs…</p>
  return (
    <div class="review" data-runs={runs.value.length}>
      <Head />
      <main>
        <Controls />
        <Timeline />
        <EventList />
      </main>
      <aside aria-label="at the cursor">
        <Values />
        <Pictures />
      </aside>
      <KeyList />
    </div>
  )
}

render(<Page />, document.getElementById('page')!)
listen()
void load()
