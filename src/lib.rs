//! Evenly spaced particles on an implicit surface f(x, y, z) = 0.
//!
//! A [`Field`] is a [`Formula`], a surface of the [gallery], a closure ([`FnField`]), a model from points, or anything that implements
//! one method of the trait. [`sample`] covers its zero set with particles: a front grows over the surface in hexagons, generation level
//! by generation level, and a few relaxation steps even the spacing out. A [`Sample`] holds the particles, a report on them and their
//! mesh. A [`Run`] does the same in steps.
//!
//! ```
//! use marching_particles::{Formula, Format, MeshFormat, Settings, gallery, sample};
//!
//! let surface = Formula::parse("x^4 + y^4 + z^4 = a")?.with("a", 0.5)?;
//! let cushion = sample(surface, &Settings::with_count(2_000))?;
//! cushion.write(Format::Ply, &mut Vec::new())?;
//!
//! // In a box of one's own, by the radius; the triangles between the particles close up to a torus.
//! let torus = gallery::find("torus").ok_or("no such surface")?;
//! let settings = Settings::with_radius(0.01).in_box(torus.bounds);
//! let sample = sample(torus.field(), &settings)?;
//! assert_eq!(sample.mesh().topology.components[0].euler(), 0);
//! sample.write_mesh(MeshFormat::Glb, &mut Vec::new())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! * f < 0 inside; the gradient and the normal point outward.
//! * Lengths are in the units of the field's own coordinates. A *repulsion radius* `r` belongs to every particle;
//!   neighbours sit `2r` apart.
//! * Angles are in radians, and names say so (`angle_rad`); those of the quality figures are in degrees.
//! * Single precision and SIMD lanes in the sampler, double precision in the oracles and the set-up.
//! * The same field, settings and seed give the same particles to the last bit, natively and in WebAssembly: the order
//!   of every sum is fixed, no clock or platform function is asked, transcendentals are [our own](math::functions).
//! * A `Result` is for the user's data, a [`StopReason`] for what a run met, a [`Warning`] for what its user should know, a panic for
//!   a mistake in the calling code; routines that can panic say when.
//!
//! # Glossary
//!
//! One word for one thing, in code, comments and on the page.
//!
//! | Term | Meaning |
//! |---|---|
//! | field | The function f(x, y, z); f < 0 inside. |
//! | surface | The zero set of the field within the clip box. |
//! | component | A connected part of the surface. |
//! | sheet | A part of the surface near one point that is a graph over its tangent plane. Two sheets may be close in space and far along the surface. |
//! | singular point | A point of the surface where ∇f = 0, so that there is no normal. |
//! | tip, nappe | An isolated point at which sheets end as cones, and one of these sheets. |
//! | clip box | The axis-aligned box outside of which nothing is sampled. |
//! | fitted box | A clip box around all bounded components of the surface, with room for particles. |
//! | border | The curves along which the surface ends: where the clip box cuts it, or f ends. Of a mesh, the edges of one triangle alone. |
//! | particle | A point of the sample, with position, normal and repulsion radius. |
//! | repulsion radius, r | Half of the wanted distance between neighbours. |
//! | radius field | The repulsion radius as a function on the surface, in adaptive sampling. |
//! | radius law | The repulsion radius that the curvature alone asks for. |
//! | grading | Limiting the radius field to a Lipschitz slope. |
//! | survey | The first look at the box on a grid: area, scale of the gradient, candidates for seeds. |
//! | seed | A first particle, from which a front grows. |
//! | witness | A point of the surface that interval arithmetic found, at least one on each component. |
//! | completeness | Whether every component is proven to have a witness, and every witness to be on the component of a particle or named. |
//! | cell | A box of the octree, or of a grid of particles. |
//! | undecided cell | A cell of the octree that may hold a component and could not be decided. |
//! | front | The particles of the newest generation level, which grow over the surface. |
//! | generation level | The number of parent links from a particle to its seed; a level is placed as one batch. |
//! | branch | A smooth function that gives f where its maxima, minima and absolute values take certain operands. |
//! | patch | A part of the surface on which one branch gives f. |
//! | crease, corner | A curve along which two patches meet at an angle; a point at which creases meet. |
//! | row | An entry of the particle columns. A particle on a crease has one for each patch. |
//! | parent, child | A particle, and one that it proposed. |
//! | slot | One of a parent's places for children; six of them 60° apart in uniform sampling. |
//! | arc | An interval of directions around a parent that is free for children, in adaptive sampling. |
//! | fate | The state of a slot: open, the parent's, added, matched, not converged, outside, undefined or capped. |
//! | match radius | The distance below which a child is identified with an existing particle. |
//! | provisional | Said of a child that is entered but not yet projected. |
//! | projection | Moving a point onto the surface: along a circle around its parent, or down the gradient. |
//! | landing | The result of a projection. |
//! | seam | Where two fronts, or two parts of one, meet out of step. |
//! | gap | A hole at a seam wide enough for a particle. |
//! | relaxation | Moving all particles against their repulsion, step by step. |
//! | energy | The sum over neighbour pairs that the relaxation lowers. |
//! | flow | Particles of a finished run that follow a surface while it moves, frame by frame. |
//! | transport | Moving the particles of a flow down the gradient to the new surface. |
//! | refinement | Ordering a coarse front as a mesh and halving its edges, level by level. |
//! | defect | A particle of a mesh whose valence is not six, or on the border not four. |
//! | neighbour list | The particles within the range of the repulsion and a skin, kept from step to step. |
//! | Verlet skin | What the lists reach beyond the range, so that they stay complete while particles move. |
//! | stale list | A list whose particle has travelled half of its skin since the list was made. |
//! | natural neighbours | The particles whose Voronoi cells share an edge in the tangent plane. |
//! | one-ring | The natural neighbours of a particle in order around it. |
//! | valence | The number of natural neighbours; six in a hexagonal lattice. |
//! | hexagonal spacing, d_hex | The spacing of a perfect hexagonal lattice of as many particles on the same area. |
//! | residual | \|f\|/\|∇f\|, the distance to the surface to first order; where f has no gradient, \|f\| over its slope along the normal. |
//! | fission, death | Splitting and removal of particles, in the system of Witkin and Heckbert. |
//! | budget | A count of work units after which a step returns. It is never a time. |
//! | slice | A share of long work between two returns to the caller. |
//! | graph, program | A formula as a list of operations in single-assignment form, and what that is compiled to. |
//! | jet | A value with its gradient and Hessian. |
//! | batch, lanes | Points evaluated by one call, and those of them computed by one SIMD instruction. |
//!
//! # What stands at the root
//!
//! | For | Items |
//! |---|---|
//! | the job | [`sample`], [`Sample`], [`Run`], [`Start`], [`Progress`], [`Phase`], [`StopReason`], [`Reporting`] |
//! | its settings | [`Settings`], [`Sampling`], [`SizeMode`], [`LawKind`], [`Method`], [`GapPolicy`], [`Bounds`], [`Reach`] |
//! | formulas | [`Formula`], [`Parameter`], [`FormulaError`], [`FormulaErrorKind`], [`Mended`], [gallery] |
//! | fields of a program | [`Field`], [`FnField`], [`Jet`], [`Sym3`], [`Bounded`], [`Enclosure`], [`Interval`], [`UnitCell`], [glam] |
//! | surfaces through points | [`fit_points`], [`CENTRES`], [`Fit`], [`ModelInfo`], [`NormalSource`], [`GivenMesh`], [`GivenTopology`], [`RbfField`] |
//! | particles and meshes | [`Particles`], [`Slots`], [`SlotFate`], [`OppositeFaces`], [`Triangulation`], [`Topology`], [`Component`], [`MeshAnswer`], [`MeshComponent`] |
//! | the report | [`Report`], [`Radii`], [`Growth`], [`FateCounts`], [`Proof`], [`Search`], [`Sampled`], [`Unsampled`], [`Measures`], [`Cut`] |
//! | its figures | [`Figures`] with the groups in [figures], [`Histogram`], [`Places`], [`Pair`], [`Hole`], [`Measurements`] |
//! | what may be wrong | [`Warning`], [`Doubt`], [`Refusal`], [`Spot`] |
//! | why there is no result | [`Error`], [`SettingsError`], [`BoxError`]; of points [`JobError`], [`ReadError`], [`InputFormat`], [`CloudError`], [`FitError`] |
//! | files | [`Format`], [`ParticleFile`], [`MeshFormat`], [`MeshFile`], [`Placement`], [`Unit`], [`UpAxis`], [`RecordText`] |
//!
//! The modules behind the root are public for the project's own tests, benchmarks and page, without a promise to stay; ARCHITECTURE.md says
//! what each is for and who may use whom.

#[doc(hidden)]
pub mod differential;
#[doc(hidden)]
pub mod export;
#[doc(hidden)]
pub mod extent;
#[doc(hidden)]
pub mod field;
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
#[doc(hidden)]
pub mod render;
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
#[cfg(target_arch = "wasm32")]
#[doc(hidden)]
pub mod web;

pub use export::{Format, MeshFile, MeshFormat, ParticleFile, Placement, RecordText, Unit, UpAxis};
pub use extent::Reach;
pub use field::formula::{Formula, FormulaError, FormulaErrorKind, Mended, Parameter};
#[cfg(feature = "points")]
pub use field::model::{CENTRES, GivenMesh, GivenTopology, ModelInfo, NormalSource};
#[cfg(feature = "points")]
pub use field::rbf::RbfField;
pub use field::{Bounded, Enclosure, Field, FnField, Jet, UnitCell, gallery};
pub use glam;
pub use math::{Bounds, BoxError, Interval, Sym3};
pub use mesh::build::Triangulation;
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
pub use quality::{Figures, Histogram, Hole, Measurements, Pair, Places, figures};
pub use run::{
    Cut, Error, Growth, Measures, MeshAnswer, MeshComponent, Proof, Radii, Report, Reporting, Run, Sample,
    Start, Warning, sample,
};
pub use sampler::{
    Doubt, FateCounts, FollowError, GapPolicy, LawKind, Method, Phase, Progress, Refusal, Sampled, Sampling,
    Search, Settings, SettingsError, SizeMode, Spot, StopReason, Unsampled,
};
pub use topology::{Component, Topology};

/// The examples of the README, so that they are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
