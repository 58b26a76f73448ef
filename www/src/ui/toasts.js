/** Shows notices as short lines. They disappear after a while, unless they need an answer. */
import { effect } from '@preact/signals-core';
import { fill, h } from './dom.js';
import { icon } from './icons.js';

/** @import { Engine, Notice } from '../engine/types.js' */

/** @typedef {(notice: Notice) => void} Toast */

const STAY_MS = 6000;

/**
 * @param {HTMLElement} host
 * @param {Engine} engine
 * @param {(notice: Notice) => boolean} isTold whether another part of the page already shows it
 * @returns {Toast}
 */
export function mountToasts(host, engine, isTold) {
  host.setAttribute('role', 'status');
  host.setAttribute('aria-live', 'polite');
  /** @type {Map<string, { element: HTMLElement, timer: number }>} */
  const shown = new Map();

  /** @param {string} id */
  function remove(id) {
    const entry = shown.get(id);
    if (!entry) return;
    clearTimeout(entry.timer);
    entry.element.remove();
    shown.delete(id);
    if (engine.notice.peek()?.id === id) engine.dismissNotice();
  }

  /** @type {Toast} */
  const toast = ({ id, kind, text, details, action }) => {
    const old = shown.get(id);
    if (old) clearTimeout(old.timer);
    const element = old?.element ?? host.appendChild(h('div'));
    element.className = 'toast';
    element.dataset.kind = kind;
    if (kind === 'error') element.setAttribute('role', 'alert');
    fill(
      element,
      h('p', null, text),
      action
        ? h(
            'button',
            {
              type: 'button',
              class: 'button',
              on: {
                click: () => {
                  remove(id);
                  action.run();
                },
              },
            },
            action.label,
          )
        : null,
      details
        ? h(
            'button',
            {
              type: 'button',
              class: 'button plain',
              on: {
                click: () => {
                  void navigator.clipboard.writeText(details).catch(() => {});
                },
              },
            },
            'Copy report',
          )
        : null,
      h(
        'button',
        { type: 'button', class: 'button plain square', 'aria-label': 'Dismiss', on: { click: () => remove(id) } },
        icon('close'),
      ),
    );
    const stays = kind === 'error' || action !== undefined || details !== undefined;
    /** @type {() => number} */
    const count = () =>
      window.setTimeout(() => {
        const entry = shown.get(id);
        if (entry && element.matches(':hover, :focus-within')) entry.timer = count();
        else remove(id);
      }, STAY_MS);
    shown.set(id, { element, timer: stays ? 0 : count() });
  };

  let last = '';
  effect(() => {
    const notice = engine.notice.value;
    if (!notice) return remove(last);
    last = notice.id;
    if (isTold(notice)) queueMicrotask(() => engine.dismissNotice());
    else toast(notice);
  });
  return toast;
}
