// What the tests measure, in one file: `FIGURES`.
import { existsSync, readFileSync, writeFileSync } from 'node:fs'

export function note(figures: Record<string, unknown>): void {
  console.log(JSON.stringify(figures))
  const file = process.env.FIGURES
  if (!file) return
  const before = existsSync(file) ? JSON.parse(readFileSync(file, 'utf8')) : {}
  writeFileSync(file, JSON.stringify({ ...before, ...figures }, null, 2) + '\n')
}

export const round = (value: number, digits = 1) => Number(value.toFixed(digits))

export function spread(ms: number[]): { lowest: number; median: number; highest: number; count: number } {
  const sorted = [...ms].sort((a, b) => a - b)
  return { lowest: sorted[0]!, median: sorted[sorted.length >> 1]!, highest: sorted.at(-1)!, count: sorted.length }
}
