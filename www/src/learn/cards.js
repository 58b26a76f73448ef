/** Entry point of the lesson's page of cards, which compare the paper with the program. */
import '../ui/trusted.js';
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h, queryAll } from '../ui/dom.js';
import { storeSite } from '../ui/offline.js';
import { openSubject } from './lesson-lab.js';
import { createMarkSwitch, isMarked } from './marks.js';
import { createPair } from './pair.js';
import { DECIDING } from './score.js';
import { knobsAgainst, WHAT_IFS } from './whatifs.js';

/** @import { WhatIf } from './types.js' */

const { lab } = openSubject();

/** Adds a button to a card that shows both variants. @param {HTMLElement} card @param {WhatIf} whatIf */
function mountCard(card, { look, sides, colouring, decides }) {
  const title = card.querySelector('h3')?.textContent ?? '';
  const isOpen = signal(false);
  const place = h('div', { class: 'card-pair', hidden: () => !isOpen.value });
  async function press() {
    isOpen.value = !isOpen.peek();
    card.toggleAttribute('data-open', isOpen.peek());
    if (place.childElementCount > 0) return;
    const pair = createPair(isMarked, createMarkSwitch());
    fill(place, h('p', { class: 'look' }, look), pair.element);
    const own = await lab;
    await pair.show({
      make: async () => [await sides[0].make(own), await sides[1].make(own)],
      labels: () => sides.map(({ label }) => label),
      card: () => ({ keys: decides ? [...DECIDING, decides] : DECIDING }),
      colouring,
    });
  }
  const expanded = () => String(isOpen.value);
  card.append(
    button({ 'aria-expanded': expanded, 'aria-label': `Show both: ${title}`, press: () => void press() }, 'Show both'),
    place,
  );
}

for (const card of queryAll(document, '.card')) {
  const { whatIf, knobs } = card.dataset;
  if (whatIf) mountCard(card, WHAT_IFS[whatIf]);
  else if (knobs) mountCard(card, knobsAgainst(knobs));
}
storeSite('../../service-worker.js');
