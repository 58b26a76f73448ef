/** The live figure of each chapter, by the name that the page's markup gives it. */
import { circle } from './circle.js';
import { cost } from './cost.js';
import { sixChildren, whoWasFirst } from './particle.js';
import { rest, seams } from './rest.js';
import { opening, rings } from './rings.js';
import { sizes } from './sizes.js';

/** @import { Context } from '../types.js' */

/** @type {Record<string, (context: Context) => Promise<(Node | null)[]>>} */
export const FIGURES = {
  why: opening,
  cost,
  plane: async (context) => (await import('./plane.js')).plane(context),
  moving: async (context) => (await import('./moving.js')).moving(context),
  six: sixChildren,
  circle,
  first: whoWasFirst,
  rings,
  seams,
  rest,
  sizes,
};
