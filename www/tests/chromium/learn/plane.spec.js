/** The chapter in which the learner is the algorithm: what the run accepts, what it objects to, and what is kept. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { packTask } from '../../../src/learn/task.js';
import { live, openLesson, overflow } from './helpers.js';

/** @import { Locator } from '@playwright/test' */

/** @param {Locator} figure @param {string} name */
const press = (figure, name) => figure.getByRole('button', { name }).click();

/** Skips the question that is asked before particle B has its turn, if it was not. @param {Locator} figure */
async function skip(figure) {
  const asked = figure.page().locator('#predict-children');
  if (await asked.getByRole('button', { name: 'Skip' }).isVisible())
    await asked.getByRole('button', { name: 'Skip' }).click();
}

/** Leaves the two particles of the plane to the run. @param {Locator} figure */
async function leaveAll(figure) {
  const question = figure.locator('.plane-question');
  for (const [particle, slots] of /** @type {const} */ ([
    ['A', [0, 1, 2, 3, 4, 5]],
    ['B', [1, 2, 3, 4, 5]],
  ]))
    for (const slot of slots) {
      if (particle === 'B' && slot === 1) await skip(figure);
      await expect(question).toContainText(`Particle ${particle}, slot ${slot}`);
      await press(figure, 'Let the run decide');
    }
  await expect(question).toContainText('Two particles are done.');
}

test('the run accepts its own decisions, from the keyboard, too, and objects to others', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#plane', width: 390 });
  const figure = await live(page, 'plane');
  const [told, score] = [figure.locator('.told'), figure.locator('.plane .figure-count')];
  const question = figure.locator('.plane-question');
  await figure.getByRole('button', { name: 'A new one' }).focus();
  for (let slot = 0; slot < 6; slot += 1) {
    await expect(question).toContainText(`Particle A, slot ${slot}`);
    await page.keyboard.press('Enter');
  }
  // What B will do is asked before its turn. Slot 0 of a child holds the parent, and nobody is asked.
  await expect(question).toContainText('Particle A is done.');
  await expect(figure.getByRole('button', { name: 'A new one' })).toBeHidden();
  await skip(figure);
  await expect(question).toContainText('Particle B, slot 1');
  await press(figure, 'A new one');
  await expect(told).toContainText('Particle G lies 0.00 r from this child, within the tolerance of 1.40 r.');
  await figure.getByRole('combobox').selectOption('particle G');
  await press(figure, 'It is there already');
  await expect(told).toContainText('matched particle G');
  await expect(score).toHaveText('Particle 2 of 2 · 1 mistake · 7 slots decided.');
  // Slot 2 lies at 120°, above on the left.
  const drawing = figure.locator('.plane-drawing svg');
  await drawing.evaluate((element) => element.scrollIntoView({ block: 'center', behavior: 'instant' }));
  const box = await drawing.boundingBox();
  if (!box) throw new Error('There is no drawing.');
  const radius = Math.min(box.width, box.height) / 10.1;
  await page.mouse.click(box.x + box.width / 2 - radius, box.y + box.height / 2 - Math.sqrt(3) * radius);
  await expect(told).toContainText('The child of slot 2 became particle H.');
  // Back over a slot that was missed: the mistakes stay.
  for (const place of ['Particle B, slot 2', 'Particle B, slot 1', 'Particle A, slot 5']) {
    await press(figure, 'One slot back');
    await expect(question).toContainText(place);
  }
  await expect(score).toHaveText('Particle 1 of 2 · 1 mistake · 5 slots decided.');
  expect(await overflow(page)).toBe(0);
  // A reload goes on where the learner stopped.
  await page.reload();
  await live(page, 'plane');
  await expect(question).toContainText('Particle A, slot 5');
  await expect(score).toHaveText('Particle 1 of 2 · 1 mistake · 5 slots decided.');
  clean();
});

test('after two particles of the plane comes the seam of the cap, where rows are out of step', { tag: '@all' }, async ({
  page,
}) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  await leaveAll(figure);
  await press(figure, 'Go to the cap');
  const question = figure.locator('.plane-question');
  await expect(question).toContainText(/Particle [A-Z]+, slot 1/);
  const told = figure.locator('.told').last();
  let words = '';
  for (let slot = 0; slot < 6 && !(await question.innerText()).startsWith('The front has met itself'); slot += 1) {
    const before = await question.innerText();
    await press(figure, 'Let the run decide');
    await expect(question).not.toHaveText(before);
    words += await told.innerText();
  }
  expect(words).toContain('out of step');
  await expect(question).toContainText('The front has met itself, out of step.');
  await expect(figure.getByRole('button', { name: 'Go to the cap' })).toHaveCount(0);
  await expect(figure.locator('.algorithm')).toBeVisible();
  await press(figure, 'Begin again');
  await expect(figure.locator('.plane .figure-count')).toHaveText('Particle 1 of 1 · 0 mistakes · 0 slots decided.');
});

test('the whole disc of a particle counts as the particle, and its number is under nothing', { tag: '@all' }, async ({
  page,
}) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  const question = figure.locator('.plane-question');
  await press(figure, 'A cap, at its seam');
  await expect(question).toContainText(/Particle [A-Z]+, slot 1/);
  // Every number lies within its disc, clear of the shapes of the children.
  const drawing = figure.locator('.plane-drawing svg');
  await drawing.evaluate((element) => element.scrollIntoView({ block: 'center', behavior: 'instant' }));
  for (let slot = 1; slot < 6 && !(await question.innerText()).startsWith('The front has met itself'); slot += 1) {
    const covered = await drawing.evaluate((svg) => {
      const shapes = [...svg.querySelectorAll('.fate, .self')].map((one) => one.getBoundingClientRect());
      const middles = [...svg.querySelectorAll('.number:not(.strong)')].map((one) => one.getBoundingClientRect());
      return middles.filter(({ x, y, width, height }) =>
        shapes.some(
          (one) =>
            one.left < x + width / 2 &&
            x + width / 2 < one.right &&
            one.top < y + height / 2 &&
            y + height / 2 < one.bottom,
        ),
      ).length;
    });
    expect(covered).toBe(0);
    const before = await question.innerText();
    await press(figure, 'Let the run decide');
    await expect(question).not.toHaveText(before);
  }
  await press(figure, 'A plane');
  for (let slot = 0; slot < 6; slot += 1) {
    await expect(question).toContainText(`Particle A, slot ${slot}`);
    await press(figure, 'A new one');
  }
  await skip(figure);
  // The particle itself covers what is below it.
  await expect(question).toContainText('Particle B, slot 1');
  await drawing.evaluate((svg) => {
    const { left, top, width, height } = svg.getBoundingClientRect();
    svg.dispatchEvent(new MouseEvent('click', { bubbles: true, clientX: left + width / 2, clientY: top + height / 2 }));
  });
  await expect(figure.locator('.told').last()).toHaveText('That is particle B itself.');
  // Slot 1 of particle B holds a particle: all over its disc a press is that particle, though the
  // slot lies on it.
  for (const [dx, dy] of [
    [0, 0],
    [0.6, 0.6],
    [-0.3, -0.8],
  ]) {
    await expect(question).toContainText('Particle B, slot 1');
    // At once, since figures above may still move it.
    await drawing.evaluate(
      (svg, [right, up]) => {
        const { left, top, width, height } = svg.getBoundingClientRect();
        const radius = Math.min(width, height) / 10.1;
        const place = {
          clientX: left + width / 2 + (1 + right) * radius,
          clientY: top + height / 2 - (Math.sqrt(3) + up) * radius,
        };
        svg.dispatchEvent(new MouseEvent('click', { bubbles: true, ...place }));
      },
      [dx, dy],
    );
    await expect(figure.locator('.told').last()).toContainText('matched particle G');
    await press(figure, 'One slot back');
  }
});

test('code comes after the cap, and what is asked of B may be answered at once', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#plane' });
  const figure = await live(page, 'plane');
  await expect(figure.locator('.algorithm')).toHaveCount(0);
  const question = page.locator('#predict-children');
  await question.getByLabel('New particles').fill('5');
  await question.getByRole('button', { name: 'Reveal' }).click();
  await expect(question.getByRole('status')).toContainText('It is 3. You said 5.One place around B holds A');
  for (let slot = 0; slot < 6; slot += 1) {
    await expect(figure.locator('.plane-question')).toContainText(`Particle A, slot ${slot}`);
    await press(figure, 'Let the run decide');
  }
  await expect(figure.locator('.plane-question')).toContainText('Particle B, slot 1');
});

test('mistakes are saved with an assignment, and stay counted when one begins again', { tag: '@all' }, async ({
  page,
}) => {
  const task = packTask({
    title: 'T',
    setup: { on: '', left: 'queue~0.7~10~0', right: 'stack~0.7~10~0' },
    locks: [],
    questions: [],
  });
  await openLesson(page, { hash: `#plane&task=${task}` });
  const figure = await live(page, 'plane');
  const question = figure.locator('.plane-question');
  // The seed has nobody beside it, so the first mistake can be made at its child.
  for (const next of ['A, slot 1', 'A, slot 2', 'A, slot 3', 'A, slot 4', 'A, slot 5', 'A is done']) {
    await press(figure, 'Let the run decide');
    await expect(question).toContainText(`Particle ${next}`);
  }
  await skip(figure);
  await press(figure, 'A new one');
  await expect(figure.locator('.told')).toContainText('The run objects.');
  const save = page.locator('#assignment').getByRole('button', { name: 'Save your work' });
  const saved = async () => {
    const [file] = await Promise.all([page.waitForEvent('download'), save.click()]);
    const { predictions } = JSON.parse(await readFile(await file.path(), 'utf8'));
    return predictions.find((/** @type {{ stop: string }} */ { stop }) => stop === 'plane-plane');
  };
  const first = await saved();
  expect(first.guess).toBe(1);
  expect(first.answer).toContain('particle B, slot 1: said added');
  await press(figure, 'Begin again');
  await expect(figure.locator('.plane .figure-count')).toHaveText('Particle 1 of 2 · 1 mistake · 0 slots decided.');
  await leaveAll(figure);
  // A reload loses none of it.
  await page.reload();
  await live(page, 'plane');
  await expect(save).toBeVisible();
  const { guess, answer } = await saved();
  expect(guess).toBe(1);
  expect(answer).toContain('1 mistake; 0 slots decided; 11 left to the run; particle B, slot 1: said added');
});
