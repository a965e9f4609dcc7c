// Over the image while the page cannot see the robot: what is known of the cause, what was known last, and what to do.
import { everMeasured, loss, type Loss, robotSilent, state } from './robot'
import { mm } from './viewer/geometry'

interface Screen {
  title: string
  text: string
  steps: string[]
}

const kLookFirst = 'Look at the needle. In an emergency use the hardware E-stop: STOP on this page does not reach the robot.'

const kScreens: Record<Exclude<Loss, 'starting'> | 'robot', Screen> = {
  token: {
    title: 'This address is not valid',
    text: 'The console answers, but not to this address: its token is wrong, or of an earlier start of the robot.',
    steps: ['Open the address that `biopsy up` printed last; it is also in console.url in its folder.', 'Close this page.'],
  },
  full: {
    title: 'Too many pages',
    text: 'The console answers. Eight pages are connected to it already, so this one can neither control nor watch.',
    steps: ['Close a page that is not needed.', 'Wait: this page connects by itself as soon as there is room.'],
  },
  silent: {
    title: 'Link lost',
    text: 'The connection is there, but the console sends nothing. A robot without its operator holds the needle at once, and lets go after 10 s; where the needle is locked for an image, after 3 min.',
    steps: [kLookFirst, 'Wait: this page continues by itself when the console answers.', 'If it does not, look at the window of `biopsy up`.'],
  },
  ended: {
    title: 'The console has ended, or cannot be reached',
    text: 'Nothing answers at its address. A robot without its console holds the needle at once, and takes the voltage off within 10 s. Where all of the robot has ended, the voltage is off.',
    steps: [
      kLookFirst,
      'Wait a few seconds: where only the console ended, `biopsy up` starts it again at this address, with series and points; plan and checks are to be confirmed anew.',
      'Otherwise read in the window of `biopsy up` what ended, start it again, and open the address that it prints.',
    ],
  },
  robot: {
    title: 'The robot is silent',
    text: 'The console answers, but no values of the robot reach it. What the needle does is not known here.',
    steps: [kLookFirst, 'Wait: values return by themselves if the robot goes on.', 'If they do not, read in the window of `biopsy up` what ended, and start it again.'],
  },
}

export function LossScreen() {
  const why = loss.value ?? (robotSilent.value ? 'robot' : null)
  if (!why || why === 'starting') return null
  const screen = kScreens[why]
  const last = state.value
  return (
    <section class="loss" tabIndex={0} aria-label={screen.title} data-screen={why}>
      <h2>{screen.title}</h2>
      <p>{screen.text}</p>
      {last && everMeasured.value && (
        <p data-name="last-known">
          Known last, now OLD: {last.mode.toUpperCase()}, needle at {last.depth_known ? `${mm(last.depth, 2)} mm` : 'an unknown depth'},{' '}
          {mm(Math.abs(last.drive), 2)} kV.
        </p>
      )}
      <ol>
        {screen.steps.map((step) => (
          <li key={step}>{step}</li>
        ))}
      </ol>
    </section>
  )
}
