/** The page as a visitor meets it in a browser with WebGL2 only: the first load, input, the address, a lost context. */
import { expect, test } from '@playwright/test';
import {
  askingFor,
  atRest,
  coarse,
  counts,
  expectCanvasShown,
  expectSurface,
  link,
  open,
  picture,
  status,
} from './browser.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {string} expression  of `p`, the console interface @returns {Promise<any>} */
const on = (page, expression) =>
  page.evaluate(`(async () => { const p = window.marchingParticles; return ${expression}; })()`);

for (const place of ['/', '/sub/path/']) {
  test(`the ellipsoid appears by itself at ${place}, and nobody else is asked for anything`, async ({ page }) => {
    const { errors, strangers } = await open(page, place);
    await expectSurface(page);
    await expectCanvasShown(page);
    const report = /** @type {any} */ (await on(page, 'p.report()'));
    expect(report.count).toBeGreaterThan(1000);
    expect(report.stop_reason).toBe('complete');
    expect(report.quality.six_neighbours).toBeGreaterThan(0.9);
    for (const phase of ['generation', 'relaxation', 'quality']) expect(report.seconds[phase]).toBeGreaterThan(0);
    expect(strangers).toEqual([]);
    expect(errors).toEqual([]);
  });
}

test('without storage the page works as ever', { tag: '@all' }, async ({ page }) => {
  await page.addInitScript(() => {
    for (const name of ['localStorage', 'sessionStorage', 'indexedDB', 'caches']) {
      Object.defineProperty(window, name, {
        get() {
          throw new DOMException('storage is denied', 'SecurityError');
        },
      });
    }
  });
  const { errors } = await open(page);
  await expectSurface(page);
  // What the page would keep is kept as long as it is open.
  await page.keyboard.press('?');
  const shortcuts = page.getByRole('dialog').getByRole('checkbox');
  await shortcuts.uncheck();
  await expect(shortcuts).not.toBeChecked();
  expect(errors).toEqual([]);
  expect((await status(page)).notice).toBe(null);
});

test('a visit: what the page forbids itself, input, links, files, and a lost context', async ({ page }) => {
  await open(page);
  await test.step('nothing is drawn while nothing happens', async () => {
    await atRest(page);
    const { frames } = await counts(page);
    await page.waitForTimeout(700);
    expect((await counts(page)).frames).toBe(frames);
  });

  await test.step('a drag turns the surface, a wheel comes nearer, F shows all of it again', async () => {
    const camera = async () => /** @type {any} */ (await on(page, 'p.engine.state.value.view.camera'));
    const host = page.locator('#canvas-host');
    // The part that no panel covers.
    const [x, y] = await page.evaluate(() => {
      const hostElement = document.querySelector('#canvas-host');
      for (let v = 0.1; v < 0.9; v += 0.1) {
        for (let u = 0.1; u < 0.9; u += 0.1) {
          const at = [innerWidth * u, innerHeight * v];
          if (hostElement?.contains(document.elementFromPoint(at[0], at[1]))) return at;
        }
      }
      return [0, 0];
    });
    const before = await camera();
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 5 });
    await page.mouse.up();
    await expect.poll(async () => (await camera()).yaw).not.toBe(before.yaw);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -300);
    await expect.poll(async () => (await camera()).distance).toBeLessThan(before.distance * 0.9);
    const near = await camera();
    expect(near.fit).toBe(false);
    await host.focus();
    await page.keyboard.press('f');
    await expect.poll(async () => (await camera()).fit).toBe(true);
    await expect.poll(async () => (await camera()).distance).toBeGreaterThan(near.distance * 1.1);
  });

  await test.step('a lost pointer ends the drag', async () => {
    const [turned, after] = await page.evaluate(async () => {
      const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const fire = (/** @type {string} */ type, /** @type {number} */ x) =>
        host.dispatchEvent(
          new PointerEvent(type, { pointerId: 7, clientX: x, clientY: 100, button: 0, isPrimary: true, bubbles: true }),
        );
      // The state follows the camera with a delay.
      const settledYaw = async () => {
        for (let last = NaN; ; ) {
          const { yaw } = engine.state.value.view.camera;
          if (yaw === last) return yaw;
          last = yaw;
          await new Promise((resolve) => setTimeout(resolve, 300));
        }
      };
      const before = await settledYaw();
      fire('pointerdown', 100);
      fire('pointermove', 140);
      fire('pointercancel', 140);
      const yaw = await settledYaw();
      fire('pointermove', 240);
      return [yaw - before, (await settledYaw()) - yaw];
    });
    expect(turned).not.toBe(0);
    expect(after).toBe(0);
  });

  await test.step('pointing at the middle tells of the particle there', async () => {
    await atRest(page);
    const hover = /** @type {any} */ (
      await page.evaluate(() => {
        const { engine } = /** @type {any} */ (window).marchingParticles;
        const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
        // The mouse still points elsewhere.
        engine.dismissHover();
        engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
        const [x, y] = [host.clientWidth / 2, host.clientHeight / 2];
        const { left, top } = host.getBoundingClientRect();
        host.dispatchEvent(
          new PointerEvent('pointermove', {
            pointerId: 1,
            pointerType: 'mouse',
            clientX: x + left,
            clientY: y + top,
            bubbles: true,
          }),
        );
        return new Promise((resolve) => {
          const stop = engine.hover.subscribe((/** @type {any} */ value) => {
            if (value)
              setTimeout(() => {
                stop();
                resolve({ ...value, picked: engine.pick(x, y) });
              });
          });
        });
      })
    );
    expect(hover.index).toBe(hover.picked);
    expect(hover.valence).toBeGreaterThanOrEqual(3);
    expect(hover.residual).toBeLessThan(1e-3);
    expect(Math.hypot(...hover.normal)).toBeCloseTo(1, 4);
  });

  await test.step('a file PNG is the picture, at any size and on no ground', async () => {
    const image = /** @type {any} */ (
      await page.evaluate(async () => {
        const p = /** @type {any} */ (window).marchingParticles;
        const blob = await p.engine.savePng({ width: 300, height: 200, transparent: true });
        const bitmap = await createImageBitmap(blob);
        const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
        const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext('2d'));
        context.drawImage(bitmap, 0, 0);
        const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
        let solid = 0;
        for (let i = 3; i < data.length; i += 4) if (data[i] > 250) solid += 1;
        return {
          type: blob.type,
          width: bitmap.width,
          height: bitmap.height,
          corner: data[3],
          solid: solid / (bitmap.width * bitmap.height),
        };
      })
    );
    expect(image).toMatchObject({ type: 'image/png', width: 300, height: 200, corner: 0 });
    expect(image.solid).toBeGreaterThan(0.1);
    expect(image.solid).toBeLessThan(0.8);
  });

  await test.step('a link is read when the address changes, and changes leave no trail for the Back button', async () => {
    await page.evaluate(
      (hash) => {
        location.hash = hash;
      },
      link({ surface: 'torus', settings: { radius_share: 0.02 } }),
    );
    await expect.poll(async () => (await on(page, 'p.state')).surface).toBe('torus');
    const before = await page.evaluate(() => history.length);
    for (const value of [0.7, 0.8, 0.9]) {
      const hash = await page.evaluate(() => location.hash);
      await page.evaluate((a) => /** @type {any} */ (window).marchingParticles.set({ parameters: { a } }), value);
      await expect.poll(() => page.evaluate(() => location.hash)).not.toBe(hash);
    }
    expect(await page.evaluate(() => history.length)).toBe(before);
  });

  await test.step('markup in a link is text only', async () => {
    const formula = '<img src=x onerror="window.hit=1">';
    await page.evaluate((hash) => {
      location.hash = hash;
    }, link({ formula }));
    await expect.poll(async () => (await status(page)).fieldError).not.toBe(null);
    expect(await page.evaluate(() => document.querySelectorAll('img[src="x"]').length + Number('hit' in window))).toBe(
      0,
    );
    await on(page, 'p.set({ surface: "ellipsoid" })');
  });

  await test.step('a canvas of no size and back again draws', async () => {
    const host = page.locator('#canvas-host');
    await host.evaluate((element) => {
      element.style.display = 'none';
    });
    await page.waitForTimeout(100);
    await host.evaluate((element) => {
      element.style.display = '';
    });
    await page.setViewportSize({ width: 333, height: 257 });
    await page.waitForTimeout(200);
    await expectSurface(page);
    await expectCanvasShown(page);
  });

  await test.step('a lost WebGL context is replaced, with the same picture', async () => {
    const before = await picture(page);
    // The notice goes after a while: it is looked for from the beginning.
    const isTold = page.waitForFunction(() =>
      /** @type {any} */ (window).marchingParticles.status().notice?.text.includes('is back'),
    );
    await page.evaluate(() => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
      canvas.getContext('webgl2')?.getExtension('WEBGL_lose_context')?.loseContext();
    });
    await isTold;
    expect((await counts(page)).opened).toBe(2);
    const after = await picture(page);
    expect(after.drawn).toBeCloseTo(before.drawn, 2);
    await expect(page.locator('#canvas-host canvas')).toHaveCount(1);
  });

  await test.step('a device that the page destroys itself is not mended', async () => {
    const { opened } = await counts(page);
    await on(page, 'p.debug.loseDevice("destroyed")');
    await page.waitForTimeout(1500);
    expect((await counts(page)).opened).toBe(opened);
  });

  await test.step('the page forbids itself every other host', async () => {
    const policy = await page.locator('meta[http-equiv="Content-Security-Policy"]').getAttribute('content');
    expect(policy).toContain("default-src 'none'");
    expect(policy).toContain("connect-src 'self'");
    const refused = await page.evaluate(
      () =>
        new Promise((resolve) => {
          document.addEventListener('securitypolicyviolation', (event) => resolve(event.violatedDirective), {
            once: true,
          });
          fetch('https://example.org/').catch(() => {});
        }),
    );
    expect(refused).toBe('connect-src');
  });
});

test('a picture whose device is lost, or whose renderer traps, while it is read back is refused', {
  tag: '@all',
}, async ({ page }) => {
  await open(page);
  const ends = await page.evaluate(async () => {
    const p = /** @type {any} */ (window).marchingParticles;
    const told = (/** @type {Promise<unknown>} */ promise) => promise.then(String, (error) => error.message);
    const opened = async (/** @type {number} */ count) => {
      while (p.debug.counts().opened < count) await new Promise((resolve) => setTimeout(resolve, 50));
    };
    const ends = [];
    const context = () =>
      /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas')).getContext('webgl2');
    let reading = p.pixels(400, 300);
    context()?.getExtension('WEBGL_lose_context')?.loseContext();
    ends.push(await told(reading));
    await opened(2);
    // The renderer asks for a fence before it reads. What is thrown there leaves it in the state of a panic.
    const { prototype } = WebGL2RenderingContext;
    const { fenceSync } = prototype;
    prototype.fenceSync = () => {
      throw new Error('no fence');
    };
    reading = p.pixels(400, 300);
    ends.push(await told(reading));
    prototype.fenceSync = fenceSync;
    await opened(3);
    return ends;
  });
  expect(ends).toEqual(['the graphics device is lost', 'the graphics device is lost']);
  await expectSurface(page);
});

test.describe('on a screen with four pixels to one', () => {
  test.use({ deviceScaleFactor: 4 });
  test('two are drawn', { tag: '@all' }, async ({ page }) => {
    await open(page);
    const [drawn, seen] = await page.evaluate(() => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
      return [canvas.width, canvas.getBoundingClientRect().width];
    });
    expect(drawn).toBeLessThanOrEqual(2 * seen + 1);
    expect(drawn).toBeGreaterThanOrEqual(seen);
    await expectSurface(page);
  });
});

test('the core is fetched once: what the page preloads is what it uses, also for the worker that replaces another', {
  tag: '@all',
}, async ({ page }) => {
  let fetched = 0;
  await page.route('**/core_bg*.wasm', async (route) => {
    fetched += 1;
    await route.continue();
  });
  const { errors } = await open(page, `./faults/${link(coarse)}`);
  await page.evaluate(() => new BroadcastChannel('faults').postMessage('panic'));
  await expect.poll(async () => (await counts(page)).restarts).toBe(1);
  await on(page, 'p.run()');
  expect(fetched).toBe(1);
  expect(await page.locator('link[rel="preload"][as="fetch"]').count()).toBe(1);
  expect(errors.filter((text) => text.includes('preload'))).toEqual([]);
});

test('a core that is missing is named, and another try helps', { tag: '@all' }, async ({ page }) => {
  await page.route('**/core_bg*.wasm', (route) => route.fulfill({ status: 404, body: 'not found' }));
  await page.goto(askingFor('/', 'webgl2'));
  await expect(page.getByText(/is not on the server: it answers 404/)).toBeVisible();
  await page.unroute('**/core_bg*.wasm');
  await page.getByRole('button', { name: 'Try again' }).click();
  await expect.poll(async () => (await status(page)).progress.phase).toBe('done');
  expect((await status(page)).backend).toBe('webgl2');
});

test('until the renderer has come the surface is painted without it', { tag: '@all' }, async ({ page }) => {
  let send = () => {};
  const asked = new Promise((resolve) => {
    send = () => resolve(null);
  });
  await page.route('**/render_bg*.wasm', async (route) => {
    await asked;
    await route.continue();
  });
  await page.goto(askingFor(`./${link(coarse)}`, 'webgl2'));
  await expect.poll(async () => (await status(page))?.progress.phase).toBe('done');
  expect((await status(page)).backend).toBe('starting');
  await expectSurface(page);
  await expect(page.locator('#poster')).toHaveClass(/gone/);
  send();
  await expect.poll(async () => (await status(page)).backend).toBe('webgl2');
  await atRest(page);
  await expect(page.locator('#canvas-host canvas')).toHaveCount(1);
  await expectSurface(page);
});
