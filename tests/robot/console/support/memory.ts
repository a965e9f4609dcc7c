// Memory of a page, after a collection of garbage, and of the console that serves it.
import { readFileSync } from 'node:fs'

import type { Page } from '@playwright/test'

export interface Memory {
  heap_MB: number // with the browser's compiled code and its lists of timings
  objects: number // of the page's script, functions and arrays included
  nodes: number
  server_MB: number // resident
}

export async function meter(page: Page, serverPid: number): Promise<() => Promise<Memory>> {
  const browser = await page.context().newCDPSession(page)
  await browser.send('Performance.enable')
  const countObjects = async (): Promise<number> => {
    const objectGroup = 'counted'
    const { result } = await browser.send('Runtime.evaluate', { expression: 'Object.prototype', objectGroup })
    const { objects } = await browser.send('Runtime.queryObjects', { prototypeObjectId: result.objectId!, objectGroup })
    const length = 'function() { return this.length }'
    const count = await browser.send('Runtime.callFunctionOn', { objectId: objects.objectId!, functionDeclaration: length })
    await browser.send('Runtime.releaseObjectGroup', { objectGroup })
    return count.result.value
  }
  return async () => {
    const objects = await countObjects()
    await browser.send('HeapProfiler.collectGarbage')
    const { metrics } = await browser.send('Performance.getMetrics')
    const of = (name: string) => metrics.find((metric) => metric.name === name)!.value
    const resident = /^VmRSS:\s+(\d+)/m.exec(readFileSync(`/proc/${serverPid}/status`, 'utf8'))![1]
    return { heap_MB: of('JSHeapUsedSize') / 1e6, objects, nodes: of('Nodes'), server_MB: Number(resident) / 1e3 }
  }
}
