// Hold-to-run button. Losing the pointer, the focus, the page or the connection releases it; continuing takes a new
// press with a new token, which the server issues once.
import { effect, signal } from '@preact/signals'

import type { Button } from './generated/messages'
import { onConnectionLost, post, send } from './link'
import { isOld, state, statesReceived } from './robot'

const kBeat_ms = 25

export const held = signal<Button | null>(null)
const kConfirmed_ms = 500 // by then the server has confirmed the press

let token = 0
let timer = 0
let pressedAt = 0

export function press(button: Button): void {
  if (held.value || !state.value) return
  held.value = button
  pressedAt = performance.now()
  token = state.value.token
  const mine = token
  void send({ type: 'Press', button, token, page_ms: performance.now() }).then((answer) => {
    if (!answer.done && token === mine) release()
  })
  timer = window.setInterval(() => post({ type: 'Beat', token: mine, page_ms: performance.now() }), kBeat_ms)
}

export function release(): void {
  if (!held.value) return
  window.clearInterval(timer)
  post({ type: 'Release', token })
  held.value = null
}

// The server ended the press (a heartbeat was late): the button is released on the page too.
effect(() => {
  void statesReceived.value // also where nothing changed: then time has passed
  const confirmed = state.value?.held.length
  if (!confirmed && held.peek() && performance.now() - pressedAt > kConfirmed_ms) release()
})

// No motion on outdated values.
effect(() => {
  if (isOld.value) release()
})

window.addEventListener('pointerup', release) // wherever the pointer is by then
window.addEventListener('pointercancel', release)
window.addEventListener('blur', release)
window.addEventListener('pagehide', release)
document.addEventListener('visibilitychange', () => document.hidden && release())
onConnectionLost(release)
