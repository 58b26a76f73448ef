//! The generation levels of a front: the loop that both kinds of front share, and what they keep of a level.
//!
//! A level has three stages. Every parent predicts its children, which get provisional places in the particle columns. All
//! children are projected onto the surface, a batch at a time. Their fates are then decided one by one in the order of the
//! queue, and those that are placed close up over those that are not.

use crate::math::{Bounds, sort_few, tangent_frame};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::fates::FateCounts;
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::settings::Settings;
use crate::sampler::sheet::{OrientedPoint, SheetRule};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::Vec3;

/// The probe, the radius field, the neighbour lists and the particles that a front works on.
pub(crate) struct FrontContext<'a, 'f> {
    pub(crate) probe: &'a mut Probe<'f>,
    /// The radius field, which the adaptive front needs.
    pub(crate) sizing: Option<&'a Sizing>,
    pub(crate) neighbours: &'a mut PackedNeighbours,
    pub(crate) particles: &'a mut Particles,
}

impl<'a> FrontContext<'a, '_> {
    /// The radius field of an adaptive run.
    pub(crate) fn sizing(&self) -> &'a Sizing {
        self.sizing.expect("an adaptive run begins with a radius field")
    }
}

/// Parameters of an attempt that a front needs before its first seed.
pub(crate) struct FrontSetup<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) bounds: &'a Bounds,
    pub(crate) survey: &'a Survey,
    /// Radius of the particles of the uniform front.
    pub(crate) radius: f32,
    /// Radii of the particles of the adaptive front.
    pub(crate) radii: RadiusRange,
    /// Particles to reserve room for.
    pub(crate) expected: usize,
}

impl FrontSetup<'_> {
    /// The rule that tells the sheets of particles with radii in this range apart.
    pub(crate) fn rule(&self, radii: RadiusRange) -> SheetRule {
        SheetRule::new(self.survey.crowding, radii, self.survey.residual_limits())
    }
}

/// Stage of a level: the work that is done for each parent or child in turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum LevelStage {
    /// Predict the children of a parent.
    #[default]
    Place,
    /// Project children onto the surface.
    Project,
    /// Decide the fate of a child.
    Settle,
}

/// State of a front within its level, and its limits.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrontLevel {
    stage: LevelStage,
    /// Next parent of the stage, or next child.
    next: usize,
    /// Index that the first child of this level has while it is provisional, and that the first one placed keeps.
    pub(crate) first_child: usize,
    /// Particles before this index are final. Provisional children stand from here on.
    pub(crate) settled: usize,
    pub(crate) bounds: Bounds,
    pub(crate) max_particles: usize,
    pub(crate) fates: FateCounts,
    /// Whether the limit on particles was reached.
    pub(crate) capped: bool,
}

impl FrontLevel {
    pub(crate) fn new(bounds: Bounds, max_particles: usize) -> Self {
        Self { bounds, max_particles, ..Self::default() }
    }

    /// Begins a level. Its children follow the particles that are final.
    pub(crate) fn begin(&mut self) {
        (self.stage, self.next) = (LevelStage::Place, 0);
        self.first_child = self.settled;
    }

    /// Counts the slots of particles that were placed before the front: those of tips are taken.
    pub(crate) fn count_known(&mut self, known: &[Slots]) {
        let fates = known.iter().flat_map(|slots| (0..Slots::COUNT).map(|k| slots.get(k)));
        fates.for_each(|fate| self.fates.count(fate));
    }
}

/// The children of a level between their prediction and their fate: a child `C` poses a problem `P`, whose solution is an `L`.
#[derive(Clone, Debug)]
pub(crate) struct ProvisionalChildren<C, P, L> {
    /// The children, in the order of their provisional places.
    pub(crate) list: Vec<C>,
    /// Landing of each child, in the order of `list`.
    pub(crate) landings: Vec<L>,
    /// Largest distance between a provisional and a final place in this level.
    pub(crate) drift: f32,
    /// The problems of a batch and their solutions.
    pub(crate) problems: Vec<P>,
    pub(crate) solutions: Vec<L>,
}

impl<C, P, L> Default for ProvisionalChildren<C, P, L> {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            landings: Vec::new(),
            drift: 0.0,
            problems: Vec::new(),
            solutions: Vec::new(),
        }
    }
}

impl<C, P, L> ProvisionalChildren<C, P, L> {
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.landings.clear();
        self.drift = 0.0;
    }
}

/// A front that grows in levels.
pub(crate) trait LevelFront {
    /// The rule that tells sheets apart.
    fn rule(&self) -> SheetRule;

    /// Forgets an earlier run.
    fn reset(&mut self, setup: &FrontSetup);

    /// Gives back the memory that only the front needs.
    fn release(&mut self);

    /// The state of the front within its level.
    fn level(&self) -> &FrontLevel;

    /// The state of the front within its level, for changes.
    fn level_mut(&mut self) -> &mut FrontLevel;

    /// Number of parents in the level; none if the front has come to its end.
    fn parents(&self) -> usize;

    /// Number of provisional children in the level.
    fn children(&self) -> usize;

    /// Stage one: finds the free slots of a parent of the level and enters a provisional child in each.
    fn place_children(&mut self, context: &mut FrontContext, parent: usize);

    /// Stage two: projects a batch of children onto the surface.
    fn project_children(&mut self, context: &mut FrontContext, children: Range<usize>);

    /// Stage three: decides the fate of a child.
    fn settle_child(&mut self, context: &mut FrontContext, child: usize);

    /// Makes the children that were placed the parents of the next level.
    fn end_level(&mut self);

    /// Drops the parents and the provisional children.
    fn clear_level(&mut self);

    /// Adds a seed on a patch, between two levels. Says whether it could: an adaptive one needs a curvature.
    fn add_seed(&mut self, context: &mut FrontContext, seed: OrientedPoint, patch: Option<u32>) -> bool;

    /// Whether the last particle, a seed that stayed alone, touches another one of whatever sheet.
    fn is_seed_crowded(&mut self, particles: &Particles) -> bool;

    /// Forgets the last seed, which has the index `seed`.
    fn forget_seed(&mut self, seed: usize);

    /// Takes in the rows of the particles on creases, which are the only ones so far: they are the parents of the first level. Each has
    /// a direction along its crease in `along`.
    fn add_creases(&mut self, context: &mut FrontContext, along: &[Vec3]);

    /// The particles within a distance of a place, of whatever sheet.
    fn within(&mut self, position: Vec3, distance: f32) -> &[Neighbour];

    /// Collects the particles on the patch of a `point` that face the same way and are so near that no front need start there.
    fn gather_cover(
        &mut self,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> &mut Vec<Neighbour>;

    /// Goes on to the gaps, once the surface is covered; false if there is none to fill.
    fn begin_filling(&mut self) -> bool;

    /// Fills gaps with up to `budget` units of work and returns what is left.
    fn fill(&mut self, context: &mut FrontContext, budget: u32) -> u32;

    /// Whether no gap is left.
    fn is_filled(&self) -> bool;

    /// Particles placed in gaps.
    fn filled(&self) -> u64;

    /// Whether every particle has placed its children.
    fn is_done(&self) -> bool {
        self.parents() == 0
    }

    /// Does up to `budget` units (the slots of a parent, the projection of a child, the fate of a child) and returns what is
    /// left.
    fn step(&mut self, context: &mut FrontContext, mut budget: u32) -> u32 {
        while budget > 0 && !self.is_done() {
            let &FrontLevel { stage, next, .. } = self.level();
            let count = match stage {
                LevelStage::Place => (self.parents() - next).min(1),
                LevelStage::Project => {
                    let most = (self.children() - next).min(BATCH).min(budget as usize);
                    self.on_one_patch(context.particles, next, most)
                }
                LevelStage::Settle => (self.children() - next).min(1),
            };
            if count == 0 {
                self.end_stage(context.particles);
                continue;
            }
            match stage {
                LevelStage::Place => self.place_children(context, next),
                LevelStage::Project => self.project_children(context, next..next + count),
                LevelStage::Settle => self.settle_child(context, next),
            }
            self.level_mut().next += count;
            budget -= count as u32;
        }
        budget
    }

    /// Number of children from child `first` on, `most` at most, that lie on one patch.
    fn on_one_patch(&self, particles: &Particles, first: usize, most: usize) -> usize {
        let first = self.level().first_child + first;
        let patch = particles.patch_of(first);
        let is_on = |&k: &usize| particles.is_on(first + k, patch);
        if patch.is_none() { most } else { (0..most).take_while(is_on).count() }
    }

    /// Goes on to the next stage, or to the next level.
    fn end_stage(&mut self, particles: &mut Particles) {
        let level = self.level_mut();
        level.next = 0;
        match level.stage {
            LevelStage::Place => level.stage = LevelStage::Project,
            LevelStage::Project => level.stage = LevelStage::Settle,
            LevelStage::Settle => {
                particles.truncate(level.settled);
                self.end_level();
                if self.level().capped {
                    self.clear_level();
                }
                self.level_mut().begin();
            }
        }
    }
}

/// What needs no code of its own in either front.
impl dyn LevelFront + '_ {
    /// Ends the front where it is: what is not final is dropped.
    pub(crate) fn stop(&mut self, particles: &mut Particles) {
        particles.truncate(self.level().settled);
        self.clear_level();
    }

    /// Whether the last seed stayed alone beside another particle: it is the far side of something too small for the radius.
    pub(crate) fn has_lone_seed(&mut self, particles: &Particles) -> bool {
        let is_seed = particles.parent.last() == Some(&Particles::NO_PARENT);
        let is_lone = is_seed && particles.len() > particles.twins.len();
        is_lone && self.is_seed_crowded(particles)
    }

    /// Takes the last seed back, which stayed alone.
    pub(crate) fn drop_last_seed(&mut self, context: &mut FrontContext) {
        let last = context.particles.len() - 1;
        self.forget_seed(last);
        let level = self.level_mut();
        for k in 0..Slots::COUNT {
            level.fates.uncount(context.particles.slots[last].get(k));
        }
        level.settled = last;
        context.particles.truncate(last);
        context.neighbours.truncate(last);
    }

    /// Whether a particle of the sheet of a `point` is so near that no front need start there. `patch` is that of the point.
    pub(crate) fn is_covered(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> bool {
        let rule = self.rule();
        let found = self.gather_cover(particles, point, patch);
        let spacing = |j: usize| 2.0 * particles.radius[j];
        rule.is_near_own(probe, particles, point, found, spacing)
    }

    /// The particles that [`LevelFront::gather_cover`] finds around a `point`, the nearest first.
    pub(crate) fn list_cover(
        &mut self,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> Vec<u32> {
        let found = self.gather_cover(particles, point, patch);
        sort_few(found, |a, b| (a.distance_sq, a.index) < (b.distance_sq, b.index));
        found.iter().map(|found| found.index).collect()
    }
}

/// The directions in the tangent plane of a parent from which the angles of its slots are measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotFrame {
    /// Unit normal.
    pub(crate) n: Vec3,
    /// Unit tangent vector at angle 0, where the parent's own parent is (paper §4.4).
    pub(crate) u: Vec3,
    /// Unit tangent vector at 90°.
    pub(crate) w: Vec3,
    /// Whether the parent has no parent, and any direction will do.
    pub(crate) is_seed: bool,
}

impl SlotFrame {
    /// The frame of a particle. That of one on a crease has its first axis in the direction in `along`, which has an entry for each of
    /// them.
    pub(crate) fn of(particles: &Particles, particle: usize, along: &[Vec3]) -> Self {
        let (p, n) = (particles.position[particle], particles.normal[particle]);
        let parent = particles.parent[particle];
        let is_seed = parent == Particles::NO_PARENT;
        let towards = if is_seed {
            along.get(particle).copied().unwrap_or(Vec3::ZERO)
        } else {
            particles.position[parent as usize] - p
        };
        let towards = (towards - n * towards.dot(n)).normalize_or_zero();
        let (u, w) = if towards == Vec3::ZERO { tangent_frame(n) } else { (towards, n.cross(towards)) };
        Self { n, u, w, is_seed }
    }
}

/// Slots of a new particle: the first one is its parent's.
pub(crate) fn initial_slots() -> Slots {
    let mut slots = Slots::default();
    slots.set(0, SlotFate::Parent);
    slots
}
