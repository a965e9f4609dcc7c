// The current step, decided by the server, and what to do in it.
import type { Step } from './generated/messages'
import { linked, planned, robotSilent, runOver, state } from './robot'
import { stopped } from './stop_card'

const kSteps: [Step, string][] = [
  ['Image', 'Open a series.'],
  ['Plan', 'Click the image, then Set entry and Set target. Confirm the plan.'],
  ['Check', 'Compare with the patient and tick all three.'],
  ['Arm', 'Hold Arm for 2 seconds.'],
  ['Insert', 'Hold to insert. Let go to hold the needle.'],
  ['Confirm', 'Look at the new image: accept, adjust or reject.'],
]

function hintOf(step: Step, hint: string): string {
  if (!linked.value || robotSilent.value) return 'No link to the robot: follow the steps over the image.'
  if (stopped.value) return 'Stopped: follow the steps beside the image.'
  if (step === 'Plan' && planned.value?.entry.length === 0) return 'Click where the tip waits, then Set entry.'
  if (step === 'Plan' && planned.value?.target.length === 0) return 'Click where it shall go, then Set target.'
  if (step === 'Plan') return 'Look at depth, layers and limits. Confirm the plan.'
  if (runOver.value && state.value?.completed) return 'Accepted, and over. A further target: click it, then Set target.'
  if (runOver.value) return 'The run is over: see its report.'
  if (step === 'Check' && (state.value?.carried_left ?? 0) > 0) return 'Compare with the patient and tick.'
  if (step === 'Confirm' && state.value?.completed) return 'Accepted. Take the sample, then Retract.'
  return hint
}

export function StepRail() {
  const now = state.value?.step
  return (
    <nav aria-label="steps" style={{ gridArea: 'steps' }}>
      <ol class="steps">
        {kSteps.map(([step, hint], n) => (
          <li key={step} aria-current={step === now ? 'step' : undefined}>
            {n + 1} {step}
            {step === now && <span class="hint">{hintOf(step, hint)}</span>}
          </li>
        ))}
      </ol>
    </nav>
  )
}
