/** The colours of voxels on the cutting plane, and the place of their picture in perspective. */

/**
 * @import { ImageFacts, ImageInfo } from '../../../engine/types.js'
 * @import { Point } from '../types.js'
 */

/** Share of the voxels that are black, and white, so that a few bright ones do not darken the rest. */
const CLIPPED = 0.002;
/** Opacity outside the surface, and the share of the range of the voxels over which it changes. */
const [OUTER, RAMP] = [0.45, 0.04];
/** Angle between the hues of consecutive labels, in turns: the golden ratio keeps any few of them apart. */
const TURN = 0.618034;

/** The values that are black and white. @param {ImageFacts} facts @returns {[number, number]} */
export function greysOf({ histogram, range: [min, max] }) {
  const most = CLIPPED * histogram.reduce((sum, count) => sum + count, 0);
  let [first, last, below, above] = [0, histogram.length - 1, histogram[0], histogram.at(-1) ?? 0];
  while (first < last && below < most) below += histogram[++first];
  while (last > first && above < most) above += histogram[--last];
  const width = (max - min) / Math.max(1, histogram.length);
  return [min + first * width, min + (last + 1) * width];
}

/** The colour of the label with this place in the list, from 0 to 255. @param {number} k */
function hueOf(k) {
  const turn = k * TURN;
  // Half a wave for each of red, green and blue, a third of a turn apart.
  return [0, 1, 2].map((c) => Math.round(70 + 170 * (0.5 + 0.5 * Math.cos(2 * Math.PI * (turn - c / 3)))));
}

/**
 * The pixels of voxels: grey values, less opaque outside the surface; of labels, a colour for each.
 * @param {ArrayLike<number>} values  NaN outside the image
 * @param {Pick<ImageFacts, 'histogram' | 'range' | 'labels'>} facts
 * @param {Pick<ImageInfo, 'label' | 'iso' | 'is_dark_inside'>} info
 */
export function pixelsOf(values, facts, info) {
  const pixels = new Uint8ClampedArray(4 * values.length);
  const [black, white] = greysOf(/** @type {ImageFacts} */ (facts));
  const [min, max] = facts.range;
  const places = new Map(facts.labels.map(({ value }, k) => [value, k]));
  for (let at = 0; at < values.length; at += 1) {
    const value = values[at];
    if (Number.isNaN(value)) continue;
    if (info.label !== null) {
      const place = places.get(value) ?? 0;
      pixels.set([...hueOf(place), value === info.label ? 255 : value === 0 ? 60 : 150], 4 * at);
      continue;
    }
    const grey = (255 * (value - black)) / (white - black);
    const depth = ((info.is_dark_inside ? info.iso - value : value - info.iso) / (max - min)) * (1 / RAMP);
    const share = Math.min(1, Math.max(0, 0.5 + depth));
    pixels.set([grey, grey, grey, 255 * (OUTER + (1 - OUTER) * share)], 4 * at);
  }
  return pixels;
}

/**
 * The homogeneous matrix that brings a picture of this size to four spots: its corners, first along its width. Columns
 * for x, for y and for the place. Null if a spot is behind the eye, or if the picture is seen from its back (P.
 * Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989, section 2.2.3).
 * @param {(Point | null)[]} spots @param {readonly [number, number]} size
 * @returns {[number, number, number][] | null}
 */
function matrixTo(spots, [width, height]) {
  const [a, b, c, d] = spots;
  if (!a || !b || !c || !d) return null;
  // Twice the area: positive where the corners run clockwise on the screen, whose y points down.
  const area = (c.x - a.x) * (d.y - b.y) - (d.x - b.x) * (c.y - a.y);
  if (area >= 0) return null;
  const [sx, sy] = [a.x - b.x + c.x - d.x, a.y - b.y + c.y - d.y];
  const [x1, y1, x2, y2] = [b.x - c.x, b.y - c.y, d.x - c.x, d.y - c.y];
  const det = x1 * y2 - x2 * y1;
  const [g, k] = [(sx * y2 - x2 * sy) / det, (x1 * sy - sx * y1) / det];
  return [
    [(b.x - a.x + g * b.x) / width, (b.y - a.y + g * b.y) / width, g / width],
    [(d.x - a.x + k * d.x) / height, (d.y - a.y + k * d.y) / height, k / height],
    [a.x, a.y, 1],
  ];
}

/**
 * The matrix of CSS that brings a picture of this size to four spots; null as above.
 * @param {(Point | null)[]} spots @param {[number, number]} size
 */
export function squareTo(spots, size) {
  const matrix = matrixTo(spots, size);
  if (!matrix) return null;
  const [[a, b, c], [d, e, f], [x, y, w]] = matrix;
  return `matrix3d(${[a, b, 0, c, d, e, 0, f, 0, 0, 1, 0, x, y, 0, w].join(', ')})`;
}

/**
 * Lays pixels over an image, brought to four spots and cut along a convex outline.
 * @param {Pick<ImageData, 'width' | 'height' | 'data'>} image
 * @param {{ pixels: Uint8ClampedArray, size: readonly [number, number] }} rectangle
 * @param {(Point | null)[]} spots @param {readonly (Point | null)[]} outline
 */
export function lay({ width, height, data }, { pixels, size }, spots, outline) {
  const matrix = matrixTo(spots, size);
  const corners = outline.flatMap((point) => point ?? []);
  if (!matrix || corners.length !== outline.length || corners.length < 3) return;
  const [[a, b, c], [d, e, f], [p, q, w]] = matrix;
  // The adjugate is the inverse, but for a factor that the division removes.
  const inverse = [
    [e * w - f * q, f * p - d * w, d * q - e * p],
    [c * q - b * w, a * w - c * p, b * p - a * q],
    [b * f - c * e, c * d - a * f, a * e - b * d],
  ];
  const within = insideOf(corners);
  const range = (/** @type {number[]} */ values, /** @type {number} */ end) => [
    Math.max(0, Math.floor(Math.min(...values))),
    Math.min(end, Math.ceil(Math.max(...values))),
  ];
  const [left, right] = range(
    corners.map(({ x }) => x),
    width,
  );
  const [top, bottom] = range(
    corners.map(({ y }) => y),
    height,
  );
  for (let y = top; y < bottom; y += 1)
    for (let x = left; x < right; x += 1) {
      const [u, v] = [x + 0.5, y + 0.5];
      if (!within(u, v)) continue;
      const [across, down, z] = inverse.map((row) => row[0] * u + row[1] * v + row[2]);
      const [column, row] = [Math.floor(across / z), Math.floor(down / z)];
      if (column < 0 || row < 0 || column >= size[0] || row >= size[1]) continue;
      blend(data, 4 * (y * width + x), pixels, 4 * (row * size[0] + column));
    }
}

/** Returns whether a place is within a convex outline. @param {readonly Point[]} corners */
function insideOf(corners) {
  const edges = corners.map(({ x, y }, k) => {
    const next = corners[(k + 1) % corners.length];
    return { x, y, dx: next.x - x, dy: next.y - y };
  });
  return (/** @type {number} */ u, /** @type {number} */ v) => {
    let [some, others] = [false, false];
    for (const { x, y, dx, dy } of edges) {
      const side = dx * (v - y) - dy * (u - x);
      some ||= side > 0;
      others ||= side < 0;
    }
    return !(some && others);
  };
}

/**
 * Lays one pixel over another.
 * @param {Uint8ClampedArray} below @param {number} at @param {Uint8ClampedArray} above @param {number} from
 */
function blend(below, at, above, from) {
  const [over, under] = [above[from + 3] / 255, below[at + 3] / 255];
  const alpha = over + under * (1 - over);
  if (alpha === 0) return;
  for (let k = 0; k < 3; k += 1) below[at + k] = (above[from + k] * over + below[at + k] * under * (1 - over)) / alpha;
  below[at + 3] = 255 * alpha;
}
