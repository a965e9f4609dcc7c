// The image before and after the step: beside each other, one over the other with a slider, or their difference. Both
// pictures have the same pixels; planned and detected tip are drawn in each way.
import { signal } from '@preact/signals'
import type { ComponentChildren } from 'preact'
import { useEffect, useRef } from 'preact/hooks'

import type { Checked } from './generated/messages'
import { welcome } from './robot'

const kWays = ['side by side', 'slider', 'difference'] as const
type Way = (typeof kWays)[number]
const way = signal<Way>('side by side')
const split = signal(50) // %: after, to the left of it

const pngOf = (base64: string) => `data:image/png;base64,${base64}`

function Marks(props: { of: Checked; found: boolean }) {
  const { of } = props
  if (of.per_pixel <= 0) return null
  const place = (depth: number): [number, number] => [
    of.entry_px[0] + (of.axis[0] * depth) / of.per_pixel,
    of.entry_px[1] + (of.axis[1] * depth) / of.per_pixel,
  ]
  const [px, py] = place(of.planned)
  const [tx, ty] = place(of.found)
  const size = of.width / 60
  return (
    <>
      <g data-name="planned" data-mm={of.planned} class="mark target" style={{ strokeWidth: size / 4 }}>
        <path d={`M${px - size},${py}H${px + size}M${px},${py - size}V${py + size}`} />
      </g>
      {props.found && of.tip_found && (
        <g data-name="found" data-mm={of.found} class="tip">
          <circle class="solid" cx={tx} cy={ty} r={size / 3} />
          <circle class="uncertain" cx={tx} cy={ty} r={Math.max((2 * of.sigma) / of.per_pixel, size / 2)} />
        </g>
      )}
    </>
  )
}

function Figure(props: { of: Checked; caption: string; label: string; children: ComponentChildren }) {
  return (
    <figure>
      <figcaption>
        {props.caption}
        {welcome.value?.simulated && ' · SIMULATED'}
      </figcaption>
      <svg viewBox={`0 0 ${props.of.width} ${props.of.height}`} role="img" aria-label={props.label}>
        {props.children}
      </svg>
    </figure>
  )
}

function Picture(props: { of: Checked; after: boolean }) {
  const { of, after } = props
  return (
    <Figure of={of} caption={after ? 'After: needle in place' : 'Before'} label={after ? 'image after' : 'image before'}>
      <image href={pngOf(after ? of.after_png : of.before_png)} width={of.width} height={of.height} />
      <Marks of={of} found={after} />
    </Figure>
  )
}

function Slider(props: { of: Checked }) {
  const { of } = props
  const at = (of.width * split.value) / 100
  return (
    <Figure of={of} caption="Left of the line after, right of it before" label="images after and before, one over the other">
      <image href={pngOf(of.before_png)} width={of.width} height={of.height} />
      <clipPath id="after">
        <rect width={at} height={of.height} />
      </clipPath>
      <image data-name="after" href={pngOf(of.after_png)} width={of.width} height={of.height} clip-path="url(#after)" />
      <line class="split" x1={at} x2={at} y2={of.height} />
      <Marks of={of} found={true} />
    </Figure>
  )
}

async function greysOf(png: string, width: number, height: number): Promise<Uint8ClampedArray> {
  const image = new Image()
  image.src = png
  await image.decode()
  const canvas = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!
  canvas.drawImage(image, 0, 0)
  return canvas.getImageData(0, 0, width, height).data
}

// Middle grey: unchanged; white: brighter than before; black: darker.
function Difference(props: { of: Checked }) {
  const { of } = props
  const canvas = useRef<HTMLCanvasElement>(null)
  useEffect(() => {
    let gone = false
    const { width, height } = of
    void Promise.all([of.before_png, of.after_png].map((png) => greysOf(pngOf(png), width, height))).then(([before, after]) => {
      if (gone || !canvas.current) return
      const drawing = canvas.current.getContext('2d')!
      const picture = drawing.createImageData(width, height)
      for (let n = 0; n < picture.data.length; n += 4) {
        picture.data.fill(128 + (after![n]! - before![n]!) / 2, n, n + 3)
        picture.data[n + 3] = 255
      }
      drawing.putImageData(picture, 0, 0)
    })
    return () => void (gone = true)
  }, [of])
  return (
    <Figure of={of} caption="After less before: grey is unchanged, dark is where signal went" label="difference of the images">
      <foreignObject width={of.width} height={of.height}>
        <canvas ref={canvas} data-name="difference" width={of.width} height={of.height} />
      </foreignObject>
      <Marks of={of} found={true} />
    </Figure>
  )
}

export function Compare(props: { of: Checked; children?: ComponentChildren }) {
  return (
    <>
      <div class="row ways" role="group" aria-label="compare before and after">
        {kWays.map((one) => (
          <button key={one} aria-pressed={way.value === one} onClick={() => void (way.value = one)}>
            {one}
          </button>
        ))}
        {way.value === 'slider' && (
          <label class="slice">
            after, to the left of the line
            <input
              type="range"
              min="0"
              max="100"
              value={split.value}
              onInput={(event) => void (split.value = Number(event.currentTarget.value))}
            />
          </label>
        )}
        {props.children}
      </div>
      <div class={way.value === 'side by side' ? 'pair' : 'pair alone'}>
        {way.value === 'slider' && <Slider of={props.of} />}
        {way.value === 'difference' && <Difference of={props.of} />}
        {way.value === 'side by side' && (
          <>
            <Picture of={props.of} after={false} />
            <Picture of={props.of} after={true} />
          </>
        )}
      </div>
    </>
  )
}
