/** Assignments as plain data, in a link and in a learner's file. */
import { packed, unpacked } from '../ui/surface-link.js';
import { setupOf } from './knobs.js';

/**
 * @import { Control, Task, Work } from './types.js'
 */

export const LONGEST_TITLE = 120;
const LONGEST_QUESTION = 500;
const MOST_QUESTIONS = 20;
/**
 * The controls that may be locked. `words` describe them to a learner; `usual` ones are locked unless the teacher
 * unlocks them.
 * @type {readonly { value: Control, label: string, words: string, usual?: boolean }[]}
 */
export const CONTROLS = [
  { value: 'on', label: 'Surface', words: 'the surface', usual: true },
  { value: 'right', label: 'Sampling on the right', words: 'the sampling on the right' },
];

/** Describes the locked controls to the learner; empty if none is locked. @param {readonly Control[]} locks */
export const lockedWords = (locks) => {
  const names = CONTROLS.filter(({ value }) => locks.includes(value)).map(({ words }) => words);
  return names.length > 0 ? `Locked: ${names.join('; ')}.` : '';
};

/** @param {Task} task */
export const packTask = (task) => packed(task);

/**
 * Reads an assignment from an address, which may contain anything; null if it is not one.
 * @param {string} text
 * @returns {Task | null}
 */
export function unpackTask(text) {
  const raw = unpacked(text);
  if (typeof raw !== 'object' || raw === null || !Array.isArray(raw.questions)) return null;
  if (typeof raw.setup !== 'object' || raw.setup === null) return null;
  return {
    title: String(raw.title ?? '').slice(0, LONGEST_TITLE),
    setup: setupOf(raw.setup),
    locks: CONTROLS.map(({ value }) => value).filter((control) => raw.locks?.includes?.(control)),
    questions: raw.questions
      .slice(0, MOST_QUESTIONS)
      .map((/** @type {unknown} */ q) => String(q).slice(0, LONGEST_QUESTION)),
  };
}

/** A cell of a table of comma-separated values. @param {unknown} value */
function cell(value) {
  const text = typeof value === 'object' ? JSON.stringify(value) : String(value ?? '');
  // A spreadsheet would run a formula at the beginning of a cell.
  const safe = /^[=+@-]/.test(text) && Number.isNaN(Number(text)) ? `'${text}` : text;
  return /[",\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

/**
 * A record as rows of a name, a number and one value; entries of a list are numbered, as are levels and steps.
 * @param {object} record
 * @returns {unknown[][]}
 */
const flat = (record) =>
  Object.entries(record).flatMap(([name, value]) => {
    if (typeof value !== 'object' || value === null) return [[name, '', value]];
    return Object.entries(value).flatMap(([key, own]) => {
      const [inner, number] = Array.isArray(value)
        ? [name, Number(key)]
        : [`${name}: ${key}`, /** @type {const} */ ('')];
      if (typeof own !== 'object' || own === null) return [[inner, number, own]];
      return Object.entries(own).map(([last, one]) => [`${inner}: ${last}`, number, one]);
    });
  });

/** The lines of a table. @param {readonly (readonly unknown[])[]} rows */
const written = (rows) => `${rows.map((row) => row.map(cell).join(',')).join('\r\n')}\r\n`;

const COLUMNS = ['part', 'name', 'number', 'value'];

/** The work in rows of these columns. @param {Work} work @returns {unknown[][]} */
const rowsOf = ({ assignment, surface, name: learner, group, answers, predictions, runs }) => [
  ...Object.entries({ title: assignment, surface, name: learner, class: group }).map((pair) => [
    'assignment',
    pair[0],
    '',
    pair[1],
  ]),
  ...answers.map(({ question, answer }) => ['answer', question, '', answer]),
  ...predictions.flatMap(({ question, guess, answer }) => [
    ['prediction', question, '', guess],
    ['run', question, '', answer],
  ]),
  ...runs.flatMap((run, k) => flat(run).map((row) => [`run ${k + 1}`, ...row])),
];

/** The works of several learners as one table; the first column numbers the works. @param {readonly Work[]} works */
export const tableOfAll = (works) =>
  written([['work', ...COLUMNS], ...works.flatMap((work, k) => rowsOf(work).map((row) => [k + 1, ...row]))]);

/**
 * Reads a learner's work from a file, which may contain anything; null if it is not one.
 * @param {string} text
 * @returns {Work | null}
 */
export function readWork(text) {
  let raw = null;
  try {
    raw = JSON.parse(text);
  } catch {
    return null;
  }
  const lists = [raw?.answers, raw?.predictions, raw?.runs];
  if (typeof raw?.assignment !== 'string' || !lists.every(isListOfObjects)) return null;
  const word = (/** @type {unknown} */ value) => String(value ?? '');
  return {
    assignment: raw.assignment,
    surface: word(raw.surface),
    name: word(raw.name),
    group: word(raw.group),
    answers: raw.answers.map((/** @type {any} */ { question, answer }) => ({
      question: word(question),
      answer: word(answer),
    })),
    predictions: raw.predictions.map((/** @type {any} */ { stop, question, guess, right, answer }) => ({
      stop: word(stop),
      question: word(question),
      guess: isValue(guess) ? guess : null,
      ...(isValue(right) ? { right } : {}),
      answer: word(answer),
    })),
    runs: raw.runs,
  };
}

/** @param {unknown} value */
const isValue = (value) => typeof value === 'number' || typeof value === 'string';

/** @param {unknown} value */
const isListOfObjects = (value) =>
  Array.isArray(value) && value.every((one) => typeof one === 'object' && one !== null && !Array.isArray(one));
