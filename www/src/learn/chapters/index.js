/** The live figure of each chapter, by the name that the page's markup gives it. */
import { cost } from './cost.js';
import { rest, seams } from './rest.js';
import { opening, rings } from './rings.js';

/** @import { Context } from '../types.js' */

/** @type {Record<string, (context: Context) => Promise<(Node | null)[]>>} */
export const FIGURES = {
  why: opening,
  cost,
  plane: async (context) => (await import('./plane.js')).plane(context),
  moving: async (context) => (await import('./moving.js')).moving(context),
  circle: async (context) => (await import('./circle.js')).circle(context),
  first: async (context) => (await import('./particle.js')).whoWasFirst(context),
  rings,
  seams,
  rest,
  angles: async () => (await import('./angles.js')).angles(),
  sizes: async (context) => (await import('./sizes.js')).sizes(context),
};
