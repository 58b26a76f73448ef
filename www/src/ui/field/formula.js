/** The formula: its editor, the description of an error with possible repairs, and the formula as mathematics. */

import { computed } from '@preact/signals-core';
import { MODEL } from '../../engine/constants.js';
import { givenOf } from '../../engine/given.js';
import { button } from '../button.js';
import { fill, h, live, marked, uniqueId } from '../dom.js';
import { mathElement, mathLines } from '../mathml.js';
import { meantBy } from '../meant.js';
import { describeFault } from './fault.js';
import { openFunctions } from './functions.js';
import { createTextarea } from './textarea.js';
import { kindOf } from './unchanging.js';

/**
 * @import { Description, Engine, MathNode } from '../../engine/types.js'
 * @import { Replace } from '../types.js'
 * @import { Change, Editor, FaultView, Repair } from './types.js'
 */

/**
 * Creates the section of the formula.
 * @param {Engine} engine
 * @param {Description} description
 * @param {Replace} replace
 */
export function createFormula(engine, description, replace) {
  const input = new FormulaInput(engine, description, replace);
  const shown = createShown(engine, input.error);
  const help = button(
    { class: 'plain small', press: () => openFunctions(description, (name) => input.insert(name)) },
    'What can I write?',
  );
  const section = h(
    'div',
    { class: 'section formula' },
    h('div', { class: 'section-head' }, h('h2', null, 'Formula'), help),
    h('div', { class: 'formula-room' }, h('div', { class: 'formula-text' }, input.holder, shown)),
  );
  document.querySelector('.skip')?.addEventListener('click', (event) => {
    event.preventDefault();
    input.editor.focus();
  });
  return section;
}

/** The present editor, and the message about an error in its text. */
class FormulaInput {
  #engine;
  #description;
  #replace;

  #upgrading;
  #fault;

  /** The text to which the error belongs: it is not shown for a later text that has not been read yet. */
  #faulty;
  #change;

  /**
   * @param {Engine} engine
   * @param {Description} description
   * @param {Replace} replace
   */
  constructor(engine, description, replace) {
    this.#engine = engine;
    this.#description = description;
    this.#replace = replace;
    this.error = h('div', { class: 'fault', id: 'formula-fault', role: 'status', 'aria-live': 'polite' });
    this.holder = h('div', { class: 'editor', id: 'formula' });
    this.#upgrading = false;
    this.#faulty = '';
    const shown = computed(() => engine.state.value.formula);
    this.#fault = computed(() => engine.fieldError.value);
    /** @type {Change} */
    this.#change = (text, whole) => {
      const set = () => engine.setFormula(text, { typing: true, whole });
      if (whole) replace(set);
      else set();
    };
    /** @type {Editor} */
    this.editor = createTextarea({
      text: shown.peek(),
      change: this.#change,
      finish: this.#finish,
      focused: () => this.#upgrade(),
    });
    this.holder.append(this.editor.element);
    // The focus may also move from one editor to the other.
    this.holder.addEventListener('focusout', ({ relatedTarget }) => {
      if (!(relatedTarget instanceof Node && this.holder.contains(relatedTarget))) this.#finish();
    });
    live(this.holder, () => {
      const text = shown.value;
      if (this.editor.text() !== text) this.editor.setText(text);
    });
    live(this.holder, () => {
      if (this.#fault.value) this.#faulty = shown.peek();
      this.#render();
    });
    live(this.holder, () => {
      void shown.value;
      void engine.trial.value;
      this.#render();
    });
  }

  /** Samples what was typed without waiting for a pause. */
  #finish = () => this.#engine.setFormula(this.editor.text());

  #names() {
    const field = this.#engine.field.peek();
    const names = field?.parameters.map(({ name }) => name) ?? [];
    return givenOf(field) ? [MODEL, ...names] : names;
  }

  /** Replaces the text area by the full editor, on the first focus. If it cannot load, the text area stays. */
  async #upgrade() {
    if (this.#upgrading) return;
    this.#upgrading = true;
    try {
      const { createCodeEditor } = await import('./code-editor.js');
      const plain = this.editor;
      if (plain.element.matches('[data-composing]'))
        await new Promise((done) => plain.element.addEventListener('compositionend', done, { once: true }));
      const focused = plain.element === document.activeElement;
      const next = createCodeEditor({
        text: plain.text(),
        functions: this.#description.functions,
        change: this.#change,
        finish: this.#finish,
        names: () => this.#names(),
        selection: plain.selection(),
      });
      this.editor = next;
      plain.element.after(next.element);
      if (focused) next.focus();
      plain.element.remove();
      this.#render();
    } catch {
      // The text area stays.
    }
  }

  /** Shows the error in the text, if any. */
  #render() {
    const { editor, holder, error } = this;
    const fault = this.#fault.peek();
    const text = editor.text();
    // Words count as a formula while being typed; names are looked up only once the text has been read.
    const isRead = this.#engine.trial.peek() !== 'typing';
    const meant = isRead ? meantBy(this.#description, text) : [];
    const view = describeFault(text, text === this.#faulty ? fault : null, meant);
    holder.classList.toggle('has-fault', view?.tone === 'fault');
    editor.setFault(view?.tone === 'fault' ? fault : null, view?.message ?? '');
    if (!view) return fill(error);
    error.dataset.tone = view.tone;
    fill(
      error,
      editor.marks ? null : excerptElement(view),
      h('p', null, marked(view.message)),
      view.repairs.length ? this.#repairButtons(view.repairs) : null,
    );
    // On a phone there is little room below the editor.
    if (holder.contains(document.activeElement)) error.scrollIntoView({ block: 'nearest' });
  }

  /** @param {Repair[]} repairs */
  #repairButtons(repairs) {
    return h(
      'div',
      { class: 'repairs' },
      repairs.map((repair) => button({ class: 'small', press: () => this.#mend(repair) }, repair.label)),
    );
  }

  /** @param {Repair} repair */
  #mend(repair) {
    const { surface } = repair;
    if (surface) return this.#replace(() => this.#engine.setSurface(surface));
    if (repair.declare) this.#engine.declareParameter(repair.declare);
    if (repair.replace) this.editor.replace(repair.replace.start, repair.replace.end, repair.replace.text);
    this.#finish();
    this.editor.focus();
  }

  /** Inserts a function at the caret. @param {string} name */
  insert(name) {
    const { anchor, head } = this.editor.selection();
    this.editor.replace(Math.min(anchor, head), Math.max(anchor, head), `${name}(`);
    this.editor.focus();
  }
}

/** @param {FaultView} view */
const excerptElement = ({ excerpt }) =>
  excerpt &&
  h(
    'code',
    { class: 'excerpt' },
    excerpt.before,
    h('mark', { class: excerpt.marked ? '' : 'caret' }, excerpt.marked),
    excerpt.after,
  );

/** Least size of a formula that is too wide, as a share of its size; beyond that it scrolls. */
const LEAST_SIZE = 0.7;

/**
 * Shows the formula as mathematics, and says so if it is not the one in the editor.
 * @param {Engine} engine @param {HTMLElement} fault  lies over it
 */
function createShown(engine, fault) {
  // A text without x, y and z, such as a word, is no formula of a surface.
  const isFormula = computed(() => {
    const field = engine.field.value;
    return !field || field.model !== null || field.periods.some((period) => period !== 0);
  });
  let written = 'null';
  // Compared as text, it stays equal while a parameter changes, so it is not drawn and measured again.
  const last = computed(() => {
    if (isFormula.value) written = JSON.stringify(engine.field.value?.mathml ?? null);
    return written;
  });
  const math = computed(() => /** @type {MathNode | null} */ (JSON.parse(last.value)));
  // While the text is no formula, the last one stays, with a caption that says so.
  const isLast = computed(() => (engine.fieldError.value !== null || !isFormula.value) && math.value !== null);
  const id = uniqueId('preview');
  const caption = h(
    'p',
    { class: 'visually-hidden', id, hidden: () => !isLast.value },
    'The last formula that could be read:',
  );
  const preview = h('div', {
    class: 'preview',
    role: 'group',
    'aria-label': 'The formula as mathematics',
    'aria-describedby': () => isLast.value && id,
    tabindex: 0,
  });
  // A formula is split into parts only if it is too wide for one line, and made smaller if a part still is.
  const fit = () => {
    const tree = math.peek();
    preview.classList.remove('long');
    preview.style.fontSize = '';
    fill(preview, tree && mathElement(tree));
    if (!tree) return;
    if (preview.scrollWidth <= preview.clientWidth + 1) return;
    preview.classList.add('long');
    fill(
      preview,
      mathLines(tree).flatMap((parts, k) => [k > 0 && h('br'), ...parts.flatMap((part) => [part, h('wbr')])]),
    );
    const { scrollWidth, clientWidth } = preview;
    if (scrollWidth > clientWidth) preview.style.fontSize = `${Math.max(LEAST_SIZE, clientWidth / scrollWidth)}em`;
  };
  // Measured in the next frame, whose layout is computed anyway.
  let asked = 0;
  live(preview, () => {
    void math.value;
    cancelAnimationFrame(asked);
    asked = requestAnimationFrame(fit);
  });
  live(preview, () => preview.classList.toggle('stale', isLast.value));
  let width = 0;
  new ResizeObserver(() => {
    if (preview.clientWidth !== width) fit();
    width = preview.clientWidth;
  }).observe(preview);
  return h('div', { class: 'code-shown' }, fault, caption, preview, createUnchanging(engine));
}

/**
 * Creates the line that names the coordinates missing from a formula, and the kind of surface that follows.
 * @param {Engine} engine
 */
function createUnchanging(engine) {
  // While the sampler runs, the last result for this formula stays.
  let [kind, formula] = ['', ''];
  return h('p', { class: 'quiet unchanging' }, () => {
    const { field, fieldError, result, status, report, columns } = engine;
    const { periods, model } = field.value ?? {};
    if (!periods || model || fieldError.value || result.value === 'none') return '';
    const without = ['x', 'y', 'z'].filter((_, k) => periods[k] === 0);
    if (without.length === 0 || without.length === 3) return '';
    if (field.value?.formula !== formula) kind = '';
    formula = field.value?.formula ?? '';
    if (report.value && status.value !== 'sampling') kind = kindOf(columns);
    return `No ${without.join(', ')}${kind && `: ${kind}`}`;
  });
}
