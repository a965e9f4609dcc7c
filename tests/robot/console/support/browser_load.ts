// What the browser costs.
import type { Browser } from '@playwright/test'

import { round } from './figures'
import { pause } from './robot'

// CPU time of all processes of the browser, by type, as a share of one core. CPU time, not wall time: other work on the
// machine changes it little.
export async function browserLoad(browser: Browser, measured_ms: number): Promise<Record<string, number>> {
  const whole = await browser.newBrowserCDPSession()
  const measure = async () => {
    const { processInfo } = await whole.send('SystemInfo.getProcessInfo')
    return { at: performance.now() / 1000, processInfo }
  }
  const from = await measure()
  await pause(measured_ms) // a figure, not a state
  const to = await measure()
  const shares: Record<string, number> = { all: 0 }
  for (const one of to.processInfo) {
    const before = from.processInfo.find((other) => other.id === one.id)?.cpuTime ?? 0
    const share = (100 * (one.cpuTime - before)) / (to.at - from.at)
    shares[one.type] = (shares[one.type] ?? 0) + share
    shares.all! += share
  }
  return Object.fromEntries(Object.entries(shares).map(([name, share]) => [name, round(share)]))
}
