//! The radii of a run. If a number of particles is wanted, each front corrects them.

use super::count::{Next, Search};
use crate::math::{Bounds, HEXAGONAL_CELL};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::FrontPlan;
use crate::sampler::projection::{Tolerance, tolerance};
use crate::sampler::refine;
use crate::sampler::settings::{Pattern, Settings, SizeMode};
use crate::sampler::sizing::Sizing;

/// Particles that a front places per hexagonal cell 2√3 r², as a first guess: rows squeezed by
/// positive curvature make it more than one, seams less. Measured on sphere, ellipsoid, torus and
/// tanglecube: 1.02 to 1.12. A guess that is far off takes another attempt.
const PACKING: f64 = 1.08;

/// [`PACKING`] of the adaptive front, whose arcs bend with the surface: 1.00 to 1.05 on the same
/// surfaces.
const ADAPTIVE_PACKING: f64 = 1.02;

/// A wanted count above this is approached through a pilot run, which measures the packing. Without
/// one such a count takes more evaluations.
const PILOT_FROM: f64 = 8_000.0;
/// Size of a pilot run as a share of the wanted count. Smaller: the count is farther off; larger:
/// there are more evaluations.
const PILOT_SHARE: f64 = 1.0 / 20.0;
/// Fewest particles of a pilot run. Smaller: the count is farther off; larger: there are more
/// evaluations.
const LEAST_PILOT: f64 = 1_500.0;

/// Particles of blue noise per hexagonal cell 2√3 r²: discs of radius r that fall at random until
/// no more fit cover 0.547 of the plane (E. L. Hinrichsen, J. Feder, T. Jøssang, "Geometry of
/// random sequential adsorption", 1986), those of a lattice π/(2√3).
const BLUE_PACKING: f64 = 0.547 / 0.9069;

/// Radius of the front under blue noise, over that of the noise. With it both have about the same
/// number of particles. Smaller: the front takes longer; larger: the squares bend more.
const BLUE_FRONT: f64 = 1.3;

/// A front under a pattern has at least about so many particles, so that it covers also a surface
/// with few.
const LEAST_COVER: f64 = 1_500.0;

/// Columns are reserved for the expected count times this: for the tolerance of a wanted count, and
/// some more.
const RESERVE: f64 = 1.05;

/// A wanted count counts as met within this share. Smaller: more attempts; larger: the count is
/// farther off.
pub(crate) const COUNT_TOLERANCE: f64 = 0.03;

/// Fronts that are tried to meet a wanted count, after which the nearest one is taken: a limit on
/// time where the count leaps with the radius.
pub(super) const MOST_FRONTS: u32 = 8;

/// The packing of an attempt is used for other radii if its count is within this factor of the
/// expected one. Larger: sheets nearer to each other than the particles are mistaken for a small
/// area.
const TRUSTED: f64 = 1.5;
/// Largest factor by which the radius changes after an attempt whose packing is not trusted.
/// Smaller: more attempts.
const MOST_CHANGE: f64 = 2.0;

/// An attempt at covering the surface.
#[derive(Clone, Default)]
pub(super) struct Attempt {
    /// Repulsion radius. In an adaptive run, the radius at which as many particles of equal size
    /// would cover the surface.
    pub(super) radius: f64,
    /// The radius field of an adaptive run.
    pub(super) sizing: Option<Sizing>,
    /// Estimated area of the surface.
    area: f64,
    /// Particles per hexagonal cell 2√3 r²: a guess, then what the attempts have shown.
    packing: f64,
    /// Radius of the front under a pattern, over that of the particles; 1 without a pattern.
    cover: f64,
}

/// The radii of a front: that of all particles, and the radius field.
pub(super) type Radii = (f64, Option<Sizing>);

impl Attempt {
    /// The first attempt on a surface of the estimated `area` in a box of the given `diagonal`.
    pub(super) fn first(settings: &Settings, area: f64, diagonal: f64, sizing: Option<Sizing>) -> Self {
        let packing = match settings.pattern_in_use() {
            Pattern::Blue => BLUE_PACKING,
            _ if sizing.is_some() => ADAPTIVE_PACKING,
            _ => PACKING,
        };
        let mut attempt = Self { sizing, area, packing, cover: 1.0, ..Self::default() };
        attempt.radius = settings.radius_share * diagonal;
        if settings.size_mode == SizeMode::Count {
            let wanted = f64::from(settings.count);
            let is_pilot = wanted > PILOT_FROM && settings.pattern_in_use() == Pattern::Hexagonal;
            let first = if is_pilot { (wanted * PILOT_SHARE).max(LEAST_PILOT) } else { wanted };
            let radius = (attempt.count_times_radius_sq() / first).sqrt();
            if radius > 0.0 {
                attempt.radius = radius;
            }
        }
        let uniform = attempt.expected(attempt.radius);
        if let Some(sizing) = &mut attempt.sizing
            && settings.size_mode == SizeMode::Count
        {
            sizing.scale_to(uniform / packing);
        }
        attempt.set_radius_by_sizing();
        let most = match settings.pattern_in_use() {
            Pattern::Hexagonal => return attempt,
            Pattern::Blue => BLUE_FRONT,
            Pattern::Random => 1.0,
        };
        let expected = attempt.area * PACKING / (HEXAGONAL_CELL * attempt.radius * attempt.radius);
        attempt.cover = most.min((expected / LEAST_COVER).sqrt());
        attempt
    }

    /// Takes the area and the radius field of a surface that has moved, and, if a number of
    /// particles is wanted, the `growth` of the radius since the survey before.
    pub(super) fn move_on(
        &mut self,
        settings: &Settings,
        area: f64,
        diagonal: f64,
        sizing: Option<Sizing>,
        growth: f64,
    ) {
        self.radius = match settings.size_mode {
            SizeMode::Radius => settings.radius_share * diagonal,
            SizeMode::Count => self.radius * growth,
        };
        (self.area, self.sizing) = (area, sizing);
        if let Some(sizing) = &mut self.sizing
            && settings.size_mode == SizeMode::Count
        {
            sizing.scale_to(f64::from(settings.count) / self.packing);
        }
        self.set_radius_by_sizing();
    }

    /// The number of particles of radius r that are expected, times r².
    fn count_times_radius_sq(&self) -> f64 {
        self.area * self.packing / HEXAGONAL_CELL
    }

    /// Makes this an attempt at particles of which so many are wanted and which need no pilot: a
    /// refinement meets the count by itself.
    pub(super) fn aim_at(&mut self, count: f64) {
        self.radius = (self.count_times_radius_sq() / count).sqrt();
        if let Some(sizing) = &mut self.sizing {
            sizing.scale_to(count / self.packing);
        }
    }

    /// Grades the radius field to a slope. It keeps the wanted number of particles.
    pub(super) fn grade(&mut self, settings: &Settings, slope: f64) {
        let Some(mut sizing) = self.sizing.take() else { return };
        sizing = sizing.graded(slope, 1.0);
        if settings.size_mode == SizeMode::Count {
            sizing.scale_to(f64::from(settings.count) / self.packing);
        }
        self.sizing = Some(sizing);
        self.set_radius_by_sizing();
    }

    /// The front of this attempt, for particles in a box.
    pub(super) fn front(&self, settings: &Settings, bounds: &Bounds) -> FrontPlan {
        let plan = FrontPlan {
            bounds: *bounds,
            radius: self.radius as f32,
            sizing: self.sizing.clone(),
            grading: settings.grading as f32,
            match_tolerance: settings.match_tolerance,
            max_particles: settings.max_particles as usize,
            expected: self.expected(self.radius),
            halvings: None,
        };
        if settings.pattern_in_use() == Pattern::Hexagonal {
            return plan;
        }
        let radius = self.radius * self.cover;
        let grading = settings.grading * self.cover;
        FrontPlan {
            radius: radius as f32,
            sizing: plan.sizing.map(|sizing| sizing.graded(grading, self.cover)),
            grading: grading as f32,
            max_particles: plan.max_particles.max(2 * LEAST_COVER as usize),
            expected: self.area * PACKING / (HEXAGONAL_CELL * radius * radius),
            ..plan
        }
    }

    /// Particles of a radius that are expected.
    pub(super) fn expected(&self, radius: f64) -> f64 {
        self.count_times_radius_sq() / (radius * radius)
    }

    /// The target of a refinement with so many halvings, or of a mesh that follows a moving surface
    /// if there are none.
    pub(super) fn target(&self, settings: &Settings, halvings: u32) -> refine::Target {
        let sizing = self.sizing.as_ref();
        let count = match (settings.size_mode, sizing) {
            (SizeMode::Count, _) => refine::Count::Total(f64::from(settings.count)),
            (SizeMode::Radius, None) => refine::Count::PerCell(self.packing),
            (SizeMode::Radius, Some(sizing)) => refine::Count::Total(self.packing * sizing.predicted_count()),
        };
        refine::Target { halvings, radius: self.radius as f32, grading: sizing.map(Sizing::slope), count }
    }

    /// Spacing of the hexagonal lattice with as many particles of one radius as are expected.
    pub(super) fn spacing(&self) -> f32 {
        (2.0 * self.radius / self.packing.sqrt()) as f32
    }

    /// The first attempt at a front that replaces this one after a refusal.
    pub(super) fn without_refinement(&mut self, settings: &Settings, diagonal: f64) -> Self {
        Self::first(settings, self.area, diagonal, self.sizing.take().map(|sizing| sizing.unscaled(settings)))
    }

    /// Particles per hexagonal cell 2√3 r².
    pub(super) fn packing(&self) -> f64 {
        self.packing
    }

    /// Multiplies all radii by a factor.
    pub(super) fn resize(&mut self, factor: f64) {
        self.radius *= factor;
        if let Some(sizing) = &mut self.sizing {
            sizing.scale(factor);
        }
    }

    /// Takes the radius from the radius field, if there is one.
    fn set_radius_by_sizing(&mut self) {
        let Some(sizing) = &self.sizing else { return };
        let radius = (self.area / (HEXAGONAL_CELL * sizing.predicted_count())).sqrt();
        // Without a surface there is none.
        if radius > 0.0 && radius.is_finite() {
            self.radius = radius;
        }
    }

    /// Particles that the run is expected to have, whatever its limit.
    pub(super) fn predicted_count(&self, settings: &Settings) -> f64 {
        match settings.size_mode {
            SizeMode::Radius => self.expected(self.radius).round(),
            SizeMode::Count => f64::from(settings.count),
        }
    }

    /// Particles to reserve room for.
    pub(super) fn reserved(count: f64, settings: &Settings) -> usize {
        (count * RESERVE).min(f64::from(settings.max_particles)) as usize
    }

    /// Tolerance for the particles that are wanted.
    pub(super) fn tolerance(&self, survey: &Survey) -> Tolerance {
        tolerance(self.radius as f32, survey.residual_limits(), survey.gradient_scale)
    }

    /// Records that this attempt has covered the surface with `count` particles, or with more if it
    /// `is_capped`. Returns whether another one, with the radius as now corrected, should come
    /// nearer to the wanted count. After the last one, restores the nearest.
    pub(super) fn is_corrected(
        &mut self,
        search: &mut Search<Radii>,
        settings: &Settings,
        count: usize,
        is_capped: bool,
    ) -> bool {
        let miss = if is_capped { f64::INFINITY } else { count as f64 / f64::from(settings.count) };
        // A limit below the wanted count prevails.
        let is_limited = is_capped && settings.count > settings.max_particles;
        if settings.size_mode == SizeMode::Radius || is_met(miss) || is_limited || search.is_over() {
            return false;
        }
        let packing = count as f64 / self.expected(self.radius);
        if !is_capped {
            self.packing *= packing;
        }
        let is_trusted = !is_capped && (1.0 / TRUSTED..=TRUSTED).contains(&packing);
        let most_change = if is_trusted { f64::INFINITY } else { MOST_CHANGE };
        match search.next(miss, most_change, (self.radius, self.sizing.clone())) {
            Next::None => return false,
            Next::Back((radius, sizing)) => (self.radius, self.sizing) = (radius, sizing),
            Next::Scaled(factor) => {
                self.radius *= factor;
                if let Some(sizing) = &mut self.sizing {
                    sizing.scale(factor);
                }
                self.set_radius_by_sizing();
            }
        }
        true
    }
}

/// Whether a front with `miss` times the wanted number of particles has met that.
pub(super) fn is_met(miss: f64) -> bool {
    (miss - 1.0).abs() <= COUNT_TOLERANCE
}
