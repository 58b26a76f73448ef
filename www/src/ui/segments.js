/** Messages in which code stands between backticks, as the core writes them. */

/**
 * Splits a message into segments.
 * @param {string} message
 */
export function segmentsOf(message) {
  const parts = message.split('`');
  // An unpaired backtick is a character of the formula.
  if (parts.length % 2 === 0) return [{ text: message, code: false }];
  return parts.map((text, i) => ({ text, code: i % 2 === 1 })).filter(({ text }) => text !== '');
}

/** Returns the first sentence and the others. @param {string} text */
export function sentencesOf(text) {
  const [first, ...rest] = text.split(/(?<=\.) (?=[A-Z])/);
  return { first, rest: rest.join(' ') };
}
