/** Two samplings side by side, with one camera, and the table of their figures. */
import { batch, signal } from '@preact/signals-core';
import { triple } from '../engine/vector.js';
import { fill, h, live } from '../ui/dom.js';
import { formatFixed, formatSignificant } from '../ui/format.js';
import { reasonOf } from './figure.js';
import { latest } from './latest.js';
import { isClosed, nearestDistances, parentDistances } from './measure.js';
import { createScale } from './parts.js';
import { byLevel, byNeighbours, byValue, Orbit, Picture } from './picture.js';
import { scoreAtEnd } from './score.js';
import { createScorecard } from './scorecard.js';

/**
 * @import { Signal } from '../engine/types.js'
 * @import { Colouring, LabRun, Scene, Score, ScorePlace, ScoreWords } from './types.js'
 */

/** The colours span this range of distances, relative to the ideal one. */
const [LOW, HIGH] = [0.7, 1.15];

/** @typedef {[number, number]} Range  the smallest and the largest radius of both runs */

/** @type {Record<Colouring, { scene: (run: LabRun, radii: Range) => Scene, legend: (radii: Range) => Node | null }>} */
const COLOURINGS = {
  level: {
    scene: ({ end }) => ({ particles: end, colours: byLevel(end) }),
    legend: () =>
      h(
        'p',
        { class: 'scale' },
        'Blue where the front began, sand where it ended, with a lighter ring every eighth level.',
      ),
  },
  // As placed; other values are those at the end of the run.
  parent: {
    scene: ({ placed, radius }) => ({
      particles: placed,
      colours: byValue(parentDistances(placed, radius), LOW, HIGH),
    }),
    legend: () => createScale('Distance to the parent, in 2r', formatFixed(LOW, 2), formatFixed(HIGH, 2)),
  },
  nearest: {
    scene: ({ end }) => ({ particles: end, colours: byValue(nearestDistances(end), LOW, HIGH) }),
    legend: () => createScale('Distance to the nearest, in 2r', formatFixed(LOW, 2), formatFixed(HIGH, 2)),
  },
  radius: {
    scene: ({ end }, [least, most]) => ({ particles: end, colours: byValue(end.radii, least, most) }),
    legend: ([least, most]) => createScale('Radius', formatSignificant(least, 2), formatSignificant(most, 2)),
  },
  // A single colour, which tells nothing about the method.
  none: {
    scene: ({ end }) => ({ particles: end, colours: byValue(new Float32Array(end.radii.length).fill(1), 0, 2) }),
    legend: () => null,
  },
};

/**
 * What a pair shows. `labels` and `card` follow signals: the names of both, and what the table says, which is hidden
 * for null.
 * @typedef {object} Shown
 * @property {() => Promise<readonly LabRun[]>} make
 * @property {() => readonly string[]} labels
 * @property {() => ScoreWords | null} card
 * @property {Colouring} [colouring]
 * @property {(run: LabRun) => Promise<Score>} [score]
 */

/**
 * @param {() => boolean} isMarked  whether particles with five and with seven neighbours are marked
 * @param {Node} key  of the marks
 */
export function createPair(isMarked, key) {
  const orbit = new Orbit();
  const pictures = ['left', 'right'].map(
    (side) => new Picture(orbit, { name: `The picture on the ${side}; both turn together` }),
  );
  const captions = pictures.map(() => h('figcaption'));
  const figures = pictures.map((picture, k) => h('figure', null, picture.element, captions[k]));
  /** Turns both to a place, and rings it on its side. @param {ScorePlace | null} place @param {number} side */
  function point(place, side) {
    for (const [k, picture] of pictures.entries()) picture.ringed.value = k === side ? place : null;
    if (place) orbit.turnTo(place.normal);
  }
  const legend = h('div', { hidden: isMarked });
  const scorecard = createScorecard(point);
  const status = h('p', { class: 'figure-status', role: 'status' });
  const element = h(
    'div',
    { class: 'pair-box' },
    status,
    h('div', { class: 'pair' }, figures),
    legend,
    key,
    scorecard.element,
  );
  /** @type {Signal<(Shown & { runs: readonly LabRun[], scenes: readonly Scene[] }) | null>} */
  const shown = signal(null);
  /** None until the runs are measured. @type {Signal<readonly Score[]>} */
  const scores = signal([]);
  live(element, () => {
    const { runs = [], scenes = [], labels = () => [] } = shown.value ?? {};
    const names = labels();
    for (const [k, scene] of scenes.entries()) {
      captions[k].textContent = names[k];
      const { valence } = (isMarked() && scores.value[k]) || {};
      pictures[k].show(valence ? { ...scene, particles: runs[k].end, colours: byNeighbours(valence) } : scene);
    }
  });
  live(element, () => {
    const card = shown.value?.card() ?? null;
    scorecard.element.hidden = card === null;
    if (shown.value && card && scores.value.length > 0)
      scorecard.tell(card.names ?? shown.value.labels(), scores.value, card);
  });

  const show = latest(async (/** @type {Shown} */ about, isOld) => {
    const { make, colouring = 'none', score = scoreAtEnd } = about;
    status.textContent = 'Running both';
    element.ariaBusy = 'true';
    try {
      const runs = await make();
      if (isOld()) return;
      orbit.fitTo(...runs.map(({ end }) => end));
      if (runs[0].lab !== shown.peek()?.runs[0].lab) orbit.faceFront(runs[0].placed);
      const all = runs.flatMap(({ end }) => [...end.radii]);
      /** @type {Range} */
      const radii = [Math.min(...all), Math.max(...all)];
      const { scene, legend: words } = COLOURINGS[colouring];
      fill(legend, words(radii));
      point(null, 0);
      element.ariaBusy = 'false';
      scorecard.wait();
      batch(() => {
        scores.value = [];
        const scenes = runs.map((run) => ({ ...scene(run, radii), isClosed: isClosed(run) }));
        shown.value = { ...about, runs, scenes };
      });
      status.textContent = 'Measuring both';
      const measured = [];
      for (const run of runs) measured.push(await score(run));
      if (isOld()) return;
      scores.value = measured;
      status.textContent = '';
    } catch (error) {
      if (isOld()) return;
      status.textContent = reasonOf(error);
      element.ariaBusy = 'false';
    }
  });
  return {
    element,
    show,
    /** The runs shown, with names, and with scores once they are measured. */
    runs() {
      const { runs = [], labels = () => [] } = shown.peek() ?? {};
      return runs.map((run, k) => ({ label: labels()[k], run, score: scores.peek()[k] }));
    },
    /** Sets the function that receives pressed points; null for none. */
    pickWith(/** @type {((place: number[]) => void) | null} */ onPick) {
      for (const picture of pictures)
        picture.pickWith(
          onPick &&
            ((particle) => {
              const { positions } = picture.scene.peek()?.particles ?? { positions: [0, 0, 0] };
              onPick(triple(positions, particle));
            }),
        );
    },
  };
}
