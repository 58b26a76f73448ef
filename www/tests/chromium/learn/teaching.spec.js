/** The lesson in a class: presenting, the hand-out, assignments and the race. */
import { readFile, writeFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { axe } from '../../axe.js';
import { live, openLesson, overflow, TORUS } from './helpers.js';
import { settledSlide } from './rehearsal.js';

/** @import { Page } from '@playwright/test' */

/** Opens the menu for teachers, and presses a button of it. @param {Page} page @param {string} name */
async function teachers(page, name) {
  await page.getByText('For teachers').click();
  await page.getByRole('button', { name, exact: true }).click();
}

test('keys and clickers go from stop to stop and blank the wall, and each stop has its own address', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings&mode=present' });
  await live(page, 'rings');
  await expect(page.locator('.chapter:visible')).toHaveCount(1);
  await expect(page.getByRole('heading', { name: 'Rings' })).toBeVisible();
  await page.keyboard.press('PageDown');
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#predict-ring&mode=present');
  await expect(page.locator('#predict-ring')).toBeVisible();
  await expect(page.locator('#rings .notes')).toBeHidden();
  // In a box, letters and spaces are text.
  await page.getByLabel('Particles in ring 12').fill('70');
  await page.keyboard.press('b');
  await expect(page.locator('.present-blank')).toBeHidden();
  // The guess is revealed, then the figure goes on from the ring that was asked for, and back.
  await page.keyboard.press('PageDown');
  await expect(page.locator('#predict-ring')).toHaveAttribute('data-state', 'open');
  const level = page.locator('#rings').getByRole('slider', { name: 'Level' });
  await expect(level).toHaveValue('12');
  await page.keyboard.press('PageDown');
  await expect(level).toHaveValue('17');
  await page.keyboard.press('ArrowLeft');
  await expect(level).toHaveValue('12');
  // On a blank wall a key only ends the blank.
  await page.keyboard.press('b');
  await expect(page.locator('.present-blank')).toBeVisible();
  await page.keyboard.press('PageDown');
  await expect(page.locator('.present-blank')).toBeHidden();
  await expect(level).toHaveValue('12');
  expect((await axe(page)).violations.map(({ id }) => id)).toEqual([]);
  await page.keyboard.press('Escape');
  await expect(page.locator('.chapter:visible')).toHaveCount(13);
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#predict-ring');
  clean();
});

test('the notes have a window of their own, with the next stop and a clock, which steers, too', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await openLesson(page, { hash: '#rings&mode=present' });
  await live(page, 'rings');
  const [notes] = await Promise.all([page.waitForEvent('popup'), page.keyboard.press('n')]);
  await expect(notes.getByRole('heading', { name: 'Rings' })).toBeVisible();
  await expect(notes.getByText('Breadth first and depth first')).toBeVisible();
  await expect(notes.getByText('Next: On a plane, ring 12 has 72')).toBeVisible();
  await expect(notes.getByText(/^\d minutes for a reader/)).toBeVisible();
  await expect(notes.getByText('Answer:')).toBeHidden();
  await expect(notes.getByText(/0:0\d since/)).toBeVisible();
  await expect(page.locator('#rings .notes')).toBeHidden();
  await notes.keyboard.press('PageDown');
  await expect(notes.getByRole('heading', { name: 'On a plane, ring 12 has 72' })).toBeVisible();
  await expect(page.locator('#predict-ring')).toBeVisible();
  // The answer is there for the one who asks, and not on the wall.
  await expect(notes.getByText(/Answer: It is \d+\. Ring 12 of this surface has/)).toBeVisible();
  await expect(page.locator('#predict-ring')).not.toHaveAttribute('data-state', 'open');
  const [closed] = await Promise.all([notes.waitForEvent('close'), page.keyboard.press('Escape')]);
  expect(closed.isClosed()).toBe(true);
  clean();
});

/** Windows of a class, with the smallest letters that the last row can read, in pixels. */
const WALLS = [
  { width: 1280, height: 800, letters: 16 },
  { width: 1920, height: 1080, letters: 24 },
];

test(
  'a rehearsal: in every window every slide is whole, with a large figure and large letters',
  {
    tag: '@all',
  },
  async ({ page }, info) => {
    test.setTimeout(300_000);
    const { clean } = await openLesson(page, { hash: '#why&mode=present', ...WALLS[0] });
    await expect(page.locator('.present-bar')).toBeVisible();
    const stops = await page.locator('[data-stop]').evaluateAll((all) => all.map(({ id }) => id));
    const rows = ['| Stop | Figure | Letters | Words | Presses |', '|---|---:|---:|---:|---:|'];
    for (const stop of stops) {
      await expect(page.locator(`#${stop}[data-current]`)).toBeVisible();
      let presses = 0;
      let least = 1;
      let seen = await settledSlide(page);
      for (;;) {
        for (const { width, height, letters } of WALLS) {
          await page.setViewportSize({ width, height });
          seen = await settledSlide(page);
          const name = `${stop}, press ${presses}, ${width} × ${height}`;
          expect(seen.beyond, name).toEqual([]);
          expect(seen.letters, `${name}: ${seen.smallest}`).toBeGreaterThanOrEqual(letters);
          expect(seen.words, name).toBeGreaterThan(2);
          // A figure, or words that fill the slide.
          if (seen.figure === null) expect(seen.words, name).toBeGreaterThan(20);
          else expect(seen.figure, name).toBeGreaterThanOrEqual(0.6);
          least = Math.min(least, seen.figure ?? 1);
        }
        if (stop === stops.at(-1) && presses === 15) break;
        await page.keyboard.press('Space');
        presses += 1;
        // The address changes before the slide does.
        if (!(await page.evaluate((id) => location.hash.startsWith(`#${id}&`), stop))) break;
      }
      const figure = seen.figure === null ? 'none' : `${Math.round(100 * least)} %`;
      rows.push(`| ${stop} | ${figure} | ${seen.letters} px | ${seen.words} | ${presses} |`);
    }
    await writeFile(info.outputPath('rehearsal.md'), `${rows.join('\n')}\n`);
    clean();
  },
);

test('a presentation begins at the chapter that is read, and fits a small window', { tag: '@all' }, async ({
  page,
}) => {
  await openLesson(page, { hash: `#seams&surface=${TORUS}`, width: 390, height: 700 });
  await live(page, 'seams');
  await teachers(page, 'Present');
  await expect.poll(() => page.evaluate(() => location.hash)).toContain(`&surface=${TORUS}&mode=present`);
  await page.getByRole('button', { name: 'Next stop' }).click();
  expect(await overflow(page)).toBe(0);
});

test('the hand-out has blanks for the predictions, and every answer on its last page', { tag: '@all' }, async ({
  page,
}) => {
  await openLesson(page);
  await page.evaluate(() => {
    window.print = () => {
      document.documentElement.dataset.printed = '';
    };
  });
  // The keys for printing wait for the answers as the button does.
  await page.keyboard.press('ControlOrMeta+p');
  await expect(page.locator('html')).toHaveAttribute('data-printed', '', { timeout: 120_000 });
  await expect(page.locator('.answers')).toBeHidden();
  await page.emulateMedia({ media: 'print' });
  await expect(page.locator('.answer-list > li')).toHaveCount(12);
  // In the order of the article.
  const questions = await page.locator('.predict-question').allTextContents();
  const answered = await page.locator('.answer-question').allTextContents();
  expect(answered).toEqual(questions.filter((question) => answered.includes(question)));
  await expect(page.locator('.answer-list')).toContainText('Ring 12 of this surface has');
  await expect(page.locator('.answer-list')).not.toContainText('has not been asked');
  for (const still of await page.locator('.what-if-stills img').all())
    await expect.poll(() => still.evaluate((one) => /** @type {HTMLImageElement} */ (one).naturalWidth)).toBe(608);
  await expect(page.locator('#bench .picture[data-drawn]')).toHaveCount(2);
  await expect(page.locator('.bar')).toBeHidden();
  // The figures of a scorecard that lead to a place are buttons on the screen.
  await expect(page.locator('button:not(.figure-place)').filter({ visible: true })).toHaveCount(0);
  for (const name of ['judge-first', 'seams'])
    await expect(page.locator(`[data-figure="${name}"] canvas`).first()).toBeVisible();
  // What the questions withhold is printed with the answers: the bars and the costs.
  await expect(page.locator('.answer-list .cost')).not.toContainText('?');
  await expect(page.locator('.answer-list .chart .fate-new').first()).toBeVisible();
  await expect(page.locator('.answer-list .picture[data-drawn]')).toHaveCount(1);
  // A question stands beside its figure.
  const [asked, drawn] = [page.locator('#predict-newton'), page.locator('#circle figure')];
  const [left, right] = [await asked.boundingBox(), await drawn.boundingBox()];
  expect(left && right && left.x + left.width <= right.x && Math.abs(left.y - right.y) < 20).toBe(true);
  const sheets = await page.pdf({ format: 'A4', preferCSSPageSize: true });
  expect(sheets.length).toBeGreaterThan(100_000);
  expect(sheets.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length).toBeLessThanOrEqual(10);
});

test('what the browser prints by itself has no answers, and the page says where to find them', { tag: '@all' }, async ({
  page,
}) => {
  await openLesson(page, { hash: '#rings' });
  await live(page, 'rings');
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await expect(page.locator('#notice')).toContainText('“Print”, under “For teachers”');
});

test('where the part for teachers does not load, the article is printed and the page says so', { tag: '@all' }, async ({
  page,
}) => {
  /** @type {string[]} */
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.route(/\/teach-[^/]*\.js$/, (route) => route.abort());
  await openLesson(page, { hash: '#task=AAAA' });
  const lost = 'A part of this page could not be loaded. Load the page again.';
  await expect(page.locator('#notice')).toHaveText(lost);
  await page.evaluate(() => {
    document.documentElement.dataset.printed = '0';
    window.print = () => {
      const { dataset } = document.documentElement;
      dataset.printed = String(Number(dataset.printed) + 1);
      dispatchEvent(new Event('afterprint'));
    };
  });
  for (const times of ['1', '2']) {
    await page.keyboard.press('ControlOrMeta+p');
    await expect(page.locator('html')).toHaveAttribute('data-printed', times);
    await expect(page.locator('#notice')).toHaveText(lost);
  }
  await page.evaluate(() => document.getElementById('notice')?.replaceChildren());
  await teachers(page, 'Assignment');
  await expect(page.locator('#notice')).toHaveText(lost);
  expect(faults).toEqual([]);
});

test('a reader loads nothing of what is for a class', { tag: '@all' }, async ({ page }) => {
  /** @type {string[]} */
  const loaded = [];
  page.on('request', (request) => loaded.push(new URL(request.url()).pathname));
  await openLesson(page);
  await live(page, 'judge-first');
  await live(page, 'rings');
  expect(loaded.filter((path) => /\/(teach|present|collect)-/.test(path))).toEqual([]);
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
  for (const name of ['Sliders and buttons of the figures', 'Answers of the questions', 'The race'])
    await dialog.getByRole('checkbox', { name }).check();
  const link = await dialog.getByLabel('Link of the assignment').inputValue();
  await page.goto('about:blank');
  await page.goto(link);
  const task = page.getByRole('region', { name: 'Seams', exact: true });
  await expect(task.locator('.picture[data-drawn]')).toHaveCount(2);
  // The teacher's own tries, one of which solves it, stay where they were made.
  expect(link).not.toContain('stack');
  await expect(task.locator('figcaption')).toHaveText([/^Queue, 0\.7 · 2r/, /^Queue, 0\.7 · 2r/]);
  await task.getByLabel('Who comes next').selectOption('stack');
  await expect(task.getByRole('columnheader', { name: /^Stack, 0\.7/ })).toBeVisible();
  await expect(task.getByLabel('What changes')).toBeDisabled();
  await task.getByRole('slider', { name: 'Match tolerance' }).press('End');
  const header = task.getByRole('columnheader', { name: 'Stack, 0.95 · 2r, ten steps, seed 0' });
  await expect(header).toBeVisible();
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
  // Each run stands there once, the best and the worst under these names. The last one is no worse beyond chance.
  const labels = work.runs.map((/** @type {any} */ { label }) => label);
  expect(labels).toEqual([
    'Best so far: Queue, 0.7 · 2r, ten steps, seed 0',
    'Worst so far: Stack, 0.7 · 2r, ten steps, seed 0',
    'Stack, 0.95 · 2r, ten steps, seed 0',
  ]);
  expect(work.runs[0].new_per_level.slice(0, 2)).toEqual([1, 6]);
  // The larger tolerance leaves more of the surface open.
  const open = work.runs.map((/** @type {any} */ { figures }) => figures['Surface outside all discs']);
  expect(open[0]).toBeLessThan(open[2]);
  const csv = await saved('Save as CSV');
  expect(csv).toContain('answer,Which run has closer pairs?,,"The left one, ""clearly""."');
  expect(csv).toContain('run 2,label,,"Worst so far: Stack, 0.7 · 2r, ten steps, seed 0"');
  const particles = (await saved('Save the particles')).trim().split('\r\n');
  expect(particles[0]).toBe('run,particle,level,parent,radius,x,y,z,normal_x,normal_y,normal_z');
  const counts = work.runs.map((/** @type {any} */ run) => run.particles);
  expect(particles).toHaveLength(1 + counts.reduce((/** @type {number} */ sum, /** @type {number} */ n) => sum + n, 0));
  // The torus of the formula, in the coordinates of each row.
  for (const row of particles.slice(1)) {
    const [, , , , , x, y, z] = row
      .replace(/^"[^"]*"/, '')
      .split(',')
      .map(Number);
    expect(Math.hypot(Math.hypot(x, y) - 0.7, z)).toBeCloseTo(0.3, 3);
  }
  // A reload loses nothing, and the file bears the name.
  await task.getByLabel('Your name').fill('Ada L.');
  await page.reload();
  await expect(task.getByLabel('Which run has closer pairs?')).toHaveValue('The left one, "clearly".');
  const button = task.getByRole('button', { name: 'Save as JSON' });
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
            ...{ stop: 'predict-cost', question: 'What takes more?', guess: k % 3 ? 'alike' : 'placing' },
            ...{ right: 'placing', answer: 'Placing took 15.' },
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
  // A file that comes again counts once, and a file that is none takes nothing away.
  await box.setInputFiles([...classOf(1), damaged]);
  await expect(collected.getByRole('status')).toContainText('30 works collected.');
  const table = collected.getByRole('region', { name: 'Answers to Seams, on a torus' });
  await expect(table.locator('tbody tr')).toHaveCount(30);
  // For each question of the lesson bars of the guesses, with the right one marked; learners stand below.
  const bars = collected.locator('.guesses');
  await expect(bars).toHaveCount(2);
  await expect(bars.first().locator('.bar-row')).toHaveText([
    'Placing all particles right10',
    'Both about the same20',
    'The ten steps of relaxation0',
  ]);
  await expect(bars.first()).toContainText('Placing took 15.');
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
  await expect(second).toContainText('Both about the same');
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
  await openLesson(page, { hash: '#what-if-step&left=0.2&right=none' });
  const bench = page.locator('#bench');
  await expect(bench.getByLabel('Left', { exact: true })).toHaveValue('0.2');
  await expect(bench.getByLabel('Right', { exact: true })).toHaveValue('0.2');
  await bench.getByLabel('Right', { exact: true }).selectOption('1');
  await expect.poll(() => page.evaluate(() => location.hash)).toBe('#what-if-step&left=0.2&right=1');
  await page.reload();
  await expect(bench.getByLabel('Right', { exact: true })).toHaveValue('1');
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
  await expect(kept('Best so far')).toContainText('Queue, 0.7 · 2r, ten steps, seed 0');
  await expect(kept('Worst so far')).toContainText('Stack, 0.7');
  await expect(said).toContainText(
    /Worse\. Here 7\d\.\d % have six neighbours, in the sampling of the lesson 89\.\d %\./,
  );
  await expect(verdict.getByRole('listitem')).toHaveText(
    /^Stack\. .* Put back to queue, 89\.\d % have six neighbours instead of 7\d\.\d %\.$/,
  );
  await bench.getByRole('slider', { name: 'Match tolerance' }).press('Home');
  await bench.getByLabel('Relaxation', { exact: true }).selectOption('0');
  await expect(kept('Worst so far')).toContainText('Stack, 0.4 · 2r, no steps, seed 0');
  await expect(verdict.getByRole('listitem')).toHaveCount(3);
  // A choice that does no harm is named as one.
  await kept('Best so far').click();
  await expect(bench.locator('figcaption')).toHaveText([/^Stack, 0\.4/, /^Queue, 0\.7/]);
  await bench.getByLabel('Relaxation', { exact: true }).selectOption('100');
  await expect(said).toContainText('No difference beyond chance.');
  await expect(verdict).toContainText('A hundred steps. It does no harm beyond chance here.');
  await kept('Worst so far').click();
  await expect(bench.locator('figcaption')).toHaveText([/^Queue, 0\.7 · 2r, ten/, /^Stack, 0\.4/]);
  const values = 'left=queue~0.7~10~0&right=stack~0.4~0~0';
  await expect.poll(() => page.evaluate(() => location.hash)).toBe(`#what-if-fail&${values}`);
  // They are there again later, and where the address says nothing both are shown.
  await page.goto('about:blank');
  await openLesson(page, { hash: '#what-if-fail' });
  await expect(bench.locator('figcaption')).toHaveText([/^Queue, 0\.7 · 2r, ten/, /^Stack, 0\.4/]);
  await expect(kept('Worst so far')).toContainText('Stack, 0.4 · 2r, no steps, seed 0');
  expect((await axe(page)).violations.map(({ id }) => id)).toEqual([]);
  clean();
});

test('a clicker asks, shows the figures and goes through the values of a comparison', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await openLesson(page, { hash: '#what-if-step&mode=present' });
  const bench = page.locator('#bench');
  await expect(bench.getByRole('columnheader', { name: '0.2 r²' })).toBeHidden();
  await expect(bench.getByText('Which of the two is better')).toBeVisible();
  await expect(bench.locator('table.compare')).toHaveCount(1);
  await page.keyboard.press('PageDown');
  await expect(bench.getByRole('columnheader', { name: '0.2 r²' })).toBeVisible();
  await page.keyboard.press('PageDown');
  await expect(bench.getByRole('columnheader', { name: '1.0 r²' })).toBeVisible();
  await page.keyboard.press('PageUp');
  await expect(bench.getByRole('columnheader', { name: '0.2 r²' })).toBeVisible();
  for (let k = 0; k < 2; k += 1) await page.keyboard.press('PageDown');
  await expect.poll(() => page.evaluate(() => location.hash)).toContain('#what-if-fail&');
  await expect(page.locator('.challenge')).toBeVisible();
  await expect(bench.locator('figcaption').last()).toHaveText(/^Stack/);
  for (let k = 0; k < 2; k += 1) await page.keyboard.press('PageDown');
  await expect(bench.locator('figcaption').last()).toHaveText(/0\.4 · 2r/);
  clean();
});

test('a damaged assignment is named, and the lesson stays', { tag: '@all' }, async ({ page }) => {
  await openLesson(page, { hash: '#task=AAAA' });
  await expect(page.locator('#notice')).toContainText('no assignment that can be read');
  await live(page, 'judge-first');
});

for (const [kind, other] of [
  ['uniform', 'Witkin and Heckbert'],
  ['adaptive', 'Forces'],
])
  test(`the front races against ${other}, each by its own rules`, { tag: '@all' }, async ({ page }) => {
    const { clean } = await openLesson(page, { hash: '#race' });
    const race = page.locator('#race-box');
    const start = race.getByRole('button', { name: 'Start' });
    // One that is given up while it is prepared does not come back.
    await race.getByLabel('Race').selectOption(kind === 'uniform' ? 'adaptive' : 'uniform');
    await start.click();
    await race.getByLabel('Race').selectOption(kind);
    await start.click();
    await expect(race.getByRole('columnheader', { name: other })).toBeVisible();
    // Of the two races no worker is left; the figures have one, and the surface that moves, below, two.
    await expect.poll(() => page.workers().length).toBeLessThan(4);
    const rounds = await race.locator('.lane dt', { hasText: 'Rounds' }).locator('+ dd').allTextContents();
    expect(rounds[0]).toBe('10');
    expect(Number(rounds[1].replace(/\D/g, ''))).toBeGreaterThan(50);
    await expect(race.locator('.picture[data-drawn]')).toHaveCount(2);
    await expect(race.getByRole('img', { name: /times as long as the front/ })).toBeVisible();
    // The figures say of which moment they are.
    await expect(race.locator('caption')).toContainText(/^After [\d,]+ evaluations of f each/);
    // Both at the same cost: the front is done where the other has hardly begun, and neither has spent more.
    const counts = async (/** @type {string} */ name) => {
      const cells = await race.locator('.lane dt', { hasText: name }).locator('+ dd').allTextContents();
      return cells.map((cell) => Number(cell.replace(/\D/g, '')));
    };
    const ends = await counts('Evaluations');
    await race.getByRole('slider', { name: 'Spent' }).fill('100');
    const half = await counts('Evaluations');
    expect(half[0]).toBe(Math.min(ends[0], half[0]));
    expect(half[1]).toBeLessThanOrEqual(Math.max(...ends) / 2);
    expect(half[1]).toBeGreaterThan(Math.max(...ends) / 4);
    expect(Number(await race.locator('.picture').last().getAttribute('data-drawn'))).toBe(
      (await counts('Particles'))[1],
    );
    await race.getByRole('slider', { name: 'Spent' }).fill('0');
    expect((await counts('Particles'))[1]).toBeLessThan(100);
    await race.getByLabel('Both at the same').selectOption('seconds');
    await race.getByRole('button', { name: 'Replay' }).click();
    await expect.poll(() => counts('Evaluations')).toEqual(ends);
    await expect(race.getByRole('columnheader', { name: other })).toBeVisible();
    clean();
  });
