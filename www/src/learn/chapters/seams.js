/** The front, its seams, and the relaxation after it, as one course that a slider goes through. */
import { signal } from '@preact/signals-core';
import { triple } from '../../engine/vector.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, formatFixed, formatSignificant, plural } from '../../ui/format.js';
import { reasonOf } from '../figure.js';
import { latest } from '../latest.js';
import { energiesOf, energyWords, nearestDistances, widestHole } from '../measure.js';
import { createChart, createPlay, createRangeRow, createScale } from '../parts.js';
import { byValue, Orbit, Picture } from '../picture.js';
import { pushesOn } from '../pushes.js';
import { scoreOf } from '../score.js';
import { createScorecard } from '../scorecard.js';

/**
 * @import { LessonParticles, Signal } from '../../engine/types.js'
 * @import { Context, Lab, LabRun, Mark, Score, ScorePlace } from '../types.js'
 */

/** Time from one place of the slider to the next. */
const STEP_MS = 400;
/** Colours span this range of distances, in 2r. */
const [NEAR, FAR] = [0.7, 1.15];
/** The share of the particles that the front has placed when the widest hole is asked for. */
const QUARTER = 0.25;
/** Arrows are so many times as long as the moves; shorter moves, in r, have none. */
const [LONGER, SHORTEST] = [6, 0.03];
/** Size of a cross, over that of other marks, which are wider than a disc. */
const CROSS = 0.5;

/** The particles of each level whose front met itself or another one out of step. @param {LabRun} run */
async function meetingsOf({ client, chapters }) {
  const levels = chapters.filter(({ kind }) => kind === 'level');
  /** @type {number[][]} */
  const found = [];
  for (const { first_event: first, events: count } of levels) {
    const events = await client.ask('events', { first, count });
    found.push(events.flatMap((event) => (event.type === 'fronts_meet' ? [event.particle] : [])));
  }
  return { levels, found };
}

/** The first particles of a run. @param {LessonParticles} all @param {number} count */
const firstOf = (all, count) => ({
  ...all,
  positions: all.positions.subarray(0, 3 * count),
  normals: all.normals.subarray(0, 3 * count),
  radii: all.radii.subarray(0, count),
  levels: all.levels.subarray(0, count),
});

/** Arrows from where particles are to where they go. @param {LessonParticles} now @param {LessonParticles} next */
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
 * What the slider goes through: the levels of the front, then the states after each step of relaxation.
 * @param {Lab} own
 */
async function courseOf(own) {
  const run = await own.run({}, { keep: true });
  const { placed } = run;
  const { levels, found } = await meetingsOf(run);
  const steps = run.chapters.filter(({ kind }) => kind === 'relaxation');
  const states = [placed];
  for (const { first_event: first, events } of steps.slice(0, -1))
    states.push(await run.client.ask('seek', { event: first + events }));
  states.push(run.end);
  const front = levels.length - 1;
  const quarter = levels.findIndex(({ after }) => after >= QUARTER * placed.radii.length);
  return {
    ...{ run, placed, levels, found, steps, states, front, quarter: Math.max(0, quarter), last: front + steps.length },
    // The body of another run, whose particles tell nothing of where this one leaves a hole.
    body: (await own.run({ seed: 1, relax_steps: 0 })).placed,
    energies: await energiesOf(own),
    widest: await widestHole(own),
    /** The particles at a place of the slider. @param {number} place */
    at: (place) => (place < front ? firstOf(placed, levels[place].after) : states[Math.max(0, place - front)]),
  };
}

/** @typedef {Awaited<ReturnType<typeof courseOf>>} Course */

/** @param {Context} context */
export async function seams({ lab, stops }) {
  const own = await lab;
  const course = await courseOf(own);
  const { placed, steps, front, quarter, last, widest } = course;
  const orbit = new Orbit();
  orbit.fitTo(placed);
  orbit.faceFront(placed);
  const picture = new Picture(orbit, {
    name: 'The front and its relaxation, coloured by the distance to the nearest particle',
    onPick(particle) {
      stops.pick('predict-hole', particle);
      if (isRelaxing()) followed.value = particle;
    },
  });
  /** Whose pushes are drawn: at first that beside the widest hole. */
  const followed = signal(widest?.particle ?? 0);
  const isFree = () => stops.isOpen('predict-hole');
  const isRelaxing = () => isFree() && stops.isOpen('predict-rest');
  /** The slider goes on with every answer. */
  const limit = () => (isRelaxing() ? last : isFree() ? front : quarter);
  const range = createRangeRow({
    name: 'Front and relaxation',
    max: limit,
    value: quarter,
    say: (place) =>
      place <= front
        ? `level ${formatCount(place)} of ${formatCount(front)}`
        : `step ${formatCount(place - front)} of ${formatCount(last - front)}`,
    change() {},
  });
  const step = () => Math.max(0, range.place.value - front);
  /** Those of the states so far, in their order. @type {Signal<Score[]>} */
  const scores = signal([]);
  const coloursAt = painted(course);
  live(picture.element, () => {
    const place = Math.min(range.place.value, limit());
    const isAfter = isRelaxing() && place >= front;
    const picked = isAfter ? followed.value : place <= front ? stops.picked('predict-hole') : null;
    const marks = marksAt(course, place, { picked, isRelaxing: isRelaxing() });
    // Before the end of the front a press chooses one of the particles to come, where the surface is still bare, too.
    const places = place < front ? placed : course.at(place);
    picture.show({ particles: course.at(place), body: course.body, places, colours: coloursAt(place), marks });
    const hole = scores.value[step()]?.places.hole ?? (step() === 0 ? widest?.hole : null) ?? null;
    picture.ringed.value = place >= front && isFree() ? hole : null;
  });
  // The answer is about the whole front, and the next one about the steps after it.
  let [wasFree, wasRelaxing] = [isFree(), isRelaxing()];
  live(picture.element, () => {
    const [isNow, isAfter] = [isFree() && !wasFree, isRelaxing() && !wasRelaxing];
    [wasFree, wasRelaxing] = [isFree(), isRelaxing()];
    if (isNow || isAfter) range.set(front);
    if (isNow && widest) orbit.turnTo(widest.hole.normal);
  });
  const words = h('p', { class: 'figure-count' }, () => {
    if (!isFree()) return 'The slider goes on once you have said where.';
    const place = range.place.value;
    if (place > front)
      return `The longest move of this step: ${formatSignificant(Number(steps[step() - 1].largest_move), 2)} r.`;
    const met = plural(course.found[place].length, 'time');
    return `${plural(course.at(place).radii.length, 'particle')}; the front met itself ${met} on this level.`;
  });
  const card = createCard(own, course, {
    isOpen: isRelaxing,
    scores,
    /** The step that is beside the placing. */
    step: () => step() || steps.length,
    show(place, at) {
      if (place) range.set(front + at);
      picture.ringed.value = place;
      if (place) orbit.turnTo(place.normal);
    },
  });
  const play = createPlay(range, { label: 'Play', totalMs: () => STEP_MS * limit() });
  return [
    picture.element,
    h('div', { class: 'controls' }, play.element, range.element, words),
    createScale('Distance to the nearest, in 2r', formatFixed(NEAR, 2), formatFixed(FAR, 2)),
    energyChart(course, {
      hidden: () => !isRelaxing(),
      at: () => (range.place.value >= front ? step() : null),
      press: (at) => range.set(front + at),
    }),
    createPushes(course, { isOpen: isRelaxing, followed, step }),
    card,
  ];
}

/**
 * The pushes on a particle in the step that comes next.
 * @param {Course} course
 * @param {{ isOpen: () => boolean, followed: Signal<number>, step: () => number }} about
 */
function createPushes({ run: { client }, states, steps }, { isOpen, followed, step }) {
  const box = h('div', { class: 'pushes-box', hidden: () => !isOpen() });
  const show = latest(async (/** @type {{ particle: number, at: number }} */ { particle, at }, isOld) => {
    // Questions are answered in their order, so none comes between these two.
    const sought = client.ask('seek', { event: steps[at].first_event });
    const pushes = await client.ask('pushes', { particle });
    await sought;
    if (!isOld()) fill(box, pushesOn({ before: states[at], after: states[at + 1] }, particle, pushes));
  });
  live(box, () => {
    const at = Math.min(step(), steps.length - 1);
    if (isOpen() && steps.length > 0) void show({ particle: followed.value, at });
  });
  return box;
}

/** The colours at each place, worked out once. @param {Course} course */
function painted({ at }) {
  /** @type {Map<number, ReturnType<typeof byValue>>} */
  const known = new Map();
  return (/** @type {number} */ place) => {
    const colours = known.get(place) ?? byValue(nearestDistances(at(place)), NEAR, FAR);
    known.set(place, colours);
    return colours;
  };
}

/**
 * Crosses where the front met itself on a level and where the learner pressed, and arrows of the step that comes next.
 * @param {Course} course @param {number} place @param {{ picked: number | null, isRelaxing: boolean }} state
 */
function marksAt({ placed, found, front, states }, place, { picked, isRelaxing }) {
  const marks = place <= front ? found[place].map((particle) => markOf(placed, particle)) : [];
  const now = states[place - front] ?? placed;
  if (picked !== null) marks.push({ ...markOf(now, picked), radius: now.radii[picked] });
  const next = states[place - front + 1];
  return place >= front && isRelaxing && next ? [...marks, ...arrowsOf(states[place - front], next)] : marks;
}

/**
 * The scorecard of the placing and a step.
 * @param {Lab} own @param {Course} course
 * @param {{ isOpen: () => boolean, scores: Signal<Score[]>, step: () => number,
 *   show: (place: ScorePlace | null, step: number) => void }} about
 */
function createCard(own, { run, states, steps }, { isOpen, scores, step, show }) {
  const scorecard = createScorecard((place, side) => show(place, side === 0 ? 0 : step()));
  async function score() {
    for (const [k, state] of states.entries()) {
      const evaluations = k === 0 ? run.placing : steps[k - 1].evaluations;
      const one = await scoreOf(own, state, { evaluations, isAdaptive: false });
      scores.value = [...scores.peek(), one];
    }
  }
  const box = h('div', { hidden: () => !isOpen() }, scorecard.element);
  live(box, () => {
    if (isOpen() && scores.peek().length === 0)
      score().catch((error) => fill(scorecard.element, h('p', { class: 'figure-status' }, reasonOf(error))));
  });
  live(box, () => {
    const [before, after] = [scores.value[0], scores.value[step()]];
    if (before && after) scorecard.tell(['As placed', `After step ${formatCount(step())}`], [before, after]);
  });
  return box;
}

/**
 * The energy step by step.
 * @param {Course} course
 * @param {{ hidden: () => boolean, at: () => number | null, press: (at: number) => void }} about
 */
function energyChart({ energies, steps }, { hidden, at, press }) {
  const three = (/** @type {number} */ value) => formatFixed(value, 3);
  return createChart({
    hidden,
    chart: () => ({
      kind: 'line',
      rows: [{ fate: 'own', name: 'energy', counts: energies }],
      floor: energies[energies.length - 1],
      ends: ['as placed', `step ${formatCount(steps.length)}`],
      first: 0,
      at: at(),
      format: three,
    }),
    label: `Energy by step, over that before the first: ${energies.map(three).join(', ')}`,
    words: () => energyWords(energies),
    press,
  });
}

/** @param {LessonParticles} particles @param {number} i @returns {Mark} */
const markOf = ({ positions, normals, radii }, i) => ({
  place: triple(positions, i),
  normal: triple(normals, i),
  radius: CROSS * radii[i],
  kind: 'cross',
});
