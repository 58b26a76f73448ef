/**
 * Writes the declarations of the engine, for programs that use it, to `target/declarations`: those of the scripts, which the
 * compiler makes, and those that are written by hand or by the core.
 *
 * @module
 */

import { execFileSync } from 'node:child_process';
import { cpSync, rmSync, statSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const place = (/** @type {string} */ path) => fileURLToPath(new URL(path, import.meta.url));
const out = place('../target/declarations');

rmSync(out, { recursive: true, force: true });
execFileSync('npx', ['tsc', '-p', place('tsconfig.engine.json')], { stdio: 'inherit' });
for (const folder of ['engine', 'wasm']) {
  cpSync(place(`src/${folder}`), `${out}/${folder}`, {
    recursive: true,
    // The bundles of the development server have the same declarations.
    filter: (path) => statSync(path).isDirectory() || path.endsWith('.d.ts'),
  });
}
