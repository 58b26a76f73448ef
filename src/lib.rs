//! Evenly spaced particles on an implicit surface f(x, y, z) = 0.
//!
//! A [`Field`] is a [`Formula`], a surface of the [gallery], a closure, a model from points, or
//! anything that implements one method of the trait. [`sample`] covers its zero set with particles:
//! a front grows over the surface in hexagons, generation level by generation level, and a few
//! relaxation steps even the spacing out. A [`Sample`] holds the particles, a report on them and
//! their mesh. A [`Run`] does the same in steps, for a caller that draws or cancels.
//!
//! ```
//! use marching_particles::{Formula, Format, MeshFormat, Radius, Settings, gallery, sample};
//!
//! let surface = Formula::parse("x^4 + y^4 + z^4 = a")?.with("a", 0.5)?;
//! let cushion = sample(surface, &Settings::with_count(2_000))?;
//! cushion.write(Format::Ply, &mut Vec::new())?;
//!
//! // In a given box and by radius. The triangles between the particles form a torus.
//! let torus = gallery::find("torus").ok_or("no such surface")?;
//! let settings = Settings::with_radius(Radius::Share(0.01)).in_box(torus.bounds);
//! let sample = sample(torus.field(), &settings)?;
//! assert_eq!(sample.mesh().topology.components[0].euler(), 0);
//! sample.write_mesh(MeshFormat::Glb, &mut Vec::new())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A program that is compiled without optimisation samples some 25 times as slowly. In its
//! `Cargo.toml` these lines have the library optimised there, too:
//!
//! ```toml
//! [profile.dev.package.marching-particles]
//! opt-level = 3
//! ```
//!
//! # Conventions
//!
//! * f < 0 inside; the gradient and the normal point outward.
//! * Lengths are in the units of the field's own coordinates. Every particle has a *repulsion
//!   radius* `r`; neighbours sit `2r` apart.
//! * Angles are in radians, and names say so (`angle_rad`); those of the quality figures are in
//!   degrees.
//! * The sampler computes in single precision and SIMD lanes, the oracles and the set-up in double
//!   precision.
//! * The same field, settings and seed give the same particles to the last bit, natively and in
//!   WebAssembly: every sum has a fixed order, no clock or platform function is used, and
//!   transcendental functions are [our own](math::functions).
//! * A `Result` is for the user's data, a [`StopReason`] for what a run met, a [`Warning`] for what
//!   its user should know, and a panic for a mistake in the calling code; routines that can panic
//!   say when.
//!
//! # Features
//!
//! `points` and `images`, which are on by default, fit surfaces to points and find them in
//! three-dimensional images; both of them sample triangle meshes anew. With `parallel` all threads
//! of the current [rayon](https://docs.rs/rayon) pool share measuring, fits to points and parts of
//! the mesh, natively; the results are the same. Functions of the program are then called from
//! several threads at once. A program that does such work in [steps](Reporting::step) takes them in
//! a thread of the pool, as within `rayon::scope`: another thread would wait for each share.
//!
//! # Glossary
//!
//! The words of the paper, and a dozen more that the code uses everywhere. One word for one thing.
//!
//! | Term | Meaning |
//! |---|---|
//! | particle | A point of the sample, with position, normal and repulsion radius. |
//! | repulsion radius, r | Half of the wanted distance between neighbours. |
//! | front | The particles of the newest generation level, which grow over the surface. |
//! | seed | A first particle, from which a front grows. |
//! | parent, child | A particle, and one that it proposed. |
//! | slot | One of a parent's places for children; six of them 60° apart in uniform sampling. |
//! | generation level | The number of parent links from a particle to its seed; a level is placed as one batch. |
//! | fate | What became of a slot: open, the parent's, added, matched, not converged, outside, undefined or capped. |
//! | projection | Moving a point onto the surface: along a circle around its parent, or down the gradient. |
//! | relaxation | Moving all particles against their repulsion, step by step. |
//! | energy | The sum over neighbour pairs that the relaxation lowers. |
//! | fission, death | Splitting and removal of particles, in the system of Witkin and Heckbert. |
//! | field | The function f(x, y, z); f < 0 inside. |
//! | component | A connected part of the surface. |
//! | body, chip | Of a mesh: a closed component with the walls of its hollows, or an open component; one that is small beside the largest. |
//! | sheet | A part of the surface that is a graph over its tangent plane. Two sheets may be close in space and far along the surface. |
//! | residual | \|f\|/\|∇f\|, the distance to the surface to first order. |
//! | witness | A point of the surface that interval arithmetic found, at least one on each component. |
//! | crease, corner, patch | A curve along which two smooth parts of the surface meet at an angle; a point where creases meet; such a part. |
//! | piece | A smooth function that gives f in a part of space, as each operand of a maximum does. |
//! | row | An entry of the particle columns. A particle on a crease or a seam has one for each patch. |
//! | seam | Of patches: a curve along which two meet without an edge. Of fronts: a line along which they meet out of step. |
//! | gap | A hole between fronts that is wide enough for a particle. |
//! | natural neighbours, valence | The particles whose Voronoi cells share an edge in the tangent plane; their number, six in a hexagonal lattice. |
//! | defect | A particle of a mesh whose valence is not six, or on the border not four. |
//! | refinement | Ordering a coarse front as a mesh and halving its edges, level by level. |
//! | flow | Particles of a finished run that follow a moving surface, frame by frame. |
//!
//! # What stands at the root
//!
//! | For | Items |
//! |---|---|
//! | the job | [`sample`], [`Sample`], [`Run`], [`Start`], [`Progress`], [`Phase`], [`StopReason`], [`Reporting`] |
//! | its settings | [`Settings`], [`Spacing`], [`SpacedSettings`], [`Sampling`], [`Radius`], [`SizeMode`], [`LawKind`], [`Method`], [`GapPolicy`], [`Pattern`], [`Counting`], [`Bounds`], [`Reach`] |
//! | formulas | [`Formula`], [`Expr`], [`Parameter`], [`Thickness`], [`FormulaError`], [`FormulaErrorKind`], [`Mended`], [`PorosityError`], [gallery] |
//! | fields of a program | [`Field`], [`IntoField`], [`FnField`], [`BatchField`], [`PiecewiseFn`], [`BatchPiecewise`], [`FieldError`], [`SharedError`], [`Evaluator`], [`Pieces`], [`Frame`], [`Facts`], [`Jet`], [`Sym3`], [`Bounded`], [`Enclosure`], [`Interval`], [`UnitCell`], [`Within`], [glam] |
//! | solids of several fields | [`union`], [`intersection`], [`difference`], [`smooth_union`], [`offset`], [`IntoFields`], [`Combined`] |
//! | surfaces through points | [`fit_points`], [`CENTRES`], [`Fit`], [`ModelInfo`], [`NormalSource`], [`GivenMesh`], [`GivenTopology`], [`RbfField`] |
//! | three-dimensional images | [`Image`], [`ImageField`], [`ImageChoice`], [`ImageSurface`], [`ImageOutline`], [`ImagePlacement`], [`Voxel`], [`VoxelType`], [`Label`], [`DEFAULT_LABEL_WIDTH`], [`ImageFormat`], [`RawVoxels`], [`ImageError`], [`ImageReadError`] |
//! | triangle meshes | [`TriangleMesh`], [`MeshSolid`], [`MeshRepairs`], [`MeshOptions`], [`MeshEdges`], [`MeshField`], [`MeshKind`], [`MeshRim`], [`MeshChange`], [`MeshDistances`], [`MeshError`] |
//! | particles and meshes | [`Particles`], [`Slots`], [`SlotFate`], [`OppositeFaces`], [`Triangulation`], [`MeshBuffers`], [`Body`], [`Inside`], [`Topology`], [`Component`], [`MeshAnswer`], [`MeshComponent`] |
//! | the report | [`Report`], [`Radii`], [`Growth`], [`FateCounts`], [`Proof`], [`Search`], [`Sampled`], [`Unsampled`], [`Measured`], [`Measures`], [`Cut`] |
//! | its figures | [`Figures`] with the groups in [figures], [`Histogram`], [`Places`], [`Pair`], [`Hole`], [`Measurements`]; [`Value`], [`NamedValues`] |
//! | what may be wrong | [`Warning`], [`Severity`], [`Doubt`], [`Refusal`], [`Spot`] |
//! | why there is no result | [`Error`], [`SettingsError`], [`BoxError`], [`FollowError`], [`ValueError`]; of points [`JobError`], [`ReadError`], [`InputFormat`], [`CloudError`], [`FitError`] |
//! | files | [`Format`], [`ParticleFile`], [`MeshFormat`], [`MeshFile`], [`Bodies`], [`Vertices`], [`Placement`], [`Unit`], [`UpAxis`], [`RecordText`] |
//!
//! The modules behind the root are public for the project's own tests, benchmarks and page and may
//! change at any time; ARCHITECTURE.md says what each is for and who may use whom.

#![cfg_attr(
    target_arch = "wasm32",
    allow(
        clippy::arc_with_non_send_sync,
        reason = "a field may hold a function of JavaScript, which is sent nowhere"
    )
)]

#[doc(hidden)]
pub mod differential;
#[doc(hidden)]
pub mod export;
#[doc(hidden)]
pub mod extent;
#[doc(hidden)]
pub mod field;
#[cfg(feature = "images")]
#[doc(hidden)]
pub mod image;
#[doc(hidden)]
pub mod lesson;
#[doc(hidden)]
pub mod math;
#[doc(hidden)]
pub mod mesh;
#[cfg(all(test, feature = "points"))]
mod page_types {
    mod tests;
}
#[doc(hidden)]
pub mod paper;
#[doc(hidden)]
pub mod particles;
#[cfg(feature = "points")]
#[doc(hidden)]
pub mod pointcloud;
#[doc(hidden)]
pub mod quality;
#[cfg(all(feature = "images", feature = "points"))]
#[doc(hidden)]
pub mod remesh;
mod run;
#[doc(hidden)]
pub mod sampler;
#[doc(hidden)]
pub mod session;
#[doc(hidden)]
pub mod slices;
#[doc(hidden)]
pub mod spatial;
#[doc(hidden)]
pub mod topology;

pub use export::{
    Format, MeshBuffers, MeshFile, MeshFormat, ParticleFile, Placement, RecordText, Unit, UpAxis, Vertices,
};
pub use extent::Reach;
pub use field::formula::{
    Expr, Formula, FormulaError, FormulaErrorKind, Mended, Parameter, PorosityError, Thickness,
};
#[cfg(feature = "points")]
pub use field::model::{CENTRES, GivenMesh, GivenTopology, ModelInfo, NormalSource};
#[cfg(feature = "points")]
pub use field::rbf::RbfField;
pub use field::{
    BatchField, BatchPiecewise, Bounded, Combined, Enclosure, Evaluator, Facts, Field, FieldError, FnField,
    Frame, IntoField, IntoFields, Jet, Pieces, PiecewiseFn, SharedError, UnitCell, Within, difference,
    gallery, intersection, offset, smooth_union, union,
};
pub use glam;
#[cfg(feature = "images")]
pub use image::{
    DEFAULT_LABEL_WIDTH, Image, ImageChoice, ImageError, ImageField, ImageFormat, ImageOutline,
    ImageReadError, ImageSurface, Label, Placement as ImagePlacement, RawVoxels, Section, Voxel, VoxelType,
};
pub use math::{Bounds, BoxError, Interval, Sym3};
pub use mesh::bodies::{Bodies, Body};
pub use mesh::facing::Inside;
pub use mesh::triangulation::Triangulation;
pub use particles::{OppositeFaces, Particles, SlotFate, Slots};
#[cfg(feature = "points")]
pub use pointcloud::CloudError;
#[cfg(feature = "points")]
pub use pointcloud::fit::{Fit, FitError};
#[cfg(feature = "points")]
pub use pointcloud::fit_points;
#[cfg(feature = "points")]
pub use pointcloud::job::JobError;
#[cfg(feature = "points")]
pub use pointcloud::read::{InputFormat, ReadError};
pub use quality::{Figures, Histogram, Hole, Measurements, NamedValues, Pair, Places, figures};
#[cfg(all(feature = "images", feature = "points"))]
pub use remesh::{
    MeshChange, MeshDistances, MeshEdges, MeshError, MeshField, MeshKind, MeshOptions, MeshRepairs, MeshRim,
    MeshSolid, TriangleMesh,
};
pub use run::{
    Cut, Error, Growth, Measured, Measures, MeshAnswer, MeshComponent, Proof, Radii, Report, Reporting, Run,
    Sample, Severity, Start, Value, ValueError, Warning, sample,
};
pub use sampler::{
    Counting, Doubt, FateCounts, FollowError, GapPolicy, LawKind, Method, Pattern, Phase, Progress, Radius,
    Refusal, Sampled, Sampling, Search, Settings, SettingsError, SizeMode, SpacedSettings, Spacing, Spot,
    StopReason, Unsampled,
};
pub use topology::{Component, Topology};

/// The examples of the README, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
