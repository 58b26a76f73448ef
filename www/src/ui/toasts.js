/** Shows notices as short lines, which disappear after a while unless they need an answer. */

import { button } from './button.js';
import { fill, h, live, query } from './dom.js';

/**
 * @import { Engine, Notice } from '../engine/types.js'
 * @import { Toast } from './types.js'
 */

const STAY_MS = 6000;

/**
 * @param {HTMLElement} host
 * @param {Engine} engine
 * @param {(notice: Notice) => boolean} isTold whether another part of the page already shows it
 * @returns {{ toast: Toast, dismiss: () => boolean }}  `dismiss` removes the newest notice that stays, and returns
 *   whether there was one
 */
export function mountToasts(host, engine, isTold) {
  // Screen readers announce what is added to an existing region: at once in an alert, in a pause in a status.
  const alerts = host.appendChild(h('div', { role: 'alert' }));
  const status = host.appendChild(h('div', { role: 'status' }));
  /**
   * By their names, the newest last; one without a timer stays.
   * @type {Map<string, { element: HTMLElement, timer: number }>}
   */
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

  /** Removes a notice later, but not while the user looks at it. @param {string} id @param {HTMLElement} element */
  const count = (id, element) =>
    window.setTimeout(() => {
      const entry = shown.get(id);
      if (entry && element.matches(':hover, :focus-within')) entry.timer = count(id, element);
      else remove(id);
    }, STAY_MS);

  /** @type {Toast} */
  const toast = (notice) => {
    const { id, kind } = notice;
    const old = shown.get(id);
    if (old) clearTimeout(old.timer);
    const region = kind === 'error' ? alerts : status;
    const element = old?.element.parentElement === region ? old.element : region.appendChild(h('div'));
    if (old?.element !== element) old?.element.remove();
    element.className = 'toast';
    element.dataset.kind = kind;
    fill(
      element,
      partsOf(notice, () => remove(id)),
    );
    const stays = kind === 'error' || Boolean(notice.action ?? notice.details ?? notice.asks);
    shown.delete(id);
    shown.set(id, { element, timer: stays ? 0 : count(id, element) });
  };

  function dismiss() {
    const newest = [...shown].findLast(([, { timer }]) => timer === 0);
    if (newest) remove(newest[0]);
    return newest !== undefined;
  }

  let last = '';
  live(host, () => {
    const notice = engine.notice.value;
    if (!notice) return remove(last);
    last = notice.id;
    if (isTold(notice)) queueMicrotask(() => engine.dismissNotice());
    else toast(notice);
  });
  return { toast, dismiss };
}

/** The text of a notice, and its action. @param {Notice} notice @param {() => void} remove */
function partsOf({ text, details, action, asks }, remove) {
  const open = () => {
    remove();
    query(document, '.open-file').click();
  };
  const act = () => {
    remove();
    action?.run();
  };
  const copy = () => void navigator.clipboard.writeText(details ?? '').catch(() => {});
  return [
    h('p', null, text),
    action && button({ press: act }, action.label),
    asks && button({ press: open }, 'Open the file…'),
    details && button({ class: 'plain', press: copy }, 'Copy report'),
    button({ icon: 'close', 'aria-label': 'Dismiss', press: remove }),
  ];
}
