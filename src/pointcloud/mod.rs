//! Models from points: from a file, or from the points that are built in, to an interpolating function.
//!
//! The way is [`Cloud`] (read, with normals) → a few hundred centres that are far from each other → a solved system,
//! `RbfData`. All of it is outside of the core that samples, which takes the solved system alone:
//! the page solves in a module and a worker of its own.

mod eigen;
pub mod fit;
pub mod job;
pub mod models;
pub mod normals;
pub mod read;
mod solve;
mod table;
pub mod thin;

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

    /// The points with these indices, in this order.
    #[must_use]
    pub fn only(&self, indices: &[u32]) -> Self {
        let of = |column: &[DVec3]| indices.iter().filter_map(|&i| column.get(i as usize).copied()).collect();
        Self { position: of(&self.position), normal: of(&self.normal), source: self.source }
    }
}

/// Why nothing can be made of points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CloudError {
    /// All of them are one point.
    #[error("all points are at the same place; a surface takes points all round it")]
    OnePlace,
    /// All of them lie on a line.
    #[error("all points lie on a straight line; a surface takes points all round it")]
    Line,
    /// All of them lie in a plane.
    #[error("all points lie in a plane; a surface takes points all round it")]
    Plane,
    /// The memory does not hold them.
    #[error("there is not enough memory for these points; give fewer, for example every tenth")]
    Memory,
}
