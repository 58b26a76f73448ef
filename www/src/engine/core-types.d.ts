// The types of what the core, the solver for points and the lesson say and are told. Written from
// the Rust types by a test: UPDATE_GOLDEN=1 cargo test --lib page_types

/** What a command is answered: the fields of the value, or the error. */
export type Answer<T, E> = ({ ok: true } & T) | { ok: false; error: E };

/** Which bodies of a mesh a file holds. */
export type Bodies = "all" | "without_chips" | "largest";

/** A body of a mesh: a closed component with the walls of its hollows, or an open component. */
export type Body = {
  /** Area, in squared units of the coordinates. */
  area: number,
  /** Lower corner of the box around it, in the coordinates of the field. */
  min: [number, number, number],
  /** Upper corner of the box around it. */
  max: [number, number, number],
  /** Volume that it encloses, without its hollows; none if it has an open edge. */
  volume: number | null,
  /** Whether it is a loose chip: its area is less than a twentieth of the largest body's. */
  is_chip: boolean,
};

/** An axis-aligned box, in the field's coordinates. */
export type Bounds = {
  /** Smallest corner. */
  min: [number, number, number],
  /** Largest corner. */
  max: [number, number, number],
};

/** A value of a setting that is a choice. */
export type Choice = {
  /** Value, as written in JSON. */
  value: string,
  /** Name for a person. */
  label: string,
};

/** A program. */
export type Code = {
  /** Its text, which ends with a line break. */
  text: string,
};

/** A way to colour the particles. */
export type Colour = {
  /** Identifier. */
  id: ColourMode,
  /** Name for a person. */
  label: string,
  /** Explanation in one line. */
  help: string,
  /** Unit of the legend. */
  unit: string,
};

/** The quantity that colours the particles. */
export type ColourMode = "level" | "fate" | "valence" | "nearest" | "energy" | "residual" | "radius" | "curvature" | "component" | "normal" | "value" | "own" | "plain";

/** A column of PLY and CSV files, here and on the page. */
export type Column = {
  /** Name in the file. */
  name: string,
  /** Type of the values. */
  kind: ColumnKind,
};

/** Type of the values of a column, by its name in PLY. */
export type ColumnKind = "coordinate" | "float" | "int" | "uint" | "uchar";

/** Condition on another setting. */
export type Condition = {
  /** Name of the other setting. */
  name: string,
  /** A choice of the other setting. */
  value: string,
  /** Whether the other setting must have that choice, or must not have it. */
  equal: boolean,
};

/** Why particles lie at the border of the box. */
export type Cut = "endless" | "fixed" | "outgrown";

/** The whole description. */
export type Description = {
  /** Version of this crate. */
  version: string,
  /** The gallery. Its first surface is shown at the start. */
  surfaces: Array<SurfaceEntry>,
  /** The models from points. */
  models: Array<Model>,
  /** Settings of a run. */
  settings: Array<Setting>,
  /** Rows of the report. */
  report: Array<ReportRow>,
  /** The fates of a child. */
  fates: Array<Fate>,
  /** Functions of the formula language. */
  functions: Array<FunctionInfo>,
  /** Ways to colour the particles. */
  colours: Array<Colour>,
  /** Columns of PLY and CSV files. */
  columns: Array<Column>,
  /** Ways to write the vertices of mesh files, the default first. */
  vertices: Array<VerticesChoice>,
  /** Template of a new parameter, without its name. */
  new_parameter: Parameter,
  /** Largest and smallest values that the core accepts. */
  limits: Limits,
};

/** Excess of the expected particles of a run over the limit. */
export type Excess = {
  /** Expected number of particles. */
  expected: number,
  /** Largest number of particles that a run may have. */
  limit: number,
  /** Factor on all radii that keeps the run within the limit. */
  factor: number,
};

/** A fate of a child. */
export type Fate = {
  /** Name, as in the report's counts. */
  name: string,
  /** Name for a person. */
  label: string,
  /** Explanation in one line. */
  help: string,
};

/** Number of children with each fate. */
export type FateCounts = {
  /** New particles, seeds not counted. */
  added: number,
  /** Slots where an existing particle sits. */
  matched: number,
  /** Children that met no surface on the circle. */
  not_converged: number,
  /** Children outside the clip box. */
  outside: number,
  /** Children at places where the field has no value or no gradient. */
  undefined: number,
  /** Children that were not placed because the limit on particles was reached. */
  capped: number,
};

/** The error with which a command is refused. */
export type Fault = {
  /** Kind of the error. */
  kind: FaultKind,
  /** The error as a sentence for the user, in plain text. */
  message: string,
  /** Start of the mistake in the formula, in UTF-16 code units, as the selection of a text field
  * counts. */
  start: number,
  /** End of the mistake in the formula, in UTF-16 code units. */
  end: number,
  /** Text that would correct the span, if there is a good guess. */
  suggestion: string | null,
  /** Texts for the span, each with another meaning, where the formula has several readings. */
  choices: Array<string>,
  /** The formula with every mistake of this kind corrected, if there are several. */
  mended: Mended | null,
  /** The unknown name, which could become a slider. */
  name: string | null,
  /** The excess of particles, if the error is [`FaultKind::TooMany`]. */
  excess: Excess | null,
};

/** Kind of the error with which a command is refused. */
export type FaultKind = "request" | "settings" | "thickness" | "spacing" | "value" | "too_many" | "unknown_surface" | "box" | "points" | "image" | "mesh" | "no_faces" | "no_solid" | FormulaErrorKind;

/** The field as it now is. */
export type FieldAnswer = {
  /** The model, if the field is made of points; else it is a formula. */
  model: ModelInfo | null,
  /** The image, if the field is a surface of one. */
  image: ImageInfo | null,
  /** The triangle mesh, if the field is the surface of one. */
  mesh: MeshInfo | null,
  /** Gallery surface, if the formula is still its own. */
  surface: string | null,
  /** Text of the formula; empty if there is none. */
  formula: string,
  /** Parameters with values and ranges. */
  parameters: Array<Parameter>,
  /** Parameters that were not declared but found in the formula. */
  auto: Array<string>,
  /** Clip box; its faces close the solid if that is chosen. Before [`Session::fit`] or a start it
  * may still be the previous formula's box. */
  bounds: Bounds,
  /** Whether the surface, before a box closes it, is bounded, if the box was fitted to it. */
  reach: Reach | null,
  /** Period of the surface along each axis: 0 if it does not change along it, none if no period
  * is known. */
  periods: [number | null, number | null, number | null],
  /** The formula as MathML; none if there is no formula. */
  mathml: MathNode | null,
  /** Whether the surface passes through the pins of the request, and how; none without pins. */
  grip: Grip | null,
};

/** Request for a field. All members are optional. */
export type FieldRequest = {
  /** Identifier of a gallery surface to start from; without one, the present field is changed. */
  surface: string | null,
  /** Text of the formula, which replaces the surface's own. */
  formula: string | null,
  /** Values of parameters by name. */
  parameters: { [key in string]: number },
  /** Parameters that the formula's unknown names become. */
  declare: Array<Parameter>,
  /** Clip box. Without one the surface's own is used, or one is fitted (see [`Session::fit`]). */
  bounds: Bounds | null,
  /** Points that the surface should pass through; this changes parameters
  * ([`Formula::pass_through`]). */
  pins: Array<[number, number, number]>,
  /** Pulls on the surface of a model from points, one after the other. */
  pulls: Array<Pull>,
};

/** The figures of a set of particles, one number per property; NaN (null in JSON) where undefined.
* Lengths are over `ideal_spacing` unless said otherwise. JSON has all figures side by side. */
export type Figures = {
  /** Spacing of a perfect hexagonal lattice of as many points on the same area, √(2A/(√3 N)), in
  * the field's units. */
  ideal_spacing: number,
  /** Area, as given or of the triangles found, in the field's units. */
  area: number,
  /** Points that differ from an earlier one by no more than rounding; dropped before the
  * triangulation. */
  duplicates: number,
  /** Points with a non-finite coordinate; left out of everything. */
  not_finite: number,
  /** Points within 4 ideal spacings of the border of a clipped surface, left out of the per-point
  * figures. */
  boundary_excluded: number,
  /** Largest first-order distance |f|/|∇f| to the surface. */
  error_max: number,
  /** Mean first-order distance to the surface. */
  error_mean: number,
  /** Points whose residual is undefined; left out of `error_max` and `error_mean`. */
  undefined: number,
  /** Mean angle between the given normals (either sign) and ∇f, in degrees. */
  normal_error_mean: number,
  /** Largest angle between the given normals (either sign) and ∇f, in degrees. */
  normal_error_max: number,
  /** Smallest nearest-neighbour distance. */
  nearest_min: number,
  /** Mean nearest-neighbour distance. */
  nearest_mean: number,
  /** Standard deviation of the nearest-neighbour distance over its mean. */
  spacing_variation: number,
  /** Smallest over mean nearest-neighbour distance. */
  nearest_ratio: number,
  /** Normalised Poisson-disk radius: `nearest_min` under its usual name. */
  rho: number,
  /** First percentile of the nearest-neighbour distance. */
  nearest_percentile_1: number,
  /** Pairs of points closer than 0.75: over `ideal_spacing`, as `nearest_min`, or, if wanted
  * radii are known, of natural neighbours over the sum of theirs, as `overlap_min`. A duplicate
  * is a pair with the point that it equals. None if there are no distances. */
  crowded: number | null,
  /** Radius of the largest hole over `ideal_spacing`/√3, the radius in the perfect lattice: 1 is
  * ideal. */
  cover: number,
  /** Largest ratio of a hole's radius to that of a hexagonal lattice with the wanted radius
  * there, the mean of the wanted radii of the points around the hole. One factor scales all
  * wanted radii so that their cells have the surface's area. 1 is ideal. With equal radii this
  * is `cover`. */
  cover_local: number,
  /** Mean squared distance from the surface to the nearest point, over that in the perfect
  * lattice: 1 is ideal. */
  quantization_error: number,
  /** Share of the surface that no disc of a point around it covers, if the discs are known: 1 -
  * π/(2√3) = 0.093 in a lattice whose discs touch. */
  uncovered: number,
  /** Holes wider than 1.4, as `cover` or, if wanted radii are known, as `cover_local`: empty
  * discs whose middle lies in no wider one. None if `cover` is undefined. */
  wide_holes: number | null,
  /** Fraction of the points with exactly six natural neighbours. */
  six_neighbours: number,
  /** Fraction of the points with five or seven natural neighbours. */
  five_or_seven_neighbours: number,
  /** Standard deviation of the valence. */
  valence_deviation: number,
  /** Number of points whose cell is not proven complete among their 200 nearest points. */
  open: number,
  /** Mean over the points of |mean over natural neighbours of exp(6iθ)|: 1 for a lattice. */
  bond_order: number,
  /** Standard deviation over mean of the length of mutual natural-neighbour edges. */
  edge_variation: number,
  /** Standard deviation over mean of edge length over the sum of the wanted radii. */
  size_variation: number,
  /** Smallest distance of natural neighbours over the sum of their wanted radii: 1 where
  * particles just touch, 0 for duplicates. */
  overlap_min: number,
  /** Kept triangles over 2N − 2χ: 1 for a closed manifold. On a clipped surface, the share of the
  * sectors around points away from the border that a kept triangle fills. */
  triangle_share: number,
  /** Fraction of the triangles (away from the border) that belong to the natural-neighbour stars
  * of all three corners. */
  agree: number,
  /** Euler number of the kept triangles, on which at least two of their three corners agree. */
  euler: number,
  /** Number of components of the surface, by natural neighbours: components of the kept
  * triangles, and groups of points far from all of them. */
  components: number,
  /** Smallest angle of any triangle, in degrees. */
  smallest_angle: number,
  /** Mean over the triangles of their smallest angle, in degrees. */
  mean_smallest_angle: number,
  /** Fraction of the triangles with an angle below 30°. */
  triangles_below_30: number,
  /** Fraction of the triangles with an angle above 90°. */
  triangles_above_90: number,
  /** Fraction of all angles below 30°. */
  angles_below_30: number,
  /** Fraction of all angles above 90°. */
  angles_above_90: number,
};

/** The record in a file, from which the same particles can be made again. Files store it as JSON
* ([`RecordText`]). */
export type FileRecord = {
  /** Version of the program. */
  version: string,
  /** Digest of the particles, 16 hexadecimal digits. */
  digest: string,
  /** Link to the page in this state, if the page made the file. */
  link: string | null,
  /** Gallery surface whose formula it is. */
  surface: string | null,
  /** Model from points, instead of a formula. */
  model: string | null,
  /** Pulls on the surface of the model. */
  pulls: Array<Pull>,
  /** Text of the formula; empty for a model alone. */
  formula: string,
  /** Values of its parameters. */
  parameters: { [key in string]: number },
  /** Box of the run. */
  bounds: Bounds,
  /** Box whose faces close the solid, if they do. */
  faces: Bounds | null,
  /** Settings of the solid that is made of the surface before it is sampled. */
  solid: Record<string, number | string>,
  /** Spacing of the run, if it is by a formula. */
  spacing?: SpacingText,
  /** Columns that formulas added. */
  values?: Array<ValueText>,
  /** Settings of the run. */
  settings: Record<string, number | string>,
};

/** Request for a mesh file. */
export type FileRequest = {
  /** Extension of the format. */
  format: string,
  /** Size and orientation of the mesh. */
  placement: Placement,
  /** The vertices of the particles on sharp edges, in GLB, OBJ and PLY, and the columns of PLY. */
  vertices: Vertices,
  /** The bodies that the file holds. */
  bodies: Bodies,
  /** Link for the record. */
  link: string | null,
  /** Whether the file is written without a record. */
  plain: boolean,
};

/** The class of a [`FormulaError`]; its name in JSON is the snake-case form. */
export type FormulaErrorKind = "empty" | "too_long" | "too_deep" | "too_complex" | "unexpected_end" | "unexpected_symbol" | "unexpected_character" | "bad_number" | "decimal_comma" | "ambiguous" | "missing_brackets" | "wrong_arity" | "too_many_equations" | "unknown_name" | "unknown_function" | "bad_definition" | "not_finite" | "bad_parameter" | "model_use";

/** Entry of the function reference. */
export type FunctionInfo = {
  /** Name as typed in a formula. */
  name: string,
  /** Name with its arguments. */
  signature: string,
  /** Description in one sentence. */
  help: string,
};

/** The mesh of a file, without repairs. */
export type GivenMesh = {
  /** Area of all faces, in the units of the file. */
  area: number,
  /** Components, Euler number and border loops, if every edge has one or two faces of equal
  * orientation. Corners that coincide in single precision are one. */
  topology: GivenTopology | null,
};

/** The connectivity of the mesh of a file. */
export type GivenTopology = {
  /** Number of connected components. */
  components: number,
  /** Euler number: vertices − edges + faces. */
  euler: number,
  /** Number of border loops, if the mesh is open. */
  borders: number,
};

/** The result of making a surface pass through points. */
export type Grip = {
  /** Whether the surface passes through all points. If not, it is as near as the ranges of the
  * parameters allow. */
  holds: boolean,
  /** For each point, a nearby point of the surface, found down the gradient; the point itself if
  * none is found. */
  places: Array<[number, number, number]>,
  /** The parameters that have changed, with their values. */
  changed: { [key in string]: number },
  /** Names of the parameters that hardly move the surface at the points. */
  idle: Array<string>,
};

/** Histogram of the nearest-neighbour distances over the ideal ones: the ideal spacing, or twice
* the particle's wanted radius if given. Bins are equal, and values outside are counted in the
* outermost. */
export type Histogram = {
  /** Lower end of the first bin. */
  min: number,
  /** Upper end of the last bin. */
  max: number,
  /** Number of distances in each bin. */
  bins: Array<number>,
};

/** A disc on the surface without a particle. */
export type Hole = {
  /** Position of the middle, in the field's units. */
  position: [number, number, number],
  /** Distance to the nearest particle, in the field's units. */
  radius: number,
  /** Radius over that in the perfect lattice or, if radii are wanted, in the lattice of those
  * around it. */
  ratio: number,
};

/** Facts about an image, before its surface is chosen. */
export type ImageFacts = {
  /** Voxels along each axis. */
  size: [number, number, number],
  /** Distances between voxels along each axis. */
  spacing: [number, number, number],
  /** Type of the voxels, such as `int16`. */
  voxel_type: string,
  /** Smallest and largest voxel. */
  range: [number, number],
  /** Number of voxels in each of 256 bins of equal width over the range. */
  histogram: Array<number>,
  /** The iso value that Otsu's method chooses. */
  otsu: number,
  /** Its labels with their numbers of voxels, the background 0 included, if its values look like
  * labels: up to 256 whole numbers. */
  labels: Array<LabelFacts>,
  /** Decisions of the reader, in sentences. */
  notes: Array<string>,
};

/** The image whose surface is sampled, and the choices for it. */
export type ImageInfo = {
  /** Name of the file or the array. */
  name: string,
  /** Voxels along each axis. */
  size: [number, number, number],
  /** Smallest and largest voxel. */
  range: [number, number],
  /** The label whose boundary is sampled instead of an iso value. */
  label: number | null,
  /** The value on the surface; for a label, the value of the distance from it. */
  iso: number,
  /** Width of the Gaussian in voxels, 0 for none. */
  smooth: number,
  /** Whether the width was chosen automatically, not by the user. */
  is_smooth_chosen: boolean,
  /** Standard deviation of the noise, in the values of the voxels. */
  noise: number,
  /** Whether darker voxels are inside. */
  is_dark_inside: boolean,
  /** Whether a surface that the border of the image cuts is closed there. */
  is_closed: boolean,
  /** Decisions that were made, in sentences. */
  notes: Array<string>,
};

/** The size and type of an image, and the memory that it needs, from the header of its file. */
export type ImagePromise = {
  /** Voxels along each axis; none if that takes the whole file. */
  size: [number, number, number] | null,
  /** Type of the voxels, such as `int16`; empty if that takes the whole file. */
  voxel_type: string,
  /** Bytes of memory for reading and filtering; 0 if that takes the whole file. */
  memory: number,
  /** Bytes of the voxels alone; 0 if that takes the whole file. */
  bytes: number,
};

/** The sign of f inside the closed parts of a surface. */
export type Inside = "f < 0" | "f > 0" | "f < 0, f > 0";

/** A label of an image. */
export type LabelFacts = {
  /** The value of its voxels. */
  value: number,
  /** Number of its voxels. */
  voxels: number,
};

/** A part of a run; a snapshot may be kept before it. */
export type LessonChapter = {
  /** Number of the first event of the chapter in the run. */
  first_event: number,
  /** Number of events of the chapter so far. */
  events: number,
  /** Number of particles at the beginning of the chapter. */
  before: number,
  /** Number of particles at the end of the chapter. */
  after: number,
  /** Number of proposed children by fate. */
  fates: FateCounts,
  /** Energy per particle when a relaxation step ends, or when an iteration of a particle system
  * begins. */
  energy: number | null,
  /** Longest move, in radii, of relaxation steps and iterations. */
  largest_move: number | null,
  /** Particles that have divided. */
  fissions: number,
  /** Particles that have died. */
  deaths: number,
  /** Evaluations of the field in the run until the end of the chapter. */
  evaluations: number,
  /** Whether the chapter is over. */
  is_over: boolean, } & ({ "kind": "level",
  /** Number of the front. */
  front: number,
  /** Number of the level. */
  level: number, } | { "kind": "stack",
  /** Number of the front. */
  front: number,
  /** Number of the part, from 0. */
  part: number, } | { "kind": "filling" } | { "kind": "relaxation",
  /** Number of the step, from 1. */
  step: number, } | { "kind": "iteration",
  /** Number of the iteration, from 1. */
  iteration: number, });

/** An event. [`Event::Seed`], [`Event::Added`], [`Event::Fate`], [`Event::Done`], [`Event::Moved`],
* [`Event::Divided`] and [`Event::Died`] change the particles; the others explain why. */
export type LessonEvent = { "type": "seed",
/** Index of the seed. */
particle: number,
/** Columns of the particle. */
data: LessonParticle, } | { "type": "level_begins",
/** Number of the level. */
level: number,
/** Number of particles that wait. */
waiting: number, } | { "type": "taken",
/** The particle. */
particle: number, } | { "type": "frame",
/** The particle. */
particle: number,
/** Unit normal N̂. */
normal: [number, number, number],
/** Unit tangent vector of slot 0, towards the parent; any for a seed. */
u: [number, number, number],
/** N̂ × u. */
w: [number, number, number], } | { "type": "slot",
/** The particle that places the child. */
parent: number,
/** Number of the slot, at an angle of slot · π/3 in uniform sampling. */
slot: number,
/** Unit tangent vector V̂. */
direction: [number, number, number],
/** Angle θ₀ on the circle. */
theta_rad: number,
/** Position at this angle. */
place: [number, number, number], } | { "type": "iterate",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Number of the evaluation, from 0. */
step: number,
/** Angle θₖ on the circle; none for Newton's method in space. */
theta_rad: number | null,
/** Position. */
position: [number, number, number],
/** Value f at the position. */
value: number,
/** Length |∇f| of the gradient at the position. */
slope: number, } | { "type": "landed",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Position. */
position: [number, number, number],
/** Unit normal at `position`. */
normal: [number, number, number],
/** Distance to the parent: 2r on the circle. */
distance: number, } | { "type": "gathered",
/** The particle. */
particle: number,
/** Distance within which neighbours are searched. */
reach: number,
/** The particles found, on any sheet. */
neighbours: Array<LessonNearby>, } | { "type": "compared",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Position at which the child was compared, predicted or on the surface. */
position: [number, number, number],
/** The nearest particle; none if none is near, or if the nearest is a child that is not yet
* projected. */
against: number | null,
/** Distance to the nearest; none if nothing is near. */
distance: number | null,
/** Match radius. */
limit: number,
/** Whether the distance is within the match radius. */
corresponds: boolean, } | { "type": "fronts_meet",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** The particle that the child met. */
particle: number,
/** Whether that particle belongs to the front of another seed. */
is_other: boolean, } | { "type": "added",
/** Index of the particle. */
particle: number,
/** Columns of the particle. */
data: LessonParticle, } | { "type": "fate",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** The fate. */
fate: SlotFate,
/** The new particle, or the existing one. */
particle: number | null, } | { "type": "done",
/** The particle. */
particle: number,
/** Evaluations of the field so far. */
evaluations: number, } | { "type": "arc",
/** The particle. */
parent: number,
/** The particle before the free space; none if the whole circle is free. */
before: number | null,
/** The particle after the free space, in the direction of increasing angles. */
behind: number | null,
/** Directions of the particles `before` and `behind` in the frame. */
angles_rad: [number, number], } | { "type": "start",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** The point I of Fig. 7c, on the circle of the previous child; none for the first child of
* a seed. */
tangent: [number, number, number] | null,
/** The point s, in the tangent plane. */
position: [number, number, number],
/** Repulsion radius at `position`. */
radius: number, } | { "type": "push",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Position after the push. */
position: [number, number, number],
/** Repulsion radius at `position`. */
radius: number, } | { "type": "push_on_circle",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Position after the push. */
position: [number, number, number],
/** Repulsion radius at `position`. */
radius: number,
/** Largest overlap with another particle, as a share of r_i + r_j; negative without an
* overlap. */
overlap: number, } | { "type": "room",
/** The particle that places the child. */
parent: number,
/** Number of the slot. */
slot: number,
/** Angle that the child's diameter occupies. */
phi_rad: number,
/** Angle that is free. */
tau_rad: number,
/** Whether there is room. */
fits: boolean, } | { "type": "gap",
/** The particle. */
particle: number,
/** Radius of that circle; none if it is too narrow or too wide to be a gap. */
width: number | null, } | { "type": "step_begins",
/** Number of the step, from 1. */
step: number,
/** Size of the step: the factor between the force and the particle's move. */
size: number,
/** Energy per particle before it. */
energy: number, } | { "type": "moved",
/** The particle. */
particle: number,
/** Sum of the repulsion, in the tangent plane; the move is the step size times this. */
force: [number, number, number],
/** Target of the move in the tangent plane; in Witkin and Heckbert's system it includes the
* return to the surface. */
target: [number, number, number],
/** Position on the surface. */
position: [number, number, number],
/** Unit normal at `position`. */
normal: [number, number, number],
/** Repulsion radius at `position`. */
radius: number,
/** Whether the particle stayed where it was, because the move would have left the box or
* the surface, or gone around a fold. */
is_kept: boolean, } | { "type": "step_ends",
/** Number of the step, from 1. */
step: number,
/** Energy per particle after it. */
energy: number,
/** Longest move, in radii. */
largest_move: number, } | { "type": "iteration_begins",
/** Number of the iteration, from 1. */
iteration: number,
/** Number of particles. */
particles: number,
/** Mean energy of the particles, or mean sum of their squared overlaps. */
energy: number, } | { "type": "divided",
/** The particle, which one child replaces. */
particle: number,
/** Index of the other child. */
child: number,
/** Columns of both children. */
data: [LessonParticle, LessonParticle],
/** Energy of the particle. */
energy: number, } | { "type": "died",
/** The particle. */
particle: number,
/** Energy of the particle. */
energy: number, } | { "type": "iteration_ends",
/** Number of the iteration, from 1. */
iteration: number,
/** Number of particles. */
particles: number,
/** Longest move, in radii. */
largest_move: number,
/** Mean move, in radii. The system has settled once it stays small and nothing divides or
* dies for a while. */
mean_move: number, };

/** A surface given by a formula, in the page's form. */
export type LessonField = {
  /** Text of the formula. */
  formula: string,
  /** Parameters with their values. */
  parameters: Array<Parameter>,
  /** Box to sample. */
  bounds: Bounds,
};

/** A step of Newton's method in space. */
export type LessonIterate = {
  /** Position. */
  position: [number, number, number],
  /** Value f at the position. */
  value: number,
  /** Length |∇f| of the gradient at the position. */
  slope: number,
};

/** The numbers of the events at which a particle was added, treated and done. */
export type LessonLife = {
  /** The event at which the particle was added. */
  born: number | null,
  /** The event at which the particle was taken from the queue. */
  taken: number | null,
  /** The event at which the particle was marked as done. */
  done: number | null,
};

/** Whether a particle that a child was identified with remains a neighbour of the parent (§4.4). */
export type LessonMatched = "leave" | "stay";

/** Method that places particles on the surface. */
export type LessonMethod = "front" | "witkin_heckbert" | "forces";

/** A particle near another one. */
export type LessonNearby = {
  /** Index of the particle. */
  particle: number,
  /** Distance to the particle. */
  distance: number,
};

/** The order in which the particles that are not done are treated (§4.4). */
export type LessonOrder = "queue" | "stack";

/** A particle: position p, normal N̂ and repulsion radius r (§4.2), with its parent, level, front
* and slots. */
export type LessonParticle = {
  /** Position on the surface. */
  position: [number, number, number],
  /** Unit outward normal. */
  normal: [number, number, number],
  /** Repulsion radius. */
  radius: number,
  /** The particle that placed this one; none for a seed, and in particle systems, whose indices
  * change. */
  parent: number | null,
  /** Generation level; in a particle system the number of fissions since the first particle. */
  level: number,
  /** Number of the front, from 0. */
  front: number,
};

/** The order in which children are projected and compared with existing particles. */
export type LessonPlacing = "one_by_one" | "level_by_level";

/** Progress of a run. */
export type LessonProgress = {
  /** Chapters so far. */
  chapters: number,
  /** Events so far. */
  events: number,
  /** Particles so far. */
  particles: number,
  /** Evaluations of the field so far. */
  evaluations: number,
  /** Pushes of one particle by another that were summed for moves so far. */
  interactions: number,
  /** Number of completed relaxation steps or iterations. */
  steps: number,
  /** Whether a particle system has settled. */
  is_settled: boolean,
  /** Whether the limit on particles was reached. */
  is_capped: boolean,
  /** Whether the run has ended. */
  is_done: boolean,
};

/** The method that moves a child onto the surface (§4.3). */
export type LessonProjection = "circle" | "newton";

/** The choices of a run. `Default` gives the paper's values, and the fast sampler's where the paper
* states none. */
export type LessonSettings = {
  /** Method that places particles on the surface. Of the settings below, the two particle systems
  * use the sizes, the seeds, `residual`, `max_iterations` and `max_particles`. */
  method: LessonMethod,
  /** Whether all particles have one radius (§4), or one that follows the curvature (§5). */
  sampling: 'uniform' | 'adaptive',
  /** Repulsion radius r of every particle of uniform sampling, a length in the field's
  * coordinates. */
  radius: number,
  /** Law for the radius of an adaptive particle, given the curvature. */
  law: 'chord_error' | 'max_curvature' | 'sum_of_curvatures',
  /** Scale of the law: for `chord_error` the gap between the surface and a triangle of
  * neighbours, a length; for the other two the radius divided by the radius of curvature. */
  law_scale: number,
  /** Smallest radius of an adaptive particle, a length. */
  radius_min: number,
  /** Largest radius of an adaptive particle, a length. In Witkin and Heckbert's system the radius
  * at which a particle divides whatever its energy, half of the surface's diameter; with 0 it
  * is measured. */
  radius_max: number,
  /** An adaptive child is added if the free angle τ is at least this share of φ, the angle that
  * it occupies. The paper's share is 1; on a lattice, where the two are equal, rounding then
  * decides. */
  fit: number,
  /** Points near the surface where fronts begin, in this order; each begins when the front before
  * it has closed. Other seeds are searched only if this is empty. */
  seeds: Array<[number, number, number]>,
  /** Random seed for the choice of the first seed point, if `seeds` is empty. */
  seed: number,
  /** Method that moves a child onto the surface. */
  projection: LessonProjection,
  /** Start of the search on the circle. */
  start: LessonStart,
  /** Order in which waiting particles are treated. */
  order: LessonOrder,
  /** Whether matched particles are removed from the neighbours. */
  matched: LessonMatched,
  /** A child is identified with a particle within this distance, in 2r. */
  match_tolerance: number,
  /** Order of projection and comparison: particle by particle, or level by level. */
  placing: LessonPlacing,
  /** Whether gaps between fronts are filled. */
  gaps: 'fill' | 'leave',
  /** A point is on the surface if |f|/|∇f| is at most this, in r. */
  residual: number,
  /** Relaxation steps. */
  relax_steps: number,
  /** Size of a relaxation step. The default is 0.6 σ² with σ = r in uniform sampling, and 0.33 of
  * the overlap in adaptive sampling. */
  step_size: number | null,
  /** A particle system ends after this many iterations even if it has not settled. */
  max_iterations: number,
  /** The run stops at this number of particles. It may exceed [`MAX_PARTICLES`]. */
  max_particles: number,
};

/** Where the search on the circle starts. */
export type LessonStart = "tangent" | "curvature";

/** The limits of what the core accepts. */
export type Limits = {
  /** Longest formula, in bytes of UTF-8. */
  formula_bytes: number,
  /** The names that parameters may have, as a regular expression of JavaScript. */
  name_pattern: string,
  /** Smallest diagonal of a clip box. */
  diagonal_min: number,
  /** Largest diagonal of a clip box. */
  diagonal_max: number,
  /** Largest coordinate of a clip box, in its diagonals. */
  farthest_corner: number,
  /** Room for the particles that are expected, as a multiple of them. */
  count_room: number,
  /** Smallest number of points of a model or a file that can be fitted, if it has as many. */
  centres_min: number,
  /** Largest number of points of a model or a file that can be fitted. */
  centres_max: number,
  /** Number of points that are fitted by default. */
  centres: number,
  /** Size of the largest file of points that is read. */
  file_bytes: number,
};

/** Element of MathML Core with child elements. */
export type MathGroup = "mrow" | "mfrac" | "msup" | "msub" | "msqrt" | "mroot" | "mtable" | "mtr" | "mtd";

/** MathML element with its content. */
export type MathNode = {
  /** Name of the element. */
  tag: MathToken,
  /** The text, not escaped. */
  text: string, } | {
  /** Name of the element. */
  tag: MathGroup,
  /** The child elements, in order. */
  children: Array<MathNode>,
};

/** Element of MathML Core with text. */
export type MathToken = "mi" | "mn" | "mo";

/** The particles that a report measures. */
export type Measured = "nothing" | "particles" | "front_too";

/** Figures of quality of a run. */
export type Measures = {
  /** Quality of the present particles; none without particles, or if they were not measured. */
  quality: Figures | null,
  /** Quality of the particles after the front, before the relaxation; none if nothing was
  * relaxed, or the front was not measured. */
  quality_before: Figures | null,
  /** Nearest-neighbour distances over the ideal ones; in an adaptive run, over the diameters of
  * the particles. */
  nearest_histogram: Histogram,
  /** The crowded pairs and wide holes of the present particles. */
  places: Places,
};

/** A formula with every mistake of one kind corrected. */
export type Mended = {
  /** The whole formula. */
  text: string,
  /** Number of places that were corrected. */
  places: number,
};

/** Counts and sizes of a mesh: triangles, components, borders and volume. */
export type MeshAnswer = {
  /** Number of triangles. */
  triangles: number,
  /** Connected components, in the order of their first particles. */
  components: Array<MeshComponent>,
  /** Number of border loops where no manifold was possible, not counting ends of the surface. */
  unfilled: number,
  /** Number of particles in no triangle. */
  left_out: number,
  /** [Volume](Triangulation::volume) that the mesh encloses; none if it is open. */
  volume: number | null,
  /** Sign of f inside of the closed parts; none if there is no closed part. All face outward in
  * files. */
  inside: Inside | null,
  /** [Smallest angle](Triangulation::smallest_angle) of any triangle, in degrees; none without
  * triangles. */
  smallest_angle: number | null,
  /** Border loops: rows of particles in order. Those where no manifold was possible come first,
  * then the longest. */
  loops: Array<Array<number>>,
  /** The bodies, the largest first. */
  bodies: Array<Body>,
  /** The triangles of the bodies that are loose chips, in ascending order. */
  chips: Array<number>,
};

/** The border of an open surface, which is kept. */
export type MeshBorder = {
  /** Number of its edges. */
  edges: number,
  /** Number of its closed curves. */
  loops: number,
  /** Whether it zigzagged and was smoothed. */
  is_smoothed: boolean,
};

/** The comparison of a mesh with the one that was sampled from it. */
export type MeshChange = {
  /** Diagonal of the box of the old mesh. */
  diagonal: number,
  /** Distances of points of the old mesh from the new one. */
  to_new: MeshDistances,
  /** Distances of points of the new mesh from the old one. */
  to_old: MeshDistances,
  /** Volume of the old and the new mesh; for an open mesh it depends on the origin. That of old
  * bodies that intersect is the volume of their union, estimated from points on its surface to
  * about a thousandth. */
  volume: [number, number],
  /** Area of the old and the new mesh; of a union estimated, too. */
  area: [number, number],
  /** Largest distance from the sharp edges of the old mesh to the new mesh; none without sharp
  * edges. */
  edges: number | null,
};

/** A connected part of a mesh. */
export type MeshComponent = {
  /** Number of triangles. */
  triangles: number,
  /** Euler number, vertices − edges + triangles: 2 − 2g for a closed surface of genus g. */
  euler: number,
  /** Number of edges with one triangle. */
  open_edges: number,
  /** Index of its body among the bodies of the mesh. */
  body: number,
};

/** Distances of points from a surface, in the units of the mesh. */
export type MeshDistances = {
  /** Mean distance. */
  mean: number,
  /** 99th percentile. */
  most: number,
  /** Largest distance. */
  largest: number,
};

/** The triangle mesh that is sampled, and what was made of it. */
export type MeshInfo = {
  /** Name of the file or the array. */
  name: string,
  /** Number of vertices after the repairs. */
  vertices: number,
  /** Number of faces after the repairs. */
  faces: number,
  /** Number of pieces that are not connected by edges of two faces. */
  pieces: number,
  /** Number of edges of borders, which have one face. */
  border_edges: number,
  /** Number of edges with more than two faces. */
  fan_edges: number,
  /** The repairs, in words. */
  mended: Array<string>,
  /** Whether it has colours, which become values at the particles. */
  has_colours: boolean,
  /** What the reader left out, in sentences. */
  notes: Array<string>,
  /** The smooth patches, if it counts as a part with sharp edges. */
  part: MeshPart | null,
  /** The grid, if it counts as a scan. */
  scan: MeshScan | null,
  /** The bodies, if several may intersect or touch. */
  union: MeshUnion | null,
};

/** Smooth patches between sharp edges. */
export type MeshPart = {
  /** Number of patches. */
  patches: number,
  /** Edges of the mesh at which two patches meet. */
  edges: number,
  /** Vertices at which three or more of these meet. */
  corners: number,
  /** Sharp edges that fade out within a patch, and are rounded. */
  faded: number,
  /** The border at which the surface ends, if it does. */
  rim: MeshBorder | null,
};

/** The distance from a mesh on a grid. */
export type MeshScan = {
  /** Voxels along each axis. */
  size: [number, number, number],
  /** Width of a cell. */
  cell: number,
  /** Width of the Gaussian in cells. */
  smooth: number,
};

/** The union of closed bodies whose boxes overlap. */
export type MeshUnion = {
  /** Number of bodies. */
  bodies: number,
  /** Sharp edges of all bodies, including those inside of others. */
  edges: number,
};

/** A built-in model. */
export type Model = {
  /** Identifier: lower case, words joined by hyphens. No gallery surface has the same one. */
  id: string,
  /** Name for the user. */
  name: string,
  /** Two sentences about the model. */
  story: string,
  /** Credit for the points. */
  credit: string,
  /** Number of points. */
  points: number,
};

/** Report of a model from points. */
export type ModelInfo = {
  /** Name of the built-in model or of the file. */
  name: string,
  /** Credit for the points; empty for a file. */
  credit: string,
  /** Number of points read. */
  points: number,
  /** Number of centres of the function. If every point is one, the surface goes through all of
  * them. */
  centres: number,
  /** Estimated condition number of the system. */
  condition: number,
  /** Mean residual |f|/|∇f| of all distinct points read, as a share of the diagonal of their box:
  * their distance from the surface to first order (G. Taubin, "Estimation of Planar Curves,
  * Surfaces, and Nonplanar Space Curves Defined by Implicit Equations", 1991). */
  residual_mean: number,
  /** Residual that 95 % of the points do not exceed, as a share of that diagonal. */
  residual_95: number,
  /** Maximum residual, as a share of that diagonal. */
  residual_max: number,
  /** Position of the point with the maximum residual. */
  farthest: [number, number, number],
  /** The mesh of the file, if it has faces. */
  mesh: GivenMesh | null,
  /** Share of the area of the fitted surface in its box that lies beyond the border of the
  * points; 0 without a border. */
  beyond_share: number,
  /** Origin of the normals. */
  normals: NormalSource,
  /** Warnings for the user, as sentences: they go from the bundle that fits a model to the one
  * that samples it. */
  warnings: Array<string>,
};

/** Origin of the normals of a model's points. */
export type NormalSource = "given" | "from_mesh" | "estimated";

/** Two particles and their distance. */
export type Pair = {
  /** Indices of the particles, the smaller one first. */
  particles: [number, number],
  /** Distance over the ideal spacing or, if radii are wanted, over their sum. */
  ratio: number,
};

/** A named number of a formula, which can be changed without parsing the formula again. */
export type Parameter = {
  /** Name in the formula. */
  name: string,
  /** Label for the user. */
  label: string,
  /** Current value. */
  value: number,
  /** Smallest value of the slider. */
  min: number,
  /** Largest value of the slider. */
  max: number,
  /** Step of the slider. */
  step: number,
};

/** Phase of a run. */
export type Phase = "idle" | "seeding" | "generation" | "refinement" | "search" | "relaxation" | "flow" | "done";

/** Size and orientation of a mesh in a file. */
export type Placement = {
  /** Length of a unit of the formula, in the unit of the file; positive. */
  scale: number,
  /** Unit of the file. 3MF names it, and for GLB lengths are converted to metres; other formats
  * cannot express it. Without a unit, numbers are not converted: they mean metres in GLB,
  * millimetres in 3MF. */
  unit: Unit | null,
  /** Axis of the formula that points up in the file: along z, in GLB along y, as its
  * specification requires. */
  up: UpAxis,
};

/** The worst places, the worst first, at most 64 of each kind: the crowded pairs and the wide holes
* or, if there are none, the closest pair and the largest hole. */
export type Places = {
  /** Crowded pairs. */
  pairs: Array<Pair>,
  /** Wide holes. */
  holes: Array<Hole>,
};

/** Progress of a job. */
export type PointsProgress = {
  /** The stage of the job in words. */
  label: string,
  /** Fraction of the whole work, from 0 to 1. It never decreases. */
  fraction: number,
  /** Whether the field is complete. */
  done: boolean,
};

/** State after a step. */
export type Progress = {
  /** Current phase. */
  phase: Phase,
  /** Particles in the columns that will stay, each counted once. */
  particles: number,
  /** Rows of the columns that will stay: one for each particle, or one on each side for those on
  * creases. */
  rows: number,
  /** Front under way, from 1: each attempt at a wanted number of particles begins anew, with
  * another radius. */
  attempt: number,
  /** Generation level under way. */
  level: number,
  /** Level of the refinement under way, 1 the coarse one; 0 in every other phase. */
  refine_level: number,
  /** Levels that the refinement under way has. */
  refine_levels: number,
  /** Relaxation steps done. */
  relax_step: number,
  /** Relaxation steps asked for. */
  relax_steps: number,
  /** Points at which the survey and all phases have evaluated the field so far, whatever
  * derivatives they asked for. A function is called more often: several times for each
  * derivative by differences ([`FnField`](crate::field::FnField)), and for the box, the set-up
  * and the proof, which are not counted. */
  evaluations: number,
  /** Estimated share of the work done. It never decreases until more work is requested. */
  fraction: number,
  /** Set once the run has ended. */
  stop_reason: StopReason | null,
  /** A sentence for the user where the reason needs one. It may name places, which the reason
  * does not hold. */
  message: string | null,
  /** Repulsion radius. */
  radius: number,
  /** Whether particles that existed before this step have moved or been removed. */
  moved: boolean,
};

/** A pull on a surface. */
export type Pull = {
  /** The place that is pulled, on the surface as the pulls before have left it. */
  at: [number, number, number],
  /** The vector of the pull. */
  by: [number, number, number],
  /** Distance from the pulled place's destination beyond which nothing moves. It is at least
  * twice the length of `by`. */
  reach: number,
};

/** Whether a surface is bounded. */
export type Reach = "bounded" | "endless" | "nowhere" | "unknown";

/** Report on a run: its particles, how they were placed, the proof of completeness, quality and
* warnings. */
export type Report = {
  /** Number of particles. */
  count: number,
  /** Volume enclosed by the mesh to which [`Run::join`] has joined the particles; none if it is
  * open, or the particles were not joined. */
  volume: number | null,
  /** Sign of f inside of the closed parts of the surface, by that mesh if the particles were
  * joined, else by the triangles of natural neighbours; none if no part is closed, or nothing
  * was measured. */
  inside: Inside | null,
  /** Smallest angle of the triangles of that mesh in degrees, including its border; none if the
  * particles were not joined. */
  smallest_angle: number | null,
  /** Pairs of particles on opposite faces of a cell, see [`Particles::pairs`]; none if no
  * opposite faces agree. */
  pairs: number | null,
  /** Particles with a child that fell outside of the box; for particles that have followed a
  * moving surface, with room for a child there. */
  border: number,
  /** Why particles lie at the border of the box. */
  cut: Cut | null,
  /** Why the run ended. */
  stop_reason: StopReason | null,
  /** Warnings about the field, the settings and the result. */
  warnings: Array<Warning>,
  /** Digest of the particles, 16 hexadecimal digits. */
  digest: string,
  /** Repulsion radius of the run; with adaptive sampling, the radius at which as many particles
  * of equal size would cover the surface. */
  radius: number,
  /** Repulsion radius of the smallest particle; 0 without particles. */
  radius_min: number,
  /** Repulsion radius of the largest particle. */
  radius_max: number,
  /** Number of generation levels. */
  levels: number,
  /** Particles per generation level. */
  level_counts: Array<number>,
  /** Fronts started: each from a seed of its own, or from connected creases. */
  components_seeded: number,
  /** Particles placed in gaps between fronts. */
  gaps_filled: number,
  /** Number of proposed children by fate. */
  fates: FateCounts,
  /** Field evaluations of the whole run, counted as
  * [`Progress::evaluations`](crate::Progress::evaluations). */
  evaluations: number,
  /** Field evaluations of the front per particle. */
  evaluations_per_particle: number,
  /** Number of refinements of a coarse front; none if it was not refined, or the front was kept. */
  refined_levels: number | null,
  /** Energy per particle before the first relaxation step and after each; none if nothing was
  * relaxed. */
  energy: Array<number> | null,
  /** Number of components at this radius, in the graph of natural neighbours of the particles. 0,
  * and null in JSON, without particles or if they were not measured. */
  components: number | null,
  /** Whether it is proven that every component of the surface has a witness, and that every
  * witness is on the component of a particle or named in `sampled`. */
  search: Search,
  /** The witnessed components that hold particles, and those that do not. */
  sampled: Sampled,
  /** Cells of the box and witnesses that the proof left undecided; none if no proof was
  * attempted. */
  undecided_cells: number | null,
  /** Places where f has no gradient on the surface, a curve of them counted as one; none if they
  * were not searched for. */
  singular_points: number | null,
  /** Curves of particles along which the surface has an edge, from corner to corner or closed;
  * none if it has no edges. */
  creases: number | null,
  /** Particles at which creases meet or end; none if the surface has no edges. */
  corners: number | null,
  /** How the edges were found, if they were searched for in the values of f; none if the field
  * itself says which pieces meet at its edges, and if no edge was found. */
  edges_found: string | null,
  /** Number of smooth joins, the curves of particles along which patches of the surface meet
  * without an edge; `None` on a surface without any. */
  seams: number | null,
  /** Quality of the present particles; none without particles, or if they were not measured. */
  quality: Figures | null,
  /** Quality of the particles after the front, before the relaxation; none if nothing was
  * relaxed, or the front was not measured. */
  quality_before: Figures | null,
  /** Nearest-neighbour distances over the ideal ones; in an adaptive run, over the diameters of
  * the particles. */
  nearest_histogram: Histogram,
  /** The crowded pairs and wide holes of the present particles. */
  places: Places,
};

/** A row of the report. */
export type ReportRow = {
  /** Path of the figure in the report. A figure that is null there does not apply to the run. */
  key: string,
  /** Path of the upper end, if the row is a range that begins at `key`. */
  to: string | null,
  /** Path of the figure that replaces this one if the report has it: a figure that is relative to
  * the lattice of one size does not apply to particles of many sizes. */
  unless: string | null,
  /** Name for a person. */
  label: string,
  /** Group in which the row is shown. */
  group: string,
  /** Unit; `%` shows the value times 100. */
  unit: string,
  /** Digits after the point. */
  digits: number,
  /** The ideal value, in words. */
  ideal: string,
  /** Whether lower or higher is better. */
  better: string | null,
  /** Definition and meaning. */
  help: string,
  /** Path to the list of places in the picture that the figure is about. */
  places: string | null,
};

/** The witnessed components that hold particles, and those that do not. */
export type Sampled = {
  /** Every witnessed component that reaches farther than this from its witness holds particles; 0
  * if all do. None if this is not proven. */
  above: number | null,
  /** Number of witnessed components without a particle; none without a search for witnesses. A
  * component counts twice if two of its witnesses could not be proven to be connected. */
  missing: number | null,
  /** A witness of each component without a particle: at most 256. */
  without: Array<Unsampled>,
};

/** How the first points of the connected components were found. */
export type Search = "proven" | "searched";

/** A setting of a run. */
export type Setting = {
  /** Name in [`Settings`]. */
  name: string,
  /** Name for a person. */
  label: string,
  /** Explanation in one line. */
  help: string,
  /** Group in which the setting is shown. */
  group: SettingGroup,
  /** Type of the values. */
  kind: SettingKind,
  /** Default value. */
  default: SettingValue,
  /** Smallest value; 0 for a choice. */
  min: number,
  /** Largest value that the page offers; 0 for a choice. */
  max: number,
  /** Step of a slider; on a logarithmic scale a factor minus one. 0 for a choice. */
  step: number,
  /** Scale of a slider. */
  scale: SettingScale,
  /** Unit; `%` stands for a share of the diagonal of the box, which is shown times 100. */
  unit: string,
  /** Values of a choice. */
  choices: Array<Choice>,
  /** The setting has an effect, and is shown, while all of these hold; always if the list is
  * empty. */
  when: Array<Condition>,
};

/** Group of settings that are shown together. */
export type SettingGroup = "Box" | "Sampling" | "Advanced";

/** Type of the values of a setting. */
export type SettingKind = "number" | "integer" | "formula" | "text" | "choice";

/** Scale of a slider. */
export type SettingScale = "linear" | "log";

/** The value of a setting. */
export type SettingValue = number | number | string;

/** A severity says what a warning means for the result. */
export type Severity = "note" | "caution" | "fault";

/** Fate of a slot around a particle. Slots are in the order of their angles: six in a hexagon
* (paper §4.4), up to ten where radii vary (§5). */
export type SlotFate = "open" | "parent" | "added" | "matched" | "not_converged" | "outside" | "undefined" | "capped";

/** Report and box that accompany a solved system to the session that samples it. */
export type SolvedModel = {
  /** Report of the model. */
  info: ModelInfo,
  /** Box to sample in. */
  bounds: Bounds,
};

/** A spacing by a formula, as text: see [`Spacing`]. A record stores it next to the settings. */
export type SpacingText = {
  /** Distance between neighbours, in x, y, z and the parameters of the formula whose surface is
  * sampled, such as `0.02 + 0.1 hypot(x, y)`. */
  formula: string,
  /** Smallest distance, used wherever the formula is below it. */
  smallest?: number,
  /** Largest distance, used wherever the formula is above it. */
  largest?: number,
};

/** Report on the start of a run: the radius, estimates and warnings. */
export type Start = {
  /** Repulsion radius of the run, in the units of the field's coordinates. */
  radius: number,
  /** Expected number of particles. */
  predicted_count: number,
  /** Estimated area of the surface in the box. */
  area: number,
  /** Warnings that are known before the first particle is placed. */
  warnings: Array<Warning>,
};

/** Why a run ended. */
export type StopReason = "complete" | "cancelled" | "cap" | "no_surface" | "constant" | "undefined" | "one_particle";

/** A surface in the gallery. */
export type SurfaceEntry = {
  /** Parameters with their ranges. */
  parameters: Array<Parameter>,
  /** Name of the group of the surface in the gallery. */
  group: string,
  /** Identifier: lower case, words joined by hyphens. */
  id: string,
  /** Name for the user. */
  name: string,
  /** Formula of f, or an equation; f < 0 inside. */
  formula: string,
  /** Box that is sampled. */
  bounds: Bounds,
  /** Algebraic degree; none for a transcendental surface. */
  degree: number | null,
  /** Genus with the default parameters; none unless the surface is closed, connected and free of
  * self-intersections. */
  genus: number | null,
  /** Words by which people look for the surface and that its name, formula and story do not have,
  * in lower case, with spaces between them. Each suggests the surface if it is typed alone. */
  words: string,
  /** Two sentences about the surface. */
  story: string,
  /** Reference to a text about the surface. */
  source: string,
};

/** Unit of length of a file. */
export type Unit = "mm" | "cm" | "m" | "in";

/** A witness on whose component no particle was found. */
export type Unsampled = {
  /** The witness, a point of the surface. */
  position: [number, number, number],
  /** Largest distance from the witness at which a point of the component was found. */
  reach: number,
  /** Whether the exploration stopped there, so that the component may be larger. */
  goes_on: boolean,
};

/** Axis of the formula's coordinates. */
export type UpAxis = "x" | "y" | "z";

/** A column of numbers at the particles, by a formula that may use the parameters of the surface. */
export type ValueText = {
  /** Name of the column. */
  name: string,
  /** Text of the formula. */
  formula: string,
};

/** How particles become vertices of a mesh file. The choices differ on sharp edges, where a
* particle has a normal for each side. */
export type Vertices = "joined" | "split" | "columns";

/** A way to write vertices, as an interface shows it. */
export type VerticesChoice = {
  /** The way. */
  value: Vertices,
  /** Name for a person. */
  label: string,
  /** Explanation in one line. */
  help: string,
  /** Extensions of the formats in which it makes a difference. */
  formats: Array<string>,
};

/** A warning, as reports in JSON have it. */
export type Warning = {
  /** A name by which a program identifies the warning. */
  code: string,
  /** The severity says what the warning means for the result. */
  severity: Severity,
  /** The first sentence says what happened and what to do; the others are details. */
  message: string,
};
