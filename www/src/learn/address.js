/**
 * The fragment of the lesson's address: the stop, then further parts, such as `#rings&surface=…&task=…`. A stop alone
 * is an ordinary anchor, which works without scripts.
 */

/** Parts that may follow the stop in a fragment. */
const PARTS = ['surface', 'task', 'on', 'left', 'right', 'particle'];
/** Names of stops for comparisons begin with this; only these stops have a surface and two values. */
export const BENCH = 'what-if';
const OF_BENCH = ['on', 'left', 'right'];
/**
 * Stops that the lesson once had, and the stops that replace them.
 * @type {Record<string, string>}
 */
const GONE = {
  race: 'cost',
  moving: 'cost',
  'predict-moving': 'cost',
  'predict-last': 'judge',
  'predict-few': 'judge',
  'predict-chance': 'judge',
};

/** @typedef {{ stop: string, parts: Record<string, string> }} Address */

/** @param {string} fragment  with or without `#` @returns {Address} */
export function readAddress(fragment) {
  let stop = '';
  /** @type {Record<string, string>} */
  const parts = {};
  for (const piece of fragment.replace(/^#/, '').split('&')) {
    const at = piece.indexOf('=');
    const name = piece.slice(0, at);
    if (at < 0) stop ||= decoded(piece);
    else if (PARTS.includes(name)) parts[name] = decoded(piece.slice(at + 1));
  }
  return { stop, parts };
}

/** @param {string} text */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** @param {Address} address */
export function writeAddress({ stop, parts }) {
  const isBench = stop.startsWith(`${BENCH}-`);
  const own = PARTS.filter((name) => parts[name] && (isBench || !OF_BENCH.includes(name)));
  const pairs = own.map((name) => `${name}=${encodeURIComponent(parts[name])}`);
  const pieces = [...(stop ? [encodeURIComponent(stop)] : []), ...pairs];
  return pieces.length > 0 ? `#${pieces.join('&')}` : '';
}

/** The title or the question of a stop. @param {Element | null} stop */
export const titleOf = (stop) =>
  stop?.querySelector(':is(.predict-question, .challenge-title, h2, caption)')?.textContent ?? '';

/**
 * Returns the stop for a name: the stop with this name, else the one that replaced it, else the one whose name differs
 * in the fewest letters; null for an empty name.
 * @param {string} name @param {readonly string[]} stops  at least one
 */
export function nearestStop(name, stops) {
  if (name === '') return null;
  if (stops.includes(name)) return { stop: name, isExact: true };
  if (Object.hasOwn(GONE, name)) return { stop: GONE[name], isExact: false };
  const distances = stops.map((stop) => editDistance(name.slice(0, LONGEST_NAME), stop));
  return { stop: stops[distances.indexOf(Math.min(...distances))], isExact: false };
}

const LONGEST_NAME = 64;

/** Number of letters to insert, delete or change (Levenshtein). @param {string} a @param {string} b */
function editDistance(a, b) {
  let row = Array.from({ length: b.length + 1 }, (_, j) => j);
  for (let i = 1; i <= a.length; i += 1) {
    const next = [i];
    for (let j = 1; j <= b.length; j += 1)
      next.push(Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1)));
    row = next;
  }
  return row[b.length];
}
