/**
 * The files of the project as a static server would send them.
 *
 * @module
 */
import { readFile } from 'node:fs/promises';

/** @typedef {{status?: number, type?: string, body?: string | Uint8Array<ArrayBuffer>, isBlocked?: boolean}} Answer */

/**
 * @param {string | URL} at  as Vite gives it: from the root of the page, or of the file system
 * @param {ReadonlyMap<string, Answer>} answers  what is answered in place of a file whose address has this part
 */
export async function fileAt(at, answers) {
  const url = String(at);
  const [, answer = {}] = [...answers].find(([part]) => url.includes(part)) ?? [];
  if (answer.isBlocked) throw new TypeError('fetch failed');
  const { status = 200, type = 'application/wasm' } = answer;
  const file = url.startsWith('file:') ? new URL(url) : new URL(`../..${url}`, import.meta.url);
  const body = status === 200 ? (answer.body ?? (await readFile(file))) : 'not found';
  return new Response(/** @type {any} */ (body), { status, headers: { 'content-type': type } });
}
