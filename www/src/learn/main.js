/** Entry point of the lesson's page: an article whose figures, questions and comparisons run the paper's algorithms. */
import '../ui/trusted.js';
import { kindOf, LessonClient } from '../engine/lesson/client.js';
import { Meter } from '../engine/sampling/meter.js';
import { button } from '../ui/button.js';
import { byId, query, queryAll } from '../ui/dom.js';
import { storeSite } from '../ui/offline.js';
import { surfaceWords } from '../ui/surface-link.js';
import { readAddress, writeAddress } from './address.js';
import { FIGURES } from './chapters/index.js';
import { mountFigure } from './figure.js';
import { createHandout } from './handout.js';
import { Lab, NoSurface, PARTICLES } from './lab.js';
import { mountPrediction, Stops } from './predict.js';
import { PREDICTIONS } from './predictions.js';
import { keepSetup, mountStops } from './stops.js';
import { subjectOf } from './surface.js';
import { unpackTask } from './task.js';
import { FAIL, setupOf, sidesOf, stopsOfBench, WHAT_IFS } from './whatifs.js';

const address = readAddress(location.hash);
const subject = subjectOf(address.parts.surface);
const open = async () => new LessonClient();
const meter = new Meter();
const notice = byId('notice');
const stops = new Stops();

/** Tries the learner's surface; where it has no particles, the ellipsoid stands in. */
async function openLab() {
  if (!subject.isOwn) return new Lab(subject.surface, open, meter);
  const own = new Lab(subject.surface, open, meter);
  try {
    await own.radiusFor(PARTICLES);
    return own;
  } catch (error) {
    const isRefused = error instanceof NoSurface || kindOf(error) === 'refused';
    if (!isRefused) return own;
    const stand = subjectOf(undefined).surface;
    notice.textContent = `${error instanceof Error ? error.message : error} The figures show an ellipsoid.`;
    byId('surface-name').textContent = 'an ellipsoid';
    return new Lab(stand, open, meter);
  }
}

/** The comparison whose picture is to be told from the other: both without a word. @param {Lab} lab */
async function blindPair(lab) {
  const { createPair } = await import('./pair.js');
  const pair = createPair(lab, { bare: true });
  const order = WHAT_IFS[0];
  const [queue, stack] = sidesOf(order, ['queue', 'stack']);
  await pair.show(
    [
      { ...stack, label: 'A' },
      { ...queue, label: 'B' },
    ],
    'level',
  );
  return [pair.element];
}

notice.textContent = subject.notice;
if (subject.isOwn) byId('surface-name').textContent = `your surface, ${surfaceWords(subject.surface)}`;
for (const id of ['#back', '#back-end']) query(document, id, HTMLAnchorElement).href = `../${subject.from}`;

const lab = openLab();
const context = { lab, stops };
const figures = queryAll(document, '[data-figure]').map((host) => {
  const name = host.dataset.figure ?? '';
  const build = name === 'order' ? async () => blindPair(await lab) : () => FIGURES[name](context);
  return mountFigure(host, build);
});
// The numbers of the text are handles of live figures.
for (const { stage, ready } of figures) void ready.then(async () => (await import('./drag.js')).mountNumbers(stage));
for (const host of queryAll(document, '.predict')) mountPrediction(host, PREDICTIONS[host.id], context);
const bench = lab.then(async (ready) => {
  const { createBench, mountCards } = await import('./bench.js');
  mountCards(byId('cards'), ready);
  void import('./race.js').then(({ mountRace }) => mountRace(byId('race-box'), ready));
  return createBench(byId('bench'), ready, { onChoice: keepSetup });
});
const { present } = mountStops({
  stops: [...document.querySelectorAll('[data-stop]')].map(({ id }) => id),
  others: stopsOfBench,
  questions: stops,
  onBench: async (id, given) => {
    const { open, show, setup } = await bench;
    // What has a slide of its own is not on that of the comparisons.
    if (id) await open(id, given);
    else await show(setup().what === FAIL ? setupOf(WHAT_IFS[0].id) : setup());
  },
  onCollect: async () => {
    const { mountCollect } = await import('./collect.js');
    await mountCollect(byId('collect'));
  },
  say: (words, place) => {
    place?.prepend(notice);
    notice.textContent = words;
  },
});

/** The dialog for teachers, once it is asked for. @type {{ open: () => void } | null} */
let maker = null;
const handout = createHandout(byId('answers'), {
  figures,
  lab,
  async compare() {
    const { show, setup } = await bench;
    await show(setup());
  },
  say: (words) => {
    notice.textContent = words;
  },
});
const tool = (/** @type {string} */ label, /** @type {() => void} */ press) => button({ class: 'plain', press }, label);
byId('tools').append(
  tool('Present', present),
  handout.button,
  tool('Assignment', async () => {
    const [{ createMaker }, { setup }] = await Promise.all([import('./assignment.js'), bench]);
    maker ??= createMaker({ setup, linkOf });
    maker.open();
  }),
);

/** The address of this lesson with an assignment. @param {string} task */
function linkOf(task) {
  const { surface } = readAddress(location.hash).parts;
  return (
    location.origin + location.pathname + writeAddress({ stop: '', parts: { ...(surface ? { surface } : {}), task } })
  );
}

if (address.parts.task) {
  const task = unpackTask(address.parts.task);
  if (!task) notice.textContent = 'The link holds no assignment that can be read. The lesson is complete without it.';
  else
    void Promise.all([import('./assignment.js'), lab]).then(([{ mountAssignment }, ready]) =>
      mountAssignment(byId('assignment'), task, { lab: ready, surface: surfaceWords(ready.surface), stops }),
    );
}
storeSite('../service-worker.js');
