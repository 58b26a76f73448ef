//! Places of the surface between the points: corners of the Voronoi cells, and random ones.

use super::triangles::area_vector;
use crate::field::Field;
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Places are projected this many at a time: the batch stays in the first-level cache.
const BATCH: usize = 256;
/// Newton steps of a projection. A place starts within d²κ/8 of the surface; two steps square that twice.
const STEPS: usize = 3;

/// Moves each place to the surface along the gradient; one that would move farther than its `leash` stays.
pub(super) fn project(field: &mut dyn Field, place: &mut [Vec3], leash: &[f32]) {
    let mut value = [0.0_f32; BATCH];
    let mut gradient = [Vec3::ZERO; BATCH];
    let mut moved = [Vec3::ZERO; BATCH];
    for (place, leash) in place.chunks_mut(BATCH).zip(leash.chunks(BATCH)) {
        let n = place.len();
        moved[..n].copy_from_slice(place);
        for _ in 0..STEPS {
            field.gradients(&moved[..n], &mut value[..n], &mut gradient[..n]);
            for k in 0..n {
                let slope_sq = gradient[k].length_squared();
                if slope_sq > 0.0 {
                    moved[k] -= gradient[k] * (value[k] / slope_sq);
                }
            }
        }
        for k in 0..n {
            // False for NaN.
            if (moved[k] - place[k]).length_squared() <= leash[k] * leash[k] {
                place[k] = moved[k];
            }
        }
    }
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

/// Where places are looked for, and which count.
pub(super) struct Places<'a> {
    pub(super) tree: &'a Tree,
    pub(super) mesh: &'a [[u32; 3]],
    /// Whether a place counts.
    pub(super) counts: &'a dyn Fn(Vec3) -> bool,
    /// Radius of an ideal hole between some points; NaN where there is no ideal.
    pub(super) ideal: &'a dyn Fn(&[u32]) -> f32,
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

/// Some places on their way to the surface.
#[derive(Default)]
struct Batch {
    place: Vec<Vec3>,
    leash: Vec<f32>,
    ideal: Vec<f32>,
}

impl Batch {
    fn clear(&mut self) {
        self.place.clear();
        self.leash.clear();
        self.ideal.clear();
    }

    fn push(&mut self, place: Vec3, leash: f32, ideal: f32) {
        self.place.push(place);
        self.leash.push(leash);
        self.ideal.push(ideal);
    }

    fn project(&mut self, field: &mut dyn Field) -> impl Iterator<Item = (Vec3, f32, f32)> {
        project(field, &mut self.place, &self.leash);
        self.place.iter().zip(&self.leash).zip(&self.ideal).map(|((&p, &leash), &ideal)| (p, leash, ideal))
    }
}

/// Holes around the Voronoi corners of the surface, the projected circumcentres of the triangles.
pub(super) fn largest_gap(field: &mut dyn Field, places: &Places) -> Holes {
    let mut batch = Batch::default();
    let (mut widest_sq, mut relative_sq) = (0.0_f32, 0.0_f32);
    for chunk in places.mesh.chunks(BATCH) {
        batch.clear();
        for &triangle in chunk {
            if let Some((centre, radius)) = circumcentre(&places.tree.position, triangle) {
                batch.push(centre.as_vec3(), radius as f32, (places.ideal)(&triangle));
            }
        }
        for (p, radius, ideal) in batch.project(field) {
            // A projected corner is about as far from its nearest point as the circumradius says; look no farther
            // than twice that. Corners that cannot beat the largest gaps so far are passed over.
            let (bound_sq, ideal_sq) = (4.0 * radius * radius, ideal * ideal);
            if bound_sq > widest_sq || bound_sq > relative_sq * ideal_sq {
                let gap_sq = places.tree.nearest_sq(p, u32::MAX, bound_sq);
                if (gap_sq > widest_sq || gap_sq > relative_sq * ideal_sq) && (places.counts)(p) {
                    widest_sq = widest_sq.max(gap_sq);
                    relative_sq = relative_sq.max(gap_sq / ideal_sq);
                }
            }
        }
    }
    Holes { widest: f64::from(widest_sq).sqrt(), relative: f64::from(relative_sq).sqrt() }
}

/// Distances from random places of the surface to their nearest point.
pub(super) struct Gaps {
    pub(super) holes: Holes,
    /// Mean squared distance; NaN without a place.
    pub(super) mean_sq: f64,
}

/// About `count` places, uniform over the area of the triangles (stratified: one in each equal share of it), projected
/// to the surface; those that count.
pub(super) fn random_gaps(field: &mut dyn Field, places: &Places, count: usize, seed: u64) -> Gaps {
    let (tree, triangles) = (places.tree, places.mesh);
    let total: f64 = triangles.iter().map(|&t| area_vector(&tree.position, t).length()).sum();
    let share = total / count as f64;
    let mut random = Pcg32::seed_from_u64(seed);
    let mut unit = move || f64::from(random.next_u32()) * (1.0 / 4_294_967_296.0);
    let mut batch = Batch::default();
    let (mut seen, mut sum, mut widest_sq, mut relative_sq) = (0_usize, 0.0_f64, 0.0_f32, 0.0_f32);
    let mut measure = |batch: &mut Batch| {
        for (p, leash, ideal) in batch.project(field).filter(|place| (places.counts)(place.0)) {
            let gap_sq = tree.nearest_sq(p, u32::MAX, 4.0 * leash * leash);
            widest_sq = widest_sq.max(gap_sq);
            relative_sq = relative_sq.max(gap_sq / (ideal * ideal));
            sum += f64::from(gap_sq);
            seen += 1;
        }
        batch.clear();
    };
    let mut passed = 0.0;
    let mut next = share * unit();
    let mut stratum = 1.0;
    for &triangle in triangles {
        passed += area_vector(&tree.position, triangle).length();
        while next < passed && stratum <= count as f64 {
            let [a, b, c] = triangle.map(|i| tree.position[i as usize].as_dvec3());
            // Uniform in the triangle: the square root undoes the crowding towards `a`.
            let (s, t) = (unit().sqrt(), unit());
            let p = a + ((b - a) * (1.0 - t) + (c - a) * t) * s;
            // The nearest point is no farther than the nearest corner; a projection moves less than that.
            let corner = (p - a).length().min((p - b).length()).min((p - c).length());
            let leash = corner.max((b - c).length() * 0.5) as f32;
            batch.push(p.as_vec3(), leash, (places.ideal)(&triangle));
            if batch.place.len() == BATCH {
                measure(&mut batch);
            }
            next = share * (stratum + unit());
            stratum += 1.0;
        }
    }
    measure(&mut batch);
    let holes = Holes { widest: f64::from(widest_sq).sqrt(), relative: f64::from(relative_sq).sqrt() };
    Gaps { holes, mean_sq: sum / seen as f64 }
}
