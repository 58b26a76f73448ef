/**
 * Points as a field: fits a smooth surface to them, in slices.
 *
 * @module
 */
import { Points } from '../src/wasm/points/points.js';

/** @import { Cloud } from './protocol.js' */
/** @import { SolvedModel } from '../src/engine/core-types.js' */

/** Points as a PLY file, from which the core fits surfaces. @param {Exclude<Cloud, {file: Blob}>} cloud */
function ply({ points, normals }) {
  const names = normals ? ['x', 'y', 'z', 'nx', 'ny', 'nz'] : ['x', 'y', 'z'];
  const count = points.length / 3;
  const properties = names.map((name) => `property double ${name}\n`).join('');
  const head = `ply\nformat binary_little_endian 1.0\nelement vertex ${count}\n${properties}end_header\n`;
  const bytes = new Uint8Array(head.length + 8 * count * names.length);
  bytes.set(new TextEncoder().encode(head));
  const view = new DataView(bytes.buffer, head.length);
  for (let i = 0, at = 0; i < count; i += 1)
    for (const column of normals ? [points, normals] : [points])
      for (let k = 0; k < 3; k += 1, at += 8) view.setFloat64(at, column[3 * i + k], true);
  return bytes;
}

/**
 * Fits the surface. Returns it in the core's form, or what is wrong with the points.
 * @param {Cloud} cloud
 * @param {<T>(slice: (budget: number) => T | undefined) => Promise<T>} inSlices
 * @returns {Promise<{system: Uint8Array, about: SolvedModel} | {error: string}>}
 */
export async function fitted(cloud, inSlices) {
  const points = new Points();
  try {
    const [name, bytes] =
      'file' in cloud ? [cloud.name, new Uint8Array(await cloud.file.arrayBuffer())] : ['points.ply', ply(cloud)];
    const begun = points.file(name, bytes, 0);
    if (!begun.ok) return begun;
    const last = await inSlices((budget) => {
      const state = points.step(budget);
      return state.ok && !state.done ? undefined : state;
    });
    if (!last.ok) return last;
    const about = points.info();
    return about.ok ? { system: points.field(), about } : about;
  } finally {
    points.free();
  }
}
