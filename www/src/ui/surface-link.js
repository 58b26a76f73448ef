/**
 * A surface in the learn page's address: its formula, parameters and box, and the link back to the page that it comes
 * from. An address can contain anything, so every part of it is checked.
 */
import { MOST_PARAMETERS } from '../engine/constants.js';
import { fromBase64url, toBase64url } from '../engine/share/base64url.js';

/** @import { Vec3 } from '../engine/types.js' */
/** @import { FormulaSurface } from './types.js' */

/**
 * The surface that a link passes on. `surface` is null if it comes from points, which no address can hold; `from` is
 * the fragment of the page's own address.
 * @typedef {{ surface: FormulaSurface | null, from: string }} Carried
 */

/** Describes a surface. @param {Pick<FormulaSurface, 'formula' | 'parameters'>} surface */
export const surfaceWords = ({ formula, parameters }) =>
  [formula, ...parameters.map(({ name, value }) => `${name} = ${value}`)].join(', ');

/** Longest text that is read: longer than the longest formula with all parameters. */
const LONGEST = 65_536;

/** Encodes plain data for an address. @param {unknown} data */
export const packed = (data) => toBase64url(new TextEncoder().encode(JSON.stringify(data)));

/** Decodes the output of `packed`; null if it is damaged. @param {string} text @returns {any} */
export function unpacked(text) {
  if (text.length > LONGEST) return null;
  try {
    return JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(fromBase64url(text)));
  } catch {
    return null;
  }
}

/** @param {Carried} carried */
export function packCarried({ surface, from }) {
  const parameters = Object.fromEntries((surface?.parameters ?? []).map(({ name, value }) => [name, value]));
  return packed(surface ? { formula: surface.formula, parameters, bounds: surface.bounds, from } : { from });
}

/**
 * A particle for the lesson to explain: where it was placed, its radius, and the seeds of the picture.
 * @typedef {{ place: Vec3, radius: number, seeds: Vec3[] }} Explained
 */

/** With more seeds than these none is passed on, and the lesson finds its own. */
const MOST_SEEDS = 24;

/** @param {Explained} particle */
export const packParticle = ({ place, radius, seeds }) =>
  packed({ place, radius, seeds: seeds.length <= MOST_SEEDS ? seeds : [] });

/** Reads a particle from an address; null if the text is invalid. @param {string} text */
export function unpackParticle(text) {
  const raw = unpacked(text);
  if (!isVector(raw?.place) || !(Number(raw.radius) > 0) || !Array.isArray(raw.seeds)) return null;
  const seeds = raw.seeds.slice(0, MOST_SEEDS);
  return seeds.every(isVector)
    ? /** @type {Explained} */ ({ place: raw.place, radius: Number(raw.radius), seeds })
    : null;
}

/** @param {unknown} v @returns {v is [number, number, number]} */
const isVector = (v) => Array.isArray(v) && v.length === 3 && v.every(Number.isFinite);

/** @param {string} text @returns {Carried | null} */
export function unpackCarried(text) {
  const raw = unpacked(text);
  if (typeof raw !== 'object' || raw === null) return null;
  const from = typeof raw.from === 'string' && /^#v\d+\.[jz]\.[\w-]*$/.test(raw.from) ? raw.from : '';
  if (raw.formula === undefined) return { surface: null, from };
  const { formula, bounds } = raw;
  const values = Object.entries(raw.parameters ?? {}).slice(0, MOST_PARAMETERS);
  const isWhole =
    typeof formula === 'string' &&
    isVector(bounds?.min) &&
    isVector(bounds?.max) &&
    [0, 1, 2].every((k) => bounds.min[k] < bounds.max[k]) &&
    values.every(([, value]) => Number.isFinite(value));
  if (!isWhole) return null;
  const parameters = values.map(([name, value]) => {
    const number = Number(value);
    return { name, label: name, value: number, min: Math.min(0, number), max: Math.max(1, number), step: 0.01 };
  });
  return { surface: { formula, parameters, bounds: { min: bounds.min, max: bounds.max } }, from };
}
