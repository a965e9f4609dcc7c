// A robot with its console, started for one test file, and its procedure log.
import { type ChildProcess, execFileSync, spawn } from 'node:child_process'
import { closeSync, existsSync, mkdtempSync, openSync, readFileSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'

import { kClockSpeed, slowedCommand, stretched } from './clock'

export const kProgram = process.env.BIOPSY ?? 'biopsy'
export const pause = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms))

const kStart_ms = stretched(60_000)
const kStop_ms = stretched(20_000)
const kReply_ms = stretched(10_000)

export interface Entry {
  at: number // ms since 1970
  kind: string
  body: Record<string, any>
}

export class Robot {
  folder = mkdtempSync(join(tmpdir(), 'biopsy-console-'))
  url = ''
  private up?: ChildProcess

  // `given`: the case, as for `biopsy up`.
  constructor(private given = ['gap']) {}

  async start(): Promise<void> {
    const domain = 30 + (process.pid % 200) // other builds on this machine use others
    const args = ['up', ...this.given, '--console', '--without-security', '--domain', String(domain), '--out', this.folder]
    const output = openSync(join(this.folder, '..', `${this.name()}.txt`), 'w')
    const [program, ...words] = slowedCommand([kProgram, ...args])
    this.up = spawn(program!, words, { stdio: ['ignore', output, output] })
    closeSync(output)
    await this.until(() => existsSync(this.address()) && readFileSync(this.address(), 'utf8').includes('http'), kStart_ms)
    this.url = readFileSync(this.address(), 'utf8').trim()
  }
  async stop(): Promise<void> {
    const up = this.up!
    if (up.exitCode === null && up.signalCode === null) {
      const ended = new Promise((resolve) => up.once('exit', resolve))
      process.kill(this.programOf(up), 'SIGINT')
      if ((await Promise.race([ended, pause(kStop_ms).then(() => 'late')])) === 'late') up.kill('SIGKILL')
    }
    if (process.env.KEEP) return
    rmSync(this.folder, { recursive: true, force: true })
    rmSync(`${this.folder}.txt`, { force: true })
  }
  pid(program: string): number {
    return this.childOf(this.programOf(this.up!), program)
  }
  // What `up` printed.
  output(): string {
    return readFileSync(`${this.folder}.txt`, 'utf8')
  }

  // The procedure log.
  log(): Entry[] {
    const shown = execFileSync(kProgram, ['log', 'show', '--raw', join(this.folder, 'procedure.log.sqlite')], { maxBuffer: 1e8 })
    const line = /^ *\d+  (\S+ \S+)  \S+ +(.*?) +(\{.*\})$/
    return shown.toString().split('\n').flatMap((text) => {
      const [, at, kind, body] = line.exec(text) ?? []
      return at ? [{ at: Date.parse(at.replace(' ', 'T') + 'Z'), kind: kind!, body: JSON.parse(body!) }] : []
    })
  }
  // The first record from `moment` on that is `wanted`; waits for it, since records are written in groups.
  async logged(moment: number, wanted: (entry: Entry) => boolean): Promise<Entry> {
    let found: Entry | undefined
    await this.until(() => (found = this.log().find((entry) => entry.at >= moment && wanted(entry))) !== undefined, kReply_ms)
    return found!
  }
  // ms from then until the stage itself reported that high voltage is off and it puts out nothing.
  async msToZero(moment: number): Promise<number> {
    const off = await this.logged(moment, ({ kind, body }) => kind === 'permit change' && body.hv_enabled === false)
    return off.at - moment
  }
  async msToMode(moment: number, mode: string): Promise<number> {
    return (await this.logged(moment, ({ kind, body }) => kind === 'state change' && body.mode === mode)).at - moment
  }
  modesSince(moment: number): string[] {
    return this.log().flatMap(({ at, kind, body }) => (at >= moment && kind === 'state change' ? [body.mode] : []))
  }
  // Commands to the console, and its answers.
  commands(): { asked: string; answer: string }[] {
    const all = execFileSync('sh', ['-c', `cat ${this.folder}/console/*/console-acts.jsonl`]).toString()
    return all.trim().split('\n').map((line) => JSON.parse(line))
  }
  // Tokens of presses of the insert button that were accepted.
  presses(): number[] {
    return this.commands().flatMap(({ asked, answer }) => {
      const command = answer === 'done' && asked.includes('"Insert"') ? JSON.parse(asked) : {}
      return command.type === 'Press' ? [command.token] : []
    })
  }

  // `faketime` stays as the parent of what it starts, and passes no signal on.
  private programOf(up: ChildProcess): number {
    return kClockSpeed === 1 ? up.pid! : this.childOf(up.pid!, kProgram)
  }
  private childOf(parent: number, program: string): number {
    const children = execFileSync('ps', ['--ppid', String(parent), '-o', 'pid=,comm=']).toString()
    const name = program.split('/').at(-1)!.slice(0, 15)
    return Number(children.split('\n').find((line) => line.includes(name))!.trim().split(' ')[0])
  }
  private address = () => join(this.folder, 'console.url')
  private name = () => this.folder.split('/').at(-1)!
  private async until(reached: () => boolean, timeout_ms: number): Promise<void> {
    for (const from = Date.now(); !reached(); await pause(50)) {
      if (this.up!.exitCode !== null) throw new Error(`the robot ended: ${this.output()}`)
      if (Date.now() - from > timeout_ms) throw new Error(`the robot did not get there: ${this.output()}`)
    }
  }
}
