/**
 * The timeline: the choice of its grain, one set of buttons, a range under bars, and the present place. The grains that
 * are finer than a level open the panel that follows a particle.
 */

import { computed, signal } from '@preact/signals-core';
import { clamp } from '../../engine/vector.js';
import { button } from '../button.js';
import { fill, h, live, s } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatShare } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createSelect } from '../select.js';
import { isMeant, moveOf } from './keys.js';
import { createLevels } from './levels.js';
import { Player } from './player.js';
import { describeLevel } from './table.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Bars, ButtonProps } from '../types.js'
 * @import { Levels, Move, TimelineOptions, Told } from './types.js'
 */

/** Speeds of the playback; 1 is ten levels, two particles or an event a second. */
const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
const GRAINS = /** @type {const} */ ([
  { value: 'level', label: 'Level' },
  { value: 'particle', label: 'Particle' },
  { value: 'event', label: 'Event' },
]);

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {TimelineOptions} page
 */
export function createTimeline(body, engine, { told, loadFollow, say }) {
  const levels = createLevels(engine);
  const player = new Player(engine, levels, loadFollow);
  live(body, () => {
    told.value = describe(engine, levels, player);
  });
  const range = rangeOf(player);
  const track = trackOf(player, range);
  const grains = createSegmented({
    name: 'Steps of the timeline',
    choices: GRAINS,
    value: () => player.grain.value,
    disabled: () => !levels.some.value,
    change: (grain) => player.choose(grain),
  });
  fill(body, grains, buttonsOf(player), track, captionOf(player), speedOf(player), chartsOf(body, engine, player, say));
  explainParts(grains, track, player);
  takeKeys(player, { body, range });
  restore(body, engine, player, { levels, say });
  live(body, () => {
    // The keys work at once: from the panel that has opened the focus goes to the range.
    const isReady = player.isOpen.value && player.track.value.some.value;
    if (isReady && document.activeElement?.matches('.panel-follow')) range.focus({ preventScroll: true });
  });
  const by = (/** @type {Move['to']} */ to) => () => player.move({ grain: 'level', to });
  return {
    first: by('first'),
    back: by(-1),
    forward: by(1),
    all: by('last'),
    toggle: () => player.toggle(),
    follow: (/** @type {number} */ index) => player.follow(index),
  };
}

/**
 * Returns the caption of the present place; null where it is the caption of the whole run.
 * @param {Engine} engine
 * @param {Levels} levels
 * @param {Player} player
 * @returns {Told | null}
 */
function describe(engine, { table, newest, kept, some, whole, relaxed, text }, player) {
  if (!some.value) return null;
  if (player.grain.value !== 'level') return { title: player.track.value.text.value, text: '' };
  if (whole.value) return null;
  if (relaxed.value !== null) {
    const energy = engine.report.value?.energy ?? [];
    const fallen = formatShare(1 - energy[relaxed.value] / energy[0]);
    return { title: text.value, text: energy.length > 0 ? `The energy is ${fallen} below that of the placing.` : '' };
  }
  const isMesh = engine.state.value.view.draw === 'mesh';
  const asPlaced = kept.value > 0 && !isMesh;
  return describeLevel(table.value, newest.value, asPlaced ? null : engine.progress.value.relax_step);
}

/** Creates the bars and the range over them. @param {Player} player @param {HTMLInputElement} range */
function trackOf({ track }, range) {
  const places = computed(() => track.value.last.value + 1);
  const bars = () => drawBars(track.value.bars.value, places.value);
  return h(
    'div',
    {
      class: 'levels-track',
      style: { '--bars': () => places.value, '--done': () => (track.value.at.value + 1) / places.value },
      'data-chosen': () => !track.value.whole.value,
    },
    // The bars are drawn twice: pale in full, and coloured up to the present place.
    h('div', { class: 'levels-chart', 'aria-hidden': 'true' }, bars, bars),
    range,
  );
}

/** @param {Player} player */
function rangeOf(player) {
  const { track } = player;
  const some = () => track.value.some.value;
  const range = h('input', {
    type: 'range',
    class: 'levels-range',
    min: 0,
    step: 1,
    disabled: () => !some(),
    'aria-label': () => `Timeline, by ${track.value.name}s`,
    'aria-valuetext': () => (some() ? track.value.text.value : 'Nothing to step through yet'),
  });
  // The place is set after the number of places, which limits it.
  live(range, () => {
    range.max = String(track.value.last.value);
    range.valueAsNumber = track.value.at.value;
  });
  /** @param {PointerEvent} event */
  const placeUnder = ({ clientX }) => {
    const { left, width } = range.getBoundingClientRect();
    const last = player.track.peek().last.peek();
    return clamp(Math.floor(((clientX - left) / Math.max(1, width)) * (last + 1)), 0, last);
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
  range.addEventListener('input', () => player.seek(range.valueAsNumber));
  range.addEventListener('dblclick', () => {
    if (player.grain.peek() === 'level') player.seek(player.levels.last.peek());
  });
  return range;
}

/**
 * Takes the keys that are meant for the timeline.
 * @param {Player} player @param {{ body: HTMLElement, range: HTMLInputElement }} parts
 */
function takeKeys(player, { body, range }) {
  // Before the page's own Escape, which stops the run.
  body.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !player.isOpen.peek()) return;
    event.preventDefault();
    player.panel.peek()?.close();
  });
  addEventListener('keydown', (event) => {
    if (!isMeant(event)) return;
    const { target, key } = event;
    if (key === ' ' && !event.ctrlKey && !event.metaKey && !event.altKey) player.toggle();
    else {
      const move = moveOf(event, { onRange: target === range, isOpen: player.isOpen.peek() });
      if (!move) return;
      player.move(move);
    }
    event.preventDefault();
  });
}

/**
 * Opens the particle that a link names, once the surface is there, and says what a link names and is not there.
 * @param {HTMLElement} body @param {Engine} engine @param {Player} player
 * @param {{ levels: Levels, say: (text: string) => void }} parts
 */
function restore(body, engine, player, { levels, say }) {
  let isNew = true;
  let seen = 'null';
  addEventListener('hashchange', () => {
    isNew = true;
  });
  const rests = computed(() => {
    const { phase, particles } = engine.progress.value;
    return !engine.busy.value && engine.loading.value === null && phase === 'done' && particles > 0;
  });
  const named = computed(() => JSON.stringify(engine.state.value.view.follow));
  live(body, () => {
    void named.value;
    // A link that is read begins a run at once.
    if (rests.value && levels.table.value.count > 0) queueMicrotask(() => rests.peek() && go());
  });

  function go() {
    const { level, step, follow } = engine.state.peek().view;
    const { last } = levels.table.peek();
    const steps = levels.last.peek() - last;
    if (isNew && level !== null && !follow) levels.turnTo(level);
    if (isNew && level !== null && level > last)
      say(`The link names level ${formatCount(level)}. The last one, ${formatCount(last)}, is shown.`);
    if (isNew && level === null && step !== null && step > steps)
      say(`The link names relaxation step ${formatCount(step)}. The last one, ${formatCount(steps)}, is shown.`);
    const isOther = named.peek() !== seen && named.peek() !== JSON.stringify(player.panel.peek()?.place.peek() ?? null);
    if (follow && (isNew || isOther)) void player.prepare().then((panel) => panel?.goTo(follow));
    isNew = false;
    seen = named.peek();
  }
}

/** Creates the caption with the present place. @param {Player} player */
function captionOf({ track }) {
  return h('p', { class: 'levels-now', 'aria-hidden': 'true' }, () => {
    const [place, of] = track.value.short.value;
    return track.value.some.value && [`${place} `, h('span', { class: 'unit' }, of)];
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
 * Creates the button that shows the charts above the timeline, which are loaded when they are first asked for.
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

/** @param {HTMLElement} grains @param {HTMLElement} track @param {Player} player */
function explainParts(grains, track, player) {
  const about = {
    level: {
      title: 'Generation levels',
      text: 'New particles per level, then the relaxation. Press or drag to see the front as far as that level.',
    },
    particle: {
      title: 'Particles',
      text: 'In the order in which they are treated; a bar per level. Press or drag to see one with its children.',
    },
    event: {
      title: 'Events of the particle',
      text: 'From its turn to its end; high bars are the fates of its children. After the last one comes the next particle.',
    },
    grains: {
      title: 'What a step is',
      text: 'A whole generation level; one particle with its children; or one event of it. Arrow keys step by events, with Shift by particles, with Alt by levels.',
    },
  };
  explain(track, () => about[player.grain.peek()], { side: 'above', focus: false });
  explain(grains, () => about.grains, { side: 'above' });
}

/** @param {Player} player */
function buttonsOf(player) {
  const { track, playing } = player;
  const name = () => track.value.name;
  const some = () => track.value.some.value;
  // Before the first event and after the last one comes another particle.
  const isFirst = () => !some() || (track.value.at.value === 0 && name() !== 'event');
  const isLast = () => !some() || (track.value.at.value >= track.value.last.value && name() !== 'event');
  const move = (/** @type {Move['to']} */ to) => () => player.move({ grain: 'chosen', to });
  return h('div', { class: 'levels-buttons', role: 'group', 'aria-label': 'Step along the timeline' }, [
    step('Home', { icon: 'first', 'aria-label': () => `First ${name()}`, off: isFirst, press: move('first') }),
    step('Page up', { icon: 'back', 'aria-label': () => `${named(name())} back`, off: isFirst, press: move(-1) }),
    step('Space', {
      icon: () => (playing.value ? 'pause' : 'play'),
      'aria-label': () => (playing.value ? 'Pause' : 'Play'),
      off: () => !some(),
      press: () => player.toggle(),
    }),
    step('Page down', { icon: 'forward', 'aria-label': () => `${named(name())} forward`, off: isLast, press: move(1) }),
    step('End', {
      icon: 'last',
      'aria-label': () => (name() === 'level' ? 'All levels' : `Last ${name()}`),
      off: isLast,
      press: move('last'),
    }),
  ]);
}

/** @param {string} name */
const named = (name) => name[0].toUpperCase() + name.slice(1);

/** @param {string} key @param {ButtonProps} props */
function step(key, props) {
  const element = button(props);
  return explain(element, () => ({ title: element.ariaLabel ?? '', text: `Key ${key}` }), { side: 'above' });
}

/** Gap on each side of a bar, as a share of its width, and the minimum height of a bar. */
const GAP = 0.1;
const LEAST = 0.06;

/**
 * Draws the bars as one path, which is stretched to the available width.
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
