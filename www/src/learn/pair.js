/** Two runs side by side, with one camera. */
import { signal } from '@preact/signals-core';
import { triple } from '../engine/vector.js';
import { fill, h, live } from '../ui/dom.js';
import { formatFixed, formatSignificant } from '../ui/format.js';
import { reasonOf } from './figure.js';
import { latest } from './latest.js';
import { createMarkSwitch, isMarked } from './marks.js';
import { isClosed, nearestDistances, parentDistances } from './measure.js';
import { createScale } from './parts.js';
import { byLevel, byNeighbours, byValue, Orbit, sideBySide } from './picture.js';
import { DECIDING, scoreAtEnd } from './score.js';
import { createScorecard } from './scorecard.js';

/** @import { Colouring, Lab, LabRun, Scene, Score, Side, WhatIf } from './types.js' */

/** The colours span this range of distances, relative to the ideal one. */
const [LOW, HIGH] = [0.7, 1.15];

/**
 * @param {LabRun} run
 * @param {Colouring} colouring
 * @param {[number, number]} radii  the smallest and the largest of both runs
 */
function sceneOf(run, colouring, radii) {
  return { ...colouredBy(run, colouring, radii), isClosed: isClosed(run) };
}

/** @param {LabRun} run @param {Colouring} colouring @param {[number, number]} radii */
function colouredBy(run, colouring, [least, most]) {
  // Distances to the parent are as placed; other values are those at the end of the run.
  const particles = colouring === 'parent' ? run.placed : run.end;
  switch (colouring) {
    case 'parent':
      return { particles, colours: byValue(parentDistances(run.placed, run.radius), LOW, HIGH) };
    case 'nearest':
      return { particles, colours: byValue(nearestDistances(particles), LOW, HIGH) };
    case 'radius':
      return { particles, colours: byValue(particles.radii, least, most) };
    default:
      return { particles, colours: byLevel(particles) };
  }
}

/** The legend in words. @param {Colouring} colouring @param {[number, number]} radii */
function legendOf(colouring, [least, most]) {
  const [low, high] = [formatFixed(LOW, 2), formatFixed(HIGH, 2)];
  switch (colouring) {
    case 'parent':
      return createScale('Distance to the parent, in 2r', low, high);
    case 'nearest':
      return createScale('Distance to the nearest, in 2r', low, high);
    case 'radius':
      return createScale('Radius', formatSignificant(least, 2), formatSignificant(most, 2));
    default:
      return h(
        'p',
        { class: 'scale' },
        'Blue where the front began, sand where it ended, with a lighter ring every eighth level.',
      );
  }
}

export function createPair() {
  const orbit = new Orbit();
  const names = ['left', 'right'].map((side) => `The picture on the ${side}; both turn together`);
  const { pictures, captions, figures, point } = sideBySide(orbit, names);
  /** @param {number} k @param {number} particle */
  function particlePlace(k, particle) {
    const { positions = new Float32Array(0) } = pictures[k].scene.peek()?.particles ?? {};
    return triple(positions, particle);
  }
  const legend = h('div');
  const scorecard = createScorecard(point);
  const status = h('p', { class: 'figure-status', role: 'status' });
  const element = h(
    'div',
    { class: 'pair-box' },
    status,
    h('div', { class: 'pair' }, figures),
    h('div', { hidden: isMarked }, legend),
    createMarkSwitch(),
    scorecard.element,
  );
  /** Both scenes without marks. @type {import('../engine/types.js').Signal<readonly Scene[]>} */
  const scenes = signal([]);
  /** Null until the runs are measured. @type {import('../engine/types.js').Signal<readonly Score[] | null>} */
  const scores = signal(null);
  live(element, () => {
    for (const [k, scene] of scenes.value.entries()) {
      const score = isMarked() ? scores.value?.[k] : null;
      const end = shown.runs?.[k].end;
      pictures[k].show(score && end ? { ...scene, particles: end, colours: byNeighbours(score.valence) } : scene);
    }
  });
  /** The lab of the runs shown. @type {Lab | null} */
  let seen = null;
  const shown = {
    element,
    runs: /** @type {readonly [LabRun, LabRun] | null} */ (null),
    /** The scores of the runs, once measured. */
    scores: () => scores.peek(),
    /** Sets the function that receives pressed points; null for none. */
    pickWith(/** @type {((place: number[]) => void) | null} */ onPick) {
      for (const [k, picture] of pictures.entries())
        picture.pickWith(onPick && ((particle) => onPick(particlePlace(k, particle))));
    },
    show: (/** @type {Pair} */ about) => compare(about),
  };
  /**
   * @typedef {{ lab: Lab, sides: readonly [Side, Side], whatIf: Pick<WhatIf, 'colouring' |
   *   'decides'> }} Pair
   */
  const compare = latest(async (/** @type {Pair} */ { lab, sides, whatIf: { colouring, decides } }, isOld) => {
    status.textContent = 'Running both';
    element.ariaBusy = 'true';
    try {
      const left = await sides[0].make(lab);
      const right = await sides[1].make(lab);
      if (isOld()) return;
      shown.runs = [left, right];
      scores.value = null;
      orbit.fitTo(left.end, right.end);
      if (lab !== seen) orbit.faceFront(left.placed);
      seen = lab;
      const all = [...left.end.radii, ...right.end.radii];
      /** @type {[number, number]} */
      const radii = [Math.min(...all), Math.max(...all)];
      scenes.value = shown.runs.map((run) => sceneOf(run, colouring, radii));
      for (const [k, { label }] of sides.entries()) captions[k].textContent = label;
      fill(legend, legendOf(colouring, radii));
      point(null, 0);
      element.ariaBusy = 'false';
      scorecard.wait();
      status.textContent = 'Measuring both';
      const measured = [await scoreAtEnd(left), await scoreAtEnd(right)];
      if (isOld()) return;
      scores.value = measured;
      scorecard.tell(
        sides.map(({ label }) => label),
        measured,
        { keys: decides ? [...DECIDING, decides] : DECIDING },
      );
      status.textContent = '';
    } catch (error) {
      if (isOld()) return;
      status.textContent = reasonOf(error);
      element.ariaBusy = 'false';
    }
  });
  return shown;
}
