/** The chapter on who was first: the tangent plane of a particle event by event, and the fates of all children. */

import { tangentPlane } from '../../figures/drawings.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle } from '../../figures/particle.js';
import { fateShape } from '../../figures/svg.js';
import { FATES, tell } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, s } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { createChart, createRange } from '../parts.js';

/**
 * @import { Opened } from '../../figures/types.js'
 * @import { Context, LabRun } from '../types.js'
 */

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

/** Charts the fates of the children, level by level. @param {LabRun} run @param {() => boolean} hidden */
function fateChart(run, hidden) {
  const levels = run.chapters.filter((chapter) => chapter.kind === 'level');
  const rows = /** @type {const} */ (['added', 'matched']).map((fate) => ({
    fate,
    name: fate,
    counts: levels.map(({ fates }) => fates[fate]),
  }));
  const totals = rows.map(({ counts }) => formatCount(counts.reduce((sum, count) => sum + count, 0)));
  return createChart({
    hidden,
    chart: () => ({
      kind: 'bars',
      rows,
      first: 0,
      at: null,
      format: formatCount,
      ends: ['level 0', `level ${formatCount(levels.length - 1)}`],
    }),
    label: `Children of each level: in the whole run ${totals[0]} added and ${totals[1]} matched`,
    words: `Children by level: ${totals[0]} added below, ${totals[1]} matched above. Parents are not counted.`,
  });
}

/** A particle amid the front, and the fates of all children. @param {Context} context */
export async function whoWasFirst({ lab, stops }) {
  const run = await (await lab).coarse();
  const place = h('div', { class: 'two' });
  const count = run.end.radii.length;
  let particle = Math.floor(count / 2);
  async function show() {
    const opened = await openParticle(run.client, run, particle);
    // The chapter is about comparing, so the drawing begins with the comparison of the first child.
    const first = opened.events.findIndex(({ type }) => type === 'compared');
    const { drawing, told, controls } = stepThrough(opened, first);
    fill(place, drawing, h('div', { class: 'side' }, told, controls, keyOf(opened)));
  }
  await show();
  const next = () => {
    particle = (particle + 7) % count;
    void show();
  };
  return [
    h(
      'div',
      { class: 'controls choices' },
      button({ press: next }, 'Another particle'),
      h('span', null, `of ${plural(count, 'particle')}`),
    ),
    place,
    fateChart(run, () => !stops.isOpen('predict-average')),
  ];
}
