//! Narrows the part of a cell in which the highest point of a component of the surface can lie.
//!
//! At such a point p the function f and its derivatives along the sides vanish: as many equations as there are free axes. By
//! Taylor's theorem from p to the middle m of the cell, with d = m − p,
//!
//! f(m) = ∂f/∂up(p) · d_up + ½ dᵀ H d  and  ∂f/∂side(m) = (H d)_side,
//!
//! where H holds second derivatives at points between. The sides occur in the first equation only through H. Bounds of H over the
//! cell make both equations linear with intervals for coefficients. They are solved for d axis by axis (Gauss–Seidel). Those of the
//! sides are first multiplied by the inverse of their midpoint matrix, as Krawczyk's and Hansen's forms of the interval Newton
//! method do (R. B. Kearfott, "Rigorous Global Search: Continuous Problems", 1996). Where no solution is left, the cell holds no
//! such point; near one, the range shrinks with the square of the cell's width.

use crate::field::{Enclosure, SECOND};
use glam::DVec3;

type Range = [f64; 2];

/// Rounds of narrowing.
const ROUNDS: u32 = 2;
/// Bound of the rounding error of one step, relative to its operands.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

fn add(a: Range, b: Range) -> Range {
    [a[0] + b[0], a[1] + b[1]]
}

fn negated([lo, hi]: Range) -> Range {
    [-hi, -lo]
}

fn scaled([lo, hi]: Range, factor: f64) -> Range {
    let (a, b) = (lo * factor, hi * factor);
    [a.min(b), a.max(b)]
}

fn product(a: Range, b: Range) -> Range {
    let (p, q) = (scaled(a, b[0]), scaled(a, b[1]));
    [p[0].min(q[0]), p[1].max(q[1])]
}

fn size([lo, hi]: Range) -> f64 {
    hi.abs().max(lo.abs())
}

/// The part of `range` in which `slope` · d = `right` has a solution d; none if there is none.
fn solved(range: Range, slope: Range, right: Range) -> Option<Range> {
    let slack = ROUNDING * (size(right) + size(slope) * size(range));
    let right = [right[0] - slack, right[1] + slack];
    let cut = if slope[0] > 0.0 || slope[1] < 0.0 {
        // The rounding error of the quotient is far below the slack.
        let quotient = product(right, [1.0 / slope[1], 1.0 / slope[0]]);
        [range[0].max(quotient[0]), range[1].min(quotient[1])]
    } else {
        let reached = product(slope, range);
        if reached[0] > right[1] || reached[1] < right[0] {
            return None;
        }
        range
    };
    // NaN compares as false, so an unknown range is kept.
    if cut[0] > cut[1] { None } else { Some(cut) }
}

/// The part of the box from `lo` to `hi` in which f and its derivatives along the free `sides` can vanish together; none if they
/// cannot. `known` and `second` are bounds of f and of its second derivatives over the box; `middle` are those of f at its middle.
pub(crate) fn narrowed(
    [lo, hi]: [DVec3; 2],
    (sides, up): ([Option<usize>; 2], usize),
    known: &Enclosure,
    middle: &Enclosure,
    second: &[Range; 6],
) -> Option<[DVec3; 2]> {
    let is_bounded = known.smooth && known.defined && known.continuous;
    if !(is_bounded && second.iter().all(|&[lo, hi]| lo.is_finite() && hi.is_finite())) {
        return Some([lo, hi]);
    }
    let h = |i: usize, j: usize| second[SECOND[i][j]];
    let half = 0.5 * (hi - lo);
    let m = 0.5 * (lo + hi);
    // It is 0 along a pinned axis, whose side has no length.
    let mut d: [Range; 3] = core::array::from_fn(|axis| [-half[axis], half[axis]]);
    for _ in 0..ROUNDS {
        let mut quadratic = [0.0; 2];
        let most = d.map(size);
        for (i, most) in most.into_iter().enumerate() {
            quadratic = add(quadratic, product(h(i, i), [0.0, 0.5 * most * most]));
        }
        for [i, j] in [[0, 1], [0, 2], [1, 2]] {
            let mixed = most[i] * most[j] * size(h(i, j));
            quadratic = add(quadratic, [-mixed, mixed]);
        }
        d[up] = solved(d[up], known.gradient[up], add(middle.value, negated(quadratic)))?;
        let right = |i: usize, d: &[Range; 3]| add(middle.gradient[i], negated(product(h(i, up), d[up])));
        match sides {
            [Some(i), Some(j)] => {
                let entries = [h(i, i), h(i, j), h(j, j)];
                let [a, b, c] = entries.map(|[lo, hi]| 0.5 * (lo + hi));
                let determinant = a * c - b * b;
                let inverse = [[c, -b], [-b, a]].map(|row| row.map(|entry| entry / determinant));
                let rights = [right(i, &d), right(j, &d)];
                for (k, row) in inverse.into_iter().enumerate() {
                    if !row.iter().all(|entry| entry.is_finite()) {
                        continue;
                    }
                    // The two terms may nearly cancel, so the slack follows their sizes.
                    let combined = |v: [Range; 2]| {
                        let slack = ROUNDING * (row[0].abs() * size(v[0]) + row[1].abs() * size(v[1]));
                        add(add(scaled(v[0], row[0]), scaled(v[1], row[1])), [-slack, slack])
                    };
                    let coefficients = [combined([h(i, i), h(j, i)]), combined([h(i, j), h(j, j)])];
                    let (axis, other) = if k == 0 { (i, j) } else { (j, i) };
                    let rest = negated(product(coefficients[1 - k], d[other]));
                    d[axis] = solved(d[axis], coefficients[k], add(combined(rights), rest))?;
                }
                // Also without the inverse, which is of no use where the equations are nearly dependent.
                for (axis, other) in [(i, j), (j, i)] {
                    let rest = negated(product(h(axis, other), d[other]));
                    d[axis] = solved(d[axis], h(axis, axis), add(right(axis, &d), rest))?;
                }
            }
            [Some(axis), None] | [None, Some(axis)] => {
                d[axis] = solved(d[axis], h(axis, axis), right(axis, &d))?;
            }
            [None, None] => {}
        }
    }
    let room = ROUNDING * (lo.abs() + hi.abs());
    let from = m - DVec3::from_array(d.map(|range| range[1])) - room;
    let to = m - DVec3::from_array(d.map(|range| range[0])) + room;
    // A range without width would pin a free axis, so the old one is kept there.
    let is_wide = from.max(lo).cmplt(to.min(hi));
    Some([DVec3::select(is_wide, from.max(lo), lo), DVec3::select(is_wide, to.min(hi), hi)])
}
