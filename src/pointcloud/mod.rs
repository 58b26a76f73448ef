//! Surfaces through points: a function fitted to the points of a file, by [`fit_points`].
//!
//! A file is read to points with normals. A few hundred of them, far apart, become the centres of a
//! radial basis function, which a linear system fits to all points: an [`RbfField`]. The sampler's
//! core needs nothing else, so the page can solve in a separate module and worker.

mod border;
mod eigen;
#[doc(hidden)]
pub mod fit;
#[doc(hidden)]
pub mod job;
#[doc(hidden)]
pub mod models;
#[doc(hidden)]
pub mod normals;
#[doc(hidden)]
pub mod read;
mod solve;
#[doc(hidden)]
pub mod thin;

pub use crate::field::model::{CENTRES, GivenMesh, GivenTopology, ModelInfo, NormalSource};
pub use crate::field::rbf::RbfField;
pub use fit::{Fit, FitError};
pub use job::JobError;
pub use read::{InputFormat, ReadError};

use crate::field::model::{DEFAULT_CENTRES, Model};
use crate::slices;
use glam::DVec3;
use job::Job;

/// Fits a surface to the points of a file: PLY, OBJ, STL, OFF, GLB, 3MF, PCD, or text with one
/// point on a line (XYZ, PTS, CSV). The content decides; if it is ambiguous, the extension of
/// `name`. A function with this number of `centres`, one of [`CENTRES`], is fitted to all points;
/// cross-validation decides how much noise is smoothed. Normals come from the file, else from its
/// faces, else they are estimated. Large faces get more points, so that the surface follows them.
/// 3MF needs the feature `images`.
///
/// # Errors
///
/// If the file cannot be read or its points give no surface. The error says what is wrong, where,
/// and what to do.
pub fn fit_points(name: &str, bytes: Vec<u8>, centres: u32) -> Result<Fit, JobError> {
    slices::in_pool(|| Job::file(name, bytes, centres)?.complete())
}

/// Fit of a built-in model with all of its points as centres.
///
/// # Panics
///
/// Never: a test calls it for every model.
#[doc(hidden)]
#[must_use]
pub fn fit_model(model: &Model) -> Fit {
    let fit = Job::model(model.id, DEFAULT_CENTRES).and_then(Job::complete);
    fit.unwrap_or_else(|error| panic!("model `{}`: {error}", model.id))
}

/// Points, with unit normals that point outward.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(hidden)]
pub struct Cloud {
    /// Positions.
    pub position: Vec<DVec3>,
    /// Unit normals, one for each position; empty if they are still to be estimated.
    pub normal: Vec<DVec3>,
    /// Source of the normals.
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

    /// Removes the points whose normals are zero.
    fn retain_with_normal(&mut self) {
        let mut stays = self.normal.iter().map(|normal| *normal != DVec3::ZERO);
        self.position.retain(|_| stays.next().unwrap_or(false));
        self.normal.retain(|normal| *normal != DVec3::ZERO);
    }

    /// The points with these indices, in this order.
    #[must_use]
    pub fn only(&self, indices: &[u32]) -> Self {
        let of = |column: &[DVec3]| indices.iter().filter_map(|&i| column.get(i as usize).copied()).collect();
        Self { position: of(&self.position), normal: of(&self.normal), source: self.source }
    }
}

/// Why no surface can be fitted to points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// All points coincide.
    #[error("all points are at the same place; a surface takes points all round it")]
    OnePlace,
    /// All points lie on a line.
    #[error("all points lie on a straight line; a surface takes points all round it")]
    Line,
    /// All points lie in a plane.
    #[error("all points lie in a plane; a surface takes points all round it")]
    Plane,
    /// There is not enough memory for the points.
    #[error("there is not enough memory for these points; give fewer, for example every tenth")]
    Memory,
}
