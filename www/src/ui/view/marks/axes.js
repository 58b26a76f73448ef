/** Axes with ticks around the particles, and a scale bar. */
import { computed } from '@preact/signals-core';
import { h } from '../../dom.js';
import { formatStep } from '../../format.js';
import { AXES, niceStep, ticksIn } from '../../space.js';
import { boxOf } from './box.js';
import { outerEdge, outward } from './edges.js';

/**
 * @import { Bounds, Engine } from '../../../engine/types.js'
 * @import { Edge, Mark, Pen, Point } from '../types.js'
 */

/** Smallest gap between ticks, length of a tick, and distances of its figure and the axis's name from the axis. */
const APART_PX = 48;
const TICK_PX = 5;
const FIGURE_PX = 15;
const NAME_PX = 38;
/** Largest length of the scale bar. */
const BAR_PX = 110;

/** @param {Engine} engine @returns {Mark} */
export function axesMark(engine) {
  const clip = boxOf(engine);
  /**
   * The box around the particles. It stays during a run, so that the axes do not grow with the surface.
   * @type {Bounds | null}
   */
  let last = null;
  const box = computed(() => {
    void engine.revision.value;
    if (engine.status.value !== 'sampling') last = engine.columns.stale ? null : engine.columns.bounds();
    return last ?? clip.value;
  });
  return {
    shown: () => engine.state.value.view.axes && box.value !== null,
    draw(pen) {
      const bounds = box.value;
      if (!bounds) return;
      for (const axis of AXES.keys()) {
        const edge = outerEdge(engine, bounds, axis);
        if (edge) drawAxis(pen, engine, edge, axis);
      }
    },
  };
}

/** @param {Pen} pen @param {Engine} engine @param {Edge} edge @param {number} axis */
function drawAxis(pen, engine, edge, axis) {
  const { from, to, ends, centre } = edge;
  pen.line(from, to, 'axis');
  const way = outward(edge, centre);
  const [low, high] = [ends[0][axis], ends[1][axis]];
  const lengthPx = Math.hypot(to.x - from.x, to.y - from.y);
  const away = (/** @type {Point} */ at, /** @type {number} */ px) => ({
    x: at.x + way.x * px,
    y: at.y + way.y * px,
  });
  const step = niceStep(((high - low) * APART_PX) / lengthPx);
  for (const value of ticksIn(low, high, step)) {
    const place = [...ends[0]];
    place[axis] = value;
    const spot = engine.project(place);
    if (!spot) continue;
    pen.line(spot, away(spot, TICK_PX), 'axis');
    pen.text(away(spot, FIGURE_PX), formatStep(value, step), 'figure', way.anchor);
  }
  const middle = { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 };
  pen.text(away(middle, NAME_PX), AXES[axis], 'figure name', way.anchor);
}

/**
 * Creates the scale bar. Its length holds at the distance of the camera's target: in perspective, nearer things look
 * longer.
 * @param {Engine} engine
 */
export function createScaleBar(engine) {
  const about = computed(() => {
    const { bar, camera } = engine.state.value.view;
    if (!bar) return null;
    void engine.frame.value;
    const spot = engine.project(camera.target);
    if (!spot) return null;
    const length = niceStep((BAR_PX * spot.perPx) / 2.5);
    return { text: formatStep(length, length), px: length / spot.perPx };
  });
  return h(
    'div',
    {
      class: 'scale-bar',
      role: 'img',
      hidden: () => !about.value,
      style: { '--length': () => `${(about.value?.px ?? 0).toFixed(1)}px` },
      'aria-label': () => `Scale bar: ${about.value?.text} units of length in the middle of the picture`,
    },
    h('span', null, () => about.value?.text),
    h('span', { class: 'line' }),
  );
}
