// The states of each run as blocks on the time axis, with marks for hazards and images.
import type { Mode, Span } from '../generated/messages'
import { kStopped } from './events'
import { type Run, runs } from './runs'
import { inner, kLeft_px, width, xOf } from './scale'
import { onAxis, view } from './time'

const kHeight_px = 34
const kLetter_px = 11 // of a state's name
const kThin_px = 1

interface Block {
  mode: Mode
  left: number
  right: number
}

// Of one mode each, as far as they are in view; what is thinner than a pixel is drawn one pixel wide, a stop always.
function blocksOf(run: Run, spans: Span[]): Block[] {
  const [first, last] = [kLeft_px, kLeft_px + inner()]
  const blocks: Block[] = []
  spans.forEach((span, n) => {
    if (n > 0 && spans[n - 1]!.mode === span.mode) return
    const next = spans.slice(n + 1).find((one) => one.mode !== span.mode)
    const left = Math.max(xOf(onAxis(run, span.from)), first)
    const right = Math.min(xOf(onAxis(run, next?.from ?? run.end)), last)
    if (right < first || left > last) return
    const before = blocks.at(-1)
    if (right - left < kThin_px && before && left - before.left < kThin_px && !kStopped.includes(span.mode)) return
    blocks.push({ mode: span.mode, left, right: Math.max(right, left + kThin_px) })
  })
  return blocks
}

// Where the brake held the needle, as left and right edges.
function lockedOf(run: Run): [number, number][] {
  const locked = run.columns.get('locked')
  if (!locked) return []
  const edges: number[] = []
  for (let n = 0; n < locked.length; ++n) if (locked[n] !== (n > 0 ? locked[n - 1] : 0)) edges.push(run.time[n]!)
  if (edges.length % 2) edges.push(run.end)
  const place = (at: number) => Math.min(Math.max(xOf(onAxis(run, at)), kLeft_px), kLeft_px + inner())
  const spans = edges.filter((_, n) => n % 2 === 0).map((from, n): [number, number] => [place(from), place(edges[2 * n + 1]!)])
  return spans.filter(([left, right]) => right > left)
}

function Lane(props: { run: Run }) {
  const { run } = props
  const [from, to] = view.value
  const inView = <Item extends { at: number }>(items: Item[]) =>
    items.filter((one) => onAxis(run, one.at) >= from && onAxis(run, one.at) <= to)
  return (
    <svg class="lane" width={width.value} height={kHeight_px} data-run={run.letter} role="img" aria-label={`states of run ${run.letter}`}>
      <text class={`letter ${run.letter}`} x={kLeft_px - 14} y={kHeight_px / 2 + 6} text-anchor="end">
        {runs.value.length > 1 ? `state ${run.letter}` : 'state'}
      </text>
      {blocksOf(run, run.about.spans).map(({ mode, left, right }) => (
        <g key={`${left} ${mode}`} class="block" data-mode={mode}>
          <rect x={left} y="2" width={right - left} height={kHeight_px - 4} />
          {right - left > kLetter_px * mode.length + 10 && (
            <text x={(left + right) / 2} y={kHeight_px / 2 + 6} text-anchor="middle">
              {mode.toUpperCase()}
            </text>
          )}
        </g>
      ))}
      {lockedOf(run).map(([left, right]) => (
        <rect key={`locked ${left}`} class="locked-mark" x={left} y={kHeight_px - 6} width={right - left} height="4">
          <title>needle locked</title>
        </rect>
      ))}
      {inView(run.about.images).map((image) => (
        <path key={`image ${image.step}`} class="image-mark" data-step={image.step} d={`M${xOf(onAxis(run, image.at)) - 7},3h14v10h-14z`} />
      ))}
      {inView(run.about.hazards).map((hazard) => (
        <path key={`hazard ${hazard.at}`} class="hazard-mark" d={`M${xOf(onAxis(run, hazard.at))},16l9,16h-18z`} />
      ))}
    </svg>
  )
}

export const Lanes = () => (
  <>
    {runs.value.map((run) => (
      <Lane key={run.letter} run={run} />
    ))}
  </>
)
