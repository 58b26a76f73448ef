// What the tests of the bundles share: loading one in Node, the golden files, and the digest of a file.
import { readFile } from 'node:fs/promises';

const root = new URL('../../', import.meta.url);

/** The classes of a bundle of www/src/wasm, and its memory. @param {string} name */
export async function load(name) {
  const folder = new URL(`www/src/wasm/${name}/`, root);
  const bundle = await import(new URL(`${name}.js`, folder).href);
  const { memory } = bundle.initSync({ module: await readFile(new URL(`${name}_bg.wasm`, folder)) });
  return { ...bundle, memory };
}

/** @param {string} name */
export const golden = async (name) => JSON.parse(await readFile(new URL(`tests/golden/${name}`, root), 'utf8'));

/** The answer, if it is no refusal. @param {any} answer @param {string} name what it answers */
export function accepted(answer, name) {
  if (answer.ok !== true) throw new Error(`${name}: ${JSON.stringify(answer)}`);
  return answer;
}

/** FNV-1a, 64 bits. @param {Uint8Array} bytes */
export function digestOf(bytes) {
  let hash = 0xcbf29ce484222325n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  return hash.toString(16).padStart(16, '0');
}
