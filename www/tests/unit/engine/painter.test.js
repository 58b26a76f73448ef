import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { NO_LEVEL } from '../../../src/engine/columns.js';
import { viewOf } from '../../../src/engine/view/camera.js';
import { MOST_WORK, Painter } from '../../../src/engine/view/painter.js';
import { LINEAR, packed } from '../../../src/engine/view/shade.js';

const [WIDTH, HEIGHT] = [60, 40];

beforeEach(() => {
  vi.stubGlobal(
    'ImageData',
    class {
      /** @param {number} width @param {number} height */
      constructor(width, height) {
        Object.assign(this, { width, height, data: new Uint8ClampedArray(4 * width * height) });
      }
    },
  );
});
afterEach(() => vi.unstubAllGlobals());

test('many discs are painted in parts, of which the canvas shows the whole alone', async () => {
  const shown = /** @type {Uint8Array[]} */ ([]);
  const putImageData = (/** @type {ImageData} */ { data }) => shown.push(Uint8Array.from(data));
  const painter = await Painter.create(/** @type {any} */ ({ getContext: () => ({ putImageData }) }));
  const n = Math.ceil(MOST_WORK / 8);
  const positions = Float32Array.from({ length: 3 * n }, (_, i) => Math.sin(12.9898 * i));
  painter.write(0, positions, positions, new Float32Array(n).fill(0.01), new Uint32Array(n), new Uint32Array(n), -1);
  painter.resize(WIDTH, HEIGHT);
  const camera = { target: [0, 0, 0], distance: 5, yaw: 0.5, pitch: 0.5, fit: false };
  const ball = { centre: [0, 0, 0], radius: 2 };
  painter.set_view(viewOf(/** @type {any} */ (camera), WIDTH, HEIGHT, /** @type {any} */ (ball), undefined).packed);
  painter.set_count(n, n);
  /** Draws a picture, and returns in how many parts. */
  const parts = () => {
    const before = shown.length;
    for (let count = 1; ; count += 1) {
      if (painter.draw(0) === 'drawn') return shown.length === before + 1 ? count : 'shown too often';
      if (shown.length > before) return 'shown too soon';
    }
  };
  painter.choose({ isMoving: true, stride: 1 });
  const moving = /** @type {number} */ (parts());
  expect(moving).toBeGreaterThan(2);
  // One that stands still has four samples.
  painter.choose({ isMoving: false, stride: 1 });
  expect(parts()).toBeGreaterThan(3 * moving);
  expect(shown[1]).toEqual(await painter.read_pixels(WIDTH, HEIGHT, false));
  // A picture that is read back in between begins the one on the screen anew, as one that is given up does.
  painter.draw(0);
  await painter.read_pixels(WIDTH, HEIGHT, false);
  parts();
  expect(shown[2]).toEqual(shown[1]);
  painter.draw(0);
  painter.choose({ isMoving: true, stride: 1 });
  expect(parts()).toBe(moving);
  expect(shown[3]).toEqual(shown[0]);
  // One of ten particles takes a tenth of the work.
  painter.choose({ isMoving: true, stride: 10 });
  expect(parts()).toBe(1);
  painter.choose({ isMoving: true, stride: 1 });
  painter.set_count(10, 0);
  expect(painter.draw(0)).toBe('drawn');
});

test('a mark is as large and as dark in a moving picture of few particles as in one of all', async () => {
  const shown = /** @type {Uint8Array[]} */ ([]);
  const putImageData = (/** @type {ImageData} */ { data }) => shown.push(Uint8Array.from(data));
  const painter = await Painter.create(/** @type {any} */ ({ getContext: () => ({ putImageData }) }));
  painter.resize(WIDTH, HEIGHT);
  painter.set_view(front());
  // A particle that cannot be seen, and a mark.
  const normals = Float32Array.of(1, 0, 0, 1, 0, 0);
  const levels = Uint32Array.of(0, NO_LEVEL);
  painter.write(0, new Float32Array(6), normals, Float32Array.of(0, 0.1), levels, new Uint32Array(2), -1);
  painter.set_count(2, 1);
  for (const stride of [1, 64]) {
    painter.choose({ isMoving: true, stride });
    expect(painter.draw(0)).toBe('drawn');
  }
  const dark = shown[0].filter((byte, i) => i % 4 === 0 && byte < 128).length;
  expect(dark).toBeGreaterThan(3);
  expect(shown[1]).toEqual(shown[0]);
});

/** A painter of one picture. @param {Float32Array} view */
async function painted(view) {
  const painter = await Painter.create(/** @type {any} */ ({ getContext: () => ({ putImageData: () => {} }) }));
  painter.resize(WIDTH, HEIGHT);
  painter.set_view(view);
  return painter;
}
const WHITE = [255, 255, 255];
const front = () => {
  const camera = { target: [0, 0, 0], distance: 5, yaw: 0, pitch: 0, fit: false };
  const ball = { centre: [0, 0, 0], radius: 2 };
  return viewOf(/** @type {any} */ (camera), WIDTH, HEIGHT, /** @type {any} */ (ball), undefined).packed;
};
/** @param {Uint8Array} pixels @param {number} x @param {number} y */
const pixel = (pixels, x, y) => [...pixels.subarray(4 * (y * WIDTH + x), 4 * (y * WIDTH + x) + 3)];

test('a colour that is drawn as it is keeps its bytes, so that the ground is that of the page', () => {
  for (let byte = 0; byte < 256; byte += 1) {
    const light = LINEAR[byte];
    expect(packed(light, light, light) >>> 0).toBe((0xff000000 | (byte * 0x010101)) >>> 0);
  }
});

test('edges are smooth: as much of a pixel is the ground as the surface leaves', async () => {
  const painter = await painted(front());
  painter.write(
    0,
    new Float32Array(3),
    Float32Array.of(1, 0, 0),
    Float32Array.of(0.9),
    new Uint32Array(1),
    new Uint32Array(1),
    -1,
  );
  painter.set_count(1, 0);
  const pixels = await painter.read_pixels(WIDTH, HEIGHT, false);
  const shades = new Set(Array.from({ length: WIDTH * HEIGHT }, (_, i) => pixels[4 * i]));
  // The black disc, the white ground, and three quarters between them.
  expect(shades.size).toBe(5);
  expect(pixel(pixels, 0, 0)).toEqual(WHITE);
  // On no ground as much of it is clear.
  const clear = await painter.read_pixels(WIDTH, HEIGHT, true);
  expect(new Set(Array.from({ length: WIDTH * HEIGHT }, (_, i) => clear[4 * i + 3]))).toEqual(
    new Set([0, 64, 128, 191, 255]),
  );
});

test('faces are painted in the place of their particles, the nearer one in front, cut and by levels', async () => {
  const painter = await painted(front());
  /** A large face across the line of sight. @param {number} x */
  const face = (x) => [x, -4, -4, x, 4, -4, x, 0, 6];
  const positions = Float32Array.from([...face(-0.5), ...face(0.5)]);
  const normals = Float32Array.from({ length: 18 }, (_, i) => Number(i % 3 === 0));
  const [red, green] = [0xff0000ff, 0xff00ff00];
  const colours = Uint32Array.of(red, red, red, green, green, green);
  const corners = /** @type {const} */ ([positions, normals, new Float32Array(6).fill(0.1)]);
  painter.write_faces(0, ...corners, Uint32Array.of(0, 0, 0, 3, 3, 3), colours, new Uint32Array(6));
  painter.set_faces(2, 1);
  painter.set_style(JSON.stringify({ faces: { flat: false, edge_px: 0 }, pixel_ratio: 1 }));
  const middle = async () => {
    const [r, g] = pixel(await painter.read_pixels(WIDTH, HEIGHT, false), WIDTH / 2, HEIGHT / 2);
    return Math.abs(r - g) < 30 ? 'ground' : r > g ? 'red' : 'green';
  };
  // The eye is on the side of larger x.
  expect(await middle()).toBe('green');
  painter.set_style(JSON.stringify({ level: 2 }));
  expect(await middle()).toBe('red');
  painter.set_style(JSON.stringify({ level: null, plane: { normal: [1, 0, 0], offset: 0 } }));
  expect(await middle()).toBe('red');
  painter.set_style(JSON.stringify({ plane: { normal: [1, 0, 0], offset: -1 } }));
  expect(await middle()).toBe('ground');
  painter.set_style(JSON.stringify({ plane: null }));
  painter.tint_faces(1, Uint32Array.of(red, red, red), new Uint32Array(3));
  expect(await middle()).toBe('red');
  painter.set_faces(0, 0);
  expect(await middle()).toBe('ground');
});

test('a sphere is lit from its side, and covers what is behind it', async () => {
  const painter = await painted(front());
  const grey = 0xff909090;
  painter.write(
    0,
    Float32Array.of(0, 0, 0, -1, 0, 0),
    Float32Array.of(1, 0, 0, 1, 0, 0),
    Float32Array.of(0.9, 1.2),
    new Uint32Array(2),
    Uint32Array.of(grey, 0xff000000),
    -1,
  );
  painter.set_count(2, 0);
  painter.set_style(JSON.stringify({ spheres: true, disc_scale: 1, key_light_view: [-1, 0, 0.5] }));
  const pixels = await painter.read_pixels(WIDTH, HEIGHT, false);
  const [left, middle, right] = [-6, 0, 6].map((dx) => pixel(pixels, WIDTH / 2 + dx, HEIGHT / 2)[0]);
  expect(left).toBeGreaterThan(middle);
  expect(middle).toBeGreaterThan(right);
  expect(right).toBeGreaterThan(20);
});
