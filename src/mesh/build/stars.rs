//! The natural neighbours of every point, counter-clockwise round its normal, in single precision.
//!
//! The points of the same sheet are unrolled to the tangent plane of a point, keeping their true
//! distance. The point's neighbours in the Delaunay triangulation there are found one after the
//! other, from the nearest one on: the next neighbour is the point to the left whose circle through
//! the centre and the last neighbour is the smallest on that side.

use super::ball::{Ball, BallPoints, MOST};
use crate::math::sort_few;
use crate::slices::{HEAVY, pause};
use crate::spatial::tree::{Leaf, Tree};
use core::ops::Range;
use glam::Vec3;

/// Largest circumradius of a triangle, in units of the spacing at the corner. Smaller: more
/// particles are in no triangle; larger: more gaps of the surface are closed.
pub(super) const WIDEST: f32 = 2.0;
/// Points nearer than this share of the ball's radius are one point.
const TWIN: f32 = 1e-5;
/// Marks, in [`Stars::entry`], that the triangle with this neighbour and the next one is narrow
/// enough to be one of the mesh.
const WEDGE: u32 = 1 << 31;

/// Natural neighbours in tree order, all stars one after the other.
#[derive(Debug)]
pub(super) struct Stars {
    start: Vec<u32>,
    entry: Vec<u32>,
    /// Whether the star has a gap: two neighbours in a row without a triangle between them.
    pub(super) is_open: Vec<bool>,
    /// Points at the place of an earlier one.
    pub(super) twins: Vec<u32>,
}

/// Buffers that are reused from leaf to leaf.
#[derive(Default)]
struct StarBuffers {
    surroundings: BallPoints,
    ball: Ball,
    star: Star,
}

/// A neighbour, and the square of the diameter of the circle through it, the centre and the next
/// one.
#[derive(Clone, Copy)]
struct Ray {
    point: usize,
    width_sq: f32,
}

/// A star under construction; empty where its rays do not close up.
#[derive(Default)]
struct Star {
    rays: Vec<Ray>,
}

/// The points of a mesh.
struct StarPoints<'a> {
    tree: &'a Tree,
    /// Unit normals, in tree order.
    normal: &'a [Vec3],
    /// The points at the apex of a cone, in ascending order.
    tips: &'a [u32],
}

impl Stars {
    /// The stars of the points of `tree` with the unit `normal`s (in tree order), of which `tips`
    /// are at the apex of a cone, in ascending order.
    pub(super) async fn new(tree: &Tree, normal: &[Vec3], tips: &[u32]) -> Self {
        let n = tree.len();
        let mut stars = Self {
            start: Vec::with_capacity(n + 1),
            entry: Vec::with_capacity(6 * n + n / 4),
            is_open: Vec::with_capacity(n),
            twins: Vec::new(),
        };
        stars.start.push(0);
        let cloud = StarPoints { tree, normal, tips };
        let mut scratch = Box::<StarBuffers>::default();
        let mut pause_at = HEAVY;
        for leaf in tree.leaves() {
            let reach = leaf.reach();
            let Leaf { range, lo, hi } = leaf;
            if range.start >= pause_at {
                pause_at = range.start + HEAVY;
                pause().await;
            }
            if lo == hi && range.len() > 1 {
                stars.add_twins(range);
                continue;
            }
            scratch.surroundings.gather(tree, normal, lo - reach, hi + reach);
            range.for_each(|i| stars.add(&cloud, i, reach, &mut scratch));
        }
        stars
    }

    /// Adds the points of a leaf that are all at one place.
    fn add_twins(&mut self, range: Range<usize>) {
        self.twins.extend(range.start as u32 + 1..range.end as u32);
        for _ in range {
            self.is_open.push(true);
            self.start.push(self.entry.len() as u32);
        }
    }

    /// Adds the star of point `i`, of a leaf whose surroundings reach as far as told.
    fn add(
        &mut self,
        &StarPoints { tree, normal, tips }: &StarPoints<'_>,
        i: usize,
        reach: f32,
        scratch: &mut StarBuffers,
    ) {
        let is_tip = tips.binary_search(&(i as u32)).is_ok();
        let StarBuffers { surroundings, ball, star } = scratch;
        let reach_sq = reach * reach;
        let has_all = ball.take(surroundings, tree.position[i], reach_sq, i as u32);
        let mut known_sq = if has_all { reach_sq } else { 0.0 };
        // Of a few points all are known, however far away.
        let twin_sq = |known_sq: f32| TWIN * TWIN * if known_sq == f32::MAX { reach_sq } else { known_sq };
        ball.level(tips, normal[i], is_tip);
        star.make(ball, normal[i], twin_sq(known_sq));
        let mut widest_sq = star.widest_sq(ball);
        if star.rays.is_empty() || known_sq < widest_sq && !star.is_certain(known_sq) {
            known_sq = ball.search(tree, normal, i as u32, widest_sq.sqrt());
            ball.level(tips, normal[i], is_tip);
            star.make(ball, normal[i], twin_sq(known_sq));
            widest_sq = star.widest_sq(ball).min(known_sq);
        }
        if !is_tip && ball.has_earlier_twin(i as u32, twin_sq(known_sq)) {
            self.twins.push(i as u32);
        }
        let mut is_open = star.rays.is_empty();
        for ray in &star.rays {
            let is_narrow = ray.width_sq <= widest_sq;
            is_open |= !is_narrow;
            self.entry.push(ball.index(ray.point) | if is_narrow { WEDGE } else { 0 });
        }
        self.is_open.push(is_open);
        self.start.push(self.entry.len() as u32);
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.is_open.len()
    }

    /// Indices of the entries of point `i`.
    pub(super) fn range(&self, i: usize) -> Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// Number of entries.
    pub(super) fn entry_count(&self) -> usize {
        self.entry.len()
    }

    /// The neighbour of an entry.
    pub(super) fn neighbour(&self, entry: usize) -> u32 {
        self.entry[entry] & !WEDGE
    }

    /// The entry of `i` that holds `a`, if `b` is the next one and makes a triangle with it.
    pub(super) fn entry(&self, i: u32, a: u32, b: u32) -> Option<usize> {
        let range = self.range(i as usize);
        let place = self.entry[range.clone()].iter().position(|&entry| entry == a | WEDGE)?;
        let entry = range.start + place;
        (self.next(&range, entry) == Some(b)).then_some(entry)
    }

    /// The next neighbour of `i`, if it makes a triangle with that of `entry`.
    pub(super) fn next(&self, range: &Range<usize>, entry: usize) -> Option<u32> {
        let next = if entry + 1 == range.end { range.start } else { entry + 1 };
        (self.entry[entry] & WEDGE != 0).then(|| self.neighbour(next))
    }
}

impl Star {
    /// Finds the neighbours of the centre among the points of the ball, which are given the tangent
    /// plane.
    fn make(&mut self, ball: &mut Ball, normal: Vec3, twin_sq: f32) {
        ball.unroll(normal, twin_sq);
        self.rays.clear();
        let Some(first) = ball.nearest() else { return };
        let mut point = first;
        loop {
            let (mut next, width_sq) = ball.next(point, 1.0);
            if point != first && next.is_some_and(|next| ball.is_between(point, first, next)) {
                next = Some(first); // Rounding has led past the first one.
            }
            if self.rays.len() == MOST {
                self.rays.clear();
                return;
            }
            self.rays.push(Ray { point, width_sq });
            match next {
                Some(next) if next == first => return,
                Some(next) => point = next,
                None => break,
            }
        }
        // Nothing follows the last one: go on at the other side of the first.
        let left = self.rays.len();
        point = first;
        while let (Some(next), width_sq) = ball.next(point, -1.0) {
            if self.rays.len() == MOST {
                self.rays.clear();
                return;
            }
            self.rays.push(Ray { point: next, width_sq });
            point = next;
        }
        self.rays[left..].reverse();
        self.rays.rotate_left(left);
    }

    /// Whether no point farther than √`known_sq` can matter.
    fn is_certain(&self, known_sq: f32) -> bool {
        self.rays.iter().all(|ray| ray.width_sq <= known_sq)
    }

    /// The square of the largest width of a wedge, in units of the median distance of the
    /// neighbours.
    fn widest_sq(&self, ball: &Ball) -> f32 {
        let mut lengths_sq = [0.0; MOST];
        for (length_sq, ray) in lengths_sq.iter_mut().zip(&self.rays) {
            *length_sq = ball.distance_sq(ray.point);
        }
        let lengths_sq = &mut lengths_sq[..self.rays.len()];
        sort_few(lengths_sq, |a, b| a < b);
        let median_sq = lengths_sq.get(self.rays.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
        4.0 * WIDEST * WIDEST * median_sq
    }
}
