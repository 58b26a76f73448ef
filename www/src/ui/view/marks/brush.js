/**
 * The brush: a drag over the surface paints places finer or coarser, or erases what is painted. The surface is sampled
 * anew once the stroke ends.
 */
import { batch, computed, signal, untracked } from '@preact/signals-core';
import { canPaint, dabAt, MOST_DABS, readDabs, without, withStroke, writeDabs } from '../../../engine/brush.js';
import { distance, dot, nearest, triple } from '../../../engine/vector.js';
import { button } from '../../button.js';
import { h, live } from '../../dom.js';
import { explain } from '../../explain.js';
import { formatShare, plural } from '../../format.js';
import { createSegmented } from '../../segmented.js';
import { createSlider } from '../../slider.js';
import { towardEye } from '../../space.js';
import { aimOf } from './aim.js';

/**
 * @import { Dab, Engine, Signal, Vec3 } from '../../../engine/types.js'
 * @import { Brush, Pins } from '../../types.js'
 * @import { Mark, Point } from '../types.js'
 */

/** Distance of the dabs of a stroke, as a share of their reach. Larger: the line has waists. */
const STEP = 0.6;
/** Share of a dab's reach that its inner disc fills, so that its mark is soft. */
const INNER = 0.55;

/** What the brush does to the spacing. */
const TIMES = /** @type {const} */ ([
  ['0.25', '¼'],
  ['0.5', '½'],
  ['2', '2'],
  ['4', '4'],
  ['erase', 'Erase'],
]);
/** Radius of the brush as a share of the diagonal of the box: at first, and its range. */
const SHARE = 0.06;
const SIZE = /** @type {const} */ ({ min: 0.02, max: 0.4, step: 0.05, scale: 'log' });

/** What is painted, from the state. @param {Engine} engine */
export const dabsOf = (engine) => computed(() => readDabs(engine.state.value.settings.brush) ?? []);

/** @param {Engine} engine @param {readonly Dab[]} dabs */
function keep(engine, dabs) {
  if (dabs.length === 0) engine.resetSetting('brush');
  else engine.setSetting('brush', writeDabs(dabs));
}

/** Paints, and draws what is painted. */
export class Painter {
  #engine;
  #brush;
  #dabs;
  /** What is painted with the present stroke; null between strokes. @type {Signal<readonly Dab[] | null>} */
  #draft = signal(null);
  /** The places of the present stroke. @type {Dab[]} */
  #stroke = [];
  /** Whether the last press in the middle of the picture met no particle. */
  missed = signal(false);
  shown;
  #normals;

  /** @param {Engine} engine @param {Brush} brush */
  constructor(engine, brush) {
    this.#engine = engine;
    this.#brush = brush;
    this.#dabs = dabsOf(engine);
    this.shown = computed(() => this.#draft.value ?? this.#dabs.value);
    /** @type {Vec3[]} */
    let last = [];
    this.#normals = computed(() => {
      void engine.revision.value;
      const { columns } = engine;
      const isNew = this.shown.value.length !== last.length;
      if (engine.status.value === 'sampling' && !isNew) return last;
      last = this.shown.value.map(({ at }) => {
        const near = nearest(columns.positions, columns.count, at);
        return near ? triple(columns.normals, near.index) : [0, 0, 0];
      });
      return last;
    });
  }

  /** Radius of the brush. */
  get reach() {
    const box = this.#engine.field.value?.bounds;
    return box ? this.#brush.share.value * distance(box.min, box.max) : 0;
  }

  /** @param {Point} at @returns the place of the particle there */
  #placeAt({ x, y }) {
    const { columns } = this.#engine;
    const index = this.#engine.pick(x, y);
    if (index === null || columns.stale) return null;
    return triple(columns.exact.length > 0 ? columns.exact : columns.shown, index);
  }

  /** Begins a stroke at a particle under a place in the picture. @param {Point} at */
  take(at) {
    if (!this.#brush.on.peek()) return null;
    const place = this.#placeAt(at);
    if (!place || !(this.reach > 0)) return null;
    this.#stroke = [];
    this.#paint(place);
    return {
      drag: (/** @type {Point} */ now) => {
        const next = this.#draft.peek() && this.#placeAt(now);
        if (next) this.#paint(next);
      },
      drop: () => this.#end(),
    };
  }

  /** @param {Vec3} place */
  #paint(place) {
    const times = this.#brush.times.peek();
    const dab = dabAt(place, this.reach, times === 'erase' ? 1 : Number(times));
    const last = this.#stroke.at(-1);
    if (last && distance(last.at, dab.at) < STEP * dab.reach) return;
    this.#stroke.push(dab);
    this.#draft.value =
      times === 'erase'
        ? without(this.#draft.peek() ?? this.#dabs.peek(), dab.at, dab.reach)
        : withStroke(this.#dabs.peek(), this.#stroke);
  }

  #end() {
    const draft = this.#draft.peek();
    if (!draft) return;
    batch(() => {
      if (writeDabs(draft) !== writeDabs(this.#dabs.peek())) keep(this.#engine, draft);
      this.#draft.value = null;
    });
  }

  /** Gives the stroke up. @returns whether there was one */
  cancel() {
    const isOne = this.#draft.peek() !== null;
    this.#draft.value = null;
    return isOne;
  }

  /** Paints one place in the middle of the picture. */
  paintMiddle() {
    const middle = this.#engine.project(this.#engine.state.peek().view.camera.target);
    const hold = middle && this.take(middle);
    this.missed.value = !hold;
    hold?.drop();
  }

  clear() {
    keep(this.#engine, []);
  }

  /** The dabs on the side that is seen. */
  seen() {
    const eye = towardEye(this.#engine.state.value.view.camera);
    const normals = this.#normals.value;
    return this.shown.value.filter((_, k) => !normals[k] || dot(normals[k], eye) > 0);
  }
}

/**
 * @param {Engine} engine
 * @param {{ stage: HTMLElement, host: HTMLElement, brush: Brush, pins: Pins, painter: Painter, middle: HTMLElement }}
 *   parts  `middle`: the button that paints there
 * @returns {Mark}
 */
export function brushMark(engine, { stage, host, brush, pins, painter, middle }) {
  const aim = aimOf(engine, [host, middle]);
  live(stage, () => void stage.toggleAttribute('data-paints', brush.on.value));
  // A press on the surface has one meaning at a time.
  live(stage, () => {
    if (!brush.on.value) return;
    untracked(() => {
      pins.value = null;
      painter.missed.value = false;
      if (engine.state.value.view.measured) engine.setView({ measured: null });
    });
  });
  live(stage, () => {
    const { view, settings } = engine.state.value;
    if (pins.value !== null || view.measured !== null || !canPaint(settings)) brush.on.value = false;
  });
  const press = (/** @type {KeyboardEvent} */ event) => {
    if (!brush.on.peek()) return;
    const isHandled = event.key === 'Escape' ? painter.cancel() : event.key === 'Enter' && event.target === host;
    if (!isHandled) return;
    if (event.key === 'Enter') painter.paintMiddle();
    event.preventDefault();
    event.stopPropagation();
  };
  stage.addEventListener('keydown', press, true);
  return {
    shown: () => brush.on.value,
    draw(pen) {
      for (const { at, reach, times } of painter.seen()) {
        const spot = engine.project(at);
        if (!spot) continue;
        const kind = times < 1 ? 'dab finer' : 'dab coarser';
        pen.ring(spot, reach / spot.perPx, kind);
        pen.ring(spot, (INNER * reach) / spot.perPx, kind);
      }
      const under = engine.hover.value;
      const spot = under && engine.project(under.position);
      if (spot) pen.ring(spot, painter.reach / spot.perPx, 'brush');
      aim(pen);
    },
  };
}

/**
 * Creates the card with the brush's choices.
 * @param {Brush} brush @param {Painter} painter @param {HTMLElement} middle
 */
export function createBrushCard(brush, painter, middle) {
  const count = computed(() => painter.shown.value.length);
  const told = computed(() => {
    if (!brush.on.value) return '';
    if (painter.missed.value) return 'Nothing in the middle of the picture: turn the surface';
    if (count.value >= MOST_DABS) return `${MOST_DABS} places are the most`;
    return count.value === 0 ? 'Drag over the surface' : '';
  });
  // The number is told to those who do not see the marks.
  const text = h(
    'span',
    { class: () => (told.value ? 'told' : 'told visually-hidden'), role: 'status' },
    () => told.value || `${plural(count.value, 'place')} painted`,
  );
  const size = createSlider({
    name: 'Size of the brush',
    scale: SIZE,
    value: () => brush.share.value,
    describe: (share) => `${formatShare(share, 0)} of the diagonal of the box`,
    change: (share) => {
      brush.share.value = share;
    },
    reset: () => {
      brush.share.value = SHARE;
    },
    number: false,
  });
  const times = createSegmented({
    name: 'Spacing times',
    choices: TIMES.map(([value, label]) => ({ value, label })),
    value: () => brush.times.value,
    change: (value) => {
      brush.times.value = value;
    },
  });
  return h(
    'div',
    { class: 'tool-card brush-card', role: 'group', 'aria-label': 'Brush', hidden: () => !brush.on.value },
    text,
    h('div', { class: 'brush-choice' }, h('span', { 'aria-hidden': 'true' }, 'Spacing ×'), times),
    h(
      'div',
      { class: 'brush-choice' },
      h('span', { 'aria-hidden': 'true' }, 'Size'),
      size.range,
      middle,
      button({ class: 'small', off: () => count.value === 0, press: () => painter.clear() }, 'Clear'),
      button(
        {
          class: 'small',
          press: () => {
            brush.on.value = false;
          },
        },
        'Done',
      ),
    ),
  );
}

/** Creates the button that paints the middle of the picture, for whoever cannot drag. @param {Painter} painter */
export const createMiddle = (painter) =>
  explain(button({ class: 'small', press: () => painter.paintMiddle() }, 'Middle'), () => ({
    text: 'Paints the middle of the picture, as the key Enter does on it.',
  }));
