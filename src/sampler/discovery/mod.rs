//! A first point on every connected component of the surface, and the proof that none is missed.
//!
//! The [`survey`] evaluates the field on a grid of the box. What it may miss, the [`octree`] finds
//! by interval arithmetic: a highest point of every component. The [`search`] returns those points
//! that no particle covers yet. At the end of a run the [`audit`] finds out which of them have a
//! particle on their component.

pub(crate) mod audit;
mod cell;
pub(crate) mod completeness;
mod creased;
mod dips;
mod fate;
pub(crate) mod grid;
mod interval_newton;
pub(crate) mod nearness;
pub(crate) mod octree;
pub(crate) mod precision;
pub(crate) mod search;
pub(crate) mod sheets;
pub(crate) mod singular;
pub(crate) mod survey;
