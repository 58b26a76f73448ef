/**
 * The fragment of the lesson's address: the stop, then further parts, such as `#rings&surface=…&task=…`. A stop alone
 * is an ordinary anchor, which works without scripts.
 */

/** Parts that may follow the stop in a fragment. */
const PARTS = ['surface', 'task', 'on', 'left', 'right', 'particle'];
/** The chapter with the bench: its stops alone have a surface and two samplings. */
export const BENCH = 'what-if';
const OF_BENCH = ['on', 'left', 'right'];
/** @param {string} stop */
export const isBench = (stop) => stop === BENCH || stop.startsWith(`${BENCH}-`);
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
  'predict-hole': 'predict-seam',
  'predict-cost': 'predict-pushes',
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
  const own = PARTS.filter((name) => parts[name] && (isBench(stop) || !OF_BENCH.includes(name)));
  const pairs = own.map((name) => `${name}=${encodeURIComponent(parts[name])}`);
  const pieces = [...(stop ? [encodeURIComponent(stop)] : []), ...pairs];
  return pieces.length > 0 ? `#${pieces.join('&')}` : '';
}

/** The title or the question of a stop. @param {Element | null} stop */
export const titleOf = (stop) =>
  stop?.querySelector(':is(.predict-question, .challenge-title, h2, caption)')?.textContent ?? '';

/**
 * The stop for a name: the one with this name, else the one that replaced it; empty without either.
 * @param {string} name @param {readonly string[]} stops
 */
export function stopFor(name, stops) {
  if (stops.includes(name)) return name;
  if (isBench(name)) return BENCH;
  return Object.hasOwn(GONE, name) ? GONE[name] : '';
}
