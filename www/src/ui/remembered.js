/** What the browser keeps of a page, apart from what is in the link. */
import { effect, signal } from '@preact/signals-core';

/**
 * A text that is there again when the page is next opened; without storage it is lost when the page closes.
 * @param {string} name
 */
export function kept(name) {
  const key = `marching-particles.${name}`;
  let storage = /** @type {Storage | null} */ (null);
  try {
    storage = localStorage;
  } catch {
    // The browser allows none.
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
 * Returns a switch that has its last position again when the page is next opened.
 * @param {string} name
 * @param {boolean} usual  its position at first
 */
export function remembered(name, usual) {
  const { text, keep } = kept(name);
  const isOn = signal(text ? text === 'on' : usual);
  effect(() => keep(isOn.value ? 'on' : 'off'));
  return isOn;
}
