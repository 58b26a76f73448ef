/** The chapter on the seams where rings meet, and on ten relaxation steps. */
import { triple } from '../../engine/vector.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, formatFixed, formatSignificant } from '../../ui/format.js';
import { reasonOf } from '../figure.js';
import { energiesOf, nearestDistances } from '../measure.js';
import { createChart, createPlay, createRange, createScale } from '../parts.js';
import { byLevel, byValue, Orbit, Picture } from '../picture.js';
import { placesOf, scoreOf } from '../score.js';
import { createScorecard } from '../scorecard.js';

/** @import { Context, Lab, LabRun, Mark } from '../types.js' */

const STEP_MS = 400;
/** Colours span this range of distances, in 2r, and of energies, over the ideal one. */
const [NEAR, FAR] = [0.7, 1.15];
const [CALM, CROWDED] = [0.7, 1.6];
/** A pair nearer than this share of 2r is too close. */
const CLOSE = 0.85;
/** The share of the particles that the front has placed when the widest hole is asked for. */
const QUARTER = 0.25;

/** The widest hole that the fronts leave, and the particle beside it; null where none is measured. @param {Lab} lab */
export async function widestHole(lab) {
  const run = await lab.run({}, { keep: true });
  const { places } = await lab.measure(run.placed, false);
  const { hole, beside } = placesOf(run.placed, places);
  return hole && { hole, particle: beside, radius: run.radius, run };
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
  // The body of another run, whose particles tell nothing of where this one leaves a hole.
  const { placed: body } = await own.run({ seed: 1, relax_steps: 0 });
  const [met, { energy, valence }] = [await seamsOf(run), await own.measure(run.placed, false)];
  const widest = await widestHole(own);
  const orbit = new Orbit(own.surface.bounds);
  orbit.fitTo(run.placed);
  orbit.faceFront(run.placed);
  const picture = new Picture(orbit, {
    name: 'The particles as they were placed, before any relaxation',
    onPick: (particle) => stops.pick('predict-hole', particle),
  });
  const words = h('p', { class: 'figure-count' });
  const scale = createScale('Energy, over that of an ideal place', formatFixed(CALM, 1), formatFixed(CROWDED, 1));
  const count = run.placed.radii.length;
  const nearest = nearestDistances(run.placed);
  const close = [...nearest.keys()].filter((i) => nearest[i] < CLOSE);
  const inLattice = close.filter((i) => valence[i] === 6 && !met.has(i));
  const rings = byLevel(run.placed);
  const energies = byValue(energy, CALM, CROWDED);
  let wasOpen = false;
  const draw = () => {
    const isOpen = stops.isOpen('predict-hole');
    const picked = stops.picked('predict-hole');
    /** @type {Mark[]} */
    const marks = [];
    if (picked !== null)
      marks.push({
        place: triple(run.placed.positions, picked),
        normal: triple(run.placed.normals, picked),
        radius: run.radius,
        kind: 'cross',
      });
    const colours = isOpen ? energies : rings;
    picture.show({ particles: run.placed, body, count: isOpen ? count : Math.round(QUARTER * count), colours, marks });
    if (isOpen && !wasOpen && widest) {
      picture.ringed.value = widest.hole;
      orbit.turnTo(widest.hole.normal);
    }
    wasOpen = isOpen;
    scale.hidden = !isOpen;
    words.textContent = isOpen
      ? `${formatCount(close.length)} of ${formatCount(count)} particles are nearer than ${formatFixed(CLOSE, 2)} · 2r to another: ${formatCount(close.length - inLattice.length)} along seams, ${formatCount(inLattice.length)} in unbroken lattice, squeezed where it bends.`
      : '';
  };
  live(words, draw);
  return [picture.element, words, scale];
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
  const colours = states.map((state) => byValue(nearestDistances(state), NEAR, FAR));
  const orbit = new Orbit(own.surface.bounds);
  orbit.fitTo(run.end);
  orbit.faceFront(run.placed);
  const picture = new Picture(orbit, { name: 'The particles, coloured by the distance to the nearest one' });
  const words = h('p', { class: 'figure-count' });
  /** The step that is beside the placing in the scorecard. */
  const last = states.length - 1;
  const scorecard = createScorecard((place, side) => {
    if (place) range.set(side === 0 ? 0 : scored);
    picture.ringed.value = place;
    if (place) orbit.turnTo(place.normal);
  });
  let scored = last;
  const scoreAt = (/** @type {number} */ step) =>
    scoreOf(own, states[step], {
      evaluations: step === 0 ? run.placing : steps[step - 1].evaluations,
      isAdaptive: false,
    });
  async function score(/** @type {number} */ step) {
    scored = step;
    const scores = [await scoreAt(0), await scoreAt(step)];
    if (step === scored) scorecard.tell(['As placed', `After step ${formatCount(step)}`], scores);
  }
  const show = (/** @type {number} */ step) => {
    picture.ringed.value = null;
    picture.show({ particles: states[step], colours: colours[step] });
    const { largest_move: move } = steps[step - 1] ?? {};
    words.textContent =
      move == null
        ? 'As they were placed.'
        : `The longest move of step ${formatCount(step)}: ${formatSignificant(move, 2)} r.`;
  };
  const range = createRange({
    name: 'Step',
    max: last,
    say: (step) => (step === 0 ? 'before the first' : `${formatCount(step)} of ${formatCount(last)}`),
    change: (step) => {
      show(step);
      if (step > 0 && stops.isOpen('predict-rest')) void score(step);
    },
  });
  show(0);
  const box = h('div', { hidden: () => !stops.isOpen('predict-rest') }, scorecard.element);
  live(box, () => {
    if (stops.isOpen('predict-rest'))
      score(last).catch((error) => fill(scorecard.element, h('p', { class: 'figure-status' }, reasonOf(error))));
  });
  const play = createPlay(range, { label: 'Relax', totalMs: STEP_MS * last });
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
    words: `Energy per particle: ${energy(energies[0])} before the first step, ${energy(energies[energies.length - 1])} after the last. The scale begins at 0.`,
  });
  return [
    picture.element,
    h('div', { class: 'controls' }, play.element, range.element, words),
    createScale('Distance to the nearest, in 2r', formatFixed(NEAR, 2), formatFixed(FAR, 2)),
    box,
    chart,
  ];
}
