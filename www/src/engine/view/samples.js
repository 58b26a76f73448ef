/**
 * Averages several samples of a picture in linear light, which smooths edges without a graphics card.
 *
 * @module
 */
import { encoded, linear } from './oklab.js';

/**
 * Offset of each sample from the middle of its pixel, in pixels, to the right and up. Each has its own column and row,
 * so that steep and flat edges are smoothed alike, as in the usual pattern of graphics cards.
 */
export const PLACES = /** @type {const} */ ([
  [-0.125, -0.375],
  [0.375, -0.125],
  [-0.375, 0.125],
  [0.125, 0.375],
]);
/** Largest linear light of a sample, so that the sum of all fits in 16 bits. */
const SCALE = Math.floor(65_535 / PLACES.length);
const TO_LINEAR = Uint16Array.from({ length: 256 }, (_, v) => Math.round(SCALE * linear(v / 255)));
/** Converts linear light in steps of {@link SCALE} to a byte. */
const TO_BYTE = Uint8Array.from({ length: SCALE + 1 }, (_, v) => Math.round(255 * encoded(v / SCALE)));

export class Samples {
  #sums = new Uint16Array(0);
  /** Number of samples in which each pixel is not left out. */
  #counts = new Uint8Array(0);
  #samples = 0;

  /** @param {number} pixels */
  begin(pixels) {
    if (this.#counts.length === pixels) {
      this.#sums.fill(0);
      this.#counts.fill(0);
    } else {
      this.#sums = new Uint16Array(3 * pixels);
      this.#counts = new Uint8Array(pixels);
    }
    this.#samples = 0;
  }

  /** Adds a sample; pixels that are 0 are left out. @param {Uint32Array} pixels */
  add(pixels) {
    const [sums, counts] = [this.#sums, this.#counts];
    for (let i = 0, k = 0; i < pixels.length; i += 1, k += 3) {
      const value = pixels[i];
      if (value === 0) continue;
      counts[i] += 1;
      sums[k] += TO_LINEAR[value & 255];
      sums[k + 1] += TO_LINEAR[(value >> 8) & 255];
      sums[k + 2] += TO_LINEAR[(value >> 16) & 255];
    }
    this.#samples += 1;
  }

  /** Writes the mean of the samples. @param {Uint32Array} out */
  mean(out) {
    const [sums, counts, samples] = [this.#sums, this.#counts, this.#samples];
    const opacity = Uint8Array.from({ length: samples + 1 }, (_, count) => Math.round((255 * count) / samples));
    for (let i = 0, k = 0; i < out.length; i += 1, k += 3) {
      const count = counts[i];
      if (count === 0) {
        out[i] = 0;
        continue;
      }
      const byte = (/** @type {number} */ sum) => TO_BYTE[(sum / count + 0.5) | 0];
      out[i] = (opacity[count] << 24) | (byte(sums[k + 2]) << 16) | (byte(sums[k + 1]) << 8) | byte(sums[k]);
    }
  }

  /** Releases its memory. */
  free() {
    this.#sums = new Uint16Array(0);
    this.#counts = new Uint8Array(0);
  }
}
