// The flash rates of IEC 60601-1-8: high 2 Hz, medium 0.5 Hz, low none; the border alone, never the text. By a timer: an
// animation has the browser prepare a picture sixty times a second, whether one differs from the one before or not.
import type { Severity } from '../generated/messages'

const kHalfPeriod_ms: Partial<Record<Severity, number>> = { Alarm: 250, Warning: 1000 }

// Returns what ends it, with the border in view.
export function flash(line: HTMLElement, loudest: Severity | null): () => void {
  const half = loudest && kHalfPeriod_ms[loudest]
  const show = (on: boolean) => void (line.dataset.border = on ? 'on' : 'off')
  show(true)
  if (!half) return () => {}
  let on = true
  const timer = setInterval(() => show((on = !on)), half)
  return () => {
    clearInterval(timer)
    show(true)
  }
}
