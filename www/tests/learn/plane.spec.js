/** The chapter in which the learner is the algorithm: what the run accepts, what it objects to, and what is kept. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { packTask } from '../../src/learn/task.js';
import { live, openLesson, overflow } from './helpers.js';

/** @import { Locator } from '@playwright/test' */

/** @param {Locator} figure @param {string} name */
const press = (figure, name) => figure.getByRole('button', { name }).click();

/** Leaves all ten particles to the run. @param {Locator} figure */
async function leaveAll(figure) {
  for (let particle = 0; particle < 10; particle += 1) {
    await expect(figure.locator('.plane-question')).toContainText(`Particle ${particle}, slot`);
    await press(figure, 'Leave this particle to the run');
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
  const box = await figure.locator('.plane-drawing svg').boundingBox();
  if (!box) throw new Error('There is no drawing.');
  const radius = box.width / 10.1;
  await page.mouse.click(box.x + box.width / 2 - radius, box.y + box.height / 2 - Math.sqrt(3) * radius);
  await expect(told).toContainText('The child of slot 2 became particle 7.');
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
});

test('in a plane the front never meets itself out of step, and on the cap it does', async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  await leaveAll(figure);
  await expect(figure.locator('.told')).toContainText('The front never met itself out of step.');
  await press(figure, 'A cap');
  await leaveAll(figure);
  await expect(figure.locator('.told')).toContainText(/out of step [1-9]\d* times?: a seam begins there/);
  await press(figure, 'Begin again');
  await expect(figure.locator('.plane-question')).toContainText('Particle 0, slot 0');
  await expect(figure.locator('.plane .figure-count')).toHaveText('Particle 1 of 10 · 0 mistakes · 0 slots decided.');
});

test('mistakes are saved with an assignment', async ({ page }) => {
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
  const saved = work.predictions.find((/** @type {{ stop: string }} */ { stop }) => stop === 'plane-plane');
  expect(saved.guess).toBe(1);
  expect(saved.answer).toContain('particle 0, slot 0: said parent');
});
