import { describe, expect, test, vi } from 'vitest';
import { loadModule } from '../../../src/engine/bundle/load.js';

// The smallest module: a header and nothing else.
const EMPTY = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0);
/** @param {() => Response | Promise<Response>} answer @param {Partial<typeof WebAssembly>} [wasm] */
const env = (answer, wasm = {}) => ({
  fetch: /** @type {typeof fetch} */ (async () => answer()),
  wasm: /** @type {typeof WebAssembly} */ ({
    validate: WebAssembly.validate,
    compile: WebAssembly.compile,
    compileStreaming: WebAssembly.compileStreaming,
    ...wasm,
  }),
});
const url = 'https://example.org/assets/core_bg.wasm';
const type = (/** @type {string} */ value) => ({ headers: { 'content-type': value } });

describe('the sampler’s file', () => {
  test('is compiled from the stream', async () => {
    const compile = () => Promise.reject(new Error('not streamed'));
    const module = await loadModule(
      url,
      'sampler',
      env(() => new Response(EMPTY, type('application/wasm')), { compile }),
    );
    expect(module).toBeInstanceOf(WebAssembly.Module);
  });

  test('that takes too long is not called damaged', async () => {
    vi.spyOn(AbortSignal, 'timeout').mockReturnValueOnce(AbortSignal.abort(new Error('it timed out')));
    const compileStreaming = () => Promise.reject(new Error('aborted'));
    const loading = loadModule(
      url,
      'sampler',
      env(() => new Response(EMPTY, type('application/wasm')), { compileStreaming }),
    );
    await expect(loading).rejects.toMatchObject({
      fault: 'blocked',
      message: expect.stringMatching(/could not be fetched: it timed out/),
    });
  });

  test('is compiled all the same when the host names the wrong type', async () => {
    const module = await loadModule(
      url,
      'sampler',
      env(() => new Response(EMPTY, type('application/octet-stream'))),
    );
    expect(module).toBeInstanceOf(WebAssembly.Module);
  });

  test.each(
    /** @type {[string, string, () => any, RegExp][]} */ ([
      ['that is not there', 'missing', () => new Response('', { status: 404 }), /core_bg\.wasm.*404/],
      ['that is blocked', 'blocked', () => Promise.reject(new TypeError('Failed to fetch')), /could not be fetched/],
      [
        'that is damaged',
        'corrupt',
        () => new Response(Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 9, 9), type('application/wasm')),
        /damaged/,
      ],
      ['that is cut off', 'corrupt', () => new Response(EMPTY.slice(0, 5), type('application/wasm')), /damaged/],
      [
        'in whose place a page comes',
        'corrupt',
        () => new Response('<!doctype html>', type('text/html')),
        /page in its place/,
      ],
    ]),
  )('%s is named as such', async (_what, fault, answer, words) => {
    await expect(loadModule(url, 'sampler', env(answer))).rejects.toMatchObject({
      fault,
      message: expect.stringMatching(words),
    });
  });

  test('without SIMD or without WebAssembly is not even fetched', async () => {
    const never = () => {
      throw new Error('fetched');
    };
    await expect(loadModule(url, 'sampler', env(never, { validate: () => false }))).rejects.toMatchObject({
      fault: 'no_simd',
    });
    await expect(loadModule(url, 'sampler', { fetch: never, wasm: undefined })).rejects.toMatchObject({
      fault: 'no_wasm',
    });
  });
});
