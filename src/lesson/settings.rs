//! Settings of a run of the lesson: the method, the rules of the paper, and choices that the paper
//! does not have.

use super::prediction::predicted_angles;
use crate::differential::Curvature;
use crate::field::formula::Parameter;
use crate::math::{Bounds, BoxError, grouped};
use crate::paper::{RadiusRule, Rules, sum_of_curvatures};
use crate::sampler::{GapPolicy, LawKind, Sampling};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Default limit of particles; nobody reads a log of more event by event.
pub const MAX_PARTICLES: u32 = 20_000;

/// Largest limit that can be set; so many particles take hundreds of megabytes with their
/// snapshots.
const MOST_PARTICLES: u32 = 1_000_000;

/// A surface given by a formula, in the page's form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LessonField {
    /// Text of the formula.
    pub formula: String,
    /// Parameters with their values.
    pub parameters: Vec<Parameter>,
    /// Box to sample.
    pub bounds: Bounds,
}

/// Method that places particles on the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonMethod"))]
#[serde(rename_all = "snake_case")]
pub enum LessonMethod {
    /// The paper's method: a front of particles, each of which places its neighbours, and a few
    /// relaxation steps.
    Front,
    /// The particle system of Witkin and Heckbert 1994, with which the paper compares its uniform
    /// sampling (Table 1).
    WitkinHeckbert,
    /// Forces between discs, the particle system with which the paper compares its non-uniform
    /// sampling (Table 1).
    Forces,
}

/// The order in which the particles that are not done are treated (§4.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonOrder"))]
#[serde(rename_all = "snake_case")]
pub enum QueueOrder {
    /// The particle that has waited longest is next. This gives the rings of Fig. 11.
    Queue,
    /// The newest particle is next, as the word "stack" in the text implies.
    Stack,
}

/// The method that moves a child onto the surface (§4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonProjection"))]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// The child moves along the circle C(p, 2r), which keeps its distance from the parent, as in
    /// the paper.
    Circle,
    /// The child moves by Newton's method in space, "the most common technique", which changes its
    /// distance from the parent.
    Newton,
}

/// Where the search on the circle starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonStart"))]
#[serde(rename_all = "snake_case")]
pub enum SearchStart {
    /// The search starts in the tangent plane, θ₀ = 0, as in Fig. 4 (left).
    Tangent,
    /// The search starts at the angle at which the parent's normal curvature predicts the surface.
    Curvature,
}

/// Whether a particle that a child was identified with remains a neighbour of the parent (§4.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonMatched"))]
#[serde(rename_all = "snake_case")]
pub enum Matched {
    /// The particle is removed from the neighbours, so that no second child of the same parent is
    /// identified with it, as in the paper.
    Leave,
    /// The particle stays, and so do the new children. Then no two particles are closer than the
    /// match radius.
    Stay,
}

/// The order in which children are projected and compared with existing particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LessonPlacing {
    /// Particle by particle: the children of a particle are projected, then compared, as in
    /// Algorithm 2.
    OneByOne,
    /// A whole generation level together, as in the fast front. Children are compared where the
    /// curvature around their parent predicts them; only the free ones are projected, and compared
    /// again.
    LevelByLevel,
}

/// The choices of a run. `Default` gives the paper's values, and the fast sampler's where the paper
/// states none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonSettings"))]
#[serde(default)]
pub struct LessonSettings {
    /// Method that places particles on the surface. Of the settings below, the two particle systems
    /// use the sizes, the seeds, `residual`, `max_iterations` and `max_particles`.
    pub method: LessonMethod,
    /// Whether all particles have one radius (§4), or one that follows the curvature (§5).
    #[cfg_attr(test, ts(type = "'uniform' | 'adaptive'"))]
    pub sampling: Sampling,
    /// Repulsion radius r of every particle of uniform sampling, a length in the field's
    /// coordinates.
    pub radius: f64,
    /// Law for the radius of an adaptive particle, given the curvature.
    #[cfg_attr(test, ts(type = "'chord_error' | 'max_curvature' | 'sum_of_curvatures'"))]
    pub law: LawKind,
    /// Scale of the law: for `chord_error` the gap between the surface and a triangle of
    /// neighbours, a length; for the other two the radius divided by the radius of curvature.
    pub law_scale: f64,
    /// Smallest radius of an adaptive particle, a length.
    pub radius_min: f64,
    /// Largest radius of an adaptive particle, a length. In Witkin and Heckbert's system the radius
    /// at which a particle divides whatever its energy, half of the surface's diameter; with 0 it
    /// is measured.
    pub radius_max: f64,
    /// An adaptive child is added if the free angle τ is at least this share of φ, the angle that
    /// it occupies. The paper's share is 1; on a lattice, where the two are equal, rounding then
    /// decides.
    pub fit: f64,
    /// Points near the surface where fronts begin, in this order; each begins when the front before
    /// it has closed. Other seeds are searched only if this is empty.
    pub seeds: Vec<[f64; 3]>,
    /// Random seed for the choice of the first seed point, if `seeds` is empty.
    pub seed: u32,
    /// Method that moves a child onto the surface.
    pub projection: Projection,
    /// Start of the search on the circle.
    pub start: SearchStart,
    /// Order in which waiting particles are treated.
    pub order: QueueOrder,
    /// Whether matched particles are removed from the neighbours.
    pub matched: Matched,
    /// A child is identified with a particle within this distance, in 2r.
    pub match_tolerance: f64,
    /// Order of projection and comparison: particle by particle, or level by level.
    pub placing: LessonPlacing,
    /// Whether gaps between fronts are filled.
    #[cfg_attr(test, ts(type = "'fill' | 'leave'"))]
    pub gaps: GapPolicy,
    /// A point is on the surface if |f|/|∇f| is at most this, in r.
    pub residual: f64,
    /// Relaxation steps.
    pub relax_steps: u32,
    /// Size of a relaxation step. The default is 0.6 σ² with σ = r in uniform sampling, and 0.33 of
    /// the overlap in adaptive sampling.
    pub step_size: Option<f64>,
    /// A particle system ends after this many iterations even if it has not settled.
    pub max_iterations: u32,
    /// The run stops at this number of particles. It may exceed [`MAX_PARTICLES`].
    pub max_particles: u32,
}

impl Default for LessonSettings {
    fn default() -> Self {
        Self {
            method: LessonMethod::Front,
            sampling: Sampling::Uniform,
            radius: 0.0,
            law: LawKind::SumOfCurvatures,
            law_scale: 0.05,
            radius_min: 0.0,
            radius_max: 0.0,
            fit: 0.5,
            seeds: Vec::new(),
            seed: 0,
            projection: Projection::Circle,
            start: SearchStart::Tangent,
            // The text says stack, but the rings of Fig. 11 need a queue.
            order: QueueOrder::Queue,
            matched: Matched::Leave,
            match_tolerance: 0.7,
            placing: LessonPlacing::OneByOne,
            gaps: GapPolicy::Leave,
            residual: 1e-4,
            relax_steps: 10,
            step_size: None,
            max_iterations: 3_000,
            max_particles: MAX_PARTICLES,
        }
    }
}

impl LessonSettings {
    /// The choices of the fast uniform front; these settings reproduce its particles.
    #[must_use]
    pub fn of_fast_front() -> Self {
        Self { placing: LessonPlacing::LevelByLevel, matched: Matched::Stay, ..Self::default() }
    }

    /// The rules of the paper's algorithms.
    pub(super) fn rules(&self) -> Rules {
        let sizes = match self.sampling {
            Sampling::Uniform => RadiusRule::Same(self.radius),
            Sampling::Adaptive => RadiusRule::ByCurvature {
                law: law(self.law),
                scale: self.law_scale,
                least: self.radius_min,
                most: self.radius_max,
            },
        };
        let mut rules = Rules {
            removes_matched: self.matched == Matched::Leave,
            match_tolerance: self.match_tolerance,
            fit: self.fit,
            residual: self.residual,
            max_particles: self.max_particles as usize,
            ..Rules::with_sizes(sizes)
        };
        if self.projection == Projection::Newton {
            rules.projection = |surface, circle, residual, note| {
                surface.land_by_newton(circle.point(circle.start_rad), circle.radius, residual, note)
            };
        }
        if self.start == SearchStart::Curvature {
            rules.start_angles = predicted_angles;
        }
        if let Some(size) = self.step_size {
            rules.step_size = size;
        }
        rules
    }

    /// Checks every value.
    ///
    /// # Errors
    ///
    /// The first setting that is out of range or incompatible with another.
    pub fn validate(&self) -> Result<(), LessonError> {
        let ranges = [
            ("match_tolerance", self.match_tolerance, 0.1, 0.95),
            ("residual", self.residual, 1e-10, 0.01),
            ("relax_steps", f64::from(self.relax_steps), 0.0, 100.0),
            ("step_size", self.step_size.unwrap_or_default(), 0.0, 3.0),
            ("max_iterations", f64::from(self.max_iterations), 1.0, 1e4),
            ("max_particles", f64::from(self.max_particles), 1.0, f64::from(MOST_PARTICLES)),
        ];
        let sizes = match self.sampling {
            Sampling::Uniform => vec![("radius", self.radius, f64::MIN_POSITIVE, f64::MAX)],
            Sampling::Adaptive => vec![
                ("law_scale", self.law_scale, f64::MIN_POSITIVE, f64::MAX),
                ("radius_max", self.radius_max, f64::MIN_POSITIVE, f64::MAX),
                ("radius_min", self.radius_min, f64::MIN_POSITIVE, self.radius_max),
                ("fit", self.fit, 0.1, 1.0),
            ],
        };
        for (name, value, min, max) in sizes.into_iter().chain(ranges) {
            if !(min..=max).contains(&value) {
                return Err(LessonError::OutOfRange { name, value, min, max });
            }
        }
        match (self.method, self.sampling) {
            (LessonMethod::WitkinHeckbert, Sampling::Adaptive) => return Err(LessonError::OneSize),
            (LessonMethod::WitkinHeckbert, _) if !(0.0..=f64::MAX).contains(&self.radius_max) => {
                let (name, value) = ("radius_max", self.radius_max);
                return Err(LessonError::OutOfRange { name, value, min: 0.0, max: f64::MAX });
            }
            _ => {}
        }
        if self.placing == LessonPlacing::LevelByLevel
            && (self.order, self.projection, self.matched)
                != (QueueOrder::Queue, Projection::Circle, Matched::Stay)
        {
            return Err(LessonError::Levels);
        }
        if (self.method, self.sampling) == (LessonMethod::Front, Sampling::Adaptive)
            && (self.placing, self.projection, self.gaps)
                != (LessonPlacing::OneByOne, Projection::Circle, GapPolicy::Leave)
        {
            return Err(LessonError::Adaptive);
        }
        Ok(())
    }
}

/// The radius of an adaptive particle as a function of curvature and scale.
fn law(kind: LawKind) -> fn(&Curvature<f64, DVec3>, f64) -> f64 {
    match kind {
        LawKind::SumOfCurvatures => sum_of_curvatures,
        LawKind::MaxCurvature => |curvature, scale| scale / curvature.max_abs(),
        // The distance between a sphere and the centre of an inscribed equilateral triangle of side
        // 2r.
        LawKind::ChordError => {
            |curvature, error| 0.5 * (3.0 * error * (2.0 / curvature.max_abs() - error)).max(0.0).sqrt()
        }
    }
}

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LessonError {
    /// A setting is not a number within its range.
    #[error("{name} is {value}, but must lie between {min} and {max}")]
    OutOfRange {
        /// Name of the setting.
        name: &'static str,
        /// The value given.
        value: f64,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// No particles can be placed in the box.
    #[error(transparent)]
    Box(#[from] BoxError),
    /// Placing level by level requires one particular choice of other settings.
    #[error("placing level by level needs a queue, the circle, and matched particles that stay")]
    Levels,
    /// The system of Witkin and Heckbert requires a single size.
    #[error("Witkin and Heckbert's system wants one radius everywhere: choose uniform sampling, or forces")]
    OneSize,
    /// Adaptive sampling requires one particular choice of other settings.
    #[error("adaptive sampling places one particle after the other, on circles, and leaves gaps")]
    Adaptive,
    /// More particles than the limit are expected.
    #[error(
        "about {} particles are to be expected, and the event log follows at most {}: \
         choose radii {factor:.2} times as large",
        grouped(expected),
        grouped(limit)
    )]
    TooMany {
        /// Expected number of particles.
        expected: u32,
        /// Largest number of particles that a run may have.
        limit: u32,
        /// Factor for all radii that brings the number within the limit.
        factor: f64,
    },
}
