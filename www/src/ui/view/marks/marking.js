/**
 * Marks edges of a mesh by hand: the edge under the pointer is shown, with the chain in which it goes on, and a press
 * keeps it sharp or no longer. The surface is sampled anew after every press.
 */
import { computed, signal, untracked } from '@preact/signals-core';
import { MOST_LINE_POINTS } from '../../../engine/constants.js';
import { dot } from '../../../engine/vector.js';
import { button } from '../../button.js';
import { h, live } from '../../dom.js';
import { explain } from '../../explain.js';
import { formatFixed, plural } from '../../format.js';
import { createSegmented } from '../../segmented.js';
import { aimOf } from './aim.js';
import { MeshEdges } from './mesh-edges.js';

/**
 * @import { Engine, Signal, Vec3 } from '../../../engine/types.js'
 * @import { Hands } from '../../types.js'
 * @import { Mark, Point } from '../types.js'
 */

/** Largest distance of the pointer from an edge: of a mouse, and of a finger. */
const REACH_PX = { fine: 12, coarse: 24 };
/** Angle of edges that is preset, in degrees, as in src/remesh/mod.rs. */
const USUAL_ANGLE = 30;
/** Angles above the chosen one by less than this are not said to be kept, because of rounding. */
const ROUNDING = 0.01;
const DEGREES = 180 / Math.PI;

export class Marker {
  #engine;
  on;
  /** The edges of the mesh; null until they are there. @type {Signal<MeshEdges | null>} */
  mesh = signal(null);
  /** The edge under the pointer. @type {Signal<number | null>} */
  hot = signal(null);
  /** Whether a press means the whole chain. */
  extent = signal(/** @type {'chain' | 'edge'} */ ('chain'));
  /** What the last press did instead of marking. */
  said = signal('');
  marked;
  /** The edges that a press now means. */
  meant;
  /** The angle from which edges are kept anyway, in degrees; infinite if none is. */
  #angle;

  /** @param {Engine} engine @param {Signal<boolean>} on */
  constructor(engine, on) {
    this.#engine = engine;
    this.on = on;
    const lines = computed(() => engine.state.value.lines);
    this.#angle = computed(() => {
      const { mesh } = engine.field.value ?? {};
      const { edges = USUAL_ANGLE } = engine.state.value.parameters;
      return (mesh?.part || mesh?.union) && edges > 0 ? edges : Infinity;
    });
    this.marked = computed(() => this.mesh.value?.edgesOf(lines.value) ?? new Set());
    this.meant = computed(() => {
      const [mesh, edge] = [this.mesh.value, this.hot.value];
      if (!mesh || edge === null) return new Set();
      return this.extent.value === 'chain' ? mesh.chainOf(edge) : new Set([edge]);
    });
  }

  /** Whether an edge stays sharp without a mark. @param {MeshEdges} mesh @param {number} edge */
  isKept(mesh, edge) {
    return Math.abs(mesh.angleAt(edge)) * DEGREES > this.#angle.value + ROUNDING;
  }

  /** Fetches the mesh. */
  async load() {
    this.mesh.value = null;
    this.hot.value = null;
    this.said.value = '';
    if (!this.on.peek()) return;
    const faces = await this.#engine.meshFaces();
    if (!this.on.peek()) return;
    if (faces) this.mesh.value = new MeshEdges(faces);
    else this.said.value = 'The mesh is not there: open its file again';
  }

  /**
   * Shows the edge at a place in the picture. A press marks it, or removes its mark.
   * @param {Point} at @param {boolean} tapped
   */
  notices(at, tapped) {
    if (!this.on.peek()) return false;
    this.said.value = '';
    this.hot.value = this.#edgeAt(at);
    if (tapped && this.hot.value !== null) this.#press(this.hot.value);
    return true;
  }

  noticeMiddle() {
    const middle = this.#engine.project(this.#engine.state.peek().view.camera.target);
    if (middle) this.notices(middle, false);
  }

  /** Returns what says of a place whether neither the cutting plane nor the box hides it. */
  shows() {
    const { plane } = this.#engine.state.peek();
    const box = this.#engine.field.peek()?.bounds;
    return (/** @type {Vec3} */ p) =>
      !(plane && dot(plane.normal, p) > plane.offset) &&
      (!box || p.every((v, k) => v >= box.min[k] && v <= box.max[k]));
  }

  /** @param {Point} at */
  #edgeAt(at) {
    const [engine, mesh] = [this.#engine, this.mesh.peek()];
    if (!mesh) return null;
    const most = matchMedia('(pointer: coarse)').matches ? REACH_PX.coarse : REACH_PX.fine;
    const isShown = this.shows();
    // Beside its outline the mesh is met a little farther inside.
    const steps = [
      [0, 0],
      ...[-1, 1].flatMap((way) => [
        [way * 0.5 * most, 0],
        [0, way * 0.5 * most],
      ]),
    ];
    for (const [x, y] of steps) {
      const ray = engine.rayThrough(at.x + x, at.y + y);
      const face = mesh.faceAt(ray, isShown);
      if (face !== null)
        return mesh.edgeNear(face, at, { most, eye: ray.eye, project: (place) => engine.project(place) });
    }
    return null;
  }

  /** @param {number} edge */
  #press(edge) {
    const mesh = this.mesh.peek();
    if (!mesh) return;
    const isMarked = this.marked.peek().has(edge);
    const next = new Set(this.marked.peek());
    for (const other of this.meant.peek()) {
      if (isMarked) next.delete(other);
      else if (!this.isKept(mesh, other)) next.add(other);
    }
    const lines = mesh.linesOf(next);
    if (lines.flat().length > MOST_LINE_POINTS) this.said.value = `Lines of ${MOST_LINE_POINTS} points are the most`;
    else if (isMarked || next.size > this.marked.peek().size) this.#engine.setLines(lines);
  }

  /** What the pointer is at, in words. */
  get text() {
    const { mesh, hot, said, meant, marked, extent } = this;
    if (!this.on.value) return '';
    if (said.value) return said.value;
    // Such as that a mesh with holes has no sharp edges.
    const { value: wrong } = this.#engine.fieldError;
    if (wrong) return `${wrong.message.charAt(0).toUpperCase()}${wrong.message.slice(1)}`;
    if (!mesh.value) return 'Reading the mesh';
    const count = marked.value.size;
    if (hot.value === null) return count > 0 ? `${plural(count, 'edge')} marked` : 'Press an edge to keep it sharp';
    const angle = `${formatFixed(Math.abs(mesh.value.angleAt(hot.value)) * DEGREES, 0)}°`;
    const what = extent.value === 'chain' ? `${plural(meant.value.size, 'edge')}, ${angle}` : `An edge, ${angle}`;
    if (marked.value.has(hot.value)) return `${what}: marked`;
    return this.isKept(mesh.value, hot.value) ? `${what}: sharp by its angle` : `${what}: not sharp yet`;
  }

  /** The options of the command line that mark the same edges. */
  get options() {
    const lines = this.#engine.state.peek().lines;
    return lines.map((line) => `--mesh-line "${line.map((point) => point.join(',')).join(' ')}"`).join(' ');
  }
}

/**
 * @param {Engine} engine
 * @param {{ stage: HTMLElement, host: HTMLElement, marker: Marker } & Omit<Hands, 'marking'>} parts
 * @returns {Mark}
 */
export function markMark(engine, { stage, host, marker, pins, brush }) {
  const { on, mesh, hot } = marker;
  const aim = aimOf(engine, [host]);
  live(stage, () => void stage.toggleAttribute('data-marking', on.value));
  // A press on the surface has one meaning at a time.
  live(stage, () => {
    if (on.value)
      untracked(() => {
        pins.value = null;
        brush.on.value = false;
        if (engine.state.value.view.measured) engine.setView({ measured: null });
        engine.dismissHover();
      });
    void marker.load();
  });
  live(stage, () => {
    const isOther = pins.value !== null || brush.on.value || engine.state.value.view.measured !== null;
    const field = engine.field.value;
    if (isOther || engine.loading.value || (field && (!field.mesh || field.formula !== ''))) on.value = false;
  });
  // By keyboard the edge in the middle is meant; it changes as the picture turns.
  const isKeyed = () => on.peek() && host.matches(':focus-visible');
  const notice = () => {
    if (isKeyed()) marker.noticeMiddle();
  };
  live(stage, () => {
    void [engine.frame.value, mesh.value];
    untracked(notice);
  });
  host.addEventListener('focus', notice);
  for (const type of ['pointerleave', 'pointerdown', 'blur'])
    host.addEventListener(type, () => {
      hot.value = null;
    });
  return {
    shown: () => on.value,
    draw(pen) {
      const edges = mesh.value;
      if (!edges) return;
      const isShown = marker.shows();
      for (const [kind, some] of /** @type {const} */ ([
        ['hot', marker.meant.value],
        ['kept', marker.marked.value],
      ]))
        for (const edge of some) {
          const ends = edges.placesOf(edge);
          if (!ends.every(isShown)) continue;
          const [p, q] = ends.map((place) => engine.project(place));
          if (p && q) pen.line(p, q, edges.isSeen(edge, engine.rayThrough(p.x, p.y).eye) ? kind : `${kind} behind`);
        }
      aim(pen);
    },
  };
}

/** Creates the card that says which edge is meant, and has the choices. @param {Marker} marker */
export function createMarkCard(marker) {
  const { on, extent, marked, said } = marker;
  const none = () => marked.value.size === 0;
  const choice = createSegmented({
    name: 'A press marks',
    choices: [
      { value: 'chain', label: 'Chain' },
      { value: 'edge', label: 'One edge' },
    ],
    value: () => extent.value,
    change: (value) => {
      extent.value = value;
    },
  });
  const copy = button(
    {
      class: 'small',
      off: none,
      press: async () => {
        try {
          await navigator.clipboard.writeText(marker.options);
          said.value = 'Options copied';
        } catch {
          said.value = 'The browser does not let the page copy';
        }
      },
    },
    'Copy',
  );
  const text = 'Copies the marked edges as options --mesh-line of the command line, for the same file.';
  const done = () => {
    on.value = false;
  };
  return h(
    'div',
    { class: 'tool-card mark-card', role: 'group', 'aria-label': 'Mark edges', hidden: () => !on.value },
    h('span', { class: 'told', role: 'status' }, () => marker.text),
    h(
      'div',
      { class: 'brush-choice' },
      choice,
      explain(copy, () => ({ text })),
      button({ class: 'small', press: done }, 'Done'),
    ),
  );
}
