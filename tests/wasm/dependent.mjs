// A program that depends on the library exports what it wrote itself, and asks nothing of its host.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';

const [, , path] = process.argv;
const module = new WebAssembly.Module(await readFile(path));

assert.deepEqual(WebAssembly.Module.imports(module), []);
const exported = WebAssembly.Module.exports(module).map(({ name }) => name);
// The last two are the linker's.
assert.deepEqual(exported.sort(), ['__data_end', '__heap_base', 'count', 'memory']);

const { exports } = new WebAssembly.Instance(module);
const found = /** @type {Function} */ (exports.count)(500);
assert.ok(Math.abs(found - 500) <= 15, `${found} particles`);
console.log(`${found} particles, and ${exported.join(', ')}`);
