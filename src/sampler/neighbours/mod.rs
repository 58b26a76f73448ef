//! Neighbour search among particles: grids for the fronts, and the neighbour lists of the
//! relaxation.

pub(crate) mod constants;
pub(crate) mod grids;
pub(crate) mod lists;
pub(crate) mod packed;
