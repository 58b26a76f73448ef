/**
 * Checks the arguments of `sample` and turns them into a request to the sampler.
 *
 * @module
 */
import { slipsBetween } from '../src/engine/spelling.js';
import { choice, flag, number, shown, vectors } from './checks.js';
import { InputError } from './errors.js';
import { blobOf, imageOf, isImage, valuesOf } from './image.js';
import { isMesh, meshOf } from './mesh.js';
import { isSolid, leavesOf, solidOf } from './solids.js';

/**
 * @import { Batch, OfPlace, Options, Pieces } from './index.js'
 * @import { Cloud, SentField, SentFunctions, SentPart, Settings } from './protocol.js'
 */

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

const SIZES = ['count', 'spacing', 'radius'];
/** Largest number of particles that can be requested. */
const MOST = 4_000_000;

const isPositive = (/** @type {number} */ v) => v > 0;
const isWhole = (/** @type {number} */ n) => Number.isSafeInteger(n) && n >= 0;
const A_SIZE = "a length above 0, or a share of the box diagonal such as '1%'";

const A_SPACING =
  "a length above 0, a share of the box diagonal such as '1%', a formula such as '0.02 + 0.1 hypot(x, y)' or a " +
  'function (x, y, z) => number';

/**
 * Whether a value is a function of a point, as a formula or in the program.
 * @param {unknown} value @returns {value is string | OfPlace}
 */
const isFunction = (value) => typeof value === 'string' || typeof value === 'function';

/**
 * Whether a spacing depends on the place: a text that is no share.
 * @param {unknown} spacing @returns {spacing is string | OfPlace}
 */
export const isVarying = (spacing) =>
  isFunction(spacing) && !(typeof spacing === 'string' && spacing.trim().endsWith('%'));

/** @param {unknown} values @returns {SentFunctions['values']} */
function functionsOf(values) {
  if (typeof values !== 'object' || values === null)
    throw new InputError(`values: an object such as {height: 'z'}, not ${shown(values)}.`);
  const entries = Object.entries(values);
  const [name, value] = entries.find(([, own]) => !isFunction(own)) ?? [];
  if (name !== undefined)
    throw new InputError(`values.${name}: a formula or a function (x, y, z) => number, not ${shown(value)}.`);
  return Object.fromEntries(entries);
}

/**
 * The share that a text such as `0.6%` stands for, rounded once.
 * @param {string} name @param {string} text
 */
function shareOf(name, text) {
  const digits = /^\s*([\d.]+(?:e[+-]?\d+)?)\s*%\s*$/i.exec(text)?.[1];
  return number(name, digits === undefined ? text : Number(`${digits}e-2`), isPositive, A_SIZE);
}

/**
 * The options that are settings of the core: the name of the setting, the kind of its values, and the values of a
 * choice or the value of a flag that is set.
 * @typedef {'count' | 'whole' | 'number' | 'spacing' | 'size' | 'text' | 'choice' | 'flag'} Kind
 * @type {Record<string, {setting: string, kind: Kind, values?: string[]}>}
 */
export const SETTINGS = {
  count: { setting: 'count', kind: 'count' },
  exactly: { setting: 'counting', kind: 'flag', values: ['exactly'] },
  spacing: { setting: 'radius_share', kind: 'spacing' },
  radius: { setting: 'radius_share', kind: 'size' },
  adaptive: { setting: 'sampling', kind: 'flag', values: ['adaptive'] },
  law: { setting: 'radius_law', kind: 'choice', values: ['chord_error', 'max_curvature', 'sum_of_curvatures'] },
  chordError: { setting: 'chord_error', kind: 'size' },
  curvatureScale: { setting: 'curvature_scale', kind: 'number' },
  radiusMin: { setting: 'radius_min_share', kind: 'size' },
  radiusMax: { setting: 'radius_max_share', kind: 'size' },
  grading: { setting: 'grading', kind: 'number' },
  closed: { setting: 'box_faces', kind: 'flag', values: ['closed'] },
  periodic: { setting: 'box_cell', kind: 'flag', values: ['periodic'] },
  thickness: { setting: 'thickness', kind: 'text' },
  method: { setting: 'method', kind: 'choice', values: ['front', 'refined'] },
  pattern: { setting: 'pattern', kind: 'choice', values: ['hexagonal', 'blue', 'random'] },
  relax: { setting: 'relax_steps', kind: 'whole' },
  matchTolerance: { setting: 'match_tolerance', kind: 'number' },
  gaps: { setting: 'gaps', kind: 'choice', values: ['fill', 'leave'] },
  seed: { setting: 'seed', kind: 'whole' },
  maxParticles: { setting: 'max_particles', kind: 'whole' },
  beyondPoints: { setting: 'beyond_points', kind: 'choice', values: ['cut', 'kept'] },
};
/** The options for a formula alone. */
const OF_FORMULAS = ['closed', 'periodic', 'thickness'];
const KNOWN = [
  ...Object.keys(SETTINGS),
  'bounds',
  'formula',
  'params',
  'values',
  'iso',
  'label',
  'smooth',
  'darkInside',
  'closeBorder',
  'edges',
  'borders',
  'measure',
  'signal',
  'onProgress',
];

/** Which name was meant, or all of them. @param {string} unknown @param {string[]} known */
export function meant(unknown, known) {
  const plain = unknown.replaceAll(/[_-]/g, '').toLowerCase();
  const near = known.find((name) => slipsBetween(plain, name.toLowerCase()) <= (plain.length > 4 ? 2 : 1));
  return near === undefined ? `There are ${known.join(', ')}.` : `Did you mean ${near}?`;
}

/** The option for a setting of the core. @param {string} setting */
export const optionOf = (setting) =>
  Object.keys(SETTINGS).find((name) => name !== 'spacing' && SETTINGS[name].setting === setting) ?? setting;

/** Refuses two sizes. @param {Record<string, unknown>} options */
export function checkSizes(options) {
  // If the spacing depends on the point, a count sets its scale.
  const sizes = isVarying(options.spacing) ? SIZES.filter((name) => name !== 'count') : SIZES;
  const [first, second] = sizes.filter((name) => options[name] !== undefined);
  if (second) throw new InputError(`${first}, ${second}: one of the two, not both.`);
}

/**
 * The core's settings that the options set, and for each the option that set it.
 * @param {Record<string, unknown>} options
 */
export function settingsOf(options) {
  /** @type {Settings} */
  const settings = {};
  /** @type {Record<string, number>} */
  const lengths = {};
  /** @type {Record<string, string>} */
  const given = {};
  for (const [name, { setting, kind, values = [] }] of Object.entries(SETTINGS)) {
    const value = options[name];
    if (value === undefined || (kind === 'flag' && flag(name, value) === false)) continue;
    // A function of a point is not a setting.
    if (kind === 'spacing' && isVarying(value)) continue;
    given[setting] = name;
    if (kind === 'flag') settings[setting] = values[0];
    else if (kind === 'choice') settings[setting] = choice(name, value, values);
    else if (kind === 'number') settings[setting] = number(name, value, () => true, 'a number');
    else if (kind === 'whole') settings[setting] = number(name, value, isWhole, 'a whole number from 0 on');
    else if (kind === 'count') {
      const isCount = (/** @type {number} */ n) => Number.isInteger(n) && n >= 1 && n <= MOST;
      settings.size_mode = 'count';
      settings.count = number(name, value, isCount, 'a whole number from 1 to 4,000,000');
    } else if (kind === 'text')
      settings[setting] = typeof value === 'string' ? value : number(name, value, () => true, 'a number or a formula');
    // The core has radii, which are half the distance between neighbours.
    else if (kind === 'spacing' && typeof value === 'string') settings[setting] = 0.5 * shareOf(name, value);
    else if (kind === 'spacing') settings.radius = 0.5 * number(name, value, isPositive, A_SPACING);
    else if (typeof value === 'string') settings[setting] = shareOf(name, value);
    else if (name === 'radius') settings.radius = number(name, value, isPositive, A_SIZE);
    else lengths[setting] = number(name, value, isPositive, A_SIZE);
  }
  return { settings: Object.keys(lengths).length > 0 ? { ...settings, lengths } : settings, given };
}

/** @param {Pick<Options, 'signal' | 'onProgress'>} options */
export function checkedCalls({ signal, onProgress }) {
  if (signal !== undefined && !(signal instanceof AbortSignal))
    throw new InputError('signal: the signal of an AbortController.');
  if (onProgress !== undefined && typeof onProgress !== 'function') throw new InputError('onProgress: a function.');
  return { signal, onProgress };
}

/**
 * The arrays of points, or their file.
 * @param {{points: unknown, normals?: unknown, name?: unknown}} given @returns {Cloud}
 */
function cloudOf({ points, normals, name }) {
  if (points instanceof Blob || points instanceof ArrayBuffer || points instanceof Uint8Array) {
    if (normals !== undefined) throw new InputError('normals: for arrays of points. A file has its own.');
    const ownName = points instanceof Blob && 'name' in points ? String(points.name) : 'points';
    return { name: name === undefined ? ownName : String(name), file: /** @type {Blob} */ (blobOf(points)) };
  }
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

/** What a file is called, and no formula. */
const A_FILE = /^[^=()]*\.(ply|obj|stl|off|pcd|xyz|pts|csv|npy|nii|nii\.gz|hdr|nrrd|nhdr|mha|mhd|cube|tiff?)$/i;
const FIELD =
  "a formula such as 'x^2 + y^2 + z^2 = 1', a function (x, y, z) => number, {batch(xyz, out)}, {label, pieces}, " +
  '{points} of a file or arrays, {image} of a file or an array of voxels, {mesh} of a file or {points, faces}, or a ' +
  'union(...) of such fields';

/** @param {{label?: unknown, pieces?: unknown}} given @returns {Pieces} */
function piecesOf({ label, pieces }) {
  if (typeof label !== 'function')
    throw new InputError(`label: a function (x, y, z) => the index of a piece, not ${shown(label)}.`);
  if (!Array.isArray(pieces) || pieces.length === 0)
    throw new InputError(`pieces: an array of functions (x, y, z) => number, not ${shown(pieces)}.`);
  const k = pieces.findIndex((piece) => typeof piece !== 'function');
  if (k >= 0) throw new InputError(`pieces[${k}]: a function (x, y, z) => number, not ${shown(pieces[k])}.`);
  return { label: /** @type {Pieces['label']} */ (label), pieces };
}

/** @param {unknown} field @returns {SentPart} */
function fieldOf(field) {
  if (typeof field === 'string') {
    if (A_FILE.test(field))
      throw new InputError(`field: a file such as ${field} is given by its bytes, as {points}, {mesh} or {image}.`);
    return { formula: field };
  }
  if (typeof field === 'function')
    return { program: /** @type {(x: number, y: number, z: number) => number} */ (field) };
  const given = /** @type {Partial<Batch & Pieces> & {points?: unknown, normals?: unknown}} */ (field ?? {});
  if (typeof given.batch === 'function') return { program: /** @type {Batch} */ (given) };
  if (given.pieces !== undefined || given.label !== undefined) return { program: piecesOf(given) };
  if (given.points !== undefined) return { cloud: cloudOf({ ...given, points: given.points }) };
  if (isImage(given)) return { given: imageOf(given) };
  if (isMesh(given)) return { given: meshOf(given) };
  if (typeof given === 'object' && isSolid(given)) return { solid: solidOf(given, fieldOf) };
  throw new InputError(`field: ${FIELD}, not ${Array.isArray(field) ? 'an array' : shown(typeof field)}.`);
}

/**
 * The formula in which the surface of points, an image, a mesh or a combination is an operand.
 * @param {unknown} formula @param {SentPart} what
 */
function modelFormula(formula, { cloud, given, solid }) {
  if (!cloud && !given && !solid)
    throw new InputError(
      'formula: for points, an image, a mesh or a union, whose surface it names model. Else the formula is the field.',
    );
  if (typeof formula === 'string') return { formula };
  throw new InputError(`formula: a text such as 'max(model, z)', not ${shown(formula)}.`);
}

/**
 * The request to the sampler.
 * @param {unknown} field @param {Options} options
 */
export function checked(field, options) {
  const what = fieldOf(field);
  const kind = what.given ? (isImage(/** @type {object} */ (field)) ? 'image' : 'mesh') : null;
  if (typeof options !== 'object' || options === null)
    throw new InputError(`options: an object, not ${shown(options)}.`);
  const unknown = Object.keys(options).find((name) => !KNOWN.includes(name));
  if (unknown !== undefined) throw new InputError(`${unknown}: there is no such option. ${meant(unknown, KNOWN)}`);
  checkSizes(/** @type {Record<string, unknown>} */ (options));
  const { beyondPoints, bounds, formula, params, spacing, values = {}, measure = true } = options;
  const { settings, given } = settingsOf(/** @type {Record<string, unknown>} */ (options));
  if (beyondPoints !== undefined && what.cloud === undefined)
    throw new InputError('beyondPoints: for points, beyond which their surface may go on.');
  const ofFormula = OF_FORMULAS.find((name) => options[/** @type {keyof Options} */ (name)]);
  if (ofFormula !== undefined && (what.formula === undefined || what.cloud !== undefined))
    throw new InputError(`${ofFormula}: for a formula by itself.`);
  const leaves = leavesOf(what);
  if (formula !== undefined) Object.assign(what, modelFormula(formula, what));
  if (params !== undefined && [what, ...leaves].every((part) => part.formula === undefined))
    throw new InputError('params: a formula has parameters, a function, points, an image or a mesh have none.');
  /** @type {SentField} */
  const request = {
    ...what,
    parameters: { ...(params === undefined ? {} : paramsOf(params)), ...valuesOf(options, kind) },
    ...(bounds === undefined ? {} : { bounds: boundsOf(bounds) }),
  };
  const functions = { ...(isVarying(spacing) ? { spacing } : {}), values: functionsOf(values) };
  const programs = [...leaves.map(({ program }) => program), functions.spacing, ...Object.values(functions.values)];
  /** Whether functions of the program are called. */
  const isHere = programs.some((own) => typeof own === 'function' || typeof own === 'object');
  return { request, functions, settings, given, isHere, measure: flag('measure', measure), ...checkedCalls(options) };
}
