// Operates the page as a person does. Waits for what the page shows, never for time.
import { expect, type Locator, type Page } from '@playwright/test'

import { slowClock, stretched } from './clock'
import { pause } from './robot'
import { lastEvent, nextModes, roundTrip, tap } from './tap'

export type Vec3 = [number, number, number]
export const distance = (a: Vec3, b: Vec3) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])

// True position in the built-in phantom of `biopsy dry-run gap`, R, A, S in mm.
export const kEntry: Vec3 = [-4.396, 33.092, 51.854]
export const kGapDepth_mm = 2.5

// Deliberate acts to an accepted depth: from the page before anything is open, and of each further target of the same
// patient, from the image on which it is set.
export const kActsMax = 12
export const kFurtherActsMax = 7

const kSlow = { timeout: stretched(30_000) } // on a loaded machine
const kPresses = 20

export class PageOperator {
  acts = 0 // deliberate ones
  constructor(readonly page: Page, readonly url: string) {}

  // The page
  async open(): Promise<void> {
    await slowClock(this.page)
    await tap(this.page)
    await this.page.goto(this.url)
    await expect(this.page.locator('.steps [aria-current]')).toBeVisible(kSlow)
  }
  async reopen(): Promise<void> {
    await this.page.mouse.move(5, 5)
    await this.open()
    await this.imageShown()
  }
  button(name: string | RegExp): Locator {
    return this.page.getByRole('button', { name })
  }
  async click(name: string | RegExp): Promise<void> {
    ++this.acts
    await this.activate(this.button(name))
  }
  // By mouse; keyboard_operator.ts does without.
  async activate(control: Locator): Promise<void> {
    await control.click()
  }
  async hold(button: Locator): Promise<void> {
    await button.hover()
    await this.page.mouse.down()
  }
  async letGo(): Promise<void> {
    await this.page.mouse.up()
  }
  insertButton(): Locator {
    return this.button('Hold to insert')
  }
  mode(): Locator {
    return this.page.locator('[data-name=mode]')
  }
  modeNow(): Promise<string | null> {
    return this.mode().getAttribute('data-mode')
  }
  async is(mode: string): Promise<void> {
    await expect(this.mode()).toHaveAttribute('data-mode', mode, kSlow)
  }
  alarm(): Locator {
    return this.page.locator('[data-name=alarm]')
  }
  async mm(name: string): Promise<Vec3> {
    const text = await this.page.locator(`[data-name=${name}]`).first().getAttribute('data-mm')
    return text!.split(',').map(Number) as Vec3
  }

  // From the image to a robot that waits for the button
  async openSeries(): Promise<void> {
    await this.click(/^Open /)
    await this.imageShown()
  }
  async imageShown(): Promise<void> {
    await expect(this.page.locator('body[data-image=shown]')).toBeAttached({ timeout: stretched(60_000) })
    await expect(this.page.locator('[data-tile^=large]')).toBeAttached()
  }
  // Clicks the image where this mark is drawn in the large view.
  async clickAt(mark: string): Promise<void> {
    ++this.acts
    const box = (await this.page.locator(`[data-tile^=large] [data-name=${mark}]`).boundingBox())!
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2]
    await this.page.mouse.click(x, y)
    await expect.poll(async () => {
      const cross = await this.crossAt()
      return Math.hypot(cross.x - x, cross.y - y)
    }, kSlow).toBeLessThan(2)
  }
  // The middle of the crosshair in the large view, in pixels of the page.
  crossAt(): Promise<{ x: number; y: number }> {
    return this.page.locator('[data-tile^=large] [data-name=cross]').evaluate((path: SVGPathElement) => {
      const [, y, x] = /^M[-\d.]+,([-\d.]+).*M([-\d.]+),/.exec(path.getAttribute('d')!)!
      const canvas = path.ownerSVGElement!.getBoundingClientRect()
      return { x: canvas.x + Number(x), y: canvas.y + Number(y) }
    })
  }
  // Clicks this share of the way from entry to target.
  async pointAlongPath(share: number): Promise<void> {
    ++this.acts
    const box = async (mark: string) => (await this.page.locator(`[data-tile^=large] [data-name=${mark}]`).boundingBox())!
    const [from, to] = [await box('entry'), await box('target')]
    const between = (side: 'x' | 'y', size: 'width' | 'height') =>
      (1 - share) * (from[side] + from[size] / 2) + share * (to[side] + to[size] / 2)
    await this.page.mouse.click(between('x', 'width'), between('y', 'height'))
  }
  async setTarget(): Promise<void> {
    await this.click('Set target')
  }
  // Retracts after an accepted depth, as its sample is taken. Then another target of the same patient, this share of the
  // way to the one before, up to its accepted depth; its acts alone.
  async furtherTarget(share: number): Promise<number> {
    await this.retractAccepted()
    const depth = await this.plannedDepth()
    this.acts = 0
    await this.pointAlongPath(share)
    await this.setTarget()
    await expect.poll(async () => Math.abs((await this.plannedDepth()) - share * depth), kSlow).toBeLessThan(0.2)
    await this.confirmPlan()
    await this.recover()
    await this.arm()
    await this.insert()
    await expect(this.page.locator('[data-name=verdict]')).toHaveText('accept', kSlow)
    await this.click('Accept this depth')
    await expect(this.page.locator('[aria-current=step]')).toContainText(/Accepted|The run is over/)
    return this.acts
  }
  async retractAccepted(): Promise<void> {
    const retract = this.page.getByRole('button', { name: 'Retract', exact: true })
    if ((await retract.getAttribute('aria-disabled')) === 'false') await this.activate(retract)
    await expect(this.page.getByRole('link', { name: /Accepted. Open the report/ })).toBeVisible(kSlow)
  }
  async plannedDepth(): Promise<number> {
    return parseFloat((await this.page.locator('[data-name=planned-depth]').textContent())!)
  }
  async setPoints(): Promise<void> {
    await this.clickAt('proposed-entry')
    await this.click('Set entry')
    await expect(this.page.locator('dd[data-name=entry]')).not.toHaveText('not set')
    await this.clickAt('proposed-target')
    await this.click('Set target')
    await expect(this.page.locator('[data-name=planned-depth]')).toBeVisible()
  }
  async tickAll(): Promise<void> {
    const boxes = this.page.getByRole('checkbox')
    await expect(boxes.first()).toBeVisible(kSlow)
    await expect(boxes).toHaveCount((await this.page.locator('[data-name=carried]').count()) ? 1 : 3, kSlow)
    for (const box of await boxes.all()) {
      if (await box.isChecked()) continue
      ++this.acts
      await this.activate(box)
      await expect(box).toBeChecked() // confirmed by the server
    }
  }
  async confirmPlan(): Promise<void> {
    await this.click('Confirm this plan')
    await this.tickAll()
  }
  // A stalling host releases a held button, as it should; the operator then presses again.
  async again(button: Locator, reached: () => Promise<boolean>): Promise<void> {
    ++this.acts
    for (let presses = 0; presses < kPresses && !(await reached()); ++presses) {
      await expect(button).toHaveAttribute('aria-pressed', 'false')
      if ((await button.getAttribute('aria-disabled')) === 'true') {
        await pause(20)
        continue
      }
      await this.hold(button)
      let alive = true
      while (alive && !(await reached())) {
        await pause(20)
        alive = (await button.getAttribute('aria-pressed')) === 'true'
      }
      await this.letGo()
    }
    await expect.poll(reached, kSlow).toBe(true)
  }
  async arm(): Promise<void> {
    await expect(this.button(/^Arm/)).toHaveAttribute('aria-disabled', 'false', kSlow)
    await this.again(this.button(/^Arm/), async () => (await this.modeNow()) === 'Armed')
  }
  // To the end of the step and its image. A robot on a machine that stalls trips by itself (its clock stood still),
  // as it should; the operator then starts the run again.
  async insert(stageEnded = async () => {}): Promise<void> {
    const acts = this.acts
    const over = this.page.locator('.confirm')
    const image = this.page.locator('[data-name=verdict]')
    const none = this.page.getByText('no image was taken')
    const tripped = this.page.locator('[data-name=mode][data-mode=Trip]') // before the needle moved: no run, no result
    for (let runs = 0; runs < 3; ++runs) {
      this.acts = acts
      await this.again(this.insertButton(), async () => (await over.isVisible()) || (await this.modeNow()) === 'Trip')
      if (await over.isVisible()) await stageEnded()
      await expect(image.or(none).or(tripped).first()).toBeVisible(kSlow)
      if (await image.isVisible()) return
      await this.recover()
      await this.arm()
    }
    throw new Error('no run was completed')
  }
  // From a run that is over, or a robot that tripped meanwhile, to one that can be armed. Without its plan and all three
  // checks nothing is reset; and the end of a run takes the checks back when it was Ready for a moment.
  async recover(): Promise<void> {
    await expect(async () => {
      const reset = this.button('Reset')
      if ((await reset.getAttribute('aria-disabled')) === 'false') await this.reset()
      // A stop that came with the image: nothing begins before somebody has judged it.
      const reject = this.button(/^Reject/)
      if ((await reject.count()) > 0 && (await reject.getAttribute('aria-disabled')) === 'false') await this.activate(reject)
      if ((await this.page.getByRole('checkbox').count()) > 0) await this.tickAll()
      const arm = this.page.locator('.act').first()
      expect(await arm.getByRole('button').getAttribute('aria-disabled'), await arm.innerText()).toBe('false')
    }).toPass({ timeout: stretched(60_000) })
  }

  // A hold that the previous test left may run out while this one goes for the button, which is off then.
  async atRest(): Promise<void> {
    const retract = this.button('Retract')
    await expect(async () => {
      const { mode } = await lastEvent(this.page, 'State')
      if (!['Armed', 'Active', 'Hold', 'Retract'].includes(mode)) return
      if ((await retract.getAttribute('aria-disabled')) === 'false') await retract.click({ timeout: 1000 })
      throw new Error(`it is in ${mode}`)
    }).toPass(kSlow)
  }
  // From the state that the previous test left to a displayed plan,
  async planned(): Promise<void> {
    await this.open()
    await this.atRest()
    const { step } = await lastEvent(this.page, 'State')
    await (step === 'Image' ? this.openSeries() : this.imageShown())
    if ((await lastEvent(this.page, 'Planned')).entry.length === 0) await this.setPoints()
  }
  // and to a robot that is ready.
  async ready(): Promise<void> {
    await this.planned()
    if (!(await lastEvent(this.page, 'Planned')).confirmed) await this.click('Confirm this plan')
    await this.recover()
  }
  async armed(): Promise<void> {
    await this.ready()
    await this.arm()
  }
  // Until the supervisor accepts it: the key counts once the needle is back.
  async reset(): Promise<void> {
    await expect(async () => {
      await this.activate(this.button('Reset'))
      await expect(this.mode()).not.toHaveAttribute('data-mode', 'Trip', { timeout: stretched(1000) })
    }).toPass(kSlow)
  }

  // Presses until the needle moves, and keeps the button down.
  async moving(): Promise<void> {
    for (let presses = 0; presses < kPresses; ++presses) {
      if ((await this.modeNow()) === 'Trip') await this.recover()
      if (!['Armed', 'Hold', 'Active'].includes((await this.modeNow())!)) await this.arm()
      await this.insertButton().hover()
      await this.page.mouse.down()
      while ((await this.insertButton().getAttribute('aria-pressed')) === 'true') {
        if ((await this.modeNow()) === 'Active') return
        await pause(10)
      }
      await this.page.mouse.up()
    }
    throw new Error('the needle never moved')
  }
  // Whatever was done: the needle is held short of its step, and nothing that is still on its way moves it.
  async isHeld(): Promise<void> {
    await expect(this.mode()).not.toHaveAttribute('data-mode', 'Active', kSlow)
    await roundTrip(this.page)
    const modes = await nextModes(this.page, 6)
    expect(modes).not.toContain('Active')
    expect((await lastEvent(this.page, 'State')).stage_done).toBe(false)
  }
}
