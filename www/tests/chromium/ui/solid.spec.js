/** A solid from a surface: closed by its box, and a shell of some thickness; in links and in the history. */
import { expect, test } from '@playwright/test';
import { afresh, open, report, settled, state } from './helpers.js';

test('a periodic surface becomes a closed part, and a surface again', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await page.evaluate(() =>
    /** @type {any} */ (window).marchingParticles.set({ surface: 'schwarz-p', settings: { radius_share: 0.012 } }),
  );
  const closed = page.getByRole('checkbox', { name: 'Closed' });
  const thickness = page.getByRole('textbox', { name: 'Thickness' });
  const before = await state(page);
  await closed.check();
  await settled(page);
  const shown = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().progress.particles);
  const { creases, cut, count } = await report(page);
  expect(creases).toBeGreaterThan(0);
  expect([cut, shown]).toEqual([null, count]);
  await test.step('what is no thickness is refused in words', async () => {
    await thickness.fill('-1');
    await thickness.press('Enter');
    await expect(page.getByRole('alert').filter({ hasText: 'from 0 on' })).toBeVisible();
    expect((await state(page)).settings.thickness).toBeUndefined();
    await thickness.fill('0.2 + q z');
    await thickness.press('Enter');
    await expect(page.getByRole('alert').filter({ hasText: 'no parameter q' })).toBeVisible();
    expect((await state(page)).settings.thickness).toBeUndefined();
  });
  await test.step('a formula makes the thickness vary', async () => {
    await thickness.fill('1 + 0.05z');
    await thickness.press('Enter');
    // The core reads the text first.
    await expect.poll(async () => (await state(page)).settings.thickness).toBe('1 + 0.05z');
    await settled(page);
    await expect(thickness).toHaveValue('1 + 0.05z');
    await page.getByRole('button', { name: 'Undo' }).click();
    await settled(page);
    await expect(thickness).toHaveValue('');
  });
  await test.step('links and the history have the choices', async () => {
    const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
    await page.getByRole('button', { name: 'Undo' }).click();
    await settled(page);
    await expect(closed).not.toBeChecked();
    expect((await state(page)).settings).toEqual(before.settings);
    await afresh(page, { hash: new URL(link).hash });
    await expect(closed).toBeChecked();
    expect((await report(page)).creases).toBe(creases);
  });
  await test.step('a model from points has no solid', async () => {
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.set({ surface: 'bunny' }));
    await expect(closed).toBeHidden();
  });
  await clean();
});

test('a unit cell has the same particles on opposite faces', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  const [closed, periodic] = ['Closed', 'Periodic'].map((name) => page.getByRole('checkbox', { name }));
  await expect(periodic).toBeHidden();
  for (const surface of ['gyroid', 'schwarz-p', 'schwarz-d']) {
    await test.step(surface, async () => {
      await page.evaluate(
        (id) => /** @type {any} */ (window).marchingParticles.set({ surface: id, settings: { radius_share: 0.014 } }),
        surface,
      );
      await closed.check();
      await settled(page);
      expect((await report(page)).pairs).toBeNull();
      await periodic.check();
      await settled(page);
      const { pairs, cut, warnings } = await report(page);
      expect(pairs).toBeGreaterThan(100);
      // Where the box cuts an intricate surface, it is not always proven that no component is missing.
      const others = warnings.filter((/** @type {{code: string}} */ { code }) => code !== 'unproven');
      expect([cut, others]).toEqual([null, []]);
      // One period, wherever the cell lies.
      await expect(page.getByText('6.28 × 6.28 × 6.28')).toBeVisible();
      expect((await state(page)).settings.box_cell).toBe('periodic');
    });
  }
  await test.step('the switches stay within the panel', async () => {
    const { room, over } = await page.getByRole('group', { name: 'Solid' }).evaluate((group) => {
      const of = (/** @type {Element} */ element) => element.getBoundingClientRect();
      const controls = [...group.querySelectorAll('input')].map(of);
      return {
        room: of(group).right - Math.max(...controls.map((box) => box.right)),
        over: group.scrollWidth - group.clientWidth,
      };
    });
    expect(room).toBeGreaterThanOrEqual(0);
    expect(over).toBe(0);
  });
  await test.step('an open solid has no cell', async () => {
    await closed.uncheck();
    await settled(page);
    await expect(periodic).toBeHidden();
    expect((await report(page)).pairs).toBeNull();
  });
  await clean();
});
