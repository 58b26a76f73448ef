import { afterEach, expect, test, vi } from 'vitest';
import { drawerOn } from '../../../src/engine/probe/drawer.js';
import { isProgram } from '../../../src/engine/probe/names.js';

afterEach(() => vi.unstubAllGlobals());

/**
 * A canvas of a browser.
 * @param {string | null} name  of its renderer; null without WebGL2
 * @param {boolean} [isSlow]  whether the browser knows the renderer to be slow
 * @returns {any}
 */
const canvas = (name, isSlow = false) => ({
  getContext: (/** @type {string} */ kind, /** @type {WebGLContextAttributes} */ { failIfMajorPerformanceCaveat }) => {
    expect(kind).toBe('webgl2');
    if (name === null || (isSlow && failIfMajorPerformanceCaveat)) return null;
    return { getExtension: () => null, getParameter: () => name };
  },
});

test('programs that draw in place of a graphics card are known by their names, and cards are not taken for them', () => {
  for (const name of [
    'ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)',
    'Google SwiftShader',
    'llvmpipe (LLVM 15.0.7, 256 bits)',
    'llvmpipe, or similar',
    'ANGLE (Mesa, llvmpipe (LLVM 15.0.6 256 bits), OpenGL 4.5)',
    'softpipe',
    'ANGLE (Microsoft, Microsoft Basic Render Driver (0x0000008C) Direct3D11 vs_5_0 ps_5_0, D3D11)',
    'Apple Software Renderer',
  ])
    expect(isProgram(name), name).toBe(true);
  for (const name of [
    'ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 (0x00002504) Direct3D11 vs_5_0 ps_5_0, D3D11)',
    'ANGLE (Intel, Mesa Intel(R) UHD Graphics 620 (KBL GT2), OpenGL 4.6)',
    'ANGLE (Apple, ANGLE Metal Renderer: Apple M2, Unspecified Version)',
    'Apple GPU',
    'Adreno (TM) 650',
    'Mali-G78',
    'AMD Radeon RX 6800 XT (radeonsi, navi21, LLVM 15.0.7, DRM 3.49)',
    'GeForce GTX 980, or similar',
    'Mozilla',
    '',
  ])
    expect(isProgram(name), name).toBe(false);
});

test('who draws is told by the context that the browser gives, and by its name', () => {
  expect(drawerOn(() => canvas('Adreno (TM) 650'))).toBe('card');
  expect(drawerOn(() => canvas('llvmpipe, or similar'))).toBe('software');
  expect(drawerOn(() => canvas('Adreno (TM) 650', true))).toBe('software');
  expect(drawerOn(() => canvas(null))).toBe('none');
});

test('where a worker has no WebGL2 the page asks itself', async () => {
  /** @param {string} told  by the worker @param {string | null} name  of the renderer of the page */
  const asked = async (told, name) => {
    vi.resetModules();
    vi.stubGlobal(
      'Worker',
      class {
        terminate() {}
        /** @param {(event: {data: string}) => void} hear */
        set onmessage(hear) {
          queueMicrotask(() => hear({ data: told }));
        }
      },
    );
    const createElement = vi.fn(() => canvas(name));
    vi.stubGlobal('document', { createElement });
    const { askDrawer } = await import('../../../src/engine/probe/index.js');
    return [await askDrawer(), createElement.mock.calls.length > 0];
  };
  expect(await asked('card', null)).toEqual(['card', false]);
  expect(await asked('software', 'Apple GPU')).toEqual(['software', false]);
  expect(await asked('none', 'Apple GPU')).toEqual(['card', true]);
  expect(await asked('none', 'llvmpipe')).toEqual(['software', true]);
  expect(await asked('none', null)).toEqual(['none', true]);
});
