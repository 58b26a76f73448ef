/** The race: the front against the method that the paper compares it with, side by side under one camera. */

import { signal } from '@preact/signals-core';
import { kindOf } from '../engine/lesson/client.js';
import { opponentOf, Race } from '../engine/lesson/race.js';
import { button } from '../ui/button.js';
import { fill, h, s } from '../ui/dom.js';
import { formatCount, formatSeconds, formatSignificant, MISSING } from '../ui/format.js';
import { adaptiveRun } from './adaptive.js';
import { reasonOf } from './figure.js';
import { USUAL } from './lab.js';
import { nearestDistances } from './measure.js';
import { createSelectRow } from './parts.js';
import { byLevel, byValue, Orbit, Picture } from './picture.js';
import { createReplay, MOST_SHOTS } from './replay.js';
import { scoreOf } from './score.js';

/**
 * @import { Lane, LessonSettings } from '../engine/lesson/types.js'
 * @import { LessonParticles, Signal } from '../engine/types.js'
 * @import { Lab, LabRun, Snapshot } from './types.js'
 */

/** Particles of the front: enough to see the difference, few enough to wait for the other. */
const PARTICLES = 1500;
/** The pictures are brought up to date this often. */
const PICTURE_MS = 250;
/** The axis of the replay has so many places. */
const PLACES = 200;

/**
 * What can be counted.
 * @type {import('./types.js').ReplayOptions<Lane>['axes']}
 */
const COSTS = [
  {
    value: 'evaluations',
    label: 'evaluations of f',
    of: ({ progress }) => progress?.evaluations ?? 0,
    say: (cost) => formatCount(Math.round(cost)),
    moment: (cost) => `After ${formatCount(Math.round(cost))} evaluations of f each, or at the end`,
  },
  {
    value: 'pushes',
    label: 'pushes',
    of: ({ progress }) => progress?.interactions ?? 0,
    say: (cost) => formatCount(Math.round(cost)),
    moment: (cost) => `After ${formatCount(Math.round(cost))} pushes each, or at the end`,
  },
  {
    value: 'seconds',
    label: 'seconds',
    of: ({ workMs }) => workMs / 1000,
    say: formatSeconds,
    moment: (cost) => `After ${formatSeconds(cost)} each, or at the end`,
  },
];
/** Distances over the ideal one span this range of colours. */
const [NEAR, FAR] = [0.7, 1.15];

/**
 * Time of the other method over that of the front, for each pair of ellipsoids in Table 1 of the paper.
 * @type {Record<string, readonly { ratio: number, words: string }[]>}
 */
const OF_THE_PAPER = {
  uniform: [
    { ratio: 219.63 / 19.8, words: '13,923 particles against 10,633' },
    { ratio: 4344.01 / 613.54, words: '55,748 against 33,343, stopped before its end' },
  ],
  adaptive: [
    { ratio: 717.53 / 75.32, words: '15,296 particles against 12,475' },
    { ratio: 4535.15 / 252.19, words: '27,314 against 27,151' },
  ],
};
/** The axis of these ratios is logarithmic, between these. */
const LEAST_RATIO = 0.5;
const MOST_RATIO = 30;
const TICKS = [1, 2, 5, 10, 20];

const KINDS = [
  { value: 'uniform', label: 'One size: the front and Witkin and Heckbert’s system' },
  { value: 'adaptive', label: 'By curvature: the front and forces' },
];

/** The settings of the front. @param {Lab} lab @param {string} kind @returns {Promise<Partial<LessonSettings>>} */
async function settingsOf(lab, kind) {
  const radius = await lab.radiusFor(PARTICLES);
  if (kind === 'uniform') return { ...USUAL, radius };
  const { settings } = await adaptiveRun(lab, 'max_curvature', {}, PARTICLES);
  return settings;
}

/** A lane: its picture and its clock. @param {Orbit} orbit @param {string} name */
function createLane(orbit, name) {
  const picture = new Picture(orbit, { name: `${name}: its particles so far` });
  const values = [h('dd', null, MISSING), h('dd', null, MISSING), h('dd', null, MISSING), h('dd', null, MISSING)];
  const names = ['Clock', 'Particles', 'Rounds', 'Evaluations of f'];
  const title = h('figcaption', null, name);
  const state = h('p', { class: 'figure-count' });
  const list = h(
    'dl',
    { class: 'lane' },
    names.flatMap((label, k) => [h('dt', null, label), values[k]]),
  );
  return {
    element: h('figure', null, picture.element, title, list, state),
    picture,
    /** @param {Lane} lane */
    tell({ progress, workMs }) {
      values[0].textContent = formatSeconds(workMs / 1000);
      values[1].textContent = progress ? formatCount(progress.particles) : MISSING;
      values[2].textContent = progress ? formatCount(progress.steps) : MISSING;
      values[3].textContent = progress ? formatCount(progress.evaluations) : MISSING;
      state.textContent = !progress?.is_done
        ? ''
        : progress.is_settled || progress.steps <= 10
          ? 'It is done.'
          : 'It ended without coming to rest.';
    },
    /** @param {LessonParticles} particles */
    show(particles) {
      picture.show({ particles, colours: byValue(nearestDistances(particles), NEAR, FAR) });
    },
  };
}

/** @param {HTMLElement} host @param {Lab} lab */
export function mountRace(host, lab) {
  const course = new Course(lab);
  const { kind, race, isPaused, place, result } = course;
  const choose = createSelectRow({
    name: 'Race',
    choices: KINDS,
    change: (value) => {
      kind.value = value;
      course.stop();
      course.lay();
    },
  });
  const go = button({ class: 'primary', press: () => course.press() }, () =>
    !race.value ? 'Start' : isPaused.value ? 'Continue' : 'Pause',
  );
  const status = h('p', { class: 'figure-status', role: 'status' }, () => course.status.value);
  fill(host, h('div', { class: 'controls' }, choose.element, go), place, status, result);
  course.lay();
}

/** The race that is run, with its two lanes. */
class Course {
  #lab;
  kind = signal(KINDS[0].value);
  /** @type {Signal<Race | null>} */
  race = signal(null);
  isPaused = signal(false);
  status = signal('');
  place = h('div', { class: 'pair' });
  result = h('div', { class: 'compare-box' });

  /** @param {Lab} lab */
  constructor(lab) {
    this.#lab = lab;
  }

  /** Lays the lanes anew. */
  lay() {
    const orbit = new Orbit();
    const names = this.kind.peek() === 'uniform' ? ['The front', 'Witkin and Heckbert'] : ['The front', 'Forces'];
    const lanes = names.map((name) => createLane(orbit, name));
    fill(
      this.place,
      lanes.map(({ element }) => element),
    );
    fill(this.result);
    // Before the start there is the body alone.
    const bare = (/** @type {LabRun} */ { placed }) => {
      if (this.race.peek() || lanes.some(({ picture }) => picture.scene.peek())) return;
      orbit.fitTo(placed);
      orbit.faceFront(placed);
      for (const { picture } of lanes) picture.show({ particles: placed, count: 0, colours: byLevel(placed) });
    };
    this.#lab.run({}, { keep: true }).then(bare, () => {});
    return { orbit, lanes, names };
  }

  stop() {
    this.race.peek()?.close();
    this.race.value = null;
    this.isPaused.value = false;
    this.status.value = '';
  }

  press() {
    const race = this.race.peek();
    if (!race) return void this.run();
    this.isPaused.value = !this.isPaused.peek();
    if (this.isPaused.peek()) race.pause();
    else race.resume();
  }

  async run() {
    const kind = this.kind.peek();
    const { orbit, lanes, names } = this.lay();
    /** @type {[Snapshot<Lane>[], Snapshot<Lane>[]]} */
    const films = [[], []];
    const own = raceOn(lanes, films);
    const isOver = () => this.race.peek() !== own;
    this.race.value = own;
    this.status.value = 'Both are running. You may turn the pictures.';
    try {
      const settings = await settingsOf(this.#lab, kind);
      const { end } = await this.#lab.run({ radius: settings.radius, relax_steps: 0 }, { particles: PARTICLES });
      // The race may have been given up or paused during the run.
      if (isOver()) return;
      orbit.fitTo(end);
      orbit.faceFront(end);
      const done = own.start(this.#lab.surface, [settings, opponentOf(settings)]);
      if (this.isPaused.peek()) own.pause();
      await done;
      if (isOver()) return;
      const ratio = own.lanes[1].workMs / own.lanes[0].workMs;
      // The last snapshots are answered in their order.
      await Promise.all([own.particles(0), own.particles(1)]);
      if (isOver()) return;
      const isAdaptive = kind === 'adaptive';
      const replay = createReplay({
        films,
        names,
        axes: COSTS,
        axisName: 'Both at the same',
        name: 'Spent',
        places: PLACES,
        at: PLACES,
        most: (of) => Math.max(...films.map((shots) => of(shots[shots.length - 1].lane))),
        score: ({ lane, particles }) =>
          scoreOf(this.#lab, particles, { evaluations: lane.progress?.evaluations ?? 0, isAdaptive }),
        show: (k, { lane, particles }) => {
          lanes[k].tell(lane);
          lanes[k].show(particles);
        },
        point: (place, side) => {
          for (const [k, { picture }] of lanes.entries()) picture.ringed.value = k === side ? place : null;
          if (place) orbit.turnTo(place.normal);
        },
      });
      fill(this.result, replay.element, marksOf(kind, ratio));
      this.stop();
      this.status.value = 'Measuring both';
      await replay.seek();
      if (!this.race.peek()) this.status.value = '';
    } catch (error) {
      if (isOver() || kindOf(error) === 'given_up') return;
      this.stop();
      this.status.value = reasonOf(error);
    }
  }
}

/**
 * A race that shows itself on its lanes, and keeps snapshots of both.
 * @param {readonly ReturnType<typeof createLane>[]} lanes @param {[Snapshot<Lane>[], Snapshot<Lane>[]]} films
 */
function raceOn(lanes, films) {
  const lastMs = [-Infinity, -Infinity];
  const [turns, strides] = [
    [0, 0],
    [1, 1],
  ];
  const race = new Race({
    onLane(k, { progress, workMs }) {
      const lane = { progress, workMs };
      const isDone = progress?.is_done ?? false;
      lanes[k].tell(lane);
      turns[k] += 1;
      if (!isDone && turns[k] % strides[k] !== 0) return;
      const keep = (/** @type {LessonParticles} */ particles) => {
        if (particles.radii.length === 0) return;
        films[k].push({ lane, particles });
        if (films[k].length > MOST_SHOTS && !isDone) {
          films[k].splice(0, Infinity, ...films[k].filter((_, shot) => shot % 2 === 0));
          strides[k] *= 2;
        }
        const now = performance.now();
        if (!isDone && now - lastMs[k] < PICTURE_MS) return;
        lastMs[k] = now;
        lanes[k].show(particles);
      };
      race.particles(k).then(keep, () => {});
    },
  });
  return race;
}

/** Returns the place of a ratio on the axis, 0 to 1. @param {number} ratio */
const axisShare = (ratio) =>
  Math.min(1, Math.max(0, Math.log(ratio / LEAST_RATIO) / Math.log(MOST_RATIO / LEAST_RATIO)));

/**
 * Marks this race and those of the paper on an axis of ratios. It is a diagram: a chart has bars or a line.
 * @param {string} kind @param {number} ratio  of the two clocks
 */
function marksOf(kind, ratio) {
  const paper = OF_THE_PAPER[kind];
  const told = [
    `Here the other method worked ${formatSignificant(ratio, 2)} times as long as the front.`,
    ...paper.map((row) => `In the paper ${formatSignificant(row.ratio, 2)} times: ${row.words}.`),
  ];
  const svg = s('svg', { class: 'ratios', viewBox: '0 0 100 9', role: 'img', 'aria-label': told.join(' ') });
  const x = (/** @type {number} */ value) => 2 + 96 * axisShare(value);
  svg.append(s('line', { x1: 2, x2: 98, y1: 5, y2: 5 }));
  for (const tick of TICKS) {
    svg.append(s('line', { x1: x(tick), x2: x(tick), y1: 4.5, y2: 5.5 }));
    svg.append(s('text', { x: x(tick), y: 8.4 }, `${tick}×`));
  }
  for (const row of paper) svg.append(s('circle', { class: 'of-paper', cx: x(row.ratio), cy: 5, r: 0.9 }));
  svg.append(s('circle', { class: 'of-here', cx: x(ratio), cy: 5, r: 1.1 }));
  return h(
    'figure',
    { class: 'ratio-figure' },
    svg,
    h(
      'figcaption',
      null,
      `Time of the other method divided by that of the front: filled here, open in Table 1. ${told.join(' ')}`,
    ),
  );
}
