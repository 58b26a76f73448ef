/** The examples of the package on the site: each works, and its code is the file that runs. */
import { readFileSync } from 'node:fs';
import { expect, test } from '@playwright/test';

const codeOf = (/** @type {string} */ name) =>
  readFileSync(new URL(`../../embed/examples/${name}`, import.meta.url), 'utf8').trimEnd();

/** Faults of the page, its policy's among them. @param {import('@playwright/test').Page} page */
function faultsOf(page) {
  /** @type {string[]} */
  const faults = [];
  page.on('pageerror', ({ message }) => faults.push(message));
  page.on('console', (message) => void (message.type() === 'error' && faults.push(message.text())));
  return faults;
}

test('the examples run, under the policy of the page, with their code beside them', { tag: '@all' }, async ({
  page,
}) => {
  const faults = faultsOf(page);
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.goto('./embed/');
  await expect(page.locator('body')).toHaveAttribute('data-filled');
  await expect(page.locator('.error')).toHaveCount(0);
  const code = await page.locator('pre').allTextContents();
  const names = ['sphere.html', 'gyroid.js', 'function.js', 'slider.html', 'slider.js', 'download.html', 'download.js'];
  expect(code).toEqual(names.map(codeOf));
  for (const id of ['gyroid', 'function']) await expect(page.locator(`#${id} canvas`)).toBeVisible();

  // The pictures fill their stages, also when the window gets smaller.
  const widths = () =>
    page
      .locator('.stage')
      .evaluateAll((stages) =>
        stages.map(({ clientWidth, firstElementChild: canvas }) => [clientWidth, canvas?.clientWidth]),
      );
  for (const width of [1200, 500]) {
    await page.setViewportSize({ width, height: 800 });
    await expect.poll(async () => (await widths()).every(([stage, canvas]) => stage === canvas)).toBe(true);
  }

  const knot = page.locator('#knot');
  await knot.scrollIntoViewIfNeeded();
  const reported = () => knot.evaluate((/** @type {any} */ { report }) => report?.components ?? null);
  await expect.poll(reported).toBe(8);
  await page.locator('#a').fill('0.5');
  await expect(knot).toHaveAttribute('params', 'a=0.5');
  await expect
    .poll(() => knot.evaluate((/** @type {any} */ { view, report }) => report && view.state.parameters.a))
    .toBe(0.5);

  // Those in sight are painted without a graphics card.
  expect(
    await page.evaluate(() =>
      [...document.querySelectorAll('marching-particles')].flatMap(({ view }) => view?.backend ?? []),
    ),
  ).toEqual(['canvas2d', 'canvas2d']);
  const [file] = await Promise.all([page.waitForEvent('download'), page.locator('#download').click()]);
  expect(file.suggestedFilename()).toBe('cushion.glb');
  const bytes = readFileSync(await file.path());
  expect(bytes.subarray(0, 4).toString()).toBe('glTF');
  await expect(page.locator('#facts')).toContainText('triangles, volume');
  expect(faults).toEqual([]);
});
