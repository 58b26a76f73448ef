/** Two runs side by side, seen by one camera. */
import { triple } from '../engine/vector.js';
import { fill, h } from '../ui/dom.js';
import { formatCount, formatFixed, formatSignificant } from '../ui/format.js';
import { spread } from '../ui/neighbours.js';
import { tableOf } from '../ui/table.js';
import { reasonOf } from './figure.js';
import { nearestDistances, parentDistances } from './measure.js';
import { createScale } from './parts.js';
import { byLevel, byValue, Orbit, Picture } from './picture.js';

/** @import { Colouring, Lab, LabRun, Side } from './types.js' */

/** Distances over the ideal one span this range of colours. */
const [LOW, HIGH] = [0.7, 1.15];

/**
 * @param {LabRun} run
 * @param {Colouring} colouring
 * @param {[number, number]} radii  the smallest and the largest of both runs
 */
function sceneOf(run, colouring, [least, most]) {
  // The distance to the parent is what placing gave; the others are as the run ended.
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

/** The colours in words. @param {Colouring} colouring @param {[number, number]} radii */
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
      return h('p', { class: 'scale' }, 'Each ring of the front has a colour; they repeat after twelve.');
  }
}

/** A mean and its deviation, to three decimals. @param {{ mean: number, deviation: number }} values */
const around = ({ mean, deviation }) =>
  `${formatFixed(mean, 3)} ± ${formatFixed(Math.round(deviation * 1000) / 1000, 3)}`;

/** Returns the figures of a run that are compared. @param {LabRun} run */
export function figuresOf(run) {
  const { particles, evaluations } = run.progress;
  const nearest = spread(nearestDistances(run.end));
  const isEven = run.settings.sampling !== 'adaptive';
  const unit = isEven ? 'in 2r' : 'over the sum of both radii';
  /** @type {[string, string][]} */
  const figures = [
    ['Particles', formatCount(particles)],
    ['Evaluations of f for each', formatSignificant(evaluations / Math.max(1, particles), 3)],
    [`Nearest neighbour, ${unit}`, around(nearest)],
    [`Closest pair, ${unit}`, formatFixed(nearest.least, 3)],
  ];
  if (isEven) figures.push(['Distance to the parent, in 2r', around(spread(parentDistances(run.placed, run.radius)))]);
  return figures;
}

/** @param {readonly [Side, Side]} sides @param {readonly [LabRun, LabRun]} runs */
function comparisonOf(sides, runs) {
  const [left, right] = runs.map(figuresOf);
  // A run with one size has more figures. Beside a run with many sizes, only the figures of both are compared.
  const names = left.length < right.length ? left : right;
  const rows = names.map(([name], k) => [name, left[k][1], right[k][1]]);
  return tableOf({ class: 'compare', head: ['', ...sides.map((side) => side.label)], rows });
}

/**
 * @param {Lab} lab @param {{ bare?: boolean }} [how]  `bare`: pictures alone, since figures would tell which is which
 */
export function createPair(lab, { bare = false } = {}) {
  const orbit = new Orbit(lab.surface.bounds);
  const pictures = ['left', 'right'].map(
    (side) => new Picture(orbit, { name: `The picture on the ${side}; both turn together` }),
  );
  /** @param {number} k @param {number} particle */
  function particlePlace(k, particle) {
    const { positions = new Float32Array(0) } = pictures[k].scene.peek()?.particles ?? {};
    return triple(positions, particle);
  }
  const captions = pictures.map(() => h('figcaption', null));
  const legend = h('div');
  const table = h('div', { class: 'compare-box' });
  const status = h('p', { class: 'figure-status', role: 'status' });
  const element = h(
    'div',
    { class: 'pair-box' },
    h(
      'div',
      { class: 'pair' },
      pictures.map((picture, k) => h('figure', null, picture.element, captions[k])),
    ),
    status,
    legend,
    bare ? null : table,
  );
  let asked = 0;
  return {
    element,
    /** @type {readonly [LabRun, LabRun] | null} */
    runs: null,
    /** Tells where a particle is pressed; null for no one. @param {((place: number[]) => void) | null} onPick */
    pickWith(onPick) {
      for (const [k, picture] of pictures.entries())
        picture.pickWith(onPick && ((particle) => onPick(particlePlace(k, particle))));
    },
    /** @param {readonly [Side, Side]} sides @param {Colouring} colouring */
    async show(sides, colouring) {
      asked += 1;
      const mine = asked;
      status.textContent = 'Running both';
      try {
        const left = await sides[0].make(lab);
        const right = await sides[1].make(lab);
        if (mine !== asked) return;
        this.runs = [left, right];
        orbit.fitTo(left.end);
        const all = [...left.end.radii, ...right.end.radii];
        /** @type {[number, number]} */
        const radii = [Math.min(...all), Math.max(...all)];
        for (const [k, run] of this.runs.entries()) {
          pictures[k].show(sceneOf(run, colouring, radii));
          captions[k].textContent = sides[k].label;
        }
        if (!bare) fill(legend, legendOf(colouring, radii));
        fill(table, comparisonOf(sides, this.runs));
        status.textContent = '';
      } catch (error) {
        if (mine === asked) status.textContent = reasonOf(error);
      }
    },
  };
}
