/** The bench on which two runs are compared, and the cards that lead to it. */
import { fill, h } from '../ui/dom.js';
import { createPair } from './pair.js';
import { createSelect } from './parts.js';
import { sidesOf, WHAT_IFS } from './whatifs.js';

/**
 * @typedef {import('./lab.js').Lab} Lab
 * @typedef {import('./whatifs.js').WhatIf} WhatIf
 */
/** What stands on the bench. @typedef {{ what: string, left: string, right: string }} Setup */

/** Stops of the bench in the address: one for each choice. */
export const STOP = 'what-if';
export const stopsOfBench = WHAT_IFS.map(({ id }) => `${STOP}-${id}`);

/** @param {string} id */
const whatIfOf = (id) => WHAT_IFS.find((whatIf) => whatIf.id === id) ?? WHAT_IFS[0];

/** The setup with which a choice is first shown. @param {string} id @returns {Setup} */
export function setupOf(id) {
  const { id: what, values } = whatIfOf(id);
  return { what, left: values[0].value, right: values[1].value };
}

/**
 * @param {HTMLElement} host @param {Lab} lab @param {{ locked?: Setup | null, onShow?: (setup: Setup) => void }} [how]  `locked`: it shows this
 *   and nothing else
 */
export function createBench(host, lab, { locked = null, onShow = () => {} } = {}) {
  const pair = createPair(lab);
  const look = h('p', { class: 'look' });
  const chosen = h('div', { class: 'controls' });
  let setup = locked ?? setupOf(WHAT_IFS[0].id);
  const what = createSelect({
    name: 'What changes',
    choices: WHAT_IFS.map(({ id, name }) => ({ value: id, label: name })),
    value: setup.what,
    change: (id) => void show(setupOf(id)),
  });
  what.select.disabled = locked !== null;

  /** @param {Setup} next */
  async function show(next) {
    setup = locked ?? next;
    const whatIf = whatIfOf(setup.what);
    what.select.value = whatIf.id;
    look.textContent = whatIf.look;
    const sides = /** @type {const} */ (['left', 'right']).map((side, k) => {
      const control = createSelect({
        name: k === 0 ? 'Left' : 'Right',
        choices: whatIf.values,
        value: setup[side],
        change: (value) => void show({ ...setup, [side]: value }),
      });
      control.select.disabled = locked !== null;
      return control.element;
    });
    fill(chosen, what.element, sides);
    onShow(setup);
    await pair.show(sidesOf(whatIf, [setup.left, setup.right]), whatIf.colouring);
  }

  fill(host, chosen, look, pair.element);
  return { show, pair, setup: () => setup };
}

/** Gives each card that has one a button that shows both. @param {HTMLElement} cards @param {Lab} lab */
export function mountCards(cards, lab) {
  for (const card of cards.querySelectorAll('.card')) {
    const { whatIf: id } = /** @type {HTMLElement} */ (card).dataset;
    if (!id) continue;
    const title = card.querySelector('h3')?.textContent ?? '';
    const place = h('div', { class: 'card-pair', hidden: true });
    /** @type {ReturnType<typeof createPair> | null} */
    let pair = null;
    const press = () => {
      place.hidden = !place.hidden;
      button.setAttribute('aria-expanded', String(!place.hidden));
      card.toggleAttribute('data-open', !place.hidden);
      if (pair || place.hidden) return;
      pair = createPair(lab);
      const whatIf = whatIfOf(id);
      const { left, right } = setupOf(id);
      fill(place, h('p', { class: 'look' }, whatIf.look), pair.element);
      void pair.show(sidesOf(whatIf, [left, right]), whatIf.colouring);
    };
    const button = h(
      'button',
      {
        type: 'button',
        class: 'button',
        'aria-expanded': 'false',
        'aria-label': `Show both: ${title}`,
        on: { click: press },
      },
      'Show both',
    );
    card.append(button, place);
  }
}
