/** For a reader who has set type of twice the usual size (the project's browser has). */
import { expect, test } from '@playwright/test';
import { open, scan } from './helpers.js';

for (const [width, height] of /** @type {const} */ ([
  [1440, 900],
  [2560, 1440],
  [390, 844],
])) {
  test(`with type twice as large nothing lies over anything else at ${width} by ${height}`, { tag: '@all' }, async ({
    page,
  }) => {
    const { clean } = await open(page, { width, height });
    expect(
      await page.evaluate(() => parseFloat(getComputedStyle(document.documentElement).fontSize)),
    ).toBeGreaterThanOrEqual(32);
    const clashes = await page.evaluate(() => {
      const boxes = [...document.querySelectorAll('.panel, .toolbar, .legend, .caption, .tabs')]
        .filter((element) => element.checkVisibility())
        .map((element) => ({ name: element.className, ...element.getBoundingClientRect().toJSON() }));
      const found = boxes
        .filter(
          ({ left, right, top, bottom }) =>
            left < -0.5 || right > innerWidth + 0.5 || top < -4.5 || bottom > innerHeight + 0.5,
        )
        .map(({ name }) => `${name} outside`);
      for (const [i, a] of boxes.entries()) {
        for (const b of boxes.slice(i + 1)) {
          const [x, y] = [
            Math.min(a.right, b.right) - Math.max(a.left, b.left),
            Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top),
          ];
          if (x > 4 && y > 4) found.push(`${a.name} over ${b.name}`);
        }
      }
      return found;
    });
    expect(clashes).toEqual([]);
    expect((await scan(page)).violations).toEqual([]);
    await clean();
  });
}
