//! The radius of a run. If a number of particles is wanted, each attempt corrects the radius.

use crate::math::{Bounds, HEXAGONAL_CELL, sort_numbers};
use crate::sampler::constraint::CreaseLadder;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::FrontPlan;
use crate::sampler::projection::{Tolerance, tolerance};
use crate::sampler::refine::{self, Refusal, SurfaceFacts};
use crate::sampler::settings::{Settings, SizeMode};
use crate::sampler::sizing::Sizing;
use glam::Vec3;

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

/// Columns are reserved for the expected count times this: for the tolerance of a wanted count, and
/// some more.
const RESERVE: f64 = 1.05;

/// A wanted count counts as met within this share. Smaller: more attempts; larger: the count is
/// farther off.
pub(crate) const COUNT_TOLERANCE: f64 = 0.03;

/// Attempts at meeting a wanted count, after which the nearest one is taken: a limit on time where
/// the count leaps with the radius.
const MAX_ATTEMPTS: u32 = 8;
/// Attempts at meeting a wanted count by refining coarse fronts of other radii.
const MAX_COARSE_ATTEMPTS: u32 = 4;

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
    /// Plan and state of the refinement of the front; none if the front is not refined.
    pub(super) refining: Option<Refining>,
    search: Search,
    /// The attempt that came nearest to the wanted count.
    nearest: Option<Box<Nearest>>,
}

/// The radii of an attempt.
#[derive(Clone)]
struct Nearest {
    /// Its count over the wanted one, or the inverse, which is the larger.
    miss: f64,
    radius: f64,
    sizing: Option<Sizing>,
}

/// A search for the radius that gives the wanted number of particles.
#[derive(Clone, Copy, Debug)]
struct Search {
    /// The radius over that of the first attempt.
    scale: f64,
    /// The largest scale known to give too many particles, and the smallest known to give too few.
    bracket: [f64; 2],
    /// Attempts completed.
    completed: u32,
}

impl Default for Search {
    fn default() -> Self {
        Self { scale: 1.0, bracket: [0.0, f64::INFINITY], completed: 0 }
    }
}

impl Search {
    /// Changes the scale after an attempt with `miss` times the wanted number of particles,
    /// assuming that the number goes with the inverse square of the radius. If this leads beyond a
    /// scale known to give too many particles or one known to give too few, the next scale is
    /// halfway between them. Returns the factor on the radius.
    fn advance(&mut self, miss: f64, most_change: f64) -> f64 {
        let [many, few] = &mut self.bracket;
        if miss > 1.0 {
            *many = self.scale;
            // The number need not fall as the radius grows.
            *few = if *few > self.scale { *few } else { f64::INFINITY };
        } else {
            *few = self.scale;
            *many = if *many < self.scale { *many } else { 0.0 };
        }
        let [many, few] = self.bracket;
        let mut factor = miss.sqrt().clamp(1.0 / most_change, most_change);
        let next = self.scale * factor;
        if many > 0.0 && few.is_finite() && !(next > many && next < few) {
            factor = (many * few).sqrt() / self.scale;
        }
        self.scale *= factor;
        factor
    }
}

/// Plan of the refinement of a front, and the failures so far.
#[derive(Clone)]
pub(super) struct Refining {
    /// Number of halvings that lead from the radius of the front to the radius of the attempt.
    pub(super) halvings: u32,
    /// The search for the radius of the front that meets the wanted count; its scale is a factor on
    /// that radius.
    search: Search,
    /// The front that came nearest.
    nearest: Option<NearestFront>,
    /// Whether the surface has creases.
    pub(super) is_creased: bool,
    /// The particles on creases at every level, where there are creases.
    pub(super) ladder: Option<CreaseLadder>,
    /// Point of the surface with the largest curvature.
    pub(super) bend: Vec3,
    /// Number of refinements that failed.
    pub(super) failures: u32,
    /// Why coarser fronts could not be refined, if that is known.
    pub(super) failure: Option<Refusal>,
}

/// A front whose refinement has ended.
#[derive(Clone, Copy, Debug)]
struct NearestFront {
    /// Its count over the wanted one, or the inverse, which is the larger.
    miss: f64,
    scale: f64,
    halvings: u32,
    failures: u32,
}

impl Refining {
    /// Returns to the front that came nearest to the wanted count, which is then final. Returns
    /// whether there is one.
    pub(super) fn recall_nearest(&mut self) -> bool {
        let Some(NearestFront { scale, halvings, failures, .. }) = self.nearest.take() else { return false };
        self.search.completed = MAX_COARSE_ATTEMPTS;
        (self.search.scale, self.halvings, self.failures) = (scale, halvings, failures);
        true
    }
}

impl Attempt {
    /// The first attempt on a surface of the estimated `area` in a box of the given `diagonal`.
    pub(super) fn first(settings: &Settings, area: f64, diagonal: f64, sizing: Option<Sizing>) -> Self {
        let packing = if sizing.is_some() { ADAPTIVE_PACKING } else { PACKING };
        let mut attempt = Self { sizing, area, packing, ..Self::default() };
        attempt.radius = settings.radius_share * diagonal;
        if settings.size_mode == SizeMode::Count {
            let wanted = f64::from(settings.count);
            let is_pilot = wanted > PILOT_FROM;
            let first = if is_pilot { (wanted * PILOT_SHARE).max(LEAST_PILOT) } else { wanted };
            let radius = (attempt.count_times_radius_sq() / first).sqrt();
            if radius > 0.0 {
                attempt.radius = radius;
            }
        }
        let uniform = attempt.count_times_radius_sq() / (attempt.radius * attempt.radius);
        if let Some(sizing) = &mut attempt.sizing
            && settings.size_mode == SizeMode::Count
        {
            sizing.scale_to(uniform / packing);
        }
        attempt.set_radius_by_sizing();
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

    /// Makes this an attempt at a coarse front to be refined, if possible, on a surface with these
    /// largest curvatures at points spread over it. There is no pilot run: the refinement meets the
    /// wanted count by itself. Otherwise returns the reason; the front with its relaxation is
    /// attempted then.
    pub(super) fn refine(
        &mut self,
        settings: &Settings,
        points: &[Vec3],
        mut curvature: Vec<f64>,
        is_creased: bool,
    ) -> Option<Refusal> {
        let count = self.predicted_count(settings);
        let radius = (self.count_times_radius_sq() / count).sqrt();
        let most = (0..points.len()).max_by(|&i, &j| curvature[i].total_cmp(&curvature[j]));
        let bend = most.map_or(Vec3::ZERO, |i| points[i]);
        sort_numbers(&mut curvature);
        let largest = curvature.last().copied().unwrap_or(f64::INFINITY);
        let halvings_at = |curvature: f64| refine::halvings(curvature * 2.0 * radius, count);
        // A component may bend too much to be refined while others can be.
        let is_mostly_smooth =
            || largest.is_finite() && halvings_at(curvature[curvature.len() / 2]).is_some();
        let halvings = halvings_at(largest).or_else(|| is_mostly_smooth().then_some(0));
        // Without a surface there is no radius.
        let expected = if radius > 0.0 { count } else { 0.0 };
        if refine::halvings(0.0, expected).is_none() {
            return Some(Refusal::Few { expected: expected as u64 });
        }
        let Some(halvings) = halvings else {
            return Some(Refusal::Bent { at: bend.into() });
        };
        let unrefined = self.clone();
        self.radius = radius;
        if let Some(sizing) = &mut self.sizing {
            sizing.scale_to(count / self.packing);
        }
        // Why no coarser front is tried, should this one fail.
        let failure = (halvings == 0).then_some(Refusal::Bent { at: bend.into() });
        let (search, nearest) = (Search::default(), None);
        self.refining = Some(Refining {
            halvings,
            search,
            nearest,
            is_creased,
            ladder: None,
            bend,
            failures: 0,
            failure,
        });
        self.grade(settings);
        if self.predicted_count(settings) > f64::from(settings.max_particles) {
            *self = unrefined;
            return Some(Refusal::Full);
        }
        None
    }

    /// Grades the radius field for a refinement on a surface with creases. The radii of the front
    /// vary there, too: it decides how many particles lie on each crease. Each level has the radii
    /// of the front divided by a power of two, and so has their slope.
    fn grade(&mut self, settings: &Settings) {
        let share = self.front_radius() / self.radius;
        if !self.refining.as_ref().is_some_and(|refining| refining.is_creased) {
            return;
        }
        let Some(mut sizing) = self.sizing.take() else { return };
        sizing = sizing.graded(settings.grading / share, 1.0);
        if settings.size_mode == SizeMode::Count {
            sizing.scale_to(f64::from(settings.count) / self.packing);
        }
        self.sizing = Some(sizing);
        self.set_radius_by_sizing();
    }

    /// The front of this attempt, for particles in a box. A front that is refined grows in a larger
    /// box, with particles of one size unless there are creases.
    pub(super) fn front(&mut self, settings: &Settings, bounds: &Bounds) -> FrontPlan {
        self.grade(settings);
        let share = self.front_radius() / self.radius;
        let (bounds, match_tolerance, sizing) = match &self.refining {
            None => (*bounds, settings.match_tolerance, self.sizing.clone()),
            Some(refining) => {
                let sizing = self.sizing.as_ref().filter(|_| refining.is_creased);
                (
                    refine::grown(bounds, self.front_radius()),
                    refine::MATCH_TOLERANCE,
                    sizing.map(|sizing| sizing.clone().graded(settings.grading, share)),
                )
            }
        };
        FrontPlan {
            bounds,
            radius: self.front_radius() as f32,
            sizing,
            grading: settings.grading as f32,
            match_tolerance,
            max_particles: settings.max_particles as usize,
            expected: self.count_times_radius_sq() / (self.front_radius() * self.front_radius()),
        }
    }

    /// What the refinement of this attempt's front, or a mesh that follows a moving surface, uses
    /// of the surface in a box.
    pub(super) fn surface(&self, bounds: &Bounds) -> SurfaceFacts<'_> {
        let refining = self.refining.as_ref();
        SurfaceFacts {
            bounds: *bounds,
            sizing: self.sizing.as_ref(),
            ladder: refining.and_then(|refining| refining.ladder.as_ref()),
            bend: refining.map_or(Vec3::ZERO, |refining| refining.bend),
            failures: refining.map_or(0, |refining| refining.failures),
        }
    }

    /// The target of the refinement of this attempt's front; none if the front is not refined.
    pub(super) fn target(&self, settings: &Settings) -> Option<refine::Target> {
        self.refining.as_ref().map(|refining| self.target_of(settings, refining.halvings))
    }

    /// The target of a mesh that follows a moving surface.
    pub(super) fn moving_target(&self, settings: &Settings) -> refine::Target {
        self.target_of(settings, 0)
    }

    fn target_of(&self, settings: &Settings, halvings: u32) -> refine::Target {
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

    /// Radius of the front.
    fn front_radius(&self) -> f64 {
        let coarse = |refining: &Refining| {
            refine::FRONT_RADIUS * f64::from(1_u32 << refining.halvings) * refining.search.scale
        };
        self.radius * self.refining.as_ref().map_or(1.0, coarse)
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
            SizeMode::Radius => (self.count_times_radius_sq() / (self.radius * self.radius)).round(),
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

    /// Number of the front under way, from 1, counting the fronts of all attempts and refinements.
    pub(super) fn number(&self) -> u32 {
        let refined = self.refining.as_ref().map_or(0, |refining| refining.search.completed);
        self.search.completed + refined + 1
    }

    /// Records that this attempt has covered the surface with `count` particles, or with more if it
    /// `is_capped`. Returns whether another one, with the radius as now corrected, should come
    /// nearer to the wanted count. After the last one, restores the nearest.
    pub(super) fn is_corrected(&mut self, settings: &Settings, count: usize, is_capped: bool) -> bool {
        let miss = count as f64 / f64::from(settings.count);
        let is_met = !is_capped && (miss - 1.0).abs() <= COUNT_TOLERANCE;
        // A limit below the wanted count prevails.
        let is_limited = is_capped && settings.count > settings.max_particles;
        self.search.completed += 1;
        if settings.size_mode == SizeMode::Radius
            || is_met
            || is_limited
            || self.search.completed > MAX_ATTEMPTS
        {
            return false;
        }
        let packing = count as f64 / (self.count_times_radius_sq() / (self.radius * self.radius));
        if !is_capped {
            self.packing *= packing;
            let miss = miss.max(1.0 / miss);
            if self.nearest.as_ref().is_none_or(|nearest| miss < nearest.miss) {
                let (radius, sizing) = (self.radius, self.sizing.clone());
                self.nearest = Some(Box::new(Nearest { miss, radius, sizing }));
            }
        }
        if self.search.completed == MAX_ATTEMPTS {
            let Some(nearest) = self.nearest.take() else { return false };
            let is_other = nearest.radius != self.radius || is_capped;
            (self.radius, self.sizing) = (nearest.radius, nearest.sizing);
            return is_other;
        }
        let is_trusted = !is_capped && (1.0 / TRUSTED..=TRUSTED).contains(&packing);
        let most_change = if is_trusted { f64::INFINITY } else { MOST_CHANGE };
        let factor = self.search.advance(if is_capped { f64::INFINITY } else { miss }, most_change);
        self.radius *= factor;
        if let Some(sizing) = &mut self.sizing {
            sizing.scale(factor);
        }
        self.set_radius_by_sizing();
        true
    }

    /// Records that the refinement of this attempt's front has ended with `count` particles.
    /// Returns whether another front, with the radius as now corrected, should come nearer to the
    /// wanted count: on flat patches the lattice stays as the front has placed it. After the last
    /// one, restores the nearest. The radius of the refined particles stays, and so does a lattice
    /// without a defect, if the first front `is_in_order`: its number can only leap.
    pub(super) fn is_front_corrected(
        &mut self,
        settings: &Settings,
        count: usize,
        is_in_order: bool,
    ) -> bool {
        let miss = count as f64 / f64::from(settings.count);
        let Some(refining) = &mut self.refining else { return false };
        let Refining { search, halvings, failures, .. } = *refining;
        if settings.size_mode == SizeMode::Radius
            || (miss - 1.0).abs() <= COUNT_TOLERANCE
            || search.completed >= MAX_COARSE_ATTEMPTS
            || (is_in_order && search.completed == 0)
        {
            return false;
        }
        let own = NearestFront { miss: miss.max(1.0 / miss), scale: search.scale, halvings, failures };
        if refining.nearest.is_none_or(|nearest| own.miss < nearest.miss) {
            refining.nearest = Some(own);
        }
        refining.search.completed += 1;
        if refining.search.completed < MAX_COARSE_ATTEMPTS {
            refining.search.advance(miss, f64::INFINITY);
            return true;
        }
        refining.recall_nearest() && refining.search.scale != own.scale
    }
}
