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

/// Largest distance from a Voronoi corner of the surface (the projected circumcentre of a triangle) that passes `counts` to
/// its nearest point.
pub(super) fn largest_gap(
    field: &mut dyn Field,
    tree: &Tree,
    triangles: &[[u32; 3]],
    counts: &dyn Fn(Vec3) -> bool,
) -> f64 {
    let mut place = Vec::with_capacity(BATCH);
    let mut leash = Vec::with_capacity(BATCH);
    let mut largest_sq = 0.0_f32;
    for chunk in triangles.chunks(BATCH) {
        place.clear();
        leash.clear();
        for &triangle in chunk {
            if let Some((centre, radius)) = circumcentre(&tree.position, triangle) {
                place.push(centre.as_vec3());
                leash.push(radius as f32);
            }
        }
        project(field, &mut place, &leash);
        for (&p, &radius) in place.iter().zip(&leash) {
            // A projected corner is about as far from its nearest point as the circumradius says; look no farther
            // than twice that. Corners that cannot beat the largest gap so far are passed over.
            if 4.0 * radius * radius > largest_sq {
                let gap_sq = tree.nearest_sq(p, u32::MAX, 4.0 * radius * radius);
                if gap_sq > largest_sq && counts(p) {
                    largest_sq = gap_sq;
                }
            }
        }
    }
    f64::from(largest_sq).sqrt()
}

/// Distances from random places of the surface to their nearest point.
pub(super) struct Gaps {
    /// Largest distance.
    pub(super) largest: f64,
    /// Mean squared distance; NaN without a place.
    pub(super) mean_sq: f64,
}

/// About `count` places, uniform over the area of the `triangles` (stratified: one in each equal share of it), projected
/// to the surface; those that pass `counts`.
pub(super) fn random_gaps(
    field: &mut dyn Field,
    tree: &Tree,
    triangles: &[[u32; 3]],
    counts: &dyn Fn(Vec3) -> bool,
    count: usize,
    seed: u64,
) -> Gaps {
    let total: f64 = triangles.iter().map(|&t| area_vector(&tree.position, t).length()).sum();
    let share = total / count as f64;
    let mut random = Pcg32::seed_from_u64(seed);
    let mut unit = move || f64::from(random.next_u32()) * (1.0 / 4_294_967_296.0);
    let mut place = Vec::with_capacity(BATCH);
    let mut leash = Vec::with_capacity(BATCH);
    let (mut seen, mut sum, mut largest_sq) = (0_usize, 0.0_f64, 0.0_f32);
    let mut measure = |place: &mut Vec<Vec3>, leash: &mut Vec<f32>| {
        project(field, place, leash);
        for (&p, &leash) in place.iter().zip(leash.iter()).filter(|(p, _)| counts(**p)) {
            let gap_sq = tree.nearest_sq(p, u32::MAX, 4.0 * leash * leash);
            largest_sq = largest_sq.max(gap_sq);
            sum += f64::from(gap_sq);
            seen += 1;
        }
        place.clear();
        leash.clear();
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
            place.push(p.as_vec3());
            // The nearest point is no farther than the nearest corner; a projection moves less than that.
            let corner = (p - a).length().min((p - b).length()).min((p - c).length());
            leash.push(corner.max((b - c).length() * 0.5) as f32);
            if place.len() == BATCH {
                measure(&mut place, &mut leash);
            }
            next = share * (stratum + unit());
            stratum += 1.0;
        }
    }
    measure(&mut place, &mut leash);
    Gaps { largest: f64::from(largest_sq).sqrt(), mean_sq: sum / seen as f64 }
}
