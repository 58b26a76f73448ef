//! The phases of a run, as its caller knows them, and why a run ends.

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
    /// Looking for components that the survey has missed; at the end of a run, finding out which of
    /// them hold particles.
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
    /// Stopped by the caller; the particles so far stay.
    Cancelled,
    /// The limit on particles was reached.
    Cap,
    /// No point of the surface in the box.
    NoSurface,
    /// f has the same value everywhere.
    Constant,
    /// f is undefined in the box, or beyond double precision.
    Undefined,
    /// The radius is too large for the surface: no child fits.
    OneParticle,
}
