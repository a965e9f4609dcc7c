// The picture of the plane along the needle, over the large part of the view.
import { useEffect, useRef } from 'preact/hooks'

import { paintTile } from './needle_plane'
import { labels, opacity } from './tissues'
import * as view from './view'

export function NeedleCanvas() {
  const canvas = useRef<HTMLCanvasElement>(null)
  const tile = view.largeTile.value
  const shown = tile?.plane === 'needle' ? tile : null
  const image = view.voxels.value
  const { low, high } = view.windowed.value
  const painted = opacity.value
  // The tile is made anew in each frame of the viewer, mostly with the same numbers.
  const same = JSON.stringify(shown)
  useEffect(() => {
    const to = canvas.current
    if (!shown || !image || !to) return
    to.width = Math.round(shown.width)
    to.height = Math.round(shown.height)
    const drawing = to.getContext('2d')!
    const picture = drawing.createImageData(to.width, to.height)
    paintTile(picture, shown, image, { low, high }, labels.value, painted)
    drawing.putImageData(picture, 0, 0)
  }, [same, image, low, high, painted])
  return shown && <canvas ref={canvas} class="needle" aria-hidden="true" />
}
