// The page cannot see the robot, for five different reasons: each has its own screen, with what is true and the next step;
// values turn OLD at once, and STOP says that it does not reach the robot.
import { expect, type Page, test } from '@playwright/test'

import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'
import { freezePage, lastEvent, nextModes } from './support/tap'
import { TcpProxy } from './support/tcp_proxy'

let robot: Robot
test.beforeEach(async () => {
  robot = new Robot()
  await robot.start()
})
test.afterEach(() => robot.stop())

async function expectScreen(page: Page, which: string, title: string): Promise<void> {
  await expect(page.locator('[data-screen]')).toHaveAttribute('data-screen', which)
  await expect(page.locator('[data-screen] h2')).toHaveText(title)
  expect(await page.locator('[data-screen] li').count()).toBeGreaterThan(1)
}

async function expectDead(page: Page): Promise<void> {
  for (const name of ['Depth', 'Voltage', 'Scanner']) await expect(page.locator(`[data-name=${name}]`)).toHaveText('OLD')
  await expect(page.getByRole('button', { name: /^STOP/ })).toHaveText('STOP: NO LINK')
  await expect(page.locator('.stopping')).toContainText('It does not reach the robot. Use the hardware E-stop.')
}

test('a wrong token', async ({ page }) => {
  const { origin } = new URL(robot.url)
  await page.goto(`${origin}/?t=0123456789abcdef0123456789abcdef`)
  await expectScreen(page, 'token', 'This address is not valid')
  await expectDead(page)
  await expect(page.locator('[data-screen]')).not.toContainText('holds')
})

test('a full server; the page connects once there is room', async ({ page, context }) => {
  const others = await context.newPage()
  await others.goto(robot.url)
  await others.evaluate(async () => {
    const url = `ws://${location.host}/live${location.search}`
    const sockets = Array.from({ length: 7 }, () => new WebSocket(url))
    await Promise.all(sockets.map((one) => new Promise((opened) => (one.onopen = opened))))
    Object.assign(window, { sockets })
  })
  await page.goto(robot.url)
  await expectScreen(page, 'full', 'Too many pages')
  await expectDead(page)
  await others.close()
  await expect(page.locator('[data-screen]')).toHaveCount(0)
  await expect(page.locator('[data-name=mode]')).not.toContainText('NO LINK')
})

test('a silent link: values are OLD before the screen says so', async ({ page }) => {
  const proxy = await TcpProxy.to(robot.url)
  const operator = new PageOperator(page, proxy.url)
  await operator.planned()
  const planned = await page.locator('.limit').first().textContent()
  expect(planned).not.toContain('OLD')
  proxy.stall()
  await expect(page.locator('[data-name=Depth]')).toHaveText('OLD', { timeout: 1000 })
  await expect(page.locator('.limit').first()).toContainText('OLD')
  await expectScreen(page, 'silent', 'Link lost')
  await expectDead(page)
  await expect(page.locator('[data-name=last-known]')).toContainText('OLD')
  proxy.resume()
  await expect(page.locator('[data-screen]')).toHaveCount(0)
  await proxy.remove()
})

test('a robot that is silent while the console answers', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await freezePage(page, { mode: 'Hold', measured: false, alarms: [], disabled: (await lastEvent(page, 'State')).disabled })
  await expectScreen(page, 'robot', 'The robot is silent')
  await expect(page.locator('[data-name=Depth]')).toHaveText('OLD')
})

test('a controller that is killed ends all: the page says so and does not promise more', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.planned()
  await page.keyboard.press('Escape')
  const card = page.locator('[data-name=stop-card]')
  await expect(card).toContainText('Press Reset.')
  process.kill(robot.pid('biopsy-controller'), 'SIGKILL')
  await expectScreen(page, 'ended', 'The console has ended, or cannot be reached')
  await expectDead(page)
  await expect(page.locator('[data-screen]')).toContainText('open the address that it prints')
  // One list of steps, and none of it is a control that is dead.
  await expect(card).toHaveCount(0)
  await expect(page.locator('[aria-current=step]')).toContainText('follow the steps')
  await expect(page.locator('[data-lit=true]')).toHaveCount(0)
})

test('a killed console comes back at the same address with its points, and says what is gone', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.ready()
  process.kill(robot.pid('biopsy-console'), 'SIGKILL')
  await expectScreen(page, 'ended', 'The console has ended, or cannot be reached')
  await expect(page.locator('[data-screen]')).toContainText('with series and points; plan and checks are to be confirmed anew')
  await expect(page.locator('[data-screen]')).toHaveCount(0, { timeout: 40_000 })
  await expect(operator.alarm()).toContainText('E-124')
  await operator.imageShown()
  // What was confirmed before counts no more, for the robot either.
  await operator.is('Safe')
  expect(await nextModes(page, 8)).not.toContain('Ready')
  await expect(page.locator('dd[data-name=entry]')).not.toHaveText('not set')
  await expect(page.getByRole('checkbox')).toHaveCount(0)
  await operator.click('Confirm this plan')
  await expect(page.locator('[data-name=alarm]').filter({ hasText: 'E-124' })).toHaveCount(0)
})
