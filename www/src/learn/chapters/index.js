/** The live figure of each chapter, by its name in the page's markup. Its script is loaded on demand. */

/** @import { Context } from '../types.js' */

/** @type {Record<string, (context: Context) => Promise<(Node | null)[]>>} */
export const FIGURES = {
  opening: async (context) => (await import('./judge.js')).opening(context),
  measures: async (context) => (await import('./measures.js')).measures(context),
  plane: async (context) => (await import('./plane.js')).plane(context),
  rings: async (context) => (await import('./rings.js')).rings(context),
  seams: async (context) => (await import('./seams.js')).seams(context),
  draws: async (context) => (await import('./judge.js')).draws(context),
  circle: async (context) => (await import('./circle.js')).circle(context),
  first: async (context) => (await import('./particle.js')).whoWasFirst(context),
  angles: async () => (await import('./angles.js')).angles(),
  sizes: async (context) => (await import('./sizes.js')).sizes(context),
  cost: async (context) => (await import('./cost.js')).cost(context),
};
