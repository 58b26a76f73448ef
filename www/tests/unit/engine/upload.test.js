import { describe, expect, test } from 'vitest';
import { Columns } from '../../../src/engine/columns.js';
import { Reveal } from '../../../src/engine/view/reveal.js';
import { firstLook } from '../../../src/engine/view/style.js';
import { MOST_UPLOADED, ParticleUpload } from '../../../src/engine/view/upload.js';

/** @import { ColourMode } from '../../../src/engine/types.js' */

const nowS = 10;

/** Columns of so many particles, of growing radius and two to a level. @param {number} n */
function columnsOf(n) {
  const columns = new Columns();
  columns.write({
    first: 0,
    total: n,
    positions: new Float32Array(3 * n),
    normals: new Float32Array(3 * n),
    radii: Float32Array.from({ length: n }, (_, i) => 1 + i),
    levels: Uint32Array.from({ length: n }, (_, i) => i >> 1),
    parents: new Uint32Array(n),
  });
  return columns;
}

/** A device that notes what it is told, in words. */
function device() {
  /** @type {string[]} */
  const told = [];
  const renderer = /** @type {any} */ ({
    max_particles: () => 1000,
    write: (/** @type {number} */ first, /** @type {Float32Array} */ positions) =>
      told.push(`particles ${first}..${first + positions.length / 3}`),
    write_colours: (/** @type {number} */ first, /** @type {Uint32Array} */ colours) =>
      told.push(`colours ${first}..${first + colours.length}`),
  });
  return { renderer, told };
}

/** @param {ColourMode} colour */
const look = (colour) => ({ ...firstLook(/** @type {any} */ ({ colour, size: 1 })) });
const present = () => ({ reveal: new Reveal(), calm: true, nowS });

describe('a device', () => {
  test('is told once what is new, and nothing while nothing is', () => {
    const { renderer, told } = device();
    const upload = new ParticleUpload(columnsOf(6));
    upload.restart();
    expect(upload.write(renderer, look('level'), present())).toBe(6);
    upload.write(renderer, look('level'), present());
    upload.changed(4, 6);
    upload.recolour(1, 3);
    upload.write(renderer, look('level'), present());
    expect(told).toEqual(['particles 0..6', 'particles 4..6', 'colours 1..3']);
    expect(upload.writes).toBe(3);
  });

  test('lacks colours that have changed, and not only particles', () => {
    const { renderer } = device();
    const upload = new ParticleUpload(columnsOf(6));
    upload.restart();
    upload.write(renderer, look('level'), present());
    expect(upload.isWhole).toBe(true);
    upload.recolour(0, 6);
    expect(upload.isWhole).toBe(false);
    upload.write(renderer, look('level'), present());
    expect(upload.isWhole).toBe(true);
  });

  test('is told of more particles than a frame has time for in parts', () => {
    const { renderer, told } = device();
    const upload = new ParticleUpload(columnsOf(2 * MOST_UPLOADED + 3));
    upload.restart();
    const held = [];
    do held.push(upload.write(renderer, look('level'), present()));
    while (!upload.isWhole);
    expect(held).toEqual([MOST_UPLOADED, 2 * MOST_UPLOADED, 2 * MOST_UPLOADED + 3]);
    expect(told).toEqual([
      `particles 0..${MOST_UPLOADED}`,
      `particles ${MOST_UPLOADED}..${2 * MOST_UPLOADED}`,
      `particles ${2 * MOST_UPLOADED}..${2 * MOST_UPLOADED + 3}`,
    ]);
    // What has moved is on the device already.
    upload.changed(0, 2);
    expect(upload.write(renderer, look('level'), present())).toBe(2 * MOST_UPLOADED + 3);
  });

  test('is told every colour anew when the ends of the ramp move', () => {
    const { renderer, told } = device();
    const columns = columnsOf(6);
    const upload = new ParticleUpload(columns);
    upload.restart();
    upload.write(renderer, look('radius'), present());
    told.length = 0;
    columns.radii[5] = 100;
    upload.changed(5, 6);
    upload.write(renderer, look('radius'), present());
    expect(told).toEqual(['particles 5..6', 'colours 0..5']);
  });

  test('is told a surface that is revealed level by level', () => {
    const { renderer, told } = device();
    const upload = new ParticleUpload(columnsOf(6));
    upload.restart();
    const reveal = new Reveal();
    reveal.begin(nowS);
    upload.write(renderer, look('level'), { ...present(), reveal });
    expect(told).toEqual(['particles 0..2', 'particles 2..4', 'particles 4..6']);
  });
});
