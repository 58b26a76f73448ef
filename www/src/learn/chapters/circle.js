/** The laboratory of the circle: a child is turned by hand until f = 0, beside Newton's method. */
import { computed, signal } from '@preact/signals-core';
import { ASIDE, asideWords, profileOf } from '../../figures/drawings.js';
import { fateShape, label, line, ring } from '../../figures/svg.js';
import { inDegrees, inRadii } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatCount, formatFixed, formatShare, formatSignificant, MISSING } from '../../ui/format.js';
import { isOn, landingsOf, MOST_THETA, newtonShare, onCircle, slotOf, slotOn, turned } from '../bend.js';
import { createNumber, dragIn } from '../drag.js';
import { openBend } from '../measure.js';
import { createRange, facts } from '../parts.js';

/** @import { Child, Opened, Point } from '../../figures/types.js' */
/** @import { Context, Lab, Landing, LabRun, SlotCase } from '../types.js' */

/** Places of the range of θ: half a degree each. */
const PLACES = 400;
const PLACE_RAD = (2 * MOST_THETA) / PLACES;
/** Limits of the numbers, with r that of the run: the circle stays in the drawing, and always meets the surface. */
const [LEAST_R, MOST_R, MOST_BEND] = [0.25, 1.1, 0.9];
/** Particles of the runs with Newton's method whose landings are shown. */
const RUNS = [180, 720];
/** From here on the place of the child is named. */
const NAMED_RAD = 0.2;
/** Size of the charts, in rem, and the place of their axes. */
const CHART = { width: 22.5, left: 2.4, right: 21.6, top: 0.7 };

/** @param {Context} context */
export async function circle({ lab, stops }) {
  const own = await lab;
  const opened = await openBend(own);
  const here = await slotOf(opened);
  const { radius: unit } = here;
  const isOpen = () => stops.isOpen('predict-newton');
  const [bend, radius, isHere, place] = [
    signal(Math.min(MOST_BEND / unit, Math.max(0, here.bend))),
    signal(unit),
    signal(true),
    signal(PLACES / 2),
  ];
  const slot = computed(() => (isHere.value ? here : slotOn(bend.value, radius.value)));
  const theta = () => (place.value - PLACES / 2) * PLACE_RAD;
  const take = (/** @type {number} */ angle) =>
    range.set(Math.max(0, Math.min(PLACES, angle / PLACE_RAD + PLACES / 2)));
  const range = createRange({
    name: 'θ',
    max: PLACES,
    value: PLACES / 2,
    say: (at) => inDegrees((at - PLACES / 2) * PLACE_RAD, 1),
    change(at) {
      place.value = at;
    },
  });

  /** @param {string} name @param {typeof bend} number @param {number} min @param {number} max */
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
  live(box, () => fill(box, drawingOf(opened.opened, slot.value, theta(), isOpen())));
  dragIn(box, ([x, y]) => take(Math.atan2(y, x)));
  const values = h('div', { class: 'lab-chart' });
  live(values, () => fill(values, valuesOf(slot.value, theta())));
  dragIn(values, ([x]) => take(MOST_THETA * (2 * shareOf(x) - 1)));
  const landings = signal(/** @type {Landing[]} */ ([]));
  const errors = h('div', { class: 'lab-chart', hidden: () => !isOpen() });
  live(errors, () => fill(errors, errorsOf(landings.value, slot.value)));
  let isAsked = false;
  live(errors, () => {
    if (!isOpen() || isAsked) return;
    isAsked = true;
    void newtonRuns(own, opened.run).then((all) => {
      landings.value = all;
    });
  });

  const side = h(
    'div',
    { class: 'side' },
    sentence,
    h('p', { class: 'told', 'aria-live': 'polite' }, () => told(slot.value, theta())),
    values,
    h(
      'div',
      { class: 'controls' },
      range.element,
      button({ press: () => take(turned(slot.value, theta())) }, 'One step of the search'),
      button({ hidden: () => isHere.value, press: () => back() }, 'Back to this surface'),
    ),
    h('div', null, () => facts(factsOf(slot.value, isOpen()))),
    errors,
    h('p', { class: 'figure-count', hidden: () => !isOpen() }, () => landingWords(landings.value)),
  );
  function back() {
    bend.value = Math.max(0, here.bend);
    radius.value = unit;
    isHere.value = true;
  }
  return [h('div', { class: 'two lab' }, box, side)];
}

/** @param {SlotCase} slot @param {number} theta */
function told(slot, theta) {
  if (isOn(slot, theta))
    return 'f = 0: the child lies on the surface, and at 2r from its parent, as all of the circle.';
  const value = slot.valueAt(theta);
  if (!Number.isFinite(value)) return 'f is undefined here.';
  return value > 0
    ? 'f is positive: the child is outside. Turn it down.'
    : 'f is negative: the child is inside. Turn it up.';
}

/** @param {SlotCase} slot @param {boolean} isOpen @returns {[string, string][]} */
function factsOf({ landing, radius, aside }, isOpen) {
  const newton =
    landing === null ? 'no landing' : inRadii(landing, radius) + asideWords({ newtonAside: aside / radius });
  return [['Newton lands at', isOpen ? newton : MISSING]];
}

/**
 * The slot from the side, with the child where the hand has turned it.
 * @param {Opened} opened @param {SlotCase} slot @param {number} theta @param {boolean} isOpen
 */
function drawingOf({ subject, normals, radii, positions }, slot, theta, isOpen) {
  const { radius, newton, section, landing, aside } = slot;
  const unit = subject.radius;
  const reach = 2 * radius;
  /** A place of space for one of the plane. @param {Point} at @returns {[number, number, number]} */
  const inSpace = ([x, y]) => [x, y, 0];
  const hand = onCircle(reach, theta);
  const isLanded = isOn(slot, theta);
  /** @type {Child} */
  const child = {
    slot: 0,
    start: { type: 'slot', parent: 0, slot: 0, direction: [1, 0, 0], theta_rad: 0, place: [reach, 0, 0] },
    iterates: [],
    landed: isLanded
      ? { type: 'landed', parent: 0, slot: 0, position: inSpace(hand), normal: [0, 1, 0], distance: reach }
      : null,
    compared: null,
    pushes: [],
    room: null,
    fate: isOpen ? 'added' : 'open',
    particle: null,
  };
  const svg = profileOf(
    { subject, normals, radii, positions, place: [0, 0, 0], normal: [0, 1, 0], events: [], profiles: [] },
    {
      normal: [0, 1, 0],
      direction: [1, 0, 0],
      reach,
      section,
      newton: isOpen ? newton.map((at) => ({ position: inSpace(at), value: 0, slope: 1 })) : [],
      newtonDistance: isOpen ? landing : null,
      newtonAside: aside / radius,
      lens: null,
    },
    child,
  );
  const [x, y] = [hand[0] / unit, hand[1] / unit];
  svg.append(
    line('distance', [
      [0, 0],
      [x, y],
    ]),
    ring(isLanded ? 'hand landed' : 'hand', [x, y], 0.13),
  );
  // At the start the place is called θ₀ already.
  if (Math.abs(theta) > NAMED_RAD) svg.append(label('name', [1.2 * x, 1.2 * y], 'θ'));
  return svg;
}

/** The share of the width at which a place of a chart lies. @param {number} x */
const shareOf = (x) => (x - CHART.left) / (CHART.right - CHART.left);

/**
 * A chart from its top to a bottom, in rem. `x` and `y` are shares of its width and of its height; `y` upwards.
 * @param {number} bottom @param {string} words
 */
function chartOf(bottom, words) {
  const { width, left, right, top } = CHART;
  const svg = s('svg', { class: 'drawing', viewBox: `0 0 ${width} ${bottom + 1.5}`, role: 'img', 'aria-label': words });
  /** @param {number} x @param {number} y @returns {Point} */
  const at = (x, y) => [left + x * (right - left), -(bottom - y * (bottom - top))];
  const across = (/** @type {string} */ kind, /** @type {number} */ y) => line(kind, [at(0, y), at(1, y)]);
  /** @param {number} x @param {string} name */
  const below = (x, name) => label('tick', [at(x, 0)[0], -bottom - 0.9], name);
  /** @param {number} y @param {string} name */
  const beside = (y, name) => label('tick side-tick', [left - 0.4, at(0, y)[1]], name);
  return { svg, at, across, below, beside };
}

/** Parts of the curve of f. */
const PARTS = 100;

/** Charts f along the circle. @param {SlotCase} slot @param {number} theta */
function valuesOf(slot, theta) {
  const angles = Array.from({ length: PARTS + 1 }, (_, k) => MOST_THETA * ((2 * k) / PARTS - 1));
  const values = angles.map(slot.valueAt);
  const finite = values.filter(Number.isFinite);
  const [low, high] = [Math.min(0, ...finite), Math.max(0, ...finite)];
  const now = slot.valueAt(theta);
  const words = `f on the circle for θ from −100° to 100°; at ${inDegrees(theta, 1)} it is ${formatSignificant(now, 2)}`;
  const { svg, at, across, below, beside } = chartOf(5.2, words);
  const upTo = (/** @type {number} */ value) => (value - low) / (high - low || 1);
  const xOf = (/** @type {number} */ angle) => (angle / MOST_THETA + 1) / 2;
  svg.append(across('axis', upTo(0)), beside(upTo(0), '0'), beside(1, 'f'));
  /** @type {Point[]} */
  let piece = [];
  for (const [k, value] of values.entries()) {
    if (Number.isFinite(value)) piece.push(at(xOf(angles[k]), upTo(value)));
    if (Number.isFinite(value) && k < PARTS) continue;
    svg.append(line('curve', piece));
    piece = [];
  }
  for (const [angle, name] of /** @type {const} */ ([
    [-MOST_THETA, '−100°'],
    [0, 'θ = 0'],
    [MOST_THETA, '100°'],
  ]))
    svg.append(below(xOf(angle) + (angle < 0 ? 0.03 : angle > 0 ? -0.04 : 0), name));
  if (Number.isFinite(now)) {
    const here = at(xOf(theta), upTo(now));
    svg.append(line('drop', [at(xOf(theta), upTo(0)), here]));
    svg.append(ring(isOn(slot, theta) ? 'hand landed' : 'hand', here, 0.38));
  }
  return svg;
}

/** The largest distance in r that the chart of Newton's method shows. */
const MOST_FAR = 2.15;

/** Charts where Newton's method lands against bend · r. @param {readonly Landing[]} landings @param {SlotCase} slot */
function errorsOf(landings, slot) {
  const words = `Distance at which Newton’s method lands, from 2r without a bend down to ${inRadii(2 * newtonShare(1), 1, 2)} at bend · r = 1; ${landingWords(landings)}`;
  const { svg, at, across, below, beside } = chartOf(6.8, words);
  const place = (/** @type {number} */ bend, /** @type {number} */ share) =>
    at(Math.min(1, Math.abs(bend)), Math.min(1, (2 * share) / MOST_FAR));
  for (const far of [0, 1, 2]) {
    const y = far / MOST_FAR;
    svg.append(across(far === 1 ? 'rule' : 'axis', y), beside(y, far === 0 ? '0' : `${far}r`));
  }
  for (const { bend, share, aside } of landings)
    svg.append(
      aside > ASIDE ? fateShape('not_converged', place(bend, share), 0.2) : ring('dot', place(bend, share), 0.13),
    );
  const bends = Array.from({ length: PARTS + 1 }, (_, k) => k / PARTS);
  svg.append(
    line(
      'newton-law',
      bends.map((bend) => place(bend, newtonShare(bend))),
    ),
  );
  svg.append(label('tick', at(0.84, 0.7), 'a sphere'), label('tick', at(0.84, 1.03), 'the circle'));
  svg.append(below(0.01, '0'), below(0.5, '0.5'), below(0.88, 'bend · r = 1'));
  const { landing, radius, bend } = slot;
  if (landing !== null) svg.append(ring('hand', place(bend * radius, landing / (2 * radius)), 0.38));
  return svg;
}

/** What the dots are. @param {readonly Landing[]} landings */
function landingWords(landings) {
  if (landings.length === 0) return 'The runs with Newton’s method are on their way.';
  const left = landings.filter(({ aside }) => aside > ASIDE).length;
  const most = landings.reduce((far, { aside }) => Math.max(far, aside), 0);
  const aside =
    left === 0
      ? 'None left the plane of its slot.'
      : `Crosses: the ${formatShare(left / landings.length)} that left the plane of their slot, by up to ${formatFixed(most, 2)}\u00a0r.`;
  return `Dots: ${formatCount(landings.length)} particles of this surface, placed by Newton’s method in two runs. ${aside}`;
}

/** The landings of Newton's method in runs on the surface. @param {Lab} lab @param {LabRun} coarse */
async function newtonRuns(lab, coarse) {
  const all = [];
  for (const particles of RUNS) {
    const change = /** @type {const} */ ({ projection: 'newton', relax_steps: 0, seed: coarse.settings.seed });
    const { client, chapters, radius, placed } = await lab.run(change, { particles, keep: true });
    const last = chapters.at(-1);
    const count = last ? last.first_event + last.events : 0;
    all.push(...landingsOf(await client.ask('events', { first: 0, count }), placed.positions, radius));
    client.close();
  }
  return all;
}
