/**
 * The sampler's side of the package. It samples in slices, each field in its own core, and keeps the cores of samples
 * that may still ask for a mesh, a file or moved particles.
 *
 * @module
 */
import { hasSimd } from '../src/engine/bundle/load.js';
import { inSlices } from '../src/engine/bundle/slices.js';
import { openGiven } from '../src/engine/files/open.js';
import loadCore, { Core } from '../src/wasm/core/core.js';
import loadPoints from '../src/wasm/points/points.js';
import { fitted } from './cloud.js';
import { optionOf } from './options.js';
import { pause } from './pause.js';
import { Program } from './program.js';

/**
 * @import { Fault, Parameter, Progress as CoreProgress } from '../src/engine/core-types.js'
 * @import { Progress } from './index.js'
 * @import { Answered, Asked, Environment, Made, Said, SentField } from './protocol.js'
 */

const PROGRESS_MS = 50;
/** The choices for an image and for a mesh, by their names in the core. */
const OF_IMAGES = ['iso', 'label', 'smooth', 'dark', 'closed'];
const OF_MESHES = ['edges', 'borders', 'smooth'];
/** Largest memory of a run and its report: half of what browsers allow a module. */
const MEMORY_MB = 2048;
const WITHOUT_SIMD =
  'There is no WebAssembly SIMD here, which the sampler needs. Chrome and Edge have it from 91 on, Firefox from 89, ' +
  'Safari from 16.4, Node from 16.4; a browser may have it switched off.';

/** An error whose name and facts become an error on the other side. */
class Refusal extends Error {
  /** @param {string} name @param {string} message @param {object} [facts] */
  constructor(name, message, facts = {}) {
    super(message);
    this.name = name;
    this.facts = facts;
  }
}

/** @param {Fault} fault */
function refusalOf({ kind, message, start, end, suggestion, choices }) {
  // Such a message begins with the name of the setting that is out of range.
  const named = message.replace(/^([a-z_]+) is /, (_, setting) => `The option ${optionOf(setting)} is `);
  if (
    ['request', 'settings', 'too_many', 'box', 'points', 'image', 'mesh', 'no_faces', 'no_solid'].includes(kind) ||
    (kind === 'value' && start === end)
  )
    return new Refusal('InputError', named);
  return new Refusal('FormulaError', message, { start, end, suggestion, choices });
}

/**
 * Refuses an option that has no effect together with the others.
 * @param {Core} core @param {Extract<Asked, {type: 'sample'}>} message
 */
function checkEffects(core, { given, settings }) {
  if (Object.keys(given).length === 0) return;
  /** @type {import('../src/engine/core-types.js').Description} */
  const { settings: table } = core.describe();
  const chosen = (/** @type {string} */ name) => settings[name] ?? table.find((row) => row.name === name)?.default;
  for (const { name, when } of table) {
    // Relaxation steps matter even for the refined method, if its front cannot be refined.
    const isSoft = (/** @type {string} */ other) => name === 'relax_steps' && other === 'method';
    const conditions = name in given ? when.filter((condition) => !isSoft(condition.name)) : [];
    const failed = conditions.find((condition) => (chosen(condition.name) === condition.value) !== condition.equal);
    if (failed)
      throw new Refusal('InputError', `The option ${given[name]} has no effect ${NEEDED[failed.name](failed)}.`);
  }
}
/** What a setting without effect needs. @type {Record<string, (failed: {value: string, equal: boolean}) => string>} */
const NEEDED = {
  sampling: ({ value }) => `${value === 'adaptive' ? 'without' : 'with'} adaptive: true`,
  size_mode: () => 'beside count',
  box_faces: () => 'without closed: true',
  method: () => "with method: 'refined'",
  pattern: () => "without pattern: 'hexagonal'",
  radius_law: ({ equal }) => `without law: ${equal ? "'chord_error'" : "'max_curvature' or 'sum_of_curvatures'"}`,
};

/** Whether a text is the identifier of a surface of the gallery. @param {Core} core @param {string} [text] */
function isOfGallery(core, text = '') {
  if (!/^[a-z][a-z0-9-]*$/.test(text)) return false;
  /** @type {import('../src/engine/core-types.js').Description} */
  const { surfaces } = core.describe();
  return surfaces.some(({ id }) => id === text);
}

/** The request for the surface of the gallery that the formula names. @param {Omit<SentField, 'solid'>} request */
const named = ({ formula: surface, ...request }) => ({ ...request, surface });

/**
 * Answers the messages of one client.
 * @param {Environment} environment
 * @returns {(message: Asked | Said) => Promise<void>}
 */
export function serve({ post, load }) {
  /** The modules that were requested. @type {Map<'core' | 'points', Promise<unknown>>} */
  const modules = new Map();
  /** @type {Map<number, Core>} */
  const cores = new Map();
  /** The functions of the program that cores call. @type {Map<Core, Program[]>} */
  const programs = new Map();
  /** The end of each core's last request. @type {WeakMap<Core, Promise<void>>} */
  const turns = new WeakMap();
  /** Current requests, and whether each is to stop. @type {Map<number, boolean>} */
  const asked = new Map();

  /**
   * Loads a module once.
   * @param {'core' | 'points'} name @param {(options: any) => Promise<unknown>} init
   */
  async function loaded(name, init) {
    if (!hasSimd()) throw new Refusal('WorkerError', WITHOUT_SIMD);
    const loading = modules.get(name) ?? load(name).then((from) => init({ module_or_path: from }));
    modules.set(name, loading);
    await loading.catch((error) => {
      throw new Refusal('WorkerError', `${name}_bg.wasm did not load from beside the script: ${error.message}`);
    });
  }

  /**
   * A function of the program in a form that a core can call.
   * @param {NonNullable<SentField['program']>} program @param {Core} core @param {string} [what]
   */
  function held(program, core, what) {
    const called = new Program(program, what);
    programs.set(core, [...(programs.get(core) ?? []), called]);
    return called;
  }

  /** @param {Core} core */
  function free(core) {
    programs.delete(core);
    core.free();
  }

  /**
   * Does work after the core's earlier requests, so that nothing changes or is freed between the slices of one of them.
   * @template T
   * @param {Core} core @param {() => T | Promise<T>} work @returns {Promise<T>}
   */
  function inTurn(core, work) {
    const done = (turns.get(core) ?? Promise.resolve()).then(work);
    const end = () => {};
    turns.set(core, done.then(end, end));
    return done;
  }

  /**
   * Does a core's work in slices and returns its result. Between slices `tell` makes the progress report for the
   * program.
   * @template T
   * @param {{id: number, core: Core}} of @param {(budget: number) => T | undefined} slice
   * @param {() => Progress} [tell]
   */
  async function done({ id, core }, slice, tell) {
    let toldMs = performance.now();
    const checked = (/** @type {number} */ budget) => {
      const made = slice(budget);
      const failure = programs.get(core)?.find((program) => program.failure)?.failure;
      if (failure) throw new Refusal('FieldError', failure.message, { cause: failure.cause });
      return made;
    };
    const after = () => {
      if (!tell || performance.now() - toldMs <= PROGRESS_MS) return;
      toldMs = performance.now();
      post({ id, progress: tell() });
    };
    const env = { nowMs: () => performance.now(), pause, interrupt: () => (asked.get(id) ? 'stop' : null) };
    const { made, why } = await inSlices(checked, env, { after });
    if (why !== null) throw new Refusal('AbortError', 'The sampling was aborted.');
    return made;
  }

  /**
   * Steps a run to its end. Returns the number of particles.
   * @param {{id: number, core: Core}} of
   */
  async function run(of) {
    const { core } = of;
    /** @type {CoreProgress} */
    let now;
    const step = (/** @type {number} */ budget) => {
      now = core.step(budget);
      return now.phase === 'done' ? now : undefined;
    };
    const last = await done(of, step, () => ({
      phase: now.phase,
      particles: now.particles,
      fraction: now.fraction,
    }));
    if (last.particles === 0) throw new Refusal('NoSurfaceError', last.message ?? 'There is no surface in the box.');
    return last.particles;
  }

  /**
   * Gives a core its field.
   * @param {SentField} field @param {{id: number, core: Core}} of
   */
  async function taken({ program, cloud, given, solid, ...request }, of) {
    const { core } = of;
    if (solid) {
      const parameters = await keptSolid(solid, request.parameters, of);
      const answer = core.set_kept(request);
      return answer.ok ? { ...answer, parameters: [...parameters, ...answer.parameters] } : answer;
    }
    if (program) {
      const called = held(program, core);
      return core.set_function(called.call, request, called.labels);
    }
    if (given) return takenGiven(given, request, of);
    if (!cloud) return core.set_field(isOfGallery(core, request.formula) ? named(request) : request);
    await loaded('points', loadPoints);
    const fit = await fitted(cloud, (slice) => done(of, slice));
    if ('error' in fit) throw new Refusal('InputError', fit.error);
    return core.set_points(fit.system, fit.about, request);
  }

  /**
   * Has a core keep a combination. Returns the parameters of the formulas in it.
   * @param {NonNullable<SentField['solid']>} solid @param {SentField['parameters']} parameters
   * @param {{id: number, core: Core}} of
   * @returns {Promise<Parameter[]>}
   */
  async function keptSolid({ join, of: operands, by }, parameters, of) {
    const found = [];
    for (const operand of operands) {
      if (operand.solid) {
        found.push(...(await keptSolid(operand.solid, parameters, of)));
      } else {
        const answer = await taken({ ...operand, parameters }, of);
        if (!answer.ok) throw refusalOf(answer.error);
        found.push(...answer.parameters);
        of.core.keep();
      }
    }
    of.core.combine(join, operands.length, by);
    return found;
  }

  /**
   * Gives a core the surface of an image or a mesh.
   * @param {NonNullable<SentField['given']>} given @param {Omit<SentField, 'given'>} request
   * @param {{id: number, core: Core}} of
   */
  async function takenGiven(given, request, of) {
    const { id, core } = of;
    if ('faces' in given) {
      const fault = core.open_faces(given.name, given.points, given.faces);
      if (fault) throw refusalOf(fault);
    } else if ('voxels' in given) {
      const { name, type, size, rows, voxels } = given;
      const fault = core.open_voxels(name, type, new Uint32Array(size), new Float64Array(rows), voxels);
      if (fault) throw refusalOf(fault);
    } else {
      const fraction = (/** @type {number} */ share) => ({ phase: 'reading', particles: 0, fraction: 0.1 * share });
      const opened = await openGiven(core, given, {
        tell: (_, share) => post({ id, progress: fraction(share) }),
        isOver: () => asked.get(id) === true,
        mostBytes: MEMORY_MB * 1e6,
        nowMs: () => performance.now(),
        pause,
      });
      if (opened && !opened.ok) throw new Refusal('InputError', opened.message);
    }
    if (asked.get(id)) throw new Refusal('AbortError', 'The sampling was aborted.');
    await done(of, (budget) => (core.make_opened(request, budget) === 1 ? true : undefined));
    const answer = core.set_opened(request);
    // The field has its own copy, which shares the voxels and faces.
    core.close_opened();
    return answer;
  }

  /**
   * Sets a field, then samples it or lets the particles follow it, and measures them.
   * @param {Extract<Asked, {type: 'sample' | 'moved'}>} message @param {Core} core
   */
  async function made(message, core) {
    const { id, field, measure, type } = message;
    /** @type {Record<string, any>} */
    const settings = message.settings;
    const of = { id, core };
    const answer = await taken(field, of);
    if (!answer.ok) throw refusalOf(answer.error);
    const { spacing, values } = message.functions;
    if (spacing !== undefined) {
      const fault = core.space(
        typeof spacing === 'string' ? spacing : held(spacing, core, 'The function of the spacing').call,
      );
      if (fault) throw refusalOf(fault);
    }
    const isKnown = (/** @type {string} */ name) =>
      answer.parameters.some((p) => p.name === name) ||
      (answer.image !== null && OF_IMAGES.includes(name)) ||
      (answer.mesh !== null && OF_MESHES.includes(name));
    const unknown = Object.keys(field.parameters).find((name) => !isKnown(name));
    if (unknown !== undefined) throw new Refusal('InputError', `The formula has no parameter “${unknown}” (params).`);
    if (message.type === 'sample') checkEffects(core, message);
    const box = await done(of, (budget) => core.fit(settings, type === 'moved', budget));
    if (!box.ok) throw refusalOf(box.error);
    if (type === 'sample' || !core.follow(settings, false)) {
      const start = core.start(settings);
      if (!start.ok) throw refusalOf(start.error);
    }
    core.plan(measure ? 'particles' : 'nothing', false);
    const particles = await run(of);
    const measuring = () => ({ phase: 'measuring', particles, fraction: core.fraction() });
    const measured = () => done(of, (budget) => core.measure('particles', budget), measuring);
    const report = measure ? await measured() : null;
    for (const [name, value] of Object.entries(values)) {
      const taken = typeof value === 'string' ? value : held(value, core, `The function of the value ${name}`).call;
      const fault = await done(of, (budget) => core.add_value(name, taken, budget));
      if (fault) throw refusalOf(fault);
    }
    const isRemeshed = measure && answer.mesh !== null && box.formula === '';
    if (isRemeshed) await done(of, (budget) => core.join(budget));
    const change = isRemeshed ? await done(of, (budget) => core.compare(budget)) : null;
    // The columns of the program, and the colours of a mesh.
    const columns = core.value_names().map((name) => [name, core.added_value(name)]);
    return columnsOf(core, {
      count: particles,
      report,
      bounds: box.bounds,
      // A combination does not have those of its operands.
      parameters: field.solid ? answer.parameters : box.parameters,
      image: box.image,
      original: box.mesh,
      change,
      values: Object.fromEntries(columns),
    });
  }

  /**
   * Makes a sample, and keeps its core.
   * @param {Extract<Asked, {type: 'sample' | 'moved'}>} message @param {Core} core
   */
  async function kept(message, core) {
    try {
      const result = await made(message, core);
      cores.set(message.id, core);
      return result;
    } catch (error) {
      // No sample uses this core. After any other error it cannot be trusted to free itself.
      if (error instanceof Refusal) free(core);
      throw error;
    }
  }

  /**
   * Joins the particles to a mesh, for the program or for a file, or writes them as they are.
   * @param {Extract<Asked, {type: 'mesh' | 'file'}>} message @param {Core} core
   * @returns {Promise<[object, ArrayBufferLike[]]>}
   */
  async function joined(message, core) {
    const of = { id: message.id, core };
    if (message.type === 'file' && !message.mesh) {
      const bytes = core.particle_file(message.format);
      return [{ bytes }, bytes ? [bytes.buffer] : []];
    }
    const about = await done(of, (budget) => core.join(budget));
    if (message.type === 'mesh') {
      const faces = core.triangles();
      if (message.weld) weld(faces, core.particle());
      const { volume, components, left_out: leftOut } = about;
      return [{ faces, volume, components, leftOut }, [faces.buffer]];
    }
    const bytes = await done(of, (budget) => core.mesh_file({ format: message.format }, budget));
    if (!bytes) throw new Refusal('InputError', `The mesh cannot be written as ${message.format}: it is too large.`);
    return [{ bytes }, [bytes.buffer]];
  }

  /**
   * Finds the core of a sample before waiting for anything, so that no later message can overtake this one.
   * @param {Asked} message @returns {Promise<[object, ArrayBufferLike[]]>}
   */
  async function answer(message) {
    if (message.type === 'sample') {
      await loaded('core', loadCore);
      const core = Core.without_surface();
      core.limit_memory(MEMORY_MB);
      return kept(message, core);
    }
    const core = cores.get(message.of);
    if (!core) throw new Refusal('DisposedError', 'The particles of this sample are gone.');
    if (message.type !== 'moved') return inTurn(core, () => joined(message, core));
    // The core now belongs to the sample that is made from this one.
    cores.delete(message.of);
    return inTurn(core, () => kept(message, core));
  }

  return async (message) => {
    if (message.type === 'stop') {
      if (asked.has(message.id)) asked.set(message.id, true);
      return;
    }
    if (message.type === 'free') {
      const core = cores.get(message.id);
      cores.delete(message.id);
      if (core) await inTurn(core, () => free(core));
      return;
    }
    const { id } = message;
    asked.set(id, false);
    try {
      const [value, transfer] = await answer(message);
      post({ id, value }, transfer);
    } catch (error) {
      post({ id, error: wordsOf(error) });
    }
    asked.delete(id);
  };
}

/**
 * Replaces the further rows of a particle, which it has on a crease, by its first row.
 * @param {Uint32Array} indices @param {Uint32Array} firstRows  nothing without creases
 */
function weld(indices, firstRows) {
  if (firstRows.length === 0) return;
  for (let k = 0; k < indices.length; k += 1) indices[k] = firstRows[indices[k]];
}

/**
 * The columns of the particles. Their buffers are given away, so that there is no copy.
 * @param {Core} core @param {Pick<Made, 'count' | 'report' | 'bounds' | 'parameters' | 'image' | 'original' | 'change' | 'values'>} about
 * @returns {[Made, ArrayBufferLike[]]}
 */
function columnsOf(core, about) {
  const exact = core.exact_positions(0);
  const columns = {
    points: exact.length > 0 ? exact : core.positions(0),
    normals: core.normals(0),
    radii: core.radii(0),
    levels: core.levels(0),
    parents: core.parents(0),
  };
  const made = { ...columns, ...about, digest: core.digest() };
  return [made, [...Object.values(columns), ...Object.values(about.values)].map(({ buffer }) => buffer)];
}

/** @param {unknown} error @returns {Answered['error']} */
function wordsOf(error) {
  if (error instanceof Refusal) return { name: error.name, message: error.message, facts: error.facts };
  const words = error instanceof Error ? error.message : String(error);
  // After a trap the module's memory cannot be trusted: the client ends this worker.
  return { name: 'WorkerError', message: `The sampler stopped on an error: ${words}`, facts: {} };
}
