/**
 * The colour palettes of the picture, for light and dark backgrounds.
 *
 * The cycle of level colours is a rhombus in OKLab's a–b plane at constant lightness. Along it both a and b are
 * triangle waves, so neighbouring levels differ by the same step even for a viewer who distinguishes only one of the
 * two axes. On a hue circle such a viewer would see no change at two places.
 *
 * @module
 */
import { vec } from '../vector.js';
import { oklch, packedFromOklab } from './oklab.js';

/** @import { Palette, Theme } from './types.js' */

/** Number of colours in the level cycle. */
export const CYCLE = 12;

/** Triangle wave of period 1: 0 → 1 → 0 → −1. @param {number} t */
function triangle(t) {
  const u = t - Math.floor(t);
  return u < 0.25 ? 4 * u : u < 0.75 ? 2 - 4 * u : 4 * u - 4;
}

/**
 * Returns the widest rhombus in the sRGB gamut at these lightnesses. The a axis ends in green-cyan and pink, the b axis
 * in blue and yellow. The cycle starts at blue, the colour of a seed.
 * @param {Theme} theme
 */
function levelCycle(theme) {
  const L = theme === 'light' ? 0.7 : 0.75;
  const a = 0.12;
  const b = 0.125;
  return Uint32Array.from({ length: CYCLE }, (_, k) => {
    const t = k / CYCLE;
    return packedFromOklab([L, a * triangle(t), -b * triangle(t + 0.25)]);
  });
}

/** Samples a ramp through OKLCH stops at `n` points. @param {[number, number, number][]} stops @param {number} n */
function ramp(stops, n) {
  return Uint32Array.from({ length: n }, (_, i) => {
    const t = (i / (n - 1)) * (stops.length - 1);
    const k = Math.min(stops.length - 2, Math.floor(t));
    const u = t - k;
    const [p, q] = [stops[k], stops[k + 1]];
    return packedFromOklab(oklch(p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u, p[2] + (q[2] - p[2]) * u));
  });
}

/** Number of samples of the sequential ramp. */
export const RAMP = 64;
/** Number of samples of the diverging ramp. It is odd, so that one sample is at 0. */
export const DIVERGING = 65;

/**
 * Returns a ramp of two straight lines in OKLab, from a neutral middle to blue and to orange. Equal steps of the value
 * are equal perceptual steps, and blue and orange stay distinct in every colour vision deficiency. The middle is the
 * lightest in both themes, so that the signs differ in hue alone and the magnitude is also visible in greyscale.
 * @param {Theme} theme
 */
function diverging(theme) {
  const light = theme === 'light';
  const middle = oklch(light ? 0.83 : 0.9, 0, 0);
  const [low, high] = light
    ? [oklch(0.47, 0.13, 255), oklch(0.52, 0.15, 45)]
    : [oklch(0.56, 0.14, 255), oklch(0.6, 0.16, 45)];
  return Uint32Array.from({ length: DIVERGING }, (_, i) => {
    const t = (2 * i) / (DIVERGING - 1) - 1;
    const end = t < 0 ? low : high;
    return packedFromOklab(vec((k) => middle[k] + (end[k] - middle[k]) * Math.abs(t)));
  });
}

/** Number of component colours. Further components reuse them. */
export const COMPONENT_COLOURS = 12;

/**
 * Lightness, chroma and hue of the component colours. A search maximised the smallest difference between the twelve
 * colours for normal vision and all three colour vision deficiencies together. Each colour is the farthest from those
 * before it.
 * @type {Record<Theme, [number, number, number][]>}
 */
const COMPONENT_LCH = {
  light: [
    [0.56, 0.15, 250],
    [0.74, 0.15, 60],
    [0.44, 0.15, 30],
    [0.79, 0.15, 220],
    [0.44, 0.15, 300],
    [0.62, 0.04, 90],
    [0.79, 0.04, 130],
    [0.44, 0.08, 190],
    [0.68, 0.15, 280],
    [0.56, 0.15, 50],
    [0.68, 0.115, 340],
    [0.56, 0.115, 330],
  ],
  dark: [
    [0.64, 0.15, 250],
    [0.76, 0.15, 60],
    [0.52, 0.115, 20],
    [0.86, 0.15, 200],
    [0.52, 0.15, 300],
    [0.86, 0.115, 130],
    [0.76, 0.115, 270],
    [0.76, 0.04, 10],
    [0.58, 0.115, 90],
    [0.64, 0.04, 290],
    [0.52, 0.08, 210],
    [0.64, 0.115, 30],
  ],
};

/** @param {Theme} theme */
function palette(theme) {
  const light = theme === 'light';
  return {
    levels: levelCycle(theme),
    // Small distances are dark violet, the ideal one is green-blue, large ones are bright yellow. The lightness
    // increases throughout, so that the order is visible in every colour vision deficiency and in greyscale.
    sequential: ramp(
      [
        [0.36, 0.14, 300],
        [0.5, 0.12, 255],
        [0.64, 0.11, 195],
        [0.78, 0.15, 140],
        [0.9, 0.16, 100],
      ],
      RAMP,
    ),
    diverging: diverging(theme),
    components: Uint32Array.from(COMPONENT_LCH[theme], ([L, C, h]) => packedFromOklab(oklch(L, C, h))),
    valence: {
      four: packedFromOklab(oklch(light ? 0.47 : 0.55, 0.17, 262)),
      five: packedFromOklab(oklch(light ? 0.66 : 0.72, 0.12, 245)),
      six: packedFromOklab(oklch(light ? 0.84 : 0.62, 0.008, 260)),
      seven: packedFromOklab(oklch(light ? 0.74 : 0.8, 0.14, 70)),
      eight: packedFromOklab(oklch(light ? 0.55 : 0.62, 0.19, 35)),
      none: packedFromOklab(oklch(light ? 0.74 : 0.44, 0.004, 260)),
    },
    fate: {
      interior: packedFromOklab(oklch(light ? 0.8 : 0.66, 0.02, 250)),
      border: packedFromOklab(oklch(light ? 0.62 : 0.72, 0.11, 245)),
      trouble: packedFromOklab(oklch(light ? 0.55 : 0.64, 0.2, 30)),
      capped: packedFromOklab(oklch(light ? 0.78 : 0.84, 0.15, 88)),
      front: packedFromOklab(oklch(light ? 0.52 : 0.58, 0.16, 310)),
    },
    plain: packedFromOklab(oklch(light ? 0.78 : 0.74, 0.025, 235)),
    // The background is nearly neutral and equals that of the page.
    ground: packedFromOklab(oklch(light ? 0.975 : 0.185, light ? 0.002 : 0.006, 260)),
    // A model's points are ink on a casing of the background's lightness, so that they are visible on any colour.
    ink: packedFromOklab(oklch(light ? 0.2 : 0.98, 0, 0)),
    casing: packedFromOklab(oklch(light ? 0.99 : 0.15, 0, 0)),
    box: packedFromOklab(oklch(light ? 0.62 : 0.55, 0.01, 260)),
  };
}

/** @type {Record<Theme, Palette>} */
export const PALETTES = { light: palette('light'), dark: palette('dark') };
