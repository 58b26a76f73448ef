/**
 * Locks controls of the lesson's page that an assignment names. Those of its own comparison are locked where they are
 * made.
 */

/** Selectors of the controls that may be locked beside the assignment's comparison. @type {Record<string, string>} */
const PARTS = {
  figures: '.stage .controls',
  questions: '.predict-form .controls',
  bench: '#bench > .controls, .card > .button',
};

/** @param {HTMLElement} root @param {readonly string[]} locks */
export function lockParts(root, locks) {
  const selector = locks.flatMap((name) => PARTS[name] ?? []).join(', ');
  if (!selector) return;
  const apply = () => {
    for (const part of root.querySelectorAll(selector)) part.toggleAttribute('inert', true);
  };
  // Figures are made later than this, and make some of their controls anew.
  new MutationObserver(apply).observe(root, { childList: true, subtree: true });
  apply();
  if (!locks.includes('questions')) return;
  // Enter in a box would press the button all the same.
  const stop = (/** @type {Event} */ event) => {
    event.preventDefault();
    event.stopImmediatePropagation();
  };
  root.addEventListener('submit', stop, true);
}
