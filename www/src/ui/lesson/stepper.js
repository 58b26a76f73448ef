/** Goes through the events of a particle: buttons, a range, and the event in words. */
import { effect } from '@preact/signals-core';
import { tell, valueText } from '../../figures/words.js';
import { bindText, h } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount } from '../format.js';
import { icon } from '../icons.js';

/** @typedef {import('./follower.js').Follower} Follower */

/** Shortest interval between announcements to assistive technology, and the rest before one. */
const ANNOUNCE_MS = 1500;
const REST_MS = 400;

/** @param {Follower} follower */
export function createStepper(follower) {
  const range = h('input', { type: 'range', class: 'slider', min: 0, step: 1, 'aria-label': 'Event of the particle' });
  range.addEventListener('input', () => follower.seek(range.valueAsNumber));
  const told = h('p', { class: 'follow-told', 'aria-hidden': 'true' });
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  const count = h('p', { class: 'follow-count', 'aria-hidden': 'true' });
  bindText(told, () => wordsOf(follower));
  bindText(count, () => {
    const events = follower.opened.value?.events.length ?? 0;
    return events > 0 ? `${formatCount(follower.at.value + 1)} / ${formatCount(events)}` : '';
  });
  effect(() => {
    const { opened, moment, at } = follower;
    const last = Math.max(0, (opened.value?.events.length ?? 0) - 1);
    range.max = String(last);
    range.disabled = moment.value === null;
    range.valueAsNumber = at.value;
    range.style.setProperty('--place', String(last > 0 ? at.value / last : 0));
    const text = opened.value && moment.value ? valueText(moment.value, opened.value.subject) : 'No events';
    range.setAttribute('aria-valuetext', text);
  });
  announce(follower, spoken);
  const element = h(
    'div',
    { class: 'follow-stepper' },
    told,
    spoken,
    h('div', { class: 'follow-line' }, buttonsOf(follower), count),
    range,
  );
  return { element, focus: () => range.focus({ preventScroll: true }) };
}

/** @param {Follower} follower */
function wordsOf({ opened, moment }) {
  if (!opened.value) return '';
  return moment.value
    ? tell(moment.value, opened.value.subject)
    : 'This particle still waited in the queue when the run reached its limit, so it has no events.';
}

/** @param {Follower} follower */
function buttonsOf(follower) {
  const can = {
    back: () => follower.at.value > 0,
    forward: () =>
      follower.moment.value !== null && follower.at.value < (follower.opened.value?.events.length ?? 0) - 1,
    any: () => follower.moment.value !== null,
  };
  const toggle = button('play', 'Play', '', () => follower.toggle(), can.any);
  effect(() => {
    toggle.setAttribute('aria-label', follower.playing.value ? 'Pause' : 'Play');
    toggle.replaceChildren(icon(follower.playing.value ? 'pause' : 'play'));
  });
  return h(
    'div',
    { class: 'levels-buttons', role: 'group', 'aria-label': 'Step through the events' },
    button('first', 'First event', 'Key Home', () => follower.seek(0), can.back),
    button('back', 'Event back', 'Key ←', () => follower.step(-1), can.back),
    toggle,
    button('forward', 'Event forward', 'Key →', () => follower.step(1), can.forward),
    button('last', 'Last event', 'Key End', () => follower.seek(follower.last), can.forward),
  );
}

/**
 * @param {import('../icons.js').IconName} name @param {string} label @param {string} text
 * @param {() => void} act @param {() => boolean} enabled
 */
function button(name, label, text, act, enabled) {
  const press = () => {
    if (element.getAttribute('aria-disabled') !== 'true') act();
  };
  const element = h(
    'button',
    { type: 'button', class: 'button plain square', 'aria-label': label, on: { click: press } },
    icon(name),
  );
  effect(() => element.setAttribute('aria-disabled', String(!enabled())));
  if (text) explain(element, () => ({ title: label, text }));
  return element;
}

/** Announces the event once the steps pause, and not more often than the interval. @param {Follower} follower @param {HTMLElement} spoken */
function announce(follower, spoken) {
  let last = -Infinity;
  let timer = 0;
  effect(() => {
    const words = wordsOf(follower);
    clearTimeout(timer);
    const wait = Math.max(REST_MS, last + ANNOUNCE_MS - performance.now());
    timer = window.setTimeout(() => {
      last = performance.now();
      spoken.textContent = words;
    }, wait);
  });
}
