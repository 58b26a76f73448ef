/**
 * Draws the children of the particle that is followed in the picture, and the circle on which the one at hand is looked
 * for.
 */
import { dot } from '../../engine/vector.js';
import { tangentsOf } from '../../figures/geometry.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Child } from '../../figures/types.js'
 * @import { Follower, Pen } from './types.js'
 */

/** Corners of a disc and of the circle. */
const DISC = 24;
const CIRCLE = 64;

/**
 * Returns points of a circle around a place.
 * @param {ArrayLike<number>} centre
 * @param {ArrayLike<number>} a
 * @param {ArrayLike<number>} b  perpendicular unit vectors of its plane
 * @param {number} radius @param {number} corners
 */
export function circleAround(centre, a, b, radius, corners) {
  return Array.from({ length: corners }, (_, k) => {
    const angle = (2 * Math.PI * k) / corners;
    const [x, y] = [radius * Math.cos(angle), radius * Math.sin(angle)];
    return [0, 1, 2].map((j) => centre[j] + x * a[j] + y * b[j]);
  });
}

/** Returns the last known position of a child. @param {Child} child */
const whereIs = ({ landed, iterates, start, pushes }) =>
  landed?.position ?? iterates.at(-1)?.position ?? start?.place ?? pushes.at(-1)?.position ?? null;

/**
 * @param {Engine} engine @param {Follower} follower
 * @returns {{ shown: () => boolean, draw: (pen: Pen) => void }}
 */
export function childrenMark(engine, { opened, moment, hot, stale, rest }) {
  return {
    shown: () => moment.value !== null && !stale.value && rest.status.value === null,
    draw(pen) {
      if (!opened.value || !moment.value) return;
      const { subject, place, normal, profiles } = opened.value;
      const { children, slot } = moment.value;
      const { eye } = engine.rayThrough(0, 0);
      const isBehind =
        dot(
          normal,
          [0, 1, 2].map((k) => eye[k] - place[k]),
        ) < 0;
      const side = isBehind ? ' behind' : '';
      const now = hot.value ?? slot;
      const profile = now === null ? null : profiles[now];
      const child = now === null ? undefined : children[now];
      if (profile && child && (child.start || child.iterates.length > 0)) {
        const circle = circleAround(place, profile.direction, profile.normal, profile.reach, CIRCLE);
        pen.polygon(circle, `child-circle${side}`);
      }
      for (const each of children) {
        const where = each.fate === 'parent' ? null : whereIs(each);
        if (!where) continue;
        const [a, b] = tangentsOf(each.landed?.normal ?? normal);
        const size = each.pushes.at(-1)?.radius ?? subject.radius;
        const kind = `child child-${each.fate.replace('_', '-')}${each.slot === now ? ' now' : ''}${side}`;
        pen.polygon(circleAround(where, a, b, size, DISC), kind);
        const spot = engine.project(where);
        if (spot && each.slot === now) pen.text(spot, String(each.slot), `figure strong${side}`);
      }
    },
  };
}
