/** The sizes in which a picture can be saved. */

/** @import { Size } from './types.js' */

/** Side of the square picture, in pixels. */
const SQUARE_PX = 2048;
/** Side up to which every browser makes a canvas. */
const LARGEST_PX = 8192;

/**
 * Returns the offered sizes.
 * @param {Size & { ratio: number }} screen  of the window in CSS pixels, and device pixels in one of them
 * @returns {{ id: string, label: string, size: Size }[]}
 */
export function sizesOf({ width, height, ratio }) {
  const scaled = (/** @type {number} */ factor) => {
    const most = Math.min(factor, LARGEST_PX / Math.max(width, height));
    return { width: Math.round(width * most), height: Math.round(height * most) };
  };
  return [
    { id: 'screen', label: 'Screen', size: scaled(ratio) },
    { id: 'double', label: 'Screen, twice', size: scaled(2 * ratio) },
    { id: '4k', label: '4K', size: { width: 3840, height: 2160 } },
    { id: 'square', label: 'Square', size: { width: SQUARE_PX, height: SQUARE_PX } },
  ];
}

/** Sizes of a film. Their sides are even, as encoders need. */
export const FILM_SIZES = [
  { id: 'hd', label: 'HD', size: { width: 1280, height: 720 } },
  { id: 'full-hd', label: 'Full HD', size: { width: 1920, height: 1080 } },
  { id: 'square', label: 'Square', size: { width: 1080, height: 1080 } },
];

/** @param {{ label: string, size: Size }} entry */
export const sizeWords = ({ label, size }) => `${label}, ${size.width}\u202f×\u202f${size.height}`;
