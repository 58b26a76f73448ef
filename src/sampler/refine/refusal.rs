//! Why a surface is not refined.

use super::LEAST_PARTICLES;
use crate::math::{grouped, place_text};
use core::fmt;
use glam::{DVec3, Vec3};
use serde::Serialize;

/// Why the particles of a run were not refined, and near which place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Refusal {
    /// The survey predicts too few particles for a refinement.
    #[error(
        "Not refined: that takes at least {} particles, and {} were expected.",
        4 * LEAST_PARTICLES, grouped(expected)
    )]
    Few {
        /// Number of particles that the survey predicts.
        expected: u64,
    },
    /// The limit on particles leaves no room.
    #[error(
        "Not refined: the limit on particles leaves no room for that. With a higher limit, or fewer \
         particles, it may be."
    )]
    Full,
    /// The surface bends too much for the wanted spacing.
    #[error("Not refined: near {at} the surface bends too much for particles of this size.")]
    Bent {
        /// A place where the surface bends too much.
        at: Spot,
    },
    /// The gradient vanishes on the surface somewhere else than at the tip of a cone.
    #[error("Not refined: near {at} the gradient vanishes on the surface.")]
    Singular {
        /// A place where the gradient vanishes.
        at: Spot,
    },
    /// The surface has a border that is not at the box.
    #[error("Not refined: near {at} the surface ends inside the box.")]
    Border {
        /// A place where the surface ends.
        at: Spot,
    },
    /// The border could not be laid on the faces of the box.
    #[error(
        "Not refined: near {at} the border of the surface could not be found on the faces of the box. With \
         more particles it may be."
    )]
    Cut {
        /// A place where the border was not found.
        at: Spot,
    },
    /// The particles could not be joined to a closed surface beyond doubt.
    #[error(
        "Not refined: near {at} the particles could not be joined to a closed surface beyond doubt. With \
         more of them they may be."
    )]
    Doubtful {
        /// A place where the particles were not joined.
        at: Spot,
    },
    /// Particles next to a tip could not be joined, or halving their edges led off the surface.
    #[error("Not refined: near {at} the surface has a tip that is too narrow for particles of this size.")]
    Tip {
        /// Position of the tip.
        at: Spot,
    },
    /// A refinement has left the surface, or has led onto another sheet.
    #[error("Not refined: near {at} a finer mesh left the surface.")]
    Folded {
        /// A place where halving edges led off the surface.
        at: Spot,
    },
}

/// A point in space. `Display` gives four digits of its largest coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spot(pub [f32; 3]);

impl From<Vec3> for Spot {
    fn from(p: Vec3) -> Self {
        Self(p.to_array())
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.map(f64::from);
        f.write_str(&place_text([x, y, z], x.abs().max(y.abs()).max(z.abs()).max(f64::MIN_POSITIVE)))
    }
}

impl Refusal {
    /// Returns the refusal with its place in the coordinates of the formula, from one whose place
    /// is relative to `origin`.
    #[must_use]
    pub(crate) fn counted_from_zero(mut self, origin: DVec3) -> Self {
        if let Some(at) = self.at() {
            *at = (origin + Vec3::from(at.0).as_dvec3()).as_vec3().into();
        }
        self
    }

    /// The place that it names, if any.
    pub(crate) fn at(&mut self) -> Option<&mut Spot> {
        match self {
            Self::Few { .. } | Self::Full => None,
            Self::Bent { at }
            | Self::Singular { at }
            | Self::Border { at }
            | Self::Cut { at }
            | Self::Doubtful { at }
            | Self::Tip { at }
            | Self::Folded { at } => Some(at),
        }
    }

    /// Whether a finer front may succeed.
    pub(crate) fn is_coarse(self) -> bool {
        !matches!(self, Self::Few { .. } | Self::Full | Self::Bent { .. } | Self::Singular { .. })
    }
}
