//! The points without duplicates, and their triangles.

use super::figures::hexagonal_spacing;
use super::gaps::{Gaps, spacing_of};
use super::options::MeasureOptions;
use super::points::MeasuredPoints;
use super::triangles::{Triangles, area};
use crate::field::Evaluator;
use crate::math::{Bounds, IndexTable, SINGLE_ROUNDING, hash};
use crate::mesh::stars::Sheets;
use crate::slices::pause;
use glam::Vec3;
use std::sync::Arc;

/// The points without duplicates and non-finite positions, and their triangles.
pub(super) struct Prepared {
    pub(super) points: MeasuredPoints,
    /// The spacing at each point.
    pub(super) spacing: Vec<f32>,
    /// The triangles that lead across no gap of the surface.
    pub(super) triangles: Triangles,
    /// The triangles that count, without conflicts (see [`Triangles::settled`]).
    pub(super) mesh: Vec<[u32; 3]>,
    /// The area of these triangles.
    pub(super) mesh_area: f64,
    /// The area of the surface, as given or of these triangles.
    pub(super) area: f64,
    pub(super) duplicates: usize,
    pub(super) not_finite: usize,
    /// Whether each point is left out, by its index as given.
    pub(super) drop: Vec<bool>,
}

impl Prepared {
    /// Prepares the points; `bounds` is the box that was sampled, and `known` are the sheets of all
    /// points, if given.
    pub(super) async fn new(
        position: &[Vec3],
        normal: &[Vec3],
        field: &mut dyn Evaluator,
        bounds: Option<&Bounds>,
        options: &MeasureOptions<'_>,
        known: Option<&Arc<Sheets>>,
    ) -> Self {
        let rows = options.rows;
        // The further rows of a particle on a crease.
        let is_further = |i: usize| rows.is_some_and(|rows| rows.first_row(i) != i);
        let further = rows.map_or(0, |rows| rows.twins.len() - rows.count_of_first(rows.twins.len()));
        let mut drop: Vec<bool> = position.iter().map(|p| !p.is_finite()).collect();
        let not_finite = drop.iter().filter(|&&dropped| dropped).count();
        let mut has_duplicate = vec![false; position.len()];
        // Equal points are dropped first: all of them would be nearest neighbours of one another.
        drop_equal(position, is_further, &mut drop, &mut has_duplicate);
        pause().await;
        loop {
            let mut points =
                MeasuredPoints::new(position, normal, field, &has_duplicate, &drop, rows, known).await;
            let spacing = spacing_of(&points).await;
            let patched = rows.filter(|_| !points.creases.is_empty());
            let (triangles, mesh) = if let Some(rows) = patched {
                let mesh = points.mesh(field, rows, bounds).await;
                points.creases.find_edges(&mesh);
                (Triangles::seen(&points.stars, &mesh), mesh)
            } else {
                let mut triangles = Triangles::new(&points.stars).await;
                let gaps = Gaps { points: &points, spacing: &spacing, bounds };
                for list in [&mut triangles.unanimous, &mut triangles.majority, &mut triangles.single] {
                    gaps.drop_across(field, list).await;
                }
                let mesh = triangles.settled(&points.tree.position);
                (triangles, mesh)
            };
            pause().await;
            let mesh_area = area(&points.tree.position, &mesh);
            let area = options.area.unwrap_or(mesh_area);
            let d_hex = hexagonal_spacing(area, position.len() - not_finite - further);
            pause().await;
            if !drop_close(&points, (SINGLE_ROUNDING * d_hex) as f32, &mut drop) {
                let duplicates = position.len() - not_finite - points.tree.len();
                return Self {
                    points,
                    spacing,
                    triangles,
                    mesh,
                    mesh_area,
                    area,
                    duplicates,
                    not_finite,
                    drop,
                };
            }
        }
    }
}

/// Marks every finite point that equals an earlier one in `drop`, and the earlier one in
/// `has_duplicate`; further rows of a particle are no duplicates of it.
fn drop_equal(
    position: &[Vec3],
    is_further: impl Fn(usize) -> bool,
    drop: &mut [bool],
    has_duplicate: &mut [bool],
) {
    let mut table = IndexTable::default();
    for (i, p) in position.iter().enumerate() {
        if drop[i] || is_further(i) {
            continue;
        }
        // Adding 0 turns −0 into 0.
        let hash = hash(p.to_array().map(|c| u64::from((c + 0.0).to_bits())));
        let first =
            table.find_or_add(hash, i, |earlier| position[earlier] == *p).map_or(i, |first| first as usize);
        if first != i {
            drop[i] = true;
            has_duplicate[first] = true;
        }
    }
}

/// Marks every point closer than `limit` to an earlier one in `drop`. Returns whether there was
/// any.
fn drop_close(points: &MeasuredPoints, limit: f32, drop: &mut [bool]) -> bool {
    let tree = &points.tree;
    let mut near = Vec::new();
    let mut any = false;
    for i in 0..tree.len() {
        if points.nearest_kept(i) < limit {
            near.clear();
            tree.within_box(tree.position[i] - limit, tree.position[i] + limit, &mut near);
            if near.iter().any(|&j| {
                tree.origin[j as usize] < tree.origin[i]
                    && !points.creases.are_one(i, j as usize)
                    && (tree.position[j as usize] - tree.position[i]).length() < limit
            }) {
                drop[tree.origin[i] as usize] = true;
                any = true;
            }
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};
    use crate::slices::complete;
    use glam::DVec3;

    #[test]
    fn equal_points_are_those_with_equal_coordinates_whatever_the_sign_of_zero() {
        let values = [0.0, -0.0, 1.0, -1.0, 0.1];
        let position: Vec<Vec3> = (0..300)
            .map(|k: usize| {
                Vec3::from_array([k * 7, k * 11 / 3, k * k / 5].map(|k| values[k % values.len()]))
            })
            .collect();
        // Those that are not finite are dropped already.
        let mut drop: Vec<bool> = (0..position.len()).map(|i| i % 17 == 3).collect();
        let is_first = |i: usize| i % 17 != 3 && !(0..i).any(|j| j % 17 != 3 && position[j] == position[i]);
        let has_later = |i: usize| (i + 1..position.len()).any(|j| j % 17 != 3 && position[j] == position[i]);
        let mut has_duplicate = vec![false; position.len()];
        drop_equal(&position, |_| false, &mut drop, &mut has_duplicate);
        for i in 0..position.len() {
            assert_eq!(drop[i], !is_first(i), "{i}");
            assert_eq!(has_duplicate[i], is_first(i) && has_later(i), "{i}");
        }
    }

    #[test]
    #[allow(clippy::disallowed_methods, reason = "nothing depends on the last bits of the points")]
    fn triangles_of_a_sphere_are_closed_and_wind_outward() {
        let count = 1234;
        let turn = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let points: Vec<Vec3> = (0..count)
            .map(|i| {
                let z = 1.0 - f64::from(2 * i + 1) / f64::from(count);
                let (s, c) = (turn * f64::from(i)).sin_cos();
                let r = (1.0 - z * z).sqrt();
                DVec3::new(r * c, r * s, z).as_vec3()
            })
            .collect();
        let sphere = Formula::as_written("x^2+y^2+z^2-1", &[]).expect("a formula");
        let sphere = &mut *sphere.evaluator(Frame::default());
        let options = MeasureOptions::default();
        let prepared = complete(Prepared::new(&points, &points, sphere, None, &options, None));
        let (found, position) = (prepared.mesh, &prepared.points.tree.position);
        assert_eq!(found.len(), 2 * points.len() - 4);
        let mut edges: Vec<[u32; 2]> = found.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "an edge is used twice in one direction");
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()), "an edge is open");
        for triangle in found {
            let [a, b, c] = triangle.map(|i| position[i as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.0);
        }
    }
}
