/**
 * Assignments: a link that fixes the surface and a comparison, locks chosen controls and asks questions. A learner's
 * answers are saved with both runs in one file; nothing is sent.
 */
import { button } from '../ui/button.js';
import { fill, h, uniqueId } from '../ui/dom.js';
import { kept } from '../ui/remembered.js';
import { download } from '../ui/share.js';
import { createBench } from './bench.js';
import { USUAL } from './knobs.js';
import { ringsOf } from './measure.js';
import { namedFigures } from './score.js';
import { CONTROLS, LONGEST_TITLE, lockedWords, packTask } from './task.js';

/** @import { Control, Lab, LabRun, Score, Setup, Stops, Task, Work } from './types.js' */

/** A run as plain numbers, for the file. @param {string} label @param {LabRun} run @param {Score} [score] */
const recordOf = (label, run, score) => ({
  label,
  settings: run.settings,
  radius: run.radius,
  particles: run.progress.particles,
  evaluations: run.progress.evaluations,
  figures: score ? namedFigures(score) : null,
  new_per_level: ringsOf(run.placed),
  fates_per_level: run.chapters.filter(({ kind }) => kind === 'level').map(({ fates }) => fates),
  energy_per_step: run.chapters.filter(({ kind }) => kind === 'relaxation').map(({ energy }) => energy),
});

/** A file name made of the letters and digits of some words. @param {readonly string[]} words */
const fileName = (words) => words.flatMap((word) => word.match(/[\p{L}\p{N}]+/gu) ?? []).join('-') || 'assignment';

/**
 * Puts an assignment before the first chapter.
 * @param {HTMLElement} host @param {Task} task @param {{ lab: Lab, surface: string, stops: Stops }} context
 */
export async function mountAssignment(host, task, { lab, surface, stops }) {
  const id = uniqueId('assignment');
  const benchHost = h('div', { class: 'bench' });
  const answers = task.questions.map((question) => {
    const own = uniqueId('answer');
    return { question, box: h('textarea', { id: own, class: 'answer-box', rows: 3 }), id: own };
  });
  const [name, group] = ['Your name', 'Class'].map((label) => ({
    label,
    box: h('input', { class: 'box wide', id: uniqueId('learner'), autocomplete: 'off' }),
  }));
  // The text that was typed for this assignment is restored when the page is opened again in this browser.
  const boxes = [name.box, group.box, ...answers.map(({ box }) => box)];
  const { text, keep } = kept(`assignment.${packTask(task)}`);
  for (const [k, value] of text.split('\0').entries()) if (boxes[k]) boxes[k].value = value;
  host.addEventListener('input', () => keep(boxes.map(({ value }) => value).join('\0')));
  /** @param {Awaited<ReturnType<typeof createBench>>} bench @returns {Work} */
  const workOf = (bench) => {
    return {
      assignment: task.title,
      surface,
      name: name.box.value,
      group: group.box.value,
      answers: answers.map(({ question, box }) => ({ question, answer: box.value })),
      predictions: stops.predictions(),
      runs: bench.runs().map(({ label, run, score }) => recordOf(label, run, score)),
    };
  };
  const save = async () => {
    // Right after the page was opened there may be no bench yet.
    const bench = await opening;
    await bench.settled();
    const text = `${JSON.stringify(workOf(bench), null, 2)}\n`;
    const blob = new Blob([text], { type: 'application/json' });
    download(blob, `${fileName([task.title, group.box.value, name.box.value])}.json`);
  };
  fill(
    host,
    h('h2', { id }, task.title || 'Assignment'),
    task.locks.length > 0 ? h('p', { class: 'quiet' }, lockedWords(task.locks)) : null,
    benchHost,
    [name, group].map(({ label, box }) => h('div', { class: 'answer-row' }, h('label', { for: box.id }, label), box)),
    answers.map(({ question, box, id: own }) =>
      h('div', { class: 'answer-row' }, h('label', { for: own }, question), box),
    ),
    h(
      'div',
      { class: 'controls' },
      button({ class: 'primary', press: () => void save() }, 'Save your work'),
      h(
        'span',
        { class: 'quiet' },
        'With your answers, your predictions and both runs. Nothing is sent; this browser keeps what you type.',
      ),
    ),
  );
  host.setAttribute('aria-labelledby', id);
  host.hidden = false;
  const opening = createBench(benchHost, lab, { locks: task.locks }).then((bench) => {
    void bench.open(task.setup);
    return bench;
  });
  await opening;
}

/**
 * The dialog for a teacher to create an assignment.
 * @param {{ setup: () => Setup, linkOf: (task: string) => string }} about
 */
export function createMaker({ setup, linkOf }) {
  const title = h('input', { class: 'box wide', id: uniqueId('title'), maxlength: LONGEST_TITLE });
  const questions = h('textarea', { class: 'answer-box', id: uniqueId('questions'), rows: 4 });
  const locks = CONTROLS.map(({ value, label, usual = false }) => {
    const box = h('input', { type: 'checkbox', value, checked: usual });
    return { box, element: h('label', { class: 'check' }, box, label) };
  });
  const what = h('p', { class: 'quiet' });
  const link = h('input', { class: 'box wide', readonly: true, 'aria-label': 'Link of the assignment' });
  const told = h('p', { class: 'quiet', role: 'status' });
  const write = () => {
    const own = locks.flatMap(({ box }) => (box.checked ? [/** @type {Control} */ (box.value)] : []));
    // If learners are to find the best and the worst, the teacher's own tries would give the solution away.
    const isGiven = own.includes('right');
    what.textContent = `It has the surface of “What if”. ${isGiven ? 'Learners see the two samplings that stand there.' : 'Learners begin with the sampling of the lesson; your own tries stay here.'}`;
    const task = {
      title: title.value,
      setup: isGiven ? setup() : { ...setup(), left: USUAL, right: USUAL },
      locks: own,
      questions: questions.value
        .split('\n')
        .map((line) => line.trim())
        .filter(Boolean),
    };
    link.value = linkOf(packTask(task));
    told.textContent = '';
  };
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(link.value);
      told.textContent = 'Link copied.';
    } catch {
      link.select();
      told.textContent = 'Copy the link from its box.';
    }
  };
  const id = uniqueId('maker');
  const dialog = h(
    'dialog',
    { class: 'dialog maker', 'aria-labelledby': id, on: { input: write } },
    h('h2', { id }, 'Make an assignment'),
    what,
    h('div', { class: 'answer-row' }, h('label', { for: title.id }, 'Title'), title),
    h('div', { class: 'answer-row' }, h('label', { for: questions.id }, 'Questions, one on each line'), questions),
    h(
      'fieldset',
      { class: 'predict-choices' },
      h('legend', null, 'Locked for learners'),
      locks.map(({ element }) => element),
    ),
    h('div', { class: 'answer-row' }, link),
    h(
      'div',
      { class: 'controls' },
      button({ class: 'primary', press: () => void copy() }, 'Copy the link'),
      button({ press: () => dialog.close() }, 'Close'),
      h('a', { class: 'button plain', href: '#collect', on: { click: () => dialog.close() } }, 'Collect answers'),
    ),
    told,
  );
  document.body.append(dialog);
  return {
    open() {
      write();
      dialog.showModal();
    },
  };
}
