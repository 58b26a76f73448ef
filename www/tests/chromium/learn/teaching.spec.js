/** The lesson in a class: questions to print, assignments and collecting. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { axe } from '../../axe.js';
import { live, openLesson, overflow, TORUS } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** Opens the menu for teachers, and presses a button of it. @param {Page} page @param {string} name */
async function teachers(page, name) {
  await page.getByText('For teachers').click();
  await page.getByRole('button', { name, exact: true }).click();
}

test('the questions are printed on two pages, without a guess and without an answer', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#predict-ring' });
  const ring = page.locator('#predict-ring');
  await ring.getByLabel('Particles in ring 12').fill('71');
  await page.keyboard.press('Enter');
  await expect(ring).toHaveAttribute('data-state', 'open');
  await page.evaluate(() => {
    window.print = () => {
      document.documentElement.dataset.printed = '';
    };
  });
  await teachers(page, 'Print the questions');
  await expect(page.locator('html')).toHaveAttribute('data-printed', '');
  await page.emulateMedia({ media: 'print' });
  const paper = page.locator('#questions');
  await expect(paper).toBeVisible();
  await expect(page.locator('.chapter').filter({ visible: true })).toHaveCount(0);
  // Eight of the chapters, and the purposes for which pairs are judged.
  await expect(paper.locator('ol > li')).toHaveCount(12);
  await expect(paper).toContainText('How many particles has ring 12 on this surface?');
  await expect(paper).toContainText('Thin tumours must not fall between them.');
  expect(await paper.innerText()).not.toMatch(/71|Ring 12 of this surface has|right/);
  const sheets = await page.pdf({ format: 'A4', preferCSSPageSize: true });
  expect(sheets.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length).toBe(2);
  // Afterwards the article is printed as before, without what was guessed.
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await expect(paper).toBeHidden();
  await expect(ring.locator('.predict-form')).toBeHidden();
  await expect(ring.locator('.predict-result')).toBeHidden();
  clean();
});

test('where the part for teachers does not load, the page says so', { tag: '@all' }, async ({ page }) => {
  /** @type {string[]} */
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.route(/\/teach-[^/]*\.js$/, (route) => route.abort());
  await openLesson(page, { hash: '#task=AAAA' });
  const lost = 'A part of this page could not be loaded. Load the page again.';
  await expect(page.locator('#notice')).toHaveText(lost);
  for (const name of ['Print the questions', 'Assignment']) {
    await page.evaluate(() => document.getElementById('notice')?.replaceChildren());
    await teachers(page, name);
    await expect(page.locator('#notice')).toHaveText(lost);
  }
  expect(faults).toEqual([]);
});

test('a reader loads nothing of what is for a class', { tag: '@all' }, async ({ page }) => {
  /** @type {string[]} */
  const loaded = [];
  page.on('request', (request) => loaded.push(new URL(request.url()).pathname));
  await openLesson(page);
  await live(page, 'opening');
  await live(page, 'rings');
  expect(loaded.filter((path) => /\/teach-/.test(path))).toEqual([]);
  await teachers(page, 'Assignment');
  await expect(page.getByRole('dialog')).toBeVisible();
  expect(loaded.filter((path) => /\/teach-/.test(path))).toHaveLength(1);
});

test('an assignment locks what the teacher chose, and its answers are one file', { tag: '@all' }, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: `#what-if-fail&surface=${TORUS}` });
  await expect(page.locator('#bench .picture[data-drawn]')).toHaveCount(2);
  await teachers(page, 'Assignment');
  const dialog = page.getByRole('dialog');
  await dialog.getByLabel('Title').fill('Seams');
  await dialog.getByLabel('Questions, one on each line').fill('Which run has closer pairs?');
  await expect(dialog.getByRole('checkbox', { name: 'Right' })).not.toBeChecked();
  const link = await dialog.getByLabel('Link of the assignment').inputValue();
  await page.goto('about:blank');
  await page.goto(link);
  const task = page.getByRole('region', { name: 'Seams', exact: true });
  await expect(task.locator('.picture[data-drawn]')).toHaveCount(2);
  // The teacher's own tries, one of which solves it, stay where they were made.
  expect(link).not.toContain('stack');
  await expect(task.locator('figcaption')).toHaveText([/^Queue, 1\.4 r/, /^Queue, 1\.4 r/]);
  await task.getByLabel('Who comes next').selectOption('stack');
  await expect(task.getByRole('columnheader', { name: 'Stack', exact: true })).toBeVisible();
  await expect(task.getByLabel('Surface')).toBeDisabled();
  await task.getByRole('slider', { name: 'Tolerance' }).press('End');
  const header = task.getByRole('columnheader', { name: 'Stack, 1.9 r', exact: true });
  await expect(header).toBeVisible();
  await task.getByLabel('Which run has closer pairs?').fill('The left one, "clearly".');
  const saved = async () => {
    const press = task.getByRole('button', { name: 'Save your work' }).click();
    const [file] = await Promise.all([page.waitForEvent('download'), press]);
    return readFile(await file.path(), 'utf8');
  };
  const work = JSON.parse(await saved());
  expect(work).toMatchObject({
    assignment: 'Seams',
    surface: '(sqrt(x^2 + y^2) - R)^2 + z^2 = 0.09, R = 0.7',
    answers: [{ question: 'Which run has closer pairs?', answer: 'The left one, "clearly".' }],
  });
  await expect(task.getByText('Locked: the surface.')).toBeVisible();
  const ring = page.locator('#predict-ring');
  await ring.getByLabel('Particles in ring 12').fill('70');
  expect(JSON.parse(await saved()).predictions).toMatchObject([{ stop: 'predict-ring', guess: 70, answer: '' }]);
  // Each run stands there once, the best and the worst under these names. The last one is no worse beyond chance.
  const labels = work.runs.map((/** @type {any} */ { label }) => label);
  expect(labels).toEqual([
    'Best so far: Queue, 1.4 r, ten steps, seed 0',
    'Worst so far: Stack, 1.4 r, ten steps, seed 0',
    'Stack, 1.9 r, ten steps, seed 0',
  ]);
  expect(work.runs[0].new_per_level.slice(0, 2)).toEqual([1, 6]);
  // The larger tolerance leaves more of the surface open.
  const open = work.runs.map((/** @type {any} */ { figures }) => figures['Surface outside all discs']);
  expect(open[0]).toBeLessThan(open[2]);
  // A reload loses nothing, and the file bears the name.
  await task.getByLabel('Your name').fill('Ada L.');
  await page.reload();
  await expect(task.getByLabel('Which run has closer pairs?')).toHaveValue('The left one, "clearly".');
  const button = task.getByRole('button', { name: 'Save your work' });
  const [file] = await Promise.all([page.waitForEvent('download'), button.click()]);
  expect(file.suggestedFilename()).toBe('Seams-Ada-L.json');
  clean();
});

/** Works of a class as its learners save them, each with a guess of its own. @param {number} count */
const classOf = (count) =>
  Array.from({ length: count }, (_, k) => ({
    name: `work-${k}.json`,
    mimeType: 'application/json',
    buffer: Buffer.from(
      JSON.stringify({
        assignment: 'Seams',
        surface: 'a torus',
        name: `Learner ${k + 1}`,
        group: k % 2 ? '7b' : '7a',
        answers: [{ question: 'Why?', answer: `<b>Because</b> of ${k}` }],
        predictions: [
          {
            ...{ stop: 'predict-rest', question: 'What has changed?', guess: k % 3 ? 'both' : 'hole' },
            ...{ right: 'hole', answer: 'The largest hole was 1.49.' },
          },
          {
            ...{ stop: 'predict-ring', question: 'How many in ring 12?', guess: [72, 66, 60, 72, null][k % 5] },
            ...{ right: 66, answer: 'Ring 12 has 66.' },
          },
          { stop: 'plane-plane', question: 'Mistakes', guess: k % 2, answer: `${k % 2} mistakes` },
        ],
        // A file of old lists a run twice. Every learner has made the first, and some the second.
        runs: [
          ...Array(2).fill({ label: '0.7', figures: { 'Largest hole, over the ideal': 1.23 } }),
          ...(k % 6 ? [] : [{ label: '0.3', figures: { 'Largest hole, over the ideal': 1.5 } }]),
        ],
      }),
    ),
  }));

test('a lecturer drops thirty files and sees the answers beside what the run says', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await openLesson(page);
  await teachers(page, 'Assignment');
  await page.getByRole('dialog').getByRole('link', { name: 'Collect answers' }).click();
  await expect(page.locator('.teachers')).not.toHaveAttribute('open');
  const box = page.getByLabel(/Drop the JSON files/);
  const damaged = { name: 'notes.json', mimeType: 'application/json', buffer: Buffer.from('{"answers": 3}') };
  await box.setInputFiles([...classOf(30), damaged]);
  const collected = page.locator('#collect');
  await expect(collected.getByRole('status')).toHaveText(
    '30 works collected. Left out, since they are not the work of a learner or are damaged: notes.json.',
  );
  // A file that comes again counts once, which is said, and a file that is none takes nothing away.
  await box.setInputFiles([...classOf(2), damaged]);
  await expect(collected.getByRole('status')).toContainText(
    '30 works collected. Counted once, since they equal a file that was there: work-0.json, work-1.json.',
  );
  const table = collected.getByRole('region', { name: 'Answers to Seams, on a torus' });
  await expect(table.locator('tbody tr')).toHaveCount(30);
  // For each question of the lesson bars of the guesses, with the right one marked; learners stand below.
  const bars = collected.locator('.guesses');
  await expect(bars).toHaveCount(2);
  await expect(bars.first().locator('.bar-row')).toHaveText([
    'The largest hole right10',
    'The share with six neighbours0',
    'Both20',
    'Neither0',
  ]);
  await expect(bars.first()).toContainText('The largest hole was 1.49.');
  await expect(bars.last().locator('.bar-row')).toHaveText(['606', '66 right6', '7212']);
  await expect(bars.last()).toContainText('6 learners skipped it.');
  await expect(bars.locator('[data-right]')).toHaveCount(2);
  const [barsBox, tableBox] = [await bars.last().boundingBox(), await table.boundingBox()];
  expect(barsBox && tableBox && barsBox.y + barsBox.height <= tableBox.y, 'learners stand below').toBe(true);
  const names = await table.locator('tbody th').allTextContents();
  const odd = Array.from({ length: 15 }, (_, k) => `Learner ${2 * k + 1}`);
  expect(names.slice(0, 15)).toEqual(odd);
  const second = table.locator('tbody tr').nth(1);
  await expect(second).toContainText('Learner 3');
  await expect(second).toContainText('<b>Because</b> of 2');
  await expect(second).toContainText('Both');
  const runs = collected.getByRole('region', { name: 'What their runs give' });
  await expect(runs.locator('tbody tr')).toHaveText([/^0\.7.*1\.23.*30$/, /^0\.3.*1\.50.*5$/]);
  const [file] = await Promise.all([
    page.waitForEvent('download'),
    collected.getByRole('button', { name: 'Save all as one CSV' }).click(),
  ]);
  const rows = (await readFile(await file.path(), 'utf8')).trim().split('\r\n');
  expect(rows[0]).toBe('work,part,name,number,value');
  expect(rows).toContain('16,answer,Why?,,<b>Because</b> of 1');
  expect((await axe(page)).violations.map(({ id, nodes }) => [id, nodes.map(({ target }) => target)])).toEqual([]);
  for (const width of [1280, 390, 320]) {
    await page.setViewportSize({ width, height: 760 });
    expect(await overflow(page)).toBe(0);
  }
  clean();
});

test('the values of a comparison are part of the address', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#what-if&left=none&right=queue~0.7~0~3' });
  const bench = page.locator('#bench');
  await expect(bench.locator('figcaption')).toHaveText([/^Queue, 1\.4 r, ten/, 'Queue, 1.4 r, no steps, seed 3']);
  await bench.getByLabel('Seed', { exact: true }).selectOption('1');
  const hash = '#what-if&left=queue~0.7~10~0&right=queue~0.7~0~1';
  await expect.poll(() => page.evaluate(() => location.hash)).toBe(hash);
  await page.reload();
  await expect(bench.getByLabel('Seed', { exact: true })).toHaveValue('1');
  // They do not follow to another stop.
  await page.getByRole('link', { name: 'Rings', exact: true }).click();
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#rings');
});

test('the worst sampling is looked for by keys, and the best and the worst are kept', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#what-if-fail' });
  const bench = page.locator('#bench');
  const kept = (/** @type {string} */ name) => bench.getByRole('button', { name });
  const [said, verdict] = [bench.locator('.said'), bench.locator('.verdict')];
  await expect(kept('Best so far')).toContainText('Queue, 1.4 r, ten steps, seed 0');
  await expect(kept('Worst so far')).toContainText('Stack, 1.4');
  await expect(said).toContainText(
    /Worse\. Here 7\d\.\d % have six neighbours, in the sampling of the lesson 89\.\d %\./,
  );
  await expect(verdict.getByRole('listitem')).toHaveText(
    /^Stack\. .* Put back to queue, 89\.\d % have six neighbours instead of 7\d\.\d %\.$/,
  );
  await bench.getByRole('slider', { name: 'Tolerance' }).press('Home');
  await bench.getByLabel('Relaxation', { exact: true }).selectOption('0');
  await expect(kept('Worst so far')).toContainText('Stack, 0.8 r, no steps, seed 0');
  await expect(verdict.getByRole('listitem')).toHaveCount(3);
  // A choice that does no harm is named as one.
  await kept('Best so far').click();
  await expect(bench.locator('figcaption')).toHaveText([/^Stack, 0\.8/, /^Queue, 1\.4/]);
  await bench.getByLabel('Relaxation', { exact: true }).selectOption('100');
  await expect(said).toContainText('No difference beyond chance.');
  await expect(verdict).toContainText('A hundred steps. It does no harm beyond chance here.');
  await kept('Worst so far').click();
  await expect(bench.locator('figcaption')).toHaveText([/^Queue, 1\.4 r, ten/, /^Stack, 0\.8/]);
  const values = 'left=queue~0.7~10~0&right=stack~0.4~0~0';
  await expect.poll(() => page.evaluate(() => location.hash)).toBe(`#what-if&${values}`);
  // They are there again later, and where the address says nothing both are shown.
  await page.goto('about:blank');
  await openLesson(page, { hash: '#what-if-fail' });
  await expect(bench.locator('figcaption')).toHaveText([/^Queue, 1\.4 r, ten/, /^Stack, 0\.8/]);
  await expect(kept('Worst so far')).toContainText('Stack, 0.8 r, no steps, seed 0');
  expect((await axe(page)).violations.map(({ id }) => id)).toEqual([]);
  clean();
});

test('a damaged assignment is named, and the lesson stays', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#task=AAAA' });
  await expect(page.locator('#notice')).toContainText('no assignment that can be read');
  await live(page, 'opening');
});
