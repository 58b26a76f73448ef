//! Places of the surface between the points: corners of the Voronoi cells, and random ones.

use super::border::Border;
use super::nearby::Nearby;
use super::sizes::Wanted;
use super::triangles::area_vector;
use crate::field::Field;
use crate::pieces::piece;
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Places looked at together, in one piece of work: the batch stays in the first-level cache.
const BATCH: usize = 128;
/// Most Newton steps of a projection.
const STEPS: usize = 3;
/// A step shorter than this share of the leash is the last one. It was the sagitta s = κℓ²/2 of the leash ℓ, as far as it had to
/// be; then κs² = 2 s³/ℓ² is left, which changes the distance to a point ℓ away by 2 (s/ℓ)⁶ of it: 3·10⁻⁸.
const LAST_STEP: f32 = 0.05;

/// Moves each place to the surface along the gradient, by [`STEPS`] steps or to one shorter than `last` of its `leash`; one
/// that would move farther than that stays.
pub(super) fn project(field: &mut dyn Field, place: &mut [Vec3], leash: &[f32], last: f32) {
    for (place, leash) in place.chunks_mut(BATCH).zip(leash.chunks(BATCH)) {
        project_batch(field, place, leash, last);
    }
}

fn project_batch(field: &mut dyn Field, place: &mut [Vec3], leash: &[f32], last: f32) {
    let mut value = [0.0_f32; BATCH];
    let mut gradient = [Vec3::ZERO; BATCH];
    let mut moved = [Vec3::ZERO; BATCH];
    moved[..place.len()].copy_from_slice(place);
    // Those under way, which stand first in `at`, and which they are.
    let mut at = moved;
    let mut under_way: [usize; BATCH] = core::array::from_fn(|k| k);
    let mut count = place.len();
    for _ in 0..STEPS {
        field.gradients(&at[..count], &mut value, &mut gradient);
        let mut left = 0;
        for k in 0..count {
            let i = under_way[k];
            let slope_sq = gradient[k].length_squared();
            if slope_sq > 0.0 {
                let step = gradient[k] * (value[k] / slope_sq);
                moved[i] -= step;
                // False for NaN, from which no step leads away.
                if step.length_squared() > last * last * leash[i] * leash[i] {
                    (under_way[left], at[left]) = (i, moved[i]);
                    left += 1;
                }
            }
        }
        count = left;
    }
    for k in 0..place.len() {
        // False for NaN.
        if (moved[k] - place[k]).length_squared() <= leash[k] * leash[k] {
            place[k] = moved[k];
        }
    }
}

/// Whether a place is on the surface but for another last step. The centre of a triangle with almost no height, as some along
/// the border of a box have, is far off, and may have found no way to it.
fn is_reached(field: &mut dyn Field, place: Vec3, leash: f32) -> bool {
    let (mut value, mut gradient) = ([0.0], [Vec3::ZERO]);
    field.gradients(&[place], &mut value, &mut gradient);
    value[0].abs() <= LAST_STEP * leash * gradient[0].length()
}

/// Circumcentre and circumradius of a triangle; none for one without area.
fn circumcentre(position: &[Vec3], triangle: [u32; 3]) -> Option<(DVec3, f64)> {
    let [a, b, c] = triangle.map(|i| position[i as usize].as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let offset = (normal.cross(ab) * ac.length_squared() + ac.cross(normal) * ab.length_squared())
        / (2.0 * normal.length_squared());
    offset.is_finite().then(|| (a + offset, offset.length()))
}

/// Where places are looked for, and what they are measured with.
pub(super) struct Places<'a> {
    pub(super) tree: &'a Tree,
    pub(super) mesh: &'a [[u32; 3]],
    pub(super) border: Option<&'a Border>,
    pub(super) wanted: Option<&'a Wanted>,
    /// Leash from which on the surroundings of a place hold too many points to be gathered.
    pub(super) wide: f32,
}

impl Places<'_> {
    /// Whether a place counts.
    pub(super) fn counts(&self, p: Vec3) -> bool {
        self.border.is_none_or(|border| !border.is_near(p))
    }

    /// Radius of an ideal hole between some points; NaN where there is no ideal.
    pub(super) fn ideal(&self, points: &[u32]) -> f32 {
        self.wanted.map_or(f32::NAN, |wanted| wanted.hole_between(points))
    }

    /// Squared distance from `p` to the nearest of some points.
    fn nearest_of(&self, p: Vec3, points: &[u32]) -> f32 {
        points
            .iter()
            .map(|&i| self.tree.position[i as usize].distance_squared(p))
            .fold(f32::INFINITY, f32::min)
    }
}

/// The largest holes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Holes {
    /// Largest distance of a place to its nearest point.
    pub(super) widest: f64,
    /// Largest such distance over that in an ideal hole there.
    pub(super) relative: f64,
}

impl Holes {
    pub(super) fn or(self, other: Self) -> Self {
        Self { widest: self.widest.max(other.widest), relative: self.relative.max(other.relative) }
    }
}

/// Distances from places of the surface to their nearest point, as they come in.
#[derive(Default)]
pub(super) struct Gaps {
    nearby: Nearby,
    widest_sq: f32,
    relative_sq: f32,
    sum_sq: f64,
    seen: usize,
}

impl Gaps {
    /// The largest so far.
    pub(super) fn holes(&self) -> Holes {
        Holes { widest: f64::from(self.widest_sq).sqrt(), relative: f64::from(self.relative_sq).sqrt() }
    }

    /// Mean squared distance from the random places; NaN without one.
    pub(super) fn mean_sq(&self) -> f64 {
        self.sum_sq / self.seen as f64
    }

    fn exceeds(&self, gap_sq: f32, ideal_sq: f32) -> bool {
        gap_sq > self.widest_sq || gap_sq > self.relative_sq * ideal_sq
    }

    fn widen(&mut self, gap_sq: f32, ideal_sq: f32) {
        self.widest_sq = self.widest_sq.max(gap_sq);
        self.relative_sq = self.relative_sq.max(gap_sq / ideal_sq);
    }

    /// Takes in random places, given with their triangles and leashes.
    fn add_random(&mut self, field: &mut dyn Field, places: &Places, batch: &mut Batch) {
        project_batch(field, &mut batch.place, &batch.leash, LAST_STEP);
        for ((&p, &leash), triangle) in batch.place.iter().zip(&batch.leash).zip(&batch.triangle) {
            if places.counts(p) {
                let bound_sq = places.nearest_of(p, triangle);
                let gap_sq = if leash < places.wide {
                    self.nearby.nearest_sq(places.tree, p, bound_sq, leash)
                } else {
                    places.tree.nearest_sq(p, u32::MAX, bound_sq)
                };
                let ideal = places.ideal(triangle);
                self.widen(gap_sq, ideal * ideal);
                self.sum_sq += f64::from(gap_sq);
                self.seen += 1;
            }
        }
        batch.clear();
    }

    /// Takes in the Voronoi corners of the surface, the projected circumcentres of the triangles.
    pub(super) async fn add_corners(&mut self, field: &mut dyn Field, places: &Places<'_>) {
        let mut batch = Batch::default();
        for chunk in places.mesh.chunks(BATCH) {
            for &triangle in chunk {
                if let Some((centre, radius)) = circumcentre(&places.tree.position, triangle) {
                    batch.push(centre.as_vec3(), radius as f32, triangle);
                }
            }
            self.add_corner_batch(field, places, &mut batch);
            piece().await;
        }
    }

    fn add_corner_batch(&mut self, field: &mut dyn Field, places: &Places, batch: &mut Batch) {
        project_batch(field, &mut batch.place, &batch.leash, LAST_STEP);
        for ((&p, &leash), triangle) in batch.place.iter().zip(&batch.leash).zip(&batch.triangle) {
            // Corners that cannot beat the largest gaps so far are passed over.
            let bound_sq = places.nearest_of(p, triangle);
            let ideal = places.ideal(triangle);
            let ideal_sq = ideal * ideal;
            if self.exceeds(bound_sq, ideal_sq) {
                let gap_sq = places.tree.nearest_sq(p, u32::MAX, bound_sq);
                if self.exceeds(gap_sq, ideal_sq) && places.counts(p) && is_reached(field, p, leash) {
                    self.widen(gap_sq, ideal_sq);
                }
            }
        }
        batch.clear();
    }

    /// Takes in about `count` places, uniform over the area of the triangles (stratified: one in each equal share of it),
    /// projected to the surface; those that count.
    pub(super) async fn add_places(
        &mut self,
        field: &mut dyn Field,
        places: &Places<'_>,
        count: usize,
        seed: u64,
    ) {
        let (position, triangles) = (&places.tree.position, places.mesh);
        let total: f64 = triangles.iter().map(|&t| area_vector(position, t).length()).sum();
        let share = total / count as f64;
        let mut random = Pcg32::seed_from_u64(seed);
        let mut unit = move || f64::from(random.next_u32()) * (1.0 / 4_294_967_296.0);
        let mut batch = Batch::default();
        let mut passed = 0.0;
        let mut next = share * unit();
        let mut stratum = 1.0;
        for &triangle in triangles {
            passed += area_vector(position, triangle).length();
            while next < passed && stratum <= count as f64 {
                let [a, b, c] = triangle.map(|i| position[i as usize].as_dvec3());
                // Uniform in the triangle: the square root undoes the crowding towards `a`.
                let (s, t) = (unit().sqrt(), unit());
                let p = a + ((b - a) * (1.0 - t) + (c - a) * t) * s;
                // The nearest point is no farther than the nearest corner; a projection moves less than that.
                let corner = (p - a).length().min((p - b).length()).min((p - c).length());
                batch.push(p.as_vec3(), corner.max((b - c).length() * 0.5) as f32, triangle);
                if batch.place.len() == BATCH {
                    self.add_random(field, places, &mut batch);
                    piece().await;
                }
                next = share * (stratum + unit());
                stratum += 1.0;
            }
        }
        self.add_random(field, places, &mut batch);
    }
}

/// Some places on their way to the surface.
#[derive(Default)]
struct Batch {
    place: Vec<Vec3>,
    /// How far each may move.
    leash: Vec<f32>,
    /// Where each comes from.
    triangle: Vec<[u32; 3]>,
}

impl Batch {
    fn clear(&mut self) {
        self.place.clear();
        self.leash.clear();
        self.triangle.clear();
    }

    fn push(&mut self, place: Vec3, leash: f32, triangle: [u32; 3]) {
        self.place.push(place);
        self.leash.push(leash);
        self.triangle.push(triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::FormulaField;
    use crate::pieces::complete;

    #[test]
    fn corners_that_do_not_come_to_the_surface_are_no_holes() {
        let mut field = FormulaField::parse("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
        let at = |y: f32, z: f32| Vec3::new(1.0, y, z).normalize_or_zero();
        // Almost on a great circle: the centre is near that of the sphere, from where no short way leads to the surface.
        let flat = [at(-0.1, 0.001), at(0.0, 0.0), at(0.1, 0.001)];
        let wide = [at(-0.1, 0.0), at(0.1, 0.0), at(0.0, 0.2)];
        for (points, holes) in [(flat, 0.0..=0.0), (wide, 0.1..=0.15)] {
            let tree = Tree::new(&points);
            let mesh = [[0, 1, 2]];
            let places = Places { tree: &tree, mesh: &mesh, border: None, wanted: None, wide: 1.0 };
            let mut gaps = Gaps::default();
            complete(gaps.add_corners(&mut field, &places));
            assert!(holes.contains(&gaps.holes().widest), "{}", gaps.holes().widest);
        }
    }
}
