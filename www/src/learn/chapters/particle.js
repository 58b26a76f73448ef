/** The chapter on who was first: the tangent plane of a particle event by event, and the fates of all children. */
import { computed, signal } from '@preact/signals-core';
import { tangentPlane } from '../../figures/drawings.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle } from '../../figures/particle.js';
import { fateShape } from '../../figures/svg.js';
import { FATES, tell } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, queryAll, s } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { createTolerance } from '../drag.js';
import { reasonOf } from '../figure.js';
import { latest } from '../latest.js';
import { createChart, createRange } from '../parts.js';

/**
 * @import { Opened } from '../../figures/types.js'
 * @import { Context, LabRun } from '../types.js'
 */

/** The match tolerance of the lesson. */
const USUAL_TOLERANCE = 0.7;
/** The fates that are explained in any case. */
const USUAL_FATES = ['parent', 'added', 'matched'];

/** The shapes of fates in words. @param {Opened} opened */
function keyOf({ events }) {
  const met = events.flatMap((event) => (event.type === 'fate' ? [event.fate] : []));
  return h(
    'ul',
    { class: 'key' },
    [...new Set([...USUAL_FATES, ...met])].map((fate) => {
      const svg = s('svg', { class: 'shape', viewBox: '-1.4 -1.4 2.8 2.8', 'aria-hidden': 'true' });
      svg.append(fateShape(fate, [0, 0], 1));
      return h('li', null, svg, FATES[fate]);
    }),
  );
}

/** Steps through the events of a particle. @param {Opened} opened @param {number} at  the event that is shown first */
function stepThrough(opened, at) {
  const drawing = h('div', { class: 'drawing-box' });
  const told = h('p', { class: 'told', 'aria-live': 'polite' });
  const { events, subject } = opened;
  const last = events.length - 1;
  const show = (/** @type {number} */ to) => {
    const moment = momentAt(events, to);
    fill(drawing, tangentPlane(opened, moment));
    told.textContent = tell(moment, subject);
  };
  const range = createRange({
    name: 'Event',
    max: last,
    value: at < 0 ? last : at,
    say: (to) => `${formatCount(to + 1)} of ${formatCount(last + 1)}`,
    change: show,
  });
  show(range.get());
  const step = (/** @type {number} */ by, /** @type {string} */ label, /** @type {'back' | 'forward'} */ name) =>
    button({
      class: 'square',
      icon: name,
      'aria-label': label,
      press: () => range.set(Math.min(last, Math.max(0, range.get() + by))),
    });
  const controls = h(
    'div',
    { class: 'controls' },
    step(-1, 'Event back', 'back'),
    step(1, 'Event forward', 'forward'),
    range.element,
  );
  return { drawing, told, controls };
}

/**
 * Charts the fates of the children, level by level.
 * @param {{ readonly value: LabRun }} run @param {() => boolean} hidden
 */
function fateChart(run, hidden) {
  const levels = computed(() => run.value.chapters.filter((chapter) => chapter.kind === 'level'));
  const countsOf = (/** @type {'added' | 'matched'} */ fate) => levels.value.map(({ fates }) => fates[fate]);
  const total = (/** @type {'added' | 'matched'} */ fate) =>
    formatCount(countsOf(fate).reduce((sum, count) => sum + count, 0));
  return createChart({
    hidden,
    chart: () => ({
      kind: 'bars',
      rows: /** @type {const} */ (['added', 'matched']).map((fate) => ({ fate, name: fate, counts: countsOf(fate) })),
      first: 0,
      at: null,
      format: formatCount,
      ends: ['level 0', `level ${formatCount(levels.value.length - 1)}`],
    }),
    label: () => `Children of each level: in the whole run ${total('added')} added and ${total('matched')} matched`,
    words: () =>
      `Children by level: ${total('added')} added below, ${total('matched')} matched above. Parents are not counted.`,
  });
}

/** A particle amid the front, and the fates of all children. @param {Context} context */
export async function whoWasFirst({ lab, stops }) {
  const own = await lab;
  const usual = await own.coarse();
  const run = signal(usual);
  const tolerance = signal(USUAL_TOLERANCE);
  const place = h('div', { class: 'two' });
  const runAt = async (/** @type {number} */ to) =>
    to === USUAL_TOLERANCE ? usual : own.run({ ...usual.settings, match_tolerance: to }, { keep: true });
  /** The particle that is shown, as a share of all. */
  let share = 0.5;
  const status = h('p', { class: 'figure-status', role: 'status' });
  const show = latest(async (/** @type {number} */ to, isOld) => {
    const next = await runAt(to).catch((error) => {
      status.textContent = reasonOf(error);
      return null;
    });
    if (!next) return;
    const old = isOld() ? next : run.peek();
    if (!isOld()) {
      run.value = next;
      status.textContent = '';
      const opened = await openParticle(next.client, next, Math.floor(share * next.end.radii.length));
      // The chapter is about comparing, so the drawing begins with the comparison of the first child.
      const first = opened.events.findIndex(({ type }) => type === 'compared');
      const { drawing, told, controls } = stepThrough(opened, first);
      fill(place, drawing, h('div', { class: 'side' }, told, controls, keyOf(opened)));
    }
    if (old !== usual && old !== run.peek()) own.drop(old);
  });
  await show(tolerance.peek());
  const next = () => {
    const count = run.peek().end.radii.length;
    share = ((Math.floor(share * count) + 7.5) / count) % 1;
    void show(tolerance.peek());
  };
  const turn = (/** @type {number} */ to) => {
    if (to === tolerance.peek()) return;
    tolerance.value = to;
    void show(to);
  };
  for (const words of queryAll(document, '[data-number="tolerance"]'))
    words.replaceWith(createTolerance(() => tolerance.value, turn));
  return [
    h(
      'div',
      { class: 'controls choices' },
      button({ press: next }, 'Another particle'),
      h('span', null, () => `of ${plural(run.value.end.radii.length, 'particle')}`),
    ),
    place,
    status,
    fateChart(run, () => !stops.isOpen('predict-average')),
  ];
}
