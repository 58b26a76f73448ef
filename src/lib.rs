//! Evenly spaced particles on an implicit surface f(x, y, z) = 0.
//!
//! # Conventions
//!
//! * f < 0 inside; the gradient and the normal point outward.
//! * Lengths are in the units of the field's own coordinates. A *repulsion radius* `r` belongs to every
//!   particle; neighbours sit `2r` apart.
//! * Single precision in the sampler, double precision in the oracles and the set-up.

pub mod export;
pub mod field;
pub mod json;
pub mod math;
pub mod particles;
pub mod quality;
pub mod render;
pub mod sampler;
pub mod session;
pub mod spatial;
#[cfg(target_arch = "wasm32")]
pub mod web;
