/** Files of points: what is read, and how a drag is told from others. Pure. */
import { FILE_TYPES, LARGEST_FILE_BYTES } from '../../engine/types.js';

/** PLY, OBJ … in words for a person; `.txt` is only another name for XYZ. */
export const FORMATS = FILE_TYPES.split(',')
  .filter((type) => type !== '.txt')
  .map((type) => type.slice(1).toUpperCase());

/** @param {string[]} words */
export const listOf = (words) =>
  words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} or ${words.at(-1)}`;

export const LIMIT = `${Math.round(LARGEST_FILE_BYTES / 1e6)}\u202fMB`;

/** Whether a drag carries files, and not text or a picture of the page. @param {{ types: readonly string[] } | null} transfer */
export const carriesFiles = (transfer) => transfer?.types.includes('Files') ?? false;

/** What can be done about a refused file or model, by the core's word for the reason. @type {Record<string, string>} */
const ADVICE = {
  too_large: `Thin the points out, or save fewer decimals: files up to ${LIMIT} are read.`,
  unreadable: 'Check that the file is still there and may be read.',
  crashed: 'The page is not harmed. Try another file; the report is worth sending with this one.',
  silent: 'Try fewer points.',
  bundle: 'Load the page again; if that does not help, the network or a filter keeps a part of it back.',
};

/**
 * What went wrong, in a person's words.
 * @param {import('../../engine/types.js').LoadingError} error
 */
export function describeLoadingError({ name, kind, message, line }) {
  const text = message.trim();
  return {
    title: `${name} could not be used`,
    text: `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? '' : '.'}`,
    line: line !== null && !text.includes(`line ${line}`) ? `Line ${line}` : '',
    advice: ADVICE[kind] ?? '',
  };
}
