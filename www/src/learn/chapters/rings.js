/** The front growing ring by ring. */
import { h, live } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { offerNumber } from '../drag.js';
import { isClosed, RING, ringsOf } from '../measure.js';
import { createChart, createPlay, createRangeRow } from '../parts.js';
import { byLevel, Orbit, Picture, rangeOf } from '../picture.js';

/** @import { Context } from '../types.js' */

/** Time for the growth of the whole front. */
const GROWTH_MS = 4500;

/** Creates the figure of the rings, with a bar for each after its prediction was made. @param {Context} context */
export async function rings(context) {
  const run = await (await context.lab).run({}, { keep: true });
  const { placed } = run;
  const orbit = new Orbit();
  orbit.fitTo(placed);
  orbit.faceFront(placed);
  const sizes = ringsOf(placed);
  /** Number of particles up to each level of the first front. */
  const counts = sizes.map((_, level) => sizes.slice(0, level + 1).reduce((sum, size) => sum + size, 0));
  const picture = new Picture(orbit, { name: 'The rings of the front around the seed' });
  const range = createRangeRow({
    name: 'Level',
    max: counts.length - 1,
    // The ring in the question.
    value: Math.min(RING, counts.length - 1),
    say: (level) => `${formatCount(level)} of ${formatCount(counts.length - 1)}`,
    change: (level) => show(level),
  });
  /** @param {number} level */
  function show(level) {
    const particles = rangeOf(placed, 0, counts[level]);
    const body = rangeOf(placed, counts[level]);
    picture.show({ particles, body, isClosed: isClosed(run), colours: byLevel(particles, counts.length - 1) });
    if (isMounted) orbit.follow(placed, level);
  }
  let isMounted = false;
  show(range.get());
  isMounted = true;
  const play = createPlay(range, { label: 'Grow', totalMs: GROWTH_MS });
  offerNumber('rings', {
    name: 'Ring',
    scale: { min: 0, max: counts.length - 1, step: 1 },
    value: () => range.place.value,
    say: formatCount,
    stage: () => picture.element.closest('.stage'),
    change(level) {
      play.stop();
      range.set(level);
    },
  });
  const words = () => {
    const level = range.place.value;
    const flat = level === 0 ? '' : ` On a plane: ${formatCount(6 * level)}.`;
    return `Level ${formatCount(level)}: ${plural(sizes[level] ?? 0, 'new particle')}.${flat}`;
  };
  const chart = createChart({
    hidden: () => !context.stops.isOpen('predict-ring'),
    chart: () => ({
      kind: 'bars',
      rows: [{ fate: 'new', name: 'new particles', counts: sizes }],
      // Up to the height of the bars.
      guide: sizes.map((_, level) => 6 * level).filter((flat) => flat <= Math.max(...sizes)),
      ends: ['level 0', 'dashed: on a plane, 6k', `level ${formatCount(sizes.length - 1)}`],
      first: 0,
      at: range.place.value,
      format: formatCount,
    }),
    label: `New particles on each level: ${sizes.slice(0, 8).join(', ')}; at most ${Math.max(...sizes)}`,
    words,
    press: range.set,
  });
  // The answer is about this ring.
  live(chart, () => {
    if (context.stops.isOpen('predict-ring')) range.set(Math.min(RING, sizes.length - 1));
  });
  return [picture.element, h('div', { class: 'controls' }, play.element, range.element), chart];
}
