/** Entry point of the lesson's page of cards, which compare the paper with the program. */
import '../ui/trusted.js';
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { fill, h, queryAll } from '../ui/dom.js';
import { storeSite } from '../ui/offline.js';
import { openSubject } from './lesson-lab.js';
import { createPair } from './pair.js';
import { setupOf, sidesOf, whatIfOf } from './whatifs.js';

const { lab } = openSubject();

/** Adds a button to a card that shows both variants. @param {HTMLElement} card @param {string} id of the choice */
function mountCard(card, id) {
  const title = card.querySelector('h3')?.textContent ?? '';
  const isOpen = signal(false);
  const place = h('div', { class: 'card-pair', hidden: () => !isOpen.value });
  let isMade = false;
  async function press() {
    isOpen.value = !isOpen.peek();
    card.toggleAttribute('data-open', isOpen.peek());
    if (isMade || !isOpen.peek()) return;
    isMade = true;
    const pair = createPair();
    const whatIf = whatIfOf(id);
    const { left, right } = setupOf(id, { right: card.dataset.right });
    fill(place, h('p', { class: 'look' }, whatIf.look), pair.element);
    await pair.show({ lab: await lab, sides: sidesOf(whatIf, [left, right]), whatIf });
  }
  const expanded = () => String(isOpen.value);
  card.append(
    button({ 'aria-expanded': expanded, 'aria-label': `Show both: ${title}`, press: () => void press() }, 'Show both'),
    place,
  );
}

for (const card of queryAll(document, '.card[data-what-if]')) mountCard(card, card.dataset.whatIf ?? '');
storeSite('../../service-worker.js');
