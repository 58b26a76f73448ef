//! Points in no triangle are inserted into the triangle below them.

use super::holes::{AGREEMENT, faces_as_corners};
use super::patch::Patch;
use crate::math::unkey;
use crate::mesh::stars::MAX_LIFT;
use crate::spatial::tree::Tree;

/// Number of nearest points among whose triangles the one below a point is searched for.
const NEAR: usize = 32;
/// Largest distance of a point outside a triangle that still counts as inside, as a share of the
/// triangle's height.
const OUTSIDE: f64 = 0.25;
/// Largest number of triangles that a point may replace. It then has 18 neighbours, three times as
/// many as in a lattice.
const MOST: usize = 16;

/// Inserts the point `v`, which is in no triangle, if there is one below it.
pub(super) fn insert(patch: &mut Patch, tree: &Tree, v: u32, keys: &mut Vec<u64>) {
    tree.nearest_many(tree.position[v as usize], NEAR, |j| j != v, keys);
    let mut best = (-OUTSIDE, None);
    for &key in keys.iter() {
        for id in patch.around(unkey(key).1) {
            let depth = depth(patch, id, v);
            if depth > best.0 {
                best = (depth, Some(id));
            }
        }
    }
    if let Some(id) = best.1 {
        replace(patch, id, v);
    }
}

/// The least barycentric coordinate of a point above a triangle; −∞ if the point is not on its
/// sheet.
fn depth(patch: &Patch, id: u32, v: u32) -> f64 {
    let [a, b, c] = patch.triangle(id);
    let area = patch.area_vector([a, b, c]);
    let area_sq = area.length_squared();
    let rise = (patch.place(v) - patch.place(a)).dot(area);
    let facing = patch.normal[v as usize].as_dvec3().dot(area);
    // The area is about that of a square over the longest side of the triangle.
    let is_above = rise * rise <= f64::from(MAX_LIFT * MAX_LIFT) * area_sq * area_sq.sqrt();
    if !(is_above && facing > 0.0 && facing * facing >= AGREEMENT * AGREEMENT * area_sq) {
        return f64::NEG_INFINITY;
    }
    let share = |a: u32, b: u32| patch.area_vector([a, b, v]).dot(area) / area_sq;
    share(a, b).min(share(b, c)).min(share(c, a))
}

/// Replaces a triangle, and those behind it whose circles contain the point, by the triangles of
/// the point and their outline, unless one of these faces another way than its corners.
fn replace(patch: &mut Patch, id: u32, v: u32) {
    let [a, b, c] = patch.triangle(id);
    let mut gone = vec![id];
    // The corners of the outline, counter-clockwise.
    let mut outline = vec![a, b, c];
    let mut k = 0;
    while k < outline.len() && gone.len() < MOST {
        let (a, b) = (outline[k], outline[(k + 1) % outline.len()]);
        let behind = patch.with_side(b, a).map(|id| (id, patch.opposite(id, a, b)));
        if let Some((id, far)) = behind
            && !outline.contains(&far)
            && (!faces_as_corners(patch, [a, b, v]) || is_too_wide(patch, [a, b], [v, far]))
        {
            gone.push(id);
            outline.insert(k + 1, far);
            k = 0;
        } else {
            k += 1;
        }
    }
    let sides = (0..outline.len()).map(|k| [outline[k], outline[(k + 1) % outline.len()], v]);
    if sides.clone().all(|triangle| faces_as_corners(patch, triangle)) {
        gone.into_iter().for_each(|id| patch.remove(id));
        sides.for_each(|triangle| patch.add(triangle));
    }
}

/// Whether the angles opposite to an edge add up to more than half a turn.
fn is_too_wide(patch: &Patch, [a, b]: [u32; 2], opposite: [u32; 2]) -> bool {
    let [(dot, cross), (other_dot, other_cross)] = opposite.map(|v| {
        let (a, b) = (patch.place(a) - patch.place(v), patch.place(b) - patch.place(v));
        (a.dot(b), a.cross(b).length())
    });
    dot * other_cross + cross * other_dot < 0.0
}

#[cfg(test)]
mod tests {
    use super::super::patch::with_plane;
    use super::*;
    use glam::{DVec2, Vec3};

    /// The Delaunay triangles of points in the plane z = 0: those whose circles contain no other
    /// point.
    fn delaunay(points: &[Vec3]) -> Vec<[u32; 3]> {
        let place = |v: u32| points[v as usize].as_dvec3().truncate();
        let count = points.len() as u32;
        let triples =
            (0..count).flat_map(|a| (a + 1..count).flat_map(move |b| (a + 1..count).map(move |c| [a, b, c])));
        let is_one = |t: &[u32; 3]| {
            let [a, b, c] = t.map(place);
            let (p, q) = (b - a, c - a);
            let twice_area = p.perp_dot(q);
            let centre: DVec2 =
                (q.perp() * -p.length_squared() + p.perp() * q.length_squared()) / (2.0 * twice_area);
            let is_free = |v: u32| t.contains(&v) || (place(v) - a - centre).length() > centre.length();
            twice_area > 0.0 && (0..count).all(is_free)
        };
        triples.filter(is_one).collect()
    }

    #[test]
    fn a_point_put_into_a_delaunay_triangulation_makes_that_of_all_points() {
        for case in 0..20 {
            // A Weyl sequence: well spread, and no four points are on a circle. The last one is
            // inside the others.
            let spread =
                |k: usize| (Vec3::new(0.754_877_7, 0.569_840_3, 0.0) * (k + 17 * case) as f32).fract();
            let mut points: Vec<Vec3> = (0..20).map(spread).collect();
            points.push(0.3 + 0.4 * spread(20).with_z(0.0) - Vec3::Z * 0.3);
            let last = points.len() as u32 - 1;
            let mut found = with_plane(&points, &delaunay(&points[..20]), |patch, tree, in_tree| {
                insert(patch, tree, in_tree[last as usize], &mut Vec::new());
                patch.triangles().map(|t| t.map(|v| tree.origin[v as usize])).collect::<Vec<_>>()
            });
            for t in &mut found {
                let first = (0..3).min_by_key(|&k| t[k]).expect("three corners");
                t.rotate_left(first);
            }
            found.sort_unstable();
            assert_eq!(found, delaunay(&points), "case {case}");
        }
    }
}
