// The newest confirmation image of each run at the cursor: the slice along the needle, as the report has it.
import { signal } from '@preact/signals'

import { withToken } from '../address'
import type { ConfirmationImage } from '../generated/messages'
import { mm } from '../viewer/geometry'
import { type Run, runs } from './runs'
import { ownTime } from './time'

type Which = 'before' | 'after' | 'difference'
const kWhich: Which[] = ['before', 'after', 'difference']
export const which = signal<Which>('after')
export const nextWhich = () => void (which.value = kWhich[(kWhich.indexOf(which.value) + 1) % kWhich.length]!)

export function imageAt(run: Run, own: number): ConfirmationImage | undefined {
  return run.about.images.filter((image) => image.at <= own + 1e-9).sort((a, b) => a.at - b.at).at(-1)
}

function Shown(props: { run: Run }) {
  const { run } = props
  const image = imageAt(run, ownTime(run))
  const name = image?.pictures.find((picture) => picture.includes(which.value))
  const whose = runs.value.length > 1 ? `${run.letter}: ` : ''
  return (
    <figure data-picture={run.letter} data-step={image?.step ?? 0}>
      <div class="frame">
        {image && name && <img src={withToken(run.base + name)} alt={`run ${run.letter}, step ${image.step}, ${which.value}`} />}
        {image && !name && <p>The folder has no such picture.</p>}
        {!image && <p>No image yet.</p>}
      </div>
      <figcaption>
        {image ? (
          <>
            <b>
              {whose}step {image.step}, {image.at.toFixed(3)} s, {image.verdict || 'not checked'}
            </b>
            {image.tip_found && (
              <>
                <br />
                tip at {mm(image.found, 2)} ± {mm(image.sigma, 2)} mm, planned {mm(image.planned, 2)} mm
              </>
            )}
          </>
        ) : (
          <b>{whose}no image</b>
        )}
      </figcaption>
    </figure>
  )
}

export function Pictures() {
  return (
    <section class="pictures" aria-label="newest image at the cursor">
      <div class="row" role="group" aria-label="which picture">
        {kWhich.map((one) => (
          <button key={one} aria-pressed={which.value === one} onClick={() => void (which.value = one)}>
            {one === 'difference' ? 'Difference' : one === 'after' ? 'After' : 'Before'}
          </button>
        ))}
      </div>
      <div class="pair">
        {runs.value.map((run) => (
          <Shown key={run.letter} run={run} />
        ))}
      </div>
    </section>
  )
}
