/**
 * The hand-out: the article on paper, with blanks for the predictions and their answers on the last page. The answers
 * come from the run, and a browser does not wait for one when it prints: so they are asked for as their figures come to
 * life, and the page's own button and the keys for printing wait for the rest.
 */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { byId, fill, h } from '../ui/dom.js';
import { FIGURES } from './chapters/index.js';
import { reasonOf } from './figure.js';
import { Stops } from './predict.js';
import { PREDICTIONS } from './predictions.js';

/** @import { HandoutOptions } from './types.js' */

const UNKNOWN = 'The run has not been asked yet. Print from the page’s own button to have the answer here.';

/** After so many frames a picture has turned. */
const FRAMES = 60;
/** The questions whose figure withholds something until they are answered: it is shown with the answer. */
const WITHHELD = ['predict-cost', 'predict-ring', 'predict-hole'];

/**
 * @param {HTMLElement} host  the last page
 * @param {HandoutOptions} about
 */
export function createHandout(host, { figures, lab, compare, say }) {
  const title = host.querySelector('h2');
  /** The answers of the run, by the id of the question. @type {Map<string, string>} */
  const known = new Map();
  const ids = Object.keys(PREDICTIONS);
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
        h('p', null, known.get(id) ?? UNKNOWN),
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
  // The figure of a chapter has made the runs that its questions ask.
  for (const { stage, ready } of figures)
    void ready.then(async () => {
      for (const { id } of stage.closest('.chapter')?.querySelectorAll('.predict') ?? []) await ask(id).catch(() => {});
    });

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

  const isWhole = () => known.size === ids.length;
  const isPreparing = signal(false);
  const print = button({ class: 'plain', disabled: () => isPreparing.value, press: () => void press() }, () =>
    isPreparing.value ? 'Preparing' : 'Print',
  );
  async function press() {
    if (isPreparing.peek()) return;
    isPreparing.value = true;
    try {
      await prepare();
    } finally {
      isPreparing.value = false;
    }
    window.print();
  }
  addEventListener('keydown', (event) => {
    const isPrint = (event.ctrlKey || event.metaKey) && !event.altKey && !event.shiftKey && event.key === 'p';
    if (!isPrint || isWhole()) return;
    event.preventDefault();
    void press();
  });
  addEventListener('beforeprint', write);
  addEventListener('afterprint', () => {
    if (!isWhole()) say('Not all answers were known when this was printed. The button “Print” waits for them.');
  });
  return { button: print };
}
