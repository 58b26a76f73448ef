/** Holds the page's sources to their rooms: who may use whom, and no circle of imports. */
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';

const SRC = fileURLToPath(new URL('../../src', import.meta.url));

/** What a panel may know of the engine; it is handed the engine itself. */
const ENGINE_FACE = [
  'engine/types',
  'engine/constants',
  'engine/vector',
  'engine/pulls',
  'engine/given',
  'engine/brush',
  'engine/patterns',
  'engine/columns',
  'engine/core-numbers',
  'engine/scans',
  'engine/spelling',
  'engine/share/base64url',
];

/**
 * Who may use whom, by path below src/. The longest entry that fits a file counts; every file may use its own room. What is not
 * listed may not be used, and a file that no entry fits has no room yet. The bundles of src/wasm are anybody's in the engine.
 * @type {Record<string, readonly string[]>}
 */
const MAY_USE = {
  main: ['engine', 'ui'],
  'service-worker': [],
  // The words that everything shares.
  'engine/core-types': [],
  'engine/core-numbers': [],
  'engine/constants': [],
  'engine/scans': [],
  'engine/spelling': [],
  'engine/vector': ['engine/types'],
  'engine/pulls': ['engine/types', 'engine/vector'],
  'engine/given': ['engine/types'],
  'engine/brush': ['engine/types', 'engine/vector'],
  'engine/patterns': ['engine/types'],
  'engine/types': ['engine/columns', 'engine/core-types', 'engine/lesson', 'engine/share/view'],
  'engine/columns': ['engine/types', 'engine/core-numbers', 'engine/vector'],
  'engine/store': ['engine/types', 'engine/share'],
  'engine/view': [
    'engine/types',
    'engine/constants',
    'engine/columns',
    'engine/core-numbers',
    'engine/vector',
    'engine/bundle',
    'engine/probe',
  ],
  // What the machine draws with.
  'engine/probe': ['engine/types'],
  // The state holds the camera's.
  'engine/share': [
    'engine/types',
    'engine/brush',
    'engine/constants',
    'engine/columns',
    'engine/core-numbers',
    'engine/vector',
    'engine/pulls',
    'engine/scans',
    'engine/view',
  ],
  // How a bundle is brought in, and how a worker keeps its pace.
  'engine/bundle': [],
  // The lesson runs beside the sampler and knows nothing of it.
  'engine/lesson': ['engine/core-types', 'engine/bundle'],
  // Files of images and meshes, opened in the core: in the worker, and in that of the package.
  'engine/files': ['engine/types', 'engine/core-types', 'engine/bundle'],
  'engine/points': [
    'engine/types',
    'engine/constants',
    'engine/store',
    'engine/share',
    'engine/bundle',
    'engine/files',
    'engine/scans',
  ],
  'engine/sampling': [
    'engine/types',
    'engine/constants',
    'engine/columns',
    'engine/store',
    'engine/share',
    'engine/bundle',
    'engine/files',
    'engine/brush',
    'engine/patterns',
    'engine/points/types',
  ],
  'engine/commands': [
    'engine/types',
    'engine/constants',
    'engine/patterns',
    'engine/store',
    'engine/share',
    'engine/points',
    'engine/parts',
    'engine/scans',
  ],
  // The files beside these rooms put them together.
  engine: ['engine'],
  // Drawings of the lesson, for every page that shows them.
  figures: ['ui/*', ...ENGINE_FACE],
  // The lesson's page stands beside the first: it has its own runs, which the sampler's meter measures, and draws with the
  // painter of the engine.
  learn: ['figures', 'ui/*', 'engine/lesson', 'engine/sampling/meter', 'engine/view', ...ENGINE_FACE],
  // Shared parts of the interface; the panels' folders do not know each other.
  ui: ENGINE_FACE,
  'ui/app': ['ui', ...ENGINE_FACE],
  'ui/field': ['ui/*', ...ENGINE_FACE],
  'ui/levels': ['ui/*', ...ENGINE_FACE],
  'ui/mesh': ['ui/*', ...ENGINE_FACE],
  // A saved picture has the voxels that lie over the one on the page.
  'ui/picture': ['ui/*', 'ui/view/marks', ...ENGINE_FACE],
  'ui/report': ['ui/*', ...ENGINE_FACE],
  'ui/sampling': ['ui/*', ...ENGINE_FACE],
  'ui/view': ['ui/*', ...ENGINE_FACE],
};

/** @typedef {{to: string, type: boolean}} Use  a module by its path below src/, without `.js`; `type`: only its types */

/** Every module that a source names, also in its type comments. @param {string} path @param {string} source @returns {Use[]} */
function usesOf(path, source) {
  const named = /(?:\bfrom\s*|\bimport\s*\(\s*|^\s*import\s+|new URL\(\s*)'(\.{1,2}\/[^'?]+)(?:\?[^']*)?'/gm;
  return [...source.matchAll(named)].map((match) => ({
    to: normalize(join(dirname(path), match[1])).replace(/\.js$/, ''),
    type: /^\s*(?:\/\*)?\*|\/\*\*|^(?:import|export) type/.test(
      source.slice(source.lastIndexOf('\n', match.index) + 1, match.index + 1),
    ),
  }));
}

/** @param {string} room @param {string} module  `ui/*` are the files of ui/ and not its folders */
function lies(room, module) {
  if (room.endsWith('/*')) return dirname(module) === room.slice(0, -2);
  return module === room || module.startsWith(`${room}/`);
}

/** The room of a module: the longest entry that it lies in. @param {string} module */
const roomOf = (module) =>
  Object.keys(MAY_USE)
    .filter((room) => lies(room, module))
    .sort((a, b) => b.length - a.length)[0];

/** What is wrong with the uses of these files. @param {Map<string, Use[]>} files */
function faultsOf(files) {
  /** @type {string[]} */
  const faults = [];
  for (const [path, uses] of files) {
    const room = roomOf(path);
    if (!room) faults.push(`${path} has no room`);
    for (const { to } of room ? uses : []) {
      if (to.startsWith('wasm/') && path.startsWith('engine/')) continue;
      if (roomOf(to) !== room && !MAY_USE[room].some((allowed) => lies(allowed, to))) {
        faults.push(`${path} uses ${to}, which ${room} may not`);
      }
    }
  }
  return faults;
}

/** A circle of imports, or null. Types alone make none: nothing of them is there when the page runs. @param {Map<string, Use[]>} files */
function circleIn(files) {
  /** @type {Set<string>} */
  const done = new Set();
  /** @param {string} path @param {string[]} way @returns {string[] | null} */
  const walk = (path, way) => {
    if (way.includes(path)) return [...way.slice(way.indexOf(path)), path];
    if (done.has(path)) return null;
    for (const { to, type } of files.get(path) ?? []) {
      const circle = type ? null : walk(to, [...way, path]);
      if (circle) return circle;
    }
    done.add(path);
    return null;
  };
  for (const path of files.keys()) {
    const circle = walk(path, []);
    if (circle) return circle.join(' → ');
  }
  return null;
}

/** @param {Record<string, string>} sources */
const graph = (sources) => new Map(Object.entries(sources).map(([path, source]) => [path, usesOf(path, source)]));

const sources = readdirSync(SRC, { recursive: true, encoding: 'utf8' })
  .map((file) => file.replaceAll('\\', '/'))
  .filter((file) => /\.(js|d\.ts)$/.test(file) && !file.startsWith('wasm') && file !== 'engine/core-types.d.ts');
const files = graph(
  Object.fromEntries(
    [...sources, 'engine/core-types.d.ts'].map((file) => [
      file.replace(/\.(js|d\.ts)$/, ''),
      readFileSync(join(SRC, file), 'utf8'),
    ]),
  ),
);

test('every module uses only what its room may use', () => {
  expect(files.size).toBeGreaterThan(80);
  expect(faultsOf(files)).toEqual([]);
});

test('no import goes in a circle', () => {
  expect(circleIn(files)).toBe(null);
});

test('every room exists', () => {
  for (const room of Object.keys(MAY_USE))
    expect(
      [...files.keys()].some((path) => lies(room, path)),
      room,
    ).toBe(true);
});

test('no comment runs over the width of the code', () => {
  const long = sources.flatMap((path) =>
    readFileSync(join(SRC, path), 'utf8')
      .split('\n')
      .filter((line) => line.length > 120 && /^\s*(\/?\*|\/\/)/.test(line))
      .map((line) => `${path}: ${line}`),
  );
  expect(long).toEqual([]);
});

test('a use is found in every form, and judged', () => {
  const uses = usesOf(
    'ui/field/panel',
    `import { a } from '../dom.js';
    import '../view/hover.js';
    const b = () => import('./gallery.js');
    const c = new URL('../../engine/index.js', import.meta.url);
    import d from '../../engine/types.js?url';
    /** @typedef {import('../report/rows.js').Row} Row */
    /**
     * @param {import('../../engine/columns.js').Columns} columns
     */`,
  );
  expect(uses).toEqual([
    { to: 'ui/dom', type: false },
    { to: 'ui/view/hover', type: false },
    { to: 'ui/field/gallery', type: false },
    { to: 'engine/index', type: false },
    { to: 'engine/types', type: false },
    { to: 'ui/report/rows', type: true },
    { to: 'engine/columns', type: true },
  ]);
  expect(faultsOf(new Map([['ui/field/panel', uses]]))).toEqual([
    'ui/field/panel uses ui/view/hover, which ui/field may not',
    'ui/field/panel uses engine/index, which ui/field may not',
    'ui/field/panel uses ui/report/rows, which ui/field may not',
  ]);
  expect(faultsOf(graph({ 'engine/view/viewer': "import { h } from '../../ui/dom.js';" }))).toHaveLength(1);
  expect(faultsOf(graph({ 'nowhere/lesson': '' }))).toEqual(['nowhere/lesson has no room']);
});

test('a circle is found', () => {
  const circle = { a: "import './b.js';", b: "import './c.js';", c: "import('./b.js');" };
  expect(circleIn(graph(circle))).toBe('b → c → b');
  expect(circleIn(graph({ ...circle, c: "/** @typedef {import('./b.js').B} B */" }))).toBe(null);
});
