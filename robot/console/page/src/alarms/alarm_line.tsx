// Always there, below the top bar: the alarm of the highest priority, how many there are, and what can be done about
// their sound. The border flashes, the text never does.
import { signal } from '@preact/signals'

import type { Alarm } from '../generated/messages'
import { acknowledge, active, history, isAcknowledged, kPriority, loudest } from './alarms'
import { muted, pausedLeft_s, pauseOrResume } from './sound'

const kMarks = { Alarm: '!!!', Warning: '!!', Notice: '!' }
export const listed = signal(false)

export function AlarmLine() {
  const all = active.value
  const worst = all.find((one) => !isAcknowledged(one)) ?? all[0]
  const shown = worst ? `${worst.severity} ${isAcknowledged(worst) ? 'acknowledged' : ''}` : ''
  return (
    <section class={`alarm ${shown}`} aria-label="alarms" data-priority={worst ? kPriority[worst.severity] : 'none'}>
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

const timeOf = (date: Date | null) => date?.toTimeString().slice(0, 8) ?? ''

function Row(props: { alarm: Alarm; from: Date; to: Date | null; acknowledged: Date | null }) {
  const { alarm } = props
  return (
    <tr data-priority={kPriority[alarm.severity]} data-active={props.to === null}>
      <td>{timeOf(props.from)}</td>
      <td>{props.to ? timeOf(props.to) : 'active'}</td>
      <td>{timeOf(props.acknowledged) || 'no'}</td>
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
      <h2>Alarms since this page was opened</h2>
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
            <Row key={`${one.alarm.code} ${one.from.getTime()}`} {...one} />
          ))}
        </tbody>
      </table>
      {history.value.length === 0 && <p>There was none.</p>}
      <button onClick={() => void (listed.value = false)}>Close the list</button>
    </section>
  )
}
