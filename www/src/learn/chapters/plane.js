/**
 * The learner plays the algorithm: slot by slot they make the run's decisions, for two particles of a plane and for the
 * place on a cap where the front meets itself. The run objects to a different decision.
 */
import { computed, signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { algorithmList } from '../../figures/algorithm.js';
import { tangentPlane } from '../../figures/drawings.js';
import { inPlane, slotPlace } from '../../figures/geometry.js';
import { momentAt } from '../../figures/moment.js';
import { fateShape } from '../../figures/svg.js';
import { tell } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { h, live, s } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { createSelect } from '../../ui/select.js';
import { loadSheet } from '../../ui/sheet.js';
import { decisionsOf, letterOf, objection, openNamed, PATCHES, runOn, treatedOf } from '../decisions.js';
import sheet from '../plane.css?url';

/**
 * @import { Signal } from '../../engine/types.js'
 * @import { Choice } from '../../ui/types.js'
 * @import { Moment, Opened, Point } from '../../figures/types.js'
 * @import { Context, Decision, Patch, Stops, Verdict } from '../types.js'
 */

/**
 * A slot to decide. `near`: the particles that may be there.
 * @typedef {{ opened: Opened, decision: Decision, moment: Moment, near: readonly Choice<number>[] }} Turn
 */

/** The shapes of a child's fates. */
const SHAPES = [
  ['open', 'a child, not decided yet'],
  ['parent', 'the parent'],
  ['matched', 'a child that is there already'],
  ['added', 'a new child'],
];

/** @param {Context} context */
export async function plane(context) {
  await loadSheet(sheet);
  const chosen = signal(0);
  const place = h('div', { class: 'plane-box' });
  /** @type {Map<number, HTMLElement>} */
  const made = new Map();
  async function choose(/** @type {number} */ k) {
    const exercise = made.get(k) ?? (await begin(context, PATCHES[k], () => void choose(k + 1)));
    made.set(k, exercise);
    chosen.value = k;
    // `fill` would dispose of the old exercise, which may be shown again.
    place.replaceChildren(exercise);
  }
  const buttons = PATCHES.map(({ name }, k) =>
    button({ 'aria-pressed': () => String(chosen.value === k), press: () => void choose(k) }, name),
  );
  await choose(0);
  const entry = (/** @type {Element} */ mark, /** @type {string} */ words) => {
    const svg = s('svg', { class: 'shape drawing', viewBox: '-1.2 -1.2 2.4 2.4', 'aria-hidden': 'true' });
    svg.append(mark);
    return h('li', null, svg, words);
  };
  const key = SHAPES.map(([fate, words]) => entry(fateShape(fate, [0, 0], 0.9), words));
  return [
    h('div', { class: 'controls choices', role: 'group', 'aria-label': 'Surface' }, buttons),
    place,
    h('ul', { class: 'key' }, key),
  ];
}

/** @param {Context} context @param {Patch} patch @param {() => void} goOn */
async function begin({ lab, stops }, patch, goOn) {
  const run = await runOn(await lab, patch);
  /** @type {Turn[]} */
  const turns = [];
  try {
    for (const particle of await treatedOf(run, patch)) turns.push(...turnsOf(await openNamed(run, particle)));
  } finally {
    run.client.close();
  }
  return createExercise(patch, { turns, stops, goOn });
}

/** @param {Opened} opened @returns {Turn[]} */
function turnsOf(opened) {
  const decisions = decisionsOf(opened.events);
  const { gathered = null } = decisions[0] ? momentAt(opened.events, decisions[0].at) : {};
  const near = (gathered?.neighbours ?? []).map(({ particle }) => ({
    value: particle,
    label: `particle ${letterOf(particle)}`,
  }));
  return decisions.map((decision) => {
    const moment = { ...momentAt(opened.events, decision.at), slot: decision.slot, isNow: true };
    return { opened, decision, moment, near };
  });
}

/**
 * One patch, decided slot by slot.
 * @param {Patch} patch @param {{ turns: readonly Turn[], stops: Stops, goOn: () => void }} about
 */
function createExercise(patch, { turns, stops, goOn }) {
  const kept = stops.more(stopOf(patch)) ?? {};
  /** Who has decided each slot so far. @type {Signal<readonly ('right' | 'left')[]>} */
  const answers = signal(kept.answers ?? []);
  /** They stay counted when one goes back. @type {Signal<readonly string[]>} */
  const mistakes = signal(kept.mistakes ?? []);
  const told = signal({ state: '', words: '' });
  const next = computed(() => turns[answers.value.length] ?? null);
  const particles = [...new Set(turns.map(({ opened }) => opened))];
  // A question about the second particle is asked before its turn.
  const waits = computed(
    () => !!patch.asks && !!next.value && next.value.opened !== particles[0] && !stops.isOpen(patch.asks),
  );
  const now = computed(() => (waits.value ? null : next.value));
  const score = () => scoreOf(answers.value, mistakes.value);

  /** @param {readonly ('right' | 'left')[]} next @param {string} [words] */
  function go(next, words = '') {
    answers.value = next;
    told.value = { state: words && 'right', words };
    keep();
  }

  /** Stores the round, for an assignment too. */
  function keep() {
    const said = mistakes.peek();
    stops.keepMore(stopOf(patch), { answers: answers.peek(), mistakes: said });
    const question = `${patch.name}, slot by slot: number of mistakes`;
    stops.record({ stop: stopOf(patch), question, guess: said.length, answer: [...score(), ...said].join('; ') });
  }

  /** @param {Verdict} said */
  function decide(said) {
    const turn = now.peek();
    if (!turn) return;
    const { opened, decision } = turn;
    const why = objection(opened, decision, said);
    if (!why) return go([...answers.peek(), 'right'], wordsOf(turn));
    const other = said.fate === 'matched' ? ` with ${letterOf(said.particle ?? 0)}` : '';
    const mistake = `particle ${letterOf(opened.subject.particle)}, slot ${decision.slot}: said ${said.fate}${other}`;
    mistakes.value = [...mistakes.peek(), mistake];
    told.value = { state: 'wrong', words: `The run objects. ${why}` };
    keep();
  }

  function leave() {
    const turn = now.peek();
    if (turn) go([...answers.peek(), 'left'], wordsOf(turn));
  }

  /** @param {MouseEvent} event */
  function press(event) {
    const turn = now.peek();
    const matrix = box.querySelector('svg')?.getScreenCTM()?.inverse();
    if (!turn || !matrix) return;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    const said = pressed(turn, [x, -y]);
    if (typeof said === 'string') told.value = { state: '', words: said };
    else decide(said);
  }

  const box = h('div', { class: 'drawing-box plane-drawing', on: { click: press } }, () =>
    drawingOf(now.value, waits.value ? particles[0] : particles[particles.length - 1]),
  );
  const isOver = () => next.value === null;
  const isLast = patch === PATCHES.at(-1);
  return h(
    'div',
    { class: 'plane' },
    h('p', { class: 'plane-question', 'aria-live': 'polite' }, () =>
      now.value ? asking(now.value) : waits.value ? patch.waits : patch.ends,
    ),
    box,
    h(
      'div',
      { class: 'side' },
      answersOf({ now: () => now.value, decide, leave }),
      h('p', { class: 'told', role: 'status', data: { state: () => told.value.state } }, () => told.value.words),
      button({ class: 'primary', hidden: () => !isOver() || isLast, press: goOn }, 'Go to the cap'),
      h(
        'div',
        { class: 'controls plane-score' },
        h('p', { class: 'figure-count' }, () => {
          const at = particles.indexOf((next.value ?? turns[turns.length - 1]).opened);
          const treated = `Particle ${formatCount(at + 1)} of ${formatCount(particles.length)}`;
          return `${[treated, ...score()].join(' · ')}.`;
        }),
        button(
          { class: 'plain', hidden: () => answers.value.length === 0, press: () => go(answers.peek().slice(0, -1)) },
          'One slot back',
        ),
        button({ class: 'plain', press: () => go([]) }, 'Begin again'),
      ),
      // The code follows the steps that it describes.
      isLast &&
        h(
          'div',
          { class: 'plane-lines', hidden: () => !isOver() },
          h('p', null, 'What you have done, as the paper writes it:'),
          algorithmList(-1),
        ),
    ),
  );
}

/**
 * The answers to choose from.
 * @param {{ now: () => Turn | null, decide: (said: Verdict) => void, leave: () => void }} how
 */
function answersOf({ now, decide, leave }) {
  const which = createSelect({ name: 'The particle that is there', choices: () => now()?.near ?? NOBODY });
  const isAlone = () => (now()?.near ?? NOBODY).length === 0;
  live(which, () => {
    which.disabled = isAlone();
  });
  const meet = () => decide({ fate: 'matched', particle: Number(which.value) });
  return h(
    'div',
    { class: 'controls', hidden: () => now() === null },
    button({ press: () => decide({ fate: 'added', particle: null }) }, 'A new one'),
    h('span', { class: 'plane-match' }, button({ disabled: isAlone, press: meet }, 'It is there already:'), which),
    button({ class: 'plain', press: leave }, 'Let the run decide'),
  );
}

/** @type {readonly Choice<number>[]} */
const NOBODY = [];

/** @param {Turn} turn */
const asking = ({ opened: { subject }, decision: { slot } }) =>
  `Particle ${letterOf(subject.particle)}, slot ${slot}: is a new one put here?`;

/** The drawing of a slot; without one that of a particle at its end. @param {Turn | null} turn @param {Opened} done */
const drawingOf = (turn, done) =>
  turn ? tangentPlane(turn.opened, turn.moment) : tangentPlane(done, momentAt(done.events, done.events.length - 1));

/**
 * What a press on the drawing says: of a particle or the slot; else words.
 * @param {Turn} turn @param {Point} at @returns {Verdict | string}
 */
function pressed({ opened, decision: { slot }, moment: { frame }, near }, at) {
  // A press on the middle particle decides nothing.
  if (Math.hypot(...at) < 1) return `That is particle ${letterOf(opened.subject.particle)} itself.`;
  if (!frame) return '';
  const plane = { centre: opened.place, right: frame.u, up: frame.w, radius: opened.subject.radius };
  // A press on a particle's disc means the particle; the slot is the rest of its circle.
  const far = near.map(({ value }) => farFrom(at, inPlane(plane, triple(opened.positions, value))));
  const least = Math.min(1, ...far);
  if (least < 1) return { fate: 'matched', particle: near[far.indexOf(least)].value };
  if (farFrom(at, slotPlace(slot)) < 1) return { fate: 'added', particle: null };
  return `Slot ${slot} comes now. Press its circle for a new particle, or the particle that is there.`;
}

/** @param {Patch} patch */
const stopOf = ({ id }) => `plane-${id}`;

/** @param {readonly ('right' | 'left')[]} answers @param {readonly string[]} mistakes */
function scoreOf(answers, mistakes) {
  const left = answers.filter((by) => by === 'left').length;
  const parts = [plural(mistakes.length, 'mistake'), `${plural(answers.length - left, 'slot')} decided`];
  return left > 0 ? [...parts, `${formatCount(left)} left to the run`] : parts;
}

/** What the run says about its decision. @param {Turn} turn */
function wordsOf({ opened: { events, subject }, decision: { end, met } }) {
  const words = tell(momentAt(events, end), subject);
  return met ? `${tell(momentAt(events, events.indexOf(met)), subject)} ${words}` : words;
}

/** @param {Point} p @param {Point} q */
const farFrom = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
