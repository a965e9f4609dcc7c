// The plan: points, depth, layers, steps, limits; and the three checks before arming.
import { useEffect, useRef } from 'preact/hooks'

import { withToken } from './address'
import type { Tick } from './generated/messages'
import { mm, ras } from './viewer/geometry'
import { send } from './link'
import { depthIsKnown, disabledReason, isKnown, kBack_mm, opened, plan, planned, runOver, state, type Vec3 } from './robot'
import { lit, StopCard, tipText } from './stop_card'
import { warningsOf } from './plan_warnings'

const kTicks: Tick[] = ['Patient', 'Place', 'Risks']

function Points() {
  const current = planned.value
  return (
    <dl>
      <dt>Entry</dt>
      <dd data-name="entry">{current?.entry[0] ? `${ras(current.entry[0].ras as Vec3)} mm` : 'not set'}</dd>
      <dt>Target</dt>
      <dd data-name="target">{current?.target[0] ? `${ras(current.target[0].ras as Vec3)} mm` : 'not set'}</dd>
      {opened.value && !plan.value && (
        <>
          <dt>Reach</dt>
          <dd>{mm(opened.value.reach)} mm from the entry: dotted circle</dd>
        </>
      )}
      {plan.value && (
        <>
          <dt>Depth</dt>
          <dd>
            <b data-name="planned-depth">{mm(plan.value.depth, 2)} mm</b>, {mm(plan.value.angle, 0)} deg to the axial
            plane, from {plan.value.side}
          </dd>
        </>
      )}
    </dl>
  )
}

function Layers() {
  const layers = plan.value!.layers
  const end = Math.min(layers.at(-1)!.to, plan.value!.depth_max)
  return (
    <div class="layers" role="img" aria-label="layers along the path">
      {layers
        .filter((layer) => layer.from < end)
        .map((layer) => (
          <span key={layer.from} style={{ flex: Math.min(layer.to, end) - layer.from }} title={layer.name}>
            {layer.name} {mm(Math.min(layer.to, end) - layer.from)}
          </span>
        ))}
    </div>
  )
}

function Steps() {
  return (
    <table>
      <caption hidden>steps</caption>
      <thead>
        <tr>
          <th>Step</th>
          <th>Depth mm</th>
          <th>Speed mm/s</th>
          <th>Then</th>
        </tr>
      </thead>
      <tbody>
        {plan.value!.stages.map((step, n) => (
          <tr key={n} aria-current={state.value?.stage === n ? 'true' : undefined}>
            <td>{n + 1}</td>
            <td>{mm(step.depth, 2)}</td>
            <td>{mm(step.speed)}</td>
            <td>{step.image_confirms ? 'hold, image' : 'hold'}</td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

// Value, warn tick, hard tick, number and unit.
function Limit(props: { name: string; value: number | null; warn: number; hard: number; unit: string }) {
  const shown = props.value === null ? 'OLD' : mm(props.value, 2)
  const x = (value: number) => `${Math.min((100 * Math.max(value, 0)) / (1.1 * props.hard), 100)}%`
  return (
    <div class="limit">
      <span>{props.name}</span>
      <svg role="img" aria-label={`${props.name} ${shown} of ${mm(props.hard, 2)} ${props.unit}`}>
        <rect x="0" y="4" width="100%" height="14" class="bar" />
        <rect x="0" y="4" width={x(props.value ?? 0)} height="14" class="filled" />
        <line x1={x(props.warn)} x2={x(props.warn)} y1="2" y2="20" class="tick" stroke-dasharray="3 2" />
        <line x1={x(props.hard)} x2={x(props.hard)} y1="0" y2="22" class="tick" stroke-width="3" />
      </svg>
      <span>
        {shown} / {mm(props.hard, 2)} {props.unit}
      </span>
    </div>
  )
}

function Check(props: { text: string; checked: boolean; set: (on: boolean) => void }) {
  return (
    <label>
      <input
        type="checkbox"
        checked={props.checked}
        disabled={disabledReason.value !== ''}
        onChange={(event) => {
          const on = event.currentTarget.checked
          event.currentTarget.checked = props.checked // until the console says otherwise, which may refuse it
          props.set(on)
        }}
      />
      {props.text}
    </label>
  )
}

function Checks() {
  const series = opened.value!.series
  const { seal, side, depth, layers } = plan.value!
  const texts: Record<Tick, string> = {
    Patient: `The patient is ${series.patient || 'without a name'}, ID ${series.patient_id || 'none'}.`,
    Place: `Needle from ${side}, ${mm(depth, 2)} mm deep, through ${layers.map((l) => l.name).join(', ')}.`,
    Risks: 'High voltage comes on and the needle moves. The E-stop is in reach.',
  }
  const { ticks, ticks_left, carried_left } = state.value!
  const set = (tick: Tick, on: boolean) => void send({ type: 'SetTick', tick, on, seal })
  const renew = (on: boolean) => (on ? void send({ type: 'RenewChecks', seal }) : set('Place', false))
  return (
    <div class={lit.value === 'checks' ? 'checks lit' : 'checks'} data-lit={lit.value === 'checks'}>
      {carried_left > 0 ? (
        <>
          <div class="carried" data-name="carried">
            <p>{texts.Patient}</p>
            <p>{texts.Risks}</p>
            <p>Ticked for an earlier target; can be renewed for {Math.ceil(carried_left / 60)} min.</p>
          </div>
          <Check text={`${texts.Place} Both above still hold.`} checked={ticks.every(Boolean)} set={renew} />
        </>
      ) : (
        kTicks.map((tick, n) => <Check key={tick} text={texts[tick]} checked={ticks[n]!} set={(on) => set(tick, on)} />)
      )}
      {ticks_left > 0 && <p>Checked; good for {Math.ceil(ticks_left)} s.</p>}
    </div>
  )
}

function Warnings() {
  const all = warningsOf(plan.value!, opened.value?.series)
  if (all.length === 0) return null
  return (
    <ul class="warnings" data-name="warnings">
      {all.map((one) => (
        <li key={one}>{one}</li>
      ))}
    </ul>
  )
}

// Armed with the needle not at its rest, the run would begin elsewhere than planned.
function Residual() {
  if (!depthIsKnown.value || Math.abs(state.value!.depth) <= kBack_mm) return null
  return <p data-name="residual">{tipText.value}</p>
}

const kBelow_px = 8

// The control that leads on stands below what happened, and may be out of view on a small screen.
function showLit(panel: HTMLElement): void {
  const control = panel.querySelector('[data-lit=true]')
  if (!control) return
  const hidden = control.getBoundingClientRect().bottom + kBelow_px - panel.getBoundingClientRect().bottom
  if (hidden > 0) panel.scrollTop += hidden
}

export function PlanPanel(props: { children?: preact.ComponentChildren }) {
  const panel = useRef<HTMLElement>(null)
  useEffect(() => showLit(panel.current!), [lit.value])
  const current = planned.value
  const now = state.value
  // Another run of the same plan begins with its checks.
  const checking = plan.value?.confirmed && (now?.step === 'Check' || now?.step === 'Arm' || runOver.value)
  const why = disabledReason.value || now?.disabled.plan || ''
  return (
    <section class="plan" aria-label="plan" tabIndex={0} ref={panel}>
      <StopCard />
      <h2>Plan</h2>
      <Points />
      {current?.refusal && (
        <p role="status" data-name="refusal">
          <b>No plan:</b> {current.refusal}. To do: {current.remedy}.
        </p>
      )}
      {!opened.value && <p>Open a series, then set entry and target.</p>}
      {plan.value && (
        <>
          <Layers />
          <Warnings />
          {checking && <Residual />}
          {checking ? <Checks /> : <Steps />}
          <Limit name="Depth" value={depthIsKnown.value ? now!.depth : null} warn={plan.value.depth} hard={plan.value.depth_max} unit="mm" />
          <Limit name="Voltage" value={isKnown.value ? Math.abs(now!.drive) : null} warn={plan.value.v_max} hard={8} unit="kV" />
          {!plan.value.confirmed && (
            <button
              class={lit.value === 'plan' ? 'lit' : ''}
              data-lit={lit.value === 'plan'}
              aria-disabled={why !== ''}
              title={why}
              onClick={() => void send({ type: 'ConfirmPlan', seal: plan.value!.seal })}
            >
              Confirm this plan
            </button>
          )}
        </>
      )}
      {now?.report && now.step !== 'Confirm' && (
        <a class="button" href={withToken(now.report)} target="_blank" rel="noreferrer">
          Report of the last run
        </a>
      )}
      {props.children}
    </section>
  )
}
