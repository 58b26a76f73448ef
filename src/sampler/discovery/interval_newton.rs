//! Narrows a cell to the part in which the highest point of a component of the surface can lie.
//!
//! At such a point p the function f and its derivatives along the sides vanish: as many equations
//! as there are free axes. By Taylor's theorem from p to the middle m of the cell, with d = m − p,
//!
//! f(m) = ∂f/∂up(p) · d_up + ½ dᵀ H d  and  ∂f/∂side(m) = (H d)_side,
//!
//! where H holds second derivatives at points between. The sides occur in the first equation only
//! through H. Bounds of H over the cell make both equations linear with intervals for coefficients.
//! They are solved for d axis by axis (Gauss–Seidel). Those of the sides are first multiplied by
//! the inverse of their midpoint matrix, as Krawczyk's and Hansen's forms of the interval Newton
//! method do (R. B. Kearfott, "Rigorous Global Search: Continuous Problems", 1996). Where no
//! solution is left, the cell holds no such point; near one, the range shrinks with the square of
//! the cell's width.

use crate::field::Enclosure;
use crate::math::{Bounds, Interval, ROUNDING, Sym3};
use crate::sampler::discovery::cell::{Axes, Cell};
use glam::DVec3;

/// Rounds of narrowing. Without any there are more cells; further rounds save no more.
const ROUNDS: u32 = 2;

/// The part of `range` in which `slope` · d = `right` has a solution d; none if it has no solution.
fn solved(range: Interval, slope: Interval, right: Interval) -> Option<Interval> {
    let right = right.widened(ROUNDING * (right.magnitude() + slope.magnitude() * range.magnitude()));
    if slope.excludes_zero() {
        // The rounding error of the quotient is far below the slack.
        let cut = range.cut_to(right * Interval::new(1.0 / slope.hi, 1.0 / slope.lo));
        return (cut.lo <= cut.hi).then_some(cut);
    }
    let reached = slope * range;
    (reached.lo <= right.hi && reached.hi >= right.lo).then_some(range)
}

/// The part of a cell in which f and its derivatives along the free sides can vanish together; none
/// if they cannot. `known` and `second` bound f and its second derivatives over the cell, `middle`
/// bounds f at the middle of the cell.
pub(crate) fn narrowed(
    cell: &Cell,
    known: &Enclosure,
    middle: &Enclosure,
    second: &Sym3<Interval>,
) -> Option<Bounds> {
    let Axes { sides, up } = cell.axes();
    let cell = &cell.bounds;
    let is_regular = known.smooth && known.defined && known.continuous;
    let mut needed = second.entries().into_iter().chain(middle.gradient).chain([middle.value]);
    if !(is_regular && needed.all(|bounds| bounds.magnitude().is_finite())) {
        return Some(*cell);
    }
    let h = |i: usize, j: usize| second.at(i, j);
    let (half, m) = (0.5 * cell.size(), cell.middle());
    // It is 0 along a pinned axis, whose side has no length.
    let mut d = half.to_array().map(Interval::symmetric);
    for _ in 0..ROUNDS {
        let mut quadratic = Interval::new(0.0, 0.0);
        let most = d.map(Interval::magnitude);
        for (i, most) in most.into_iter().enumerate() {
            quadratic = quadratic + h(i, i) * Interval::new(0.0, 0.5 * most * most);
        }
        for [i, j] in [[0, 1], [0, 2], [1, 2]] {
            quadratic = quadratic + Interval::symmetric(most[i] * most[j] * h(i, j).magnitude());
        }
        d[up] = solved(d[up], known.gradient[up], middle.value + -quadratic)?;
        let right = |i: usize, d: &[Interval; 3]| middle.gradient[i] + -(h(i, up) * d[up]);
        match sides {
            [Some(i), Some(j)] => {
                let [a, b, c] = [h(i, i), h(i, j), h(j, j)].map(Interval::middle);
                let determinant = a * c - b * b;
                let inverse = [[c, -b], [-b, a]].map(|row| row.map(|entry| entry / determinant));
                let rights = [right(i, &d), right(j, &d)];
                for (k, row) in inverse.into_iter().enumerate() {
                    if !row.iter().all(|entry| entry.is_finite()) {
                        continue;
                    }
                    // The two terms may nearly cancel, so the slack follows their sizes.
                    let combined = |v: [Interval; 2]| {
                        let slack =
                            ROUNDING * (row[0].abs() * v[0].magnitude() + row[1].abs() * v[1].magnitude());
                        v[0] * row[0] + v[1] * row[1] + Interval::symmetric(slack)
                    };
                    let coefficients = [combined([h(i, i), h(j, i)]), combined([h(i, j), h(j, j)])];
                    let (axis, other) = if k == 0 { (i, j) } else { (j, i) };
                    let rest = -(coefficients[1 - k] * d[other]);
                    d[axis] = solved(d[axis], coefficients[k], combined(rights) + rest)?;
                }
                // Also without the inverse, which does not help where the equations are nearly
                // dependent.
                for (axis, other) in [(i, j), (j, i)] {
                    let rest = -(h(axis, other) * d[other]);
                    d[axis] = solved(d[axis], h(axis, axis), right(axis, &d) + rest)?;
                }
            }
            [Some(axis), None] | [None, Some(axis)] => {
                d[axis] = solved(d[axis], h(axis, axis), right(axis, &d))?;
            }
            [None, None] => {}
        }
    }
    let (lo, hi) = (cell.lo(), cell.hi());
    let room = ROUNDING * (lo.abs() + hi.abs());
    let from = m - DVec3::from_array(d.map(|range| range.hi)) - room;
    let to = m - DVec3::from_array(d.map(|range| range.lo)) + room;
    // A range without width would pin a free axis, so the old range is kept there.
    let is_wide = from.max(lo).cmplt(to.min(hi));
    Some(Bounds::new(DVec3::select(is_wide, from.max(lo), lo), DVec3::select(is_wide, to.min(hi), hi)))
}
