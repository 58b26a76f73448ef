/**
 * The palettes of the picture, light and dark.
 *
 * The level cycle is a rhombus in OKLab's a–b plane at constant lightness: along it both a and b are triangle waves, so that
 * neighbouring levels stay apart by the same step even for an eye that sees only one of the two axes. A hue circle has two
 * places where such an eye sees nothing change.
 *
 * @module
 */
import { oklch, packedFromOklab } from './oklab.js';

/** @typedef {'light' | 'dark'} Theme */

/** Steps in the level cycle. */
export const CYCLE = 12;

/** Triangle wave of period 1: 0 → 1 → 0 → −1. @param {number} t */
function triangle(t) {
  const u = t - Math.floor(t);
  return u < 0.25 ? 4 * u : u < 0.75 ? 2 - 4 * u : 4 * u - 4;
}

/**
 * The widest rhombus that sRGB holds at these lightnesses: the a axis ends in green-cyan and pink, the b axis in blue and
 * yellow. The cycle starts at blue, the colour of a seed.
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

/** A ramp through OKLCH stops, `n` samples. @param {[number, number, number][]} stops @param {number} n */
function ramp(stops, n) {
  return Uint32Array.from({ length: n }, (_, i) => {
    const t = (i / (n - 1)) * (stops.length - 1);
    const k = Math.min(stops.length - 2, Math.floor(t));
    const u = t - k;
    const [p, q] = [stops[k], stops[k + 1]];
    return packedFromOklab(oklch(p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u, p[2] + (q[2] - p[2]) * u));
  });
}

/** Samples of the sequential ramp. */
export const RAMP = 64;

/** @param {Theme} theme */
function palette(theme) {
  const light = theme === 'light';
  return {
    levels: levelCycle(theme),
    // Too close is dark violet, the ideal distance green-blue, too far bright yellow: lightness rises all the way, so that
    // the order survives any colour deficiency and a grey print.
    sequential: ramp([[0.36, 0.14, 300], [0.5, 0.12, 255], [0.64, 0.11, 195], [0.78, 0.15, 140], [0.9, 0.16, 100]], RAMP),
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
    // Near-neutral ground, the same as the page's own.
    ground: packedFromOklab(oklch(light ? 0.975 : 0.185, light ? 0.002 : 0.006, 260)),
    box: packedFromOklab(oklch(light ? 0.62 : 0.55, 0.01, 260)),
  };
}

/** @typedef {ReturnType<typeof palette>} Palette */

/** @type {Record<Theme, Palette>} */
export const PALETTES = { light: palette('light'), dark: palette('dark') };
