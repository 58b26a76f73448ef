/** Marks the place of a figure pressed in the report: two particles, a hole, or an open border. */

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Mark } from '../types.js'
 */

const LEAST_RING_PX = 7;
const LABEL_PX = 14;

/** @param {Engine} engine @returns {Mark} */
export function spotMark(engine) {
  return {
    shown: () => engine.spot.value !== null,
    draw(pen) {
      const { places, radius, text, outline } = engine.spot.value ?? { places: [], radius: 0, text: '' };
      const spots = places.flatMap((place) => engine.project(place) ?? []);
      if (outline) {
        pen.polygon(places, 'marked');
        const top = spots.reduce((best, spot) => (spot.y < best.y ? spot : best), spots[0]);
        if (top) pen.text({ x: top.x, y: top.y - LABEL_PX }, text, 'figure strong');
        return;
      }
      for (const spot of spots) pen.ring(spot, Math.max(LEAST_RING_PX, radius / spot.perPx), 'marked');
      if (spots.length === 2) pen.line(spots[0], spots[1], 'marked');
      const top = spots.reduce((best, spot) => (spot.y < best.y ? spot : best), spots[0]);
      if (top) pen.text({ x: top.x, y: top.y - radius / top.perPx - LABEL_PX }, text, 'figure strong');
    },
  };
}
