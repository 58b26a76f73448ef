/**
 * What can be said of a picture by its pixels.
 *
 * @module
 */

/**
 * Four bytes a pixel: red, green, blue, opacity.
 * @typedef {{pixels: Uint8Array, width: number, height: number}} Pixels
 */

/**
 * Returns the share of pixels that differ from the corner and of those that have a colour, and how many of 12 hues there
 * are.
 * @param {Pixels} picture
 */
export function pictureOf({ pixels, width, height }) {
  const corner = [...pixels.subarray(0, 3)];
  const hues = new Array(12).fill(0);
  let drawn = 0;
  let coloured = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    const [r, g, b] = [pixels[i], pixels[i + 1], pixels[i + 2]];
    if (Math.abs(r - corner[0]) + Math.abs(g - corner[1]) + Math.abs(b - corner[2]) < 24) continue;
    drawn += 1;
    const most = Math.max(r, g, b);
    const chroma = most - Math.min(r, g, b);
    if (chroma < 20) continue;
    coloured += 1;
    const hue = most === r ? (g - b) / chroma + 6 : most === g ? (b - r) / chroma + 2 : (r - g) / chroma + 4;
    hues[Math.floor(hue * 2) % 12] += 1;
  }
  const middle = 4 * (Math.floor(height / 2) * width + Math.floor(width / 2));
  return {
    width,
    height,
    drawn: drawn / (width * height),
    coloured: coloured / (width * height),
    hues: hues.filter((n) => n > 4).length,
    corner,
    middle: [...pixels.subarray(middle, middle + 4)],
  };
}

/**
 * Returns the separate spots in a picture, their areas in pixels and how far their middles lie from
 * the picture's, largest first; and how many pixels are dark and nearly white.
 * @param {Pixels} picture
 */
export function spotsOf({ pixels, width, height }) {
  const [r0, g0, b0] = pixels;
  const drawn = new Uint8Array(width * height);
  let [black, white] = [0, 0];
  for (let i = 0; i < drawn.length; i += 1) {
    const [r, g, b] = pixels.subarray(4 * i, 4 * i + 3);
    drawn[i] = Number(Math.abs(r - r0) + Math.abs(g - g0) + Math.abs(b - b0) > 60);
    black += Number(Math.max(r, g, b) < 80);
    white += Number(Math.min(r, g, b) > 215);
  }
  const found = [];
  for (let start = 0; start < drawn.length; start += 1) {
    if (!drawn[start]) continue;
    const open = [start];
    drawn[start] = 0;
    let [area, sumX, sumY] = [0, 0, 0];
    for (let at = open.pop(); at !== undefined; at = open.pop()) {
      area += 1;
      const x = at % width;
      sumX += x;
      sumY += Math.floor(at / width);
      for (const [next, inside] of /** @type {[number, boolean][]} */ ([
        [at - 1, x > 0],
        [at + 1, x < width - 1],
        [at - width, at >= width],
        [at + width, at < width * (height - 1)],
      ])) {
        if (!inside || !drawn[next]) continue;
        drawn[next] = 0;
        open.push(next);
      }
    }
    found.push({ area, off: Math.hypot(sumX / area - width / 2, sumY / area - height / 2) });
  }
  return { found: found.sort((p, q) => q.area - p.area), black, white };
}

/**
 * Returns the shares of the left and of the right half of a picture in which something is drawn.
 * @param {Pixels} picture
 */
export function halvesOf({ pixels, width, height }) {
  const seen = [0, 0];
  for (let i = 0; i < pixels.length; i += 4) {
    const drawn = [0, 1, 2].some((k) => Math.abs(pixels[i + k] - pixels[k]) > 24);
    if (drawn) seen[(i / 4) % width < width / 2 ? 0 : 1] += 2 / (width * height);
  }
  return seen;
}

/**
 * Returns how light the ground and the middle of a picture are, and how colourful its middle is: the mean of a patch,
 * without what is ground between discs.
 * @param {Pixels} picture
 */
export function shadeOf({ pixels, width, height }) {
  const ground = [...pixels.subarray(0, 3)];
  const sum = [0, 0, 0];
  let count = 0;
  for (let y = height / 2 - 8; y < height / 2 + 8; y += 1) {
    for (let x = width / 2 - 8; x < width / 2 + 8; x += 1) {
      const p = [...pixels.subarray(4 * (width * y + x), 4 * (width * y + x) + 3)];
      if (p.every((v, k) => Math.abs(v - ground[k]) < 8)) continue;
      for (let k = 0; k < 3; k += 1) sum[k] += p[k];
      count += 1;
    }
  }
  const mean = sum.map((v) => v / count);
  const light = (/** @type {number[]} */ [r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return { ground: light(ground), light: light(mean), spread: Math.max(...mean) - Math.min(...mean) };
}

/** A plane, seen from its outside and from its inside by the usual camera. */
export const SIDES = ['x+y+z=0', '0=x+y+z'].map((formula) => ({
  formula,
  bounds: { min: [-1, -1, -1], max: [1, 1, 1] },
  settings: { radius_share: 0.02 },
}));

/**
 * What tells an inside from an outside: it is darker and greyer, and stands out from the ground.
 * @param {Pixels[]} pictures  of the {@link SIDES}
 * @param {number} lightest  most light of an inside, as a share of that of the outside
 */
export function isInsideTold(pictures, lightest = 0.82) {
  const [front, behind] = pictures.map(shadeOf);
  return {
    isDarker: behind.light < lightest * front.light,
    isGreyer: behind.spread < front.spread,
    isSeen: Math.abs(behind.light - behind.ground) > 20,
  };
}
/** What {@link isInsideTold} returns of a good picture. */
export const INSIDE_TOLD = { isDarker: true, isGreyer: true, isSeen: true };
