// A browser without Playwright, which reports each of its pages as visible and focused whatever is in front of it.
// Driven by the DevTools protocol over a pipe.
import { type ChildProcess, spawn } from 'node:child_process'
import { mkdtempSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import type { Writable } from 'node:stream'

import { pause } from './robot'

const kPatience_ms = 60_000

export class DevtoolsBrowser {
  private folder = mkdtempSync(join(tmpdir(), 'biopsy-browser-'))
  private browser: ChildProcess
  private waiting = new Map<number, { done: (result: any) => void; failed: (error: Error) => void }>()
  private last = 0
  private tab = ''
  private session = ''

  constructor() {
    const args = ['--headless=new', '--no-sandbox', '--no-first-run', '--remote-debugging-pipe', '--window-size=1920,1200',
                   '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', `--user-data-dir=${this.folder}`]
    this.browser = spawn(process.env.CHROMIUM ?? '/usr/bin/chromium', [...args, 'about:blank'],
                         { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] })
    let text = ''
    this.browser.stdio[4]!.on('data', (bytes: Buffer) => {
      text += bytes
      const messages = text.split('\0')
      text = messages.pop()!
      for (const { id, result, error } of messages.map((one) => JSON.parse(one))) {
        const pending = this.waiting.get(id)
        if (error) pending?.failed(new Error(error.message))
        else pending?.done(result)
      }
    })
  }
  async close(): Promise<void> {
    const ended = new Promise((resolve) => this.browser.once('exit', resolve))
    await this.call('Browser.close')
    await ended
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 })
  }

  async open(url: string): Promise<void> {
    const { targetInfos } = await this.call('Target.getTargets')
    this.tab = targetInfos.find((one: { type: string }) => one.type === 'page').targetId
    this.session = (await this.call('Target.attachToTarget', { targetId: this.tab, flatten: true })).sessionId
    await this.call('Page.navigate', { url }, this.session)
  }
  // Another tab of the same window.
  async openOtherTab(): Promise<void> {
    await this.call('Target.createTarget', { url: 'about:blank' })
  }
  async bringBack(): Promise<void> {
    await this.call('Target.activateTarget', { targetId: this.tab })
  }
  async pressMouseOn(text: string): Promise<void> {
    const place = `[...document.querySelectorAll('button')].find((one) => one.textContent === '${text}').getBoundingClientRect()`
    const [x, y] = await this.value<[number, number]>(`(() => { const b = ${place}; return [b.x + b.width / 2, b.y + b.height / 2] })()`)
    for (const type of ['mouseMoved', 'mousePressed']) await this.mouse(type, x, y)
  }
  releaseMouse = () => this.mouse('mouseReleased', 0, 0)

  async value<T>(expression: string): Promise<T> {
    return (await this.call('Runtime.evaluate', { expression, returnByValue: true }, this.session)).result.value
  }
  async until(expression: string): Promise<void> {
    for (const from = Date.now(); (await this.value(expression)) !== true; await pause(20))
      if (Date.now() - from > kPatience_ms) throw new Error(`timed out: ${expression}`)
  }

  private mouse(type: string, x: number, y: number): Promise<any> {
    return this.call('Input.dispatchMouseEvent', { type, x, y, button: 'left', clickCount: 1 }, this.session)
  }
  private call(method: string, params: object = {}, sessionId?: string): Promise<any> {
    const id = ++this.last
    ;(this.browser.stdio[3] as Writable).write(JSON.stringify({ id, method, params, sessionId }) + '\0')
    return new Promise((done, failed) => this.waiting.set(id, { done, failed }))
  }
}
