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
//! # Modules
//!
//! ```text
//! math ← field ← differential ← sampler ← session ← web
//!           ↑              ↖ quality ← export ↙
//!       pointcloud
//! ```
//!
//! An arrow points at what is used; `tests/architecture.rs` names every use that is allowed and fails on any other.
//!
//! * [`math`]: lanes, elementary functions, symmetric matrices, boxes.
//! * [`field`]: values, gradients and Hessians, from a formula or from the gallery.
//! * [`differential`]: principal curvatures and directions of the surface.
//! * [`spatial`] and [`particles`]: the cell grid and the columns. They know no field.
//! * `pieces`: long work that can be left and gone on with, as measuring is.
//! * [`trace`]: the log with which the adaptive front can be replayed.
//! * [`sampler`]: discovery, fronts, relaxation, as a state machine with a budget.
//! * [`baseline`]: the particle systems that the paper compares its method with, natively only.
//! * [`quality`]: figures about a set of particles, whatever made it: it never uses the sampler.
//! * [`pointcloud`]: from a file of points to a field (feature `points`, on by default).
//! * [`mesh`]: triangles over particles, whatever made them.
//! * [`export`]: particles as PLY, CSV, XYZ and NPY; meshes as GLB, OBJ, STL and PLY.
//! * [`answer`]: what a command of the page is answered.
//! * [`session`]: a field, a sampler and a run together; what the page talks to.
//! * [`render`]: the renderer of the page, on slices and camera numbers alone (feature `webgpu` or `webgl`).
//! * `web`: what JavaScript sees, on `wasm32` only.

pub mod answer;
#[cfg(not(target_arch = "wasm32"))]
pub mod baseline;
pub mod differential;
pub mod export;
pub mod field;
pub mod math;
pub mod mesh;
pub mod particles;
mod pieces;
#[cfg(feature = "points")]
pub mod pointcloud;
pub mod quality;
pub mod render;
pub mod sampler;
pub mod session;
pub mod spatial;
pub mod trace;
#[cfg(target_arch = "wasm32")]
pub mod web;

/// The examples of the README, so that they are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
