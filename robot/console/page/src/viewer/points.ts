// Entry and target as they were set on the page, one after the other: set, undone, set again. The server decides of each.
import { computed, signal } from '@preact/signals'

import type { Mark } from '../generated/messages'
import { send } from '../link'
import { opened, planned, type Vec3 } from '../robot'
import { voxelOf } from './geometry'

interface Change {
  mark: Mark
  before: Vec3 | null // nothing was set
  after: Vec3
}
const past = signal<Change[]>([])
const future = signal<Change[]>([])

let of = '' // the series that these belong to

function recall(): void {
  const uid = opened.value?.series.series_uid ?? ''
  if (of !== uid) past.value = future.value = []
  of = uid
}

const pointOf = (mark: Mark) => ((mark === 'Entry' ? planned.value?.entry : planned.value?.target)?.[0]?.ras ?? null) as Vec3 | null

async function put(mark: Mark, p: Vec3): Promise<boolean> {
  const series = opened.value?.series
  if (!series) return false
  const voxel = voxelOf(series.ras_from_voxel, p)
  return (await send({ type: 'SetPoint', mark, series_uid: series.series_uid, voxel, ras_mm: p })).done
}

export async function setPoint(mark: Mark, p: Vec3): Promise<void> {
  recall()
  const before = pointOf(mark)
  if (!(await put(mark, p))) return
  past.value = [...past.value, { mark, before, after: p }]
  future.value = []
}

export async function undo(): Promise<void> {
  recall()
  const last = past.value.at(-1)
  if (!last?.before || !(await put(last.mark, last.before))) return
  past.value = past.value.slice(0, -1)
  future.value = [...future.value, last]
}

export async function redo(): Promise<void> {
  recall()
  const next = future.value.at(-1)
  if (!next || !(await put(next.mark, next.after))) return
  future.value = future.value.slice(0, -1)
  past.value = [...past.value, next]
}

export const whyNoUndo = computed(() => {
  const last = past.value.at(-1)
  if (!last) return 'Nothing was changed.'
  return last.before ? '' : 'Before that nothing was set.'
})
export const whyNoRedo = computed(() => (future.value.length ? '' : 'Nothing was undone.'))
