// No finding of axe.
import AxeBuilder from '@axe-core/playwright'
import { expect, type Page } from '@playwright/test'

// `tags`: only rules of these; none: all there are.
export async function expectAccessible(page: Page, tags: string[] = []): Promise<void> {
  const rules = new AxeBuilder({ page: page as never })
  const found = await (tags.length ? rules.withTags(tags) : rules).analyze()
  expect(found.violations.map((v) => `${v.id} ${v.nodes[0]?.target} ${v.nodes[0]?.failureSummary}`)).toEqual([])
}
