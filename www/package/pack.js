/**
 * Builds the package into the folder that the environment variable PACKAGE names, else `target/package`, and packs it:
 * `marching-particles.tgz` beside its files. Nothing is published.
 *
 * @module
 */
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, renameSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { rolldown } from 'rolldown';

const here = fileURLToPath(new URL('.', import.meta.url));
const out = process.env.PACKAGE ?? join(here, '../../target/package');
const ENTRIES = ['index', 'node', 'worker', 'worker-node', 'three'];

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });

/** @param {string[]} entries @param {import('rolldown').OutputOptions} [output] */
async function write(entries, output) {
  const bundle = await rolldown({
    input: Object.fromEntries(entries.map((name) => [name, join(here, `${name}.js`)])),
    external: [/^node:/, 'three'],
    platform: 'neutral',
    moduleTypes: { '.wasm': 'binary' },
  });
  await bundle.write({ dir: out, format: 'es', entryFileNames: '[name].js', chunkFileNames: '[name].js', ...output });
  await bundle.close();
}
await write(ENTRIES);
// All in one file.
await write(['inline'], { codeSplitting: false });
for (const name of ['package.json', 'README.md', 'index.d.ts', 'three.d.ts'])
  copyFileSync(join(here, name), join(out, name));
for (const name of ['LICENSE-MIT', 'LICENSE-APACHE']) copyFileSync(join(here, '../..', name), join(out, name));
for (const name of ['core', 'points'])
  copyFileSync(join(here, `../src/wasm/${name}/${name}_bg.wasm`), join(out, `${name}_bg.wasm`));
const packed = execFileSync('npm', ['pack', '--silent', '--ignore-scripts'], {
  cwd: out,
  encoding: 'utf8',
  shell: process.platform === 'win32',
});
renameSync(join(out, packed.trim()), join(out, 'marching-particles.tgz'));
