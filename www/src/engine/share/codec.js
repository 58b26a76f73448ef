/**
 * Encodes the state in the fragment of an address, so that a link holds the whole state and no server is needed.
 *
 * `#v1.j.…` is base64url of UTF-8 JSON, `#v1.z.…` the same after deflate; the shorter one is written. Only values that
 * differ from the defaults are stored. Decoding checks the length of the fragment, the size of the inflated text and
 * every value.
 *
 * @module
 */
import { fromBase64url, toBase64url } from './base64url.js';
import { completeSettings, defaultState, ownFormula, sanitize } from './state.js';

/** @import { Description, State } from '../types.js' */

const VERSION = 1;
/** Largest length of a fragment that is decoded. */
export const LONGEST_FRAGMENT = 65_536;
/** Largest size of the inflated JSON. No state written by the page comes near it. */
const LONGEST_JSON = 65_536;
/** Length below which deflate makes the text longer. */
const WORTH_DEFLATING = 256;

/** @param {number} v @param {number} digits  significant ones */
const short = (v, digits = 6) => Number(v.toPrecision(digits));

/**
 * Returns the values of a state that differ from the defaults.
 * @param {State} state
 * @param {Description} description
 */
export function difference(state, description) {
  const home = defaultState(description);
  const { view } = state;
  /** @type {Record<string, unknown>} */
  const out = {};
  if (state.surface !== home.surface) out.surface = state.surface;
  if (state.formula !== ownFormula(description, state.surface)) out.formula = state.formula;
  if (Object.keys(state.parameters).length) out.parameters = state.parameters;
  if (state.declared.length) out.declared = state.declared;
  if (state.centres !== null) out.centres = state.centres;
  if (state.bounds) out.bounds = state.bounds;
  if (state.plane) out.plane = { normal: state.plane.normal.map((v) => short(v)), offset: short(state.plane.offset) };
  if (state.pulls.length) out.pulls = state.pulls;
  if (state.lines.length) out.lines = state.lines;
  const defaults = completeSettings(description, {});
  const settings = Object.fromEntries(
    Object.entries(state.settings).filter(([name, value]) => value !== defaults[name]),
  );
  if (Object.keys(settings).length) out.settings = settings;
  /** @type {Record<string, unknown>} */
  const look = {};
  for (const [key, value] of Object.entries(view))
    if (key !== 'camera' && value !== /** @type {any} */ (home.view)[key]) look[key] = value;
  const { camera } = view;
  const rounded = {
    target: camera.target.map((v) => short(v)),
    distance: short(camera.distance),
    yaw: short(camera.yaw, 5),
    pitch: short(camera.pitch, 5),
    fit: camera.fit,
  };
  // A camera that fits the surface automatically is stored only if it was rotated.
  const turned =
    Math.abs(camera.yaw - home.view.camera.yaw) > 1e-3 || Math.abs(camera.pitch - home.view.camera.pitch) > 1e-3;
  if (!camera.fit || turned) look.camera = rounded;
  if (Object.keys(look).length) out.view = look;
  return out;
}

/**
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @param {CompressionStream | DecompressionStream} stream
 * @param {number} limit
 */
async function through(bytes, stream, limit) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  /** @type {Uint8Array[]} */
  const parts = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > limit) {
      reader.cancel().catch(() => {});
      throw new RangeError('too large');
    }
    parts.push(value);
  }
  const out = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

/**
 * Returns the fragment of a state, with `#`; empty for the default state.
 * @param {State} state
 * @param {Description} description
 */
export async function encode(state, description) {
  const changes = difference(state, description);
  if (Object.keys(changes).length === 0) return '';
  const bytes = new TextEncoder().encode(JSON.stringify(changes));
  const plain = `#v${VERSION}.j.${toBase64url(bytes)}`;
  if (bytes.length < WORTH_DEFLATING || typeof CompressionStream === 'undefined') return plain;
  const packed = await through(bytes, new CompressionStream('deflate-raw'), Infinity);
  const deflated = `#v${VERSION}.z.${toBase64url(packed)}`;
  return deflated.length < plain.length ? deflated : plain;
}

/**
 * Reads a fragment.
 * @param {string} fragment  with or without `#`
 * @param {Description} description
 * @param {boolean} [hasFile]  whether a file is open, which the state may refer to
 * @returns {Promise<{state: State, reset: string[], problem: string | null}>} `problem`: why nothing of the fragment
 *   could be used; `reset`: the parts that could not
 */
export async function decode(fragment, description, hasFile = false) {
  const text = fragment.startsWith('#') ? fragment.slice(1) : fragment;
  const home = { state: defaultState(description), reset: [] };
  if (text === '') return { ...home, problem: null };
  if (text.length > LONGEST_FRAGMENT) return { ...home, problem: 'The link is too long to be one of this page.' };
  const parts = /^v(\d{1,4})\.([jz])\.([^.]*)$/.exec(text);
  if (!parts) return { ...home, problem: 'The link is damaged.' };
  if (Number(parts[1]) !== VERSION) return { ...home, problem: 'The link was made by another version of this page.' };
  try {
    const bytes = fromBase64url(parts[3]);
    const plain = parts[2] === 'z' ? await through(bytes, new DecompressionStream('deflate-raw'), LONGEST_JSON) : bytes;
    const raw = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(plain));
    return { ...sanitize(raw, description, hasFile), problem: null };
  } catch (error) {
    return {
      ...home,
      problem: error instanceof RangeError ? 'The link holds too much to be one of this page.' : 'The link is damaged.',
    };
  }
}
