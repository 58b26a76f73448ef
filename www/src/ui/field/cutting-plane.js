/** The controls of the cutting plane: its direction, its position, and which side it hides. */
import { computed, signal } from '@preact/signals-core';
import { along, dot } from '../../engine/vector.js';
import { button } from '../button.js';
import { h, live } from '../dom.js';
import { explain } from '../explain.js';
import { formatSignificant } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createSlider } from '../slider.js';
import {
  AXES,
  anglesOf,
  axisOf,
  axisVector,
  centreOf,
  directionOf,
  equationOf,
  extentOf,
  towardEye,
} from '../space.js';

/** @import { Bounds, CuttingPlane, Engine, ReadonlySignal, Signal } from '../../engine/types.js' */

/**
 * The present plane, and the axis to which it is perpendicular, if any.
 * @typedef {{ plane: ReadonlySignal<CuttingPlane | null>, axis: ReadonlySignal<ReturnType<typeof axisOf>> }} Cut
 */

/** Number of steps of the position slider. */
const PLACES = 400;
const DEGREES = 180 / Math.PI;

/** @param {Engine} engine */
export function createCuttingPlane(engine) {
  const bounds = computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);
  const plane = computed(() => engine.state.value.plane);
  /** Whether the user chose a free direction, which stays free even while it is parallel to an axis. */
  const free = signal(false);
  const axis = computed(() => (plane.value && !free.value ? axisOf(plane.value.normal) : null));

  const flip = () => {
    const now = plane.peek();
    if (now) engine.setPlane({ normal: along([0, 0, 0], now.normal, -1), offset: -now.offset });
  };
  /** Cuts through the centre of the box and hides the side towards the viewer. @param {string} value */
  function choose(value) {
    const now = bounds.peek();
    free.value = value === 'free';
    if (value === 'off' || !now) return engine.setPlane(null);
    const seen = towardEye(engine.state.peek().view.camera);
    const at = ['x', 'y', 'z'].indexOf(value);
    const normal = at < 0 ? seen : axisVector(at, seen[at] < 0 ? -1 : 1);
    engine.setPlane({ normal, offset: dot(normal, centreOf(now)) });
  }

  const told = () => {
    if (!plane.value) return 'off';
    return (axis.value && equationOf(plane.value)) ?? 'free direction';
  };
  const details = h(
    'details',
    { class: 'section clip plane' },
    h('summary', { class: 'section-head' }, h('h2', null, 'Cutting plane'), h('span', { class: 'quiet now' }, told)),
    createSegmented({
      name: 'Cut across',
      choices: [
        { value: 'off', label: 'Off' },
        ...AXES.map((name) => ({ value: name, label: name })),
        { value: 'free', label: 'Free' },
      ],
      value: () => (!plane.value ? 'off' : axis.value ? AXES[axis.value.axis] : 'free'),
      change: choose,
    }),
    h(
      'div',
      { class: 'rows', hidden: () => !plane.value },
      createPosition(engine, { bounds, plane, axis }),
      createAngles(engine, { plane, axis, free }),
      h(
        'div',
        { class: 'repairs' },
        action('Flip', 'Hides the other side.', flip),
        action('Look straight at it', 'Turns the plane so that it hides what is nearer to you.', () => choose('free')),
      ),
    ),
  );
  // A plane from a link or from undo opens the section that explains it.
  live(details, () => {
    if (plane.value) details.open = true;
  });
  return details;
}

/** @param {string} label @param {string} text @param {() => void} press */
const action = (label, text, press) =>
  explain(button({ class: 'small', press }, label), () => ({ title: label, text }));

/**
 * Creates the position slider: the coordinate of a plane perpendicular to an axis, else the distance from the origin
 * along the normal.
 * @param {Engine} engine
 * @param {Cut & { bounds: ReadonlySignal<Bounds | null> }} cut
 */
function createPosition(engine, { bounds, plane, axis }) {
  const sign = () => axis.peek()?.sign ?? 1;
  const slider = createSlider({
    name: 'Position of the cutting plane',
    scale: { min: -1, max: 1, step: 0.01 },
    value: 0,
    describe: (value) => formatSignificant(value, 3),
    change(value, live) {
      const now = plane.peek();
      if (now) engine.setPlane({ ...now, offset: sign() * value }, { live });
    },
    reset() {
      const [now, box] = [plane.peek(), bounds.peek()];
      if (now && box) engine.setPlane({ ...now, offset: dot(now.normal, centreOf(box)) });
    },
    read: engine.readNumber,
  });
  live(slider.range, () => {
    const [now, box, straight] = [plane.value, bounds.value, axis.value];
    if (!now || !box) return;
    const normal = straight ? axisVector(straight.axis) : now.normal;
    const [min, max] = extentOf(box, normal);
    slider.setScale({ min, max, step: (max - min) / PLACES });
    slider.set((straight?.sign ?? 1) * now.offset);
  });
  const name = h('var', null, () => (axis.value ? AXES[axis.value.axis] : 'd'));
  return h('div', { class: 'row' }, h('span', { class: 'name' }, name), slider.range, slider.box);
}

/**
 * Creates the sliders for a free direction.
 * @param {Engine} engine
 * @param {Cut & { free: Signal<boolean> }} cut
 */
function createAngles(engine, { plane, axis, free }) {
  const angles = computed(() => anglesOf(plane.value?.normal ?? [1, 0, 0]));
  /** @param {Partial<ReturnType<typeof anglesOf>>} patch @param {boolean} [isLive] */
  const turn = (patch, isLive = false) => {
    const [now, box] = [plane.peek(), engine.state.peek().bounds ?? engine.field.peek()?.bounds];
    if (!now || !box) return;
    free.value = true;
    const { azimuth, elevation } = { ...angles.peek(), ...patch };
    const normal = directionOf(azimuth, elevation);
    // The plane turns about its point nearest to the centre of the box.
    const centre = centreOf(box);
    const lift = now.offset - dot(now.normal, centre);
    engine.setPlane({ normal, offset: dot(normal, centre) + lift }, { live: isLive });
  };
  return /** @type {const} */ ([
    ['azimuth', 'Azimuth of the cutting plane', 'az', 180],
    ['elevation', 'Elevation of the cutting plane', 'el', 90],
  ]).map(([key, name, short, most]) => {
    const slider = createSlider({
      name,
      scale: { min: -most, max: most, step: 1 },
      value: () => Number((angles.value[key] * DEGREES).toFixed(2)),
      describe: (value) => `${formatSignificant(value, 3)}°`,
      change: (value, live) => turn({ [key]: value / DEGREES }, live),
      reset: () => turn({ [key]: 0 }),
      read: engine.readNumber,
    });
    const caption = h('span', { class: 'name quiet' }, short);
    explain(caption, () => ({
      title: key === 'azimuth' ? 'Azimuth' : 'Elevation',
      text:
        key === 'azimuth'
          ? 'Direction of the hidden side in the xy plane, in degrees from x towards y.'
          : 'Direction of the hidden side above the xy plane, in degrees.',
    }));
    const hidden = () => !plane.value || axis.value !== null;
    return h('div', { class: 'row', hidden }, caption, slider.range, slider.box);
  });
}
