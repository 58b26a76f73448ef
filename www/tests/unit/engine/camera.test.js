import { describe, expect, test } from 'vitest';
import {
  axes,
  ballOf,
  Camera,
  fitDistance,
  outlineDistance,
  PITCH_LIMIT_RAD,
  projected,
  rayThrough,
  STANDARD_VIEWS,
  viewOf,
} from '../../../src/engine/view/camera.js';

/**
 * @import { Vec3 } from '../../../src/engine/types.js'
 * @import { Insets, View } from '../../../src/engine/view/types.js'
 */

const scene = { centre: /** @type {Vec3} */ ([0, 0, 0]), radius: 2 };
const size = /** @type {const} */ ([800, 600]);
const state = { target: /** @type {Vec3} */ ([0.3, -0.2, 0.1]), distance: 6, yaw: 0.7, pitch: 0.3, fit: false };

/**
 * Pixel and depth of a world point.
 * @param {View} view
 * @param {readonly number[]} p
 * @param {number} w
 * @param {number} h
 */
function project(view, p, w = size[0], h = size[1]) {
  const m = view.clipFromWorld;
  const c = [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
  return { x: (0.5 + c[0] / c[3] / 2) * w, y: (0.5 - c[1] / c[3] / 2) * h, depth: c[2] / c[3] };
}

describe('the view', () => {
  test('shows the target in the middle, upright, nearer things at smaller depth', () => {
    const view = viewOf(state, ...size, scene);
    const centre = project(view, state.target);
    expect(centre.x).toBeCloseTo(400, 3);
    expect(centre.y).toBeCloseTo(300, 3);
    expect(project(view, [0.3, -0.2, 0.6]).y).toBeLessThan(centre.y);
    const nearer = state.target.map((t, k) => t - view.forward[k]);
    expect(project(view, nearer).depth).toBeLessThan(centre.depth);
  });

  test('has the whole scene between near and far', () => {
    for (const yaw of [0, 1, 2.5, -2]) {
      const view = viewOf({ ...state, target: [0, 0, 0], yaw }, ...size, scene);
      for (const sign of [-2, 2]) {
        const depth = project(
          view,
          view.forward.map((f) => f * sign),
        ).depth;
        expect(depth).toBeGreaterThanOrEqual(0);
        expect(depth).toBeLessThanOrEqual(1);
      }
    }
  });

  test('keeps circles round in any shape of picture', () => {
    for (const [w, h] of /** @type {[number, number][]} */ ([
      [800, 600],
      [390, 844],
      [3840, 1000],
    ])) {
      const view = viewOf(state, w, h, scene);
      const c = project(view, state.target, w, h);
      const right = project(
        view,
        state.target.map((t, k) => t + 0.1 * view.right[k]),
        w,
        h,
      );
      const up = project(
        view,
        state.target.map((t, k) => t + 0.1 * view.up[k]),
        w,
        h,
      );
      expect(right.x - c.x).toBeCloseTo(c.y - up.y, 2);
    }
  });

  test('centres the target in what panels leave free', () => {
    const insets = { left: 300, right: 100, top: 0, bottom: 80 };
    const view = viewOf(state, ...size, scene, insets);
    const c = project(view, state.target);
    expect(c.x).toBeCloseTo(500, 2);
    expect(c.y).toBeCloseTo(260, 2);
    const ray = rayThrough(view, 500, 260);
    for (let k = 0; k < 3; k += 1) expect(ray[k]).toBeCloseTo(view.forward[k], 6);
  });

  test('survives panels that cover everything', () => {
    for (const insets of [
      { left: 900, right: 900, top: 600, bottom: 0 },
      { left: Number.NaN, right: -50, top: 0, bottom: 1e9 },
    ]) {
      const view = viewOf(state, ...size, scene, insets);
      const c = project(view, state.target);
      expect(c.x).toBeGreaterThan(0);
      expect(c.x).toBeLessThan(800);
      expect(c.y).toBeGreaterThan(0);
      expect(c.y).toBeLessThan(600);
      const edge = project(
        view,
        state.target.map((t, k) => t + 0.5 * view.right[k]),
      );
      expect(edge.x - c.x).toBeGreaterThan(15);
    }
  });

  test('rays go through what is drawn at their pixel', () => {
    const view = viewOf(state, ...size, scene, { left: 120, right: 0, top: 10, bottom: 50 });
    const p = [1.1, -0.4, 0.8];
    const at = project(view, p);
    const ray = rayThrough(view, at.x, at.y);
    const way = p.map((c, k) => c - view.eye[k]);
    const length = Math.hypot(...way);
    for (let k = 0; k < 3; k += 1) expect(ray[k]).toBeCloseTo(way[k] / length, 5);
  });
});

describe('a place in the picture', () => {
  test('is where the ray through it goes, and as large as it looks', () => {
    const view = viewOf(state, ...size, scene, { left: 120, right: 0, top: 0, bottom: 40 });
    const place = [0.9, 0.4, -0.5];
    const spot = projected(view, place);
    if (!spot) throw new Error('behind the eye');
    const ray = rayThrough(view, spot.x, spot.y);
    const way = place.map((c, k) => c - view.eye[k]);
    const length = Math.hypot(...way);
    for (const k of [0, 1, 2]) expect(way[k] / length).toBeCloseTo(ray[k], 5);
    const beside = projected(
      view,
      place.map((c, k) => c + 10 * spot.perPx * view.right[k]),
    );
    expect(beside?.x).toBeCloseTo(spot.x + 10, 2);
    expect(beside?.y).toBeCloseTo(spot.y, 2);
  });

  test('is nowhere behind the eye', () => {
    const view = viewOf(state, ...size, scene);
    expect(
      projected(
        view,
        view.eye.map((c, k) => c - view.forward[k]),
      ),
    ).toBe(null);
  });
});

describe('the camera', () => {
  test('glides before a place and ends facing it, by the shorter way', () => {
    const camera = new Camera({ ...state, yaw: 3 });
    const normal = /** @type {Vec3} */ ([-0.6, -0.64, 0.48]);
    camera.lookAt({ centre: [1, 0, 0], radius: 0.05 }, normal);
    expect(camera.state.fit).toBe(false);
    let turned = 0;
    for (let i = 0, last = camera.state.yaw; i < 200 && camera.step(1 / 60); i += 1) {
      turned += Math.abs(camera.state.yaw - last);
      last = camera.state.yaw;
    }
    expect(turned).toBeLessThan(Math.PI);
    const { forward } = axes(camera.state);
    for (const k of [0, 1, 2]) expect(forward[k]).toBeCloseTo(-normal[k], 2);
    expect(camera.state.target).toEqual([1, 0, 0]);
    expect(camera.state.distance).toBeCloseTo(fitDistance(0.05), 6);
    // A large place does not take the camera away.
    camera.lookAt({ centre: [1, 0, 0], radius: 50 }, normal);
    while (camera.step(1 / 60));
    expect(camera.state.distance).toBeCloseTo(fitDistance(0.05), 6);
  });

  test('turns to the end where a fit comes between', () => {
    const camera = new Camera(state);
    camera.turnTo({ yaw: 1.5, pitch: 0.4 });
    camera.step(1 / 60);
    camera.fit({ centre: [1, 1, 1], radius: 3 });
    while (camera.step(1 / 60));
    expect(camera.state).toMatchObject({ yaw: 1.5, pitch: 0.4, target: [1, 1, 1], distance: fitDistance(3) });
  });

  test('is before a place at once where motion is reduced', () => {
    const camera = new Camera(state);
    camera.calm = true;
    camera.lookAt({ centre: [1, 0, 0], radius: 0.05 }, [0, 0, 1]);
    expect(camera.state.pitch).toBe(PITCH_LIMIT_RAD);
    expect(camera.state.target).toEqual([1, 0, 0]);
    expect(camera.step(1 / 60)).toBe(false);
  });

  test('keeps the point under the cursor while zooming', () => {
    const camera = new Camera(state);
    const before = viewOf(camera.state, ...size, scene);
    const at = { view: before, xPx: 650, yPx: 120 };
    const ray = rayThrough(before, 650, 120);
    const along =
      state.distance / (ray[0] * before.forward[0] + ray[1] * before.forward[1] + ray[2] * before.forward[2]);
    const point = before.eye.map((e, k) => e + along * ray[k]);
    camera.zoom(1.7, at);
    const after = project(viewOf(camera.state, ...size, scene), point);
    expect(after.x).toBeCloseTo(650, 2);
    expect(after.y).toBeCloseTo(120, 2);
    expect(camera.state.distance).toBeCloseTo(6 / 1.7, 9);
    expect(camera.state.fit).toBe(false);
  });

  test('moves the surface with the hand when panning', () => {
    const camera = new Camera(state);
    const before = viewOf(camera.state, ...size, scene);
    camera.pan(37, -21, before);
    const moved = project(viewOf(camera.state, ...size, scene), state.target);
    expect(moved.x).toBeCloseTo(437, 1);
    expect(moved.y).toBeCloseTo(279, 1);
  });

  test('turns the near side with the hand, and never over the pole', () => {
    const camera = new Camera({ ...state, target: [0, 0, 0] });
    const near = () => viewOf(camera.state, ...size, scene).forward.map((f) => -f);
    const point = near();
    camera.orbit(0.2, 0);
    expect(project(viewOf(camera.state, ...size, scene), point).x).toBeGreaterThan(400);
    camera.orbit(-0.2, 0.2);
    expect(project(viewOf(camera.state, ...size, scene), point).y).toBeGreaterThan(300);
    camera.orbit(0, 50);
    expect(camera.state.pitch).toBe(PITCH_LIMIT_RAD);
  });

  test('comes to rest after a throw, and covers the same way at any frame rate', () => {
    const ways = [30, 60, 144].map((hz) => {
      const camera = new Camera({ ...state, yaw: 0 });
      camera.fling(2, 0);
      let frames = 0;
      while (camera.step(1 / hz)) frames += 1;
      expect(frames / hz).toBeLessThan(1.5);
      return camera.state.yaw;
    });
    expect(ways[1]).toBeCloseTo(ways[0], 3);
    expect(ways[2]).toBeCloseTo(ways[0], 3);
  });

  test('is still at once where motion is reduced', () => {
    const camera = new Camera(state);
    camera.calm = true;
    camera.fling(5, 5);
    expect(camera.step(1 / 60)).toBe(false);
    camera.fit({ centre: [1, 1, 1], radius: 3 });
    expect(camera.step(1 / 60)).toBe(false);
    expect(camera.state).toMatchObject({ target: [1, 1, 1], distance: fitDistance(3), fit: true });
  });

  test('a fit shows the whole ball and nothing less', () => {
    const camera = new Camera(state);
    const ball = ballOf({ min: [-1, -2, -3], max: [3, 2, 1] });
    camera.fit(ball);
    while (camera.step(1 / 60));
    const view = viewOf(camera.state, ...size, ball);
    const c = project(view, ball.centre);
    // A ball's outline is seen under asin(radius / distance).
    const outlinePx = Math.tan(Math.asin(ball.radius / camera.state.distance)) / view.worldPerPx;
    expect(c.x).toBeCloseTo(400, 3);
    expect(outlinePx).toBeLessThan(300);
    expect(outlinePx).toBeGreaterThan(270);
  });

  describe('a fit by the outline', () => {
    const free = { width: 800, height: 600 };
    /** Discs along an axis through the origin. @param {(t: number) => number[]} place */
    const along = (place, count = 41) => ({
      positions: Array.from({ length: count }, (_, i) => place((2 * i) / (count - 1) - 1)).flat(),
      radii: new Float32Array(count).fill(0.01),
      count,
    });
    const ball = { centre: /** @type {[number, number, number]} */ ([0, 0, 0]), radius: 1.01 };

    test('fills its share of the picture, whichever side is the shorter one for the surface', () => {
      for (const [yaw, pitch] of [
        [0, 0],
        [0.62, 0.42],
        [2, -1],
      ]) {
        // Nearly as wide as the ball, and far from as high.
        const [s, c] = [Math.sin(yaw), Math.cos(yaw)];
        const discs = along((t) => [-0.9 * t * s, 0.9 * t * c, 0]);
        const distance = outlineDistance({ yaw, pitch }, ball, free, discs);
        const view = viewOf({ ...state, yaw, pitch, target: [0, 0, 0], distance }, ...size, ball);
        const xs = [0, 40].map((i) => project(view, discs.positions.slice(3 * i, 3 * i + 3)).x);
        const share = Math.abs(xs[1] - xs[0]) / free.width;
        expect(distance).toBeCloseTo(0.8 * fitDistance(ball.radius), 9);
        expect(share).toBeLessThan(0.93);
      }
    });

    test('is between the distance that shows the whole ball and 0.8 of it, and exact in between', () => {
      const angles = { yaw: 0, pitch: 0 };
      const whole = fitDistance(ball.radius);
      for (const size of [0.2, 0.5, 0.85, 0.95, 1]) {
        const discs = along((t) => [0, 0, size * t]);
        const distance = outlineDistance(angles, ball, free, discs);
        expect(distance).toBeGreaterThanOrEqual(0.8 * whole);
        expect(distance).toBeLessThanOrEqual(whole);
        const view = viewOf({ ...state, ...angles, target: [0, 0, 0], distance }, free.width, free.height, ball);
        const [top, bottom] = [project(view, [0, 0, size + 0.01]).y, project(view, [0, 0, -size - 0.01]).y];
        if (distance > 0.8 * whole && distance < whole) expect((bottom - top) / free.height).toBeCloseTo(0.93, 6);
        expect(bottom - top).toBeLessThan(0.96 * free.height);
      }
    });

    test('leaves a corner free, by no more than that takes', () => {
      const angles = { yaw: 0, pitch: 0 };
      // From the lower left to the upper right, as seen from the front of x.
      const [rising, falling] = [along((t) => [0, 0.7 * t, 0.7 * t]), along((t) => [0, -0.7 * t, 0.7 * t])];
      const corner = { width: 300, height: 100 };
      const at = (/** @type {typeof rising} */ discs, /** @type {Insets['corner']} */ kept) =>
        outlineDistance(angles, ball, { ...free, corner: kept }, discs);
      expect(at(rising, corner)).toBe(at(rising, undefined));
      const distance = at(falling, corner);
      expect(distance).toBeGreaterThan(at(falling, undefined));
      const view = viewOf({ ...state, ...angles, target: [0, 0, 0], distance }, free.width, free.height, ball);
      const { x, y } = project(view, [0, -0.7, 0.7]);
      expect(x > corner.width || y > corner.height).toBe(true);
      expect(Math.min(Math.abs(x - corner.width), Math.abs(y - corner.height))).toBeLessThan(10);
      expect(at(falling, { width: 790, height: 590 })).toBe(1.25 * fitDistance(ball.radius));
    });

    test('takes the discs alone that are shown', () => {
      const discs = along((t) => [0, 0, t]);
      const all = outlineDistance({ yaw: 0, pitch: 0 }, ball, free, discs);
      const some = outlineDistance({ yaw: 0, pitch: 0 }, ball, free, discs, (i) => Math.abs(i - 20) < 10);
      expect(some).toBeLessThan(all);
    });
  });

  test('refuses to zoom to nothing, through the target or away for ever', () => {
    const camera = new Camera(state);
    camera.limits(2);
    for (const factor of [0, -1, Number.NaN, Infinity]) camera.zoom(factor);
    expect(camera.state.distance).toBe(6);
    camera.zoom(1e9);
    expect(camera.state.distance).toBeCloseTo(0.04, 9);
    camera.zoom(1e-9);
    expect(camera.state.distance).toBe(120);
  });
});

describe('an orthographic view', () => {
  const about = { target: /** @type {[number, number, number]} */ ([1, 2, 3]), distance: 5, fit: false };
  /** @param {keyof typeof STANDARD_VIEWS} name */
  const seen = (name) =>
    viewOf({ ...about, ...STANDARD_VIEWS[name] }, 800, 600, { centre: [1, 2, 3], radius: 2 }, undefined, true);
  /** @param {ReturnType<typeof viewOf>} view @param {number[]} place */
  const at = (view, place) => {
    const spot = projected(view, place);
    if (!spot) throw new Error('behind the eye');
    return spot;
  };

  test('keeps the size of what is farther away, and that of the target as in perspective', () => {
    const view = seen('isometric');
    const { x, y, perPx } = at(view, [1, 2, 3]);
    expect([x, y]).toEqual([expect.closeTo(400), expect.closeTo(300)]);
    const near = viewOf({ ...about, ...STANDARD_VIEWS.isometric }, 800, 600, { centre: [1, 2, 3], radius: 2 });
    expect(perPx).toBeCloseTo(at(near, [1, 2, 3]).perPx, 6);
    const axes = [at(view, [2, 2, 3]), at(view, [1, 3, 3]), at(view, [1, 2, 4])].map((p) =>
      Math.hypot(p.x - x, p.y - y),
    );
    expect(axes).toEqual([0, 1, 2].map(() => expect.closeTo(axes[0], 3)));
    const behind = view.forward.map((f, k) => about.target[k] + 1.5 * f);
    expect(at(view, behind)).toMatchObject({ x: expect.closeTo(400, 2), y: expect.closeTo(300, 2), perPx });
  });

  test('is drawn between its near and far planes, and its rays meet what is under them', () => {
    const view = seen('front');
    const place = [1.7, 3.5, 2.1];
    const m = view.clipFromWorld;
    const row = (/** @type {number} */ k) => m[k] * place[0] + m[4 + k] * place[1] + m[8 + k] * place[2] + m[12 + k];
    expect(row(3)).toBe(1);
    expect(row(2)).toBeGreaterThan(0.5);
    expect(row(2)).toBeLessThan(1);
    const { x, y, perPx } = at(view, place);
    const ray = rayThrough(view, x, y);
    const way = place.map((c, k) => c - view.eye[k]);
    const along = way.reduce((sum, c, k) => sum + c * ray[k], 0);
    expect(Math.hypot(...way.map((c, k) => c - along * ray[k]))).toBeLessThan(0.5 * perPx);
  });

  test('from the front has x to the right and z up, from the right y, from the top y up', () => {
    const from = (/** @type {keyof typeof STANDARD_VIEWS} */ name, /** @type {number[]} */ step) => {
      const { x, y } = at(
        seen(name),
        step.map((d, k) => d + about.target[k]),
      );
      return [Math.sign(Math.round(x - 400)), Math.sign(Math.round(300 - y))];
    };
    expect([from('front', [1, 0, 0]), from('front', [0, 0, 1]), from('front', [0, 1, 0])]).toEqual([
      [1, 0],
      [0, 1],
      [0, 0],
    ]);
    expect([from('right', [0, 1, 0]), from('right', [0, 0, 1])]).toEqual([
      [1, 0],
      [0, 1],
    ]);
    expect([from('top', [1, 0, 0]), from('top', [0, 1, 0]), from('top', [0, 0, 1])]).toEqual([
      [1, 0],
      [0, 1],
      [0, 0],
    ]);
  });
});
