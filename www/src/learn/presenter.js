/**
 * Presenting: one stop at a time, as large as the window, with the keys of a clicker. A press goes one step on: to the
 * answer of a question, through the steps of a figure, and then to the next stop. The stop stays in the address.
 */
import { signal } from '@preact/signals-core';
import { button } from '../ui/button.js';
import { byId, h, queryAll } from '../ui/dom.js';
import { formatCount } from '../ui/format.js';
import { loadSheet } from '../ui/sheet.js';
import { titleOf } from './address.js';
import { createNotes } from './notes.js';
import sheet from './present.css?url';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { PresenterOptions } from './types.js'
 */

/** Elements in which a letter is text. */
const TYPING = 'input:not([type="range"], [type="radio"], [type="checkbox"]), textarea';
/** Elements that have a meaning of their own for some keys. */
const PRESSED = 'button, select, summary, input, a[href]';
const TURNED = 'input, select, .picture, .number';
/** A longer range of a figure is walked in `FEW` presses, a shorter one value by value. A button has `LONG` presses. */
const LONG = 18;
const FEW = 6;

/** @param {PresenterOptions} about */
export async function createPresenter({ stops, questions, to }) {
  await loadSheet(sheet);
  const root = document.documentElement;
  /** Number of the stop that is shown; null while nothing is presented. */
  /** @type {Signal<number | null>} */
  const at = signal(null);
  const told = signal('');
  const isBlank = signal(false);
  /** What the run says to the question that is shown. */
  const answer = signal('');
  let last = 0;
  let walk = createWalk(stops[0], questions);
  const notes = createNotes({
    now: () => wordsOf(stops[at.value ?? last], answer.value),
    next: () => wordsOf(stops[(at.value ?? last) + 1]),
    say: (words) => {
      told.value = words;
    },
  });
  const leave = () => {
    if (document.fullscreenElement) void document.exitFullscreen();
    to(stops[last], false);
  };
  const stop = (/** @type {number} */ by) => to(stops[Math.min(stops.length - 1, Math.max(0, last + by))], true);
  const step = (/** @type {1 | -1} */ by) => {
    if (!walk(by)) stop(by);
  };
  const blank = () => {
    isBlank.value = !isBlank.peek();
  };
  const bar = h(
    'nav',
    {
      class: 'present-bar',
      'aria-label': 'Presentation',
      hidden: () => at.value === null,
      // The focus stays where it was, so that the next press of Space goes on.
      on: { mousedown: (/** @type {MouseEvent} */ event) => event.preventDefault() },
    },
    button({ icon: 'back', 'aria-label': 'Previous stop', press: () => stop(-1) }),
    h('p', { class: 'present-place', 'aria-live': 'polite' }, () =>
      at.value === null ? '' : `${formatCount(at.value + 1)} of ${formatCount(stops.length)}`,
    ),
    button({ icon: 'forward', 'aria-label': 'Next stop', press: () => stop(1) }),
    button({ class: 'plain', press: notes.toggle }, 'Notes'),
    button({ class: 'plain', press: blank }, 'Blank'),
    button({ class: 'plain', press: toggleFull }, 'Full screen'),
    button({ class: 'plain', press: leave }, 'Leave'),
    h('span', { role: 'status' }, () => told.value),
  );
  const curtain = h('div', { class: 'present-blank', role: 'status', hidden: () => !isBlank.value }, () =>
    isBlank.value
      ? h('span', { class: 'visually-hidden' }, 'The screen is blank. Any key of the clicker ends it.')
      : '',
  );
  document.body.append(bar, curtain);
  const [on, back] = [() => step(1), () => step(-1)];
  const press = listener(
    {
      ...{ PageDown: on, ' ': on, ArrowRight: on, ArrowDown: on },
      ...{ PageUp: back, ArrowLeft: back, ArrowUp: back },
      ...{ b: blank, '.': blank, Escape: leave, n: notes.toggle, f: toggleFull },
    },
    { isOn: () => at.peek() !== null, isBlank },
  );
  addEventListener('keydown', press, true);
  notes.listen(press);
  return {
    /** Shows one stop alone. @param {string} id */
    show(id) {
      last = Math.max(0, stops.indexOf(id));
      at.value = last;
      told.value = '';
      isBlank.value = false;
      root.dataset.mode = 'present';
      setCurrent(document.getElementById(id));
      for (const bench of queryAll(document, '.bench')) bench.dataset.asks = '';
      walk = createWalk(id, questions);
      answer.value = '';
      const asked = questions.entries.get(id)?.ask();
      asked?.then((words) => {
        if (stops[last] === id) answer.value = words;
      });
      scrollTo(0, 0);
    },
    /** Goes back to the article. */
    end() {
      at.value = null;
      isBlank.value = false;
      notes.close();
      delete root.dataset.mode;
      setCurrent(null);
    },
  };
}

/** Marks the stop that is shown, and the chapter around it. @param {HTMLElement | null} stop */
function setCurrent(stop) {
  for (const marked of queryAll(document, '[data-current]')) {
    marked.removeAttribute('data-current');
    marked.removeAttribute('data-part');
  }
  const chapter = stop?.closest('.chapter');
  for (const shown of [stop, chapter]) shown?.setAttribute('data-current', '');
  // A part of a chapter stands below its title; a question that has no figure of its own, with that of the chapter.
  if (stop && chapter && stop !== chapter)
    chapter.setAttribute('data-part', stop.matches('.predict:not(:has(.stage)), .challenge') ? 'asks' : 'alone');
}

/**
 * The words of a stop for the one who presents; null beyond the last.
 * @param {string | undefined} id @param {string} [answer]  of its question
 */
function wordsOf(id, answer = '') {
  if (id === undefined) return null;
  const stop = byId(id);
  const chapter = stop.closest('.chapter');
  return {
    title: titleOf(stop),
    minutes: stop === chapter ? (chapter.getAttribute('data-minutes') ?? '') : '',
    answer,
    notes: chapter?.querySelector('.notes')?.textContent ?? '',
  };
}

/**
 * Returns what goes one step within a stop, and says whether there was one: the answer of its question, then the steps
 * of its figure if no later question shows it, the start of its race, or the figures of its comparison and then its
 * values.
 * @param {string} id @param {PresenterOptions['questions']} questions
 */
function createWalk(id, questions) {
  const stop = byId(id);
  const chapter = stop.closest('.chapter') ?? stop;
  const own = stop.querySelector('.predict .stage, :scope.predict .stage');
  const asking = [chapter, ...chapter.querySelectorAll('.predict')].filter(
    (one) => !one.querySelector(':scope.predict .stage'),
  );
  const stage = own ?? (stop === asking.at(-1) ? chapter.querySelector('figure > .stage') : null);
  const start = stop.querySelector('.race > .controls .primary');
  const bench = stop.querySelector('.bench') ?? stop.closest('.challenge')?.parentElement?.querySelector('.bench');
  let [isAsked, isBegun, pressed] = [questions.isOpen(id), false, 0];
  /** @param {1 | -1} by */
  return (by) => {
    const question = questions.entries.get(id);
    if (question && !isAsked && by > 0) {
      if (question.look()) return true;
      isAsked = true;
      void question.reveal();
      return true;
    }
    if (start instanceof HTMLElement && !isBegun && by > 0) {
      isBegun = true;
      start.click();
      return true;
    }
    if (bench) {
      const isHidden = bench.hasAttribute('data-asks');
      if (isHidden) bench.toggleAttribute('data-asks', by < 0);
      return isHidden ? by > 0 : !bench.dispatchEvent(new CustomEvent('walk', { detail: by, cancelable: true }));
    }
    const press = [...chapter.querySelectorAll(`button[data-${by > 0 ? 'step' : 'back'}="${id}"]`)].find((one) =>
      one.checkVisibility(),
    );
    const isTurn = by > 0 ? pressed < LONG : pressed > 0;
    if (press instanceof HTMLElement && press.ariaDisabled !== 'true' && isTurn) {
      pressed += by;
      press.click();
      return true;
    }
    const range = [...(stage?.querySelectorAll('input[type="range"]') ?? [])].find((one) => one.checkVisibility());
    if (!(range instanceof HTMLInputElement)) return false;
    const [value, most] = [range.valueAsNumber, Number(range.max)];
    const stride = most > LONG ? Math.ceil(most / FEW) : 1;
    // A figure that stands at its end, or a step before it, begins anew.
    const next = value + stride >= most && by > 0 && !isBegun ? 0 : Math.min(most, value + by * stride);
    if (next === value || next < 0) return false;
    isBegun = true;
    range.valueAsNumber = next;
    range.dispatchEvent(new Event('input', { bubbles: true }));
    return true;
  };
}

/** Fills the screen, or leaves it. A browser may refuse; the presentation goes on in the window. */
function toggleFull() {
  if (document.fullscreenElement) void document.exitFullscreen();
  else document.documentElement.requestFullscreen?.().catch(() => {});
}

/**
 * Takes the keys of the presentation, but where they have a meaning in a control. On a blank screen every one of them
 * only ends it.
 * @param {Record<string, () => void>} keys
 * @param {{ isOn: () => boolean, isBlank: Signal<boolean> }} state
 */
const listener =
  (keys, { isOn, isBlank }) =>
  (/** @type {KeyboardEvent} */ event) => {
    if (!isOn() || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const act = keys[key];
    const on = (/** @type {string} */ selector) => /** @type {any} */ (event.target)?.matches?.(selector);
    const isOwn =
      (key.length === 1 && on(TYPING)) || (key === ' ' && on(PRESSED)) || (key.startsWith('Arrow') && on(TURNED));
    if (!act || (isOwn && !isBlank.peek())) return;
    event.preventDefault();
    event.stopPropagation();
    if (isBlank.peek()) isBlank.value = false;
    else act();
  };
