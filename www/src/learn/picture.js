/**
 * A picture of particles, drawn by the page's own 2-D painter at twice its size, so that the browser smooths the edges.
 * A page of figures would run out of graphics contexts.
 */
import { signal } from '@preact/signals-core';
import { clamp, distance } from '../engine/vector.js';
import { axes, Camera, projected, viewOf } from '../engine/view/camera.js';
import { anglesOf } from '../engine/view/facing.js';
import { rgbFromPacked } from '../engine/view/oklab.js';
import { Painter } from '../engine/view/painter.js';
import { PALETTES, RAMP } from '../engine/view/palettes.js';
import { endsWith, h, live, reducedMotion } from '../ui/dom.js';
import '../ui/theme.js';
import { bedDepths } from './beds.js';
import { Fit } from './fit.js';
import { frontNormal, shareFacing } from './front.js';

/**
 * @import { LessonParticles, Signal } from '../engine/types.js'
 * @import { Palette, View } from '../engine/view/types.js'
 * @import { Discs, Mark, Scene, ScorePlace } from './types.js'
 */

const KEY_STEP_RAD = 0.14;
const KEY_ZOOM = 1.2;
/** How many times nearer or farther than a fit the eye may be. @type {readonly [number, number]} */
const ZOOMS = [0.1, 30];
/** Radians per drag over a picture's whole height. */
const DRAG_RAD = 3.4;
/** A press that moves by less, in pixels, chooses something. */
const PRESS_PX = 5;
/** The camera follows a level if a smaller share of it faces the camera. */
const IN_SIGHT = 0.35;
/** Height of a printed picture, divided by its width. */
const PAPER = 0.6;
/** Radius of the ring around a particle, divided by its own. */
const AROUND = 1.6;
/** Canvas pixels per page pixel. */
const FINENESS = 2;

const dark = matchMedia('(prefers-color-scheme: dark)');
/** Paper is white in either theme. */
const printing = signal(false);
const isDark = signal(false);
const followTheme = () => {
  const { theme } = document.documentElement.dataset;
  isDark.value = theme ? theme === 'dark' : dark.matches;
};
followTheme();
dark.addEventListener('change', followTheme);
addEventListener('beforeprint', () => {
  printing.value = true;
});
addEventListener('afterprint', () => {
  printing.value = false;
});

/** A camera shared by one or more pictures. Its rays are parallel, so that discs have the same size everywhere. */
export class Orbit {
  #camera = new Camera();
  #home = { yaw: 0, pitch: 0 };
  #fit = new Fit([{ positions: new Float32Array(3), radii: Float32Array.of(1) }]);
  /** How many times nearer the eye is than for a fit. */
  #zoom = 1;
  #frame = 0;
  /** Number of changes. */
  turned = signal(0);

  /** @param {number} yawRad @param {number} pitchRad */
  orbit(yawRad, pitchRad) {
    this.#camera.rest();
    this.#camera.orbit(yawRad, pitchRad);
    this.#hasTurned();
  }

  /** Moves nearer by a factor, within limits. @param {number} factor */
  zoom(factor) {
    this.#zoom = clamp(this.#zoom * factor, ...ZOOMS);
    this.#hasTurned();
  }

  /** `peek`, so that an effect that turns the camera does not depend on its turning. */
  #hasTurned() {
    this.turned.value = this.turned.peek() + 1;
  }

  /** Rotates to a side of the surface. @param {readonly number[]} normal of that side */
  turnTo(normal) {
    const camera = this.#camera;
    camera.calm = reducedMotion();
    camera.turnTo(anglesOf(normal, camera.state.yaw));
    let lastMs = performance.now();
    const frame = (/** @type {number} */ nowMs) => {
      const goesOn = camera.step(Math.max(0, nowMs - lastMs) / 1000);
      lastMs = nowMs;
      this.#hasTurned();
      this.#frame = goesOn ? requestAnimationFrame(frame) : 0;
    };
    cancelAnimationFrame(this.#frame);
    frame(lastMs);
  }

  /** Looks at the side where the front begins, also after a reset. @param {LessonParticles} particles */
  faceFront(particles) {
    this.#home = anglesOf(frontNormal(particles));
    this.reset();
  }

  /**
   * Follows the front: rotates if the discs of a level face away.
   * @param {LessonParticles} particles @param {number} level
   */
  follow(particles, level) {
    const { forward } = axes(this.#camera.state);
    if (shareFacing(particles, forward, level, level) < IN_SIGHT) this.turnTo(frontNormal(particles, level, level));
  }

  /** Fits the pictures to bodies once these are known. @param {readonly Discs[]} bodies */
  fitTo(...bodies) {
    const drawn = bodies.filter(({ radii }) => radii.length > 0);
    if (drawn.length === 0) return;
    this.#fit = new Fit(drawn);
    this.#zoom = 1;
    this.#hasTurned();
  }

  reset() {
    this.#camera.set({ ...this.#camera.state, ...this.#home });
    this.#zoom = 1;
    this.#hasTurned();
  }

  /** The view for a picture of this size. @param {{ width: number, height: number }} size */
  view({ width, height }) {
    const { yaw, pitch } = this.#camera.state;
    const { ball, distance } = this.#fit.in(pitch, { width, height });
    const state = { yaw, pitch, target: ball.centre, distance: distance / this.#zoom, fit: true };
    return viewOf(state, width, height, ball, undefined, true);
  }
}

export class Picture {
  #name;

  /** @type {((particle: number) => void) | null} */
  #onPick;
  #canvas;
  #size;
  #frame;
  /**
   * The last scene with computed depths of its beds.
   * @type {{ scene: Scene, depths: Float32Array | null } | null}
   */
  #bedded = null;

  /**
   * @param {Orbit} orbit
   * @param {{ name: string }} about  `name`: of the picture, for screen readers
   */
  constructor(orbit, { name }) {
    this.orbit = orbit;
    this.#name = name;
    this.#onPick = null;
    /** @type {Signal<Scene | null>} */
    this.scene = signal(null);
    /** The place with a ring around it. @type {Signal<ScorePlace | null>} */
    this.ringed = signal(null);
    this.#canvas = h('canvas', { class: 'picture-canvas' });
    this.element = h('div', { class: 'picture', role: 'application', tabindex: 0 }, this.#canvas);
    this.pickWith(null);
    const context = this.#canvas.getContext('2d');
    this.painter = context ? new Painter(this.#canvas, context) : null;
    this.#size = signal({ width: 0, height: 0 });
    this.#frame = 0;
    const observer = new ResizeObserver(() => this.#measure());
    observer.observe(this.element);
    endsWith(this.element, () => observer.disconnect());
    live(this.element, () => {
      void [this.scene.value, this.ringed.value, this.#size.value, this.orbit.turned.value, isDark.value];
      // Printing cannot wait for a frame.
      if (printing.value) this.#draw();
      else this.#ask();
    });
    this.#listen();
  }

  /** @param {((particle: number) => void) | null} onPick */
  pickWith(onPick) {
    this.#onPick = onPick;
    const keys = onPick ? 'Arrow keys turn it, Enter chooses the particle in the middle.' : 'Arrow keys turn it.';
    this.element.setAttribute('aria-label', `${this.#name}. ${keys}`);
  }

  #measure() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const old = this.#size.peek();
    if (width !== old.width || height !== old.height) this.#size.value = { width, height };
  }

  #ask() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#draw();
    });
  }

  /** @param {Scene} scene */
  show(scene) {
    this.scene.value = scene;
  }

  /** The size to draw. Printed pictures all have the same shape. */
  #room() {
    const { width, height } = this.#size.peek();
    return { width, height: printing.peek() && height > 0 ? PAPER * width : height };
  }

  #view() {
    return this.orbit.view(this.#room());
  }

  #draw() {
    const scene = this.scene.peek();
    const { width, height } = this.#room();
    if (!scene || !this.painter || width === 0 || height === 0) return;
    const { painter } = this;
    const { particles } = scene;
    const palette = PALETTES[isDark.peek() && !printing.peek() ? 'dark' : 'light'];
    const background = [...rgbFromPacked(palette.ground), 1];
    const [w, high] = [width * FINENESS, height * FINENESS];
    if (painter.width !== w || painter.height !== high) painter.resize(w, high);
    const { positions, normals, radii, levels } = particles;
    painter.write(0, positions, normals, radii, levels, scene.colours(palette), -Infinity);
    const count = scene.count ?? radii.length;
    let body = radii.length;
    painter.bedDepths = this.#depths(scene);
    if (scene.body) {
      const { positions, normals, radii, levels } = scene.body;
      painter.write(count, positions, normals, radii, levels, new Uint32Array(radii.length), -Infinity);
      body = count + radii.length;
    }
    painter.set_count(count, body);
    const colour = rgbFromPacked(palette.body);
    painter.set_style(JSON.stringify({ background, dim_backfaces: 1, body: { colour, is_open: !scene.isClosed } }));
    const view = this.#view();
    painter.set_view(view.packed);
    // The background is left out, so that the page or the paper shows through.
    painter.draw(0, true, Infinity);
    const { places = [], normal = [], radius = 0 } = this.ringed.peek() ?? {};
    // The largest hole gets its empty circle; of a pair both particles are ringed.
    const isHole = places.length === 1;
    const rings = places.map((place) => ({ place, normal, radius, isHole, kind: /** @type {const} */ ('ring') }));
    this.#drawMarks(painter.context, [...(scene.marks ?? []), ...rings], view);
    this.element.dataset.drawn = String(scene.count ?? radii.length);
  }

  /** The depths of a scene's beds, computed once. @param {Scene} scene */
  #depths(scene) {
    const { particles, count = particles.radii.length, body = null } = scene;
    if (this.#bedded?.scene !== scene) {
      // The body follows the discs, replacing the particles without discs.
      const own = body ? rangeOf(particles, 0, count) : particles;
      this.#bedded = { scene, depths: bedDepths(own, count, body) };
    }
    return this.#bedded.depths;
  }

  /** @param {CanvasRenderingContext2D} context @param {readonly Mark[]} marks @param {View} view */
  #drawMarks(context, marks, view) {
    const style = getComputedStyle(this.element);
    let rings = 0;
    context.lineWidth = 2 * FINENESS;
    for (const { place, to, normal, radius, kind, isHole = false } of marks) {
      const at = projected(view, place);
      if (!at || !isFacing(view.eye, place, normal)) continue;
      const [x, y] = [at.x * FINENESS, at.y * FINENESS];
      const r = Math.max(6, ((isHole ? 1 : AROUND) * radius) / at.perPx) * FINENESS;
      context.strokeStyle = style.getPropertyValue(kind === 'ring' ? '--mark' : '--mark-own') || style.color;
      context.beginPath();
      const end = to && projected(view, to);
      if (kind === 'arrow') {
        if (end) drawArrow(context, [x, y], [end.x * FINENESS, end.y * FINENESS]);
        continue;
      }
      if (kind === 'ring') {
        context.arc(x, y, r, 0, 2 * Math.PI);
        rings += 1;
      } else {
        context.moveTo(x - r, y);
        context.lineTo(x + r, y);
        context.moveTo(x, y - r);
        context.lineTo(x, y + r);
      }
      context.stroke();
    }
    this.element.dataset.rings = String(rings);
  }

  /** The particle under a point of the picture; null without one. @param {number} xPx @param {number} yPx */
  #pick(xPx, yPx) {
    const scene = this.scene.peek();
    if (!scene) return null;
    const { positions, normals, radii } = scene.particles;
    const view = this.#view();
    let best = null;
    let least = Infinity;
    for (let i = 0; i < radii.length; i += 1) {
      const place = positions.subarray(3 * i, 3 * i + 3);
      const at = projected(view, place);
      if (!at || !isFacing(view.eye, place, normals.subarray(3 * i, 3 * i + 3))) continue;
      const far = Math.hypot(at.x - xPx, at.y - yPx) * at.perPx;
      // Of several particles under the point the frontmost is chosen, and on its sheet the nearest.
      const cost = distance(view.eye, place) + 2 * far;
      if (far < 2 * radii[i] && cost < least) [best, least] = [i, cost];
    }
    return best;
  }

  #listen() {
    const { element, orbit } = this;
    /** @type {{ x: number, y: number, moved: number } | null} */
    let held = null;
    element.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      held = { x: event.clientX, y: event.clientY, moved: 0 };
      element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', ({ clientX, clientY }) => {
      if (!held) return;
      const [dx, dy] = [clientX - held.x, clientY - held.y];
      held = { x: clientX, y: clientY, moved: held.moved + Math.abs(dx) + Math.abs(dy) };
      const scale = DRAG_RAD / Math.max(1, this.#size.peek().height);
      if (held.moved > PRESS_PX) orbit.orbit(dx * scale, dy * scale);
    });
    element.addEventListener('pointerup', ({ clientX, clientY }) => {
      const isPress = held !== null && held.moved <= PRESS_PX;
      held = null;
      const box = element.getBoundingClientRect();
      if (isPress) this.#choose(clientX - box.left, clientY - box.top);
    });
    element.addEventListener('pointercancel', () => {
      held = null;
    });
    element.addEventListener('dblclick', () => {
      if (!this.#onPick) orbit.reset();
    });
    element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.#press(event.key)) return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /** @param {number} x @param {number} y */
  #choose(x, y) {
    const found = this.#onPick ? this.#pick(x, y) : null;
    if (found !== null) this.#onPick?.(found);
  }

  /** @param {string} key @returns whether the key means something here */
  #press(key) {
    const { orbit } = this;
    /** @type {Record<string, [number, number]>} */
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const turn = turns[key];
    if (turn) orbit.orbit(turn[0] * KEY_STEP_RAD, turn[1] * KEY_STEP_RAD);
    else if (key === '+' || key === '=') orbit.zoom(KEY_ZOOM);
    else if (key === '-' || key === '_') orbit.zoom(1 / KEY_ZOOM);
    else if (key === 'Enter' && this.#onPick) this.#choose(this.#size.peek().width / 2, this.#size.peek().height / 2);
    else return false;
    return true;
  }
}

/** Length and width of an arrow's head, divided by the arrow's length. */
const HEAD = [0.28, 0.16];

/** @param {CanvasRenderingContext2D} context @param {readonly number[]} from @param {readonly number[]} to */
function drawArrow(context, [x, y], [endX, endY]) {
  const [dx, dy] = [endX - x, endY - y];
  const [back, aside] = HEAD;
  context.lineWidth = FINENESS;
  context.moveTo(x, y);
  context.lineTo(endX, endY);
  context.moveTo(endX - back * dx - aside * dy, endY - back * dy + aside * dx);
  context.lineTo(endX, endY);
  context.lineTo(endX - back * dx + aside * dy, endY - back * dy - aside * dx);
  context.stroke();
  context.lineWidth = 2 * FINENESS;
}

/**
 * The particles of a run from one number on, up to another.
 * @param {LessonParticles} all @param {number} first @param {number} [end]
 */
export const rangeOf = (all, first, end = all.radii.length) => ({
  ...all,
  positions: all.positions.subarray(3 * first, 3 * end),
  normals: all.normals.subarray(3 * first, 3 * end),
  radii: all.radii.subarray(first, end),
  levels: all.levels.subarray(first, end),
});

/** @param {readonly number[]} eye @param {ArrayLike<number>} place @param {ArrayLike<number>} normal */
const isFacing = (eye, place, normal) => [0, 1, 2].reduce((sum, k) => sum + (eye[k] - place[k]) * normal[k], 0) > 0;

/**
 * Colours by generation level.
 * @param {LessonParticles} particles
 * @param {number} [last]  last level of the run, if the particles are a part of it
 */
export const byLevel = ({ levels }, last = levels.reduce((most, level) => Math.max(most, level), 0)) =>
  once((palette) => {
    const colours = palette.levels(last);
    return Uint32Array.from(levels, (level) => colours[level]);
  });

/**
 * Colours by a number per particle, from `low` to `high`.
 * @param {ArrayLike<number>} values
 * @param {number} low
 * @param {number} high
 */
export const byValue = (values, low, high) =>
  once((palette) =>
    Uint32Array.from(values, (value) => {
      const at = (value - low) / (high - low || 1);
      return palette.sequential[Math.round(Math.min(1, Math.max(0, at)) * (RAMP - 1))];
    }),
  );

/** Marks particles with fewer or more than six neighbours. @param {Uint8Array} valence */
export const byNeighbours = (valence) =>
  once(({ valence: { five, six, seven } }) =>
    Uint32Array.from(valence, (count) => (count === 6 || count === 0 ? six : count < 6 ? five : seven)),
  );

/** Computes the colours of each palette once. @param {(palette: Palette) => Uint32Array} colours */
function once(colours) {
  /** @type {Map<Palette, Uint32Array>} */
  const known = new Map();
  return (/** @type {Palette} */ palette) => {
    const made = known.get(palette) ?? colours(palette);
    known.set(palette, made);
    return made;
  };
}
