/** The notes of the one who presents, in a window of their own: they never stand on the wall. */
import { signal } from '@preact/signals-core';
import { fill, h, release } from '../ui/dom.js';

/** @typedef {{ title: string, minutes: string, answer: string, notes: string } | null} Words  of a stop */

/** @param {{ now: () => Words, next: () => Words, say: (words: string) => void }} about */
export function createNotes({ now, next, say }) {
  /** @type {Window | null} */
  let shown = null;
  let timer = 0;
  let beganMs = 0;
  /** @type {((event: KeyboardEvent) => void) | null} */
  let press = null;
  const timeMs = signal(0);
  const clock = () => {
    const seconds = Math.floor((timeMs.value - beganMs) / 1000);
    const [minutes, rest] = [Math.floor(seconds / 60), String(seconds % 60).padStart(2, '0')];
    const time = new Date(timeMs.value).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });
    return `${time} · ${minutes}:${rest} since these notes were opened`;
  };
  const tick = () => {
    timeMs.value = Date.now();
  };
  function close() {
    clearInterval(timer);
    if (shown && !shown.closed) {
      release(shown.document.body);
      shown.close();
    }
    shown = null;
  }
  function open() {
    shown = window.open('', 'marching-particles-notes', 'popup,width=720,height=520');
    if (!shown) return say('The browser refused the window of notes. Allow it for this page, and press Notes again.');
    beganMs = Date.now();
    tick();
    timer = window.setInterval(tick, 1000);
    const { document: page } = shown;
    page.title = 'Notes · Marching Particles';
    page.documentElement.lang = 'en';
    page.documentElement.dataset.mode = 'notes';
    const sheets = document.querySelectorAll('link[rel="stylesheet"]');
    for (const sheet of sheets)
      page.head.append(h('link', { rel: 'stylesheet', href: /** @type {HTMLLinkElement} */ (sheet).href }));
    fill(
      page.body,
      h(
        'main',
        { class: 'speaker' },
        h('p', { class: 'speaker-clock' }, clock),
        h('h1', null, () => now()?.title ?? ''),
        h(
          'p',
          { class: 'quiet', hidden: () => !now()?.minutes },
          () => `${now()?.minutes} minutes for a reader, half as many again with a class.`,
        ),
        h('p', { hidden: () => !now()?.answer }, () => h('b', null, `Answer: ${now()?.answer}`)),
        h('p', null, () => now()?.notes ?? ''),
        h('p', { class: 'speaker-next' }, () => `Next: ${next()?.title ?? 'the end'}`),
        h('p', { class: 'quiet' }, 'Space, the arrow keys and the clicker go on from here, too. B blanks the wall.'),
      ),
    );
    if (press) shown.addEventListener('keydown', press, true);
    shown.addEventListener('pagehide', close);
  }
  addEventListener('pagehide', close);
  return {
    close,
    toggle: () => (shown && !shown.closed ? close() : open()),
    /** Has the keys of the window of notes go to the presentation. @param {(event: KeyboardEvent) => void} on */
    listen(on) {
      press = on;
    },
  };
}
