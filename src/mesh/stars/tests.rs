use super::*;
use crate::math::tangent_frame;
use crate::slices::complete;
use glam::{DVec2, DVec3};

/// Points on a unit sphere, uniformly at random.
fn on_sphere(count: usize) -> Vec<Vec3> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
    };
    let in_cube = core::iter::repeat_with(|| DVec3::new(next(), next(), next()));
    let in_ball = in_cube.filter(|p| (0.01..1.0).contains(&p.length_squared()));
    in_ball.map(|p| p.normalize_or_zero().as_vec3()).take(count).collect()
}

/// The natural neighbours of a point by looking at all points, in double precision: the cell is cut
/// by the bisector of each on the sheet, corner by corner.
fn naive(points: &StarPoints, i: usize) -> Vec<u32> {
    let centre = points.oriented(i as u32);
    let (u, v) = tangent_frame(centre.normal);
    // Corners, and the point behind the edge that begins at each.
    let mut cell: Vec<(DVec2, Option<u32>)> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| (1e3 * DVec2::new(x, y), None))
        .into();
    for j in (0..points.tree.len() as u32).filter(|&j| j as usize != i) {
        let other = points.oriented(j);
        let offset = (other.position - centre.position).as_dvec3();
        let flat = DVec2::new(offset.dot(u.as_dvec3()), offset.dot(v.as_dvec3()));
        let lift = offset.dot((centre.normal + other.normal).as_dvec3()) / offset.length();
        let is_flat = flat.length_squared() >= f64::from(ball::MIN_FLAT) * offset.length_squared();
        if centre.normal.dot(other.normal) <= 0.0 || lift.abs() > f64::from(MAX_LIFT) || !is_flat {
            continue;
        }
        let q = flat.normalize_or_zero() * offset.length();
        let side = |c: DVec2| c.dot(q) - 0.5 * q.length_squared();
        let mut cut = Vec::new();
        for (k, &(c, behind)) in cell.iter().enumerate() {
            let (d, _) = cell[(k + 1) % cell.len()];
            let crossing = c + (d - c) * (side(c) / (side(c) - side(d)));
            match (side(c) <= 0.0, side(d) <= 0.0) {
                (true, true) => cut.push((c, behind)),
                (true, false) => cut.extend([(c, behind), (crossing, Some(j))]),
                (false, true) => cut.push((crossing, behind)),
                (false, false) => {}
            }
        }
        cell = cut;
    }
    cell.into_iter().filter_map(|(_, behind)| behind).collect()
}

/// The cycle that starts at its smallest number.
fn turned(mut cycle: Vec<u32>) -> Vec<u32> {
    let least = (0..cycle.len()).min_by_key(|&k| cycle[k]).unwrap_or(0);
    cycle.rotate_left(least);
    cycle
}

#[test]
fn stars_are_those_found_by_looking_at_all_points() {
    let ellipsoid = |semiaxes: Vec3| move |p: Vec3| (p * semiaxes, (p / semiaxes).normalize_or_zero());
    for semiaxes in [Vec3::ONE, Vec3::new(1.0, 0.8, 0.5)] {
        let (position, normal): (Vec<Vec3>, Vec<Vec3>) =
            on_sphere(900).into_iter().map(ellipsoid(semiaxes)).unzip();
        let tree = Tree::new(&position);
        let normal: Vec<Vec3> = tree.origin.iter().map(|&i| normal[i as usize]).collect();
        let points = StarPoints { tree: &tree, normal: &normal, tips: &[], patch: None };
        let stars = complete(Stars::new(&points, &ByDirection));
        let stars = complete(stars.completed(&points, |_| false, &ByDirection));
        for i in 0..tree.len() {
            let found: Vec<u32> = stars.of(i).map(|j| j as u32).collect();
            assert_eq!(turned(found), turned(naive(&points, i)), "{semiaxes}: point {i}");
            let others = (0..tree.len()).filter(|&j| j != i);
            let nearest =
                others.map(|j| tree.position[j].distance(tree.position[i])).fold(f32::INFINITY, f32::min);
            assert_eq!(stars.nearest[i], nearest, "{semiaxes}: point {i}");
            assert!(!stars.is_open[i]);
        }
    }
}

#[test]
fn across_the_diagonal_of_a_square_no_points_are_neighbours_but_their_triangles_are() {
    let points: Vec<Vec3> =
        (0..11).flat_map(|x| (0..11).map(move |y| Vec3::new(x as f32, y as f32, 0.0))).collect();
    let tree = Tree::new(&points);
    let normal = vec![Vec3::Z; points.len()];
    let points = StarPoints { tree: &tree, normal: &normal, tips: &[], patch: None };
    let stars = complete(Stars::new(&points, &ByDirection));
    for i in 0..tree.len() {
        let p = tree.position[i];
        let is_inner = p.truncate().min_element() > 0.0 && p.truncate().max_element() < 10.0;
        assert_eq!(stars.is_open[i], !is_inner, "{p}");
        if is_inner {
            assert!(stars.of(i).all(|j| tree.position[j].distance(p) == 1.0), "{p}");
            assert_eq!(stars.valence(i), 4, "{p}");
            let range = stars.range(i);
            assert!(range.clone().all(|entry| stars.next(&range, entry).is_some()), "{p}");
        }
    }
}
