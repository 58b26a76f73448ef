/** The chapter in which the learner is the algorithm: what the run accepts, what it objects to, and what is kept. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { packTask } from '../../../src/learn/task.js';
import { live, openLesson, overflow } from './helpers.js';

/** @import { Locator } from '@playwright/test' */

/** @param {Locator} figure @param {string} name */
const press = (figure, name) => figure.getByRole('button', { name }).click();

/** Leaves all ten particles to the run. @param {Locator} figure */
async function leaveAll(figure) {
  for (let particle = 0; particle < 10; particle += 1) {
    await expect(figure.locator('.plane-question')).toContainText(`Particle ${particle}, slot`);
    await press(figure, 'The rest of this particle, too');
  }
  await expect(figure.locator('.plane-question')).toHaveText('Ten particles are done.');
}

test('the run accepts its own decisions, from the keyboard, too, and objects to others', async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#plane', width: 390 });
  const figure = await live(page, 'plane');
  const [told, score] = [figure.locator('.told'), figure.locator('.plane .figure-count')];
  await figure.getByRole('button', { name: 'A new one' }).focus();
  for (let slot = 0; slot < 6; slot += 1) {
    await expect(figure.locator('.plane-question')).toContainText(`Particle 0, slot ${slot}`);
    await page.keyboard.press('Enter');
  }
  await expect(figure.locator('.plane-question')).toContainText('Particle 1, slot 0');
  await press(figure, 'A new one');
  await expect(told).toContainText('The run objects. Particle 0 is the parent');
  await press(figure, 'The parent');
  await expect(told).toContainText('Slot 0 holds the parent');
  await press(figure, 'A new one');
  await expect(told).toContainText('Particle 6 lies 0.00 r from this child, within 1.40 r.');
  await figure.getByRole('combobox').selectOption('particle 6');
  await press(figure, 'It is there already');
  await expect(told).toContainText('matched particle 6');
  await expect(score).toHaveText('Particle 2 of 10 · 2 mistakes · 8 slots decided.');
  // Slot 2 lies at 120°, above on the left.
  const drawing = figure.locator('.plane-drawing svg');
  await drawing.evaluate((element) => element.scrollIntoView({ block: 'center', behavior: 'instant' }));
  const box = await drawing.boundingBox();
  if (!box) throw new Error('There is no drawing.');
  const radius = Math.min(box.width, box.height) / 10.1;
  await page.mouse.click(box.x + box.width / 2 - radius, box.y + box.height / 2 - Math.sqrt(3) * radius);
  await expect(told).toContainText('The child of slot 2 became particle 7.');
  // Back over a slot that was missed: the mistakes stay.
  const question = figure.locator('.plane-question');
  for (const place of ['Particle 1, slot 2', 'Particle 1, slot 1', 'Particle 1, slot 0', 'Particle 0, slot 5']) {
    await press(figure, 'One slot back');
    await expect(question).toContainText(place);
  }
  await expect(score).toHaveText('Particle 1 of 10 · 2 mistakes · 5 slots decided.');
  await press(figure, 'A new one');
  await expect(question).toContainText('Particle 1, slot 0');
  expect(await overflow(page)).toBe(0);
  clean();
});

test('a slot, its line and its place are pointed at together', async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  await press(figure, 'A new one');
  await figure.locator('.algorithm li', { hasText: 'otherwise add it' }).hover();
  await expect(figure.locator('[data-slot="0"].hot').first()).toBeAttached();
  await expect(figure.locator('[data-slot="1"].hot')).toHaveCount(0);
  await expect(figure.locator('.picture')).toHaveAttribute('data-rings', '1');
});

test('in a plane the front never meets itself out of step, and on the cap it does', async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  await leaveAll(figure);
  await expect(figure.locator('.told')).toContainText('The front never met itself out of step.');
  await press(figure, 'A cap');
  await leaveAll(figure);
  await expect(figure.locator('.told')).toContainText(/out of step [1-9]\d* times?: a seam begins there/);
  // The camera has turned to the last of these places, which is ringed.
  const rings = () => figure.locator('.picture').getAttribute('data-rings').then(Number);
  await expect.poll(rings).toBeGreaterThan(0);
  await press(figure, 'Begin again');
  await expect(figure.locator('.plane-question')).toContainText('Particle 0, slot 0');
  await expect(figure.locator('.plane .figure-count')).toHaveText('Particle 1 of 10 · 0 mistakes · 0 slots decided.');
  await expect.poll(rings).toBe(0);
});

test('what is below the discs says nothing of later places', async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  // A plane is lit alike everywhere: but for the seed, no pixel is much darker or lighter than most.
  const share = await figure.locator('.picture canvas').evaluate((element) => {
    const canvas = /** @type {HTMLCanvasElement} */ (element);
    const image = canvas.getContext('2d')?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
    const reds = [...image].filter((_, k) => k % 4 === 0 && image[k + 3] > 0);
    const median = [...reds].sort((one, other) => one - other)[Math.floor(reds.length / 2)];
    return reds.filter((red) => Math.abs(red - median) < 8).length / reds.length;
  });
  expect(share).toBeGreaterThan(0.95);
});

test('the live line is the one that asks, and with the answer to the question the seed is done', async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  const line = figure.locator('.algorithm [aria-current]');
  await expect(line).toHaveText('Slot 0 holds the parent, if p has one');
  await press(figure, 'A new one');
  await expect(line).toHaveText('For each child: find the nearest of those particles');
  const question = page.locator('#predict-children');
  await question.getByLabel('New children').fill('5');
  await question.getByRole('button', { name: 'Reveal' }).click();
  await expect(question.getByRole('status')).toContainText('You said 5.3 children are new. Slot 0 holds the parent');
  await expect(figure.locator('.plane-question')).toContainText('Particle 1, slot 0');
  await expect(line).toHaveText('Slot 0 holds the parent, if p has one');
});

test('a clicker goes slot by slot, and back', async ({ page }) => {
  await openLesson(page, { hash: '#predict-children&mode=present' });
  const question = (await live(page, 'plane')).locator('.plane-question');
  for (const [key, place] of [
    ['PageDown', 'Particle 1, slot 0'],
    ['PageDown', 'Particle 1, slot 1'],
    ['PageDown', 'Particle 1, slot 2'],
    ['PageUp', 'Particle 1, slot 1'],
    ['PageUp', 'Particle 1, slot 0'],
  ]) {
    await page.keyboard.press(key);
    await expect(question).toContainText(place);
  }
});

test('mistakes are saved with an assignment, those of the first round, too', async ({ page }) => {
  const task = packTask({
    title: 'T',
    setup: { what: 'order', left: 'queue', right: 'stack' },
    locks: [],
    questions: [],
  });
  await openLesson(page, { hash: `#plane&task=${task}` });
  const figure = await live(page, 'plane');
  await press(figure, 'The parent');
  await expect(figure.locator('.told')).toContainText('A seed has no parent');
  const download = page.waitForEvent('download');
  await page.locator('#assignment').getByRole('button', { name: 'Save as JSON' }).click();
  const work = JSON.parse(await readFile(await (await download).path(), 'utf8'));
  const ofPlane = (/** @type {{ stop: string }} */ { stop }) => stop === 'plane-plane';
  const saved = work.predictions.find(ofPlane);
  expect(saved.guess).toBe(1);
  expect(saved.answer).toContain('particle 0, slot 0: said parent');
  // Beginning again in the middle of a particle that the run decides waits for it, and keeps what was.
  await press(figure, 'The rest of this particle, too');
  await press(figure, 'Begin again');
  await expect(figure.locator('.plane .figure-count')).toHaveText('Particle 1 of 10 · 0 mistakes · 0 slots decided.');
  await leaveAll(figure);
  const [file] = await Promise.all([
    page.waitForEvent('download'),
    page.locator('#assignment').getByRole('button', { name: 'Save as JSON' }).click(),
  ]);
  const { guess, answer } = JSON.parse(await readFile(await file.path(), 'utf8')).predictions.find(ofPlane);
  expect(guess).toBe(1);
  expect(answer).toContain('1 mistake; 0 slots decided; 6 left to the run; particle 0, slot 0: said parent');
  expect(answer).toContain('best of 2 rounds: 0 mistakes, 0 slots decided, 60 left to the run');
});
