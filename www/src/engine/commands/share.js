/**
 * Commands that produce output: a link, a picture, a file.
 *
 * @module
 */
import { decode, encode } from '../share/codec.js';
import { IN_FILE, MARKED, mergeState } from '../share/state.js';
import { homeView } from '../share/view.js';
import { description } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { Columns, EngineCommands, MeshFormat } from '../types.js'
 */

/** Largest width or height of a saved picture. */
const LARGEST_PICTURE_PX = 8192;

/** What is told of a link to the surface of a file. */
const OF_FILE =
  'The surface of this link is in a file, which a link cannot hold. Open the file here: the settings of the link are chosen already.';

const MARK_AGAIN = ' Its edges are to be marked again.';

/** @type {Partial<Record<MeshFormat, string>>} */
const MIME = { glb: 'model/gltf-binary', '3mf': 'model/3mf', stl: 'model/stl' };

/** Fetches the code that writes files. The first picture does not need it, so it loads after the sampler. */
export const fetchExports = () => import('../share/exports.js');

/**
 * @typedef {'link' | 'openLink' | 'set' | 'picture' | 'savePng' | 'exportFile' | 'exportMesh' | 'code'} Shared
 * @typedef {Pick<EngineCommands, Shared>} ShareCommands
 */

/** @param {Parts} parts @returns {ShareCommands} */
export function shareCommands({ store, columns, picture: { viewer }, sampler, loader, adopt }) {
  /** @type {EngineCommands['picture']} */
  async function picture({ width, height, transparent = false, over } = {}) {
    const side = (/** @type {number | undefined} */ wanted, /** @type {number} */ own) =>
      Math.min(LARGEST_PICTURE_PX, Math.max(1, Math.round(wanted ?? own)));
    const { screen } = viewer;
    const shot = await viewer.pixels(side(width, screen.width), side(height, screen.height), transparent);
    const image = new ImageData(new Uint8ClampedArray(shot.pixels.buffer), shot.width, shot.height);
    await over?.(image, shot.project);
    return image;
  }

  return {
    link: () => encode(store.state.value, description(store)),
    async openLink(link, { initial = false, patch = {} } = {}) {
      const about = description(store);
      const { state, reset, problem } = await decode(link, about, loader.hasFile);
      if (problem) {
        const outcome = initial ? 'This is the standard surface instead.' : 'Nothing was changed.';
        store.notice.value = { id: 'link', kind: 'warn', text: `${problem} ${outcome}` };
        if (!initial) return;
      } else if (reset.length) {
        const what = [...new Set(reset)].join(', ');
        store.notice.value = reset.includes(IN_FILE)
          ? { id: 'link', kind: 'warn', text: OF_FILE + (reset.includes(MARKED) ? MARK_AGAIN : ''), asks: 'file' }
          : { id: 'link', kind: 'warn', text: `The link was read, except for: ${what}.` };
      }
      const whole = mergeState(state, { ...patch }, about, loader.hasFile).state;
      // A link without a camera gets the default camera, whose distance fits no particular surface.
      const { camera } = whole.view;
      viewer.linked = camera.distance === homeView().camera.distance ? null : camera;
      adopt(whole);
    },
    set(patch) {
      const { state, reset } = mergeState(store.state.value, patch, description(store), loader.hasFile);
      adopt(state);
      return reset;
    },
    picture,
    async savePng(options) {
      const { png } = await fetchExports();
      return png(await picture(options));
    },
    async exportFile(format, { link } = {}) {
      if (columns.stale || columns.count === 0) throw new Error('There is no surface.');
      const { csv, json, ply } = await fetchExports();
      const record = columns.record && { ...columns.record, link: link ?? null };
      if (format === 'json') {
        if (!record) throw new Error('There is no record of these particles.');
        return json(record);
      }
      const all = [...description(store).columns];
      /** @type {Columns & {values?: Record<string, Float32Array>}} */
      const exported = Object.create(columns);
      exported.values = { ...columns.own, ...(columns.value ? { value: columns.value } : {}) };
      for (const name of Object.keys(exported.values))
        all.push(/** @type {typeof all[number]} */ ({ name, kind: 'float' }));
      return format === 'csv' ? csv(exported, all) : ply(exported, all, record);
    },
    code: (language) => sampler.client.code(language),
    async exportMesh(format, options) {
      const bodies = columns.mesh?.leavesOutChips ? 'without_chips' : 'all';
      const bytes = await sampler.client.meshFile({ bodies, ...options, format });
      return new Blob([bytes], { type: MIME[format] ?? 'application/octet-stream' });
    },
  };
}
