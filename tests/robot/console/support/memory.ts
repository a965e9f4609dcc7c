// Memory of a page, after a collection of garbage, and of the console that serves it.
import { readFileSync } from 'node:fs'

import type { Page } from '@playwright/test'

export interface Memory {
  heap_MB: number
  nodes: number
  server_MB: number // resident
}

export async function meter(page: Page, serverPid: number): Promise<() => Promise<Memory>> {
  const browser = await page.context().newCDPSession(page)
  await browser.send('Performance.enable')
  return async () => {
    await browser.send('HeapProfiler.collectGarbage')
    const { metrics } = await browser.send('Performance.getMetrics')
    const of = (name: string) => metrics.find((metric) => metric.name === name)!.value
    const resident = /^VmRSS:\s+(\d+)/m.exec(readFileSync(`/proc/${serverPid}/status`, 'utf8'))![1]
    return { heap_MB: of('JSHeapUsedSize') / 1e6, nodes: of('Nodes'), server_MB: Number(resident) / 1e3 }
  }
}
