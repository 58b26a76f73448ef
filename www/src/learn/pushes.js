/** The pushes on one particle in a relaxation step, seen from above: that of each neighbour, and their sum. */
import { along, cross, distance, dot, size, triple, unit } from '../engine/vector.js';
import { inPlane } from '../figures/geometry.js';
import { label, line, ring } from '../figures/svg.js';
import { h, s } from '../ui/dom.js';
import { formatCount, formatFixed, formatSignificant, plural } from '../ui/format.js';

/** @import { LessonParticles, LessonPush, Vec3 } from '../engine/types.js' */
/** @import { Point } from '../figures/types.js' */

/** Half size of the drawing, in radii. */
const HALF = 3.9;
/** Length of the strongest push, in radii: its arrow ends before the particle that it pushes. */
const STRONGEST = 1.8;
/** Sides of an arrow's head, in radii. */
const HEAD = [0.3, 0.15];

/**
 * Returns the drawing with its words.
 * @param {{ before: LessonParticles, after: LessonParticles }} step
 * @param {number} particle @param {readonly LessonPush[]} pushes  on that particle
 */
export function pushesOn({ before, after }, particle, pushes) {
  const { positions, normals, radii } = before;
  const [centre, normal] = [triple(positions, particle), triple(normals, particle)];
  const flat = (/** @type {readonly number[]} */ v) => along(v, normal, -dot(v, normal));
  const forces = pushes.map(({ force }) => flat(force));
  /** @type {Vec3} */
  const none = [0, 0, 0];
  const sum = forces.reduce((all, force) => along(all, force, 1), none);
  const strongest = Math.max(...forces.map(size));
  const nearest = pushes.reduce((a, b) => (b.distance < a.distance ? b : a));
  const right = unit(flat(along(triple(positions, nearest.particle), centre, -1)));
  const plane = { centre, right, up: cross(normal, right), radius: radii[particle] };
  const arrow = (/** @type {string} */ kind, /** @type {Point} */ from, /** @type {Vec3} */ force) => {
    const scale = STRONGEST / strongest;
    return arrowOf(kind, from, [scale * dot(force, plane.right), scale * dot(force, plane.up)]);
  };
  const places = pushes.map((push) => inPlane(plane, triple(positions, push.particle)));
  const share = formatFixed((100 * size(sum)) / strongest, 0);
  const move = distance(centre, triple(after.positions, particle)) / radii[particle];
  const words = `${plural(pushes.length, 'neighbour')} push particle ${formatCount(particle)}. Their pushes add up to ${share} % of the strongest, and move it by ${formatSignificant(move, 2)} r in this step. Where neighbours stand evenly around it, their pushes cancel.`;
  const svg = s('svg', {
    class: 'drawing pushes',
    viewBox: `${-HALF} ${-HALF} ${2 * HALF} ${2 * HALF}`,
    role: 'img',
    'aria-label': `The pushes on one particle from above. ${words}`,
  });
  svg.append(
    ...places.map((at) => ring('disc', at, 1)),
    ring('self', [0, 0], 1),
    ...places.map((at, k) => arrow('push', at, forces[k])),
    arrow('sum', [0, 0], sum),
    label('number', [0, -0.6], formatCount(particle)),
  );
  const [drawing, told] = [h('div', { class: 'drawing-box' }, svg), h('p', { 'aria-live': 'polite' }, words)];
  return h('div', { class: 'two' }, drawing, told);
}

/** @param {string} kind @param {Point} from @param {Point} way */
function arrowOf(kind, [x, y], [dx, dy]) {
  const length = Math.hypot(dx, dy) || 1;
  const head = HEAD.map((side) => (Math.min(1, length / HEAD[0]) * side) / length);
  const [endX, endY] = [x + dx, y + dy];
  const corner = (/** @type {1 | -1} */ side) =>
    /** @type {Point} */ ([endX - head[0] * dx - side * head[1] * dy, endY - head[0] * dy + side * head[1] * dx]);
  return line(kind, [[x, y], [endX, endY], corner(1), [endX, endY], corner(-1)]);
}
