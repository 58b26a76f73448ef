//! What is known of a model from points, beside its function: where its points come from and how well they are met.

use serde::{Deserialize, Serialize};

/// Where the normals of a model's points come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NormalSource {
    /// They came with the points.
    #[default]
    Given,
    /// From the faces around each point, weighted by area.
    FromMesh,
    /// From each point's neighbours.
    Estimated,
}

/// A model from points, as it is reported.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelInfo {
    /// What it is called: a built-in model's name or the file's.
    pub name: String,
    /// Whom to thank for the points; empty for a file.
    pub credit: String,
    /// Points that were read.
    pub points: u32,
    /// Points that the function interpolates.
    pub centres: u32,
    /// Estimate of the condition number of the system that was solved.
    pub condition: f64,
    /// Mean distance of all points from the surface, |f|/|∇f|, as a share of the diagonal of the points' box.
    pub residual_mean: f64,
    /// The largest such distance.
    pub residual_max: f64,
    /// Where the normals come from.
    pub normals: NormalSource,
    /// Things the user should know, in words.
    pub warnings: Vec<String>,
}
