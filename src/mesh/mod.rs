//! Triangle meshes whose vertices are particles. Positions and normals are enough: this module
//! knows no field and no sampler.
//!
//! A mesh passes between modules as plain data, a list of triangles: triples of particle indices,
//! counter-clockwise seen from outside.
//!
//! * [`triangulation`]: from points with normals to triangles.
//! * [`facing`]: which side of a closed mesh is its inside.
//! * [`bodies`]: the pieces of a mesh, and which of them are loose chips.
//! * `stars`: the natural neighbours of points.
//! * [`half_edge`]: a surface that can be changed: flips, splits, collapses and insertions, which a
//!   journal can undo; subdivision.
//!
//! [`topology`](crate::topology) counts the components, borders and Euler number of such a list.

pub mod bodies;
pub mod facing;
pub mod half_edge;
pub(crate) mod stars;
pub mod triangulation;
