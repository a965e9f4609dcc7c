// Entry and target as they were set on the page, one after the other: set, undone, set again. The server decides of each.
import { computed, signal } from '@preact/signals'

import type { Mark } from '../generated/messages'
import { send } from '../link'
import { opened, planned, type Vec3 } from '../robot'
import { length, minus, voxelOf } from './geometry'

interface Change {
  mark: Mark
  before: Vec3 | null // nothing was set
  after: Vec3
}
const kSame_mm = 1e-6

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

// One after the other, each with the answer to the one before: two at once would undo the same change twice.
let acts: Promise<void> = Promise.resolve()
const inTurn = (act: () => Promise<void>) => (acts = acts.then(act))

export const setPoint = (mark: Mark, p: Vec3) => inTurn(() => change(mark, p))
export const undo = () => inTurn(takeBack)
export const redo = () => inTurn(repeat)

async function change(mark: Mark, p: Vec3): Promise<void> {
  recall()
  const before = pointOf(mark)
  if (!(await put(mark, p))) return
  if (before && length(minus(before, p)) < kSame_mm) return // nothing to undo
  past.value = [...past.value, { mark, before, after: p }]
  future.value = []
}

async function takeBack(): Promise<void> {
  recall()
  const last = past.value.at(-1)
  if (!last?.before || !(await put(last.mark, last.before))) return
  past.value = past.value.slice(0, -1)
  future.value = [...future.value, last]
}

async function repeat(): Promise<void> {
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
