/**
 * Makes films and picture sequences: each frame is sampled and drawn completely, however long that takes, and shown for
 * a thirtieth of a second. Only a film of what the user does is recorded in real time.
 */
import { effect } from '@preact/signals-core';
import { placeAt, valueAt } from '../motion.js';
import { sliceOver } from '../view/marks/slice.js';
import { compose } from './compose.js';

/**
 * @import { VideoCodec } from 'mediabunny'
 * @import { Engine } from '../../engine/types.js'
 * @import { Context, Subject, Wish } from './types.js'
 */

/** Pictures per second. */
const FRAMES_PER_S = 30;
/** Bits of a film per pixel and second. Fine dots need more than a filmed scene. */
const BITS_PER_PX_S = 5;
/**
 * Codecs of an MP4 film, which all programs play, and of a WebM film, for browsers that cannot encode the former.
 * @type {{ mp4: VideoCodec[], webm: VideoCodec[] }}
 */
const CODECS = { mp4: ['avc'], webm: ['vp9', 'av1', 'vp8'] };

/** Whether this browser encodes films. The formats are only known when one is made. */
export const canFilm = () => typeof VideoEncoder !== 'undefined';

/**
 * Returns a function that puts the surface into its pose at a share of the recording, 0 to 1, and one that restores it.
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
      if (engine.status.value === 'sampling' || engine.reveal.value) return;
      queueMicrotask(() => stop());
      resolve();
    });
  });

/** @returns {Promise<void>} */
const nextFrame = () => new Promise((resolve) => requestAnimationFrame(() => resolve()));

/**
 * Draws the present picture on a canvas.
 * @param {Wish} wish @param {Context} context @param {boolean} [transparent]
 */
export async function drawOn({ engine, size, parts }, context, transparent = false) {
  context.putImageData(await engine.picture({ ...size, transparent, over: sliceOver(engine) }), 0, 0);
  compose(context, parts());
}

/**
 * Makes a film of so many seconds, or of what the user does until it is stopped. If stopped early, it keeps what is
 * recorded.
 * @param {Wish} wish
 * @throws if the browser encodes no film of that size
 */
export async function makeFilm(wish) {
  const { size, subject, seconds, signal, tell } = wish;
  const { canvas, context } = sheetOf(size, { alpha: false });
  const { output, source, type } = await encoderOf(canvas);
  const isFree = subject.kind === 'free';
  const count = isFree ? Infinity : seconds * FRAMES_PER_S;
  const { at, back } = poserOf(wish.engine, subject);
  try {
    await output.start();
    const begunMs = performance.now();
    const passed = () => (performance.now() - begunMs) / 1000;
    for (let i = 0; i < count && !(signal.aborted && i > 0); i += 1) {
      const timeS = isFree ? passed() : i / FRAMES_PER_S;
      tell(isFree ? null : i / count, timeS);
      await at(i / count);
      await drawOn(wish, context);
      await source.add(timeS, 1 / FRAMES_PER_S);
      // Yielding to the page lets it show the progress and react to Stop.
      await nextFrame();
      while (isFree && !signal.aborted && passed() < timeS + 1 / FRAMES_PER_S) await nextFrame();
    }
    await output.finalize();
    return new Blob([/** @type {ArrayBuffer} */ (output.target.buffer)], { type });
  } finally {
    if (output.state !== 'finalized') await output.cancel();
    back();
  }
}

/**
 * Returns a file of a format that this browser encodes, and the source that adds pictures of a canvas to it.
 * @param {OffscreenCanvas} canvas
 */
async function encoderOf(canvas) {
  const { BufferTarget, CanvasSource, getFirstEncodableVideoCodec, Mp4OutputFormat, Output, WebMOutputFormat } =
    await import('mediabunny');
  const { width, height } = canvas;
  const bitrate = BITS_PER_PX_S * width * height;
  for (const format of [new Mp4OutputFormat({ fastStart: 'in-memory' }), new WebMOutputFormat()]) {
    const codecs = format instanceof Mp4OutputFormat ? CODECS.mp4 : CODECS.webm;
    const codec = await getFirstEncodableVideoCodec(codecs, { width, height, bitrate });
    if (!codec) continue;
    const output = new Output({ format, target: new BufferTarget() });
    const source = new CanvasSource(canvas, { codec, bitrate });
    output.addVideoTrack(source, { frameRate: FRAMES_PER_S });
    return { output, source, type: format.mimeType };
  }
  throw new Error('This browser encodes no films.');
}

/** A canvas for the pictures. @param {Wish['size']} size @param {CanvasRenderingContext2DSettings} [settings] */
function sheetOf({ width, height }, settings) {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext('2d', settings);
  if (!context) throw new Error('The browser gives no canvas.');
  return { canvas, context };
}

/**
 * Makes single pictures, each of a finished run, and packs them uncompressed into a ZIP file.
 * @param {Wish & { transparent: boolean }} wish
 * @returns null if it was cancelled
 */
export async function makeSequence(wish) {
  const { engine, size, subject, signal, tell, transparent, seconds } = wish;
  const { Zip, ZipPassThrough } = await import('fflate');
  const { canvas, context } = sheetOf(size);
  /** @type {Uint8Array<ArrayBuffer>[]} */
  const parts = [];
  const zip = new Zip((error, chunk) => {
    if (error) throw error;
    parts.push(/** @type {Uint8Array<ArrayBuffer>} */ (chunk));
  });
  const count = seconds * FRAMES_PER_S;
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
      // Yielding to the page lets it show the progress and react to Stop.
      await nextFrame();
    }
    zip.end();
    return new Blob(parts, { type: 'application/zip' });
  } finally {
    back();
  }
}
