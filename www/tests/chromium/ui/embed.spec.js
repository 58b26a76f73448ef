/** The picture alone, in a frame of another page. */
import { once } from 'node:events';
import { createServer } from 'node:http';
import { expect, test } from '@playwright/test';

test('a page with the picture in a frame sets its state, reads it and gets the report', { tag: '@all' }, async ({
  page,
  baseURL,
}) => {
  await page.setViewportSize({ width: 800, height: 600 });
  // Another port, so that the frame has an origin of its own.
  const src = `${baseURL}?backend=canvas2d&embed=caption`;
  const server = createServer((_, response) => {
    response.setHeader('content-type', 'text/html');
    response.end(`<!doctype html><iframe src="${src}" width="700" height="500"></iframe>`);
  }).listen(0, 'localhost');
  await once(server, 'listening');
  const { port } = /** @type {import('node:net').AddressInfo} */ (server.address());
  await page.addInitScript(() => {
    if (window.parent !== window) return;
    const got = /** @type {any[]} */ ([]);
    addEventListener('message', ({ data }) => got.push(data));
    const ask = (/** @type {object} */ message) =>
      new Promise((resolve) => {
        const id = got.length + Math.random();
        addEventListener('message', ({ data }) => data.id === id && resolve(data));
        document
          .querySelector('iframe')
          ?.contentWindow?.postMessage({ type: 'marching-particles', id, ...message }, '*');
      });
    Object.assign(window, { got, ask });
  });
  await page.goto(`http://localhost:${port}/`);
  const ask = (/** @type {object} */ message) =>
    page.evaluate((sent) => /** @type {any} */ (window).ask(sent), message);
  await expect.poll(() => page.evaluate(() => /** @type {any} */ (window).got[0]?.call)).toBe('ready');

  const set = await ask({ call: 'set', value: { surface: 'torus', settings: { radius_share: 0.01 } } });
  expect(set.value.quality.euler).toBe(0);
  expect((await ask({ call: 'get' })).value.surface).toBe('torus');
  expect((await ask({ call: 'report' })).value.digest).toBe(set.value.digest);
  const faulty = await ask({ call: 'set', value: { formula: 'x^2 +' } });
  expect(faulty).toMatchObject({ call: 'set', error: 'Something is missing at the end' });

  const frame = page.frameLocator('iframe');
  await expect(frame.locator('.caption')).toBeVisible();
  const { backend } = await frame
    .locator('body')
    .evaluate(() => /** @type {any} */ (window).marchingParticles.status());
  expect(backend).toBe('canvas2d');
  // Without panels the bar alone shows that it works.
  await expect(frame.locator('.framed-track .progress')).toHaveCount(1);
  await expect(frame.locator('.framed-track')).toBeVisible();
  for (const part of ['.panel-field', '.panel-report', '.panel-levels', '.toolbar', '.legend', '.unhide'])
    await expect(frame.locator(part)).toBeHidden();
  server.close();
});
