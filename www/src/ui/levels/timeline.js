/**
 * The timeline of the generation levels: a bar for the new particles of each, a slider over them, and buttons to go level by level.
 * The level is part of the state; what is drawn of it is the picture's affair.
 */
import { computed, effect, signal } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, plural } from '../format.js';
import { drawIcon } from '../icons.js';
import { clamp } from '../scale.js';
import { describeLevel, levelTable, shortOf } from './table.js';
import { turnToSeed } from './turn.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {{ title: string, text: string }} Told */
/** @typedef {ReturnType<typeof createTimeline>} Timeline */

/** Levels per second. */
const SPEEDS = [2, 5, 10, 25];
const USUAL_SPEED = 10;

const ICONS = {
  first: 'M4.500 4v8M11.500 4 7.500 8l4 4',
  back: 'M9.800 4 5.800 8l4 4',
  play: 'M5 3.500v9l7.500-4.500z',
  pause: 'M5.500 4v8M10.500 4v8',
  forward: 'M6.200 4l4 4-4 4',
  all: 'M11.500 4v8M4.500 4l4 4-4 4',
};

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {import('@preact/signals-core').Signal<Told | null>} told  the level in words, null while all are shown
 */
export function createTimeline(body, engine, told) {
  const table = signal(levelTable(engine.columns));
  const chosen = computed(() => engine.state.value.view.level);
  const some = computed(() => table.value.count > 0 && !engine.empty.value);
  /** The newest level that is drawn. */
  const at = computed(() => Math.min(chosen.value ?? Infinity, table.value.last));

  // However many pieces a run comes in, the table is made once a frame.
  let asked = false;
  effect(() => {
    void engine.revision.value;
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      table.value = levelTable(engine.columns);
    });
  });
  effect(() => {
    told.value =
      chosen.value !== null && some.value
        ? describeLevel(table.value, at.value, engine.progress.value.relax_step)
        : null;
  });

  /** @param {number | null} level */
  const show = (level) => {
    if (level === chosen.peek()) return;
    if (chosen.peek() === null) turnToSeed(engine);
    engine.setView({ level });
  };

  // ---- by itself ----------------------------------------------------------------------------------------------------------

  const playing = signal(false);
  const speed = h(
    'select',
    { class: 'select speed', 'aria-label': 'Levels per second' },
    SPEEDS.map((value) => h('option', { value, selected: value === USUAL_SPEED }, `${value}\u202f/\u202fs`)),
  );
  let timer = 0;
  const pause = () => {
    clearTimeout(timer);
    playing.value = false;
  };
  const wait = () => {
    timer = window.setTimeout(next, 1000 / Number(speed.value));
  };
  function next() {
    const level = chosen.peek();
    // Another run may have begun meanwhile; after the last level all of them are shown alike.
    if (level === null || level >= table.peek().last) {
      show(null);
      pause();
      return;
    }
    show(level + 1);
    wait();
  }
  const play = () => {
    if (!some.peek()) return;
    if (chosen.peek() === null || at.peek() >= table.peek().last) show(0);
    playing.value = true;
    wait();
  };

  // ---- by hand ------------------------------------------------------------------------------------------------------------

  /** @param {number | null} level */
  const seek = (level) => {
    pause();
    if (some.peek()) show(level);
  };
  /** @param {1 | -1} by */
  const step = (by) => {
    const to = at.peek() + by;
    // From the whole picture a step back leads to the last level, a step forward from that to the whole picture.
    if (chosen.peek() === null) seek(by < 0 ? table.peek().last : null);
    else seek(to > table.peek().last ? null : Math.max(0, to));
  };
  const commands = {
    first: () => seek(0),
    back: () => step(-1),
    toggle: () => (playing.peek() ? pause() : play()),
    forward: () => step(1),
    all: () => seek(null),
  };

  const range = h('input', { type: 'range', class: 'levels-range', min: 0, step: 1, 'aria-label': 'Generation level' });
  /** @param {PointerEvent} event */
  const levelUnder = ({ clientX }) => {
    const { left, width } = range.getBoundingClientRect();
    const bars = table.peek().last + 1;
    return clamp(Math.floor(((clientX - left) / Math.max(1, width)) * bars), 0, bars - 1);
  };
  // By hand, so that a press anywhere in a bar leads there, on every system.
  range.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || range.disabled) return;
    range.setPointerCapture(event.pointerId);
    seek(levelUnder(event));
  });
  range.addEventListener('pointermove', (event) => {
    if (range.hasPointerCapture(event.pointerId)) seek(levelUnder(event));
  });
  range.addEventListener('mousedown', (event) => {
    event.preventDefault();
    range.focus({ preventScroll: true });
  });
  range.addEventListener('input', () => seek(range.valueAsNumber));
  range.addEventListener('dblclick', () => seek(null));

  // ---- how it looks -------------------------------------------------------------------------------------------------------

  const chart = h('div', { class: 'levels-chart', 'aria-hidden': 'true' });
  const track = h('div', { class: 'levels-track' }, chart, range);
  effect(() => {
    const { fresh, last } = table.value;
    fill(chart, bars(fresh), bars(fresh));
    track.style.setProperty('--bars', String(last + 1));
    range.max = String(last);
  });
  effect(() => {
    const { last } = table.value;
    range.disabled = !some.value;
    range.valueAsNumber = at.value;
    range.setAttribute(
      'aria-valuetext',
      !some.value
        ? 'No levels yet'
        : chosen.value === null
          ? `All ${plural(last + 1, 'level')}: ${plural(table.value.count, 'particle')}`
          : shortOf(table.value, at.value),
    );
    track.style.setProperty('--done', String((at.value + 1) / (last + 1)));
    track.toggleAttribute('data-chosen', chosen.value !== null);
  });

  const now = h('p', { class: 'levels-now', 'aria-hidden': 'true' });
  effect(() => {
    const { last } = table.value;
    if (!some.value) fill(now);
    else if (chosen.value === null) fill(now, 'All levels ', h('span', { class: 'unit' }, `0 to ${formatCount(last)}`));
    else fill(now, `Level ${formatCount(at.value)} `, h('span', { class: 'unit' }, `of ${formatCount(last)}`));
  });

  const ends = computed(() => some.value && chosen.value !== 0);
  const toggle = button('play', 'Play', 'Shows one level after another.', 'P', commands.toggle, some);
  effect(() => {
    const label = playing.value ? 'Pause' : 'Play';
    toggle.setAttribute('aria-label', label);
    toggle.replaceChildren(drawIcon(ICONS[playing.value ? 'pause' : 'play']));
  });
  fill(
    body,
    h(
      'div',
      { class: 'levels-buttons', role: 'group', 'aria-label': 'Step through the levels' },
      button('first', 'First level', 'The seed.', '<', commands.first, ends),
      button('back', 'Level back', 'One generation level less.', ',', commands.back, ends),
      toggle,
      button(
        'forward',
        'Level forward',
        'One generation level more.',
        '.',
        commands.forward,
        computed(() => some.value && chosen.value !== null),
      ),
      button(
        'all',
        'All levels',
        'Every particle, all alike.',
        '>',
        commands.all,
        computed(() => some.value && chosen.value !== null),
      ),
    ),
    track,
    now,
    speed,
  );
  explain(
    track,
    () => ({
      title: 'Generation levels',
      text: 'New particles per level. Press or drag to see the front as far as that level.',
    }),
    { side: 'above' },
  );
  return commands;
}

/**
 * @param {keyof typeof ICONS} name
 * @param {string} label
 * @param {string} text
 * @param {string} key
 * @param {() => void} act
 * @param {import('@preact/signals-core').ReadonlySignal<boolean>} enabled
 */
function button(name, label, text, key, act, enabled) {
  const element = h(
    'button',
    {
      type: 'button',
      class: 'button plain square',
      'aria-label': label,
      on: {
        click: () => {
          if (enabled.peek()) act();
        },
      },
    },
    drawIcon(ICONS[name]),
  );
  effect(() => element.setAttribute('aria-disabled', String(!enabled.value)));
  explain(element, () => ({ title: element.getAttribute('aria-label') ?? label, text: `${text} Key ${key}` }), {
    side: 'above',
  });
  return element;
}

/** A bar per level as one path, stretched to the room there is. @param {Uint32Array} fresh */
function bars(fresh) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  const most = fresh.reduce((a, b) => Math.max(a, b), 1);
  svg.setAttribute('viewBox', `0 0 ${fresh.length} 1`);
  svg.setAttribute('preserveAspectRatio', 'none');
  // A level with one particle among hundreds is still to be seen.
  path.setAttribute(
    'd',
    Array.from(fresh, (n, k) => `M${k + GAP} 1V${(1 - Math.max(n / most, LEAST)).toFixed(3)}h${1 - 2 * GAP}V1z`).join(
      '',
    ),
  );
  svg.append(path);
  return svg;
}
/** Room on each side of a bar, as a share of a level's width; and the least height of a bar. */
const GAP = 0.1;
const LEAST = 0.06;
