/**
 * Converts colours between OKLab, OKLCH (Björn Ottosson, 2020) and sRGB bytes.
 *
 * @module
 */

/** @typedef {[number, number, number]} Triple */

/** Decodes sRGB in 0 … 1 to linear light. @param {number} v */
export const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
/** Encodes linear light as sRGB in 0 … 1. @param {number} v */
export const encoded = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);

/**
 * Returns the linear sRGB of an OKLab colour. Components are outside 0 … 1 if the colour is outside the sRGB gamut.
 * @param {Triple} lab
 * @returns {Triple}
 */
function linearFromOklab([L, a, b]) {
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

/**
 * Returns the OKLab of a linear sRGB colour.
 * @param {Triple} rgb
 * @returns {Triple}
 */
export function oklabFromLinear([r, g, b]) {
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

/** Whether a linear colour is in the sRGB gamut, to half a byte. @param {Triple} rgb */
const inGamut = (rgb) => rgb.every((v) => v >= -0.0015 && v <= 1.0015);

/**
 * Returns an OKLab colour as opaque `0xAABBGGRR`. Outside the sRGB gamut the chroma is reduced; lightness and hue stay.
 * @param {Triple} lab
 */
export function packedFromOklab(lab) {
  let rgb = linearFromOklab(lab);
  if (!inGamut(rgb)) {
    let inside = 0;
    let outside = 1;
    // 12 bisections find the gamut boundary to 1/4096 of the chroma, well below one byte.
    for (let i = 0; i < 12; i += 1) {
      const k = (inside + outside) / 2;
      if (inGamut(linearFromOklab([lab[0], lab[1] * k, lab[2] * k]))) inside = k;
      else outside = k;
    }
    rgb = linearFromOklab([lab[0], lab[1] * inside, lab[2] * inside]);
  }
  const [r, g, b] = rgb.map((v) => Math.round(255 * encoded(Math.min(1, Math.max(0, v)))));
  return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

/**
 * Returns the OKLab of a lightness 0 … 1, a chroma and a hue in degrees.
 * @param {number} L
 * @param {number} C
 * @param {number} hDeg
 * @returns {Triple}
 */
export function oklch(L, C, hDeg) {
  const h = (hDeg * Math.PI) / 180;
  return [L, C * Math.cos(h), C * Math.sin(h)];
}

/** Returns the sRGB components of `0xAABBGGRR`, 0 … 1. @param {number} packed @returns {Triple} */
export const rgbFromPacked = (packed) => [
  (packed & 255) / 255,
  ((packed >> 8) & 255) / 255,
  ((packed >> 16) & 255) / 255,
];

/** Returns `#rrggbb` for `0xAABBGGRR`. @param {number} packed */
export const hexFromPacked = (packed) =>
  `#${[packed & 255, (packed >> 8) & 255, (packed >> 16) & 255].map((v) => v.toString(16).padStart(2, '0')).join('')}`;

/** Returns the OKLab of `0xAABBGGRR`. @param {number} packed @returns {Triple} */
export function oklabFromPacked(packed) {
  const [r, g, b] = rgbFromPacked(packed);
  return oklabFromLinear([linear(r), linear(g), linear(b)]);
}
