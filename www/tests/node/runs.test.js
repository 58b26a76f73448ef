/** Runs: what starts, stops and replaces them, and what the page has of the surface meanwhile. */
import { readFile } from 'node:fs/promises';
import { describe, expect, test } from 'vitest';
import { GRACE_MS, SILENCE_MS } from '../../src/engine/bundle/load.js';
import { ALL } from '../all.js';
import { eventually, expectSurface, link, open, pause, picture, strike, turn, until, wishes } from './engine.js';

const golden = new URL('../../../tests/golden/digests.json', import.meta.url);

test.runIf(ALL)('the same state gives the same particles as the native core', async () => {
  const { runs } = JSON.parse(await readFile(golden, 'utf8'));
  expect(runs.length).toBeGreaterThan(0);
  const p = await open();
  for (const { name, field, settings, digest, count } of runs) {
    const report = await p.set({ parameters: {}, bounds: null, ...field, declared: field.declare ?? [], settings });
    expect({ name, digest: report?.digest, count: report?.count }).toEqual({ name, digest, count });
  }
});

/** Time after which a sampler at work that says nothing is taken for one that hangs. */
const HANG_MS = SILENCE_MS + GRACE_MS;

describe('a sampler that fails', () => {
  for (const fault of /** @type {const} */ (['panic', 'overflow', 'hang'])) {
    test(`by ${fault} is replaced, with the state intact`, async () => {
      const p = await open();
      const before = p.state;
      strike(fault);
      if (fault === 'hang') {
        p.engine.setParameter('a', 1.1);
        await turn(HANG_MS);
      }
      await until(p.engine.notice, (notice) => notice?.id === (fault === 'hang' ? 'hang' : 'panic'));
      expect(p.debug.counts().restarts).toBe(1);
      expect((await p.run())?.count).toBeGreaterThan(200);
      expect(p.engine.notice.value?.details).toContain('Marching Particles');
      if (fault !== 'hang') expect(p.state).toEqual(before);
      await expectSurface(p);
    });
  }

  test('by hanging twice on the same input settles what waits for it', async () => {
    const p = await open();
    const kinds = [];
    for (const fault of [true, true, false]) {
      if (fault) strike('hang');
      const run = p.run();
      if (fault) await turn(HANG_MS);
      await run;
      kinds.push(p.engine.notice.value?.kind);
    }
    // The first time the run is made again; the second time it is given up, until it is asked for.
    expect(kinds.slice(0, 2)).toEqual(['warn', 'error']);
    await expectSurface(p);
  });

  test('four times in a minute is left alone until it is asked for again', async () => {
    const p = await open();
    for (let k = 1; k <= 4; k += 1) {
      strike('panic');
      await eventually(() => p.debug.counts().restarts).toBe(k);
    }
    await until(p.engine.notice, (notice) => notice?.id === 'safe-mode');
    await expectSurface(p);
    p.engine.notice.value?.action?.run();
    await until(p.engine.progress, ({ phase }) => phase === 'done');
    expect(p.engine.notice.value).toBe(null);
  });
});

test('a stop keeps the partial surface, says so, and does not wait for the picture', async () => {
  const p = await open();
  let isDrawn = false;
  // So many steps that it does not end before the stop.
  const set = p.set({ settings: { max_particles: 1_000_000, radius_share: 0.001, relax_steps: 100 } });
  void set.then(() => {
    isDrawn = true;
  });
  await until(p.engine.progress, ({ phase, particles }) => phase === 'generation' && particles > 0);
  await p.stop();
  expect(isDrawn).toBe(false);
  expect(p.engine.result.value).toBe('partial');
  expect(p.engine.progress.value.stop_reason).toBe('cancelled');
  expect(p.particles().count).toBeGreaterThan(0);
});

test('a message of an old run changes nothing', async () => {
  const p = await open();
  const before = p.status();
  p.debug.stale(0);
  expect(p.status()).toEqual(before);
  expect(p.debug.counts().stale).toBeGreaterThan(0);
});

test('a slider dragged at 120 Hz ends at its last value, with one surface on screen', async () => {
  const p = await open();
  for (let k = 0; k < 120; k += 1) {
    p.engine.setParameter('a', 0.6 + 0.005 * k, { live: true });
    await pause(8);
  }
  p.engine.setParameter('a', 1.2);
  await until(p.engine.report, (report) => report);
  expect(p.engine.status.value).not.toBe('sampling');
  const { positions, count } = p.particles();
  let widest = 0;
  for (let i = 0; i < count; i += 1) widest = Math.max(widest, Math.abs(positions[3 * i]));
  expect(widest).toBeCloseTo(1.2, 1);
  const { shown = 0, requested = 0 } = p.engine.lastDrag.value ?? {};
  expect(shown).toBeGreaterThan(0);
  expect(shown).toBeLessThanOrEqual(requested);
});

test('a mistake in the formula keeps the last surface, dimmed; mending it brings it back', async () => {
  const p = await open();
  const clear = await picture(p);
  p.engine.setFormula('x^2 +');
  await until(p.engine.fieldError, (error) => error?.message);
  expect(p.particles().count).toBeGreaterThan(200);
  p.engine.setFormula('x^2 + y^2 + z^2 = 0.5');
  await until(p.engine.fieldError, (error) => error === null);
  await until(p.engine.progress, ({ phase }) => phase === 'done');
  expect((await picture(p)).drawn).not.toBe(clear.drawn);
});

test('a patch with a mistake in its formula, and a run of it, are no reports of the surface before', async () => {
  const p = await open();
  await expect(p.set({ formula: 'x^2 +' })).rejects.toThrow('Something is missing at the end');
  await expect(p.run()).rejects.toThrow('Something is missing at the end');
  expect((await p.set({ formula: 'x^2 + y^2 + z^2 = 0.5' }))?.quality?.euler).toBe(2);
});

test('an earlier state comes back with its camera, and a drag that rests is told as one', async () => {
  const p = await open();
  const { v: _, view, ...shape } = p.state;
  const camera = { ...view.camera, yaw: 1.5, distance: 3, fit: false };
  p.engine.setParameter('a', 1.1, { live: true });
  await turn(400);
  // The control has rested, and the full run with it, but it is still held.
  expect(p.engine.dragging.value).toBe(true);
  p.engine.setParameter('a', 1.2);
  expect(p.engine.dragging.value).toBe(false);
  p.engine.restore({ ...shape, camera });
  await until(p.engine.report, (report) => report);
  expect(p.state).toMatchObject({ ...shape, view: { camera } });
});

test('a formula without a surface leaves the last one, dimmed, says why, and takes nothing for its own', async () => {
  const p = await open();
  const isDimmed = () => p.debug.counts().dimmed;
  p.engine.setFormula('x^2 + y^2 + z^2 + 1');
  await until(p.engine.result, (result) => result === 'none');
  expect(p.engine.progress.value.message).toBeTruthy();
  expect(isDimmed()).toBe(true);
  // The camera stays with the last surface.
  expect((await picture(p)).drawn).toBeGreaterThan(0.09);
  expect(p.particles().count).toBe(0);
  await expect(p.engine.exportFile('csv')).rejects.toThrow();
  // Also a mistake after that, and an editor emptied.
  for (const text of ['x^2 +', '']) {
    p.engine.setFormula(text);
    await until(p.engine.fieldError, (error) => error);
    expect(isDimmed()).toBe(true);
  }
  p.engine.setFormula('x^2 + y^2 + z^2 = 1');
  await eventually(isDimmed).toBe(false);
  expect(p.engine.result.value).not.toBe('none');
});

test.runIf(ALL)('the code of a run is that of the command line', async () => {
  const kept = await readFile(new URL('../../../tests/golden/code.json', import.meta.url), 'utf8');
  /** @type {{digest: string, programs: Record<import('../../src/engine/types.js').Language, string>}[]} */
  const [cushion] = JSON.parse(kept);
  const p = await open();
  const settings = { size_mode: 'count', count: 2000, method: 'refined' };
  const report = await p.set({ formula: 'x^4 + y^4 + z^4 = a', parameters: { a: 0.5 }, settings });
  expect(report?.digest).toBe(cushion.digest);
  for (const language of /** @type {const} */ (['rust', 'js', 'python', 'shell']))
    expect(await p.engine.code(language)).toBe(cushion.programs[language]);
  await p.set({ settings: { box_faces: 'closed' } });
  expect(await p.engine.code('python')).toContain('closed=True');
  expect(await p.engine.code('shell')).toContain('--closed');
});

test('PLY and CSV hold every particle', async () => {
  const p = await open();
  const { count } = p.particles();
  const all = p.engine.description.value?.columns.map(({ name }) => name) ?? [];
  const columns = all.filter((name) => !['patch', 'particle', 'periodic'].includes(name));
  const ply = Buffer.from(await (await p.engine.exportFile('ply')).arrayBuffer()).toString('latin1');
  const header = ply.slice(0, ply.indexOf('end_header'));
  expect(header).toContain(`element vertex ${count}\n`);
  expect(header).toContain('property uchar valence');
  const [names, first, ...rows] = (await (await p.engine.exportFile('csv')).text()).trimEnd().split('\n');
  // What they were made from, and the digest by which they are known when they are made again.
  const { marching_particles: record } = JSON.parse(await (await p.engine.exportFile('json')).text());
  expect(record).toMatchObject({ surface: p.engine.field.value?.surface, digest: p.report()?.digest });
  expect(record.formula).toBe(p.engine.field.value?.formula);
  expect(names.split(',')).toEqual(columns);
  expect(first.split(',').filter((cell) => cell !== '' && Number.isFinite(Number(cell)))).toHaveLength(columns.length);
  expect(rows.length + 1).toBe(count);
  // A surface with creases has two more, and a unit cell another one.
  p.engine.setFormula('max(abs(x), abs(y), abs(z)) = 1');
  const creased = async () => (await (await p.engine.exportFile('csv')).text()).split('\n')[0].split(',');
  await eventually(creased).toEqual(all.filter((name) => name !== 'periodic'));
  p.engine.setFormula('cos(x) + cos(y) + cos(z) = 0');
  p.engine.setSetting('box_faces', 'closed');
  p.engine.setSetting('box_cell', 'periodic');
  await eventually(creased).toEqual(all);
});

for (const [device, userAgent] of /** @type {const} */ ([
  ['desk', 'Linux'],
  ['phone', 'Android 14; Mobile'],
])) {
  // That of a desk takes a run of 200,000 particles.
  const only = device === 'phone' ? test : test.runIf(ALL);
  only(`more particles than the memory of a ${device} holds are refused in words, and fewer are sampled`, async () => {
    wishes.userAgent = userAgent;
    const p = await open();
    const count = (/** @type {number} */ n) => {
      p.engine.setSetting('max_particles', n);
      p.engine.setSetting('size_mode', 'count');
      p.engine.setSetting('count', n);
    };
    const isRefused = (/** @type {number} */ n) =>
      until(p.engine.notice, (now) =>
        now?.text.includes(`There is not enough memory for about ${n.toLocaleString('en')} particles`),
      );
    // 512 MB on a desk, 256 MB on a phone: about 1.4 and 0.7 million.
    count(1_000_000);
    if (device === 'desk') {
      await until(p.engine.progress, ({ particles }) => particles > 200_000);
      count(2_000_000);
      await isRefused(2_000_000);
    } else {
      await isRefused(1_000_000);
    }
    count(5000);
    await until(p.engine.notice, (notice) => notice === null);
    await until(p.engine.report, (report) => report && report.count > 4500);
  });
}

test.runIf(ALL)('the mesh that is exported is byte for byte that of the command line', async () => {
  const [{ field, settings, files }] = JSON.parse(
    await readFile(new URL('../../../tests/golden/meshes.json', import.meta.url), 'utf8'),
  ).runs;
  const p = await open(link({ surface: field.surface, settings }));
  for (const format of /** @type {const} */ (['glb', '3mf', 'stl', 'obj', 'ply'])) {
    const bytes = new Uint8Array(await (await p.engine.exportMesh(format, { plain: true })).arrayBuffer());
    expect(digestOf(bytes), format).toBe(files[format]);
  }
});

test('a mesh is exported with what it was made from, and in another size', async () => {
  const p = await open();
  const placement = { scale: 20, unit: /** @type {const} */ ('mm'), up: /** @type {const} */ ('y') };
  const file = await p.engine.exportMesh('obj', { placement, link: 'https://a.example/#b' });
  const lines = (await file.text()).split('\n').slice(1);
  const start = '# marching_particles ';
  const made = lines.filter((line) => line.startsWith(start));
  const record = JSON.parse(made.map((line) => line.slice(start.length)).join(''));
  const first = lines[made.length];
  const { surface } = p.state;
  expect(record).toMatchObject({ link: 'https://a.example/#b', digest: p.report()?.digest, surface });
  const plain = await (await p.engine.exportMesh('obj', { plain: true })).text();
  const [x, y, z] = (plain.split('\n')[1] ?? '').split(' ').slice(1).map(Number);
  const placed = first.split(' ').slice(1).map(Number);
  for (const [k, v] of [z, x, y].entries()) expect(placed[k]).toBeCloseTo(20 * v, 5);
});

test('a mesh is made by the refined method, once, and its figures are those of the report', async () => {
  // So many particles that some levels are refined.
  const p = await open(link({ settings: { radius_share: 0.01 } }));
  const { particles } = p.engine.progress.value;
  p.engine.makeMesh();
  expect(p.engine.status.value).toBe('sampling');
  await until(p.engine.status, (status) => status !== 'sampling');
  const mesh = await until(p.engine.mesh, (made) => made);
  const report = await until(p.engine.report, (told) => told && told.smallest_angle !== null && told);
  // The state keeps the method that was chosen.
  expect(p.engine.state.value).toMatchObject({ settings: {}, view: { draw: 'mesh' } });
  expect(p.engine.state.value.settings.method).toBeUndefined();
  expect(report).toMatchObject({ smallest_angle: mesh?.smallest_angle, refined_levels: expect.any(Number) });
  expect(mesh?.loops).toEqual([]);
  expect(mesh?.smallest_angle).toBeGreaterThan(30);
  expect(particles).toBeGreaterThan(0);
  // It is there already.
  await until(p.engine.status, (status) => status !== 'sampling');
  const { run } = p.engine.progress.value;
  p.engine.setView({ draw: 'discs' });
  p.engine.makeMesh();
  expect(p.engine.status.value).not.toBe('sampling');
  expect(p.engine.progress.value.run).toBe(run);
  // Back to the particles as they were: the method, and how they are drawn.
  p.engine.leaveMesh();
  await until(p.engine.status, (status) => status !== 'sampling');
  expect(p.engine.state.value.view.draw).toBe('discs');
  expect(p.engine.columns.record?.settings.method).not.toBe('refined');
  expect(p.engine.progress.value.particles).toBe(particles);
});

test('another surface keeps the settings of the sampling, not those of the surface before', async () => {
  const p = await open();
  await p.set({
    settings: { thickness: 0.2, box_faces: 'closed', relax_steps: 4 },
    plane: { normal: [1, 0, 0], offset: 0 },
  });
  p.engine.setSurface('torus');
  await until(p.engine.status, (status) => status !== 'sampling');
  expect(p.state).toMatchObject({ surface: 'torus', settings: { relax_steps: 4 }, plane: null });
  expect(Object.keys(p.state.settings)).toEqual(['relax_steps']);
  await p.set({ settings: { thickness: 0.2 } });
  await p.set({ surface: 'sphere' });
  expect(p.state.settings).toEqual({});
});

/** FNV-1a, 64 bits. @param {Uint8Array} bytes */
function digestOf(bytes) {
  let hash = 0xcbf29ce484222325n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  return hash.toString(16).padStart(16, '0');
}

/**
 * Drags the first parameter in steps of a 600th, and returns how many particles each picture had.
 * @param {Awaited<ReturnType<typeof open>>} p @param {number} steps
 */
async function dragged(p, steps) {
  /** @type {number[]} */
  const counts = [];
  const stop = p.engine.progress.subscribe(({ live, phase }) => {
    if (live && phase === 'done' && p.engine.columns.count > 0) counts.push(p.engine.columns.count);
  });
  const [{ name, value }] = p.engine.field.value?.parameters ?? [];
  for (let k = 1; k <= steps; k += 1) {
    p.engine.setParameter(name, value * (1 + k / 600), { live: true });
    await pause(100);
  }
  stop();
  p.engine.setParameter(name, value * (1 + steps / 600));
  return counts;
}

test('the particles of a finished run follow its surface while a slider is dragged, and the run takes their place', async () => {
  for (const method of ['front', 'refined']) {
    const p = await open(link({ surface: 'torus', settings: { method, size_mode: 'count', count: 6000 } }));
    const before = p.particles();
    const counts = await dragged(p, 10);
    expect(counts.length, method).toBeGreaterThan(0);
    for (const count of counts) expect(Math.abs(count / before.count - 1), method).toBeLessThan(0.05);
    expect(p.engine.lastDrag.value?.coarse, method).toBe(false);
    const report = await until(p.engine.report, (report) => report);
    const { state } = p;
    await p.set({ surface: 'sphere' });
    expect((await p.set({ ...state, view: undefined }))?.digest, method).toBe(report?.digest);
  }
});

test.runIf(ALL)('where particles cannot follow, a coarser run is shown while a slider is dragged', async () => {
  // The surface has creases.
  const formula = 'max(sqrt(x^2+y^2+z^2)-a, z-0.2)';
  const p = await open(
    link({ formula, declared: [], parameters: { a: 1 }, settings: { count: 60_000, size_mode: 'count' } }),
  );
  const counts = await dragged(p, 20);
  expect(counts.length).toBeGreaterThan(0);
  for (const count of counts) expect(count).toBeLessThan(50_000);
  expect(p.engine.lastDrag.value?.coarse).toBe(true);
  await until(p.engine.report, (report) => report && report.count > 57_000);
});
