/**
 * The page without a network, and the change from one version of it to the next. Each test has a server of its own to
 * shut down.
 */
import { expect, test } from '@playwright/test';
import { createSite } from '../../server.js';
import { settled as settledBy, state } from './helpers.js';

/**
 * @import { Page } from '@playwright/test'
 * @import { AddressInfo } from 'node:net'
 */

test.use({ serviceWorkers: 'allow' });

/** As a visitor without a graphics card has the page. @param {Page} page */
const settled = (page) => settledBy(page, new URL(page.url()).searchParams.get('backend') ?? 'canvas2d');

/** What tells the second version from the first. */
const MARK = '<meta name="version" content="2">';

/**
 * Starts a server of the first version of the site, which can be exchanged for the second.
 * @returns {Promise<{ address: string, asked: string[], change: () => void, close: () => Promise<void> }>}
 */
async function host() {
  /** @type {string[]} */
  const asked = [];
  let isSecond = false;
  const server = createSite((name, content) => {
    asked.push(name);
    if (!isSecond) return content;
    if (name === 'index.html') return content.toString().replace('</head>', `${MARK}</head>`);
    // The revision of index.html is another one, as a build of the second version would write it.
    if (name === 'service-worker.js')
      return content.toString().replace(/(index\.html[^}]*revision:[^\w]*)\w{4}/, (_, before) => `${before}2222`);
    return content;
  });
  await new Promise((done) => server.listen(0, 'localhost', () => done(undefined)));
  const { port } = /** @type {AddressInfo} */ (server.address());
  return {
    address: `http://localhost:${port}/`,
    asked,
    change: () => {
      isSecond = true;
    },
    close: () =>
      new Promise((done) => {
        server.closeAllConnections();
        server.close(() => done());
      }),
  };
}

/** Opens the page and waits until all of it is stored. @param {Page} page @param {string} address */
async function openStored(page, address) {
  await page.goto(address);
  await settled(page);
  await page.waitForFunction(() => navigator.serviceWorker.controller?.state === 'activated');
}

/** @param {Page} page */
const isSecond = (page) => page.locator('meta[name="version"]').count();

for (const { place, tag } of [
  { place: '', tag: [] },
  { place: 'sub/path/', tag: ['@all'] },
]) {
  test(`after the first load the page needs no network, at /${place}`, { tag }, async ({ page }) => {
    const { address, asked, close } = await host();
    await openStored(page, `${address}${place}`);
    const { length } = asked;
    await close();
    await page.getByRole('combobox', { name: 'Group of surfaces' }).selectOption('Points');
    await page.locator('.tile[data-surface="bunny"]').click();
    await expect.poll(async () => (await state(page)).surface).toBe('bunny');
    await settled(page);
    const count = () => page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().count);
    expect(await count()).toBeGreaterThan(1000);
    // The address holds the state a little later.
    await page.waitForFunction(() => location.hash !== '');
    await page.reload();
    await settled(page);
    expect((await state(page)).surface).toBe('bunny');
    expect(await count()).toBeGreaterThan(1000);
    // Other ways of drawing, the editor, exports and pictures of the gallery were never asked for before.
    await page.goto(`${address}${place}?backend=webgl2`);
    await settled(page);
    await page.getByRole('textbox', { name: 'Formula' }).click();
    await expect(page.locator('.code-host')).toBeVisible();
    for (const img of await page.locator('.tile:visible img').all())
      await expect
        .poll(() => img.evaluate((image) => /** @type {HTMLImageElement} */ (image).naturalWidth))
        .toBeGreaterThan(0);
    expect(asked.length).toBe(length);
  });
}

test('the rest of the site is fetched after the first surface, and once', { tag: '@all' }, async ({ page }) => {
  const { address, asked, close } = await host();
  await page.addInitScript(() => {
    const { prototype } = ServiceWorkerContainer;
    const { register } = prototype;
    prototype.register = function (...words) {
      const store = /** @type {any} */ (window);
      store.particlesBefore = store.marchingParticles?.report()?.count ?? 0;
      return register.apply(this, words);
    };
  });
  await openStored(page, address);
  expect(await page.evaluate(() => /** @type {any} */ (window).particlesBefore)).toBeGreaterThan(1000);
  const of = (/** @type {RegExp} */ name) => asked.flatMap((file, i) => (name.test(file) ? [i] : []));
  const points = of(/points_bg.*\.wasm$/);
  expect(points).toHaveLength(1);
  expect(points[0]).toBeGreaterThan(of(/^service-worker\.js$/)[0]);
  await close();
});

test('a new version waits until it is asked for, and never mixes with the old one', { tag: '@all' }, async ({
  page,
  context,
}) => {
  const { address, asked, change, close } = await host();
  await openStored(page, address);
  const other = await context.newPage();
  await other.goto(address);
  await settled(other);
  await expect(page.locator('.toast')).toHaveCount(0);

  change();
  await page.evaluate(async () => void (await (await navigator.serviceWorker.ready).update()));
  const line = page.locator('.toast', { hasText: 'There is a new version of this page.' });
  await expect(line).toBeVisible();
  // Loaded again by other means, the page is still the old one, all of it, and says so again.
  const { length } = asked;
  await page.reload();
  await settled(page);
  expect(await isSecond(page)).toBe(0);
  expect(asked.slice(length).filter((name) => name !== 'service-worker.js')).toEqual([]);
  await expect(line).toBeVisible();

  await line.getByRole('button', { name: 'Reload' }).click();
  await expect.poll(() => isSecond(page).catch(() => 0)).toBe(1);
  await settled(page);
  await expect(line).toHaveCount(0);
  // The other page goes on, says that it is the old one, and is new when it is loaded again.
  expect(await isSecond(other)).toBe(0);
  const told = other.locator('.toast', { hasText: 'This one is no longer stored.' });
  await told.getByRole('button', { name: 'Reload' }).click();
  await expect.poll(() => isSecond(other).catch(() => 0)).toBe(1);
  await close();
});
