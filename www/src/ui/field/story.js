/** Returns the description of the present surface. */
import { FILE_SURFACE } from '../../engine/constants.js';
import { scanOf } from '../../engine/scans.js';
import { plural } from '../format.js';

/** @import { Description, ImageInfo, MeshInfo, ModelInfo } from '../../engine/types.js' */

/**
 * @param {Description} description
 * @param {string | null} id null for a formula that is not in the gallery
 * @param {ModelInfo | ImageInfo | MeshInfo | null} info of a surface from points, of an image or of a mesh
 */
export function storyOf(description, id, info) {
  const model = description.models.find((entry) => entry.id === id);
  if (model) return { name: model.name, facts: plural(model.points, 'point'), text: model.story, credit: model.credit };
  const scan = id === null ? undefined : scanOf(id);
  if (scan) return { name: scan.name, facts: '', text: scan.story, credit: '' };
  if (info && 'size' in info) {
    const what = info.label === null ? 'on which the image has one value' : 'around one label of the image';
    return { name: info.name, facts: '', text: `The surface ${what}.`, credit: '' };
  }
  if (info && 'faces' in info)
    return { name: info.name, facts: '', text: 'The surface of this mesh, sampled anew.', credit: '' };
  if (id === FILE_SURFACE) {
    return {
      name: info?.name ?? 'File',
      facts: info ? plural(info.points, 'point') : '',
      text: 'The surface that is fitted to the points of this file.',
      credit: info?.credit ?? '',
    };
  }
  const entry = description.surfaces.find((surface) => surface.id === id);
  if (!entry)
    return {
      name: 'Your own formula',
      facts: '',
      text: 'The surface where the formula is zero. Unknown names become sliders.',
      credit: '',
    };
  const facts = [
    entry.degree === null ? '' : `Degree ${entry.degree}`,
    entry.genus === null ? '' : `genus ${entry.genus}`,
  ]
    .filter(Boolean)
    .join(' · ');
  return { name: entry.name, facts, text: entry.story, credit: entry.source };
}
