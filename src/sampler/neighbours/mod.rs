//! Who is near whom: grids over the particles of a front, and the neighbour lists of the relaxation.

pub(crate) mod constants;
pub(crate) mod grids;
pub(crate) mod lists;
pub(crate) mod packed;
