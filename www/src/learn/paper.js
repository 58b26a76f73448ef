/** Prints the questions on two pages, without guesses or answers, with space to write. */
import { fill, h } from '../ui/dom.js';
import { PURPOSES } from './pairs.js';
import { partsOf, QUESTIONS } from './questions.js';

/** @import { Part } from './types.js' */

/** The blanks to tick or to fill in. @param {Part<any>} part */
const blankOf = ({ kind, choices = [], label }) =>
  kind === 'choice'
    ? h(
        'ul',
        { class: 'blanks' },
        choices.map((choice) => h('li', null, choice.label)),
      )
    : h('p', { class: 'blank' }, kind === 'number' ? `${label}:` : 'Say where, and why there:');

/** The questions in page order, then the purposes for which pairs are judged. */
const questions = () => {
  const why = () => h('p', { class: 'blank' }, 'Why:');
  const ids = Array.from(document.querySelectorAll('.chapter .predict'), ({ id }) => id);
  const asked = ids.filter((id) => Object.hasOwn(QUESTIONS, id)).map((id) => QUESTIONS[id]);
  return [
    ...asked.map((about) => h('li', null, h('p', null, about.question), partsOf(about).map(blankOf), why())),
    ...PURPOSES.map(({ story }) =>
      h('li', null, h('p', null, `${story} Which figure tells how good a sampling is for that?`), why()),
    ),
  ];
};

/** @param {HTMLElement} host */
export function printQuestions(host) {
  const name = h('p', { class: 'blank' }, 'Name and class:');
  fill(
    host,
    h('h2', { id: 'questions-title' }, 'How particles march over a surface: questions'),
    name,
    h('ol', null, questions()),
  );
  const { dataset } = document.documentElement;
  dataset.prints = 'questions';
  addEventListener('afterprint', () => delete dataset.prints, { once: true });
  window.print();
}
