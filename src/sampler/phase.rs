//! What a run is doing, and why it ended.

use serde::Serialize;

/// What the sampler is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Nothing started.
    #[default]
    Idle,
    /// Looking for a first point on every component that the survey has met.
    Seeding,
    /// Placing particles, level by level.
    Generation,
    /// Looking for components that the survey has missed.
    Search,
    /// Relaxing the particles.
    Relaxation,
    /// Finished or stopped.
    Done,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// Everything done.
    Complete,
    /// Stopped by the caller; what was there stays.
    Cancelled,
    /// The limit on particles was reached.
    Cap,
    /// No point of the surface in the box.
    NoSurface,
    /// f has the same value everywhere.
    Constant,
    /// f has no value anywhere in the box.
    Undefined,
    /// The radius is too large for the surface: no child fits.
    OneParticle,
}
