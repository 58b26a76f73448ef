//! Triangle meshes whose vertices are particles. Positions and normals are enough: this module
//! knows no field and no sampler.
//!
//! A [`Triangulation`] is made from points with normals. A mesh is a list of triangles: triples of
//! particle indices, counter-clockwise seen from outside. Its [`Topology`] counts components,
//! borders and Euler number, a [`Body`] is one of its pieces, and [`Inside`] says which side of a
//! closed mesh is its inside.

#[doc(hidden)]
pub mod bodies;
#[doc(hidden)]
pub mod facing;
// A surface that can be changed: flips, splits, collapses and insertions, which a journal can undo.
#[doc(hidden)]
pub mod half_edge;
// The natural neighbours of points.
pub(crate) mod stars;
#[doc(hidden)]
pub mod triangulation;

pub use crate::topology::{Component, Topology};
pub use bodies::Body;
pub use facing::Inside;
pub use triangulation::Triangulation;
