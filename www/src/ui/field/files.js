/** Describes the files that can be read, and the errors in reading them. */
import { FILE_TYPES } from '../../engine/constants.js';

/** @import { Engine, LoadingError } from '../../engine/types.js' */

/** Names of the file formats, such as PLY and OBJ. `.txt` and `.asc` are only other extensions of XYZ. */
const FORMATS = FILE_TYPES.split(',')
  .filter((type) => !['.txt', '.asc'].includes(type))
  .map((type) => type.slice(1).toUpperCase());

/** @param {string[]} words */
const listOf = (words) => (words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} or ${words.at(-1)}`);

/** The formats of triangle meshes. */
export const MESH_FORMATS = 'STL, OBJ, PLY, OFF, GLB or 3MF';
/** The formats of three-dimensional images. */
export const IMAGE_FORMATS = 'NIfTI, NRRD, NPY, MetaImage, cube or TIFF';
/** Extensions of image headers, whose voxels may be in another file. */
const HEADERS = /\.(hdr|nhdr|mhd|nii|nii\.gz)$/i;

/**
 * Returns the file that makes the surface, which is a header if there is one, and the others.
 * @param {File[]} files
 */
export function ofFiles(files) {
  const file = files.find(({ name }) => HEADERS.test(name)) ?? files[0];
  return { file, beside: files.filter((other) => other !== file) };
}

/** Returns the formats of files that can be opened, in words. @param {Engine} engine */
export const filesOf = ({ description }) =>
  `${listOf(FORMATS)}, up to ${Math.round((description.value?.limits.file_bytes ?? 0) / 1e6)}\u202fMB`;

/**
 * Returns whether a drag carries files rather than text or an image of the page.
 * @param {{ types: readonly string[] } | null} transfer
 */
export const carriesFiles = (transfer) => transfer?.types.includes('Files') ?? false;

/** Advice after the refusal of a file or model, by the kind of error. @type {Record<string, string>} */
const ADVICE = {
  too_large: 'Thin the points out, or save fewer decimals.',
  image: 'Choose another file, or convert it.',
  mesh: 'Mend it in another program, or open it as points.',
  no_solid: 'Points can be sampled without a volume.',
  unreadable: 'Check that the file is still there and may be read.',
  crashed: 'The page is not harmed. Try another file; the report is worth sending with this one.',
  silent: 'Try fewer points.',
  bundle: 'Load the page again; if that does not help, the network or a filter keeps a part of it back.',
};

/**
 * Describes an error in loading for the user.
 * @param {LoadingError} error
 */
export function describeLoadingError({ name, kind, message }) {
  const text = message.trim();
  return {
    title: `${name} could not be used`,
    text: `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? '' : '.'}`,
    advice: ADVICE[kind] ?? '',
  };
}
