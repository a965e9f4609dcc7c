// The one WebSocket to the server: messages in become signals, asks go out with a number and come back answered.
import { batch } from '@preact/signals'

import type { Answer, Command, Event } from './generated/messages'
import * as robot from './robot'

type WithId = Extract<Command, { id: number }>
type WithoutId<T> = T extends { id: number } ? Omit<T, 'id'> : never

const token = new URLSearchParams(location.search).get('t') ?? ''
const kAgain_ms = 1000

let socket: WebSocket | null = null
let lastId = 0
const waiting = new Map<number, (answer: Answer) => void>()
const whenLost: (() => void)[] = []

export const withToken = (path: string) => `${path}?t=${token}`
export const onLost = (act: () => void) => void whenLost.push(act)

export function connect(): void {
  open()
  setInterval(() => void (robot.linkAge.value = 50 * Math.floor((performance.now() - robot.heardAt) / 50)), 50)
}

function open(): void {
  socket = new WebSocket(`ws://${location.host}/live?t=${token}`)
  socket.onopen = () => void (robot.connected.value = true)
  socket.onmessage = (event) => hear(JSON.parse(event.data as string) as Event)
  socket.onclose = lose
}

function lose(): void {
  robot.connected.value = false
  for (const act of whenLost) act()
  for (const answer of waiting.values()) answer(unanswered)
  waiting.clear()
  setTimeout(open, kAgain_ms)
}

const unanswered: Answer = {
  id: 0,
  done: false,
  code: 'E-100',
  what: 'The console does not answer.',
  robot_did: 'It holds the needle, then lets it back by itself.',
  to_do: 'Use the hardware E-stop in an emergency. The page tries again.',
}

function hear(message: Event): void {
  batch(() => {
    robot.heard()
    switch (message.type) {
      case 'Welcome':
        robot.welcome.value = message
        break
      case 'Opened':
        if (robot.opened.value?.series.series_uid !== message.series.series_uid) robot.opened.value = message
        break
      case 'Planned':
        robot.planned.value = message
        robot.checked.value = []
        break
      case 'State':
        robot.state.value = message
        break
      case 'Telemetry':
        robot.remember(message)
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

// Sent at once or not at all: what waits for a link would act when nobody expects it any more.
export function ask(message: WithoutId<WithId>): Promise<Answer> {
  const id = ++lastId
  return new Promise((resolve) => {
    if (!say({ ...message, id } as Command)) {
      robot.refused.value = unanswered
      return resolve(unanswered)
    }
    waiting.set(id, resolve)
  })
}

export function say(message: Command): boolean {
  if (socket?.readyState !== WebSocket.OPEN) return false
  socket.send(JSON.stringify(message))
  return true
}
