/** The formula: an editor, what is wrong with it and how to mend that, and how it reads as mathematics. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { mathElement, mathPieces } from '../mathml.js';
import { beginsFunction, describeFault, piecesOf } from './fault.js';
import { openFunctions } from './functions.js';
import { createTextarea } from './textarea.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

/** @typedef {import('../../engine/types.js').FieldFault} FieldFault */
/**
 * What both editors can do. Offsets are UTF-16 code units.
 * @typedef {object} Editor
 * @property {HTMLElement} element
 * @property {() => string} text
 * @property {(text: string) => void} setText
 * @property {(start: number, end: number, text: string) => void} replace
 * @property {(fault: FieldFault | null, message: string) => void} setFault
 * @property {() => { anchor: number, head: number }} selection
 * @property {() => void} focus
 * @property {boolean} marks whether it shows the place of the error itself
 */

/**
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function createFormula(engine, description) {
  const error = h('div', { class: 'fault', id: 'formula-fault', role: 'status', 'aria-live': 'polite' });
  const preview = h('div', {
    class: 'preview',
    role: 'group',
    'aria-label': 'The formula as mathematics',
    tabindex: 0,
  });
  const holder = h('div', { class: 'editor', id: 'formula' });
  const shown = computed(() => engine.state.value.formula);
  const fault = computed(() => engine.fieldError.value);
  const math = computed(() => engine.field.value?.mathml ?? null);

  const names = () => engine.field.peek()?.parameters.map(({ name }) => name) ?? [];
  /** The caret is behind the beginning of a name: what was wrong before it may be mended with that. */
  let unfinished = false;
  const change = (/** @type {string} */ text) => {
    const { anchor, head } = editor.selection();
    unfinished = anchor === head && beginsFunction(text.slice(0, head), description.functions, names());
    engine.setFormula(text, { unfinished });
  };
  /** @type {Editor} */
  let editor = createTextarea({ text: shown.peek(), change, focused: upgrade });
  holder.append(editor.element);
  let upgrading = false;

  /** The full editor arrives with the first focus; until then, and where it cannot load, the text area does the work. */
  async function upgrade() {
    if (upgrading) return;
    upgrading = true;
    try {
      const { createCodeEditor } = await import('./code-editor.js');
      const plain = editor;
      if (plain.element.matches('[data-composing]'))
        await new Promise((done) => plain.element.addEventListener('compositionend', done, { once: true }));
      const focused = plain.element === document.activeElement;
      const next = createCodeEditor({
        text: plain.text(),
        functions: description.functions,
        change,
        names,
        selection: plain.selection(),
      });
      editor = next;
      plain.element.replaceWith(next.element);
      render();
      if (focused) next.focus();
    } catch {
      // The text area stays.
    }
  }

  function render() {
    const text = editor.text();
    const view = describeFault(text, unfinished ? null : fault.peek());
    holder.classList.toggle('has-fault', view?.tone === 'fault');
    editor.setFault(view?.tone === 'fault' ? fault.peek() : null, view?.message ?? '');
    if (!view) return fill(error);
    const { excerpt } = view;
    error.dataset.tone = view.tone;
    fill(
      error,
      excerpt && !editor.marks
        ? h(
            'code',
            { class: 'excerpt' },
            excerpt.before,
            h('mark', { class: excerpt.marked ? '' : 'caret' }, excerpt.marked),
            excerpt.after,
          )
        : null,
      h(
        'p',
        null,
        piecesOf(view.message).map(({ text: piece, code }) => (code ? h('code', null, piece) : piece)),
      ),
      view.repairs.length
        ? h(
            'div',
            { class: 'repairs' },
            view.repairs.map((repair) =>
              h('button', { type: 'button', class: 'button small', on: { click: () => mend(repair) } }, repair.label),
            ),
          )
        : null,
    );
    // On a phone there is room for little below the editor.
    if (holder.contains(document.activeElement)) error.scrollIntoView({ block: 'nearest' });
  }

  /** @param {import('./fault.js').Repair} repair */
  function mend(repair) {
    if (repair.declare) engine.declareParameter(repair.declare);
    if (repair.replace) editor.replace(repair.replace.start, repair.replace.end, repair.replace.text);
    editor.focus();
  }

  effect(() => {
    const text = shown.value;
    if (editor.text() !== text) editor.setText(text);
  });
  effect(() => {
    void fault.value;
    unfinished = false;
    render();
  });
  effect(() => {
    void shown.value;
    render();
  });
  effect(() => {
    void math.value;
    fit();
    preview.classList.toggle('stale', engine.fieldError.value !== null);
  });
  /** A formula too long for one line goes on in the next, and is taken apart only then. */
  function fit() {
    const tree = math.peek();
    preview.classList.remove('long');
    fill(preview, tree && mathElement(tree));
    if (!tree) return;
    if (preview.scrollWidth <= preview.clientWidth + 1) return;
    preview.classList.add('long');
    fill(
      preview,
      mathPieces(tree).flatMap((piece) => [piece, h('wbr')]),
    );
  }
  let width = 0;
  new ResizeObserver(() => {
    if (preview.clientWidth !== width) fit();
    width = preview.clientWidth;
  }).observe(preview);
  document.querySelector('.skip')?.addEventListener('click', (event) => {
    event.preventDefault();
    if (section.hidden) /** @type {HTMLElement | null} */ (document.querySelector('.tile :checked'))?.focus();
    else editor.focus();
  });

  const help = h(
    'button',
    {
      type: 'button',
      class: 'button plain small',
      on: { click: () => openFunctions(description, (name) => insert(name)) },
    },
    'Functions',
  );
  /** @param {string} name */
  function insert(name) {
    const { anchor, head } = editor.selection();
    editor.replace(Math.min(anchor, head), Math.max(anchor, head), `${name}(`);
    editor.focus();
  }
  const section = h(
    'div',
    { class: 'section formula' },
    h('div', { class: 'section-head' }, h('h2', null, 'Formula'), help),
    holder,
    error,
    preview,
  );
  effect(() => {
    section.hidden = engine.field.value?.kind === 'points';
  });
  return section;
}
