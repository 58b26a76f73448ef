/** The laboratory of the circle, the room around a particle, and numbers of the text that are dragged. */
import { expect, test } from '@playwright/test';
import { live, openLesson, overflow } from './helpers.js';

/** @import { Locator, Page } from '@playwright/test' */

/** Drags from the middle of an element. @param {Page} page @param {Locator} what @param {number} x @param {number} y */
async function drag(page, what, x, y) {
  await what.scrollIntoViewIfNeeded();
  const box = await what.boundingBox();
  if (!box) throw new Error('There is nothing to drag.');
  const [left, top] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(left, top);
  await page.mouse.down();
  await page.mouse.move(left + x / 2, top + y / 2);
  await page.mouse.move(left + x, top + y);
  await page.mouse.up();
}

/** @param {Locator} slider */
const numberOf = async (slider) => Number(await slider.getAttribute('aria-valuenow'));

/** The angle that a range says. @param {Locator} theta */
const degrees = async (theta) =>
  Number.parseFloat((await theta.getAttribute('aria-valuetext'))?.replace('\u2212', '-') ?? '');

test('the child is turned by mouse and keyboard until f = 0, and Newton’s method stays out until it was guessed', async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#circle', width: 1440, height: 900 });
  const figure = await live(page, 'circle');
  const [told, theta] = [figure.locator('.told'), figure.getByRole('slider', { name: 'θ' })];
  await expect(told).toContainText('f is positive');
  await expect(figure.locator('.newton-way')).toHaveCount(0);
  await expect(figure.locator('.newton-law')).toBeHidden();
  await expect(figure.locator('.facts')).toBeHidden();
  // By the handle of the drawing, a quarter of the circle down.
  const hand = figure.locator('.drawing-box .hand');
  await drag(page, hand, -60, 120);
  // What was tried on the way is the bracket of the search.
  await expect(told).toContainText(/f is negative: the child is inside\. f changes its sign between −[\d.]+° and/);
  await expect(figure.locator('.bracket')).toHaveCount(2);
  // By the keys, half a degree at a time, up to the surface.
  await theta.focus();
  for (let press = 0; press < 120 && !(await told.textContent())?.startsWith('f = 0'); press += 1)
    await page.keyboard.press('ArrowRight');
  await expect(told).toContainText('f = 0: the child lies on the surface');
  await expect(figure.locator('.drawing-box .hand.landed')).toHaveCount(1);
  // The search comes to the same angle.
  const byHand = await degrees(theta);
  await theta.fill('200');
  const search = figure.getByRole('button', { name: 'One step of the search' });
  for (let step = 0; step < 10 && (await search.isEnabled()); step += 1) await search.click();
  await expect(search).toBeDisabled();
  expect(Math.abs((await degrees(theta)) - byHand)).toBeLessThanOrEqual(1);
  await page.locator('#predict-newton').getByRole('radio', { name: 'Nearer' }).check();
  await page.locator('#predict-newton').getByRole('button').first().click();
  await expect(figure.locator('.newton-way')).toHaveCount(1);
  await expect(figure.locator('.figure-count')).toContainText(/Dots: \d+ particles/, { timeout: 60_000 });
  await expect(figure.locator('.figure-count')).toContainText('left the plane of their slot');
  expect(await figure.locator('.lab-chart .dot').count()).toBeGreaterThan(300);
  // A press on a dot shows that landing, and so do the keys; the cross in the drawing is where it came down.
  const sentence = figure.locator('.side > p').first();
  const lands = figure.locator('.facts');
  await figure.locator('.lab-chart .dot').nth(200).click({ force: true });
  await expect(sentence).toContainText('Here this surface curves by');
  const dot = figure.getByRole('slider', { name: 'Dot' });
  await expect(dot).not.toHaveValue('0');
  const pressed = await sentence.textContent();
  await dot.focus();
  await page.keyboard.press('End');
  await expect(sentence).not.toHaveText(pressed ?? '');
  // It is the one with the sharpest bend, which falls shortest of 2r.
  await expect(lands).toContainText(/Newton lands at1\.[5-7]/);
  await page.keyboard.press('Home');
  await expect(lands).toContainText('Newton lands at1.99');
  await figure.getByRole('button', { name: 'Back to the sharpest bend' }).click();
  await expect(sentence).toContainText('At its sharpest bend');
  clean();
});

test('bend and r are dragged in the sentence, by keys, too; a bend of one’s own is a sphere’s', async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#circle' });
  const figure = await live(page, 'circle');
  await page.locator('#predict-newton').getByRole('button', { name: 'Skip' }).click();
  const [bend, radius] = ['Bend', 'r'].map((name) => figure.getByRole('slider', { name, exact: true }));
  const sentence = figure.locator('.side > p').first();
  await expect(sentence).toContainText('At its sharpest bend this surface');
  const before = await numberOf(bend);
  await drag(page, bend, 60, 0);
  expect(await numberOf(bend)).toBeGreaterThan(before);
  await expect(sentence).toContainText('A sphere curves by');
  await bend.press('Home');
  await expect(sentence).toContainText('bend · r = 0.00');
  await expect(figure.locator('.facts')).toContainText('Newton lands at2.000');
  await bend.press('End');
  await expect(sentence).toContainText('bend · r = 0.90');
  await expect(figure.locator('.facts')).toContainText('Newton lands at1.12');
  // Smaller particles see a flatter surface.
  await radius.press('Home');
  await expect(sentence).toContainText('bend · r = 0.23');
  await expect(figure.locator('.facts')).toContainText('Newton lands at1.8');
  await figure.getByRole('button', { name: 'Back to the sharpest bend' }).click();
  expect(await numberOf(bend)).toBe(before);
  await expect(sentence).toContainText('At its sharpest bend this surface');
  clean();
});

test('the radii of a particle and of those around it are dragged, and φ and τ follow step by step', async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#angles', width: 390, height: 844 });
  const figure = await live(page, 'angles');
  const [own, other] = ['particle', 'others'].map((of) => figure.getByRole('slider', { name: `Radius of the ${of}` }));
  await expect(figure.locator('.told')).toContainText(/takes φ = [\d.]+°; τ = [\d.]+° are free\. There is room/);
  await expect(figure.locator('.free')).toHaveCount(1);
  // τ is beside the numbers of the discs, not under one.
  const names = await figure
    .locator('.drawing text')
    .evaluateAll((all) => all.map((one) => ({ words: one.textContent, ...one.getBoundingClientRect().toJSON() })));
  const tau = names.find(({ words }) => words === 'τ');
  for (const one of names)
    if (one !== tau)
      expect(one.right <= tau.left || one.left >= tau.right || one.bottom <= tau.top || one.top >= tau.bottom).toBe(
        true,
      );
  // Equal radii: six in all.
  await own.press('Home');
  await other.press('Home');
  await expect(figure.locator('.facts')).toContainText('360° / φ6.00Placed, with the first one6');
  await figure.getByRole('slider', { name: 'Step' }).press('End');
  await expect(figure.locator('.told')).toContainText('has no room and is not added');
  // The handle on the rim of the other makes it larger, and there is room for fewer.
  await drag(page, figure.locator('.hand').last(), 30, 0);
  expect(await numberOf(other)).toBeGreaterThan(0.6);
  expect(await numberOf(own)).toBe(0.5);
  await expect(figure.locator('.facts')).not.toContainText('first one6');
  await drag(page, figure.locator('.hand').first(), 12, 26);
  expect(await numberOf(own)).toBeGreaterThan(0.5);
  expect(await overflow(page)).toBe(0);
  clean();
});

test('a number of the text is a handle of its figure, and follows it', async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings' });
  const figure = await live(page, 'rings');
  const text = page.locator('#rings > p');
  const level = figure.getByRole('slider', { name: 'Level' });
  const [ring, flat] = [
    text.getByRole('slider', { name: 'Ring', exact: true }),
    text.getByRole('slider', { name: 'Particles of the ring on a plane' }),
  ];
  await level.fill('5');
  await expect(ring).toHaveText('5');
  await expect(flat).toHaveText('30');
  await ring.press('ArrowRight');
  await expect(level).toHaveValue('6');
  await drag(page, flat, 24, 0);
  const now = await numberOf(flat);
  expect(now).toBeGreaterThan(36);
  await expect(level).toHaveValue(String(now / 6));
  await expect(ring).toHaveText(String(now / 6));
  clean();
});
