/** The chapter on a surface that moves: by mouse and by keyboard, back and forth, beside other lanes, and at rest. */
import { expect, test } from '@playwright/test';
import { axe } from '../../axe.js';
import { fingerprint, live, openLesson, overflow, TORUS } from './helpers.js';

/** @import { Locator, Page } from '@playwright/test' */

/** The numbers of particles in both lanes. @param {Locator} figure */
const counts = async (figure) =>
  (await figure.locator('.pair figcaption').allTextContents()).map((text) =>
    Number(/([\d,]+) particle/.exec(text)?.[1].replace(',', '')),
  );

/** Answers the question, which opens the figures. @param {Page} page */
async function answer(page) {
  const question = page.locator('#predict-moving');
  await question.getByRole('radio', { name: 'The order' }).check();
  await question.getByRole('button', { name: 'Reveal' }).click();
  await expect(question).toHaveAttribute('data-state', 'open');
  await expect(question).toContainText('As you said.');
}

test('particles follow the slider, by keyboard and by mouse, back on what was kept, and a front comes at rest', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#moving' });
  const figure = await live(page, 'moving');
  const chart = figure.locator('.chart');
  await expect(chart).toBeHidden();
  await expect(figure.locator('.compare')).toBeHidden();
  const [front, system] = await counts(figure);
  // The answer is about the other end of the slider, and the figure goes there.
  await answer(page);
  await expect(chart).toBeVisible();
  const slider = figure.getByRole('slider', { name: 'Parameter' });
  await expect(slider).toHaveAttribute('aria-valuetext', 'a = 1.60');
  await expect(figure.locator('.pair figcaption').first()).toContainText('It flows');
  await expect.poll(async () => (await counts(figure))[0]).toBeGreaterThan(1.7 * front);
  await expect.poll(async () => (await counts(figure))[1]).toBeGreaterThan(1.5 * system);
  await expect(figure.getByRole('row', { name: /^Largest hole/ })).toBeVisible();
  const atEnd = await counts(figure);
  // In the middle of the slider, by mouse: both are as they were there.
  await slider.scrollIntoViewIfNeeded();
  const box = await slider.boundingBox();
  if (!box) throw new Error('There is no slider.');
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await expect(slider).toHaveAttribute('aria-valuetext', /a = 1\.2[01]/);
  await expect.poll(async () => (await counts(figure))[0]).toBeLessThan(1.6 * front);
  const six = async () => Number(/flow ([\d.]+) %/.exec(await chart.innerText())?.[1]);
  await expect.poll(six).toBeLessThan(80);
  await slider.fill('60');
  await expect.poll(() => counts(figure)).toEqual(atEnd);
  // The last place is at rest, where the front begins anew.
  await slider.press('End');
  await expect(slider).toHaveAttribute('aria-valuetext', 'a = 1.60, at rest');
  await expect(figure.locator('.pair figcaption').first()).toContainText('A new front');
  await expect.poll(six).toBeGreaterThan(80);
  await figure.getByRole('button', { name: 'Replay' }).click();
  await expect(slider).toHaveValue('61');
  // A table is pale until it is that of this place.
  await expect(figure.locator('[aria-busy="true"]')).toHaveCount(0);
  expect((await axe(page)).violations.map(({ id }) => id)).toEqual([]);
  clean();
});

test('the lane beside it and the surface are chosen: none is born there, and the tanglecube falls apart', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#moving', width: 390 });
  const figure = await live(page, 'moving');
  const slider = figure.getByRole('slider');
  await slider.fill('12');
  await expect(figure.locator('.pair figcaption').first()).toContainText('It flows');
  await figure.getByRole('combobox', { name: 'Beside it' }).selectOption('Without births and deaths');
  await expect(slider).toHaveValue('0');
  await expect(figure.locator('.pair figcaption').first()).toContainText('A front: 1,');
  const [born, beside] = await counts(figure);
  expect(beside).toBe(born);
  await slider.fill('60');
  await expect.poll(async () => (await counts(figure))[0]).toBeGreaterThan(1.7 * born);
  expect((await counts(figure))[1]).toBe(born);
  await figure.getByRole('combobox', { name: 'Surface' }).selectOption('A tanglecube falls into eight');
  await expect(slider).toHaveAttribute('aria-valuetext', 'c = 11.00');
  await expect.poll(async () => (await counts(figure))[1]).toBeGreaterThan(1500);
  // Two choices at once: what the first one has begun is given up.
  await figure.getByRole('combobox', { name: 'Surface' }).selectOption('An ellipsoid is drawn out');
  await figure.getByRole('combobox', { name: 'Beside it' }).selectOption('A new front each time');
  await expect(figure.locator('.pair figcaption').last()).toContainText('A new front each time: 1,');
  expect(await overflow(page)).toBe(0);
  clean();
});

test('the table goes along with its replay', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#moving' });
  const figure = await live(page, 'moving');
  await answer(page);
  const caption = figure.locator('.compare caption');
  await expect(caption).toHaveText('a = 1.60');
  await expect(figure.locator('[aria-busy="true"]')).toHaveCount(0);
  await page.emulateMedia({ reducedMotion: 'no-preference' });
  await figure.getByRole('slider').press('Home');
  await expect(caption).toHaveText('a = 0.80');
  await figure.getByRole('button', { name: 'Replay' }).click();
  // It has figures of the moments in between, and of the last one as soon as they are there.
  await expect(caption).toHaveText(/a = (0\.9|1\.[0-4])/);
  await expect(figure.getByRole('slider')).toHaveValue('61');
  await expect(figure.locator('[aria-busy="true"]')).toHaveCount(0);
  await expect(caption).toHaveText('a = 1.60, at rest');
  clean();
});

test('the learner’s own surface moves by its parameter', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: `#moving&surface=${TORUS}` });
  const figure = await live(page, 'moving');
  await expect(figure.getByText('if its formula has a parameter')).toHaveCount(0);
  await figure.getByRole('combobox', { name: 'Surface' }).selectOption('Yours, by R');
  const slider = figure.getByRole('slider', { name: 'Parameter' });
  await expect(slider).toHaveAttribute('aria-valuetext', 'R = 0.70');
  const [before] = await counts(figure);
  await slider.fill('60');
  await expect(slider).toHaveAttribute('aria-valuetext', 'R = 0.45');
  await expect(figure.locator('.pair figcaption').first()).toContainText('It flows');
  // The area of a torus goes with R. On surfaces that shrink up to an eighth more particles are left (docs/flow.md).
  await expect.poll(async () => (await counts(figure))[0] / before / (0.45 / 0.7)).toBeLessThan(1.125);
  expect((await counts(figure))[0] / before / (0.45 / 0.7)).toBeGreaterThan(0.95);
  clean();
});

test('under reduced motion the picture is where the slider is, at once', { tag: '@all' }, async ({ page }) => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await openLesson(page, { hash: '#moving' });
  const figure = await live(page, 'moving');
  const picture = figure.locator('.picture').first();
  const seen = new Set([await fingerprint(picture)]);
  await figure.getByRole('slider').fill('60');
  for (;;) {
    seen.add(await fingerprint(picture));
    if ((await figure.locator('.pair figcaption').first().innerText()).startsWith('It flows')) break;
  }
  await expect.poll(() => fingerprint(picture)).not.toBe([...seen][0]);
  seen.add(await fingerprint(picture));
  expect(seen.size).toBe(2);
});

test('the link to the first page grabs its surface', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#moving' });
  await page.getByRole('link', { name: 'Grab the ellipsoid' }).click();
  await page.waitForURL(/\?grab/);
  await expect(page.getByRole('button', { name: 'Grab', exact: true })).toHaveAttribute('aria-pressed', 'true');
});
