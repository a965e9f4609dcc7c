// What to look at twice in a plan that is accepted all the same.
import type { Planned, Series } from './generated/messages'
import { length, mm, minus } from './viewer/geometry'
import type { Vec3 } from './robot'

const kOutside = /skin|muscle|fat|air|gel|phantom/i // tissues that a path may begin in
const kOffAxis_mm = 0.5
const kThin_mm = 0.3 // less, and a tip within its tolerance may lie in the next tissue

export function warningsOf(plan: Planned, series: Series | undefined): string[] {
  const all: string[] = []
  const reached = plan.layers.filter((layer) => layer.from < plan.depth)
  for (const layer of reached.filter((one) => /unknown|unlabel/i.test(one.name)))
    all.push(`${mm(Math.min(layer.to, plan.depth) - layer.from)} mm of the path are of unknown tissue.`)
  const first = reached[0]
  if (first && !kOutside.test(first.name) && !/unknown|unlabel/i.test(first.name))
    all.push(`The entry lies in ${first.name}: the path does not begin at the skin.`)
  const last = reached.at(-1)
  if (last && Math.min(last.to - plan.depth, plan.depth - last.from) < kThin_mm)
    all.push(`The target is ${mm(Math.min(last.to - plan.depth, plan.depth - last.from))} mm from the edge of ${last.name}.`)
  if (plan.axis_offset > kOffAxis_mm) all.push(`The target is ${mm(plan.axis_offset)} mm off the needle's axis.`)
  const [entry, target] = [plan.entry[0]?.ras, plan.target[0]?.ras]
  const apart = entry && target ? length(minus(target as Vec3, entry as Vec3)) : plan.depth
  if (Math.abs(apart - plan.depth) > kOffAxis_mm)
    all.push(`Entry and target are ${mm(apart)} mm apart, the planned depth is ${mm(plan.depth)} mm.`)
  for (const warning of series?.warnings ?? []) all.push(`Image: ${warning}`)
  return all
}
