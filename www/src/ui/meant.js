/** Finds the surfaces that a user means by typing words instead of a formula. */

/** @import { Description } from '../engine/types.js' */

/** Largest number of surfaces offered. */
const MOST = 3;
/** Shortest word that names a surface: shorter ones are parameters. */
const SHORTEST = 3;

/**
 * Returns the surfaces whose name or search words occur in the typed text, best match first.
 * @param {Pick<Description, 'surfaces' | 'models'>} description
 * @param {string} text
 */
export function meantBy({ surfaces, models }, text) {
  const typed = text.toLowerCase();
  // Only words and numbers; anything else is a formula.
  if (!/^[\p{L}\d\s'’.-]*$/u.test(typed) || /(^|\s)[xyz](\s|$)/.test(typed)) return [];
  const words = typed.split(/[\s.-]+/).filter((word) => word.length >= SHORTEST && !/\d/.test(word));
  /** @param {{ id: string, name: string, words?: string }} entry */
  const weigh = ({ id, name, words: others = '' }) => {
    const own = name.toLowerCase().split(/[\s.-]+/);
    const known = others.split(' ');
    const weight = words.reduce((sum, word) => sum + (own.includes(word) ? 3 : known.includes(word) ? 1 : 0), 0);
    // Among names that match equally, the one with fewer words is better.
    return { id, name, weight: weight === 0 ? 0 : weight - own.length / 100 };
  };
  const found = [...surfaces, ...models].map(weigh).filter(({ weight }) => weight > 0);
  found.sort((a, b) => b.weight - a.weight);
  // A match in a name excludes matches in mere search words.
  const best = found[0]?.weight ?? 0;
  return found.filter(({ weight }) => Math.ceil(weight) === Math.ceil(best)).slice(0, MOST);
}

/** Names the surfaces in a question. @param {readonly { name: string }[]} meant */
export function questionOf(meant) {
  const names = meant.map(({ name }) => `the ${name}`);
  const last = names.pop();
  return `Did you mean ${names.length > 0 ? `${names.join(', ')} or ${last}` : last}?`;
}
