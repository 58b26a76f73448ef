/**
 * A core of a few lines for the tests of the job loop: a surface whose front grows by one particle per work unit and
 * whose relaxation moves every particle once per step. Time passes only through `clock`.
 */

/**
 * @import { Answer, ImageFacts, ImagePromise } from '../../../src/engine/core-types.js'
 * @import {
 *   Bounds, CoreProgress, CoreReport, FieldAnswer, FieldFault, FieldRequest, MeshAnswer, Settings, SolvedModel, StartAnswer,
 *   StopReason,
 * } from '../../../src/engine/types.js'
 */

/**
 * @param {string} formula @param {Bounds} bounds
 * @returns {FieldAnswer}
 */
const field = (formula, bounds) => ({
  ok: true,
  model: null,
  image: null,
  mesh: null,
  surface: null,
  formula,
  parameters: [],
  auto: [],
  bounds,
  reach: 'bounded',
  periods: [null, null, null],
  mathml: null,
  grip: null,
});

/** @type {ImageFacts} */
const facts = {
  size: [2, 2, 2],
  spacing: [1, 1, 1],
  voxel_type: 'uint8',
  range: [0, 7],
  histogram: [],
  otsu: 3,
  labels: [],
  notes: [],
};

/** @param {string} message @returns {{ok: false, error: FieldFault}} */
const refused = (message) => ({
  ok: false,
  error: {
    kind: 'image',
    message,
    start: 0,
    end: 0,
    suggestion: null,
    choices: [],
    mended: null,
    name: null,
    excess: null,
  },
});

/**
 * @param {object} [options]
 * @param {number} [options.particles]
 * @param {number} [options.relax_steps]
 * @param {number} [options.usPerUnit]
 * @param {number} [options.slices]  of a measurement
 * @param {number} [options.usPerSlice]
 * @param {number} [options.refined_levels]  of a refinement after the front, of which each level has four times as many
 *   particles
 * @param {number} [options.fitSlices]  of the search for a box
 * @param {number} [options.openSlices]  of opening an image
 * @param {number} [options.makeSlices]  of making the field of a file
 */
export function fakeCore({
  particles = 1000,
  relax_steps = 2,
  usPerUnit = 10,
  slices = 1000,
  usPerSlice = 50,
  refined_levels = 0,
  fitSlices = 0,
  openSlices = 0,
  makeSlices = 0,
} = {}) {
  let fitted = 0;
  /** Bytes of the file that was begun, and what is left of opening it. */
  let [added, slicesLeft] = [0, 0];
  let making = { wanted: '', left: 0 };
  const clock = { ms: 0 };
  const calls = /** @type {string[]} */ ([]);
  let isFlat = false;
  let count = 0;
  let step = 0;
  let steps = relax_steps;
  let target = particles;
  /** @type {StopReason} */
  let stop = null;
  let moves = 0;
  let measured = 0;
  /** Count of the run before, whose particles may follow. */
  let started = 0;
  let joined = 0;
  let refined = 0;
  /** @returns {CoreProgress} */
  const progress = (moved = false) => ({
    phase: stop ? 'done' : count < target ? 'generation' : refined_levels ? 'refinement' : 'relaxation',
    particles: count,
    rows: count,
    attempt: 1,
    level: Math.floor(Math.sqrt(count)),
    refine_level: Math.floor(refined) + 1,
    refine_levels: refined_levels,
    relax_step: step,
    relax_steps: steps,
    evaluations: 2 * count,
    fraction: 0,
    stop_reason: stop,
    message: null,
    radius: 0.01,
    moved,
  });
  const column = (/** @type {number} */ from, /** @type {number} */ width, /** @type {any} */ Type) =>
    Type.from(
      { length: (count - from) * width },
      (/** @type {unknown} */ _, /** @type {number} */ i) => from * width + i + moves * 0.5,
    );
  return {
    clock,
    calls,
    /** @param {FieldRequest} request @returns {FieldAnswer} */
    set_field({ formula }) {
      calls.push('set_field');
      if (formula === 'x^2+')
        return {
          ok: false,
          error: {
            kind: 'unexpected_end',
            message: 'something is missing',
            start: 4,
            end: 4,
            suggestion: null,
            choices: [],
            mended: null,
            name: null,
            excess: null,
          },
        };
      return field(formula ?? '', { min: [-1, -1, -1], max: [1, 1, 1] });
    },
    /** @param {string} text @returns {number | undefined} */
    number: (text) => (Number.isFinite(Number(text)) ? Number(text) : undefined),
    text_fault: () => undefined,
    /** @param {Uint8Array} bytes @param {SolvedModel} about @param {Partial<FieldRequest>} request @returns {FieldAnswer} */
    set_points(bytes, { info, bounds: own }, { bounds }) {
      calls.push(`set_points ${bytes.length}`);
      return {
        ok: true,
        model: info,
        image: null,
        mesh: null,
        surface: null,
        formula: '',
        parameters: [],
        auto: [],
        bounds: bounds ?? own,
        reach: null,
        periods: [null, null, null],
        mathml: null,
        grip: null,
      };
    },
    /** @param {string} name @returns {Answer<ImagePromise, FieldFault>} */
    image_promise: (name) =>
      name.endsWith('.bad')
        ? refused('no image')
        : { ok: true, size: [2, 2, 2], voxel_type: 'uint8', memory: 72, bytes: 8 },
    begin_file() {
      added = 0;
    },
    /** @param {number} step */
    keep_one_in(step) {
      calls.push(`keep_one_in ${step}`);
    },
    /** @param {Uint8Array} bytes */
    add_bytes(bytes) {
      added += bytes.length;
    },
    /** @param {string} name */
    open_image(name) {
      calls.push(`open_image ${name} ${added}`);
      slicesLeft = openSlices;
    },
    /** @param {number} budget @returns {number | Answer<ImageFacts, FieldFault>} */
    open_step(budget) {
      slicesLeft -= budget;
      if (isFlat) return { ok: false, error: { ...refused('flat').error, kind: 'no_solid' } };
      return slicesLeft > 0 ? 1 - slicesLeft / openSlices : { ok: true, ...facts };
    },
    open_voxels: () => null,
    /** @param {Partial<FieldRequest>} request @param {number} budget */
    make_opened({ parameters = {} }, budget) {
      const wanted = JSON.stringify(parameters);
      if (wanted !== making.wanted) {
        calls.push(`make ${wanted}`);
        making = { wanted, left: makeSlices };
      }
      making.left -= budget;
      return making.left > 0 ? 1 - making.left / makeSlices : 1;
    },
    /** @param {string} name */
    open_mesh(name) {
      calls.push(`open_mesh ${name} ${added}`);
      slicesLeft = openSlices;
      isFlat = name.startsWith('flat');
    },
    section: () => new Float32Array(0),
    open_faces: () => null,
    /** @returns {any} */
    compare: () => null,
    close_opened: () => {},
    /** @param {Partial<FieldRequest>} request @returns {FieldAnswer} */
    set_opened({ parameters = {} }) {
      making.wanted = '';
      calls.push(`set_opened ${JSON.stringify(parameters)}`);
      return field('', { min: [-1, -1, -1], max: [1, 1, 1] });
    },
    /**
     * @param {Settings} _settings @param {boolean} _onlyGrows @param {number} budget
     * @returns {FieldAnswer | undefined}
     */
    fit(_settings, _onlyGrows, budget) {
      const n = Math.min(budget, fitSlices - fitted);
      fitted += n;
      clock.ms += (n * usPerSlice) / 1000;
      if (fitted < fitSlices) return undefined;
      fitted = 0;
      return field('x', { min: [-2, -2, -2], max: [2, 2, 2] });
    },
    /** @param {Settings} settings @returns {StartAnswer} */
    start(settings) {
      calls.push('start');
      if (settings.count) target = Number(settings.count);
      started = target;
      steps = Number(settings.relax_steps ?? relax_steps);
      count = 0;
      step = 0;
      stop = null;
      measured = 0;
      joined = 0;
      refined = 0;
      return { ok: true, radius: 0.01, predicted_count: target, area: 1, warnings: [] };
    },
    /** Particles follow if the run before had as many as these settings ask for. @param {Settings} settings */
    follow(settings) {
      const can = count > 0 && started === Number(settings.count);
      if (can) {
        calls.push('follow');
        stop = null;
        step = steps - 1;
      }
      return can;
    },
    /** @param {number} budget */
    step(budget) {
      calls.push('step');
      if (count < target) {
        const n = Math.min(budget, target - count);
        count += n;
        clock.ms += (n * usPerUnit) / 1000;
        if (count === target && steps === 0) stop = 'complete';
        return progress();
      }
      joined = 0;
      moves += 1;
      if (refined_levels) {
        // A level is handed on in one step, and worked at in the next.
        refined += 0.5;
        if (refined % 1 === 0) return progress();
        if (refined > 1) target = count *= 4;
        if (refined > refined_levels) stop = 'complete';
        return progress(true);
      }
      step += 1;
      clock.ms += (count * usPerUnit) / 1000;
      if (step >= steps) stop = 'complete';
      return progress(true);
    },
    /** @param {number} more */
    relax(more) {
      steps = step + more;
      stop = null;
    },
    cancel() {
      calls.push('cancel');
      stop = 'cancelled';
      return progress();
    },
    count: () => count,
    positions: (/** @type {number} */ from) => column(from, 3, Float32Array),
    exact_positions: () => new Float64Array(0),
    twins: () => new Uint32Array(0),
    segments: () => new Uint32Array(0),
    seams: () => new Uint32Array(0),
    normals: (/** @type {number} */ from) => column(from, 3, Float32Array),
    radii: (/** @type {number} */ from) => column(from, 1, Float32Array),
    levels: (/** @type {number} */ from) => column(from, 1, Uint32Array),
    parents: (/** @type {number} */ from) => column(from, 1, Uint32Array),
    slots: (/** @type {number} */ from) => column(from, 1, Uint32Array),
    curvature(/** @type {number} */ from) {
      calls.push(`curvature ${from}`);
      return column(from, 2, Float32Array);
    },
    component: () => new Uint32Array(count),
    measure_placed: () => {
      throw new Error('not here');
    },
    set_function: () => {
      throw new Error('not here');
    },
    keep() {},
    combine() {},
    set_kept: () => {
      throw new Error('not here');
    },
    space: () => null,
    add_value: () => null,
    value_names: () => [],
    /** @param {number[]} segments */
    mark_edges(segments) {
      calls.push(`mark_edges ${segments.join(' ')}`);
    },
    mesh_vertices: () => new Float64Array(),
    mesh_faces: () => new Uint32Array(),
    added_value: () => new Float32Array(),
    plan() {},
    fraction: () => measured / slices,
    /** @param {string} _measured @param {number} budget */
    measure(_measured, budget) {
      calls.push('measure');
      const n = Math.min(budget, slices - measured);
      measured += n;
      clock.ms += (n * usPerSlice) / 1000;
      if (measured < slices) return undefined;
      return /** @type {CoreReport} */ ({ count, digest: 'd' });
    },
    /** @param {number} budget @returns {MeshAnswer | undefined} */
    join(budget) {
      calls.push('join');
      const n = Math.min(budget, slices - joined);
      joined += n;
      clock.ms += (n * usPerSlice) / 1000;
      if (joined < slices) return undefined;
      return {
        triangles: 1,
        components: [{ triangles: 1, euler: 1, open_edges: 3, body: 0 }],
        unfilled: 0,
        left_out: count - 3,
        volume: null,
        inside: null,
        smallest_angle: null,
        loops: [],
        bodies: [{ area: 0.5, min: [0, 0, 0], max: [1, 1, 0], volume: null, is_chip: false }],
        chips: [],
      };
    },
    triangles: () => Uint32Array.of(0, 1, 2),
    valence: () => new Uint8Array(count).fill(6),
    nearest: () => new Float32Array(count),
    residual: () => new Float32Array(count),
    energy: () => new Float32Array(count).fill(1),
    patch: () => new Uint32Array(0),
    particle: () => new Uint32Array(0),
    periodic: () => new Uint32Array(0),
    // The loop leaves these to others.
    describe: () => {
      throw new Error('a core of a few lines does not describe itself');
    },
    digest: () => 'd',
    code: () => /** @type {const} */ ({ ok: true, text: 'code' }),
    limit_memory() {},
    mesh_file: () => null,
    particle_file: () => undefined,
    record: () => null,
    free() {},
    [Symbol.dispose]() {},
  };
}
