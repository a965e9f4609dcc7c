// The bottom bar, always there: Arm, Hold to insert, Retract, Reset and, bottom right, STOP.
import type { Button } from './generated/messages'
import { held, press, release } from './hold'
import { send } from './link'
import { linked, refused, state, disabledReason } from './robot'
import { lit } from './stop_card'

// Pressed by pointer or key, acts while held; key repeats belong to the same press.
function HoldButton(props: { button: Button; name: string; why: string }) {
  const start = () => props.why === '' && press(props.button)
  const stop = () => held.value === props.button && release()
  const isKey = (event: KeyboardEvent) => event.key === ' ' || event.key === 'Enter'
  return (
    <div class="act">
      <button
        aria-disabled={props.why !== ''}
        aria-pressed={held.value === props.button}
        data-alive={held.value === props.button && state.value?.held[0] === props.button}
        onPointerDown={(event) => {
          if (event.button !== 0) return
          event.currentTarget.setPointerCapture(event.pointerId)
          start()
        }}
        onPointerMove={(event) => event.buttons !== 1 && stop()} // a mouse that has another button down reports no pointerup
        onPointerUp={stop}
        onPointerCancel={stop}
        onLostPointerCapture={stop}
        onPointerLeave={stop} // of a pointer that was not captured
        onContextMenu={(event) => event.preventDefault()}
        onBlur={stop}
        onKeyDown={(event) => {
          if (!isKey(event)) return
          event.preventDefault()
          if (!event.repeat) start()
        }}
        onKeyUp={(event) => isKey(event) && stop()}
      >
        {props.name}
      </button>
      <span class="why">{props.why}</span>
    </div>
  )
}

function Click(props: { name: string; why: string; lit?: boolean; act: () => void }) {
  return (
    <div class="act">
      <button
        class={props.lit ? 'lit' : ''}
        data-lit={props.lit ?? false}
        aria-disabled={props.why !== ''} onClick={() => props.why === '' && props.act()}>
        {props.name}
      </button>
      <span class="why">{props.why}</span>
    </div>
  )
}

function stop(): void {
  release()
  void send({ type: 'Stop' })
}

window.addEventListener('keydown', (event) => {
  if (event.key !== 'Escape' || event.repeat) return
  event.preventDefault()
  stop()
})

// While another button of the mouse is down, a press is a pointermove; and the mouse may be captured elsewhere.
window.addEventListener('pointermove', (event) => {
  const isPress = event.button === 0 && (event.buttons & 1) === 1
  if (isPress && document.elementFromPoint(event.clientX, event.clientY)?.closest('.stopping button')) stop()
}, true)

function armName(): string {
  const now = state.value
  if (now && now.arm_held > 0) return `Arm: ${(2 - now.arm_held).toFixed(1)} s more`
  if (now && now.armed_left > 0) return `Armed: ${Math.ceil(now.armed_left)} s`
  return 'Arm (hold 2 s)'
}

export function ActionBar() {
  const no = state.value?.disabled
  const common = disabledReason.value
  return (
    <footer class="acts">
      <HoldButton button="Arm" name={armName()} why={common || no?.arm || ''} />
      <HoldButton button="Insert" name="Hold to insert" why={common || no?.insert || ''} />
      <Click name="Retract" why={common || no?.retract || ''} act={() => void send({ type: 'Retract' })} />
      <Click name="Reset" lit={lit.value === 'reset'} why={common || no?.reset || ''} act={() => void send({ type: 'Reset' })} />
      <div class="refusal" role="status">
        {state.value && !state.value.controlled && (
          <button onClick={() => void send({ type: 'TakeControl' })}>Take control</button>
        )}
        {refused.value && (
          <span data-name="refused">
            <b>{refused.value.code}</b> {refused.value.what} {refused.value.robot_did} {refused.value.to_do}
          </span>
        )}
      </div>
      <div class="stopping">
        <button
          data-dead={!linked.value}
          onPointerDown={stop}
          onKeyDown={(event) => (event.key === ' ' || event.key === 'Enter') && !event.repeat && stop()}
          onClick={(event) => event.detail === 0 && stop()} // by voice or a screen reader, which press nothing
        >
          {linked.value ? 'STOP' : 'STOP: NO LINK'}
        </button>
        <p>
          {linked.value
            ? 'Software stop. Use the hardware E-stop in an emergency.'
            : 'It does not reach the robot. Use the hardware E-stop.'}
        </p>
      </div>
    </footer>
  )
}
