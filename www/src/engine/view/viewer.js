/**
 * The picture: combines the camera, the frame schedule, the appearance and the uploads to the device.
 *
 * @module
 */
import { clamp, vec } from '../vector.js';
import {
  ballOf,
  Camera,
  fitDistance,
  freePart,
  outlineDistance,
  projected,
  rayThrough,
  STANDARD_VIEWS,
  viewOf,
} from './camera.js';
import { legendOf, legendOfDots } from './colouring.js';
import { CreaseUpload } from './creases.js';
import { DeviceKeeper } from './device.js';
import { Dimmer } from './dimmer.js';
import { Effort, WHOLE } from './effort.js';
import { FaceUpload } from './faces.js';
import { facing, widestYaw } from './facing.js';
import { FrameLoop, nowS } from './frames.js';
import { pick } from './picking.js';
import { Reveal } from './reveal.js';
import { Scene } from './scene.js';
import { Screen } from './screen.js';
import { FADE_S, firstLook, scaleOf, shownLevel, shownStep, styleOf } from './style.js';
import { ParticleUpload } from './upload.js';

/**
 * @import { Angles, Bounds, CameraState, Place, Ray, Vec3 } from '../types.js'
 * @import { Device, FrameResult, Look, View, ViewerEvents, ViewerOptions } from './types.js'
 */

/** Picking tolerance around small discs, in page pixels. */
const PICK_PX = 6;

/** Time without motion after which the complete picture is drawn. */
const REST_MS = 150;

/** Interval of the frames drawn while a picture is read back. */
const LOOK_MS = 1000;

/** Radius around a highlighted point that the picture shows, in radii of its rings. */
const LOOK_RADII = 14;

export class Viewer {
  #events;
  #scene;
  #faces;
  #creases;

  /** Whether the system asks for reduced motion. */
  #calm;

  /** How far the picture is behind the clock, since reveals wait for frames; and the time of the last frame. */
  #lagS;
  #lastS;
  #sight;

  /** Whether the last frame was partial. Until the picture is complete, the data on the device does not change. */
  #isPart = false;

  /** The camera and the quality of the last picture, and the judge of the drawing time. */
  /** @type {CameraState | null} */
  #drawnCamera = null;
  #quality = WHOLE;
  #effort = new Effort();
  #isMoving = false;
  #sinceMs = 0;
  /** Whether the last frame moved and requested the next one. */
  #isMotion = false;

  /** Timer for the complete picture after a motion. @type {ReturnType<typeof setTimeout> | undefined} */
  #rest;

  /** Distance at which the last fit would have shown the whole ball. */
  #wholeDistance = 0;

  /**
   * @param {ViewerOptions} options
   * @param {ViewerEvents} events
   */
  constructor({ host, columns, look, first }, events) {
    this.columns = columns;
    this.#events = events;
    this.camera = new Camera(look.camera);
    /** @type {Look} */
    this.look = firstLook(look);
    this.#scene = new Scene();
    this.reveal = new Reveal();
    this.#lagS = 0;
    this.#lastS = 0;
    /** Whether the next growing surface is the first one of a visit. */
    this.opening = false;
    /** The camera of the last opened link, until the user fits the surface. @type {CameraState | null} */
    this.linked = null;
    /** Whether the front is still placing particles. A reveal does not end before the front. */
    this.growing = false;
    this.dimmer = new Dimmer();
    this.upload = new ParticleUpload(columns);
    this.#faces = new FaceUpload(columns);
    this.#creases = new CreaseUpload(columns);
    /** Which parts have changed since the last frame. */
    this.due = { size: true, style: true, legend: true };
    this.frames = new FrameLoop((nowS, dtS) => this.#frame(nowS, dtS));
    this.screen = new Screen(host, () => this.#resized());
    this.#calm = matchMedia('(prefers-reduced-motion: reduce)');
    this.camera.calm = this.#calm.matches;
    this.#calm.onchange = () => this.#calmed();
    this.keeper = new DeviceKeeper({
      host,
      first,
      onOpen: (device, isStandIn) => this.#opened(device, isStandIn),
      onLost: events.onLost,
      onFallback: events.onFallback,
    });
    this.#sight = new IntersectionObserver((entries) => this.#seen(entries[entries.length - 1].isIntersecting));
    this.#sight.observe(host);
  }

  start() {
    const started = this.keeper.start();
    void this.keeper.standIn();
    return started;
  }

  destroy() {
    this.#sight.disconnect();
    this.screen.close();
    this.#calm.onchange = null;
    clearTimeout(this.#rest);
    this.keeper.close();
    this.frames.close();
  }

  // ---- what is to be drawn
  // ------------------------------------------------------------------------------------------------

  /**
   * Replaces the old surface by a new one. If it `meets` the old one, its particles fade in over the body.
   * @param {{grow: boolean, fit: boolean, bounds: Bounds | null, meets?: boolean}} options
   */
  begin({ grow, fit, bounds, meets = false }) {
    this.#scene.shown = bounds ?? this.#scene.bounds;
    // Otherwise a surface of another size might grow around the camera or far from it.
    if (fit) this.fit(true);
    if (grow && this.look.level === null && !this.#calm.matches && !this.frames.isHidden) {
      this.#lastS = nowS();
      this.reveal.begin(this.#now(), this.opening);
      this.#events.onReveal({ level: 0, levels: 0, particles: 0 });
    } else {
      this.#endReveal();
    }
    this.upload.restart(meets);
    this.look = { ...this.look, highlight: -1 };
    this.remembered();
    this.#restyle();
  }

  /** Draws the particles after the chosen relaxation step, or on their way there. */
  remembered() {
    const { columns } = this;
    const before = columns.shown;
    columns.step = shownStep(this.look);
    if (columns.shown === before) return;
    this.upload.all();
    this.frames.ask();
  }

  /** @param {number} first @param {number} last @param {() => void} onDrawn */
  changed(first, last, onDrawn) {
    if (last > 0) this.opening = false;
    this.upload.changed(first, last);
    this.due.legend = true;
    // The last level may have changed.
    if (this.look.level !== null) this.due.style = true;
    // Without a visible picture the sampler does not wait for frames.
    if (this.frames.isHidden || !this.keeper.device) onDrawn();
    else this.frames.afterNext(onDrawn);
    this.frames.ask();
  }

  /** Handles a mesh that was added or removed without particles. */
  meshed() {
    this.due.legend = true;
    this.frames.ask();
  }

  /** @param {number} first @param {number} last */
  recolour(first, last) {
    this.upload.recolour(first, last);
    this.#faces.recolour();
    this.due.legend = true;
    this.frames.ask();
  }

  /** @param {boolean} on */
  dim(on) {
    if (this.dimmer.set(on, this.#now(), this.#calm.matches)) this.#restyle();
  }

  /** @param {Partial<Look>} patch */
  set(patch) {
    const before = this.look;
    this.look = { ...before, ...patch };
    if (Object.entries(before).every(([name, value]) => this.look[/** @type {keyof Look} */ (name)] === value)) return;
    const { colour, theme, level, marks } = this.look;
    if (colour !== before.colour || theme !== before.theme) this.recolour(0, this.columns.count);
    if (marks !== before.marks) this.#faces.recolour();
    if (marks !== before.marks || this.look.draw !== before.draw) this.due.legend = true;
    this.remembered();
    if (level !== before.level || this.look.insets !== before.insets) this.#frameFront();
    // A running reveal would continue behind the levels that the user steps through.
    if (level !== null) this.complete();
    this.#restyle();
  }

  #restyle() {
    this.due.style = true;
    this.frames.ask();
  }

  #resized() {
    this.due.size = true;
    this.#frameFront();
    this.#restyle();
  }

  #calmed() {
    this.camera.calm = this.#calm.matches;
    if (this.#calm.matches && this.reveal.active) this.#endReveal();
    this.frames.ask();
  }

  /** @param {boolean} isSeen  whether the picture is in sight */
  #seen(isSeen) {
    this.keeper.seen(isSeen);
    this.frames.see(isSeen);
    // A surface that grows out of sight is completed at once.
    if (!isSeen) this.complete();
  }

  /** Ends a reveal: what has been placed is shown at once. */
  complete() {
    if (!this.reveal.active) return;
    this.#endReveal();
    this.upload.all();
  }

  #endReveal() {
    this.reveal.end();
    this.#events.onReveal(null);
    // Now a mesh is drawn, and a closed surface only from outside.
    this.#restyle();
  }

  // ---- where it is seen from
  // ----------------------------------------------------------------------------------------------

  /**
   * Sets the clip box, which determines the near and far planes, and the fit before there are particles.
   * @param {Bounds} bounds
   */
  setBounds(bounds) {
    this.#scene.bounds = bounds;
    this.camera.limits(ballOf(bounds).radius);
    this.frames.ask();
  }

  /**
   * @param {boolean} [jump]  without an animation, to the box of a surface that is still to come; the present one stays
   *   until then
   */
  fit(jump = false) {
    if (jump) this.camera.fit(this.#scene.boxBall(this.look.box !== null), { jump });
    else {
      const { ball, distance } = this.#fit();
      this.camera.fit(ball, { distance });
    }
    this.moved();
  }

  /** Rotates about the vertical, from these angles, to where the outline is largest. @param {Angles} from */
  turnWide(from) {
    const { columns, camera } = this;
    camera.turnTo({ yaw: widestYaw(from, columns, this.#fitBall()), pitch: from.pitch });
    this.moved();
  }

  /** Rotates to a side of the surface, unless it is already visible. @param {Vec3} normal */
  turnTo(normal) {
    const to = facing(this.camera.state, normal);
    if (to) this.camera.turnTo(to);
    this.moved();
  }

  /** Turns the camera to a named view. @param {keyof typeof STANDARD_VIEWS} name */
  lookFrom(name) {
    this.camera.turnTo(STANDARD_VIEWS[name]);
    this.moved();
  }

  /** Fits the surface, or the visible part of the front, unless the user has moved the camera. */
  #frameFront() {
    const { camera, columns } = this;
    if (!camera.state.fit || columns.count === 0 || columns.stale || this.reveal.active) return;
    const { ball, distance } = this.#fit();
    camera.glideTo(ball, distance);
    this.moved();
  }

  /** Returns the ball for a fit. */
  #fitBall() {
    const { columns, look } = this;
    return this.#scene.fitBall(columns, look.box !== null, look.axes, this.#shownOnly());
  }

  /** Returns which particles are drawn; undefined if all are. */
  #shownOnly() {
    const { columns, look } = this;
    const newest = shownLevel(look, columns.lastLevel);
    if (newest === null || newest >= columns.lastLevel) return undefined;
    return (/** @type {number} */ i) => columns.levels[i] <= newest;
  }

  /**
   * Returns the ball and the distance for a fit. Without box and axes the outline of the surface fills the picture,
   * else the ball does.
   */
  #fit() {
    const { columns, look, screen } = this;
    const ball = this.#fitBall();
    this.#wholeDistance = fitDistance(ball.radius);
    if (look.box || look.axes || columns.count === 0 || screen.cssWidth === 0)
      return { ball, distance: this.#wholeDistance };
    const { placed: positions, radii, count } = columns;
    const discs = { positions, radii, count };
    const distance = outlineDistance(this.camera.end, ball, this.#free(), discs, this.#shownOnly());
    return { ball, distance: this.#asLinked(distance) };
  }

  /** Returns the size of the picture's free part, which no panel covers, and its corner that must stay free. */
  #free() {
    const { insets } = this.look;
    return { ...freePart(this.screen.cssWidth, this.screen.cssHeight, insets), corner: insets.corner };
  }

  /**
   * Returns the distance of a link's camera, if the angles are the link's and the whole surface is visible from there.
   * So a page that is opened again shows the same picture.
   * @param {number} distance  of a fit
   */
  #asLinked(distance) {
    const [{ linked }, { yaw, pitch }] = [this, this.camera.end];
    if (linked?.yaw !== yaw || linked.pitch !== pitch) return distance;
    return clamp(linked.distance, distance, Math.max(distance, this.#wholeDistance));
  }

  /** Moves the camera to look at a point along its normal. @param {Place} place */
  lookAt({ places, radius, normal }) {
    const centre = vec((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);
    this.camera.lookAt({ centre, radius: LOOK_RADII * radius }, normal);
    this.moved();
  }

  /** Handles a motion of the camera. */
  moved() {
    this.#events.onCamera(this.camera.state);
    this.frames.ask();
  }

  /** @returns {View} */
  currentView() {
    const { cssWidth, cssHeight } = this.screen;
    const { insets, projection } = this.look;
    const isParallel = projection === 'orthographic';
    return viewOf(this.camera.state, cssWidth, cssHeight, this.#scene.ball(), insets, isParallel);
  }

  /**
   * Returns the first row of the particle under a point of the host, in CSS pixels; null if there is none.
   * @param {number} x @param {number} y
   */
  pick(x, y) {
    const { columns, look } = this;
    const { cssWidth, cssHeight } = this.screen;
    if (columns.count === 0 || columns.stale || cssWidth === 0 || cssHeight === 0) return null;
    const view = this.currentView();
    const row = pick(
      columns,
      { eye: view.eye, direction: rayThrough(view, x, y) },
      {
        discScale: scaleOf(look),
        spheres: look.draw === 'spheres',
        toleranceRad: PICK_PX * view.worldPerPx,
        lastLevel: shownLevel(look, columns.lastLevel) ?? Infinity,
        plane: look.plane,
      },
    );
    return row === null ? null : columns.firstRow(row);
  }

  /**
   * Returns the position of a point in the picture, in CSS pixels of the host; null behind the eye.
   * @param {ArrayLike<number>} place
   */
  project(place) {
    return projected(this.currentView(), place);
  }

  /** Returns the ray through a point of the host, in CSS pixels. @param {number} x @param {number} y @returns {Ray} */
  rayThrough(x, y) {
    const view = this.currentView();
    return { eye: view.eye, direction: rayThrough(view, x, y) };
  }

  // ---- drawing
  // ------------------------------------------------------------------------------------------------------------

  /** @param {Device} device  without any particle yet @param {boolean} isStandIn */
  #opened(device, isStandIn) {
    this.#effort.begin(device.kind, this.screen.ratio);
    this.#drawnCamera = null;
    this.#isPart = false;
    this.due.size = true;
    this.upload.restart();
    this.#faces.restart();
    this.#creases.restart();
    this.#restyle();
    if (!isStandIn) this.#events.onDevice(device);
  }

  /** The time of the picture, in seconds. */
  #now() {
    return nowS() - this.#lagS;
  }

  /** @param {number} clockS @param {number} dtS @returns {FrameResult} */
  #frame(clockS, dtS) {
    const { device } = this.keeper;
    if (!device || this.#holds(clockS)) return 'none';
    const passedS = clockS - this.#lastS;
    this.#lagS += this.reveal.wait(passedS);
    this.#lastS = clockS;
    const nowS = clockS - this.#lagS;
    const before = this.camera.state;
    const moving = this.camera.step(dtS);
    if (this.camera.state !== before) this.#events.onCamera(this.camera.state);
    this.#choose(device);
    let outcome;
    const startMs = performance.now();
    try {
      if (!this.#isPart || !this.upload.isWhole) this.#tell(device, nowS);
      outcome = this.upload.isWhole ? device.renderer.draw(nowS) : 'part';
    } catch (error) {
      // The renderer has trapped; its instance must not be called again.
      this.keeper.giveUp(error instanceof Error ? error.message : String(error));
      return 'none';
    }
    this.#isPart = outcome === 'part';
    this.#sinceMs += performance.now() - startMs;
    if (this.#isPart) {
      if (this.camera.state !== before) this.frames.ask();
      return 'part';
    }
    // Without particles the colours have no range; the previous legend stays.
    if (this.due.legend && this.columns.count > 0) this.#tellLegend();
    const revealing = this.#tellReveal(nowS);
    const dimming = this.dimmer.moving;
    if (dimming) this.due.style = true;
    if (outcome === 'drawn') this.#judge(passedS);
    const { upload } = this;
    this.#isMotion = this.#isMoving && (moving || revealing || upload.glide.active);
    if (moving || revealing || dimming || upload.glide.active || upload.fading(nowS)) this.frames.ask();
    if (outcome === 'drawn') {
      this.keeper.drew();
      this.#events.onFrame();
      return 'drawn';
    }
    return outcome === 'skipped' && this.screen.width > 0 && this.screen.height > 0 ? 'skipped' : 'none';
  }

  /** @param {boolean} isGrowing  whether the front is still placing particles */
  grow(isGrowing) {
    this.growing = isGrowing;
    if (this.reveal.isHeld) this.frames.ask();
  }

  /**
   * Whether the first surface is still awaited. Once it is there, the camera fits it.
   * @param {number} clockS
   */
  #holds(clockS) {
    const { reveal, columns, camera } = this;
    if (!reveal.isHeld) return false;
    if (this.growing || columns.count === 0) return true;
    const { ball, distance } = this.#fit();
    if (camera.state.fit) camera.fit(ball, { distance, jump: true });
    this.#lastS = clockS;
    const { eye } = this.currentView();
    const { placed, normals } = columns;
    const isSeen = (/** @type {number} */ i) =>
      [0, 1, 2].reduce((sum, k) => sum + normals[3 * i + k] * (eye[k] - placed[3 * i + k]), 0) > 0;
    reveal.release(clockS - this.#lagS, columns.levels.subarray(0, columns.count), isSeen);
    return false;
  }

  /**
   * Chooses how the next picture is drawn. A motion interrupts a complete picture that is being painted.
   * @param {Device} device
   */
  #choose({ renderer }) {
    const { camera, reveal, upload } = this;
    const isMoving = camera.state !== this.#drawnCamera || reveal.active || upload.glide.active || this.growing;
    if (this.#isPart && (!isMoving || this.#isMoving)) return;
    this.#isPart = false;
    this.#isMoving = isMoving;
    this.#sinceMs = 0;
    this.#drawnCamera = camera.state;
    const before = this.#quality;
    this.#quality = this.#effort.of(isMoving);
    const { share, body, stride } = this.#quality;
    if (share !== before.share) this.due.size = true;
    if (share !== before.share || body !== before.body) this.due.style = true;
    if ('choose' in renderer) renderer.choose({ isMoving, stride });
  }

  /**
   * Learns from a picture, and schedules the complete one for when it stands still.
   * @param {number} passedS  since the last frame
   */
  #judge(passedS) {
    clearTimeout(this.#rest);
    this.#rest = undefined;
    if (!this.#isMoving) return;
    if (this.keeper.device?.kind === 'canvas2d') this.#effort.painted(this.#sinceMs);
    else if (this.#isMotion) this.#effort.passed(1000 * passedS);
    if (!this.#effort.isReduced) return;
    this.#rest = setTimeout(() => this.frames.ask(), REST_MS);
  }

  /** Whether the complete picture is still to come. */
  get isWaiting() {
    return this.#rest !== undefined;
  }

  /** Passes the changes since the last frame to the device. @param {Device} device @param {number} nowS */
  #tell({ renderer }, nowS) {
    const { screen, due, upload, look, reveal } = this;
    if (due.size) {
      const { share } = this.#quality;
      renderer.resize(Math.round(share * screen.width), Math.round(share * screen.height));
      due.size = false;
    }
    const count = upload.write(renderer, look, { reveal, calm: this.#calm.matches, nowS });
    const drawn = look.draw === 'mesh' && !reveal.active;
    this.#faces.write(renderer, look, { drawn, range: upload.range });
    this.#creases.write(renderer, look);
    this.#tellView(renderer, this.currentView(), count);
    if (due.style) {
      renderer.set_style(JSON.stringify(this.#style(nowS)));
      due.style = false;
    }
  }

  /** @param {Device['renderer']} renderer @param {View} view @param {number} count  particles that the device holds */
  #tellView(renderer, view, count) {
    renderer.set_view(view.packed);
    const points = this.upload.writePoints(renderer, this.look, view, {
      count,
      ratio: this.screen.ratio * this.#quality.share,
    });
    const { reveal } = this;
    if (reveal.isOpening) renderer.set_count(Math.min(count, reveal.appeared(this.#now())), count);
    else renderer.set_count(count + points, count);
  }

  #tellLegend() {
    const { colour, theme, draw, marks } = this.look;
    this.due.legend = false;
    const legend = legendOf(colour, theme, this.columns, this.upload.range);
    const hasDots = draw === 'mesh' && marks && this.columns.mesh !== null;
    this.#events.onLegend(hasDots ? { ...legend, dots: legendOfDots(theme) } : legend);
  }

  /** @param {number} nowS @returns whether further levels are to appear */
  #tellReveal(nowS) {
    const { reveal, columns } = this;
    if (!reveal.active) return false;
    if (nowS > reveal.endS() + FADE_S && !this.growing && !reveal.isHeld) {
      this.#endReveal();
      return false;
    }
    const level = reveal.levelAt(nowS);
    let particles = 0;
    for (let i = 0; i < columns.count && columns.levels[i] <= level; i += 1) if (!columns.isFurther(i)) particles += 1;
    this.#events.onReveal({ level: Math.max(0, level), levels: reveal.births.length, particles });
    return true;
  }

  /** @param {number} nowS */
  #style(nowS) {
    const calm = this.#calm.matches;
    const { columns, reveal } = this;
    const { share, body } = this.#quality;
    const look = body ? this.look : { ...this.look, body: false };
    return styleOf(look, {
      lastLevel: columns.lastLevel,
      // A surface that has not closed yet shows its inside.
      isOpen: columns.isOpen || (reveal.active && !reveal.isOpening),
      bounds: this.#scene.shown,
      dim: this.dimmer.at(nowS, calm),
      calm,
      pixelRatio: this.screen.ratio * share,
    });
  }

  /**
   * Returns the camera for a picture of this size: the one on the screen, or, if the outline was fitted to a longer
   * side, one that shows the whole surface.
   * @param {{width: number, height: number}} size
   */
  #cameraOf(size) {
    const { state } = this.camera;
    const longer = (/** @type {{width: number, height: number}} */ { width, height }) =>
      [width, height].map((side) => side / Math.min(width, height));
    const [wanted, shown] = [longer(size), longer(this.#free())];
    if (!state.fit || wanted.every((side, k) => side > shown[k] - 0.01)) return state;
    return { ...state, distance: Math.max(state.distance, this.#wholeDistance) };
  }

  /**
   * Draws the picture, without panels, into a texture and reads it back. `project` says where a place is in it.
   * @param {number} widthPx @param {number} heightPx @param {boolean} transparent
   * @returns {Promise<{width: number, height: number, pixels: Uint8Array<ArrayBuffer>,
   *   project: ReturnType<typeof fillFrame>}>}
   */
  async pixels(widthPx, heightPx, transparent) {
    const { device } = this.keeper;
    if (!device) throw new Error('There is no picture yet.');
    const { renderer } = device;
    const now = this.#now();
    // A saved picture shows the particles at their final positions, not during an animation.
    if (this.upload.glide.active) this.upload.restart();
    this.#isPart = false;
    this.#quality = WHOLE;
    this.due = { ...this.due, size: true, style: true };
    do this.#tell(device, now);
    while (!this.upload.isWhole);
    const [width, height] = renderer.picture_size(widthPx, heightPx);
    const { cssWidth, cssHeight } = this.screen;
    const isParallel = this.look.projection === 'orthographic';
    const size = /** @type {const} */ ([cssWidth || width, cssHeight || height]);
    const camera = this.#cameraOf({ width, height });
    const view = viewOf(camera, ...size, this.#scene.ball(), undefined, isParallel);
    const project = fillFrame(view, { width, height }, (cssWidth || width) / (cssHeight || height));
    this.#tellView(renderer, view, this.columns.count);
    renderer.set_style(JSON.stringify({ ...this.#style(now), dim: 0, outline: -1 }));
    const picture = renderer.read_pixels(width, height, transparent);
    this.#restyle();
    // A frame would find out whether the renderer has trapped meanwhile.
    const look = setInterval(() => this.frames.ask(), LOOK_MS);
    const pixels = await this.keeper.answered(picture).finally(() => clearInterval(look));
    return { width, height, pixels, project };
  }
}

/**
 * Enlarges a view so that the surface fills the shorter side of a picture as it fills the window's. A renderer shows
 * everything that the window shows, so with another aspect ratio the surface would be smaller. Returns where a place is
 * in the picture then; null behind the eye.
 * @param {View} view @param {{ width: number, height: number }} picture @param {number} windowAspect
 * @returns {(place: ArrayLike<number>) => { x: number, y: number } | null}
 */
function fillFrame(view, { width, height }, windowAspect) {
  const { packed } = view;
  const aspect = width / height;
  const shorter = (/** @type {number} */ a) => Math.min(1, a);
  // Heights: the window has 1 and is scaled by this factor to lie within the picture, which has 1.
  const within = Math.min(1, aspect / windowAspect);
  const factor = shorter(aspect) / (shorter(windowAspect) * within);
  for (let k = 0; k < 4; k += 1) {
    packed[4 * k] *= factor;
    packed[4 * k + 1] *= factor;
  }
  // The window within the picture.
  const [w, h] = [height * within * windowAspect, height * within];
  return (place) => {
    const spot = projected({ ...view, clipFromWorld: packed, widthPx: w, heightPx: h }, place);
    return spot && { x: spot.x + (width - w) / 2, y: spot.y + (height - h) / 2 };
  };
}
