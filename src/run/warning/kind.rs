//! The codes and the severities of warnings, by which programs distinguish them.

use super::{Severity, Warning};
use crate::sampler::Doubt;
use serde::{Serialize, Serializer};

impl Warning {
    /// A name by which a program identifies the warning. It stays when the words change.
    #[must_use]
    pub fn code(&self) -> &'static str {
        self.kind().0
    }

    /// Returns what the warning means for the result.
    #[must_use]
    pub fn severity(&self) -> Severity {
        self.kind().1
    }

    fn kind(&self) -> (&'static str, Severity) {
        use Severity::{Caution, Fault, Note};
        match self {
            Self::Limit { .. } => ("limit", Caution),
            Self::Touches => ("touches", Note),
            Self::Bare { .. } => ("bare", Caution),
            Self::Beyond { .. } => ("beyond", Caution),
            Self::SampledAs { .. } => ("sampled_as", Note),
            Self::Smoothed { .. } => ("smoothed", Note),
            Self::FlushFaces { .. } => ("flush_faces", Note),
            Self::Finer { .. } => ("finer", Note),
            Self::Unused { .. } => ("unused", Note),
            Self::Gradient { .. } => ("gradient", Fault),
            Self::Count { .. } => ("count", Caution),
            Self::NotRefined(_) => ("not_refined", Caution),
            Self::Unpaired { .. } => ("unpaired", Caution),
            Self::Children { is_closed, .. } => ("children", if *is_closed { Note } else { Caution }),
            Self::CloseSheets { .. } => ("close_sheets", Caution),
            Self::Meets { .. } => ("meets", Note),
            Self::Rims { .. } => ("rims", Note),
            Self::Crosses { .. } => ("crosses", Note),
            Self::Moved => ("moved", Note),
            Self::EndedEarly { .. } => ("ended_early", Fault),
            Self::SmallFeatures { .. } => ("small_features", Caution),
            Self::WithoutParticle { .. } => ("without_particle", Fault),
            Self::Open { edges: 0, .. } => ("left_out", Caution),
            Self::Open { .. } => ("open", Fault),
            Self::Jumps { .. } => ("jumps", Note),
            Self::MeshDiffers { .. } => ("mesh_differs", Fault),
            Self::MeshHoles { .. } => ("mesh_holes", Fault),
            Self::MeshTouches { .. } => ("mesh_touches", Note),
            Self::MeshLeavesOut { .. } => ("mesh_leaves_out", Caution),
            Self::LargerInside(_) => ("larger_inside", Note),
            Self::FileDiffers { .. } => ("file_differs", Caution),
            // Nothing is known to be missing, and the report's completeness says the same.
            Self::Unproven { doubt: Doubt::Cells { .. } | Doubt::Creases, .. } => ("unproven", Note),
            Self::Unproven { .. } => ("unproven", Caution),
            Self::Digits { .. } => ("digits", Caution),
            Self::Overflow => ("overflow", Caution),
        }
    }
}

/// A warning, as reports in JSON have it.
#[derive(Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Warning"))]
pub(in crate::run) struct Told {
    /// A name by which a program identifies the warning.
    code: &'static str,
    /// The severity says what the warning means for the result.
    severity: Severity,
    /// The first sentence says what happened and what to do; the others are details.
    message: String,
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let told = Told { code: self.code(), severity: self.severity(), message: self.to_string() };
        told.serialize(serializer)
    }
}
