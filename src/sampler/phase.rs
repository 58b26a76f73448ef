//! The phases of a run: their public names, and the state that each of them carries.

use super::refine::{Components, MovingMesh};
use serde::Serialize;

/// Phase of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Phase {
    /// No run was started.
    #[default]
    Idle,
    /// Looking for a first point on every component that the survey has met.
    Seeding,
    /// Placing particles, level by level.
    Generation,
    /// Refining a coarse front.
    Refinement,
    /// Looking for components that the survey has missed; at the end of a run, finding out which of them hold particles.
    Search,
    /// Relaxing the particles.
    Relaxation,
    /// Bringing the particles to a surface that has moved.
    Flow,
    /// Finished or stopped.
    Done,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StopReason {
    /// All phases were completed.
    Complete,
    /// Stopped by the caller; what was there stays.
    Cancelled,
    /// The limit on particles was reached.
    Cap,
    /// No point of the surface in the box.
    NoSurface,
    /// f has the same value everywhere.
    Constant,
    /// f has no value in the box, or none that double precision holds.
    Undefined,
    /// The radius is too large for the surface: no child fits.
    OneParticle,
}

/// What particles do on a surface that has moved.
#[derive(Clone, Debug)]
pub(super) enum FlowStage {
    /// The particles move with the mesh of a refined run.
    Mesh(Box<MovingMesh>),
    /// The particles are transported to the surface.
    Transport,
    /// The particles make one of so many steps on the surface.
    Step(u32),
}

/// The present phase and the state that only this phase has.
///
/// | Phase | Event | Next phase |
/// |---|---|---|
/// | any | a run starts | `Seeding` |
/// | `Seeding` | particles were placed on creases | `Generation` |
/// | `Seeding` | a survey point is not covered | `Generation` |
/// | `Seeding` | all survey points are covered | `Search` |
/// | `Generation` | the front has closed | `Seeding`; `Search` if the seed was a witness or the limit is reached |
/// | `Search` | a witness is not covered | `Generation` |
/// | `Search` | all witnesses are covered | `Filling` if there are gaps; else as after `Filling` |
/// | `Filling` | no gap is left | `Relaxation`; `Seeding` if the wanted count is missed; `Refinement` of a coarse front; `Audit` if nothing is to be relaxed |
/// | `Refinement` | the last level is done | `Audit` |
/// | `Refinement` | the front is refused | `Seeding`, with a finer front |
/// | `Relaxation` | the last step is done | `Audit` |
/// | `Audit` | it is known which components hold particles | `Marking` |
/// | `Marking` | the particles are marked | `Done` |
/// | `Done` | the caller asks for more relaxation steps | `Relaxation` |
/// | `Done` | the surface has moved | `Flow` |
/// | `Flow` | the mesh cannot follow | `Flow`, without it |
/// | `Flow` | the particles have made their steps on the new surface | `Done` |
/// | any before `Marking` | the caller cancels the run | `Marking` |
///
/// `Sampler::next` makes every transition.
#[derive(Clone, Debug, Default)]
pub(super) enum PhaseState {
    /// There is no run.
    #[default]
    Idle,
    /// Looks for a survey point that no particle covers.
    Seeding(SurveyCursor),
    /// Grows a front from a seed. Afterwards the seeding goes on from the cursor; there is none where the seed was a witness of the
    /// search, or that of an earlier coarse front.
    Generation(Option<SurveyCursor>),
    /// Looks for a witness that no particle covers.
    Search,
    /// Fills the gaps that the fronts have left.
    Filling,
    /// Brings a coarse front into order and refines it.
    Refinement(Box<Components>),
    /// Moves the particles to more even distances.
    Relaxation,
    /// Brings the particles to a surface that has moved.
    Flow(FlowStage),
    /// Finds out which components hold particles.
    Audit(StopReason),
    /// Marks the particles next to singular points. This costs no budget: a run that has ended is marked.
    Marking(StopReason),
    /// The run has ended.
    Done(StopReason),
}

impl PhaseState {
    /// The public name of the phase.
    pub(super) fn name(&self) -> Phase {
        match self {
            Self::Idle => Phase::Idle,
            Self::Seeding(_) => Phase::Seeding,
            Self::Generation(_) | Self::Filling => Phase::Generation,
            Self::Refinement(_) => Phase::Refinement,
            Self::Search | Self::Audit(_) => Phase::Search,
            Self::Relaxation => Phase::Relaxation,
            Self::Flow(_) => Phase::Flow,
            Self::Marking(_) | Self::Done(_) => Phase::Done,
        }
    }

    /// Why the run has ended, if it has.
    pub(super) fn stop_reason(&self) -> Option<StopReason> {
        match self {
            Self::Marking(reason) | Self::Done(reason) => Some(*reason),
            _ => None,
        }
    }
}

/// Position in the sequence of seeds: particles on creases and tips first, then a point drawn from the surface, and then the survey's
/// points in grid order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SurveyCursor {
    /// Whether the particles on creases and tips have been placed.
    pub(super) has_creases: bool,
    /// Whether a point has been drawn.
    pub(super) has_drawn: bool,
    /// The survey's point that is tried next.
    pub(super) next: usize,
}
