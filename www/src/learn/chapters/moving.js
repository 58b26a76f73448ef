/** The chapter on a surface that moves: a front that flows, beside a rival, under one camera. */
import { signal } from '@preact/signals-core';
import { button } from '../../ui/button.js';
import { fill, h, live, reducedMotion } from '../../ui/dom.js';
import { formatFixed, plural } from '../../ui/format.js';
import { icon } from '../../ui/icons.js';
import { reasonOf } from '../figure.js';
import { FrontLane, lossOf, MOTIONS, STEPS, SystemLane, scoreAt, surfaceAt, valueAt } from '../flowing.js';
import { createChart, createRange, createSelect } from '../parts.js';
import { byLevel, Orbit, Picture } from '../picture.js';
import { createScorecard } from '../scorecard.js';

/**
 * @import { Signal } from '../../engine/types.js'
 * @import { Context, FlowLane, Lab, Motion, Score } from '../types.js'
 */

/** Steps from one measurement to the next. */
const MEASURED = 4;
/** Shortest time of a step, so that the eye can follow. */
const STEP_MS = 33;

/**
 * What stands beside the front that flows.
 * @type {readonly { value: string, label: string, make: (motion: Motion) => FlowLane }[]}
 */
const RIVALS = [
  { value: 'system', label: 'Witkin and Heckbert', make: (motion) => new SystemLane(motion) },
  {
    value: 'closed',
    label: 'Without births and deaths',
    make: (motion) => new FrontLane(motion, { isClosed: true }),
  },
  { value: 'fresh', label: 'A new front each time', make: (motion) => new FrontLane(motion, { isFresh: true }) },
];

/** Two lanes on one moving surface, with their pictures and their figures. */
class Pursuit {
  #lab;
  motion = MOTIONS[0];
  rival = RIVALS[0];
  place = h('div', { class: 'pair' });
  /** The shares with six neighbours in both lanes, from the beginning on. @type {Signal<[number, number][]>} */
  shares = signal([]);
  isSweeping = signal(false);
  /** The step of the slider at which the lanes are. */
  at = signal(0);
  /** The step to which they go. */
  #target = 0;
  /** @type {[number, number][]} */
  #past = [];
  status = signal('');
  scorecard = createScorecard((spot, side) => {
    for (const [k, picture] of this.#pictures.entries()) picture.ringed.value = k === side ? spot : null;
    if (spot) this.#orbit.turnTo(spot.normal);
  });
  #orbit = new Orbit(surfaceAt(this.motion, 0).bounds);
  /** @type {Picture[]} */
  #pictures = [];
  /** @type {HTMLElement[]} */
  #captions = [];
  /** @type {FlowLane[]} */
  #lanes = [];
  /** Counts the beginnings: what an earlier one still does is dropped. */
  #begun = 0;
  /** What the lane on the left does. */
  #name = '';
  #last = Promise.resolve();
  #measured = Promise.resolve();

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
  }

  /** Lays both pictures anew, with a front and its rival on the surface of the first step. */
  lay() {
    this.#begun += 1;
    for (const lane of this.#lanes) lane.close();
    const { motion, rival } = this;
    const [x, y, z] = motion.half.map((half) => motion.seen * half);
    this.#orbit = new Orbit({ min: [-x, -y, -z], max: [x, y, z] });
    this.#lanes = [new FrontLane(motion), rival.make(motion)];
    this.#pictures = ['A front that flows', rival.label].map((name) => new Picture(this.#orbit, { name }));
    this.#captions = this.#pictures.map(() => h('figcaption'));
    fill(
      this.place,
      this.#pictures.map((picture, k) => h('figure', null, picture.element, this.#captions[k])),
    );
    fill(this.scorecard.element);
    this.isSweeping.value = false;
    [this.at.value, this.#target, this.#past] = [0, 0, []];
    this.#name = 'A front';
    return this.#act('Covering the surface', (lane) => lane.begin(0));
  }

  /** Moves the surface to a step of the slider. @param {number} step */
  go(step) {
    this.#target = step;
    return this.#act('', null);
  }

  /** Moves the surface to the other end of the slider and back; a second call holds it where it is. */
  async sweep() {
    this.isSweeping.value = !this.isSweeping.peek();
    if (!this.isSweeping.peek()) return this.go(this.at.peek());
    for (const end of this.at.peek() === STEPS ? [0] : [STEPS, 0]) if (this.isSweeping.peek()) await this.go(end);
    this.isSweeping.value = false;
  }

  /** Has both come to rest, each in its own way. */
  rest() {
    this.isSweeping.value = false;
    this.#target = this.at.peek();
    this.#name = 'A new front';
    return this.#act('Both come to rest', (lane) => lane.rest(this.at.peek()));
  }

  /**
   * Has both lanes do something once what is under way is done, or follow the slider; shows and measures them.
   * @param {string} words @param {((lane: FlowLane) => Promise<void>) | null} job
   */
  #act(words, job) {
    const mine = this.#begun;
    const isOver = () => mine !== this.#begun;
    this.#last = this.#last.then(async () => {
      if (isOver() || (!job && this.at.peek() === this.#target)) return;
      this.status.value = words;
      try {
        if (job) await Promise.all(this.#lanes.map(job));
        else await this.#follow(isOver);
        if (isOver()) return;
        this.#show();
        await this.#measure(true);
        if (!isOver()) this.status.value = '';
      } catch (error) {
        if (isOver()) return;
        this.isSweeping.value = false;
        this.status.value = reasonOf(error);
      }
    });
    return this.#last;
  }

  /** Follows the slider step by step to where it is. @param {() => boolean} isOver */
  async #follow(isOver) {
    this.#name = 'It flows';
    while (this.at.peek() !== this.#target && !isOver()) {
      const sinceMs = performance.now();
      const at = this.at.peek();
      const next = at + Math.sign(this.#target - at);
      await Promise.all(this.#lanes.map((lane) => lane.follow(next)));
      if (!isOver()) this.at.value = next;
      if (isOver() || reducedMotion()) continue;
      this.#show();
      if (next % MEASURED === 0) {
        // The surface does not run away from the meter.
        await this.#measured;
        this.#measure(false).catch(() => {});
      }
      await new Promise((done) => setTimeout(done, STEP_MS - (performance.now() - sinceMs)));
    }
  }

  #show() {
    for (const [k, { particles }] of this.#lanes.entries()) {
      this.#pictures[k].ringed.value = null;
      this.#pictures[k].show({ particles, colours: byLevel(particles) });
      const name = k === 0 ? this.#name : this.rival.label;
      this.#captions[k].textContent = `${name}: ${plural(particles.radii.length, 'particle')}`;
    }
  }

  /** Measures both lanes as they are now, one after the other. @param {boolean} isLast  the figures are shown, too */
  #measure(isLast) {
    const [mine, step, { motion }] = [this.#begun, this.at.peek(), this];
    const now = this.#lanes.map(({ particles, evaluations }) => ({ particles, evaluations }));
    // A measurement that has failed is no reason for the next one to fail.
    this.#measured = this.#measured
      .catch(() => {})
      .then(async () => {
        /** @type {Score[]} */
        const scores = [];
        for (const lane of now) if (mine === this.#begun) scores.push(await scoreAt(this.#lab, motion, step, lane));
        if (mine !== this.#begun) return;
        this.#past = [...this.#past, [scores[0].six ?? 0, scores[1].six ?? 0]];
        this.shares.value = this.#past;
        if (isLast) this.scorecard.tell([this.#name, 'Beside it'], scores);
      });
    return this.#measured;
  }
}

/** The chart of both lanes. @param {Pursuit} pursuit @param {() => boolean} isOpen */
function chartOf({ shares }, isOpen) {
  const percent = (/** @type {number} */ share) => `${formatFixed(100 * share, 0)} %`;
  const told = () => {
    const [first, last] = [shares.value[0], shares.value[shares.value.length - 1]];
    if (!first) return '';
    return `Six neighbours: of those that flow ${percent(last[0])}, beside them ${percent(last[1])}. At the beginning it was ${percent(first[0])} and ${percent(first[1])}.`;
  };
  return createChart({
    hidden: () => !isOpen(),
    chart: () => ({
      kind: 'line',
      rows: [
        { fate: 'own', name: 'it flows', counts: shares.value.map(([six]) => six) },
        { fate: 'other', name: 'beside it', counts: shares.value.map(([, six]) => six) },
      ],
      first: 0,
      at: null,
      format: percent,
      ends: ['at first', 'now'],
      guide: [1],
    }),
    label: told,
    words: told,
  });
}

/** @param {Context} context */
export async function moving({ lab, stops }) {
  const pursuit = new Pursuit(await lab);
  const isOpen = () => stops.isOpen('predict-moving');
  const range = createRange({
    name: 'Parameter',
    max: STEPS,
    say: (step) => `${pursuit.motion.name} = ${formatFixed(valueAt(pursuit.motion, step), 2)}`,
    change: (step) => {
      pursuit.isSweeping.value = false;
      void pursuit.go(step);
    },
  });
  live(range.element, () => {
    if (pursuit.isSweeping.value) range.place.value = pursuit.at.value;
  });
  const lay = () => {
    range.place.value = 0;
    return pursuit.lay();
  };
  const choices = [
    createSelect({
      name: 'Surface',
      choices: MOTIONS,
      change: (value) => {
        pursuit.motion = MOTIONS.find((one) => one.value === value) ?? MOTIONS[0];
        void lay();
      },
    }),
    createSelect({
      name: 'Beside it',
      choices: RIVALS,
      change: (value) => {
        pursuit.rival = RIVALS.find((one) => one.value === value) ?? RIVALS[0];
        void lay();
      },
    }),
  ];
  const rest = () => {
    range.place.value = pursuit.at.peek();
    void pursuit.rest();
  };
  await lay();
  return [
    pursuit.place,
    h(
      'div',
      { class: 'controls' },
      button({ press: () => void pursuit.sweep() }, () =>
        pursuit.isSweeping.value ? [icon('pause'), 'Hold'] : [icon('play'), 'There and back'],
      ),
      button({ press: rest }, 'Come to rest'),
      range.element,
    ),
    h(
      'div',
      { class: 'controls' },
      choices.map(({ element }) => element),
    ),
    h('p', { class: 'figure-status', role: 'status' }, () => pursuit.status.value),
    chartOf(pursuit, isOpen),
    h('div', { hidden: () => !isOpen() }, pursuit.scorecard.element),
  ];
}

// One part is loaded for the figure and for its question.
export { lossOf };
