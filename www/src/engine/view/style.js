/**
 * How the picture looks: what a person chose, and the renderer's style that follows from it.
 *
 * @module
 */
import { rgbFromPacked } from './oklab.js';
import { PALETTES } from './palettes.js';

/** Time a new particle takes to appear. */
export const FADE_S = 0.12;
/** How far discs seen from behind fade towards the ground. */
const DIM_BACKFACES = 0.55;

/**
 * @typedef {object} Look
 * @property {import('../types.js').ColourMode} colour
 * @property {number} size  disc radius as a share of the particle's radius
 * @property {'light' | 'dark'} theme
 * @property {import('../types.js').Bounds | null} box  the clip box, where it is drawn
 * @property {Float32Array | null} points  the points of a model, three numbers each, drawn as dots
 * @property {number | null} level  the newest generation level to be seen, null for all of them
 * @property {number} highlight  index of the particle with an outline, −1 for none
 * @property {import('./camera.js').Insets} insets
 */

/** @param {import('../types.js').ViewState} view @returns {Look} */
export const firstLook = ({ colour, size }) => ({
  colour,
  size,
  theme: 'light',
  box: null,
  points: null,
  level: null,
  highlight: -1,
  insets: { left: 0, right: 0, top: 0, bottom: 0 },
});

/** The newest level in the picture: one that does not exist counts as the last. @param {Look} look @param {number} lastLevel */
export const shownLevel = ({ level }, lastLevel) => (level === null ? null : Math.min(level, lastLevel));

/**
 * The renderers' style record.
 * @param {Look} look
 * @param {{lastLevel: number, dim: number, calm: boolean, pixelRatio: number}} present
 */
export function styleOf(look, { lastLevel, dim, calm, pixelRatio }) {
  const palette = PALETTES[look.theme];
  return {
    background: [...rgbFromPacked(palette.ground), 1],
    disc_scale: look.size,
    dim,
    fade_s: calm ? 0 : FADE_S,
    level: shownLevel(look, lastLevel),
    // Level by level one often looks into a surface that is still open.
    dim_backfaces: look.level === null ? DIM_BACKFACES : DIM_BACKFACES / 2,
    outline: look.highlight,
    box: look.box && { ...look.box, colour: [...rgbFromPacked(palette.box), 0.9] },
    pixel_ratio: pixelRatio,
  };
}
