//! Evenly spaced particles on an implicit surface f(x, y, z) = 0.
//!
//! A [`Sampler`](sampler::Sampler) covers the zero set of a [`Field`](field::Field) in a box with particles: a front grows
//! over the surface in hexagons, generation level by generation level, and a few relaxation steps even the spacing out.
//! Fields are [formulas](field::formula), entries of the [gallery](field::gallery), or anything that implements the trait.
//!
//! ```
//! use marching_particles::field::gallery;
//! use marching_particles::quality::{self, Options};
//! use marching_particles::sampler::{Sampler, Settings};
//!
//! let torus = gallery::find("torus").expect("a surface of the gallery");
//! let mut field = torus.field();
//! let settings = Settings { radius_share: 0.01, ..Settings::default() };
//!
//! let mut sampler = Sampler::new();
//! sampler.start(&mut field, &torus.bounds, &settings)?;
//! // A budget is a count of work, never a time: cut as you like, the particles are the same to the last bit.
//! while sampler.step(&mut field, 1_000).stop_reason.is_none() {}
//!
//! let particles = sampler.particles();
//! let report = quality::measure(
//!     &particles.position, &particles.normal, &mut field, Some(&torus.bounds), &Options::default(),
//! );
//! // The triangles between the particles close up to a torus, and most particles have six neighbours.
//! assert_eq!(report.figures.euler, 0);
//! assert!(report.figures.six > 0.8);
//! # Ok::<(), marching_particles::sampler::SettingsError>(())
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
//! * A `Result` is for the user's data, a [`StopReason`](sampler::StopReason) for what a run met, a panic for a mistake
//!   in the calling code; routines that can panic say when.
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
//! | clip box | The axis-aligned box outside of which nothing is sampled. |
//! | fitted box | A clip box around all bounded components of the surface, with room for particles. |
//! | reach | Whether the surface lies in its fitted box, goes on beyond it, or is nowhere. |
//! | border | Where the clip box cuts the surface. |
//! | particle | A point of the sample, with position, normal and repulsion radius. |
//! | repulsion radius, r | Half of the wanted distance between neighbours. |
//! | radius field | The repulsion radius as a function on the surface, in adaptive sampling. |
//! | radius law | The repulsion radius that the curvature alone asks for. |
//! | grading | Limiting the radius field to a Lipschitz slope. |
//! | survey | The first look at the box on a grid: area, scale of the gradient, candidates for seeds. |
//! | seed | A first particle, from which a front grows. |
//! | witness | A point of the surface that interval arithmetic found, at least one on each component. |
//! | completeness | Whether every component is proven to have a witness. |
//! | cell | A box of the octree, or of a grid of particles. |
//! | undecided cell | A cell of the octree that may hold a component and could not be decided. |
//! | front | The particles of the newest generation level, which grow over the surface. |
//! | generation level | The number of parent links from a particle to its seed; a level is placed as one batch. |
//! | parent, child | A particle, and one that it proposed. |
//! | slot | One of a parent's places for children; six of them 60° apart in uniform sampling. |
//! | arc | An interval of directions around a parent that is free for children, in adaptive sampling. |
//! | fate | What became of a slot: added, matched, not converged, outside, undefined, capped. |
//! | match radius | The distance below which a child is identified with an existing particle. |
//! | provisional | Said of a child that is entered but not yet projected. |
//! | projection | Moving a point onto the surface: along a circle around its parent, or down the gradient. |
//! | landing | The result of a projection. |
//! | seam | Where two fronts, or two parts of one, meet out of step. |
//! | gap | A hole at a seam wide enough for a particle. |
//! | relaxation | Moving all particles against their repulsion, step by step. |
//! | energy | The sum over neighbour pairs that the relaxation lowers. |
//! | neighbour list | The particles within the range of the repulsion and a skin, kept from step to step. |
//! | Verlet skin | What the lists reach beyond the range, so that they stay complete while particles move. |
//! | stale list | A list whose particle has travelled half of its skin since the list was made. |
//! | natural neighbours | The particles whose Voronoi cells share an edge in the tangent plane. |
//! | one-ring | The natural neighbours of a particle in order around it. |
//! | valence | The number of natural neighbours; six in a hexagonal lattice. |
//! | hexagonal spacing, d_hex | The spacing of a perfect hexagonal lattice of as many particles on the same area. |
//! | residual | \|f\|/\|∇f\|, the distance to the surface to first order. |
//! | fission, death | Splitting and removal of particles, in the system of Witkin and Heckbert. |
//! | budget | A count of work units after which a step returns. It is never a time. |
//! | slice | A share of long work between two returns to the caller. |
//! | tape | A formula compiled to a list of operations in single-assignment form. |
//! | jet | A value with its gradient and Hessian. |
//! | batch, lanes | Points evaluated by one call, and those of them computed by one SIMD instruction. |
//!
//! # Modules
//!
//! ```text
//! math ← field ← differential ← sampler ← session ← web
//!           ↑      ↑       ↖ quality ← export ↙
//!       pointcloud  ↑   ↖ extent ← session
//!                  paper ← lesson ← web
//! ```
//!
//! An arrow points at what is used; `tests/architecture.rs` names every use that is allowed and fails on any other.
//!
//! * [`math`]: lanes, elementary functions, symmetric matrices, boxes.
//! * [`field`]: values, gradients and Hessians, from a formula or from the gallery.
//! * [`extent`]: how far a surface reaches, and the box that fits it.
//! * [`differential`]: principal curvatures and directions of the surface.
//! * [`spatial`] and [`particles`]: the cell grid and the columns. They know no field.
//! * `slices`: long work that can be left and gone on with, as measuring is.
//! * [`sampler`]: discovery, fronts, relaxation, as a state machine with a budget.
//! * [`paper`]: the paper's algorithms, to be read beside it, and the oracle of the fast fronts.
//! * [`lesson`]: runs of them with a log of every event, and the methods that the paper compares them with.
//! * [`quality`]: figures about a set of particles, whatever made it: it never uses the sampler.
//! * [`pointcloud`]: from a file of points to a field (feature `points`, on by default).
//! * [`mesh`]: triangles over particles, whatever made them.
//! * [`export`]: particles as PLY, CSV, XYZ and NPY; meshes as GLB, OBJ, STL and PLY.
//! * [`answer`]: what a command of the page is answered.
//! * [`session`]: a field, a sampler and a run together; what the page talks to.
//! * [`render`]: the renderer of the page, on slices and camera numbers alone (feature `webgpu` or `webgl`).
//! * `web`: what JavaScript sees, on `wasm32` only.

pub mod answer;
pub mod differential;
pub mod export;
pub mod extent;
pub mod field;
pub mod lesson;
pub mod math;
pub mod mesh;
#[cfg(all(test, feature = "points"))]
mod page_types;
pub mod paper;
pub mod particles;
#[cfg(feature = "points")]
pub mod pointcloud;
pub mod quality;
pub mod render;
pub mod sampler;
pub mod session;
mod slices;
pub mod spatial;
pub mod topology;
#[cfg(target_arch = "wasm32")]
pub mod web;

/// The examples of the README, so that they are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
