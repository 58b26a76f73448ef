/** The chapter on the seams where rings meet, and on ten relaxation steps. */
import { triple } from '../../engine/vector.js';
import { h, live } from '../../ui/dom.js';
import { formatCount, formatFixed, formatSignificant } from '../../ui/format.js';
import { spread } from '../../ui/neighbours.js';
import { energiesOf, nearestDistances } from '../measure.js';
import { createChart, createPlay, createRange, createScale } from '../parts.js';
import { byLevel, byMark, byValue, Orbit, Picture } from '../picture.js';

/** @import { Context, Lab, LabRun, Mark } from '../types.js' */

const STEP_MS = 400;
/** Colours span this range of distances, in 2r. */
const [NEAR, FAR] = [0.7, 1.15];

/**
 * The widest hole that the fronts leave: the particle beside it, where the filling of gaps looks.
 * @param {Lab} lab
 */
export async function widestHole(lab) {
  const run = await lab.run({ gaps: 'fill', relax_steps: 0 }, { keep: true });
  const filling = run.chapters.find(({ kind }) => kind === 'filling');
  if (!filling) return null;
  const events = await run.client.ask('events', { first: filling.first_event, count: filling.events });
  let widest = { particle: -1, width: 0 };
  for (const event of events)
    if (event.type === 'gap' && event.width !== null && event.width > widest.width)
      widest = { particle: event.particle, width: event.width };
  return widest.particle < 0 ? null : { ...widest, radius: run.radius, run };
}

/** Particles whose front met itself or another one out of step. @param {LabRun} run */
async function seamsOf({ client, chapters }) {
  /** @type {Set<number>} */
  const found = new Set();
  for (const { kind, first_event: first, events: count } of chapters) {
    if (kind !== 'level') continue;
    for (const event of await client.ask('events', { first, count }))
      if (event.type === 'fronts_meet') found.add(event.particle).add(event.parent);
  }
  return found;
}

/** @param {Context} context */
export async function seams({ lab, stops }) {
  const own = await lab;
  const run = await own.run({}, { keep: true });
  const [hole, met] = [await widestHole(own), await seamsOf(run)];
  const orbit = new Orbit(own.surface.bounds);
  orbit.fitTo(run.placed);
  const picture = new Picture(orbit, {
    name: 'The particles as they were placed, before any relaxation',
    onPick: (particle) => stops.pick('predict-hole', particle),
  });
  const show = h('input', { type: 'checkbox' });
  const box = h('label', { class: 'check' }, show, 'Mark where rings met out of step');
  const words = h('p', { class: 'figure-count' });
  const count = run.placed.radii.length;
  const rings = byLevel(run.placed);
  const marked = byMark(count, (i) => met.has(i));
  const draw = () => {
    const isOpen = stops.isOpen('predict-hole');
    const picked = stops.picked('predict-hole');
    /** @type {Mark[]} */
    const marks = [];
    const mark = (/** @type {number} */ i, /** @type {'ring' | 'cross'} */ kind) =>
      marks.push({
        place: triple(run.placed.positions, i),
        normal: triple(run.placed.normals, i),
        radius: run.radius,
        kind,
      });
    if (picked !== null) mark(picked, 'cross');
    if (isOpen && hole && hole.particle < count) mark(hole.particle, 'ring');
    picture.show({ particles: run.placed, colours: isOpen && show.checked ? marked : rings, marks });
    box.hidden = !isOpen;
    words.textContent = isOpen
      ? `${formatCount(met.size)} of ${formatCount(count)} particles lie where rings met out of step.`
      : 'Turn the picture and press a particle: that is your prediction.';
  };
  show.addEventListener('change', draw);
  live(box, draw);
  return [picture.element, h('div', { class: 'controls' }, box, words)];
}

/** @param {Context} context */
export async function rest({ lab, stops }) {
  const own = await lab;
  const run = await own.run({}, { keep: true });
  const steps = run.chapters.filter(({ kind }) => kind === 'relaxation');
  const energies = await energiesOf(run);
  const states = [run.placed];
  for (const { first_event: first, events } of steps)
    states.push(await run.client.ask('seek', { event: first + events }));
  const distances = states.map((state) => nearestDistances(state));
  const colours = distances.map((values) => byValue(values, NEAR, FAR));
  const orbit = new Orbit(own.surface.bounds);
  orbit.fitTo(run.end);
  const picture = new Picture(orbit, { name: 'The particles, coloured by the distance to the nearest one' });
  const words = h('p', { class: 'figure-count' });
  const show = (/** @type {number} */ step) => {
    picture.show({ particles: states[step], colours: colours[step] });
    const { mean, deviation } = spread(distances[step]);
    words.textContent = `Nearest neighbour at ${formatFixed(mean, 3)} · 2r on average, ± ${formatFixed(deviation, 3)}.`;
  };
  const range = createRange({
    name: 'Step',
    max: states.length - 1,
    say: (step) => (step === 0 ? 'before the first' : `${formatCount(step)} of ${formatCount(states.length - 1)}`),
    change: show,
  });
  show(0);
  const play = createPlay(range, { label: 'Relax', totalMs: STEP_MS * (states.length - 1) });
  const energy = (/** @type {number} */ value) => formatSignificant(value, 3);
  const chart = createChart({
    hidden: () => !stops.isOpen('predict-rest'),
    chart: () => ({
      kind: 'line',
      rows: [{ fate: 'energy', name: 'energy', counts: energies }],
      first: 0,
      at: range.place.value,
      format: energy,
    }),
    label: `Energy per particle: ${energies.map(energy).join(', ')}`,
    words: `Energy per particle: ${energy(energies[0])} before the first step, ${energy(energies[energies.length - 1])} after the last.`,
  });
  return [
    picture.element,
    h('div', { class: 'controls' }, play.element, range.element, words),
    createScale('Distance to the nearest, in 2r', formatFixed(NEAR, 2), formatFixed(FAR, 2)),
    chart,
  ];
}
