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
import { fill, h } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { loadSheet } from '../../ui/sheet.js';
import { decisionsOf, objection } from '../decisions.js';
import { byLevel, Orbit, Picture } from '../picture.js';
import sheet from '../plane.css?url';

/**
 * @import { Moment, Opened, Point } from '../../figures/types.js'
 * @import { Vec3 } from '../../engine/types.js'
 * @import { Context, Decision, LabRun, Patch, Stops, Verdict } from '../types.js'
 */

/** @typedef {{ opened: Opened, decisions: Decision[], at: number, moment: Moment }} Shown */

/** Particles that the learner treats: the seed, its six children, and three of theirs. */
const TREATED = 10;

/** @type {readonly Patch[]} */
export const PATCHES = [
  {
    id: 'plane',
    name: 'A plane',
    surface: { formula: 'z = 0', parameters: [], bounds: { min: [-1, -1, -0.5], max: [1, 1, 0.5] } },
    radius: 0.13,
    seed: [0, 0, 0],
    ends: 'In a plane every child met its particle exactly, or none at all.',
  },
  {
    id: 'cap',
    name: 'A cap',
    surface: {
      formula: 'x^2 + y^2 + z^2 = 1',
      parameters: [],
      bounds: { min: [-1.1, -1.1, -0.6], max: [1.1, 1.1, 1.1] },
    },
    radius: 0.27,
    seed: [0, 0, 1],
    ends: 'On a cap a circle is shorter than in a plane, and has no room for six more on every ring.',
  },
];

/** @param {Context} context */
export async function plane(context) {
  await loadSheet(sheet);
  const chosen = signal(0);
  const place = h('div', { class: 'plane-box' });
  /** @type {Map<number, HTMLElement>} */
  const made = new Map();
  async function choose(/** @type {number} */ k) {
    const element = made.get(k) ?? (await begin(context, PATCHES[k]));
    made.set(k, element);
    chosen.value = k;
    fill(place, element);
  }
  const buttons = PATCHES.map(({ name }, k) =>
    button({ 'aria-pressed': () => String(chosen.value === k), press: () => void choose(k) }, name),
  );
  await choose(0);
  return [h('div', { class: 'controls choices', role: 'group', 'aria-label': 'Surface' }, buttons), place];
}

/** @param {Context} context @param {Patch} patch */
async function begin({ lab, stops }, patch) {
  const { surface, radius, seed } = patch;
  const run = await (await lab).beside(surface).run({ relax_steps: 0, radius, seeds: [seed] }, { keep: true });
  const exercise = new Exercise(patch, run, stops);
  await exercise.take(0);
  return exercise.element;
}

/** One patch, decided slot by slot. */
class Exercise {
  #patch;
  #run;
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
  #counts;

  /** @type {string[]} */
  #mistakes = [];
  /** Where the front has met itself out of step. @type {Vec3[]} */
  #seam = [];

  /** What is shown. @type {Shown | null} */
  #now;

  /** @param {Patch} patch @param {LabRun} run @param {Stops} stops */
  constructor(patch, run, stops) {
    this.#patch = patch;
    this.#run = run;
    this.#stops = stops;
    const orbit = new Orbit(patch.surface.bounds);
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
    const leave = button({ class: 'plain', press: () => void this.#leave() }, 'Leave this particle to the run');
    this.#answers = h(
      'div',
      { class: 'controls' },
      button({ press: () => this.#decide({ fate: 'parent', particle: null }) }, 'The parent'),
      button({ press: () => this.#decide({ fate: 'added', particle: null }) }, 'A new one'),
      h('span', { class: 'plane-match' }, this.#matched, this.#which),
      leave,
    );
    this.#counts = noDecisions();
    this.#now = null;
    const again = button({ class: 'plain', press: () => void this.#beginAgain() }, 'Begin again');
    const side = h(
      'div',
      { class: 'side' },
      this.#question,
      this.#answers,
      this.#told,
      this.#score,
      h('div', { class: 'controls' }, again),
    );
    this.element = h(
      'div',
      { class: 'plane' },
      h('div', { class: 'two' }, this.#box, side),
      h('div', { class: 'two' }, this.#picture.element, this.#lines),
    );
    linkHover(this.element, () => this.#now, {
      picture: this.#picture,
      rest: () => this.#ringSeam(),
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

  /** Takes back all decisions. */
  async #beginAgain() {
    this.#counts = noDecisions();
    this.#mistakes = [];
    this.#seam = [];
    this.#answers.hidden = false;
    this.#tell('', '');
    await this.take(0);
  }

  /** Rings the places where the front has met itself out of step. */
  #ringSeam() {
    const { radius } = this.#run;
    const normal = triple(this.#run.placed.normals, 0);
    this.#picture.ringed.value = this.#seam.length > 0 ? { places: this.#seam, radius, normal } : null;
  }

  /** Shows the slot that is to be decided. */
  #ask() {
    const now = this.#now;
    if (!now) return;
    const { opened, decisions, at } = now;
    const { slot, at: event } = decisions[at];
    now.moment = { ...momentAt(opened.events, event), slot, isNow: true };
    fill(this.#box, tangentPlane(opened, now.moment));
    fill(this.#lines, algorithmList(lineOf(now.moment.event)));
    this.#question.textContent = `Particle ${formatCount(opened.subject.particle)}, slot ${slot}: what is at this place?`;
    const near = now.moment.gathered?.neighbours.map(({ particle }) => particle) ?? [];
    if (at === 0)
      fill(
        this.#which,
        near.map((particle) => h('option', { value: particle }, `particle ${formatCount(particle)}`)),
      );
    this.#matched.disabled = near.length === 0;
    this.#which.disabled = near.length === 0;
    this.#draw();
  }

  #draw() {
    const { particles } = this.#counts;
    this.#ringSeam();
    this.#picture.show({ particles: this.#run.placed, count: particles, colours: this.#colours });
    this.#count();
  }

  /** Writes the score, also for an assignment. */
  #count() {
    const { right, left } = this.#counts;
    const parts = [plural(this.#mistakes.length, 'mistake'), `${plural(right, 'slot')} decided`];
    if (left > 0) parts.push(`${formatCount(left)} left to the run`);
    const treated = formatCount((this.#now?.opened.subject.particle ?? 0) + 1);
    this.#score.textContent = `${[`Particle ${treated} of ${formatCount(TREATED)}`, ...parts].join(' · ')}.`;
    const { id, name } = this.#patch;
    const stop = `plane-${id}`;
    const question = `${name}, ten particles slot by slot: number of mistakes`;
    const answer = [parts.join(', '), ...this.#mistakes].join('; ');
    // Nothing is answered before the first decision.
    if (right + left + this.#mistakes.length === 0) return;
    this.#stops.outcomes.set(stop, { stop, question, guess: this.#mistakes.length, answer });
  }

  /** Goes on to the next slot, or the next particle. @param {string} words */
  async #goOn(words) {
    const now = this.#now;
    if (!now) return;
    const { verdict, met, compared } = now.decisions[now.at];
    if (verdict.fate === 'added') this.#counts.particles += 1;
    if (met) this.#counts.met += 1;
    if (met && compared) this.#seam.push(compared.position);
    this.#tell('right', words);
    now.at += 1;
    if (now.at < now.decisions.length) return this.#ask();
    if (!(await this.take(now.opened.subject.particle + 1))) this.#end(now.opened);
  }

  /** @param {Opened} opened */
  #end(opened) {
    this.#draw();
    this.#answers.hidden = true;
    fill(this.#box, tangentPlane(opened, momentAt(opened.events, opened.events.length - 1)));
    fill(this.#lines, algorithmList(-1));
    this.#question.textContent = 'Ten particles are done.';
    const { met } = this.#counts;
    const seam =
      met === 0
        ? 'The front never met itself out of step.'
        : `The front met itself out of step ${plural(met, 'time')}: a seam begins there, where the picture has rings.`;
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
      this.#counts.right += 1;
      void this.#goOn(wordsOf(opened, decision));
      return;
    }
    const other = said.fate === 'matched' ? ` with ${said.particle}` : '';
    this.#mistakes.push(`particle ${opened.subject.particle}, slot ${decision.slot}: said ${said.fate}${other}`);
    this.#tell('wrong', `The run objects. ${why}`);
    this.#count();
  }

  #meet() {
    this.#decide({ fate: 'matched', particle: Number(this.#which.value) });
  }

  /** Lets the run decide the rest of a particle. */
  async #leave() {
    const now = this.#now;
    while (now && now === this.#now && now.at < now.decisions.length) {
      this.#counts.left += 1;
      await this.#goOn('The run has decided the rest of that particle.');
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

/** The counts before the first decision. */
const noDecisions = () => ({ particles: 1, right: 0, left: 0, met: 0 });

/** What the run says of its decision. @param {Opened} opened @param {Decision} decision */
function wordsOf({ events, subject }, { end, met }) {
  const words = tell(momentAt(events, end), subject);
  return met ? `${tell(momentAt(events, events.indexOf(met)), subject)} ${words}` : words;
}

/** @param {Point} p @param {Point} q */
const farFrom = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);

/**
 * Lets a slot, its line and its place in the picture stand out together.
 * @param {HTMLElement} element @param {() => Shown | null} shown
 * @param {{ picture: Picture, rest: () => void }} about  `rest` shows what is ringed where nothing is pointed at
 */
function linkHover(element, shown, { picture, rest }) {
  /** @param {EventTarget | null} target */
  function mark(target) {
    const part = target instanceof Element ? target.closest('[data-slot], [data-line]') : null;
    const now = shown();
    if (!now) return;
    const { opened, moment } = now;
    const parent = opened.subject.particle;
    const lineAt = moment.children.map(({ slot, fate }) => {
      if (fate !== 'open') return lineOf({ type: 'fate', parent, slot, fate, particle: null });
      return slot === moment.slot ? lineOf(moment.event) : -1;
    });
    const [slot, line] = ['data-slot', 'data-line'].map((name) => Number(part?.getAttribute(name) ?? -1));
    const hot = moment.children.filter((child) => child.slot === slot || (line >= 0 && lineAt[child.slot] === line));
    for (const one of element.querySelectorAll('[data-slot]'))
      one.classList.toggle(
        'hot',
        hot.some((child) => child.slot === Number(one.getAttribute('data-slot'))),
      );
    for (const one of element.querySelectorAll('[data-line]'))
      one.classList.toggle(
        'hot',
        hot.some((child) => lineAt[child.slot] === Number(one.getAttribute('data-line'))),
      );
    const places = hot.flatMap(({ landed }) => (landed ? [landed.position] : []));
    if (places.length > 0) picture.ringed.value = { places, radius: opened.subject.radius, normal: opened.normal };
    else rest();
  }
  element.addEventListener('pointerover', ({ target }) => mark(target));
  element.addEventListener('pointerleave', () => mark(null));
}
