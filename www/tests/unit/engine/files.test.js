/** Files of images and meshes on their way into the core, and the jobs that are of them. */
import { createHash } from 'node:crypto';
import { describe, expect, test } from 'vitest';
import { FileKeeper } from '../../../src/engine/files/keeper.js';
import { openGiven } from '../../../src/engine/files/open.js';
import { scanFile } from '../../../src/engine/files/scans.js';
import { Jobs } from '../../../src/engine/sampling/jobs.js';
import { SCANS } from '../../../src/engine/scans.js';
import { ofFiles } from '../../../src/ui/field/files.js';
import { barsOf, filteredOf, voxelsOf } from '../../../src/ui/field/image-words.js';
import { changeOf, facesOf, madeOf, mendedOf } from '../../../src/ui/field/mesh-words.js';
import { fakeCore } from './fake-core.js';

/** @import { Line } from '../../../src/engine/types.js' */

const ROOM = 1e9;
/** Without a clock and with an immediate pause. */
const TIME = { nowMs: () => 0, pause: () => Promise.resolve() };

/** @param {string} name @param {string} [text] */
const imageOf = (name, text = 'voxels') => ({
  as: /** @type {const} */ ('image'),
  key: name,
  name,
  file: new Blob([text]),
  beside: [],
});

/** @param {ReturnType<typeof fakeCore>} fake @returns {any} */
const coreOf = (fake) => fake;

describe('a file of an image', () => {
  test('is read once its header and its memory are known, and told how far it is', async () => {
    const core = coreOf(fakeCore());
    /** @type {[string, number][]} */
    const told = [];
    const tell = (/** @type {string} */ label, /** @type {number} */ share) => void told.push([label, share]);
    const opened = await openGiven(core, imageOf('a.nii'), { ...TIME, tell, isOver: () => false, mostBytes: ROOM });
    expect(opened).toMatchObject({ ok: true, facts: { otsu: 3 } });
    expect(core.calls).toEqual(['open_image a.nii 6']);
    expect(told[1]).toEqual(['Reading 2 × 2 × 2 voxels of uint8, about 1 MB of memory', 0]);
    expect(told.at(-1)?.[1]).toBe(0.5);
  });

  test('is refused by its header, and by its memory, before it is read', async () => {
    const core = coreOf(fakeCore());
    const env = { ...TIME, tell: () => {}, isOver: () => false, mostBytes: ROOM };
    expect(await openGiven(core, imageOf('a.bad'), env)).toEqual({ ok: false, kind: 'image', message: 'no image' });
    const large = await openGiven(core, imageOf('a.nii'), { ...env, mostBytes: 71 });
    // 8 bytes are read, and an eighth of the voxels is left.
    expect(large).toMatchObject({ step: 2 });
    expect(await openGiven(core, { ...imageOf('a.nii'), step: 2 }, { ...env, mostBytes: 16 })).toMatchObject({
      ok: false,
      step: 3,
    });
    expect(core.calls).toEqual([]);
    expect(await openGiven(core, { ...imageOf('a.nii'), step: 3 }, { ...env, mostBytes: 16 })).toMatchObject({
      ok: true,
    });
    expect(core.calls.splice(0)).toEqual(['keep_one_in 3', 'open_image a.nii 6']);
    expect(large).toMatchObject({ ok: false, message: expect.stringContaining('2 × 2 × 2 voxels takes about 1 MB') });
    expect(core.calls).toEqual([]);
  });

  test('is given up without reaching the core', async () => {
    const core = coreOf(fakeCore());
    const env = { ...TIME, tell: () => {}, isOver: () => true, mostBytes: ROOM };
    expect(await openGiven(core, imageOf('a.nii'), env)).toBe(null);
    expect(core.calls).toEqual([]);
  });

  test('is opened in slices, and can be given up between two of them', async () => {
    const core = coreOf(fakeCore({ openSlices: 5000 }));
    /** @type {number[]} */
    const shares = [];
    const tell = (/** @type {string} */ _, /** @type {number} */ share) => void shares.push(share);
    const env = { ...TIME, tell, isOver: () => false, mostBytes: ROOM };
    expect(await openGiven(core, imageOf('a.nii'), env)).toMatchObject({ ok: true });
    expect(shares.length).toBeGreaterThan(5);
    expect(shares).toEqual([...shares].sort((a, b) => a - b));
    const isOver = () => (shares.at(-1) ?? 0) > 0.6;
    shares.length = 0;
    expect(await openGiven(core, imageOf('a.nii'), { ...env, isOver })).toBe(null);
    expect(shares.at(-1)).toBeLessThan(1);
  });

  test('is its header where files are dropped together', () => {
    const files = ['a.img', 'a.hdr'].map((name) => new File([], name));
    expect(ofFiles(files)).toEqual({ file: files[1], beside: [files[0]] });
    expect(ofFiles(files.slice(0, 1)).file).toBe(files[0]);
    expect(ofFiles([]).file).toBe(undefined);
  });
});

describe('a file of a mesh', () => {
  const env = { ...TIME, tell: () => {}, isOver: () => false, mostBytes: ROOM };
  const meshOf = (/** @type {string} */ name) => ({ ...imageOf(name, 'faces'), as: /** @type {const} */ ('mesh') });

  test('is opened as one, and refused by kind if it encloses nothing', async () => {
    const core = coreOf(fakeCore({ openSlices: 100 }));
    /** @type {number[]} */
    const told = [];
    const tell = (/** @type {string} */ _, /** @type {number} */ share) => void told.push(share);
    expect(await openGiven(core, meshOf('a.stl'), { ...env, tell })).toEqual({ ok: true, facts: null });
    expect(told.at(-1)).toBeGreaterThan(0.5);
    let looks = 0;
    expect(await openGiven(core, meshOf('a.stl'), { ...env, isOver: () => ++looks > 2 })).toBe(null);
    core.calls.pop();
    expect(core.calls).toEqual(['open_mesh a.stl 5']);
    expect(await openGiven(core, meshOf('flat.stl'), env)).toEqual({ ok: false, kind: 'no_solid', message: 'flat' });
  });

  test('is refused before it is read if its memory is not there', async () => {
    const core = coreOf(fakeCore());
    const large = await openGiven(core, meshOf('a.stl'), { ...env, mostBytes: 10 });
    expect(large).toMatchObject({ ok: false, kind: 'mesh', message: expect.stringContaining('simplify it first') });
    expect(core.calls).toEqual([]);
  });

  test('has its marked edges before its field is made, and again none', async () => {
    const core = coreOf(fakeCore());
    const keeper = new FileKeeper(ROOM, TIME);
    const file = { ...meshOf('a.stl'), key: 'a' };
    await keeper.open(core, file);
    core.calls.length = 0;
    /** @type {Line} */
    const line = [
      [0, 0, 0],
      [1, 0, 0],
      [1, 2, 0],
    ];
    for (const request of [{ lines: [line] }, {}]) {
      while (!keeper.isReady(core, file, request, { whenReady: () => {} })) await Promise.resolve();
      keeper.setField(core, file, request);
    }
    const marks = core.calls.filter((/** @type {string} */ call) => !call.startsWith('make'));
    expect(marks).toEqual([
      'mark_edges 0 0 0 1 0 0 1 0 0 1 2 0',
      expect.stringContaining('set_opened'),
      'mark_edges ',
      expect.stringContaining('set_opened'),
    ]);
  });

  test('is told in words, and so is what has become of it', () => {
    const info = /** @type {any} */ ({
      faces: 1200,
      vertices: 600,
      pieces: 1,
      border_edges: 8,
      fan_edges: 0,
      mended: ['3 vertices merged', '1 face turned'],
      has_colours: false,
      part: { patches: 6, edges: 12, corners: 8, faded: 1, rim: null },
      scan: null,
    });
    const rim = { edges: 8, loops: 2, is_smoothed: false };
    expect(madeOf({ ...info, part: { ...info.part, rim } })).toContain(
      'The surface ends at its border, 2 closed curves of 8 edges.',
    );
    expect(facesOf({ ...info, part: null, scan: {} })).toBe(
      '1,200 faces with 600 vertices in 1 piece. Holes with 8 edges at their borders are closed smoothly.',
    );
    expect(mendedOf(info)).toBe('Mended: 3 vertices merged, 1 face turned.');
    expect(mendedOf({ ...info, mended: [] })).toBe('');
    expect(madeOf(info)).toContain('6 patches between 12 sharp edges of the mesh and 8 corners. 1 sharp edge');
    const scan = { size: [96, 64, 1200], cell: 0.0125, smooth: 0.7 };
    expect(madeOf({ ...info, part: null, scan })).toBe(
      'A scan, without sharp edges: its distance on a grid of 96 × 64 × 1,200 cells of 0.0125, smoothed by a Gaussian of 0.7 cells.',
    );
    const far = { mean: 0.001, most: 0.004, largest: 0.01 };
    const rows = changeOf({ diagonal: 10, to_new: far, to_old: far, edges: null, volume: [8, 7.92], area: [24, 24] });
    expect(rows.map(({ label }) => label)).toEqual(['Old to new', 'New to old', 'Volume', 'Area']);
    expect(rows[0]).toMatchObject({
      value: 'up to 0.01 (0.1% of the diagonal)',
      help: expect.stringContaining('The mean is 0.001, and 99\u202f% are below 0.004.'),
    });
    expect(rows[2].value).toBe('8 → 7.92 (−1%)');
    expect(rows[3].value).toBe('24 → 24 (the same)');
  });
});

describe('a job of an image', () => {
  const job = (/** @type {number} */ id, /** @type {string} */ name) =>
    /** @type {any} */ ({
      id,
      job: { kind: 'new', field: { parameters: { iso: id } }, settings: {} },
      given: { file: imageOf(name) },
    });

  const live = (/** @type {number} */ id) => {
    const { job: whole, ...numbered } = job(id, 'a.nii');
    return { ...numbered, job: { ...whole, kind: 'live' } };
  };

  test('waits until the core has its image, also after another one', async () => {
    const core = coreOf(fakeCore());
    const keeper = new FileKeeper(ROOM, TIME);
    /** @type {any[]} */
    const posted = [];
    /** @type {() => void} */
    let ready = () => {};
    const jobs = new Jobs(
      (message) => void posted.push(message),
      () => 0,
      {
        isReady: (ours, _, file, field) => keeper.isReady(ours, file, field, { whenReady: () => ready() }),
        setField: (ours, file, field) => keeper.setField(ours, file, field),
        stop: () => keeper.stop(),
      },
    );
    for (const [id, name] of /** @type {[number, string][]} */ ([
      [1, 'a.nii'],
      [2, 'b.nii'],
      [3, 'a.nii'],
    ])) {
      const isOpen = new Promise((done) => {
        ready = () => done(null);
      });
      jobs.add(job(id, name));
      expect(jobs.take(core)).toBe(null);
      await isOpen;
      expect(jobs.take(core)?.id).toBe(id);
    }
    expect(core.calls.filter((/** @type {string} */ call) => call.startsWith('open'))).toHaveLength(3);
    expect(core.calls.at(-1)).toBe('set_opened {"iso":3}');
    expect(posted.map(({ type, id }) => `${type} ${id}`)).toEqual(['field 1', 'field 2', 'field 3']);
    // The image is still there for the next one.
    jobs.add(job(4, 'a.nii'));
    expect(jobs.take(core)?.id).toBe(4);
  });

  /** Jobs on a core whose fields take some slices, and what they post. @param {string} name */
  async function slowly(name) {
    const core = coreOf(fakeCore({ makeSlices: 5000 }));
    const keeper = new FileKeeper(ROOM, TIME);
    await keeper.open(core, imageOf(name));
    /** @type {string[]} */
    const posted = [];
    let made = Promise.resolve();
    const jobs = new Jobs(
      (message) => void posted.push(`${message.type} ${'id' in message ? message.id : ''}`),
      () => 0,
      {
        isReady(ours, _, file, field) {
          let whenReady = () => {};
          made = new Promise((done) => {
            whenReady = done;
          });
          return keeper.isReady(ours, file, field, { whenReady });
        },
        setField: (ours, file, field) => keeper.setField(ours, file, field),
        stop: () => keeper.stop(),
      },
    );
    return { core, jobs, posted, made: () => made };
  }

  test('has its field made in slices, while the control moves on', async () => {
    const { core, jobs, posted, made } = await slowly('a.nii');
    jobs.add(live(1));
    expect(jobs.take(core)).toBe(null);
    const first = made();
    // The next values of a drag wait for this one; the last of them waits longest.
    jobs.add(live(2));
    jobs.add(live(3));
    expect(jobs.take(core)).toBe(null);
    await first;
    expect(jobs.take(core)?.id).toBe(1);
    expect(core.calls.slice(1)).toEqual(['make {"iso":1}', 'set_opened {"iso":1}']);
    expect(jobs.take(core)).toBe(null);
    // What is left when the control is let go does not wait.
    jobs.add(job(4, 'a.nii'));
    expect(jobs.take(core)).toBe(null);
    await made();
    expect(jobs.take(core)?.id).toBe(4);
    expect(posted).toEqual(['field 1', 'field 4']);
  });

  test('is dropped if it is stopped while its field is made', async () => {
    const { core, jobs, posted, made } = await slowly('a.nii');
    jobs.add(job(1, 'a.nii'));
    expect(jobs.take(core)).toBe(null);
    jobs.stop();
    await made();
    expect(jobs.take(core)).toBe(null);
    expect(posted).toEqual(['dropped 1']);
    expect(core.calls.at(-1)).toBe('make {"iso":1}');
    jobs.add(job(2, 'a.nii'));
    expect(jobs.take(core)).toBe(null);
    await made();
    expect(jobs.take(core)?.id).toBe(2);
  });

  test('is refused if its file is none any more', async () => {
    const core = coreOf(fakeCore());
    const keeper = new FileKeeper(ROOM, TIME);
    const image = imageOf('a.bad');
    await new Promise((done) => {
      expect(keeper.isReady(core, image, {}, { whenReady: done })).toBe(false);
    });
    expect(keeper.isReady(core, image, {}, { whenReady: () => {} })).toBe(true);
    expect(keeper.setField(core, image, {})).toMatchObject({
      ok: false,
      error: { kind: 'image', message: 'no image' },
    });
  });
});

test('the computed images are the same every time', async () => {
  const sums = await Promise.all(
    SCANS.map(async ({ id }) => {
      const bytes = Buffer.from(await scanFile(id).arrayBuffer());
      return createHash('sha256').update(bytes).digest('hex').slice(0, 16);
    }),
  );
  expect(sums).toEqual(['beb58918ec473f19', '40841137e17ab6c3', '8e077dfbe0296c64', '99b531eb653260f4']);
});

describe('an image is described', () => {
  test('by its voxels and by what filtered them', () => {
    const facts = /** @type {any} */ ({ size: [64, 64, 1200], spacing: [0.7, 0.7, 1.5], voxel_type: 'int16' });
    expect(voxelsOf({ ...facts, range: [-1024, 3071] })).toBe(
      '64 × 64 × 1,200 voxels of 0.7 × 0.7 × 1.5, int16, −1,024 to 3,071.',
    );
    const info = /** @type {any} */ ({ smooth: 0.7, is_smooth_chosen: true, label: null, noise: 15.2 });
    expect(filteredOf(info)).toBe('A Gaussian of 0.7 voxels against noise of 15: it rounds corners by about as much.');
    expect(filteredOf({ ...info, noise: 0 })).toContain('against the steps between whole numbers');
    expect(filteredOf({ ...info, smooth: 1, label: 3 })).toContain('A Gaussian of 1 voxel over the distance');
    expect(filteredOf({ ...info, smooth: 0, is_smooth_chosen: false })).toBe('');
  });

  test('by a histogram whose highest bar is full', () => {
    expect(barsOf([0, 999, 0, 1])).toBe('M1 1V0h1V1zM3 1V0.9h1V1z');
  });
});
