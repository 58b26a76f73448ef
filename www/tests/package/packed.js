/** The package, packed and installed into a project of its own, as a program gets it. */
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const www = fileURLToPath(new URL('../..', import.meta.url));

/** Points of a ball, on a spiral from pole to pole. */
export const ROUND = Array.from({ length: 400 }, (_, i) => {
  const [z, angle] = [1 - (2 * i + 1) / 400, 2.399963 * i];
  return [Math.sqrt(1 - z * z) * Math.cos(angle), Math.sqrt(1 - z * z) * Math.sin(angle), z];
}).flat();

/** A surface with its digest in `tests/golden`, as the options of the package have it. */
export const GYROID = {
  formula: 'sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x)',
  options: { radius: '1.2%', bounds: { min: [-3, -3, -3], max: [3, 3, 3] } },
  golden: 'gyroid, cut by its box',
};

/** A program that samples it and calls `told` with the digest. @param {string} told */
export const programOf = (told) => `import { sample } from 'marching-particles';
const gyroid = await sample('${GYROID.formula}', ${JSON.stringify(GYROID.options)});
${told}(gyroid.digest);
`;

/**
 * Packs the package and installs it, with what it is used with from the page's packages.
 * @param {string[]} [others]
 */
export function install(others = []) {
  const project = mkdtempSync(join(tmpdir(), 'marching-particles-'));
  const env = { ...process.env, PACKAGE: join(project, 'packed') };
  execFileSync(process.execPath, [join(www, 'package/pack.js')], { env, stdio: ['ignore', 'ignore', 'inherit'] });
  const modules = join(project, 'node_modules');
  mkdirSync(join(modules, 'marching-particles'), { recursive: true });
  const tarball = join(project, 'packed/marching-particles.tgz');
  execFileSync('tar', ['xzf', tarball, '-C', join(modules, 'marching-particles'), '--strip-components=1']);
  for (const name of others) {
    mkdirSync(join(modules, name, '..'), { recursive: true });
    symlinkSync(join(www, 'node_modules', name), join(modules, name), 'dir');
  }
  writeFileSync(join(project, 'package.json'), '{ "private": true, "type": "module" }');
  return {
    project,
    /** @param {string} name @param {string} text */
    write(name, text) {
      const path = join(project, name);
      writeFileSync(path, text);
      return path;
    },
    /** The package as an import of this test. @returns {Promise<typeof import('../../package/index.js')>} */
    module: () => import(/* @vite-ignore */ pathToFileURL(join(modules, 'marching-particles/node.js')).href),
    remove: () => rmSync(project, { recursive: true, force: true }),
  };
}
