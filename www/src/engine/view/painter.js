/**
 * Draws the surface on a 2-D canvas without a graphics API, if there is no graphics card or none is ready. Each disc is
 * an ellipse on the screen, filled pixel by pixel with the depth of its plane; spheres and faces are filled in the same
 * way. Creases and the clip box are lines one pixel wide. A picture with several samples is painted several times, each
 * time shifted by a fraction of a pixel, and shows their mean, which smooths all edges. Compared with a graphics card
 * it lacks domes, fading in, ambient occlusion, and the body's edge at the box.
 *
 * The class has the methods of the WebAssembly renderers, so that the viewer can treat them alike.
 *
 * @module
 */
import { grown, NO_LEVEL } from '../columns.js';
import { dot } from '../vector.js';
import { END } from './creases.js';
import { linear } from './oklab.js';
import { PaintedMesh } from './painted-mesh.js';
import { isBeyond } from './picking.js';
import { BALL_SIDE, fillBall, fillDisc, isHidden, overBall, POINT_PX, paintLine } from './raster.js';
import { PLACES, Samples } from './samples.js';
import { COLOUR, LIGHT, LINEAR, lightOn, lit, packed, rimOn, smoothstep, takeColour } from './shade.js';

/**
 * @import { Renderer } from '../../wasm/render-webgpu/render.js'
 * @import { PaintedDisc, PaintedScene, Pass, Style, Target } from './types.js'
 */

/** Radius of a dot for a particle on a crease, as a share of a disc's radius. */
const DOT = 0.5;
/** Distance, in radii, by which a crease is moved towards the eye, as in shaders/lines.wgsl. */
const CREASE_LIFT = 0.3;

/**
 * Work of one call of {@link Painter.draw}, in visited pixels: about 20 ms, so that a press is answered between calls.
 * The fixed work for a disc or a face counts as `WORK_OF_ONE` pixels.
 */
export const MOST_WORK = 2.5e6;
const WORK_OF_ONE = 20;

/** Radius on the screen above which a disc has a darker rim. */
const RIM_FROM_PX = 4;
/** Light that a rim loses. */
const RIM_SHADE = 0.14;
/** Share by which discs of earlier levels fade to the background, as in src/render/style.rs. */
const MUTE = 0.35;
// As in shaders/discs.wgsl.
const BED_RADIUS = 1.75;
const BED_SUNK = 0.22;
const BED_BEHIND = 0.4;
const OUTLINE_BED = /** @type {const} */ ([0.88, 0.15]);
const OPEN_OUTLINE_BED = /** @type {const} */ ([1.2, 0.6]);
const INSIDE_FROM = /** @type {const} */ ([0.15, 0.45]);
const TO_COME = 0.72;
const TO_COME_BEHIND = 0.2;
const LEAST_BED_PX = 0.8;
/**
 * Cosine of the viewing angle below which a bed is so small that it needs no extra depth along the line of sight.
 */
const LEAST_FACING = 0.5;
/** SWELL_PX in that shader. */
const GAPS_PX = /** @type {const} */ ([0.8, 2.4]);

/**
 * Returns the unit axes of the eye, and the screen displacement of a unit step to the right. The rows of
 * clip_from_world give them up to scale and up to the component along the view, which shifts the picture.
 * @param {Float32Array} m  a packed view
 */
function eyeAxes(m) {
  const forward = [m[19], m[20], m[21]];
  const axis = (/** @type {number} */ k) => {
    const v = [m[k], m[4 + k], m[8 + k]];
    const along = v[0] * forward[0] + v[1] * forward[1] + v[2] * forward[2];
    const u = v.map((c, i) => c - along * forward[i]);
    const length = Math.hypot(u[0], u[1], u[2]) || 1;
    return { length, unit: u.map((c) => c / length) };
  };
  const { unit: right, length: clipXPerWorld } = axis(0);
  return { right, up: axis(1).unit, forward, clipXPerWorld };
}

/**
 * Replaces a view with parallel rays, whose divisor w is 1 everywhere and carries no depth, by the view of a distant
 * eye. Returns other views unchanged.
 * @param {Float32Array} m  a packed view
 */
function seenFromFar(m) {
  if (m[3] !== 0 || m[7] !== 0 || m[11] !== 0) return m;
  const eye = m.subarray(16, 19);
  const forward = m.subarray(19, 22);
  // In clip coordinates the depth is 0 at the near plane, 1 at the far plane, and linear between them.
  const depthAtEye = m[2] * eye[0] + m[6] * eye[1] + m[10] * eye[2] + m[14];
  const middle = (0.5 - depthAtEye) / Math.hypot(m[2], m[6], m[10]);
  const far = m.map((value, k) => (k < 16 && k % 4 < 2 ? middle * value : value));
  for (let k = 0; k < 3; k += 1) far[4 * k + 3] = forward[k];
  far[15] = -dot(forward, eye);
  return far;
}

// As in shade.js, the results for a disc are always written to the same arrays.
const PLACE = new Float64Array(3);
const NORMAL = new Float64Array(3);

/**
 * Returns a view that shifts a picture of this size by a fraction of a pixel.
 * @param {Float32Array} view @param {readonly [number, number]} by @param {number} width @param {number} height
 */
function moved(view, [x, y], width, height) {
  const out = view.slice();
  for (let k = 0; k < 4; k += 1) {
    out[4 * k] += ((2 * x) / width) * view[4 * k + 3];
    out[4 * k + 1] += ((2 * y) / height) * view[4 * k + 3];
  }
  return out;
}

export class Painter {
  #canvas;

  /**
   * How many radii the bed of each particle lies behind its usual depth; null if particles are so small that the usual
   * depth is enough.
   * @type {Float32Array | null}
   */
  bedDepths;

  /** Number of discs, and of particles in the body. */
  #count;
  #body;

  /** Time in seconds at which each particle appears. */
  #births;

  /** @type {Style} */
  #style;
  #image;
  #depth;

  /** The picture that is being painted over several calls; else null. @type {Pass | null} */
  #pass;

  #mesh;
  #samples;

  /** The view of the current sample. */
  #seen;

  /** @param {HTMLCanvasElement} canvas */
  static async create(canvas) {
    const context = canvas.getContext('2d', { alpha: false });
    if (!context) throw new Error('The browser gives no 2-D canvas.');
    return new Painter(canvas, context);
  }

  /** @param {HTMLCanvasElement} canvas @param {CanvasRenderingContext2D} context */
  constructor(canvas, context) {
    this.#canvas = canvas;
    this.context = context;
    this.#count = 0;
    this.bedDepths = null;
    this.#body = 0;
    this.positions = new Float32Array(0);
    this.normals = new Float32Array(0);
    this.radii = new Float32Array(0);
    this.levels = new Uint32Array(0);
    this.colours = new Uint32Array(0);
    this.#births = new Float64Array(0);
    /** The ends of the crease segments, as `endsOf` returns them, and the colour of each segment. */
    this.ends = new Float32Array(0);
    this.lineColours = new Uint32Array(0);
    /** @type {Float32Array} */
    this.view = new Float32Array(23);
    this.#style = {
      background: [1, 1, 1, 1],
      disc_scale: 0.92,
      key_light_view: [-0.5, 0.72, 0.55],
      dim: 0,
      dim_backfaces: 0,
      outline: -1,
      box: null,
    };
    this.#image = new ImageData(1, 1);
    this.#depth = new Float32Array(1);
    this.#pass = null;
    this.#mesh = new PaintedMesh();
    this.#samples = new Samples();
    this.#seen = this.view;
    /** Work for all pictures so far, in pixels. */
    this.work = 0;
    /** Samples per picture, 1 or all; and the stride: one of this many particles is drawn, enlarged; marks all are. */
    this.samples = 1;
    this.stride = 1;
    this.width = 0;
    this.height = 0;
  }

  backend() {
    return 'canvas2d';
  }

  adapter() {
    return '2-D canvas';
  }

  max_particles() {
    return Infinity;
  }

  max_faces() {
    return Infinity;
  }

  /** @type {Renderer['resize']} */
  resize(widthPx, heightPx) {
    this.width = Math.max(0, Math.floor(widthPx));
    this.height = Math.max(0, Math.floor(heightPx));
  }

  /** @type {Renderer['write']} */
  write(first, positions, normals, radii, levels, colours, birthS) {
    const last = first + radii.length;
    if (last > this.radii.length) {
      const room = Math.max(last, 2 * this.radii.length);
      this.positions = grown(this.positions, 3 * room);
      this.normals = grown(this.normals, 3 * room);
      this.radii = grown(this.radii, room);
      this.levels = grown(this.levels, room);
      this.colours = grown(this.colours, room);
      this.#births = grown(this.#births, room);
    }
    this.positions.set(positions, 3 * first);
    this.normals.set(normals, 3 * first);
    this.radii.set(radii, first);
    this.levels.set(levels, first);
    this.colours.set(colours, first);
    this.#births.fill(birthS, first, last);
  }

  /** @type {Renderer['write_colours']} */
  write_colours(first, colours) {
    this.colours.set(colours.subarray(0, Math.max(0, this.colours.length - first)), first);
  }

  /** @type {Renderer['write_lines']} */
  write_lines(ends, colours) {
    this.ends = ends.slice();
    this.lineColours = colours.slice();
  }

  /** @type {Renderer['write_faces']} */
  write_faces(first, positions, normals, radii, levels, colours, marks) {
    this.#mesh.write(first, { positions, normals, radii, levels }, colours, marks);
  }

  /** @type {Renderer['tint_faces']} */
  tint_faces(first, colours, marks) {
    this.#mesh.tint(first, colours, marks);
  }

  /** @type {Renderer['set_faces']} */
  set_faces(count, particles) {
    this.#mesh.show(count, particles);
  }

  /** @type {Renderer['set_count']} */
  set_count(n, body) {
    this.#count = Math.min(n, this.radii.length);
    this.#body = Math.min(body, this.radii.length);
  }

  /** @type {Renderer['set_view']} */
  set_view(view) {
    this.view = seenFromFar(Float32Array.from(view));
  }

  /** @type {Renderer['set_style']} */
  set_style(json) {
    this.#style = { ...this.#style, ...JSON.parse(json) };
  }

  /**
   * Paints a picture or a part of it. After a part it returns 'part', and the next calls continue it. The painted data
   * must not change before the last call.
   * @param {number} timeS @param {boolean} [transparent]  leaves the background out @param {number} [most]  work
   */
  draw(timeS, transparent = false, most = MOST_WORK) {
    const { width, height } = this;
    if (width === 0 || height === 0) return 'skipped';
    if (this.#image.width !== width || this.#image.height !== height) {
      this.#image = new ImageData(width, height);
      this.#depth = new Float32Array(width * height);
    }
    this.#pass ??= this.#begin(this.#image, this.#depth, { transparent, timeS, samples: this.samples });
    if (!this.#advance(this.#pass, most)) return 'part';
    this.#pass = null;
    // Resizing a canvas erases its picture, so the size changes only with the next picture.
    if (this.#canvas.width !== width || this.#canvas.height !== height) Object.assign(this.#canvas, { width, height });
    this.context.putImageData(this.#image, 0, 0);
    return 'drawn';
  }

  /**
   * Chooses how the next picture is painted: one that stands still with smooth edges, of one that moves maybe fewer
   * particles. A picture of which a part is painted is given up.
   * @param {{ isMoving: boolean, stride: number }} how
   */
  choose({ isMoving, stride }) {
    this.#pass = null;
    this.samples = isMoving ? 1 : PLACES.length;
    this.stride = stride;
  }

  /** @type {Renderer['picture_size']} */
  picture_size(widthPx, heightPx) {
    return Uint32Array.of(widthPx, heightPx);
  }

  /** @type {Renderer['read_pixels']} */
  async read_pixels(widthPx, heightPx, transparent) {
    const image = new ImageData(widthPx, heightPx);
    const [onScreen, { stride }] = [this.view.slice(), this];
    this.stride = 1;
    // A picture with another aspect ratio keeps everything that the canvas shows, without distortion.
    const wider = widthPx / heightPx / (Math.max(1, this.width) / Math.max(1, this.height));
    for (let k = 0; k < 4; k += 1) {
      if (wider > 1) this.view[4 * k] /= wider;
      else this.view[4 * k + 1] *= wider;
    }
    // A picture being painted for the screen starts again, since its view and style have changed.
    this.#pass = null;
    const how = { transparent, timeS: Infinity, samples: PLACES.length };
    this.#advance(this.#begin(image, new Float32Array(widthPx * heightPx), how), Infinity);
    this.view = onScreen;
    this.stride = stride;
    return new Uint8Array(image.data.buffer);
  }

  destroy() {
    this.#count = 0;
    this.#body = 0;
    this.#image = new ImageData(1, 1);
    this.#depth = new Float32Array(1);
    this.#mesh.show(0, 0);
    this.#samples.free();
    this.#pass = null;
  }

  free() {}

  /**
   * Begins a picture.
   * @param {ImageData} image @param {Float32Array} depth
   * @param {{ transparent: boolean, timeS: number, samples: number }} how
   * @returns {Pass}
   */
  #begin(image, depth, { transparent, timeS, samples }) {
    const { width, height } = image;
    const { background, body } = this.#style;
    const ground = background.slice(0, 3).map((v) => linear(v));
    const target = { out: new Uint32Array(image.data.buffer), depth, width, height };
    const faces = this.#style.faces && this.stride === 1 ? this.#mesh.count : 0;
    const first = faces > 0 ? this.#mesh.particles : 0;
    const every = (/** @type {number} */ count) => Math.max(0, Math.ceil((count - first) / this.stride));
    const pass = {
      target,
      timeS,
      ground,
      value: transparent ? 0 : packed(ground[0], ground[1], ground[2]),
      samples,
      sample: 0,
      faces,
      first,
      beds: body ? every(this.#body) : 0,
      discs: every(Math.min(this.#count, this.#body)),
      // Marks follow the particles.
      marks: Math.max(0, this.#count - this.#body),
      next: 0,
    };
    if (samples > 1) this.#samples.begin(width * height);
    return { ...pass, scene: this.#sampled(pass) };
  }

  /** Begins a sample of a picture. @param {Omit<Pass, 'scene'>} pass @returns {PaintedScene} */
  #sampled({ target, ground, value, sample, samples }) {
    const { width, height } = target;
    target.out.fill(value);
    // The depth buffer holds 1/w, which is linear in screen coordinates on a plane; larger values are nearer.
    target.depth.fill(0);
    this.#seen = samples > 1 ? moved(this.view, PLACES[sample], width, height) : this.view;
    const axes = eyeAxes(this.#seen);
    const { right, up, forward } = axes;
    const { key_light_view: toward, body } = this.#style;
    const light = Math.hypot(toward[0], toward[1], toward[2]) || 1;
    const key = [0, 1, 2].map((k) => (right[k] * toward[0] + up[k] * toward[1] - forward[k] * toward[2]) / light);
    const bed = (body?.colour ?? []).map((v) => linear(v));
    const scene = { target, axes, key, ground, rim: rimOn(ground), bed, swell: Math.sqrt(this.stride), lights: null };
    return this.#style.spheres ? { ...scene, lights: this.#lightsOf(scene) } : scene;
  }

  /** Returns the light on a ball for {@link fillBall}. @param {PaintedScene} scene */
  #lightsOf({ axes: { right, up, forward }, key, rim }) {
    const lights = new Float32Array(3 * BALL_SIDE * BALL_SIDE);
    const along = (/** @type {number[]} */ axis) => dot(key, axis);
    const [keyX, keyY, keyZ] = [along(right), along(up), -along(forward)];
    overBall((at, x, y, z) => {
      const cosines = { keyward: keyX * x + keyY * y + keyZ * z, skyward: y, edgeOn: 1 - z };
      lightOn(cosines, { rim, warmth: this.#style.warmth ?? 0 });
      lights.set(LIGHT, 3 * at);
    });
    return lights;
  }

  /**
   * Continues a picture: in each sample the faces, the body, the particles; after the last sample the lines.
   * @param {Pass} pass @param {number} most  work
   * @returns whether the picture is complete
   */
  #advance(pass, most) {
    const { faces, beds, discs, marks, timeS, first, samples } = pass;
    const { stride } = this;
    const end = faces + beds + discs + marks;
    const until = this.work + most;
    for (;;) {
      const { scene } = pass;
      for (; pass.next < end; pass.next += 1) {
        if (this.work >= until) return false;
        let k = pass.next;
        this.work += WORK_OF_ONE;
        if (k < faces) {
          this.work += this.#mesh.paint(k, scene, this.#seen, this.#style);
          continue;
        }
        k -= faces;
        const isBed = k < beds;
        const isMark = k >= beds + discs;
        const i = isMark ? this.#body + k - beds - discs : first + (isBed ? k : k - beds) * stride;
        if (this.#births[i] > timeS) continue;
        this.work += isBed ? this.#paintBed(i, scene) : this.#paintDisc(i, scene);
      }
      this.#paintCreases(scene.target, scene.ground);
      if (this.#style.box) this.#paintBox(scene.target, this.#style.box);
      if (samples === 1) return true;
      this.#samples.add(scene.target.out);
      pass.sample += 1;
      if (pass.sample === samples) {
        this.#samples.mean(scene.target.out);
        return true;
      }
      pass.next = 0;
      pass.scene = this.#sampled(pass);
      this.work += scene.target.out.length;
    }
  }

  /** Returns a position for {@link paintLine}. @param {ArrayLike<number>} p */
  #clip(p) {
    const m = this.#seen;
    return [0, 1, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
  }

  /** Draws the creases. @param {Target} target @param {number[]} ground  the background in linear light */
  #paintCreases(target, ground) {
    const { dim, plane = null } = this.#style;
    const { ends, lineColours } = this;
    const m = this.#seen;
    for (const [k, colour] of lineColours.entries()) {
      const piece = [2 * k, 2 * k + 1].map((end) => [...ends.subarray(END * end, END * (end + 1))]);
      const middle = [0, 1, 2].map((c) => 0.5 * (piece[0][c] + piece[1][c]));
      if (plane && isBeyond(plane, middle, 0)) continue;
      const places = piece.map(([x, y, z, radius]) => {
        const toEye = [m[16] - x, m[17] - y, m[18] - z];
        const lift = (CREASE_LIFT * radius) / (Math.hypot(toEye[0], toEye[1], toEye[2]) || 1);
        return this.#clip([x + lift * toEye[0], y + lift * toEye[1], z + lift * toEye[2]]);
      });
      const [p, q] = places;
      if (!(p[2] > 1e-9 && q[2] > 1e-9)) continue;
      // Two parts per pixel, but if an end is close to the eye no more than the picture can show.
      const most = 2 * Math.max(target.width, target.height);
      const share = 0.5 * Math.max(...[0, 1].map((r) => Math.abs(p[r] / p[2] - q[r] / q[2])));
      const steps = Math.ceil(most * Math.min(1, share)) || 1;
      const [red, green, blue] = [0, 8, 16].map(
        (shift, c) => LINEAR[(colour >> shift) & 255] * (1 - dim) + ground[c] * dim,
      );
      paintLine(target, { ends: places, steps, value: packed(red, green, blue) });
    }
  }

  /**
   * Returns the position of a point in the picture; null behind the eye.
   * @param {number} x @param {number} y @param {number} z @param {PaintedScene} scene
   */
  #project(x, y, z, { target: { width, height }, axes }) {
    const m = this.#seen;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    if (!(w > 1e-9)) return null;
    const sx = (0.5 + (0.5 * (m[0] * x + m[4] * y + m[8] * z + m[12])) / w) * width;
    const sy = (0.5 - (0.5 * (m[1] * x + m[5] * y + m[9] * z + m[13])) / w) * height;
    return { sx, sy, w, pxPerWorld: (axes.clipXPerWorld * 0.5 * width) / w };
  }

  /** Turns NORMAL towards the eye. Returns the cosine between them, negative if NORMAL was reversed. */
  #face() {
    const m = this.#seen;
    const x = m[16] - PLACE[0];
    const y = m[17] - PLACE[1];
    const z = m[18] - PLACE[2];
    const facing = (x * NORMAL[0] + y * NORMAL[1] + z * NORMAL[2]) / Math.sqrt(x * x + y * y + z * z);
    if (facing < 0) for (let k = 0; k < 3; k += 1) NORMAL[k] = -NORMAL[k];
    return facing;
  }

  /** Writes the light on a particle to LIGHT. @param {number} facing @param {PaintedScene} scene */
  #light(facing, { axes: { up }, key, rim }) {
    const cosines = { keyward: dot(NORMAL, key), skyward: dot(NORMAL, up), edgeOn: 1 - Math.abs(facing) };
    lightOn(cosines, { rim, warmth: this.#style.warmth ?? 0 });
  }

  /** Whether the style shows the level of a particle. @param {number} i */
  #isShown(i) {
    const { level = null } = this.#style;
    return level === null || this.levels[i] <= level || this.levels[i] === NO_LEVEL;
  }

  /** Returns the share by which a particle fades to the background. @param {number} i */
  #fadeOf(i) {
    const { dim, level = null } = this.#style;
    return level !== null && this.levels[i] < level ? Math.max(dim, MUTE) : dim;
  }

  /** Writes PLACE and NORMAL of a particle. Returns whether the cutting plane keeps it. @param {number} i */
  #take(i) {
    const { positions: p, normals: n } = this;
    const { plane } = this.#style;
    if (plane && isBeyond(plane, p, 3 * i)) return false;
    for (let k = 0; k < 3; k += 1) {
      PLACE[k] = p[3 * i + k];
      NORMAL[k] = n[3 * i + k];
    }
    return true;
  }

  /**
   * Draws a particle's part of the body, as `bed_vertex` in shaders/discs.wgsl does.
   * @param {number} i @param {PaintedScene} scene
   */
  #paintBed(i, scene) {
    const { body, dim_backfaces, dim, plane } = this.#style;
    const radius = this.radii[i] * scene.swell;
    if (!body || !(radius > 0) || this.levels[i] === NO_LEVEL) return 0;
    if (!this.#take(i)) return 0;
    const facing = this.#face();
    const isOpen = body.is_open || !!plane;
    if (facing < 0 && !isOpen) return 0;
    const down = isOpen ? 0 : BED_SUNK * radius;
    const [x, y, z] = [PLACE[0] - down * NORMAL[0], PLACE[1] - down * NORMAL[1], PLACE[2] - down * NORMAL[2]];
    const at = this.#project(x, y, z, scene);
    if (!at || at.pxPerWorld * radius < LEAST_BED_PX) return 0;
    const [least, full] = isOpen ? OPEN_OUTLINE_BED : OUTLINE_BED;
    const share = least + (BED_RADIUS - least) * Math.min(1, Math.abs(facing) / full);
    const isToCome = i >= this.#count || !this.#isShown(i);
    const deep = (this.bedDepths?.[i] ?? 0) / Math.max(LEAST_FACING, Math.abs(facing));
    const near = 1 / (at.w + ((isToCome ? TO_COME_BEHIND : BED_BEHIND) + deep) * radius);
    const px = at.pxPerWorld * share * radius;
    if (isHidden(scene.target, at, px, near)) return 0;
    this.#light(facing, scene);
    // As in the shader, a bed has its disc's colour if the gaps fall between pixels.
    const hasGaps = isToCome ? 1 : smoothstep(GAPS_PX, at.pxPerWorld * radius * Math.abs(facing));
    const colour = this.colours[i];
    for (let k = 0; k < 3; k += 1) {
      const root = (1 - hasGaps) * Math.sqrt(LINEAR[(colour >> (8 * k)) & 255]) + hasGaps * Math.sqrt(scene.bed[k]);
      COLOUR[k] = root * root;
    }
    const behind = smoothstep(INSIDE_FROM, -facing) * dim_backfaces;
    const value = lit(1, behind, isToCome ? Math.max(TO_COME, dim) : this.#fadeOf(i), scene.ground);
    return this.#fill(scene, { at, px, near, value, rim: value, coreSq: Infinity });
  }

  /**
   * Draws a particle, unless the style hides it or it lies outside the picture.
   * @param {number} i @param {PaintedScene} scene
   */
  #paintDisc(i, scene) {
    const { dim_backfaces, disc_scale, outline } = this.#style;
    const { axes, ground } = scene;
    if (!this.#isShown(i) || !this.#take(i)) return 0;
    // A negative radius means a dot that faces the eye, as in shaders/discs.wgsl.
    const isBall = scene.lights !== null && this.levels[i] !== NO_LEVEL;
    const isDot = this.radii[i] < 0 && !isBall;
    const swell = this.levels[i] === NO_LEVEL ? 1 : scene.swell;
    const radius = Math.abs(this.radii[i]) * disc_scale * swell * (isDot ? DOT : 1);
    const at = this.#project(PLACE[0], PLACE[1], PLACE[2], scene);
    if (!at || radius === 0) return 0;
    // A dot is moved towards the eye by its radius, so that neighbouring discs do not cut it.
    const near = 1 / (isDot ? at.w - radius : at.w);
    const px = at.pxPerWorld * radius;
    if (isHidden(scene.target, at, px, near)) return 0;
    if (isDot) for (let k = 0; k < 3; k += 1) NORMAL[k] = -axes.forward[k];
    const facing = this.#face();
    // A rim of a tenth of the radius separates overlapping discs.
    const hasRim = px > RIM_FROM_PX && (isDot || this.levels[i] !== NO_LEVEL);
    const coreSq = hasRim ? 0.81 * px * px : Infinity;
    if (i === outline) {
      const value = packed(1 - ground[0], 1 - ground[1], 1 - ground[2]);
      return this.#fill(scene, { at, px, near, value, rim: value, coreSq });
    }
    takeColour(this.colours[i]);
    const [behind, away] = [facing < 0 ? dim_backfaces : 0, this.#fadeOf(i)];
    if (scene.lights && isBall && px >= POINT_PX) {
      const { sx, sy, w, pxPerWorld } = at;
      const depthPerPx = 1 / (pxPerWorld * w * w);
      return fillBall(scene.target, { sx, sy, px, near, depthPerPx, lights: scene.lights, ground, away });
    }
    this.#light(facing, scene);
    const value = lit(1, behind, away, ground);
    return this.#fill(scene, {
      at,
      px,
      near,
      value,
      rim: hasRim ? lit(1 - RIM_SHADE, behind, away, ground) : value,
      coreSq,
    });
  }

  /**
   * Fills a visible disc in its plane, whose normal is NORMAL.
   * @param {PaintedScene} scene
   * @param {{at: {sx: number, sy: number, w: number, pxPerWorld: number}} & Pick<PaintedDisc, 'px' | 'near' | 'value' |
   *   'rim' | 'coreSq'>} disc
   */
  #fill({ target, axes }, { at: { sx, sy, w, pxPerWorld }, px, near, value, rim, coreSq }) {
    if (px < POINT_PX) {
      const pixel = (sy | 0) * target.width + (sx | 0);
      target.depth[pixel] = near;
      target.out[pixel] = value;
      return 1;
    }
    // In view axes the disc's plane is a·dx + b·dy + c·dz = 0 with c > 0 towards the eye. In screen pixels, to first
    // order in the size of the disc, it is the ellipse dx² + dy² + dz² ≤ px² with dz = −(a·dx + b·dy)/c.
    const a = dot(NORMAL, axes.right);
    const b = -dot(NORMAL, axes.up);
    // Seen edge on, a disc keeps a twelfth of its length as width, so that it never vanishes.
    const c = Math.max(1 / 12, -dot(NORMAL, axes.forward));
    const depthPerPx = 1 / (pxPerWorld * w * w);
    return fillDisc(target, { sx, sy, px, ka: a / c, kb: b / c, near, depthPerPx, value, rim, coreSq });
  }

  /**
   * Draws the twelve edges of the clip box, one pixel wide, except where discs hide them.
   * @param {Target} target @param {NonNullable<Style['box']>} box
   */
  #paintBox(target, box) {
    const value =
      ((255 << 24) |
        (Math.round(box.colour[2] * 255) << 16) |
        (Math.round(box.colour[1] * 255) << 8) |
        Math.round(box.colour[0] * 255)) >>>
      0;
    const corner = (/** @type {number} */ k) => {
      const p = [k & 1 ? box.max[0] : box.min[0], k & 2 ? box.max[1] : box.min[1], k & 4 ? box.max[2] : box.min[2]];
      return this.#clip(p);
    };
    const steps = 2 * Math.max(target.width, target.height);
    for (let k = 0; k < 8; k += 1) {
      for (const bit of [1, 2, 4]) {
        if (k & bit) continue;
        paintLine(target, { ends: [corner(k), corner(k | bit)], steps, value });
      }
    }
  }
}
