// The needle's path as far as it is known: set, else as the case proposes it.
import { computed } from '@preact/signals'

import { opened, planned, type Vec3 } from '../robot'

const of = (which: 'entry' | 'target') => planned.value?.[which][0]?.ras as Vec3 | undefined

export const entry = computed(() => of('entry'))
export const target = computed(() => of('target'))

export const path = computed<{ from: Vec3; to: Vec3 } | null>(() => {
  const proposal = opened.value?.proposal[0]
  const from = entry.value ?? (proposal?.entry_ras as Vec3 | undefined)
  const to = target.value ?? (proposal?.target_ras as Vec3 | undefined)
  return from && to ? { from, to } : null
})
