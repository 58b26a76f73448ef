/** The chapter on a surface that moves: a front that flows, beside a rival, under one camera. */
import { signal } from '@preact/signals-core';
import { fill, h, live, reducedMotion } from '../../ui/dom.js';
import { formatFixed, plural } from '../../ui/format.js';
import { reasonOf } from '../figure.js';
import { FrontLane, MOTIONS, ownMotions, STEPS, SystemLane, scoreAt, valueAt } from '../flowing.js';
import { createChart, createSelectRow } from '../parts.js';
import { byLevel, Orbit, sideBySide } from '../picture.js';
import { createReplay } from '../replay.js';
import { rowOf } from '../score.js';

/**
 * @import { Signal } from '../../engine/types.js'
 * @import { AtStep, Context, FlowLane, Lab, Motion, Snapshot } from '../types.js'
 */

/** Steps from one measurement to the next. */
const MEASURED = 4;
/** Shortest time of a step, so that the eye can follow. */
const STEP_MS = 33;
/** Times the radius at which a few particles show how large a surface is. */
const COARSER = 2;
/** After the last step both come to rest. */
const AT_REST = STEPS + 1;

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

/**
 * Two lanes on one moving surface. They go forward as far as the slider has been, and a snapshot is kept of every step:
 * back, and forward again, it shows those.
 */
class Pursuit {
  #lab;
  motion = MOTIONS[0];
  rival = RIVALS[0];
  place = h('div', { class: 'pair' });
  controls = h('div');
  card = h('div');
  /** The shares with six neighbours in both lanes, at every measured step. @type {Signal<[number, number][]>} */
  shares = signal([]);
  /** The step that the slider shows. */
  at = signal(0);
  status = signal('');
  /** @type {FlowLane[]} */
  #lanes = [];
  /** Counts the beginnings: what an earlier one still does is dropped. */
  #begun = 0;
  /** Brings the slider to a step. @type {(step: number) => void} */
  go = () => {};

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
  }

  /** Begins anew, with a front and its rival on the surface of the first step. */
  async lay() {
    this.#begun += 1;
    const mine = this.#begun;
    const isOver = () => mine !== this.#begun;
    for (const lane of this.#lanes) lane.close();
    const { motion, rival } = this;
    const lanes = [new FrontLane(motion), rival.make(motion)];
    this.#lanes = lanes;
    const { orbit, show, point } = this.#pictures();
    const ends = await endsOf(motion);
    if (isOver()) return;
    orbit.fitTo(...ends);
    /** @type {[Snapshot<AtStep>[], Snapshot<AtStep>[]]} */
    const films = [[], []];
    this.shares.value = [];
    this.status.value = 'Covering the surface';
    /** The step as far as which the lanes go. */
    let target = 0;
    let isBusy = false;
    /** Goes forward to the target, step by step. */
    const record = async () => {
      if (isBusy) return;
      isBusy = true;
      try {
        while (films[0].length <= target && !isOver()) {
          const sinceMs = performance.now();
          const step = films[0].length;
          if (step === AT_REST) this.status.value = 'Both come to rest';
          await Promise.all(lanes.map((lane) => doStep(lane, step)));
          if (isOver()) return;
          if (step === 0) orbit.faceFront(lanes[0].particles);
          for (const [k, { particles, evaluations }] of lanes.entries())
            films[k].push({ lane: { step, evaluations }, particles });
          if (step % MEASURED === 0 || step === AT_REST) await this.#measure(films, isOver);
          const isLast = step >= target;
          if (!isLast && reducedMotion()) continue;
          if (isLast) {
            this.status.value = '';
            await replay.seek();
          } else if (replay.range.get() >= step) {
            for (const k of [0, 1]) show(k, films[k][step]);
            replay.scorecard.wait();
          }
          if (!isLast) await new Promise((done) => setTimeout(done, STEP_MS - (performance.now() - sinceMs)));
        }
      } catch (error) {
        if (!isOver()) this.status.value = reasonOf(error);
      } finally {
        isBusy = false;
      }
    };
    const replay = createReplay({
      films,
      names: ['The front', 'Beside it'],
      axes: [
        {
          ...{ value: 'step', label: 'step', of: ({ step }) => step },
          ...{ say: (step) => this.say(step), moment: (step) => this.say(step) },
        },
      ],
      axisName: '',
      name: 'Parameter',
      places: AT_REST,
      at: 0,
      most: () => AT_REST,
      score: ({ lane: { step, evaluations }, particles }) =>
        scoreAt(this.#lab, motion, Math.min(step, STEPS), { particles, evaluations }),
      show,
      point,
    });
    live(replay.controls, () => {
      const step = replay.range.place.value;
      this.at.value = step;
      if (step <= target) return;
      target = step;
      void record();
    });
    this.go = replay.range.set;
    await record();
    if (isOver() || films[0].length === 0) return;
    fill(this.controls, replay.controls);
    fill(this.card, replay.scorecard.element);
  }

  /** @param {number} step */
  say(step) {
    const { motion } = this;
    return `${motion.name} = ${formatFixed(valueAt(motion, step), 2)}${step > STEPS ? ', at rest' : ''}`;
  }

  /** Lays both pictures anew. */
  #pictures() {
    const { rival } = this;
    const orbit = new Orbit();
    const { pictures, captions, figures, point } = sideBySide(orbit, ['A front that flows', rival.label]);
    fill(this.place, figures);
    return {
      orbit,
      point,
      /** @param {number} k @param {Snapshot<AtStep>} shot */
      show(k, { lane: { step }, particles }) {
        pictures[k].ringed.value = null;
        pictures[k].show({ particles, colours: byLevel(particles) });
        const own = step === 0 ? 'A front' : step > STEPS ? 'A new front' : 'It flows';
        captions[k].textContent = `${k === 0 ? own : rival.label}: ${plural(particles.radii.length, 'particle')}`;
      },
    };
  }

  /** Measures both lanes as they are now. @param {readonly Snapshot<AtStep>[][]} films @param {() => boolean} isOver */
  async #measure(films, isOver) {
    const now = films.map((shots) => shots[shots.length - 1]);
    const sixes = [];
    for (const { lane, particles } of now) {
      const { evaluations, step } = lane;
      const { six } = await scoreAt(this.#lab, this.motion, Math.min(step, STEPS), { particles, evaluations });
      sixes.push(six ?? 0);
    }
    if (!isOver()) this.shares.value = [...this.shares.peek(), [sixes[0], sixes[1]]];
  }
}

/** @param {FlowLane} lane @param {number} step */
function doStep(lane, step) {
  if (step === 0) return lane.begin(0);
  return step > STEPS ? lane.rest(STEPS) : lane.follow(step);
}

/** A few particles of the first surface and of the last, to which pictures are fitted. @param {Motion} motion */
async function endsOf(motion) {
  const lane = new FrontLane({ ...motion, radius: COARSER * motion.radius }, { isFresh: true });
  try {
    await lane.begin(0);
    const first = lane.particles;
    await lane.follow(STEPS);
    return [first, lane.particles];
  } finally {
    lane.close();
  }
}

/** The chart of both lanes. @param {Pursuit} pursuit @param {() => boolean} isOpen */
function chartOf(pursuit, isOpen) {
  // Written as in the scorecard below.
  const percent = rowOf('six').write;
  const { shares } = pursuit;
  const measured = (/** @type {number} */ step) => Math.ceil(step / MEASURED);
  const told = () => {
    const [first] = shares.value;
    const now = shares.value[Math.min(measured(pursuit.at.value), shares.value.length - 1)];
    if (!first) return '';
    const step = Math.min(AT_REST, MEASURED * shares.value.indexOf(now));
    return `Six neighbours, measured at every fourth step, last at ${pursuit.say(step)}: of those that flow ${percent(now[0])}, beside them ${percent(now[1])}; at the beginning ${percent(first[0])} and ${percent(first[1])}.`;
  };
  const row = (/** @type {0 | 1} */ k) => (shares.value.length > 0 ? shares.value.map((both) => both[k]) : [0]);
  return createChart({
    hidden: () => !isOpen(),
    chart: () => ({
      kind: 'line',
      rows: [
        { fate: 'own', name: 'it flows', counts: row(0) },
        { fate: 'other', name: 'beside it', counts: row(1) },
      ],
      first: 0,
      at: measured(pursuit.at.value),
      format: percent,
      ends: ['at first', 'as far as it went'],
      guide: [1],
    }),
    label: told,
    words: told,
    press: (at) => pursuit.go(Math.min(AT_REST, at * MEASURED)),
  });
}

/** @param {Context} context */
export async function moving({ lab, stops }) {
  const own = await lab;
  const isOpen = () => stops.isOpen('predict-moving');
  const pursuit = new Pursuit(own);
  const motions = [...MOTIONS, ...(await ownMotions(own))];
  const choices = [
    createSelectRow({
      name: 'Surface',
      choices: motions,
      change: (value) => {
        pursuit.motion = motions.find((one) => one.value === value) ?? MOTIONS[0];
        void pursuit.lay();
      },
    }),
    createSelectRow({
      name: 'Beside it',
      choices: RIVALS,
      change: (value) => {
        pursuit.rival = RIVALS.find((one) => one.value === value) ?? RIVALS[0];
        void pursuit.lay();
      },
    }),
  ];
  await pursuit.lay();
  // The answer is about the other end of the slider.
  live(pursuit.card, () => {
    if (isOpen()) pursuit.go(STEPS);
  });
  const isAlone = motions.length === MOTIONS.length;
  return [
    pursuit.place,
    pursuit.controls,
    h(
      'div',
      { class: 'controls' },
      choices.map(({ element }) => element),
    ),
    isAlone
      ? h('p', { class: 'quiet' }, 'A surface of the first page moves here, too, if its formula has a parameter.')
      : null,
    h('p', { class: 'figure-status', role: 'status' }, () => pursuit.status.value),
    chartOf(pursuit, isOpen),
    h('div', { hidden: () => !isOpen() }, pursuit.card),
  ];
}
