/**
 * Types of the engine: the core's description, the values of the engine's signals, and the arguments of its commands.
 *
 * The file has JSDoc types and a few constants. Import a type with `@typedef {import('./types.js').State} State`.
 * Lengths are in the field's own
 * coordinates, angles in radians (`…_rad`), pixels are CSS pixels unless a name says otherwise.
 *
 * @module
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
/** @typedef {{min: Vec3, max: Vec3}} Bounds */
/** @typedef {{name: string, label: string, value: number, min: number, max: number, step: number}} Parameter */

// ---- what the core describes ------------------------------------------------------------------------------------------

/**
 * One entry of the gallery.
 * @typedef {object} SurfaceInfo
 * @property {string} id
 * @property {string} name
 * @property {string} formula
 * @property {Parameter[]} parameters
 * @property {Bounds} bounds
 * @property {number | null} degree
 * @property {number | null} genus
 * @property {string} story
 */
/**
 * One setting of the sampler; the interface builds its control from this.
 * @typedef {object} SettingInfo
 * @property {string} name
 * @property {string} label
 * @property {string} group
 * @property {'number' | 'integer' | 'choice'} kind
 * @property {number | string} default
 * @property {number} min
 * @property {number} max
 * @property {number} step
 * @property {'linear' | 'log'} scale
 * @property {string} unit
 * @property {{value: string, label: string}[]} [choices]
 * @property {string} help
 * @property {{name: string, value: string, equal?: boolean}[]} [when]  conditions of visibility: each other setting
 *   must have the value, or, with `equal` false, must not have it
 */
/**
 * One row of the report. `key` is a path into {@link Report}, for example `quality.six`. A null value there means that
 * the figure does not apply to the run.
 * @typedef {object} ReportRow
 * @property {string} key
 * @property {string | null} [unless]  path of a figure that replaces this one if it exists
 * @property {string | null} [to]  path of the upper end of a range whose lower end is `key`
 * @property {string} label
 * @property {string} group
 * @property {string} unit
 * @property {number} digits
 * @property {string} ideal
 * @property {'higher' | 'lower' | null} better
 * @property {string} help
 */
/**
 * A built-in model from points. Its `id` is used like that of a gallery surface.
 * @typedef {object} PointModel
 * @property {string} id
 * @property {string} name
 * @property {string} story
 * @property {string} credit  source of the points; may be empty
 * @property {number} points
 */
/**
 * The facts about a solved model from points.
 * @typedef {object} ModelInfo
 * @property {string} name  name of the built-in model or of the file
 * @property {string} credit
 * @property {number} points  number of points read
 * @property {number} centres  number of points that the field interpolates
 * @property {number} condition  estimate of the condition number of the system
 * @property {number} residual_mean  mean distance of all points from the surface, as a share of the diagonal of their box
 * @property {number} residual_max
 * @property {'given' | 'from_mesh' | 'estimated'} normals
 * @property {string[]} warnings
 */
/**
 * The core's description, from which the interface is generated.
 * @typedef {object} Description
 * @property {string} version
 * @property {string} default_surface
 * @property {SurfaceInfo[]} surfaces
 * @property {PointModel[]} models
 * @property {SettingInfo[]} settings
 * @property {ReportRow[]} report
 * @property {{name: string, label: string, help: string}[]} fates
 * @property {{name: string, signature: string, help: string}[]} functions
 * @property {{id: string, label: string, help: string, unit: string}[]} colours
 */

/**
 * A field to set in the core. `points` names a solved model; with it, only the clip box is used besides.
 * @typedef {object} FieldRequest
 * @property {string} [points]
 * @property {string} [surface]
 * @property {string} [formula]
 * @property {Record<string, number>} [parameters]
 * @property {Parameter[]} [declare]
 * @property {Bounds} [bounds]
 */
/**
 * A MathML element with its text or its children.
 * @typedef {{tag: 'mi' | 'mn' | 'mo', text: string}
 *   | {tag: 'mrow' | 'mfrac' | 'msup' | 'msub' | 'msqrt' | 'mroot', children: MathNode[]}} MathNode
 */
/**
 * @typedef {object} FieldOk
 * @property {true} ok
 * @property {'formula' | 'points'} kind
 * @property {ModelInfo | null} model  for points
 * @property {string | null} surface  id of the gallery surface or model, {@link FILE_SURFACE} for a file; null once the
 *   formula differs from the gallery's
 * @property {string} formula  empty for points
 * @property {Parameter[]} parameters
 * @property {string[]} auto  parameters that were declared automatically
 * @property {Bounds} bounds
 * @property {MathNode | null} mathml  null for points
 */
/**
 * Offsets are UTF-16 code units into the formula, as a textarea's selection uses them.
 * @typedef {object} FieldFault
 * @property {string} kind
 * @property {string} message
 * @property {number} start
 * @property {number} end
 * @property {string | null} suggestion
 * @property {string[]} names  names that can be declared as parameters
 */
/** @typedef {{ok: false, error: FieldFault}} FieldError */
/** @typedef {FieldOk | FieldError} FieldAnswer */

/** The data that accompany a solved system. @typedef {{info: ModelInfo, bounds: Bounds}} SolvedModel */
/** @typedef {{radius: number, predicted_count: number, area: number, warnings: string[]}} Start */
/** @typedef {({ok: true} & Start) | {ok: false, error: FieldFault}} StartAnswer */
/** @typedef {{kind: string, message: string, line: number | null}} PointsFault */
/** @typedef {{stage: 'reading' | 'thinning' | 'normals' | 'solving' | 'done', label: string, fraction: number, done: boolean}} PointsProgress */
/** @typedef {({ok: true} & PointsProgress) | {ok: false, error: PointsFault}} PointsAnswer */
/** @typedef {({ok: true} & SolvedModel) | {ok: false, error: PointsFault}} SolvedAnswer */

/** @typedef {Record<string, number | string>} Settings  by name; a missing setting has its default */
/** @typedef {'idle' | 'seeding' | 'pilot' | 'generation' | 'search' | 'relaxation' | 'done'} CorePhase */
/** @typedef {null | 'complete' | 'cancelled' | 'cap' | 'no_surface' | 'constant' | 'undefined' | 'one_particle'} StopReason */

/**
 * The result of one step of the core.
 * @typedef {object} CoreProgress
 * @property {CorePhase} phase
 * @property {number} particles
 * @property {number} level
 * @property {number} relax_step
 * @property {number} relax_steps
 * @property {number} evaluations
 * @property {number} fraction  0 … 1
 * @property {StopReason} stop_reason
 * @property {string | null} message
 * @property {number} radius
 * @property {boolean} moved  whether columns of existing particles have changed since the last step
 */
/**
 * The progress of the present run, as the page shows it. `phase` has one more value than in the core, `quality`: the
 * quality figures are being computed.
 * @typedef {Omit<CoreProgress, 'phase'> & {phase: CorePhase | 'quality', run: number, live: boolean}} Progress
 */

/**
 * @typedef {object} Quality
 * @property {number} d_hex
 * @property {number} area
 * @property {number} err_max
 * @property {number} err_mean
 * @property {number} nn_min
 * @property {number} nn_mean
 * @property {number} nn_cv
 * @property {number} nn_ratio
 * @property {number} rho
 * @property {number} rho_1
 * @property {number} cover
 * @property {number} quant
 * @property {number} six
 * @property {number} five_seven
 * @property {number} val_sd
 * @property {number} open
 * @property {number} psi6
 * @property {number} tri_ok
 * @property {number} agree
 * @property {number} euler
 * @property {number} components
 * @property {number} ang_min
 * @property {number} ang_min_mean
 * @property {number} lt30
 * @property {number} gt90
 * @property {number} edge_cv
 * @property {number} boundary_excluded
 * @property {number} size_cv
 * @property {number} cover_local
 * @property {number} overlap_min
 */
/** @typedef {{seeding: number, generation: number, relaxation: number, quality: number}} Seconds */
/**
 * The figures of a finished run.
 * @typedef {object} CoreReport
 * @property {number} count
 * @property {number} levels
 * @property {number} components_seeded
 * @property {number} radius
 * @property {number} radius_min  of the smallest particle
 * @property {number} radius_max
 * @property {number} components  number of components
 * @property {number | null} undecided_cells  cells of the box that may still hold surface; null where no proof was attempted
 * @property {number | null} singular_points  places where f has no gradient on the surface; null where none were looked for
 * @property {'proven' | 'searched'} search  whether a witness on every component is proven, or a dense search found the components
 * @property {number} evaluations
 * @property {number} evaluations_per_particle
 * @property {{added: number, matched: number, not_converged: number, outside: number, undefined: number, capped: number}} fates
 * @property {Exclude<StopReason, null>} stop_reason
 * @property {string[]} warnings
 * @property {number[]} level_counts
 * @property {number[]} energy
 * @property {string} digest
 * @property {Quality | null} quality
 * @property {Quality | null} quality_before  after the front, before relaxation
 * @property {{min: number, max: number, bins: number[]}} nearest_histogram
 */
/** The report with the times that the worker has measured. @typedef {CoreReport & {seconds: Seconds}} Report */

// ---- the shareable state ----------------------------------------------------------------------------------------------

/** @typedef {'level' | 'fate' | 'valence' | 'nearest' | 'radius' | 'curvature' | 'component' | 'normal' | 'plain'} ColourMode */
/**
 * The camera: the eye is on a sphere around `target`, with z up. With `fit` the engine sets target and distance so that
 * the camera follows the surface. A zoom or pan by the user ends that, and the fit command starts it again.
 * @typedef {{target: Vec3, distance: number, yaw: number, pitch: number, fit: boolean}} CameraState
 */
/**
 * @typedef {object} ViewState
 * @property {ColourMode} colour
 * @property {number} size  disc radius as a share of the repulsion radius, 0.2 … 1.5; 0.92 by default
 * @property {'auto' | 'light' | 'dark'} theme
 * @property {boolean} box  whether the clip box is drawn
 * @property {boolean} points  whether the points that a model interpolates are drawn
 * @property {number | null} level  the newest generation level drawn, null for all of them; a level beyond the last counts as the last
 * @property {CameraState} camera
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
 * @property {Bounds | null} bounds  null: the surface's own box
 * @property {Settings} settings
 * @property {ViewState} view
 */

/**
 * The part of the state that determines what is sampled and how, without the view.
 * @typedef {Omit<State, 'v' | 'view'>} Shape
 */

// ---- what the engine reports ------------------------------------------------------------------------------------------

/** @typedef {'starting' | 'webgpu' | 'webgl2' | 'canvas2d'} BackendName */
/**
 * A message for the user. `id` names its cause (`panic`, `hang`, `safe-mode`, `device-lost`, `link`, `load`, `size`,
 * `file`,
 * `share-file`, …); a later notice of the same cause replaces it, and it is removed when it no longer applies.
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
 */
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
/** @typedef {{total: number, seconds: Seconds, us_per_particle: number, particles: number, live: boolean}} Timing */
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
 * @property {ReadonlySignal<Hover | null>} hover
 * @property {ReadonlySignal<Legend | null>} legend
 * @property {ReadonlySignal<number>} revision  increases whenever the particles, their fates or their figures change
 * @property {import('./columns.js').Columns} columns  the particles, read-only
 * @property {ReadonlySignal<Reveal | null>} reveal  null while nothing is being revealed
 * @property {ReadonlySignal<boolean>} busy  whether a run is active and can be stopped
 * @property {ReadonlySignal<boolean>} partial  whether the picture shows a run that was stopped or capped
 * @property {ReadonlySignal<boolean>} empty  whether the last run found no surface
 * @property {ReadonlySignal<LastDrag | null>} lastDrag
 * @property {ReadonlySignal<'light' | 'dark'>} theme  the effective theme, after `auto` is resolved
 * @property {ReadonlySignal<Loading | null>} loading  the model or file that is loading
 * @property {ReadonlySignal<LoadingError | null>} loadingError  null once another surface is chosen; a notice `file`
 *   has the same message
 * @property {ReadonlySignal<ModelInfo | null>} model  of the surface shown; null for a formula
 */
/**
 * @typedef {object} EngineCommands
 * @property {(id: string) => void} setSurface  a gallery surface, a built-in model, or {@link FILE_SURFACE} to return to the file opened last
 * @property {(file: File) => Promise<void>} openFile  samples the points of a file; resolves once it is sampled,
 *   refused or cancelled
 * @property {() => void} cancelLoading  cancels the model or file that is loading
 * @property {(text: string, options?: {unfinished?: boolean}) => void} setFormula  `unfinished`: the text is sampled
 *   only after a pause, or with the next change
 * @property {(name: string, value: number, options?: {live?: boolean}) => void} setParameter  `live` during a drag;
 *   call once more without it at the end
 * @property {(name: string) => void} resetParameter  restores the value of the gallery or of the declaration
 * @property {(name: string) => void} declareParameter  declares an unknown name of the formula as a parameter
 * @property {(bounds: Bounds | null, options?: {live?: boolean}) => void} setBounds
 * @property {(name: string, value: number | string, options?: {live?: boolean}) => void} setSetting
 * @property {(name: string) => void} resetSetting
 * @property {(shape: Shape) => void} restore  restores an earlier state, without the view
 * @property {() => void} run  samples from the start; does nothing during a run of the same input
 * @property {() => void} stop  stops the run and keeps the partial result
 * @property {() => void} generateOnly  starts a run without relaxation
 * @property {(steps: number) => void} relax  relaxes the present particles by that many steps
 * @property {(patch: Partial<ViewState>) => void} setView
 * @property {() => void} fit
 * @property {(factor: number) => void} zoom  > 1 zooms in
 * @property {(dxRad: number, dyRad: number) => void} orbit
 * @property {(insets: {left: number, right: number, top: number, bottom: number}) => void} setInsets  pixels of the
 *   canvas host covered by panels; the surface is centred in the rest
 * @property {() => Promise<string>} shareUrl
 * @property {(hash: string) => Promise<void>} loadUrl
 * @property {(options?: {width?: number, height?: number, transparent?: boolean}) => Promise<Blob>} savePng
 * @property {(format: 'ply' | 'csv') => Promise<Blob>} exportFile
 * @property {() => void} dismissNotice
 * @property {(x: number, y: number) => number | null} pick  returns the index of the particle under a point of the
 *   canvas host
 * @property {() => void} destroy
 */
/** @typedef {EngineSignals & EngineCommands} Engine */

/** Value of `State.surface` for a surface from a file. */
export const FILE_SURFACE = 'file';
/** Size of the largest file that is read. */
export const LARGEST_FILE_BYTES = 50e6;
/** File extensions that `openFile` reads, for the `accept` attribute of a file chooser. */
export const FILE_TYPES = '.ply,.obj,.stl,.xyz,.txt';
