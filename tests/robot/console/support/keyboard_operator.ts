// A person without a mouse: everything is reached by Tab, pressed by Enter or Space, and pointed at by arrow keys.
import { expect, type Locator, type Page } from '@playwright/test'

import { distance, PageOperator } from './page_operator'

const kTabsMax = 80
const kStepsMax = 400
const kFine_mm = 0.1
const kNear_px = 1 // a nudge of 0.1 mm is drawn about as long

export class KeyboardOperator extends PageOperator {
  keys = 0

  async press(key: string): Promise<void> {
    ++this.keys
    await this.page.keyboard.press(key)
  }
  // By Tab alone, and visibly: what has the focus is outlined.
  async tabTo(control: Locator): Promise<void> {
    await expect(control).toHaveCount(1)
    for (let tabs = 0; tabs < kTabsMax; ++tabs) {
      if (await control.evaluate((one) => one === document.activeElement)) {
        expect(await control.evaluate((one) => getComputedStyle(one).outlineStyle)).not.toBe('none')
        return
      }
      await this.press('Tab')
    }
    throw new Error('Tab does not lead there')
  }
  override async activate(control: Locator): Promise<void> {
    await this.tabTo(control)
    await this.press((await control.getAttribute('type')) === 'checkbox' ? 'Space' : 'Enter')
  }
  override async hold(button: Locator): Promise<void> {
    await this.tabTo(button)
    ++this.keys
    await this.page.keyboard.down('Space')
  }
  override async letGo(): Promise<void> {
    await this.page.keyboard.up('Space')
  }

  // From the target, where the crosshair was left, back towards the entry: in the view along the needle that is upwards.
  override async pointAlongPath(share: number): Promise<void> {
    ++this.acts
    const far = (1 - share) * distance(await this.mm('entry'), await this.mm('target'))
    expect(distance(await this.mm('crosshair'), await this.mm('target'))).toBeLessThan(kFine_mm)
    await this.tabTo(this.page.locator('canvas[tabindex]'))
    await this.press('4')
    await expect(this.button('along the needle')).toHaveAttribute('aria-pressed', 'true')
    for (let steps = Math.round(far / kFine_mm); steps > 0; --steps) await this.press('Shift+ArrowUp')
  }
  override async setTarget(): Promise<void> {
    ++this.acts
    await this.press('t')
  }

  // To a mark that the image shows, by what is seen: how far it lies from the crosshair, and whether it is dashed.
  override async clickAt(mark: string): Promise<void> {
    ++this.acts
    await this.tabTo(this.page.locator('canvas[tabindex]'))
    const large = this.page.locator('[data-tile^=large]')
    const seen = async () => {
      const [at, cross] = [(await large.locator(`[data-name=${mark}]`).boundingBox())!, (await large.locator('[data-name=cross]').boundingBox())!]
      const off = Number(await large.locator(`[data-name=${mark}]`).getAttribute('data-off-mm'))
      const { x, y } = await this.crossAt()
      expect(cross.width).toBeGreaterThan(0)
      return { dx: at.x + at.width / 2 - x, dy: at.y + at.height / 2 - y, off }
    }
    // Slice by slice, then by tenths of a millimetre, until the mark is no longer nearer in the next one.
    for (const shift of ['', 'Shift+'])
      for (const [there, back] of [['PageUp', 'PageDown'], ['PageDown', 'PageUp']] as const)
        for (let steps = 0, before = await seen(); steps < kStepsMax; ++steps) {
          await this.press(shift + there)
          const after = await seen()
          if (Math.abs(after.off) >= Math.abs(before.off)) {
            await this.press(shift + back)
            break
          }
          before = after
        }
    for (let steps = 0; steps < kStepsMax; ++steps) {
      const now = await seen()
      const [far, sideways] = [Math.max(Math.abs(now.dx), Math.abs(now.dy)), Math.abs(now.dx) > Math.abs(now.dy)]
      if (far < kNear_px) return
      const key = sideways ? (now.dx > 0 ? 'ArrowRight' : 'ArrowLeft') : now.dy > 0 ? 'ArrowDown' : 'ArrowUp'
      await this.press(far > 12 ? key : `Shift+${key}`)
    }
    throw new Error('the arrow keys do not lead there')
  }
}
