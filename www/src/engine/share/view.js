/**
 * The options of the view: for each its default, its valid values, and its name in words. State, links, validation and
 * the menu follow from this table.
 *
 * @module
 */
import { DISC_SIZE } from '../constants.js';
import { homeCamera, PITCH_LIMIT_RAD } from '../view/camera.js';
import { COLOURINGS } from '../view/colouring.js';
import { integers, isRecord, vec3, within } from './valid.js';

/**
 * @import { CameraState, ColourMode } from '../types.js'
 * @import { Option } from './types.js'
 */

/** Largest number in a camera, since the graphics card uses single precision. */
const LARGEST_SINGLE = 3e38;
/** Upper limit for generation levels, relaxation steps and events in a state; no run reaches it. */
const LAST_LEVEL = 1e6;
/** Longest formula of a value. */
const LONGEST_VALUE = 2000;
/** Largest index of a particle in a state; no run reaches it. */
const LAST_PARTICLE = 2 ** 32 - 1;

/** @param {boolean} home @param {string} words @returns {Option<boolean>} */
const flag = (home, words) => ({
  home: () => home,
  words,
  valid: (raw) => (typeof raw === 'boolean' ? raw : undefined),
});

/**
 * An option with one of several values; the first is the default.
 * @template {string} T
 * @param {string} words @param {readonly T[]} values @returns {Option<T>}
 */
const choice = (words, values) => ({
  home: () => values[0],
  words,
  valid: (raw) => values.find((value) => value === raw),
});

/** A position on the timeline; null for its whole length. @param {string} words @returns {Option<number | null>} */
const place = (words) => ({
  home: () => null,
  words,
  valid(raw) {
    if (raw === null) return null;
    const at = within(raw, 0, LAST_LEVEL);
    return at === undefined ? undefined : Math.round(at);
  },
});

/** @param {unknown} raw @returns {CameraState | undefined} */
function validCamera(raw) {
  const { target: at, distance: far, yaw: turn, pitch: tilt, fit } = isRecord(raw) ? raw : {};
  const target = vec3(at);
  const distance = within(far, 1 / LARGEST_SINGLE, LARGEST_SINGLE);
  const yaw = within(turn, -2 * Math.PI, 2 * Math.PI);
  const pitch = within(tilt, -PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
  if (!target || distance === undefined || yaw === undefined || pitch === undefined) return undefined;
  return { target, distance, yaw, pitch, fit: fit === true };
}

export const VIEW = {
  colour: choice('colour', /** @type {ColourMode[]} */ (Object.keys(COLOURINGS))),
  /** The formula of the value by which the particles are coloured. @type {Option<string>} */
  value: {
    home: () => 'k_1 k_2',
    words: 'formula of the colours',
    valid: (raw) => (typeof raw === 'string' && raw.trim() !== '' && raw.length <= LONGEST_VALUE ? raw : undefined),
  },
  /** Disc radius as a share of the repulsion radius: see {@link DISC_SIZE}. @type {Option<number>} */
  size: {
    home: () => DISC_SIZE.initial,
    words: 'disc size',
    valid: (raw) => within(raw, DISC_SIZE.min, DISC_SIZE.max),
    exact: true,
  },
  /** Whether distant parts look smaller. */
  projection: choice('projection', ['perspective', 'orthographic']),
  /** The way of drawing the particles. */
  draw: choice('way of drawing', ['discs', 'spheres', 'mesh']),
  /** The lighting and colours of the faces of a mesh. */
  faces: choice('faces of the mesh', ['smooth', 'flat']),
  /** Whether the edges of a mesh are drawn. */
  edges: flag(true, 'edges of the mesh'),
  /** Whether vertices of a mesh without six neighbours are marked. */
  marks: flag(true, 'marks on the mesh'),
  /** Whether lines are drawn along creases. */
  creases: flag(true, 'creases'),
  theme: choice('theme', ['auto', 'light', 'dark']),
  /** Whether a body beneath the discs closes the gaps between them. */
  body: flag(true, 'body beneath the discs'),
  /** Whether the clip box is drawn, with its dimensions. */
  box: flag(false, 'box'),
  /** Whether axes with ticks are drawn around the clip box. */
  axes: flag(false, 'axes'),
  /** Whether a scale bar is drawn. */
  bar: flag(false, 'scale bar'),
  /**
   * Indices of up to two particles whose distance is measured; null if nothing is measured.
   * @type {Option<number[] | null>}
   */
  measured: {
    home: () => null,
    words: 'measured distance',
    valid(raw) {
      if (raw === null) return null;
      const ends = integers(raw, LAST_PARTICLE);
      return ends && ends.length <= 2 && new Set(ends).size === ends.length ? ends : undefined;
    },
  },
  /** Whether the centres of a model are drawn. */
  points: flag(true, 'points of the model'),
  /** Whether particles that have followed a moving surface stay where they are. */
  flow: flag(false, 'particles at rest'),
  /** The newest generation level drawn, null for all levels; beyond the last one it means the last. */
  level: place('generation level'),
  /** The relaxation step after which the particles are drawn, null for the last step. */
  step: place('relaxation step'),
  /** @type {Option<CameraState>} */
  camera: { home: homeCamera, words: 'camera', valid: validCamera },
};

/** @typedef {{[K in keyof typeof VIEW]: ReturnType<(typeof VIEW)[K]['home']>}} ViewState */

const OPTIONS = /** @type {[string, Option<unknown>][]} */ (Object.entries(VIEW));

export const homeView = () =>
  /** @type {ViewState} */ (Object.fromEntries(OPTIONS.map(([key, { home }]) => [key, home()])));

/**
 * Returns a view with the usable parts of a patch. The unusable ones are named in `reset`, in words for the user.
 * @param {Record<string, unknown>} raw
 * @param {ViewState} view
 * @param {string[]} reset
 */
export function validView(raw, view, reset = []) {
  /** @type {Record<string, unknown>} */
  const out = { ...view };
  for (const [key, { words, valid, exact }] of OPTIONS) {
    if (raw[key] === undefined) continue;
    const value = valid(raw[key]);
    if (value === undefined || (exact && value !== raw[key])) reset.push(words);
    if (value !== undefined) out[key] = value;
  }
  return /** @type {ViewState} */ (out);
}
