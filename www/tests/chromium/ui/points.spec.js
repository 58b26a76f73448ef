import { expect, test } from '@playwright/test';
import { afresh, COARSE, open, report, scan, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/**
 * A drag with a file, or with text.
 * @param {Page} page
 * @param {string} type
 * @param {{ name: string, text?: string, bytes?: number } | null} file
 */
const drag = (page, type, file) =>
  page.evaluate(
    ({ type, file }) => {
      const transfer = new DataTransfer();
      if (file) transfer.items.add(new File([file.bytes ? new Uint8Array(file.bytes) : (file.text ?? '')], file.name));
      else transfer.items.add('words', 'text/plain');
      const target = document.querySelector('.preview') ?? document.body;
      const event = new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true });
      target.dispatchEvent(event);
      return event.defaultPrevented;
    },
    { type, file },
  );

/** Points on a sphere, with their normals, as an ASCII PLY file. @param {number} count */
function spherePly(count) {
  const golden = Math.PI * (3 - Math.sqrt(5));
  const rows = Array.from({ length: count }, (_, i) => {
    const z = 1 - (2 * i + 1) / count;
    const [x, y] = [Math.cos(golden * i), Math.sin(golden * i)].map((v) => v * Math.sqrt(1 - z * z));
    const normal = [x, y, z].map((v) => v.toFixed(6));
    return [...normal, ...normal].join(' ');
  });
  const properties = ['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `property float ${name}`).join('\n');
  return `ply\nformat ascii 1.0\nelement vertex ${count}\n${properties}\nend_header\n${rows.join('\n')}\n`;
}

const dropped = async (
  /** @type {Page} */ page,
  /** @type {{ name: string, text?: string, bytes?: number }} */ file,
) => {
  await drag(page, 'dragover', file);
  await drag(page, 'drop', file);
};

/** The menu of the gallery's groups. @param {Page} page */
const groups = (page) => page.getByRole('combobox', { name: 'Group of surfaces' });

test('files: dropped, chosen, refused, given up', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  await test.step('a file dragged over the page is shown where it may be dropped, with the formats and the limit', async () => {
    await page.emulateMedia({ reducedMotion: 'reduce' });
    const overlay = page.locator('.drop');
    await expect(overlay).toBeHidden();
    await drag(page, 'dragenter', null);
    expect(await drag(page, 'dragover', null)).toBe(false);
    await expect(overlay).toBeHidden();
    await drag(page, 'dragenter', { name: 'a.ply' });
    expect(await drag(page, 'dragover', { name: 'a.ply' })).toBe(true);
    await expect(overlay).toBeVisible();
    for (const word of ['PLY', 'OBJ', 'STL', 'XYZ', '50']) await expect(overlay).toContainText(word);
    expect((await scan(page)).violations).toEqual([]);
    await drag(page, 'dragleave', { name: 'a.ply' });
    await expect(overlay).toBeHidden();
  });

  await test.step('a file too large is refused at once, with the reason and what to do, and the surface stays', async () => {
    await page.emulateMedia({ reducedMotion: 'reduce' });
    await afresh(page, { width: 1440, height: 900, hash: COARSE });
    const { digest } = await report(page);
    await dropped(page, { name: 'statue.ply', bytes: 51_000_000 });
    const box = page.locator('.refused');
    await expect(box).toContainText('statue.ply could not be used');
    await expect(box).toContainText('50');
    await expect(
      page.locator('.loading ~ [role=status], [role=status].visually-hidden', {
        hasText: 'statue.ply could not be used',
      }),
    ).toHaveCount(1);
    await expect(page.locator('.toast')).toHaveCount(0);
    expect((await report(page)).digest).toBe(digest);
    expect((await scan(page)).violations).toEqual([]);
    await page.locator('.tile[data-surface="sphere"]').click();
    await expect(box).toBeHidden();
  });

  await test.step('what is on its way shows its stage', async () => {
    await page.emulateMedia({ reducedMotion: 'reduce' });
    await afresh(page, { width: 1440, height: 900, hash: COARSE });
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.loading.value = { id: 'bunny', name: 'Bunny', label: 'Solving', fraction: 0.42 };
    });
    const bar = page.getByRole('progressbar', { name: 'Loading Bunny' });
    await expect(bar).toHaveAttribute('aria-valuenow', '42');
    await expect(page.locator('.loading')).toContainText('Solving');
    await expect(page.getByRole('button', { name: 'Cancel' })).toBeVisible();
    expect((await scan(page)).violations).toEqual([]);
    await page.evaluate(() => {
      /** @type {any} */ (window).marchingParticles.engine.loading.value = null;
    });
  });

  await test.step('a model given up on its way leaves the surface as it was', async () => {
    await afresh(page, { hash: COARSE });
    const before = await state(page);
    const { digest } = await report(page);
    await page.evaluate(
      () =>
        new Promise((/** @type {(done: void) => void} */ resolve) => {
          const { engine } = /** @type {any} */ (window).marchingParticles;
          // Pressed in the page itself: from here a press could come late.
          const off = engine.loading.subscribe((/** @type {any} */ loading) => {
            if (loading)
              setTimeout(() => {
                off();
                /** @type {HTMLElement | null} */ (document.querySelector('.loading .button'))?.click();
                resolve();
              });
          });
          /** @type {HTMLElement} */ (document.querySelector('.tile[data-surface="bunny"]')).click();
        }),
    );
    await expect(page.locator('.loading')).toBeHidden();
    await settled(page);
    expect((await state(page)).surface).toBe(before.surface);
    expect((await report(page)).digest).toBe(digest);
    await expect(page.locator('.refused')).toBeHidden();
  });

  await test.step('a fault in a file is told with its line, in the open and to a screen reader', async () => {
    await afresh(page, { width: 390, height: 844, hash: COARSE });
    const lines = spherePly(300).split('\n');
    lines[20] = '0.1 seven 0.3 0 0 1';
    await dropped(page, { name: 'ball.ply', text: lines.join('\n') });
    const box = page.locator('.refused');
    await expect(box).toContainText(/line 21/i);
    await expect(box).toContainText('The surface before it stays');
    await page.getByRole('navigation', { name: 'Panels' }).getByRole('button', { name: 'Sampling' }).click();
    await dropped(page, { name: 'empty.ply', text: '' });
    // The panel that would say it is not in sight: a notice does.
    await expect(page.locator('.toast')).toContainText('empty.ply');
  });
  await clean();
});

test('keys alone open the chooser for files', { tag: '@all' }, async ({ page }) => {
  // Asked for before there is anything to press, so that the browser knows in time.
  const chosen = page.waitForEvent('filechooser');
  await open(page);
  await page.getByRole('button', { name: 'Open file…' }).focus();
  await page.keyboard.press('Enter');
  const chooser = await chosen;
  // The voxels of an image may be beside its header.
  expect(chooser.isMultiple()).toBe(true);
  const accepted = await page.locator('input[type=file]').getAttribute('accept');
  for (const type of ['.ply', '.nii.gz']) expect(accepted).toContain(type);
});

test('a model is sampled, tells of its points, and one press leads back to the formula', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  const { formula } = await state(page);
  const [model] = await page.evaluate(
    () => /** @type {any} */ (window).marchingParticles.engine.description.value.models,
  );
  await groups(page).selectOption('Points');
  await page.locator(`.tile[data-surface="${model.id}"]`).click();
  await expect(page.locator('.story')).toContainText(model.name);
  await settled(page);
  expect((await report(page)).count).toBeGreaterThan(1000);
  const points = page.getByRole('button', { name: 'Show points' });
  for (const [width, height, colorScheme] of /** @type {const} */ ([
    [1440, 900, 'light'],
    [390, 844, 'dark'],
  ])) {
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ colorScheme });
    await expect(page.locator('.story')).toContainText(model.credit);
    await expect(page.locator('.story')).toContainText(`${model.points} points`);
    const facts = page.locator('.model .facts');
    for (const word of ['Normals', 'Condition number', 'Mean distance', '95 % are nearer', 'Largest distance'])
      await expect(facts).toContainText(word);
    await expect(page.locator('.model')).toContainText(`f interpolates all ${model.points} points`);
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveValue('model');
    await expect(points).toHaveAttribute('aria-pressed', 'true');
    await points.click();
    expect((await state(page)).view.points).toBe(false);
    expect((await scan(page)).violations).toEqual([]);
    await points.click();
  }
  await page.getByRole('button', { name: 'Back to the formula' }).click();
  await settled(page);
  expect((await state(page)).formula).toBe(formula);
  await expect(points).toBeHidden();
  await page.getByRole('button', { name: 'Undo', exact: true }).click();
  await expect(page.locator('.story')).toContainText(model.name);
  await settled(page);
  await clean();
});

test('a formula cuts a model and keeps it as long as it names it', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  const heading = page.getByRole('heading', { name: 'ball.ply' });
  const fault = page.locator('#formula-fault');
  const grab = page.getByRole('button', { name: 'Grab', exact: true });
  await dropped(page, { name: 'ball.ply', text: spherePly(300) });
  await expect(heading).toBeVisible();
  await settled(page);
  await expect(grab).toBeVisible();

  await test.step('the name of the model is in the field, and a part of the ball is cut off by a plane with a slider', async () => {
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveValue('model');
    await typeFormula(page, 'max(model, z - h)');
    await page.keyboard.press('Enter');
    await page.locator('.row[data-parameter="h"]').getByRole('spinbutton').fill('0');
    await page.keyboard.press('Enter');
    await settled(page);
    expect((await report(page)).quality.area / (3 * Math.PI)).toBeCloseTo(1, 1);
    await expect(heading).toBeVisible();
    await expect(page.locator('.preview math')).toContainText('model');
    await expect(grab).toBeHidden();
    expect((await scan(page)).violations).toEqual([]);
  });

  await test.step('a mistake is marked with what to write, and the surface before it stays', async () => {
    const { digest } = await report(page);
    await typeFormula(page, '2model');
    await expect(fault).toContainText('max(model, z)');
    await expect(page.locator('.code-host .cm-fault')).toBeVisible();
    await settled(page);
    expect((await report(page)).digest).toBe(digest);
    await expect(heading).toBeVisible();
  });

  await test.step('typed letter by letter it is the model again', async () => {
    await page.keyboard.press('ControlOrMeta+a');
    await page.keyboard.type('abs(model) - 0.1', { delay: 5 });
    await settled(page);
    expect(await state(page)).toMatchObject({ surface: 'file', formula: 'abs(model) - 0.1' });
    await expect(fault).toBeEmpty();
    // Two spheres.
    expect((await report(page)).components).toBe(2);
  });

  await test.step('a formula without the name leaves the model, and undo brings both back', async () => {
    await page.waitForTimeout(900);
    await typeFormula(page, 'x^2 + y^2 + z^2 = 1');
    await settled(page);
    await expect(heading).toBeHidden();
    const undo = page.getByRole('button', { name: 'Undo', exact: true });
    // The camera has turned to the sphere, which is a step of its own.
    for (let k = 0; k < 3 && (await state(page)).surface !== 'file'; k += 1) {
      await undo.click();
      await settled(page);
    }
    await expect(heading).toBeVisible();
    expect(await state(page)).toMatchObject({ surface: 'file', formula: 'abs(model) - 0.1' });
  });

  await clean();
});

test('a link holds the formula of a model of the gallery', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await groups(page).selectOption('Points');
  await page.locator('.tile[data-surface="bunny"]').click();
  await settled(page);
  await typeFormula(page, 'max(model, x - 0.1)');
  await settled(page);
  const { digest } = await report(page);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await afresh(page, { width: 1440, height: 900 });
  expect((await state(page)).surface).toBe('ellipsoid');
  await afresh(page, { width: 1440, height: 900, hash: new URL(link).hash });
  expect(await state(page)).toMatchObject({ surface: 'bunny', formula: 'max(model, x - 0.1)' });
  expect((await report(page)).digest).toBe(digest);
  await clean();
});

test('a file and the number of its points', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('a dropped file becomes the surface, keeps a tile of its own, and is there again among the points', async () => {
    await dropped(page, { name: 'ball.ply', text: spherePly(300) });
    await expect(page.getByRole('heading', { name: 'ball.ply' })).toBeVisible();
    await settled(page);
    const { quality } = await report(page);
    expect(quality.area / (4 * Math.PI)).toBeCloseTo(1, 1);
    await expect(page.locator('.model .facts')).toContainText('given');
    await groups(page).selectOption('Closed');
    await page.locator('.tile[data-surface="torus"]').click();
    await settled(page);
    await groups(page).selectOption('Points');
    await page.locator('.tile[data-surface="file"]').click();
    await settled(page);
    await expect(page.getByRole('heading', { name: 'ball.ply' })).toBeVisible();
  });

  await test.step('another number of points is fitted on request, kept in links, and taken back', async () => {
    await afresh(page, { width: 1440, height: 900 });
    await dropped(page, { name: 'ball.ply', text: spherePly(900) });
    await expect(page.getByRole('heading', { name: 'ball.ply' })).toBeVisible();
    await settled(page);
    await expect(page.locator('.model > .quiet')).toContainText('A smooth surface through 900 points');
    await page.locator('.model .details > summary').click();
    const fitted = page.locator('.model .details > .quiet');
    await expect(fitted).toContainText('f is fitted to 900 points, with 200 as centres');
    await expect(page.locator('.story')).toContainText('The surface that is fitted to the points of this file.');
    const slider = page.getByRole('slider', { name: 'Centres' });
    const number = page.getByRole('spinbutton', { name: 'Centres, number' });
    await number.fill('350');
    await number.press('Enter');
    await expect(fitted).toContainText('f is fitted to 900 points, with 350 as centres');
    await settled(page);
    expect((await state(page)).centres).toBe(350);
    // Changes of one value within 0.8 s are one step of the history.
    await page.waitForTimeout(900);
    await slider.press('Home');
    await expect(fitted).toContainText('f is fitted to 900 points, with 100 as centres');
    await page.getByRole('button', { name: 'Undo', exact: true }).click();
    await expect(fitted).toContainText('f is fitted to 900 points, with 350 as centres');
    await settled(page);
    // Of a model there are no more than it has, and a link holds the number.
    await groups(page).selectOption('Points');
    await page.locator('.tile[data-surface="bunny"]').click();
    await expect(fitted).toContainText('f interpolates all 200 points');
    await settled(page);
    expect(await number.getAttribute('aria-valuemax')).toBe('200');
    await number.fill('120');
    await number.press('Enter');
    await expect(fitted).toContainText('f is fitted to 200 points, with 120 as centres');
    await settled(page);
    // The address bar follows after a pause.
    const isInAddress = () =>
      page.evaluate(async () => {
        const shared = await /** @type {any} */ (window).marchingParticles.link();
        return new URL(shared).hash === location.hash;
      });
    await expect.poll(isInAddress).toBe(true);
    await page.reload();
    await settled(page);
    await expect(fitted).toContainText('f is fitted to 200 points, with 120 as centres');
  });
  await clean();
});
