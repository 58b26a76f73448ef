/**
 * Keeps the state in the fragment of the page's address: writes it shortly after a change and reads it from a link.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** @import { Engine } from '../engine/types.js' */

/** Delay between a change and its write. Browsers refuse more than about 100 address changes in 30 seconds. */
const ADDRESS_MS = 500;

/** @param {Engine} engine */
export function keepAddress(engine) {
  /** The fragment last written by the page. Any other fragment comes from the user. */
  let own = location.hash;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  addEventListener('hashchange', () => {
    if (location.hash === own) return;
    own = location.hash;
    if (engine.description.value) void engine.openLink(own);
  });
  async function write() {
    if (!engine.description.value) return;
    const link = await engine.link();
    if (link === own) return;
    own = link;
    history.replaceState(history.state, '', link || location.pathname + location.search);
  }
  effect(() => {
    // Reading the whole state makes the effect run after any change of it.
    void engine.state.value;
    clearTimeout(timer);
    timer = setTimeout(write, ADDRESS_MS);
  });
}
