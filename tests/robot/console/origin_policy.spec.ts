// One page controls, others watch and may stop; requests from elsewhere and malformed messages are refused with a reason.
import { expect, test } from '@playwright/test'

import { PageOperator } from './support/page_operator'
import { Robot } from './support/robot'

const robot = new Robot()
test.beforeAll(() => robot.start())
test.afterAll(() => robot.stop())

test('a used token, a wrong position and a malformed message are refused with a reason', async ({ page }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await operator.openSeries()
  const answers = await page.evaluate(async () => {
    const link = window.tap.newest()
    const answers: { id: number; code: string; what: string; robot_did: string; to_do: string }[] = []
    const commands = [
      { type: 'Press', id: 901, button: 'Insert', token: 7, page_ms: 1 },
      { type: 'SetPoint', id: 902, mark: 'Entry', series_uid: 'another', voxel: [1, 1, 1], ras_mm: [0, 0, 0] },
      { type: 'OpenSeries', id: 903, series_uid: 'another' },
      { type: 'Stop' },
      'garbage',
    ]
    return new Promise<typeof answers>((resolve) => {
      link.addEventListener('message', (event) => {
        const message = JSON.parse(event.data)
        if (message.type === 'Answer' && (message.id === 0 || message.id > 900)) answers.push(message)
        if (answers.length === commands.length) resolve(answers)
      })
      for (const command of commands) link.send(JSON.stringify(command))
    })
  })
  expect(answers.map((one) => one.code)).toEqual(['E-107', 'E-103', 'E-102', 'E-110', 'E-110'])
  for (const answer of answers) {
    expect(answer.what).not.toBe('')
    expect(answer.robot_did).not.toBe('')
    expect(answer.to_do).not.toBe('')
  }
})

test('a second page watches and may stop; it controls once the first is closed', async ({ page, context }) => {
  const operator = new PageOperator(page, robot.url)
  await operator.armed()
  const watcher = new PageOperator(await context.newPage(), robot.url)
  await watcher.open()
  for (const name of [/^Arm/, 'Hold to insert', 'Retract'])
    await expect(watcher.button(name)).toHaveAttribute('aria-disabled', 'true')
  await expect(watcher.page.getByText('Another page controls the robot').first()).toBeVisible()
  await expect(watcher.button('Take control')).toHaveCount(0)
  const refused = await watcher.page.evaluate(() => {
    const link = window.tap.newest()
    return new Promise<string>((resolve) => {
      link.addEventListener('message', (event) => {
        const message = JSON.parse(event.data)
        if (message.type === 'Answer') resolve(message.code)
      })
      link.send('{"type":"TakeControl","id":904}')
    })
  })
  expect(refused).toBe('E-101')
  await watcher.page.bringToFront()
  await watcher.button('STOP').hover()
  await watcher.page.mouse.down()
  await watcher.is('Trip')
  await watcher.page.mouse.up()
  await operator.is('Trip')

  await page.close()
  await watcher.click('Take control')
  await expect(watcher.page.getByText('Another page controls the robot')).toHaveCount(0)
  await watcher.reset()
})

test('without the token there is nothing', async ({ request, page }) => {
  const { origin } = new URL(robot.url)
  for (const path of ['/volume-0.nii', '/report.html', '/volume-0.nii?t=0123456789abcdef0123456789abcdef'])
    expect((await request.get(origin + path)).status()).toBe(403)
  await page.goto(origin + '/?t=0123456789abcdef0123456789abcdef')
  await expect(page.locator('[data-name=mode]')).toContainText('NO LINK')
  await expect(page.getByText('Waiting for the console…')).toBeVisible()
})

test('a request with a body is answered', async ({ request }) => {
  const { origin, search } = new URL(robot.url)
  for (const bytes of [1, 100, 200_000])
    expect((await request.post(`${origin}/status${search}`, { data: Buffer.alloc(bytes, 'x') })).status()).toBe(413)
  expect((await request.post(`${origin}/status${search}`)).status()).toBe(405)
})

test('the page is sent compressed', async ({ page }) => {
  const sent = new Map<string, { encoding: string; bytes: number }>()
  page.on('response', async (response) => {
    const { encodedDataLength } = { encodedDataLength: (await response.request().sizes()).responseBodySize }
    sent.set(new URL(response.url()).pathname, { encoding: response.headers()['content-encoding'] ?? 'none', bytes: encodedDataLength })
  })
  const operator = new PageOperator(page, robot.url)
  await operator.open()
  await expect.poll(() => sent.size).toBeGreaterThanOrEqual(3)
  const files = [...sent].filter(([path]) => path === '/' || path.startsWith('/assets/'))
  expect(files.length).toBeGreaterThanOrEqual(3)
  for (const [path, { encoding }] of files) expect(encoding, path).toBe('gzip')
  expect(files.reduce((sum, [, { bytes }]) => sum + bytes, 0)).toBeLessThan(600_000)
})
