import { expect, test } from '@playwright/test';
import { link } from '../engine/browser.js';
import { afresh, atRest, COARSE, open, report, settled, state, typeFormula } from './helpers.js';

test('a formula is typed, and mended', async ({ page }) => {
  const { clean } = await open(page, { hash: COARSE });
  await test.step('a formula typed while the full editor comes is not taken for one that was left; no name is broken', async () => {
    await page.route('**/code-editor*.js', async (route) => {
      await new Promise((go) => setTimeout(go, 1500));
      await route.continue();
    });
    const engine = (/** @type {string} */ name) =>
      page.evaluate((of) => /** @type {any} */ (window).marchingParticles.engine[of].value, name);
    await page.getByRole('textbox', { name: 'Formula' }).fill('x');
    await expect.poll(() => engine('trial')).toBe('shown');
    await expect(page.locator('.code-host')).toBeVisible();
    await page.unroute('**/code-editor*.js');
    await typeFormula(page, `${'sinh(x) + '.repeat(12)}y`);
    const broken = await page.locator('.cm-function').evaluateAll((all) => all.map((e) => e.getClientRects().length));
    expect(broken).toEqual(Array(12).fill(1));
    await clean();
  });

  await test.step('a typed formula gets sliders for its unknown names, and dragging one samples anew', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'x^2 + y^2 + k z^2 = 1');
    const slider = page.getByRole('slider', { name: /k$/ });
    await expect(slider).toBeVisible();
    await settled(page);
    const before = await report(page);
    const box = await slider.boundingBox();
    if (!box) throw new Error('the slider has no box');
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.9, box.y + box.height / 2, { steps: 4 });
    await page.mouse.up();
    await settled(page);
    expect((await state(page)).parameters.k).toBeGreaterThan(1);
    expect((await report(page)).digest).not.toBe(before.digest);
    await slider.dblclick();
    await settled(page);
    expect((await state(page)).parameters.k).toBeUndefined();
  });

  await test.step('more than three sliders scroll in their room, and the gallery keeps its place', async () => {
    await afresh(page, { hash: COARSE });
    const top = async () => (await page.locator('.gallery').boundingBox())?.y;
    const before = await top();
    await typeFormula(page, 'a x^2 + b y^2 + c z^2 + d x y = k');
    const last = page.getByRole('slider', { name: /k$/ });
    await expect(last).toBeAttached();
    await settled(page);
    expect(await top()).toBe(before);
    await last.focus();
    await expect(last).toBeInViewport();
  });

  await test.step('an error names its place, the last surface stays, and a press on the suggestion mends it', async () => {
    await afresh(page, { hash: COARSE });
    const before = await report(page);
    await typeFormula(page, 'x^2 + y^2 + sqt(z) = 1');
    const editor = page.getByRole('textbox', { name: 'Formula' });
    await expect(editor).toHaveAttribute('aria-invalid', 'true');
    await expect(page.locator('.cm-fault')).toHaveText('sqt');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().count)).toBe(
      before.count,
    );
    await page.getByRole('button', { name: 'Change to sqrt' }).click();
    await expect(editor).toHaveAttribute('aria-invalid', 'false');
    await expect.poll(async () => (await state(page)).formula).toBe('x^2 + y^2 + sqrt(z) = 1');
  });

  await test.step('a mistake that is typed over leaves no style behind, which the content security policy forbids', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'sqt(z) + x');
    await expect(page.locator('.cm-fault')).toHaveText('sqt');
    await page.keyboard.press('ControlOrMeta+a');
    await page.keyboard.type('y = x');
    await expect.poll(async () => (await state(page)).formula).toBe('y = x');
    await clean();
    await page.keyboard.press('ControlOrMeta+a');
    await page.keyboard.type('(');
    await expect.poll(async () => (await state(page)).formula).toBe('(y = x)');
  });

  await test.step('beside a mistake the typeset formula is said to be the last one that could be read', async () => {
    await afresh(page, { hash: COARSE });
    const preview = page.getByRole('group', { name: 'The formula as mathematics' });
    await expect(preview).toHaveAccessibleDescription('');
    await typeFormula(page, 'x^2 + y^2 +');
    await expect(preview).toHaveAccessibleDescription('The last formula that could be read:');
    // A word is none.
    await typeFormula(page, 'x^2 + y^4 = 1');
    await expect(preview).toHaveAccessibleDescription('');
    for (const text of ['heart', 'heart +']) {
      await typeFormula(page, text);
      await expect(preview).toHaveAccessibleDescription('The last formula that could be read:');
      await expect(preview).toHaveText('x2+y4=1');
    }
    await typeFormula(page, 'x^2 + y^2 + z^2 = 1');
    await expect(preview).toHaveAccessibleDescription('');
  });

  await test.step('in an own formula a parameter is no longer what it was in the surface of the gallery', async () => {
    await afresh(page, { hash: COARSE });
    await expect(page.getByRole('slider', { name: 'Semi-axis along x a' })).toBeVisible();
    await typeFormula(page, 'x^2 + y^2 + a z^2 = 1');
    await expect(page.getByRole('slider', { name: 'Parameter a' })).toBeVisible();
    await expect(page.getByRole('slider', { name: /Semi-axis/ })).toHaveCount(0);
  });

  await test.step('letter by letter, what is typed shows its mistake after a pause, and its surface at once by Enter', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'x^2 + y^2 + z^2 = ');
    const editor = page.getByRole('textbox', { name: 'Formula' });
    await expect(editor).toHaveAttribute('aria-invalid', 'true');
    // Beside a later text an earlier mistake says nothing.
    await page.keyboard.type('s');
    await expect(editor).toHaveAttribute('aria-invalid', 'false');
    await page.keyboard.type('qrt(2');
    await page.keyboard.press('Enter');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.trial.value)).not.toBe(
      'typing',
    );
    await settled(page);
    expect((await state(page)).formula).toBe('x^2 + y^2 + z^2 = sqrt(2)');
    await expect(page.locator('.row[data-parameter]')).toHaveCount(0);
  });

  await test.step('a parameter named like the beginning of a function gets its slider', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'x^2 + y^2 + z^2 = s');
    await expect(page.locator('.row[data-parameter="s"]').getByRole('slider')).toBeVisible();
  });

  await test.step('every unknown name gets a slider, and one like a function on request', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'p x^2 + q y^2 + s z^2 + u x y + v y z + sim z x = 1');
    const add = page.getByRole('button', { name: /^Add slider/ });
    await expect(add).toHaveCount(1);
    await add.click();
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveAttribute('aria-invalid', 'false');
    await expect(page.locator('.row[data-parameter]')).toHaveCount(6);
  });

  await test.step('words ask for the surface that they name, and a press shows it', async () => {
    await typeFormula(page, 'donut');
    await expect(page.locator('.fault')).toContainText('Did you mean the Torus');
    await expect(page.locator('.rows .row:visible')).toHaveCount(0);
    await expect(page.locator('.fault').getByRole('button', { name: 'Show the Torus', exact: true })).toBeVisible();
    const view = page.getByRole('region', { name: 'View' });
    await expect(view.getByRole('heading', { name: /^Did you mean the Torus/ })).toBeVisible();
    await view.getByRole('button', { name: 'Show the Torus', exact: true }).click();
    await settled(page);
    expect((await state(page)).surface).toBe('torus');
  });

  await test.step('an equation in polar coordinates is written in x and y by one press, without a slider', async () => {
    // The torus has a parameter of this name.
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'r = 2cos(3θ)');
    const written = page.getByRole('button', { name: /^Write as / });
    await expect(written).toHaveText('Write as hypot(x, y) = 2cos(3 atan2(y, x))');
    await expect(page.locator('.fault .repairs .button')).toHaveCount(1);
    await written.click();
    await settled(page);
    await expect(page.locator('.unchanging')).toHaveText('No z: a cylinder');
  });

  await test.step('no formula moves the gallery: the formula grows over it while it has the focus', async () => {
    await afresh(page, { hash: COARSE });
    const box = async (/** @type {string} */ of) => {
      const { y = 0, height = 0 } = (await page.locator(of).boundingBox()) ?? {};
      return { top: y, bottom: y + height };
    };
    const { top } = await box('.gallery');
    for (const text of [
      'x^2 + y^2 + z^2 = 1',
      'hypot(x, y) = 2cos(3 atan2(y, x)) +',
      'k x^2 + y^2 = 1',
      `x^2 + y^2 ${'+ 0.1*x*y '.repeat(14)}= 1`,
    ]) {
      await typeFormula(page, text);
      await expect(page.locator('.fault').or(page.locator('.preview math'))).not.toHaveCount(0);
      expect((await box('.gallery')).top, text).toBe(top);
    }
    await settled(page);
    // Five lines, four of mathematics and a remark, all of them to be seen.
    await expect(page.locator('.unchanging')).toHaveText('No z: a cylinder');
    await expect(page.locator('.formula-text')).toHaveCSS('z-index', '3');
    expect((await box('.formula-text')).bottom).toBeGreaterThan(top);
    expect((await box('.gallery')).top).toBe(top);
    // Without the focus it leaves the gallery free.
    await page.locator('#stage').click({ position: { x: 640, y: 20 } });
    await expect.poll(async () => (await box('.formula-text')).bottom).toBeLessThanOrEqual(top);
    for (const part of ['#formula', '.code-shown']) expect((await box(part)).bottom).toBeLessThanOrEqual(top);
    expect((await box('.gallery')).top).toBe(top);
  });

  await test.step('a formula pasted over another ends what was set for that, which is said, and one Undo brings it back', async () => {
    await afresh(page, {
      hash: link({ surface: 'gyroid', settings: { radius_share: 0.03, thickness: 0.4, box_faces: 'closed' } }),
    });
    await page.locator('#formula').click();
    await expect(page.locator('.code-host')).toBeVisible();
    await page.keyboard.press('ControlOrMeta+a');
    await page.evaluate(() => {
      const clipboardData = new DataTransfer();
      clipboardData.setData('text/plain', 'x^2 + y^2 + z^2 = 1');
      const paste = new ClipboardEvent('paste', { clipboardData, bubbles: true, cancelable: true });
      document.querySelector('.code-host')?.shadowRoot?.querySelector('.cm-content')?.dispatchEvent(paste);
    });
    await expect(page.locator('.toast')).toHaveText(/thickness 0.4; closed by the box/);
    await settled(page);
    expect((await state(page)).settings).toEqual({ radius_share: 0.03 });
    await page.getByRole('button', { name: 'Undo' }).click();
    await settled(page);
    expect(await state(page)).toMatchObject({ surface: 'gyroid', settings: { thickness: 0.4, box_faces: 'closed' } });
  });

  await test.step('Escape stops a run, also from within the formula', async () => {
    await afresh(page);
    await page.getByRole('textbox', { name: 'Formula' }).click();
    await expect(page.locator('.code-host')).toBeVisible();
    // Pressed by the page itself in the middle of the run, which a press from here might miss.
    const stopped = await page.evaluate(async () => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const editor = document.querySelector('.code-host')?.shadowRoot?.activeElement;
      const press = new KeyboardEvent('keydown', { key: 'Escape', bubbles: true, composed: true, cancelable: true });
      engine.setSetting('radius_share', 0.001);
      await new Promise((resolve) => {
        const end = engine.progress.subscribe((/** @type {{ particles: number }} */ { particles }) => {
          if (engine.status.value === 'sampling' && particles > 5000) queueMicrotask(() => resolve(end()));
        });
      });
      const wasBusy = engine.status.value === 'sampling';
      editor?.dispatchEvent(press);
      while (engine.status.value === 'sampling') await new Promise((go) => setTimeout(go, 10));
      return { wasBusy, isPartial: engine.result.value === 'partial' };
    });
    expect(stopped).toEqual({ wasBusy: true, isPartial: true });
  });

  await test.step('an empty formula is met with a hint, not an error, and the surface stays', async () => {
    await afresh(page, { hash: COARSE });
    const before = await report(page);
    await typeFormula(page, '');
    const message = page.locator('#formula-fault');
    await expect(message).toContainText('Type a formula');
    await expect(message).toHaveAttribute('data-tone', 'hint');
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveAttribute('aria-invalid', 'false');
    await expect(page.locator('.editor')).not.toHaveClass(/has-fault/);
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().count)).toBe(
      before.count,
    );
  });

  await test.step('markup in a formula stays text', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, '<img src=x onerror=alert(1)>');
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveAttribute('aria-invalid', 'true');
    expect(await page.evaluate(() => document.querySelectorAll('img[onerror], [onerror]').length)).toBe(0);
    expect(
      await page.evaluate(() => document.querySelector('.code-host')?.shadowRoot?.querySelectorAll('img').length),
    ).toBe(0);
  });

  await test.step('the formula is shown as mathematics', async () => {
    await afresh(page, { hash: COARSE });
    await typeFormula(page, 'x^2 + y^2/4 + z^2 = 1');
    await expect(page.locator('.preview math mfrac, .preview math msup').first()).toBeVisible();
  });

  await test.step('on a phone a mistake is read and mended without scrolling for it', async () => {
    await afresh(page, { width: 390, height: 844, hash: COARSE });
    await typeFormula(page, 'x^2 + y^2 + sqt(z) = 1');
    const repair = page.getByRole('button', { name: 'Change to sqrt' });
    await expect(repair).toBeInViewport({ ratio: 1 });
    await repair.click();
    await expect(page.getByRole('textbox', { name: 'Formula' })).toHaveAttribute('aria-invalid', 'false');
  });

  await test.step('a surface of the gallery is chosen by a press and by the arrow keys', async () => {
    await afresh(page, { hash: COARSE });
    await page.locator('.tile[data-surface="torus"]').click();
    await settled(page);
    expect((await state(page)).surface).toBe('torus');
    await expect(page.getByRole('heading', { name: 'Torus', exact: true })).toBeVisible();
    await expect(page.getByRole('radio', { name: 'Torus', exact: true })).toBeChecked();
    await page.keyboard.press('ArrowLeft');
    await expect.poll(async () => (await state(page)).surface).not.toBe('torus');
  });

  await test.step('the clip box is edited axis by axis and taken back', async () => {
    await afresh(page, { hash: COARSE });
    await page.locator('.clip summary', { hasText: 'Clip box' }).click();
    const high = page.getByRole('spinbutton', { name: 'x to' });
    await high.fill('0.25');
    await high.press('Tab');
    await settled(page);
    expect((await state(page)).bounds.max[0]).toBe(0.25);
    const xs = await page.evaluate(() => {
      const { positions, count } = /** @type {any} */ (window).marchingParticles.particles();
      return Math.max(...Array.from({ length: count }, (_, i) => positions[3 * i]));
    });
    expect(xs).toBeLessThanOrEqual(0.25 + 1e-6);
    await page.locator('.clip').getByRole('button', { name: 'Reset' }).click();
    await expect.poll(async () => (await state(page)).bounds).toBeNull();
  });
  await clean();
});

test('another formula is shown from its widest side, also where the hand has turned the camera, and an edit is not', {
  tag: '@all',
}, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  const { clean } = await open(page, { hash: '' });
  const engine = (/** @type {string} */ act) =>
    page.evaluate(
      (call) => new Function('engine', `return ${call}`)(/** @type {any} */ (window).marchingParticles.engine),
      act,
    );
  const yaw = async () => {
    await settled(page);
    await atRest(page);
    return (await state(page)).view.camera.yaw;
  };
  await page.locator('.tile[data-surface="torus"]').click();
  await yaw();
  await engine('engine.orbit(0.7, 0.5)');
  // A plate across the x axis.
  await typeFormula(page, '(4x)^4 + y^4 + z^4 = 1');
  const plate = await yaw();
  expect(Math.abs(Math.cos(plate))).toBeGreaterThan(0.7);
  await engine('engine.orbit(0.7, 0)');
  const turned = await yaw();
  await page.keyboard.press('End');
  await page.keyboard.type('.5');
  expect(await yaw()).toBeCloseTo(turned, 6);
  await typeFormula(page, 'x^4 + (5y)^4 = 2 - z^4');
  expect(Math.abs(Math.sin(await yaw()))).toBeGreaterThan(0.7);
  await clean();
});
