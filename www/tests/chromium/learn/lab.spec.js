/** The figure of the circle, the room around a particle, and numbers of the text that are dragged. */
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

test('the surface bends under the finger and by keys, and Newton’s child stays out until it was guessed', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#circle', width: 1440, height: 900 });
  const figure = await live(page, 'circle');
  const [sentence, told] = [figure.locator('.side > p').first(), figure.locator('.told')];
  const [bend, radius] = ['Bend', 'r'].map((name) => figure.getByRole('slider', { name, exact: true }));
  await expect(sentence).toContainText('At its sharpest bend this surface curves by');
  await expect(figure.locator('.newton-end, .ruler-newton')).toHaveCount(0);
  await page.locator('#predict-newton').getByRole('radio', { name: 'Nearer' }).check();
  await page.locator('#predict-newton').getByRole('button').first().click();
  await expect(figure.locator('.newton-end, .ruler-newton')).toHaveCount(2);
  await expect(told).toContainText('Newton lands at 1.659');
  const before = await numberOf(bend);
  // The finger is below the tangent plane, and the surface comes to it.
  const drawing = figure.locator('svg.drawing');
  await drawing.scrollIntoViewIfNeeded();
  const box = await drawing.boundingBox();
  if (!box) throw new Error('There is no drawing.');
  const [x, y] = [box.x + 0.72 * box.width, box.y + 0.32 * box.height];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y + 20);
  await expect(sentence).toContainText('A sphere curves by');
  const bent = await numberOf(bend);
  await page.mouse.move(x, y + 60);
  await page.mouse.up();
  expect(await numberOf(bend)).toBeGreaterThan(bent);
  // By keys: without a bend both land at 2r, and smaller particles see a flatter surface.
  await bend.press('Home');
  await expect(sentence).toContainText('A plane curves by 0, and r is');
  await expect(told).toContainText('Newton lands at 2.000');
  await bend.press('End');
  await expect(sentence).toContainText('bend · r = 0.90');
  await expect(told).toContainText('On the circle the child lands at 2.000');
  await expect(told).toContainText('Newton lands at 1.12');
  await radius.press('Home');
  await expect(sentence).toContainText('bend · r = 0.23');
  await expect(told).toContainText('Newton lands at 1.8');
  await figure.getByRole('button', { name: 'Back to the sharpest bend' }).click();
  expect(await numberOf(bend)).toBe(before);
  await expect(sentence).toContainText('At its sharpest bend this surface');
  clean();
});

test('the radii of a particle and of those around it are dragged, and φ and τ follow step by step', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#angles', width: 390, height: 844 });
  const figure = await live(page, 'angles');
  const [own, other] = ['particle', 'others'].map((of) => figure.getByRole('slider', { name: `Radius of the ${of}` }));
  await expect(figure.locator('.told')).toContainText(
    /takes φ = [\d.]+°; τ = [\d.]+° are free, \d+ % of that\. There is room/,
  );
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
  await expect(figure.locator('.facts')).toContainText('360° / φ6.00Placed, where half of φ is enough6');
  await figure.getByRole('slider', { name: 'Step' }).press('End');
  await expect(figure.locator('.told')).toContainText('has no room and is not added');
  // The handle on the rim of the other makes it larger, and there is room for fewer.
  await drag(page, figure.locator('.hand').last(), 30, 0);
  expect(await numberOf(other)).toBeGreaterThan(0.6);
  expect(await numberOf(own)).toBe(0.5);
  await expect(figure.locator('.facts')).not.toContainText('enough6');
  await drag(page, figure.locator('.hand').first(), 12, 26);
  expect(await numberOf(own)).toBeGreaterThan(0.5);
  expect(await overflow(page)).toBe(0);
  clean();
});

test('a number of the text is a handle of its figure, and follows it', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings' });
  const figure = await live(page, 'rings');
  const text = page.locator('#rings > p');
  const level = figure.getByRole('slider', { name: 'Level' });
  const [ring, flat] = [
    text.getByRole('slider', { name: 'Ring', exact: true }),
    text.getByRole('slider', { name: 'Particles of the ring on a plane' }),
  ];
  // The text says what the figure shows, which is the ring of the question.
  await expect(ring).toHaveText('12');
  await expect(flat).toHaveText('72');
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

test('numbers of the text turn the seed, the step of the relaxation and the tolerance of their figures', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#measures' });
  const figure = await live(page, 'measures');
  const seed = page.locator('#rule').getByRole('slider', { name: 'Seed' });
  await seed.press('ArrowRight');
  await expect(seed).toHaveText('2');
  await expect(figure.locator('.dots-row').first().locator('.dots-axis > span')).toHaveCount(2);
  await expect(figure.locator('.told')).toHaveText('Run 2 of 5.');
  const [second, drawing] = [await figure.locator('b').first().textContent(), figure.locator('.patch')];
  const patch = await drawing.getAttribute('aria-label');
  await seed.press('Home');
  await expect(drawing).not.toHaveAttribute('aria-label', patch ?? '');
  await expect(figure.locator('b').first()).not.toHaveText(second ?? '');
  await expect(figure.locator('.told')).toHaveText('Run 2 of 5.');

  // What a step does is the answer to a question.
  const sentence = page.locator('#steps');
  await expect(sentence).toBeHidden();
  await live(page, 'seams');
  for (const id of ['#predict-seam', '#predict-rest'])
    await page.locator(id).getByRole('button', { name: 'Skip' }).click();
  await expect(sentence).toContainText('After 0 of the ten steps the largest hole is 1.49.');
  const step = sentence.getByRole('slider', { name: 'Step of the relaxation' });
  await step.press('End');
  await expect(sentence).toContainText('After 10 of the ten steps the largest hole is 1.23.');
  await expect(page.locator('[data-figure="seams"] .range-value')).toHaveText('step 10 of 10');

  const bench = page.locator('#bench');
  await bench.scrollIntoViewIfNeeded();
  const tolerance = page.locator('#what-if').getByRole('slider', { name: 'Tolerance of the sampling on the right' });
  await expect(tolerance).toHaveText('1.4 r');
  await tolerance.press('End');
  await expect(bench.getByRole('slider', { name: 'Tolerance', exact: true })).toHaveText('1.9 r');
  await expect(bench.locator('.said')).toContainText('Worse.');
  clean();
});

test('the dials show what is run, also what is kept, and go on from there', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#what-if-fail' });
  const bench = page.locator('#bench');
  const [relaxation, seed] = ['Relaxation', 'Seed'].map((name) => bench.getByLabel(name, { exact: true }));
  const tolerance = bench.getByRole('slider', { name: 'Tolerance' });
  const right = bench.locator('figcaption').last();
  await expect(right).toHaveText(/^Stack, 1\.4/);
  await bench.getByLabel('Who comes next').selectOption('queue');
  await tolerance.press('Home');
  await relaxation.selectOption('0');
  await seed.selectOption('3');
  await expect(right).toHaveText('Queue, 0.8 r, no steps, seed 3');
  await expect(bench.locator('.said')).toContainText('Worse.');
  await bench.getByRole('button', { name: 'Best so far' }).click();
  await expect(right).toHaveText('Queue, 1.4 r, ten steps, seed 0');
  const dials = async () => {
    const chosen = await bench
      .locator('.controls select')
      .evaluateAll((all) => all.slice(1).map((one) => /** @type {any} */ (one).selectedOptions[0].label));
    const [who, steps, from] = chosen.map((words) => words.toLowerCase());
    return `${who}, ${await tolerance.textContent()}, ${steps}, ${from}`;
  };
  const words = async () => (await right.innerText()).toLowerCase();
  expect(await dials()).toBe(await words());
  const next = Number.parseFloat((await tolerance.textContent()) ?? '') + 0.1;
  await tolerance.press('ArrowRight');
  await seed.selectOption('2');
  await expect(right).toHaveText(new RegExp(`, ${next.toFixed(1)} r.*seed 2`));
  expect(await dials()).toBe(await words());
  clean();
});

test('while both are run, what stands there is marked as old', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#what-if-fail' });
  const bench = page.locator('#bench');
  await expect(bench.locator('.outcome')).toBeVisible();
  await bench.getByLabel('Relaxation', { exact: true }).selectOption('100');
  await expect(bench.locator('.pair-box')).toHaveAttribute('aria-busy', 'true');
  await expect(bench.getByText('Running both')).toBeVisible();
  await expect(bench.locator('[aria-busy="true"]')).toHaveCount(0);
  await expect(bench.getByRole('columnheader', { name: /a hundred steps/ })).toBeVisible();
});

test('a picture is pinned while its number is turned, and over no question', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings', width: 1280, height: 720 });
  const stage = await live(page, 'rings');
  const [number, question] = [
    page.locator('#rings').getByRole('slider', { name: 'Ring', exact: true }),
    page.locator('#predict-ring'),
  ];
  await page.mouse.wheel(0, 1);
  await number.evaluate((element) =>
    scrollBy({ top: element.getBoundingClientRect().bottom - innerHeight + 60, behavior: 'instant' }),
  );
  await number.focus();
  await expect(stage).not.toHaveClass(/pinned/);
  await number.press('ArrowRight');
  await expect(stage).toHaveClass(/pinned/);
  const [picture, asked, own] = [
    await stage.locator('canvas').boundingBox(),
    await question.boundingBox(),
    await number.boundingBox(),
  ];
  if (!picture || !asked || !own) throw new Error('There is no box.');
  for (const box of [asked, own])
    expect(picture.y + picture.height <= box.y || box.y + box.height <= picture.y).toBe(true);
  // The focus alone does not keep it there.
  await expect(number).toBeFocused();
  await expect(stage).not.toHaveClass(/pinned/);
  clean();
});
