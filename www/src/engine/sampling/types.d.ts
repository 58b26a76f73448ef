// Messages between the page and the sampler's worker, and the record of the runs.

import type { Timers, WorkerEnv } from '../bundle/types.js';
import type { KeyedFile, Opened } from '../files/types.js';
import type { Solved } from '../points/types.js';
import type { Store } from '../store.js';
import type {
  Bounds,
  CodeAnswer,
  ColumnRange,
  Columns,
  CoreProgress,
  Description,
  FieldAnswer,
  FieldFault,
  FieldOk,
  FieldRequest,
  Figures,
  FileRecord,
  FileRequest,
  Language,
  Measures,
  MeshChange,
  MeshFaces,
  Report,
  SampleKind,
  Seconds,
  Settings,
  State,
  ToldProgress,
} from '../types.js';

export type Mesh = import('../types.js').Mesh;
/**
 * Samples a field from the start, in the way of the job's kind (see `kinds.js`), with complete settings. The particles
 * may follow the surface instead in the settings of `following`.
 */
export interface SampleJob {
  kind: SampleKind;
  field: FieldRequest;
  settings: Settings;
  following?: Settings[];
  /** The number of particles above which the user is asked first. */
  asksAbove: number;
}
/** Relaxes the particles that the worker holds. They must be those of run `of`. */
export type RelaxJob = { kind: 'relax'; of: number; steps: number };
export type Job = SampleJob | RelaxJob;
/** What the field of a job names: a solved model, or the file of an image or a mesh. */
export type Given = Pick<Solved, 'field' | 'info'> | { file: KeyedFile };
/** A job on its way through the worker, under the number of its run. */
export type Numbered = { id: number; job: Job; given: Given | null };
/**
 * A `job` takes the place of the one that waits, and replaces the running one once the core has accepted its field
 * (see `jobs.js`). If the field is refused, the running job continues. `stop` ends every job sent before it.
 * `curvature` says whether the page shows the curvature. If so, it is sent with the other columns, and at once for the
 * particles that the worker holds. `mesh` says whether the page draws a mesh. If so, it is made at the end of every
 * run, and sent with the last columns. `value` is the formula of the value that the page shows, empty for none. It is
 * sent after each run, and for the particles that the worker holds. `export` asks for the mesh as a file, once no job
 * is left. `number` asks for the number that a text without names stands for, `code` for the program that makes the
 * particles, `fault` for what is wrong with a formula of the settings. `measure` measures particles that the sampler
 * has not placed: a worker that is asked has no jobs. `section` asks for the voxels in a plane. `open` opens the file
 * of an image or a mesh, which `open_stop` gives up. The first message is `core`, or `no_core` if the core could not be
 * loaded.
 */
export type ToWorker =
  | { type: 'core'; module: WebAssembly.Module }
  | { type: 'no_core'; fault: LoadFault; message: string }
  | ({ type: 'job' } & Numbered)
  | { type: 'curvature'; on: boolean }
  | { type: 'mesh'; on: boolean }
  | { type: 'export'; request: number; file: Partial<FileRequest> }
  | { type: 'number'; request: number; text: string }
  | { type: 'code'; request: number; language: Language }
  | { type: 'value'; text: string }
  | { type: 'fault'; request: number; what: 'thickness' | 'spacing'; text: string }
  | { type: 'measure'; request: number; field: Partial<FieldRequest>; placed: PlacedColumns; isAdaptive: boolean }
  | { type: 'section'; request: number; place: number[]; size: [number, number] }
  | { type: 'faces'; request: number }
  | { type: 'open'; request: number; file: KeyedFile }
  | { type: 'open_stop' }
  | { type: 'stop' }
  | { type: 'drawn'; id: number };
/** Particles that the sampler has not placed: vectors of three floats. */
export type PlacedColumns = { positions: Float32Array; normals: Float32Array; radii: Float32Array };
/** Figures, places and columns as those of a report. */
export type PlacedMeasures = Measures & { energy: Float32Array; valence: Uint8Array };
/**
 * How a job ended. `refused`: the core rejected the settings; `ask`: more particles than allowed are expected;
 * `lost`: the worker no longer holds the particles to relax. A job whose field was refused ends with that answer. A
 * job that is replaced ends without a message.
 */
export type Outcome = 'complete' | 'stopped' | 'refused' | 'ask' | 'lost';
export interface ColumnsMessage extends ColumnRange {
  type: 'columns';
  id: number;
  slotsFrom: number;
  slots: Uint32Array;
  curvatureFrom: number;
  /** empty unless the page shows it */
  curvature: Float32Array;
  /** null unless the page draws it and the run is over */
  mesh: Mesh | null;
  progress: CoreProgress | null;
}
/** The positions before each relaxation step of the run, or before the first alone where there are many particles. */
export type PastMessage = { type: 'past'; id: number; positions: Float32Array[] };
export interface DoneMessage {
  type: 'done';
  id: number;
  outcome: Outcome;
  progress: CoreProgress | null;
  seconds: Seconds;
  /** particles expected at the start, 0 when unknown */
  predicted: number;
  /** whether the particles are those of the run before, which have followed the surface */
  followed: boolean;
  /** words for `refused`, else empty */
  message: string;
  reportFollows: boolean;
}
/** What the particles of a run that has ended were made from; none of particles that have followed a surface. */
export type RecordMessage = { type: 'record'; id: number; record: FileRecord };
/** `own`: the columns of the colours that the surface has, by their names. */
export type ReportMessage = { type: 'report'; id: number; report: Report; own: Record<string, Float32Array> } & Figures;
export type LoadFault = import('../bundle/types.js').LoadFault;
export type FromWorker =
  | { type: 'ready'; description: Description }
  | { type: 'failed'; fault: LoadFault; message: string }
  | { type: 'beat' }
  | { type: 'number'; request: number; value: number | null }
  | { type: 'code'; request: number; answer: CodeAnswer }
  | { type: 'fault'; request: number; fault: string | null }
  | { type: 'value'; id: number; values: Float32Array; fault: string | null }
  | { type: 'field'; id: number; answer: FieldAnswer }
  | { type: 'dropped'; id: number }
  | { type: 'box'; id: number; answer: FieldOk }
  | { type: 'started'; id: number; radius: number; predicted: number; warnings: Report['warnings'] }
  | { type: 'progress'; id: number; progress: ToldProgress }
  | ColumnsMessage
  | PastMessage
  | DoneMessage
  | RecordMessage
  | ReportMessage
  | { type: 'file'; request: number; bytes: Uint8Array<ArrayBuffer> | null }
  | { type: 'section'; request: number; values: Float32Array | null }
  | { type: 'faces'; request: number; mesh: MeshFaces | null }
  | { type: 'opening' }
  | { type: 'making'; id: number; fraction: number }
  | { type: 'open_progress'; request: number; label: string; fraction: number }
  | { type: 'opened'; request: number; opened: Opened }
  | { type: 'change'; id: number; change: MeshChange }
  | { type: 'measured'; request: number; measures: PlacedMeasures }
  | { type: 'measured'; request: number; error: FieldFault }
  | { type: 'crashed'; id: number; message: string; stack: string };
/**
 * The stage of a run. `seeding`: none of its particles is on the page; `growing`: some are; `measuring`: all are,
 * and the report is pending; `over`: the run has ended.
 */
export type Stage = 'seeding' | 'growing' | 'measuring' | 'over';
/**
 * What the page knows of a job that it sent to the worker. `bounds` is the clip box of its field, known once the field
 * is accepted, and final once the box is found. `sinceMs` is when it was sent, or when the job before it ended.
 */
export type Run = { id: number; job: Job; bounds: Bounds | null; stage: Stage; sinceMs: number };
/** The job whose particles are on the page, and whether their report has arrived. */
export type Shown = { job: SampleJob; reported: boolean };
/** What the page knows of its runs: those asked wait at the worker, and one is current. */
export interface Ledger {
  /** id of the run sent last, 0 before the first */
  lastId: number;
  /** runs whose field has not been answered yet, in the order sent */
  asked: readonly Run[];
  /** the run whose messages count: the last one whose field was accepted */
  current: Run | null;
  /** the run whose particles the worker holds, 0 for none */
  held: number;
  /** the last sampling that the core accepted */
  accepted: SampleJob | null;
  shown: Shown | null;
  /**
   * The surface that stood before that of a trial, a formula that is still being typed. It comes back if what is typed
   * in the end has no surface or a mistake. It is forgotten once the formula is a trial no longer.
   */
  stood: Shown | null;
  /** whether the surface on the page differs from the one requested last */
  astray: boolean;
  /** when a run ended last */
  endedMs: number;
  /** id of the last run sent before a stop; no run up to it continues, and none follows from it */
  stoppedUpTo: number;
  /** the input on which the worker crashed last, from {@link inputOf} */
  crashedInput: string;
}
/**
 * The events. `committed`: the formula that was asked for last is a trial no longer; `particles`: the first particles
 * of the current run have arrived; `lost`: the worker and its jobs are gone; `crashed`: the worker failed on `input`,
 * which is sent `again` or given up.
 */
export type LedgerEvent =
  | { type: 'sent'; job: Job; nowMs: number }
  | { type: 'accepted'; id: number; bounds: Bounds }
  | { type: 'boxed'; bounds: Bounds }
  | { type: 'refused'; id: number }
  | { type: 'dropped'; id: number }
  | { type: 'particles'; description: Description | null }
  | { type: 'done'; outcome: Outcome; particles: number; reportFollows: boolean; nowMs: number }
  | { type: 'reported' }
  | { type: 'committed' }
  | { type: 'stopped' }
  | { type: 'lost' }
  | { type: 'crashed'; input: string; again: boolean }
  | { type: 'revived' };

/** The worker's events, as its client passes them on. */
export interface ClientOptions {
  spawn: () => WorkerLike;
  onMessage: (message: FromWorker) => void;
  /** the old worker is gone and the new one is loading */
  onRestart: (crash: Crash) => void;
  /** no worker until `revive()` */
  onSafeMode: (crash: Crash) => void;
  onLoadFailed: (text: string) => void;
  clock?: Clock;
}
export interface Env extends WorkerEnv<FromWorker> {
  interrupt: () => 'stop' | 'replace' | null;
  /** whether the page shows the curvature */
  curvature: () => boolean;
  /** whether the page draws a mesh */
  mesh: () => boolean;
  /** whether the page has drawn the columns sent so far */
  room: () => boolean;
}
/** The part of a job's surroundings that the work after a run uses. */
export type AfterEnv = Pick<Env, 'nowMs' | 'pause' | 'post' | 'interrupt'>;
/**
 * What the worker holds: the id of the run whose particles the core has, 0 for none, and of the run whose mesh the page
 * has. `gaveUp`: the joining of the mesh over the particles `meshed` was stopped.
 */
export type Memory = { held: number; meshed: number; gaveUp: boolean };
/** The part of the viewer that the presenter uses. */
export interface PictureLike {
  /** a new surface replaces the old one */
  begin: (options: { grow: boolean; fit: boolean; bounds: Bounds | null; meets?: boolean }) => void;
  /** columns of particles first … last are new */
  changed: (first: number, last: number, onDrawn: () => void) => void;
  /** the columns have positions of earlier relaxation steps */
  remembered: () => void;
  /** the columns have another mesh */
  meshed: () => void;
  /** colours of particles first … last may have changed */
  recolour: (from: number, last: number) => void;
  fit: () => void;
  dim: (dim: boolean) => void;
}
export type WorkerLike = import('../bundle/types.js').WorkerLike<ToWorker, FromWorker>;
export type Crash = { cause: 'panic' | 'hang'; message: string; stack: string; restarts: number };
export type Clock = Timers & { now: () => number };
/** What the state may name in the place of a formula: models, which are solved first, and files, which are opened. */
export interface Models {
  /** the key of the state's model or file; undefined for a formula */
  key: () => string | undefined;
  /** whether the state can be sampled now */
  ready: () => boolean;
  /** returns the state, but with the previous surface while its model is loading */
  present: () => State;
  /** starts solving the state's model and samples it once it is solved */
  load: (kind?: SampleKind) => void;
  /** the state's surface is now being sampled */
  settled: () => void;
  solved: (key: string) => Given | undefined;
  /** of the model that is being solved; else empty */
  orderKey: string;
  cancel: () => void;
}
export interface SamplerOptions {
  store: Store;
  columns: Columns;
  picture: PictureLike;
  models: Models;
  spawn: () => WorkerLike;
  /** called when the description has arrived for the first time */
  onReady: () => void;
  clock?: Clock;
}
/**
 * What a run differs in from that of the state. `settings` stand in the place of the state's; `pulled`: points that the
 * surface is to pass through, and the parameters that are changed for it.
 */
export interface Change {
  kind?: SampleKind;
  settings?: Settings;
  pulled?: Required<Pick<FieldRequest, 'parameters' | 'pins'>>;
}
