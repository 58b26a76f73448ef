/**
 * The learner is the algorithm: slot by slot they decide what the run decided, in a plane and on a cap. The run objects
 * to a decision that is not its own.
 */
import { signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { algorithmList } from '../../figures/algorithm.js';
import { tangentPlane } from '../../figures/drawings.js';
import { inPlane, slotPlace } from '../../figures/geometry.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle } from '../../figures/particle.js';
import { lineOf, tell } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { loadSheet } from '../../ui/sheet.js';
import { decisionsOf, lineAt, objection, PATCHES, runOn } from '../decisions.js';
import { byLevel, Orbit, Picture } from '../picture.js';
import sheet from '../plane.css?url';

/**
 * @import { Moment, Opened, Point } from '../../figures/types.js'
 * @import { LessonParticles } from '../../engine/types.js'
 * @import { Context, Decision, LabRun, Mark, Patch, Stops, Verdict } from '../types.js'
 */

/** @typedef {{ opened: Opened, decisions: Decision[], at: number, moment: Moment }} Shown */

/** Particles that the learner treats: the seed, its six children, and three of theirs. */
const TREATED = 10;
/** The discs of the body below are so many times smaller, so that they tell nothing of later places. */
const FINER = 8;
/** Size of a ring around a place, over that of other rings, which are wider than a disc. */
const RING = 0.7;

/** @param {Context} context */
export async function plane(context) {
  await loadSheet(sheet);
  const chosen = signal(0);
  const place = h('div', { class: 'plane-box' });
  /** @type {Map<number, Exercise>} */
  const made = new Map();
  async function choose(/** @type {number} */ k) {
    const exercise = made.get(k) ?? (await begin(context, PATCHES[k]));
    made.set(k, exercise);
    chosen.value = k;
    fill(place, exercise.element);
  }
  const buttons = PATCHES.map(({ name }, k) =>
    button({ 'aria-pressed': () => String(chosen.value === k), press: () => void choose(k) }, name),
  );
  await choose(0);
  // The question gives the seed away, and asks for its first child.
  live(place, () => {
    if (context.stops.isOpen('predict-children')) made.get(0)?.leaveSeed();
  });
  return [h('div', { class: 'controls choices', role: 'group', 'aria-label': 'Surface' }, buttons), place];
}

/** @param {Context} context @param {Patch} patch */
async function begin({ lab, stops }, patch) {
  const own = await lab;
  const { radius, surface, seed } = patch;
  const run = await runOn(own, patch);
  const { end: body } = await own.beside(surface).run({ relax_steps: 0, radius: radius / FINER, seeds: [seed] });
  const exercise = new Exercise(patch, { run, body, stops });
  await exercise.take(0);
  return exercise;
}

/** One patch, decided slot by slot. */
class Exercise {
  #patch;
  #run;
  #body;
  #stops;
  #picture;
  #colours;
  #box;
  #lines;
  #question;
  #told;
  #score;
  #which;
  #matched;
  #answers;
  #back;
  #round = newRound();

  /** What was shown at each slot that is decided. @type {Past[]} */
  #past = [];

  /** The rounds before this one. @type {Round[]} */
  #rounds = [];
  /** What takes its time follows one after the other. */
  #last = Promise.resolve();

  /** What is shown. @type {Shown | null} */
  #now;

  /** @param {Patch} patch @param {{ run: LabRun, body: LessonParticles, stops: Stops }} about */
  constructor(patch, { run, body, stops }) {
    this.#patch = patch;
    this.#run = run;
    this.#body = body;
    this.#stops = stops;
    const orbit = new Orbit();
    orbit.fitTo(run.placed);
    orbit.faceFront(run.placed);
    this.#picture = new Picture(orbit, { name: `${patch.name} with the particles that there are so far` });
    this.#colours = byLevel(run.placed);
    this.#box = h('div', { class: 'drawing-box plane-drawing', on: { click: (event) => this.#press(event) } });
    this.#lines = h('div', { class: 'plane-lines' });
    this.#question = h('p', { class: 'plane-question', 'aria-live': 'polite' });
    this.#told = h('p', { class: 'told', role: 'status' });
    this.#score = h('p', { class: 'figure-count' });
    this.#which = h('select', { class: 'select', 'aria-label': 'The particle that is there' });
    this.#matched = button({ press: () => this.#meet() }, 'It is there already:');
    this.#answers = h(
      'div',
      { class: 'controls' },
      button({ press: () => this.#decide({ fate: 'parent', particle: null }) }, 'The parent'),
      button({ press: () => this.#decide({ fate: 'added', particle: null }) }, 'A new one'),
      h('span', { class: 'plane-match' }, this.#matched, this.#which),
      button(
        { class: 'plain', 'data-step': 'predict-children', press: () => this.#queue(() => this.#leave(1)) },
        'Let the run decide',
      ),
      button(
        { class: 'plain', press: () => this.#queue(() => this.#leave(Infinity)) },
        'The rest of this particle, too',
      ),
    );
    this.#now = null;
    this.#back = button(
      { class: 'plain', 'data-back': 'predict-children', press: () => this.#queue(() => this.#takeBack()) },
      'One slot back',
    );
    const again = button({ class: 'plain', press: () => this.#queue(() => this.#beginAgain()) }, 'Begin again');
    this.element = h(
      'div',
      { class: 'plane' },
      this.#question,
      this.#box,
      this.#lines,
      h(
        'div',
        { class: 'side' },
        this.#answers,
        this.#told,
        h('div', { class: 'controls plane-score' }, this.#score, this.#back, again),
      ),
      this.#picture.element,
    );
    linkHover(this.element, { shown: () => this.#now, ring: (marks) => this.#draw(marks) });
  }

  /** Does something once what is under way is done. @param {() => Promise<unknown>} job */
  #queue(job) {
    this.#last = this.#last.then(job, job).then(() => {});
  }

  /** Has the run decide the seed, if it is the seed's turn. */
  leaveSeed() {
    this.#queue(async () => {
      if (this.#now?.opened.subject.particle === 0) await this.#leave(Infinity);
    });
  }

  /** Opens a particle, or the next that has something to decide; returns whether there is one. */
  async take(/** @type {number} */ particle) {
    for (let next = particle; next < TREATED; next += 1) {
      const opened = await openParticle(this.#run.client, this.#run, next);
      const decisions = decisionsOf(opened.events);
      if (decisions.length === 0) continue;
      this.#now = { opened, decisions, at: 0, moment: momentAt(opened.events, 0) };
      this.#ask();
      return true;
    }
    return false;
  }

  /** Takes back all decisions. What they were is kept for an assignment. */
  async #beginAgain() {
    if (isBegun(this.#round)) this.#rounds.push(this.#round);
    this.#round = newRound();
    this.#past = [];
    this.#answers.hidden = false;
    this.#tell('', '');
    await this.take(0);
  }

  /** Goes back to the slot that was decided last. Mistakes stay counted. */
  async #takeBack() {
    const past = this.#past.pop();
    if (!past) return;
    const { particle, at, round } = past;
    this.#round = { ...round, mistakes: this.#round.mistakes };
    this.#answers.hidden = false;
    this.#tell('', '');
    await this.take(particle);
    if (!this.#now) return;
    this.#now.at = at;
    this.#ask();
  }

  /** Shows the slot that is to be decided. */
  #ask() {
    const now = this.#now;
    if (!now) return;
    const { opened, decisions, at } = now;
    const { slot, at: event } = decisions[at];
    now.moment = { ...momentAt(opened.events, event), slot, isNow: true };
    fill(this.#box, tangentPlane(opened, now.moment));
    fill(this.#lines, algorithmList(lineAt(decisions[at])));
    this.#question.textContent = `Particle ${formatCount(opened.subject.particle)}, slot ${slot}: what is here?`;
    const near = now.moment.gathered?.neighbours.map(({ particle }) => particle) ?? [];
    if (at === 0)
      fill(
        this.#which,
        near.map((particle) => h('option', { value: particle }, `particle ${formatCount(particle)}`)),
      );
    this.#matched.disabled = near.length === 0;
    this.#which.disabled = near.length === 0;
    this.#draw();
    this.#count();
  }

  /** @param {readonly Mark[]} [pointed]  rings what is pointed at, else where the front has met itself out of step */
  #draw(pointed = []) {
    const marks = pointed.length > 0 ? pointed : this.#round.seam;
    const { particles } = this.#round;
    this.#picture.show({
      particles: this.#run.placed,
      body: this.#body,
      count: particles,
      colours: this.#colours,
      marks,
    });
  }

  /** Writes the score, also for an assignment. */
  #count() {
    const treated = formatCount((this.#now?.opened.subject.particle ?? 0) + 1);
    this.#back.hidden = this.#past.length === 0;
    this.#score.textContent = `${[`Particle ${treated} of ${formatCount(TREATED)}`, ...scoreOf(this.#round)].join(' · ')}.`;
    const rounds = [...this.#rounds, this.#round].filter(isBegun);
    // Nothing is answered before the first decision.
    if (rounds.length === 0) return;
    const { id, name } = this.#patch;
    const stop = `plane-${id}`;
    const question = `${name}, ten particles slot by slot: number of mistakes in the first round`;
    const [first] = rounds;
    const answer = [...scoreOf(first), ...first.mistakes];
    const best = bestOf(rounds);
    if (best && best !== first) answer.push(`best of ${plural(rounds.length, 'round')}: ${scoreOf(best).join(', ')}`);
    this.#stops.outcomes.set(stop, { stop, question, guess: first.mistakes.length, answer: answer.join('; ') });
  }

  /** Keeps what is shown before a slot is decided. @param {Shown} now */
  #keep({ opened, at }) {
    const { seam } = this.#round;
    this.#past.push({ particle: opened.subject.particle, at, round: { ...this.#round, seam: [...seam] } });
  }

  /** Goes on to the next slot, or the next particle. @param {string} words */
  async #goOn(words) {
    const now = this.#now;
    if (!now) return;
    const { opened, decisions } = now;
    const { verdict, met, slot } = decisions[now.at];
    if (verdict.fate === 'added') this.#round.particles += 1;
    if (met) {
      const [mark] = marksOf(opened, [slot]);
      this.#round.seam.push(mark);
      this.#picture.orbit.turnTo(Array.from(mark.normal));
    }
    this.#tell('right', words);
    now.at += 1;
    if (now.at < decisions.length) this.#ask();
    else if (!(await this.take(opened.subject.particle + 1))) this.#end(opened);
  }

  /** @param {Opened} opened */
  #end(opened) {
    this.#round.isWhole = true;
    this.#draw();
    this.#count();
    this.#answers.hidden = true;
    fill(this.#box, tangentPlane(opened, momentAt(opened.events, opened.events.length - 1)));
    fill(this.#lines, algorithmList(-1));
    this.#question.textContent = 'Ten particles are done.';
    const { length } = this.#round.seam;
    const seam =
      length === 0
        ? 'The front never met itself out of step.'
        : `The front met itself out of step ${plural(length, 'time')}: a seam begins there, where the picture has rings.`;
    this.#tell('', `${seam} ${this.#patch.ends}`);
  }

  /** @param {string} state @param {string} words */
  #tell(state, words) {
    this.#told.dataset.state = state;
    this.#told.textContent = words;
  }

  /** @param {Verdict} said */
  #decide(said) {
    const now = this.#now;
    if (!now || this.#answers.inert || this.#answers.hidden || now.at >= now.decisions.length) return;
    const { opened } = now;
    const decision = now.decisions[now.at];
    const why = objection(opened, decision, said);
    if (!why) {
      this.#keep(now);
      this.#round.right += 1;
      this.#queue(() => this.#goOn(wordsOf(opened, decision)));
      return;
    }
    const other = said.fate === 'matched' ? ` with ${said.particle}` : '';
    this.#round.mistakes.push(`particle ${opened.subject.particle}, slot ${decision.slot}: said ${said.fate}${other}`);
    this.#tell('wrong', `The run objects. ${why}`);
    this.#count();
  }

  #meet() {
    this.#decide({ fate: 'matched', particle: Number(this.#which.value) });
  }

  /** Lets the run decide slots of a particle. @param {number} most */
  async #leave(most) {
    const now = this.#now;
    for (let slots = 0; now && now === this.#now && now.at < now.decisions.length && slots < most; slots += 1) {
      this.#keep(now);
      this.#round.left += 1;
      await this.#goOn(wordsOf(now.opened, now.decisions[now.at]));
    }
  }

  /** Decides by what is pressed in the drawing: the particle or the slot that is nearest. @param {MouseEvent} event */
  #press({ clientX, clientY }) {
    const now = this.#now;
    const matrix = this.#box.querySelector('svg')?.getScreenCTM()?.inverse();
    const { frame = null, gathered = null } = now?.moment ?? {};
    if (!now || !matrix || !frame || now.at >= now.decisions.length) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix);
    const { opened } = now;
    const at = { centre: opened.place, right: frame.u, up: frame.w, radius: opened.subject.radius };
    const { slot } = now.decisions[now.at];
    const own = farFrom([x, -y], slotPlace(slot));
    const near = { particle: -1, far: 1 };
    for (const { particle } of gathered?.neighbours ?? []) {
      const far = farFrom([x, -y], inPlane(at, triple(opened.positions, particle)));
      if (far < near.far) Object.assign(near, { particle, far });
    }
    if (near.particle < 0 && own > 1)
      this.#tell('', `Slot ${slot} comes now. Press its circle for a new particle, or the particle that is there.`);
    else if (own < near.far) this.#decide({ fate: 'added', particle: null });
    else if (near.particle === opened.subject.parent) this.#decide({ fate: 'parent', particle: near.particle });
    else this.#decide({ fate: 'matched', particle: near.particle });
  }
}

/** @typedef {ReturnType<typeof newRound>} Round */
/** @typedef {{ particle: number, at: number, round: Round }} Past */

/** A round before its first decision. `seam`: where the front has met itself out of step. */
const newRound = () => ({
  particles: 1,
  right: 0,
  left: 0,
  isWhole: false,
  mistakes: /** @type {string[]} */ ([]),
  seam: /** @type {Mark[]} */ ([]),
});

/** @param {Round} round */
const isBegun = ({ right, left, mistakes }) => right + left + mistakes.length > 0;

/**
 * The round that went to its end with the fewest slots that were not decided rightly at once.
 * @param {readonly Round[]} rounds
 */
const bestOf = (rounds) =>
  rounds
    .filter(({ isWhole }) => isWhole)
    .sort((one, other) => one.mistakes.length + one.left - other.mistakes.length - other.left)[0];

/** @param {Round} round */
function scoreOf({ mistakes, right, left }) {
  const parts = [plural(mistakes.length, 'mistake'), `${plural(right, 'slot')} decided`];
  return left > 0 ? [...parts, `${formatCount(left)} left to the run`] : parts;
}

/**
 * Rings around the children of some slots, where they have landed.
 * @param {Opened} opened @param {readonly number[]} slots
 */
const marksOf = ({ events, subject }, slots) =>
  events.flatMap((event) =>
    event.type === 'landed' && slots.includes(event.slot)
      ? [
          /** @type {Mark} */ ({
            place: event.position,
            normal: event.normal,
            radius: RING * subject.radius,
            kind: 'ring',
          }),
        ]
      : [],
  );

/** What the run says of its decision. @param {Opened} opened @param {Decision} decision */
function wordsOf({ events, subject }, { end, met }) {
  const words = tell(momentAt(events, end), subject);
  return met ? `${tell(momentAt(events, events.indexOf(met)), subject)} ${words}` : words;
}

/** @param {Point} p @param {Point} q */
const farFrom = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);

/**
 * Lets a slot, its line and its place in the picture stand out together.
 * @param {HTMLElement} element
 * @param {{ shown: () => Shown | null, ring: (marks: readonly Mark[]) => void }} about
 */
function linkHover(element, { shown, ring }) {
  /** @param {EventTarget | null} target */
  function mark(target) {
    const part = target instanceof Element ? target.closest('[data-slot], [data-line]') : null;
    const now = shown();
    if (!now) return;
    const { opened, moment, decisions, at } = now;
    const parent = opened.subject.particle;
    const lines = moment.children.map(({ slot, fate }) => {
      if (fate !== 'open') return lineOf({ type: 'fate', parent, slot, fate, particle: null });
      return slot === moment.slot ? lineAt(decisions[Math.min(at, decisions.length - 1)]) : -1;
    });
    const [slot, line] = ['data-slot', 'data-line'].map((name) => Number(part?.getAttribute(name) ?? -1));
    const hot = moment.children
      .map((child) => child.slot)
      .filter((own) => own === slot || (line >= 0 && lines[own] === line));
    for (const one of element.querySelectorAll('[data-slot]'))
      one.classList.toggle('hot', hot.includes(Number(one.getAttribute('data-slot'))));
    for (const one of element.querySelectorAll('[data-line]'))
      one.classList.toggle(
        'hot',
        hot.some((own) => lines[own] === Number(one.getAttribute('data-line'))),
      );
    const landed = hot.filter((own) => moment.children[own].landed !== null);
    ring(marksOf(opened, landed));
  }
  element.addEventListener('pointerover', ({ target }) => mark(target));
  element.addEventListener('pointerleave', () => mark(null));
}
