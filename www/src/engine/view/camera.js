/**
 * An orbit camera: the eye lies on a sphere around a target, with z up. The functions are pure; the caller passes the
 * time step.
 *
 * A rotation slows down gradually after its release, and a fit is animated. With `calm` (reduced motion) both are
 * instant.
 *
 * @module
 */
import { clamp, dot, vec } from '../vector.js';

/**
 * @import { Angles, CameraState, Spot, Vec3 } from '../types.js'
 * @import { Ball, Insets, View } from './types.js'
 */

/** Angle of view across the shorter side of the picture's free part. A narrow angle keeps the distortion small. */
export const FIELD_OF_VIEW_RAD = (30 * Math.PI) / 180;
/** Largest pitch. Beyond the poles the up direction would flip. */
export const PITCH_LIMIT_RAD = Math.PI / 2;
/**
 * In a parallel projection the eye is this many distances away. The matrix is exactly parallel; rays and pixel sizes
 * belong to this eye, and are off by less than half a pixel.
 */
const PARALLEL_DISTANCES = 1000;
/** The directions of the named views, with z up. @type {Record<'front' | 'right' | 'top' | 'isometric', Angles>} */
export const STANDARD_VIEWS = {
  front: { yaw: -Math.PI / 2, pitch: 0 },
  right: { yaw: 0, pitch: 0 },
  top: { yaw: -Math.PI / 2, pitch: Math.PI / 2 },
  // The three axes have equal length in the picture.
  isometric: { yaw: -Math.PI / 4, pitch: Math.atan(Math.SQRT1_2) },
};
/** Time constant in which a released rotation loses 63 % of its speed and a fit covers 63 % of its distance. */
const EASE_S = 0.11;
/** Speed below which the rotation stops: 0.02 pixels per frame at 1,000 px. */
const REST_RAD_PER_S = 0.002;

/** @returns {CameraState} */
export const homeCamera = () => ({ target: [0, 0, 0], distance: 5, yaw: 0.62, pitch: 0.42, fit: true });

/**
 * Returns the unit axes of the eye: right, up, forward.
 * @param {Angles} camera
 * @returns {{right: Vec3, up: Vec3, forward: Vec3}}
 */
export function axes({ yaw, pitch }) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return { right: [-sy, cy, 0], up: [-cy * sp, -sy * sp, cp], forward: [-cy * cp, -sy * cp, -sp] };
}

const NO_INSETS = { left: 0, right: 0, top: 0, bottom: 0 };

/**
 * Returns the matrices and vectors that the renderers and the picker need.
 * @param {CameraState} camera
 * @param {number} widthPx
 * @param {number} heightPx
 * @param {Ball} scene  a ball around everything drawn, which determines the near and far planes
 * @param {Insets} [insets]  covered margins; the target is drawn in the middle of the free part
 * @param {boolean} [parallel]  whether lines that are parallel stay so: an orthographic view
 * @returns {View}
 */
export function viewOf(camera, widthPx, heightPx, scene, insets = NO_INSETS, parallel = false) {
  const w = Math.max(1, widthPx);
  const h = Math.max(1, heightPx);
  const free = freePart(w, h, insets);
  const away = parallel ? PARALLEL_DISTANCES : 1;
  const worldPerPx = (2 * Math.tan(FIELD_OF_VIEW_RAD / 2)) / Math.min(free.width, free.height) / away;
  const tanX = (worldPerPx * w) / 2;
  const tanY = (worldPerPx * h) / 2;
  const shiftX = free.x / w;
  const shiftY = -free.y / h;
  const { right, up, forward } = axes(camera);
  const { target } = camera;
  const distance = camera.distance * away;
  /** @type {Vec3} */
  const eye = [target[0] - forward[0] * distance, target[1] - forward[1] * distance, target[2] - forward[2] * distance];
  const depth = dot(forward, [scene.centre[0] - eye[0], scene.centre[1] - eye[1], scene.centre[2] - eye[2]]);
  // The near plane is at least a thousandth of the far plane. Below that, a 24-bit depth buffer cannot separate
  // neighbouring discs.
  const far = Math.max(depth + scene.radius * 1.05, distance * 0.02, 1e-30);
  const near = Math.max(depth - scene.radius * 1.05, parallel ? 0 : far * 1e-3);
  const a = far / (near - far);
  const b = (far * near) / (near - far);
  // Rows of clipFromView (view looks along −z, depth 0 … 1) times the rows of viewFromWorld.
  const tr = -dot(right, eye);
  const tu = -dot(up, eye);
  const tb = dot(forward, eye);
  const clipFromWorld = new Float32Array(16);
  for (let k = 0; k < 4; k += 1) {
    const r = k < 3 ? right[k] : tr;
    const u = k < 3 ? up[k] : tu;
    const z = k < 3 ? -forward[k] : tb;
    const last = k < 3 ? 0 : 1;
    // The divisor is the depth; in a parallel projection it is 1, and the depth counts from the near plane.
    clipFromWorld[4 * k] = parallel ? r / (tanX * distance) + last * shiftX : r / tanX - shiftX * z;
    clipFromWorld[4 * k + 1] = parallel ? u / (tanY * distance) + last * shiftY : u / tanY - shiftY * z;
    clipFromWorld[4 * k + 2] = parallel ? (z + last * near) / (near - far) : a * z + last * b;
    clipFromWorld[4 * k + 3] = parallel ? last : -z;
  }
  const packed = new Float32Array(23);
  packed.set(clipFromWorld);
  packed.set(eye, 16);
  packed.set(forward, 19);
  packed[22] = worldPerPx;
  return {
    widthPx: w,
    heightPx: h,
    clipFromWorld,
    eye,
    forward,
    right,
    up,
    tanX,
    tanY,
    shiftX,
    shiftY,
    worldPerPx,
    span: distance,
    parallel,
    packed,
  };
}

/**
 * Returns the size of the picture's free part, which no panel covers, and twice the offset of its middle from the
 * picture's middle, to the right and down.
 * @param {number} widthPx @param {number} heightPx @param {Insets} insets
 */
export function freePart(widthPx, heightPx, insets) {
  const [left, right] = fair(insets.left, insets.right, widthPx);
  const [top, bottom] = fair(insets.top, insets.bottom, heightPx);
  return { width: widthPx - left - right, height: heightPx - top - bottom, x: left - right, y: top - bottom };
}

/** Smallest share of a side that counts as free, however much the panels cover. */
const LEAST_FREE = 0.2;

/**
 * Scales down two opposite insets until they leave enough of the side free.
 * @param {number} a
 * @param {number} b
 * @param {number} side
 */
function fair(a, b, side) {
  const [p, q] = [Math.max(0, a) || 0, Math.max(0, b) || 0];
  const scale = Math.min(1, ((1 - LEAST_FREE) * side) / (p + q || 1));
  return [p * scale, q * scale];
}

/**
 * Returns the unit direction of the ray through a pixel.
 * @param {View} view @param {number} xPx @param {number} yPx
 * @returns {Vec3}
 */
export function rayThrough(view, xPx, yPx) {
  const sx = ((2 * xPx) / view.widthPx - 1 - view.shiftX) * view.tanX;
  const sy = (1 - (2 * yPx) / view.heightPx - view.shiftY) * view.tanY;
  const d = [0, 1, 2].map((k) => view.forward[k] + sx * view.right[k] + sy * view.up[k]);
  const length = Math.hypot(d[0], d[1], d[2]);
  return [d[0] / length, d[1] / length, d[2] / length];
}

/**
 * Returns the position of a point in the picture; null behind the eye.
 * @param {View} view @param {ArrayLike<number>} place
 * @returns {Spot | null}
 */
export function projected({ clipFromWorld: m, worldPerPx, widthPx, heightPx, span, parallel }, place) {
  const row = (/** @type {number} */ k) => m[k] * place[0] + m[4 + k] * place[1] + m[8 + k] * place[2] + m[12 + k];
  const w = row(3);
  if (!(w > 0)) return null;
  const [x, y] = [(0.5 + (0.5 * row(0)) / w) * widthPx, (0.5 - (0.5 * row(1)) / w) * heightPx];
  return { x, y, perPx: worldPerPx * (parallel ? span : w) };
}

/**
 * Returns the distance at which a ball of this radius fills the free part of the picture, with a margin of 5 %.
 * @param {number} radius
 */
export const fitDistance = (radius) => (radius * 1.05) / Math.sin(FIELD_OF_VIEW_RAD / 2);

/** Largest share of the free part's side that a surface takes when it is fitted by its outline. */
const OUTLINE_SHARE = 0.93;
/** Least distance of that fit, relative to the fit of the ball: when rotated, the surface may extend beyond a side. */
const NEAREST_FIT = 0.8;
/** Largest distance of that fit, relative to the fit of the ball, to leave a corner free. */
const FARTHEST_FIT = 1.25;

/**
 * Returns the distance at which the outline of discs, seen from these angles, fills the free part of the picture: at
 * most the distance for the ball around them, unless the outline would reach into a corner.
 * @param {Angles} angles
 * @param {Ball} ball
 * @param {{width: number, height: number, corner?: Insets['corner']}} free  that part
 * @param {{positions: ArrayLike<number>, radii: ArrayLike<number>, count: number}} discs
 * @param {(disc: number) => boolean} [isShown]  the discs that are drawn; by default all
 */
export function outlineDistance(
  angles,
  ball,
  { width, height, corner },
  { positions, radii, count },
  isShown = () => true,
) {
  const { right, up, forward } = axes(angles);
  const [cx, cy, cz] = ball.centre;
  const perPx = (OUTLINE_SHARE * Math.tan(FIELD_OF_VIEW_RAD / 2)) / Math.min(width, height);
  const [tanX, tanY] = [perPx * width, perPx * height];
  const full = (2 * Math.tan(FIELD_OF_VIEW_RAD / 2)) / Math.min(width, height);
  const [besideX, belowY] = [full * (width / 2 - (corner?.width ?? 0)), full * (height / 2 - (corner?.height ?? 0))];
  let distance = 0;
  let clear = 0;
  for (let i = 0; i < count; i += 1) {
    if (!isShown(i)) continue;
    const [x, y, z] = [positions[3 * i] - cx, positions[3 * i + 1] - cy, positions[3 * i + 2] - cz];
    const [across, high] = [dot(right, [x, y, z]), dot(up, [x, y, z])];
    const near = -dot(forward, [x, y, z]);
    distance = Math.max(
      distance,
      near + (Math.abs(across) + radii[i]) / tanX,
      near + (Math.abs(high) + radii[i]) / tanY,
    );
    // It is enough to clear the corner at the side or below.
    if (corner)
      clear = Math.max(clear, near + Math.min(beyond(radii[i] - across, besideX), beyond(high + radii[i], belowY)));
  }
  const whole = fitDistance(ball.radius);
  return Math.max(clamp(distance, NEAREST_FIT * whole, whole), Math.min(clear, FARTHEST_FIT * whole));
}

/** The distance from which a length subtends an angle with this tangent. @param {number} length @param {number} tan */
const beyond = (length, tan) => (length <= 0 ? -Infinity : tan > 0 ? length / tan : Infinity);

/** Returns the ball around a box. @param {{min: ArrayLike<number>, max: ArrayLike<number>}} bounds */
export function ballOf({ min, max }) {
  const half = [0, 1, 2].map((k) => (max[k] - min[k]) / 2);
  return {
    centre: vec((k) => (max[k] + min[k]) / 2),
    radius: Math.hypot(half[0], half[1], half[2]) || 1,
  };
}

/** A camera in motion: its state, its angular speed, and the destination of a fit, if any. */
export class Camera {
  #yawPerS;
  #pitchPerS;

  /** @type {{target: Vec3, distance: number, yaw?: number, pitch?: number} | null} */
  #glide;

  /** Limits of the distance, from the size of the scene. */
  #nearLimit;
  #farLimit;

  /** @param {CameraState} [state] */
  constructor(state = homeCamera()) {
    this.state = { ...state };
    this.#yawPerS = 0;
    this.#pitchPerS = 0;
    this.#glide = null;
    /** Whether motion is reduced: no easing and no animation. */
    this.calm = false;
    this.#nearLimit = 1e-3;
    this.#farLimit = 1e4;
  }

  /** @param {CameraState} state */
  set(state) {
    this.state = { ...state };
    this.rest();
  }

  rest() {
    this.#yawPerS = 0;
    this.#pitchPerS = 0;
    this.#glide = null;
  }

  /** @param {number} radius  of the scene */
  limits(radius) {
    this.#nearLimit = radius * 0.02;
    this.#farLimit = radius * 60;
  }

  /**
   * Rotates the camera by two angles. A positive dx moves the near side of the surface to the right.
   * @param {number} dxRad
   * @param {number} dyRad
   */
  orbit(dxRad, dyRad) {
    const { yaw, pitch } = this.state;
    this.state = {
      ...this.state,
      // The yaw stays within one turn, so that links stay short and no precision is lost.
      yaw: (yaw - dxRad) % (2 * Math.PI),
      pitch: clamp(pitch + dyRad, -PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
    };
  }

  /** Continues a rotation at the speed of its release. @param {number} yawPerS @param {number} pitchPerS */
  fling(yawPerS, pitchPerS) {
    if (this.calm) return;
    this.#yawPerS = clamp(yawPerS, -12, 12);
    this.#pitchPerS = clamp(pitchPerS, -12, 12);
  }

  /**
   * Reduces the distance by `factor` (> 1) and keeps the world point under the cursor in place.
   * @param {number} factor
   * @param {{view: View, xPx: number, yPx: number} | null} [at]
   */
  zoom(factor, at = null) {
    if (!(factor > 0) || !Number.isFinite(factor)) return;
    const { target, distance } = this.state;
    const next = clamp(distance / factor, this.#nearLimit, this.#farLimit);
    let moved = target;
    if (at) {
      const ray = rayThrough(at.view, at.xPx, at.yPx);
      // The fixed point is the intersection of the ray with the plane through the target that faces the eye.
      const along = at.view.span / dot(ray, at.view.forward);
      const share = 1 - next / distance;
      moved = vec((k) => target[k] + share * (at.view.eye[k] + ray[k] * along - target[k]));
    }
    this.state = { ...this.state, distance: next, target: moved, fit: false };
    this.#glide = null;
  }

  /** Moves the target by a drag in pixels. @param {number} dxPx @param {number} dyPx @param {View} view */
  pan(dxPx, dyPx, view) {
    const scale = view.worldPerPx * view.span;
    this.state = {
      ...this.state,
      target: vec((k) => this.state.target[k] + scale * (-dxPx * view.right[k] + dyPx * view.up[k])),
      fit: false,
    };
    this.#glide = null;
  }

  /** The angles at which the current motion ends, or the current angles. @returns {Angles} */
  get end() {
    const { yaw = this.state.yaw, pitch = this.state.pitch } = this.#glide ?? {};
    return { yaw, pitch };
  }

  /**
   * Moves the camera so that the whole ball is visible, or to a given distance; animated unless `jump` is set.
   * @param {Ball} ball
   * @param {{jump?: boolean, distance?: number}} [how]
   */
  fit(ball, { jump = false, distance = fitDistance(ball.radius) } = {}) {
    this.limits(ball.radius);
    const goal = { target: ball.centre, distance };
    this.state = { ...this.state, fit: true };
    if (jump || this.calm) {
      this.state = { ...this.state, ...goal };
      this.#glide = null;
    } else {
      this.#glide = { ...this.#glide, ...goal };
    }
  }

  /**
   * Moves gradually to a distance from the centre of a ball.
   * @param {Ball} ball @param {number} distance
   */
  glideTo({ centre }, distance) {
    const goal = { target: centre, distance: Math.max(this.#nearLimit, distance) };
    if (this.calm) this.state = { ...this.state, ...goal };
    else this.#glide = { ...this.#glide, ...goal };
  }

  /** Rotates gradually to these angles, the shorter way, and continues a fit in progress. @param {Angles} to */
  turnTo({ yaw, pitch }) {
    const { state } = this;
    const way = Math.atan2(Math.sin(yaw - state.yaw), Math.cos(yaw - state.yaw));
    const goal = { yaw: state.yaw + way, pitch: clamp(pitch, -PITCH_LIMIT_RAD, PITCH_LIMIT_RAD) };
    this.#yawPerS = 0;
    this.#pitchPerS = 0;
    if (this.calm) this.state = { ...state, ...goal, yaw: goal.yaw % (2 * Math.PI) };
    else this.#glide = { target: state.target, distance: state.distance, ...this.#glide, ...goal };
  }

  /**
   * Moves the camera so that a ball is seen along a normal, animated; the distance does not grow.
   * @param {Ball} ball
   * @param {Vec3} normal  towards the camera
   */
  lookAt({ centre, radius }, [x, y, z]) {
    const distance = Math.max(this.#nearLimit, Math.min(this.state.distance, fitDistance(radius)));
    const turn = Math.hypot(x, y) > 1e-6 ? Math.atan2(y, x) - this.state.yaw : 0;
    const goal = {
      target: centre,
      distance,
      // The shorter way.
      yaw: this.state.yaw + Math.atan2(Math.sin(turn), Math.cos(turn)),
      pitch: clamp(Math.atan2(z, Math.hypot(x, y)), -PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
    };
    this.rest();
    this.state = { ...this.state, fit: false };
    if (this.calm) this.state = { ...this.state, ...goal, yaw: goal.yaw % (2 * Math.PI) };
    else this.#glide = goal;
  }

  /**
   * Advances the motion by `dtS`.
   * @param {number} dtS
   * @returns whether the motion continues
   */
  step(dtS) {
    const keep = Math.exp(-dtS / EASE_S);
    let moving = false;
    if (this.#yawPerS !== 0 || this.#pitchPerS !== 0) {
      // The exact angle covered while the speed decays exponentially.
      const way = EASE_S * (1 - keep);
      this.orbit(this.#yawPerS * way, this.#pitchPerS * way);
      this.#yawPerS *= keep;
      this.#pitchPerS *= keep;
      if (Math.hypot(this.#yawPerS, this.#pitchPerS) < REST_RAD_PER_S) {
        this.#yawPerS = 0;
        this.#pitchPerS = 0;
      } else moving = true;
    }
    return this.#follow(keep) || moving;
  }

  /**
   * Advances an animation until the share `keep` of its way remains.
   * @param {number} keep
   * @returns whether it continues
   */
  #follow(keep) {
    if (!this.#glide) return false;
    const { state } = this;
    const { target, distance, yaw = state.yaw, pitch = state.pitch } = this.#glide;
    const log = Math.log(distance) + (Math.log(state.distance) - Math.log(distance)) * keep;
    const next = vec((k) => target[k] + (state.target[k] - target[k]) * keep);
    const turned = { yaw: yaw + (state.yaw - yaw) * keep, pitch: pitch + (state.pitch - pitch) * keep };
    const left =
      Math.hypot(next[0] - target[0], next[1] - target[1], next[2] - target[2]) / distance +
      Math.abs(log - Math.log(distance)) +
      Math.abs(turned.yaw - yaw) +
      Math.abs(turned.pitch - pitch);
    // The motion ends at a thousandth of the distance, which is less than a pixel.
    const ends = left < 1e-3;
    if (ends) this.#glide = null;
    this.state = ends
      ? { ...state, target, distance, yaw: yaw % (2 * Math.PI), pitch }
      : { ...state, ...turned, target: next, distance: Math.exp(log) };
    return !ends;
  }
}
