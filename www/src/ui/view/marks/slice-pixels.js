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
 * The matrix of CSS that brings a picture of this size to four spots: its corners, first along its width. Null if one
 * is behind the eye, or if the picture is seen from its back (P. Heckbert, "Fundamentals of Texture Mapping and Image
 * Warping", 1989, section 2.2.3).
 * @param {(Point | null)[]} spots @param {[number, number]} size
 */
export function squareTo(spots, [width, height]) {
  const [a, b, c, d] = spots;
  if (!a || !b || !c || !d) return null;
  // Twice the area: positive where the corners run clockwise on the screen, whose y points down.
  const area = (c.x - a.x) * (d.y - b.y) - (d.x - b.x) * (c.y - a.y);
  if (area >= 0) return null;
  const [sx, sy] = [a.x - b.x + c.x - d.x, a.y - b.y + c.y - d.y];
  const [x1, y1, x2, y2] = [b.x - c.x, b.y - c.y, d.x - c.x, d.y - c.y];
  const det = x1 * y2 - x2 * y1;
  const [g, k] = [(sx * y2 - x2 * sy) / det, (x1 * sy - sx * y1) / det];
  const [m11, m12] = [b.x - a.x + g * b.x, b.y - a.y + g * b.y];
  const [m21, m22] = [d.x - a.x + k * d.x, d.y - a.y + k * d.y];
  // Columns of the matrix, for a picture in pixels.
  const columns = [
    [m11, m12, 0, g].map((v) => v / width),
    [m21, m22, 0, k].map((v) => v / height),
    [0, 0, 1, 0],
    [a.x, a.y, 0, 1],
  ];
  return `matrix3d(${columns.flat().join(', ')})`;
}
