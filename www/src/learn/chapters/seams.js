/** The front, its seams, and the relaxation after it, as one sequence with a slider. */
import { signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { byId, fill, h, live } from '../../ui/dom.js';
import { formatCount, formatSignificant, plural } from '../../ui/format.js';
import { offerNumber } from '../drag.js';
import { createMarkKey } from '../marks.js';
import { isClosed, meetingsOf } from '../measure.js';
import { createPlay, createRangeRow } from '../parts.js';
import { byNeighbours, byValue, Orbit, Picture, rangeOf } from '../picture.js';
import { scoreOf, written } from '../score.js';
import { termShown } from '../terms.js';

/**
 * @import { LessonParticles, Signal } from '../../engine/types.js'
 * @import { Context, Lab, Mark, Score } from '../types.js'
 */

/** Time between two positions of the slider. */
const STEP_MS = 400;
/** The share of particles placed when the question about seams is asked. */
const QUARTER = 0.25;
/** Arrows are this many times as long as the moves; moves shorter than this, in r, get none. */
const [LONGER, SHORTEST] = [6, 0.03];
/** Size of a cross relative to other marks, which are wider than a disc. */
const CROSS = 0.5;

/**
 * Arrows from particles to their next positions.
 * @param {LessonParticles} now @param {LessonParticles} next
 */
function arrowsOf(now, next) {
  /** @type {Mark[]} */
  const arrows = [];
  for (let i = 0; i < now.radii.length; i += 1) {
    const [place, to] = [triple(now.positions, i), triple(next.positions, i)];
    const way = to.map((value, k) => value - place[k]);
    if (Math.hypot(...way) < SHORTEST * now.radii[i]) continue;
    const end = place.map((value, k) => value + LONGER * way[k]);
    arrows.push({ place, to: end, normal: triple(now.normals, i), radius: now.radii[i], kind: 'arrow' });
  }
  return arrows;
}

/**
 * The states that the slider shows: the rings of the front, then each step of the relaxation.
 * @param {Lab} own
 */
async function courseOf(own) {
  const run = await own.run({}, { keep: true });
  const { placed } = run;
  const met = await meetingsOf(run);
  /** The numbers of particles up to each ring; the particles of a level place the next ring. */
  const ends = [1, ...run.chapters.filter(({ kind }) => kind === 'level').map(({ after }) => after)];
  const steps = run.chapters.filter(({ kind }) => kind === 'relaxation');
  const states = [placed];
  for (const { first_event: first, events } of steps.slice(0, -1))
    states.push(await run.client.ask('seek', { event: first + events }));
  states.push(run.end);
  const front = met.length - 1;
  const quarter = ends.findIndex((end) => end >= QUARTER * placed.radii.length);
  return {
    ...{ run, placed, met, steps, states, front, quarter: Math.max(0, quarter), last: front + steps.length },
    // The body comes from another run, so that it does not show where this one leaves a hole.
    body: (await own.run({ seed: 1, relax_steps: 0 })).placed,
    /** The particles at a position of the slider. @param {number} place */
    at: (place) => (place < front ? rangeOf(placed, 0, ends[place]) : states[Math.max(0, place - front)]),
  };
}

/** @typedef {Awaited<ReturnType<typeof courseOf>>} Course */

/** @param {Context} context */
export async function seams({ lab, stops }) {
  const own = await lab;
  const course = await courseOf(own);
  const { placed, met, front, quarter, last } = course;
  const orbit = new Orbit();
  orbit.fitTo(placed);
  orbit.faceFront(placed);
  const picture = new Picture(orbit, {
    name: 'The front and its relaxation, with particles of five and of seven neighbours marked',
  });
  const isFree = () => stops.isOpen('predict-seam');
  const isRelaxing = () => isFree() && stops.isOpen('predict-rest');
  /** Every answer lets the slider go further. */
  const limit = () => (isRelaxing() ? last : isFree() ? front : quarter);
  const range = createRangeRow({
    name: 'Front and relaxation',
    max: limit,
    value: quarter,
    say: (place) =>
      place <= front
        ? `ring ${formatCount(place)} of ${formatCount(front)}`
        : `step ${formatCount(place - front)} of ${formatCount(last - front)}`,
    change() {},
  });
  const step = () => Math.max(0, range.place.value - front);
  /** Scores of the states so far, in order. @type {Signal<Score[]>} */
  const scores = signal([]);
  async function measure() {
    for (const state of course.states)
      scores.value = [...scores.peek(), await scoreOf(own, state, { evaluations: 0, isAdaptive: false })];
  }
  // Without its figures the picture is complete.
  measure().catch(() => {});
  live(picture.element, () => {
    const place = Math.min(range.place.value, limit());
    const marks = marksAt(course, place, { isFree: isFree(), isRelaxing: isRelaxing() });
    // A seam is where fronts have met so far.
    if (isFree() && termShown() === 'seam')
      marks.push(
        ...met
          .slice(0, place + 1)
          .flat()
          .map((particle) => markOf(placed, particle, 'cross')),
      );
    const measured = scores.value[step()] ?? scores.value[0];
    const particles = course.at(place);
    const colours =
      isFree() && measured
        ? byNeighbours(measured.valence.subarray(0, particles.radii.length))
        : byValue(particles.radii, 0, 2 * particles.radii[0]);
    picture.show({ particles, body: course.body, isClosed: isClosed(course.run), colours, marks });
    picture.ringed.value = (place >= front && isFree() && scores.value[step()]?.places.hole) || null;
  });
  // The answer concerns the first meeting; the next one concerns the steps after the front.
  let [wasFree, wasRelaxing] = [isFree(), isRelaxing()];
  live(picture.element, () => {
    const [isNow, isAfter] = [isFree() && !wasFree, isRelaxing() && !wasRelaxing];
    [wasFree, wasRelaxing] = [isFree(), isRelaxing()];
    const hole = scores.peek()[0]?.places.hole;
    if (isAfter) range.set(front);
    if (isAfter && hole) orbit.turnTo(hole.normal);
    const first = met.findIndex(({ length }) => length > 0);
    if (!isNow || first < 0) return;
    range.set(first);
    orbit.turnTo(triple(placed.normals, met[first][0]));
  });
  const words = h('p', { class: 'figure-count' }, () =>
    isFree() ? wordsAt(course, range.place.value) : 'The slider goes further once you have answered.',
  );
  const play = createPlay(range, { label: 'Play', totalMs: () => STEP_MS * limit() });
  mountSteps({
    last: last - front,
    step,
    stage: () => picture.element.closest('.stage'),
    go(to) {
      play.stop();
      range.set(front + to);
    },
    score: () => (isRelaxing() ? scores.value[step()] : undefined),
  });
  return [
    picture.element,
    h('div', { class: 'controls' }, play.element, range.element, words),
    createMarkKey({ hidden: () => !isFree() }),
  ];
}

/**
 * The sentence of the text about a relaxation step, whose number is a handle. It would give the answer away, so it
 * appears with the score.
 * @param {{ last: number, step: () => number, stage: () => HTMLElement | null, go: (step: number) => void,
 *   score: () => Score | undefined }} about  `score`: that of the step
 */
function mountSteps({ last, step, stage, go, score }) {
  const scale = { min: 0, max: last, step: 1 };
  offerNumber('steps', { name: 'Step', scale, value: step, say: formatCount, stage, change: go });
  const sentence = byId('steps');
  live(sentence, () => {
    const own = score();
    sentence.hidden = !own;
    if (own) fill(byId('steps-hole'), written('hole', own));
  });
}

/** The words for a position of the slider. @param {Course} course @param {number} place */
function wordsAt({ at, met, front, steps }, place) {
  if (place > front)
    return `The longest move of this step: ${formatSignificant(Number(steps[place - front - 1].largest_move), 2)} r.`;
  const times = plural(met[place].length, 'time');
  return `${plural(at(place).radii.length, 'particle')}; on this ring the front met itself ${times}.`;
}

/**
 * Crosses where the front met itself on a ring, and arrows for the next step.
 * @param {Course} course @param {number} place
 * @param {{ isFree: boolean, isRelaxing: boolean }} state
 */
function marksAt({ placed, met, front, states }, place, { isFree, isRelaxing }) {
  const marks = isFree && place <= front ? met[place].map((particle) => markOf(placed, particle, 'cross')) : [];
  const next = states[place - front + 1];
  return place >= front && isRelaxing && next ? [...marks, ...arrowsOf(states[place - front], next)] : marks;
}

/**
 * @param {LessonParticles} particles @param {number} i @param {Mark['kind']} kind @returns {Mark}
 */
const markOf = ({ positions, normals, radii }, i, kind) => ({
  place: triple(positions, i),
  normal: triple(normals, i),
  radius: CROSS * radii[i],
  kind,
});
