/** Marks of the cutting plane: its outline in the clip box, a knob that moves it and one that turns it. */
import { along, clamp, dot } from '../../../engine/vector.js';
import { live } from '../../dom.js';
import { formatSignificant } from '../../format.js';
import { centreOf, directionOnSphere, extentOf, placeAlong, sectionOf } from '../../space.js';
import { boxOf } from './box.js';
import { createHandle } from './handle.js';

/**
 * @import { Bounds, CuttingPlane, Engine, Ray, ReadonlySignal, Vec3 } from '../../../engine/types.js'
 * @import { Mark } from '../types.js'
 */

/** Length of the arrow in pixels. */
const ARROW_PX = 52;
/** Step of the arrow keys as a share of the extent of the box, and the factor of a drag with Shift. */
const KEY_SHARE = 0.01;
const FINE = 0.1;

/** @param {Engine} engine @param {HTMLElement} stage @returns {Mark} */
export function planeMark(engine, stage) {
  const box = boxOf(engine);
  const mover = new Mover(engine, box);
  live(stage, () => {
    if (!engine.state.value.plane) mover.forget();
  });
  const knob = createHandle(engine, stage, { name: 'Cutting plane', kind: 'plane-knob', ...mover.sliding() });
  const tip = createHandle(engine, stage, {
    name: 'Direction of the cutting plane',
    kind: 'plane-tip',
    ...mover.turning(),
  });
  return {
    handles: [knob.knob, tip.knob],
    shown: () => box.value !== null && engine.state.value.plane !== null,
    draw(pen) {
      const [plane, bounds] = [engine.state.value.plane, box.value];
      if (!plane || !bounds) return;
      const section = sectionOf(bounds, plane);
      if (section.length) pen.polygon(section, 'section-line');
      const base = mover.baseOf(plane, bounds);
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

/** Moves and turns the plane as its handles are dragged. */
class Mover {
  #engine;
  #box;
  /** Point near the knob, if the plane was turned in the picture. @type {Vec3 | null} */
  #pivot = null;
  /** The plane at the start of a drag. @type {CuttingPlane | null} */
  #before = null;
  /** The place of its knob at that time. @type {Vec3} */
  #base = [0, 0, 0];

  /** @param {Engine} engine @param {ReadonlySignal<Bounds | null>} box */
  constructor(engine, box) {
    this.#engine = engine;
    this.#box = box;
  }

  /** Forgets the pivot of a plane that no longer exists. */
  forget() {
    this.#pivot = null;
  }

  /**
   * Returns the place of the knob: the pivot or the centre of the box, projected to the plane.
   * @param {CuttingPlane} plane
   * @param {Bounds} bounds
   */
  baseOf({ normal, offset }, bounds) {
    const near = this.#pivot ?? centreOf(bounds);
    return along(near, normal, offset - dot(normal, near));
  }

  /** Returns the drag of the knob, which moves the plane along its normal within the box. */
  sliding() {
    /** The last place of the pointer along the normal. @type {number | null} */
    let last = null;
    return {
      grab: (/** @type {Ray} */ ray) => {
        const plane = this.#grab();
        if (plane) last = placeAlong(ray, this.#base, plane.normal);
      },
      drag: (/** @type {Ray} */ ray, /** @type {boolean} */ fine) => {
        const { plane } = this.#engine.state.peek();
        if (!plane) return;
        const at = placeAlong(ray, this.#base, plane.normal);
        if (at !== null && last !== null) this.#move((at - last) * (fine ? FINE : 1), { live: true });
        last = at;
      },
      drop: this.#drop,
      cancel: this.#cancel,
      press: (/** @type {number} */ presses, /** @type {boolean} */ fine) =>
        this.#move(presses * KEY_SHARE * (fine ? FINE : 1), { ofBox: true }),
    };
  }

  /**
   * Returns the drag of the arrow's tip, which turns the plane about its knob. The panel has sliders for both angles.
   */
  turning() {
    let [radius, isFar] = [0, false];
    return {
      grab: (/** @type {Ray} */ { direction }) => {
        const plane = this.#grab();
        const spot = this.#engine.project(this.#base);
        if (!plane || !spot) return;
        radius = ARROW_PX * spot.perPx;
        isFar = dot(plane.normal, direction) > 0;
        this.#pivot = this.#base;
      },
      drag: (/** @type {Ray} */ ray) => {
        if (!this.#before || !(radius > 0)) return;
        const normal = directionOnSphere(ray, this.#base, radius, isFar);
        this.#engine.setPlane({ normal, offset: dot(normal, this.#base) }, { live: true });
      },
      drop: this.#drop,
      cancel: this.#cancel,
      press: null,
    };
  }

  #grab() {
    const [plane, bounds] = [this.#engine.state.peek().plane, this.#box.peek()];
    this.#before = plane;
    if (plane && bounds) this.#base = this.baseOf(plane, bounds);
    return bounds && plane;
  }

  /** Ends a drag and keeps the plane. */
  #drop = () => this.#engine.setPlane(this.#engine.state.peek().plane);

  #cancel = () => {
    if (this.#before) this.#engine.setPlane(this.#before);
  };

  /**
   * @param {number} by  a length, or a share of the way through the box
   * @param {{ ofBox?: boolean, live?: boolean }} [how]
   */
  #move(by, { ofBox = false, live = false } = {}) {
    const [plane, bounds] = [this.#engine.state.peek().plane, this.#box.peek()];
    if (!plane || !bounds) return;
    const [low, high] = extentOf(bounds, plane.normal);
    const offset = clamp(plane.offset + by * (ofBox ? high - low : 1), low, high);
    this.#engine.setPlane({ ...plane, offset }, { live });
  }
}
