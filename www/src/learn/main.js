/** Entry point of the lesson's page: an article whose figures, questions and comparisons run the paper's algorithms. */
import '../ui/trusted.js';
import { button } from '../ui/button.js';
import { byId, fill, h, live, queryAll } from '../ui/dom.js';
import { storeSite } from '../ui/offline.js';
import { kept } from '../ui/remembered.js';
import { packed, surfaceWords } from '../ui/surface-link.js';
import { readAddress, writeAddress } from './address.js';
import { Stops } from './answers.js';
import { mountQuestion } from './ask.js';
import { FIGURES } from './chapters/index.js';
import { mountFigure } from './figure.js';
import { openSubject } from './lesson-lab.js';
import { QUESTIONS } from './questions.js';
import { written } from './score.js';
import { keepSetup, mountStops } from './stops.js';
import { mountTerms } from './terms.js';

const { subject, notice, parts, lab } = openSubject();
// An assignment has other pairs, and therefore other answers, than a reader alone.
const own = kept(['lesson', packed(subject.surface), ...(parts.task ? [parts.task] : [])].join('.'));
const stops = new Stops(own.text, own.keep);
/** The part for teachers, loaded on demand. */
const teach = () => import('./teach.js');

if (stops.isBegun()) {
  const forget = () => {
    stops.forget();
    location.reload();
  };
  const place = byId('kept');
  fill(place, 'This browser has kept your answers. ', button({ class: 'plain', press: forget }, 'Forget them'));
  place.hidden = false;
}

/** All learners of a class judge the same pairs. */
const context = { lab, stops, series: parts.task ?? stops.series() };
for (const host of queryAll(document, '[data-figure]'))
  mountFigure(host, () => FIGURES[host.dataset.figure ?? ''](context));
for (const host of queryAll(document, '.predict')) mountQuestion(host, host.id, QUESTIONS[host.id], context);
// What would give an answer away follows it.
for (const words of queryAll(document, '[data-after]'))
  live(words, () => {
    words.hidden = !stops.isOpen(words.dataset.after ?? '');
  });
mountTerms();
const bench = lab.then(async (ready) => {
  const { createBench } = await import('./bench.js');
  return createBench(byId('bench'), ready, { onChoice: keepSetup });
});
/** A sampling has failed if a smaller share keeps six neighbours. */
const FAILED = 0.5;
void bench.then(({ worst }) => {
  const done = byId('what-if-done');
  live(done, () => {
    const score = worst.value?.score;
    const isDone = score && score.six !== null && score.six < FAILED;
    done.textContent = isDone ? `Done: only ${written('six', score)} have six neighbours.` : '';
  });
});
const say = (/** @type {string} */ words) => {
  notice.textContent = words;
};
mountStops({
  stops: queryAll(document, '[data-stop]').map(({ id }) => id),
  onBench: async (given) => (await bench).open(given),
  teach,
  say: (words, place) => {
    place?.prepend(notice);
    say(words);
  },
});

/** Said when a part of the page failed to load: browsers may not request it again. */
const LOST = 'A part of this page could not be loaded. Load the page again.';

/** The dialog for teachers, once it was requested. @type {{ open: () => void } | null} */
let maker = null;
async function makeAssignment() {
  try {
    const [{ createMaker }, { setup }] = await Promise.all([teach(), bench]);
    maker ??= createMaker({ setup, linkOf });
  } catch {
    return say(LOST);
  }
  maker.open();
}

/** Prints the questions without guesses or answers. */
async function print() {
  try {
    (await teach()).printQuestions(byId('questions'));
  } catch {
    say(LOST);
  }
}

const tool = (/** @type {string} */ label, /** @type {() => unknown} */ press) =>
  button({ class: 'plain', press: () => void press() }, label);
const teachers = h(
  'details',
  // A chosen tool replaces the list.
  {
    class: 'teachers',
    on: { click: ({ target }) => target instanceof Element && !target.closest('summary') && close() },
  },
  h('summary', { class: 'button plain' }, 'For teachers'),
  h(
    'div',
    { class: 'teachers-list' },
    tool('Print the questions', print),
    tool('Assignment', makeAssignment),
    h('a', { class: 'button plain', href: '#collect' }, 'Collect answers'),
  ),
);
const close = () => teachers.toggleAttribute('open', false);
byId('tools').append(teachers);

/** The address of this lesson with an assignment. @param {string} task */
function linkOf(task) {
  const { surface } = readAddress(location.hash).parts;
  return (
    location.origin + location.pathname + writeAddress({ stop: '', parts: { ...(surface ? { surface } : {}), task } })
  );
}

storeSite('../service-worker.js');

if (parts.task) {
  try {
    const [{ unpackTask, mountAssignment }, ready] = await Promise.all([teach(), lab]);
    const task = unpackTask(parts.task);
    if (task)
      await mountAssignment(byId('assignment'), task, { lab: ready, surface: surfaceWords(ready.surface), stops });
    else say('The link holds no assignment that can be read. The lesson is complete without it.');
  } catch {
    say(LOST);
  }
}
