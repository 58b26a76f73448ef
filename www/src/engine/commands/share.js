/**
 * Commands that produce output: a link, a picture, a file.
 *
 * @module
 */
import { surfaceOf } from '../share/state.js';
import { description } from '../store.js';
import { FILE_SURFACE } from '../types.js';

/** Largest width or height of a saved picture. */
const LARGEST_PICTURE_PX = 8192;

/** Fetches the code that writes files. The first picture does not need it, so it loads after the sampler. */
export const fetchExports = () => import('../share/exports.js');

/** @typedef {Pick<import('../types.js').EngineCommands, 'shareUrl' | 'loadUrl' | 'picture' | 'savePng' | 'exportFile' | 'exportMesh'>} ShareCommands */

/** @param {import('../index.js').Parts} parts @returns {ShareCommands} */
export function shareCommands({ store, columns, picture: { viewer }, runs, address }) {
  /** @type {import('../types.js').EngineCommands['picture']} */
  async function picture({ width, height, transparent = false } = {}) {
    const side = (/** @type {number | undefined} */ wanted, /** @type {number} */ own) =>
      Math.min(LARGEST_PICTURE_PX, Math.max(1, Math.round(wanted ?? own)));
    const { screen } = viewer;
    const shot = await viewer.pixels(side(width, screen.width), side(height, screen.height), transparent);
    return new ImageData(new Uint8ClampedArray(shot.pixels.buffer), shot.width, shot.height);
  }

  return {
    async shareUrl() {
      if (store.state.value.surface === FILE_SURFACE) {
        store.notice.value = {
          id: 'share-file',
          kind: 'info',
          text: `A link cannot hold the points of ${store.model.value?.name ?? 'a file'}: it shows the standard surface with these settings. Send the file along.`,
        };
      }
      return address.url();
    },
    loadUrl: (hash) => address.load(hash),
    picture,
    async savePng(options) {
      const { png } = await fetchExports();
      return png(await picture(options));
    },
    async exportFile(format) {
      const { shown } = runs.sampling;
      if (!shown) throw new Error('There is no surface.');
      const what = titleOf(shown.request.field);
      const { csv, ply } = await fetchExports();
      const { columns: all } = description(store);
      return format === 'csv' ? csv(columns, all) : ply(columns, all, { comment: `Marching Particles, ${what}` });
    },
    async exportMesh(format) {
      const bytes = await runs.sampling.meshFile(format);
      return new Blob([bytes], { type: format === 'glb' ? 'model/gltf-binary' : 'application/octet-stream' });
    },
  };

  /** Returns a description of a field for the header of a file. @param {import('../types.js').FieldRequest} field */
  function titleOf(field) {
    const model = field.points && runs.loader.client.get(field.points)?.info.info;
    if (model) return `${model.name}, interpolated from ${model.centres} of ${model.points} points`;
    return `f = ${field.formula ?? surfaceOf(description(store), field.surface ?? '')?.formula}`;
  }
}
