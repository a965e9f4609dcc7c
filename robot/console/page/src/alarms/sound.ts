// The sounds of IEC 60601-1-8: bursts of ten, three or two pulses, each a tone with harmonics; paused for two minutes.
import { computed, effect, signal } from '@preact/signals'

import type { Severity } from '../generated/messages'
import { loudest } from './alarms'

export const kPause_s = 120

interface Burst {
  starts_s: number[] // of the pulses
  pulse_s: number
  tone_Hz: number
  again_s: number // from one burst to the next
}
const half = [0, 0.2, 0.4, 0.75, 0.95]
export const kBursts: Record<Severity, Burst> = {
  Alarm: { starts_s: [...half, ...half.map((at) => at + 1.6)], pulse_s: 0.12, tone_Hz: 660, again_s: 7 },
  Warning: { starts_s: [0, 0.35, 0.7], pulse_s: 0.2, tone_Hz: 440, again_s: 15 },
  Notice: { starts_s: [0, 0.4], pulse_s: 0.2, tone_Hz: 330, again_s: 30 },
}
const kHarmonics = [0, 1, 0.7, 0.5, 0.4, 0.3] // of the tone, from its first
const kEdge_s = 0.02
const kVolume = 0.25

export const pausedUntil = signal(0) // ms since 1970
export const now = signal(Date.now())
export const pausedLeft_s = computed(() => Math.max(0, Math.ceil((pausedUntil.value - now.value) / 1000)))
export const pauseOrResume = () => {
  now.value = Date.now()
  pausedUntil.value = pausedLeft_s.value > 0 ? 0 : now.value + 1000 * kPause_s
}

let context: AudioContext | null = null
export const muted = signal(true) // the browser lets a page sound only after its first click or key

function unlock(): void {
  if (!muted.value) return
  context ??= new AudioContext()
  void context.resume().then(() => (muted.value = context!.state !== 'running'))
}
for (const input of ['pointerdown', 'keydown'] as const) window.addEventListener(input, unlock)

let sounding: OscillatorNode[] = []
async function play({ starts_s, pulse_s, tone_Hz }: Burst, wanted: () => boolean): Promise<void> {
  if (!context) return
  await context.resume()
  muted.value = context.state !== 'running'
  if (muted.value || !wanted()) return
  const wave = context.createPeriodicWave(new Float32Array(kHarmonics.length), new Float32Array(kHarmonics))
  const from = context.currentTime + 0.02
  sounding = starts_s.map((start) => {
    const tone = context!.createOscillator()
    const gain = context!.createGain()
    tone.setPeriodicWave(wave)
    tone.frequency.value = tone_Hz
    gain.gain.setValueAtTime(0, from + start)
    gain.gain.linearRampToValueAtTime(kVolume, from + start + kEdge_s)
    gain.gain.setValueAtTime(kVolume, from + start + pulse_s - kEdge_s)
    gain.gain.linearRampToValueAtTime(0, from + start + pulse_s)
    tone.connect(gain).connect(context!.destination)
    tone.start(from + start)
    tone.stop(from + start + pulse_s)
    return tone
  })
  sounding.at(-1)!.onended = rest
}

// A context that plays silence costs a hundredth of a core and more, so that it is suspended while there is nothing to
// hear, between two bursts too.
const rest = () => void (!muted.value && context?.suspend())

function hush(): void {
  for (const tone of sounding) {
    tone.onended = null // of a burst that another one may follow at once
    tone.stop()
  }
  sounding = []
}

// A burst at once when the loudest alarm changes, then again and again.
const quiet = computed(() => pausedLeft_s.value > 0)
effect(() => {
  const severity = loudest.value
  if (!severity || quiet.value || muted.value) {
    rest()
    return
  }
  let wanted = true
  const burst = () => void play(kBursts[severity], () => wanted)
  burst()
  const timer = setInterval(burst, 1000 * kBursts[severity].again_s)
  return () => {
    wanted = false
    clearInterval(timer)
    hush()
  }
})

// Counts down only while something is paused.
effect(() => {
  if (pausedUntil.value <= Date.now()) return
  const timer = setInterval(() => {
    now.value = Date.now()
    if (now.value >= pausedUntil.value) pausedUntil.value = 0
  }, 500)
  return () => clearInterval(timer)
})
