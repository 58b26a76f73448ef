import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { ballOf } from '../../../src/engine/view/camera.js';
import { Dimmer } from '../../../src/engine/view/dimmer.js';
import { Scene } from '../../../src/engine/view/scene.js';

/** @import { Bounds } from '../../../src/engine/types.js' */

/** @returns {Bounds} */
const cube = (/** @type {number} */ side) => ({ min: [-side, -side, -side], max: [side, side, side] });

describe('a fit', () => {
  test('shows the clip box while there is no particle, all of it only where it is drawn', () => {
    const scene = new Scene();
    scene.bounds = cube(2);
    const columns = new Columns();
    expect(scene.fitBall(columns, true).radius).toBeCloseTo(2 * Math.sqrt(3));
    expect(scene.fitBall(columns, false).radius).toBeLessThan(2 * Math.sqrt(3));
  });

  test('shows the particles with their discs, those of an earlier field with the clip box where it is drawn', () => {
    const scene = new Scene();
    scene.bounds = { min: [0, 0, 0], max: [3, 1, 1] };
    const columns = new Columns();
    columns.write({
      first: 0,
      total: 2,
      positions: Float32Array.of(-1, 0, 0, 1, 0, 0),
      normals: new Float32Array(6),
      radii: Float32Array.of(0.25, 0.25),
      levels: new Uint32Array(2),
      parents: new Uint32Array(2),
    });
    expect(scene.fitBall(columns, false)).toEqual({ centre: [0, 0, 0], radius: 1.25 });
    // With room for the axes around them, or for the clip box, where those are drawn.
    expect(scene.fitBall(columns, false, true)).toEqual(
      ballOf({ min: [-1.25, -0.25, -0.25], max: [1.25, 0.25, 0.25] }),
    );
    expect(scene.fitBall(columns, true)).toEqual(scene.boxBall(true));
    columns.stale = true;
    expect(scene.fitBall(columns, false)).toEqual({ centre: [0, 0, 0], radius: 1.25 });
    // From -1.25 to 3 along x.
    const { centre, radius } = scene.fitBall(columns, true);
    expect(centre[0]).toBeCloseTo(0.875);
    expect(radius).toBeCloseTo(Math.hypot(4.25, 1.25, 1.25) / 2);
  });

  test('is as small as the particles of a tiny box', () => {
    const columns = new Columns();
    columns.write({
      first: 0,
      total: 2,
      positions: Float32Array.of(-1e-10, 0, 0, 1e-10, 0, 0),
      normals: new Float32Array(6),
      radii: Float32Array.of(1e-11, 1e-11),
      levels: new Uint32Array(2),
      parents: new Uint32Array(2),
    });
    expect(new Scene().fitBall(columns, false).radius).toBeCloseTo(1.1e-10, 14);
  });

  test('is within planes that enclose the box on the page and the one asked for', () => {
    const scene = new Scene();
    scene.bounds = cube(1);
    scene.shown = cube(3);
    expect(scene.ball().radius).toBeCloseTo(3 * Math.sqrt(3));
  });
});

describe('dimming', () => {
  test('comes and goes gradually, from where it is', () => {
    const dimmer = new Dimmer();
    expect(dimmer.set(false, 1, false)).toBe(false);
    expect(dimmer.set(true, 1, false)).toBe(true);
    const half = dimmer.at(1.075, false);
    expect(half).toBeGreaterThan(0);
    expect(half).toBeLessThan(dimmer.at(2, false));
    dimmer.set(false, 1.075, false);
    expect(dimmer.at(1.075, false)).toBeCloseTo(half);
    expect(dimmer.moving).toBe(true);
    expect(dimmer.at(2, false)).toBe(0);
    expect(dimmer.moving).toBe(false);
  });

  test('moves until its end is drawn, though a picture takes longer than the fade', () => {
    const dimmer = new Dimmer();
    dimmer.set(true, 1, false);
    // The first picture begins with the fade and is complete long after it.
    dimmer.at(1, false);
    expect(dimmer.moving).toBe(true);
    dimmer.at(5, false);
    expect(dimmer.moving).toBe(false);
  });

  test('is there at once where motion is not wanted', () => {
    const dimmer = new Dimmer();
    dimmer.set(true, 1, true);
    expect(dimmer.at(1, true)).toBe(dimmer.at(9, false));
  });
});
