/**
 * Particles that follow a surface that moves, step by step: those of a front in the sampler's core, and those of Witkin
 * and Heckbert's system in the lesson's. Each lane has a worker of its own.
 */
import { LessonClient } from '../engine/lesson/client.js';
import { FlowingFront } from '../engine/sampling/flowing.js';
import { along, distance } from '../engine/vector.js';
import { formatCount, formatFixed } from '../ui/format.js';
import { PARTICLES } from './lab.js';
import { rowOf, scoreOf } from './score.js';

/**
 * @import { LessonParticles } from '../engine/types.js'
 * @import { FormulaSurface } from '../ui/types.js'
 * @import { Answer, Flowing, FlowLane, Lab, Motion } from './types.js'
 */

/** Steps of the slider from one end to the other: no particle moves by more than its radius in one. */
export const STEPS = 60;
/** Rounds of Witkin and Heckbert's system for each step of the slider, and at rest, if it does not settle before. */
const ROUNDS = 4;
const MOST_ROUNDS = 200;

/** @param {string} formula @param {string} name @param {readonly number[]} half  of the box */
const moved = (formula, name, half) => ({
  formula,
  parameters: [{ name, label: name, value: 0, min: 0, max: 0, step: 0 }],
  bounds: { min: along([0, 0, 0], half, -1), max: along([0, 0, 0], half, 1) },
});

/** The surfaces that move, each by one parameter. @type {readonly Motion[]} */
export const MOTIONS = [
  {
    value: 'ellipsoid',
    label: 'An ellipsoid is drawn out',
    surface: moved('x^2/a^2 + y^2/0.49 + z^2/0.25 = 1', 'a', [1.7, 0.8, 0.6]),
    name: 'a',
    range: [0.8, 1.6],
    radius: 0.04,
  },
  {
    value: 'tanglecube',
    label: 'A tanglecube falls into eight',
    surface: moved('x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + c = 0', 'c', [2.6, 2.6, 2.6]),
    name: 'c',
    range: [11, 14],
    radius: 0.14,
  },
];

/** A slider of the learner's own surface is moved by this share of it, towards its farther end. */
const OWN_SHARE = 0.25;

/** The learner's own surface, moved by each of its parameters. @param {Lab} lab @returns {Promise<Motion[]>} */
export async function ownMotions(lab) {
  const { surface } = lab;
  if (surface.parameters.length === 0) return [];
  const radius = await lab.radiusFor(PARTICLES);
  return surface.parameters.map(({ name, value, min, max }) => {
    const way = OWN_SHARE * (max - min) * (max - value >= value - min ? 1 : -1);
    return {
      value: `own-${name}`,
      label: `Yours, by ${name}`,
      surface,
      name,
      range: [value, value + way],
      radius,
    };
  });
}

/** The value of the parameter at a step. @param {Motion} motion @param {number} step */
export const valueAt = ({ range: [from, to] }, step) => from + ((to - from) * Math.min(step, STEPS)) / STEPS;

/** The surface at a step. @param {Motion} motion @param {number} step @returns {FormulaSurface} */
export function surfaceAt(motion, step) {
  const { surface, name, range } = motion;
  const [min, max] = [Math.min(...range), Math.max(...range)];
  const of = { value: valueAt(motion, step), min, max, step: (max - min) / STEPS };
  const parameters = surface.parameters.map((one) => (one.name === name ? { ...one, ...of } : one));
  return { ...surface, parameters };
}

/** @param {Lab} lab @param {Motion} motion @param {number} step @param {Flowing} lane */
export const scoreAt = (lab, motion, step, { particles, evaluations }) =>
  scoreOf(lab.beside(surfaceAt(motion, step)), particles, { evaluations, isAdaptive: false });

/** The particles of a front, which flow. @implements {FlowLane} */
export class FrontLane {
  #motion;
  #how;
  #front;
  /** Evaluations of the fronts before the present one. */
  #before = 0;
  evaluations = 0;
  particles = none();

  /**
   * @param {Motion} motion
   * @param {{ isClosed?: boolean, isFresh?: boolean, front?: FlowingFront }} [how]  `isClosed`: particles are neither
   *   born nor die; `isFresh`: every step has a front of its own
   */
  constructor(motion, { isClosed = false, isFresh = false, front = new FlowingFront() } = {}) {
    this.#motion = motion;
    this.#how = { isClosed, isFresh };
    this.#front = front;
  }

  /** @param {number} step */
  begin(step) {
    this.#before = this.evaluations;
    return this.#go(step, false);
  }

  /** @param {number} step */
  follow(step) {
    return this.#how.isFresh ? this.begin(step) : this.#go(step, true);
  }

  /** At rest a new front takes their place, unless none may be born. @param {number} step */
  async rest(step) {
    if (!this.#how.isClosed) await this.begin(step);
  }

  close() {
    this.#front.close();
  }

  /** @param {number} step @param {boolean} follows */
  async #go(step, follows) {
    const { formula, parameters, bounds } = surfaceAt(this.#motion, step);
    const settings = { size_mode: 'radius', radius_share: this.#motion.radius / distance(bounds.max, bounds.min) };
    const how = { follows, isClosed: this.#how.isClosed };
    const { columns, evaluations } = await this.#front.go({ formula, declare: parameters, bounds }, settings, how);
    const { positions, normals, radii, levels, parents } = columns;
    this.particles = { ...none(radii.length), positions, normals, radii, levels, parents };
    this.evaluations = this.#before + evaluations;
  }
}

/** Witkin and Heckbert's particles, which follow as in their own system. @implements {FlowLane} */
export class SystemLane {
  #motion;
  #client;
  evaluations = 0;
  particles = none();

  /** @param {Motion} motion @param {{ client?: LessonClient }} [how] */
  constructor(motion, { client = new LessonClient() } = {}) {
    this.#motion = motion;
    this.#client = client;
  }

  /** @param {number} step */
  async begin(step) {
    const settings = /** @type {const} */ ({ method: 'witkin_heckbert', radius: this.#motion.radius, radius_max: 0 });
    await this.#look((await this.#client.start(surfaceAt(this.#motion, step), settings)).evaluations);
  }

  /** @param {number} step */
  async follow(step) {
    const moved = await this.#client.ask('follow', surfaceAt(this.#motion, step));
    if (!moved?.ok) throw new Error(moved?.error.message ?? 'No run was begun.');
    await this.#advance(moved.particles, ROUNDS);
  }

  /** At rest the system goes on until it has settled. */
  async rest() {
    for (let rounds = 0; rounds < MOST_ROUNDS; rounds += ROUNDS)
      if ((await this.#advance(this.particles.radii.length, ROUNDS)).is_done) return;
  }

  close() {
    this.#client.close();
  }

  /** In a round every particle is moved, and then decided on. @param {number} particles @param {number} rounds */
  async #advance(particles, rounds) {
    const { progress } = await this.#client.ask('advance', { units: 2 * rounds * Math.max(1, particles) });
    await this.#look(progress.evaluations);
    return progress;
  }

  /** @param {number} evaluations */
  async #look(evaluations) {
    this.particles = await this.#client.ask('seek', { event: Infinity });
    this.evaluations = evaluations;
  }
}

/** Particles of no front and with no fates. @param {number} [count] @returns {LessonParticles} */
function none(count = 0) {
  const numbers = () => new Uint32Array(count);
  return {
    ...{ at: 0, positions: new Float32Array(3 * count), normals: new Float32Array(3 * count) },
    ...{ radii: new Float32Array(count), levels: numbers(), parents: numbers(), fronts: numbers(), slots: numbers() },
    done: new Uint8Array(count).fill(1),
  };
}

/** What is called a loss: a hole this wide, a count this far from a new front's, so many fewer with six neighbours. */
const [HOLE, COUNT, SIX] = [1.9, 0.15, 0.1];

/**
 * What the front of the first motion has lost at the other end of the slider.
 * @param {Lab} lab @param {FrontLane} [lane]
 * @returns {Promise<Answer>}
 */
export async function lossOf(lab, lane = new FrontLane(MOTIONS[0])) {
  const [motion] = MOTIONS;
  try {
    await lane.begin(0);
    const before = await scoreAt(lab, motion, 0, lane);
    for (let step = 1; step <= STEPS; step += 1) await lane.follow(step);
    const [after, count] = [await scoreAt(lab, motion, STEPS, lane), lane.particles.radii.length];
    await lane.rest(STEPS);
    const fresh = lane.particles.radii.length;
    const lost = Number(before.six) - Number(after.six);
    const isFar = Math.abs(count / fresh - 1) > COUNT;
    const right = Number(after.hole) > HOLE ? 'holes' : isFar ? 'count' : lost > SIX ? 'order' : 'nothing';
    const percent = (/** @type {number | null} */ share) => rowOf('six').write(Number(share));
    const hole = (/** @type {number | null} */ size) => formatFixed(Number(size), 2);
    const words = [
      `There are ${formatCount(count)} particles, and a new front has ${formatCount(fresh)}. The largest hole was ${hole(before.hole)} times that of the ideal pattern and is ${hole(after.hole)}.`,
      `But ${percent(before.six)} of the particles had six neighbours, and now ${percent(after.six)} have: a child is born where there is room, and not where a lattice would have it.`,
    ];
    return { right, words: words.join(' ') };
  } finally {
    lane.close();
  }
}
