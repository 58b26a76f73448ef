/** Marks of the clip box: a handle on each face, and the lengths of its edges. */
import { computed } from '@preact/signals-core';
import { isBoxDrawn, withFace } from '../../box.js';
import { formatSignificant } from '../../format.js';
import { AXES, axisVector, centreOf, placeAlong } from '../../space.js';
import { outerEdge, outward } from './edges.js';
import { createHandle } from './handle.js';

/**
 * @import { Bounds, Engine, ReadonlySignal } from '../../../engine/types.js'
 * @import { FaceDrag, Mark } from '../types.js'
 */

/** Step of the arrow keys as a share of the side. */
const KEY_SHARE = 0.02;
/** Factor of a drag with Shift. */
const FINE = 0.1;
/** Distance of a length from its edge. */
const LABEL_PX = 14;

/** The clip box that is drawn: the user's, or that of the field. @param {Engine} engine */
export const boxOf = (engine) => computed(() => engine.state.value.bounds ?? engine.field.value?.bounds ?? null);

/** @param {Engine} engine @param {HTMLElement} stage @returns {Mark} */
export function boxMark(engine, stage) {
  const box = boxOf(engine);
  const faces = AXES.flatMap((name, axis) =>
    /** @type {const} */ (['min', 'max']).map((end) => createFace(engine, stage, box, { name, axis, end })),
  );
  return {
    handles: faces.map(({ handle }) => handle.knob),
    shown: () => box.value !== null && isBoxDrawn(engine),
    draw(pen) {
      const bounds = box.value;
      if (!bounds) return;
      for (const { put } of faces) put(bounds);
      // The figures of the axes would be at the same places.
      if (engine.state.value.view.axes) return;
      for (const [axis, name] of AXES.entries()) {
        const edge = outerEdge(engine, bounds, axis);
        if (!edge) continue;
        const middle = { x: (edge.from.x + edge.to.x) / 2, y: (edge.from.y + edge.to.y) / 2 };
        const side = formatSignificant(bounds.max[axis] - bounds.min[axis], 3);
        const way = outward(edge, edge.centre);
        pen.text(
          { x: middle.x + way.x * LABEL_PX, y: middle.y + way.y * LABEL_PX },
          `${name} ${side}`,
          'figure',
          way.anchor,
        );
      }
    },
  };
}

/**
 * @param {Engine} engine
 * @param {HTMLElement} stage
 * @param {ReadonlySignal<Bounds | null>} box
 * @param {{ name: string, axis: number, end: 'min' | 'max' }} face
 */
function createFace(engine, stage, box, { name, axis, end }) {
  const vector = axisVector(axis);
  /** @type {FaceDrag} */
  const drag = { box: null, own: null, at: null, value: 0, moved: false };
  const middleOf = (/** @type {Bounds} */ bounds) => {
    const middle = centreOf(bounds);
    middle[axis] = bounds[end][axis];
    return middle;
  };
  const handle = createHandle(engine, stage, {
    name: `${end === 'min' ? 'Lower' : 'Upper'} ${name} face of the clip box`,
    kind: 'face',
    grab(ray) {
      drag.box = box.peek();
      drag.own = engine.state.peek().bounds;
      if (!drag.box) return;
      drag.value = drag.box[end][axis];
      drag.moved = false;
      drag.at = placeAlong(ray, middleOf(drag.box), vector);
    },
    drag(ray, fine) {
      if (!drag.box) return;
      const at = placeAlong(ray, middleOf(drag.box), vector);
      if (at !== null && drag.at !== null) {
        drag.value += (at - drag.at) * (fine ? FINE : 1);
        drag.moved = true;
        engine.setBounds(withFace(drag.box, axis, end, drag.value), { live: true });
      }
      drag.at = at;
    },
    drop() {
      if (drag.moved) engine.setBounds(engine.state.peek().bounds);
    },
    cancel: () => engine.setBounds(drag.own),
    press(presses, fine) {
      const now = box.peek();
      if (!now) return;
      const step = KEY_SHARE * (now.max[axis] - now.min[axis]) * (fine ? FINE : 1);
      engine.setBounds(withFace(now, axis, end, now[end][axis] + presses * step));
    },
  });
  return {
    handle,
    /** @param {Bounds} bounds */
    put(bounds) {
      handle.put(engine.project(middleOf(bounds)));
      const [low, high] = [bounds.min[axis], bounds.max[axis]];
      handle.tell(bounds[end][axis], low, high, `${name} = ${formatSignificant(bounds[end][axis], 3)}`);
    },
  };
}
