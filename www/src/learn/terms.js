/**
 * Terms of the text that a figure of their chapter can mark: while one is hovered, focused or
 * pressed, the figure shows what it means.
 */
import { signal } from '@preact/signals-core';
import { queryAll } from '../ui/dom.js';

const shown = signal('');

/** The term that is marked now; empty for none. An effect that asks runs again once it changes. */
export const termShown = () => shown.value;

/** Makes the terms of the text marks of the figures: each names itself in `data-term`. */
export function mountTerms() {
  for (const term of queryAll(document, '[data-term]')) {
    const { term: name = '' } = term.dataset;
    const stages = queryAll(term.closest('.chapter') ?? document, '.stage');
    const mark = (/** @type {boolean} */ isOn) => {
      // The pointer may leave a term once another one has the focus.
      if (!isOn && shown.peek() !== name) return;
      shown.value = isOn ? name : '';
      for (const stage of stages) stage.dataset.marks = shown.peek();
    };
    term.tabIndex = 0;
    term.title = 'Marked in the figure';
    for (const kind of ['pointerenter', 'focus']) term.addEventListener(kind, () => mark(true));
    for (const kind of ['pointerleave', 'blur']) term.addEventListener(kind, () => mark(false));
  }
}
