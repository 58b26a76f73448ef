//! What is known of models from points, beside their functions: what the built-in ones are, where points come from and how
//! well they are met. The points themselves and the fitting are in the module `points`, which the core does without.

use crate::math::Bounds;
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

/// What goes with a solved system from where it was solved to where it is sampled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolvedModel {
    /// What is known of the model.
    pub info: ModelInfo,
    /// The box to sample in.
    pub bounds: Bounds,
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

/// To be named wherever the bunny is shown, by the terms of its scan.
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

/// The built-in model with this identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static Model> {
    MODELS.iter().find(|model| model.id == id)
}
