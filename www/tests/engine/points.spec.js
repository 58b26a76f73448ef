/** Surfaces from points: built-in models and files, their dots, their links, and what can go wrong with them. */
import { expect, test } from '@playwright/test';
import { counts, expectCanvasShown, expectSurface, link, open, spots, status } from './browser.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page @param {string} expression  of `p`, the console interface */
const on = (page, expression) =>
  page.evaluate(`(async () => { const p = window.marchingParticles; return ${expression}; })()`);
/** @param {Page} page @param {object} patch @returns {Promise<any>} */
const set = (page, patch) => page.evaluate((p) => /** @type {any} */ (window).marchingParticles.set(p), patch);
const bunny = { surface: 'bunny', settings: { radius_share: 0.015 } };

/** A PLY of points with normals on a sphere of this radius. @param {number} n @param {number} radius */
function spherePly(n, radius) {
  const rows = Array.from({ length: n }, (_, i) => {
    const z = 1 - (2 * i + 1) / n;
    const s = Math.sqrt(1 - z * z);
    const turn = i * 2.399963229728653;
    const normal = [s * Math.cos(turn), s * Math.sin(turn), z];
    return [...normal.map((v) => v * radius), ...normal].map((v) => v.toFixed(6)).join(' ');
  });
  const names = ['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `property float ${name}`);
  return ['ply', 'format ascii 1.0', `element vertex ${n}`, ...names, 'end_header', ...rows, ''].join('\n');
}
/**
 * Opens a file by the console interface and gives the report.
 * @param {Page} page
 * @param {string} name
 * @param {string} text
 * @returns {Promise<any>}
 */
const openFile = (page, name, text) =>
  page.evaluate(
    ([file, content]) => /** @type {any} */ (window).marchingParticles.open(new File([content], file)),
    [name, text],
  );

/** Counts the workers of the page by name. @param {Page} page */
const countWorkers = (page) =>
  page.addInitScript(() => {
    /** @type {any} */ (window).started = {};
    const Plain = window.Worker;
    window.Worker = class extends Plain {
      /** @param {string | URL} url @param {WorkerOptions} [options] */
      constructor(url, options = {}) {
        super(url, options);
        const { started } = /** @type {any} */ (window);
        started[options.name ?? ''] = (started[options.name ?? ''] ?? 0) + 1;
      }
    };
  });

test('the bunny is solved when it is chosen, drawn with its points, and there at once the second time', async ({
  page,
}) => {
  await countWorkers(page);
  const { errors, strangers } = await open(page);
  expect(await page.evaluate(() => /** @type {any} */ (window).started.points)).toBe(undefined);
  const report = await set(page, bunny);
  expect(report.stop_reason).toBe('complete');
  expect(report.count).toBeGreaterThan(300);
  expect(report.components).toBe(1);
  const { model } = await status(page);
  expect(model).toMatchObject({
    name: expect.stringContaining('bunny'),
    points: 200,
    centres: 200,
    credit: expect.stringContaining('Stanford'),
  });
  await expectSurface(page);
  await expectCanvasShown(page);

  const dotted = await spots(page);
  await on(page, 'p.engine.setView({ points: false })');
  const plain = await spots(page);
  expect(dotted.black).toBeGreaterThan(plain.black + 100);
  expect(/** @type {any} */ (await on(page, 'p.state')).view.points).toBe(false);

  await set(page, { surface: 'ellipsoid' });
  expect((await status(page)).model).toBe(null);
  const again = await set(page, bunny);
  expect(again.digest).toBe(report.digest);
  expect(await page.evaluate(() => /** @type {any} */ (window).started.points)).toBe(1);
  expect(strangers).toEqual([]);
  expect(errors).toEqual([]);
});

test('the points of a model stay on it when it turns, and keep their size when it comes nearer', async ({ page }) => {
  await open(page);
  await set(page, { ...bunny, view: { size: 0.2, colour: 'plain', theme: 'dark' } });
  // White dots on a dark ground: with discs this small nearly all the white is theirs.
  const near = async (/** @type {number} */ factor) => {
    await on(page, `p.engine.zoom(${factor})`);
    await page.waitForTimeout(100);
    return (await spots(page)).white;
  };
  const [home, nearer, back] = [await near(1), await near(1.6), await near(1 / 1.6)];
  expect(home).toBeGreaterThan(300);
  expect(nearer / home).toBeGreaterThan(0.4);
  expect(nearer / home).toBeLessThan(1.6);
  expect(back / home).toBeCloseTo(1, 1);
});

test('a model goes through a link, with its settings', async ({ page }) => {
  await open(page);
  const before = await set(page, { ...bunny, view: { colour: 'curvature', points: false } });
  const shared = String(await on(page, 'p.link()'));
  expect((await status(page)).notice).toBe(null);
  await page.goto('about:blank');
  await open(page, `/${new URL(shared).hash}`);
  expect(await on(page, 'p.state')).toMatchObject({
    surface: 'bunny',
    formula: '',
    settings: bunny.settings,
    view: { colour: 'curvature', points: false },
  });
  expect(/** @type {any} */ (await on(page, 'p.report()')).digest).toBe(before.digest);
});

test('a formula typed on a model leads back to formulas', async ({ page }) => {
  await open(page);
  await set(page, bunny);
  await on(page, '(p.engine.setFormula("x^2 + y^2 + z^2 = 0.5"), 0)');
  await expect.poll(async () => (await status(page)).model).toBe(null);
  await expect.poll(async () => (await status(page)).progress.phase).toBe('done');
  expect(await on(page, 'p.state')).toMatchObject({ surface: 'ellipsoid', formula: 'x^2 + y^2 + z^2 = 0.5' });
});

test('settings and the clip box of a model are sampled live', async ({ page }) => {
  await open(page);
  await set(page, bunny);
  const end = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const { bounds } = p.engine.field.value;
      const half = (bounds.min[2] + bounds.max[2]) / 2;
      for (let k = 0; k < 30; k += 1) {
        p.engine.setBounds(
          { min: bounds.min, max: [bounds.max[0], bounds.max[1], bounds.max[2] + ((half - bounds.max[2]) * k) / 29] },
          { live: true },
        );
        await new Promise((resolve) => setTimeout(resolve, 16));
      }
      p.engine.setBounds({ min: bounds.min, max: [bounds.max[0], bounds.max[1], half] });
      await new Promise((resolve) => {
        const off = p.engine.report.subscribe((/** @type {any} */ report) => {
          if (report) setTimeout(() => resolve(off()));
        });
      });
      const { positions, count } = p.particles();
      let highest = -Infinity;
      for (let i = 0; i < count; i += 1) highest = Math.max(highest, positions[3 * i + 2]);
      return { highest, half, drag: p.engine.lastDrag.value, count };
    })
  );
  expect(end.count).toBeGreaterThan(100);
  expect(end.highest).toBeLessThanOrEqual(end.half + 1e-4);
  expect(end.drag.shown).toBeGreaterThan(0);
});

test('the sampler replaced in the middle of a model samples it again', async ({ page }) => {
  await open(page);
  const before = await set(page, bunny);
  await on(page, 'p.debug.panic()');
  await expect.poll(async () => (await counts(page)).restarts).toBe(1);
  const after = /** @type {any} */ (await on(page, 'p.run()'));
  expect(after.digest).toBe(before.digest);
  expect((await status(page)).model).not.toBe(null);
});

test('a stop in a run on a model keeps what there is, and nobody takes it for a hang', async ({ page }) => {
  await open(page);
  await set(page, bunny);
  const out = /** @type {any} */ (
    await page.evaluate(async () => {
      const p = /** @type {any} */ (window).marchingParticles;
      // The page hears of the run only between two pictures, so it is long, and quick to draw.
      void p.set({ settings: { sampling: 'adaptive', chord_error: 5e-5, relax_steps: 100 } });
      await new Promise((resolve) => {
        const off = p.engine.progress.subscribe((/** @type {any} */ v) => {
          if (v.phase === 'generation' && v.particles > 200) setTimeout(() => resolve(off()));
        });
      });
      p.engine.stop();
      await new Promise((resolve) => {
        const off = p.engine.busy.subscribe((/** @type {boolean} */ busy) => {
          if (!busy) setTimeout(() => resolve(off()));
        });
      });
      return {
        partial: p.engine.partial.value,
        reason: p.engine.progress.value.stop_reason,
        count: p.particles().count,
      };
    })
  );
  expect(out).toMatchObject({ partial: true, reason: 'cancelled' });
  expect(out.count).toBeGreaterThan(200);
  expect((await counts(page)).restarts).toBe(0);
});

test.describe('a file', () => {
  test('of points is sampled where they are', async ({ page }) => {
    await open(page);
    const report = await openFile(page, 'ball.ply', spherePly(300, 1.5));
    expect(report.stop_reason).toBe('complete');
    expect(report.components).toBe(1);
    const far = /** @type {number[]} */ (
      await page.evaluate(() => {
        const { positions, count } = /** @type {any} */ (window).marchingParticles.particles();
        return Array.from({ length: count }, (_, i) =>
          Math.hypot(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]),
        );
      })
    );
    expect(Math.min(...far)).toBeGreaterThan(1.5 * 0.97);
    expect(Math.max(...far)).toBeLessThan(1.5 * 1.03);
    expect((await status(page)).model).toMatchObject({ name: 'ball.ply', points: 300, normals: 'given' });
    expect(/** @type {any} */ (await on(page, 'p.state')).surface).toBe('file');
    await expectSurface(page);
  });

  test('is not in a link: the page says so, and opens the standard surface with the settings', async ({ page }) => {
    await open(page);
    await openFile(page, 'ball.ply', spherePly(200, 1));
    const shared = String(await on(page, 'p.link()'));
    await page.goto('about:blank');
    await open(page, `/${new URL(shared).hash}`);
    expect((await status(page)).notice).toMatchObject({ id: 'link', text: expect.stringContaining('file') });
    expect(await on(page, 'p.state')).toMatchObject({ surface: 'ellipsoid', settings: { radius_share: 0.01 } });
  });

  /** @type {[string, string, string, number | null][]} */
  const broken = [
    [
      'with a word for a number',
      'word.ply',
      spherePly(150, 1).replace(/\n(\S+) (\S+) (\S+)/g, (row, x, _, z, at, all) =>
        all.slice(0, at).split('\n').length === 20 ? `\n${x} seven ${z}` : row,
      ),
      21,
    ],
    [
      'with NaN in it',
      'nan.ply',
      spherePly(150, 1)
        .split('\n')
        .map((row, k) => (k === 30 ? row.replace(/^\S+/, 'nan') : row))
        .join('\n'),
      31,
    ],
    ['that ends too soon', 'short.ply', spherePly(150, 1).split('\n').slice(0, 60).join('\n'), null],
    ['that is no such file', 'picture.ply', '\u0089PNG\r\n\u001a\n nothing of use', null],
    ['that is empty', 'empty.ply', '', null],
  ];
  for (const [what, name, text, line] of broken) {
    test(`${what} is refused with its place, and the picture stays`, async ({ page }) => {
      await open(page);
      const before = /** @type {any} */ (await on(page, 'p.report()'));
      const { frames } = await counts(page);
      await openFile(page, name, text);
      const { loadingError, loading, model } = await status(page);
      expect(loading).toBe(null);
      expect(model).toBe(null);
      expect(loadingError).toMatchObject({ id: 'file', name });
      expect(loadingError.message.length).toBeGreaterThan(10);
      if (line !== null) expect(loadingError.line).toBe(line);
      await expect(page.getByText(loadingError.message)).not.toHaveCount(0);
      expect(/** @type {any} */ (await on(page, 'p.report()')).digest).toBe(before.digest);
      expect(/** @type {any} */ (await on(page, 'p.state')).surface).toBe('ellipsoid');
      await expectSurface(page);
      expect((await counts(page)).frames).toBeGreaterThanOrEqual(frames);
    });
  }

  test('of two gigabytes is not even read', async ({ page }) => {
    await countWorkers(page);
    await open(page);
    await page.evaluate(() => {
      const file = new File(['x'], 'huge.ply');
      Object.defineProperty(file, 'size', { value: 2e9 });
      return /** @type {any} */ (window).marchingParticles.open(file);
    });
    expect((await status(page)).loadingError).toMatchObject({ kind: 'too_large', name: 'huge.ply' });
    expect(await page.evaluate(() => /** @type {any} */ (window).started.points)).toBe(undefined);
  });

  test('can be given up while it is read', async ({ page }) => {
    await open(page);
    const before = /** @type {any} */ (await on(page, 'p.report()'));
    await page.evaluate(
      (text) => {
        const { engine } = /** @type {any} */ (window).marchingParticles;
        void engine.openFile(new File([text], 'large.ply'));
        return new Promise((resolve) => setTimeout(resolve, 20));
      },
      spherePly(60_000, 1),
    );
    expect((await status(page)).loading).toMatchObject({ id: 'file', name: 'large.ply' });
    await on(page, 'p.engine.cancelLoading()');
    await expect.poll(async () => (await status(page)).loading).toBe(null);
    expect((await status(page)).notice).toBe(null);
    expect(/** @type {any} */ (await on(page, 'p.report()')).digest).toBe(before.digest);
  });
});

test('a solver that does not load is named, and the surface stays; without any surface the standard one comes', async ({
  page,
}) => {
  await page.route('**/points_bg*.wasm', (route) => route.fulfill({ status: 404, body: 'not found' }));
  await open(page);
  await on(page, '(p.engine.setSurface("bunny"), 0)');
  await expect.poll(async () => (await status(page)).loadingError?.kind).toBe('bundle');
  expect((await status(page)).loadingError.message).toContain('404');
  expect(/** @type {any} */ (await on(page, 'p.state')).surface).toBe('ellipsoid');
  await expectSurface(page);
  await page.goto('about:blank');
  await open(page, `/${link({ ...bunny })}`);
  expect(/** @type {any} */ (await on(page, 'p.state')).surface).toBe('ellipsoid');
  expect((await status(page)).loadingError).toMatchObject({ id: 'bunny', kind: 'bundle' });
  await expectSurface(page);
});
