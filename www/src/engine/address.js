/**
 * Keeps the state in the fragment of the page's address: writes it shortly after a change and reads it from a link.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { decode, encode } from './share/codec.js';
import { description } from './store.js';

/** Delay between a change and its write. Browsers refuse more than about 100 address changes in 30 seconds. */
const ADDRESS_MS = 500;

export class Address {
  /**
   * @param {object} parts
   * @param {import('./store.js').Store} parts.store
   * @param {() => boolean} parts.hasFile  whether a file is open, so that a link to it can be followed
   * @param {(state: import('./types.js').State) => void} parts.apply  adopts a valid state and samples it
   */
  constructor({ store, hasFile, apply }) {
    this.store = store;
    this.hasFile = hasFile;
    this.apply = apply;
    /** The fragment last written by the page. Any other fragment comes from the user. */
    this.own = location.hash;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    this.onHashChange = () => {
      if (location.hash === this.own) return;
      this.own = location.hash;
      if (store.description.value) void this.load(location.hash);
    };
    addEventListener('hashchange', this.onHashChange);
    this.stop = effect(() => {
      // Reading the whole state makes the effect run after any change of it.
      if (store.state.value) this.writeLater();
    });
  }

  /**
   * Reads a link and applies its state.
   * @param {string} hash
   * @param {boolean} [initial]  the first state of the page
   */
  async load(hash, initial = false) {
    const { notice } = this.store;
    const { state, reset, problem } = await decode(hash, description(this.store), this.hasFile());
    if (problem) {
      const outcome = initial ? 'This is the standard surface instead.' : 'Nothing was changed.';
      notice.value = { id: 'link', kind: 'warn', text: `${problem} ${outcome}` };
      if (!initial) return;
    } else if (reset.length) {
      const what = [...new Set(reset)].join(', ');
      notice.value = { id: 'link', kind: 'warn', text: `The link was read, except for: ${what}.` };
    }
    this.apply(state);
  }

  /** Returns the address that restores the present state. */
  async url() {
    return location.origin + location.pathname + (await encode(this.store.state.value, description(this.store)));
  }

  writeLater() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), ADDRESS_MS);
  }

  async write() {
    const { state, description: about } = this.store;
    if (!about.value) return;
    const hash = await encode(state.value, about.value);
    if (hash === this.own) return;
    this.own = hash;
    history.replaceState(history.state, '', hash || location.pathname + location.search);
  }

  close() {
    clearTimeout(this.timer);
    this.stop();
    removeEventListener('hashchange', this.onHashChange);
  }
}
