/** What is in the picture, by the painter: levels, the cutting plane, the inside, and when it is drawn at all. */
import { describe, expect, test } from 'vitest';
import { PALETTES } from '../../src/engine/view/palettes.js';
import { halvesOf, INSIDE_TOLD, isInsideTold, SIDES, shadeOf } from '../pixels.js';
import { coarse, eventually, expectSurface, hide, link, open, pause, picture, turn, until, wishes } from './engine.js';

/** @import { Console } from '../../src/main/types.js' */

const MIDDLE = /** @type {const} */ ([80, 60]);

describe('levels', () => {
  /** Faces the seed, or the side beyond it, and holds the camera, which would frame them. @param {Console} p */
  const faceSeed = (p, turned = 0) => {
    const [x, y, z] = p.particles().normals;
    const [yaw, pitch] = [Math.atan2(y, x), Math.asin(Math.max(-1, Math.min(1, z)))];
    const camera = { ...p.state.view.camera, yaw: yaw + turned, pitch: turned ? -pitch : pitch, fit: false };
    p.engine.setView({ camera });
  };

  test('a level hides the later ones and mutes the earlier ones', async () => {
    const p = await open();
    faceSeed(p);
    const drawn = [];
    for (const level of [0, 2, 5, null]) {
      p.engine.setView({ level });
      drawn.push((await picture(p)).coloured);
    }
    for (let k = 1; k < drawn.length; k += 1) expect(drawn[k]).toBeGreaterThan(1.5 * drawn[k - 1]);
    // The seed is in the middle of what is drawn: pure in its own level, paler in the next.
    const [x, y, z] = p.particles().positions;
    p.engine.setView({ size: 1.5, camera: { ...p.state.view.camera, target: [x, y, z], fit: false } });
    const shades = [];
    for (const level of [0, 1]) {
      p.engine.setView({ level });
      const { middle, corner } = await picture(p);
      shades.push(Math.hypot(...[0, 1, 2].map((k) => middle[k] - corner[k])));
    }
    expect(shades[1]).toBeLessThan(0.8 * shades[0]);
    expect(shades[1]).toBeGreaterThan(0.2 * shades[0]);
  });

  test('to go from level to level costs a frame, or two where it then stands still, and nothing is told to the device again', async () => {
    const p = await open();
    p.engine.setView({ level: 1 });
    await p.debug.still();
    const before = p.debug.counts();
    for (const level of [2, 3, 7]) {
      const { frames } = p.debug.counts();
      p.engine.setView({ level });
      await eventually(() => p.debug.counts().frames).toBeGreaterThan(frames);
    }
    await p.debug.still();
    const { frames, uploads } = p.debug.counts();
    expect(uploads).toBe(before.uploads);
    expect(frames - before.frames).toBeLessThanOrEqual(6);
  });

  test('a front that grows is framed as it is, until a hand takes the camera', async () => {
    const p = await open();
    /** @param {number | null} level */
    const distanceAt = async (level) => {
      p.engine.setView({ level });
      await p.debug.still();
      return p.state.view.camera.distance;
    };
    const distances = [];
    for (const level of [2, 6, 10, null]) distances.push(await distanceAt(level));
    for (let k = 1; k < distances.length; k += 1) expect(distances[k]).toBeGreaterThan(distances[k - 1]);
    p.engine.zoom(1.25);
    const held = await distanceAt(null);
    expect(await distanceAt(2)).toBe(held);
  });

  test('what is hidden is not picked', async () => {
    const p = await open();
    faceSeed(p, Math.PI);
    const { levels } = p.particles();
    expect(levels[p.engine.pick(...MIDDLE) ?? 0]).toBeGreaterThan(5);
    p.engine.setView({ level: 5 });
    expect(levels[p.engine.pick(...MIDDLE) ?? 0]).toBeLessThanOrEqual(5);
  });

  test('a link with a level shows it, also after the device was lost', async () => {
    const first = await open(link(coarse));
    faceSeed(first);
    const { camera } = first.state.view;
    const p = await open(link({ ...coarse, view: { level: 4, camera } }));
    const before = await picture(p);
    expect(before.coloured).toBeGreaterThan(0.002);
    p.engine.setView({ level: null });
    expect((await picture(p)).coloured).toBeGreaterThan(2 * before.coloured);
    p.engine.setView({ level: 4 });
    p.debug.loseDevice();
    await eventually(() => p.debug.counts().opened).toBe(2);
    expect((await picture(p)).coloured).toBeCloseTo(before.coloured, 2);
  });
});

describe('the cutting plane', () => {
  /** Seen from +x with z up: +y is on the right. */
  const camera = {
    target: /** @type {[number, number, number]} */ ([0, 0, 0]),
    distance: 6,
    yaw: 0,
    pitch: 0,
    fit: false,
  };

  test('hides the side of its normal, and samples nothing anew', async () => {
    const p = await open();
    p.engine.setView({ camera });
    const { run } = p.engine.progress.value;
    const halves = async () => halvesOf(await p.pixels(160, 120));
    const whole = await halves();
    expect(Math.min(...whole)).toBeGreaterThan(0.05);
    p.engine.setPlane({ normal: [0, 1, 0], offset: 0 });
    const left = await halves();
    expect(left[0]).toBeCloseTo(whole[0], 2);
    // Discs are whole: those at the plane reach beyond it.
    expect(left[1]).toBeLessThan(0.2 * whole[1]);
    // The normal need not have length 1.
    p.engine.setPlane({ normal: [0, -4, 0], offset: 0 });
    const right = await halves();
    expect(right[1]).toBeCloseTo(whole[1], 2);
    expect(right[0]).toBeLessThan(0.2 * whole[0]);
    p.engine.setPlane(null);
    expect(await halves()).toEqual(whole);
    expect(p.engine.progress.value.run).toBe(run);
  });

  test('what it hides is not picked, and what is behind it is', async () => {
    const p = await open();
    p.engine.setView({ camera });
    /** The place along x of what is under the middle. */
    const picked = () => {
      const index = p.engine.pick(...MIDDLE);
      return index === null ? null : p.particles().positions[3 * index];
    };
    expect(picked()).toBeGreaterThan(0.9);
    p.engine.setPlane({ normal: [1, 0, 0], offset: 0 });
    expect(picked()).toBeLessThan(-0.9);
    p.engine.setPlane({ normal: [1, 0, 0], offset: -2 });
    expect(picked()).toBe(null);
  });
});

test('creases are lines, on which dots are picked once', async () => {
  const p = await open();
  p.engine.setView({ theme: 'light' });
  await p.set({ formula: 'max(abs(x), abs(y), abs(z)) = 1', settings: { radius_share: 0.03 } });
  /** Number of pixels in about the colour of creases, whose edges are smooth. */
  const inked = async () => {
    const { pixels } = await p.pixels(160, 120);
    const [ink, at] = [
      PALETTES.light.ink,
      (/** @type {number} */ pixel, /** @type {number} */ k) => (pixel >> (8 * k)) & 255,
    ];
    return new Uint32Array(pixels.buffer).filter((pixel) =>
      [0, 1, 2].every((k) => Math.abs(at(pixel, k) - at(ink, k)) < 32),
    ).length;
  };
  expect(await inked()).toBeGreaterThan(100);
  p.engine.setView({ creases: false });
  expect(await inked()).toBe(0);
  // The corner (1, 1, 1) has a row on each of three faces.
  const { positions } = p.particles();
  const rows = Array.from({ length: positions.length / 3 }, (_, i) => i).filter((i) =>
    [0, 1, 2].every((k) => Math.abs(positions[3 * i + k] - 1) < 1e-4),
  );
  expect(rows).toHaveLength(3);
  const camera = { target: /** @type {[number, number, number]} */ ([1, 1, 1]), distance: 4, yaw: 0.6, pitch: 0.5 };
  p.engine.setView({ camera: { ...camera, fit: false } });
  expect(p.engine.pick(...MIDDLE)).toBe(rows[0]);
});

describe('the body', () => {
  /** Share of a picture in which something is drawn, however faintly. @param {Console} p */
  async function covered(p) {
    const words = new Uint32Array((await p.pixels(320, 240)).pixels.buffer);
    return words.filter((word) => word !== words[0]).length / words.length;
  }

  test('closes the gaps between discs, of whatever size they are', async () => {
    const p = await open();
    const shares = [];
    for (const look of [
      { size: 0.92, body: true },
      { size: 0.4, body: true },
      { size: 0.4, body: false },
    ]) {
      p.engine.setView(look);
      shares.push(await covered(p));
    }
    const [usual, small, bare] = shares;
    expect(small).toBeCloseTo(usual, 2);
    expect(bare).toBeLessThan(0.9 * usual);
  });

  test('of a level shows the surface to come, fainter than what is there', async () => {
    const p = await open();
    p.engine.setView({ camera: { ...p.state.view.camera, fit: false } });
    const whole = await covered(p);
    p.engine.setView({ level: 2, colour: 'plain' });
    expect(await covered(p)).toBeCloseTo(whole, 2);
    // Of the whole the middle is a disc or the body beneath it.
    const { ground, light: faint } = shadeOf(await p.pixels(160, 120));
    p.engine.setView({ level: null });
    const { light } = shadeOf(await p.pixels(160, 120));
    expect(Math.abs(faint - ground)).toBeLessThan(0.6 * Math.abs(light - ground));
  });
});

test('with parallel rays, too, what is in front hides what is behind', async () => {
  const p = await open();
  await p.set({ formula: 'x^2 + y^2 + z^2 = 1', settings: { radius_share: 0.02 } });
  p.engine.setView({ colour: 'plain', theme: 'light' });
  const lights = [];
  for (const projection of /** @type {const} */ (['perspective', 'orthographic'])) {
    p.engine.setView({ projection });
    lights.push(shadeOf(await p.pixels(160, 120)).light);
  }
  // Where the back of the far side is seen, it is darker.
  expect(lights[1]).toBeGreaterThan(0.97 * lights[0]);
});

test('discs seen from behind are darker and greyer, on a light and on a dark ground', async () => {
  const p = await open();
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    p.engine.setView({ theme, size: 1.1, colour: 'plain' });
    const pictures = [];
    for (const side of SIDES) {
      await p.set(side);
      pictures.push(await p.pixels(160, 120));
    }
    expect(isInsideTold(pictures), theme).toEqual(INSIDE_TOLD);
  }
});

test('nothing is drawn while nothing happens', async () => {
  const p = await open();
  await p.debug.still();
  const { frames } = p.debug.counts();
  await turn(10_000);
  await pause(50);
  expect(p.debug.counts().frames).toBe(frames);
});

test('a hidden tab draws nothing and samples on; shown again it has the new surface', async () => {
  const p = await open();
  const before = await picture(p);
  await p.debug.still();
  hide(true);
  const { frames } = p.debug.counts();
  const report = await p.set({ surface: 'sphere', ...coarse });
  expect(report).toMatchObject({ stop_reason: 'complete', quality: { euler: 2 } });
  await pause(100);
  expect(p.debug.counts().frames).toBe(frames);
  hide(false);
  await eventually(() => p.debug.counts().frames).toBeGreaterThan(frames);
  await expectSurface(p);
  expect((await picture(p)).drawn).not.toBe(before.drawn);
});

test('a tab hidden while the surface grows is not stuck half-way', async () => {
  wishes.reducedMotion = false;
  const p = await open();
  p.engine.run();
  await until(p.engine.reveal, (reveal) => reveal);
  hide(true);
  await until(p.engine.status, (status) => status !== 'sampling');
  hide(false);
  await until(p.engine.reveal, (reveal) => reveal === null);
  await expectSurface(p);
});
