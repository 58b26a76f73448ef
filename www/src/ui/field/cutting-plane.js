/** The controls of the cutting plane: its direction, its position, and which side it hides. */
import { computed, effect, signal } from '@preact/signals-core';
import { along, dot } from '../../engine/vector.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { formatSignificant } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createSlider } from '../slider.js';
import { AXES, anglesOf, axisOf, axisVector, centreOf, directionOf, extentOf, towardEye } from '../space.js';

/**
 * @import { Bounds, CuttingPlane, Engine } from '../../engine/types.js'
 * @import { ReadonlySignal, Signal } from '@preact/signals-core'
 */

/** Places of the position slider on the way through the box. */
const PLACES = 400;
const DEGREES = 180 / Math.PI;

/** @param {Engine} engine */
export function createCuttingPlane(engine) {
  const bounds = computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);
  const plane = computed(() => engine.state.value.plane);
  /** Whether the direction was chosen freely, so that passing through an axis makes no difference. */
  const free = signal(false);
  const axis = computed(() => (plane.value && !free.value ? axisOf(plane.value.normal) : null));

  const direction = createSegmented({
    name: 'Cut across',
    choices: [
      { value: 'off', label: 'Off' },
      ...AXES.map((name) => ({ value: name, label: name })),
      { value: 'free', label: 'Free' },
    ],
    change: choose,
  });
  const position = createPosition(engine, { bounds, plane, axis });
  const angles = createAngles(engine, { plane, axis, free });
  const flip = button('Flip', 'Hides the other side.', () => {
    const now = plane.peek();
    if (now) engine.setPlane({ normal: along([0, 0, 0], now.normal, -1), offset: -now.offset });
  });
  const face = button('Face me', 'Turns the plane so that it hides what is nearer to you.', () => choose('free'));
  const controls = h('div', { class: 'rows' }, position, ...angles, h('div', { class: 'repairs' }, flip, face));

  /** Cuts through the middle of the box and hides the side that is turned to the viewer. @param {string} value */
  function choose(value) {
    const now = bounds.peek();
    free.value = value === 'free';
    if (value === 'off' || !now) return engine.setPlane(null);
    const seen = towardEye(engine.state.peek().view.camera);
    const at = /** @type {readonly string[]} */ (AXES).indexOf(value);
    const normal = at < 0 ? seen : axisVector(at, seen[at] < 0 ? -1 : 1);
    engine.setPlane({ normal, offset: dot(normal, centreOf(now)) });
  }

  const summary = h('span', { class: 'quiet now' });
  const details = h(
    'details',
    { class: 'section clip plane' },
    h('summary', { class: 'section-head' }, h('h2', null, 'Cutting plane'), summary),
    direction.element,
    controls,
  );
  effect(() => {
    const [now, straight] = [plane.value, axis.value];
    direction.set(!now ? 'off' : straight ? AXES[straight.axis] : 'free');
    controls.hidden = !now;
    summary.textContent = !now
      ? 'off'
      : straight
        ? `${AXES[straight.axis]} = ${formatSignificant(straight.sign * now.offset, 3)}`
        : 'free direction';
    // A plane that comes with a link or by undo is not left unexplained.
    if (now) details.open = true;
  });
  return details;
}

/** @param {string} label @param {string} text @param {() => void} act */
function button(label, text, act) {
  const element = h('button', { type: 'button', class: 'button small', on: { click: act } }, label);
  explain(element, () => ({ title: label, text }));
  return element;
}

/**
 * Creates the slider for the position: the coordinate where the plane lies across an axis, else the distance from the
 * origin along the normal.
 * @param {Engine} engine
 * @param {object} present
 * @param {ReadonlySignal<Bounds | null>} present.bounds
 * @param {ReadonlySignal<CuttingPlane | null>} present.plane
 * @param {ReadonlySignal<{axis: number, sign: number} | null>} present.axis
 */
function createPosition(engine, { bounds, plane, axis }) {
  const sign = () => axis.peek()?.sign ?? 1;
  const slider = createSlider({
    name: 'Position of the cutting plane',
    scale: { min: -1, max: 1, step: 0.01 },
    value: 0,
    describe: (value) => formatSignificant(value, 3),
    change(value) {
      const now = plane.peek();
      if (now) engine.setPlane({ ...now, offset: sign() * value });
    },
    reset() {
      const [now, box] = [plane.peek(), bounds.peek()];
      if (now && box) engine.setPlane({ ...now, offset: dot(now.normal, centreOf(box)) });
    },
  });
  const name = h('var', null, 'd');
  effect(() => {
    const [now, box, straight] = [plane.value, bounds.value, axis.value];
    if (!now || !box) return;
    const normal = straight ? axisVector(straight.axis) : now.normal;
    const [min, max] = extentOf(box, normal);
    name.textContent = straight ? AXES[straight.axis] : 'd';
    slider.setScale({ min, max, step: (max - min) / PLACES });
    slider.set((straight?.sign ?? 1) * now.offset);
  });
  return h('div', { class: 'row' }, h('span', { class: 'name' }, name), slider.range, slider.box);
}

/**
 * Creates the sliders for a free direction.
 * @param {Engine} engine
 * @param {object} present
 * @param {ReadonlySignal<CuttingPlane | null>} present.plane
 * @param {ReadonlySignal<{axis: number, sign: number} | null>} present.axis
 * @param {Signal<boolean>} present.free
 */
function createAngles(engine, { plane, axis, free }) {
  const angles = computed(() => anglesOf(plane.value?.normal ?? [1, 0, 0]));
  /** @param {Partial<ReturnType<typeof anglesOf>>} patch */
  const turn = (patch) => {
    const [now, box] = [plane.peek(), engine.state.peek().bounds ?? engine.field.peek()?.bounds];
    if (!now || !box) return;
    free.value = true;
    const { azimuth, elevation } = { ...angles.peek(), ...patch };
    const normal = directionOf(azimuth, elevation);
    // The plane turns about the place on it that is nearest to the middle of the box.
    const centre = centreOf(box);
    const lift = now.offset - dot(now.normal, centre);
    engine.setPlane({ normal, offset: dot(normal, centre) + lift });
  };
  return /** @type {const} */ ([
    ['azimuth', 'Azimuth of the cutting plane', 'az', 180],
    ['elevation', 'Elevation of the cutting plane', 'el', 90],
  ]).map(([key, name, short, most]) => {
    const slider = createSlider({
      name,
      scale: { min: -most, max: most, step: 1 },
      value: 0,
      describe: (value) => `${formatSignificant(value, 3)}°`,
      change: (value) => turn({ [key]: value / DEGREES }),
      reset: () => turn({ [key]: 0 }),
    });
    const caption = h('span', { class: 'name quiet' }, short);
    explain(caption, () => ({
      title: key === 'azimuth' ? 'Azimuth' : 'Elevation',
      text:
        key === 'azimuth'
          ? 'Direction of the hidden side in the xy plane, in degrees from x towards y.'
          : 'Direction of the hidden side above the xy plane, in degrees.',
    }));
    const row = h('div', { class: 'row' }, caption, slider.range, slider.box);
    effect(() => {
      row.hidden = !plane.value || axis.value !== null;
      slider.set(Number((angles.value[key] * DEGREES).toFixed(2)));
    });
    return row;
  });
}
