/** Describes a three-dimensional image in words, and its histogram as a path. */
import { formatCount, formatSignificant } from '../format.js';

/** @import { ImageFacts, ImageInfo } from '../../engine/types.js' */

/** Describes the voxels of an image. @param {ImageFacts} facts */
export function voxelsOf({ size, spacing, voxel_type, range }) {
  const steps = spacing.map((length) => formatSignificant(length)).join(' × ');
  const [min, max] = range.map((value) => formatSignificant(value, 5));
  return `${size.map(formatCount).join(' × ')} voxels of ${steps}, ${voxel_type}, ${min} to ${max}.`;
}

/** Says how the voxels were filtered, and why. @param {ImageInfo} info */
export function filteredOf({ smooth, is_smooth_chosen, label, noise }) {
  if (smooth === 0) return is_smooth_chosen ? 'There is too little noise to filter.' : '';
  const width = `${formatSignificant(smooth, 2)} voxel${smooth === 1 ? '' : 's'}`;
  const ofWhat = label === null ? '' : ' over the distance from the label';
  const why =
    label !== null
      ? 'against the steps between voxels'
      : noise > 0
        ? `against noise of ${formatSignificant(noise, 2)}`
        : 'against the steps between whole numbers';
  return `A Gaussian of ${width}${ofWhat}${is_smooth_chosen ? ` ${why}` : ''}: it rounds corners by about as much.`;
}

/**
 * Returns a histogram's bars as a path. Their heights are logarithms, because most voxels are background.
 * @param {number[]} counts
 */
export function barsOf(counts) {
  const highest = Math.log1p(Math.max(...counts, 1));
  return counts
    .map((count, k) => (count > 0 ? `M${k} 1V${+(1 - Math.log1p(count) / highest).toFixed(3)}h1V1z` : ''))
    .join('');
}
