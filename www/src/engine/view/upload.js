/**
 * Uploads the columns to the graphics device: new particles, changed colours, and the points of a model.
 *
 * @module
 */

import { MOST_STEPPED } from '../constants.js';
import { coloursOf, rangeOf } from './colouring.js';
import { radiiOf } from './creases.js';
import { dotsOf } from './dots.js';
import { Glide } from './glide.js';
import { PALETTES } from './palettes.js';
import { FADE_S, scaleOf } from './style.js';

/**
 * @import { Columns } from '../types.js'
 * @import { Reveal } from './reveal.js'
 * @import { Device, Look, View } from './types.js'
 */

/** @typedef {Device['renderer']} Renderer */

/** Largest change of a ramp's end that is not visible, as a share of the ramp: half of one of its 64 steps. */
const RANGE_SLACK = 1 / 128;

/** Most particles that one frame uploads, so that a press is answered between frames. An animation moves fewer. */
export const MOST_UPLOADED = 2 ** 18;

/** A range of particles from `first`, inclusive, to `last`, exclusive. */
class Span {
  first = Infinity;
  last = 0;

  get empty() {
    return this.first >= this.last;
  }

  /** @param {number} first @param {number} last */
  include(first, last) {
    this.first = Math.min(this.first, first);
    this.last = Math.max(this.last, last);
  }

  /** Removes a range that covers an end of this one. @param {number} first @param {number} last */
  exclude(first, last) {
    if (first <= this.first) this.first = Math.max(this.first, last);
    if (last >= this.last) this.last = Math.min(this.last, first);
  }
}

export class ParticleUpload {
  /** Particles whose colours are not uploaded yet. */
  #recoloured;

  /** @param {Columns} columns */
  constructor(columns) {
    this.columns = columns;
    this.glide = new Glide();
    /**
     * Whether the next particles replace others on the same surface, and from which time the replacements are drawn.
     */
    this.meets = false;
    this.metS = -Infinity;
    /** Particles that are not uploaded yet. */
    this.dirty = new Span();
    this.#recoloured = new Span();
    /** Values at the ends of the current colour ramp. @type {[number, number] | null} */
    this.range = null;
    /** Number of uploads of particles. */
    this.writes = 0;
    /** Number of particles on the device. */
    this.held = 0;
  }

  /** Whether particles fade in at this time. @param {number} nowS */
  fading(nowS) {
    return nowS < this.metS + FADE_S;
  }

  /** Marks particles as new or moved. @param {number} first @param {number} last */
  changed(first, last) {
    this.dirty.include(first, last);
  }

  /** Marks colours that may have changed. @param {number} first @param {number} last */
  recolour(first, last) {
    this.#recoloured.include(first, last);
  }

  /** Marks everything for upload. */
  all() {
    this.dirty.include(0, this.columns.count);
  }

  /**
   * Starts over for another surface or a new device, without an animation from the earlier positions. Particles that
   * replace others fade in over the body, which is visible at once.
   * @param {boolean} [meets]
   */
  restart(meets = false) {
    this.glide.forget();
    this.meets = meets;
    this.metS = -Infinity;
    this.dirty = new Span();
    this.held = 0;
    this.all();
  }

  /** Whether all changes are on the device. */
  get isWhole() {
    return this.dirty.empty && this.#recoloured.empty;
  }

  /**
   * Uploads the changes, or the first part of them.
   * @param {Renderer} renderer
   * @param {Look} look
   * @param {{reveal: Reveal, calm: boolean, nowS: number}} present
   * @returns number of particles on the device
   */
  write(renderer, look, { reveal, calm, nowS }) {
    const { columns, glide, dirty } = this;
    const { count } = columns;
    if (!dirty.empty || !this.#recoloured.empty) this.#followRange(look);
    const moved = dirty.first < Math.min(glide.count, count);
    if (moved && count <= MOST_STEPPED && !reveal.active && !calm) glide.begin(nowS);
    if (this.meets && !dirty.empty) {
      this.meets = false;
      this.metS = nowS;
    }
    const [first, end] = glide.active ? [0, count] : [dirty.first, Math.min(dirty.last, count)];
    const last = Math.min(end, first + MOST_UPLOADED);
    if (first < last) {
      const positions = glide.active ? glide.between(columns.shown, count, nowS) : columns.shown;
      const colours = this.#colours(look, first, last);
      for (const [from, end, birth] of reveal.runs(columns.levels, first, last, { nowS, birthS: this.metS })) {
        renderer.write(
          from,
          positions.subarray(3 * from, 3 * end),
          columns.normals.subarray(3 * from, 3 * end),
          radiiOf(columns, from, end),
          columns.levels.subarray(from, end),
          colours.subarray(from - first, end - first),
          birth,
        );
        this.writes += 1;
      }
      glide.note(positions, first, last);
      this.#recoloured.exclude(first, last);
    }
    this.held = Math.min(count, Math.max(this.held, last));
    this.dirty = new Span();
    if (last < end) {
      this.dirty.include(last, end);
      return this.held;
    }
    const recoloured = { first: this.#recoloured.first, last: Math.min(this.#recoloured.last, count) };
    if (recoloured.first < recoloured.last) {
      renderer.write_colours(recoloured.first, this.#colours(look, recoloured.first, recoloured.last));
      this.writes += 1;
    }
    this.#recoloured = new Span();
    return this.held;
  }

  /** @param {Look} look @param {number} first @param {number} last */
  #colours({ colour, theme }, first, last) {
    return coloursOf(colour, theme, this.columns, first, last, this.range);
  }

  /**
   * Updates the ends of the ramp from the particles. After a visible change all colours are uploaded again.
   * @param {Look} look
   */
  #followRange({ colour }) {
    const range = rangeOf(colour, this.columns);
    const old = this.range;
    const slack = RANGE_SLACK * (range ? range[1] - range[0] : 0);
    if (range && old && Math.abs(range[0] - old[0]) <= slack && Math.abs(range[1] - old[1]) <= slack) return;
    this.range = range;
    if (range || old) this.recolour(0, this.columns.count);
  }

  /**
   * Writes the model's points after the particles, as discs that face the eye; therefore again for every frame.
   * @param {Renderer} renderer
   * @param {Look} look
   * @param {View} view
   * @param {{count: number, ratio: number}} present  particles that the device holds; canvas pixels per page pixel
   * @returns discs written
   */
  writePoints(renderer, look, view, { count, ratio }) {
    const { points, theme } = look;
    if (!points) return 0;
    const { columns } = this;
    // A dot is moved forward by this distance, so that discs around it do not cut it.
    const lift = columns.count > 0 ? columns.radii[columns.count >> 1] : 0;
    const dots = dotsOf(points, view, { px: ratio, size: scaleOf(look), lift, palette: PALETTES[theme] });
    if (count + dots.radii.length > renderer.max_particles()) return 0;
    renderer.write(count, dots.positions, dots.normals, dots.radii, dots.levels, dots.colours, -Infinity);
    return dots.radii.length;
  }
}
