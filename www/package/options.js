/**
 * Checks what a program gives `sample`, and turns it into what is sent to the sampler.
 *
 * @module
 */
import { InputError } from './errors.js';

/**
 * @import { Batch, Options } from './index.js'
 * @import { SentField } from './protocol.js'
 */

/** A value as an error names it. @param {unknown} value */
export const shown = (value) => (typeof value === 'string' ? `“${value.slice(0, 40)}”` : String(value));

/** @type {(name: string, value: unknown, is: (v: number) => boolean, what: string) => number} */
function number(name, value, is, what) {
  if (typeof value === 'number' && Number.isFinite(value) && is(value)) return value;
  throw new InputError(`${name}: ${what}, not ${shown(value)}.`);
}

/** @param {string} name @param {unknown} value @param {readonly string[]} choices */
function choice(name, value, choices) {
  if (choices.includes(/** @type {string} */ (value))) return /** @type {string} */ (value);
  throw new InputError(`${name}: one of ${choices.join(', ')}, not ${shown(value)}.`);
}

/**
 * Values of parameters by name.
 * @param {unknown} params @param {string[]} [known]  the names in the formula, where it has been read
 */
export function paramsOf(params, known) {
  if (typeof params !== 'object' || params === null || Array.isArray(params))
    throw new InputError(`params: an object with a number for each name, not ${shown(params)}.`);
  for (const [name, value] of Object.entries(params)) number(`params.${name}`, value, () => true, 'a number');
  const unknown = known && Object.keys(params).find((name) => !known.includes(name));
  if (known && unknown !== undefined)
    throw new InputError(`params.${unknown}: there is no such parameter. There are ${known.join(', ') || 'none'}.`);
  return /** @type {Record<string, number>} */ (params);
}

/** @param {unknown} bounds */
function boundsOf(bounds) {
  const { min, max } = /** @type {{min: number[], max: number[]}} */ (bounds ?? {});
  const isPoint = (/** @type {unknown} */ p) => Array.isArray(p) && p.length === 3 && p.every(Number.isFinite);
  if (!isPoint(min) || !isPoint(max) || min.some((v, k) => v >= max[k]))
    throw new InputError('bounds: {min: [x, y, z], max: [x, y, z]} with numbers and min below max.');
  return {
    min: /** @type {[number, number, number]} */ ([...min]),
    max: /** @type {[number, number, number]} */ ([...max]),
  };
}

const SIZES = ['count', 'radius', 'spacing'];
const KNOWN = [
  ...SIZES,
  'bounds',
  'beyondPoints',
  'formula',
  'params',
  'adaptive',
  'method',
  'seed',
  'measure',
  'signal',
  'onProgress',
];

/** @param {Pick<Options, 'signal' | 'onProgress'>} options */
export function checkedCalls({ signal, onProgress }) {
  if (signal !== undefined && !(signal instanceof AbortSignal))
    throw new InputError('signal: the signal of an AbortController.');
  if (onProgress !== undefined && typeof onProgress !== 'function') throw new InputError('onProgress: a function.');
  return { signal, onProgress };
}

/** @param {string} name @param {unknown} value */
function flag(name, value) {
  if (typeof value !== 'boolean') throw new InputError(`${name}: true or false, not ${shown(value)}.`);
  return value;
}

/**
 * Three numbers for each of some points, in double precision.
 * @param {string} name @param {unknown} value
 */
function vectors(name, value) {
  const isArray = Array.isArray(value) || value instanceof Float32Array || value instanceof Float64Array;
  const all = isArray ? Float64Array.from(value) : null;
  if (all === null || all.length === 0 || all.length % 3 !== 0)
    throw new InputError(`${name}: an array of numbers, x, y and z of each point.`);
  const wrong = all.findIndex((v) => !Number.isFinite(v));
  if (wrong >= 0) throw new InputError(`${name}[${wrong}]: a number, not ${shown(all[wrong])}.`);
  return all;
}

/** @param {{points: unknown, normals?: unknown}} given */
function cloudOf({ points, normals }) {
  const cloud = {
    points: vectors('points', points),
    normals: normals === undefined ? null : vectors('normals', normals),
  };
  if (cloud.normals && cloud.normals.length !== cloud.points.length)
    throw new InputError(
      `normals: one for each point, not ${cloud.normals.length / 3} for ${cloud.points.length / 3}.`,
    );
  return cloud;
}

const FIELD =
  "a formula such as 'x^2 + y^2 + z^2 = 1', a function (x, y, z) => number, {batch(xyz, out)} or {points, normals}";

/** @param {unknown} field @returns {Pick<SentField, 'formula' | 'cloud' | 'program'>} */
function fieldOf(field) {
  if (typeof field === 'string') return { formula: field };
  if (typeof field === 'function')
    return { program: /** @type {(x: number, y: number, z: number) => number} */ (field) };
  const given = /** @type {Partial<Batch> & {points?: unknown, normals?: unknown}} */ (field ?? {});
  if (typeof given.batch === 'function') return { program: /** @type {Batch} */ (given) };
  if (given.points !== undefined) return { cloud: cloudOf({ ...given, points: given.points }) };
  throw new InputError(`field: ${FIELD}, not ${shown(typeof field)}.`);
}

/**
 * The size of the particles, as settings of the core.
 * @param {Options} options @returns {Record<string, number | string>}
 */
function sizeOf(options) {
  const [first, second] = SIZES.filter((name) => options[/** @type {keyof Options} */ (name)] !== undefined);
  if (second) throw new InputError(`${first}, ${second}: one of the two, not both.`);
  if (options.adaptive === true && first !== 'count') {
    // The curvature gives the size.
    if (first === undefined) return {};
    throw new InputError(`${first}: for particles of one size. Adaptive ones take a count, or no size.`);
  }
  const { count = 20_000, radius, spacing } = options;
  if (radius !== undefined) {
    const isShare = (/** @type {number} */ r) => r >= 0.0001 && r <= 0.2;
    return { radius_share: number('radius', radius, isShare, 'a share of the box diagonal, 0.0001 to 0.2') };
  }
  // The core has radii, half of the distance between neighbours.
  if (spacing !== undefined)
    return { radius: 0.5 * number('spacing', spacing, (s) => s > 0, 'a length above 0, in the units of the field') };
  const isCount = (/** @type {number} */ n) => Number.isInteger(n) && n >= 1 && n <= 4_000_000;
  return { size_mode: 'count', count: number('count', count, isCount, 'a whole number from 1 to 4,000,000') };
}

/**
 * The formula in which the surface of points is an operand.
 * @param {unknown} formula @param {{cloud?: unknown}} what
 */
function modelFormula(formula, { cloud }) {
  if (cloud === undefined)
    throw new InputError('formula: for points, whose surface it names model. Else the formula is the field.');
  if (typeof formula === 'string') return { formula };
  throw new InputError(`formula: a text such as 'max(model, z)', not ${shown(formula)}.`);
}

/**
 * What the sampler is asked for.
 * @param {unknown} field @param {Options} options
 */
export function checked(field, options) {
  const what = fieldOf(field);
  if (typeof options !== 'object' || options === null)
    throw new InputError(`options: an object, not ${shown(options)}.`);
  const unknown = Object.keys(options).find((name) => !KNOWN.includes(name));
  if (unknown !== undefined)
    throw new InputError(`${unknown}: there is no such option. There are ${KNOWN.join(', ')}.`);
  const { beyondPoints, bounds, formula, params, adaptive = false, method, seed, measure = true } = options;
  /** @type {Record<string, number | string>} */
  const settings = { max_particles: 4_400_000, ...sizeOf(options) };
  if (flag('adaptive', adaptive)) settings.sampling = 'adaptive';
  if (method !== undefined) settings.method = choice('method', method, ['front', 'refined']);
  if (seed !== undefined)
    settings.seed = number('seed', seed, (n) => Number.isSafeInteger(n) && n >= 0, 'a whole number from 0 on');
  if (beyondPoints !== undefined) {
    if (what.cloud === undefined)
      throw new InputError('beyondPoints: for points, beyond which their surface may go on.');
    settings.beyond_points = choice('beyondPoints', beyondPoints, ['cut', 'kept']);
  }
  if (formula !== undefined) Object.assign(what, modelFormula(formula, what));
  if (params !== undefined && what.formula === undefined)
    throw new InputError('params: a formula has parameters, a function or points have none.');
  /** @type {SentField} */
  const request = {
    ...what,
    parameters: params === undefined ? {} : paramsOf(params),
    ...(bounds === undefined ? {} : { bounds: boundsOf(bounds) }),
  };
  return { request, settings, measure: flag('measure', measure), ...checkedCalls(options) };
}
