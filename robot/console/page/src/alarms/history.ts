// What there was: as the console keeps it, over a reload of the page and a restart of the console; and what only this page
// could know, that it had lost the console, kept for as long as its tab is open.
import { computed, effect, signal } from '@preact/signals'

import type { Alarm, PastAlarm } from '../generated/messages'
import { alarmHistory } from '../robot'
import { active, isAcknowledged, keyOf } from './alarms'

const kOwn = new Set(['E-100', 'E-124'])
const kRowsMax = 100
const kKey = 'alarms of this page'

function kept(): PastAlarm[] {
  try {
    const rows = JSON.parse(sessionStorage.getItem(kKey) ?? '[]') as PastAlarm[]
    return rows.map((row) => (row.to_ms ? row : { ...row, to_ms: Date.now() })) // ended with the page that saw it
  } catch {
    return []
  }
}
const own = signal<PastAlarm[]>(kept()) // newest first

function followed(rows: PastAlarm[], alarms: Alarm[], now_ms: number): PastAlarm[] {
  const open = new Map(alarms.filter((one) => kOwn.has(one.code)).map((one) => [keyOf(one), one]))
  const after = rows.map((row) => {
    if (row.to_ms) return row
    const still = open.get(keyOf(row.alarm))
    if (!still) return { ...row, to_ms: now_ms }
    open.delete(keyOf(row.alarm))
    return row.acknowledged_ms || !isAcknowledged(still) ? row : { ...row, acknowledged_ms: now_ms }
  })
  const fresh = [...open.values()].map((alarm) => ({ number: 0, alarm, from_ms: now_ms, to_ms: 0, acknowledged_ms: 0 }))
  return [...fresh, ...after].slice(0, kRowsMax)
}

effect(() => {
  const before = own.peek()
  const after = followed(before, active.value, Date.now())
  if (after.length === before.length && after.every((row, n) => row === before[n])) return
  own.value = after
  sessionStorage.setItem(kKey, JSON.stringify(after))
})

export const history = computed<PastAlarm[]>(() =>
  [...own.value, ...(alarmHistory.value?.rows ?? [])].sort((a, b) => b.from_ms - a.from_ms),
)
