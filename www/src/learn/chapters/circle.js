/** The laboratory of the circle: a child is turned by hand until f = 0, beside Newton's method. */
import { computed, signal } from '@preact/signals-core';
import { ASIDE, asideWords, profileOf } from '../../figures/drawings.js';
import { fateShape, label, line, ring } from '../../figures/svg.js';
import { inDegrees, inRadii } from '../../figures/words.js';
import { button } from '../../ui/button.js';
import { fill, h, live, s } from '../../ui/dom.js';
import { formatCount, formatFixed, formatShare, formatSignificant } from '../../ui/format.js';
import { bracketOf, isOn, landingsOf, MOST_THETA, newtonShare, onCircle, slotOf, slotOn, turned } from '../bend.js';
import { createNumber, dragIn } from '../drag.js';
import { openBend, openSlot } from '../measure.js';
import { createRange, facts } from '../parts.js';

/** @import { Signal } from '../../engine/types.js' */
/** @import { Child, Opened, Point } from '../../figures/types.js' */
/** @import { Context, Lab, Landing, LabRun, SlotCase } from '../types.js' */

/** @typedef {{ slot: SlotCase, opened: Opened }} Shown */
/** @typedef {Landing & { run: LabRun }} Landed */

/** Places of the range of θ: half a degree each. */
const PLACES = 400;
const PLACE_RAD = (2 * MOST_THETA) / PLACES;
/** Limits of the numbers, with r that of the run: the circle stays in the drawing, and always meets the surface. */
const [LEAST_R, MOST_R, MOST_BEND] = [0.25, 1.1, 0.9];
/** Particles of the runs with Newton's method whose landings are shown. */
const RUNS = [180, 720];
/** From here on the place of the child is named. */
const NAMED_RAD = 0.2;
/** Angle between the child and its name. */
const BESIDE_RAD = 0.16;
/** Parts of the arc on which f changes its sign. */
const ARC = 24;
/** Size of the charts, in rem, and the place of their axes. */
const CHART = { width: 22.5, left: 2.4, right: 21.6, top: 0.7 };

/** @param {Context} context */
export async function circle({ lab, stops }) {
  const own = await lab;
  const first = await openBend(own);
  const sharpest = { slot: await slotOf(first), opened: first.opened };
  const { radius: unit } = sharpest.slot;
  const isOpen = () => stops.isOpen('predict-newton');
  /** A slot of this surface. @type {Signal<Shown>} */
  const here = signal(sharpest);
  const [bend, radius, isHere, place] = [signal(0), signal(unit), signal(true), signal(PLACES / 2)];
  const slot = computed(() => (isHere.value ? here.value.slot : slotOn(bend.value, radius.value)));
  /** The angles that were tried at this slot. @type {Signal<readonly number[]>} */
  const tried = signal([]);
  const bracket = computed(() => bracketOf(slot.value, tried.value));
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
      tried.value = [...tried.peek(), theta()];
    },
  });
  /** Shows a slot of this surface. @param {Shown} shown */
  function show(shown) {
    here.value = shown;
    bend.value = Math.min(MOST_BEND / unit, Math.max(0, shown.slot.bend));
    radius.value = shown.slot.radius;
    isHere.value = true;
  }
  show(sharpest);

  const handle = handleOf(() => {
    isHere.value = false;
  });
  const sentence = h(
    'p',
    null,
    () =>
      isHere.value
        ? `${here.value === sharpest ? 'At its sharpest bend' : 'Here'} this surface curves by `
        : `A ${bend.value > 0 ? 'sphere' : 'plane'} curves by `,
    handle('Bend', bend, 0, MOST_BEND / unit),
    ', and r is ',
    handle('r', radius, LEAST_R * unit, MOST_R * unit),
    () => `: bend · r = ${formatFixed(slot.value.bend * slot.value.radius, 2)}.`,
  );

  const box = h('div', { class: 'drawing-box' });
  live(box, () =>
    fill(box, drawingOf(here.value.opened, slot.value, { theta: theta(), bracket: bracket.value, isOpen: isOpen() })),
  );
  dragIn(box, ([x, y]) => take(Math.atan2(y, x)));
  const values = h('div', { class: 'lab-chart' });
  live(values, () => fill(values, valuesOf(slot.value, theta(), bracket.value)));
  // At another slot the search begins anew.
  live(values, () => {
    void slot.value;
    tried.value = [(place.peek() - PLACES / 2) * PLACE_RAD];
  });
  dragIn(values, ([x]) => take(MOST_THETA * (2 * shareOf(x) - 1)));
  const newton = landingsPart(own, { isOpen, slot, show, first: first.run });

  const side = h(
    'div',
    { class: 'side' },
    sentence,
    h('p', { class: 'told', 'aria-live': 'polite' }, () => told(slot.value, theta(), bracket.value)),
    values,
    h(
      'div',
      { class: 'controls' },
      range.element,
      button(
        {
          'data-step': 'circle',
          off: () => isOn(slot.value, theta()),
          press: () => take(turned(slot.value, theta(), bracket.peek())),
        },
        'One step of the search',
      ),
      button(
        {
          hidden: () => isHere.value && here.value === sharpest,
          press: () => show(sharpest),
        },
        'Back to the sharpest bend',
      ),
    ),
    h('div', { hidden: () => !isOpen() }, () => facts(factsOf(slot.value))),
    newton,
  );
  return [h('div', { class: 'two lab' }, box, side)];
}

/**
 * Makes numbers of the sentence that can be dragged.
 * @param {() => void} leave  says that the slot is none of this surface any more
 */
const handleOf =
  (leave) =>
  /** @param {string} name @param {Signal<number>} number @param {number} min @param {number} max */
  (name, number, min, max) =>
    createNumber({
      name,
      scale: { min, max, step: 10 ** (Math.floor(Math.log10(max)) - 2) },
      value: () => number.value,
      say: (value) => formatSignificant(value, 3),
      change(value) {
        leave();
        number.value = value;
      },
    });

/**
 * The chart of the landings of Newton's method. A dot that is pressed shows its landing.
 * @param {Lab} lab
 * @param {{ isOpen: () => boolean, slot: { value: SlotCase }, show: (shown: Shown) => void, first: LabRun }} about
 */
function landingsPart(lab, { isOpen, slot, show, first }) {
  /** In the order of their bends. @type {Signal<readonly Landed[]>} */
  const landings = signal([]);
  const errors = h('div', { class: 'lab-chart', hidden: () => !isOpen() });
  live(errors, () => fill(errors, errorsOf(landings.value, slot.value)));
  const dots = h('div', { class: 'controls', hidden: () => !isOpen() });
  let isAsked = false;
  live(errors, () => {
    if (!isOpen() || isAsked) return;
    isAsked = true;
    void newtonRuns(lab, first).then((all) => {
      landings.value = all;
      fill(dots, dotRange(all, open).element);
    });
  });
  /** The dot that is asked for; −1 for none. */
  let wanted = -1;
  let isBusy = false;
  /** Shows where the child of a dot has landed, the newest that is asked for. @param {number} at */
  async function open(at) {
    wanted = at;
    if (isBusy) return;
    isBusy = true;
    try {
      while (wanted >= 0) {
        const { run, parent, slot: number } = landings.peek()[wanted];
        wanted = -1;
        const opened = await openSlot(run, parent, number);
        show({ slot: await slotOf(opened), opened: opened.opened });
      }
    } finally {
      isBusy = false;
    }
  }
  dragIn(errors, (at) => {
    const input = dots.querySelector('input');
    if (!input) return;
    input.valueAsNumber = nearestDot(landings.peek(), at);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  });
  const words = h(
    'p',
    { class: 'figure-count', hidden: () => !isOpen(), 'aria-busy': () => String(landings.value.length === 0) },
    () => landingWords(landings.value),
  );
  return [errors, dots, words];
}

/** @param {SlotCase} slot @param {number} theta @param {[number, number] | null} bracket */
function told(slot, theta, bracket) {
  if (isOn(slot, theta))
    return 'f = 0: the child lies on the surface, and at 2r from its parent, as all of the circle.';
  const value = slot.valueAt(theta);
  if (!Number.isFinite(value)) return 'f is undefined here.';
  const side = value > 0 ? 'f is positive: the child is outside.' : 'f is negative: the child is inside.';
  if (!bracket) return `${side} Turn it ${value > 0 ? 'down' : 'up'}.`;
  return `${side} f changes its sign between ${inDegrees(bracket[0], 1)} and ${inDegrees(bracket[1], 1)}.`;
}

/** @param {SlotCase} slot @returns {[string, string][]} */
function factsOf({ landing, radius, aside }) {
  const newton =
    landing === null ? 'no landing' : inRadii(landing, radius) + asideWords({ newtonAside: aside / radius });
  return [['Newton lands at', newton]];
}

/**
 * The slot from the side, with the child where the hand has turned it.
 * @param {Opened} opened @param {SlotCase} slot
 * @param {{ theta: number, bracket: [number, number] | null, isOpen: boolean }} state
 */
function drawingOf({ subject, normals, radii, positions }, slot, { theta, bracket, isOpen }) {
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
  if (bracket) {
    const [from, to] = bracket;
    const arc = Array.from({ length: ARC + 1 }, (_, k) => onCircle(reach / unit, from + ((to - from) * k) / ARC));
    svg.append(line('bracket', arc));
  }
  svg.append(
    line('distance', [
      [0, 0],
      [x, y],
    ]),
    ring(isLanded ? 'hand landed' : 'hand', [x, y], 0.13),
  );
  // At the start the place is called θ₀ already. The name stands on the circle, where the drawing has room.
  if (Math.abs(theta) > NAMED_RAD)
    svg.append(label('name', onCircle(reach / unit, theta + Math.sign(theta) * BESIDE_RAD), 'θ'));
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

/** Charts f along the circle. @param {SlotCase} slot @param {number} theta @param {[number, number] | null} bracket */
function valuesOf(slot, theta, bracket) {
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
  if (bracket) svg.append(line('bracket', [at(xOf(bracket[0]), upTo(0)), at(xOf(bracket[1]), upTo(0))]));
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
/** The bottom of that chart. */
const ERRORS_REM = 6.8;

/** Where the chart of Newton's method has a landing. @param {Pick<Landing, 'bend' | 'share'>} landing */
const dotAt = ({ bend, share }) => [Math.min(1, Math.abs(bend)), Math.min(1, (2 * share) / MOST_FAR)];

/** Charts where Newton's method lands against bend · r. @param {readonly Landing[]} landings @param {SlotCase} slot */
function errorsOf(landings, slot) {
  const words = `Distance at which Newton’s method lands, from 2r without a bend down to ${inRadii(2 * newtonShare(1), 1, 2)} at bend · r = 1; ${landingWords(landings)}`;
  const { svg, at, across, below, beside } = chartOf(ERRORS_REM, words);
  const place = (/** @type {number} */ bend, /** @type {number} */ share) => {
    const [x, y] = dotAt({ bend, share });
    return at(x, y);
  };
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

/** The landing whose dot is nearest to a place of the chart. @param {readonly Landing[]} landings @param {Point} at */
function nearestDot(landings, [x, y]) {
  const { left, right, top } = CHART;
  const far = landings.map((landing) => {
    const [across, up] = dotAt(landing);
    return Math.hypot(left + across * (right - left) - x, up * (ERRORS_REM - top) - ERRORS_REM - y);
  });
  return far.indexOf(Math.min(...far));
}

/** Goes through the dots in their order. @param {readonly Landed[]} all @param {(at: number) => void} open */
const dotRange = (all, open) =>
  createRange({
    name: 'Dot',
    max: all.length - 1,
    say: (at) => `${formatCount(at + 1)} of ${formatCount(all.length)}`,
    change: open,
  });

/** What the dots are. @param {readonly Landing[]} landings */
function landingWords(landings) {
  if (landings.length === 0) return 'The runs with Newton’s method are on their way.';
  const left = landings.filter(({ aside }) => aside > ASIDE).length;
  const most = landings.reduce((far, { aside }) => Math.max(far, aside), 0);
  const aside =
    left === 0
      ? 'None left the plane of its slot.'
      : `Crosses: the ${formatShare(left / landings.length)} that left the plane of their slot, by up to ${formatFixed(most, 2)}\u00a0r.`;
  return `Dots: ${formatCount(landings.length)} particles that Newton’s method has placed in two runs. ${aside}`;
}

/** The landings of Newton's method in runs on the surface, by their bends. @param {Lab} lab @param {LabRun} coarse */
async function newtonRuns(lab, coarse) {
  /** @type {Landed[]} */
  const all = [];
  for (const particles of RUNS) {
    const change = /** @type {const} */ ({ projection: 'newton', relax_steps: 0, seed: coarse.settings.seed });
    const run = await lab.run(change, { particles, keep: true });
    const last = run.chapters.at(-1);
    const count = last ? last.first_event + last.events : 0;
    const events = await run.client.ask('events', { first: 0, count });
    for (const landing of landingsOf(events, run.placed.positions, run.radius)) all.push({ ...landing, run });
  }
  return all.sort((one, other) => one.bend - other.bend);
}
