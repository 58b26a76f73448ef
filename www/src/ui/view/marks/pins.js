/**
 * Pins: points of the surface that are dragged, or held while others are. The parameters follow (Witkin and Heckbert
 * 1994, §3); a model, which has no parameters, is deformed around them.
 */
import { batch } from '@preact/signals-core';
import { MOST_PULLS } from '../../../engine/constants.js';
import { canGrab, endOf, pullBetween } from '../../../engine/pulls.js';
import { along, distance, dot, nearest, triple } from '../../../engine/vector.js';
import { button } from '../../button.js';
import { h, live } from '../../dom.js';
import { towardEye } from '../../space.js';
import { createHandle } from './handle.js';

/**
 * @import { Engine, Grip, Pull, Ray, Vec3 } from '../../../engine/types.js'
 * @import { Pins } from '../../types.js'
 * @import { Mark } from '../types.js'
 */

/** Largest number of pins: more than most formulas have parameters. */
const MOST_PINS = 6;
/** Length of a pin's move by an arrow key, in particle radii, and the factor with Shift. */
const KEY_RADII = 1;
const FINE = 0.1;
/** Default reach of a pull on a model, as a share of the diagonal of its box. */
const REACH = 0.15;
/** Distance, as a share of that diagonal, within which a pin is at the end of a pull, which its drag then continues. */
const SAME = 1e-4;

/** @param {Engine} engine @param {HTMLElement} stage @param {Pins} pins @returns {Mark} */
export function pinMark(engine, stage, pins) {
  const hand = new Hand(engine, pins);
  const handles = Array.from({ length: MOST_PINS }, (_, k) => {
    const handle = createHandle(engine, stage, {
      name: `Pin ${k + 1}, along the normal`,
      kind: 'pin',
      grab: () => hand.grab(k),
      drag: (ray) => hand.drag(ray),
      drop: () => {
        if (!hand.drop()) hand.takeOff(k);
      },
      cancel: () => hand.cancel(),
      press: (presses, fine) => hand.push(k, presses * KEY_RADII * (fine ? FINE : 1)),
    });
    handle.knob.addEventListener('keydown', (event) => {
      if (event.key === 'Delete' || event.key === 'Backspace') hand.takeOff(k);
    });
    return handle;
  });
  stage.addEventListener('keydown', (event) => hand.escape(event), true);
  live(stage, () => hand.follow());
  live(stage, () => void stage.toggleAttribute('data-grabs', pins.value !== null));
  return {
    handles: handles.map(({ knob }) => knob),
    take: (at, shift) => hand.take(at, shift),
    shown: () => pins.value !== null,
    draw() {
      const places = pins.value ?? [];
      for (const [k, { put, tell }] of handles.entries()) {
        put(places[k] ? engine.project(places[k]) : null);
        tell(0, -1, 1, 'Arrow keys pull it out or push it in, Delete takes it off');
      }
    },
  };
}

/**
 * The state at the start of a drag; `diagonal`: of the box.
 * @typedef {{
 *   parameters: Record<string, number>, pulls: readonly Pull[], diagonal: number, pins: readonly Vec3[],
 * }} Start
 */

/** Pulls one pin at a time. */
class Hand {
  #engine;
  #pins;
  /** The pin that is dragged, and whether it is removed when it is released. */
  #held = 0;
  #isFleeting = false;
  /** Whether the drag began in the picture. */
  #isTaken = false;
  /** The state at the start of the drag. @type {Start} */
  #start = { parameters: {}, pulls: [], diagonal: 0, pins: [] };
  /** Wanted places of the pins; null until the first motion. @type {readonly Vec3[] | null} */
  #wanted = null;
  /** The field to which the pins belong, and the result of the last pull. */
  #of = '';
  /** @type {Grip | null} */
  #grip = null;

  /** @param {Engine} engine @param {Pins} pins */
  constructor(engine, pins) {
    this.#engine = engine;
    this.#pins = pins;
  }

  /**
   * Grabs the particle under a place in the picture; with Shift its pin lasts for this drag only.
   * @param {{x: number, y: number}} at @param {boolean} shift
   */
  take(at, shift) {
    const [engine, pins] = [this.#engine, this.#pins.peek() ?? []];
    const isOn = this.#pins.peek() !== null;
    if (!(isOn || shift) || !canGrab(engine.field.peek()) || pins.length === MOST_PINS) return null;
    const index = engine.pick(at.x, at.y);
    if (index === null) return null;
    this.#pins.value = [...pins, triple(engine.columns.shown, index)];
    this.#of = fieldOf(engine);
    this.grab(pins.length);
    this.#isFleeting = !isOn;
    this.#isTaken = true;
    return {
      drag: (/** @type {{x: number, y: number}} */ { x, y }) => {
        if (this.#isTaken) this.drag(engine.rayThrough(x, y));
      },
      drop: () => {
        if (this.#isTaken) this.drop();
        this.#isTaken = false;
      },
    };
  }

  /** Cancels the drag of a particle, if any. @param {KeyboardEvent} event */
  escape(event) {
    if (event.key !== 'Escape' || !this.#isTaken) return;
    event.stopPropagation();
    this.#isTaken = false;
    this.cancel();
    if (this.#isFleeting) this.#pins.value = null;
  }

  /** @param {number} k */
  grab(k) {
    this.#held = k;
    this.#isFleeting = false;
    const { parameters, pulls } = this.#engine.state.peek();
    const box = this.#engine.field.peek()?.bounds;
    const diagonal = box ? distance(box.min, box.max) : 0;
    this.#start = { parameters, pulls, diagonal, pins: this.#pins.peek() ?? [] };
    this.#wanted = null;
  }

  /** Moves the pin in the plane through it that faces the camera. @param {Ray} ray */
  drag({ eye, direction }) {
    const place = this.#start.pins[this.#held];
    const facing = towardEye(this.#engine.state.peek().view.camera);
    const t = dot(along(place, eye, -1), facing) / dot(direction, facing);
    if (Number.isFinite(t) && t > 0) this.#pull(along(eye, direction, t), true);
  }

  /** @param {Vec3} to @param {boolean} live */
  #pull(to, live) {
    this.#wanted = this.#start.pins.map((pin, k) => (k === this.#held ? to : pin));
    this.#go(this.#wanted, live);
  }

  /** Deforms the surface towards the wanted pins. @param {readonly Vec3[]} wanted @param {boolean} live */
  #go(wanted, live) {
    const [engine, { parameters }] = [this.#engine, this.#start];
    if (!engine.field.peek()?.model) return engine.pull(parameters, wanted, { live });
    const { pulls, pins } = pulled(this.#start, this.#held, wanted[this.#held]);
    batch(() => {
      engine.setPulls(pulls, { live });
      this.#pins.value = pins;
      this.#of = fieldOf(engine);
    });
  }

  /** @returns whether the pin was moved */
  drop() {
    const wanted = this.#wanted;
    this.#wanted = null;
    if (wanted) this.#go(wanted, false);
    if (this.#isFleeting) this.#pins.value = null;
    return wanted !== null;
  }

  cancel() {
    this.#wanted = null;
    this.#go(this.#start.pins, false);
  }

  /** Moves a pin along the normal by some particle radii. @param {number} k @param {number} radii */
  push(k, radii) {
    this.grab(k);
    const { columns } = this.#engine;
    const near = nearest(columns.positions, columns.count, this.#start.pins[k])?.index ?? 0;
    this.#pull(along(this.#start.pins[k], triple(columns.normals, near), radii * columns.radii[near]), false);
    this.#wanted = null;
  }

  /** @param {number} k */
  takeOff(k) {
    this.#pins.value = (this.#pins.peek() ?? []).filter((_, other) => other !== k);
  }

  /** Moves the pins to the surface; removes them if something else has changed the surface. */
  follow() {
    const grip = this.#engine.grip.value;
    const field = fieldOf(this.#engine);
    const pins = this.#pins.peek();
    const isNew = grip !== this.#grip;
    this.#grip = grip;
    if (!pins?.length) return;
    if (isNew && grip?.places.length === pins.length) {
      this.#pins.value = grip.places;
      this.#of = field;
    } else if (field !== this.#of) {
      this.#pins.value = [];
    }
  }
}

/**
 * Pulls a model's surface so that a pin comes as near to a place as the others allow. If that pin was pulled last, its
 * pull is continued.
 * @param {Start} start @param {number} k  of the pin @param {Vec3} to
 */
function pulled({ pulls, diagonal, pins }, k, to) {
  if (distance(pins[k], to) === 0) return { pulls, pins };
  const last = pulls.at(-1);
  const isSame = last !== undefined && distance(endOf(last), pins[k]) < SAME * diagonal;
  const before = isSame ? pulls.slice(0, -1) : pulls;
  if (before.length === MOST_PULLS) return { pulls, pins };
  const held = pins.filter((_, other) => other !== k);
  const pull = pullBetween(isSame ? last.at : pins[k], to, { reach: REACH * diagonal, held });
  return { pulls: [...before, pull], pins: pins.map((pin, other) => (other === k ? endOf(pull) : pin)) };
}

/** Returns a text that identifies a field. @param {Engine} engine */
function fieldOf({ field: { value: field }, state }) {
  const { surface, centres, pulls } = state.value;
  return JSON.stringify(field?.model ? [surface, centres, pulls] : field && [field.formula, field.parameters]);
}

/** Creates the card with the result of a pull. @param {Engine} engine @param {Pins} pins */
export function createPinCard(engine, pins) {
  const text = h('span', { role: 'status' }, () => {
    if (pins.value === null) return '';
    if (engine.state.value.pulls.length === MOST_PULLS) return `${MOST_PULLS} pulls are the most`;
    const grip = engine.grip.value;
    if (grip && pins.value.length > 0) {
      const names = grip.idle.join(', ');
      if (grip.idle.length === engine.field.value?.parameters.length) return 'No parameter moves the surface here';
      if (!grip.holds) return 'The ranges of the parameters end here';
      if (names) return `${names} cannot move it here`;
    }
    return 'Drag the surface. Click to pin a point';
  });
  const done = () => {
    pins.value = null;
  };
  return h(
    'div',
    { class: 'tool-card', hidden: () => pins.value === null },
    text,
    button({ class: 'small', press: done }, 'Done'),
  );
}
