import { expect, test } from '@playwright/test';
import { link } from '../engine/browser.js';
import { afresh, atRest, open, openFigures, report, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

test('the settings', async ({ page }) => {
  const { clean } = await open(page);
  await test.step('the settings are those that the core describes, each with its help', async () => {
    const settings = await page.evaluate(
      () => /** @type {any} */ (window).marchingParticles.engine.description.value.settings,
    );
    // The mode of the box is set where the box is.
    const shown = settings.filter((/** @type {{ group: string }} */ { group }) => group !== 'Box');
    await expect(page.locator('.setting')).toHaveCount(shown.length);
    await page.getByRole('button', { name: 'Advanced' }).click();
    for (const { name, label, help } of shown) {
      const setting = page.locator(`.setting[data-setting="${name}"]`);
      await expect(setting).toContainText(label);
      if (!(await setting.isVisible())) continue;
      await setting.hover();
      await expect(page.locator('#explain')).toContainText(help.slice(0, 40));
    }
    // The explanation of the last one may lie over the button.
    await page.mouse.move(0, 0);
    await page.getByRole('button', { name: 'Advanced' }).click();
  });

  await test.step('Uniform and Adaptive each show their own settings, and the bar keeps its height', async () => {
    await afresh(page, { width: 1440, height: 900 });
    const bar = page.locator('#panel-sampling');
    const height = (await bar.boundingBox())?.height;
    const uniform = await shownSettings(page);
    expect(uniform).toContain('radius_share');
    await page.getByRole('radio', { name: 'Adaptive' }).check();
    await expect.poll(async () => (await state(page)).settings.sampling).toBe('adaptive');
    const adaptive = await shownSettings(page);
    expect(adaptive).toContain('radius_law');
    expect(adaptive).not.toContain('radius_share');
    expect((await bar.boundingBox())?.height).toBe(height);
    // One row of them, also where there are most.
    await page.getByRole('radio', { name: 'Count' }).check();
    await expect(page.locator('.setting[data-setting="count"]')).toBeVisible();
    expect((await bar.boundingBox())?.height).toBe(height);
    await page.getByRole('radio', { name: 'Radius', exact: true }).check();
    await page.getByRole('combobox', { name: 'Radius law' }).selectOption('max_curvature');
    await expect(page.locator('.setting[data-setting="curvature_scale"]')).toBeVisible();
    await expect(page.locator('.setting[data-setting="chord_error"]')).toBeHidden();
    await page.getByRole('radio', { name: 'Adaptive' }).focus();
    await page.keyboard.press('ArrowLeft');
    await expect(page.getByRole('radio', { name: 'Uniform' })).toBeChecked();
    await expect.poll(() => shownSettings(page)).toEqual(uniform);
  });

  await test.step('a slider that goes away under the hand keeps its value', async () => {
    await afresh(page, { width: 1440, height: 900 });
    const box = await page.getByRole('slider', { name: 'Radius' }).boundingBox();
    if (!box) throw new Error('the slider has no box');
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y, { steps: 2 });
    await expect.poll(async () => (await state(page)).settings.radius_share).toBeDefined();
    const { radius_share } = (await state(page)).settings;
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setSetting('sampling', 'adaptive'));
    await page.mouse.move(x + 60, y, { steps: 3 });
    await page.mouse.up();
    await settled(page);
    expect((await state(page)).settings).toEqual({ radius_share, sampling: 'adaptive' });
  });

  await test.step('what a pattern cannot have is unavailable, and says why', async () => {
    await afresh(page, { width: 1440, height: 900, hash: link({ settings: { pattern: 'blue', radius_share: 0.03 } }) });
    const before = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.progress.value.run);
    for (const [name, key] of [
      ['Without relaxing', 'g'],
      ['Relax one step', 'e'],
    ]) {
      const action = page.getByRole('button', { name });
      await expect(action).toHaveAttribute('aria-disabled', 'true');
      // Playwright waits for a button that is enabled, unless it is forced.
      await action.click({ force: true });
      await expect(page.locator('#explain')).toContainText('Blue noise is not relaxed');
      await page.locator('.canvas-host').focus();
      await page.keyboard.press(key);
    }
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.progress.value.run)).toBe(
      before,
    );
    await expect(page.locator('.legend .ends')).toContainText('rounds of darts');
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setSetting('pattern', 'hexagonal'));
    await settled(page);
    await expect(page.getByRole('button', { name: 'Relax one step' })).toHaveAttribute('aria-disabled', 'false');
    await expect(page.locator('.legend .ends')).toContainText('rings around the seed');
  });

  await test.step('what few need is behind a button that says how much of it was changed', async () => {
    await afresh(page, { width: 1440, height: 900 });
    const more = page.getByRole('button', { name: 'Advanced' });
    await expect(more).toHaveAttribute('aria-expanded', 'false');
    await expect(page.locator('.setting[data-setting="seed"]')).toBeHidden();
    await more.click();
    await expect(more).toHaveAttribute('aria-expanded', 'true');
    const seed = page.getByRole('spinbutton', { name: 'Seed' });
    await seed.fill('7');
    await seed.press('Enter');
    await expect(more).toContainText('1 changed');
    await more.click();
    await expect(seed).toBeHidden();
  });

  await test.step('typing a radius samples with it', async () => {
    await afresh(page);
    const before = await report(page);
    const box = page.locator('.setting[data-setting="radius_share"] input[role=spinbutton]');
    await box.fill('2');
    await box.press('Enter');
    await box.blur();
    await settled(page);
    expect((await state(page)).settings.radius_share).toBeCloseTo(0.02);
    expect((await report(page)).count).toBeLessThan(before.count);
  });

  await test.step('no two sliders have the same name', async () => {
    await afresh(page, { hash: link({ surface: 'sphere' }) });
    const names = await page
      .getByRole('slider')
      .evaluateAll((sliders) => sliders.map((slider) => slider.getAttribute('aria-label')));
    expect(names.length).toBeGreaterThan(1);
    expect(new Set(names).size).toBe(names.length);
  });

  await test.step('Enter in a number field hands the keys back to the page', async () => {
    await afresh(page);
    const field = page.getByRole('spinbutton', { name: 'Semi-axis along x a, number' });
    await field.fill('0.9');
    await field.press('Enter');
    await settled(page);
    await expect(field).not.toBeFocused();
    await page.keyboard.press(',');
    // One back from the end is the last relaxation step but one.
    expect((await state(page)).view.step).not.toBeNull();
  });
  await clean();
});

/** @param {Page} page */
const shownSettings = (page) =>
  page.locator('.setting:visible').evaluateAll((all) => all.map((one) => one.getAttribute('data-setting')));

/** Time in which a second press of a button counts as part of a double click. */
const DOUBLE_CLICK_MS = 500;

test('the run and its buttons', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await test.step('a double click on Run is one run', async () => {
    const before = await report(page);
    await page.getByRole('button', { name: 'Run', exact: true }).first().dblclick();
    await settled(page);
    const after = await report(page);
    expect(after.digest).toBe(before.digest);
    expect(after.stop_reason).toBe('complete');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().partial)).toBe(false);
  });

  await test.step('generate only leaves the front unrelaxed; relax one step moves it', async () => {
    await afresh(page);
    const relaxed = await report(page);
    await page.getByRole('button', { name: 'Without relaxing' }).click();
    await settled(page);
    const front = await report(page);
    expect(front.count).toBe(relaxed.count);
    expect(front.digest).not.toBe(relaxed.digest);
    await page.getByRole('button', { name: 'Relax one step' }).click();
    await expect.poll(async () => (await report(page))?.digest ?? front.digest).not.toBe(front.digest);
  });

  await test.step('a double click on Relax one step is one step', async () => {
    await page.waitForTimeout(DOUBLE_CLICK_MS);
    await afresh(page);
    const { relax_steps } = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().progress);
    await page.getByRole('button', { name: 'Relax one step' }).dblclick();
    await settled(page);
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().progress.relax_step)).toBe(
      relax_steps + 1,
    );
  });

  await test.step('figures of a run without relaxation are those of the front, and go on to relaxed with the first step', async () => {
    await page.waitForTimeout(DOUBLE_CLICK_MS);
    await afresh(page);
    await openFigures(page);
    const cells = page.locator('tr', { has: page.getByRole('button', { name: 'Six neighbours' }) }).locator('td');
    await page.getByRole('button', { name: 'Without relaxing' }).click();
    await settled(page);
    await expect(cells.nth(0)).toHaveText('');
    await expect(cells.nth(1)).toHaveText(/\d/);
    await page.getByRole('button', { name: 'Relax one step' }).click();
    await settled(page);
    await expect(cells.nth(1)).toHaveText(/\d/);
  });

  await test.step('the time under the picture is the time of the sampling in the report', async () => {
    await afresh(page);
    const total = await page.locator('.timing thead th').last().textContent();
    await expect(page.locator('.caption')).toContainText(String(total));
  });

  await test.step('after one step more the caption and the report say that the time is that of the step', async () => {
    await page.waitForTimeout(DOUBLE_CLICK_MS);
    await afresh(page);
    await page.getByRole('button', { name: 'Relax one step' }).click();
    await settled(page);
    const [title, time] = await page
      .locator('.timing thead th')
      .evaluateAll(([first, , last]) => [first.textContent, last.textContent]);
    expect(title).toBe('The last step');
    await expect(page.locator('.caption')).toContainText(`${time} for the last step`);
    await expect(page.locator('.timing tbody th')).toHaveText(['Relaxation']);
    await page.getByRole('button', { name: 'Run', exact: true }).click();
    await settled(page);
    await expect(page.locator('.timing thead th').first()).toHaveText('Sampling');
    await expect(page.locator('.caption')).not.toContainText('step');
  });

  await test.step('more particles than the limit are asked for first, and the answer is heeded', async () => {
    await afresh(page);
    const before = await report(page);
    await page.getByRole('button', { name: 'Advanced' }).click();
    const limit = page.locator('.setting[data-setting="max_particles"] input[role=spinbutton]');
    await limit.fill('2000');
    await limit.press('Enter');
    const notice = page.locator('.toast');
    await expect(notice).toContainText('limit is 2,000');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().dimmed)).toBe(true);
    const [legend, box] = [await page.locator('.legend').boundingBox(), await notice.boundingBox()];
    expect(legend && box && box.y - legend.y - legend.height, 'below the legend').toBeGreaterThanOrEqual(0);
    await page.keyboard.press('Escape');
    await expect(notice).toBeHidden();
    await limit.fill('2001');
    await limit.press('Enter');
    await expect(notice).toContainText('limit is 2,001');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().count)).toBe(
      before.count,
    );
    await notice.getByRole('button', { name: 'Sample them anyway' }).click();
    await settled(page);
    expect((await report(page)).count).toBe(before.count);
    expect((await state(page)).settings.max_particles).toBeGreaterThan(before.count);
  });

  await test.step('a stopped run is labelled and keeps what it has', async () => {
    await afresh(page);
    // About a million particles: long enough to be stopped on any machine.
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.setSetting('max_particles', 3_000_000);
      engine.setSetting('radius_share', 0.0004);
    });
    // Pressed in the page itself, as soon as there is something to stop: from here a press could come late.
    await page.waitForFunction(() => {
      const { busy, progress } = /** @type {any} */ (window).marchingParticles.status();
      if (!(busy && progress.radius > 0 && progress.radius < 0.002 && progress.particles > 100)) return false;
      for (const button of document.querySelectorAll('.actions .button'))
        if (button.textContent === 'Stop') /** @type {HTMLElement} */ (button).click();
      return true;
    });
    await expect(page.locator('.caption')).toContainText(/Stopped (at level|after relaxation) \d/);
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().partial)).toBe(true);
  });
  await clean();
});

test('the report, what can be taken away, and what is said where there is no surface', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('the report explains its figures and shows them before and after relaxation', async () => {
    const rows = await page.evaluate(
      () => /** @type {any} */ (window).marchingParticles.engine.description.value.report,
    );
    const particles = (await report(page)).count.toLocaleString('en');
    const plain = page.locator('.plain-figures');
    await expect(plain.locator('.term')).toHaveText([
      'Particles',
      'Spacing variation',
      'Largest error',
      'Completeness',
    ]);
    await expect(plain.locator('dd')).toHaveText([`${particles}`, /%$/, /%$/, 'proven']);
    await expect(page.locator('.figures')).toBeHidden();
    await openFigures(page);
    await expect(page.locator('.figures .term')).toHaveCount(rows.length);
    const row = rows.find((/** @type {any} */ { key }) => key === 'quality.six_neighbours');
    const term = page.locator('.figures .term', { hasText: row.label });
    await term.focus();
    await page.keyboard.press('Shift+Tab');
    await page.keyboard.press('Tab');
    await expect(page.locator('#explain')).toContainText(row.help.slice(0, 40));
    await page.keyboard.press('Escape');
    await expect(page.locator('#explain')).toBeHidden();
    const cells = term.locator('xpath=ancestor::tr').locator('td');
    for (const i of [0, 1]) await expect(cells.nth(i)).toHaveText(/\d/);
    await expect(page.locator('.plot svg path').first()).toBeVisible();
    await page.getByText('As a table').click();
    expect(await page.locator('.histogram tbody tr').count()).toBeGreaterThan(2);
  });

  await test.step('the particles and the picture can be taken away', async () => {
    await afresh(page);
    const count = (await report(page)).count;
    await page.getByRole('button', { name: 'Export', exact: true }).click();
    const [csv] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('button', { name: /Export CSV/ }).click(),
    ]);
    expect(csv.suggestedFilename()).toMatch(/^ellipsoid-\d+\.csv$/);
    const { readFile } = await import('node:fs/promises');
    const lines = (await readFile(await csv.path(), 'utf8')).trim().split('\n');
    expect(lines[0]).toMatch(/^x,y,z,nx,ny,nz,/);
    expect(lines.length).toBe(count + 1);
    await page.getByRole('button', { name: 'Save picture' }).click();
    const [png] = await Promise.all([
      page.waitForEvent('download'),
      page.getByRole('button', { name: 'Save PNG' }).click(),
    ]);
    expect((await readFile(await png.path())).subarray(1, 4).toString()).toBe('PNG');
  });

  await test.step('no surface anywhere is said in words, with a way out; the last surface stays, dimmed', async () => {
    await afresh(page);
    await typeFormula(page, 'x^2 + y^2 + z^2 + 1');
    await expect(page.getByRole('heading', { name: 'No surface within ±10,000' })).toBeVisible();
    await expect(page.locator('.figures')).toBeHidden();
    await expect(page.locator('.empty')).toContainText('The last surface stays, dimmed');
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().dimmed)).toBe(true);
    await page.getByRole('button', { name: 'Export', exact: true }).click();
    await page.getByRole('button', { name: /Export CSV/ }).click();
    await expect(page.locator('.toast')).toContainText('no particles to export');
    // What is wrong with the formula is said beside it, and no longer over the picture.
    await typeFormula(page, 'x^2 +');
    await expect(page.locator('.empty')).toBeHidden();
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().dimmed)).toBe(true);
    await typeFormula(page, 'x^2 + y^4 + z^4 = 1');
    await settled(page);
    await typeFormula(page, 'x^2 + y^2 + z^2 + 1');
    // The way back leads to what was there last.
    await page.getByRole('button', { name: 'Back to the last surface' }).click();
    await settled(page);
    expect((await state(page)).formula).toBe('x^2 + y^4 + z^4 = 1');
    await expect(page.locator('.empty')).toBeHidden();
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().dimmed)).toBe(false);
    expect((await report(page)).count).toBeGreaterThan(100);
  });

  await test.step('what a surface always does is a note, which no folded report counts', async () => {
    await afresh(page);
    await typeFormula(page, '(x^2+9/4*y^2+z^2-1)^3 - x^2*z^3 - 9/80*y^2*z^3 = 0');
    await settled(page);
    await expect(page.locator('.panel-report .now').first()).toHaveText(/^[\d,]+ particles$/);
    await expect(page.locator('.panel-report .section.warnings')).toBeHidden();
    const notes = page.locator('.notes');
    await expect(notes.locator('> summary')).toHaveText('2 notes');
    await notes.locator('> summary').click();
    await expect(notes.locator('li').first()).toContainText('the particles around them close it');
  });

  await test.step('while a run counts particles nothing says that there is no surface, and report and caption agree', async () => {
    await afresh(page);
    await typeFormula(page, '1 = 1');
    await expect(page.locator('.empty')).toBeVisible();
    const counting = (/** @type {number} */ share) =>
      page.evaluate(async (share) => {
        const { engine } = /** @type {any} */ (window).marchingParticles;
        // Most of a million particles: long enough to be looked at on any machine.
        engine.setSetting('max_particles', 3_000_000);
        if (engine.result.value === 'none') engine.setFormula('x^2 + y^2 + z^2 = 1');
        engine.setSetting('radius_share', share);
        const radius = share * 4;
        const shown = (/** @type {string} */ selector) =>
          document.querySelector(selector)?.checkVisibility() ? document.querySelector(selector)?.textContent : null;
        for (;;) {
          await new Promise((go) => setTimeout(go));
          const { radius: present, particles } = engine.progress.value;
          if (engine.status.value === 'sampling' && present > 0 && present < radius && particles > 1000) break;
        }
        const count = [...document.querySelectorAll('.figures tr')].find((row) =>
          /^Particles/.test(row.textContent ?? ''),
        );
        const answer = {
          empty: shown('.empty'),
          waiting: shown('.waiting'),
          caption: shown('.caption'),
          count: count?.checkVisibility() ? (count.querySelector('.now')?.textContent ?? null) : null,
        };
        engine.stop();
        return answer;
      }, share);
    const first = await counting(0.0006);
    expect(first.empty).toBe(null);
    expect(first.waiting ?? '').not.toContain('no surface');
    await settled(page);
    // From now on there are figures of a run before.
    const second = await counting(0.0005);
    expect(second.count).toMatch(/\d/);
    expect(second.caption).toContain(second.count);
  });
  await clean();
});

test('a link to a formula without a surface in its box shows that box, whole', { tag: '@all' }, async ({ page }) => {
  const wanted = { formula: 'x^2 + (y - 30)^2 + z^2 = 1', settings: { box_mode: 'fixed' } };
  await open(page, { hash: link(wanted) });
  const said = page.locator('.empty');
  await expect(page.getByRole('heading', { name: 'No surface inside the box' })).toBeVisible();
  await expect(said).not.toContainText('The last surface');
  for (const size of [
    { width: 390, height: 844 },
    { width: 1440, height: 900 },
  ]) {
    await page.setViewportSize(size);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.fit());
    await atRest(page);
    const [lowest, top] = await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const { min, max } = engine.field.value.bounds;
      const corners = Array.from({ length: 8 }, (_, k) => [0, 1, 2].map((axis) => ((k >> axis) & 1 ? max : min)[axis]));
      const said = /** @type {Element} */ (document.querySelector('.empty')).getBoundingClientRect();
      return [Math.max(...corners.map((corner) => engine.project(corner).y)), said.top];
    });
    expect(lowest).toBeGreaterThan(100);
    expect(lowest).toBeLessThan(top);
  }
  const { distance } = (await state(page)).view.camera;
  await page.getByRole('button', { name: /^Back to the / }).click();
  await settled(page);
  await atRest(page);
  expect((await state(page)).view.camera.distance).toBeLessThan(distance);
});
