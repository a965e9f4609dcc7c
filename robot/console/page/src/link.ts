// The WebSocket to the server: events become signals; commands are sent with an id and answered.
import { batch } from '@preact/signals'

import { token, withToken } from './address'
import type { Answer, Command, Event } from './generated/messages'
import * as robot from './robot'
import { shownState } from './shown_state'

type WithId = Extract<Command, { id: number }>
type WithoutId<T> = T extends { id: number } ? Omit<T, 'id'> : never

const kReconnect_ms = 1000
const kTick_ms = 50
const kFrozen_ms = 250

let socket: WebSocket | null = null
let lastId = 0
const waiting = new Map<number, (answer: Answer) => void>()
const lostHandlers: (() => void)[] = []

export const onConnectionLost = (handler: () => void) => void lostHandlers.push(handler)

export function connect(): void {
  open()
  ageLink(performance.now())
}

// Looked at when the newest message will be old, and then again and again: each look costs time.
function ageLink(due: number): void {
  const now = performance.now()
  const froze = Math.abs(now - due) > kFrozen_ms // what arrived meanwhile comes next: then the age is known again
  const age = now - robot.lastMessageAt
  if (!froze) robot.linkAge.value = kTick_ms * Math.floor(age / kTick_ms)
  const wait = age >= 0 ? Math.max(robot.kOld_ms + kTick_ms - age, kTick_ms) : kTick_ms
  setTimeout(() => ageLink(now + wait), wait)
}

function open(): void {
  socket = new WebSocket(`ws://${location.host}/live?t=${token}`)
  socket.onopen = () => {
    robot.noteMessage()
    robot.connected.value = true
  }
  socket.onmessage = (event) => onEvent(JSON.parse(event.data as string) as Event)
  socket.onclose = onClose
}

function onClose(): void {
  robot.connected.value = false
  void findCause()
  for (const handler of lostHandlers) handler()
  for (const answer of waiting.values()) answer(unanswered)
  waiting.clear()
  setTimeout(open, kReconnect_ms)
}

// A refused WebSocket does not say why.
async function findCause(): Promise<void> {
  try {
    const { status } = await fetch(withToken('/status'), { signal: AbortSignal.timeout(kReconnect_ms), cache: 'no-store' })
    robot.closed.value = status === 403 ? 'token' : status === 503 ? 'full' : 'silent'
  } catch (error) {
    robot.closed.value = (error as Error).name === 'TimeoutError' ? 'silent' : 'ended'
  }
}

// What an earlier start of the console told is gone.
function welcome(message: Extract<Event, { type: 'Welcome' }>): void {
  const before = robot.welcome.value
  robot.welcome.value = message
  if (!before || before.session === message.session) return
  robot.restarted.value = robot.opened.value !== null
  robot.opened.value = robot.planned.value = robot.refused.value = null
  robot.checked.value = []
}

const unanswered: Answer = {
  id: 0,
  done: false,
  code: 'E-100',
  what: 'The console does not answer.',
  robot_did: 'It was not sent later either.',
  to_do: 'Use the hardware E-stop in an emergency.',
}

function onEvent(message: Event): void {
  batch(() => {
    robot.noteMessage()
    switch (message.type) {
      case 'Welcome':
        welcome(message)
        break
      case 'Opened':
        if (robot.opened.value?.series.series_uid !== message.series.series_uid) robot.opened.value = message
        break
      case 'Planned':
        robot.planned.value = message
        if (message.confirmed) robot.restarted.value = false
        robot.checked.value = []
        break
      case 'State':
        robot.state.value = shownState(message, robot.state.peek())
        ++robot.statesReceived.value
        if (message.measured) robot.everMeasured.value = true
        break
      case 'Telemetry':
        robot.appendTelemetry(message)
        break
      case 'AlarmHistory':
        robot.alarmHistory.value = message
        break
      case 'Checked':
        robot.checked.value = [...robot.checked.value.filter((c) => c.stage !== message.stage), message]
        break
      case 'Answer':
        waiting.get(message.id)?.(message)
        waiting.delete(message.id)
        robot.refused.value = message.done ? null : message
        break
    }
  })
}

// Sent at once or not at all: a delayed command would act when nobody expects it.
export function send(message: WithoutId<WithId>): Promise<Answer> {
  const id = ++lastId
  return new Promise((resolve) => {
    if (!post({ ...message, id } as Command)) {
      robot.refused.value = unanswered
      return resolve(unanswered)
    }
    waiting.set(id, resolve)
  })
}

// Without an answer. False: there is no connection.
export function post(message: Command): boolean {
  if (socket?.readyState !== WebSocket.OPEN) return false
  socket.send(JSON.stringify(message))
  return true
}
