/** How children of another size find room around a particle: the angles φ and τ, with a handle for each radius. */
import { computed, signal } from '@preact/signals-core';
import { adaptivePlane } from '../../figures/adaptive.js';
import { polar } from '../../figures/geometry.js';
import { ring } from '../../figures/svg.js';
import { ADAPTIVE, inDegrees } from '../../figures/words.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, formatFixed } from '../../ui/format.js';
import { loadSheet } from '../../ui/sheet.js';
import { createNumber, dragIn } from '../drag.js';
import { createSteps, facts } from '../parts.js';
import sheet from '../plane.css?url';
import { roomEvents, takenAngle } from '../room.js';

/** @import { Moment } from '../../figures/types.js' */

/** Limits of the two radii, in any unit, since only their ratio matters. */
const SCALE = { min: 0.5, max: 1.25, step: 0.01 };
/** Half size of the drawing, in the same unit: both radii at their largest, plus a margin. */
const HALF = 4;
/** Direction of the particle's handle, on the side that is filled last. */
const HANDLE_RAD = -1.1;
/** Size of a handle. */
const HANDLE = 0.16;
/** The figure starts with some children already placed. */
const OPENS_AT = 16;

export async function angles() {
  await loadSheet(sheet);
  const [own, other] = [signal(1), signal(0.7)];
  const events = computed(() => roomEvents(own.value, other.value));
  const box = h('div', { class: 'drawing-box' });
  const host = h('div', { class: 'side' });
  /** @param {string} name @param {typeof own} radius */
  const handle = (name, radius) =>
    createNumber({
      name,
      scale: SCALE,
      value: () => radius.value,
      say: (value) => formatFixed(value, 2),
      change(value) {
        radius.value = value;
      },
    });
  const { moment, elements } = createSteps({
    name: 'Step',
    events: () => events.value,
    first: OPENS_AT,
    subject: () => ({ particle: 0, level: 0, parent: null, radius: own.value }),
    lines: ADAPTIVE,
  });
  live(box, () => fill(box, drawingOf(own.value, other.value, moment.value)));
  let held = own;
  dragIn(box, ([x, y], isFirst) => {
    // In the drawing the particle has radius 1.
    const [far, right] = [own.value * Math.hypot(x, y), own.value * x];
    if (isFirst) held = far < 1.25 * own.value ? own : other;
    const value = held === own ? far : (right - own.value) / 2;
    held.value = Math.max(SCALE.min, Math.min(SCALE.max, Math.round(100 * value) / 100));
  });
  fill(
    host,
    h(
      'p',
      null,
      'A particle of radius ',
      handle('Radius of the particle', own),
      ' among others of radius ',
      handle('Radius of the others', other),
      () => `: together the two give each the angle φ = ${inDegrees(takenAngle(own.value, other.value), 1)}.`,
    ),
    elements,
    h('div', null, () => {
      const placed = events.value.filter((event) => event.type === 'fate' && event.fate === 'added').length;
      return facts([
        ['360° / φ', formatFixed((2 * Math.PI) / takenAngle(own.value, other.value), 2)],
        ['Placed, where half of φ is enough', formatCount(placed + 1)],
      ]);
    }),
  );
  return [h('div', { class: 'two room' }, box, host)];
}

/** @param {number} own @param {number} other @param {Moment} moment */
function drawingOf(own, other, moment) {
  const positions = Float32Array.of(0, 0, 0, own + other, 0, 0);
  const svg = adaptivePlane(
    {
      subject: { particle: 0, level: 0, parent: null, radius: own },
      place: [0, 0, 0],
      normal: [0, 0, 1],
      positions,
      normals: Float32Array.of(0, 0, 1, 0, 0, 1),
      radii: Float32Array.of(own, other),
      events: [],
      profiles: [],
    },
    moment,
  );
  // Both radii are drawn to the same scale; the drawing's own unit is the radius of the particle.
  const half = HALF / own;
  svg.setAttribute('viewBox', `${-half} ${-half} ${2 * half} ${2 * half}`);
  svg.style.setProperty('--unit', String(1 / own));
  const size = HANDLE / own;
  svg.append(ring('hand', polar(HANDLE_RAD, 1), size), ring('hand', [1 + (2 * other) / own, 0], size));
  return svg;
}
