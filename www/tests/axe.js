/** What axe has to say of a page. @module */
import AxeBuilder from '@axe-core/playwright';

/** @import { Page } from '@playwright/test' */

/**
 * Without the legacy mode each scan opens a page of its own to gather what frames of other hosts say, which takes as long as
 * the scan; here are no such frames.
 * @param {Page} page
 */
export const axe = (page) =>
  new AxeBuilder({ page })
    .setLegacyMode()
    .withTags(['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'])
    .analyze();
