// Types of the engine: the core's description, the values of the engine's signals, and the arguments of its commands.
// Lengths are in the field's own coordinates, angles in radians (`…_rad`), pixels are CSS pixels unless a name says
// otherwise.
import type { Columns, MEASURED } from './columns.js';
import type { Answer, Code, Phase as CorePhase, PointsProgress, Start } from './core-types.js';
import type { Surface } from './lesson/types.js';

export type Signal<T> = import('@preact/signals-core').Signal<T>;
export type ReadonlySignal<T> = import('@preact/signals-core').ReadonlySignal<T>;
export type Vec3 = [number, number, number];
/**
 * Margins of the picture that panels cover, in pixels. `corner`: a rectangle in the upper left of what is free, into
 * which a fit does not let the surface reach.
 */
export type Insets = {
  left: number;
  right: number;
  top: number;
  bottom: number;
  corner?: { width: number; height: number };
};

// ---- what the core says and is told: written from its own types (core-types.d.ts)

export type Bounds = import('./core-types.js').Bounds;
export type Parameter = import('./core-types.js').Parameter;
export type Description = import('./core-types.js').Description;
export type Limits = import('./core-types.js').Limits;
/** One entry of the gallery. */
export type SurfaceInfo = import('./core-types.js').SurfaceEntry;
/** One setting of the sampler; the interface builds its control from this. */
export type SettingInfo = import('./core-types.js').Setting;
/** One row of the report; its keys are paths into {@link Report}, such as `quality.six_neighbours`. */
export type ReportRow = import('./core-types.js').ReportRow;
/** A built-in model from points. Its `id` goes where a gallery surface's does. */
export type PointModel = import('./core-types.js').Model;
/** The description of a model from points, known once it is solved. */
export type ModelInfo = import('./core-types.js').ModelInfo;
/** The description that the core reads together with a solved system. */
export type SolvedModel = import('./core-types.js').SolvedModel;
export type Grip = import('./core-types.js').Grip;
export type Pull = import('./core-types.js').Pull;
export type MathNode = import('./core-types.js').MathNode;
export type FieldFault = import('./core-types.js').Fault;
/** The answer of the core to one step. */
export type CoreProgress = import('./core-types.js').Progress;
/** null while the run goes on */
export type StopReason = CoreProgress['stop_reason'];
/** The figures of a finished run. */
export type CoreReport = import('./core-types.js').Report;
/** The figures of quality of some particles. */
export type Measures = import('./core-types.js').Measures;
/** Requests for a mesh file, and what is told of the particles in files. */
export type FileRequest = import('./core-types.js').FileRequest;
export type FileRecord = import('./core-types.js').FileRecord;
/** The counts and the topology of a mesh. */
export type MeshAnswer = import('./core-types.js').MeshAnswer;
export type MeshInfo = import('./core-types.js').MeshInfo;
/** How far a new mesh is from the one that it was sampled from. */
export type MeshChange = import('./core-types.js').MeshChange;
export type LessonEvent = import('./core-types.js').LessonEvent;
export type LessonIterate = import('./core-types.js').LessonIterate;
export type LessonChapter = import('./core-types.js').LessonChapter;
export type LessonSettings = import('./core-types.js').LessonSettings;
export type LessonClient = import('./lesson/client.js').LessonClient;
export type LessonParticles = import('./lesson/types.js').Particles;
/** A mesh over all particles on the page, three indices a triangle. */
export type Mesh = { triangles: Uint32Array; about: MeshAnswer; leavesOutChips?: true };
/** A piece of a mesh. */
export type Body = import('./core-types.js').Body;
export type CoreAnswer<T> = Answer<T, FieldFault>;
export type ImageFacts = import('./core-types.js').ImageFacts;
export type ImageInfo = import('./core-types.js').ImageInfo;
export type FieldAnswer = CoreAnswer<import('./core-types.js').FieldAnswer>;
/** `surface` is of a model its id, of a file {@link FILE_SURFACE} */
export type FieldOk = Extract<FieldAnswer, { ok: true }>;
export type StartAnswer = CoreAnswer<Start>;
export type PointsAnswer = Answer<PointsProgress, string>;
export type SolvedAnswer = Answer<SolvedModel, string>;

// ---- what the page adds to it

export type { Columns };
/** The columns of a report. */
export type Figures = { [K in (typeof MEASURED)[number]]: NonNullable<Columns[K]> };
/** A range of the columns, as the worker posts it: the attributes of particles `first … first + n`. */
export interface ColumnRange {
  first: number;
  /** number of rows after this range is written */
  total: number;
  positions: Float32Array;
  /** the positions in double precision, in a box far from the origin; else empty */
  exact?: Float64Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
  parents: Uint32Array;
  /** the rows where patches meet and the pairs that a crease or a smooth join connects, where they have changed */
  creases?: Pick<Columns, 'twins' | 'segments' | 'seams'> | null;
  /** null for columns sent after the run, of as many particles */
  progress?: CoreProgress | null;
}

/**
 * `points` names a solved model; with it the clip box, the pulls and a formula that names the model
 * count.
 */
export type FieldRequest = Partial<import('./core-types.js').FieldRequest> & { points?: string; lines?: Line[] };
/** By the settings' names; a missing one has its default. `brush` holds the text of what is painted. */
export type Settings = Record<string, number | string>;
/**
 * A place that is painted finer or coarser: a ball, in whose middle the spacing is multiplied by `times`, and beyond
 * whose `reach` it is not.
 */
export type Dab = { at: Vec3; reach: number; times: number };
/** How particles lie to each other: in hexagons, or drawn over a front. */
export type Pattern = 'hexagonal' | 'blue' | 'random';
/**
 * The progress of a run as the worker tells it. `phase` has three more values than in the core: in
 * `making` the field is made of a file, in `mesh` the particles are joined, in `quality` they are measured.
 */
export type ToldProgress = Omit<CoreProgress, 'phase'> & { phase: CorePhase | 'making' | 'mesh' | 'quality' };
/** The progress of the present run, as the page shows it. */
export type Progress = ToldProgress & { run: number; live: boolean };
/** What a run that samples is for: {@link KINDS} says what follows from it. */
export type SampleKind =
  | 'new'
  | 'grow'
  | 'agreed'
  | 'change'
  | 'move'
  | 'rest'
  | 'trial'
  | 'live'
  | 'sketch'
  | 'again'
  | 'restore'
  | 'backdrop';
export type JobKind = SampleKind | 'relax';
export type Seconds = { seeding: number; generation: number; refinement: number; relaxation: number; quality: number };
/** A report with what the worker measured. */
export type Report = CoreReport & { seconds: Seconds };

// ---- the shareable state

export type ColourMode = import('./core-types.js').ColourMode;
/**
 * The camera: the eye is on a sphere around `target`, with z up. With `fit` the engine sets target and distance so that
 * the camera follows the surface. A zoom or pan by the user ends that, and the fit command starts it again.
 */
export type CameraState = Angles & { target: Vec3; distance: number; fit: boolean };
/** The side from which the camera looks. */
export type Angles = { yaw: number; pitch: number };
/** The options of the view. */
export type ViewState = import('./share/view.js').ViewState;
/**
 * A plane that hides the part of the picture that its unit normal points to: all p with normal · p > offset. Nothing is
 * sampled anew.
 */
export type CuttingPlane = { normal: Vec3; offset: number };
/** A clip box. `enlarged`: nobody has set it; it was enlarged by a press, around an `endless` surface or another. */
export interface ChosenBounds extends Bounds {
  enlarged?: 'larger' | 'endless';
}
/**
 * The whole shareable state, as plain JSON. `surface` is the gallery entry on which the formula is
 * based, and `formula` is the text in the editor. `parameters` and `settings` hold only values that
 * differ from the defaults. If `surface` is a model's id, or {@link FILE_SURFACE} for the file
 * opened last, `formula` names it {@link MODEL}: by itself it is that model. A formula typed
 * without that name is based on the default surface. The points of a file are not in the state, so
 * a link to a file shows the default surface.
 */
export interface State {
  v: 1;
  surface: string;
  formula: string;
  parameters: Record<string, number>;
  declared: Parameter[];
  /** how many of the points of a model or a file are fitted; null for the default number, and for a formula */
  centres: number | null;
  /** null: the surface's own box, or one that fits the formula */
  bounds: ChosenBounds | null;
  plane: CuttingPlane | null;
  /** on the surface of a model or a file, one after the other; none on a surface from a formula */
  pulls: Pull[];
  /** along which edges of the mesh of a file stay sharp, whatever their angle */
  lines: Line[];
  settings: Settings;
  view: ViewState;
}
/** The part of the state that can be undone: what is sampled and how, and where it is cut open, without the view. */
export type Shape = Omit<State, 'v' | 'view'>;

// ---- what the engine reports

export type BackendKind = 'webgpu' | 'webgl2' | 'canvas2d';
export type BackendName = 'starting' | BackendKind;
/**
 * A message for the user. `id` names its cause (`panic`, `hang`, `safe-mode`, `device-lost`, `link`, `load`, `size`,
 * `file`, `share-file`, …); a later notice of the same cause replaces it, and it is removed when it no longer applies.
 * `details` is a report for the user to copy.
 */
export interface Notice {
  id: string;
  kind: 'info' | 'warn' | 'error';
  text: string;
  details?: string;
  action?: { label: string; run: () => void };
  /** the page offers to open one */
  asks?: 'file';
}
/**
 * The particle under the pointer, or the tapped one. x and y are CSS pixels within the canvas host. `residual`,
 * `nearest` and `valence` are null until the report of the run has arrived.
 */
export interface Hover {
  index: number;
  level: number;
  /** null for a seed */
  parent: number | null;
  /** the kind of curve on which it lies */
  curve: 'crease' | 'smooth join' | null;
  position: Vec3;
  normal: Vec3;
  radius: number;
  residual: number | null;
  valence: number | null;
  nearest: number | null;
  x: number;
  y: number;
  /** it was pressed and stays until the next press, instead of following the pointer */
  tapped: boolean;
}
/**
 * Where a place is in the picture: x and y are CSS pixels within the canvas host, `perPx` is the length in the field's
 * coordinates that is one pixel long there, across the line of sight.
 */
export type Spot = { x: number; y: number; perPx: number };
/**
 * A place to be pointed out: the positions that are marked by rings of this radius, the direction from which they are
 * seen, and what stands beside them. An `outline` goes through the positions in the place of rings.
 */
export type Place = { places: Vec3[]; radius: number; normal: Vec3; text: string; outline?: boolean };
/** Something in the picture that a pointer holds, at places in CSS pixels of the canvas host. */
export interface Hold {
  drag: (at: { x: number; y: number }) => void;
  drop: () => void;
}
/** Returns what a press takes hold of in place of the camera, if anything. */
export type Take = (at: { x: number; y: number }, shift: boolean) => Hold | null;
/** Takes notice of a place that a pointer hovers over or taps; true if that means no particle. */
export type Notices = (at: { x: number; y: number }, tapped: boolean) => boolean;
/** The points of a line, in their order. */
export type Line = Vec3[];
/** The mesh of a file as it was repaired: three coordinates for each vertex, three vertices for each face. */
export type MeshFaces = { vertices: Float64Array; faces: Uint32Array };
/** A ray from the eye; the direction has length 1. */
export type Ray = { eye: Vec3; direction: Vec3 };
/** colour is `#rrggbb` */
export type LegendEntry = { label: string; colour: string; count?: number };
/**
 * The legend of the colours. `colours` are `#rrggbb`: the cycle, or the samples of the ramp from `range[0]` to
 * `range[1]`. A diverging ramp has 0 in its middle; values outside its range have the colour of its end. `entries` name
 * categories. `pending` is set while the figures behind the colours are being computed.
 */
export interface Legend {
  title: string;
  unit: string;
  kind: 'categories' | 'sequential' | 'diverging' | 'plain' | 'normal';
  entries?: LegendEntry[];
  range?: [number, number];
  /** a value with a tick on the ramp, such as the ideal distance 2r */
  mark?: number;
  colours: string[];
  pending?: boolean;
  /** of the dots on vertices of a mesh, while it is drawn with them */
  dots?: LegendEntry[];
}
/**
 * The times in seconds of the sampling and of its parts. With `steps` above 0 they are those of so many relaxation
 * steps alone, which were made after it.
 */
export type Timing = { steps: number; sampling: number; seconds: Seconds; particles: number };
/**
 * Measurements of the last slider drag: the runs requested and shown, and the median time from a request to its
 * picture.
 */
export type LastDrag = { requested: number; shown: number; latency_ms: number; particles: number; coarse: boolean };
/** The progress of the reveal of a new run: its particles appear level by level, slowly enough to be followed. */
export type Reveal = { level: number; levels: number; particles: number };
/** The progress of loading a model or a file. `label` is the core's name of the stage. */
export interface Loading {
  /** of the model, or {@link FILE_SURFACE} */
  id: string;
  name: string;
  label: string;
  /** 0 … 1 of the whole process */
  fraction: number;
}
/** An error in loading a model or a file. The previous surface stays. */
export interface LoadingError {
  id: string;
  name: string;
  /** `refused` by the core, or `too_large`, `unreadable`, `crashed`, `silent`, `bundle` */
  kind: string;
  /** with the line number, if there is one */
  message: string;
}
/**
 * What is under way. `sampling`: a run, which can be stopped; `measuring`: its particles are on the page, and its
 * report is pending.
 */
export type Status = 'rest' | 'sampling' | 'measuring';
/**
 * What the last run has made. `partial`: it was stopped or capped; `none`: it found no surface; null: no run has ended,
 * or the next one has found a surface.
 */
export type Result = 'whole' | 'partial' | 'none' | null;
/**
 * What has become of a formula that is still being typed. `typing`: it waits for a pause before it is sampled; `shown`:
 * the surface is its own; `back`: it gave way to the one before.
 */
export type Trial = 'none' | 'typing' | 'shown' | 'back';
export interface EngineSignals {
  state: ReadonlySignal<State>;
  /** null until the core has loaded */
  description: ReadonlySignal<Description | null>;
  /** the last good field */
  field: ReadonlySignal<FieldOk | null>;
  /** what has become of the surface that was pulled last; null if something else has changed it since */
  grip: ReadonlySignal<Grip | null>;
  /** the error in the present formula */
  fieldError: ReadonlySignal<FieldFault | null>;
  progress: ReadonlySignal<Progress>;
  /** null while stale */
  report: ReadonlySignal<Report | null>;
  timing: ReadonlySignal<Timing | null>;
  backend: ReadonlySignal<BackendName>;
  /** name of the graphics adapter, may be empty */
  adapter: ReadonlySignal<string>;
  notice: ReadonlySignal<Notice | null>;
  /** of the mesh drawn; null while there is none */
  mesh: ReadonlySignal<MeshAnswer | null>;
  /** how particles were drawn before a mesh was made, which the refined method samples; null while none is made */
  meshing: ReadonlySignal<Pick<ViewState, 'draw' | 'level' | 'step'> | null>;
  hover: ReadonlySignal<Hover | null>;
  /** the place that was pointed out last; null once it no longer applies */
  spot: ReadonlySignal<Place | null>;
  legend: ReadonlySignal<Legend | null>;
  /** increases whenever the particles, their fates or their figures change */
  revision: ReadonlySignal<number>;
  /** the particles, read-only */
  columns: Columns;
  /** null while nothing is being revealed */
  reveal: ReadonlySignal<Reveal | null>;
  status: ReadonlySignal<Status>;
  result: ReadonlySignal<Result>;
  trial: ReadonlySignal<Trial>;
  /** whether a control is being dragged, also while it rests */
  dragging: ReadonlySignal<boolean>;
  lastDrag: ReadonlySignal<LastDrag | null>;
  /** increases when the page turns the camera to show another surface, as no hand does */
  turned: ReadonlySignal<number>;
  /** increases with every picture drawn, after which places may have moved in it */
  frame: ReadonlySignal<number>;
  /** the effective theme, after `auto` is resolved */
  theme: ReadonlySignal<'light' | 'dark'>;
  /** the model or file that is loading */
  loading: ReadonlySignal<Loading | null>;
  /** null once another surface is chosen; a notice `file` has the same message */
  loadingError: ReadonlySignal<LoadingError | null>;
  /** of the surface shown; null for a formula */
  model: ReadonlySignal<ModelInfo | null>;
  /** of the image that was opened last; null before */
  image: ReadonlySignal<ImageFacts | null>;
  /** what the mesh file that was opened last is taken for; null if the last file was of another kind */
  taken: ReadonlySignal<'surface' | 'points' | null>;
  /** how far the new mesh is from the one that was opened; null before it is known */
  change: ReadonlySignal<MeshChange | null>;
  /** what is wrong with the formula of the value by which the particles are coloured; null if nothing is */
  valueFault: ReadonlySignal<string | null>;
}
export interface EngineCommands {
  /** a gallery surface, a built-in model, or {@link FILE_SURFACE} to return to the file opened last */
  setSurface: (id: string) => void;
  /**
   * samples the surface of a triangle mesh, the image or the points of a file. The voxels of an image may be in a file
   * beside it. Resolves once it is sampled, refused or cancelled.
   */
  openFile: (file: File, beside?: File[]) => Promise<void>;
  /** takes the mesh file that was opened last for its surface, or for points */
  takeFileFor: (what: 'surface' | 'points') => Promise<void>;
  /** fits another number of the points of the present model or file */
  setCentres: (count: number) => void;
  /** cancels the model or file that is loading */
  cancelLoading: () => void;
  /**
   * a formula that names {@link MODEL} keeps the model shown, another one leaves it; `typing`: more
   * keys may follow, so that the text is sampled once they pause; without it, at once; `whole`: the
   * text replaces all of the formula before, and what was set for that ends
   */
  setFormula: (text: string, options?: { typing?: boolean; whole?: boolean }) => void;
  /** `live` during a drag; call once more without it at the end */
  setParameter: (name: string, value: number, options?: { live?: boolean }) => void;
  /** samples what else is chosen of an image or a mesh, as a new surface: by its parameters */
  chooseOfFile: (parameters: Record<string, number>) => void;
  /** restores the value of the gallery or of the declaration */
  resetParameter: (name: string) => void;
  /**
   * changes these parameters as little as possible so that the surface passes through the pins; `live` during a drag,
   * once more without it at the end
   */
  pull: (parameters: Record<string, number>, pins: readonly Vec3[], options?: { live?: boolean }) => void;
  /** makes these pulls on the surface of a model, in the place of those before; `live` during a drag */
  setPulls: (pulls: readonly Pull[], options?: { live?: boolean }) => void;
  /**
   * has a press on the picture take hold of something in place of the camera, and what the pointer is at mean something
   * else than a particle
   */
  takeWith: (take: Take, notices: Notices) => void;
  /** the mesh of the file; null if the core has none open */
  meshFaces: () => Promise<MeshFaces | null>;
  /** keeps the edges of the mesh along these lines sharp, in the place of those before */
  setLines: (lines: readonly Line[]) => void;
  /** declares an unknown name of the formula as a parameter */
  declareParameter: (name: string) => void;
  /** the number that a text stands for in the language of formulas, such as `pi/2`; null for any other text */
  readNumber: (text: string) => Promise<number | null>;
  /** what is wrong with the formula of a thickness or a spacing on the present surface; null if nothing is */
  textFault: (what: 'thickness' | 'spacing', text: string) => Promise<string | null>;
  /** the voxels of the image in a rectangle of so many pixels; NaN outside it, null without an image */
  section: (rectangle: { corner: Vec3; sides: [Vec3, Vec3]; size: [number, number] }) => Promise<Float32Array | null>;
  /** `enlarges`: nobody has set this box, so the camera fits it and the next formula ends it */
  setBounds: (bounds: Bounds | null, options?: { live?: boolean; enlarges?: boolean }) => void;
  /** whether the box was enlarged by a press, around an `endless` surface or another; reads the state */
  enlargement: () => 'endless' | 'larger' | null;
  /** the normal may have any length but 0 */
  setPlane: (plane: CuttingPlane | null, options?: { live?: boolean }) => void;
  /** takes the box of the gallery surface back, or fits it to the formula */
  fitBox: () => void;
  setSetting: (name: string, value: number | string, options?: { live?: boolean }) => void;
  resetSetting: (name: string) => void;
  /** restores an earlier state; of the view the camera alone, where it is given */
  restore: (shape: Shape & { camera?: CameraState }) => void;
  /** samples from the start; does nothing during a run of the same input */
  run: () => void;
  /** stops the run and keeps the partial result */
  stop: () => void;
  /** starts a run without relaxation; does nothing if a pattern is chosen that is not relaxed */
  generateOnly: () => void;
  /** relaxes the present particles by that many steps, unless their pattern is not relaxed */
  relax: (steps: number) => void;
  setView: (patch: Partial<ViewState>) => void;
  fit: () => void;
  /** marks a place, or none, and brings it before the camera */
  pointOut: (place: Place | null) => void;
  /** turns the camera to a side of the surface, unless that side is seen already */
  turnTo: (normal: Vec3) => void;
  /** turns the camera to a named view */
  lookFrom: (name: 'front' | 'right' | 'top' | 'isometric') => void;
  /** no particle is chosen any more, even if it was pressed */
  dismissHover: () => void;
  /** > 1 zooms in */
  zoom: (factor: number) => void;
  orbit: (dxRad: number, dyRad: number) => void;
  /** pixels of the canvas host covered by panels; the surface is centred in the rest */
  setInsets: (insets: Insets) => void;
  /** the state as the fragment of an address, with `#`; empty for the default state. Not before the core has loaded */
  link: () => Promise<string>;
  /**
   * adopts the state of such a fragment with what `patch` changes; `initial`: what cannot be read is the default state
   */
  openLink: (link: string, options?: { initial?: boolean; patch?: object }) => Promise<void>;
  /** changes a part of the state and samples; returns what of it was not valid, in words */
  set: (patch: Record<string, unknown>) => string[];
  /** without panels; the surface fills its shorter side as it fills that of the window */
  picture: (options?: PictureWish) => Promise<ImageData>;
  savePng: (options?: PictureWish) => Promise<Blob>;
  /** the particles; `ply` has the record of what they were made from, `json` is the record alone */
  exportFile: (format: ParticleFormat, options?: { link?: string }) => Promise<Blob>;
  /** the program that makes the particles of the last run; rejects with the reason where there is none */
  code: (language: Language) => Promise<string>;
  /** draws the mesh of the refined method, whatever method is set, until `leaveMesh` */
  makeMesh: () => void;
  /** draws particles by the method that is set, as before the mesh was made */
  leaveMesh: () => void;
  /** takes the loose chips out of the present mesh, and out of its files */
  leaveOutChips: () => void;
  /** once no run is left; with the record of what it was made from, unless `plain` */
  exportMesh: (format: MeshFormat, options?: Partial<Omit<FileRequest, 'format'>>) => Promise<Blob>;
  dismissNotice: () => void;
  /** returns the index of the particle under a point of the canvas host */
  pick: (x: number, y: number) => number | null;
  /** returns where a place is in the picture; null behind the eye */
  project: (place: ArrayLike<number>) => Spot | null;
  /** returns the ray from the eye through a point of the canvas host */
  rayThrough: (x: number, y: number) => Ray;
  /** returns the present surface for such a run */
  lessonSurface: () => Surface | null;
  /** frees all that the engine holds: its workers, its device and its canvas */
  destroy: () => void;
}
/** File formats for particles, and for the record of what they were made from. */
export type ParticleFormat = 'ply' | 'csv' | 'json';
/** File formats for a mesh. */
export type MeshFormat = 'glb' | '3mf' | 'stl' | 'obj' | 'ply';
/** A picture to be drawn. `over` draws on it, and is told where a place is in it, null behind the eye. */
export interface PictureWish {
  width?: number;
  height?: number;
  transparent?: boolean;
  over?: (
    image: ImageData,
    project: (place: ArrayLike<number>) => { x: number; y: number } | null,
  ) => void | Promise<void>;
}
/** Languages of the program that makes the particles. */
export type Language = 'rust' | 'js' | 'python' | 'shell';
export type CodeAnswer = Answer<Code, string>;
/** Commands and counts of an engine for tests. */
export interface EngineDebug {
  loseDevice: (reason?: string) => void;
  /** delivers a message of another run */
  stale: (id: number) => void;
  /** resolves once the picture stands still and the state has the camera */
  still: () => Promise<void>;
  /** whether no sampler is there or coming */
  isOff: () => boolean;
  /** `work`: pixels that the painter has looked at */
  counts: () => {
    frames: number;
    uploads: number;
    opened: number;
    restarts: number;
    stale: number;
    dimmed: boolean;
    work: number;
  };
}
export type Engine = EngineSignals & EngineCommands & { debug: EngineDebug };
/** The arguments of an engine's creation. */
export interface EngineOptions {
  /** must be positioned; a canvas fills it */
  host: HTMLElement;
  /** the state to begin with, as {@link Engine.link} gives it */
  link?: string;
  /** what differs from it */
  state?: Record<string, unknown>;
  /** the back end to try first */
  backend?: BackendKind | null;
}
