/**
 * Shows the picture alone, for a page that has this one in a frame, and answers the messages of that page. See
 * docs/page.md.
 */
import { byId } from '../ui/dom.js';
import { loadSheet } from '../ui/sheet.js';
import sheet from './embed.css?url';

/** @import { Console, Request } from './types.js' */

/** Name by which the messages of both sides are known. */
const TYPE = 'marching-particles';

/**
 * @param {Console} p
 * @param {string} parts  that are shown with the picture, with commas between them
 */
export function embed(p, parts) {
  Object.assign(byId('shell').dataset, { hidden: 'all', embed: parts.split(',').join(' ') });
  // Without the sheet the picture stands alone, which is the most of it.
  loadSheet(sheet).catch(() => {});
  const { parent } = window;
  if (parent === window) return;
  /** @type {Record<string, (value: any) => unknown>} */
  const calls = { set: (value) => p.set({ ...value }), get: () => p.state, report: () => p.report() };
  addEventListener('message', async ({ source, origin, data }) => {
    if (source !== parent || data?.type !== TYPE || !Object.hasOwn(calls, data.call)) return;
    const { call, id = null, value } = /** @type {Request} */ (data);
    // A document without an origin, such as a file, has no name by which it could be answered.
    const to = origin === 'null' ? '*' : origin;
    try {
      parent.postMessage({ type: TYPE, call, id, value: await calls[call](value) }, to);
    } catch (error) {
      parent.postMessage({ type: TYPE, call, id, error: error instanceof Error ? error.message : String(error) }, to);
    }
  });
  // The parent is not known yet, and this says nothing of anyone.
  void p.ready.then(() => parent.postMessage({ type: TYPE, call: 'ready', id: null, value: p.version }, '*'));
}
