//! What is done at each level: how many sweeps, how much surgery, and in which order.

use super::sizes::WHOLE;

/// One pass over the particles, the half-edges or the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pass {
    /// Takes the sizes from the radius field, to the power of so many quarters.
    Size(u8),
    /// Limits the slope of the sizes, from the first particle to the last one or back.
    Limit { back: bool },
    /// Measures the surface: the spacing follows.
    Measure,
    /// A sweep of the springs.
    Sweep,
    /// Flips to Delaunay's edges.
    Flip,
    /// A round of surgery, which also keeps trials that lose up to so much, in units of the spacing squared.
    Mend { loss: f32 },
    /// Finds the particles near defects.
    Find,
    /// A step of Lloyd's method for those.
    Centre,
    /// Finds the pairs of particles that crowd at the border, and takes one of each out.
    Thin,
    /// One step of Newton's method for everyone, so that positions and normals are those of the surface.
    Land,
    /// Looks at the finished faces.
    Inspect,
}

/// The passes of a level.
#[derive(Clone, Debug, Default)]
pub(super) struct Recipe {
    pub(super) passes: Vec<Pass>,
    /// Rest length of the springs over the spacing.
    pub(super) theta: f32,
    /// Price of a defect.
    pub(super) delta: f32,
}

/// Sweeps, then rounds of surgery with sweeps after each, then Lloyd's method near the defects that are left. A flip follows every
/// sweep.
#[derive(Clone, Copy)]
struct Plan {
    /// Sweeps at the start.
    sweeps: usize,
    /// Rounds of surgery.
    rounds: usize,
    /// Sweeps after each.
    calm: usize,
    /// Lloyd steps near defects.
    centre: usize,
    theta: f32,
    delta: f32,
    /// Loss that the first round of surgery accepts, in units of the spacing squared.
    loss: f32,
}

/// The first round of surgery accepts trials that lose up to the `loss` of the plan, each later round less, and from this share of
/// the rounds on none does. A scar in a bad place can so pass through a worse one to a better: threshold accepting, G. Dueck and T.
/// Scheuer, Journal of Computational Physics 90, 1990.
const LOSING_ROUNDS: f32 = 0.7;

/// Over-relaxation of the sweeps.
pub(super) const OMEGA: f32 = 1.5;

/// The first level. Its particles are few, and what is mended here holds on every finer level.
const FIRST: Plan = Plan { sweeps: 10, rounds: 20, calm: 3, centre: 0, theta: 0.8, delta: 0.02, loss: 0.0 };
/// The levels between, on which scars grow. Ten rounds that accept losses, in place of five that do not, gain 0.2° to 0.3° of the
/// mean smallest angle with 56,000 particles on ellipsoid, sphere and torus, for a sixth more evaluations. Longer rest lengths than
/// those of the first level keep distances and holes even: the closest pair on the ellipsoid is at 0.80 of the ideal instead of
/// 0.78, for 0.1° of the mean angle.
const MIDDLE: Plan = Plan { sweeps: 4, rounds: 10, calm: 2, centre: 0, theta: 0.9, delta: 0.015, loss: 0.06 };
/// The last level but one, where surgery costs most.
const LAST_BUT_ONE: Plan =
    Plan { sweeps: 4, rounds: 4, calm: 1, centre: 0, theta: 0.9, delta: 0.012, loss: 0.0 };
/// The last level: surgery would add more defects than it takes.
const LAST: Plan = Plan { sweeps: 4, rounds: 0, calm: 0, centre: 3, theta: 0.98, delta: 0.0, loss: 0.0 };
/// A front that is refined so many times at most has a surface that bends much between neighbours, and plans of its own.
const FEW_LEVELS: u32 = 2;
/// Defects are dearer, and losses are accepted here, since there is no level between.
const FIRST_OF_FEW: Plan = Plan { delta: 0.03, loss: 0.03, ..FIRST };
const LAST_BUT_ONE_OF_FEW: Plan = Plan { loss: 0.02, ..LAST_BUT_ONE };
/// Defects lie nearer to each other, and Lloyd's method would stretch the triangles between them: fewer steps of it, and a stiffer
/// lattice.
const LAST_OF_FEW: Plan = Plan { sweeps: 6, centre: 2, theta: 0.93, ..LAST };
/// The last level of a front that is refined once: stiffer springs do more for the angles than they cost the closest pairs. On the
/// decocube with 20,000 particles the mean smallest angle is 55.8° instead of 55.3° and no triangle is above 90° instead of ten,
/// with the closest pair at 0.777 instead of 0.786.
const LAST_OF_ONE: Plan = Plan { theta: 0.7, ..LAST_OF_FEW };
/// The last two levels of a surface with a border. Those that repeat in space are saddles throughout, with three times the defects
/// of a closed surface. In the strain between these, stiffer springs and cheaper defects do more for the angles than Lloyd's
/// method, which is left to the border. On the gyroid with 20,000 particles the mean smallest angle is 55.6° instead of 54.4°, and
/// the largest hole 1.32 instead of 1.24; on Schwarz's surface 56.5° instead of 55.3°, and 1.28 instead of 1.21.
const LAST_BUT_ONE_WITH_BORDER: Plan = Plan { rounds: 8, theta: 0.8, delta: 0.002, ..LAST_BUT_ONE };
const LAST_WITH_BORDER: Plan = Plan { sweeps: 6, centre: 4, theta: 0.65, ..LAST };

/// Steps in which the first level goes from one size to those of the radius field. At once, neighbours would tangle.
const BLEND: u8 = WHOLE;
/// Sweeps and rounds of surgery in each of them; the rest of the plan's rounds come in the last one. With six rounds the distances
/// spread by 0.061 on the ellipsoid, with two by 0.053: what was mended for other sizes is in the way.
const BLEND_SWEEPS: usize = 3;
const BLEND_ROUNDS: usize = 2;
/// Passes that limit the slope of the sizes: there and back, twice. What is far in that order is near on the surface at some pass,
/// since the order is breadth first.
const LIMITS: usize = 4;

impl Plan {
    /// Loss that a round of surgery accepts.
    fn loss_in(&self, round: usize) -> f32 {
        let done = round as f32 / self.rounds as f32;
        self.loss * (1.0 - done / LOSING_ROUNDS).max(0.0)
    }
}

impl Recipe {
    /// The recipe of a level with so many to come of all `levels`, of one size or of sizes that differ, with a border or without.
    pub(super) fn of(halvings: u32, to_come: u32, is_graded: bool, has_border: bool) -> Self {
        let (is_first, are_few) = (to_come == halvings, halvings <= FEW_LEVELS);
        let mut plan = match (is_first, to_come) {
            (true, _) if are_few => FIRST_OF_FEW,
            (true, _) => FIRST,
            (false, 0) if has_border => LAST_WITH_BORDER,
            (false, 0) if halvings == 1 => LAST_OF_ONE,
            (false, 0) if are_few => LAST_OF_FEW,
            (false, 0) => LAST,
            (false, 1) if has_border => LAST_BUT_ONE_WITH_BORDER,
            (false, 1) if are_few => LAST_BUT_ONE_OF_FEW,
            (false, 1) => LAST_BUT_ONE,
            (false, _) => MIDDLE,
        };
        if is_graded {
            // Lloyd's method is for one size: it would draw small particles and large ones to one distance. On 22 random surfaces
            // the mean smallest angle is 0.5° larger without it, on each of them.
            plan.centre = 0;
        }
        let Plan { theta, delta, .. } = plan;
        let mut recipe = Self { passes: Vec::new(), theta, delta };
        recipe.passes.push(Pass::Measure);
        match (is_graded, is_first) {
            (false, _) => recipe.even(plan),
            (true, true) => recipe.blend(plan),
            (true, false) => recipe.graded(plan),
        }
        if plan.centre > 0 {
            recipe.passes.push(Pass::Find);
            recipe.passes.extend([Pass::Centre].repeat(plan.centre));
        }
        if has_border && to_come == 0 {
            recipe.passes.extend([Pass::Thin, Pass::Flip]);
        }
        recipe.passes.push(Pass::Land);
        if is_graded && to_come == 0 {
            recipe.passes.push(Pass::Size(WHOLE));
        }
        recipe.passes.push(Pass::Inspect);
        recipe
    }

    fn even(&mut self, plan: Plan) {
        self.sweep(plan.sweeps);
        for round in 0..plan.rounds {
            self.passes.push(Pass::Mend { loss: plan.loss_in(round) });
            self.sweep(plan.calm);
        }
    }

    /// The first level of sizes that differ: it is brought to rest with one size, and led to the others step by step.
    fn blend(&mut self, plan: Plan) {
        let before = usize::from(BLEND - 1) * BLEND_ROUNDS;
        self.sweep(plan.sweeps);
        for quarters in 1..=BLEND {
            self.size(quarters);
            self.sweep(BLEND_SWEEPS);
            let rounds = if quarters == BLEND { plan.rounds - before } else { BLEND_ROUNDS };
            for _ in 0..rounds {
                self.passes.push(Pass::Mend { loss: 0.0 });
                self.sweep(plan.calm);
                self.size(quarters);
            }
        }
    }

    fn graded(&mut self, plan: Plan) {
        self.size(WHOLE);
        self.sweep(plan.sweeps);
        for round in 0..plan.rounds {
            self.size(WHOLE);
            self.passes.push(Pass::Mend { loss: plan.loss_in(round) });
            self.sweep(plan.calm);
        }
    }

    fn sweep(&mut self, count: usize) {
        self.passes.extend([Pass::Sweep, Pass::Flip].repeat(count));
    }

    fn size(&mut self, quarters: u8) {
        self.passes.push(Pass::Size(quarters));
        self.passes.extend((0..LIMITS).map(|k| Pass::Limit { back: k % 2 == 1 }));
        self.passes.push(Pass::Measure);
    }
}

#[cfg(test)]
mod tests {
    use super::{Pass, Recipe};

    #[test]
    fn a_level_is_measured_first_and_inspected_last() {
        for to_come in 0..=3 {
            for is_graded in [false, true] {
                let passes = Recipe::of(3, to_come, is_graded, false).passes;
                assert_eq!((passes[0], passes[passes.len() - 1]), (Pass::Measure, Pass::Inspect));
                let surgery = passes.iter().filter(|pass| matches!(pass, Pass::Mend { .. })).count();
                assert_eq!(surgery > 0, to_come > 0, "{to_come} levels to come");
                let has_sizes = passes.iter().any(|pass| matches!(pass, Pass::Size(_)));
                assert_eq!(has_sizes, is_graded);
            }
        }
    }
}
