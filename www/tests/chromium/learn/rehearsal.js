/** A rehearsal of the presentation: what a slide shows, measured as a class would see it. */
import { expect } from '@playwright/test';

/** @import { Page } from '@playwright/test' */

/** Waits until the slide of a stop is whole. @param {Page} page */
async function slideSettled(page) {
  const busy = page.locator('[data-current] .figure-status:visible', { hasText: /\w/ });
  const asked = page.locator('[data-current] .predict-result:visible', { hasText: 'The run is asked.' });
  for (const stage of await page.locator('[data-current] [data-figure]:visible').all())
    await expect(stage).toHaveAttribute('data-state', 'live');
  await expect(asked).toHaveCount(0);
  await expect(busy).toHaveCount(0);
  await expect(page.locator('[data-current] [aria-busy="true"]:visible')).toHaveCount(0);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/**
 * Measures the slide: the share of the window's height that its figure takes (null without one), the smallest letters
 * in pixels, the number of its words, and what reaches beyond the slide or is cut off.
 * @param {Page} page
 */
const measureSlide = (page) =>
  page.evaluate(() => {
    const slide = /** @type {HTMLElement} */ (document.querySelector('.chapter[data-current]'));
    const floor = document.querySelector('.present-bar')?.getBoundingClientRect().top ?? innerHeight;
    const seen = [...slide.querySelectorAll('*')].filter(
      (one) => one.checkVisibility({ visibilityProperty: true }) && !one.closest('.visually-hidden, .best, select'),
    );
    const nameOf = (/** @type {Element} */ one) =>
      `${one.tagName.toLowerCase()}.${one.getAttribute('class') ?? ''} “${(one.textContent ?? '').trim().slice(0, 30)}”`;
    const isText = (/** @type {Element} */ one) =>
      [...one.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent?.trim());
    const sizeOf = (/** @type {Element} */ one) => {
      const own = Number.parseFloat(getComputedStyle(one).fontSize);
      return one instanceof SVGGraphicsElement ? own * (one.getScreenCTM()?.a ?? 1) : own;
    };
    const texts = seen.filter((one) => isText(one) && !one.closest('math'));
    const smallest = texts.reduce((least, one) => (sizeOf(one) < sizeOf(least) ? one : least), texts[0]);
    const figures = seen.filter((one) => one.matches('.picture, .drawing, .cost, .slide-figure'));
    const heights = figures.map((one) => one.getBoundingClientRect().height / innerHeight);
    const beyond = seen.filter((one) => {
      if (one instanceof SVGElement && !(one instanceof SVGSVGElement)) return false;
      const { left, right, bottom, width } = one.getBoundingClientRect();
      const isCut =
        !(one instanceof SVGElement) &&
        one.scrollWidth > one.clientWidth + 1 &&
        one.clientWidth > 0 &&
        getComputedStyle(one).display !== 'inline';
      return width > 0 && (bottom > floor + 1 || right > innerWidth + 1 || left < -1 || isCut);
    });
    return {
      figure: heights.length > 0 ? Math.max(...heights) : null,
      letters: Math.round(10 * sizeOf(smallest)) / 10,
      smallest: nameOf(smallest),
      words: texts
        .map((one) => one.textContent)
        .join(' ')
        .split(/\s+/).length,
      beyond: beyond.map(nameOf),
    };
  });

/** Measures a slide once it is whole. @param {Page} page */
export async function settledSlide(page) {
  await slideSettled(page);
  return measureSlide(page);
}
