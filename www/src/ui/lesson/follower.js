/**
 * Follows single particles: runs the paper's algorithm on the surface of the picture, finds the particle that stands for one of
 * the picture, and goes through its events.
 */
import { batch, computed, signal } from '@preact/signals-core';
import { NO_PARENT } from '../../engine/columns.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle, RESIDUAL, triple } from '../../figures/particle.js';
import { formatCount, formatSignificant, plural } from '../format.js';
import { clamp } from '../scale.js';
import { nearest, standIn } from './find.js';

/**
 * @typedef {import('../../engine/types.js').Engine} Engine
 * @typedef {import('../../engine/types.js').LessonEvent} LessonEvent
 * @typedef {import('../../engine/types.js').LessonClient} LessonClient
 * @typedef {import('../../engine/types.js').Vec3} Vec3
 */
/**
 * The particle that is open. `picture` is the one of the picture for which it stands, with its distance; null after a step to
 * another one.
 * @typedef {import('../../figures/particle.js').Opened & { picture: { index: number, distance: number } | null }} Opened
 */
/**
 * @typedef {{ kind: 'running', particles: number }
 *   | { kind: 'ready' }
 *   | { kind: 'too_many', text: string, radius: number }
 *   | { kind: 'failed', text: string }} Status
 */
/**
 * A run and the surface that it belongs to.
 * @typedef {object} Run
 * @property {string} surface  see {@link surfaceKey}
 * @property {string} words  the surface in words
 * @property {number} pictureRadius
 * @property {number} own  radius of the particle that was asked for, which the run has unless that would be too many
 * @property {number} radius
 * @property {boolean} adaptive  whether the picture's particles have different radii
 * @property {import('../../engine/types.js').LessonParticles} end  all its particles
 */

/** The most particles whose events are followed, as the core has it. */
const MOST_PARTICLES = 20_000;
/** The particles that a coarser run aims at, and the least factor by which its radius grows. */
const COARSER_PARTICLES = 16_000;
const LEAST_COARSER = 1.25;
/** Time for which an event is shown during playback: long enough to read its sentence. */
const PLAY_MS = 1200;

/** Settings of a run: Algorithm 2 child by child. Matched particles stay among the neighbours, as in the picture's own front. */
const SETTINGS = /** @type {const} */ ({
  placing: 'one_by_one',
  matched: 'stay',
  gaps: 'leave',
  relax_steps: 0,
  residual: RESIDUAL,
});

/** Names the surface of the picture, so that a change can be told. @param {Engine} engine */
function surfaceKey({ field }) {
  const { kind, formula, parameters, bounds, surface, model } = field.value ?? {};
  const values = parameters?.map(({ name, value }) => [name, value]);
  return JSON.stringify([kind, formula, values, bounds, surface, model]);
}

/** The surface in words, for a transcript. @param {Engine} engine */
function surfaceWords({ field }) {
  const { kind, formula, parameters } = field.value ?? {};
  if (kind !== 'formula') return 'a model from points';
  return [formula, ...(parameters ?? []).map(({ name, value }) => `${name} = ${value}`)].join(', ');
}

export class Follower {
  /** @param {Engine} engine */
  constructor(engine) {
    this.engine = engine;
    /** @type {import('@preact/signals-core').Signal<Status>} */
    this.status = signal({ kind: 'running', particles: 0 });
    this.opened = signal(/** @type {Opened | null} */ (null));
    /** Number of the event that is shown. */
    this.at = signal(0);
    this.playing = signal(false);
    this.run = signal(/** @type {Run | null} */ (null));
    this.moment = computed(() => {
      const opened = this.opened.value;
      return opened && opened.events.length > 0 ? momentAt(opened.events, this.at.value) : null;
    });
    /** Whether the picture shows another surface, or one with another radius, than the run. */
    this.stale = computed(() => {
      const run = this.run.value;
      if (!run) return false;
      const { phase, radius } = engine.progress.value;
      return surfaceKey(engine) !== run.surface || (phase === 'done' && radius !== run.pictureRadius);
    });
    /** @type {LessonClient | null} */
    this.client = null;
    /** Number of the last order, so that the answers to earlier ones are dropped. */
    this.asked = 0;
    this.timer = 0;
    /** The particle of the picture that was followed last. @type {{ index: number, place: Vec3 } | null} */
    this.wanted = null;
  }

  /**
   * Follows a particle of the picture.
   * @param {number} index @param {number | null} [coarser]  radius of the run; null for that of the picture
   */
  async follow(index, coarser = null) {
    const { engine } = this;
    const { columns } = engine;
    if (index >= columns.count || columns.stale) return;
    this.pause();
    this.wanted = { index, place: triple(columns.positions, index) };
    const pictureRadius = engine.progress.peek().radius;
    const own = columns.adaptive || !(pictureRadius > 0) ? columns.radii[index] : pictureRadius;
    const radius = coarser ?? own;
    const run = this.run.peek();
    const surface = surfaceKey(engine);
    const isKnown = run && run.surface === surface && run.own === own && (coarser === null || run.radius === coarser);
    if (isKnown) return this.stand(run);
    if (coarser === null && !columns.adaptive && columns.count > MOST_PARTICLES) return this.tooMany(radius);
    const { adaptive } = columns;
    await this.begin({ surface, words: surfaceWords(engine), pictureRadius, own, radius, adaptive });
  }

  /** Follows the particle of the present picture at the place of the one before. */
  async again() {
    const { columns } = this.engine;
    const found = this.wanted && nearest(columns.positions, columns.count, this.wanted.place);
    if (found) await this.follow(found.particle);
  }

  /** @param {Omit<Run, 'end'>} about */
  async begin(about) {
    const { engine } = this;
    const mine = this.next();
    const surface = engine.lessonSurface();
    batch(() => {
      this.opened.value = null;
      this.run.value = null;
      this.status.value = surface
        ? { kind: 'running', particles: 0 }
        : { kind: 'failed', text: 'The surface is still being loaded.' };
    });
    if (!surface) return;
    try {
      this.client ??= await engine.openLesson({
        onProgress: ({ particles }) => {
          if (this.status.peek().kind === 'running') this.status.value = { kind: 'running', particles };
        },
      });
      if (mine !== this.asked) return;
      await this.client.start(surface, { ...SETTINGS, radius: about.radius, seeds: seedsOf(engine) });
      const end = await this.client.ask('seek', { event: Infinity });
      if (mine !== this.asked) return;
      const run = { ...about, end };
      this.run.value = run;
      await this.stand(run);
    } catch (error) {
      if (mine === this.asked) this.fail(error, about.radius);
    }
  }

  /** Opens the particle of the run that stands for the one that is wanted. @param {Run} run */
  async stand(run) {
    const found = this.wanted && standIn(run.end.positions, this.wanted, run.radius);
    if (!found || !this.wanted) {
      this.status.value = { kind: 'failed', text: 'The algorithm found no surface here.' };
      return;
    }
    await this.open(found.particle, { index: this.wanted.index, distance: found.distance });
  }

  /** Opens a particle of the run. @param {number} particle @param {Opened['picture']} [picture] */
  async open(particle, picture = null) {
    const run = this.run.peek();
    const { client } = this;
    if (!run || !client || particle < 0 || particle >= run.end.radii.length) return;
    this.pause();
    const mine = this.next();
    try {
      const opened = await openParticle(client, run, particle);
      if (mine !== this.asked) return;
      batch(() => {
        this.opened.value = { ...opened, picture };
        this.at.value = 0;
        this.status.value = { kind: 'ready' };
      });
    } catch (error) {
      if (mine === this.asked) this.fail(error, run.radius);
    }
  }

  next() {
    this.asked += 1;
    return this.asked;
  }

  /** @param {number} radius */
  tooMany(radius) {
    this.next();
    const { count } = this.engine.columns;
    batch(() => {
      this.opened.value = null;
      this.status.value = {
        kind: 'too_many',
        text: `The picture has ${plural(count, 'particle')}. The events of at most ${formatCount(MOST_PARTICLES)} are followed.`,
        radius: coarserThan(radius, count),
      };
    });
  }

  /** @param {any} error @param {number} radius */
  fail(error, radius) {
    const words = error instanceof Error ? error.message : String(error);
    if (error?.kind === 'given_up') return;
    if (error?.kind === 'crashed' || error?.kind === 'bundle') this.run.value = null;
    this.opened.value = null;
    if (error?.kind === 'refused' && /are to be expected/.test(words)) {
      const expected = Number(/about (\d+)/.exec(words)?.[1] ?? MOST_PARTICLES);
      this.status.value = {
        kind: 'too_many',
        text: `With the radius ${formatSignificant(radius, 3)} about ${plural(expected, 'particle')} are to be expected. The events of at most ${formatCount(MOST_PARTICLES)} are followed.`,
        radius: coarserThan(radius, expected),
      };
    } else if (error?.kind === 'refused') {
      this.status.value = { kind: 'failed', text: `This surface cannot be followed: ${words}.` };
    } else if (error?.kind === 'crashed') {
      this.status.value = { kind: 'failed', text: `Following stopped on an error: ${words}.` };
    } else {
      const text = `The part of the page that follows particles did not load: ${words}. The picture is not affected.`;
      this.status.value = { kind: 'failed', text };
    }
  }

  get last() {
    return Math.max(0, (this.opened.peek()?.events.length ?? 0) - 1);
  }

  /** Shows an event at the user's request. @param {number} at */
  seek(at) {
    this.pause();
    this.at.value = clamp(at, 0, this.last);
  }

  /** @param {number} by */
  step(by) {
    this.seek(this.at.peek() + by);
  }

  /** Opens the particle before or after. @param {1 | -1} by */
  turn(by) {
    const opened = this.opened.peek();
    if (opened) void this.open(opened.subject.particle + by);
  }

  toggle() {
    if (this.playing.peek()) return this.pause();
    if (this.last === 0) return;
    if (this.at.peek() >= this.last) this.at.value = 0;
    this.playing.value = true;
    const next = () => {
      this.at.value = Math.min(this.last, this.at.peek() + 1);
      if (this.at.peek() >= this.last) this.pause();
      else wait();
    };
    const wait = () => {
      this.timer = window.setTimeout(next, PLAY_MS);
    };
    wait();
  }

  pause() {
    clearTimeout(this.timer);
    this.playing.value = false;
  }

  /** Ends the worker and frees its memory. */
  close() {
    this.pause();
    this.next();
    this.client?.close();
    this.client = null;
    batch(() => {
      this.opened.value = null;
      this.run.value = null;
    });
  }
}

/** A radius with which there are few enough particles. @param {number} radius @param {number} count  with that radius */
const coarserThan = (radius, count) => radius * Math.max(LEAST_COARSER, Math.sqrt(count / COARSER_PARTICLES));

/** The points of the picture at which fronts began. @param {Engine} engine @returns {Vec3[]} */
function seedsOf({ columns }) {
  const seeds = [];
  for (let i = 0; i < columns.count; i += 1)
    if (columns.parents[i] === NO_PARENT) seeds.push(triple(columns.positions, i));
  return seeds;
}
