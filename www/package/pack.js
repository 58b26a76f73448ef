/**
 * Builds the package into the folder that the environment variable PACKAGE names, else `target/package`, and packs it
 * as `marching-particles.tgz` in the same folder. Nothing is published.
 *
 * @module
 */
import { execFileSync } from 'node:child_process';
import { renameSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { buildPackage } from './build.js';

const out = process.env.PACKAGE ?? fileURLToPath(new URL('../../target/package', import.meta.url));

await buildPackage(out);
const packed = execFileSync('npm', ['pack', '--silent', '--ignore-scripts'], {
  cwd: out,
  encoding: 'utf8',
  shell: process.platform === 'win32',
});
renameSync(join(out, packed.trim()), join(out, 'marching-particles.tgz'));
