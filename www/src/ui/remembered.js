/** What the browser stores for a page, apart from the contents of the link. */
import { effect, signal } from '@preact/signals-core';

/**
 * A text that is stored for the next visit; without storage it is lost when the page closes.
 * @param {string} name
 */
export function kept(name) {
  const key = `marching-particles.${name}`;
  let storage = /** @type {Storage | null} */ (null);
  try {
    storage = localStorage;
  } catch {
    // The browser allows no storage.
  }
  return {
    text: storage?.getItem(key) ?? '',
    /** @param {string} text */
    keep(text) {
      try {
        storage?.setItem(key, text);
      } catch {
        // The storage is full.
      }
    },
  };
}

/**
 * Returns a switch whose position is stored for the next visit.
 * @param {string} name
 * @param {boolean} usual  its position at first
 */
export function remembered(name, usual) {
  const { text, keep } = kept(name);
  const isOn = signal(text ? text === 'on' : usual);
  effect(() => keep(isOn.value ? 'on' : 'off'));
  return isOn;
}
