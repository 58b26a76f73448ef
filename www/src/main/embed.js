/**
 * Shows the picture alone, for a page that embeds this one in a frame, and answers that page's messages. See
 * docs/page.md.
 */
import { byId } from '../ui/dom.js';
import { loadSheet } from '../ui/sheet.js';
import sheet from './embed.css?url';

/** @import { Console, Request } from './types.js' */

/** The type of all messages in both directions. */
const TYPE = 'marching-particles';

/**
 * @param {Console} p
 * @param {string} parts  shown with the picture, separated by commas
 */
export function embed(p, parts) {
  Object.assign(byId('shell').dataset, { hidden: 'all', embed: parts.split(',').join(' ') });
  // Without the style sheet the picture still works.
  loadSheet(sheet).catch(() => {});
  const { parent } = window;
  if (parent === window) return;
  /** @type {Record<string, (value: any) => unknown>} */
  const calls = { set: (value) => p.set({ ...value }), get: () => p.state, report: () => p.report() };
  addEventListener('message', async ({ source, origin, data }) => {
    if (source !== parent || data?.type !== TYPE || !Object.hasOwn(calls, data.call)) return;
    const { call, id = null, value } = /** @type {Request} */ (data);
    // A document without an origin, such as a file, can only be answered at any origin.
    const to = origin === 'null' ? '*' : origin;
    try {
      parent.postMessage({ type: TYPE, call, id, value: await calls[call](value) }, to);
    } catch (error) {
      parent.postMessage({ type: TYPE, call, id, error: error instanceof Error ? error.message : String(error) }, to);
    }
  });
  // The parent's origin is not known yet, and this message is not confidential.
  void p.ready.then(() => parent.postMessage({ type: TYPE, call: 'ready', id: null, value: p.version }, '*'));
}
