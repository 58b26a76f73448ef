/** The formula in a native text area, used before the full editor has loaded and if it cannot load. */
import { h } from '../dom.js';

/** @import { Change, Editor } from './types.js' */

/**
 * @param {{ text: string, change: Change, finish: () => void, focused: () => void }} options
 * @returns {Editor}
 */
export function createTextarea({ text, change, finish, focused }) {
  /** Whether a paste replaces the whole text. */
  let whole = false;
  const area = h('textarea', {
    class: 'code',
    rows: 1,
    spellcheck: 'false',
    autocapitalize: 'off',
    autocomplete: 'off',
    autocorrect: 'off',
    'aria-label': 'Formula',
    'aria-describedby': 'formula-fault',
    prop: { value: text },
    on: {
      paste: () => {
        whole = area.selectionStart === 0 && area.selectionEnd === area.value.length;
      },
      input: (event) => {
        grow();
        change(area.value, whole && event instanceof InputEvent && event.inputType === 'insertFromPaste');
        whole = false;
      },
      focus: focused,
      keydown: (event) => {
        if (event.key !== 'Enter' || event.shiftKey || event.isComposing) return;
        event.preventDefault();
        finish();
      },
      compositionstart: () => {
        area.dataset.composing = '';
      },
      compositionend: () => {
        delete area.dataset.composing;
      },
    },
  });
  function grow() {
    const lines = Math.ceil(area.value.length / 34) + (area.value.match(/\n/g)?.length ?? 0);
    area.rows = Math.min(8, Math.max(1, lines));
  }
  grow();
  return {
    element: area,
    marks: false,
    text: () => area.value,
    setText(next) {
      area.value = next;
      grow();
    },
    replace(start, end, inserted) {
      area.setRangeText(inserted, start, end, 'end');
      grow();
      change(area.value, false);
    },
    setFault(fault) {
      area.setAttribute('aria-invalid', String(fault !== null));
    },
    selection: () => ({ anchor: area.selectionStart, head: area.selectionEnd }),
    focus: () => area.focus(),
  };
}
