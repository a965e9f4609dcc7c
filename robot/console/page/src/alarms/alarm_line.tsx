// Always there, below the top bar: the alarm of the highest priority, how many there are, and what can be done about
// their sound. The border flashes, the text never does.
import { signal, useSignalEffect } from '@preact/signals'
import { useRef } from 'preact/hooks'

import type { PastAlarm } from '../generated/messages'
import { acknowledge, active, isAcknowledged, kPriority, loudest } from './alarms'
import { flash } from './flash'
import { history } from './history'
import { muted, pausedLeft_s, pauseOrResume } from './sound'

const kMarks = { Alarm: '!!!', Warning: '!!', Notice: '!' }
export const listed = signal(false)

export function AlarmLine() {
  const all = active.value
  const worst = all.find((one) => !isAcknowledged(one)) ?? all[0]
  const line = useRef<HTMLElement>(null)
  useSignalEffect(() => flash(line.current!, loudest.value))
  const shown = worst ? `${worst.severity} ${isAcknowledged(worst) ? 'acknowledged' : ''}` : ''
  return (
    <section ref={line} class={`alarm ${shown}`} aria-label="alarms" data-priority={worst ? kPriority[worst.severity] : 'none'}>
      <div class="says" role="alert">
        {worst ? (
          <>
            <b class="mark">
              <span aria-hidden="true">{kMarks[worst.severity]}</span> {kPriority[worst.severity].toUpperCase()}
            </b>
            <span data-name="alarm">
              <b>{worst.code}</b> {worst.what} {worst.robot_did} {worst.to_do}
            </span>
          </>
        ) : (
          <span>No alarms</span>
        )}
      </div>
      {pausedLeft_s.value > 0 && <b data-name="audio-paused">Sound paused: {pausedLeft_s.value} s</b>}
      {loudest.value && muted.value && <b data-name="audio-off">No sound before the first click</b>}
      {loudest.value && <button onClick={acknowledge}>Acknowledge</button>}
      {(loudest.value || pausedLeft_s.value > 0) && (
        <button onClick={pauseOrResume}>{pausedLeft_s.value > 0 ? 'Sound on' : 'Pause sound'}</button>
      )}
      <button aria-expanded={listed.value} onClick={() => void (listed.value = !listed.value)}>
        Alarms: <b data-name="alarm-count">{all.length}</b>
      </button>
    </section>
  )
}

// With the day where it is not today's.
function timeOf(ms: number): string {
  const date = new Date(ms)
  const time = date.toTimeString().slice(0, 8)
  return date.toDateString() === new Date().toDateString() ? time : `${date.toLocaleDateString('sv')} ${time}`
}

function Row(props: { row: PastAlarm }) {
  const { alarm, from_ms, to_ms, acknowledged_ms } = props.row
  return (
    <tr data-priority={kPriority[alarm.severity]} data-active={to_ms === 0}>
      <td>{timeOf(from_ms)}</td>
      <td>{to_ms ? timeOf(to_ms) : 'active'}</td>
      <td>{acknowledged_ms ? timeOf(acknowledged_ms) : 'no'}</td>
      <td>{kPriority[alarm.severity]}</td>
      <td>
        <b>{alarm.code}</b> {alarm.what} {alarm.robot_did}
      </td>
    </tr>
  )
}

export function AlarmList() {
  if (!listed.value) return null
  return (
    <section class="alarm-list" aria-label="list of alarms" tabIndex={0}>
      <h2>Alarms of this robot, newest first</h2>
      <table>
        <thead>
          <tr>
            <th>From</th>
            <th>To</th>
            <th>Acknowledged</th>
            <th>Priority</th>
            <th>Alarm</th>
          </tr>
        </thead>
        <tbody>
          {history.value.map((one) => (
            <Row key={`${one.number} ${one.alarm.code} ${one.from_ms}`} row={one} />
          ))}
        </tbody>
      </table>
      {history.value.length === 0 && <p>There was none.</p>}
      <button onClick={() => void (listed.value = false)}>Close the list</button>
    </section>
  )
}
