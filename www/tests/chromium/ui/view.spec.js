import { expect, test } from '@playwright/test';
import { afresh, atRest, open, settled, state, typeFormula } from './helpers.js';

test('the view', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await test.step('a particle under the pointer tells what it is', async () => {
    const view = await page.locator('#view').boundingBox();
    if (!view) throw new Error('the view has no box');
    await page.mouse.move(view.x + view.width / 2, view.y + view.height / 2 + 3, { steps: 3 });
    const card = page.locator('.hover-card');
    await expect(card).toBeVisible();
    for (const row of ['Particle', 'Level', 'Parent', 'Position', 'Neighbours', 'Residual'])
      await expect(card).toContainText(row);
    await page.mouse.move(view.x + 4, view.y + view.height / 2, { steps: 3 });
    await expect(card).toBeHidden();
  });

  await test.step('the legend shows what the chosen colours mean', async () => {
    await afresh(page);
    const choose = page.getByRole('combobox', { name: 'Colour by' });
    const { lastLevel } = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.columns);
    await expect(page.locator('.legend .ramp')).toBeVisible();
    await expect(page.locator('.legend .ends')).toHaveText(new RegExp(`^0.*${lastLevel}$`));
    await choose.selectOption('valence');
    await expect(page.locator('.categories li').first()).toBeVisible();
    const counted = await page.locator('.categories .count').allTextContents();
    const total = counted.reduce((sum, text) => sum + Number(text.replace(/\D/g, '')), 0);
    expect(total).toBe(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.particles().count));
    await choose.selectOption('nearest');
    await expect(page.locator('.ramp')).toBeVisible();
    await expect(page.locator('.ends')).toHaveText(/\d.*\d/);
  });

  await test.step('buttons zoom, turn and fit for those who cannot drag', async () => {
    await afresh(page);
    await atRest(page);
    const camera = async () => (await state(page)).view.camera;
    const first = await camera();
    await page.getByRole('button', { name: 'Zoom in' }).click();
    await expect.poll(async () => (await camera()).distance).toBeLessThan(first.distance);
    await page.getByRole('button', { name: 'View options' }).click();
    await page.getByRole('button', { name: 'Turn right' }).click();
    await expect.poll(async () => (await camera()).yaw).not.toBe(first.yaw);
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
    // From another side the outline is another one.
    await expect.poll(async () => Math.abs((await camera()).distance / first.distance - 1)).toBeLessThan(0.08);
    expect((await camera()).fit).toBe(true);
    await atRest(page);
    const [lowest, caption] = await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const { positions, count } = engine.columns;
      let y = 0;
      for (let i = 0; i < count; i += 1) y = Math.max(y, engine.project(positions.subarray(3 * i, 3 * i + 3)).y);
      return [y, document.querySelector('.caption')?.getBoundingClientRect().top];
    });
    expect(lowest).toBeGreaterThan(0);
    expect(lowest).toBeLessThan(Number(caption));
  });

  await test.step('a menu opened by the pointer and closed by Escape gives the focus back without an error', async () => {
    await afresh(page);
    for (const name of ['View options', 'Export']) {
      const button = page.getByRole('button', { name, exact: true });
      await button.click();
      await expect(button).toHaveAttribute('aria-expanded', 'true');
      await page.keyboard.press('Escape');
      await expect(button).toHaveAttribute('aria-expanded', 'false');
      await expect(button).toBeFocused();
      // The explanation of the button, which has the focus by the keyboard now.
      await expect(page.getByRole('tooltip')).toBeVisible();
      await page.keyboard.press('Escape');
    }
  });

  await test.step('on a phone the tabs open one sheet at a time, and the run is on that of sampling', async () => {
    await afresh(page, { width: 390, height: 844 });
    const tabs = page.getByRole('navigation', { name: 'Panels' });
    await expect(page.locator('#panel-field')).toBeVisible();
    await tabs.getByRole('button', { name: 'Report' }).click();
    await expect(page.locator('#panel-field')).toBeHidden();
    await expect(page.locator('.plain-figures')).toBeVisible();
    await tabs.getByRole('button', { name: 'Report' }).click();
    await expect(page.locator('#panel-report')).toBeHidden();
    await expect(tabs.getByRole('button', { name: 'Run' })).toBeHidden();
    await tabs.getByRole('button', { name: 'Sampling' }).click();
    await tabs.getByRole('button', { name: 'Run' }).dblclick();
    await settled(page);
    expect(await page.evaluate(() => /** @type {any} */ (window).marchingParticles.status().partial)).toBe(false);
  });

  await test.step('panels fold, and hide all together', async () => {
    await afresh(page, { width: 1440, height: 900 });
    await page.getByRole('button', { name: 'Fold report' }).click();
    await expect(page.locator('#report-body')).toBeHidden();
    await page.getByRole('button', { name: 'Unfold report' }).click();
    await expect(page.locator('#report-body')).toBeVisible();
    await page.getByRole('button', { name: 'View options' }).click();
    await page.getByRole('button', { name: 'Hide the panels' }).click();
    await expect(page.locator('.panel:visible')).toHaveCount(1);
    await expect(page.getByRole('slider', { name: 'Timeline' })).toBeVisible();
    await expect(page.locator('.caption')).toBeVisible();
    await page.keyboard.press('h');
    await expect(page.locator('.panel:visible')).toHaveCount(0);
    await expect(page.locator('.caption')).toBeHidden();
    await page.getByRole('button', { name: 'Show the panels' }).click();
    await expect(page.locator('.panel:visible')).toHaveCount(4);
  });
  await clean();
});

for (const width of [1280, 320]) {
  test(`the name of every colouring can be read in full at ${width} pixels`, { tag: '@all' }, async ({ page }) => {
    await open(page, { width, height: 640 });
    const choose = page.getByRole('combobox', { name: 'Colour by' });
    const ids = await choose
      .locator('option')
      .evaluateAll((options) => options.map((option) => /** @type {HTMLOptionElement} */ (option).value));
    expect(ids.length).toBeGreaterThan(4);
    for (const id of ids) {
      await choose.selectOption(id);
      const { room, text } = await choose.evaluate((element) => {
        const select = /** @type {HTMLSelectElement} */ (element);
        const style = getComputedStyle(select);
        const context = /** @type {CanvasRenderingContext2D} */ (document.createElement('canvas').getContext('2d'));
        context.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
        return {
          room: select.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight),
          text: context.measureText(select.selectedOptions[0].text).width,
        };
      });
      expect(room, id).toBeGreaterThanOrEqual(text - 0.5);
    }
  });
}

test('on a first visit sampling and report take a line each; what is unfolded stays so', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900, folded: true });
  await expect(page.locator('#report-body')).toBeHidden();
  await expect(page.locator('.panel-report .panel-head')).toContainText('4,286 particles');
  await expect(page.getByRole('group', { name: 'Settings', exact: true })).toBeHidden();
  await page.getByRole('button', { name: 'Unfold report' }).click();
  await expect(page.locator('#report-body')).toBeVisible();
  await page.reload();
  await settled(page);
  await expect(page.locator('#report-body')).toBeVisible();
  await expect(page.getByRole('group', { name: 'Settings', exact: true })).toBeHidden();
  await clean();
});

test('on a phone the sheets are as wide as the window on a first visit, too', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844, folded: true });
  for (const name of ['Report', 'Sampling']) {
    await page.locator('.tabs').getByRole('button', { name }).click();
    const box = await page.locator(`#panel-${name.toLowerCase()}`).boundingBox();
    expect([name, box?.x, box?.width]).toEqual([name, 0, 390]);
  }
  await clean();
});

test('on a phone the message that there is no surface leaves the tools free, and a constant has no box', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844 });
  await typeFormula(page, 'hello world');
  await expect(page.locator('.empty')).toContainText('There is no x, y or z in it');
  const last = page.getByRole('button', { name: 'Help' });
  const { x, y, width, height } = (await last.boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
  const at = { x: x + width / 2, y: y + height / 2 };
  expect(await last.evaluate((tool, { x, y }) => tool.contains(document.elementFromPoint(x, y)), at)).toBe(true);
  await expect(page.getByRole('slider', { name: /face of the clip box/ })).toHaveCount(0);
  await clean();
});
