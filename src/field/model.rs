//! Descriptions of models from points: the built-in ones, and reports of fits.
//!
//! The points themselves and the fitting are in the module `pointcloud`, which the core of the page
//! is built without.

use crate::math::Bounds;
use core::ops::RangeInclusive;
use serde::{Deserialize, Serialize};

/// Numbers of centres that can be requested, for example from [`fit_points`](crate::fit_points).
pub const CENTRES: RangeInclusive<u32> = 100..=800;
/// Maximum size of a file of points in bytes. Fifty million bytes hold some millions of points,
/// thousands of times more than an interpolant can have centres.
pub const MAX_FILE_BYTES: u32 = 50_000_000;
/// Default number of centres, as in the paper's models (§6).
pub const DEFAULT_CENTRES: u32 = 200;

/// Origin of the normals of a model's points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum NormalSource {
    /// The normals were given with the points.
    #[default]
    Given,
    /// Each normal is the area-weighted mean of the normals of the faces around its point.
    FromMesh,
    /// The normals were estimated from the neighbours of each point.
    Estimated,
}

/// Report of a model from points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ModelInfo {
    /// Name of the built-in model or of the file.
    pub name: String,
    /// Credit for the points; empty for a file.
    pub credit: String,
    /// Number of points read.
    pub points: u32,
    /// Number of centres of the function. If every point is one, the surface goes through all of
    /// them.
    pub centres: u32,
    /// Estimated condition number of the system.
    pub condition: f64,
    /// Mean residual |f|/|∇f| of all distinct points read, as a share of the diagonal of their box:
    /// their distance from the surface to first order (G. Taubin, "Estimation of Planar Curves,
    /// Surfaces, and Nonplanar Space Curves Defined by Implicit Equations", 1991).
    pub residual_mean: f64,
    /// Residual that 95 % of the points do not exceed, as a share of that diagonal.
    pub residual_95: f64,
    /// Maximum residual, as a share of that diagonal.
    pub residual_max: f64,
    /// Position of the point with the maximum residual.
    pub farthest: [f64; 3],
    /// The mesh of the file, if it has faces.
    pub mesh: Option<GivenMesh>,
    /// Share of the area of the fitted surface in its box that lies beyond the border of the
    /// points; 0 without a border.
    #[serde(default)]
    pub beyond_share: f64,
    /// Origin of the normals.
    pub normals: NormalSource,
    /// Warnings for the user, as sentences: they go from the bundle that fits a model to the one
    /// that samples it.
    pub warnings: Vec<String>,
}

/// The mesh of a file, without repairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct GivenMesh {
    /// Area of all faces, in the units of the file.
    pub area: f64,
    /// Components, Euler number and border loops, if every edge has one or two faces of equal
    /// orientation. Corners that coincide in single precision are one.
    pub topology: Option<GivenTopology>,
}

/// The connectivity of the mesh of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct GivenTopology {
    /// Number of connected components.
    pub components: usize,
    /// Euler number: vertices − edges + faces.
    pub euler: i64,
    /// Number of border loops, if the mesh is open.
    pub borders: usize,
}

/// Report and box that accompany a solved system to the session that samples it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct SolvedModel {
    /// Report of the model.
    pub info: ModelInfo,
    /// Box to sample in.
    pub bounds: Bounds,
}

/// A built-in model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Model {
    /// Identifier: lower case, words joined by hyphens. No gallery surface has the same one.
    pub id: &'static str,
    /// Name for the user.
    pub name: &'static str,
    /// Two sentences about the model.
    pub story: &'static str,
    /// Credit for the points.
    pub credit: &'static str,
    /// Number of points.
    pub points: u32,
}

/// Credit that the terms of the scan require wherever the bunny is shown.
const STANFORD: &str = "Stanford Computer Graphics Laboratory";

/// The built-in models.
pub static MODELS: &[Model] = &[
    Model {
        id: "bunny",
        name: "Stanford bunny",
        story: "A clay rabbit that Greg Turk and Marc Levoy scanned at Stanford in 1994, rebuilt here from 200 points with \
                normals. The model of the same name in the paper has as many.",
        credit: STANFORD,
        points: 200,
    },
    Model {
        id: "bunny-joined",
        name: "Bunny with joined ears",
        story: "The bunny from 200 points of which none lies between the ears: nothing keeps them apart there, they grow \
                together, and the surface gets a handle. The paper's figure 9 shows the same.",
        credit: STANFORD,
        points: 200,
    },
    Model {
        id: "rabbit",
        name: "Sitting rabbit",
        story: "200 points of a rabbit made of twelve ellipsoids that blend into each other. It stands in for the paper's \
                rabbit, whose points are not public.",
        credit: "",
        points: 200,
    },
    Model {
        id: "sack-and-hat",
        name: "Figure with sack and hat",
        story: "200 points of a figure made of fifteen ellipsoids that blend into each other: folds, a bobble and a sack on \
                the back. It stands in for the paper's Santa, whose points are not public.",
        credit: "",
        points: 200,
    },
];

/// Built-in model with the identifier `id`.
#[must_use]
pub fn find(id: &str) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.id == id)
}
