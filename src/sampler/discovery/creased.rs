//! Proofs on a surface with creases and corners, where f has several gradients.
//!
//! # The argument
//!
//! f is Lipschitz and at each point one of several smooth pieces. Let v be a direction along which
//! every piece that has a zero in a convex set H rises there. Then f rises through zero along v at
//! each of its zeros in H (F. H. Clarke, "Optimization and Nonsmooth Analysis", 1983: the
//! generalised gradient is in the hull of the pieces' gradients). So a line along v has at most one
//! zero in H, and the surface is a graph over the plane perpendicular to v, with a slope of at most
//! s, the largest quotient of a piece's slope across v and along v. A cube is such a graph around
//! each of its edges and corners, seen along its diagonal. From a point p of the surface the graph
//! goes on along any straight path of length ρ in that plane, no farther than ρ √(1 + s²) from p:
//! if H reaches so far, the path stays in H, and the surface connects its ends.
//!
//! The search is that of the [octree](super::octree), with two changes. *Highest* is meant along
//! [`HIGH`], to which hardly a face or an edge is perpendicular. A cell holds no highest point if
//! the surface is a graph along a direction perpendicular to that one: some of its points then are
//! higher. A cell is decided if the surface in a larger box around it is such a graph over any
//! plane: then all points of the cell are connected with the zero on the line through its middle.
//!
//! Near a side of the region the larger box would reach outside. There v is parallel to that side:
//! the path goes straight on towards it and does not leave the cell.

use crate::field::{Bounded, Enclosure};
use crate::math::{Bounds, Interval, ROUNDING};
use crate::sampler::discovery::cell::Cell;
use crate::sampler::discovery::fate::Fate;
use glam::DVec3;

/// The direction in which points of a creased surface are high: not far from up, and off the
/// symmetry of what people build.
const HIGH: DVec3 = DVec3::new(0.4174, 0.2796, 0.8646);
/// Room for steeper slopes in the larger box: a factor and a term. Less decides fewer cells at
/// once, more makes the larger box reach other parts of the surface.
const STEEPER: [f64; 2] = [1.25, 0.5];
/// Steps to the direction along which all pieces rise. Each comes closer to the best one; three
/// pieces need some ten.
const STEPS: u32 = 24;
/// Distance from a point near the surface within which it has to lie, in slacks: a particle is off
/// by less than one, on a slope of at least a fourth of the gradient.
const NEAR: f64 = 4.0;

/// The pieces of f in a box, with what is said about them together.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    known: Vec<Enclosure>,
    /// Bounds of each of these pieces at the middle of the box.
    middle: Vec<Enclosure>,
}

/// A direction along which all pieces rise, and the largest slope of the surface over the plane
/// perpendicular to it.
#[derive(Clone, Copy, Debug)]
struct Rise {
    along: DVec3,
    slope: f64,
}

impl Rise {
    /// Largest distance that a path on the surface covers above a path of this length in the plane.
    fn reach(&self, length: f64) -> f64 {
        length * libm::hypot(1.0, self.slope) * (1.0 + ROUNDING)
    }
}

/// The axes along which a box has a width.
fn free_axes(bounds: &Bounds) -> [bool; 3] {
    [0, 1, 2].map(|axis| bounds.min[axis] < bounds.max[axis])
}

/// The part of a vector along some axes.
fn part_along(v: DVec3, axes: [bool; 3]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| if axes[axis] { v[axis] } else { 0.0 }))
}

/// A box that reaches farther by `room` along some axes.
fn enlarged_along(bounds: &Bounds, axes: [bool; 3], room: f64) -> Bounds {
    let room = part_along(DVec3::splat(room), axes);
    Bounds::new(bounds.lo() - room, bounds.hi() + room)
}

impl Pieces {
    /// Finds the pieces in a box; returns whether these are all.
    fn find(&mut self, field: &mut dyn Bounded, bounds: &Bounds) -> bool {
        let are_all = field.pieces_in(bounds, &mut self.known);
        self.middle = self.known.split_off(self.known.len() / 2);
        are_all
    }

    fn are_regular(&self) -> bool {
        self.known.iter().all(|piece| piece.defined && piece.continuous)
    }

    /// Bounds of the derivative of a piece along a direction.
    fn derivative(piece: &Enclosure, v: DVec3) -> Interval {
        let mut sum = Interval::new(0.0, 0.0);
        let mut size = 0.0;
        for axis in 0..3 {
            let term = piece.gradient[axis] * v[axis];
            sum = sum + term;
            size += term.magnitude();
        }
        // Infinite bounds give infinite ends or NaN, which compares as false: no sign is proven.
        sum.widened(ROUNDING * size)
    }

    /// A direction along some axes, perpendicular to `across`, along which all of these pieces
    /// rise: the one along which the slowest rises most, the nearest point to the origin in the
    /// hull of their gradients (E. G. Gilbert, SIAM J. Control 4, 1966).
    fn direction(pieces: &[Enclosure], axes: [bool; 3], across: DVec3) -> Option<DVec3> {
        let across = part_along(across, axes).normalize_or_zero();
        let flat = |v: DVec3| {
            let v = part_along(v, axes);
            v - across * across.dot(v)
        };
        let slopes: Vec<DVec3> =
            pieces.iter().map(|piece| flat(piece.middle().1.normalize_or_zero())).collect();
        let mut nearest = slopes.iter().sum::<DVec3>() / slopes.len() as f64;
        for _ in 0..STEPS {
            let least = *slopes.iter().min_by(|a, b| nearest.dot(**a).total_cmp(&nearest.dot(**b)))?;
            let towards = least - nearest;
            let share = -nearest.dot(towards) / towards.length_squared();
            if share.is_nan() || share <= 0.0 {
                break;
            }
            nearest += towards * share.min(1.0);
        }
        let along = flat(nearest).try_normalize()?;
        let rises = |piece: &Enclosure| Self::derivative(piece, along).lo > 0.0;
        pieces.iter().all(rises).then_some(along)
    }

    /// Whether two pieces may both be zero at a point of the box. Their values are weighted so that
    /// the slopes along one axis cancel.
    fn can_meet(&self, pair: [usize; 2], half: DVec3) -> bool {
        let [a, b] = pair.map(|k| &self.known[k].gradient);
        let [at_a, at_b] = pair.map(|k| self.middle[k].value);
        (0..3).filter(|&axis| half[axis] > 0.0).all(|axis| {
            let (of_a, of_b) = (b[axis].middle(), -a[axis].middle());
            let terms = [at_a * of_a, at_b * of_b];
            let swing = |k: usize| (a[k] * of_a + b[k] * of_b).magnitude() * half[k];
            let slack = ROUNDING * (terms[0].magnitude() + terms[1].magnitude());
            !(terms[0] + terms[1]).widened(slack).mean_value((0..3).map(swing).sum()).excludes_zero()
        })
    }

    /// Whether no point of the surface in the box is highest along `high`, because next to each is
    /// a higher one. The pieces that are zero at one point can all meet.
    fn holds_none(&self, bounds: &Bounds, free: [bool; 3], high: DVec3) -> bool {
        if Self::direction(&self.known, free, high).is_some() {
            return true;
        }
        let half = 0.5 * bounds.size();
        let mut left: Vec<usize> = (1..self.known.len()).collect();
        let mut group = vec![0];
        loop {
            let mut next = 0;
            while next < group.len() {
                let (near, far) =
                    left.into_iter().partition::<Vec<usize>, _>(|&k| self.can_meet([group[next], k], half));
                group.extend(near);
                (left, next) = (far, next + 1);
            }
            let pieces: Vec<Enclosure> = group.iter().map(|&k| self.known[k]).collect();
            let is_all = pieces.len() == self.known.len();
            if is_all || Self::direction(&pieces, free, high).is_none() {
                return false;
            }
            let Some(first) = left.pop() else { return true };
            group = vec![first];
        }
    }

    /// The direction along which all pieces rise, with the slope of the surface; `free` are the
    /// axes of the stratum, and the direction is along `axes` of these.
    fn rise(&self, free: [bool; 3], axes: [bool; 3]) -> Option<Rise> {
        let along = Self::direction(&self.known, axes, DVec3::ZERO)?;
        let mut slope = 0.0_f64;
        for piece in &self.known {
            let mut across_sq = 0.0;
            for axis in (0..3).filter(|&axis| free[axis]) {
                let unit = DVec3::AXES[axis];
                across_sq += Self::derivative(piece, unit - along * along[axis]).magnitude().powi(2);
            }
            slope = slope.max(across_sq.sqrt() / Self::derivative(piece, along).lo);
        }
        slope.is_finite().then_some(Rise { along, slope })
    }

    /// The fate of a cell in the search of the whole of f in a region; none if it is discarded.
    pub(super) fn fate(
        &mut self,
        field: &mut dyn Bounded,
        whole: usize,
        cell: &Cell,
        region: &Bounds,
    ) -> Option<Fate> {
        if !self.find(field, &cell.bounds) {
            return Some(Fate::Halved(*cell));
        }
        if self.known.is_empty() {
            return None;
        }
        if !self.are_regular() {
            return Some(Fate::Irregular(*cell));
        }
        let free = free_axes(&cell.bounds);
        let high = part_along(HIGH, free);
        if self.holds_none(&cell.bounds, free, high) {
            return None;
        }
        let alone = if let [piece] = self.known[..] { Some(piece) } else { None };
        match (self.graph(field, &cell.bounds, free, region), alone) {
            (Some((graph, rise)), _) => self.witness(field, whole, cell, &graph, rise),
            (None, Some(piece)) => Some(Fate::Doubtful(*cell, piece)),
            (None, None) => Some(Fate::Halved(*cell)),
        }
    }

    /// The larger box in the region in which the surface is a graph that connects all of its points
    /// in a box, and the direction over whose perpendicular plane it is one.
    fn graph(
        &mut self,
        field: &mut dyn Bounded,
        bounds: &Bounds,
        free: [bool; 3],
        region: &Bounds,
    ) -> Option<(Bounds, Rise)> {
        self.larger(field, bounds, free, region, 0.5 * bounds.diagonal(), 0.0)
    }

    /// A box around another one, in which the surface is a graph that goes on for a `length` from
    /// each of its points in that box, and for the `room` beyond.
    fn larger(
        &mut self,
        field: &mut dyn Bounded,
        bounds: &Bounds,
        free: [bool; 3],
        region: &Bounds,
        length: f64,
        room: f64,
    ) -> Option<(Bounds, Rise)> {
        let fits = |axis: usize, far: f64| {
            bounds.min[axis] - far >= region.min[axis] && bounds.max[axis] + far <= region.max[axis]
        };
        let mut axes = free;
        let far = loop {
            let guess = self.rise(free, axes)?;
            let far = Rise { slope: STEEPER[0] * guess.slope + STEEPER[1], ..guess }.reach(length) + room;
            let fitting = [0, 1, 2].map(|axis| axes[axis] && fits(axis, far));
            if fitting == axes {
                break far;
            }
            axes = fitting;
        };
        let graph = enlarged_along(bounds, axes, far);
        if !(self.find(field, &graph) && self.are_regular()) {
            return None;
        }
        let rise = self.rise(free, axes)?;
        (rise.reach(length) + room <= far).then_some((graph, rise))
    }

    /// Looks for the zero on the line through the middle of a cell in the box around it in which
    /// the surface is a graph.
    fn witness(
        &mut self,
        field: &mut dyn Bounded,
        whole: usize,
        cell: &Cell,
        graph: &Bounds,
        Rise { along, .. }: Rise,
    ) -> Option<Fate> {
        let (middle, half) = (cell.bounds.middle(), 0.5 * graph.size());
        let most = (0..3).filter(|&axis| along[axis] != 0.0).map(|axis| half[axis] / along[axis].abs());
        let end = most.fold(f64::INFINITY, f64::min);
        let ends = [-end, end].map(|t| Bounds::point(middle + along * t));
        let mut known = [Enclosure::UNKNOWN; 2];
        field.enclose(whole, &ends, &mut known);
        let [below, above] = known.map(|end| end.value);
        if !below.excludes_zero() || !above.excludes_zero() {
            return Some(Fate::Halved(*cell));
        }
        // f would rise along the line.
        if below.lo > 0.0 || above.hi < 0.0 {
            return None;
        }
        let (mut lo, mut hi) = (-end, end);
        for _ in 0..f64::MANTISSA_DIGITS {
            let t = 0.5 * (lo + hi);
            if field.value_and_gradient(middle + along * t).0 < 0.0 { lo = t } else { hi = t }
        }
        Some(Fate::Decided(middle + along * hi))
    }

    /// Whether bounds prove that the surface in a region connects the points of it that are within
    /// `slack` of `from` and of `to`.
    pub(super) fn connect(
        &mut self,
        field: &mut dyn Bounded,
        whole: usize,
        [from, to]: [DVec3; 2],
        slack: f64,
        region: &Bounds,
    ) -> bool {
        let near = NEAR * slack;
        let bounds = Bounds::new(from.min(to), from.max(to));
        if !(self.find(field, &bounds.enlarged(near)) && self.are_regular()) {
            return false;
        }
        let length = (to - from).length() + 2.0 * near;
        let Some((_, rise)) = self.larger(field, &bounds, [true; 3], region, length, near) else {
            return false;
        };
        let ends = [from, to].map(|p| [-near, near].map(|t| Bounds::point(p + rise.along * t)));
        let mut known = [Enclosure::UNKNOWN; 4];
        field.enclose(whole, ends.as_flattened(), &mut known);
        let passes = |k: usize| known[k].value.hi < 0.0 && known[k + 1].value.lo > 0.0;
        passes(0) && passes(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    #[test]
    fn a_direction_along_which_all_pieces_rise_is_found_where_there_is_one() {
        let mut random = Pcg32::seed_from_u64(1);
        let mut number = || f64::from(random.next_u32()) / 2_147_483_648.0 - 1.0;
        let mut vector = || DVec3::new(number(), number(), number()).normalize_or(DVec3::X);
        let tried: Vec<DVec3> = (0..2_000).map(|_| vector()).collect();
        let mut found = [0, 0];
        for case in 0..400 {
            let slopes: Vec<DVec3> = (0..1 + case % 4).map(|_| vector()).collect();
            let exactly = |slope: &DVec3| Enclosure {
                gradient: slope.to_array().map(|entry| Interval::new(entry, entry)),
                ..Enclosure::UNKNOWN
            };
            let pieces: Vec<Enclosure> = slopes
                .iter()
                .map(|slope| Enclosure { value: Interval::symmetric(1.0), ..exactly(slope) })
                .collect();
            for across in [DVec3::ZERO, HIGH] {
                let least = |v: DVec3| {
                    let v = v - across * across.dot(v) / across.length_squared().max(1.0e-9);
                    slopes.iter().map(|slope| slope.dot(v)).fold(f64::INFINITY, f64::min)
                };
                let best = tried.iter().map(|&v| least(v)).fold(f64::NEG_INFINITY, f64::max);
                let told = Pieces::direction(&pieces, [true; 3], across);
                match told {
                    Some(v) => assert!(least(v) > 0.0 && v.dot(across).abs() < 1.0e-9, "{slopes:?}: {v}"),
                    None => assert!(best < 0.2, "{slopes:?}: {best}"),
                }
                found[usize::from(told.is_some())] += 1;
            }
        }
        assert!(found.into_iter().all(|count| count > 50), "{found:?}");
    }
}
