/** The theme, which the browser stores: a choice on the page holds in the lesson, too. */
import { kept } from './remembered.js';

export const { text: keptTheme, keep: keepTheme } = kept('theme');

/** Sets the document's theme; any value other than these two means the system's. @param {string} theme */
export function showTheme(theme) {
  if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
}

// Before the first frame.
showTheme(keptTheme);
