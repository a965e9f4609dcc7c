// Between the page and its link: what was heard and said can be looked at, and the page can be made to stand still in
// a state that is written down here, so that a picture of it is the same in every run.
import type { Page } from '@playwright/test'

export type Message = { type: string } & Record<string, any>

declare global {
  interface Window {
    tap: {
      links: WebSocket[]
      heard: Map<string, Message> // the last of each type
      states: number
      still: boolean
      told(message: Message): void
      newest(): WebSocket
    }
  }
}

// Before the page is opened.
export async function tap(page: Page): Promise<void> {
  await page.addInitScript(() => {
    if (window.tap) return
    const Real = window.WebSocket
    const links: WebSocket[] = []
    let hear: ((event: MessageEvent) => void) | null = null
    window.tap = {
      links,
      heard: new Map(),
      states: 0,
      still: false,
      told: (message) => hear!(new MessageEvent('message', { data: JSON.stringify(message) })),
      newest: () => links.at(-1)!,
    }
    window.WebSocket = class extends Real {
      constructor(url: string | URL) {
        super(url)
        links.push(this)
      }
      override set onmessage(listener: (event: MessageEvent) => void) {
        hear = listener
        this.addEventListener('message', (event) => {
          if (window.tap.still) return
          const message = JSON.parse(event.data)
          window.tap.heard.set(message.type, message)
          listener(event)
          if (message.type === 'State') ++window.tap.states
        })
      }
      override send(data: string) {
        if (!window.tap.still) super.send(data)
      }
    }
  })
}

// From now on the page hears only this: the State it heard last, with what is given here, every 20 ms; and 30 s of
// plots made of sines. What it says goes nowhere. The robot never learns of it.
export async function standStill(page: Page, given: Record<string, unknown>, more: Message[] = []): Promise<void> {
  await page.evaluate(
    ([state, messages]) => {
      const tap = window.tap
      tap.still = true
      const last = tap.heard.get('State')!
      const quiet = { depth: 0, drive: 0, hold_left: 0, armed_left: 0, ticks_left: 0, arm_held: 0, held: [], alarms: [], measured: true }
      const now = { ...last, ...quiet, controller: true, controlled: true, ...(state as object) } as Message
      for (const message of messages as Message[]) tap.told(message)
      for (let n = 0; n <= 1500; ++n) {
        const depth = 1 + Math.sin(n / 100)
        const drive = 2 * Math.sin(n / 10)
        tap.told({
          type: 'Telemetry', time: n * 20, depth_low: depth, depth_high: depth + 0.05, setpoint: 1.2,
          drive_low: drive - 0.5, drive_high: drive + 0.5, envelope: 3,
        })
      }
      const again = () => tap.told(now)
      again()
      const timers = window as unknown as { stillTimer: number }
      clearInterval(timers.stillTimer)
      timers.stillTimer = window.setInterval(again, 20)
    },
    [given, more] as const,
  )
}

export const heard = (page: Page, type: string): Promise<Message> =>
  page.evaluate((name) => window.tap.heard.get(name)!, type)

// Everything that the page has said until now has been answered or counts for nothing.
export async function roundTrip(page: Page): Promise<void> {
  await page.evaluate(() => {
    const link = window.tap.newest()
    return new Promise<void>((resolve) => {
      const answered = (event: MessageEvent) => {
        const message = JSON.parse(event.data)
        if (message.type !== 'Answer' || message.id !== 4_000_000_000) return
        link.removeEventListener('message', answered)
        resolve()
      }
      link.addEventListener('message', answered)
      link.send('{"type":"TakeControl","id":4000000000}')
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
      modes.push(window.tap.heard.get('State')!.mode)
    }
    return modes
  }, count)
}
