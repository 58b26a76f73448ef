/**
 * An orbit camera: the eye on a sphere around a target, z up. Pure arithmetic; the controls and the viewer own the clock.
 *
 * A rotation eases out after the hand lets go and a fit glides to its place; with `calm` (reduced motion) both are instant.
 *
 * @module
 */

/**
 * @typedef {import('../types.js').CameraState} CameraState
 * @typedef {import('../types.js').Vec3} Vec3
 * @typedef {import('../types.js').Bounds} Bounds
 * @typedef {{left: number, right: number, top: number, bottom: number}} Insets  pixels covered by panels
 * @typedef {{
 *   clip_from_world: Float32Array, eye: Vec3, forward: Vec3, right: Vec3, up: Vec3, tan_x: number, tan_y: number,
 *   shift_x: number, shift_y: number, world_per_px: number, packed: Float32Array,
 * }} View
 */

/** Angle of view across the shorter side of the free part of the picture: a quiet lens, little distortion. */
export const FIELD_OF_VIEW_RAD = (30 * Math.PI) / 180;
/** Just short of the poles, where the up direction would turn over. */
export const PITCH_LIMIT_RAD = (89 * Math.PI) / 180;
/** Time in which a thrown rotation loses 63 % of its speed, and a fit covers 63 % of its way. */
const EASE_S = 0.11;
/** Speeds below this are rest: 0.02 pixels a frame at 1,000 px. */
const REST_RAD_PER_S = 0.002;

/** @param {number} v @param {number} low @param {number} high */
const clamp = (v, low, high) => Math.min(high, Math.max(low, v));

/** @returns {CameraState} */
export const homeCamera = () => ({ target: [0, 0, 0], distance: 5, yaw: 0.62, pitch: 0.42, fit: true });

/**
 * The axes of the eye: right, up, forward, all of length 1.
 * @param {{yaw: number, pitch: number}} camera
 * @returns {{right: Vec3, up: Vec3, forward: Vec3}}
 */
export function axes({ yaw, pitch }) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return { right: [-sy, cy, 0], up: [-cy * sp, -sy * sp, cp], forward: [-cy * cp, -sy * cp, -sp] };
}

/**
 * What the renderers and the picker need of a camera.
 * @param {CameraState} camera
 * @param {number} width_px
 * @param {number} height_px
 * @param {{centre: Vec3, radius: number}} scene  a ball around everything drawn: it places the near and far planes
 * @param {Insets} [insets]  the target is drawn in the middle of what they leave free
 * @returns {View}
 */
export function viewOf(camera, width_px, height_px, scene, insets = { left: 0, right: 0, top: 0, bottom: 0 }) {
  const w = Math.max(1, width_px);
  const h = Math.max(1, height_px);
  const [left, right_px] = fair(insets.left, insets.right, w);
  const [top, bottom] = fair(insets.top, insets.bottom, h);
  const free_w = w - left - right_px;
  const free_h = h - top - bottom;
  const world_per_px = (2 * Math.tan(FIELD_OF_VIEW_RAD / 2)) / Math.min(free_w, free_h);
  const tan_x = (world_per_px * w) / 2;
  const tan_y = (world_per_px * h) / 2;
  const shift_x = (left - right_px) / w;
  const shift_y = (bottom - top) / h;
  const { right, up, forward } = axes(camera);
  const { target, distance } = camera;
  /** @type {Vec3} */
  const eye = [target[0] - forward[0] * distance, target[1] - forward[1] * distance, target[2] - forward[2] * distance];
  const depth = dot(forward, [scene.centre[0] - eye[0], scene.centre[1] - eye[1], scene.centre[2] - eye[2]]);
  // Near is kept above a thousandth of far: below that a 24-bit depth buffer no longer tells neighbouring discs apart.
  const far = Math.max(depth + scene.radius * 1.05, distance * 0.02, 1e-6);
  const near = Math.max(depth - scene.radius * 1.05, far * 1e-3);
  const a = far / (near - far);
  const b = (far * near) / (near - far);
  // Rows of clip_from_view (view looks along −z, depth 0 … 1) times the rows of view_from_world.
  const tr = -dot(right, eye);
  const tu = -dot(up, eye);
  const tb = dot(forward, eye);
  const clip_from_world = new Float32Array(16);
  for (let k = 0; k < 4; k += 1) {
    const r = k < 3 ? right[k] : tr;
    const u = k < 3 ? up[k] : tu;
    const z = k < 3 ? -forward[k] : tb;
    clip_from_world[4 * k] = r / tan_x - shift_x * z;
    clip_from_world[4 * k + 1] = u / tan_y - shift_y * z;
    clip_from_world[4 * k + 2] = a * z + (k === 3 ? b : 0);
    clip_from_world[4 * k + 3] = -z;
  }
  const packed = new Float32Array(23);
  packed.set(clip_from_world);
  packed.set(eye, 16);
  packed.set(forward, 19);
  packed[22] = world_per_px;
  return { clip_from_world, eye, forward, right, up, tan_x, tan_y, shift_x, shift_y, world_per_px, packed };
}

/** However much panels cover, this share of a side counts as free. */
const LEAST_FREE = 0.2;

/** Two insets of one side, shrunk together until they leave enough free. @param {number} a @param {number} b @param {number} side */
function fair(a, b, side) {
  const [p, q] = [Math.max(0, a) || 0, Math.max(0, b) || 0];
  const scale = Math.min(1, ((1 - LEAST_FREE) * side) / (p + q || 1));
  return [p * scale, q * scale];
}

/** @param {readonly number[]} p @param {readonly number[]} q */
export const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];

/**
 * Direction (length 1) of the ray through a pixel.
 * @param {View} view @param {number} x_px @param {number} y_px @param {number} width_px @param {number} height_px
 * @returns {Vec3}
 */
export function rayThrough(view, x_px, y_px, width_px, height_px) {
  const sx = ((2 * x_px) / width_px - 1 - view.shift_x) * view.tan_x;
  const sy = (1 - (2 * y_px) / height_px - view.shift_y) * view.tan_y;
  const d = [0, 1, 2].map((k) => view.forward[k] + sx * view.right[k] + sy * view.up[k]);
  const length = Math.hypot(d[0], d[1], d[2]);
  return [d[0] / length, d[1] / length, d[2] / length];
}

/**
 * The distance at which a ball of this radius fills the free part of the picture, with a margin of a twentieth.
 * @param {number} radius
 */
export const fitDistance = (radius) => (radius * 1.05) / Math.sin(FIELD_OF_VIEW_RAD / 2);

/** The ball around a box. @param {Bounds} bounds @returns {{centre: Vec3, radius: number}} */
export function ballOf({ min, max }) {
  const half = [0, 1, 2].map((k) => (max[k] - min[k]) / 2);
  return {
    centre: /** @type {Vec3} */ ([0, 1, 2].map((k) => (max[k] + min[k]) / 2)),
    radius: Math.hypot(half[0], half[1], half[2]) || 1,
  };
}

/** The moving camera: a state, a speed, and perhaps a place to glide to. */
export class Camera {
  /** @param {CameraState} [state] */
  constructor(state = homeCamera()) {
    this.state = { ...state };
    this.yaw_per_s = 0;
    this.pitch_per_s = 0;
    /** @type {{target: Vec3, distance: number} | null} */
    this.glide = null;
    /** Reduced motion: no easing, no glide. */
    this.calm = false;
    /** Distances allowed, from the size of the scene. */
    this.near_limit = 1e-3;
    this.far_limit = 1e4;
  }

  /** @param {CameraState} state */
  set(state) {
    this.state = { ...state };
    this.rest();
  }

  rest() {
    this.yaw_per_s = 0;
    this.pitch_per_s = 0;
    this.glide = null;
  }

  /** @param {number} radius  of the scene */
  limits(radius) {
    this.near_limit = radius * 0.02;
    this.far_limit = radius * 60;
  }

  /** Turns by the given angles: a positive dx moves the near side to the right. @param {number} dx_rad @param {number} dy_rad */
  orbit(dx_rad, dy_rad) {
    const { yaw, pitch } = this.state;
    this.state = {
      ...this.state,
      // Kept within a turn, so that links stay short and floats exact.
      yaw: (yaw - dx_rad) % (2 * Math.PI),
      pitch: clamp(pitch + dy_rad, -PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
    };
  }

  /** The hand let go at this speed. @param {number} yaw_per_s @param {number} pitch_per_s */
  fling(yaw_per_s, pitch_per_s) {
    if (this.calm) return;
    this.yaw_per_s = clamp(yaw_per_s, -12, 12);
    this.pitch_per_s = clamp(pitch_per_s, -12, 12);
  }

  /**
   * Comes nearer by `factor` (> 1) and keeps the world point under the cursor where it is.
   * @param {number} factor
   * @param {{view: View, x_px: number, y_px: number, width_px: number, height_px: number} | null} [at]
   */
  zoom(factor, at = null) {
    if (!(factor > 0) || !Number.isFinite(factor)) return;
    const { target, distance } = this.state;
    const next = clamp(distance / factor, this.near_limit, this.far_limit);
    /** @type {Vec3} */
    let moved = target;
    if (at) {
      const ray = rayThrough(at.view, at.x_px, at.y_px, at.width_px, at.height_px);
      // Where the ray meets the plane through the target that faces the eye, relative to the target.
      const along = distance / dot(ray, at.view.forward);
      const share = 1 - next / distance;
      moved = /** @type {Vec3} */ (target.map((t, k) => t + share * (at.view.eye[k] + ray[k] * along - t)));
    }
    this.state = { ...this.state, distance: next, target: moved, fit: false };
    this.glide = null;
  }

  /** Moves the target with the hand, in pixels. @param {number} dx_px @param {number} dy_px @param {View} view */
  pan(dx_px, dy_px, view) {
    const scale = view.world_per_px * this.state.distance;
    this.state = {
      ...this.state,
      target: /** @type {Vec3} */ (
        this.state.target.map((t, k) => t + scale * (-dx_px * view.right[k] + dy_px * view.up[k]))
      ),
      fit: false,
    };
    this.glide = null;
  }

  /** Glides (or jumps) to show the whole ball. @param {{centre: Vec3, radius: number}} ball @param {boolean} [jump] */
  fit(ball, jump = false) {
    this.limits(ball.radius);
    const goal = { target: ball.centre, distance: fitDistance(ball.radius) };
    this.state = { ...this.state, fit: true };
    if (jump || this.calm) {
      this.state = { ...this.state, ...goal };
      this.glide = null;
    } else {
      this.glide = goal;
    }
  }

  /**
   * Moves on by `dt_s`.
   * @param {number} dt_s
   * @returns {boolean} whether there is more to come
   */
  step(dt_s) {
    const keep = Math.exp(-dt_s / EASE_S);
    let moving = false;
    if (this.yaw_per_s !== 0 || this.pitch_per_s !== 0) {
      // The exact way covered while the speed decays.
      const way = EASE_S * (1 - keep);
      this.orbit(this.yaw_per_s * way, this.pitch_per_s * way);
      this.yaw_per_s *= keep;
      this.pitch_per_s *= keep;
      if (Math.hypot(this.yaw_per_s, this.pitch_per_s) < REST_RAD_PER_S) {
        this.yaw_per_s = 0;
        this.pitch_per_s = 0;
      } else moving = true;
    }
    if (this.glide) {
      const { target, distance } = this.glide;
      const state = this.state;
      const log = Math.log(distance) + (Math.log(state.distance) - Math.log(distance)) * keep;
      const next = /** @type {Vec3} */ (state.target.map((t, k) => target[k] + (t - target[k]) * keep));
      const left =
        Math.hypot(next[0] - target[0], next[1] - target[1], next[2] - target[2]) / distance +
        Math.abs(log - Math.log(distance));
      // A thousandth of the distance is under a pixel.
      if (left < 1e-3) {
        this.state = { ...state, target, distance };
        this.glide = null;
      } else {
        this.state = { ...state, target: next, distance: Math.exp(log) };
        moving = true;
      }
    }
    return moving;
  }
}
