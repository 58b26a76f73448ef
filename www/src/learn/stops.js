/** Stops in the address: every chapter, question and comparison has one. */
import { byId } from '../ui/dom.js';
import { BENCH, nearestStop, readAddress, titleOf, writeAddress } from './address.js';

/** @import { Setup, StopsOptions } from './types.js' */

/** The part of the page for collecting work. */
const COLLECT = 'collect';
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
export function mountStops({ stops, others, onBench, teach, say }) {
  const all = [...stops, ...others, COLLECT];
  let isBenchShown = false;
  const showBench = (/** @type {string} */ id, /** @type {Record<string, string>} */ parts = {}) => {
    isBenchShown = true;
    void onBench(id, parts);
  };

  /** Goes to the stop in the address. */
  function go() {
    const { stop, parts } = readAddress(location.hash);
    const found = nearestStop(stop, all);
    if (!found) return;
    if (!found.isExact) {
      const nearest = document.getElementById(found.stop) ?? document.getElementById(BENCH);
      say(`There is no stop “${stop}” in this lesson. This is the nearest, “${titleOf(nearest)}”.`, nearest);
      history.replaceState(history.state, '', writeAddress({ stop: found.stop, parts }));
    }
    const isBench = others.includes(found.stop);
    if (isBench) showBench(found.stop.slice(BENCH.length + 1), parts);
    if (found.stop === COLLECT) void collect({ teach, say });
    settleOn(document.getElementById(isBench ? BENCH : found.stop));
  }

  let leave = new AbortController();
  /**
   * Scrolls a stop to the top, again whenever a figure above it changes its height, until the reader acts.
   * @param {HTMLElement | null} target
   */
  function settleOn(target) {
    leave.abort();
    leave = new AbortController();
    const { signal } = leave;
    if (!target) return;
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
    const target = document.getElementById(others.includes(stop) ? BENCH : stop);
    target?.setAttribute('tabindex', '-1');
    target?.focus({ preventScroll: true });
  });
  addEventListener('hashchange', go);
  go();

  // The comparison runs when it comes near the window, like figures.
  const bench = document.getElementById(BENCH);
  const observer = new IntersectionObserver(
    (entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      observer.disconnect();
      if (!isBenchShown) showBench('');
    },
    { rootMargin: '300px 0px' },
  );
  if (bench) observer.observe(bench);
}

/** Puts a comparison with its values into the address. @param {Setup} setup */
export function keepSetup({ what, on, left, right }) {
  const { parts } = readAddress(location.hash);
  const address = writeAddress({ stop: `${BENCH}-${what}`, parts: { ...parts, on, left, right } });
  history.replaceState(history.state, '', address);
}
