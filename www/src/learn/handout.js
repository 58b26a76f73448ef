/** The hand-out: the article on paper, with blanks for the predictions and their answers on the last page. */
import { fill, h } from '../ui/dom.js';
import { reasonOf } from './figure.js';
import { PREDICTIONS } from './predictions.js';

/**
 * @param {HTMLElement} host  the last page
 * @param {object} about
 * @param {readonly import('./figure.js').Figure[]} about.figures
 * @param {Promise<import('./lab.js').Lab>} about.lab
 */
export function createHandout(host, { figures, lab }) {
  const title = host.querySelector('h2');
  const hint = h('p', null, 'The answers come from the run. Print from the page’s own button to have them here.');
  fill(host, title, hint);
  host.hidden = false;

  /** Makes every figure and asks the run for every answer. */
  async function prepare() {
    for (const { load } of figures) await load();
    const ready = await lab;
    const list = h('ol', { class: 'answer-list' });
    for (const [id, prediction] of Object.entries(PREDICTIONS)) {
      const question = document.querySelector(`#${id} .predict-question`)?.textContent ?? '';
      const words = await prediction.answer(ready, null).then(
        (answer) => answer.words,
        (error) => reasonOf(error),
      );
      list.append(h('li', null, h('p', { class: 'answer-question' }, question), h('p', null, words)));
    }
    fill(host, title, list);
  }

  const button = h('button', { type: 'button', class: 'button plain', on: { click: () => void press() } }, 'Print');
  async function press() {
    button.disabled = true;
    button.textContent = 'Preparing';
    try {
      await prepare();
    } finally {
      button.disabled = false;
      button.textContent = 'Print';
    }
    print();
  }
  return { button, prepare };
}
