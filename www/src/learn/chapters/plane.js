/**
 * The learner plays the algorithm: slot by slot they make the run's decisions, for two particles of a plane and for the
 * place on a cap where the front meets itself. The run objects to a different decision.
 */
import { signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { algorithmList } from '../../figures/algorithm.js';
import { tangentPlane } from '../../figures/drawings.js';
import { inPlane, slotPlace } from '../../figures/geometry.js';
import { momentAt } from '../../figures/moment.js';
import { fateShape } from '../../figures/svg.js';
import { tell } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { createSelect } from '../../ui/select.js';
import { loadSheet } from '../../ui/sheet.js';
import { decisionsOf, letterOf, objection, openNamed, PATCHES, runOn, treatedOf } from '../decisions.js';
import sheet from '../plane.css?url';

/**
 * @import { Signal } from '../../engine/types.js'
 * @import { Choice } from '../../ui/types.js'
 * @import { Moment, Opened, Point } from '../../figures/types.js'
 * @import { Context, Decision, LabRun, Patch, Stops, Verdict } from '../types.js'
 */

/** @typedef {{ opened: Opened, decisions: Decision[], at: number, moment: Moment }} Shown */

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
  /** @type {Map<number, Exercise>} */
  const made = new Map();
  async function choose(/** @type {number} */ k) {
    const exercise = made.get(k) ?? (await begin(context, PATCHES[k], () => void choose(k + 1)));
    made.set(k, exercise);
    chosen.value = k;
    // `fill` would dispose of the old exercise, which may be shown again.
    place.replaceChildren(exercise.element);
  }
  const buttons = PATCHES.map(({ name }, k) =>
    button({ 'aria-pressed': () => String(chosen.value === k), press: () => void choose(k) }, name),
  );
  await choose(0);
  // The question reveals the seed's fates, and asks for its first child.
  live(place, () => {
    if (context.stops.isOpen('predict-children')) made.get(0)?.leaveSeed();
  });
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
  const treated = await treatedOf(run, patch);
  const exercise = new Exercise(patch, { run, treated, stops, goOn });
  await exercise.take();
  return exercise;
}

/** One patch, decided slot by slot. */
class Exercise {
  #patch;
  #run;
  #treated;
  #stops;
  #box = h('div', { class: 'drawing-box plane-drawing', on: { click: (event) => this.#press(event) } });
  /** The algorithm, shown after it was played. */
  #lines = h('div', { class: 'plane-lines', hidden: true });
  #question = h('p', { class: 'plane-question', 'aria-live': 'polite' });
  #told = h('p', { class: 'told', role: 'status' });
  #score = h('p', { class: 'figure-count' });
  /** Neighbours that may be the matching particle. @type {Signal<readonly Choice<number>[]>} */
  #near = signal([]);
  #which = createSelect({ name: 'The particle that is there', choices: () => this.#near.value });
  #matched = button({ press: () => this.#meet() }, 'It is there already:');
  #answers;
  #next;
  #back;
  /** @type {Round} */
  #round;
  /** Jobs that take time run one after the other. */
  #last = Promise.resolve();
  /** The current slot. @type {Shown | null} */
  #now = null;

  /** @param {Patch} patch @param {{ run: LabRun, treated: number[], stops: Stops, goOn: () => void }} about */
  constructor(patch, { run, treated, stops, goOn }) {
    this.#patch = patch;
    this.#run = run;
    this.#treated = treated;
    this.#stops = stops;
    this.#round = stops.more(stopOf(patch)) ?? newRound();
    this.#answers = h(
      'div',
      { class: 'controls' },
      button({ press: () => this.#decide({ fate: 'added', particle: null }) }, 'A new one'),
      h('span', { class: 'plane-match' }, this.#matched, this.#which),
      button({ class: 'plain', press: () => this.#queue(() => this.#leave(1)) }, 'Let the run decide'),
    );
    this.#next = button({ class: 'primary', hidden: true, press: goOn }, 'Go to the cap');
    this.#back = button({ class: 'plain', press: () => this.#queue(() => this.#takeBack()) }, 'One slot back');
    const again = button({ class: 'plain', press: () => this.#queue(() => this.#beginAgain()) }, 'Begin again');
    this.element = h(
      'div',
      { class: 'plane' },
      this.#question,
      this.#box,
      h(
        'div',
        { class: 'side' },
        this.#answers,
        this.#told,
        this.#next,
        h('div', { class: 'controls plane-score' }, this.#score, this.#back, again),
        this.#lines,
      ),
    );
  }

  /** Runs a job after the current one. @param {() => Promise<unknown>} job */
  #queue(job) {
    this.#last = this.#last.then(job, job).then(() => {});
  }

  /** Lets the run decide for the seed, if it is the seed's turn. */
  leaveSeed() {
    this.#queue(async () => {
      if (this.#now?.opened.subject.particle !== 0) return;
      await this.#leave(Infinity);
      this.#tell('', '');
    });
  }

  /** Shows the current slot of the round, or its end. */
  async take() {
    const { turn, at } = this.#round;
    const isOver = turn >= this.#treated.length;
    const opened = await openNamed(this.#run, this.#treated[isOver ? turn - 1 : turn]);
    const decisions = decisionsOf(opened.events);
    this.#now = { opened, decisions, at, moment: momentAt(opened.events, 0) };
    if (isOver) this.#end(this.#now);
    else this.#ask(this.#now);
    this.#count();
  }

  /** Undoes all decisions; mistakes still count. */
  async #beginAgain() {
    this.#round = { ...newRound(), mistakes: this.#round.mistakes };
    this.#tell('', '');
    await this.take();
  }

  /** Goes back to the last decided slot; mistakes still count. */
  async #takeBack() {
    const past = this.#round.past.pop();
    if (!past) return;
    Object.assign(this.#round, past);
    this.#tell('', '');
    await this.take();
  }

  /** Shows the slot to decide. @param {Shown} now */
  #ask(now) {
    const { opened, decisions, at } = now;
    const { slot, at: event } = decisions[at];
    now.moment = { ...momentAt(opened.events, event), slot, isNow: true };
    fill(this.#box, tangentPlane(opened, now.moment));
    this.#question.textContent = `Particle ${letterOf(opened.subject.particle)}, slot ${slot}: is a new one put here?`;
    const near = now.moment.gathered?.neighbours.map(({ particle }) => particle) ?? [];
    if (at === 0 || this.#which.options.length === 0)
      this.#near.value = near.map((particle) => ({ value: particle, label: `particle ${letterOf(particle)}` }));
    this.#matched.disabled = near.length === 0;
    this.#which.disabled = near.length === 0;
    this.#answers.hidden = false;
    this.#lines.hidden = true;
    this.#next.hidden = true;
  }

  /** Writes the score, for an assignment too, and stores the round. */
  #count() {
    const { turn, past, mistakes, right, left } = this.#round;
    const treated = formatCount(Math.min(turn + 1, this.#treated.length));
    this.#back.hidden = past.length === 0;
    const score = scoreOf(this.#round);
    this.#score.textContent = `${[`Particle ${treated} of ${formatCount(this.#treated.length)}`, ...score].join(' · ')}.`;
    const stop = stopOf(this.#patch);
    // Without a decision there is no answer.
    if (right + left + mistakes.length === 0) return;
    this.#stops.keepMore(stop, this.#round);
    const question = `${this.#patch.name}, slot by slot: number of mistakes`;
    this.#stops.record({ stop, question, guess: mistakes.length, answer: [...score, ...mistakes].join('; ') });
  }

  /** Continues with the next slot or particle. @param {string} words */
  async #goOn(words) {
    const now = this.#now;
    if (!now) return;
    this.#tell('right', words);
    this.#round.at += 1;
    if (this.#round.at === now.decisions.length) Object.assign(this.#round, { turn: this.#round.turn + 1, at: 0 });
    await this.take();
  }

  /** @param {Shown} now */
  #end({ opened }) {
    this.#answers.hidden = true;
    this.#next.hidden = this.#patch === PATCHES.at(-1);
    fill(this.#box, tangentPlane(opened, momentAt(opened.events, opened.events.length - 1)));
    // The code follows the steps that it describes.
    this.#lines.hidden = this.#patch !== PATCHES.at(-1);
    fill(this.#lines, h('p', null, 'What you have done, as the paper writes it:'), algorithmList(-1));
    this.#question.textContent = this.#patch.ends;
  }

  /** @param {string} state @param {string} words */
  #tell(state, words) {
    this.#told.dataset.state = state;
    this.#told.textContent = words;
  }

  /** The position in the round. */
  #place() {
    const { turn, at, right, left } = this.#round;
    return { turn, at, right, left };
  }

  /** @param {Verdict} said */
  #decide(said) {
    const now = this.#now;
    if (!now || this.#answers.inert || this.#answers.hidden) return;
    const { opened } = now;
    const decision = now.decisions[now.at];
    const why = objection(opened, decision, said);
    if (!why) {
      this.#queue(async () => {
        this.#round.past.push(this.#place());
        this.#round.right += 1;
        await this.#goOn(wordsOf(opened, decision));
      });
      return;
    }
    const other = said.fate === 'matched' ? ` with ${letterOf(said.particle ?? 0)}` : '';
    this.#round.mistakes.push(
      `particle ${letterOf(opened.subject.particle)}, slot ${decision.slot}: said ${said.fate}${other}`,
    );
    this.#tell('wrong', `The run objects. ${why}`);
    this.#count();
  }

  #meet() {
    this.#decide({ fate: 'matched', particle: Number(this.#which.value) });
  }

  /** Lets the run decide some slots of a particle. @param {number} most */
  async #leave(most) {
    const { turn } = this.#round;
    for (let slots = 0; slots < most && this.#now && this.#round.turn === turn && !this.#answers.hidden; slots += 1) {
      const { opened, decisions, at } = this.#now;
      this.#round.past.push(this.#place());
      this.#round.left += 1;
      await this.#goOn(wordsOf(opened, decisions[at]));
    }
  }

  /** Decides by a press on the drawing: on a particle or the slot. @param {MouseEvent} event */
  #press({ clientX, clientY }) {
    const now = this.#now;
    const matrix = this.#box.querySelector('svg')?.getScreenCTM()?.inverse();
    const { frame = null, gathered = null } = now?.moment ?? {};
    if (!now || !matrix || !frame || this.#answers.hidden) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix);
    const { opened } = now;
    const at = { centre: opened.place, right: frame.u, up: frame.w, radius: opened.subject.radius };
    const { slot } = now.decisions[now.at];
    // A press on the middle particle decides nothing.
    if (Math.hypot(x, y) < 1) return this.#tell('', `That is particle ${letterOf(opened.subject.particle)} itself.`);
    // A press on a particle's disc means the particle; the slot is the rest of its circle.
    const near = { particle: -1, far: 1 };
    for (const { particle } of gathered?.neighbours ?? []) {
      const far = farFrom([x, -y], inPlane(at, triple(opened.positions, particle)));
      if (far < near.far) Object.assign(near, { particle, far });
    }
    if (near.particle >= 0) this.#decide({ fate: 'matched', particle: near.particle });
    else if (farFrom([x, -y], slotPlace(slot)) < 1) this.#decide({ fate: 'added', particle: null });
    else this.#tell('', `Slot ${slot} comes now. Press its circle for a new particle, or the particle that is there.`);
  }
}

/** @param {Patch} patch */
const stopOf = ({ id }) => `plane-${id}`;

/**
 * A round: `turn` and `at` are the next particle and slot, and `past` has the positions of all decisions.
 * @typedef {object} Round
 * @property {number} turn
 * @property {number} at
 * @property {number} right
 * @property {number} left
 * @property {string[]} mistakes
 * @property {{ turn: number, at: number, right: number, left: number }[]} past
 */

/** @returns {Round} */
const newRound = () => ({ turn: 0, at: 0, right: 0, left: 0, mistakes: [], past: [] });

/** @param {Round} round */
function scoreOf({ mistakes, right, left }) {
  const parts = [plural(mistakes.length, 'mistake'), `${plural(right, 'slot')} decided`];
  return left > 0 ? [...parts, `${formatCount(left)} left to the run`] : parts;
}

/** What the run says about its decision. @param {Opened} opened @param {Decision} decision */
function wordsOf({ events, subject }, { end, met }) {
  const words = tell(momentAt(events, end), subject);
  return met ? `${tell(momentAt(events, events.indexOf(met)), subject)} ${words}` : words;
}

/** @param {Point} p @param {Point} q */
const farFrom = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
