/** Finds the surfaces that a user means by typing words instead of a formula. */
import { slipsBetween } from '../engine/spelling.js';

/** @import { Description } from '../engine/types.js' */

/** Largest number of surfaces offered. */
const MOST = 3;
/** Shortest word that names a surface: shorter ones are parameters. */
const SHORTEST = 3;
/** Number of letters for each of which a word may have one wrong: five letters one, ten letters two. */
const LETTERS_A_SLIP = 5;
/** Words that say nothing of which surface is meant. */
const FILLERS = new Set(['the', 'show', 'draw', 'plot', 'make', 'please', 'surface']);

/**
 * Returns the surfaces whose name or search words occur in the typed text, best match first. A word of
 * a name counts among any other words. Search words, which are everyday words, and misspelt ones count only if the text
 * has no others.
 * @param {Pick<Description, 'surfaces' | 'models'>} description
 * @param {string} text
 */
export function meantBy({ surfaces, models }, text) {
  const typed = text.toLowerCase();
  // Only words and numbers; anything else is a formula.
  if (!/^[\p{L}\d\s'’.-]*$/u.test(typed) || /(^|\s)[xyz](\s|$)/.test(typed)) return [];
  const entries = [...surfaces, ...models].map((/** @type {{ id: string, name: string, words?: string }} */ entry) => ({
    ...entry,
    own: wordsOf(entry.name),
    others: wordsOf(entry.words ?? ''),
  }));
  const known = [...entries.flatMap(({ own }) => own), ...entries.flatMap(({ others }) => others)];
  const written = wordsOf(typed);
  const words = written.map((word) => spelt(word, known));
  if (words.length === 0) return [];
  const found = entries
    .map(({ id, name, own, others }) => {
      const named = words.filter((word) => own.includes(word)).length;
      const described = words.filter((word) => !own.includes(word) && others.includes(word)).length;
      const isMeant = named + described === words.length || written.some((word) => own.includes(word));
      // Among names that match equally, the one with fewer words is better.
      return { id, name, weight: isMeant ? 3 * named + described - wordCount(name) / 100 : 0 };
    })
    .filter(({ weight }) => weight > 0);
  found.sort((a, b) => b.weight - a.weight);
  // A match in a name excludes matches in mere search words.
  const best = found[0]?.weight ?? 0;
  return found.filter(({ weight }) => Math.ceil(weight) === Math.ceil(best)).slice(0, MOST);
}

/** The words of a text that may name a surface. @param {string} text */
const wordsOf = (text) =>
  text
    .toLowerCase()
    .split(/[\s.-]+/)
    .filter((word) => word.length >= SHORTEST && !/\d/.test(word) && !FILLERS.has(word));

/** @param {string} text */
const wordCount = (text) => text.split(/[\s.-]+/).length;

/**
 * Returns the known word nearest to a typed one, within the slips that its length allows; the typed word if there is
 * none.
 * @param {string} word @param {readonly string[]} known
 */
function spelt(word, known) {
  if (known.includes(word)) return word;
  let [nearest, least] = [word, Math.floor(word.length / LETTERS_A_SLIP) + 1];
  for (const other of known) {
    // A short word such as `ring` is near too many others.
    if (other.length < LETTERS_A_SLIP || Math.abs(other.length - word.length) >= least) continue;
    const slips = slipsBetween(word, other);
    if (slips < least) [nearest, least] = [other, slips];
  }
  return nearest;
}

/** Names the surfaces in a question. @param {readonly { name: string }[]} meant */
export function questionOf(meant) {
  const names = meant.map(({ name }) => `the ${name}`);
  const last = names.pop();
  return `Did you mean ${names.length > 0 ? `${names.join(', ')} or ${last}` : last}?`;
}
