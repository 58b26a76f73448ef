/** The page as a visitor meets it in a browser with WebGL2 only: first load, links, faults, files. */
import { readFileSync } from 'node:fs';
import { expect, test } from '@playwright/test';
import { atRest, coarse, counts, expectCanvasShown, expectSurface, link, open, picture, status } from './browser.js';

/** @import { Page, Route } from '@playwright/test' */

/** @param {Page} page @param {string} expression  of `p`, the console interface */
const on = (page, expression) =>
  page.evaluate(`(async () => { const p = window.marchingParticles; return ${expression}; })()`);

for (const place of ['/', '/sub/path/']) {
  test(`the ellipsoid appears by itself at ${place}, and nobody else is asked for anything`, async ({ page }) => {
    const { errors, strangers } = await open(page, place);
    expect((await status(page)).backend).toBe('webgl2');
    await expectSurface(page);
    await expectCanvasShown(page);
    const report = /** @type {any} */ (await on(page, 'p.report()'));
    expect(report.count).toBeGreaterThan(1000);
    expect(report.stop_reason).toBe('complete');
    expect(report.quality.six).toBeGreaterThan(0.9);
    for (const phase of ['generation', 'relaxation', 'quality']) expect(report.seconds[phase]).toBeGreaterThan(0);
    expect(strangers).toEqual([]);
    expect(errors).toEqual([]);
  });
}

test('the page forbids itself every other host', async ({ page }) => {
  await open(page);
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

test('without storage the page works as ever', async ({ page }) => {
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

test('the same state gives the same particles as the native core', async ({ page }) => {
  const { runs } = JSON.parse(readFileSync(new URL('../../../tests/golden/digests.json', import.meta.url), 'utf8'));
  expect(runs.length).toBeGreaterThan(0);
  await open(page);
  for (const { name, field, settings, digest, count } of runs) {
    const state = { parameters: {}, bounds: null, ...field, declared: field.declare ?? [], settings };
    const report = /** @type {any} */ (
      await page.evaluate((patch) => /** @type {any} */ (window).marchingParticles.set(patch), state)
    );
    expect({ name, digest: report.digest, count: report.count }).toEqual({ name, digest, count });
  }
});

test('nothing is drawn while nothing happens', async ({ page }) => {
  await open(page);
  await atRest(page);
  const { frames } = await counts(page);
  await page.waitForTimeout(700);
  expect((await counts(page)).frames).toBe(frames);
});

test('a drag turns the surface, a wheel comes nearer, F shows all of it again', async ({ page }) => {
  await open(page);
  const camera = async () => /** @type {any} */ (await on(page, 'p.engine.state.value.view.camera'));
  const host = page.locator('#canvas-host');
  const box = /** @type {{x: number, y: number, width: number, height: number}} */ (await host.boundingBox());
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
  expect((await camera()).fit).toBe(false);
  await host.focus();
  await page.keyboard.press('f');
  await expect.poll(async () => (await camera()).fit).toBe(true);
  expect(box.width).toBeGreaterThan(0);
});

test('a lost pointer ends the drag', async ({ page }) => {
  await open(page);
  const after = await page.evaluate(async () => {
    const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const fire = (/** @type {string} */ type, /** @type {number} */ x) =>
      host.dispatchEvent(
        new PointerEvent(type, { pointerId: 7, clientX: x, clientY: 100, button: 0, isPrimary: true, bubbles: true }),
      );
    fire('pointerdown', 100);
    fire('pointermove', 140);
    fire('pointercancel', 140);
    // The state follows the camera with a delay.
    const settledYaw = async () => {
      for (let last = NaN; ; ) {
        const { yaw } = engine.state.value.view.camera;
        if (yaw === last) return yaw;
        last = yaw;
        await new Promise((resolve) => setTimeout(resolve, 300));
      }
    };
    const yaw = await settledYaw();
    fire('pointermove', 240);
    return (await settledYaw()) - yaw;
  });
  expect(after).toBe(0);
});

test('pointing at the middle tells of the particle there', async ({ page }) => {
  await open(page);
  const hover = /** @type {any} */ (
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const host = /** @type {HTMLElement} */ (document.querySelector('#canvas-host'));
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

test.describe('links', () => {
  test('bring back surface, settings and view', async ({ page }) => {
    await open(
      page,
      `/${link({ surface: 'torus', settings: { radius_share: 0.02 }, view: { colour: 'valence', theme: 'dark' } })}`,
    );
    const state = /** @type {any} */ (await on(page, 'p.state'));
    expect(state).toMatchObject({
      surface: 'torus',
      settings: { radius_share: 0.02 },
      view: { colour: 'valence', theme: 'dark' },
    });
    const report = /** @type {any} */ (await on(page, 'p.report()'));
    expect(report.quality.euler).toBe(0);
    const shared = String(await on(page, 'p.link()'));
    await page.evaluate(() => history.replaceState(null, '', '#'));
    await page.evaluate((hash) => {
      location.hash = hash;
    }, new URL(shared).hash);
    await expect.poll(async () => /** @type {any} */ (await on(page, 'p.state')).surface).toBe('torus');
  });

  /**
   * What the page says of a link. On a slow machine it is gone before the surface is there, for which this waits.
   * @param {Page} page
   * @param {string} address
   */
  async function noticeOf(page, address) {
    await page.goto(address);
    const notice = await page.waitForFunction(() => {
      const said = /** @type {any} */ (window).marchingParticles?.status().notice;
      return said?.id === 'link' && said.text;
    });
    const text = await notice.jsonValue();
    await on(page, 'p.ready.then(() => 0)');
    return text;
  }

  test('with a mistake in them say what was reset, and the page works', async ({ page }) => {
    const text = await noticeOf(page, `/${link({ surface: 'nowhere', settings: { radius_share: 9 } })}`);
    expect(text).toContain('surface');
    expect(text).toContain('radius_share');
  });

  test('that are broken lead to the standard surface', async ({ page }) => {
    expect(await noticeOf(page, '/#v99.j.AAAA')).toContain('another version');
    expect(/** @type {any} */ (await on(page, 'p.state')).surface).toBe('ellipsoid');
  });

  test('to what cannot be had leave the surface before, whole, with its figures and files', async ({ page }) => {
    await open(page);
    const { count } = /** @type {any} */ (await on(page, 'p.report()'));
    for (const [state, sign] of /** @type {[object, string][]} */ ([
      [{ ...coarse, formula: 'x^2 +' }, 'fieldError'],
      [{ settings: { radius_share: 0.0005 } }, 'notice'],
    ])) {
      await page.evaluate((hash) => {
        location.hash = hash;
      }, link(state));
      await expect.poll(async () => (await status(page))[sign]).toBeTruthy();
      await expect.poll(async () => (await status(page)).busy).toBe(false);
      expect((await status(page)).dimmed).toBe(true);
      expect(await on(page, 'p.report().count')).toBe(count);
      expect(await on(page, 'p.particles().count')).toBe(count);
      expect(
        await on(
          page,
          'p.engine.exportFile("csv").then((blob) => blob.text()).then((text) => text.trim().split("\\n").length)',
        ),
      ).toBeGreaterThan(count);
    }
  });

  test('to what cannot be had leave the surface before in view, also where their box is smaller', async ({ page }) => {
    await open(page);
    const before = await picture(page);
    await page.evaluate(
      (hash) => {
        location.hash = hash;
      },
      link({ ...coarse, formula: 'x^2 +', bounds: { min: [0.4, -0.1, -0.1], max: [0.6, 0.1, 0.1] } }),
    );
    await expect.poll(async () => (await status(page)).fieldError).toBeTruthy();
    // Nothing of it is cut off, and the camera shows it as it did.
    await expect.poll(async () => (await picture(page)).drawn).toBeCloseTo(before.drawn, 2);
  });

  test('carry markup as text only', async ({ page }) => {
    const formula = '<img src=x onerror="window.hit=1">';
    await open(page, `/${link({ ...coarse, formula })}`);
    expect((await status(page)).fieldError).not.toBe(null);
    expect(await page.evaluate(() => document.querySelectorAll('img[src="x"]').length + Number('hit' in window))).toBe(
      0,
    );
  });
});

test.describe('a sampler that fails', () => {
  for (const fault of ['panic', 'overflow', 'hang']) {
    test(`by ${fault} is replaced, with the state intact`, async ({ page }) => {
      await open(page);
      const before = await on(page, 'p.state');
      await on(page, `p.debug.${fault}()`);
      if (fault === 'hang') await on(page, '(p.engine.setParameter("a", 1.25), 0)');
      await expect
        .poll(async () => (await status(page)).notice?.id, { timeout: 15_000 })
        .toBe(fault === 'hang' ? 'hang' : 'panic');
      expect((await counts(page)).restarts).toBe(1);
      const report = /** @type {any} */ (await on(page, 'p.run()'));
      expect(report.count).toBeGreaterThan(500);
      const { notice } = await status(page);
      expect(notice.details).toContain('Marching Particles');
      if (fault !== 'hang') expect(await on(page, 'p.state')).toEqual(before);
      await expectSurface(page);
    });
  }

  test('by hanging twice on the same input settles what waits for it', async ({ page }) => {
    await open(page);
    const kinds = await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const kinds = [];
      for (const fault of [true, true, false]) {
        if (fault) p.debug.hang();
        await p.run();
        kinds.push(p.status().notice?.kind);
      }
      return kinds;
    });
    // The first time the run is made again; the second time it is given up, until it is asked for.
    expect(kinds.slice(0, 2)).toEqual(['warn', 'error']);
    await expectSurface(page);
  });

  test('four times in a minute is left alone until it is asked for again', async ({ page }) => {
    await open(page);
    for (let k = 1; k <= 4; k += 1) {
      await on(page, 'p.debug.panic()');
      await expect.poll(async () => (await counts(page)).restarts).toBe(k);
    }
    await expect.poll(async () => (await status(page)).notice.id).toBe('safe-mode');
    await expectSurface(page);
    await on(page, '(p.engine.notice.value.action.run(), 0)');
    await expect.poll(async () => (await status(page)).progress.phase).toBe('done');
    expect((await status(page)).notice).toBe(null);
  });
});

test('a stop keeps the partial surface, says so, and does not wait for the picture', async ({ page }) => {
  await open(page);
  const outcome = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      let isDrawn = false;
      // So many steps that it does not end before the stop, and few enough particles for a slow machine to draw.
      void p
        .set({ settings: { max_particles: 1_000_000, radius_share: 0.001, relax_steps: 1000 } })
        .then(() => (isDrawn = true));
      await new Promise((resolve) => {
        let isAsked = false;
        const off = p.engine.progress.subscribe((/** @type {any} */ v) => {
          if (isAsked || v.phase !== 'generation' || v.particles === 0) return;
          isAsked = true;
          p.stop().then(resolve);
          setTimeout(() => off());
        });
      });
      return {
        isDrawn,
        partial: p.engine.partial.value,
        count: p.particles().count,
        reason: p.engine.progress.value.stop_reason,
      };
    })
  );
  expect(outcome).toMatchObject({ isDrawn: false, partial: true, reason: 'cancelled' });
  expect(outcome.count).toBeGreaterThan(0);
});

test('a message of an old run changes nothing', async ({ page }) => {
  await open(page);
  const before = await status(page);
  await on(page, 'p.debug.stale(0)');
  const after = await status(page);
  expect(after.progress).toEqual(before.progress);
  expect((await counts(page)).stale).toBeGreaterThan(0);
});

test('a slider dragged at 120 Hz ends at its last value, with one surface on screen', async ({ page }) => {
  await open(page);
  const end = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      for (let k = 0; k < 120; k += 1) {
        p.engine.setParameter('a', 0.6 + 0.005 * k, { live: true });
        await new Promise((resolve) => setTimeout(resolve, 8));
      }
      p.engine.setParameter('a', 1.2);
      await new Promise((resolve) => {
        const off = p.engine.report.subscribe((/** @type {any} */ report) => {
          if (report) setTimeout(() => resolve(off()));
        });
      });
      const { positions, count } = p.particles();
      let widest = 0;
      for (let i = 0; i < count; i += 1) widest = Math.max(widest, Math.abs(positions[3 * i]));
      return { widest, drag: p.engine.lastDrag.value, queued: p.engine.busy.value };
    })
  );
  expect(end.widest).toBeCloseTo(1.2, 1);
  expect(end.drag.shown).toBeGreaterThan(0);
  expect(end.drag.shown).toBeLessThanOrEqual(end.drag.requested);
  expect(end.queued).toBe(false);
});

test('a mistake in the formula keeps the last surface, dimmed; mending it brings it back', async ({ page }) => {
  await open(page);
  const clear = await picture(page);
  await on(page, '(p.engine.setFormula("x^2 +"), 0)');
  await expect.poll(async () => (await status(page)).fieldError?.message).toBeTruthy();
  expect(/** @type {any} */ (await on(page, 'p.particles().count'))).toBeGreaterThan(500);
  await on(page, '(p.engine.setFormula("x^2 + y^2 + z^2 = 0.5"), 0)');
  await expect.poll(async () => (await status(page)).fieldError).toBe(null);
  await expect.poll(async () => (await status(page)).progress.phase).toBe('done');
  expect((await picture(page)).drawn).not.toBe(clear.drawn);
});

test('a formula without a surface leaves the last one, dimmed, says why, and takes nothing for its own', async ({
  page,
}) => {
  await open(page);
  await on(page, '(p.engine.setFormula("x^2 + y^2 + z^2 + 1"), 0)');
  await expect.poll(async () => (await status(page)).empty).toBe(true);
  expect((await status(page)).progress.message).toBeTruthy();
  expect((await status(page)).dimmed).toBe(true);
  // The camera stays with the last surface.
  expect((await picture(page)).drawn).toBeGreaterThan(0.09);
  expect(await on(page, 'p.particles().count')).toBe(0);
  expect(await on(page, 'p.engine.exportFile("csv").then(() => "written", () => "refused")')).toBe('refused');
  // Also a mistake after that, and an editor emptied.
  for (const text of ['x^2 +', '']) {
    await on(page, `(p.engine.setFormula(${JSON.stringify(text)}), 0)`);
    await expect.poll(async () => (await status(page)).fieldError).toBeTruthy();
    expect((await status(page)).dimmed).toBe(true);
  }
  await on(page, '(p.engine.setFormula("x^2 + y^2 + z^2 = 1"), 0)');
  await expect.poll(async () => (await status(page)).dimmed).toBe(false);
  expect((await status(page)).empty).toBe(false);
});

test('a lost WebGL context is replaced, with the same picture', async ({ page }) => {
  await open(page);
  const before = await picture(page);
  await page.evaluate(() => {
    const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
    canvas.getContext('webgl2')?.getExtension('WEBGL_lose_context')?.loseContext();
  });
  await expect.poll(async () => (await counts(page)).opened).toBe(2);
  await expect.poll(async () => (await status(page)).notice?.text).toContain('is back');
  const after = await picture(page);
  expect(after.drawn).toBeCloseTo(before.drawn, 2);
  await expect(page.locator('#canvas-host canvas')).toHaveCount(1);
});

test('a device that the page destroys itself is not mended', async ({ page }) => {
  await open(page);
  await on(page, 'p.debug.loseDevice("destroyed")');
  await page.waitForTimeout(1500);
  expect((await counts(page)).opened).toBe(1);
});

test('a canvas of no size and back again draws', async ({ page }) => {
  await open(page);
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

test.describe('on a screen with four pixels to one', () => {
  test.use({ deviceScaleFactor: 4 });
  test('two are drawn', async ({ page }) => {
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

test('changes leave no trail for the Back button', async ({ page }) => {
  await open(page);
  const before = await page.evaluate(() => history.length);
  for (const value of [0.7, 0.8, 0.9]) {
    await page.evaluate((a) => /** @type {any} */ (window).marchingParticles.set({ parameters: { a } }), value);
    await expect.poll(() => page.evaluate(() => location.hash)).not.toBe('');
  }
  await page.waitForTimeout(700);
  expect(await page.evaluate(() => history.length)).toBe(before);
});

test.describe('files', () => {
  test('PLY and CSV hold every particle', async ({ page }) => {
    await open(page);
    const files = /** @type {any} */ (
      await page.evaluate(async () => {
        const p = /** @type {any} */ (window).marchingParticles;
        const text = new TextDecoder('latin1').decode(await (await p.engine.exportFile('ply')).arrayBuffer());
        const csv = await (await p.engine.exportFile('csv')).text();
        return {
          count: p.particles().count,
          header: text.slice(0, text.indexOf('end_header')),
          csv: csv.trimEnd().split('\n').length,
          names: csv.slice(0, csv.indexOf('\n')).split(','),
          columns: p.engine.description.value.columns.map((/** @type {{name: string}} */ { name }) => name),
          values: csv
            .split('\n')[1]
            .split(',')
            .filter((/** @type {string} */ cell) => cell !== '' && Number.isFinite(Number(cell))).length,
        };
      })
    );
    expect(files.header).toContain(`element vertex ${files.count}\n`);
    expect(files.header).toContain('property uchar valence');
    expect(files.names).toEqual(files.columns);
    expect(files.values).toBe(files.columns.length);
    expect(files.csv).toBe(files.count + 1);
  });

  test('PNG is the picture, at any size and on no ground', async ({ page }) => {
    await open(page);
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
});

test.describe('a sampler that does not load', () => {
  /** @type {[string, (route: Route) => Promise<void>, RegExp][]} */
  const faults = [
    ['is missing', (route) => route.fulfill({ status: 404, body: 'not found' }), /404/],
    ['is blocked', (route) => route.abort('blockedbyclient'), /could not be fetched/],
    [
      'is damaged',
      (route) =>
        route.fulfill({ contentType: 'application/wasm', body: Buffer.from([0, 97, 115, 109, 1, 0, 0, 0, 255, 1]) }),
      /damaged/,
    ],
    [
      'is a page',
      (route) => route.fulfill({ contentType: 'text/html', body: '<!doctype html><title>Hello</title>' }),
      /page in its place/,
    ],
  ];
  for (const [what, answer, words] of faults) {
    test(`because its file ${what} is named, and another try helps`, async ({ page }) => {
      await page.route('**/core_bg*.wasm', answer);
      await page.goto('/');
      await page.waitForFunction(() => /** @type {any} */ (window).marchingParticles?.status().notice?.id === 'load');
      expect((await status(page)).notice.text).toMatch(words);
      await page.unroute('**/core_bg*.wasm');
      await on(page, '(p.engine.notice.value.action.run(), 0)');
      await expect.poll(async () => (await status(page)).progress.phase).toBe('done');
    });
  }

  test('because the browser has no SIMD says which browsers have it', async ({ page }) => {
    await page.addInitScript(() => {
      WebAssembly.validate = () => false;
    });
    await page.goto('/');
    const words = page.getByText(/lacks WebAssembly SIMD.*Chrome.*Firefox.*Safari/);
    await expect(words).toBeVisible();
    expect((await status(page)).notice).toMatchObject({ id: 'load', kind: 'error' });
  });

  test('is fetched once: what the page preloads is what it uses, also for the worker that replaces another', async ({
    page,
  }) => {
    let fetched = 0;
    await page.route('**/core_bg*.wasm', async (route) => {
      fetched += 1;
      await route.continue();
    });
    const { errors } = await open(page);
    await on(page, 'p.debug.panic()');
    await expect.poll(async () => (await counts(page)).restarts).toBe(1);
    await on(page, 'p.run()');
    expect(fetched).toBe(1);
    expect(await page.locator('link[rel="preload"][as="fetch"]').count()).toBe(1);
    expect(errors.filter((text) => text.includes('preload'))).toEqual([]);
  });

  test('under a wrong media type loads all the same', async ({ page }) => {
    await page.route('**/core_bg*.wasm', async (route) => {
      const response = await route.fetch();
      await route.fulfill({ response, headers: { ...response.headers(), 'content-type': 'application/octet-stream' } });
    });
    await open(page);
    await expectSurface(page);
  });
});
