/**
 * Computes the small images of the gallery as files. Only sums, products and roots are used, so that the voxels are the
 * same in every browser.
 *
 * @module
 */

const SIDE = 64;
const MIDDLE = (SIDE - 1) / 2;

/** Random numbers from −1 to 1, by a linear congruence (Numerical Recipes, 1992); the same sequence each time. */
function noise() {
  let state = 1;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 31 - 1;
  };
}

/** A wave of period 1, similar to a sine but made of parabolas. @param {number} t */
function wave(t) {
  const u = 2 * (t - Math.floor(t)) - 1;
  return -4 * u * (1 - Math.abs(u));
}

/** @param {number} x @param {number} y @param {number} z @param {number} period */
function gyroid(x, y, z, period) {
  const [a, b, c] = [x / period, y / period, z / period];
  return wave(a) * wave(b + 0.25) + wave(b) * wave(c + 0.25) + wave(c) * wave(a + 0.25);
}

/** @typedef {(x: number, y: number, z: number, random: () => number) => number} Value */

/** A network of struts of varying thickness. @type {Value} */
function bone(x, y, z, random) {
  const bend = 3 * wave(z / 47);
  const struts = gyroid(x + bend, y - bend, 0.8 * z, 26);
  const share = 0.5 + 1.5 * (struts - 0.45 + 0.3 * gyroid(y, z, x + 5, 43));
  return 1000 * Math.min(1, Math.max(0, share)) + 40 * (random() + random());
}

/** @type {Value} */
function bodies(x, y, z) {
  const [a, b, c] = [x - MIDDLE, y - MIDDLE, z - MIDDLE];
  const outer = (a / 27) ** 2 + (b / 22) ** 2 + (c / 19) ** 2;
  const inner = Math.sqrt((a - 4) ** 2 + b ** 2 + c ** 2);
  if (inner < 9) return 2;
  // A quarter is cut out to show the ball inside.
  return outer < 1 && inner > 12 && !(a > 0 && c > 2) ? 1 : 0;
}

/** The corners of a hexagon of radius 1. */
const HEXAGON = [0, 1, 2, 3, 4, 5].map((k) => {
  const [x, y] = [[1, 0.5, -0.5][k % 3], [0, 0.5 * Math.sqrt(3), 0.5 * Math.sqrt(3)][k % 3]];
  return k < 3 ? [x, y] : [-x, -y];
});

/** @type {Value} */
function benzene(x, y, z, random) {
  let sum = 0;
  for (const [radius, reach, height] of [
    [13, 12, 900],
    [23, 8, 500],
  ])
    for (const [a, b] of HEXAGON) {
      const far = (x - MIDDLE - radius * a) ** 2 + (y - MIDDLE - radius * b) ** 2 + (z - MIDDLE) ** 2;
      sum += height * Math.max(0, 1 - far / reach ** 2) ** 3;
    }
  return sum + 15 * (random() + random());
}

/** A stem of salt under a wide cap, between layers that it has lifted. @type {Value} */
function salt(x, y, z, random) {
  const [a, b] = [x - MIDDLE, y - MIDDLE];
  const stem = 9 + 2 * wave(z / 40) - Math.sqrt((a + 4 * wave(z / 70)) ** 2 + b ** 2);
  const cap = 11 - 11 * Math.sqrt((a / 22) ** 2 + (b / 18) ** 2 + ((z - 41) / 12) ** 2);
  const below = Math.min(stem, 41 - z);
  // The larger of the two depths below the boundary, with a fillet of a few voxels.
  const joint = Math.max(0, 6 - Math.abs(below - cap));
  const depth = Math.max(below, cap) + joint ** 2 / 24;
  const share = Math.min(1, Math.max(0, 0.5 + 0.25 * depth));
  const lift = 10 / (1 + (a ** 2 + b ** 2) / 300);
  const layers = 180 * wave((z - lift + 2 * wave(x / 90)) / 8);
  return 1000 * share + (1 - share) * layers + 30 * (random() + random());
}

/** @type {Record<string, Value>} */
const VALUES = { 'scan-bone': bone, 'scan-bodies': bodies, 'scan-benzene': benzene, 'scan-salt': salt };

/** Computes an image, as an NRRD file. @param {string} id */
export function scanFile(id) {
  const [value, random] = [VALUES[id], noise()];
  const voxels = new DataView(new ArrayBuffer(2 * SIDE ** 3));
  for (let at = 0; at < SIDE ** 3; at += 1) {
    const [x, y, z] = [at % SIDE, Math.floor(at / SIDE) % SIDE, Math.floor(at / SIDE ** 2)];
    voxels.setInt16(2 * at, Math.round(value(x, y, z, random)), true);
  }
  const sizes = `${SIDE} ${SIDE} ${SIDE}`;
  const header = `NRRD0004\ntype: int16\ndimension: 3\nsizes: ${sizes}\nspacings: 1 1 1\nendian: little\nencoding: raw\n\n`;
  return new Blob([header, voxels.buffer]);
}
