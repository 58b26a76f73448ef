/**
 * The hand-out: the article on paper, with blanks for the predictions and their answers on the last page. The answers
 * come from the run, and a browser does not wait for one when it prints: the page's own button and the keys for
 * printing do.
 */
import { byId, fill, h } from '../ui/dom.js';
import { Stops } from './answers.js';
import { FIGURES } from './chapters/index.js';
import { reasonOf } from './figure.js';
import { PREDICTIONS } from './predictions.js';

/** @import { HandoutOptions } from './types.js' */

/** After so many frames a picture has turned. */
const FRAMES = 60;
/** The questions whose figure withholds something until they are answered: it is shown with the answer. */
const WITHHELD = ['predict-cost', 'predict-ring'];

/**
 * @param {HTMLElement} host  the last page
 * @param {HandoutOptions} about
 */
export function createHandout(host, { figures, lab, compare }) {
  const title = host.querySelector('h2');
  /** The answers of the run, by the id of the question. @type {Map<string, string>} */
  const known = new Map();
  // In the order of the article.
  const ids = Array.from(document.querySelectorAll('.predict'), ({ id }) => id).filter((id) => id in PREDICTIONS);
  /** Figures of questions that are answered. @type {Map<string, Element>} */
  const shown = new Map();
  const open = new Stops();
  for (const id of ids) open.state(id).value = true;

  function write() {
    const rows = ids.map((id) => {
      const question = document.querySelector(`#${id} .predict-question`)?.textContent ?? '';
      return h(
        'li',
        null,
        h('p', { class: 'answer-question' }, question),
        h('p', null, known.get(id) ?? ''),
        shown.get(id),
      );
    });
    fill(host, title, h('ol', { class: 'answer-list' }, rows));
  }
  write();
  host.hidden = false;

  /** @param {string} id */
  async function ask(id) {
    if (known.has(id)) return;
    const answer = await PREDICTIONS[id].answer(await lab, null);
    known.set(id, answer.words);
  }
  /** Makes the figure of an answered question. @param {string} id */
  async function show(id) {
    const name = byId(id).closest('.chapter')?.querySelector('figure > .stage')?.getAttribute('data-figure') ?? '';
    if (!shown.has(id)) shown.set(id, h('div', { class: 'stage' }, await FIGURES[name]({ lab, stops: open })));
  }

  /** Makes every figure and asks the run for every answer. */
  async function prepare() {
    for (const { load } of figures) await load();
    for (const id of ids) await ask(id).catch((error) => known.set(id, reasonOf(error)));
    await compare();
    // An image that was never on the screen is not loaded yet.
    for (const image of document.querySelectorAll('.what-if-stills img')) {
      if (!(image instanceof HTMLImageElement)) continue;
      image.loading = 'eager';
      await image.decode().catch(() => {});
    }
    for (const id of WITHHELD) await show(id).catch(() => {});
    write();
    // The pictures take their sizes, and that of the hole turns to it.
    for (let frame = 0; frame < FRAMES; frame += 1) await new Promise(requestAnimationFrame);
  }

  let isPreparing = false;
  addEventListener('beforeprint', write);
  return {
    /** Prints once every answer is known. */
    async print() {
      if (isPreparing) return;
      isPreparing = true;
      try {
        await prepare();
      } finally {
        isPreparing = false;
      }
      window.print();
    },
  };
}
