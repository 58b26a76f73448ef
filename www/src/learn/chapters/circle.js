/** One slot from the side: dragging bends the surface; one child keeps its distance, the other loses it. */
import { computed, signal } from '@preact/signals-core';
import { asideWords } from '../../figures/drawings.js';
import { label, line, ring, segments } from '../../figures/svg.js';
import { inRadii } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatFixed, formatSignificant } from '../../ui/format.js';
import { bendThrough, slotOf, slotOn } from '../bend.js';
import { createNumber, dragIn } from '../drag.js';
import { openBend } from '../measure.js';

/** @import { Signal } from '../../engine/types.js' */
/** @import { Point } from '../../figures/types.js' */
/** @import { Context, SlotCase } from '../types.js' */

/** Limits of the numbers, relative to the run's r: the circle stays in the drawing and always meets the surface. */
const [LEAST_R, MOST_R, MOST_BEND] = [0.25, 1.1, 0.9];
/** Edges of the drawing, in radii of the run, and the position of the ruler below it. */
const VIEW = { left: -1.4, right: 2.9, top: 1.2, bottom: -2.4, ruler: 1.25 };
/** A press nearer to p than this, in radii, has no effect. */
const AT_P = 0.4;

/** @param {Context} context */
export async function circle({ lab, stops }) {
  const sharpest = await slotOf(await openBend(await lab));
  const unit = sharpest.radius;
  const isOpen = () => stops.isOpen('predict-newton');
  const [bend, radius, isHere] = [signal(0), signal(unit), signal(true)];
  const slot = computed(() => (isHere.value ? sharpest : slotOn(bend.value, radius.value)));
  function reset() {
    bend.value = Math.min(MOST_BEND / unit, Math.max(0, sharpest.bend));
    radius.value = unit;
    isHere.value = true;
  }
  reset();
  /** @param {string} name @param {Signal<number>} number @param {number} min @param {number} max */
  const handle = (name, number, min, max) =>
    createNumber({
      name,
      scale: { min, max, step: 10 ** (Math.floor(Math.log10(max)) - 2) },
      value: () => number.value,
      say: (value) => formatSignificant(value, 3),
      change(value) {
        isHere.value = false;
        number.value = value;
      },
    });
  const sentence = h(
    'p',
    null,
    () =>
      isHere.value
        ? 'At its sharpest bend this surface curves by '
        : `A ${bend.value > 0 ? 'sphere' : 'plane'} curves by `,
    handle('Bend', bend, 0, MOST_BEND / unit),
    ', and r is ',
    handle('r', radius, LEAST_R * unit, MOST_R * unit),
    () => `: bend · r = ${formatFixed(slot.value.bend * slot.value.radius, 2)}.`,
  );
  const box = h('div', { class: 'drawing-box' });
  live(box, () => fill(box, drawingOf(slot.value, unit, isOpen())));
  dragIn(box, ([x, y]) => {
    if (Math.hypot(x, y) < AT_P || y < VIEW.bottom) return;
    isHere.value = false;
    bend.value = Math.min(MOST_BEND / radius.peek(), Math.max(0, bendThrough(x * unit, y * unit)));
  });
  const side = h(
    'div',
    { class: 'side' },
    sentence,
    h('p', { class: 'told', 'aria-live': 'polite' }, () => told(slot.value, isOpen())),
    h('div', { class: 'controls' }, button({ hidden: () => isHere.value, press: reset }, 'Back to the sharpest bend')),
  );
  return [h('div', { class: 'two bend' }, box, side)];
}

/** @param {SlotCase} slot @param {boolean} isOpen */
function told({ radius, landing, aside }, isOpen) {
  const own = `On the circle the child lands at ${inRadii(2 * radius, radius)}, as everywhere.`;
  if (!isOpen) return `${own} Newton’s child is shown once you have guessed.`;
  if (landing === null) return `${own} Newton’s method lands nowhere near.`;
  return `${own} Newton lands at ${inRadii(landing, radius)}${asideWords({ newtonAside: aside / radius })}.`;
}

/** @param {SlotCase} slot @param {number} unit  length of the drawing's unit @param {boolean} isOpen */
function drawingOf({ bend, radius, child, newton, landing, section }, unit, isOpen) {
  const { left, right, top, bottom, ruler } = VIEW;
  const far = (2 * radius) / unit;
  const newtonFar = isOpen && landing !== null ? landing / unit : null;
  const words = [
    `A slot from the side, where bend · r is ${formatFixed(bend * radius, 2)}. The child on the circle is at ${inRadii(2 * radius, radius)}`,
    newtonFar === null ? '' : `, that of Newton’s method at ${inRadii(newtonFar, radius / unit)}`,
  ];
  const svg = s('svg', {
    class: 'drawing profile',
    viewBox: `${left} ${-top} ${right - left} ${top - bottom + ruler}`,
    role: 'img',
    'aria-label': `${words.join('')}.`,
  });
  /** @param {Point} at @returns {Point} */
  const drawn = ([x, y]) => [x / unit, y / unit];
  const own = drawn(child);
  svg.append(
    line('plane', [
      [left, 0],
      [right, 0],
    ]),
    line('normal', [
      [0, 0],
      [0, 1],
    ]),
    label('name', [0.28, 0.9], 'N'),
    label('name', [right - 0.25, 0.22], 'V'),
    ring('circle', [0, 0], far),
    segments('curve', section, 1 / unit),
    line('distance', [[0, 0], own]),
  );
  const last = newton.at(-1);
  if (newtonFar !== null && last)
    svg.append(
      line('newton-way', [[far, 0], ...newton.map(drawn)]),
      line('way', [[0, 0], drawn(last)]),
      ring('newton-end', drawn(last), 0.12),
    );
  svg.append(ring('theta', [far, 0], 0.08), ring('landed', own, 0.12), ring('point', [0, 0], 0.1));
  svg.append(
    label('name', [-0.3, 0.26], 'p'),
    s('rect', { class: 'under', x: left, y: -bottom, width: right - left, height: ruler }),
  );
  const [first, second] = [bottom - 0.4, bottom - 0.8];
  for (const [x, name] of /** @type {[number, string][]} */ ([
    [0, '0'],
    [far / 2, 'r'],
    [far, '2r'],
  ]))
    svg.append(
      line('tick', [
        [x, bottom - 0.22],
        [x, bottom - 0.98],
      ]),
      label('ruler-name', [x, bottom - 1.12], name),
    );
  const bar = (/** @type {string} */ kind, /** @type {number} */ to, /** @type {number} */ y) =>
    svg.append(
      line(kind, [
        [0, y],
        [to, y],
      ]),
    );
  bar('ruler-own', far, first);
  svg.append(label('ruler-side', [-0.1, first], 'on the circle'));
  if (newtonFar !== null) {
    bar('ruler-newton', newtonFar, second);
    svg.append(label('ruler-side', [-0.1, second], 'by Newton'));
  }
  return svg;
}
