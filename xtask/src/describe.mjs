// Writes down what the core says of itself, as `description.json`. What calls for the rest of it (`later`) is found by trying
// on the first part alone. Run where the bound core is.
import { readFileSync, writeFileSync } from 'node:fs';

const [first, rest] = ['core_bg.wasm', 'core_rest.wasm'].map((name) => new WebAssembly.Module(readFileSync(name)));
let instances = 0;
async function fresh() {
  const { initSync, whenMissing, Core } = await import(`./core.js?${++instances}`);
  const calls = { count: 0 };
  initSync({ module: first });
  whenMissing(() => {
    calls.count += 1;
    return rest;
  });
  return { core: new Core(), calls };
}
async function isLater(field) {
  const { core, calls } = await fresh();
  const { ok, error } = JSON.parse(core.set_field(JSON.stringify(field)));
  if (!ok) throw new Error(`${JSON.stringify(field)}: ${error.message}`);
  core.start('{}');
  return calls.count > 0;
}
const description = JSON.parse((await fresh()).core.describe());
const later = { functions: [], surfaces: [] };
for (const { id } of description.surfaces) if (await isLater({ surface: id })) later.surfaces.push(id);
const values = { a: 'x', b: 'y', k: '1' };
for (const { name, signature } of description.functions) {
  const call = signature.replace(', …', '').replace(/\b[abk]\b/g, (argument) => values[argument]);
  if (await isLater({ formula: `z = ${call}` })) later.functions.push(name);
}
writeFileSync('description.json', JSON.stringify({ ...description, later }));
