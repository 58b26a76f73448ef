/** The lesson in a class: presenting, the hand-out, assignments and the race. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { axe } from '../axe.js';
import { live, openLesson, overflow, TORUS } from './helpers.js';

test('a clicker goes from stop to stop, and each has its own address', async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings&mode=present' });
  await live(page, 'rings');
  await expect(page.locator('.chapter:visible')).toHaveCount(1);
  await expect(page.getByRole('heading', { name: 'Rings' })).toBeVisible();
  await page.keyboard.press('PageDown');
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#predict-ring&mode=present');
  await expect(page.locator('#predict-ring')).toBeVisible();
  await expect(page.locator('#predict-order')).toBeHidden();
  // Letters in a box are text.
  await page.getByLabel('Particles in ring 12').fill('7');
  await expect(page.locator('#rings .notes')).toBeHidden();
  await page.getByRole('button', { name: 'Notes' }).click();
  await expect(page.locator('#rings .notes')).toBeVisible();
  await page.keyboard.press('PageUp');
  await expect(page.locator('#predict-ring')).toBeHidden();
  expect((await axe(page)).violations.map(({ id }) => id)).toEqual([]);
  await page.keyboard.press('Escape');
  await expect(page.locator('.chapter:visible')).toHaveCount(12);
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#rings');
  clean();
});

test('no slide has a control or a caption under the bar of the presenter', async ({ page }) => {
  test.slow();
  const sizes = [
    { width: 1280, height: 800 },
    { width: 1920, height: 1080 },
  ];
  await openLesson(page, { hash: '#why&mode=present', ...sizes[0] });
  await expect(page.locator('.present-bar')).toBeVisible();
  const stops = await page.locator('[data-stop]').evaluateAll((all) => all.map(({ id }) => id));
  expect(stops).toHaveLength(21);
  // Comparison, race and cards are longer than a window, and are scrolled.
  for (const stop of stops.filter((id) => !['what-if', 'race', 'differences'].includes(id))) {
    await page.evaluate((id) => {
      location.hash = `#${id}&mode=present`;
    }, stop);
    await expect(page.locator(`#${stop}[data-current]`)).toBeVisible();
    for (const stage of await page.locator('[data-current] [data-figure]').filter({ visible: true }).all())
      await expect(stage).toHaveAttribute('data-state', 'live', { timeout: 60_000 });
    for (const size of sizes) {
      await page.setViewportSize(size);
      const below = () =>
        page.evaluate(() => {
          const bar = document.querySelector('.present-bar')?.getBoundingClientRect().top ?? 0;
          const parts = document.querySelectorAll('[data-current] :is(input, button, select, figcaption, .scale)');
          return [...parts]
            .filter((part) => /** @type {HTMLElement} */ (part).offsetParent)
            .filter((part) => part.getBoundingClientRect().bottom > bar + 1)
            .map((part) => part.outerHTML.slice(0, 80));
        });
      // A figure takes its new size with the next frame.
      await expect.poll(below, { message: `${stop} at ${size.width}` }).toEqual([]);
    }
  }
});

test('a presentation begins at the chapter that is read, and fits a small window', async ({ page }) => {
  await openLesson(page, { hash: `#seams&surface=${TORUS}`, width: 390, height: 700 });
  await live(page, 'seams');
  await page.getByRole('button', { name: 'Present' }).click();
  await expect.poll(() => page.evaluate(() => location.hash)).toContain(`&surface=${TORUS}&mode=present`);
  await page.getByRole('button', { name: 'Next stop' }).click();
  expect(await overflow(page)).toBe(0);
});

test('the hand-out has blanks for the predictions, and every answer on its last page', async ({ page }) => {
  await openLesson(page);
  await page.evaluate(() => {
    window.print = () => {
      document.documentElement.dataset.printed = '';
    };
  });
  // The keys for printing wait for the answers as the button does.
  await page.keyboard.press('ControlOrMeta+p');
  await expect(page.locator('html')).toHaveAttribute('data-printed', '', { timeout: 60_000 });
  await expect(page.locator('.answers')).toBeHidden();
  await page.emulateMedia({ media: 'print' });
  await expect(page.locator('.answer-list > li')).toHaveCount(9);
  await expect(page.locator('.answer-list')).toContainText('Ring 12 of this surface has');
  await expect(page.locator('.answer-list')).not.toContainText('has not been asked');
  for (const still of await page.locator('.what-if-stills img').all())
    await expect.poll(() => still.evaluate((one) => /** @type {HTMLImageElement} */ (one).naturalWidth)).toBe(608);
  await expect(page.locator('#bench .picture[data-drawn]')).toHaveCount(2);
  await expect(page.locator('.bar')).toBeHidden();
  // The figures of a scorecard that lead to a place are buttons on the screen.
  await expect(page.locator('button:not(.figure-place)').filter({ visible: true })).toHaveCount(0);
  for (const name of ['why', 'rest']) await expect(page.locator(`[data-figure="${name}"] canvas`)).toBeVisible();
  expect((await page.pdf({ format: 'A4' })).length).toBeGreaterThan(100_000);
});

test('what the browser prints by itself has the answers of the figures that are live, and the page says what is missing', async ({
  page,
}) => {
  await openLesson(page, { hash: '#rings' });
  await live(page, 'rings');
  const ring = page.locator('.answer-list > li', { hasText: 'On a plane, ring 12 has 72' });
  // The answer is asked for when its figure has come to life, and written when it is printed.
  await expect
    .poll(async () => {
      await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
      return ring.textContent();
    })
    .toContain('Ring 12 of this surface has');
  const last = page.locator('.answer-list > li').last();
  await expect(last).toContainText('Print from the page’s own button');
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await expect(page.locator('#notice')).toContainText('Not all answers were known');
});

test('an assignment locks what the teacher chose, and its answers are one file', async ({ page }) => {
  const { clean } = await openLesson(page, { hash: `#what-if-tolerance&surface=${TORUS}` });
  await expect(page.locator('#bench .picture[data-drawn]')).toHaveCount(2, { timeout: 60_000 });
  await page.getByRole('button', { name: 'Assignment' }).click();
  const dialog = page.getByRole('dialog');
  await dialog.getByLabel('Title').fill('Seams');
  await dialog.getByLabel('Questions, one on each line').fill('Which run has closer pairs?');
  await dialog.getByRole('checkbox', { name: 'Right' }).uncheck();
  for (const name of ['Sliders and buttons of the figures', 'Answers of the questions', 'The race'])
    await dialog.getByRole('checkbox', { name }).check();
  const link = await dialog.getByLabel('Link of the assignment').inputValue();
  await page.goto('about:blank');
  await page.goto(link);
  const task = page.getByRole('region', { name: 'Seams' });
  await expect(task.locator('.picture[data-drawn]')).toHaveCount(2, { timeout: 60_000 });
  await expect(task.getByLabel('What changes')).toBeDisabled();
  await expect(task.getByLabel('Left', { exact: true })).toBeDisabled();
  await task.getByLabel('Right', { exact: true }).selectOption('0.95');
  await expect(task.getByRole('columnheader', { name: '0.95 · 2r' })).toBeVisible({ timeout: 60_000 });
  await task.getByLabel('Which run has closer pairs?').fill('The left one, "clearly".');
  const saved = async (/** @type {string} */ name) => {
    const [file] = await Promise.all([page.waitForEvent('download'), task.getByRole('button', { name }).click()]);
    return readFile(await file.path(), 'utf8');
  };
  const work = JSON.parse(await saved('Save as JSON'));
  expect(work).toMatchObject({
    assignment: 'Seams',
    surface: '(sqrt(x^2 + y^2) - R)^2 + z^2 = 0.09, R = 0.7',
    answers: [{ question: 'Which run has closer pairs?', answer: 'The left one, "clearly".' }],
  });
  // What is locked elsewhere on the page is locked, and what is not stays open.
  await expect(task.getByText(/^Locked: what is compared here; the picture on the left; the sliders/)).toBeVisible();
  const rings = await live(page, 'rings');
  await expect(rings.locator('.controls')).toHaveJSProperty('inert', true);
  await expect(page.locator('#race-box > .controls')).toHaveJSProperty('inert', true);
  await expect(page.locator('#bench > .controls')).toHaveJSProperty('inert', false);
  const ring = page.locator('#predict-ring');
  await ring.getByLabel('Particles in ring 12').fill('70');
  await page.keyboard.press('Enter');
  await expect(ring).not.toHaveAttribute('data-state', 'open');
  const guesses = JSON.parse(await saved('Save as JSON')).predictions;
  expect(guesses).toMatchObject([{ stop: 'predict-ring', guess: 70, answer: '' }]);
  expect(work.runs.map((/** @type {any} */ { settings }) => settings.match_tolerance)).toEqual([0.7, 0.95]);
  expect(work.runs[0].new_per_level.slice(0, 2)).toEqual([1, 6]);
  // The figures that decide: the larger tolerance leaves the larger hole.
  const holes = work.runs.map((/** @type {any} */ { figures }) => figures['Largest hole, over the ideal']);
  expect(holes[0]).toBeLessThan(holes[1]);
  expect(await saved('Save as CSV')).toContain('answer,Which run has closer pairs?,,"The left one, ""clearly""."');
  // A reload loses nothing, and the file bears the name.
  await task.getByLabel('Your name').fill('Ada L.');
  await page.reload();
  await expect(task.getByLabel('Which run has closer pairs?')).toHaveValue('The left one, "clearly".');
  const button = task.getByRole('button', { name: 'Save as JSON' });
  const [file] = await Promise.all([page.waitForEvent('download'), button.click()]);
  expect(file.suggestedFilename()).toBe('Seams-Ada-L.json');
  clean();
});

test('a damaged assignment is named, and the lesson stays', async ({ page }) => {
  await openLesson(page, { hash: '#task=AAAA' });
  await expect(page.locator('#notice')).toContainText('no assignment that can be read');
  await live(page, 'why');
});

for (const [kind, other] of [
  ['uniform', 'Witkin and Heckbert'],
  ['adaptive', 'Forces'],
])
  test(`the front races against ${other}, each by its own rules`, async ({ page }) => {
    const { clean } = await openLesson(page, { hash: '#race' });
    const race = page.locator('#race-box');
    const start = race.getByRole('button', { name: 'Start' });
    // One that is given up while it is prepared does not come back.
    await race.getByLabel('Race').selectOption(kind === 'uniform' ? 'adaptive' : 'uniform');
    await start.click();
    await race.getByLabel('Race').selectOption(kind);
    await start.click();
    await expect(race.getByRole('columnheader', { name: other })).toBeVisible({ timeout: 55_000 });
    // Of the two races no worker is left; the pictures have one.
    await expect.poll(() => page.workers().length).toBeLessThan(2);
    const rounds = await race.locator('.lane dt', { hasText: 'Rounds' }).locator('+ dd').allTextContents();
    expect(rounds[0]).toBe('10');
    expect(Number(rounds[1].replace(/\D/g, ''))).toBeGreaterThan(50);
    await expect(race.locator('.picture[data-drawn]')).toHaveCount(2);
    await expect(race.getByRole('img', { name: /times as long as the front/ })).toBeVisible();
    await expect(page.getByRole('cell', { name: '373' })).toBeVisible();
    clean();
  });
