// Before and after, side by side: detected tip, planned target, error and confidence. No default answer.
import { computed, effect, signal } from '@preact/signals'

import type { Checked, Judgement, State } from './generated/messages'
import { withToken } from './address'
import { send } from './link'
import { Compare } from './compare'
import { checked, state, disabledReason, runOver } from './robot'
import { tipText } from './stop_card'
import { mm } from './viewer/geometry'

function Buttons(props: { of: Checked }) {
  const why = disabledReason.value || state.value?.disabled.judge || ''
  const whyNotAccept = disabledReason.value || state.value?.disabled.accept || ''
  const judge = (judgement: Judgement) => void send({ type: 'Judge', stage: props.of.stage, judgement })
  return (
    <div class="row decide">
      <button aria-disabled={whyNotAccept !== ''} title={whyNotAccept} onClick={() => judge('Accept')}>
        Accept this depth
      </button>
      <button aria-disabled={why !== ''} title={why} onClick={() => judge('Adjust')}>
        Adjust: retract, plan again
      </button>
      <button aria-disabled={why !== ''} title={why} onClick={() => judge('Reject')}>
        Reject: retract, end
      </button>
      {whyNotAccept && <span data-name="why-not-accept">{whyNotAccept}</span>}
    </div>
  )
}

// Once a run is over: its result, or the image, on which a further target is set. An accepted one makes way by itself.
const shown = signal<'result' | 'image' | null>(null)
effect(() => {
  if (!runOver.value) shown.value = null
})
const showsImage = computed(() => runOver.value && (shown.value ?? (state.value?.completed ? 'image' : 'result')) === 'image')

function Report(props: { path: string; completed: boolean }) {
  const image = showsImage.value
  return (
    <div class="row" data-name="report">
      <button onClick={() => void (shown.value = image ? 'result' : 'image')}>
        {image ? 'Show the result' : 'Back to the image'}
      </button>
      {/* No print from here: a print dialog that this page opens may stop it, and STOP with it, until it is closed. */}
      <a class="button" href={withToken(props.path)} target="_blank" rel="noreferrer">
        {props.completed ? 'Accepted.' : 'Not completed.'} Open the report, to read, print or save as PDF
      </a>
    </div>
  )
}

// Stopped or retracted before the end of a step.
function NoImage(props: { path: string }) {
  return (
    <div class="confirm" role="status">
      <h2>The step did not end: no image was taken.</h2>
      <p data-name="tip-now">{tipText.value}</p>
      <Report path={props.path} completed={false} />
      <p>Another run begins with the three checks.</p>
    </div>
  )
}

// Below the image.
function Result(props: { of: Checked | undefined; path: string; completed: boolean }) {
  const { of } = props
  return (
    <div class="result" role="status">
      <p>
        {!of && 'No image was taken.'}
        {of && !of.tip_found && 'No tip was found.'}
        {of?.tip_found && (
          <>
            Tip at <b data-name="found-depth">{foundText(of)}</b>, error <b data-name="error">{mm(of.error, 2)} mm</b>, depth
            check: <b data-name="verdict">{of.verdict}</b>
          </>
        )}
      </p>
      <Report path={props.path} completed={props.completed} />
    </div>
  )
}

const foundText = (of: Checked) => `${mm(of.found, 2)} ± ${mm(of.sigma, 2)} mm`

const heldText = (now: State) =>
  `The needle is ${now.locked ? 'locked' : 'held'} for ${now.hold_left} s more, then retracted.`

// A demonstration that does not wait as long as a scanner says so.
const shortScanText = (now: State) =>
  `SIMULATED: an image takes ${now.short_scan} s here; a scanner takes 20 to 60 s.`

export function ConfirmView() {
  const now = state.value
  const last = checked.value.at(-1)
  if (now?.step !== 'Confirm') return null
  if (showsImage.value) return <Result of={last} path={now.report} completed={now.completed} />
  if (!last && now.report) return <NoImage path={now.report} />
  if (!last && now.mode !== 'Hold' && now.scanner === 'Idle') return null // the image shows the retracting tip
  if (!last || (now.scanner !== 'Idle' && !now.report))
    return (
      <div class="confirm" role="status">
        <h2>{now.scanner === 'Checking' ? 'Looking for the tip in the new image…' : 'The scanner takes the image…'}</h2>
        {now.hold_left > 0 && <p>{heldText(now)}</p>}
        {now.short_scan > 0 && <p data-name="short-scan">{shortScanText(now)}</p>}
      </div>
    )
  return (
    <div class="confirm">
      <Compare of={last}>
        {now.hold_left > 0 && <p data-name="hold-left">{heldText(now)}</p>}
        {now.hold_left > 0 && now.short_scan > 0 && <p data-name="short-scan">{shortScanText(now)}</p>}
      </Compare>
      <dl>
        <div>
          <dt>Planned</dt>
          <dd>{mm(last.planned, 2)} mm</dd>
        </div>
        <div>
          <dt>In the image</dt>
          <dd data-name="found-depth">
            {last.tip_found ? foundText(last) : 'no tip found'}
          </dd>
        </div>
        <div>
          <dt>Error</dt>
          <dd data-name="error">{last.tip_found ? `${mm(last.error, 2)} mm` : 'unknown'}</dd>
        </div>
        <div>
          <dt>Beside the path</dt>
          <dd data-name="lateral">
            {last.tip_found ? `${mm(last.lateral, 2)} ± ${mm(last.lateral_sigma, 2)} mm` : 'unknown'}
          </dd>
        </div>
        <div>
          <dt>Angle to it</dt>
          <dd data-name="angle">{last.tip_found ? `${mm(last.angle)} ± ${mm(last.angle_sigma)} deg` : 'unknown'}</dd>
        </div>
        <div>
          <dt>Confidence</dt>
          <dd>{(100 * last.confidence).toFixed(0)} %</dd>
        </div>
        <div>
          <dt>Depth check</dt>
          <dd data-name="verdict">{last.verdict}</dd>
        </div>
      </dl>
      <p>{last.reason}</p>
      {now.report ? <Report path={now.report} completed={now.completed} /> : <Buttons of={last} />}
    </div>
  )
}
