//! The recipe of each level: the number of sweeps, the rounds of surgery, and their order.

/// A pass over the particles, the half-edges or the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pass {
    /// Takes the sizes from the radius field or, if not `is_whole`, their square roots: halfway
    /// from one size to the field's.
    Size { is_whole: bool },
    /// Limits the slope of the sizes, from the first particle to the last one or back.
    Limit { back: bool },
    /// Measures the faces, which determines the spacing.
    Measure,
    /// A sweep of the springs.
    Sweep,
    /// Flips the edges that are not Delaunay's.
    Flip,
    /// A round of surgery, which also accepts trials that lose up to `loss`, in units of the
    /// spacing squared.
    Mend { loss: f32 },
    /// Finds the particles near defects.
    Find,
    /// A step of Lloyd's method for the particles near defects.
    Centre,
    /// Removes one of each pair of particles that crowd at the border.
    Thin,
    /// A step of Newton's method for every particle, so that positions and normals are on the
    /// surface.
    Land,
    /// A step of Newton's method to a surface that has moved for every particle, out of the box if
    /// it leads there.
    Follow,
    /// Cuts away the part beyond the box.
    Clip,
    /// Checks the orientation of the finished faces.
    Inspect,
}

/// The passes of a level.
#[derive(Clone, Debug, Default)]
pub(super) struct Recipe {
    pub(super) passes: Vec<Pass>,
    /// Rest length of the springs over the spacing.
    pub(super) theta: f32,
    /// Price of a defect, in units of the spacing squared.
    pub(super) delta: f32,
    /// Surgery also tries a particle without a defect if its edges are too short or too long by
    /// this share on average.
    pub(super) stretch: f32,
}

/// Plan of a level. A flip follows every sweep.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// Sweeps at the start.
    sweeps: usize,
    /// Rest length of the springs over the spacing.
    theta: f32,
    /// Price of a defect, in units of the spacing squared.
    delta: f32,
}

/// Tuning parameters of the recipes.
pub(super) struct Tuning {
    /// Plan of the coarse level, where the few particles are ordered.
    first: Plan,
    /// Plan of the levels between, which keep the order while scars grow.
    between: Plan,
    /// Plan of the last level, where the lattice relaxes. With one size surgery would add more
    /// defects there than it removes.
    last: Plan,
    /// Rounds of surgery at every level before the last one, with a sweep after each. The first
    /// half of them is skipped where they cost most: on the last level but one, and on a first
    /// level at full resolution, which then relaxes by the last level's plan.
    rounds: usize,
    /// Surgery tries a particle without a defect if its edges are too short or too long by this
    /// share.
    stretch: f32,
    /// The same share for a frame of a moving mesh, and for the last level of varying sizes, where
    /// order has to be kept.
    kept_stretch: f32,
    /// Least gain of a trial in a frame of a moving mesh, and at the last level of varying sizes,
    /// in units of the spacing squared.
    least_gain: f32,
    /// Loss that the first round of surgery accepts, in units of the spacing squared. It falls to 0
    /// by the last round.
    loss: f32,
    /// Over-relaxation of the sweeps.
    pub(super) omega: f32,
    /// Decrease of the rest length of the last level per share of particles with a defect: the more
    /// defects there are, the more the lattice between them is strained, and the stiffer in shear
    /// it must be.
    theta_per_defect: f32,
    /// Shortest rest length of the last level.
    least_theta: f32,
    /// Longest rest length of the last level.
    most_theta: f32,
    /// Steps of Lloyd's method near the defects of the last level.
    lloyd: usize,
    /// Rounds of surgery at sizes halfway between one size and the radius field; the other rounds
    /// of the first level follow at full sizes. The last level of varying sizes, the first with the
    /// full slope, has as many rounds.
    graded_rounds: usize,
}

/// The values. Angles are the smallest angles of triangles, holes and pairs the largest hole and
/// the closest pair. `cargo xtask sensitivity sampler/refine/recipe.rs:rounds` shows what one of
/// them changes.
pub(super) const TUNING: Tuning = Tuning {
    // Smaller δ: fewer particles have six neighbours. Fewer sweeps: more surfaces are refused where
    // sizes differ.
    first: Plan { sweeps: 10, theta: 0.8, delta: 0.045 },
    // If both θ and δ are smaller, holes are wider.
    between: Plan { sweeps: 4, theta: 0.9, delta: 0.015 },
    // θ without defects, before the limits below.
    last: Plan { sweeps: 6, theta: 1.3, delta: 0.0 },
    // More are no better. At full resolution the second half of them heals as much as all.
    rounds: 10,
    // Without it the count is farther off, and holes are wider.
    stretch: 0.04,
    // Without it holes are wider; smaller: a frame takes longer.
    kept_stretch: 0.2,
    // With 0 fewer of the first particles survive. Larger: more do, and holes are wider.
    least_gain: 0.2,
    // Smaller: holes are wider. Larger: fewer particles of a surface that a box cuts have six
    // neighbours.
    loss: 0.1,
    // Halfway from 1, where sweeps are slow, to 2, where they diverge for a quadratic energy.
    omega: 1.5,
    // The limits below then hold for one defect in a hundred particles and for one in forty.
    // Smaller: pairs are farther apart, and angles smaller; larger: the other way round.
    theta_per_defect: 30.0,
    // Smaller: holes are wider where sizes differ; larger: angles are smaller.
    least_theta: 0.6,
    // Smaller: pairs are nearer, and angles larger.
    most_theta: 0.98,
    // More: pairs are farther apart, and angles smaller.
    lloyd: 2,
    // More: holes are narrower, and fewer particles have six neighbours.
    graded_rounds: 2,
};

/// The level for which a recipe is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelFacts {
    /// Whether it is the coarse level, where the lattice is ordered.
    pub(super) is_first: bool,
    /// Levels still to come after this one.
    pub(super) to_come: u32,
    /// Whether sizes vary.
    pub(super) is_graded: bool,
    pub(super) has_border: bool,
    /// Share of the particles that have a defect.
    pub(super) defects: f32,
}

/// The rounds of surgery, by the loss that each of them accepts: threshold accepting.
fn losses() -> impl Iterator<Item = f32> {
    (0..TUNING.rounds).rev().map(|to_come| TUNING.loss * to_come as f32 / (TUNING.rounds - 1) as f32)
}

impl Recipe {
    pub(super) fn of(level: &LevelFacts) -> Self {
        let &LevelFacts { is_first, to_come, is_graded, has_border, defects } = level;
        let is_last = to_come == 0 && !is_first;
        let plan = match (is_first, is_last) {
            (true, _) => TUNING.first,
            (false, false) => TUNING.between,
            (false, true) => {
                let theta = TUNING.last.theta - TUNING.theta_per_defect * defects;
                Plan { theta: theta.clamp(TUNING.least_theta, TUNING.most_theta), ..TUNING.last }
            }
        };
        let stretch = if is_last { TUNING.kept_stretch } else { TUNING.stretch };
        let mut recipe = Self { passes: vec![Pass::Measure], theta: plan.theta, delta: plan.delta, stretch };
        let losses: Vec<f32> = match to_come {
            0 if is_last && is_graded => vec![-TUNING.least_gain; TUNING.graded_rounds],
            0 if is_last => Vec::new(),
            0 | 1 if to_come == 0 || !is_first => losses().skip(TUNING.rounds / 2).collect(),
            _ => losses().collect(),
        };
        if is_graded && is_first {
            recipe.blend(plan, &losses);
        } else {
            recipe.rounds(plan, &losses, is_graded);
        }
        // Lloyd's method is only for one size: it would bring small and large particles to one
        // distance.
        if is_last && !is_graded {
            recipe.passes.push(Pass::Find);
            recipe.passes.extend([Pass::Centre].repeat(TUNING.lloyd));
        }
        if has_border && is_last {
            recipe.passes.extend([Pass::Thin, Pass::Flip]);
        }
        recipe.passes.push(Pass::Land);
        if is_graded && is_last {
            recipe.passes.push(Pass::Size { is_whole: true });
        }
        if is_last {
            recipe.passes.push(Pass::Inspect);
        }
        recipe
    }

    /// The passes of a frame of a mesh that follows a moving surface, by the plan of the levels
    /// between.
    pub(super) fn of_frame(is_graded: bool, has_border: bool) -> Self {
        let Plan { theta, delta, .. } = TUNING.between;
        let mend = Pass::Mend { loss: -TUNING.least_gain };
        let passes = vec![Pass::Follow, Pass::Follow, Pass::Clip];
        let mut recipe = Self { passes, theta, delta, stretch: TUNING.kept_stretch };
        if is_graded {
            recipe.size(true);
        }
        recipe.sweep(1);
        recipe.passes.extend([Pass::Measure, mend]);
        recipe.sweep(1);
        if has_border {
            recipe.passes.extend([Pass::Thin, Pass::Flip]);
        }
        recipe.passes.push(Pass::Inspect);
        recipe
    }

    /// The sweeps of a plan, and rounds of surgery with a sweep after each. Varying sizes are
    /// looked up again before each round.
    fn rounds(&mut self, plan: Plan, losses: &[f32], is_graded: bool) {
        if is_graded {
            self.size(true);
        }
        self.sweep(plan.sweeps);
        for &loss in losses {
            if is_graded {
                self.size(true);
            }
            self.passes.push(Pass::Mend { loss });
            self.sweep(1);
        }
    }

    /// The first level of varying sizes: it relaxes with one size, and reaches the wanted sizes in
    /// two steps.
    fn blend(&mut self, plan: Plan, losses: &[f32]) {
        let (half, whole) = losses.split_at(TUNING.graded_rounds);
        self.sweep(plan.sweeps);
        for (is_whole, losses) in [(false, half), (true, whole)] {
            self.size(is_whole);
            for &loss in losses {
                self.passes.push(Pass::Mend { loss });
                self.sweep(1);
                self.size(is_whole);
            }
        }
    }

    fn sweep(&mut self, count: usize) {
        self.passes.extend([Pass::Sweep, Pass::Flip].repeat(count));
    }

    fn size(&mut self, is_whole: bool) {
        // Both ways, because the order is breadth first: what is far in one direction is near on
        // the surface in the other.
        self.passes.extend([
            Pass::Size { is_whole },
            Pass::Limit { back: false },
            Pass::Limit { back: true },
            Pass::Measure,
        ]);
    }
}

#[cfg(test)]
mod tests {
    use super::{LevelFacts, Pass, Recipe, TUNING};

    fn passes(to_come: u32, is_graded: bool) -> Vec<Pass> {
        let is_first = to_come == 3;
        Recipe::of(&LevelFacts { is_first, to_come, is_graded, has_border: false, defects: 0.0 }).passes
    }

    fn rounds(passes: &[Pass]) -> usize {
        passes.iter().filter(|pass| matches!(pass, Pass::Mend { .. })).count()
    }

    #[test]
    fn a_level_is_measured_first_and_the_last_one_inspected_in_the_end() {
        for to_come in 0..=3 {
            for is_graded in [false, true] {
                let passes = passes(to_come, is_graded);
                assert_eq!(passes[0], Pass::Measure);
                assert_eq!(passes.last() == Some(&Pass::Inspect), to_come == 0);
                assert_eq!(rounds(&passes) > 0, to_come > 0 || is_graded, "{to_come} levels to come");
                let has_sizes = passes.iter().any(|pass| matches!(pass, Pass::Size { .. }));
                assert_eq!(has_sizes, is_graded);
            }
        }
    }

    #[test]
    fn losses_fall_to_none_and_the_last_level_but_one_has_the_second_half_of_the_rounds() {
        let losses = |to_come| {
            let loss = |pass: &Pass| if let Pass::Mend { loss } = *pass { Some(loss) } else { None };
            passes(to_come, false).iter().filter_map(loss).collect::<Vec<_>>()
        };
        let whole = losses(2);
        assert_eq!(whole.len(), TUNING.rounds);
        assert!(whole.is_sorted_by(|a, b| a >= b) && whole[0] == TUNING.loss, "{whole:?}");
        assert_eq!(whole.last(), Some(&0.0));
        assert_eq!(losses(1), whole[whole.len() / 2..]);
    }

    #[test]
    fn more_defects_make_the_last_level_stiffer() {
        let theta = |to_come, defects| {
            let facts = LevelFacts { is_first: false, to_come, is_graded: false, has_border: false, defects };
            Recipe::of(&facts).theta
        };
        let thetas = [0.0, 0.01, 0.015, 0.02, 0.03, 1.0].map(|defects| theta(0, defects));
        assert!(thetas.is_sorted_by(|a, b| a >= b) && thetas[1] > thetas[4], "{thetas:?}");
        assert_eq!((thetas[0], thetas[5]), (TUNING.most_theta, TUNING.least_theta));
        assert_eq!(theta(1, 0.0), theta(1, 1.0));
    }
}
