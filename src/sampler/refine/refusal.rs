//! Why a surface is not refined.

use serde::Serialize;

/// Why the particles of a run were not refined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum Refusal {
    /// The wanted count, the curvature or a vanishing gradient rules refinement out from the start.
    #[error(
        "The front stands, and is not refined: that takes at least 720 particles and room for them below the limit, a \
         spacing of less than 0.45 of the smallest radius of curvature, and a gradient that vanishes nowhere on the surface."
    )]
    Unsuitable,
    /// The surface has a border that is not at the box.
    #[error(
        "The front stands, and is not refined: near ({:.3}, {:.3}, {:.3}) the surface ends inside the box.", .at[0], .at[1], .at[2]
    )]
    Border {
        /// A place there.
        at: [f32; 3],
    },
    /// The border could not be laid on the faces of the box.
    #[error(
        "The front stands, and is not refined: near ({:.3}, {:.3}, {:.3}) the border of the surface could not be found on the faces \
         of the box. With more particles it may be.", .at[0], .at[1], .at[2]
    )]
    Cut {
        /// A place there.
        at: [f32; 3],
    },
    /// A part of the surface within the box was missed.
    #[error(
        "The front stands, and is not refined: near ({:.3}, {:.3}, {:.3}) the box leaves a part of the surface that is too small for \
         a coarse front.", .at[0], .at[1], .at[2]
    )]
    Missed {
        /// A place there.
        at: [f32; 3],
    },
    /// A component has too few particles.
    #[error("The front stands, and is not refined: a part of the surface has fewer than 180 particles.")]
    Small,
    /// The particles could not be joined to a closed surface beyond doubt.
    #[error(
        "The front stands, and is not refined: its particles could not be joined to a closed surface beyond doubt. With more \
         of them they may be."
    )]
    Doubtful,
    /// The surface bends too much between neighbours.
    #[error("The front stands, and is not refined: the surface bends too much between neighbours.")]
    Sharp,
    /// A refinement has left the surface, or has led onto another sheet.
    #[error("The front stands, and is not refined: halving its edges led off the surface.")]
    Folded,
}

impl Refusal {
    /// Whether a finer front may do.
    pub(crate) fn is_coarse(self) -> bool {
        !matches!(self, Self::Unsuitable | Self::Border { .. })
    }
}
