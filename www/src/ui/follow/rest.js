/**
 * Follows the particle that is open through the relaxation: where the timeline stands at a relaxation step, the panel
 * shows who pushes the particle, and where it goes. The run with its steps is another one, made when it is first asked
 * for.
 */

import { computed, signal } from '@preact/signals-core';
import { mostPushed, numbersOfRest, pushersOf, restOf, tellRest } from '../../figures/rest.js';
import { moveLens, restPlane, SCALE_WORDS } from '../../figures/rest-drawings.js';
import { button } from '../button.js';
import { h, live, uniqueId } from '../dom.js';
import { formatCount, formatSignificant } from '../format.js';
import { settingOf, settingsOf } from './run.js';

/**
 * @import { LessonChapter, LessonClient, Signal } from '../../engine/types.js'
 * @import { Rest } from '../../figures/types.js'
 * @import { Children } from '../types.js'
 * @import { Follower, Opened } from './types.js'
 */

/**
 * The state of a relaxation step: null while the timeline stands elsewhere.
 * @typedef {null | { text: string, rest: Rest | null }} RestStatus
 */

export class Relaxation {
  /**
   * The run and its number of steps, so that a change can be told.
   * @type {{ of: object, steps: number, chapters: Promise<LessonChapter[]> } | null}
   */
  #made;
  #asked;

  /** @param {Follower} follower */
  constructor(follower) {
    this.follower = follower;
    /** @type {Signal<RestStatus>} */
    this.status = signal(null);
    /** @type {LessonClient | null} */
    this.client = null;
    this.#made = null;
    this.#asked = 0;
  }

  /** Shows the step at which the timeline stands. @param {HTMLElement} element  as long as it lasts */
  watch(element) {
    const { engine, opened, stale } = this.follower;
    const wanted = computed(() => {
      const { grain, level, step } = engine.state.value.view;
      const isThere = grain === 'level' && level === null && opened.value !== null && !stale.value;
      return isThere ? `${opened.value?.subject.particle} ${step ?? 'last'}` : null;
    });
    live(element, () => {
      const place = wanted.value;
      this.#asked += 1;
      const mine = this.#asked;
      if (place === null) this.status.value = null;
      // While the timeline moves, it may pass another place for a moment.
      else setTimeout(() => mine === this.#asked && void this.#show(place));
    });
  }

  /** @param {string} place */
  async #show(place) {
    const mine = this.#asked;
    const [particle, step] = place.split(' ');
    const usual = Number(settingOf(this.follower.engine, 'relax_steps'));
    const wanted = step === 'last' ? usual : Number(step);
    if (wanted === 0) return;
    if (this.status.peek() === null) this.status.value = { text: 'Running the relaxation', rest: null };
    const told = (/** @type {RestStatus} */ status) => {
      if (mine === this.#asked) this.status.value = status;
    };
    try {
      const chapters = await this.#chapters(Math.max(usual, wanted));
      if (mine !== this.#asked || !this.client) return;
      const rest = await restOf(this.client, chapters, Number(particle), wanted);
      told({ text: rest ? tellRest(rest) : 'This run has no such step.', rest });
    } catch (error) {
      if (/** @type {any} */ (error)?.kind !== 'given_up')
        told({
          text: `The relaxation cannot be shown: ${error instanceof Error ? error.message : error}.`,
          rest: null,
        });
    }
  }

  /** The chapters of the run with its steps, which is made unless it is there. @param {number} steps */
  async #chapters(steps) {
    const { follower } = this;
    const { engine } = follower;
    const run = follower.run.peek();
    const surface = engine.lessonSurface();
    if (!run || !surface) return [];
    if (this.#made?.of === run && this.#made.steps >= steps) return this.#made.chapters;
    this.client ??= await engine.openLesson();
    const { client } = this;
    const chapters = client
      .start(surface, { ...settingsOf(engine, run), relax_steps: steps })
      .then(() => client.ask('chapters', { first: 0 }));
    this.#made = { of: run, steps, chapters };
    chapters.catch(() => {
      this.#made = null;
    });
    return chapters;
  }

  /** Opens the particle that is pushed most in the step that is shown. */
  async openMost() {
    const step = this.status.peek()?.rest?.step;
    const chapters = await this.#made?.chapters.catch(() => []);
    if (!this.client || !chapters || step === undefined) return;
    await this.follower.open(await mostPushed(this.client, chapters, step));
  }

  /** Every step of a particle in words, if the run is there. @param {number} particle */
  async told(particle) {
    const chapters = (await this.#made?.chapters.catch(() => [])) ?? [];
    const words = [];
    for (let step = 1; this.client; step += 1) {
      const rest = await restOf(this.client, chapters, particle, step);
      if (!rest) break;
      words.push(tellRest(rest));
    }
    return words;
  }

  /** Frees the worker. */
  close() {
    this.#asked += 1;
    this.status.value = null;
    this.#made = null;
    this.client?.close();
    this.client = null;
  }
}

/** The views of a step. @param {Follower} follower */
export function createRestViews({ rest, opened }) {
  const shown = computed(() => {
    const [found, particle] = [rest.status.value?.rest, opened.value];
    return found && particle ? { found, particle } : null;
  });
  const part = (/** @type {string} */ title, /** @type {(step: Shown) => Children} */ content) => {
    const id = uniqueId('rest');
    return h(
      'section',
      { class: 'section', 'aria-labelledby': id },
      h('h3', { id, class: 'section-title' }, title),
      h('div', { class: 'follow-view' }, () => shown.value && content(shown.value)),
    );
  };
  return h(
    'div',
    { class: 'follow-rest', hidden: () => !shown.value },
    part('A step of rest', planeOf),
    part('Numbers', ({ found }) => [
      h(
        'dl',
        { class: 'facts' },
        numbersOfRest(found).map(([name, value]) => [h('dt', null, name), h('dd', null, value)]),
      ),
      button({ press: () => void rest.openMost() }, 'Follow the one that is pushed most'),
    ]),
    part('Who pushes', ({ found }) => {
      const words = pushersOf(found);
      return h(
        'ol',
        { class: 'slots', 'aria-label': `${formatCount(words.length)} particles push` },
        words.map((text) => h('li', null, text)),
      );
    }),
  );
}

/** @typedef {{ found: Rest, particle: Opened }} Shown */

/** The step in the tangent plane, with the move enlarged. @param {Shown} shown */
function planeOf({ found, particle }) {
  const frame = particle.events.find(({ type }) => type === 'frame');
  const towards = frame?.type === 'frame' ? frame.u : undefined;
  const lens = moveLens(found, towards);
  const times = lens && formatSignificant(lens.times, 2);
  return [
    restPlane(particle.subject, found, towards),
    h(
      'div',
      { class: 'follow-key' },
      h('p', { class: 'quiet' }, SCALE_WORDS),
      lens &&
        h(
          'div',
          { class: 'lens-box' },
          lens.svg,
          h('p', { class: 'quiet' }, `The move and the landing, enlarged about ${times} times`),
        ),
    ),
  ];
}
