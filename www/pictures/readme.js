/**
 * Draws the pictures of the documents with the program itself, from the built site:
 * `npm run pictures:readme`, or only some by `npm run pictures:readme -- http://localhost:4517/ page levels`.
 *
 * Writes into docs/images, each with a light and a dark ground: page (the whole page), sizes
 * (adaptive sampling and models from points), meshes (refined runs as meshes), solids (sharp
 * edges), scans (three-dimensional images), remesh (triangle meshes before and after sampling),
 * shells (whose thickness is a formula), moved (a film of particles that follow a surface) and
 * levels (generation levels growing).
 */
import { mkdir, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { animation } from './animation.js';
import { launch } from './browser.js';
import { MESH_FILES } from './meshes.js';

/** @import { BrowserContextOptions, Page } from '@playwright/test' */

const PAGE_PX = { width: 1440, height: 840 };
/** The page is shown with so many device pixels per pixel, and kept at that. */
const PAGE_SCALE = 1.25;
const PAGE_SURFACE = 'tanglecube';

/** What the strip of sizes shows, from left to right; `zoom` brings it nearer than the fit. */
const SIZES = [
  {
    surface: 'ellipsoid',
    settings: { sampling: 'adaptive', chord_error: 1.5e-4 },
    view: { colour: 'radius' },
  },
  { surface: 'bunny', settings: { radius_share: 0.009 }, view: { colour: 'level', points: true } },
  {
    surface: 'bunny',
    settings: { sampling: 'adaptive', chord_error: 3e-4 },
    view: { colour: 'radius', points: false },
  },
  {
    surface: 'sack-and-hat',
    settings: { sampling: 'adaptive', chord_error: 3e-4 },
    view: { colour: 'curvature', points: false },
  },
];

/**
 * What the strip of meshes shows: the same count by both methods, where the front's grains meet in seams; then two
 * refined runs.
 */
const MESH_VIEW = { colour: 'valence', draw: 'mesh', faces: 'smooth', edges: true, marks: true, points: false };
const MESH_SETTINGS = { size_mode: 'count', count: 3000 };
const MESHES = [
  { surface: 'ellipsoid', settings: { ...MESH_SETTINGS, method: 'front' }, view: MESH_VIEW },
  { surface: 'ellipsoid', settings: { ...MESH_SETTINGS, method: 'refined' }, view: MESH_VIEW },
  { surface: 'tanglecube', settings: { ...MESH_SETTINGS, count: 6000, method: 'refined' }, view: MESH_VIEW },
  { surface: 'gyroid', settings: { ...MESH_SETTINGS, count: 9000, method: 'refined' }, view: MESH_VIEW },
];

/** What the two rows of solids show: as discs above, over the faint surface, and as meshes below. */
const SOLIDS = [
  { formula: 'max(abs(x), abs(y), abs(z)) = 1' },
  {
    formula: 'max(max(abs(x), abs(y), abs(z)) - 1, 0.55 - hypot(x, y), 0.55 - hypot(y, z), 0.55 - hypot(z, x))',
  },
  { formula: 'min(hypot(x, y - 0.6, z), hypot(x, y + 0.6, z)) = 1' },
  { formula: 'max(hypot(x, y) + z - 1, -z)' },
  { formula: 'max(abs(x) - 1, abs(y) - 1.4, abs(z) - 0.25, 0.3 - hypot(abs(x) - 0.5, abs(y) - 0.85))' },
  { formula: 'max(hypot(x, y), hypot(y, z), hypot(z, x)) = 1', zoom: 0.9 },
  {
    formula: 'max(abs(y), abs(0.866025 x + y / 2), abs(0.866025 x - y / 2), abs(z) + 0.5, 1.5 - hypot(x, y)) = 1',
  },
  {
    surface: 'gyroid',
    bounds: { min: [-2.6, -2.6, -2.6], max: [2.6, 2.6, 2.6] },
    settings: { box_faces: 'closed', thickness: 0.6, count: 3000 },
    zoom: 0.95,
  },
].map(({ settings, ...shown }, k) => ({
  ...shown,
  settings: { size_mode: 'count', count: 1200, method: 'refined', ...settings },
  view: {
    ...(k < 4 ? { colour: 'level', draw: 'discs' } : { ...MESH_VIEW, colour: 'normal', marks: false }),
    camera: { yaw: 0.5, pitch: 0.55, fit: true },
  },
}));

/** What the strip of scans shows: the images of the gallery's group of that name. */
const SCANS = ['scan-bone', 'scan-bodies', 'scan-benzene', 'scan-salt'].map((surface) => ({
  surface,
  settings: { ...MESH_SETTINGS, count: 8000, method: 'refined' },
  view: { ...MESH_VIEW, colour: 'normal', edges: false, marks: false, camera: { yaw: 0.5, pitch: 0.4, fit: true } },
}));

/** How the two rows of triangle meshes are sampled and drawn. */
const REMESH = {
  settings: { size_mode: 'count', count: 1200, method: 'refined' },
  view: { ...MESH_VIEW, colour: 'normal', marks: false },
};
/** The edges of triangles take room: at {@link LEVEL_SCALE} a file would be twice as large. */
const REMESH_SCALE = 1;

/** What the strip of shells shows: parts of one gyroid, whose thickness is a number, and then a formula. */
const SHELLS = [0.6, '0.65 + 0.13z', '1.1 - 0.2 hypot(x, y)', '0.25 + 0.7 smoothstep(-1, 1, x)'].map((thickness) => ({
  surface: 'gyroid',
  bounds: { min: [-3.6, -3.6, -3.6], max: [3.6, 3.6, 3.6] },
  settings: { box_faces: 'closed', thickness, size_mode: 'count', count: 6000, method: 'refined' },
  zoom: 0.95,
  view: { ...MESH_VIEW, colour: 'normal', edges: false, marks: false, camera: { yaw: 0.5, pitch: 0.35, fit: true } },
}));

/** Pictures of the film, and the time for which each of them is shown: it plays for six seconds. */
const FILM = { pictures: 60, ms: 100 };
/** Frames in which the surface moves between two pictures of the film, so that it moves as far at a time as on the page. */
const STEPS = 4;
const FILM_QUALITY = 0.75;

/** A frame of the strip, and device pixels per pixel of it. */
const LEVEL_PX = { width: 300, height: 240 };
const LEVEL_SCALE = 1.5;
const LEVEL_SURFACE = 'torus';
const LEVEL_SETTINGS = { radius_share: 0.0075, seed: 3 };
const LEVELS = [10, 17, 25, 34];
const LEVEL_CAMERA = { yaw: 0.62, pitch: 0.72, fit: true };

const [base = 'http://localhost:4517/', ...wanted] = process.argv.slice(2);
/** @param {string} name */
const isWanted = (name) => wanted.length === 0 || wanted.includes(name);
const folder = fileURLToPath(new URL('../../docs/images/', import.meta.url));
await mkdir(folder, { recursive: true });
const browser = await launch();

/** @param {string} name @param {Uint8Array} bytes */
async function write(name, bytes) {
  await writeFile(`${folder}${name}`, bytes);
  console.log(`${name} ${bytes.length} bytes`);
}

/**
 * Compresses pictures side by side, in a page without a content security policy.
 * @param {Buffer[]} pngs
 * @param {number} quality
 * @param {number} [columns]  pictures in a row
 */
async function webp(pngs, quality, columns = pngs.length) {
  const page = await browser.newPage();
  const bytes = await page.evaluate(
    async ({ datas, quality, columns }) => {
      const bitmaps = await Promise.all(
        datas.map(async (data) => createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob())),
      );
      const { width, height } = bitmaps[0];
      const canvas = new OffscreenCanvas(width * columns, height * Math.ceil(bitmaps.length / columns));
      const context = canvas.getContext('2d');
      for (const [k, bitmap] of bitmaps.entries())
        context?.drawImage(bitmap, (k % columns) * width, Math.floor(k / columns) * height);
      return [...new Uint8Array(await (await canvas.convertToBlob({ type: 'image/webp', quality })).arrayBuffer())];
    },
    { datas: pngs.map((png) => png.toString('base64')), quality, columns },
  );
  await page.close();
  return new Uint8Array(bytes);
}

/**
 * Opens the page as on a later visit: on the first one a slider moves by itself.
 * @param {BrowserContextOptions} options
 */
async function open(options) {
  const page = await browser.newPage(options);
  await page.addInitScript(() => localStorage.setItem('marching-particles.invited', 'on'));
  await page.goto(`${base}?backend=webgl2`);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.ready);
  return page;
}

/** Waits until the picture is drawn completely, and nothing fades. @param {Page} page */
async function atRest(page) {
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.still());
  await page.waitForFunction(() => document.getAnimations().every(({ playState }) => playState !== 'running'));
}

for (const theme of isWanted('page') ? /** @type {const} */ (['light', 'dark']) : []) {
  const page = await open({ viewport: PAGE_PX, deviceScaleFactor: PAGE_SCALE, colorScheme: theme });
  await page.evaluate((surface) => /** @type {any} */ (window).marchingParticles.set({ surface }), PAGE_SURFACE);
  await atRest(page);
  await write(`page-${theme}.webp`, await webp([await page.screenshot()], 0.86));
  await page.close();
}

/** Leaves nothing of the page but the picture, and the pins on it. @param {Page} page */
const onlyThePicture = (page) =>
  page.evaluate(() => {
    for (
      let kept = /** @type {Element | null} */ (document.querySelector('canvas'));
      kept && kept !== document.body;
      kept = kept.parentElement
    ) {
      for (const other of kept.parentElement?.children ?? [])
        if (other !== kept && other instanceof HTMLElement && !other.matches('.marks')) other.style.display = 'none';
    }
  });

/**
 * Draws surfaces side by side in both themes.
 * @param {string} name of the files
 * @param {{
 *   zoom?: number, surface?: string, formula?: string, settings: object, view: { colour: string, camera?: object },
 * }[]} states
 * @param {number} [columns]  surfaces in a row
 */
async function strip(name, states, columns) {
  if (!isWanted(name)) return;
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    const page = await open({ viewport: LEVEL_PX, deviceScaleFactor: LEVEL_SCALE, colorScheme: theme });
    await onlyThePicture(page);
    const frames = [];
    for (const { zoom = 1, ...state } of states) {
      await page.evaluate(
        async ({ wanted, zoom }) => {
          const mp = /** @type {any} */ (window).marchingParticles;
          mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
          const camera = { ...mp.state.view.camera, fit: true, ...wanted.view.camera };
          await mp.set({ ...wanted, view: { ...wanted.view, camera } });
          mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
          mp.engine.zoom(zoom);
        },
        { wanted: state, zoom },
      );
      await atRest(page);
      frames.push(await page.screenshot());
    }
    await page.close();
    await write(`${name}-${theme}.webp`, await webp(frames, 0.86, columns));
  }
}

/**
 * Replaces the mesh on the page by the triangles of its file. Each has its corners for itself, with its own normal.
 * @param {Page} page
 */
const showFaces = (page) =>
  page.evaluate(async () => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    const { vertices, faces } = await engine.meshFaces();
    const { columns } = engine;
    const count = faces.length;
    const positions = Float32Array.from(
      { length: 3 * count },
      (_, k) => vertices[3 * faces[Math.floor(k / 3)] + (k % 3)],
    );
    const normals = new Float32Array(3 * count);
    for (let first = 0; first < 3 * count; first += 9) {
      const [a, b, c] = [0, 3, 6].map((k) => [...positions.subarray(first + k, first + k + 3)]);
      const [u, v] = [b, c].map((end) => end.map((x, axis) => x - a[axis]));
      const across = [0, 1, 2].map((k) => u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
      const size = Math.hypot(...across);
      for (let k = 0; k < 9; k += 1) normals[first + k] = across[k % 3] / size;
    }
    // Faces without a radius are not drawn.
    const radii = new Float32Array(count).fill(columns.radii[0]);
    const levels = new Uint32Array(count);
    const triangles = Uint32Array.from({ length: count }, (_, k) => k);
    Object.assign(columns, { count, positions, normals, radii, levels, mesh: { ...columns.mesh, triangles } });
    engine.zoom(1);
  });

/** Draws triangle meshes, above as they are in their files and below as they are sampled anew, in both themes. */
async function remeshed() {
  if (!isWanted('remesh')) return;
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    const [before, after] = [/** @type {Buffer[]} */ ([]), /** @type {Buffer[]} */ ([])];
    for (const { name, text, camera } of MESH_FILES) {
      const page = await open({ viewport: LEVEL_PX, deviceScaleFactor: REMESH_SCALE, colorScheme: theme });
      await onlyThePicture(page);
      await page.evaluate(
        async ({ name, text, wanted }) => {
          const mp = /** @type {any} */ (window).marchingParticles;
          await mp.engine.openFile(new File([text], name));
          const camera = { ...mp.state.view.camera, fit: true, ...wanted.view.camera };
          await mp.set({ ...wanted, view: { ...wanted.view, camera } });
          mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
        },
        { name, text, wanted: { ...REMESH, view: { ...REMESH.view, camera } } },
      );
      await atRest(page);
      after.push(await page.screenshot());
      await showFaces(page);
      await atRest(page);
      before.push(await page.screenshot());
      await page.close();
    }
    await write(`remesh-${theme}.webp`, await webp([...before, ...after], 0.7, MESH_FILES.length));
  }
}

/** A share of the film to a share of the way: there and back, slow at both ends. @param {number} share */
const swing = (share) => (1 - Math.cos(2 * Math.PI * share)) / 2;

/** Waits until the particles have followed and the picture is drawn. @param {Page} page */
const followed = (page) =>
  page.evaluate(async () => {
    const { engine } = /** @type {any} */ (window).marchingParticles;
    do await new Promise((go) => requestAnimationFrame(go));
    while (engine.status.value === 'sampling');
    await new Promise((go) => requestAnimationFrame(go));
  });

/**
 * Opens a surface of the film in a picture that stays as large as it is.
 * @param {Page} page @param {object} surface @param {number} zoom
 */
async function opened(page, surface, zoom) {
  await page.evaluate(
    async ({ surface, zoom }) => {
      const mp = /** @type {any} */ (window).marchingParticles;
      const camera = { ...mp.state.view.camera, fit: true };
      const view = { colour: 'level', flow: true, camera };
      mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
      await mp.set({ ...surface, settings: { size_mode: 'count', count: 2500 }, view });
      mp.engine.setInsets({ left: 0, right: 0, top: 0, bottom: 0 });
      mp.engine.zoom(zoom);
    },
    { surface, zoom },
  );
  await atRest(page);
}

/** The tanglecube falls into eight pieces, and they join again. @param {Page} page */
async function tanglecubeSplits(page) {
  const [from, to] = [11, 13.6];
  await opened(page, { surface: 'tanglecube', parameters: { c: from } }, 0.9);
  return (/** @type {number} */ share) =>
    page.evaluate(
      (c) => /** @type {any} */ (window).marchingParticles.engine.setParameter('c', c),
      from + (to - from) * swing(share),
    );
}

/** The ellipsoid is pulled by one of its particles, with the pointer. @param {Page} page */
async function ellipsoidIsPulled(page) {
  await opened(page, { surface: 'ellipsoid' }, 0.7);
  const at = await page.evaluate(() => {
    const mp = /** @type {any} */ (window).marchingParticles;
    const { columns } = mp.engine;
    let right = { x: 0, y: 0 };
    for (let i = 0; i < columns.count; i += 1) {
      const place = mp.engine.project(columns.shown.subarray(3 * i, 3 * i + 3));
      if (place.x > right.x && mp.engine.pick(place.x, place.y) === i) right = place;
    }
    const { left, top } = document.querySelector('canvas')?.getBoundingClientRect() ?? new DOMRect();
    return { x: left + right.x, y: top + right.y };
  });
  await page.keyboard.down('Shift');
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  // A circle that begins and ends at the particle, so that it is drawn out, up, back and down.
  const reach = 0.09 * LEVEL_PX.width;
  return (/** @type {number} */ share) => {
    const turn = 2 * Math.PI * share;
    return page.mouse.move(at.x + reach * (1 - Math.cos(turn)), at.y - reach * Math.sin(turn));
  };
}

/**
 * Makes a film of surfaces that move, side by side, in both themes.
 * @param {string} name of the files
 * @param {((page: Page) => Promise<(share: number) => Promise<unknown>>)[]} scenes  each opens a surface, and gives what
 *   brings it to a share of the film
 */
async function film(name, scenes) {
  if (!isWanted(name)) return;
  for (const theme of /** @type {const} */ (['light', 'dark'])) {
    /** @type {Buffer[][]} */
    const taken = [];
    for (const scene of scenes) {
      const page = await open({ viewport: LEVEL_PX, colorScheme: theme });
      await onlyThePicture(page);
      const moveTo = await scene(page);
      const pictures = [];
      for (let k = 0; k < FILM.pictures; k += 1) {
        for (let step = 1; step <= STEPS; step += 1) {
          await moveTo((k + step / STEPS) / FILM.pictures);
          await followed(page);
        }
        pictures.push(await page.screenshot());
      }
      taken.push(pictures);
      await page.close();
    }
    const pictures = [];
    for (let k = 0; k < FILM.pictures; k += 1)
      pictures.push({
        picture: Buffer.from(
          await webp(
            taken.map((scene) => scene[k]),
            FILM_QUALITY,
          ),
        ),
        ms: FILM.ms,
      });
    const size = { width: scenes.length * LEVEL_PX.width, height: LEVEL_PX.height };
    await write(`${name}-${theme}.webp`, animation({ pictures, ...size }));
  }
}

await strip('sizes', SIZES);
await strip('meshes', MESHES);
await strip('solids', SOLIDS, 4);
await strip('scans', SCANS);
await remeshed();
await strip('shells', SHELLS);
await film('moved', [tanglecubeSplits, ellipsoidIsPulled]);

const LEVEL_STATES = [...LEVELS, null].map((level) => ({
  surface: LEVEL_SURFACE,
  // The front as it was placed; at the end, as it was relaxed.
  settings: level === null ? LEVEL_SETTINGS : { ...LEVEL_SETTINGS, relax_steps: 0 },
  view: { colour: 'level', level, camera: LEVEL_CAMERA },
}));
await strip('levels', LEVEL_STATES);

await browser.close();
