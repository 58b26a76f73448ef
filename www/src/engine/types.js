/**
 * Types of the engine: the core's description, the values of the engine's signals, and the arguments of its commands.
 *
 * The file has JSDoc types and a few constants. Import a type with `@import { State } from './types.js'`.
 * Lengths are in the field's own coordinates, angles in radians (`…_rad`), pixels are CSS pixels unless a name says
 * otherwise.
 *
 * @module
 */

/**
 * @import { Columns } from './columns.js'
 * @import { Answer, Phase as CorePhase, PointsFault, PointsProgress } from './core-types.js'
 * @import { Start } from './core-types.js'
 * @import { Surface } from './lesson/protocol.js'
 */

/**
 * @template T
 * @typedef {import('@preact/signals-core').Signal<T>} Signal
 */
/**
 * @template T
 * @typedef {import('@preact/signals-core').ReadonlySignal<T>} ReadonlySignal
 */

/** @typedef {[number, number, number]} Vec3 */

// ---- what the core says and is told: written from its own types (core-types.d.ts)
// ---------------------------------------

/** @typedef {import('./core-types.js').Bounds} Bounds */
/** @typedef {import('./core-types.js').Parameter} Parameter */
/** @typedef {import('./core-types.js').Description} Description */
/** @typedef {import('./core-types.js').Limits} Limits */
/** One entry of the gallery. @typedef {import('./core-types.js').SurfaceEntry} SurfaceInfo */
/**
 * One setting of the sampler; the interface builds its control from this.
 * @typedef {import('./core-types.js').Setting} SettingInfo
 */
/**
 * One row of the report; its keys are paths into {@link Report}, such as `quality.six`.
 * @typedef {import('./core-types.js').ReportRow} ReportRow
 */
/**
 * A built-in model from points. Its `id` goes where a gallery surface's does.
 * @typedef {import('./core-types.js').Model} PointModel
 */
/** What is known of a model from points once it is solved. @typedef {import('./core-types.js').ModelInfo} ModelInfo */
/** What goes with a solved system to the core. @typedef {import('./core-types.js').SolvedModel} SolvedModel */
/** @typedef {import('./core-types.js').MathNode} MathNode */
/** @typedef {import('./core-types.js').Fault} FieldFault */
/** What one step of the core answers. @typedef {import('./core-types.js').Progress} CoreProgress */
/** @typedef {CoreProgress['stop_reason']} StopReason  null while the run goes on */
/** The figures of a finished run. @typedef {import('./core-types.js').Report} CoreReport */
/** What a mesh adds up to. @typedef {import('./core-types.js').MeshAnswer} MeshAnswer */
/** @typedef {import('./core-types.js').LessonEvent} LessonEvent */
/** @typedef {import('./core-types.js').LessonIterate} LessonIterate */
/** @typedef {import('./core-types.js').LessonPush} LessonPush */
/** @typedef {import('./core-types.js').LessonChapter} LessonChapter */
/** @typedef {import('./core-types.js').LessonSettings} LessonSettings */
/** @typedef {import('./lesson/client.js').LessonClient} LessonClient */
/** @typedef {import('./lesson/protocol.js').Particles} LessonParticles */
/**
 * A mesh over all particles on the page, three indices a triangle.
 * @typedef {{triangles: Uint32Array, about: MeshAnswer}} Mesh
 */

/**
 * @template T
 * @typedef {Answer<T, FieldFault>} CoreAnswer
 */
/** @typedef {CoreAnswer<import('./core-types.js').FieldAnswer>} FieldAnswer */
/**
 * @typedef {Extract<FieldAnswer, {ok: true}>} FieldOk  `surface` is of a model its id, of a file {@link FILE_SURFACE}
 */
/** @typedef {CoreAnswer<Start>} StartAnswer */
/**
 * @template T
 * @typedef {Answer<T, PointsFault>} SolverAnswer
 */
/** @typedef {SolverAnswer<PointsProgress>} PointsAnswer */
/** @typedef {SolverAnswer<SolvedModel>} SolvedAnswer */

// ---- what the page adds to it
// ------------------------------------------------------------------------------------------

/**
 * `points` names a solved model; with it only the clip box counts.
 * @typedef {Partial<import('./core-types.js').FieldRequest> & {points?: string}} FieldRequest
 */
/** By the settings' names; a missing one has its default. @typedef {Record<string, number | string>} Settings */
/**
 * The progress of the present run, as the page shows it. `phase` has one more value than in the core, `quality`: the
 * quality figures are being computed.
 * @typedef {Omit<CoreProgress, 'phase'> & {phase: CorePhase | 'quality', run: number, live: boolean}} Progress
 */
/** @typedef {{seeding: number, generation: number, refinement: number, relaxation: number, quality: number}} Seconds */
/** A report with what the worker measured. @typedef {CoreReport & {seconds: Seconds}} Report */

// ---- the shareable state
// ----------------------------------------------------------------------------------------------

/** @typedef {ViewState['grain']} Grain */
/** @typedef {import('./core-types.js').ColourMode} ColourMode */
/**
 * The camera: the eye is on a sphere around `target`, with z up. With `fit` the engine sets target and distance so that
 * the camera follows the surface. A zoom or pan by the user ends that, and the fit command starts it again.
 * @typedef {{target: Vec3, distance: number, yaw: number, pitch: number, fit: boolean}} CameraState
 */
/** The options of the view. @typedef {import('./share/view.js').ViewState} ViewState */
/**
 * A plane that hides the part of the picture that its unit normal points to: all p with normal · p > offset. Nothing is
 * sampled anew.
 * @typedef {{normal: Vec3, offset: number}} CuttingPlane
 */
/**
 * The whole shareable state, as plain JSON. `surface` is the gallery entry on which the formula is based, and `formula`
 * is the text in the editor. `parameters` and `settings` hold only values that differ from the defaults. If `surface`
 * is a model's id, or {@link FILE_SURFACE} for the file opened last, `formula` is empty; a formula typed then is based
 * on the default surface. The points of a file are not in the state, so a link to a file shows the default surface.
 * @typedef {object} State
 * @property {1} v
 * @property {string} surface
 * @property {string} formula
 * @property {Record<string, number>} parameters
 * @property {Parameter[]} declared
 * @property {number | null} centres  how many of the points of a model or a file are fitted; null for the default
 *   number, and for a formula
 * @property {Bounds | null} bounds  null: the surface's own box, or one that fits the formula
 * @property {CuttingPlane | null} plane
 * @property {Settings} settings
 * @property {ViewState} view
 */

/**
 * The part of the state that can be undone: what is sampled and how, and where it is cut open, without the view.
 * @typedef {Omit<State, 'v' | 'view'>} Shape
 */

// ---- what the engine reports
// ------------------------------------------------------------------------------------------

/** @typedef {'starting' | 'webgpu' | 'webgl2' | 'canvas2d'} BackendName */
/**
 * A message for the user. `id` names its cause (`panic`, `hang`, `safe-mode`, `device-lost`, `link`, `load`, `size`,
 * `file`, `share-file`, …); a later notice of the same cause replaces it, and it is removed when it no longer applies.
 * `details` is a report for the user to copy.
 * @typedef {object} Notice
 * @property {string} id
 * @property {'info' | 'warn' | 'error'} kind
 * @property {string} text
 * @property {string} [details]
 * @property {{label: string, run: () => void}} [action]
 */
/**
 * The particle under the pointer, or the tapped one. x and y are CSS pixels within the canvas host. `residual`,
 * `nearest` and `valence` are null until the report of the run has arrived.
 * @typedef {object} Hover
 * @property {number} index
 * @property {number} level
 * @property {number | null} parent  null for a seed
 * @property {Vec3} position
 * @property {Vec3} normal
 * @property {number} radius
 * @property {number | null} residual
 * @property {number | null} valence
 * @property {number | null} nearest
 * @property {number} x
 * @property {number} y
 * @property {boolean} tapped  it was pressed and stays until the next press, instead of following the pointer
 */
/**
 * Where a place is in the picture: x and y are CSS pixels within the canvas host, `perPx` is the length in the field's
 * coordinates that is one pixel long there, across the line of sight.
 * @typedef {{x: number, y: number, perPx: number}} Spot
 */
/**
 * A place to be pointed out: the positions that are marked by rings of this radius, the direction from which they are
 * seen, and what stands beside them.
 * @typedef {{places: Vec3[], radius: number, normal: Vec3, text: string}} Place
 */
/** A ray from the eye; the direction has length 1. @typedef {{eye: Vec3, direction: Vec3}} Ray */
/** @typedef {{label: string, colour: string, count?: number}} LegendEntry  colour is `#rrggbb` */
/**
 * The legend of the colours. `colours` are `#rrggbb`: the cycle, or the samples of the ramp from `range[0]` to
 * `range[1]`. A diverging ramp has 0 in its middle; values outside its range have the colour of its end. `entries` name
 * categories. `pending` is set while the figures behind the colours are being computed.
 * @typedef {object} Legend
 * @property {string} title
 * @property {string} unit
 * @property {'cyclic' | 'categories' | 'sequential' | 'diverging' | 'plain' | 'normal'} kind
 * @property {LegendEntry[]} [entries]
 * @property {[number, number]} [range]
 * @property {number} [mark]  a value with a tick on the ramp, such as the ideal distance 2r
 * @property {string[]} colours
 * @property {boolean} [pending]
 */
/**
 * The times in seconds of the sampling and of its parts. With `steps` above 0 they are those of so many relaxation
 * steps alone, which were made after it.
 * @typedef {{steps: number, sampling: number, total: number, seconds: Seconds, us_per_particle: number, particles:
 *   number, live: boolean}} Timing
 */
/**
 * Measurements of the last slider drag: the runs requested and shown, and the median time from a request to its
 * picture.
 * @typedef {{requested: number, shown: number, latency_ms: number, particles: number, coarse: boolean}} LastDrag
 */

/**
 * The progress of the reveal of a new run: its particles appear level by level, slowly enough to be followed.
 * @typedef {{level: number, levels: number, particles: number}} Reveal
 */

/**
 * The progress of loading a model or a file. `label` is the core's name of the stage.
 * @typedef {object} Loading
 * @property {string} id  of the model, or {@link FILE_SURFACE}
 * @property {string} name
 * @property {'starting' | 'reading' | 'thinning' | 'normals' | 'solving'} stage
 * @property {string} label
 * @property {number} fraction  0 … 1 of the whole process
 */
/**
 * An error in loading a model or a file. The previous surface stays.
 * @typedef {object} LoadingError
 * @property {string} id
 * @property {string} name
 * @property {string} kind  the core's kind of error, or `too_large`, `unreadable`, `crashed`, `silent`, `bundle`
 * @property {string} message  with the line number, if there is one
 * @property {number | null} line  from 1
 */

/**
 * @typedef {object} EngineSignals
 * @property {ReadonlySignal<State>} state
 * @property {ReadonlySignal<Description | null>} description  null until the core has loaded
 * @property {ReadonlySignal<FieldOk | null>} field  the last good field
 * @property {ReadonlySignal<FieldFault | null>} fieldError  the error in the present formula
 * @property {ReadonlySignal<Progress>} progress
 * @property {ReadonlySignal<Report | null>} report  null while stale
 * @property {ReadonlySignal<Timing | null>} timing
 * @property {ReadonlySignal<BackendName>} backend
 * @property {ReadonlySignal<string>} adapter  name of the graphics adapter, may be empty
 * @property {ReadonlySignal<Notice | null>} notice
 * @property {ReadonlySignal<MeshAnswer | null>} mesh  of the mesh drawn; null while there is none
 * @property {ReadonlySignal<Hover | null>} hover
 * @property {ReadonlySignal<Place | null>} spot  the place that was pointed out last; null once it no longer applies
 * @property {ReadonlySignal<Legend | null>} legend
 * @property {ReadonlySignal<number>} revision  increases whenever the particles, their fates or their figures change
 * @property {Columns} columns  the particles, read-only
 * @property {ReadonlySignal<Reveal | null>} reveal  null while nothing is being revealed
 * @property {ReadonlySignal<boolean>} busy  whether a run is active and can be stopped
 * @property {ReadonlySignal<boolean>} partial  whether the picture shows a run that was stopped or capped
 * @property {ReadonlySignal<boolean>} empty  whether the last run found no surface
 * @property {ReadonlySignal<LastDrag | null>} lastDrag
 * @property {ReadonlySignal<number>} frame  increases with every picture drawn, after which places may have moved in it
 * @property {ReadonlySignal<'light' | 'dark'>} theme  the effective theme, after `auto` is resolved
 * @property {ReadonlySignal<Loading | null>} loading  the model or file that is loading
 * @property {ReadonlySignal<LoadingError | null>} loadingError  null once another surface is chosen; a notice `file`
 *   has the same message
 * @property {ReadonlySignal<ModelInfo | null>} model  of the surface shown; null for a formula
 */
/**
 * @typedef {object} EngineCommands
 * @property {(id: string) => void} setSurface  a gallery surface, a built-in model, or {@link FILE_SURFACE} to return
 *   to the file opened last
 * @property {(file: File) => Promise<void>} openFile  samples the points of a file; resolves once it is sampled,
 *   refused or cancelled
 * @property {(count: number) => void} setCentres  fits another number of the points of the present model or file
 * @property {() => void} cancelLoading  cancels the model or file that is loading
 * @property {(text: string, options?: {unfinished?: boolean}) => void} setFormula  `unfinished`: the text is sampled
 *   only after a pause, or with the next change
 * @property {(name: string, value: number, options?: {live?: boolean}) => void} setParameter  `live` during a drag;
 *   call once more without it at the end
 * @property {(name: string) => void} resetParameter  restores the value of the gallery or of the declaration
 * @property {(name: string) => void} declareParameter  declares an unknown name of the formula as a parameter
 * @property {(bounds: Bounds | null, options?: {live?: boolean}) => void} setBounds
 * @property {(plane: CuttingPlane | null) => void} setPlane  the normal may have any length but 0
 * @property {() => void} fitBox  takes the box of the gallery surface back, or fits it to the formula
 * @property {(name: string, value: number | string, options?: {live?: boolean}) => void} setSetting
 * @property {(name: string) => void} resetSetting
 * @property {(shape: Shape) => void} restore  restores an earlier state, without the view
 * @property {() => void} run  samples from the start; does nothing during a run of the same input
 * @property {() => void} stop  stops the run and keeps the partial result
 * @property {() => void} generateOnly  starts a run without relaxation
 * @property {(steps: number) => void} relax  relaxes the present particles by that many steps
 * @property {(patch: Partial<ViewState>) => void} setView
 * @property {() => void} fit
 * @property {(place: Place | null, options?: {turns?: boolean}) => void} pointOut  marks a place, or none, and brings
 *   it before the camera unless `turns` is false
 * @property {(count: number | null) => void} showFirst  draws only so many particles, the first ones; null for all
 * @property {(normal: Vec3) => void} turnTo  turns the camera to a side of the surface, unless that side is seen
 *   already
 * @property {() => void} dismissHover  no particle is chosen any more, even if it was pressed
 * @property {(factor: number) => void} zoom  > 1 zooms in
 * @property {(dxRad: number, dyRad: number) => void} orbit
 * @property {(insets: {left: number, right: number, top: number, bottom: number}) => void} setInsets  pixels of the
 *   canvas host covered by panels; the surface is centred in the rest
 * @property {() => Promise<string>} link  the state as the fragment of an address, with `#`; empty for the default
 *   state. Not before the core has loaded
 * @property {(link: string, options?: {initial?: boolean, patch?: object}) => Promise<void>} openLink  adopts the state
 *   of such a fragment with what `patch` changes; `initial`: what cannot be read is the default state
 * @property {(patch: Record<string, unknown>) => string[]} set  changes a part of the state and samples; returns what
 *   of it was not valid, in words
 * @property {(options?: {width?: number, height?: number, transparent?: boolean}) => Promise<ImageData>} picture
 *   without panels; the surface fills its shorter side as it fills that of the window
 * @property {(options?: {width?: number, height?: number, transparent?: boolean}) => Promise<Blob>} savePng
 * @property {(format: 'ply' | 'csv') => Promise<Blob>} exportFile
 * @property {(format: MeshFormat) => Promise<Blob>} exportMesh  once no run is left
 * @property {() => void} dismissNotice
 * @property {(x: number, y: number) => number | null} pick  returns the index of the particle under a point of the
 *   canvas host
 * @property {(place: ArrayLike<number>) => Spot | null} project  returns where a place is in the picture; null behind
 *   the eye
 * @property {(x: number, y: number) => Ray} rayThrough  returns the ray from the eye through a point of the canvas host
 * @property {(options?: ConstructorParameters<typeof import('./lesson/client.js').LessonClient>[0]) =>
 *   Promise<import('./lesson/client.js').LessonClient>} openLesson  the paper's algorithms, event by event; its worker
 *   and its bundle are loaded with the first run
 * @property {() => Surface | null} lessonSurface  returns the present surface for such a run
 * @property {() => void} destroy  frees all that the engine holds: its workers, its device and its canvas
 */
/** File formats for a mesh. @typedef {'glb' | 'obj' | 'stl' | 'ply'} MeshFormat */
/**
 * What tests need of an engine.
 * @typedef {object} EngineDebug
 * @property {(fault: 'panic' | 'overflow' | 'hang') => void} provoke  traps the core in its worker, overflows the
 *   worker's stack, or sends it into an endless loop
 * @property {(reason?: string) => void} loseDevice
 * @property {(id: number) => void} stale  delivers a message of another run
 * @property {() => Promise<void>} still  resolves once the picture stands still and the state has the camera
 * @property {() => boolean} isOff  whether no sampler is there or coming
 * @property {() => {frames: number, uploads: number, opened: number, restarts: number, stale: number, dimmed: boolean}}
 *   counts
 */
/** @typedef {EngineSignals & EngineCommands & {debug: EngineDebug}} Engine */

/** Value of `State.surface` for a surface from a file. */
export const FILE_SURFACE = 'file';
/** Disc radius as a share of the repulsion radius. */
export const DISC_SIZE = { initial: 0.92, min: 0.2, max: 1.5, step: 0.01 };
/** Size of the largest file that is read. */
export const LARGEST_FILE_BYTES = 50e6;
/** File extensions that `openFile` reads, for the `accept` attribute of a file chooser. */
export const FILE_TYPES = '.ply,.obj,.stl,.xyz,.txt';
