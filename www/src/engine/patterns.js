/**
 * The patterns of particles: that of a front, which is relaxed, and those that are not.
 *
 * @module
 */

/** @import { Pattern, Settings } from './types.js' */

/**
 * The pattern of a run with these settings. The refined method makes hexagons, whatever pattern is chosen.
 * @param {Settings} settings @returns {Pattern}
 */
export const patternOf = ({ method, pattern = 'hexagonal' }) =>
  method === 'refined' ? 'hexagonal' : /** @type {Pattern} */ (pattern);

/** Why particles of a pattern cannot be relaxed; empty if they can. @param {Pattern} pattern */
export function unrelaxed(pattern) {
  if (pattern === 'hexagonal') return '';
  const name = pattern === 'blue' ? 'Blue noise is' : 'Random points are';
  return `${name} not relaxed: repulsion would undo the pattern. Relaxation is for hexagonal particles.`;
}
