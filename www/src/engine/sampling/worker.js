/**
 * The sampler's worker. It receives the core from the page and runs one job at a time, always the latest. After a trap
 * it reports the crash, never calls the core again and waits to be replaced.
 *
 * @module
 */
import init, { Core } from '../../wasm/core/core.js';
import { crashWords } from '../bundle/crash.js';
import { FileKeeper } from '../files/keeper.js';
import { curvatureColumn, meshColumn, runJob } from './job.js';
import { Jobs, measured } from './jobs.js';
import { compared, join, valued, write } from './joining.js';
import { BEAT_MS, PROGRESS_MS } from './protocol.js';

/**
 * @import { Env, FromWorker, LoadFault, ToWorker } from './types.js'
 */

/** Largest memory of a run and its report. Browsers close pages that use much more, phones much earlier. */
const MEMORY_MB = { desk: 512, phone: 256 };
/** Largest memory of a file while it is read and becomes a field. */
const FILE_MB = { desk: 1600, phone: 400 };

/** @param {Navigator & {userAgentData?: {mobile: boolean}, deviceMemory?: number}} device */
const onPhone = ({ userAgentData, deviceMemory = 8, userAgent }) =>
  (userAgentData?.mobile ?? /Mobi/.test(userAgent)) || deviceMemory < 4;

/** @param {FromWorker} message @param {Transferable[]} [transfer] */
const post = (message, transfer = []) => self.postMessage(message, { transfer });

const device = onPhone(navigator) ? 'phone' : 'desk';
const nowMs = () => performance.now();
/** Number of column messages that the page has not yet drawn. */
let undrawn = 0;
/** Whether the page shows the curvature, and whether it draws a mesh. */
let curvature = false;
let mesh = false;
/** The formula of the value that the page shows; then the run and the formula of the last value sent. */
let value = '';
let sentValue = '';
/** Requested files. @type {Extract<ToWorker, {type: 'export'}>[]} */
const files = [];
/** Particles placed elsewhere that are to be measured. @type {Extract<ToWorker, {type: 'measure'}>[]} */
const placed = [];
let pumping = false;
let dead = false;
const crashOf = crashWords();

// A message to itself ends the worker's task, so that waiting messages are handled. Browsers delay timers by 4 ms.
const selfChannel = new MessageChannel();
/** What waits for the end of the task: a run, and a field that is made meanwhile. @type {(() => void)[]} */
const waiting = [];
selfChannel.port1.onmessage = () => waiting.shift()?.();
/** @returns {Promise<void>} */
const pause = () =>
  new Promise((resolve) => {
    waiting.push(resolve);
    selfChannel.port2.postMessage(null);
  });

const opener = new FileKeeper(FILE_MB[device] * 1e6, { nowMs, pause }, () => post({ type: 'opening' }));
/** Continues once a job's field is made. @param {unknown} [error] */
const prepared = (error) => {
  if (error) crashed(0, error);
  else void pump();
};
let toldMs = 0;
/** Tells how far a job's field is. @param {number} id @param {number} fraction */
function tellMaking(id, fraction) {
  if (nowMs() - toldMs < PROGRESS_MS) return;
  toldMs = nowMs();
  post({ type: 'making', id, fraction });
}
const jobs = new Jobs(post, nowMs, {
  isReady: (ours, id, file, field) =>
    opener.isReady(ours, file, field, { tell: (share) => tellMaking(id, share), whenReady: prepared }),
  setField: (ours, file, field) => opener.setField(ours, file, field),
  stop: () => opener.stop(),
});

/** @type {Core | null} */
let core = null;
const memory = { held: 0, meshed: 0, gaveUp: false };
/** Whether the field is an opened mesh, and the last run that was compared with it. */
const remesh = { isIt: false, compared: 0 };

/** @param {Core} ours @returns {Env} */
const surroundings = (ours) => ({
  nowMs,
  pause,
  post: (message, transfer) => {
    if (message.type === 'columns') undrawn += 1;
    if (message.type === 'done') jobs.sampled();
    post(message, transfer);
  },
  interrupt: () => jobs.interrupt(ours),
  curvature: () => curvature,
  mesh: () => mesh,
  room: () => undrawn < 2,
});

/** Does all pending work, jobs first. */
async function pump() {
  if (pumping) return;
  pumping = true;
  while (core && !dead) {
    const ours = core;
    try {
      const next = jobs.take(ours);
      if (next) {
        undrawn = 0;
        const { job, given } = next;
        if (job.kind !== 'relax') remesh.isIt = given !== null && 'file' in given && given.file.as === 'mesh';
        await runJob(ours, next, surroundings(ours), memory);
      } else if (!(await serve(ours))) {
        break;
      }
    } catch (error) {
      crashed(jobs.running?.id ?? 0, error);
    }
    jobs.running = null;
  }
  pumping = false;
}

/**
 * Does one piece of other work: measures particles placed elsewhere, makes a value, a mesh or a file that the page
 * requested since the last job, or compares the mesh with the opened one.
 * @param {Core} ours
 * @returns whether there was anything to do
 */
async function serve(ours) {
  const question = placed.shift();
  if (question) {
    post(measured(ours, question));
    return true;
  }
  const { held } = memory;
  const wantedValue = value && held > 0 ? `${held} ${value}` : '';
  if (wantedValue && wantedValue !== sentValue) {
    const found = await valued(ours, value, surroundings(ours));
    if (!found) return true;
    sentValue = wantedValue;
    post({ type: 'value', id: held, ...found }, [found.values.buffer]);
    // It names the columns of a file, of which the value is one now.
    const record = ours.record();
    if (record) post({ type: 'record', id: held, record });
    return true;
  }
  const isDrawn = mesh && held > 0 && memory.meshed !== held;
  const isCompared = remesh.isIt && held > 0 && remesh.compared !== held;
  if (!isDrawn && !isCompared && files.length === 0) return false;
  const made = held > 0 ? await join(ours, surroundings(ours)) : null;
  // A new job has priority.
  if (held > 0 && !made) return true;
  if (made && isDrawn) {
    memory.meshed = held;
    post(...meshColumn(ours, held, made));
  }
  if (made && isCompared) {
    const found = await compared(ours, surroundings(ours));
    if (!found) return true;
    remesh.compared = held;
    if (found.change) post({ type: 'change', id: held, change: found.change });
  }
  const [wanted] = files;
  if (wanted) {
    const file = made ? await write(ours, wanted.file, surroundings(ours)) : { bytes: null };
    if (!file) return true;
    files.shift();
    post({ type: 'file', request: wanted.request, bytes: file.bytes }, file.bytes ? [file.bytes.buffer] : []);
  }
  return true;
}

/** @param {number} id @param {unknown} error */
function crashed(id, error) {
  dead = true;
  post({ type: 'crashed', id, ...crashOf(error) });
}

self.onmessage = (/** @type {MessageEvent<ToWorker>} */ { data }) => {
  if (dead) return;
  switch (data.type) {
    case 'core':
      void boot(data.module);
      break;
    case 'no_core':
      failed(data.fault, data.message);
      break;
    case 'job':
      jobs.add(data);
      void pump();
      break;
    case 'curvature':
      curvature = data.on;
      if (curvature && core && !jobs.running && memory.held > 0) {
        try {
          post(...curvatureColumn(core, memory.held));
        } catch (error) {
          crashed(memory.held, error);
        }
      }
      break;
    case 'mesh':
      mesh = data.on;
      if (mesh && memory.gaveUp) [memory.meshed, memory.gaveUp] = [0, false];
      void pump();
      break;
    case 'export':
      files.push(data);
      void pump();
      break;
    case 'number':
      post({ type: 'number', request: data.request, value: core?.number(data.text) ?? null });
      break;
    case 'code':
      if (core) post({ type: 'code', request: data.request, answer: core.code(data.language) });
      break;
    case 'value':
      value = data.text;
      void pump();
      break;
    case 'fault':
      post({ type: 'fault', request: data.request, fault: core?.text_fault(data.what, data.text) ?? null });
      break;
    case 'section': {
      const [width, height] = data.size;
      const values = core?.section(new Float64Array(data.place), width, height);
      post({ type: 'section', request: data.request, values: values?.length ? values : null });
      break;
    }
    case 'faces': {
      const [vertices, faces] = [core?.mesh_vertices(), core?.mesh_faces()];
      const mesh = vertices?.length && faces ? { vertices, faces } : null;
      post({ type: 'faces', request: data.request, mesh }, mesh ? [mesh.vertices.buffer, mesh.faces.buffer] : []);
      break;
    }
    case 'open':
      void open(data);
      break;
    case 'open_stop':
      opener.stop();
      break;
    case 'measure':
      placed.push(data);
      void pump();
      break;
    case 'stop':
      jobs.stop();
      break;
    case 'drawn':
      if (data.id === jobs.running?.id) undrawn = Math.max(0, undrawn - 1);
      break;
    default:
  }
};

/** Opens a file for the page. @param {Extract<ToWorker, {type: 'open'}>} question */
async function open({ request, file }) {
  if (!core)
    return post({
      type: 'opened',
      request,
      opened: { ok: false, kind: file.as, message: 'the sampler is not there yet' },
    });
  try {
    const tell = (/** @type {string} */ label, /** @type {number} */ fraction) =>
      post({ type: 'open_progress', request, label, fraction });
    post({ type: 'opened', request, opened: await opener.open(core, file, tell) });
  } catch (error) {
    crashed(0, error);
  }
}

// Shows the page that the worker is alive while the core loads.
const beat = setInterval(() => post({ type: 'beat' }), BEAT_MS);

/** @param {LoadFault} fault @param {string} message */
function failed(fault, message) {
  clearInterval(beat);
  dead = true;
  post({ type: 'failed', fault, message });
}

/** @param {WebAssembly.Module} module */
async function boot(module) {
  try {
    await init({ module_or_path: module });
    core = new Core();
    core.limit_memory(MEMORY_MB[device]);
    post({ type: 'ready', description: core.describe() });
  } catch (error) {
    failed('init', `The sampler did not start: ${crashOf(error).message}`);
  }
  clearInterval(beat);
  await pump();
}
