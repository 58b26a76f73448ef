/** Stops in the address: every chapter, question and comparison has one. */
import { byId } from '../ui/dom.js';
import { BENCH, isBench, readAddress, stopFor, titleOf, writeAddress } from './address.js';
import { whenNear } from './figure.js';

/** @import { Setup, StopsOptions } from './types.js' */

/** The part of the page for collecting work, and the element of the bench. */
const [COLLECT, BENCH_HOST] = ['collect', 'bench'];
/** Height of the bar at the top of the window, in pixels. */
export const HEAD_PX = 60;

/** Shows the part that collects answers to an assignment. @param {Pick<StopsOptions, 'teach' | 'say'>} about */
async function collect({ teach, say }) {
  try {
    (await teach()).mountCollect(byId(COLLECT));
  } catch {
    say('The part that collects answers could not be loaded. Load the page again.');
  }
}

/** @param {StopsOptions} about */
export function mountStops({ stops, onBench, teach, say }) {
  const all = [...stops, COLLECT];
  let isBenchShown = false;
  /** Shows the comparison in the address; without one, that which is there. @param {Record<string, string>} parts */
  function showBench(parts) {
    if (isBenchShown && !parts.left && !parts.right) return;
    isBenchShown = true;
    void onBench(parts);
  }

  /** Goes to the stop in the address. */
  function go() {
    const { stop, parts } = readAddress(location.hash);
    if (!stop) return;
    const found = stopFor(stop, all);
    const place = document.getElementById(found);
    if (!place) return say(`There is no stop “${stop}” in this lesson.`);
    if (found !== stop) {
      say(`There is no stop “${stop}” in this lesson. This is the nearest, “${titleOf(place)}”.`, place);
      history.replaceState(history.state, '', writeAddress({ stop: found, parts }));
    }
    if (isBench(found)) showBench(parts);
    if (found === COLLECT) void collect({ teach, say });
    settleOn(place);
  }

  let leave = new AbortController();
  /**
   * Scrolls a stop to the top, again whenever a figure above it changes its height, until the reader acts.
   * @param {HTMLElement} target
   */
  function settleOn(target) {
    leave.abort();
    leave = new AbortController();
    const { signal } = leave;
    target.scrollIntoView({ block: 'start' });
    let isFirst = true;
    const observer = new ResizeObserver(() => {
      if (!isFirst) target.scrollIntoView({ block: 'start', behavior: 'instant' });
      isFirst = false;
    });
    observer.observe(document.body);
    signal.addEventListener('abort', () => observer.disconnect());
    for (const act of ['wheel', 'touchstart', 'pointerdown', 'keydown'])
      addEventListener(act, () => leave.abort(), { signal, passive: true });
  }

  // A link in the page names only a stop; the other parts of the address are kept.
  document.addEventListener('click', (event) => {
    const link = event.target instanceof Element ? event.target.closest('a[href^="#"]') : null;
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey || event.button !== 0) return;
    event.preventDefault();
    const { parts } = readAddress(location.hash);
    const { stop } = readAddress(link.getAttribute('href') ?? '');
    const next = writeAddress({ stop, parts });
    if (next === location.hash) go();
    else location.hash = next;
    // The focus moves to the target, as with an anchor.
    const target = document.getElementById(stop);
    target?.setAttribute('tabindex', '-1');
    target?.focus({ preventScroll: true });
  });
  addEventListener('hashchange', go);
  go();

  // The comparison runs when it comes near the window, like figures.
  const bench = document.getElementById(BENCH_HOST);
  if (bench) whenNear(bench, async () => showBench({}));
}

/** Puts a comparison into the address. @param {Setup} setup */
export function keepSetup(setup) {
  const { parts } = readAddress(location.hash);
  history.replaceState(history.state, '', writeAddress({ stop: BENCH, parts: { ...parts, ...setup } }));
}
