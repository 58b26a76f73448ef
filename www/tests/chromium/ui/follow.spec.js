/** The panel that follows a particle, event by event. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { afresh, atRest, open, scan, settled } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page */
const panel = (page) => page.getByRole('region', { name: /^Particle/ });
/** @param {Page} page */
const range = (page) => page.getByRole('slider', { name: /^Timeline, by/ });
/** @param {Page} page */
const followSeed = (page) => page.getByRole('radio', { name: 'Event' }).check({ force: true });
/** What the panel shows of the present event: the sentence, the drawings and the numbers. @param {Page} page */
const shown = (page) =>
  page.evaluate(() =>
    ['.follow-told', '.levels-now', '.follow-views'].map((part) => document.querySelector(part)?.innerHTML),
  );

test('a particle is followed by the keyboard; words, drawings, algorithm and transcript agree', async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('a particle is followed by the keyboard alone, and every step back is exact', async () => {
    await page.locator('#canvas-host').focus();
    await page.keyboard.press('Enter');
    await expect(page.getByRole('button', { name: 'Follow this particle' })).toBeVisible();
    await page.keyboard.press('Enter');
    await expect(range(page)).toBeFocused();
    await expect(range(page)).toHaveAttribute(
      'aria-valuetext',
      /^Level \d+ of \d+, particle [\d,]+: taken from the queue$/,
    );
    await expect(page.getByRole('button', { name: 'Follow this particle' })).toBeHidden();

    const forwards = [];
    const events = Number(await range(page).getAttribute('max')) + 1;
    expect(events).toBeGreaterThan(20);
    for (let at = 0; at < events; at += 1) {
      if (at > 0) await page.keyboard.press('ArrowRight');
      await expect(range(page)).toHaveValue(String(at));
      forwards.push(await shown(page));
    }
    await expect(range(page)).toHaveAttribute('aria-valuetext', /: done$/);
    for (let at = events - 1; at >= 0; at -= 1) {
      expect(await shown(page), `event ${at}`).toEqual(forwards[at]);
      if (at > 0) await page.keyboard.press('ArrowLeft');
    }
    await page.keyboard.press('End');
    await expect(range(page)).toHaveValue(String(events - 1));
    await page.keyboard.press('Home');
    await expect(range(page)).toHaveValue('0');

    const name = await panel(page).getByRole('heading', { level: 2 }).textContent();
    await page.keyboard.press('Shift+ArrowRight');
    await expect(panel(page).getByRole('heading', { level: 2 })).not.toHaveText(name ?? '');
    await page.keyboard.press('Shift+ArrowLeft');
    await expect(panel(page).getByRole('heading', { level: 2 })).toHaveText(name ?? '');
    await page.keyboard.press('Escape');
    await expect(panel(page)).toBeHidden();
    await expect(page.locator('#canvas-host')).toBeFocused();
  });

  await test.step('the seed places six children; words, drawings, algorithm and transcript agree', async () => {
    await afresh(page, { width: 1440, height: 900 });
    await followSeed(page);
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 0 of \d+, particle 0: taken from the queue$/);
    // Away from the control that the panel has moved under the pointer, which would explain itself.
    await page.mouse.move(0, 0);
    await expect(page.locator('#explain')).toBeHidden();
    expect((await scan(page)).violations).toEqual([]);
    await page.keyboard.press('End');
    await expect(
      panel(page)
        .getByRole('list', { name: 'Slots' })
        .getByText(/^added \d$/),
    ).toHaveCount(6);
    await expect(panel(page).getByRole('img', { name: /^Tangent plane of particle 0: six slots/ })).toBeVisible();
    await page.keyboard.press('ArrowLeft');
    await expect(range(page)).toHaveAttribute(
      'aria-valuetext',
      /^Level 0 of \d+, particle 0, slot 5: added particle 6$/,
    );
    await expect(panel(page).locator('.algorithm [aria-current=step]')).toHaveText(
      'otherwise add it, and let it wait its turn',
    );
    // The child keeps the distance; Newton's method in space does not.
    const distances = await panel(page).locator('.follow-key dd').allTextContents();
    expect(distances[0]).toBe('2.0000\u00a0r');
    expect(Number.parseFloat(distances[1])).toBeLessThan(2);
    await expect(panel(page).getByRole('img', { name: /Newton’s method would land 1\.\d+/ })).toBeVisible();
    expect((await scan(page)).violations).toEqual([]);

    const [file] = await Promise.all([
      page.waitForEvent('download'),
      panel(page).getByRole('button', { name: 'Save transcript' }).click(),
    ]);
    const text = await readFile(await file.path(), 'utf8');
    expect(text).toContain('Surface: x^2/a^2 + y^2/b^2 + z^2/c^2 = 1, a = 1, b = 0.7, c = 0.5');
    expect(text).toContain('A new particle, number 6, is added where the child of slot 5 landed.');
    expect(text.match(/lands on the surface, 2\.000 r from its parent/g)).toHaveLength(6);
  });

  await test.step('of an adaptive particle every push and every free angle is an event', async () => {
    await afresh(page, { width: 1280, height: 800 });
    await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      engine.setSetting('chord_error', 0.0004);
      engine.setSetting('sampling', 'adaptive');
    });
    await settled(page);
    await followSeed(page);
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 0: taken/);
    await page.keyboard.press('Shift+ArrowRight');
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 1: taken/);
    const told = panel(page).locator('.follow-told');
    for (let k = 0; k < 80 && !/are free/.test((await told.textContent()) ?? ''); k += 1)
      await page.keyboard.press('ArrowRight');
    await expect(told).toHaveText(/^The child of slot 1 takes φ = [\d.]+°; τ = [\d.]+° are free\. There is/);
    await expect(panel(page).locator('.drawing .taken')).toBeVisible();
    await expect(panel(page).locator('.drawing .free')).toBeVisible();
    expect(await panel(page).locator('.drawing .step').count()).toBeGreaterThan(2);
    await expect(panel(page).getByRole('img', { name: /child 1 pushed \d+ times; it takes φ/ })).toBeVisible();
    await expect(panel(page).locator('.algorithm [aria-current=step]')).toContainText('compare the angle φ');
    await expect(panel(page).getByText(/^§5 of the paper on this surface/)).toBeVisible();
    expect((await scan(page)).violations).toEqual([]);
  });
  await clean();
});

/** The view of the state. @param {Page} page */
const view = async (page) => (await page.evaluate(() => /** @type {any} */ (window).marchingParticles.state)).view;

test('the place of a particle on the timeline, in the picture and in words', async ({ page }) => {
  // Keys that are pressed while the timeline loads act when it has.
  let letCome = () => {};
  const held = new Promise((resolve) => {
    letCome = () => resolve(undefined);
  });
  await page.route(/timeline-[^/]*\.js/, (route) => held.then(() => route.continue()));
  const { clean } = await open(page, { width: 1280, height: 800 });
  await test.step('one timeline goes along levels, particles and events', async () => {
    const grain = (/** @type {string} */ name) => page.getByRole('radio', { name, exact: true });
    for (const key of ['<', '.', '.']) await page.keyboard.press(key);
    letCome();
    await grain('Particle').check({ force: true });
    // The first particle of level 2, as its children are placed.
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 2 of \d+, particle 7: /);
    await expect(page.locator('.levels-now')).toHaveText(/^Particle 7 of [\d,]+$/);
    expect(await view(page)).toMatchObject({ level: null, grain: 'particle', follow: [7, 0] });
    await page.getByRole('button', { name: 'Particle forward' }).click();
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 8: done$/);
    await grain('Event').check({ force: true });
    await page.getByRole('button', { name: 'Event forward' }).click();
    // After the last event comes the next particle, and before its first the one before.
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 9: taken from the queue$/);
    await range(page).focus();
    await page.keyboard.press('PageUp');
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 8: done$/);
    await page.keyboard.press('Alt+ArrowRight');
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 3 of \d+, particle 19: taken/);
    await page.keyboard.press('Shift+ArrowLeft');
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 2 of \d+, particle 18: taken/);
    await grain('Level').check({ force: true });
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 2 of \d+: 12 particles, 19 so far$/);
    await range(page).focus();
    await page.keyboard.press('Escape');
    await expect(panel(page)).toBeHidden();
    expect(await view(page)).toMatchObject({ grain: 'level', follow: null });
  });

  await test.step('a child that is pointed at stands out in every view and in the picture', async () => {
    await afresh(page, { width: 1280, height: 800 });
    await followSeed(page);
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 0: taken/);
    await page.keyboard.press('End');
    // The circle of the last slot, and six children in place.
    await expect(page.locator('.marks .child-added')).toHaveCount(6);
    await expect(page.locator('.marks .child-circle')).toHaveCount(1);
    await panel(page).locator('.slots [data-slot="2"]').hover();
    await expect(panel(page).locator('.drawing [data-slot="2"].hot').first()).toBeAttached();
    await expect(panel(page).getByText('Slot 2 from the side')).toBeVisible();
    await expect(page.locator('.marks .child.now')).toHaveCount(1);
    await expect(page.locator('.marks text.strong', { hasText: /^2$/ })).toBeVisible();
    await panel(page).locator('.drawing [data-slot="4"] .slot').hover({ force: true });
    await expect(panel(page).getByText('Slot 4 from the side')).toBeVisible();
    await expect(panel(page).locator('.slots .hot')).toHaveAttribute('data-slot', '4');
  });

  await test.step('a screen reader hears where the steps come to rest, and not every one of them', async () => {
    await afresh(page, { width: 1280, height: 800 });
    await followSeed(page);
    await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 0: taken/);
    const spoken = panel(page).locator('.follow-stepper [aria-live=polite]');
    await expect(spoken).toHaveText('Particle 0 is taken from the queue. Its children are to be placed.');
    await spoken.evaluate((element) => {
      const heard = /** @type {string[]} */ ([]);
      /** @type {any} */ (window).heard = heard;
      new MutationObserver(() => heard.push(element.textContent ?? '')).observe(element, { childList: true });
    });
    for (let k = 0; k < 20; k += 1) await page.keyboard.press('ArrowRight');
    const told = panel(page).locator('.follow-told');
    await expect(spoken).toHaveText((await told.textContent()) ?? '');
    const heard = await page.evaluate(() => /** @type {any} */ (window).heard);
    // However slow the machine is: fewer than the steps, and the last of them is among what is heard.
    expect(heard.length).toBeLessThan(20);
    expect(heard.at(-1)).toBe(await told.textContent());
    // The sentence for the eye is not read out a second time.
    await expect(told).toHaveAttribute('aria-hidden', 'true');
  });

  await test.step('a surface that changes is told, and its particle at the same place is offered', async () => {
    await afresh(page, { width: 1280, height: 800 });
    await followSeed(page);
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 0 of \d+, particle 0/);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setParameter('a', 1.3));
    await settled(page);
    await expect(panel(page).getByText('The surface has changed.')).toBeVisible();
    // What is open stays as it was.
    await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 0 of \d+, particle 0/);
    await panel(page).getByRole('button', { name: 'Follow the particle at the same place' }).click();
    await expect(range(page)).toBeFocused();
    await expect(panel(page).getByText('The surface has changed.')).toBeHidden();
    await expect(range(page)).toHaveAttribute(
      'aria-valuetext',
      /^Level \d+ of \d+, particle [\d,]+: taken from the queue$/,
    );
  });

  await test.step('too many particles are followed at a coarser radius', async () => {
    await afresh(page);
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setSetting('radius_share', 0.0025));
    await settled(page);
    await followSeed(page);
    await expect(
      panel(page).getByText(/about 2\d,\d+ particles are to be expected\. The events of at most 20,000/),
    ).toBeVisible();
    await panel(page)
      .getByRole('button', { name: /^Follow at a coarser radius/ })
      .click();
    await expect(range(page)).toHaveAttribute('aria-valuetext', /: taken from the queue$/, { timeout: 40_000 });
  });
  await clean();
});

test('the place is part of the link, and one that is not there leads to the nearest', async ({ page }) => {
  const { clean } = await open(page, { width: 1280, height: 800 });
  await followSeed(page);
  await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 0: taken/);
  await page.keyboard.press('Shift+ArrowRight');
  await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 1: taken/);
  for (const key of ['ArrowRight', 'ArrowRight']) await page.keyboard.press(key);
  await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 1 of \d+, particle 1, slot 1: starts/);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  expect(JSON.parse(Buffer.from(new URL(link).hash.split('.')[2], 'base64url').toString()).view).toMatchObject({
    grain: 'event',
    follow: [1, 2],
  });
  const undo = page.getByRole('button', { name: 'Undo' });
  await expect(undo).toHaveAttribute('aria-disabled', 'true');
  await page.goto('about:blank');
  await open(page, { width: 1280, height: 800, hash: new URL(link).hash });
  await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level 1 of \d+, particle 1, slot 1: starts/);
  await expect(page.getByRole('radio', { name: 'Event' })).toBeChecked();
  const far = Buffer.from(JSON.stringify({ view: { grain: 'event', follow: [999999, 3] } })).toString('base64url');
  await page.goto('about:blank');
  await open(page, { width: 1280, height: 800, hash: `#v1.j.${far}` });
  await expect(page.getByText('The link names particle 999,999. The last one is shown.')).toBeVisible();
  await expect(range(page)).toHaveAttribute('aria-valuetext', /^Level \d+ of \d+, particle \d,\d+/);
  await clean();
});

test('in a relaxation step the panel shows who pushes the particle, and where it goes', async ({ page }) => {
  const { clean } = await open(page, { width: 1280, height: 800 });
  await followSeed(page);
  await expect(range(page)).toHaveAttribute('aria-valuetext', /particle 0: taken/);
  await panel(page).getByRole('button', { name: 'Its relaxation' }).click();
  const told = panel(page).locator('.follow-told');
  await expect(told).toHaveText(/^Step 1 of 10: 6 particles push it, together by \S+\sr\. A step of 0\.6 makes/);
  await expect(range(page)).toHaveAttribute('aria-valuetext', 'Relaxation step 1 of 10');
  await expect(panel(page).locator('.rest .push')).toHaveCount(6);
  await expect(panel(page).getByRole('img', { name: /in relaxation step 1: 6 particles push it/ })).toBeVisible();
  // Of the slots nothing is said here.
  await expect(panel(page).getByRole('list', { name: 'Slots' })).toBeHidden();
  const pushers = panel(page).getByRole('list', { name: '6 particles push' });
  await expect(pushers.getByRole('listitem').first()).toHaveText(
    /^Particle \d+, [12]\.\d+\sr away, pushes by 0\.\d+\sr$/,
  );
  // The seed lies evenly between its six; somewhere a particle is pushed far.
  await panel(page).getByRole('button', { name: 'Follow the one that is pushed most' }).click();
  await expect(told).toContainText('cut off there');
  expect(Number((await told.textContent())?.match(/together by ([\d.]+)/)?.[1])).toBeGreaterThan(0.35);
  expect((await scan(page)).violations).toEqual([]);
  await page.getByRole('button', { name: 'Level forward' }).click();
  await expect(told).toHaveText(/^Step 2 of 10: /);
  const forwards = await told.textContent();
  await page.getByRole('button', { name: 'Level forward' }).click();
  await expect(told).toHaveText(/^Step 3 of 10: /);
  await page.getByRole('button', { name: 'Level back' }).click();
  await expect(told).toHaveText(forwards ?? '');
  const [file] = await Promise.all([
    page.waitForEvent('download'),
    panel(page).getByRole('button', { name: 'Save transcript' }).click(),
  ]);
  expect((await readFile(await file.path(), 'utf8')).match(/^Step \d+ of 10: /gm)).toHaveLength(10);
  const link = await page.evaluate(() => /** @type {any} */ (window).marchingParticles.link());
  await panel(page).getByRole('button', { name: 'Its events' }).click();
  await expect(panel(page).getByRole('list', { name: 'Slots' })).toBeVisible();
  await page.goto('about:blank');
  await open(page, { width: 1280, height: 800, hash: new URL(link).hash });
  await expect(told).toHaveText(forwards ?? '');
  await clean();
});

test('a bundle that is missing is named, and tried again', async ({ page }) => {
  await open(page);
  await page.route(/lesson_bg/, (route) => route.abort());
  await followSeed(page);
  await expect(panel(page).getByText(/The part of the page that follows particles did not load/)).toBeVisible();
  await page.unroute(/lesson_bg/);
  await panel(page).getByRole('button', { name: 'Try again' }).click();
  await expect(range(page)).toHaveAttribute('aria-valuetext', /: taken from the queue$/);
});

test('on a phone the panel is a sheet under the picture', async ({ page }) => {
  const { clean } = await open(page, { width: 390, height: 844 });
  for (const [width, height, colorScheme] of /** @type {const} */ ([
    [390, 844, 'dark'],
    [320, 640, 'light'],
  ])) {
    await page.emulateMedia({ colorScheme });
    await afresh(page, { width, height });
    await atRest(page);
    const free = await page.locator('#view').boundingBox();
    if (!free) throw new Error('the view has no box');
    await page.mouse.click(free.x + free.width / 2, free.y + free.height / 2);
    await page.getByRole('button', { name: 'Follow this particle' }).click();
    await expect(range(page)).toBeFocused();
    await page.keyboard.press('End');
    await expect(range(page)).toHaveAttribute('aria-valuetext', /: done$/);
    const box = await panel(page).boundingBox();
    expect(box?.width).toBe(width);
    expect(box?.y).toBeGreaterThan(0.3 * height);
    const body = panel(page).locator('.panel-body');
    expect(await body.evaluate(({ scrollWidth, clientWidth }) => scrollWidth - clientWidth)).toBe(0);
    expect((await scan(page)).violations).toEqual([]);
    await panel(page).getByRole('button', { name: 'Close' }).click();
    await expect(page.locator('#tabs')).toBeVisible();
  }
  await clean();
});
