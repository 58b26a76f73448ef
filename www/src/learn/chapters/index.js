/** The live figure of each chapter, by the name that the page's markup gives it. */
import { cost } from './cost.js';
import { judge } from './judge.js';
import { rings } from './rings.js';
import { seams } from './seams.js';

/** @import { Context } from '../types.js' */

/** @type {Record<string, (context: Context) => Promise<(Node | null)[]>>} */
export const FIGURES = {
  'judge-first': (context) => judge(context, 'first'),
  plane: async (context) => (await import('./plane.js')).plane(context),
  circle: async (context) => (await import('./circle.js')).circle(context),
  first: async (context) => (await import('./particle.js')).whoWasFirst(context),
  rings,
  seams,
  cost,
  angles: async () => (await import('./angles.js')).angles(),
  sizes: async (context) => (await import('./sizes.js')).sizes(context),
  'judge-last': (context) => judge(context, 'last'),
  moving: async (context) => (await import('./moving.js')).moving(context),
};
