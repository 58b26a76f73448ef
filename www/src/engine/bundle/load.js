/**
 * Loads the WebAssembly module of a worker and classifies the cause if loading fails.
 *
 * @module
 */

/** @import { LoadFault } from './types.js' */

/**
 * Time allowed for loading a bundle: enough for the largest one at 15 kB/s. A request that the browser loses would
 * never end.
 */
export const LOADING_MS = 60_000;
/**
 * Time without a message after which a busy worker counts as hung. A step takes some tens of milliseconds, and up to
 * two seconds on a busy machine.
 */
export const SILENCE_MS = 4000;
/**
 * Delay between a silence and counting the worker as hung. A tab that was suspended first handles its waiting messages.
 */
export const GRACE_MS = 120;

/** A module with one 128-bit constant, which is valid exactly if the browser supports SIMD. */
const SIMD_PROBE = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

/**
 * Whether this browser or program has the instructions that the modules need.
 * @param {typeof WebAssembly} wasm
 */
export const hasSimd = (wasm = WebAssembly) => wasm.validate(SIMD_PROBE);

/** An error in loading, with its cause. */
export class LoadError extends Error {
  /** @param {LoadFault} fault @param {string} message */
  constructor(fault, message) {
    super(message);
    this.name = 'LoadError';
    this.fault = fault;
  }
}

/**
 * Fetches and compiles a module. If the server sends a wrong media type, the module is compiled without streaming.
 * @param {string | URL} url
 * @param {string} [what]  name of the module in error messages
 * @param {{fetch: typeof fetch, wasm: typeof WebAssembly | undefined}} [env]
 */
export async function loadModule(
  url,
  what = 'sampler',
  env = { fetch: (...request) => globalThis.fetch(...request), wasm: globalThis.WebAssembly },
) {
  const { wasm } = env;
  if (!wasm) throw new LoadError('no_wasm', `This browser has WebAssembly switched off. The ${what} needs it.`);
  if (!hasSimd(wasm))
    throw new LoadError(
      'no_simd',
      `This browser lacks WebAssembly SIMD, which the ${what} needs. Chrome and Edge have it from 91 on, Firefox from 89, Safari from 16.4.`,
    );
  const name = new URL(url, 'http://localhost').pathname.split('/').pop();
  const signal = AbortSignal.timeout(LOADING_MS);
  const blocked = (/** @type {unknown} */ error) =>
    new LoadError(
      'blocked',
      `The ${what} (${name}) could not be fetched: ${words(error)}. Is the connection up, or an extension blocking it?`,
    );
  let response;
  try {
    response = await env.fetch(url, { signal });
  } catch (error) {
    throw blocked(error);
  }
  if (!response.ok) {
    throw new LoadError(
      'missing',
      `The ${what} (${name}) is not on the server: it answers ${response.status}. The site is incomplete; build it again.`,
    );
  }
  const type = response.headers.get('content-type') ?? '';
  try {
    if (type.startsWith('application/wasm') && wasm.compileStreaming) return await wasm.compileStreaming(response);
    return await wasm.compile(await response.arrayBuffer());
  } catch (error) {
    if (signal.aborted) throw blocked(signal.reason);
    const hint = type.startsWith('text/html') ? 'The server sends a page in its place' : 'The file is damaged';
    throw new LoadError(
      'corrupt',
      `The ${what} (${name}) is no WebAssembly: ${words(error)}. ${hint}; reload, or build the site again.`,
    );
  }
}

/** @param {unknown} error */
export const words = (error) => (error instanceof Error ? error.message : String(error));
