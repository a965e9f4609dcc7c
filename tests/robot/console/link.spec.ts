// Page, link and console fail one by one while the needle moves: it is held, and who looks at the page knows.
import { expect, test } from '@playwright/test'

import { Cable } from './cable'
import { note } from './figures'
import { Person } from './person'
import { pause, Robot } from './robot'

const kLetBack_ms = 11_000 // the bus gives a process up after 10 s; a hold does not last longer either

let robot: Robot
let cable: Cable
test.beforeEach(async () => {
  robot = new Robot()
  await robot.start()
  cable = await Cable.to(robot.url)
})
test.afterEach(async () => {
  await cable.remove()
  await robot.stop()
})

async function saysLost(person: Person): Promise<void> {
  await expect(person.mode()).toContainText('NO LINK')
  await expect(person.alarm()).toContainText('E-100')
  for (const name of [/^Arm/, 'Hold to insert', 'Retract', 'Reset'])
    await expect(person.button(name)).toHaveAttribute('aria-disabled', 'true')
  await expect(person.insertButton()).toHaveAttribute('aria-pressed', 'false')
}

test('a link that is cut holds, and the page says so until it is back', async ({ page }) => {
  const person = new Person(page, cable.url)
  await person.armed()
  await person.moving()
  const at = Date.now()
  cable.cut()
  note({ cut_link_to_hold_ms: await robot.msToMode(at, 'hold') })
  await saysLost(person)
  await page.mouse.up()
  cable.plugIn()
  await expect(person.mode()).not.toContainText('NO LINK')
  await person.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
})

test('a link that goes silent holds, and what arrives late moves nothing', async ({ page }) => {
  const person = new Person(page, cable.url)
  await person.armed()
  await person.moving()
  const at = Date.now()
  cable.goSilent()
  note({ silent_link_to_hold_ms: await robot.msToMode(at, 'hold') })
  await expect(page.locator('[data-tile^=large] [data-name=tip]')).toHaveAttribute('data-old', 'true')
  await expect(page.locator('[data-name=Depth]')).toHaveText('OLD')
  await saysLost(person)
  cable.speakAgain()
  await expect(person.mode()).not.toContainText('NO LINK')
  await person.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
  await page.mouse.up()
})

test('a console that hangs holds, and its late beats move nothing', async ({ page }) => {
  const person = new Person(page, cable.url)
  await person.armed()
  await person.moving()
  const console_ = robot.pid('biopsy-console')
  const at = Date.now()
  process.kill(console_, 'SIGSTOP')
  note({ hanging_console_to_hold_ms: await robot.msToMode(at, 'hold') })
  await saysLost(person)
  process.kill(console_, 'SIGCONT')
  await expect(person.mode()).not.toContainText('NO LINK')
  await person.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
  await page.mouse.up()
})

test('a console that is killed leaves a needle that is held, then without voltage', async ({ page }) => {
  const person = new Person(page, robot.url)
  await person.armed()
  await person.moving()
  const at = Date.now()
  process.kill(robot.pid('biopsy-console'), 'SIGKILL')
  note({ killed_console_to_hold_ms: await robot.msToMode(at, 'hold') })
  await saysLost(person)
  await page.mouse.up()
  await pause(kLetBack_ms / 2) // it is waited for longer than for other records
  const off_ms = await robot.msToZero(at)
  note({ killed_console_to_0V_ms: off_ms })
  expect(off_ms).toBeLessThanOrEqual(kLetBack_ms)
  expect(robot.modesSince(at)).not.toContain('active')
})
