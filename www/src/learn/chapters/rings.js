/** The front growing ring by ring. */
import { h, live } from '../../ui/dom.js';
import { formatCount, plural } from '../../ui/format.js';
import { offerNumber } from '../drag.js';
import { isClosed, RING, ringsOf } from '../measure.js';
import { createChart, createPlay, createRangeRow } from '../parts.js';
import { byLevel, Orbit, Picture } from '../picture.js';

/**
 * @import { LessonParticles } from '../../engine/types.js'
 * @import { Context } from '../types.js'
 */

/** Time for the growth of the whole front. */
const GROWTH_MS = 4500;

/** Number of particles up to each level. @param {LessonParticles} particles */
function countsOf({ levels }) {
  const last = levels.reduce((most, level) => Math.max(most, level), 0);
  return Array.from({ length: last + 1 }, (_, level) => levels.reduce((sum, own) => sum + (own <= level ? 1 : 0), 0));
}

/** The particles on some levels. @param {LessonParticles} all @param {(level: number) => boolean} isKept */
function onLevels(all, isKept) {
  const kept = [...all.levels.keys()].filter((i) => isKept(all.levels[i]));
  const vectors = (/** @type {Float32Array} */ column) =>
    Float32Array.from(kept.flatMap((i) => [column[3 * i], column[3 * i + 1], column[3 * i + 2]]));
  return {
    ...all,
    positions: vectors(all.positions),
    normals: vectors(all.normals),
    radii: Float32Array.from(kept, (i) => all.radii[i]),
    levels: Uint32Array.from(kept, (i) => all.levels[i]),
  };
}

/** Creates the figure of the rings, with a bar for each after its prediction was made. @param {Context} context */
export async function rings(context) {
  const run = await (await context.lab).run({}, { keep: true });
  const { placed } = run;
  const orbit = new Orbit();
  orbit.fitTo(placed);
  orbit.faceFront(placed);
  const counts = countsOf(placed);
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
    const particles = onLevels(placed, (own) => own <= level);
    const body = onLevels(placed, (own) => own > level);
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
  const sizes = ringsOf(placed);
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
