/**
 * Collect: a lecturer drops the files that learners saved, and sees how often each answer was guessed, with the right
 * one marked. The files are read in this page and sent nowhere.
 */
import { button } from '../ui/button.js';
import { fill, h, uniqueId } from '../ui/dom.js';
import { formatCount, MISSING, plural } from '../ui/format.js';
import { download } from '../ui/share.js';
import { loadSheet } from '../ui/sheet.js';
import { tableOf } from '../ui/table.js';
import sheet from './collect.css?url';
import { choicesOf, QUESTIONS } from './questions.js';
import { ROWS } from './score.js';
import { readWork, tableOfAll } from './task.js';

/** @import { Guessed, Work } from './types.js' */

/** Larger files, in bytes, are not read. */
const LARGEST = 8e6;

/** @param {HTMLElement} host */
export async function mountCollect(host) {
  await loadSheet(sheet);
  host.hidden = false;
  if (host.childElementCount > 0) return;
  /** The works read, by their text, so that a file counts once. @type {Map<string, Work>} */
  const works = new Map();
  const id = uniqueId('files');
  const input = h('input', {
    type: 'file',
    id,
    accept: '.json,application/json',
    prop: { multiple: true },
    on: { change: () => void take([...(input.files ?? [])]) },
  });
  const told = h('p', { role: 'status' });
  const tables = h('div', { class: 'collected' });
  const save = button(
    {
      hidden: true,
      press: () => download(new Blob([tableOfAll(inOrder())], { type: 'text/csv;charset=utf-8' }), 'collected.csv'),
    },
    'Save all as one CSV',
  );
  const clear = button(
    {
      hidden: true,
      press: () => {
        works.clear();
        write();
      },
    },
    'Clear',
  );
  fill(
    host,
    h('h2', { id: 'collect-title' }, 'Collect answers'),
    h('label', { class: 'drop', for: id }, 'Drop the JSON files of your learners here, or choose them: ', input),
    h('p', { class: 'quiet' }, 'They are read in this page and sent nowhere. A reload forgets them.'),
    told,
    h('div', { class: 'controls' }, save, clear),
    tables,
  );
  const inOrder = () =>
    [...works.values()].sort((a, b) => order.compare(a.group, b.group) || order.compare(a.name, b.name));

  /** @param {readonly File[]} files */
  async function take(files) {
    const [refused, equal] = [[], []].map((names) => /** @type {string[]} */ (names));
    for (const file of files) {
      const text = file.size > LARGEST ? '' : await file.text().catch(() => '');
      const work = readWork(text);
      if (!work) refused.push(file.name);
      else if (works.has(text)) equal.push(file.name);
      else works.set(text, work);
    }
    input.value = '';
    write(refused, equal);
  }

  /**
   * @param {readonly string[]} [refused]  names of files
   * @param {readonly string[]} [equal]  to another one
   */
  function write(refused = [], equal = []) {
    told.textContent = [
      `${plural(works.size, 'work')} collected.`,
      equal.length > 0
        ? `Counted once, since ${equal.length === 1 ? 'it equals' : 'they equal'} a file that was there: ${equal.join(', ')}.`
        : '',
      refused.length > 0
        ? `Left out, since they are not the work of a learner or are damaged: ${refused.join(', ')}.`
        : '',
    ].join(' ');
    for (const one of [save, clear]) one.hidden = works.size === 0;
    /** @type {Map<string, Work[]>} */
    const groups = new Map();
    for (const work of inOrder()) {
      const key = `${work.assignment || 'Assignment'}, on ${work.surface}`;
      groups.set(key, [...(groups.get(key) ?? []), work]);
    }
    fill(
      tables,
      [...groups].map(([title, group]) => [answersOf(title, group), runTable(group)]),
    );
  }

  for (const type of ['dragenter', 'dragover'])
    host.addEventListener(type, (event) => {
      event.preventDefault();
      host.dataset.over = '';
    });
  host.addEventListener('dragleave', () => {
    delete host.dataset.over;
  });
  host.addEventListener('drop', (event) => {
    event.preventDefault();
    delete host.dataset.over;
    void take([...(event.dataTransfer?.files ?? [])]);
  });
}

/** A table that scrolls by itself if it is wider than the page. @param {string} name @param {Node} table */
const scrolled = (name, table) =>
  h('div', { class: 'collect-table', role: 'region', 'aria-label': name, tabindex: 0 }, table);

/** The questions in works, in order of first appearance. @param {readonly { question: string }[]} all */
const questionsOf = (all) => [...new Set(all.map(({ question }) => question))];

/** A guess in the words of the page. @param {Guessed | undefined} guessed */
function guessWords(guessed) {
  if (!guessed || guessed.guess === null) return MISSING;
  return choicesOf(guessed.stop).find(({ value }) => value === guessed.guess)?.label ?? String(guessed.guess);
}

/** Whether a question has a single right answer, the same for all learners. @param {Guessed} guessed */
const hasBars = ({ stop }) => choicesOf(stop).length > 0 || Object.hasOwn(QUESTIONS, stop);

/**
 * How often each answer to a question was guessed, as bars, with the right one marked.
 * @param {string} question @param {readonly Guessed[]} all  of this question
 */
function barsOf(question, all) {
  const guesses = all.flatMap(({ guess }) => (guess === null ? [] : [guess]));
  const known = all.find(({ right }) => right !== undefined);
  const choices = choicesOf(all[0].stop);
  const values =
    choices.length > 0
      ? choices.map(({ value }) => value)
      : [...new Set([...guesses, ...(known ? [known.right ?? ''] : [])])].sort((a, b) => Number(a) - Number(b));
  const counts = values.map((value) => guesses.filter((guess) => guess === value).length);
  const most = Math.max(1, ...counts);
  const rows = values.map((value, k) => {
    const isRight = value === known?.right;
    return h(
      'li',
      { class: 'bar-row', 'data-right': isRight ? '' : null },
      h('span', null, choices[k]?.label ?? String(value), isRight ? h('b', null, ' right') : null),
      h('span', { class: 'cost-bar', style: { width: `${(100 * counts[k]) / most}%` } }),
      h('span', null, formatCount(counts[k])),
    );
  });
  const open = all.length - guesses.length;
  return h(
    'section',
    { class: 'guesses' },
    h('h3', null, question),
    h('ul', null, rows),
    open > 0 ? h('p', { class: 'quiet' }, `${plural(open, 'learner')} skipped it.`) : null,
    known ? h('p', null, known.answer) : h('p', { class: 'quiet' }, 'Nobody has revealed the answer.'),
  );
}

/**
 * The learners' guesses, question by question, then everything that each of them wrote.
 * @param {string} title @param {readonly Work[]} works
 */
function answersOf(title, works) {
  const all = works.flatMap(({ predictions }) => predictions);
  const bars = questionsOf(all.filter(hasBars)).map((question) =>
    barsOf(
      question,
      all.filter((one) => one.question === question),
    ),
  );
  const asked = questionsOf(works.flatMap(({ answers }) => answers));
  const guessed = questionsOf(all);
  const table = tableOf({
    class: 'compare',
    caption: 'Learners',
    head: ['Name', 'Class', ...asked, ...guessed],
    rows: works.map(({ name, group, answers, predictions }) =>
      [
        name,
        group,
        ...asked.map((question) => answers.find((one) => one.question === question)?.answer),
        ...guessed.map((question) => guessWords(predictions.find((one) => one.question === question))),
      ].map((words) => words || MISSING),
    ),
  });
  return [
    h('h2', null, `${title}: ${plural(works.length, 'work')}`),
    bars.length > 0 ? h('div', { class: 'guesses-box' }, bars) : null,
    scrolled(`Answers to ${title}`, table),
  ];
}

/** Orders numbers in names and labels by value. */
const order = new Intl.Collator('en', { numeric: true });

/** A key that distinguishes runs. @param {any} run */
const keyOf = ({ label, figures }) => JSON.stringify([label, figures]);

/** The figures of the learners' runs, each with the number of learners. @param {readonly Work[]} works */
function runTable(works) {
  /** @type {Map<string, { run: any, count: number }>} */
  const found = new Map();
  for (const { runs } of works) {
    // A learner counts once per run, even if a file lists it several times.
    const own = new Map(runs.map((run) => [keyOf(run), run]));
    for (const [key, run] of own) found.set(key, { run, count: (found.get(key)?.count ?? 0) + 1 });
  }
  if (found.size === 0) return null;
  const rows = [...found.values()].sort(
    (a, b) => b.count - a.count || order.compare(String(a.run.label), String(b.run.label)),
  );
  const table = tableOf({
    class: 'compare',
    caption: 'What their runs give',
    head: ['Run', ...ROWS.map(({ name }) => name), 'Learners'],
    rows: rows.map(({ run, count }) => [
      String(run.label),
      ...ROWS.map(({ name, write }) => {
        const value = run.figures?.[name];
        return typeof value === 'number' ? write(value) : MISSING;
      }),
      formatCount(count),
    ]),
  });
  return scrolled('What their runs give', table);
}
