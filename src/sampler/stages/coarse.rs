//! How coarse the front of a refined run is: by the curvature at first, then by what was refused,
//! and by the wanted count.

use crate::field::Evaluator;
use crate::math::{Bounds, sort_numbers};
use crate::sampler::attempt::{Attempt, is_met};
use crate::sampler::constraint::CreaseLadder;
use crate::sampler::count::{Next, Search};
use crate::sampler::front::FrontPlan;
use crate::sampler::refine::{self, Components, Refusal, SurfaceFacts, Target};
use crate::sampler::settings::{Settings, SizeMode};
use crate::sampler::surface::Surface;
use glam::Vec3;

/// Coarse fronts that are tried to meet a wanted count.
const MOST_FRONTS: u32 = 4;

/// The plan of the coarse fronts of a run, and what has become of them so far.
pub(in crate::sampler) struct Refining {
    /// Number of halvings that lead from the radius of the front to that of the particles.
    pub(in crate::sampler) halvings: u32,
    /// The search for the radius of the front that meets the wanted count. The radius of the
    /// refined particles stays.
    search: Search<Coarseness>,
    /// Whether the surface has creases.
    is_creased: bool,
    /// The particles on creases at every level, where there are creases.
    pub(in crate::sampler) ladder: Option<CreaseLadder>,
    /// Point of the surface with the largest curvature.
    bend: Vec3,
    /// Number of refinements that failed.
    failures: u32,
    /// The first failure, which is the one to report: the last one may only be that nothing is left
    /// to try.
    failure: Option<Refusal>,
}

/// The halvings and the failures of a front.
type Coarseness = (u32, u32);

impl Refining {
    /// Plans coarse fronts on a surface, and makes `attempt` one at their refinement. There is no
    /// pilot run: the refinement meets the wanted count by itself.
    ///
    /// # Errors
    ///
    /// Why the surface cannot be refined. The attempt is then as it was.
    pub(in crate::sampler) fn new(
        attempt: &mut Attempt,
        field: &mut dyn Evaluator,
        surface: &Surface,
        settings: &Settings,
    ) -> Result<Self, Refusal> {
        let Surface { survey, creases, tips, .. } = surface;
        if let Some(at) = creases.passed {
            return Err(Refusal::Singular { at: at.as_vec3().into() });
        }
        let points = &survey.position;
        let mut curvature = refine::largest_curvatures(field, points);
        for (curvature, &p) in curvature.iter_mut().zip(points) {
            if tips.iter().any(|tip| tip.explains(p, *curvature)) {
                *curvature = 0.0;
            }
        }
        let mut aimed = attempt.clone();
        let count = attempt.predicted_count(settings);
        aimed.aim_at(count);
        let radius = aimed.radius;
        let most = (0..points.len()).max_by(|&i, &j| curvature[i].total_cmp(&curvature[j]));
        let bend = most.map_or(Vec3::ZERO, |i| points[i]);
        let bent = Refusal::Bent { at: bend.into() };
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
            return Err(Refusal::Few { expected: expected as u64 });
        }
        let halvings = halvings.ok_or(bent)?;
        let refining = Self {
            halvings,
            search: Search::new(MOST_FRONTS),
            is_creased: creases.are_there(),
            ladder: None,
            bend,
            failures: 0,
            // Why no coarser front is tried, should this one fail.
            failure: (halvings == 0).then_some(bent),
        };
        refining.grade(&mut aimed, settings);
        if aimed.predicted_count(settings) > f64::from(settings.max_particles) {
            return Err(Refusal::Full);
        }
        *attempt = aimed;
        Ok(refining)
    }

    /// Radius of the front.
    fn front_radius(&self, attempt: &Attempt) -> f64 {
        attempt.radius * (refine::FRONT_RADIUS * f64::from(1_u32 << self.halvings) * self.search.scale)
    }

    /// Grades the radius field on a surface with creases. The radii of the front vary there, too:
    /// it decides how many particles lie on each crease. Each level has the radii of the front
    /// divided by a power of two, and so has their slope.
    fn grade(&self, attempt: &mut Attempt, settings: &Settings) {
        if self.is_creased {
            let share = self.front_radius(attempt) / attempt.radius;
            attempt.grade(settings, settings.grading / share);
        }
    }

    /// The next front, for particles in a box. It grows in a larger box, with particles of one size
    /// unless there are creases.
    pub(in crate::sampler) fn front(
        &self,
        attempt: &mut Attempt,
        settings: &Settings,
        bounds: &Bounds,
    ) -> FrontPlan {
        self.grade(attempt, settings);
        let radius = self.front_radius(attempt);
        let sizing = attempt.sizing.as_ref().filter(|_| self.is_creased).cloned();
        FrontPlan {
            bounds: refine::grown(bounds, radius),
            radius: radius as f32,
            sizing: sizing.map(|sizing| sizing.graded(settings.grading, radius / attempt.radius)),
            match_tolerance: refine::MATCH_TOLERANCE,
            expected: attempt.expected(radius),
            halvings: Some(self.halvings),
            ..attempt.front(settings, bounds)
        }
    }

    /// The target of the refinement.
    pub(super) fn target(&self, attempt: &Attempt, settings: &Settings) -> Target {
        attempt.target(settings, self.halvings)
    }

    /// What the refinement uses of the surface in a box.
    pub(super) fn facts<'a>(&'a self, attempt: &'a Attempt, bounds: &Bounds) -> SurfaceFacts<'a> {
        SurfaceFacts {
            bounds: *bounds,
            sizing: attempt.sizing.as_ref(),
            ladder: self.ladder.as_ref(),
            bend: self.bend,
            failures: self.failures,
        }
    }

    /// Takes in that a front was refused. The next one has half the radius, or is the one that came
    /// nearest to the wanted count. Pieces between creases are refined at least once, and so is a
    /// component of varying sizes that `is_lone`.
    ///
    /// # Errors
    ///
    /// Why the surface is not refined, if nothing is left to try.
    pub(in crate::sampler) fn refuse(
        &mut self,
        refusal: Refusal,
        attempt: &Attempt,
        is_lone: bool,
    ) -> Result<(), Refusal> {
        if let Some(nearest) = self.search.recall() {
            (self.halvings, self.failures) = nearest;
            return Ok(());
        }
        let first = *self.failure.get_or_insert(refusal);
        let least = u32::from(self.ladder.is_some() || is_lone && attempt.sizing.is_some());
        if self.halvings <= least || !refusal.is_coarse() {
            return Err(first);
        }
        self.halvings -= 1;
        Ok(())
    }

    /// Takes in that a refinement was refused: see [`Refining::refuse`].
    ///
    /// # Errors
    ///
    /// Why the surface is not refined, if nothing is left to try.
    pub(in crate::sampler) fn fail(
        &mut self,
        refusal: Refusal,
        components: &Components,
        attempt: &Attempt,
        is_lone: bool,
    ) -> Result<(), Refusal> {
        self.halvings = components.fewest_halvings();
        self.failures += 1;
        self.refuse(refusal, attempt, is_lone)
    }

    /// Takes in that a refinement has ended with `count` particles. Returns whether another front
    /// should come nearer to the wanted count: on flat patches the lattice stays as the front has
    /// placed it. A lattice without a defect stays, if it is that of the first front: its number
    /// can only leap.
    pub(in crate::sampler) fn is_corrected(
        &mut self,
        settings: &Settings,
        count: usize,
        components: &Components,
    ) -> bool {
        // The component that was refined least sets how coarse the next front may be.
        self.halvings = components.fewest_halvings();
        let miss = count as f64 / f64::from(settings.count);
        let stands = self.search.is_new() && components.are_in_order();
        if settings.size_mode == SizeMode::Radius || is_met(miss) || stands {
            return false;
        }
        match self.search.next(miss, f64::INFINITY, (self.halvings, self.failures)) {
            Next::None => return false,
            Next::Scaled(_) => {}
            Next::Back(nearest) => (self.halvings, self.failures) = nearest,
        }
        true
    }
}
