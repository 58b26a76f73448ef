//! Stars: the natural neighbours of every point, counter-clockwise round its normal, in single
//! precision. The mesh of the particles is made from them, and so are the figures of their order.
//!
//! The points of the same sheet are unrolled to the tangent plane of a point, keeping their true
//! distance. The point's neighbours in the Delaunay triangulation there are found one by one,
//! starting with the nearest one: the next neighbour is the point on the left whose circle through
//! the centre and the last neighbour is the smallest on that side.

mod ball;
mod sheet;

pub(crate) use ball::MAX_LIFT;
pub(crate) use sheet::{Sheet, Sheets};

use crate::math::{NONE, sort_few};
use crate::particles::OrientedPoint;
use crate::slices::{self, HEAVY, MEDIUM, MaybeSend, MaybeSync, pause, ranges};
use crate::spatial::tree::{Leaf, Tree};
use ball::{Ball, BallPoints, MOST, NEAR};
use core::ops::Range;
use glam::Vec3;

/// Largest circumradius of a triangle, in units of the spacing at the corner. Smaller: more
/// particles are in no triangle; larger: more gaps of the surface are closed.
const WIDEST: f32 = 2.0;
/// Points nearer than this share of the ball's radius are the same point.
const TWIN: f32 = 1e-5;
/// Marks, in [`Stars::entry`], that the point, this neighbour and the next one form a triangle.
const WEDGE: u32 = 1 << 31;
/// Marks, in [`Stars::entry`], that the Voronoi cells of the two points meet only in a corner, as
/// across a diagonal of a square.
const CORNER: u32 = 1 << 30;
/// The bits of an entry that hold its point.
const POINT: u32 = CORNER - 1;
/// An edge of a Voronoi cell is a corner if it is shorter than half this share of the distance of
/// the two points, which is above rounding in single precision.
const SHORT: f32 = 1e-5;
/// Leaves of the tree in a slice of work: they have eight to sixteen points each.
const LEAVES: usize = HEAVY / 8;

/// Distinguishes sheets that face the same way and lie nearer to each other than their points do.
/// Between two such sheets there is a third one that faces the other way.
pub(crate) trait TellsApart: MaybeSend + MaybeSync {
    /// The judge of one patch, or of a surface without creases. Each thread makes its own.
    fn on(&self, patch: Option<u32>) -> Box<dyn TellsApart + '_>;

    /// The distance from a point to the nearest sheet that faces the other way, on which `others`
    /// lie; infinite if none is near.
    fn facing_away(&mut self, point: OrientedPoint, others: &[OrientedPoint]) -> f64;

    /// Whether two points that face the same way are on two sheets, if one that faces the other way
    /// is `facing_away` from the first.
    fn are_two(&mut self, one: OrientedPoint, other: OrientedPoint, facing_away: f64) -> bool;
}

/// Distinguishes sheets only by the directions and heights of their points.
pub(crate) struct ByDirection;

impl TellsApart for ByDirection {
    fn on(&self, _: Option<u32>) -> Box<dyn TellsApart + '_> {
        Box::new(Self)
    }

    fn facing_away(&mut self, _: OrientedPoint, _: &[OrientedPoint]) -> f64 {
        f64::INFINITY
    }

    fn are_two(&mut self, _: OrientedPoint, _: OrientedPoint, _: f64) -> bool {
        false
    }
}

/// Natural neighbours in tree order, all stars one after the other.
///
/// [`Stars::new`] finds those that matter to a mesh: its triangles are narrow, and a star may lack
/// neighbours across a hole. [`Stars::completed`] finds those, too.
#[derive(Debug, Default)]
pub(crate) struct Stars {
    start: Vec<u32>,
    entry: Vec<u32>,
    /// Whether the star has a gap: two neighbours in a row without a triangle between them.
    pub(crate) is_open: Vec<bool>,
    /// Whether the point is known to have no other natural neighbours, all round it.
    is_certain: Vec<bool>,
    /// Distance of the nearest other point, on any sheet; infinite if there is none.
    pub(crate) nearest: Vec<f32>,
    /// Points at the place of an earlier one.
    twins: Vec<u32>,
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

/// A star under construction; empty only if the centre has no other point on its sheet.
#[derive(Default)]
struct Star {
    rays: Vec<Ray>,
}

/// Points with normals.
pub(crate) struct StarPoints<'a> {
    pub(crate) tree: &'a Tree,
    /// Unit normals, in tree order.
    pub(crate) normal: &'a [Vec3],
    /// The points at the apex of a cone, in ascending order.
    pub(crate) tips: &'a [u32],
    /// The patch, if the surface has several.
    pub(crate) patch: Option<u32>,
}

impl StarPoints<'_> {
    fn oriented(&self, i: u32) -> OrientedPoint {
        OrientedPoint { position: self.tree.position[i as usize], normal: self.normal[i as usize] }
    }

    fn is_tip(&self, i: u32) -> bool {
        self.tips.binary_search(&i).is_ok()
    }
}

impl Stars {
    /// Memory for the stars of so many points.
    fn with_capacity(n: usize) -> Self {
        let mut start = Vec::with_capacity(n + 1);
        start.push(0);
        Self {
            start,
            entry: Vec::with_capacity(6 * n + n / 4),
            is_open: Vec::with_capacity(n),
            is_certain: Vec::with_capacity(n),
            nearest: Vec::with_capacity(n),
            twins: Vec::new(),
        }
    }

    /// The stars of the points, as far as a mesh needs them.
    pub(crate) async fn new(points: &StarPoints<'_>, judge: &dyn TellsApart) -> Self {
        let n = points.tree.len();
        assert!(n < 1 << 30, "points are numbered with 30 bits");
        let leaves: Vec<Leaf> = points.tree.leaves().collect();
        let new_scratch = || (judge.on(points.patch), Box::<StarBuffers>::default());
        let parts = slices::map(leaves.len(), LEAVES, new_scratch, |(judge, buffers), own| {
            let leaves = &leaves[own];
            let mut part = Self::with_capacity(leaves.iter().map(|leaf| leaf.range.len()).sum());
            for leaf in leaves {
                let Leaf { range, lo, hi } = leaf;
                if lo == hi && range.len() > 1 {
                    part.add_twins(range.clone());
                    continue;
                }
                let reach = leaf.reach();
                buffers.surroundings.gather(points.tree, points.normal, *lo - reach, *hi + reach);
                range.clone().for_each(|i| part.add(points, i, reach, &mut **judge, buffers));
            }
            part
        });
        Self::joined(n, parts.await)
    }

    /// The stars of consecutive points, part by part.
    fn joined(n: usize, parts: Vec<Self>) -> Self {
        let mut stars = Self::with_capacity(n);
        for mut part in parts {
            let before = stars.entry.len() as u32;
            stars.start.extend(part.start[1..].iter().map(|start| before + start));
            stars.entry.append(&mut part.entry);
            stars.is_open.append(&mut part.is_open);
            stars.is_certain.append(&mut part.is_certain);
            stars.nearest.append(&mut part.nearest);
            stars.twins.append(&mut part.twins);
        }
        stars
    }

    /// Adds the points of a leaf that are all at one place.
    fn add_twins(&mut self, range: Range<usize>) {
        self.twins.extend(range.start as u32 + 1..range.end as u32);
        for _ in range {
            self.end_star(0.0, true, false);
        }
    }

    /// Ends the star whose entries have been added.
    fn end_star(&mut self, nearest: f32, is_open: bool, is_certain: bool) {
        self.nearest.push(nearest);
        self.is_open.push(is_open);
        self.is_certain.push(is_certain);
        self.start.push(self.entry.len() as u32);
    }

    /// Adds the star of point `i`, of a leaf whose surroundings extend by `reach`.
    fn add(
        &mut self,
        points: &StarPoints<'_>,
        i: usize,
        reach: f32,
        judge: &mut dyn TellsApart,
        StarBuffers { surroundings, ball, star }: &mut StarBuffers,
    ) {
        let &StarPoints { tree, normal, tips, .. } = points;
        let is_tip = points.is_tip(i as u32);
        let reach_sq = reach * reach;
        let has_all = ball.take(surroundings, tree.position[i], reach_sq, i as u32);
        let mut known_sq = if has_all { reach_sq } else { 0.0 };
        // If the points are few, all are known, however far away.
        let twin_sq = |known_sq: f32| TWIN * TWIN * if known_sq == f32::MAX { reach_sq } else { known_sq };
        ball.level(tips, normal[i], is_tip);
        star.make(ball, points, i as u32, twin_sq(known_sq), judge);
        let mut widest_sq = star.widest_sq(ball);
        if star.rays.is_empty() || known_sq < widest_sq && !star.is_certain(known_sq) {
            known_sq = ball.search(points, i as u32, widest_sq.sqrt(), NEAR);
            ball.level(tips, normal[i], is_tip);
            star.make(ball, points, i as u32, twin_sq(known_sq), judge);
            widest_sq = star.widest_sq(ball).min(known_sq);
        }
        if !is_tip && ball.has_earlier_twin(i as u32, twin_sq(known_sq)) {
            self.twins.push(i as u32);
        }
        let is_certain = star.is_certain(known_sq);
        self.push(ball, star, widest_sq, is_certain);
    }

    /// Appends a star, whose triangles are the wedges up to this width.
    fn push(&mut self, ball: &Ball, star: &Star, widest_sq: f32, is_certain: bool) {
        let mut is_open = star.rays.is_empty();
        for (k, ray) in star.rays.iter().enumerate() {
            let is_narrow = ray.width_sq <= widest_sq;
            is_open |= !is_narrow;
            let mark = |holds: bool, mark: u32| if holds { mark } else { 0 };
            let marks = mark(is_narrow, WEDGE) | mark(star.is_corner(ball, k), CORNER);
            self.entry.push(ball.index(ray.point) | marks);
        }
        self.end_star(ball.nearest_of_all(), is_open, is_certain);
    }

    /// The stars with all natural neighbours of the points, whose triangles may be wide. Only stars
    /// of points with nothing on one side, for half a turn, stay open, and those of points known to
    /// be at a border are not changed.
    pub(crate) async fn completed(
        &self,
        points: &StarPoints<'_>,
        is_at_border: impl Fn(usize) -> bool,
        judge: &dyn TellsApart,
    ) -> Self {
        /// Points in a slice of work: each may examine hundreds of others.
        const FEW: usize = HEAVY / 8;
        let n = self.len();
        let is_unknown = |i: &usize| !self.is_certain[*i] && !is_at_border(*i);
        let unknown: Vec<usize> = (0..n).filter(is_unknown).collect();
        pause().await;
        let new_scratch = || (judge.on(points.patch), Box::<StarBuffers>::default());
        let parts = slices::map(unknown.len(), FEW, new_scratch, |(judge, buffers), own| {
            let mut part = Self::with_capacity(own.len());
            unknown[own].iter().for_each(|&i| part.add_complete(points, i as u32, &mut **judge, buffers));
            part
        });
        let found = Self::joined(unknown.len(), parts.await);
        let mut unknown = unknown.into_iter().zip(0..).peekable();
        let mut stars = Self::with_capacity(n);
        for range in ranges(n, MEDIUM) {
            for i in range {
                if let Some((_, k)) = unknown.next_if(|&(other, _)| other == i) {
                    stars.entry.extend(&found.entry[found.range(k)]);
                    stars.end_star(found.nearest[k], found.is_open[k], found.is_certain[k]);
                } else {
                    let mark = if self.is_certain[i] { WEDGE } else { 0 };
                    stars.entry.extend(self.entry[self.range(i)].iter().map(|entry| entry | mark));
                    stars.end_star(self.nearest[i], !self.is_certain[i], self.is_certain[i]);
                }
            }
            pause().await;
        }
        stars
    }

    /// Adds the star of point `i` with all of its neighbours.
    fn add_complete(
        &mut self,
        points: &StarPoints<'_>,
        i: u32,
        judge: &mut dyn TellsApart,
        StarBuffers { ball, star, .. }: &mut StarBuffers,
    ) {
        let normal = points.normal[i as usize];
        let mut look = |radius: f32, most: usize, star: &mut Star| {
            let known_sq = ball.search(points, i, radius, most);
            ball.level(points.tips, normal, points.is_tip(i));
            star.make(ball, points, i, 0.0, judge);
            known_sq
        };
        let mut known_sq = look(0.0, NEAR, star);
        let width_sq = star.width_sq();
        if width_sq > known_sq && width_sq.is_finite() {
            // If the ball is wide and would hold more points, a search for the nearest ones is
            // faster.
            let is_wide = width_sq > (MOST / NEAR) as f32 * known_sq;
            // The hundredth allows for rounding.
            known_sq = look(if is_wide { 0.0 } else { 1.01 * width_sq.sqrt() }, MOST, star);
        }
        let is_certain = star.is_certain(known_sq);
        self.push(ball, star, known_sq.min(f32::MAX), is_certain);
    }

    /// The [completed](Stars::completed) stars of all sheets in the order of a tree over their
    /// rows; the first `on_creases` rows are on creases. A row that was left out has no neighbours.
    pub(crate) async fn gathered(
        sheets: &Sheets,
        tree: &Tree,
        on_creases: usize,
        judge: &dyn TellsApart,
    ) -> Self {
        let count = tree.origin.iter().max().map_or(0, |&row| row as usize + 1);
        let mut place = vec![NONE; count];
        (0..).zip(&tree.origin).for_each(|(k, &row)| place[row as usize] = k);
        // The sheet of each row, and the row's place in it.
        let mut at = vec![None; count];
        let mut completed = Vec::new();
        for sheet in &sheets.all {
            let number = completed.len();
            (0..).zip(&sheet.tree.origin).for_each(|(k, &row)| at[row as usize] = Some((number, k)));
            let is_at_border = |k: usize| (sheet.tree.origin[k] as usize) < on_creases;
            completed.push(sheet.stars.completed(&sheet.points(), is_at_border, judge).await);
        }
        let mut stars = Self::with_capacity(tree.len());
        for &row in &tree.origin {
            let Some((number, k)) = at[row as usize] else {
                stars.end_star(f32::INFINITY, true, false);
                continue;
            };
            let (own, rows): (&Self, _) = (&completed[number], &sheets.all[number].tree.origin);
            stars.entry.extend(own.entry[own.range(k)].iter().map(|&entry| {
                let row = rows[(entry & POINT) as usize];
                entry & !POINT | place[row as usize]
            }));
            stars.end_star(own.nearest[k], own.is_open[k], own.is_certain[k]);
        }
        stars
    }

    /// The points at the place of an earlier one.
    fn twins(&self) -> &[u32] {
        &self.twins
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.is_open.len()
    }

    /// Indices of the entries of point `i`.
    pub(crate) fn range(&self, i: usize) -> Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// Number of entries.
    pub(crate) fn entry_count(&self) -> usize {
        self.entry.len()
    }

    /// The neighbour of an entry.
    pub(crate) fn neighbour(&self, entry: usize) -> u32 {
        self.entry[entry] & POINT
    }

    /// The entry of `i` that holds `a`, if `b` is the next one and makes a triangle with it.
    pub(crate) fn entry(&self, i: u32, a: u32, b: u32) -> Option<usize> {
        let range = self.range(i as usize);
        let place = self.entry[range.clone()].iter().position(|&entry| entry & !CORNER == a | WEDGE)?;
        let entry = range.start + place;
        (self.next(&range, entry) == Some(b)).then_some(entry)
    }

    /// The neighbour after that of `entry`, if both form a triangle with the centre.
    pub(crate) fn next(&self, range: &Range<usize>, entry: usize) -> Option<u32> {
        let next = if entry + 1 == range.end { range.start } else { entry + 1 };
        (self.entry[entry] & WEDGE != 0).then(|| self.neighbour(next))
    }

    /// Whether `i` sees the triangle of itself, `a` and `b`, from either side: points of two sheets
    /// may see it from opposite sides.
    pub(crate) fn sees(&self, i: u32, a: u32, b: u32) -> bool {
        self.entry(i, a, b).is_some() || self.entry(i, b, a).is_some()
    }

    /// The natural neighbours of `i`: the points whose Voronoi cells share an edge with its own.
    pub(crate) fn of(&self, i: usize) -> impl Iterator<Item = usize> + Clone + '_ {
        let entries = self.entry[self.range(i)].iter().filter(|&&entry| entry & CORNER == 0);
        entries.map(|&entry| (entry & POINT) as usize)
    }

    /// Number of natural neighbours of `i`.
    pub(crate) fn valence(&self, i: usize) -> usize {
        self.of(i).count()
    }

    /// Whether `j` is a natural neighbour of `i`.
    pub(crate) fn adjacent(&self, i: usize, j: usize) -> bool {
        self.of(i).any(|other| other == j)
    }
}

impl Star {
    /// Finds the neighbours of point `i` among the points of the ball around it.
    fn make(
        &mut self,
        ball: &mut Ball,
        points: &StarPoints<'_>,
        i: u32,
        twin_sq: f32,
        judge: &mut dyn TellsApart,
    ) {
        let centre = points.oriented(i);
        ball.unroll(centre.normal, twin_sq);
        self.follow(ball);
        if !ball.faces_another() || points.is_tip(i) {
            return;
        }
        let mut others: Vec<OrientedPoint> = ball.indices().map(|j| points.oriented(j)).collect();
        others.retain(|other| other.normal.dot(centre.normal) < 0.0);
        let facing_away = judge.facing_away(centre, &others);
        if facing_away == f64::INFINITY {
            return;
        }
        let mut is_known = [false; MOST];
        loop {
            let mut is_changed = false;
            for &Ray { point, .. } in &self.rays {
                let j = ball.index(point);
                if !core::mem::replace(&mut is_known[point], true)
                    && !points.is_tip(j)
                    && judge.are_two(centre, points.oriented(j), facing_away)
                {
                    ball.leave_out(point);
                    is_changed = true;
                }
            }
            if !is_changed {
                return;
            }
            self.follow(ball);
        }
    }

    /// Follows the hull of the inverted points from the nearest one, to the left until it closes,
    /// or else to both sides as far as it goes.
    fn follow(&mut self, ball: &Ball) {
        self.rays.clear();
        let Some(first) = ball.nearest() else { return };
        let mut point = first;
        // The hull has no more corners than there are points.
        while self.rays.len() < ball.len() {
            let (mut next, width_sq) = ball.next(point, 1.0);
            if point != first && next.is_some_and(|next| ball.is_between(point, first, next)) {
                next = Some(first); // Rounding has led past the first one.
            }
            self.rays.push(Ray { point, width_sq });
            match next {
                Some(next) if next == first => return,
                Some(next) => point = next,
                None => break,
            }
        }
        let left = self.rays.len();
        point = first;
        while self.rays.len() < ball.len()
            && let (Some(next), width_sq) = ball.next(point, -1.0)
        {
            self.rays.push(Ray { point: next, width_sq });
            point = next;
        }
        self.rays[left..].reverse();
        self.rays.rotate_left(left);
    }

    /// Whether no point farther than √`known_sq` can change the star.
    fn is_certain(&self, known_sq: f32) -> bool {
        !self.rays.is_empty() && self.width_sq() <= known_sq
    }

    /// The square of the largest width of a wedge; infinite if one takes half a turn or more.
    fn width_sq(&self) -> f32 {
        self.rays.iter().map(|ray| ray.width_sq).fold(0.0, f32::max)
    }

    /// Whether the Voronoi cells of the centre and of the point of a ray meet only in a corner: the
    /// circles through both and the ray on either side are the same.
    fn is_corner(&self, ball: &Ball, k: usize) -> bool {
        let n = self.rays.len();
        let [before, at, after] = [k + n - 1, k, k + 1].map(|k| self.rays[k % n]);
        // With three rays the points on either side may follow each other on the far side.
        let has_wedges = n > 3 && before.width_sq < f32::INFINITY && at.width_sq < f32::INFINITY;
        has_wedges && ball.cotangent(at.point, before.point) + ball.cotangent(at.point, after.point) < SHORT
    }

    /// The square of the largest width of a wedge, in units of the median distance of the
    /// neighbours.
    fn widest_sq(&self, ball: &Ball) -> f32 {
        let mut lengths_sq = [0.0; NEAR];
        for (length_sq, ray) in lengths_sq.iter_mut().zip(&self.rays) {
            *length_sq = ball.distance_sq(ray.point);
        }
        let lengths_sq = &mut lengths_sq[..self.rays.len()];
        sort_few(lengths_sq, |a, b| a < b);
        let median_sq = lengths_sq.get(self.rays.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
        4.0 * WIDEST * WIDEST * median_sq
    }
}

#[cfg(test)]
mod tests;
