/**
 * Places of the surface that are painted finer or coarser: balls in space, of which each multiplies the spacing. The
 * setting `brush` is their text, and the core is given a formula of the spacing in its place.
 *
 * @module
 */
import { distance } from './vector.js';

/** @import { Bounds, Dab, Settings, Vec3 } from './types.js' */

/** Largest number of dabs. Their formula then takes about three quarters of the bytes that a formula may have. */
export const MOST_DABS = 64;
/** Smallest and largest factor of a dab. */
const [LEAST_TIMES, MOST_TIMES] = [1 / 16, 16];
/** Share of a dab's reach squared, up to which its factor holds in full; it ends smoothly at the whole. */
const CORE = 0.2;
/** Share of a dab's reach within which another one of that size or more replaces it. */
const SAME = 0.35;
/** Steps of a dab's coordinates within its reach. */
const STEPS = 50;

/**
 * Reads the setting; null if it is not one.
 * @param {unknown} text @returns {Dab[] | null}
 */
export function readDabs(text) {
  if (text === undefined || text === '') return [];
  if (typeof text !== 'string') return null;
  const rows = text.split(';');
  if (rows.length > MOST_DABS) return null;
  const dabs = rows.map((row) => {
    const words = row.trim().split(/\s+/);
    const [x, y, z, reach, times] = words.map(Number);
    const isDab = words.length === 5 && [x, y, z].every(Number.isFinite) && reach > 0 && reach < Infinity;
    if (!isDab || !(times >= LEAST_TIMES && times <= MOST_TIMES)) return null;
    return { at: /** @type {Vec3} */ ([x, y, z]), reach, times };
  });
  return dabs.every((dab) => dab !== null) ? dabs : null;
}

/** Writes the setting. @param {readonly Dab[]} dabs */
export const writeDabs = (dabs) => dabs.map(({ at, reach, times }) => [...at, reach, times].join(' ')).join(';');

/**
 * A dab with coordinates that are short in a link and in the formula.
 * @param {Vec3} at @param {number} reach @param {number} times
 * @returns {Dab}
 */
export function dabAt(at, reach, times) {
  const digits = Math.ceil(Math.log10(STEPS / reach));
  const step = 10 ** -digits;
  const short = (/** @type {number} */ v) => Number((Math.round(v / step) * step).toPrecision(12)) + 0;
  return { at: [short(at[0]), short(at[1]), short(at[2])], reach: Number(reach.toPrecision(3)), times };
}

/**
 * The dabs with a stroke over them: a new one replaces those that it would cover. Those beyond {@link MOST_DABS} are
 * left out.
 * @param {readonly Dab[]} dabs @param {readonly Dab[]} stroke
 */
export function withStroke(dabs, stroke) {
  const isCovered = (/** @type {Dab} */ { at, reach }) =>
    stroke.some((over) => over.reach >= reach && distance(over.at, at) < SAME * over.reach);
  return [...dabs.filter((dab) => !isCovered(dab)), ...stroke].slice(0, MOST_DABS);
}

/**
 * The dabs whose middle is not within reach of a place.
 * @param {readonly Dab[]} dabs @param {Vec3} at @param {number} reach
 */
export const without = (dabs, at, reach) => dabs.filter((dab) => distance(dab.at, at) >= reach);

/**
 * The formula of a spacing with dabs over it, the later over the earlier ones. In the middle of a dab the spacing is
 * that of `base`, times its factor.
 * @param {string} base  the formula without them @param {readonly Dab[]} dabs
 */
export function spacingWith(base, dabs) {
  const code = base.replace(/\/\*[\s\S]*?(\*\/|$)|(\/\/|#).*/g, ' ').replace(/[\s;]+$/, '');
  const end = Math.max(code.lastIndexOf(';'), code.lastIndexOf('\n')) + 1;
  const share = '((x-a)^2+(y-b)^2+(z-c)^2)/r^2';
  const rows = dabs.map(({ at, reach, times }, k) => {
    const before = k === 0 ? 0 : `dab${k}`;
    return `dab${k + 1}=dab(${[...at, reach, Number(Math.log2(times).toPrecision(4)), before].join(',')});`;
  });
  return [
    code.slice(0, end),
    `dab(a,b,c,r,t,s)=s+(t-s)*(1-smoothstep(${CORE},1,${share}));`,
    ...rows,
    `(${code.slice(end).trim()})*2^dab${dabs.length}`,
  ].join('');
}

/** Whether what is painted has an effect: sizes by the curvature are not painted. @param {Settings} settings */
export const canPaint = ({ sampling }) => sampling !== 'adaptive';

/**
 * The settings as the core takes them, in the box of the run: with the formula of what is painted.
 * @param {Settings} settings  complete ones @param {Bounds} bounds
 * @returns {Settings}
 */
export function painted({ brush, ...settings }, { min, max }) {
  const dabs = readDabs(brush) ?? [];
  if (dabs.length === 0 || !canPaint(settings)) return settings;
  // With a count the formula gives proportions alone.
  const usual = settings.size_mode === 'count' ? 1 : 2 * Number(settings.radius_share) * distance(min, max);
  return { ...settings, spacing: spacingWith(String(settings.spacing || usual), dabs) };
}
