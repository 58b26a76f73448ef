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
//! // In the box of the gallery and by radius. The triangles between the particles form a torus.
//! let torus = gallery::find("torus").ok_or("no such surface")?;
//! let sample = sample(torus.field(), &Settings::with_radius(Radius::Share(0.01)))?;
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
//! # Modules
//!
//! At the root stands what most programs use. The rest has a module for each subject:
//!
//! | For | At the root | More |
//! |---|---|---|
//! | sampling | [`sample`], [`Sample`], [`Run`], [`Progress`], [`StopReason`] | [`run`]: what is measured, values of a program, what may be wrong |
//! | how | [`Settings`], [`Sampling`], [`Radius`], [`Spacing`], [`SizeMode`], [`LawKind`], [`Method`], [`Pattern`], [`Counting`], [`GapPolicy`], [`Bounds`] | [`sampler`]: what a run tells of itself |
//! | of what | [`Formula`], [`gallery`], [`Field`] | [`field`]: functions of a program in every form |
//! | solids of several fields | [`union`], [`intersection`], [`difference`], [`smooth_union`], [`offset`] | |
//! | points, images, meshes | [`fit_points`], [`Image`], [`TriangleMesh`] | [`pointcloud`], [`image`], [`remesh`] |
//! | with what result | [`Particles`], [`Report`], [`Warning`], [`Error`] | [`particles`], [`mesh`]: triangles, bodies, topology; [`quality`]: the figures |
//! | in which file | [`Format`], [`MeshFormat`] | [`export`]: record, size and place of a mesh |
//!
//! Vectors are those of [glam].
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
//!   transcendental functions are our own.
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
//! several threads at once. A program that does such work in [steps](run::Reporting::step) takes
//! them in a thread of the pool, as within `rayon::scope`: another thread would wait for each
//! share.
//!
//! # Glossary
//!
//! The words of the paper, and those that the code adds to them. One word for one thing.
//!
//! | Term | Meaning |
//! |---|---|
//! | particle | A point of the sample, with position, normal and repulsion radius. |
//! | repulsion radius, r | Half of the distance between neighbours that the sampler aims at; the size of a particle. |
//! | spacing | The distance between neighbours, 2r. Of voxels: the distance between their centres. |
//! | front | The particles of the newest generation level, which grow over the surface. |
//! | seed | A first particle, from which a front grows. |
//! | parent, child | A particle, and one that it proposed. |
//! | slot | One of a parent's places for children; six of them 60° apart in uniform sampling. |
//! | generation level | The number of parent links from a particle to its seed; a level is placed as one batch. A level of a refinement is another thing: one halving of all edges. |
//! | fate | What became of a slot: open, the parent's, added, matched, not converged, outside, undefined or capped. |
//! | projection | Moving a point onto the surface: along a circle around its parent, or down the gradient. |
//! | relaxation | Moving all particles against their repulsion, step by step. |
//! | energy | The sum over neighbour pairs that the relaxation lowers. |
//! | fission, death | Splitting and removal of particles, in the system of Witkin and Heckbert. |
//! | field | The function f(x, y, z); f < 0 inside. |
//! | component | A connected part of the surface. |
//! | body, chip | Of a mesh: a closed component with the walls of its hollows, or an open component; one that is small beside the largest. |
//! | sheet | A part of the surface that is a graph over its tangent plane. Two sheets may be close in space and far along the surface. |
//! | shell | The solid that a thickness makes of a surface. |
//! | survey | The first look at a field, on a grid over the box: area, points where fronts may begin, the precision that particles need. |
//! | cell | A box of a grid or of a search, unless it is a unit cell, whose opposite faces have the same particles, or a Voronoi cell. |
//! | residual | \|f\|/\|∇f\|, the distance to the surface to first order. |
//! | witness | A point of the surface that interval arithmetic found, at least one on each component. |
//! | crease, corner, patch | A curve along which two smooth parts of the surface meet at an angle, its sharp edge; a point where creases meet; such a part. |
//! | edge | Of the surface: a crease. Of a mesh: a side of its faces. |
//! | piece | A smooth function that gives f in a part of space, as each operand of a maximum does. |
//! | row | An entry of the particle columns. A particle on a crease or a smooth join has one for each patch. |
//! | smooth join | A curve along which two patches meet without an edge; `seams` in reports and columns. |
//! | seam | A line along which fronts meet out of step: its particles have five or seven neighbours. |
//! | gap | A place between fronts that is wide enough for a particle. |
//! | crack | Of a mesh: an opening between patches in which no particle fits. |
//! | hole | Of a sample: an empty disc on the surface. Of a mesh: a closed curve of open edges. |
//! | natural neighbours, valence | The particles whose Voronoi cells share an edge in the tangent plane; their number, six in a hexagonal lattice. |
//! | defect | A particle of a mesh whose valence is not six, or on the border not four. |
//! | refinement | Ordering a coarse front as a mesh and halving its edges, level by level. |
//! | flow | Particles of a finished run that follow a moving surface, frame by frame. |

#![cfg_attr(
    target_arch = "wasm32",
    allow(
        clippy::arc_with_non_send_sync,
        reason = "a field may hold a function of JavaScript, which is sent nowhere"
    )
)]

pub mod export;
pub mod field;
#[cfg(feature = "images")]
pub mod image;
pub mod mesh;
pub mod particles;
#[cfg(feature = "points")]
pub mod pointcloud;
pub mod quality;
#[cfg(all(feature = "images", feature = "points"))]
pub mod remesh;
pub mod run;
pub mod sampler;

mod differential;
mod extent;
mod lesson;
mod math;
mod paper;
mod session;
mod slices;
mod spatial;
mod topology;

#[cfg(all(test, feature = "points"))]
mod page_types {
    mod tests;
}

/// The parts that the project's page, command line, Python package and tests use beyond the
/// interface. They may change at any time, as may what is hidden in the modules above.
#[doc(hidden)]
pub mod internal {
    pub mod differential {
        pub use crate::differential::*;
    }
    pub mod extent {
        pub use crate::extent::*;
    }
    pub mod lesson {
        pub use crate::lesson::*;
    }
    pub mod math {
        pub use crate::math::*;
    }
    pub mod paper {
        pub use crate::paper::*;
    }
    pub mod session {
        pub use crate::session::*;
    }
    pub mod slices {
        pub use crate::slices::*;
    }
    pub mod spatial {
        pub use crate::spatial::*;
    }
}

#[doc(inline)]
pub use export::{Format, MeshFormat};
#[doc(inline)]
pub use field::formula::Formula;
#[doc(inline)]
pub use field::{Field, difference, gallery, intersection, offset, smooth_union, union};
pub use glam;
#[cfg(feature = "images")]
#[doc(inline)]
pub use image::Image;
pub use math::Bounds;
#[doc(inline)]
pub use particles::Particles;
#[cfg(feature = "points")]
#[doc(inline)]
pub use pointcloud::fit_points;
#[cfg(all(feature = "images", feature = "points"))]
#[doc(inline)]
pub use remesh::TriangleMesh;
#[doc(inline)]
pub use run::{Error, Report, Run, Sample, Warning, sample};
#[doc(inline)]
pub use sampler::{
    Counting, GapPolicy, LawKind, Method, Pattern, Progress, Radius, Sampling, Settings, SizeMode, Spacing,
    StopReason,
};

/// The examples of the README, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
