/**
 * The colour palettes of the picture, for light and dark backgrounds.
 *
 * @module
 */
import { vec } from '../vector.js';
import { oklch, packedFromOklab } from './oklab.js';

/** @import { Palette, Theme } from './types.js' */

/** Number of levels between two light rings. */
export const RING = 8;
/**
 * Exponents for the way from blue to sand. Around a seed most particles are on later levels; with creases, where rings
 * begin everywhere, on early ones. So the middle of the surface is teal in both cases.
 */
const WAY = { seed: 1.4, creases: 0.7 };
/**
 * Lightness, chroma and hue in degrees at the seed, and their changes: lightness and chroma within a ring, hue up to
 * the last level. Rings differ in lightness, which every kind of vision distinguishes.
 * @type {Record<Theme, {L: [number, number], C: [number, number], h: [number, number]}>}
 */
const SEA = {
  light: { L: [0.79, 0.1], C: [0.072, -0.03], h: [262, -177] },
  dark: { L: [0.64, 0.15], C: [0.092, -0.022], h: [266, -181] },
};

/**
 * Returns a function for the colours of the levels 0 to `last`: blue where the rings begin, then teal, green and sand
 * at the end, with a soft light ring every {@link RING} levels. It keeps the last table.
 * @param {Theme} theme
 */
function seaOf(theme) {
  const { L, C, h } = SEA[theme];
  let made = { last: -1, exponent: 0, table: new Uint32Array(0) };
  return (/** @type {number} */ last, isFromCreases = false) => {
    const exponent = isFromCreases ? WAY.creases : WAY.seed;
    if (made.last !== last || made.exponent !== exponent) {
      const table = Uint32Array.from({ length: last + 1 }, (_, level) => {
        const ring = 0.5 - 0.5 * Math.cos((2 * Math.PI * level) / RING);
        const way = (level / Math.max(1, last)) ** exponent;
        return packedFromOklab(oklch(L[0] + L[1] * ring, C[0] + C[1] * ring, h[0] + h[1] * way));
      });
      made = { last, exponent, table };
    }
    return made.table;
  };
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
    levels: seaOf(theme),
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
    // The body beneath the discs: darker than the discs, and so grey that it does not look like a colour of the data.
    body: packedFromOklab(light ? oklch(0.71, 0.025, 240) : oklch(0.5, 0.03, 245)),
    // Share of the ambient occlusion; with all of it a light picture looks sooty.
    occlusion: light ? 0.65 : 0.8,
    // The background is nearly neutral and equals that of the page.
    ground: packedFromOklab(oklch(light ? 0.975 : 0.185, light ? 0.002 : 0.006, 260)),
    // A model's points are ink on a casing of the background's lightness, so that they are visible on any colour.
    ink: packedFromOklab(oklch(light ? 0.36 : 0.98, 0, 0)),
    casing: packedFromOklab(oklch(light ? 0.99 : 0.15, 0, 0)),
    box: packedFromOklab(oklch(light ? 0.62 : 0.55, 0.01, 260)),
  };
}

/** @type {Record<Theme, Palette>} */
export const PALETTES = { light: palette('light'), dark: palette('dark') };
