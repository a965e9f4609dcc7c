// Drawn over the image, in each of its frames: crosshair, entry, target, path, live tip, points proposed by the case, the
// stage's reach, ruler, scale bars. SVG, so that a test can read every position in mm from the page. Dashed: in front of
// or behind the displayed slice.
import { add, kNames, length, lettersOf, minus, mm, project, type Tile, type View } from './geometry'
import * as path from './path'
import { crossed, crosshair, ruler, rulerLength, tiles } from './view'
import { isOld, opened, plan, state, type Vec3 } from '../robot'

const kOff_mm = 0.5
const kBars_mm = [100, 50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1]
const kGap_px = 16
// Where the name of a plane would reach the letter in the middle.
const kShort: Record<View, string> = { axial: 'ax', coronal: 'cor', sagittal: 'sag', needle: 'ndl', '3-D': '3-D' }
const kTextMin_px = 110 // below this height words would cover the picture
const kLetter_px = 10
const kFrame_px = 36 // along the edges of a tile: letters, names and scale bars
const kBarText_px = 92 // what the scale bar's words and margins take beside it
const kBarMin_px = 20
const kRulerText_px = 76
const kRulerRoom_px = 2 * kFrame_px + kRulerText_px
const kTipSigma_mm = 0.1 // the laser's loop settles within this; paper IV.F

const mmText = (p: Vec3) => p.map((v) => v.toFixed(3)).join(',')

function Mark(props: { tile: Tile; at: Vec3; kind: 'entry' | 'target'; proposed?: boolean }) {
  const { x, y, off } = project(props.tile, props.at)
  const dash = Math.abs(off) > kOff_mm || props.proposed ? '5 4' : 'none'
  const name = props.proposed ? `proposed-${props.kind}` : props.kind
  const shape =
    props.kind === 'entry' ? (
      <circle cx={x} cy={y} r="9" />
    ) : (
      <path d={`M${x - 9},${y}H${x + 9}M${x},${y - 9}V${y + 9}`} />
    )
  return (
    <g class={`mark ${props.kind}`} data-name={name} data-mm={mmText(props.at)} data-off-mm={off.toFixed(3)}
       stroke-dasharray={dash} opacity={props.proposed ? 0.75 : 1}>
      {shape}
    </g>
  )
}

function Path(props: { tile: Tile; from: Vec3; to: Vec3 }) {
  const a = project(props.tile, props.from)
  const b = project(props.tile, props.to)
  const off = Math.max(Math.abs(a.off), Math.abs(b.off)) > kOff_mm
  return (
    <line class="path" data-name="path" x1={a.x} y1={a.y} x2={b.x} y2={b.y} stroke-dasharray={off ? '6 4' : 'none'} />
  )
}

// Hollow and "OLD" while the position is outdated.
function Tip(props: { tile: Tile; from: Vec3; to: Vec3 }) {
  const known = state.value
  if (!known?.measured || !known.depth_known) return null
  const way = minus(props.to, props.from)
  const tip = add(props.from, way, Math.round(50 * known.depth) / 50 / length(way)) // no repaint for noise
  const { x, y, off } = project(props.tile, tip)
  const radius = (2 * kTipSigma_mm) / length(props.tile.right)
  return (
    <g class="tip" data-name="tip" data-mm={mmText(tip)} data-off-mm={off.toFixed(3)} data-old={isOld.value}>
      <circle class="uncertain" cx={x} cy={y} r={Math.max(radius, 6)} />
      <circle class={isOld.value ? 'hollow' : 'solid'} cx={x} cy={y} r="4" />
      {isOld.value && (
        <text x={x + 10} y={y + 5}>
          OLD
        </text>
      )}
    </g>
  )
}

// Open in the middle: what it points at stays in view.
function Cross(props: { tile: Tile; at: Vec3 }) {
  const { left, top, width, height } = props.tile
  const { x, y } = project(props.tile, props.at)
  const lines = `M${left},${y}H${x - kGap_px}M${x + kGap_px},${y}H${left + width}M${x},${top}V${y - kGap_px}M${x},${y + kGap_px}V${top + height}`
  return <path class="cross" data-name="cross" d={lines} />
}

// Where the stage's stroke ends, all around the entry, or around the crosshair before there is one: cut by the slice.
function Reach(props: { tile: Tile; entry: Vec3; reach: number }) {
  const { x, y, off } = project(props.tile, props.entry)
  const across = Math.sqrt(Math.max(props.reach ** 2 - off ** 2, 0)) / length(props.tile.right)
  return across > 0 ? <circle class="reach" data-name="reach" data-mm={props.reach} cx={x} cy={y} r={across} /> : null
}

// The nearest place within the frame of a tile, for what is so long.
const inside = (at: number, from: number, size: number, long: number) =>
  Math.max(Math.min(at, from + size - kFrame_px - long), from + kFrame_px)

function Ruler(props: { tile: Tile }) {
  if (!ruler.value) return null
  const { left, top, width, height } = props.tile
  const [a, b] = [project(props.tile, ruler.value.from), project(props.tile, ruler.value.to)]
  const off = Math.max(Math.abs(a.off), Math.abs(b.off)) > kOff_mm
  return (
    <g class="ruler" data-name="ruler" data-mm={rulerLength.value.toFixed(3)}>
      <line x1={a.x} y1={a.y} x2={b.x} y2={b.y} stroke-dasharray={off ? '6 4' : 'none'} />
      {width > kRulerRoom_px && (
        <text x={inside(b.x + 10, left, width, kRulerText_px)} y={inside(b.y - 10, top + 16, height - 40, 0)}>
          {mm(rulerLength.value)} mm
        </text>
      )}
    </g>
  )
}

// Sides of the patient.
function Letters(props: { tile: Tile }) {
  const { left, top, width, height, right, down } = props.tile
  const [x, y] = [left + width / 2, top + height / 2]
  const letters: [string, number, number, Vec3, number][] = [
    ['left', left + 14, y, right, -1],
    ['right', left + width - 14, y, right, 1],
    ['top', x, top + 24, down, -1],
    ['bottom', x, top + height - 12, down, 1],
  ]
  return (
    <>
      {letters.map(([edge, at, line, way, sign]) => (
        <text key={edge} class="letter" data-edge={edge} x={at} y={line} text-anchor="middle">
          {lettersOf(way, sign)}
        </text>
      ))}
    </>
  )
}

const nameOf = ({ plane, width }: Tile) => (kLetter_px * kNames[plane].length + kFrame_px > width / 2 ? kShort[plane] : kNames[plane])

// The longest that leaves room for the letter in the middle; where none does, above it.
function Scale(props: { tile: Tile }) {
  const { tile } = props
  const within = (room: number) => kBars_mm.find((one) => one / length(tile.right) < room)
  const room = tile.width / 2 - kBarText_px
  const beside = room < kBarMin_px ? undefined : within(room)
  const bar = beside ?? within(tile.width - kBarText_px) ?? kBars_mm.at(-1)!
  const wide = bar / length(tile.right)
  const [x, y] = [tile.left + tile.width - wide - 68, tile.top + tile.height - (beside ? 12 : kFrame_px)]
  return (
    <g class="scale" data-mm={bar}>
      <path d={`M${x},${y - 5}V${y}H${x + wide}V${y - 5}`} />
      <text x={x + wide + 6} y={y}>
        {bar} mm
      </text>
    </g>
  )
}

export function Overlay() {
  const [entry, target] = [path.entry.value, path.target.value]
  const proposal = opened.value?.proposal[0]
  return (
    <svg class="overlay" role="img" aria-label="entry, target, path and needle tip over the image">
      {crosshair.value && <g data-name="crosshair" data-mm={mmText(crosshair.value)} />}
      {tiles.value.map((tile, n) => (
        <g key={n} data-tile={n === 0 ? `large ${tile.plane}` : tile.plane} data-right={tile.right.map((v) => v.toPrecision(6)).join()}>
          <clipPath id={`tile${n}`}>
            <rect x={tile.left} y={tile.top} width={tile.width} height={tile.height} />
          </clipPath>
          <g clip-path={`url(#tile${n})`}>
            {crosshair.value && crossed.value && tile.plane !== '3-D' && <Cross tile={tile} at={crosshair.value} />}
            {opened.value && (entry ?? crosshair.value) && (
              <Reach tile={tile} entry={entry ?? crosshair.value!} reach={opened.value.reach} />
            )}
            {proposal && !entry && <Mark tile={tile} at={proposal.entry_ras as Vec3} kind="entry" proposed />}
            {proposal && !target && <Mark tile={tile} at={proposal.target_ras as Vec3} kind="target" proposed />}
            {entry && target && <Path tile={tile} from={entry} to={target} />}
            {entry && <Mark tile={tile} at={entry} kind="entry" />}
            {target && <Mark tile={tile} at={target} kind="target" />}
            {plan.value && entry && target && <Tip tile={tile} from={entry} to={target} />}
            {tile.plane !== '3-D' && <Ruler tile={tile} />}
            {tile.height > kTextMin_px && (
              <>
                <text class="plane" x={tile.left + 14} y={tile.top + 26}>
                  {nameOf(tile)}
                </text>
                <Letters tile={tile} />
                <Scale tile={tile} />
              </>
            )}
          </g>
        </g>
      ))}
    </svg>
  )
}
