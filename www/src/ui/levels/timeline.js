/** The timeline: one set of buttons, a range under bars, and the present place. */

import { computed, signal } from '@preact/signals-core';
import { clamp } from '../../engine/vector.js';
import { button } from '../button.js';
import { fill, h, live, s } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatShare } from '../format.js';
import { createRange } from '../range.js';
import { createSelect } from '../select.js';
import { isMeant, moveOf } from './keys.js';
import { createLevels } from './levels.js';
import { Player } from './player.js';
import { describeLevel } from './table.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Bars, ButtonProps } from '../types.js'
 * @import { Levels, TimelineOptions, To, Told } from './types.js'
 */

/** Speeds of playback; 1 is ten levels per second. */
const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {TimelineOptions} page
 */
export function createTimeline(body, engine, { told, say }) {
  const levels = createLevels(engine);
  const player = new Player(engine, levels);
  live(body, () => {
    told.value = describe(engine, levels);
  });
  const range = rangeOf(player);
  const track = trackOf(levels, range);
  const charts = chartsOf(body, engine, player, say);
  fill(body, playOf(player), track, captionOf(levels), stepsOf(player), speedOf(player), charts);
  explain(
    track,
    () => ({
      title: 'Generation levels',
      text: 'New particles per level, then the relaxation. Press or drag to see the front as far as that level.',
    }),
    { side: 'above', focus: false },
  );
  takeKeys(player, range);
  restore(body, engine, { levels, say });
  const by = (/** @type {To} */ to) => () => player.move(to);
  return { first: by('first'), back: by(-1), forward: by(1), all: by('last'), toggle: () => player.toggle() };
}

/**
 * Returns the caption of the present place; null if the whole run is shown, which has its own caption.
 * @param {Engine} engine
 * @param {Levels} levels
 * @returns {Told | null}
 */
function describe(engine, { table, newest, kept, some, whole, relaxed, text }) {
  if (!some.value || whole.value) return null;
  if (relaxed.value !== null) {
    const energy = engine.report.value?.energy ?? [];
    const fallen = formatShare(1 - energy[relaxed.value] / energy[0]);
    return { title: text.value, text: energy.length > 0 ? `The energy is ${fallen} below that of the placing.` : '' };
  }
  const isMesh = engine.state.value.view.draw === 'mesh';
  const asPlaced = kept.value > 0 && !isMesh;
  return describeLevel(table.value, newest.value, asPlaced ? null : engine.progress.value.relax_step);
}

/** Creates the bars and the range over them. @param {Levels} levels @param {HTMLInputElement} range */
function trackOf({ last, bars: all, at, whole }, range) {
  const places = computed(() => last.value + 1);
  const bars = () => drawBars(all.value, places.value);
  return h(
    'div',
    {
      class: 'levels-track',
      style: { '--bars': () => places.value, '--done': () => (at.value + 1) / places.value },
      'data-chosen': () => !whole.value,
    },
    // The bars are drawn twice: pale in full, and coloured up to the present place.
    h('div', { class: 'levels-chart', 'aria-hidden': 'true' }, bars, bars),
    range,
  );
}

/** @param {Player} player */
function rangeOf(player) {
  const { some, text, at, last } = player.levels;
  const range = createRange({
    look: 'levels-range',
    max: () => last.value,
    at: () => at.value,
    say: () => (some.value ? text.value : 'Nothing to step through yet'),
    change: (place) => player.seek(place),
    disabled: () => !some.value,
    'aria-label': 'Timeline, by levels',
  });
  /** @param {PointerEvent} event */
  const placeUnder = ({ clientX }) => {
    const { left, width } = range.getBoundingClientRect();
    const most = last.peek();
    return clamp(Math.floor(((clientX - left) / Math.max(1, width)) * (most + 1)), 0, most);
  };
  // The page handles the press itself, so that a press anywhere in a bar selects it on every system.
  range.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || range.disabled) return;
    range.setPointerCapture(event.pointerId);
    player.seek(placeUnder(event));
  });
  range.addEventListener('pointermove', (event) => {
    if (range.hasPointerCapture(event.pointerId)) player.seek(placeUnder(event));
  });
  range.addEventListener('mousedown', (event) => {
    event.preventDefault();
    range.focus({ preventScroll: true });
  });
  range.addEventListener('dblclick', () => player.seek(last.peek()));
  return range;
}

/** Handles the keys of the timeline. @param {Player} player @param {HTMLInputElement} range */
function takeKeys(player, range) {
  addEventListener('keydown', (event) => {
    if (!isMeant(event)) return;
    const { target, key } = event;
    if (key === ' ' && !event.ctrlKey && !event.metaKey && !event.altKey) player.toggle();
    else {
      const to = moveOf(event, target === range);
      if (!to) return;
      player.move(to);
    }
    event.preventDefault();
  });
}

/**
 * Goes to the level in a link once the surface is there, and says if the link's level does not exist.
 * @param {HTMLElement} body @param {Engine} engine @param {{ levels: Levels, say: (text: string) => void }} parts
 */
function restore(body, engine, { levels, say }) {
  let isNew = true;
  addEventListener('hashchange', () => {
    isNew = true;
  });
  const rests = computed(() => {
    const { phase, particles } = engine.progress.value;
    return engine.status.value !== 'sampling' && engine.loading.value === null && phase === 'done' && particles > 0;
  });
  live(body, () => {
    // Reading a link starts a run at once.
    if (rests.value && levels.table.value.count > 0) queueMicrotask(() => rests.peek() && go());
  });

  function go() {
    if (!isNew) return;
    isNew = false;
    const { level, step } = engine.state.peek().view;
    const { last } = levels.table.peek();
    const steps = levels.last.peek() - last;
    if (level !== null) levels.turnTo(level);
    if (level !== null && level > last)
      say(`The link names level ${formatCount(level)}. The last one, ${formatCount(last)}, is shown.`);
    if (level === null && step !== null && step > steps)
      say(`The link names relaxation step ${formatCount(step)}. The last one, ${formatCount(steps)}, is shown.`);
  }
}

/** Creates the caption with the present place. @param {Levels} levels */
function captionOf({ short, some }) {
  return h('p', { class: 'levels-now', 'aria-hidden': 'true' }, () => {
    const [place, of] = short.value;
    return some.value && [`${place} `, h('span', { class: 'unit' }, of)];
  });
}

/** @param {Player} player */
function speedOf(player) {
  return createSelect({
    name: 'Speed of the timeline',
    choices: SPEEDS.map((value) => ({ value, label: `${value}\u202f×` })),
    value: () => player.speed,
    change: (value) => {
      player.speed = value;
    },
    look: 'speed',
  });
}

/**
 * Creates the button that shows the charts above the timeline. They are loaded on first use.
 * @param {HTMLElement} body @param {Engine} engine @param {Player} player @param {(text: string) => void} say
 */
function chartsOf(body, engine, player, say) {
  /** @type {Awaited<ReturnType<typeof import('./charts.js')['createCharts']>> | null} */
  let charts = null;
  const isShown = signal(false);
  const toggle = async () => {
    try {
      charts ??= await (await import('./charts.js')).createCharts(engine, player);
    } catch {
      return say('The charts did not load. The timeline is not affected.');
    }
    const { element, shown } = charts;
    if (element.isConnected) element.remove();
    else body.before(element);
    shown.value = element.isConnected;
    isShown.value = shown.value;
  };
  const text = 'Particles and fates per level, energy and moves per relaxation step, distances and neighbours.';
  return explain(
    button({
      class: 'plain square charts-toggle',
      icon: 'charts',
      'aria-label': 'Charts',
      'aria-expanded': () => String(isShown.value),
      press: () => void toggle(),
    }),
    () => ({ title: 'Charts', text }),
    { side: 'above' },
  );
}

/** @param {Player} player */
function playOf(player) {
  const { playing, levels } = player;
  return step('Space', {
    class: 'plain square levels-play',
    icon: () => (playing.value ? 'pause' : 'play'),
    'aria-label': () => (playing.value ? 'Pause' : 'Play'),
    off: () => !levels.some.value,
    press: () => player.toggle(),
  });
}

/** @param {Player} player */
function stepsOf(player) {
  const { some, at, last } = player.levels;
  const isFirst = () => !some.value || at.value === 0;
  const isLast = () => !some.value || at.value >= last.value;
  const move = (/** @type {To} */ to) => () => player.move(to);
  return h('div', { class: 'levels-steps', role: 'group', 'aria-label': 'Step along the timeline' }, [
    step('Home', { icon: 'first', 'aria-label': 'First level', off: isFirst, press: move('first') }),
    step('Page up', { icon: 'back', 'aria-label': 'Level back', off: isFirst, press: move(-1) }),
    step('Page down', { icon: 'forward', 'aria-label': 'Level forward', off: isLast, press: move(1) }),
    step('End', { icon: 'last', 'aria-label': 'All levels', off: isLast, press: move('last') }),
  ]);
}

/** @param {string} key @param {ButtonProps} props */
function step(key, props) {
  const element = button(props);
  return explain(element, () => ({ title: element.ariaLabel ?? '', text: `Key ${key}` }), { side: 'above' });
}

/** Gap on each side of a bar, as a share of its width, and the minimum height of a bar. */
const GAP = 0.1;
const LEAST = 0.06;

/**
 * Draws the bars as one path, stretched to the available width.
 * @param {Bars} bars @param {number} places
 */
function drawBars({ heights, widths }, places) {
  const all = Array.from(heights);
  const most = all.reduce((a, b) => Math.max(a, b), 1e-9);
  let left = 0;
  const bars = all.map((height, k) => {
    const width = widths?.[k] ?? 1;
    const x = left + GAP * width;
    left += width;
    // A minimum height keeps a level with few particles visible.
    const top = (1 - Math.max(height / most, LEAST)).toFixed(3);
    return `M${+x.toFixed(3)} 1V${top}h${+((1 - 2 * GAP) * width).toFixed(3)}V1z`;
  });
  const d = bars.join('');
  return s('svg', { viewBox: `0 0 ${places} 1`, preserveAspectRatio: 'none' }, s('path', { d }));
}
