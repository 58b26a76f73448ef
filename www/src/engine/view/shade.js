/**
 * The light and the colours of the painter, like shaders/common.wgsl for the other renderers.
 *
 * @module
 */
import { clamp } from '../vector.js';
import { encoded, linear } from './oklab.js';

/** Steps of linear light, enough to distinguish the darkest bytes of sRGB. */
const STEPS = 4095;
/** Tables from a byte to linear light, and from a step of linear light to a byte. */
export const LINEAR = Float32Array.from({ length: 256 }, (_, v) => linear(v / 255));
const ENCODED = Uint8Array.from({ length: STEPS + 1 }, (_, v) => Math.round(255 * encoded(v / STEPS)));

/** Luminance above which a background is light, and the outline's light on a dark one, as there. */
const LIGHT_GROUND = 0.179;
const RIM_LIGHT = 0.1;
/** Shares of light and chroma that the inside of a surface keeps. */
const INSIDE_LIGHT = 0.6;
const INSIDE_CHROMA = 0.75;
const GROUND_LIGHT = 0.32;
const SKY_LIGHT = 0.6;
const KEY_LIGHT = 0.74;
const WRAP = 0.3;
const OUTLINE_SHADE = 0.14;
const COOL_TO_WARM = /** @type {const} */ ([0.35, 1.15]);

/** @param {readonly number[]} edges @param {number} x */
export function smoothstep([from, to], x) {
  const t = clamp((x - from) / (to - from), 0, 1);
  return t * t * (3 - 2 * t);
}

/** @param {number[]} linear */
const luminanceOf = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/** Returns the light along the outline for a background in linear light. @param {number[]} ground */
export const rimOn = (ground) => (luminanceOf(ground) > LIGHT_GROUND ? 0 : RIM_LIGHT);

/** Packs three linear components into a pixel. @param {number} r @param {number} g @param {number} b */
export const packed = (r, g, b) => (255 << 24) | (encodedOf(b) << 16) | (encodedOf(g) << 8) | encodedOf(r);
/** @param {number} value  in linear light, 0 … 1 */
const encodedOf = (value) => ENCODED[(value * STEPS + 0.5) | 0];

// A frame draws up to some million discs, so results are always written to the same arrays; allocating new ones would
// take most of the frame.
export const LIGHT = new Float64Array(3);
export const COLOUR = new Float64Array(3);
/** The result of {@link shade}. */
export const SHADE = new Float64Array(3);

/** Writes a packed colour to COLOUR, in linear light. @param {number} colour */
export function takeColour(colour) {
  for (let k = 0; k < 3; k += 1) COLOUR[k] = LINEAR[(colour >> (8 * k)) & 255];
}

/**
 * Writes the light on a surface to LIGHT, for each component of its colour, like `light_on` in shaders/common.wgsl.
 * @param {{keyward: number, skyward: number, edgeOn: number}} cosines  of its normal with the
 *   directions to the key light and to the sky; `edgeOn`: 1 at the outline
 * @param {{rim: number, warmth: number}} how
 */
export function lightOn({ keyward, skyward, edgeOn }, { rim, warmth }) {
  const sky = 0.5 + 0.5 * skyward;
  const key = Math.max(0, (keyward + WRAP) / (1 + WRAP));
  const direct =
    (GROUND_LIGHT + (SKY_LIGHT - GROUND_LIGHT) * sky + KEY_LIGHT * key * key) * (1 - OUTLINE_SHADE * edgeOn ** 3);
  const light = direct + rim * edgeOn ** 4 * sky;
  const warm = warmth * (smoothstep(COOL_TO_WARM, light) - 0.5);
  LIGHT[0] = light * (1 + 0.6 * warm);
  LIGHT[1] = light * (1 + 0.1 * warm);
  LIGHT[2] = light * (1 - warm);
}

/**
 * Writes COLOUR, in linear light, under a share of LIGHT to SHADE: as an inside by the share `behind`, faded to the
 * background by the share `away`.
 * @param {number} share @param {number} behind @param {number} away @param {number[]} ground
 */
export function shade(share, behind, away, ground) {
  const r = COLOUR[0] * (LIGHT[0] * share);
  const g = COLOUR[1] * (LIGHT[1] * share);
  const b = COLOUR[2] * (LIGHT[2] * share);
  const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const component = (/** @type {number} */ value, /** @type {number} */ k) => {
    const inside = INSIDE_LIGHT * (luminance + (value - luminance) * INSIDE_CHROMA);
    return Math.min(1, value + (inside - value) * behind) * (1 - away) + ground[k] * away;
  };
  SHADE[0] = component(r, 0);
  SHADE[1] = component(g, 1);
  SHADE[2] = component(b, 2);
}

/** The same as a pixel. @param {number} share @param {number} behind @param {number} away @param {number[]} ground */
export function lit(share, behind, away, ground) {
  shade(share, behind, away, ground);
  return packed(SHADE[0], SHADE[1], SHADE[2]);
}
