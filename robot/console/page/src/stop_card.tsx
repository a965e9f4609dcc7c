// After a stop: what happened, where the tip is, and the steps back to a robot that can be armed, of which one control is
// lit. What is said of the needle is measured.
import { computed } from '@preact/signals'

import { controls, depthIsKnown, disabledReason, kBack_mm, linked, opened, plan, state, welcome } from './robot'
import { mm } from './viewer/geometry'

const kStandingStop = 'E-122'

export const tipText = computed(() => {
  const depth = state.value?.depth ?? 0
  if (!depthIsKnown.value) return 'It is not known where the needle is.'
  if (Math.abs(depth) <= kBack_mm) return `The needle is back: ${mm(depth, 2)} mm measured.`
  return `The needle is at ${mm(depth, 2)} mm: not back.`
})

// Without a link nothing is known of it: the steps are those of loss_screen.tsx.
export const stopped = computed(() => {
  const now = state.value
  if (!now || !linked.value) return null
  const alarm = now.alarms.find((one) => now.mode === 'Trip' || one.code === kStandingStop)
  return alarm && now.mode !== 'Lock' ? alarm : null
})

type Control = 'reset' | 'plan' | 'checks'

// The one control that leads on. None: what leads on is not on this page.
export const lit = computed<Control | null>(() => {
  const now = state.value
  if (!stopped.value || !now || disabledReason.value) return null
  if (now.disabled.reset === '') return 'reset'
  if (plan.value && !plan.value.confirmed) return 'plan'
  if (plan.value && !now.ticks.every(Boolean)) return 'checks'
  return null
})

interface Step {
  text: string
  control?: Control
}

function steps(): Step[] {
  const all: Step[] = [{ text: 'Look at the needle and at the patient.' }]
  if (depthIsKnown.value && Math.abs(state.value!.depth) > kBack_mm)
    all.push({ text: 'If the needle does not come back by itself, draw the stage back along its guide by hand.' })
  if (stopped.value!.code === kStandingStop) all.push({ text: 'Find out why STOP was pressed.' })
  if (lit.value !== 'reset' && opened.value) {
    if (!plan.value) all.push({ text: 'Set entry and target.' })
    if (!plan.value?.confirmed) all.push({ text: 'Confirm the plan.', control: 'plan' })
    if (!state.value!.ticks.every(Boolean)) all.push({ text: 'Tick the three checks.', control: 'checks' })
  }
  const onPage = welcome.value?.simulated || stopped.value!.code === kStandingStop
  if (!onPage) all.push({ text: 'Turn the reset key on the device.' })
  else if (controls.value) all.push({ text: 'Press Reset.', control: 'reset' })
  else all.push({ text: 'Press Reset on the page that controls the robot.' })
  return all
}

export function StopCard() {
  const happened = stopped.value
  if (!happened) return null
  return (
    <section class="card" aria-label="stopped" data-name="stop-card">
      <h2>
        Stopped: {happened.what} <span class="code">{happened.code}</span>
      </h2>
      <p>{happened.robot_did}</p>
      <p data-name="tip-now">
        <b>{tipText.value}</b>
      </p>
      <ol>
        {steps().map((step) => (
          <li key={step.text} aria-current={step.control && step.control === lit.value ? 'step' : undefined}>
            {step.text}
          </li>
        ))}
      </ol>
    </section>
  )
}
