/** Records the picture: as a film while it moves, or as a sequence of single pictures of full quality. */
import { effect } from '@preact/signals-core';
import { CROSSING_S, placeAt, TURN_S, valueAt } from '../motion.js';
import { compose } from './compose.js';
import { withDuration } from './webm.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Context, Subject, Wish } from './types.js'
 */

/** Pictures per second of a sequence; the least time between two of a film. */
const FRAMES_PER_S = 30;
/** Bits of a film per pixel and second. Fine dots need more than a filmed scene. */
const BITS_PER_PX_S = 5;
/** Kinds of film, the best first. Safari makes only the last. */
const KINDS = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'];

/** Returns the kind of film that this browser makes, or null. */
export const kindOfFilm = () =>
  typeof MediaRecorder === 'undefined' ? null : (KINDS.find((kind) => MediaRecorder.isTypeSupported(kind)) ?? null);

/** Seconds of a recording; it has no end of its own where the user moves. @param {Subject} subject */
export function durationOf(subject) {
  if (subject.kind === 'turn') return TURN_S;
  if (subject.kind === 'parameter') return subject.course === 'bounce' ? 2 * CROSSING_S : CROSSING_S;
  return Infinity;
}

/**
 * Returns a function that brings the surface into its pose at a share of the recording, 0 to 1, and one that takes it
 * back.
 * @param {Engine} engine @param {Subject} subject
 * @returns {{ at: (share: number) => Promise<void>, back: () => void }}
 */
function poserOf(engine, subject) {
  if (subject.kind === 'free') return { at: async () => {}, back: () => {} };
  const { view, parameters } = engine.state.peek();
  if (subject.kind === 'turn') {
    const { camera } = view;
    const turn = (/** @type {number} */ share) => {
      const yaw = camera.yaw + 2 * Math.PI * share;
      engine.setView({ camera: { ...camera, yaw: yaw - 2 * Math.PI * Math.round(yaw / (2 * Math.PI)) } });
    };
    return { at: async (share) => turn(share), back: () => engine.setView({ camera }) };
  }
  const { range, course } = subject;
  const crossings = course === 'bounce' ? 2 : 1;
  return {
    at: (share) => {
      engine.setParameter(range.name, valueAt(range, placeAt(crossings * share, course)));
      return sampled(engine);
    },
    back: () => {
      if (range.name in parameters) engine.setParameter(range.name, parameters[range.name]);
      else engine.resetParameter(range.name);
    },
  };
}

/** Resolves once no run is active. @param {Engine} engine @returns {Promise<void>} */
const sampled = (engine) =>
  new Promise((resolve) => {
    const stop = effect(() => {
      if (engine.busy.value || engine.reveal.value) return;
      queueMicrotask(() => stop());
      resolve();
    });
  });

/** @returns {Promise<void>} */
const nextFrame = () => new Promise((resolve) => requestAnimationFrame(() => resolve()));

/**
 * Draws the present moment on a canvas.
 * @param {Wish} wish @param {Context} context @param {boolean} [transparent]
 */
export async function drawOn({ engine, size, parts }, context, transparent = false) {
  context.putImageData(await engine.picture({ ...size, transparent }), 0, 0);
  compose(context, parts());
}

/**
 * Records a film in the time in which it plays: what takes longer to draw is drawn less often.
 * @param {Wish} wish
 * @throws if the browser makes no films
 */
export async function recordFilm(wish) {
  const { engine, size, subject, signal, tell } = wish;
  const kind = kindOfFilm();
  if (!kind) throw new Error('This browser makes no films.');
  const canvas = document.createElement('canvas');
  Object.assign(canvas, size);
  const context = canvas.getContext('2d', { alpha: false });
  if (!context) throw new Error('The browser gives no canvas.');
  const seconds = durationOf(subject);
  const { at, back } = poserOf(engine, subject);
  try {
    await at(0);
    await drawOn(wish, context);
    const bits = BITS_PER_PX_S * size.width * size.height;
    const recorder = new MediaRecorder(canvas.captureStream(FRAMES_PER_S), {
      mimeType: kind,
      videoBitsPerSecond: bits,
    });
    /** @type {Blob[]} */
    const chunks = [];
    recorder.ondataavailable = ({ data }) => void chunks.push(data);
    const ended = new Promise((resolve) => {
      recorder.onstop = resolve;
    });
    recorder.start(1000);
    const begunMs = performance.now();
    for (let passed = 0; passed < seconds && !signal.aborted; passed = (performance.now() - begunMs) / 1000) {
      tell(Number.isFinite(seconds) ? passed / seconds : null, passed);
      await at(Math.min(1, passed / seconds));
      await drawOn(wish, context);
      await nextFrame();
    }
    const shown = (performance.now() - begunMs) / 1000;
    recorder.stop();
    await ended;
    for (const track of recorder.stream.getTracks()) track.stop();
    const film = withDuration(new Uint8Array(await new Blob(chunks).arrayBuffer()), shown);
    return new Blob([film], { type: kind.replace(/;.*/, '') });
  } finally {
    back();
  }
}

/**
 * Makes single pictures, each of a finished run, and packs them into a ZIP file without compressing them again.
 * @param {Wish & { transparent: boolean, seconds: number }} wish
 * @returns null if it was given up
 */
export async function recordSequence(wish) {
  const { engine, size, subject, signal, tell, transparent, seconds } = wish;
  const { Zip, ZipPassThrough } = await import('fflate');
  const canvas = new OffscreenCanvas(size.width, size.height);
  const context = canvas.getContext('2d');
  if (!context) throw new Error('The browser gives no canvas.');
  /** @type {Uint8Array<ArrayBuffer>[]} */
  const parts = [];
  const zip = new Zip((error, chunk) => {
    if (error) throw error;
    parts.push(/** @type {Uint8Array<ArrayBuffer>} */ (chunk));
  });
  const count = Math.max(2, Math.round(seconds * FRAMES_PER_S));
  const { at, back } = poserOf(engine, subject);
  try {
    for (let i = 0; i < count; i += 1) {
      if (signal.aborted) return null;
      tell(i / count, i / FRAMES_PER_S);
      await at(i / count);
      await drawOn(wish, context, transparent);
      const png = await canvas.convertToBlob({ type: 'image/png' });
      const file = new ZipPassThrough(`frame-${String(i + 1).padStart(4, '0')}.png`);
      zip.add(file);
      file.push(new Uint8Array(await png.arrayBuffer()), true);
      // A page that is drawn from time to time shows how far it is, and can be stopped.
      await nextFrame();
    }
    zip.end();
    return new Blob(parts, { type: 'application/zip' });
  } finally {
    back();
  }
}
