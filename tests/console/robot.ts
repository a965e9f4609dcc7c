// A robot with its console, brought up for one test file, and what a person does on the page.
import { type ChildProcess, execFileSync, spawn } from 'node:child_process'
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'

import { expect, type Locator, type Page } from '@playwright/test'

export type Vec3 = [number, number, number]

// Where the built-in phantom truly is: of `biopsy dry-run gap`, R, A, S in mm.
export const kEntry: Vec3 = [-4.396, 33.092, 51.854]
export const kGapDepth_mm = 2.5

export class Robot {
  folder = mkdtempSync(join(tmpdir(), 'biopsy-console-'))
  url = ''
  private up?: ChildProcess

  constructor(private domain: number, private caseName = 'gap') {}

  async start(): Promise<void> {
    const program = process.env.BIOPSY!
    const words = ['up', this.caseName, '--console', '--without-security', '--domain', String(this.domain), '--out', this.folder]
    this.up = spawn(program, words, { stdio: ['ignore', 'inherit', 'inherit'] })
    const address = join(this.folder, 'console.url')
    for (let n = 0; n < 600 && !existsSync(address); ++n) await pause(100)
    this.url = readFileSync(address, 'utf8').trim()
  }
  async stop(): Promise<void> {
    const ended = new Promise((resolve) => this.up!.once('exit', resolve))
    this.up!.kill('SIGINT')
    await ended
    if (!process.env.KEEP) rmSync(this.folder, { recursive: true })
  }
  pid(program: string): number {
    const children = execFileSync('ps', ['--ppid', String(this.up!.pid), '-o', 'pid=,comm=']).toString()
    return Number(children.split('\n').find((line) => line.includes(program.slice(0, 15)))!.trim().split(' ')[0])
  }
  // The procedure log: when (ms since 1970), what, and its content.
  log(): { at: number; kind: string; body: Record<string, unknown> }[] {
    const shown = execFileSync(process.env.BIOPSY!, ['log', 'show', join(this.folder, 'procedure.log.sqlite')])
    const line = /^ *\d+  (\S+ \S+)  \S+ +(.*?) +(\{.*\})$/
    return shown.toString().split('\n').flatMap((text) => {
      const [, at, kind, body] = line.exec(text) ?? []
      return at ? [{ at: Date.parse(at.replace(' ', 'T') + 'Z'), kind: kind!, body: JSON.parse(body!) }] : []
    })
  }
  modes(): unknown[] {
    return this.log().filter((one) => one.kind === 'state change').map((one) => one.body.mode)
  }
  // From each moment on: ms until the stage put out 0 V with high voltage off.
  msToZero(moments: number[]): number[] {
    const off = this.log().filter((one) => one.kind === 'permit change' && one.body.hv_enabled === false)
    return moments.map((moment) => (off.find((one) => one.at >= moment)?.at ?? NaN) - moment)
  }
  acts(): { asked: string; answer: string }[] {
    const all = execFileSync('sh', ['-c', `cat ${this.folder}/console/*/console-acts.jsonl`]).toString()
    return all.trim().split('\n').map((line) => JSON.parse(line))
  }
}

export const pause = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms))

export class Console {
  acts = 0 // that a person did on purpose
  constructor(readonly page: Page, readonly url: string) {}

  async open(): Promise<void> {
    await this.page.goto(this.url)
    await expect(this.page.locator('.steps [aria-current]')).toBeVisible()
  }
  button(name: string | RegExp): Locator {
    return this.page.getByRole('button', { name })
  }
  async click(name: string | RegExp): Promise<void> {
    ++this.acts
    await this.button(name).click()
  }
  mode(): Locator {
    return this.page.locator('[data-name=mode]')
  }
  async is(mode: string, timeout = 15_000): Promise<void> {
    await expect(this.mode()).toHaveAttribute('data-mode', mode, { timeout })
  }
  async openSeries(): Promise<void> {
    await this.click(/^Open /)
    await expect(this.page.locator('body[data-image=shown]')).toBeAttached({ timeout: 60_000 })
    await expect(this.page.locator('[data-tile^=large]')).toBeAttached()
  }

  // Clicks the image where the mark of this name is drawn in the large view.
  async clickAt(mark: string): Promise<void> {
    ++this.acts
    const box = (await this.page.locator(`[data-tile^=large] [data-name=${mark}]`).boundingBox())!
    await this.page.mouse.click(box.x + box.width / 2, box.y + box.height / 2)
  }
  async mm(name: string): Promise<Vec3> {
    const text = await this.page.locator(`[data-name=${name}]`).first().getAttribute('data-mm')
    return text!.split(',').map(Number) as Vec3
  }
  async setPoints(): Promise<void> {
    await this.clickAt('proposed-entry')
    await this.click('Set entry')
    await expect(this.page.locator('dd[data-name=entry]')).not.toHaveText('not set')
    await this.clickAt('proposed-target')
    await this.click('Set target')
    await expect(this.page.locator('[data-name=planned-depth]')).toBeVisible()
  }
  async confirmPlan(): Promise<void> {
    await this.click('Confirm this plan')
    const boxes = this.page.getByRole('checkbox')
    await expect(boxes).toHaveCount(3)
    for (const box of await boxes.all()) {
      ++this.acts
      await box.click()
      await expect(box).toBeChecked() // by the server's word, not the page's
    }
  }
  async hold(name: string | RegExp, while_: () => Promise<void>): Promise<void> {
    ++this.acts
    await this.button(name).hover()
    await this.page.mouse.down()
    await while_()
    await this.page.mouse.up()
  }
  // A host that stalls takes the hand off the button, as it should; a person then presses again.
  async again(button: Locator, reached: () => Promise<boolean>): Promise<void> {
    ++this.acts
    for (let presses = 0; presses < 12 && !(await reached()); ++presses) {
      await button.hover()
      await this.page.mouse.down()
      for (let n = 0; n < 100 && !(await reached()); ++n) {
        await pause(50)
        if (n > 5 && (await button.getAttribute('data-alive')) !== 'true') break
      }
      await this.page.mouse.up()
      await pause(200)
    }
    expect(await reached()).toBe(true)
  }
  async modeIs(mode: string): Promise<boolean> {
    return (await this.mode().getAttribute('data-mode')) === mode
  }
  async arm(): Promise<void> {
    await expect(this.button(/^Arm/)).toHaveAttribute('aria-disabled', 'false')
    await this.again(this.button(/^Arm/), () => this.modeIs('Armed'))
  }
  // To the end of the stage.
  async insert(): Promise<void> {
    await this.again(this.button('Hold to insert'), () => this.page.locator('.confirm').isVisible())
  }
  // From an open page to a robot that waits for the button.
  async prepare(): Promise<void> {
    await this.open()
    await this.openSeries()
    await this.setPoints()
    await this.confirmPlan()
    await this.is('Ready')
    await this.arm()
  }
}

export const distance = (a: Vec3, b: Vec3) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])
