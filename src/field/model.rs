//! What is known of models from points, beside their functions: what the built-in ones are, where points come from and how
//! well they are met. The points themselves and the fitting are in the module `points`, which the core does without.

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

/// A built-in model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Model {
    /// Identifier: lower case, words joined by hyphens; no gallery surface has the same.
    pub id: &'static str,
    /// Name for a person.
    pub name: &'static str,
    /// Two sentences about it.
    pub story: &'static str,
    /// Whom to thank for the points.
    pub credit: &'static str,
    /// Number of points.
    pub points: u32,
}

const STANFORD: &str = "Stanford Computer Graphics Laboratory";

/// The built-in models.
pub static MODELS: &[Model] = &[
    Model {
        id: "bunny",
        name: "Stanford bunny",
        story: "A clay rabbit scanned at Stanford in 1994, here from 200 points with normals. The paper's model of the \
                same name has 200 points, too.",
        credit: STANFORD,
        points: 200,
    },
    Model {
        id: "bunny-joined",
        name: "Bunny with joined ears",
        story: "The bunny without its points between the ears: nothing keeps them apart there, and they grow together \
                to a handle, as in figure 9 of the paper. It takes no change of the method to sample it.",
        credit: STANFORD,
        points: 190,
    },
];

/// The built-in model with this identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.id == id)
}
