/**
 * Builds the files of the package.
 *
 * @module
 */
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { rolldown } from 'rolldown';

/** @import { Plugin } from 'rolldown' */

const here = dirname(fileURLToPath(import.meta.url));
const ENTRIES = ['index', 'node', 'worker', 'worker-node', 'three', 'view', 'element'];
const DECLARATIONS = ['index', 'three', 'view', 'element'];

/**
 * The package has no folders: a file's name begins with the name of its folder.
 * @param {string} path
 */
function flatName(path) {
  const folder = basename(dirname(path));
  if (path.endsWith('.wasm')) return `${folder}_bg.wasm`;
  return dirname(path) === here ? basename(path) : `${folder}-${basename(path)}`;
}

/**
 * Adds the workers and the modules that scripts name by `new URL('…', import.meta.url)`, and keeps their addresses in
 * this form, which browsers and bundlers understand.
 * @type {Plugin}
 */
const flat = {
  name: 'flat',
  transform(code, id) {
    if (!code.includes('import.meta.url')) return null;
    return code.replace(/new URL\('([^']+\.(?:js|wasm))', import\.meta\.url\)/g, (_, address) => {
      const path = join(dirname(id), address);
      const fileName = flatName(path);
      if (path.endsWith('.wasm')) this.emitFile({ type: 'asset', fileName, source: readFileSync(path) });
      else if (!ENTRIES.includes(basename(fileName, '.js'))) this.emitFile({ type: 'chunk', id: path, fileName });
      return `new URL('./${fileName}', import.meta.url)`;
    });
  },
};

/** @param {string[]} entries @param {import('rolldown').OutputOptions} output */
async function write(entries, output) {
  const bundle = await rolldown({
    input: Object.fromEntries(entries.map((name) => [name, join(here, `${name}.js`)])),
    external: [/^node:/, 'three'],
    platform: 'neutral',
    resolve: { mainFields: ['module', 'main'] },
    moduleTypes: { '.wasm': 'binary' },
    // Only the page's development server sets it.
    transform: { define: { 'import.meta.env.VITE_WITHOUT_WEBGPU': 'undefined' } },
    plugins: [flat],
  });
  await bundle.write({ format: 'es', entryFileNames: '[name].js', chunkFileNames: '[name]-[hash].js', ...output });
  await bundle.close();
}

/** Builds the package into a folder, whose old content is deleted. @param {string} out */
export async function buildPackage(out) {
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  await write(ENTRIES, { dir: out });
  // Everything in one file.
  await write(['inline'], { dir: out, codeSplitting: false });
  for (const name of ['package.json', 'README.md']) copyFileSync(join(here, name), join(out, name));
  for (const name of DECLARATIONS) {
    const declared = readFileSync(join(here, `${name}.d.ts`), 'utf8');
    writeFileSync(join(out, `${name}.d.ts`), declared.replaceAll('../src/engine/core-types.js', './core-types.js'));
  }
  copyFileSync(join(here, '../src/engine/core-types.d.ts'), join(out, 'core-types.d.ts'));
  copyFileSync(join(here, '../../CHANGELOG.md'), join(out, 'CHANGELOG.md'));
  for (const name of ['LICENSE-MIT', 'LICENSE-APACHE']) copyFileSync(join(here, '../..', name), join(out, name));
}
