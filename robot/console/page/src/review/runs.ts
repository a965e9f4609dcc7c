// The finished runs that the server has read, each with its samples.
import { signal } from '@preact/signals'

import { withToken } from '../address'
import type { FinishedRun, Runs } from '../generated/messages'

export interface Run {
  about: FinishedRun
  letter: 'A' | 'B'
  base: string // of its documents
  time: Float64Array // s, from its start; never runs back
  columns: ReadonlyMap<string, Float64Array> // by name
  end: number // s
}

export const runs = signal<Run[]>([])
export const failure = signal('') // why there are none

async function fetched(path: string): Promise<Response> {
  const answer = await fetch(withToken(path))
  if (answer.status === 403) throw new Error('This address is not valid: open the one that the program printed last.')
  if (!answer.ok) throw new Error(`The server has no ${path}.`)
  return answer
}

async function loaded(about: FinishedRun, n: number): Promise<Run> {
  const base = `/run/${n}/`
  const bytes = await (await fetched(`${base}samples`)).arrayBuffer()
  if (bytes.byteLength !== 8 * about.rows * about.columns.length) throw new Error('The samples did not arrive whole.')
  const columns = new Map(about.columns.map((name, at) => [name, new Float64Array(bytes, 8 * at * about.rows, about.rows)]))
  const time = columns.get('time_s')!
  return { about, letter: n === 0 ? 'A' : 'B', base, time, columns, end: time.at(-1)! }
}

export async function load(): Promise<void> {
  try {
    const found = (await (await fetched('/runs')).json()) as Runs
    runs.value = await Promise.all(found.runs.map(loaded))
  } catch (error) {
    failure.value = error instanceof TypeError ? 'The program that served this page has ended.' : (error as Error).message
  }
}
