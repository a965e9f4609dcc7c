// Page, connection and console fail one by one while the needle moves: it is held, and the page shows the failure.
import { expect, test } from '@playwright/test'

import { TcpProxy } from './support/tcp_proxy'
import { note } from './support/figures'
import { PageOperator } from './support/page_operator'
import { pause, Robot } from './support/robot'

const kRetract_ms = 11_000 // the bus considers a process lost after 10 s; a hold does not last longer either

let robot: Robot
let proxy: TcpProxy
test.beforeEach(async () => {
  robot = new Robot()
  await robot.start()
  proxy = await TcpProxy.to(robot.url)
})
test.afterEach(async () => {
  await proxy.remove()
  await robot.stop()
})

async function expectConnectionLost(operator: PageOperator): Promise<void> {
  await expect(operator.mode()).toContainText('NO LINK')
  await expect(operator.alarm()).toContainText('E-100')
  for (const name of [/^Arm/, 'Hold to insert', 'Retract', 'Reset'])
    await expect(operator.button(name)).toHaveAttribute('aria-disabled', 'true')
  await expect(operator.insertButton()).toHaveAttribute('aria-pressed', 'false')
}

test('a closed connection holds the needle, and the page shows it until reconnected', async ({ page }) => {
  const operator = new PageOperator(page, proxy.url)
  await operator.armed()
  await operator.moving()
  const at = Date.now()
  proxy.cut()
  note({ cut_link_to_hold_ms: await robot.msToMode(at, 'hold') })
  await expectConnectionLost(operator)
  await page.mouse.up()
  proxy.reopen()
  await expect(operator.mode()).not.toContainText('NO LINK')
  await operator.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
})

test('a stalled connection holds the needle, and late messages have no effect', async ({ page }) => {
  const operator = new PageOperator(page, proxy.url)
  await operator.armed()
  await operator.moving()
  const at = Date.now()
  proxy.stall()
  note({ silent_link_to_hold_ms: await robot.msToMode(at, 'hold') })
  await expect(page.locator('[data-tile^=large] [data-name=tip]')).toHaveAttribute('data-old', 'true')
  await expect(page.locator('[data-name=Depth]')).toHaveText('OLD')
  await expectConnectionLost(operator)
  proxy.resume()
  await expect(operator.mode()).not.toContainText('NO LINK')
  await operator.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
  await page.mouse.up()
})

test('a console that does not respond holds the needle, and its late heartbeats have no effect', async ({ page }) => {
  const operator = new PageOperator(page, proxy.url)
  await operator.armed()
  await operator.moving()
  const console_ = robot.pid('biopsy-console')
  const at = Date.now()
  process.kill(console_, 'SIGSTOP')
  note({ hanging_console_to_hold_ms: await robot.msToMode(at, 'hold') })
  await expectConnectionLost(operator)
  process.kill(console_, 'SIGCONT')
  await expect(operator.mode()).not.toContainText('NO LINK')
  await operator.isHeld()
  expect(robot.modesSince(at)).not.toContain('active')
  await page.mouse.up()
})

test('a killed console leaves the needle held, then without voltage', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  await operator.moving()
  const at = Date.now()
  process.kill(robot.pid('biopsy-console'), 'SIGKILL')
  note({ killed_console_to_hold_ms: await robot.msToMode(at, 'hold') })
  await expectConnectionLost(operator)
  await page.mouse.up()
  await pause(kRetract_ms / 2) // longer than the wait for other records
  const off_ms = await robot.msToZero(at)
  note({ killed_console_to_0V_ms: off_ms })
  expect(off_ms).toBeLessThanOrEqual(kRetract_ms)
  expect(robot.modesSince(at)).not.toContain('active')
})
