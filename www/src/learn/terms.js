/**
 * Terms of the text that a figure of their chapter can explain: while a term is hovered, focused or pressed, the figure
 * marks its meaning.
 */
import { signal } from '@preact/signals-core';
import { queryAll } from '../ui/dom.js';

const shown = signal('');

/** The current term; empty for none. An effect that calls this runs again when it changes. */
export const termShown = () => shown.value;

/** Connects the terms of the text, named in `data-term`, to the figures. */
export function mountTerms() {
  for (const term of queryAll(document, '[data-term]')) {
    const { term: name = '' } = term.dataset;
    const stages = queryAll(term.closest('.chapter') ?? document, '.stage');
    const mark = (/** @type {boolean} */ isOn) => {
      // A term may lose the pointer after another one has received the focus.
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
