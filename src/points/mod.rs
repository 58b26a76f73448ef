//! Models from points: from a file, or from the points that are built in, to an interpolating function.
//!
//! The way is [`Cloud`] (read, with normals) → a few hundred centres that are far from each other → a solved system,
//! `RbfData`. All of it is outside of the core that samples, which takes the solved system alone:
//! the page solves in a module and a worker of its own.

pub use crate::field::model::{ModelInfo, NormalSource};

use glam::DVec3;

/// Points with unit normals that point outward.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Positions.
    pub position: Vec<DVec3>,
    /// Unit normals, as many as positions; none at all if they are still to be estimated.
    pub normal: Vec<DVec3>,
    /// Where the normals come from.
    pub source: NormalSource,
}

impl Cloud {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }
}
