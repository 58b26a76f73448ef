/** Tells the event of the timeline in words, on the panel and to assistive technology. */
import { tell } from '../../figures/words.js';
import { h, live } from '../dom.js';

/** @import { Follower } from './types.js' */

/** Shortest interval between announcements to assistive technology, and the rest before one. */
const ANNOUNCE_MS = 1500;
const REST_MS = 400;

/** @param {Follower} follower */
export function createTold(follower) {
  const told = h('p', { class: 'follow-told', 'aria-hidden': 'true' }, () => toldWords(follower));
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  announce(follower, spoken);
  return h('div', { class: 'follow-stepper' }, told, spoken);
}

/** @param {Follower} follower */
function toldWords({ opened, moment, rest }) {
  if (!opened.value) return '';
  if (rest.status.value) return rest.status.value.text;
  return moment.value
    ? tell(moment.value, opened.value.subject)
    : 'This particle still waited in the queue when the run reached its limit, so it has no events.';
}

/**
 * Announces the event once the steps pause, and not more often than the interval.
 * @param {Follower} follower
 * @param {HTMLElement} spoken
 */
function announce(follower, spoken) {
  let last = -Infinity;
  let timer = 0;
  live(spoken, () => {
    const words = toldWords(follower);
    clearTimeout(timer);
    const wait = Math.max(REST_MS, last + ANNOUNCE_MS - performance.now());
    timer = window.setTimeout(() => {
      last = performance.now();
      spoken.textContent = words;
    }, wait);
  });
}
