/**
 * Follows single particles: runs the paper's algorithm on the surface of the picture, finds the particle that stands
 * for one of the picture, and goes through its events.
 */

import { batch, computed, signal } from '@preact/signals-core';
import { clamp, nearest, triple } from '../../engine/vector.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle } from '../../figures/particle.js';
import { formatCount, formatSignificant, plural } from '../format.js';
import { surfaceWords } from '../surface-link.js';
import { standIn } from './find.js';
import { Relaxation } from './rest.js';
import { alikeIn, isOfSolid, settingsOf, surfaceKey } from './run.js';

/**
 * @import { Engine, LessonClient, ReadonlySignal, Signal, Vec3 } from '../../engine/types.js'
 * @import { FollowedRun, Opened, Status } from './types.js'
 */

/**
 * A particle that is to be opened, and the event to begin with.
 * @typedef {{ particle: number, at: number | 'last', picture: Opened['picture'] }} Wish
 */

/** The least factor by which the radius of a coarser run grows. */
const LEAST_COARSER = 1.25;
const OF_SURFACES = 'Particles of solids cannot be followed: the paper’s algorithm runs on the surface of the formula.';

export class Follower {
  #say;

  /** @type {Wish | null} */
  #wish;
  #isLoading;

  /** The particle of the picture that was followed last. @type {{ index: number, place: Vec3 } | null} */
  #wanted;

  /** @param {Engine} engine @param {(text: string) => void} say  tells what a link names and is not there */
  constructor(engine, say) {
    this.engine = engine;
    this.#say = say;
    /** @type {Signal<Status>} */
    this.status = signal({ kind: 'running', particles: 0 });
    /** @type {Signal<Opened | null>} */
    this.opened = signal(null);
    /** Number of the event that is shown. */
    this.at = signal(0);
    /** The particle that is open, or is about to be. */
    this.target = signal(0);
    /**
     * The particle that is open, and its event.
     * @type {ReadonlySignal<[number, number] | null>}
     */
    this.place = computed(() => (this.opened.value ? [this.opened.value.subject.particle, this.at.value] : null));
    /** @type {Signal<FollowedRun | null>} */
    this.run = signal(null);
    this.moment = computed(() => {
      const opened = this.opened.value;
      return opened && opened.events.length > 0 ? momentAt(opened.events, this.at.value) : null;
    });
    /**
     * The slot under the pointer, in a view or in the picture; every view then shows it.
     * @type {Signal<number | null>}
     */
    this.pointed = signal(null);
    this.hot = computed(() => this.pointed.value ?? this.#slotInPicture());
    /** Whether the picture shows another surface, or one with another radius, than the run. */
    this.stale = computed(() => {
      const run = this.run.value;
      if (!run) return false;
      const { phase, radius } = engine.progress.value;
      return surfaceKey(engine) !== run.surface || (phase === 'done' && radius !== run.pictureRadius);
    });
    /** The particle in the relaxation. */
    this.rest = new Relaxation(this);
    /** @type {LessonClient | null} */
    this.client = null;
    /** Number of the last order, so that the answers to earlier ones are dropped. */
    this.asked = 0;
    this.#wish = null;
    this.#isLoading = false;
    this.#wanted = null;
    /** Does once more what was asked for last. @type {(radius: number | null) => void} */
    this.again = () => {};
  }

  /** The slot whose particle is under the pointer in the picture. */
  #slotInPicture() {
    const hover = this.engine.hover.value;
    const { moment, run } = this;
    if (!hover || !moment.value || !run.value || hover.index >= run.value.alike) return null;
    return moment.value.children.find(({ particle }) => particle === hover.index)?.slot ?? null;
  }

  /** Number of particles of the run. */
  get count() {
    return this.run.value?.end.radii.length ?? 0;
  }

  /**
   * Follows a particle of the picture.
   * @param {number} index @param {number | null} [coarser]  radius of the run; null for that of the picture
   */
  async follow(index, coarser = null) {
    const { columns } = this.engine;
    if (index >= columns.count || columns.stale) return;
    this.#wanted = { index, place: triple(columns.placed, index) };
    this.again = (radius) => void this.follow(index, radius);
    const run = await this.#runFor(coarser);
    if (!run) return;
    const found = standIn(run.end.positions, this.#wanted, run.adaptive ? 0 : run.radius);
    if (found) await this.open(found.index, { picture: { index, distance: found.distance } });
    else this.status.value = { kind: 'failed', text: 'The algorithm found no surface here.' };
  }

  /**
   * Opens a particle of the run at an event, as a link names them; the nearest ones where there are fewer.
   * @param {[number, number]} place @param {number | null} [coarser]
   */
  async goTo(place, coarser = null) {
    const [particle, at] = place;
    const { columns } = this.engine;
    const opened = this.opened.peek();
    if (opened && !this.stale.peek() && opened.subject.particle === particle) return this.seek(at);
    if (columns.count === 0 || columns.stale) return;
    this.again = (radius) => void this.goTo(place, radius);
    const run = await this.#runFor(coarser);
    if (!run) return;
    const last = run.end.radii.length - 1;
    await this.open(Math.min(particle, last), { at });
    const now = this.opened.peek();
    if (!now) return;
    this.#wanted = { index: Math.min(now.subject.particle, columns.count - 1), place: now.place };
    if (particle > last) this.#say(`The link names particle ${formatCount(particle)}. The last one is shown.`);
    else if (at > this.#last)
      this.#say(
        `The link names event ${formatCount(at + 1)} of particle ${formatCount(particle)}. The last one is shown.`,
      );
  }

  /** Follows the particle of the present picture at the place of the one before. */
  async anew() {
    const { columns } = this.engine;
    const found = this.#wanted && nearest(columns.placed, columns.count, this.#wanted.place);
    if (found) await this.follow(found.index);
  }

  /**
   * Returns the run on the present surface, which is made unless it is there; null if it cannot be had.
   * @param {number | null} coarser  another radius than that of the picture
   */
  async #runFor(coarser) {
    const { engine } = this;
    const { columns } = engine;
    const pictureRadius = engine.progress.peek().radius;
    const own = columns.adaptive ? 1 : pictureRadius > 0 ? pictureRadius : columns.radii[0];
    const radius = coarser ?? own;
    const run = this.run.peek();
    const surface = surfaceKey(engine);
    if (run && run.surface === surface && run.own === own && (coarser === null || run.radius === coarser)) return run;
    const { adaptive } = columns;
    const field = engine.field.peek();
    const words = field?.model === null ? surfaceWords(field) : 'a model from points';
    return this.#begin({ surface, words, pictureRadius, own, radius, adaptive });
  }

  /** @param {Omit<FollowedRun, 'end' | 'alike'>} about */
  async #begin(about) {
    const { engine } = this;
    const mine = this.#next();
    const surface = engine.lessonSurface();
    const isSolid = isOfSolid(engine);
    batch(() => {
      this.opened.value = null;
      this.run.value = null;
      this.status.value =
        surface && !isSolid
          ? { kind: 'running', particles: 0 }
          : { kind: 'failed', text: isSolid ? OF_SURFACES : 'The surface is still being loaded.' };
    });
    if (!surface || isSolid) return null;
    try {
      this.client ??= await engine.openLesson({
        onProgress: ({ particles }) => {
          if (this.status.peek().kind === 'running') this.status.value = { kind: 'running', particles };
        },
      });
      if (mine !== this.asked) return null;
      await this.client.start(surface, settingsOf(engine, about));
      const end = await this.client.ask('seek', { event: Infinity });
      if (mine !== this.asked) return null;
      // With graded sizes the picture's particles differ from those of the run from the start.
      const alike = about.adaptive ? 0 : alikeIn(engine.columns, end, 0.5 * about.radius);
      this.run.value = { ...about, end, alike };
      return this.run.value;
    } catch (error) {
      if (mine === this.asked) this.#fail(error, about.radius);
      return null;
    }
  }

  /**
   * Opens a particle of the run. Of those that are asked for while one is being fetched, only the last is opened.
   * @param {number} particle @param {Partial<Omit<Wish, 'particle'>>} [how]
   */
  async open(particle, { at = 0, picture = null } = {}) {
    if (particle < 0 || particle >= this.count) return;
    this.#wish = { particle, at, picture };
    this.target.value = particle;
    if (this.#isLoading) return;
    this.#isLoading = true;
    const mine = this.asked;
    try {
      while (this.#wish && mine === this.asked) await this.#grant(this.#wish);
    } catch (error) {
      if (mine === this.asked) this.#fail(error, this.run.peek()?.radius ?? 0);
    }
    if (mine === this.asked) this.#isLoading = false;
  }

  /** @param {Wish} wish */
  async #grant({ particle, at, picture }) {
    this.#wish = null;
    const run = this.run.peek();
    const { client, asked } = this;
    if (!run || !client) return;
    const radius = run.adaptive ? run.end.radii[particle] : run.radius;
    const opened = await openParticle(client, { end: run.end, radius }, particle);
    if (asked !== this.asked) return;
    const last = Math.max(0, opened.events.length - 1);
    batch(() => {
      this.opened.value = { ...opened, picture };
      this.at.value = at === 'last' ? last : Math.min(at, last);
      this.status.value = { kind: 'ready' };
    });
    this.engine.turnTo(opened.normal);
  }

  #next() {
    this.asked += 1;
    this.#wish = null;
    this.#isLoading = false;
    return this.asked;
  }

  /** @param {any} error @param {number} radius */
  #fail(error, radius) {
    const words = error instanceof Error ? error.message : String(error);
    if (error?.kind === 'given_up') return;
    if (error?.kind === 'crashed' || error?.kind === 'bundle') this.run.value = null;
    this.opened.value = null;
    const excess = error?.fault?.excess;
    if (excess) {
      const sizes = this.engine.columns.adaptive ? 'these sizes' : `the radius ${formatSignificant(radius, 3)}`;
      this.status.value = {
        kind: 'too_many',
        text: [
          `With ${sizes} about ${plural(excess.expected, 'particle')} are to be expected.`,
          `The events of at most ${formatCount(excess.limit)} are followed.`,
        ].join(' '),
        radius: radius * Math.max(LEAST_COARSER, excess.factor),
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

  get #last() {
    return Math.max(0, (this.opened.peek()?.events.length ?? 0) - 1);
  }

  /** @param {number} at */
  seek(at) {
    this.at.value = clamp(at, 0, this.#last);
  }

  /** Ends the worker and frees its memory. */
  close() {
    this.#next();
    this.rest.close();
    this.client?.close();
    this.client = null;
    batch(() => {
      this.opened.value = null;
      this.run.value = null;
    });
  }
}
