//! What is done at each level, as numbers: how many sweeps, how much surgery, and in which order.

/// One pass over the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pass {
    /// A sweep of the springs.
    Sweep,
    /// Flips to Delaunay's edges.
    Flip,
    /// A round of surgery.
    Mend,
    /// Finds the particles near defects.
    Find,
    /// A step of Lloyd's method for those.
    Centre,
    /// One step of Newton's method for everyone, so that positions and normals are those of the surface.
    Land,
}

/// The passes of a level: sweeps, then rounds of surgery with sweeps after each, then Lloyd's method near the defects that are left.
/// A flip follows every sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    /// Sweeps at the start.
    sweeps: usize,
    /// Rounds of surgery.
    rounds: usize,
    /// Sweeps after each.
    calm: usize,
    /// Lloyd steps near defects.
    centre: usize,
    /// Rest length of the springs over the spacing.
    pub(super) theta: f32,
    /// Over-relaxation of the sweeps.
    pub(super) omega: f32,
    /// Price of a defect.
    pub(super) delta: f32,
}

/// The first level. Its particles are few, and what is mended here holds on every finer level.
const FIRST: Recipe =
    Recipe { sweeps: 10, rounds: 10, calm: 3, centre: 0, theta: 0.8, omega: 1.5, delta: 0.03 };
/// The levels between: rest lengths nearer to the spacing keep particles and holes even (closest pairs 0.80 instead of 0.78 of
/// the ideal on the ellipsoid), and cost 0.1° of the mean angle.
const MIDDLE: Recipe =
    Recipe { sweeps: 4, rounds: 5, calm: 2, centre: 0, theta: 0.9, omega: 1.5, delta: 0.015 };
/// The last level but one, where surgery costs most.
const LAST_BUT_ONE: Recipe =
    Recipe { sweeps: 4, rounds: 4, calm: 1, centre: 0, theta: 0.9, omega: 1.5, delta: 0.012 };
/// The last level: surgery would add more defects than it takes.
const LAST: Recipe = Recipe { sweeps: 4, rounds: 0, calm: 0, centre: 4, theta: 0.9, omega: 1.5, delta: 0.0 };
impl Recipe {
    /// The recipe of a level, with so many levels to come.
    pub(super) fn of(is_first: bool, to_come: u32) -> Self {
        match (is_first, to_come) {
            (true, _) => FIRST,
            (false, 0) => LAST,
            (false, 1) => LAST_BUT_ONE,
            (false, _) => MIDDLE,
        }
    }

    /// Number of passes.
    pub(super) fn passes(&self) -> usize {
        2 * self.sweeps + self.rounds * (1 + 2 * self.calm) + self.centre + 2
    }

    /// Pass number `at`; `None` after the last.
    pub(super) fn pass(&self, at: usize) -> Option<Pass> {
        let swept = |k: usize| if k.is_multiple_of(2) { Pass::Sweep } else { Pass::Flip };
        let mut k = at;
        if k < 2 * self.sweeps {
            return Some(swept(k));
        }
        k -= 2 * self.sweeps;
        let round = 1 + 2 * self.calm;
        if k < self.rounds * round {
            return Some(if k.is_multiple_of(round) { Pass::Mend } else { swept(k % round - 1) });
        }
        k -= self.rounds * round;
        match k {
            0 => Some(Pass::Find),
            k if k <= self.centre => Some(Pass::Centre),
            k if k == self.centre + 1 => Some(Pass::Land),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Pass, Recipe};

    #[test]
    fn a_recipe_lists_its_passes_in_order() {
        let recipe = Recipe { sweeps: 1, rounds: 2, calm: 1, centre: 1, theta: 1.0, omega: 1.0, delta: 0.0 };
        let passes: Vec<Pass> = (0..).map_while(|at| recipe.pass(at)).collect();
        let round = [Pass::Mend, Pass::Sweep, Pass::Flip];
        let expected =
            [&[Pass::Sweep, Pass::Flip], &round[..], &round, &[Pass::Find, Pass::Centre, Pass::Land]]
                .concat();
        assert_eq!(passes, expected);
        assert_eq!(passes.len(), recipe.passes());
    }
}
