/** Handles single-key shortcuts, the dialog that lists them, and the switch that disables them (WCAG 2.1.4). */

import { createDialog } from './dialog.js';
import { byId, h } from './dom.js';
import { remembered } from './remembered.js';

/** @import { Shortcut } from './types.js' */

/** Name of the command key on this platform. */
export const COMMAND_KEY = /Mac|iPhone|iPad/.test(navigator.platform) ? '⌘' : 'Ctrl';

/** @param {EventTarget | null} target */
function types(target) {
  if (!(target instanceof HTMLElement)) return false;
  return (
    target.isContentEditable ||
    target.shadowRoot !== null ||
    target.matches('textarea, select, input:not([type=range], [type=checkbox], [type=radio])')
  );
}

/** Follows the page's link to the lesson, which passes on the surface. @param {Event} event */
function follow(event) {
  event.preventDefault();
  byId('learn-link').click();
}

/** @param {Shortcut[]} shortcuts */
export function mountShortcuts(shortcuts) {
  const isEnabled = remembered('shortcuts', true);
  const toggle = h('input', {
    type: 'checkbox',
    prop: { checked: isEnabled.peek() },
    on: {
      change: () => {
        isEnabled.value = toggle.checked;
      },
    },
  });
  const rest = /** @type {const} */ ([
    ['Arrow keys', 'Turn, with the picture focused'],
    ['Enter', 'Choose the particle in the middle of the picture; again: have it explained'],
    ['← →', 'Along the timeline by a level'],
    ['Page up, Page down, Home, End, Space', 'Along the timeline as its buttons do'],
    ['Drag', 'Turn'],
    ['Right drag', 'Move'],
    ['Shift drag', 'Pull the surface, or move beside it'],
    ['Wheel, pinch', 'Zoom'],
    ['Shift with a slider', 'Ten times finer'],
    ['Double click on a slider', 'Reset'],
  ]);
  const dialog = createDialog(
    'Help',
    h(
      'p',
      null,
      'This page covers a surface, given by a formula, with particles that lie evenly on it. Choose a surface or type a formula, and watch it grow; the ',
      h('a', { href: './learn/', on: { click: follow } }, 'lesson'),
      ' shows how it works.',
    ),
    h('h3', null, 'Keyboard and pointer'),
    h(
      'dl',
      { class: 'keys' },
      [...shortcuts.map(({ shown, label }) => /** @type {const} */ ([shown, label])), ...rest].flatMap(
        ([key, label]) => [h('dt', null, h('kbd', null, key)), h('dd', null, label)],
      ),
    ),
    h('label', { class: 'check' }, toggle, 'Single-key shortcuts'),
  );
  addEventListener('keydown', (event) => {
    const ctrl = event.ctrlKey || event.metaKey;
    if (event.defaultPrevented || event.altKey || types(event.composedPath()[0] ?? null) || types(event.target)) return;
    if (document.querySelector('dialog[open], [popover]:popover-open:not(.explain)')) return;
    const found = shortcuts.find(
      (shortcut) =>
        shortcut.keys.includes(event.key) &&
        (shortcut.ctrl ?? false) === ctrl &&
        (!ctrl || (shortcut.shift ?? false) === event.shiftKey),
    );
    if (!found || (!isEnabled.peek() && !ctrl && event.key !== 'Escape')) return;
    event.preventDefault();
    found.act();
  });
  return { open: dialog.open };
}
