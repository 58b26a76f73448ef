/**
 * The timeline of the generation levels: a bar per level for its new particles, a slider over the bars, and buttons.
 */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, plural } from '../format.js';
import { icon } from '../icons.js';
import { clamp } from '../scale.js';
import { Stepper } from './stepper.js';
import { describeLevel, shortOf } from './table.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {{ title: string, text: string }} Told */
/** @typedef {ReturnType<typeof createTimeline>} Timeline */

/** Levels per second. */
const SPEEDS = [2, 5, 10, 25];
const USUAL_SPEED = 10;

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {import('@preact/signals-core').Signal<Told | null>} told  the level in words, null while all are shown
 */
export function createTimeline(body, engine, told) {
  const speed = h(
    'select',
    { class: 'select speed', 'aria-label': 'Levels per second' },
    SPEEDS.map((value) => h('option', { value, selected: value === USUAL_SPEED }, `${value}\u202f/\u202fs`)),
  );
  const stepper = new Stepper(engine, () => Number(speed.value));
  const { table, chosen, some, at } = stepper;
  effect(() => {
    const one = chosen.value !== null && some.value;
    told.value = one ? describeLevel(table.value, at.value, engine.progress.value.relax_step) : null;
  });
  const commands = {
    first: () => stepper.seek(0),
    back: () => stepper.step(-1),
    toggle: () => stepper.toggle(),
    forward: () => stepper.step(1),
    all: () => stepper.seek(null),
  };
  const track = trackOf(stepper);
  fill(body, buttonsOf(stepper, commands), track, captionOf(stepper), speed);
  const about = {
    title: 'Generation levels',
    text: 'New particles per level. Press or drag to see the front as far as that level.',
  };
  explain(track, () => about, { side: 'above' });
  return commands;
}

/** Creates the bars and the slider over them. @param {Stepper} stepper */
function trackOf(stepper) {
  const { table, chosen, some, at } = stepper;
  const range = sliderOf(stepper);
  const chart = h('div', { class: 'levels-chart', 'aria-hidden': 'true' });
  const track = h('div', { class: 'levels-track' }, chart, range);
  effect(() => {
    const { fresh, last } = table.value;
    // The bars are drawn twice: pale in full, and coloured up to the present level.
    fill(chart, bars(fresh), bars(fresh));
    track.style.setProperty('--bars', String(last + 1));
    range.max = String(last);
  });
  effect(() => {
    const { last, count } = table.value;
    range.disabled = !some.value;
    range.valueAsNumber = at.value;
    const whole = `All ${plural(last + 1, 'level')}: ${plural(count, 'particle')}`;
    const words = chosen.value === null ? whole : shortOf(table.value, at.value);
    range.setAttribute('aria-valuetext', some.value ? words : 'No levels yet');
    track.style.setProperty('--done', String((at.value + 1) / (last + 1)));
    track.toggleAttribute('data-chosen', chosen.value !== null);
  });
  return track;
}

/** @param {Stepper} stepper */
function sliderOf(stepper) {
  const range = h('input', { type: 'range', class: 'levels-range', min: 0, step: 1, 'aria-label': 'Generation level' });
  /** @param {PointerEvent} event */
  const levelUnder = ({ clientX }) => {
    const { left, width } = range.getBoundingClientRect();
    return clamp(Math.floor(((clientX - left) / Math.max(1, width)) * (stepper.last + 1)), 0, stepper.last);
  };
  // The page handles the press itself, so that a press anywhere in a bar selects it on every system.
  range.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || range.disabled) return;
    range.setPointerCapture(event.pointerId);
    stepper.seek(levelUnder(event));
  });
  range.addEventListener('pointermove', (event) => {
    if (range.hasPointerCapture(event.pointerId)) stepper.seek(levelUnder(event));
  });
  range.addEventListener('mousedown', (event) => {
    event.preventDefault();
    range.focus({ preventScroll: true });
  });
  range.addEventListener('input', () => stepper.seek(range.valueAsNumber));
  range.addEventListener('dblclick', () => stepper.seek(null));
  return range;
}

/** Creates the caption with the present level. @param {Stepper} stepper */
function captionOf({ table, chosen, some, at }) {
  const now = h('p', { class: 'levels-now', 'aria-hidden': 'true' });
  const unit = (/** @type {string} */ text) => h('span', { class: 'unit' }, text);
  effect(() => {
    const last = formatCount(table.value.last);
    if (!some.value) fill(now);
    else if (chosen.value === null) fill(now, 'All levels ', unit(`0 to ${last}`));
    else fill(now, `Level ${formatCount(at.value)} `, unit(`of ${last}`));
  });
  return now;
}

/** @param {Stepper} stepper @param {Record<'first' | 'back' | 'toggle' | 'forward' | 'all', () => void>} commands */
function buttonsOf({ chosen, some, playing }, commands) {
  const notFirst = computed(() => some.value && chosen.value !== 0);
  const notAll = computed(() => some.value && chosen.value !== null);
  const toggle = button('play', 'Play', 'Shows one level after another.', 'P', commands.toggle, some);
  effect(() => {
    toggle.setAttribute('aria-label', playing.value ? 'Pause' : 'Play');
    toggle.replaceChildren(icon(playing.value ? 'pause' : 'play'));
  });
  return h(
    'div',
    { class: 'levels-buttons', role: 'group', 'aria-label': 'Step through the levels' },
    button('first', 'First level', 'The seed.', '<', commands.first, notFirst),
    button('back', 'Level back', 'One generation level less.', ',', commands.back, notFirst),
    toggle,
    button('forward', 'Level forward', 'One generation level more.', '.', commands.forward, notAll),
    button('last', 'All levels', 'Every particle, all alike.', '>', commands.all, notAll),
  );
}

/**
 * @param {import('../icons.js').IconName} name
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
    icon(name),
  );
  effect(() => element.setAttribute('aria-disabled', String(!enabled.value)));
  explain(element, () => ({ title: element.getAttribute('aria-label') ?? label, text: `${text} Key ${key}` }), {
    side: 'above',
  });
  return element;
}

/** Draws a bar per level as one path, which is stretched to the available width. @param {Uint32Array} fresh */
function bars(fresh) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  const most = fresh.reduce((a, b) => Math.max(a, b), 1);
  svg.setAttribute('viewBox', `0 0 ${fresh.length} 1`);
  svg.setAttribute('preserveAspectRatio', 'none');
  // A minimum height keeps a level with few particles visible.
  path.setAttribute(
    'd',
    Array.from(fresh, (n, k) => `M${k + GAP} 1V${(1 - Math.max(n / most, LEAST)).toFixed(3)}h${1 - 2 * GAP}V1z`).join(
      '',
    ),
  );
  svg.append(path);
  return svg;
}
/** Gap on each side of a bar, as a share of a level's width, and the minimum height of a bar. */
const GAP = 0.1;
const LEAST = 0.06;
