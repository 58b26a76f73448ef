/** The theme, which the browser keeps: what was chosen on the page is that of the lesson, too. */
import { kept } from './remembered.js';

export const { text: keptTheme, keep: keepTheme } = kept('theme');

/** Gives the document a theme; all others than these two are that of the system. @param {string} theme */
export function showTheme(theme) {
  if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
}

// From the first frame on.
showTheme(keptTheme);
