/**
 * The picture: which device draws, when it draws, and what it is told. It draws on demand: while nothing moves, fades or
 * arrives, no frame is drawn.
 *
 * @module
 */
import { ballOf, Camera, rayThrough, viewOf } from './camera.js';
import { coloursOf, legendOf, rangeOf } from './colouring.js';
import { DeviceKeeper } from './device.js';
import { dotsOf } from './dots.js';
import { Glide, MOST_GLIDING } from './glide.js';
import { rgbFromPacked } from './oklab.js';
import { PALETTES } from './palettes.js';
import { pick } from './picking.js';
import { Reveal } from './reveal.js';

/**
 * @typedef {import('../columns.js').Columns} Columns
 * @typedef {import('../types.js').Bounds} Bounds
 * @typedef {import('../types.js').Vec3} Vec3
 * @typedef {import('../types.js').ViewState} ViewState
 * @typedef {import('./backends.js').Device} Device
 * @typedef {import('./camera.js').Insets} Insets
 * @typedef {import('./camera.js').View} View
 */

/** More pixels than two per page pixel cannot be told apart, and cost as much again. */
const LARGEST_PIXEL_RATIO = 2;
/** The painter without a graphics card counts its pixels. */
const LARGEST_PAINTED_RATIO = 1;
/** Time a new particle takes to appear. */
const FADE_S = 0.12;
/** Time the picture takes to dim or come back. */
const DIM_S = 0.15;
const DIM = 0.62;
/** How far discs seen from behind fade towards the ground. */
const DIM_BACKFACES = 0.55;
/** A picture that the screen did not take is drawn again this much later, and so many times. */
const RETRY_MS = 60;
const MOST_SKIPS = 20;
/** Change of a ramp's end, as a share of the ramp, that nobody sees: half a step of 64. */
const RANGE_SLACK = 1 / 128;
/** Discs smaller than this are picked by their neighbourhood, in page pixels. */
const PICK_PX = 6;

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const least = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.min(a[2], b[2])];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const most = (a, b) => [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.max(a[2], b[2])];

export class Viewer {
  /**
   * @param {object} options
   * @param {HTMLElement} options.host
   * @param {Columns} options.columns
   * @param {ViewState} options.look
   * @param {(device: Device) => void} options.onDevice
   * @param {(kind: string, message: string) => void} options.onLost
   * @param {(kind: string, message: string) => void} options.onFallback
   * @param {(legend: import('../types.js').Legend) => void} options.onLegend
   * @param {(camera: import('../types.js').CameraState) => void} options.onCamera
   * @param {(reveal: import('../types.js').Reveal | null) => void} options.onReveal
   * @param {import('./backends.js').BackendKind | null} [options.first]
   */
  constructor({ host, columns, look, onDevice, onLost, onFallback, onLegend, onCamera, onReveal, first = null }) {
    this.host = host;
    this.columns = columns;
    this.onDevice = onDevice;
    this.onLegend = onLegend;
    this.onCamera = onCamera;
    this.onReveal = onReveal;
    this.camera = new Camera(look.camera);
    this.reveal = new Reveal();
    this.glide = new Glide();
    this.colour = look.colour;
    this.size = look.size;
    /** @type {'light' | 'dark'} */
    this.theme = 'light';
    /** @type {Bounds | null} */
    this.box = null;
    /** Newest generation level to be seen, null for all of them. @type {number | null} */
    this.level = null;
    this.highlight = -1;
    /** The points of a model, three numbers each, drawn as dots. @type {Float32Array | null} */
    this.points = null;
    /** Values at the ends of the present colouring's ramp. @type {[number, number] | null} */
    this.range = null;
    /** @type {Insets} */
    this.insets = { left: 0, right: 0, top: 0, bottom: 0 };
    this.dimmed = { from: 0, to: 0, at_s: 0 };
    /** The clip box of the field asked for, and that of the particles on the page. @type {Bounds} */
    this.bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
    this.shown_bounds = this.bounds;
    /** Columns not yet told to the device. */
    this.dirty = { first: Infinity, last: 0 };
    this.recoloured = { first: Infinity, last: 0 };
    this.legend_due = true;
    this.style_due = true;
    /** Called when what they wait for is on screen. @type {(() => void)[]} */
    this.waiting = [];
    this.frames = 0;
    /** Times that particles were told to the device. */
    this.uploads = 0;
    this.skipped = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.retry = undefined;
    this.last_s = 0;
    this.asked = 0;
    this.width = 0;
    this.height = 0;
    this.css_width = 0;
    this.css_height = 0;
    this.ratio = 1;
    /** @type {View | null} */
    this.view = null;
    this.calm = matchMedia('(prefers-reduced-motion: reduce)');
    this.camera.calm = this.calm.matches;
    this.calm.onchange = () => {
      this.camera.calm = this.calm.matches;
      if (this.calm.matches && this.reveal.active) {
        this.reveal.end();
        this.onReveal(null);
      }
      this.invalidate();
    };
    this.keeper = new DeviceKeeper({
      host,
      first,
      onOpen: (device) => this.opened(device),
      onLost,
      onFallback,
    });
    this.resizes = new ResizeObserver(() => this.invalidate(true));
    this.resizes.observe(host);
    this.watchRatio();
    // A tab that comes back has lost its last picture on some systems.
    this.onVisible = () => {
      if (!document.hidden) this.invalidate();
      else this.flush();
    };
    document.addEventListener('visibilitychange', this.onVisible);
    this.frame = this.frame.bind(this);
    this.measure();
  }

  start() {
    return this.keeper.start();
  }

  // ---- what is to be drawn ------------------------------------------------------------------------------------------------

  /** A new surface takes the place of the old one. @param {{grow: boolean, fit: boolean, bounds: Bounds | null}} options */
  begin({ grow, fit, bounds }) {
    this.shown_bounds = bounds ?? this.bounds;
    // One of another size would grow around the camera, or far from it.
    if (fit) this.fit(true);
    if (grow && this.level === null && !this.calm.matches && !document.hidden) this.reveal.begin(this.now_s());
    else this.reveal.end();
    this.onReveal(this.reveal.active ? { level: 0, levels: 0, particles: 0 } : null);
    this.glide.forget();
    this.highlight = -1;
    this.style_due = true;
    this.dirty = { first: 0, last: 0 };
    this.invalidate();
  }

  /** @param {number} first @param {number} last @param {() => void} onDrawn */
  changed(first, last, onDrawn) {
    this.dirty.first = Math.min(this.dirty.first, first);
    this.dirty.last = Math.max(this.dirty.last, last);
    this.legend_due = true;
    if (document.hidden || !this.keeper.device) {
      // Nobody looks: the sampler need not wait for pictures.
      onDrawn();
    } else {
      this.waiting.push(onDrawn);
    }
    this.invalidate();
  }

  /** @param {number} first @param {number} last */
  recolour(first, last) {
    this.recoloured.first = Math.min(this.recoloured.first, first);
    this.recoloured.last = Math.max(this.recoloured.last, last);
    this.legend_due = true;
    this.invalidate();
  }

  /** @param {boolean} on */
  dim(on) {
    const now = this.now_s();
    const to = on ? DIM : 0;
    if (to === this.dimmed.to) return;
    this.dimmed = { from: this.dimAt(now), to, at_s: now };
    this.style_due = true;
    this.invalidate();
  }

  /** @param {number} now_s */
  dimAt(now_s) {
    const { from, to, at_s } = this.dimmed;
    const t = this.calm.matches ? 1 : Math.min(1, (now_s - at_s) / DIM_S);
    return from + (to - from) * t;
  }

  /**
   * @param {{colour?: ViewState['colour'], size?: number, theme?: 'light' | 'dark', box?: Bounds | null, points?: Float32Array | null, level?: number | null, highlight?: number, insets?: Insets}} look
   */
  set(look) {
    if (
      (look.colour !== undefined && look.colour !== this.colour) ||
      (look.theme !== undefined && look.theme !== this.theme)
    ) {
      this.recolour(0, this.columns.count);
    }
    this.colour = look.colour ?? this.colour;
    this.theme = look.theme ?? this.theme;
    this.size = look.size ?? this.size;
    if (look.box !== undefined) this.box = look.box;
    if (look.points !== undefined) this.points = look.points;
    if (look.level !== undefined) this.setLevel(look.level);
    if (look.highlight !== undefined) this.highlight = look.highlight;
    this.insets = look.insets ?? this.insets;
    this.style_due = true;
    this.invalidate();
  }

  /** @param {number | null} level */
  setLevel(level) {
    this.level = level;
    // What grows of itself would go on behind the levels that are stepped through.
    if (level !== null && this.reveal.active) {
      this.reveal.end();
      this.dirty = { first: 0, last: this.columns.count };
      this.onReveal(null);
    }
  }

  /** The newest level in the picture: one that does not exist counts as the last. */
  shownLevel() {
    return this.level === null ? null : Math.min(this.level, this.columns.last_level);
  }

  /** What a fit shows: the particles of the present field, else its clip box, all of it where it is drawn. */
  ball() {
    const { columns } = this;
    const bounds = columns.stale ? null : columns.bounds();
    if (!bounds) return this.boxBall();
    const { centre } = ballOf(bounds);
    let far_sq = 0;
    for (let i = 0; i < columns.count; i += 1) {
      const [x, y, z] = [0, 1, 2].map((k) => columns.positions[3 * i + k] - centre[k]);
      const reach = Math.hypot(x, y, z) + columns.radii[i];
      far_sq = Math.max(far_sq, reach * reach);
    }
    return { centre, radius: Math.max(Math.sqrt(far_sq), 1e-6) };
  }

  boxBall() {
    const { centre, radius } = ballOf(this.bounds);
    // A surface seldom reaches the corners: the ball through the middles of the edges is the better guess.
    return { centre, radius: this.box ? radius : radius * 0.72 };
  }

  /** The clip box, for the near and far planes and for a fit before there are particles. @param {Bounds} bounds */
  setBounds(bounds) {
    this.bounds = bounds;
    this.camera.limits(ballOf(bounds).radius);
    this.invalidate();
  }

  /** What the near and far planes enclose: the surface on the page may be that of another box than the one asked for. */
  scene() {
    const [a, b] = [this.bounds, this.shown_bounds];
    return ballOf({ min: least(a.min, b.min), max: most(a.max, b.max) });
  }

  /** @param {boolean} [jump]  at once, to the box of a surface that is still to come: the one on the page stays until then */
  fit(jump = false) {
    this.camera.fit(jump ? this.boxBall() : this.ball(), jump);
    this.moved();
  }

  /** The camera was moved by hand, a link or a glide. */
  moved() {
    this.onCamera(this.camera.state);
    this.invalidate();
  }

  // ---- drawing ------------------------------------------------------------------------------------------------------------

  now_s() {
    return performance.now() / 1000;
  }

  /** Asks for a frame. @param {boolean} [resized] */
  invalidate(resized = false) {
    if (resized) this.measure();
    if (this.asked === 0 && !document.hidden) this.asked = requestAnimationFrame(this.frame);
  }

  measure() {
    const { clientWidth, clientHeight } = this.host;
    const limit = this.keeper?.device?.kind === 'canvas2d' ? LARGEST_PAINTED_RATIO : LARGEST_PIXEL_RATIO;
    const ratio = Math.min(limit, devicePixelRatio || 1);
    this.css_width = clientWidth;
    this.css_height = clientHeight;
    this.width = Math.round(clientWidth * ratio);
    this.height = Math.round(clientHeight * ratio);
    this.ratio = ratio;
    this.style_due = true;
    this.size_due = true;
  }

  /** A window that moves to another monitor keeps its size and changes its pixels. */
  watchRatio() {
    this.monitor = matchMedia(`(resolution: ${devicePixelRatio}dppx)`);
    this.monitor.onchange = () => {
      this.watchRatio();
      this.invalidate(true);
    };
  }

  /** @param {Device} device */
  opened(device) {
    this.measure();
    this.glide.forget();
    this.dirty = { first: 0, last: this.columns.count };
    this.style_due = true;
    this.invalidate();
    this.onDevice(device);
  }

  flush() {
    const { waiting } = this;
    this.waiting = [];
    for (const drawn of waiting) drawn();
  }

  frame() {
    this.asked = 0;
    const device = this.keeper.device;
    if (!device) {
      this.flush();
      return;
    }
    const now = this.now_s();
    // After a pause the first step is one frame long: nothing jumps.
    const dt = Math.min(now - this.last_s, 1 / 20);
    this.last_s = now;
    const before = this.camera.state;
    const moving = this.camera.step(dt);
    if (this.camera.state !== before) this.onCamera(this.camera.state);
    try {
      this.tell(device, now);
      const outcome = device.renderer.draw(now);
      if (outcome === 'drawn') {
        this.frames += 1;
        this.skipped = 0;
      } else if (outcome === 'skipped' && this.width > 0 && this.height > 0 && this.skipped < MOST_SKIPS) {
        // The screen was not ready to take a picture; what was to be seen has not been seen.
        this.skipped += 1;
        this.retry = setTimeout(() => this.invalidate(), RETRY_MS);
      }
    } catch (error) {
      // The renderer trapped: its instance is not to be called again.
      this.flush();
      this.keeper.giveUp(error instanceof Error ? error.message : String(error));
      return;
    }
    this.flush();
    if (this.legend_due && !this.reveal.active) this.tellLegend();
    const revealing = this.tellReveal(now);
    const dimming = now - this.dimmed.at_s < DIM_S;
    if (dimming) this.style_due = true;
    if (moving || revealing || dimming || this.glide.active) this.invalidate();
  }

  /** Everything that changed since the last frame. @param {Device} device @param {number} now_s */
  tell({ renderer }, now_s) {
    const { columns } = this;
    if (this.size_due) {
      renderer.resize(this.width, this.height);
      this.size_due = false;
    }
    const most = renderer.max_particles();
    const count = Math.min(columns.count, most);
    const { dirty, recoloured, glide } = this;
    if (dirty.first < dirty.last || recoloured.first < recoloured.last) this.follow();
    if (
      dirty.first < Math.min(glide.count, count) &&
      count <= MOST_GLIDING &&
      !this.reveal.active &&
      !this.calm.matches
    )
      glide.begin(now_s);
    const [first, last] = glide.active ? [0, count] : [dirty.first, Math.min(dirty.last, count)];
    if (first < last) {
      const positions = glide.active ? glide.between(columns.positions, count, now_s) : columns.positions;
      const colours = coloursOf(this.colour, this.theme, columns, first, last, this.range);
      for (const [from, end, birth] of this.pieces(first, last, now_s)) {
        renderer.write(
          from,
          positions.subarray(3 * from, 3 * end),
          columns.normals.subarray(3 * from, 3 * end),
          columns.radii.subarray(from, end),
          columns.levels.subarray(from, end),
          colours.subarray(from - first, end - first),
          birth,
        );
        this.uploads += 1;
      }
      // The newest level that there is may be another.
      if (this.level !== null) this.style_due = true;
      glide.note(positions, first, last);
    }
    const recolour_last = Math.min(recoloured.last, count);
    if (recoloured.first < recolour_last) {
      renderer.write_colours(
        recoloured.first,
        coloursOf(this.colour, this.theme, columns, recoloured.first, recolour_last, this.range),
      );
      this.uploads += 1;
    }
    this.dirty = { first: Infinity, last: 0 };
    this.recoloured = { first: Infinity, last: 0 };
    this.view = viewOf(this.camera.state, this.css_width, this.css_height, this.scene(), this.insets);
    renderer.set_view(this.view.packed);
    renderer.set_count(count + this.tellPoints(renderer, this.view, count));
    if (this.style_due) {
      renderer.set_style(JSON.stringify(this.style(now_s)));
      this.style_due = false;
    }
  }

  /** The ramp's ends follow the particles; when they move by more than can be seen, every colour is another. */
  follow() {
    const range = rangeOf(this.colour, this.columns);
    const old = this.range;
    const slack = RANGE_SLACK * (range ? range[1] - range[0] : 0);
    if (range && old && Math.abs(range[0] - old[0]) <= slack && Math.abs(range[1] - old[1]) <= slack) return;
    this.range = range;
    if (range || old) this.recoloured = { first: 0, last: this.columns.count };
  }

  /**
   * Writes the model's points behind the particles, as discs that face the eye, and so anew for every picture.
   * @param {Device['renderer']} renderer @param {View} view @param {number} count  of particles
   * @returns {number} discs written
   */
  tellPoints(renderer, view, count) {
    if (!this.points) return 0;
    const dots = dotsOf(this.points, view, {
      px: this.ratio,
      size: this.size,
      lift: this.lift(),
      palette: PALETTES[this.theme],
    });
    if (count + dots.radii.length > renderer.max_particles()) return 0;
    renderer.write(count, dots.positions, dots.normals, dots.radii, dots.levels, dots.colours, -Infinity);
    return dots.radii.length;
  }

  /** By how much a dot has to come forward so that the discs around it do not cut it. */
  lift() {
    const { columns } = this;
    return columns.count > 0 ? columns.radii[columns.count >> 1] : 0;
  }

  /**
   * Runs of particles that appear at the same time: one while nothing is being revealed, else one for each level.
   * @param {number} first @param {number} last @param {number} now_s
   * @returns {[number, number, number][]}
   */
  pieces(first, last, now_s) {
    if (!this.reveal.active) return [[first, last, -Infinity]];
    /** @type {[number, number, number][]} */
    const out = [];
    const { levels } = this.columns;
    for (let i = first; i < last; ) {
      const level = levels[i];
      let end = i + 1;
      while (end < last && levels[end] === level) end += 1;
      out.push([i, end, this.reveal.birthOf(level, now_s)]);
      i = end;
    }
    return out;
  }

  /** @param {number} now_s @returns {boolean} whether more is to appear */
  tellReveal(now_s) {
    const { reveal, columns } = this;
    if (!reveal.active) return false;
    const level = reveal.levelAt(now_s);
    const levels = reveal.births.length;
    if (now_s > reveal.end_s() + FADE_S && !this.growing) {
      reveal.end();
      this.onReveal(null);
      if (this.legend_due) this.tellLegend();
      return false;
    }
    let particles = 0;
    while (particles < columns.count && columns.levels[particles] <= level) particles += 1;
    this.onReveal({ level: Math.max(0, level), levels, particles });
    return true;
  }

  /** Whether the front is still placing particles: a reveal does not end before it. */
  growing = false;

  tellLegend() {
    this.legend_due = false;
    this.onLegend(legendOf(this.colour, this.theme, this.columns, this.range));
  }

  /** @param {number} now_s */
  style(now_s) {
    return {
      background: [...rgbFromPacked(PALETTES[this.theme].ground), 1],
      disc_scale: this.size,
      dim: this.dimAt(now_s),
      fade_s: this.calm.matches ? 0 : FADE_S,
      level: this.shownLevel(),
      // Level by level one often looks into a surface that is still open.
      dim_backfaces: this.level === null ? DIM_BACKFACES : DIM_BACKFACES / 2,
      outline: this.highlight,
      box: this.box && { ...this.box, colour: [...rgbFromPacked(PALETTES[this.theme].box), 0.9] },
      pixel_ratio: this.ratio,
    };
  }

  // ---- looking at it ------------------------------------------------------------------------------------------------------

  /** @returns {View} */
  currentView() {
    return viewOf(this.camera.state, this.css_width, this.css_height, this.scene(), this.insets);
  }

  /** Index of the particle under a point of the host, in CSS pixels. @param {number} x @param {number} y */
  pick(x, y) {
    const { columns, css_width, css_height } = this;
    if (columns.count === 0 || columns.stale || css_width === 0 || css_height === 0) return null;
    const view = this.currentView();
    return pick(
      columns,
      view.eye,
      rayThrough(view, x, y, css_width, css_height),
      this.size,
      PICK_PX * view.world_per_px,
      this.shownLevel() ?? Infinity,
    );
  }

  /**
   * The picture without panels, drawn into a texture and read back.
   * @param {number} width_px @param {number} height_px @param {boolean} transparent
   * @returns {Promise<{width: number, height: number, pixels: Uint8Array<ArrayBuffer>}>}
   */
  async pixels(width_px, height_px, transparent) {
    const device = this.keeper.device;
    if (!device) throw new Error('There is no picture yet.');
    const { renderer } = device;
    const now = this.now_s();
    if (this.glide.active) {
      // A picture on file shows the particles where they are, not on their way.
      this.glide.forget();
      this.dirty = { first: 0, last: this.columns.count };
    }
    this.tell(device, now);
    const [width, height] = renderer.picture_size(width_px, height_px);
    const view = viewOf(this.camera.state, this.css_width || width, this.css_height || height, this.scene());
    renderer.set_view(view.packed);
    const count = Math.min(this.columns.count, renderer.max_particles());
    renderer.set_count(count + this.tellPoints(renderer, view, count));
    renderer.set_style(JSON.stringify({ ...this.style(now), dim: 0, outline: -1 }));
    this.style_due = true;
    const picture = renderer.read_pixels(width, height, transparent);
    this.invalidate();
    return { width, height, pixels: await picture };
  }

  destroy() {
    cancelAnimationFrame(this.asked);
    clearTimeout(this.retry);
    this.resizes.disconnect();
    this.calm.onchange = null;
    if (this.monitor) this.monitor.onchange = null;
    document.removeEventListener('visibilitychange', this.onVisible);
    this.keeper.close();
    this.flush();
  }
}
