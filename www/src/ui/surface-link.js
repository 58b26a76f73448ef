/**
 * A surface in the address of the learn page: its formula, its parameters and its box, and the way back to the page
 * from which it comes. What is read from an address may be anything, so every part of it is checked.
 */
import { MOST_PARAMETERS } from '../engine/constants.js';
import { fromBase64url, toBase64url } from '../engine/share/base64url.js';

/** @import { Vec3 } from '../engine/types.js' */
/** @import { FormulaSurface } from './types.js' */

/**
 * The surface that a link hands over. `surface` is null if it comes from points, which no address can hold; `from` is
 * the fragment of the page's own address.
 * @typedef {{ surface: FormulaSurface | null, from: string }} Carried
 */

/** A surface in words. @param {Pick<FormulaSurface, 'formula' | 'parameters'>} surface */
export const surfaceWords = ({ formula, parameters }) =>
  [formula, ...parameters.map(({ name, value }) => `${name} = ${value}`)].join(', ');

/** Longest text that is read: more than a formula of the greatest length with all parameters. */
const LONGEST = 65_536;

/** Writes any plain data for an address. @param {unknown} data */
export const packed = (data) => toBase64url(new TextEncoder().encode(JSON.stringify(data)));

/** Reads what `packed` has written; null if it is damaged. @param {string} text @returns {any} */
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
 * A particle that the lesson is to explain: where it was placed, its radius, and where the fronts of the picture began.
 * @typedef {{ place: Vec3, radius: number, seeds: Vec3[] }} Explained
 */

/** More seeds than these are left out: the lesson finds seeds of its own. */
const MOST_SEEDS = 24;

/** @param {Explained} particle */
export const packParticle = ({ place, radius, seeds }) =>
  packed({ place, radius, seeds: seeds.length <= MOST_SEEDS ? seeds : [] });

/** Reads a particle from an address, where anything may stand; null if it is none. @param {string} text */
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
