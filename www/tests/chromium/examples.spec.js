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
    .poll(() => knot.evaluate((/** @type {any} */ { view, report }) => report && view.state.params.a))
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

/** Keeps how often each stage draws, by calls of WebGL2. @param {import('@playwright/test').Page} page */
const countDrawing = (page) =>
  page.addInitScript(() => {
    const drawn = /** @type {Record<string, number>} */ ({ gyroid: 0, function: 0 });
    Object.assign(window, { drawn });
    const { prototype } = WebGL2RenderingContext;
    for (const name of /** @type {const} */ (['drawArrays', 'drawElements', 'drawElementsInstanced'])) {
      const draw = /** @type {(...given: any[]) => void} */ (prototype[name]);
      prototype[name] = function (/** @type {any[]} */ ...given) {
        const { parentElement } = /** @type {HTMLCanvasElement} */ (this.canvas);
        drawn[parentElement?.id ?? ''] += 1;
        return draw.apply(this, given);
      };
    }
  });
/** @param {import('@playwright/test').Page} page @returns {Promise<Record<string, number>>} */
const drawn = (page) => page.evaluate(() => ({ .../** @type {any} */ (window).drawn }));
/** Waits for frames of the browser. @param {import('@playwright/test').Page} page */
const frames = (page) =>
  page.evaluate(async () => {
    for (let k = 0; k < 20; k += 1) await new Promise(requestAnimationFrame);
  });

test('what moves is drawn while it is in view, and the page can be photographed', async ({ page }) => {
  const faults = faultsOf(page);
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await countDrawing(page);
  await page.goto('./embed/');
  await expect(page.locator('body')).toHaveAttribute('data-filled');
  await page.locator('#gyroid').scrollIntoViewIfNeeded();
  const before = await drawn(page);
  await expect.poll(async () => (await drawn(page)).gyroid).toBeGreaterThan(before.gyroid + 1);
  expect((await page.screenshot()).length).toBeGreaterThan(1000);
  await page.locator('#download').scrollIntoViewIfNeeded();
  // The browser tells of it with its next frames.
  await frames(page);
  const hidden = await drawn(page);
  await frames(page);
  expect(await drawn(page)).toEqual(hidden);
  expect(faults).toEqual([]);
});

test('where frames take long, what turns by itself comes to rest', { tag: '@all' }, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await countDrawing(page);
  await page.addInitScript(() => {
    // Frames of a tenth of a second.
    window.requestAnimationFrame = (draw) => Number(setTimeout(() => draw(performance.now()), 100));
    window.cancelAnimationFrame = (handle) => clearTimeout(handle);
  });
  await page.goto('./embed/');
  await expect(page.locator('body')).toHaveAttribute('data-filled');
  await page.locator('#gyroid').scrollIntoViewIfNeeded();
  await expect.poll(async () => (await drawn(page)).gyroid).toBeGreaterThan(4);
  await expect
    .poll(async () => {
      const { gyroid } = await drawn(page);
      await frames(page);
      return (await drawn(page)).gyroid - gyroid;
    })
    .toBe(0);
});
