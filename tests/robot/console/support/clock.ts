// The clock of the robot and of the page. On a machine that stands still too often for a robot in real time,
// on_steady_host repeats a test with both at a share of their speed: a stall is shorter by it, all else takes longer.
import type { Page } from '@playwright/test'

export const kClockSpeed = Number(process.env.CLOCK_SPEED ?? 1)

// What a wait for the robot or the page may take, by the clock of this machine.
export const stretched = (ms: number) => ms / kClockSpeed

// Before the page's own script runs. `faketime` slows the programs, see Robot.
export async function slowClock(page: Page): Promise<void> {
  if (kClockSpeed === 1) return
  await page.addInitScript((speed) => {
    if ('slowed' in window) return // told so before
    Object.assign(window, { slowed: true })
    const [now, wall, later, often] = [performance.now.bind(performance), Date.now, setTimeout, setInterval]
    const opened = wall()
    performance.now = () => now() * speed
    Date.now = () => opened + (wall() - opened) * speed
    window.setTimeout = ((act: TimerHandler, ms = 0, ...rest: any[]) => later(act, ms / speed, ...rest)) as typeof setTimeout
    window.setInterval = ((act: TimerHandler, ms = 0, ...rest: any[]) => often(act, ms / speed, ...rest)) as typeof setInterval
  }, kClockSpeed)
}

// The words that start a program with that clock.
export const slowedCommand = (command: string[]) =>
  kClockSpeed === 1
    ? command
    : ['env', 'NO_FAKE_STAT=1', `LD_PRELOAD=${process.env.SLOWED_WAITS}`, 'faketime', '-f', `+0 x${kClockSpeed}`, ...command]
