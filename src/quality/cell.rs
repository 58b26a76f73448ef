//! The Voronoi cell of one point in a plane.

use glam::DVec2;

/// Largest number of points by which a cell is clipped. Fewer leave more cells open.
pub(super) const MOST_POINTS: usize = 200;
/// Largest number of corners of a cell: each of the points can add one, and the starting square has
/// four.
const CORNERS: usize = MOST_POINTS + 8;
/// Label of an edge of the starting square.
const SQUARE: u32 = u32::MAX;
/// A bisector that cuts off less than this share of |q| counts as not touching the cell. The share
/// is far above the rounding of the corners in double precision (they are cut from a square many
/// times larger) and far below that of positions in single precision. So four exactly cocircular
/// points share one corner and no edge.
const TOUCH: f64 = 1e-10;

/// The Voronoi cell of the origin, which is clipped by one bisector after another.
#[derive(Debug)]
pub(super) struct VoronoiCell {
    /// The cell, and memory for what the next bisector leaves of it: the cell is the second one
    /// where `is_second`.
    polygon: [Polygon; 2],
    is_second: bool,
    /// Signed distance of each corner from the bisector of the clip under way, times |q|.
    side: [f64; CORNERS],
    reach_sq: f64,
}

/// A convex polygon around the origin, its corners in counter-clockwise order.
#[derive(Debug)]
struct Polygon {
    corner: [DVec2; CORNERS],
    /// `label[k]` names the point whose bisector carries the edge from corner `k` to corner
    /// `k + 1`.
    label: [u32; CORNERS],
    /// Squared distance of each corner.
    distance_sq: [f64; CORNERS],
    count: usize,
}

impl Polygon {
    fn new() -> Self {
        Self {
            corner: [DVec2::ZERO; CORNERS],
            label: [SQUARE; CORNERS],
            distance_sq: [0.0; CORNERS],
            count: 0,
        }
    }

    #[inline]
    fn push(&mut self, corner: DVec2, label: u32, distance_sq: f64) {
        self.corner[self.count] = corner;
        self.label[self.count] = label;
        self.distance_sq[self.count] = distance_sq;
        self.count += 1;
    }
}

impl VoronoiCell {
    /// Returns an empty cell; call [`VoronoiCell::start`] first.
    pub(super) fn new() -> Self {
        let polygon = [Polygon::new(), Polygon::new()];
        Self { polygon, is_second: false, side: [0.0; CORNERS], reach_sq: 0.0 }
    }

    /// Starts again from the square of half-width `half`.
    pub(super) fn start(&mut self, half: f64) {
        let now = &mut self.polygon[usize::from(self.is_second)];
        now.count = 0;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let corner = DVec2::new(x * half, y * half);
            now.push(corner, SQUARE, corner.length_squared());
        }
        self.reach_sq = 2.0 * half * half;
    }

    /// Returns the squared distance of the farthest corner. A point farther away than twice that
    /// distance cannot change the cell.
    #[inline]
    pub(super) fn reach_sq(&self) -> f64 {
        self.reach_sq
    }

    /// Cuts off the part that is nearer to `q` than to the origin, and labels the new edge `label`.
    /// Where there is such a part, `is_neighbour` is asked before.
    #[inline]
    pub(super) fn clip(&mut self, q: DVec2, label: u32, is_neighbour: impl FnOnce() -> bool) {
        let Self { polygon: [one, other], is_second, side, reach_sq } = self;
        let (now, next) = if *is_second { (other, one) } else { (one, other) };
        let n = now.count;
        let offset = 0.5 * q.length_squared();
        let (mut worst, mut farthest) = (0, f64::NEG_INFINITY);
        for (k, (side, corner)) in side.iter_mut().zip(&now.corner[..n]).enumerate() {
            *side = corner.dot(q) - offset;
            if *side > farthest {
                (worst, farthest) = (k, *side);
            }
        }
        // A full cell stays as it is: its corners are either right or not certain.
        if farthest <= TOUCH * q.length_squared() || n + 1 >= CORNERS || !is_neighbour() {
            return;
        }
        // The corners that are cut off are consecutive, from `first` to `last`, because the cell is
        // convex.
        let before = |k: usize| if k == 0 { n - 1 } else { k - 1 };
        let after = |k: usize| if k + 1 == n { 0 } else { k + 1 };
        let mut first = worst;
        while side[before(first)] > 0.0 && before(first) != worst {
            first = before(first);
        }
        let mut last = worst;
        while side[after(last)] > 0.0 && after(last) != first {
            last = after(last);
        }
        let (outer, inner) = (before(first), after(last));
        if side[outer] > 0.0 || side[inner] > 0.0 {
            return; // Everything is cut off: numerically, q is the origin.
        }
        let cross = |inside: usize, outside: usize| {
            let (a, b) = (side[inside], side[outside]);
            now.corner[inside] + (now.corner[outside] - now.corner[inside]) * (a / (a - b))
        };
        next.count = 0;
        let mut k = inner;
        loop {
            next.push(now.corner[k], now.label[k], now.distance_sq[k]);
            if k == outer {
                break;
            }
            k = after(k);
        }
        for (corner, label) in [(cross(outer, first), label), (cross(inner, last), now.label[last])] {
            next.push(corner, label, corner.length_squared());
        }
        *reach_sq =
            next.distance_sq[..next.count].iter().fold(0.0, |reach, &d| if d > reach { d } else { reach });
        *is_second = !*is_second;
    }

    /// Returns every edge in counter-clockwise order: its label, and whether the corner at its end
    /// is certain. A corner is certain if it belongs to the cell among all points, provided that
    /// the cell was clipped by every point nearer than √`known_sq`. Edges of the starting square
    /// are left out, and corners on them are not certain.
    pub(super) fn edges(&self, known_sq: f64) -> impl Iterator<Item = (u32, bool)> {
        let Polygon { label, distance_sq, count, .. } = &self.polygon[usize::from(self.is_second)];
        (0..*count).filter(|&k| label[k] != SQUARE).map(move |k| {
            let next = if k + 1 == *count { 0 } else { k + 1 };
            let certain = label[next] != SQUARE && 4.0 * distance_sq[next] <= known_sq;
            (label[k], certain)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(points: &[(f64, f64)]) -> Vec<u32> {
        let mut cell = VoronoiCell::new();
        cell.start(100.0);
        for (i, &(x, y)) in points.iter().enumerate() {
            cell.clip(DVec2::new(x, y), i as u32, || true);
        }
        let mut found: Vec<u32> = cell.edges(f64::INFINITY).map(|edge| edge.0).collect();
        // The cycle is made to start at its smallest label.
        let smallest = (0..found.len()).min_by_key(|&k| found[k]).unwrap_or(0);
        found.rotate_left(smallest);
        found
    }

    #[test]
    fn square_neighbours_are_four_and_diagonals_share_corners_only() {
        let points = [
            (1.0, 0.0),
            (0.0, 1.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (1.0, -1.0),
            (-1.0, -1.0),
        ];
        assert_eq!(labels(&points), [0, 1, 2, 3]);
    }

    #[test]
    fn neighbours_are_those_of_the_hull_of_the_inverted_points() {
        // The points are random with a fixed seed. The hull of q/|q|² is found by brute force: a
        // and b are consecutive vertices of it if every other inverted point lies to the left of
        // the line through them.
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1_u64 << 24) as f64 * 2.0 - 1.0
        };
        for _ in 0..50 {
            let points: Vec<(f64, f64)> = (0..40).map(|_| (next(), next())).collect();
            let inverted: Vec<DVec2> = points
                .iter()
                .map(|&(x, y)| {
                    let q = DVec2::new(x, y);
                    q / q.length_squared()
                })
                .collect();
            let mut hull = Vec::new();
            for a in 0..40 {
                for b in 0..40 {
                    let line = inverted[b] - inverted[a];
                    if a != b
                        && (0..40).all(|c| c == a || c == b || line.perp_dot(inverted[c] - inverted[a]) > 0.0)
                    {
                        hull.push((a as u32, b as u32));
                    }
                }
            }
            let cell = labels(&points);
            assert_eq!(cell.len(), hull.len());
            for k in 0..cell.len() {
                assert!(hull.contains(&(cell[k], cell[(k + 1) % cell.len()])));
            }
        }
    }
}
