// Holds the GLB files that tests/it/mesh_export.rs writes to Khronos' validator: no error and no warning.
//
// Usage: node tests/gltf/validate.mjs FOLDER, after `cargo test --test it mesh_export::`; `cargo xtask test gltf` does both.
import { readdir, readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import process from 'node:process';

const root = new URL('../../', import.meta.url);
const { validateBytes } = createRequire(new URL('www/package.json', root))('gltf-validator');

const folder = process.argv[2];
const files = (await readdir(folder)).filter((name) => name.endsWith('.glb'));
if (files.length < 3) throw new Error(`${folder} holds ${files.length} GLB files, not the three of the tests`);

let faults = 0;
for (const name of files) {
  const { issues, info } = await validateBytes(new Uint8Array(await readFile(join(folder, name))));
  const { numErrors, numWarnings, messages } = issues;
  console.log(`${name}: ${info.totalTriangleCount ?? 0} triangles, ${numErrors} errors, ${numWarnings} warnings`);
  for (const { code, message, pointer, severity } of messages.slice(0, 20)) {
    console.log(`  ${['error', 'warning', 'information', 'hint'][severity]} ${code} ${pointer ?? ''}: ${message}`);
  }
  faults += numErrors + numWarnings;
}
process.exitCode = faults === 0 ? 0 : 1;
