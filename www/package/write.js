/**
 * Files, where there are any, and downloads elsewhere.
 *
 * @module
 */
import { InputError } from './errors.js';

/**
 * Writes a file in Node, where a missing folder is named; in a page it becomes a download.
 * @param {string} path @param {Uint8Array<ArrayBuffer>} bytes
 */
export async function write(path, bytes) {
  // A static import of Node's modules would stop bundlers for browsers.
  const files = globalThis.process?.getBuiltinModule?.('node:fs/promises');
  if (files) {
    await files.writeFile(path, bytes).catch((error) => {
      if (error.code !== 'ENOENT') throw error;
      throw new InputError(`path: ${path} could not be written: its folder does not exist.`);
    });
    return;
  }
  if (typeof document === 'undefined')
    throw new InputError('save(): it is for Node and for pages. In a worker take the bytes of toFile().');
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([bytes], { type: 'application/octet-stream' }));
  link.download = path.replace(/^.*[/\\]/, '');
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
