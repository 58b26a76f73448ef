//! The stages of the [methods](super::methods). A stage works on a [cover](super::cover) of the
//! surface, in slices, and may be stopped between any two of them.

pub(super) mod coarse;
pub(super) mod covering;
pub(super) mod drawing;
pub(super) mod following;
pub(super) mod refining;
pub(super) mod relaxing;
