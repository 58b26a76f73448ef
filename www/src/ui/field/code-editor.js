/**
 * The full formula editor, loaded on the first focus: syntax colours, bracket pairs, completion with help, and errors
 * underlined. It is in a shadow root, where constructed style sheets replace inline styles.
 */
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap } from '@codemirror/commands';
import { EditorState, StateEffect, StateField } from '@codemirror/state';
import { Decoration, EditorView, keymap, MatchDecorator, ViewPlugin, WidgetType } from '@codemirror/view';
import { MODEL } from '../../engine/constants.js';
import { h } from '../dom.js';

/**
 * @import { StateEffectType } from '@codemirror/state'
 * @import { DecorationSet, ViewUpdate } from '@codemirror/view'
 * @import { Transaction } from '@codemirror/state'
 * @import { FieldFault } from '../../engine/types.js'
 * @import { CodeEditorOptions, Editor, Functions } from './types.js'
 */

/** @type {StateEffectType<{ fault: FieldFault | null, message: string }>} */
const faultEffect = StateEffect.define();

class CaretWidget extends WidgetType {
  toDOM() {
    return h('span', { class: 'cm-fault-caret', 'aria-hidden': 'true' });
  }
}

/** @typedef {{ fault: boolean, marks: DecorationSet }} FaultState */
const faultField = StateField.define({
  create: () => /** @type {FaultState} */ ({ fault: false, marks: Decoration.none }),
  update(value, transaction) {
    let { fault, marks } = value;
    if (transaction.docChanged) marks = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(faultEffect)) continue;
      const length = transaction.state.doc.length;
      fault = effect.value.fault !== null;
      if (!effect.value.fault) marks = Decoration.none;
      else {
        const start = Math.min(effect.value.fault.start, length);
        const end = Math.min(Math.max(start, effect.value.fault.end), length);
        marks = Decoration.set(
          end > start
            ? Decoration.mark({ class: 'cm-fault' }).range(start, end)
            : Decoration.widget({ widget: new CaretWidget(), side: 1 }).range(start),
        );
      }
    }
    return fault === value.fault && marks === value.marks ? value : { fault, marks };
  },
  provide: (field) => [
    EditorView.decorations.from(field, ({ marks }) => marks),
    EditorView.contentAttributes.from(field, ({ fault }) => ({
      'aria-label': 'Formula',
      'aria-invalid': String(fault),
      'aria-describedby': 'message',
      spellcheck: 'false',
      autocapitalize: 'off',
      autocorrect: 'off',
    })),
  ],
});

/** Returns the extension that colours numbers, functions, coordinates and parameters. @param {Functions} functions */
function tokens(functions) {
  const known = new Set(functions.map(({ name }) => name));
  const marks = Object.fromEntries(
    ['number', 'function', 'axis', 'name', 'comment'].map((name) => [name, Decoration.mark({ class: `cm-${name}` })]),
  );
  const decorator = new MatchDecorator({
    regexp: /(\/\/.*|#.*|\/\*.*?\*\/)|(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)|([\p{L}_][\p{L}\p{N}_]*)/gu,
    decoration: ([, comment, number, name]) => {
      if (comment) return marks.comment;
      if (number) return marks.number;
      if (known.has(name)) return marks.function;
      return /^[xyz]$/.test(name) ? marks.axis : marks.name;
    },
  });
  return ViewPlugin.fromClass(
    class {
      /** @param {EditorView} view */
      constructor(view) {
        this.decorations = decorator.createDeco(view);
      }

      /** @param {ViewUpdate} update */
      update(update) {
        this.decorations = decorator.updateDeco(update, this.decorations);
      }
    },
    { decorations: (plugin) => plugin.decorations },
  );
}

/** Returns the completions for the names that a formula defines. @param {string} formula */
const definedIn = (formula) =>
  [...formula.matchAll(/(?<=^|[;\n])\s*([\p{L}_][\p{L}\p{N}_]*)\s*(\([^()]*\))?\s*=/gu)].map(([, name, list]) => ({
    label: name,
    detail: list ?? ' defined',
    apply: list ? `${name}(` : name,
  }));

/**
 * @param {Functions} functions
 * @param {() => string[]} names
 */
function completion(functions, names) {
  return autocompletion({
    icons: false,
    activateOnTypingDelay: 150,
    override: [
      (context) => {
        const word = context.matchBefore(/[\p{L}_][\p{L}\p{N}_]*/u);
        if (!word || (word.text.length < 2 && !context.explicit)) return null;
        return {
          from: word.from,
          options: [
            ...functions.map(({ name, signature, help }) => ({
              label: name,
              detail: signature.startsWith(name) ? signature.slice(name.length) : signature,
              info: help,
              apply: signature.includes('(') ? `${name}(` : name,
            })),
            ...definedIn(context.state.doc.toString()),
            ...names().map((name) => ({ label: name, detail: name === MODEL ? ' from points' : ' parameter' })),
          ],
        };
      },
    ],
  });
}

const theme = EditorView.theme({
  '&': {
    font: 'var(--code-size)/1.25rem var(--mono)',
    fontVariantLigatures: 'none',
    color: 'var(--ink)',
  },
  '&.cm-focused': { outline: 'none' },
  '.cm-scroller': { font: 'inherit', lineHeight: '1.25rem', overflow: 'auto' },
  '.cm-content': { padding: '0.4375rem 0', minHeight: '2.125rem', caretColor: 'var(--ink)' },
  '.cm-line': { padding: '0 0.5rem' },
  // Lines break between names, not within one.
  '.cm-number, .cm-function, .cm-name': { whiteSpace: 'nowrap' },
  '.cm-number': { color: 'var(--ink-2)' },
  '.cm-axis': { color: 'var(--ink)' },
  '.cm-function': { color: 'var(--accent-strong)' },
  '.cm-name': { color: 'var(--accent-strong)', fontStyle: 'italic' },
  '.cm-comment': { color: 'var(--ink-3)' },
  '.cm-fault': {
    backgroundColor: 'var(--fault-soft)',
    textDecoration: 'underline wavy var(--fault) 1px',
    textUnderlineOffset: '3px',
  },
  '.cm-fault-caret': {
    display: 'inline-block',
    width: '2px',
    height: '1.1em',
    verticalAlign: 'text-bottom',
    backgroundColor: 'var(--fault)',
  },
  '.cm-tooltip': {
    border: '1px solid var(--line)',
    borderRadius: '0.375rem',
    backgroundColor: 'var(--panel)',
    color: 'var(--ink)',
    overflow: 'hidden',
  },
  '.cm-tooltip.cm-tooltip-autocomplete > ul': { font: '0.75rem/1.25rem var(--mono)', maxHeight: '11rem' },
  '.cm-tooltip.cm-tooltip-autocomplete > ul > li': { padding: '0.125rem 0.5rem' },
  '.cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]': {
    backgroundColor: 'var(--accent-soft)',
    color: 'var(--ink)',
  },
  '.cm-completionMatchedText': { textDecoration: 'none', color: 'var(--accent-strong)' },
  '.cm-completionDetail': { color: 'var(--ink-3)', fontStyle: 'normal', marginLeft: '0' },
  '.cm-completionInfo': { padding: '0.25rem 0.5rem', font: '0.75rem/1.0625rem var(--font)', maxWidth: '14rem' },
});

/**
 * Replaces a selection by the typed text. If the browser did it, Chromium would keep the look of an underlined name by
 * an inline style, which the content security policy forbids.
 */
const typedOver = EditorView.domEventHandlers({
  beforeinput(event, view) {
    const { from, to } = view.state.selection.main;
    const text = event.data;
    if (event.inputType !== 'insertText' || event.isComposing || !text || from === to) return false;
    event.preventDefault();
    const insert = () =>
      view.state.update(view.state.replaceSelection(text), { userEvent: 'input.type', scrollIntoView: true });
    const handlers = view.state.facet(EditorView.inputHandler);
    if (!handlers.some((handle) => handle(view, from, to, text, insert))) view.dispatch(insert());
    return true;
  },
});

/** Whether a paste replaced the whole text. @param {Transaction} transaction */
function isWhole(transaction) {
  let isAll = false;
  transaction.changes.iterChangedRanges((from, to) => {
    isAll = from === 0 && to === transaction.startState.doc.length;
  });
  return isAll && transaction.isUserEvent('input.paste');
}

/** @param {CodeEditorOptions} options @returns {Editor} */
export function createCodeEditor({ text, selection, functions, names, change, finish }) {
  const element = h('div', { class: 'code-host' });
  const root = element.attachShadow({ mode: 'open', delegatesFocus: true });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(
    '#message { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }',
  );
  const message = h('span', { id: 'message' });
  let own = false;
  const enter = () => {
    finish();
    return true;
  };
  const view = new EditorView({
    root,
    parent: /** @type {any} */ (root),
    state: EditorState.create({
      doc: text,
      selection: { anchor: Math.min(selection.anchor, text.length), head: Math.min(selection.head, text.length) },
      extensions: [
        history(),
        closeBrackets(),
        faultField,
        tokens(functions),
        completion(functions, names),
        theme,
        typedOver,
        EditorView.lineWrapping,
        // Enter accepts a completion, else samples the formula; Shift Enter begins a new line.
        keymap.of([
          ...closeBracketsKeymap,
          ...completionKeymap,
          { key: 'Enter', run: enter },
          ...historyKeymap,
          ...defaultKeymap,
        ]),
        EditorView.updateListener.of((update) => {
          if (update.docChanged && !own) change(update.state.doc.toString(), update.transactions.some(isWhole));
        }),
      ],
    }),
  });
  root.append(message);
  root.adoptedStyleSheets.push(sheet);
  return {
    element,
    marks: true,
    text: () => view.state.doc.toString(),
    setText(next) {
      own = true;
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: next } });
      own = false;
    },
    replace(start, end, inserted) {
      const length = view.state.doc.length;
      view.dispatch({
        changes: { from: Math.min(start, length), to: Math.min(end, length), insert: inserted },
        selection: { anchor: Math.min(start, length) + inserted.length },
      });
    },
    setFault(fault, words) {
      message.textContent = words;
      view.dispatch({ effects: faultEffect.of({ fault, message: words }) });
    },
    selection: () => ({ anchor: view.state.selection.main.anchor, head: view.state.selection.main.head }),
    focus: () => view.focus(),
  };
}
