// A button that acts only while it is held. Whatever takes the hand or the page away lets it go; going on takes a
// new press with a new token, which the server gives out once.
import { effect, signal } from '@preact/signals'

import type { Button } from './generated/messages'
import { ask, onLost, say } from './link'
import { isOld, state } from './robot'

const kBeat_ms = 25

export const held = signal<Button | null>(null)
const kTaken_ms = 500 // by then the server says that it is held

let token = 0
let timer = 0
let pressedAt = 0

export function press(button: Button): void {
  if (held.value || !state.value) return
  held.value = button
  pressedAt = performance.now()
  token = state.value.token
  const mine = token
  void ask({ type: 'Press', button, token, page_ms: performance.now() }).then((answer) => {
    if (!answer.done && token === mine) letGo()
  })
  timer = window.setInterval(() => say({ type: 'Beat', token: mine, page_ms: performance.now() }), kBeat_ms)
}

export function letGo(): void {
  if (!held.value) return
  window.clearInterval(timer)
  say({ type: 'Release', token })
  held.value = null
}

// The server ended the press (a beat was late): the button springs out, so that nobody believes it is held.
effect(() => {
  const taken = state.value?.held.length
  if (!taken && held.peek() && performance.now() - pressedAt > kTaken_ms) letGo()
})

// What the page shows is old: nobody can hold by that.
effect(() => {
  if (isOld.value) letGo()
})

window.addEventListener('pointerup', letGo) // wherever the pointer is by then
window.addEventListener('pointercancel', letGo)
window.addEventListener('blur', letGo)
window.addEventListener('pagehide', letGo)
document.addEventListener('visibilitychange', () => document.hidden && letGo())
onLost(letGo)
