import { expect, test } from '@playwright/test';
import { afresh, atRest, COARSE, open, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

const undo = (/** @type {Page} */ page) => page.getByRole('button', { name: 'Undo', exact: true });
const redo = (/** @type {Page} */ page) => page.getByRole('button', { name: 'Redo', exact: true });

test('the history', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900, hash: COARSE });
  await test.step('surface, formula and settings are undone and redone, by buttons and by keys', async () => {
    await expect(undo(page)).toBeHidden();
    const { formula } = await state(page);
    await page.locator('.tile[data-surface="torus"]').click();
    await settled(page);
    await page.getByRole('radio', { name: 'Adaptive' }).check();
    await typeFormula(page, 'x^2 + y^2 + z^2 = 0.3');
    await undo(page).click();
    await expect.poll(async () => (await state(page)).surface).toBe('torus');
    expect((await state(page)).settings.sampling).toBe('adaptive');
    await expect(page.getByRole('textbox', { name: 'Formula' })).toContainText('sqrt');
    await page.locator('#canvas-host').focus();
    await page.keyboard.press('Control+z');
    await expect.poll(async () => (await state(page)).settings.sampling).toBeUndefined();
    await page.keyboard.press('Control+z');
    await expect.poll(async () => (await state(page)).formula).toBe(formula);
    await expect(undo(page)).toHaveAttribute('aria-disabled', 'true');
    await page.keyboard.press('Control+Shift+z');
    await expect.poll(async () => (await state(page)).surface).toBe('torus');
    await redo(page).click();
    await redo(page).click();
    await expect.poll(async () => (await state(page)).formula).toBe('x^2 + y^2 + z^2 = 0.3');
    await settled(page);
  });

  await test.step('a drag is undone at once, however long it pauses', async () => {
    await afresh(page, { hash: COARSE });
    const range = page.locator('.row[data-parameter] input[type=range]').first();
    const { x, y, width, height } = (await range.boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
    const to = (/** @type {number} */ share) => page.mouse.move(x + share * width, y + height / 2, { steps: 3 });
    await to(0.5);
    await page.mouse.down();
    for (const share of [0.6, 0.7]) {
      await to(share);
      // Longer than the pause by which typing and keys become steps of their own.
      await page.waitForTimeout(1000);
    }
    await page.mouse.up();
    await settled(page);
    expect((await state(page)).parameters).not.toEqual({});
    await undo(page).click();
    expect((await state(page)).parameters).toEqual({});
  });

  await test.step('another surface that comes back is seen with all its levels', async () => {
    await afresh(page, { hash: COARSE });
    await page.locator('.tile[data-surface="torus"]').click();
    await settled(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ level: 3 }));
    await undo(page).click();
    await settled(page);
    expect((await state(page)).view.level).toBe(null);
  });

  await test.step('in a text field the keys undo the typing, not the page', async () => {
    await afresh(page, { hash: COARSE });
    await page.locator('.tile[data-surface="sphere"]').click();
    await settled(page);
    const box = page.locator('.setting[data-setting="radius_share"] input[role=spinbutton]');
    await box.focus();
    await page.keyboard.press('Control+z');
    expect((await state(page)).surface).toBe('sphere');
  });

  await test.step('five hundred steps back end at the first state and harm nothing', async () => {
    await afresh(page, { hash: COARSE });
    const first = await state(page);
    await page.evaluate(async () => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      for (let i = 1; i <= 30; i += 1) engine.setSetting(i % 2 ? 'relax_steps' : 'seed', i);
    });
    await page.evaluate(() => {
      const press = (/** @type {boolean} */ shiftKey) =>
        document.body.dispatchEvent(
          new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, shiftKey, bubbles: true, cancelable: true }),
        );
      for (let i = 0; i < 500; i += 1) press(false);
      for (let i = 0; i < 500; i += 1) press(true);
      for (let i = 0; i < 500; i += 1) press(false);
    });
    await settled(page);
    expect((await state(page)).settings).toEqual(first.settings);
    expect((await state(page)).surface).toBe(first.surface);
  });
  await clean();
});

test('what is undone while it is typed is seen as it was, and can be redone', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await page.locator('.tile[data-surface="torus"]').click();
  await settled(page);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.orbit(0.7, 0.2));
  const angles = async () => {
    const { yaw, pitch } = (await state(page)).view.camera;
    return [yaw, pitch];
  };
  await atRest(page);
  const before = await angles();
  await typeFormula(page, 'x^2 + y^2 + z^2 = 0.3');
  await undo(page).click();
  await expect.poll(async () => (await state(page)).formula).toContain('sqrt');
  await settled(page);
  // A fit follows the end of a run.
  await page.waitForTimeout(500);
  await atRest(page);
  expect(await angles()).toEqual(before);
  await expect(redo(page)).toHaveAttribute('aria-disabled', 'false');
  await clean();
});

test('Back leads from surface to surface, each as it was seen, and at last leaves the page', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  /** Waits until the address holds the state. */
  const written = () =>
    expect
      .poll(() =>
        page.evaluate(
          async () =>
            (await /** @type {any} */ (window).marchingParticles.link()) ===
            location.origin + location.pathname + location.hash,
        ),
      )
      .toBe(true);
  const length = () => page.evaluate(() => history.length);
  const shown = async () => {
    await settled(page);
    const { surface, formula, parameters, view } = await state(page);
    return { surface, formula, parameters, yaw: Number(view.camera.yaw.toFixed(4)), theme: view.theme };
  };
  const first = await length();
  await page.locator('.tile[data-surface="torus"]').click();
  await settled(page);
  await expect.poll(length).toBe(first + 1);
  await written();
  // A turn, a slider and the theme are no surfaces.
  await page.evaluate(() => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    engine.orbit(0.4, 0);
    engine.setParameter('r', 0.2);
  });
  await settled(page);
  await written();
  expect(await length()).toBe(first + 1);
  const torus = await shown();
  expect(torus.parameters).toEqual({ r: 0.2 });
  // However often the typing pauses, a formula is one surface until it has stood.
  await typeFormula(page, 'x^2 + y^2 +');
  await written();
  await page.keyboard.type(' z^2 = 1');
  await settled(page);
  await expect
    .poll(() => page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.trial.value))
    .toBe('none');
  await written();
  expect(await length()).toBe(first + 2);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ theme: 'dark' }));
  await written();
  await page.goBack();
  await expect.poll(async () => (await state(page)).surface).toBe('torus');
  // The theme is the reader's.
  expect(await shown()).toEqual({ ...torus, theme: 'dark' });
  await page.goForward();
  await expect.poll(async () => (await state(page)).formula).toBe('x^2 + y^2 + z^2 = 1');
  // Twice at once.
  await page.evaluate(() => {
    history.back();
    history.back();
  });
  await expect.poll(async () => (await state(page)).surface).toBe('ellipsoid');
  await settled(page);
  await page.goBack();
  expect(page.url()).toBe('about:blank');
  await clean();
});

test('a surface that is chosen while the page opens is an entry after the first', { tag: '@all' }, async ({ page }) => {
  await page.goto('./?backend=canvas2d');
  const first = await page.evaluate(async () => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    while (engine.state.value.surface === '') await new Promise((go) => setTimeout(go));
    engine.setSurface('torus');
    return history.length;
  });
  await settled(page);
  await expect.poll(() => page.evaluate(() => history.length)).toBe(first + 1);
  await page.goBack();
  await expect.poll(async () => (await state(page)).surface).toBe('ellipsoid');
});
