/**
 * The state in the address of the page: written a little after it changes, read when somebody follows a link.
 *
 * @module
 */
import { effect } from '@preact/signals-core';
import { decode, encode } from './share/codec.js';
import { description } from './store.js';

/** The address follows the state at this pace; browsers refuse more than about 100 changes in half a minute. */
const ADDRESS_MS = 500;

export class Address {
  /**
   * @param {object} parts
   * @param {import('./store.js').Store} parts.store
   * @param {() => boolean} parts.hasFile  whether there is a file for a link to one
   * @param {(state: import('./types.js').State) => void} parts.apply  takes a valid state for its own
   */
  constructor({ store, hasFile, apply }) {
    this.store = store;
    this.hasFile = hasFile;
    this.apply = apply;
    /** The fragment that we wrote, to tell it from one that somebody typed. */
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
      // The whole state is worth an address.
      if (store.state.value) this.writeLater();
    });
  }

  /** Takes the state of a link. @param {string} hash @param {boolean} [initial]  the first state of the page */
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

  /** The address that shows the present state. */
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
