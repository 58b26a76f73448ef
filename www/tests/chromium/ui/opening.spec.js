/** The first picture: the surface grows from its seed before the eye. */
import { expect, test } from '@playwright/test';
import { atRest, open, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** Keeps the view of every frame of the opening, and what the address was given. @param {Page} page */
const watch = (page) =>
  page.addInitScript(() => {
    const seen = /** @type {{ camera: string, level: number, particles: number }[]} */ ([]);
    const hashes = /** @type {string[]} */ ([]);
    Object.assign(window, { seen, hashes });
    const { replaceState } = history;
    history.replaceState = (data, unused, url) => {
      if (String(url).includes('#')) hashes.push(String(url));
      replaceState.call(history, data, unused, url);
    };
    const look = () => {
      const { engine } = /** @type {any} */ (window).marchingParticles ?? {};
      const reveal = engine?.reveal.value;
      if (reveal?.particles > 0) {
        const { direction, eye } = engine.rayThrough(innerWidth / 2, innerHeight / 2);
        const camera = JSON.stringify([...direction, ...eye].map((v) => Number(v.toFixed(4))));
        seen.push({ camera, level: reveal.level, particles: reveal.particles });
      }
      requestAnimationFrame(look);
    };
    look();
  });

test('the surface grows level by level before a camera that stands still where the picture stays', {
  tag: '@all',
}, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await watch(page);
  const { clean } = await open(page);
  const seen = /** @type {{ camera: string, level: number, particles: number }[]} */ (
    await page.evaluate(() => /** @type {any} */ (window).seen)
  );
  // It is seen growing, however slow the machine: no frame adds more than a few levels.
  expect(new Set(seen.map(({ level }) => level)).size).toBeGreaterThan(15);
  for (let k = 1; k < seen.length; k += 1) expect(seen[k].particles).toBeGreaterThanOrEqual(seen[k - 1].particles);
  expect(new Set(seen.map(({ camera }) => camera)).size).toBe(1);
  await atRest(page);
  const { yaw, pitch, distance } = (await state(page)).view.camera;
  expect([yaw, pitch]).toEqual([0.62, 0.42]);
  // As large as a fit makes it.
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.fit());
  await atRest(page);
  expect((await state(page)).view.camera.distance).toBeCloseTo(distance, 4);
  // The address never holds a view that nobody chose: it is written half a second after a change.
  await page.waitForTimeout(700);
  expect(new URL(page.url()).hash).toBe('');
  expect(await page.evaluate(() => /** @type {any} */ (window).hashes)).toEqual([]);
  await clean();
});

for (const [width, height, tolerance] of /** @type {const} */ ([
  [1440, 900, 0.005],
  [1920, 1080, 0.005],
  [1024, 768, 0.01],
  [390, 844, 0.01],
  [360, 740, 0.01],
])) {
  test(`at ${width} by ${height} the poster has the outline of the picture that takes its place`, {
    tag: '@all',
  }, async ({ page }) => {
    const { clean } = await open(page, { width, height, folded: true });
    const { poster, picture } = await page.evaluate(async () => {
      const image = /** @type {HTMLImageElement} */ (document.querySelector('#poster'));
      const { left, top, width, height } = image.getBoundingClientRect();
      const canvas = new OffscreenCanvas(Math.ceil(width), Math.ceil(height));
      const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext('2d'));
      context.drawImage(image, 0, 0, width, height);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      const box = () => ({ left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity });
      const add = (/** @type {ReturnType<typeof box>} */ to, /** @type {number} */ x, /** @type {number} */ y) => {
        to.left = Math.min(to.left, x);
        to.right = Math.max(to.right, x);
        to.top = Math.min(to.top, y);
        to.bottom = Math.max(to.bottom, y);
      };
      const [poster, picture] = [box(), box()];
      for (let i = 3; i < data.length; i += 4) {
        const at = (i - 3) / 4;
        if (data[i] > 128) add(poster, left + (at % canvas.width) + 0.5, top + Math.floor(at / canvas.width) + 0.5);
      }
      const { engine } = /** @type {any} */ (window).marchingParticles;
      for (let i = 0; i < engine.columns.count; i += 1) {
        const { x, y } = engine.project(engine.columns.positions.subarray(3 * i, 3 * i + 3));
        add(picture, x, y);
      }
      return { poster, picture };
    });
    const size = picture.right - picture.left;
    for (const side of /** @type {const} */ (['left', 'top', 'right', 'bottom']))
      expect(Math.abs(poster[side] - picture[side]) / size, side).toBeLessThan(tolerance);
    await clean();
  });
}

test('the legend has the colours of the particles from the first frame that shows some', { tag: '@all' }, async ({
  page,
}) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await page.addInitScript(() => {
    const legends = /** @type {string[]} */ ([]);
    Object.assign(window, { legends });
    const look = () => {
      const p = /** @type {any} */ (window).marchingParticles;
      const scale = document.querySelector('.scale');
      if (p?.engine.reveal.value?.particles > 0 && scale)
        legends.push(scale.checkVisibility() ? (scale.textContent ?? '') : '');
      requestAnimationFrame(look);
    };
    look();
  });
  const { clean } = await open(page);
  const legends = await page.evaluate(() => /** @type {any} */ (window).legends);
  expect(legends.length).toBeGreaterThan(5);
  expect(legends.filter((/** @type {string} */ text) => text.includes('everywhere'))).toEqual([]);
  expect(legends.at(-1)).toContain('rings around the seed');
  expect(legends[Math.floor(legends.length / 2)]).toBe(legends.at(-1));
  await clean();
});

test('stays as it is where motion is reduced', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  const { yaw, pitch } = (await state(page)).view.camera;
  expect([yaw, pitch]).toEqual([0.62, 0.42]);
  await clean();
});

/** What can be pressed, typed into or dragged, as far as it is seen. */
const seenControls = () =>
  [...document.querySelectorAll('a[href], button, input, select, textarea, summary, [contenteditable]')]
    .filter((element) => {
      const { left, top, right, bottom } = element.getBoundingClientRect();
      return right > 0 && bottom > 0 && left < innerWidth && top < innerHeight && right - left > 0;
    })
    .filter((element) => {
      // What stands for an input that is not seen itself is.
      const shown = element.closest('label') ?? element;
      return shown.checkVisibility({ opacityProperty: true, visibilityProperty: true });
    })
    .map((element) => element.getAttribute('aria-label') ?? element.textContent?.trim());

test('at rest there are few controls in view; the others come with the pointer or the focus', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900, folded: true });
  await atRest(page);
  // Some browsers begin with the pointer over the picture.
  await page.mouse.move(60, 60);
  await page.waitForFunction(() => document.getAnimations().every(({ playState }) => playState !== 'running'));
  const atFirst = await page.evaluate(seenControls);
  expect(atFirst.length, atFirst.join(' · ')).toBeLessThanOrEqual(35);
  // The invitation: formula, sliders, gallery, timeline, a mesh.
  for (const name of [
    'Formula',
    'Semi-axis along x a',
    'Group of surfaces',
    'Sphere',
    'Timeline, by levels',
    'Play',
    'Make a mesh',
  ])
    expect(atFirst).toContain(name);
  for (const name of ['Run', 'Stop', 'Without relaxing', 'Relax one step', 'Uniform', 'Zoom in', 'First level'])
    expect(atFirst).not.toContain(name);

  const seen = async () => {
    await page.waitForFunction(() => document.getAnimations().every(({ playState }) => playState !== 'running'));
    return page.evaluate(seenControls);
  };
  await page.mouse.move(720, 400);
  expect(await seen()).toEqual(expect.arrayContaining(['Zoom in', 'Save picture', 'Export']));
  await page.locator('#panel-levels').hover();
  expect(await seen()).toEqual(expect.arrayContaining(['First level', 'Speed of the timeline']));
  await page.getByRole('slider', { name: 'Semi-axis along x a' }).focus();
  expect(await seen()).toContain('Play a');

  await test.step('Run is there while something waits to be run', async () => {
    const run = page.locator('#panel-sampling').getByRole('button', { name: 'Run', exact: true });
    await expect(run).toBeHidden();
    // A run that was stopped is not whole.
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.setSetting('radius_share', 0.001);
      return new Promise((resolve) => {
        const end = engine.progress.subscribe((/** @type {{particles: number}} */ { particles }) => {
          if (engine.status.value !== 'sampling' || particles < 100) return;
          queueMicrotask(() => resolve(end()));
          engine.stop();
        });
      });
    });
    await expect(run).toBeVisible();
  });

  await test.step('the sampling part has the rest', async () => {
    await page.getByRole('heading', { name: 'Sampling' }).click();
    for (const name of ['Run', 'Stop', 'Without relaxing', 'Relax one step'])
      await expect(page.locator('#panel-sampling').getByRole('button', { name, exact: true })).toBeVisible();
    await expect(page.getByRole('radio', { name: 'Adaptive' })).toBeVisible();
  });
  await clean();
});

test('after the first surface has grown, the first slider moves by itself, once', { tag: '@all' }, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await page.addInitScript(() => {
    const values = /** @type {number[]} */ ([]);
    Object.assign(window, { values });
    const look = () => {
      const { engine } = /** @type {any} */ (window).marchingParticles ?? {};
      const { a } = engine?.state.value.parameters ?? {};
      if (a !== undefined) values.push(a);
      requestAnimationFrame(look);
    };
    look();
  });
  const { clean } = await open(page, { invites: true });
  await expect(page.locator('.invite')).toHaveText('Drag a');
  const { parameters } = await state(page);
  await expect.poll(() => page.evaluate(() => /** @type {any} */ (window).values.length)).toBeGreaterThan(2);
  await expect.poll(async () => (await state(page)).parameters).toEqual({});
  await settled(page);
  expect(parameters.a ?? 1).toBeGreaterThan(0);
  // Nothing of it is left behind: no entry to undo, and no link.
  await expect(page.locator('#panel-field').getByRole('button', { name: 'Undo' })).toBeHidden();
  await page.waitForTimeout(700);
  expect(new URL(page.url()).hash).toBe('');
  await page.locator('#stage').click({ position: { x: 640, y: 20 } });
  await expect(page.locator('.invite')).toBeHidden();
  // The next visit is not invited.
  await page.reload();
  await settled(page);
  await page.waitForTimeout(300);
  await expect(page.locator('.invite')).toBeHidden();
  expect(await page.evaluate(() => /** @type {any} */ (window).values)).toEqual([]);
  await clean();
});

test('another surface is not invited to by the name of a parameter that it has not', { tag: '@all' }, async ({
  page,
}) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  const { clean } = await open(page, { invites: true });
  await expect(page.locator('.invite')).toHaveText('Drag a');
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ surface: 'tanglecube' }));
  expect((await state(page)).parameters).toEqual({});
  await expect(page.locator('.invite')).toBeHidden();
  await clean();
});
