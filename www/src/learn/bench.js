/** The bench on which two runs are compared, and the cards that lead to it. */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h } from '../ui/dom.js';
import { BENCH } from './address.js';
import { createPair } from './pair.js';
import { createSelect } from './parts.js';
import { seedAt, setupOf, sidesOf, WHAT_IFS, whatIfOf } from './whatifs.js';

/** @import { Control, Lab, Setup } from './types.js' */

/** Stops of the bench in the address: one for each choice. */
export const stopsOfBench = WHAT_IFS.map(({ id }) => `${BENCH}-${id}`);

/**
 * @param {HTMLElement} host
 * @param {Lab} lab
 * @param {{ setup?: Setup, locks?: readonly Control[], onChoice?: (setup: Setup) => void }} [how]
 *   `locks`: controls that stay as they are; `onChoice` is told what the learner chooses
 */
export function createBench(
  host,
  lab,
  { setup: first = setupOf(WHAT_IFS[0].id), locks = [], onChoice = () => {} } = {},
) {
  const pair = createPair(lab);
  const look = h('p', { class: 'look' });
  const chosen = h('div', { class: 'controls' });
  let setup = first;
  const what = createSelect({
    name: 'What changes',
    choices: WHAT_IFS.map(({ id, name }) => ({ value: id, label: name })),
    value: setup.what,
    change: (id) => choose(setupOf(id)),
  });
  what.select.disabled = locks.includes('what');

  /** @param {Setup} next */
  function choose(next) {
    void show(next);
    onChoice(next);
  }

  /** @param {Setup} next */
  async function show(next) {
    setup = next;
    const whatIf = whatIfOf(setup.what);
    what.select.value = whatIf.id;
    look.textContent = whatIf.look;
    const sides = /** @type {const} */ (['left', 'right']).map((side, k) => {
      const control = createSelect({
        name: k === 0 ? 'Left' : 'Right',
        choices: withOwn(whatIf.values, setup[side]),
        value: setup[side],
        change: (value) => choose({ ...setup, [side]: value }),
      });
      control.select.disabled = locks.includes(side);
      return control.element;
    });
    fill(chosen, what.element, sides);
    // The picture on the right begins where one of the two is pressed.
    const seeds = (/** @type {number[]} */ place) => choose({ ...setup, right: seedAt(place) });
    pair.pickWith(setup.what === 'seed' && !locks.includes('right') ? seeds : null);
    await pair.show(sidesOf(whatIf, [setup.left, setup.right]), whatIf.colouring);
  }

  fill(host, chosen, look, pair.element);
  return { show, pair, setup: () => setup };
}

/**
 * The values to choose from, with one that was found otherwise.
 * @param {readonly { value: string, label: string }[]} values
 * @param {string} own
 */
const withOwn = (values, own) =>
  values.some(({ value }) => value === own) ? values : [...values, { value: own, label: own }];

/** Gives each card that has one a button that shows both. @param {HTMLElement} cards @param {Lab} lab */
export function mountCards(cards, lab) {
  for (const card of cards.querySelectorAll('.card')) {
    const id = card.getAttribute('data-what-if');
    if (!id) continue;
    const title = card.querySelector('h3')?.textContent ?? '';
    const isOpen = signal(false);
    const place = h('div', { class: 'card-pair', hidden: () => !isOpen.value });
    /** @type {ReturnType<typeof createPair> | null} */
    let pair = null;
    const press = () => {
      isOpen.value = !isOpen.peek();
      card.toggleAttribute('data-open', isOpen.peek());
      if (pair || !isOpen.peek()) return;
      pair = createPair(lab);
      const whatIf = whatIfOf(id);
      const { left, right } = setupOf(id);
      fill(place, h('p', { class: 'look' }, whatIf.look), pair.element);
      void pair.show(sidesOf(whatIf, [left, right]), whatIf.colouring);
    };
    card.append(
      button({ 'aria-expanded': () => String(isOpen.value), 'aria-label': `Show both: ${title}`, press }, 'Show both'),
      place,
    );
  }
}
