/** Choices of the page that the browser keeps, apart from what is in the link. */
import { effect, signal } from '@preact/signals-core';

/**
 * Returns a switch that has its last position again when the page is next opened.
 * @param {string} name
 * @param {boolean} usual  its position at first
 */
export function remembered(name, usual) {
  const key = `marching-particles.${name}`;
  let storage = /** @type {Storage | null} */ (null);
  try {
    storage = localStorage;
  } catch {
    // Without storage the choice is lost when the page closes.
  }
  const stored = storage?.getItem(key);
  const isOn = signal(stored ? stored === 'on' : usual);
  effect(() => {
    try {
      storage?.setItem(key, isOn.value ? 'on' : 'off');
    } catch {
      // The storage is full.
    }
  });
  return isOn;
}
