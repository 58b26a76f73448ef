/**
 * Keeps the state in the fragment of the page's address: writes it shortly after a change and reads it from a link.
 * Choosing another surface adds an entry to the browser's history, so that Back returns to the previous surface and its
 * view; other changes are written into the present entry.
 *
 * @module
 */
import { effect } from '@preact/signals-core';

/** @import { Engine, State } from '../engine/types.js' */

/** Delay between a change and its write. Browsers refuse more than about 100 address changes in 30 seconds. */
const ADDRESS_MS = 500;

/** Identifies the surface; a change of it makes a new history entry. @param {State} state */
const nameOf = ({ surface, formula }) => JSON.stringify([surface, formula]);

/** @param {Engine} engine @param {{ hasEntries: boolean }} how  `hasEntries`: surfaces are entries of the history */
export function keepAddress(engine, { hasEntries }) {
  /** The fragment last written by the page. Any other comes from the user. */
  let own = location.hash;
  /**
   * The surface of the present entry; null while it may still change, as during typing.
   * @type {string | null}
   */
  let entry = null;
  let isOpen = false;
  /** Number of fragments still to be read, one after the other. */
  let reading = 0;
  let last = Promise.resolve();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  addEventListener('hashchange', () => {
    if (location.hash === own) return;
    own = location.hash;
    if (!engine.description.value) return;
    reading += 1;
    last = last
      .then(() => read(own))
      .finally(() => {
        reading -= 1;
      });
  });
  /** @param {string} link */
  async function read(link) {
    // The theme belongs to the reader, not to a history entry.
    const { theme } = engine.state.value.view;
    await engine.openLink(link, { patch: { view: { theme } } });
    entry = nameOf(engine.state.value);
  }
  async function write() {
    if (!engine.description.value) return;
    const link = await engine.link();
    // The state before Back must not be written into the entry that Back leads to.
    if (reading > 0) return;
    const { trial, fieldError, state } = engine;
    const name = nameOf(state.value);
    const isNext = hasEntries && entry !== null && entry !== name;
    const isTried = trial.value === 'shown' || trial.value === 'typing';
    if (!isTried && fieldError.value === null) entry = name;
    else if (isNext) entry = null;
    if (link === own) return;
    own = link;
    history[isNext ? 'pushState' : 'replaceState'](history.state, '', link || location.pathname + location.search);
  }
  effect(() => {
    // Reading the whole state makes the effect run after any change of it, and after a typed formula has settled.
    void [engine.state.value, engine.trial.value, engine.fieldError.value];
    // The first surface is that of the opening entry, even if another is chosen before the first write.
    if (!isOpen && engine.description.value && engine.state.value.surface !== '') {
      isOpen = true;
      entry = nameOf(engine.state.value);
    }
    clearTimeout(timer);
    timer = setTimeout(write, ADDRESS_MS);
  });
}
