/** Marks of the cutting plane: its outline in the clip box, a knob that moves it and one that turns it. */
import { effect } from '@preact/signals-core';
import { along, dot } from '../../../engine/vector.js';
import { formatSignificant } from '../../format.js';
import { clamp } from '../../scale.js';
import { centreOf, directionOnSphere, extentOf, placeAlong, sectionOf } from '../../space.js';
import { boxOf } from './box.js';
import { createHandle } from './handle.js';

/**
 * @import { Bounds, CuttingPlane, Engine, Ray, Vec3 } from '../../../engine/types.js'
 * @import { Mark } from './layer.js'
 */

/** Length of the arrow in pixels. */
const ARROW_PX = 52;
/** Step of the arrow keys as a share of the way through the box, and the share of a drag with Shift. */
const KEY_SHARE = 0.01;
const FINE = 0.1;

/** @param {Engine} engine @param {HTMLElement} stage @returns {Mark} */
export function planeMark(engine, stage) {
  const box = boxOf(engine);
  /** Place near which the knob is, if the plane was turned in the picture. @type {Vec3 | null} */
  let pivot = null;
  effect(() => {
    if (!engine.state.value.plane) pivot = null;
  });
  /** The plane when a drag began, the place of its knob, and where the pointer was along its normal. */
  const drag = {
    plane: /** @type {CuttingPlane | null} */ (null),
    base: /** @type {Vec3} */ ([0, 0, 0]),
    at: /** @type {number | null} */ (null),
    radius: 0,
    far: false,
  };

  /**
   * Returns the place of the knob: on the plane, beside the pivot or the middle of the box.
   * @param {CuttingPlane} plane
   * @param {Bounds} bounds
   */
  const baseOf = ({ normal, offset }, bounds) => {
    const near = pivot ?? centreOf(bounds);
    return along(near, normal, offset - dot(normal, near));
  };
  const cancel = () => {
    if (drag.plane) engine.setPlane(drag.plane);
  };
  /** @param {Ray} ray */
  const grab = (ray) => {
    const [plane, bounds] = [engine.state.peek().plane, box.peek()];
    drag.plane = plane;
    if (!plane || !bounds) return;
    drag.base = baseOf(plane, bounds);
    drag.at = placeAlong(ray, drag.base, plane.normal);
  };
  /** Moves the plane, within the box. @param {number} offset */
  const move = (offset) => {
    const [plane, bounds] = [engine.state.peek().plane, box.peek()];
    if (!plane || !bounds) return;
    const [low, high] = extentOf(bounds, plane.normal);
    engine.setPlane({ ...plane, offset: clamp(offset, low, high) });
  };

  const knob = createHandle(engine, stage, {
    name: 'Cutting plane',
    kind: 'plane-knob',
    grab,
    drag(ray, fine) {
      const { plane } = engine.state.peek();
      if (!plane) return;
      const at = placeAlong(ray, drag.base, plane.normal);
      if (at !== null && drag.at !== null) move(plane.offset + (at - drag.at) * (fine ? FINE : 1));
      drag.at = at;
    },
    drop: () => {},
    cancel,
    press(presses, fine) {
      const [plane, bounds] = [engine.state.peek().plane, box.peek()];
      if (!plane || !bounds) return;
      const [low, high] = extentOf(bounds, plane.normal);
      move(plane.offset + presses * KEY_SHARE * (high - low) * (fine ? FINE : 1));
    },
  });
  const tip = createHandle(engine, stage, {
    name: 'Direction of the cutting plane',
    kind: 'plane-tip',
    grab(ray) {
      grab(ray);
      const spot = engine.project(drag.base);
      if (!drag.plane || !spot) return;
      drag.radius = ARROW_PX * spot.perPx;
      drag.far = dot(drag.plane.normal, ray.direction) > 0;
      pivot = drag.base;
    },
    drag(ray) {
      if (!drag.plane || !(drag.radius > 0)) return;
      const normal = directionOnSphere(ray, drag.base, drag.radius, drag.far);
      engine.setPlane({ normal, offset: dot(normal, drag.base) });
    },
    drop: () => {},
    cancel,
    // The panel has sliders for the two angles.
    press: null,
  });

  return {
    handles: [knob.knob, tip.knob],
    shown: () => box.value !== null && engine.state.value.plane !== null,
    draw(pen) {
      const [plane, bounds] = [engine.state.value.plane, box.value];
      if (!plane || !bounds) return;
      const section = sectionOf(bounds, plane);
      if (section.length) pen.polygon(section, 'section-line');
      const base = baseOf(plane, bounds);
      const spot = engine.project(base);
      const end = spot && engine.project(along(base, plane.normal, ARROW_PX * spot.perPx));
      if (spot && end) pen.line(spot, end, 'arrow');
      knob.put(spot);
      tip.put(end);
      const [low, high] = extentOf(bounds, plane.normal);
      knob.tell(plane.offset, low, high, `${formatSignificant(plane.offset, 3)} along the normal`);
    },
  };
}
