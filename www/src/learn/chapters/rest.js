/** The chapter on the seams where rings meet, and on ten relaxation steps. */
import { signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, formatFixed, formatSignificant } from '../../ui/format.js';
import { reasonOf } from '../figure.js';
import { nearestDistances } from '../measure.js';
import { createChart, createPlay, createRange, createScale } from '../parts.js';
import { byLevel, byValue, Orbit, Picture } from '../picture.js';
import { placesOf, scoreOf } from '../score.js';
import { createScorecard } from '../scorecard.js';

/**
 * @import { Signal } from '../../engine/types.js'
 * @import { Context, Lab, LabRun, Mark, Score } from '../types.js'
 */

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
  const orbit = new Orbit();
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
  const states = [run.placed];
  for (const { first_event: first, events } of steps.slice(0, -1))
    states.push(await run.client.ask('seek', { event: first + events }));
  states.push(run.end);
  const colours = states.map((state) => byValue(nearestDistances(state), NEAR, FAR));
  const orbit = new Orbit();
  orbit.fitTo(run.end);
  orbit.faceFront(run.placed);
  const picture = new Picture(orbit, { name: 'The particles, coloured by the distance to the nearest one' });
  const words = h('p', { class: 'figure-count' });
  const last = states.length - 1;
  const isOpen = () => stops.isOpen('predict-rest');
  /** Those of the states so far, in their order. @type {Signal<Score[]>} */
  const scores = signal([]);
  /** The step that is beside the placing in the scorecard. */
  const scored = () => range.place.value || last;
  const scorecard = createScorecard((place, side) => {
    if (place) range.set(side === 0 ? 0 : scored());
    picture.ringed.value = place;
    if (place) orbit.turnTo(place.normal);
  });
  async function score() {
    for (const [step, state] of states.entries()) {
      const evaluations = step === 0 ? run.placing : steps[step - 1].evaluations;
      const found = await scoreOf(own, state, { evaluations, isAdaptive: false });
      scores.value = [...scores.peek(), found];
      if (step === 0 && found.places.hole) orbit.turnTo(found.places.hole.normal);
    }
  }
  const show = (/** @type {number} */ step) => {
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
    change: show,
  });
  show(0);
  const box = h('div', { hidden: () => !isOpen() }, scorecard.element);
  live(box, () => {
    if (isOpen() && scores.peek().length === 0)
      score().catch((error) => fill(scorecard.element, h('p', { class: 'figure-status' }, reasonOf(error))));
  });
  // The largest hole of the step that is shown is ringed.
  live(picture.element, () => {
    picture.ringed.value = scores.value[range.place.value]?.places.hole ?? null;
  });
  live(box, () => {
    const [before, after] = [scores.value[0], scores.value[scored()]];
    if (before && after) scorecard.tell(['As placed', `After step ${formatCount(scored())}`], [before, after]);
  });
  const play = createPlay(range, { label: 'Relax', totalMs: STEP_MS * last });
  const row = (/** @type {'hole' | 'six'} */ key) => states.map((_, step) => scores.value[step]?.[key] ?? 0);
  const ratio = (/** @type {number} */ value) => formatFixed(value, 2);
  const told = () =>
    `By step, 1 is best: the largest hole over that of the ideal pattern ${row('hole').map(ratio).join(', ')}; the share with six neighbours ${row('six').map(ratio).join(', ')}.`;
  const chart = createChart({
    hidden: () => scores.value.length < states.length,
    chart: () => ({
      kind: 'line',
      rows: [
        { fate: 'own', name: 'largest hole, over the ideal', counts: row('hole') },
        { fate: 'other', name: 'share with six neighbours', counts: row('six') },
      ],
      ends: ['placed', `step ${formatCount(last)}`],
      first: 0,
      at: range.place.value,
      format: ratio,
    }),
    label: told,
    words: 'Both are 1 in the ideal pattern.',
    press: range.set,
  });
  return [
    picture.element,
    h('div', { class: 'controls' }, play.element, range.element, words),
    createScale('Distance to the nearest, in 2r', formatFixed(NEAR, 2), formatFixed(FAR, 2)),
    chart,
    box,
  ];
}
