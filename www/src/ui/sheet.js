/** Loads the style sheet of a part of the page on demand. */
import { h } from './dom.js';

/** @param {string} href @returns {Promise<void>} */
export function loadSheet(href) {
  return new Promise((resolve, reject) => {
    const failed = () => {
      link.remove();
      reject(new Error('a style sheet did not load'));
    };
    const link = h('link', { rel: 'stylesheet', href, on: { load: () => resolve(), error: failed } });
    document.head.append(link);
  });
}
