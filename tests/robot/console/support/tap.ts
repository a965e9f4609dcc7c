// Between the page and its WebSocket: records the events, and can freeze the page in a given state, so that a
// screenshot is the same in every run.
import type { Page } from '@playwright/test'

export type Message = { type: string } & Record<string, any>

declare global {
  interface Window {
    tap: {
      sockets: WebSocket[]
      events: Map<string, Message> // the last of each type
      states: number
      frozen: boolean
      inject(message: Message): void
      newest(): WebSocket
    }
  }
}

// Before the page is opened.
export async function tap(page: Page): Promise<void> {
  await page.addInitScript(() => {
    if (window.tap) return
    const Real = window.WebSocket
    const sockets: WebSocket[] = []
    let deliver: ((event: MessageEvent) => void) | null = null
    window.tap = {
      sockets,
      events: new Map(),
      states: 0,
      frozen: false,
      inject: (message) => deliver!(new MessageEvent('message', { data: JSON.stringify(message) })),
      newest: () => sockets.at(-1)!,
    }
    window.WebSocket = class extends Real {
      constructor(url: string | URL) {
        super(url)
        sockets.push(this)
      }
      override set onmessage(listener: (event: MessageEvent) => void) {
        deliver = listener
        this.addEventListener('message', (event) => {
          if (window.tap.frozen) return
          const message = JSON.parse(event.data)
          window.tap.events.set(message.type, message)
          listener(event)
          if (message.type === 'State') ++window.tap.states
        })
      }
      override send(data: string) {
        if (!window.tap.frozen) super.send(data)
      }
    }
  })
}

// From now on the page receives only this: its last State with the given fields, every 20 ms, and 30 s of plots made of
// sines. Its commands are dropped.
export async function freezePage(page: Page, given: Record<string, unknown>, more: Message[] = []): Promise<void> {
  await page.evaluate(
    ([state, messages]) => {
      const tap = window.tap
      tap.frozen = true
      const last = tap.events.get('State')!
      const quiet = { depth: 0, drive: 0, hold_left: 0, armed_left: 0, ticks_left: 0, arm_held: 0, held: [], alarms: [], measured: true, depth_known: true, estop: false }
      const now = { ...last, ...quiet, controller: true, controlled: true, ...(state as object) } as Message
      for (const message of messages as Message[]) tap.inject(message)
      for (let n = 0; n <= 1500; n += 3) {
        const depth = 1 + Math.sin(n / 100)
        const drive = 2 * Math.sin(n / 10)
        tap.inject({
          type: 'Telemetry', time: n * 20, depth_low: depth, depth_high: depth + 0.05, setpoint: 1.2,
          drive_low: drive - 0.5, drive_high: drive + 0.5, envelope: 3,
        })
      }
      const again = () => tap.inject(now)
      // The page keeps a shown depth or voltage that a new one hardly differs from (shown_state.ts): of the noise before.
      tap.inject({ ...now, depth: now.depth + 1, drive: now.drive + 1 })
      again()
      const timers = window as unknown as { stillTimer: number }
      clearInterval(timers.stillTimer)
      timers.stillTimer = window.setInterval(again, 20)
    },
    [given, more] as const,
  )
}

export const lastEvent = (page: Page, type: string): Promise<Message> =>
  page.evaluate((name) => window.tap.events.get(name)!, type)

// Everything that the page has sent until now has been answered or has no effect.
export async function roundTrip(page: Page): Promise<void> {
  await page.evaluate(() => {
    const socket = window.tap.newest()
    return new Promise<void>((resolve) => {
      const answered = (event: MessageEvent) => {
        const message = JSON.parse(event.data)
        if (message.type !== 'Answer' || message.id !== 4_000_000_000) return
        socket.removeEventListener('message', answered)
        resolve()
      }
      socket.addEventListener('message', answered)
      socket.send('{"type":"TakeControl","id":4000000000}')
    })
  })
}

// The modes of the next States that arrive.
export async function nextModes(page: Page, count: number): Promise<string[]> {
  return page.evaluate(async (wanted) => {
    const modes: string[] = []
    for (let seen = window.tap.states; modes.length < wanted; ) {
      await new Promise((resolve) => setTimeout(resolve, 5))
      if (window.tap.states === seen) continue
      seen = window.tap.states
      modes.push(window.tap.events.get('State')!.mode)
    }
    return modes
  }, count)
}
