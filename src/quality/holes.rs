//! Figures of the holes: distances from random points of the surface and from Voronoi corners to
//! the nearest point.

use super::border::Border;
use super::creases::CreaseRows;
use super::places::{Hole, WIDE};
use super::projection::{LAST_STEP, is_reached, project};
use super::sizes::WantedRadii;
use super::triangles::area_vector;
use crate::field::{BATCH, Evaluator};
use crate::math::{LANES, Lanes, NONE};
use crate::slices::{self, HEAVY, MEDIUM, MaybeSend, MaybeSync, pause};
use crate::spatial::tree::{PointsInBox, Tree};
use glam::{DVec3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// [`WIDE`] squared.
const WIDE_SQ: f32 = (WIDE * WIDE) as f32;

fn hole(p: Vec3, radius: f64, ratio: f64) -> Hole {
    Hole { position: p.to_array(), radius, ratio }
}

/// Returns the circumcentre and the circumradius of a triangle; `None` for one without area.
fn circumcentre(position: &[Vec3], triangle: [u32; 3]) -> Option<(DVec3, f64)> {
    let [a, b, c] = triangle.map(|i| position[i as usize].as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let offset = (normal.cross(ab) * ac.length_squared() + ac.cross(normal) * ab.length_squared())
        / (2.0 * normal.length_squared());
    offset.is_finite().then(|| (a + offset, offset.length()))
}

/// The points whose holes are measured, and the triangles on which the surface is sampled.
pub(super) struct Cover<'a> {
    pub(super) tree: &'a Tree,
    pub(super) creases: &'a CreaseRows,
    /// The triangles, patch by patch.
    pub(super) mesh: &'a [[u32; 3]],
    pub(super) mesh_area: f64,
    pub(super) border: Option<&'a Border>,
    pub(super) wanted: Option<&'a WantedRadii>,
    /// Radius of the disc of each point, in the order given; none if unknown.
    pub(super) discs: &'a [f32],
    /// Radius of a hole in the perfect lattice, d_hex/√3.
    pub(super) lattice: f32,
}

impl Cover<'_> {
    /// The triangles, patch by patch.
    fn patches(&self) -> impl Iterator<Item = &[[u32; 3]]> {
        self.mesh.chunk_by(|one, other| self.creases.is_one_patch(one[0] as usize, other[0] as usize))
    }

    /// Returns whether a sample counts: it is away from the border.
    fn counts(&self, p: Vec3) -> bool {
        self.border.is_none_or(|border| !border.is_near(p))
    }

    /// Returns the radius of an ideal hole between some points: without wanted radii, that of the
    /// perfect lattice.
    fn ideal(&self, points: &[u32]) -> f32 {
        self.wanted.map_or(self.lattice, |wanted| wanted.hole_between(points))
    }

    /// Whether a sample lies outside the discs of the corners of its triangle.
    fn is_bare(&self, p: Vec3, triangle: &[u32]) -> bool {
        triangle.iter().all(|&i| {
            let radius = self.discs.get(self.tree.origin[i as usize] as usize).copied().unwrap_or(f32::NAN);
            self.tree.position[i as usize].distance_squared(p) > radius * radius
        })
    }

    /// Returns the squared distance from `p` to the nearest of some points.
    fn nearest_of(&self, p: Vec3, points: &[u32]) -> f32 {
        points
            .iter()
            .map(|&i| self.tree.position[i as usize].distance_squared(p))
            .fold(f32::INFINITY, f32::min)
    }
}

/// The holes between the points of a surface, and statistics of the distances from its samples to
/// their nearest points. The radius of a hole is the distance of a sample to its nearest point.
pub(super) struct Holes {
    /// Radius of the largest hole.
    pub(super) widest: f64,
    /// Largest radius over that of an ideal hole at the same place.
    pub(super) relative: f64,
    /// Mean squared distance of the random samples; NaN if there are none.
    pub(super) mean_sq: f64,
    /// Share of the random samples outside the discs around them; NaN if there are none.
    pub(super) bare: f64,
    /// The wide holes, and the largest ones if they are not wide.
    pub(super) found: Vec<Hole>,
}

/// Slices of work that `count` random samples take.
pub(super) fn slices(count: usize) -> u64 {
    (count / BATCH) as u64
}

/// Measures the holes by about `count` random samples on the triangles, by their Voronoi corners
/// and at `crossings`, random samples of the surface.
pub(super) async fn measure(
    field: &dyn Evaluator,
    cover: &Cover<'_>,
    count: usize,
    crossings: &[Vec3],
) -> Holes {
    let mut search = HoleSearch::default();
    {
        let random = samples(cover, count).await;
        search.add_all(field, cover, random.len(), |k| random[k].clone(), true).await;
    }
    let parts: Vec<&[[u32; 3]]> = cover.patches().flat_map(|triangles| triangles.chunks(BATCH)).collect();
    search.add_all(field, cover, parts.len(), |k| corners(cover, parts[k]), false).await;
    let samples = search.samples as f64;
    let mut holes = Holes {
        widest: f64::from(search.widest_sq).sqrt(),
        relative: f64::from(search.relative_sq).sqrt(),
        mean_sq: search.sum_sq / samples,
        bare: search.bare as f64 / samples,
        found: search.wide.into_iter().chain(search.largest).collect(),
    };
    holes.add_missed(cover, crossings).await;
    holes
}

impl Holes {
    /// Adds what the triangles cannot show: components without a point, and regions where the
    /// points end. The part of the surface that is farther from every point than any sample on the
    /// triangles counts by its share of the area.
    async fn add_missed(&mut self, cover: &Cover<'_>, crossings: &[Vec3]) {
        // The hundredth allows for the rounding of the samples.
        let (widest, relative) = (1.01 * self.widest, 1.01 * self.relative);
        let (mut all, mut far, mut sum_sq) = (0.0, 0.0, 0.0);
        for chunk in crossings.chunks(HEAVY) {
            for &p in chunk.iter().filter(|&&p| cover.counts(p)) {
                all += 1.0;
                let (gap_sq, index) = cover.tree.nearest(p, NONE, f32::INFINITY);
                if index == NONE {
                    continue;
                }
                let gap = f64::from(gap_sq).sqrt();
                let ratio = gap / f64::from(cover.ideal(&[index]));
                if gap > widest {
                    far += 1.0;
                    sum_sq += gap * gap;
                    self.widest = self.widest.max(gap);
                }
                if ratio > relative {
                    self.relative = self.relative.max(ratio);
                    self.found.push(hole(p, gap, ratio));
                }
            }
            pause().await;
        }
        if all > 0.0 {
            let share = far / all;
            self.mean_sq = self.mean_sq * (1.0 - share) + sum_sq / all;
            self.bare = self.bare * (1.0 - share) + share;
        }
    }
}

/// The points in a box around the last sample. Successive samples are close to one another, so most
/// of them need no search in the tree, which takes ten times as long.
#[derive(Default)]
struct Surroundings {
    lo: Vec3,
    hi: Vec3,
    points: PointsInBox,
}

impl Surroundings {
    /// Makes the next search gather the points anew.
    fn clear(&mut self) {
        (self.lo, self.hi) = (Vec3::ZERO, Vec3::ZERO);
    }

    /// The squared distance of the nearest point of `tree` to `p` and that point, if it is below
    /// `bound_sq`; otherwise `bound_sq` and [`NONE`]. The box is gathered anew if it does not hold
    /// all points that close; within `width` there are a few points.
    fn nearest(&mut self, tree: &Tree, p: Vec3, bound_sq: f32, width: f32) -> (f32, u32) {
        /// Room around a sample for those that follow, in units of `width`. Less: the box is
        /// gathered more often; more: it holds more points.
        const REACH: f32 = 2.0;
        /// Points above which a search in the tree takes less: a triangle across a gap may be as
        /// wide as the surface.
        const MANY: usize = 256;
        let bound = bound_sq.sqrt();
        if !((p - bound).cmpge(self.lo).all() && (p + bound).cmple(self.hi).all()) {
            let reach = bound + REACH * width;
            (self.lo, self.hi) = (p - reach, p + reach);
            self.points.gather(tree, self.lo, self.hi);
        }
        if self.points.index.len() > MANY {
            return tree.nearest(p, NONE, bound_sq);
        }
        let least = self.points.distances_sq(p).fold(Lanes::splat(bound_sq), Lanes::min);
        let least = least.0.into_iter().fold(bound_sq, f32::min);
        if least >= bound_sq {
            return (bound_sq, NONE);
        }
        let blocks = self.points.index.chunks(LANES).zip(self.points.distances_sq(p));
        let mut all = blocks.flat_map(|(index, lanes)| index.iter().copied().zip(lanes.0));
        (least, all.find(|&(_, distance_sq)| distance_sq == least).map_or(NONE, |(index, _)| index))
    }
}

/// Search for holes by samples of the surface over the triangles.
#[derive(Default)]
struct HoleSearch {
    widest_sq: f32,
    relative_sq: f32,
    /// Sum of the squared distances of the random samples, and their number.
    sum_sq: f64,
    samples: usize,
    /// Random samples outside the discs around them.
    bare: usize,
    /// The wide holes.
    wide: Vec<Hole>,
    /// The largest hole, unless it is wide.
    largest: Option<Hole>,
}

impl HoleSearch {
    /// Returns whether a distance is that of a wide hole, or larger than those so far, absolutely
    /// or relative to the ideal one.
    fn matters(&self, gap_sq: f32, ideal_sq: f32) -> bool {
        gap_sq > self.widest_sq || gap_sq > self.relative_sq * ideal_sq || gap_sq > WIDE_SQ * ideal_sq
    }

    /// Adds an empty disc around `p`.
    fn widen(&mut self, p: Vec3, gap_sq: f32, ideal_sq: f32) {
        let relative_sq = gap_sq / ideal_sq;
        let hole = || hole(p, f64::from(gap_sq).sqrt(), f64::from(relative_sq).sqrt());
        if relative_sq > WIDE_SQ {
            self.wide.push(hole());
            self.largest = None;
        } else if relative_sq > self.relative_sq {
            self.largest = Some(hole());
        }
        self.widest_sq = self.widest_sq.max(gap_sq);
        self.relative_sq = self.relative_sq.max(relative_sq);
    }

    /// Adds `count` batches of samples; only `random` ones enter the statistics.
    async fn add_all(
        &mut self,
        field: &dyn Evaluator,
        cover: &Cover<'_>,
        count: usize,
        batch: impl Fn(usize) -> Batch + MaybeSend + MaybeSync,
        random: bool,
    ) {
        let known = (self.widest_sq, self.relative_sq);
        let new_scratch = || (field.another(), Surroundings::default());
        let parts = slices::map(count, 1, new_scratch, |(field, around), range| {
            let mut part = Self { widest_sq: known.0, relative_sq: known.1, ..Self::default() };
            around.clear();
            range.for_each(|k| part.add(&mut **field, cover, batch(k), around, random));
            part
        });
        for part in parts.await {
            if part.relative_sq > self.relative_sq {
                self.largest = part.largest;
            }
            self.widest_sq = self.widest_sq.max(part.widest_sq);
            self.relative_sq = self.relative_sq.max(part.relative_sq);
            self.sum_sq += part.sum_sq;
            self.samples += part.samples;
            self.bare += part.bare;
            self.wide.extend(part.wide);
        }
    }

    /// Projects a batch of samples and adds them.
    fn add(
        &mut self,
        field: &mut dyn Evaluator,
        cover: &Cover,
        mut batch: Batch,
        around: &mut Surroundings,
        random: bool,
    ) {
        let Some(first) = batch.triangle.first() else { return };
        let field = cover.creases.on(field, first[0] as usize);
        project(field, &mut batch.position, &batch.leash, LAST_STEP);
        for ((&p, &leash), triangle) in batch.position.iter().zip(&batch.leash).zip(&batch.triangle) {
            if !cover.counts(p) {
                continue;
            }
            let corner_sq = cover.nearest_of(p, triangle);
            let mut ideal = cover.ideal(triangle);
            if !random && !self.matters(corner_sq, ideal * ideal) {
                continue;
            }
            let (gap_sq, nearer) = around.nearest(cover.tree, p, corner_sq, leash);
            // The circumcentre of a long triangle may be at a far place, where other points are
            // larger.
            if nearer != NONE {
                ideal = ideal.max(cover.ideal(&[nearer]));
            }
            let ideal_sq = ideal * ideal;
            let matters = self.matters(gap_sq, ideal_sq);
            // On a triangle across a gap in the surface a sample may find no surface. The leash of
            // an almost flat triangle is far longer than the gap.
            if matters && !is_reached(field, p, leash.min(gap_sq.sqrt())) {
                continue;
            }
            if random {
                self.sum_sq += f64::from(gap_sq);
                self.samples += 1;
                self.bare += usize::from(cover.is_bare(p, triangle));
            }
            if matters && cover.creases.reaches(field, triangle[0] as usize, p) {
                self.widen(p, gap_sq, ideal_sq);
            }
        }
    }
}

/// The Voronoi corners of triangles: their circumcentres.
fn corners(cover: &Cover<'_>, triangles: &[[u32; 3]]) -> Batch {
    let mut batch = Batch::default();
    for &triangle in triangles {
        if let Some((centre, radius)) = circumcentre(&cover.tree.position, triangle) {
            batch.push(centre.as_vec3(), radius as f32, triangle);
        }
    }
    batch
}

/// About `count` random samples: uniform on the triangles, one in each of `count` equal shares of
/// their area.
async fn samples(cover: &Cover<'_>, count: usize) -> Vec<Batch> {
    let position = &cover.tree.position;
    // Twice the areas, as `area_vector` has them.
    let share = 2.0 * cover.mesh_area / count as f64;
    let mut random = Pcg32::seed_from_u64(0);
    let mut unit = move || f64::from(random.next_u32()) * (1.0 / 4_294_967_296.0);
    let mut batches: Vec<Batch> = Vec::new();
    let mut passed = 0.0;
    let mut next = share * unit();
    let mut stratum = 1.0;
    for triangles in cover.patches() {
        let mut batch = Batch::default();
        for chunk in triangles.chunks(MEDIUM) {
            for &triangle in chunk {
                passed += area_vector(position, triangle).length();
                while next < passed && stratum <= count as f64 {
                    let [a, b, c] = triangle.map(|i| position[i as usize].as_dvec3());
                    // The sample is uniform in the triangle: the square root undoes the crowding
                    // near `a`.
                    let (s, t) = (unit().sqrt(), unit());
                    let p = a + ((b - a) * (1.0 - t) + (c - a) * t) * s;
                    // The nearest point is no farther than the nearest corner, and the projection
                    // moves the sample by less than that.
                    let corner = (p - a).length().min((p - b).length()).min((p - c).length());
                    batch.push(p.as_vec3(), corner.max((b - c).length() * 0.5) as f32, triangle);
                    if batch.position.len() == BATCH {
                        batches.push(core::mem::take(&mut batch));
                        pause().await;
                    }
                    next = share * (stratum + unit());
                    stratum += 1.0;
                }
            }
            pause().await;
        }
        batches.push(batch);
    }
    batches
}

/// A batch of samples of one patch.
#[derive(Clone, Default)]
struct Batch {
    position: Vec<Vec3>,
    /// Largest distance that the projection may move each.
    leash: Vec<f32>,
    /// The triangle that each comes from.
    triangle: Vec<[u32; 3]>,
}

impl Batch {
    fn push(&mut self, position: Vec3, leash: f32, triangle: [u32; 3]) {
        self.position.push(position);
        self.leash.push(leash);
        self.triangle.push(triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};
    use crate::slices::complete;

    #[test]
    fn corners_that_do_not_come_to_the_surface_are_no_holes() {
        let field = Formula::as_written("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
        let field = &mut *field.evaluator(Frame::default());
        let at = |y: f32, z: f32| Vec3::new(1.0, y, z).normalize_or_zero();
        // These are almost on a great circle: their circumcentre is near the centre of the sphere,
        // far from the surface.
        let flat = [at(-0.1, 0.001), at(0.0, 0.0), at(0.1, 0.001)];
        let wide = [at(-0.1, 0.0), at(0.1, 0.0), at(0.0, 0.2)];
        for (points, holes) in [(flat, 0.0..=0.0), (wide, 0.1..=0.15)] {
            let tree = Tree::new(&points);
            let mesh = [[0, 1, 2]];
            let cover = Cover {
                tree: &tree,
                creases: &CreaseRows::default(),
                mesh: &mesh,
                mesh_area: 0.0,
                border: None,
                wanted: None,
                discs: &[],
                lattice: 1.0,
            };
            let mut search = HoleSearch::default();
            complete(search.add_all(field, &cover, 1, |_| corners(&cover, cover.mesh), false));
            let widest = search.widest_sq.sqrt();
            assert!(holes.contains(&widest), "{widest}");
        }
    }

    #[test]
    fn a_hole_is_measured_by_the_largest_of_the_discs_around_it() {
        let field = Formula::as_written("z = 0", &[]).expect("a formula");
        let field = &mut *field.evaluator(Frame::default());
        // The circumcentre of the long triangle of three small discs is next to the large one.
        let tree = Tree::new(
            &[[-0.1, 0.0], [0.0, 0.01], [0.1, 0.0], [0.0, -0.45]].map(|[x, y]| Vec3::new(x, y, 0.0)),
        );
        let place = |i: u32| tree.origin.iter().position(|&own| own == i).expect("a place") as u32;
        let mut radius = vec![0.01; 4];
        radius[place(3) as usize] = 0.05;
        let wanted = WantedRadii { radius, hole: 1.0 };
        let cover = Cover {
            tree: &tree,
            creases: &CreaseRows::default(),
            mesh: &[[0, 1, 2].map(place)],
            mesh_area: 0.0,
            border: None,
            wanted: Some(&wanted),
            discs: &[],
            lattice: 1.0,
        };
        let mut search = HoleSearch::default();
        complete(search.add_all(field, &cover, 1, |_| corners(&cover, cover.mesh), false));
        let relative = search.relative_sq.sqrt();
        assert!((0.8..1.0).contains(&relative), "{relative}");
    }
}
