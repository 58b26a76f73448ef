/**
 * The appearance of the picture: the user's options, and the renderer's style that follows from them.
 *
 * @module
 */
import { COLOURINGS } from './colouring.js';
import { rgbFromPacked } from './oklab.js';
import { PALETTES } from './palettes.js';

/**
 * @import { Bounds, ViewState } from '../types.js'
 * @import { Look } from './types.js'
 */

/** Radius of the discs in repulsion radii; spheres have the radius of their particles and touch. @param {Look} look */
export const scaleOf = ({ draw, size }) => (draw === 'spheres' ? 1 : size);

/** Duration of a new particle's fade-in. */
export const FADE_S = 0.12;
/** Difference in warmth between lit and shaded places, if light may tint the colours. */
const WARMTH = 0.12;
/** Width of the edges of faces, in page pixels. */
const EDGE_PX = 1;
/**
 * Share by which back sides are drawn as an inside, darker and greyer: fully for discs; for spheres enough to keep the
 * far side subdued in the gaps; for a mesh enough to tell its sides apart where it is cut.
 */
const DIM_BEHIND = { discs: 1, spheres: 0.5, mesh: 0.25 };

/** Returns the parts of the view that the picture shows. @param {ViewState} view */
export function seenOf({ theme, box, bar, measured, points, camera, ...seen }) {
  return seen;
}

/** @param {ViewState} view @returns {Look} */
export const firstLook = (view) => ({
  ...seenOf(view),
  theme: 'light',
  box: null,
  plane: null,
  points: null,
  highlight: -1,
  insets: { left: 0, right: 0, top: 0, bottom: 0 },
});

/**
 * Returns the newest visible level. A level beyond the last counts as the last.
 * @param {Look} look
 * @param {number} lastLevel
 */
export const shownLevel = ({ level }, lastLevel) => (level === null ? null : Math.min(level, lastLevel));

/**
 * Returns the relaxation step after which the particles are drawn, null for the last one. Generation levels are drawn
 * as they were placed. A mesh exists only for the last step.
 * @param {Look} look
 */
export function shownStep({ level, step, draw }) {
  if (draw === 'mesh') return null;
  return level === null ? step : 0;
}

/**
 * Returns the renderers' style record.
 * @param {Look} look
 * @param {{lastLevel: number, isOpen: boolean, bounds: Bounds, dim: number, calm: boolean,
 *   pixelRatio: number}} present `isOpen`: whether the inside of the surface can be seen; `bounds`:
 *   the box that the surface ends at
 */
export function styleOf(look, { lastLevel, isOpen, bounds, dim, calm, pixelRatio }) {
  const palette = PALETTES[look.theme];
  return {
    background: [...rgbFromPacked(palette.ground), 1],
    faces: look.draw === 'mesh' ? { flat: look.faces === 'flat', edge_px: look.edges ? EDGE_PX : 0 } : null,
    body: look.body ? { colour: rgbFromPacked(palette.body), is_open: isOpen, bounds } : null,
    occlusion: palette.occlusion,
    warmth: COLOURINGS[look.colour].isTinted ? WARMTH : 0,
    spheres: look.draw === 'spheres',
    disc_scale: scaleOf(look),
    dim,
    fade_s: calm ? 0 : FADE_S,
    level: shownLevel(look, lastLevel),
    dim_backfaces: DIM_BEHIND[look.draw],
    outline: look.highlight,
    box: look.box && { ...look.box, colour: [...rgbFromPacked(palette.box), 0.9] },
    plane: look.plane,
    pixel_ratio: pixelRatio,
  };
}
