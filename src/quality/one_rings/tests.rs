use super::super::creases::CreaseRows;
use super::super::probe::crossings;
use super::super::triangles::Triangles;
use super::*;
use crate::field::formula::Formula;
use crate::field::{Field, Frame};
use crate::math::Bounds;
use crate::slices::complete;
use std::collections::BTreeMap;

/// The natural neighbours of point `i`, by looking at all points: the cell is cut by the bisector
/// of each of the nearest on the sheet, corner by corner, and none is left out early.
fn naive(sheets: &Sheets, i: usize) -> Vec<usize> {
    let Sheets { tree, normal, .. } = *sheets;
    let p = tree.position[i];
    let mut all: Vec<(f32, usize)> = (0..tree.len())
        .map(|j| ((tree.position[j] - p).length_squared(), j))
        .filter(|&(distance_sq, j)| j != i && is_one_sheet(sheets, i, j, distance_sq))
        .collect();
    all.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    all.truncate(MOST_POINTS);
    let farthest_sq = f64::from(all.last().expect("a point").0);
    let half = if all.len() == MOST_POINTS { farthest_sq } else { farthest_sq * 1e6 }.sqrt();
    // Corners, and the point behind the edge that begins at each.
    let mut cell: Vec<(DVec2, Option<usize>)> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| (half * DVec2::new(x, y), None))
        .into();
    let (u, v) = tangent_frame(normal[i]);
    for (_, j) in all {
        let offset = (tree.position[j] - p).as_dvec3();
        let flat = DVec2::new(offset.dot(u.as_dvec3()), offset.dot(v.as_dvec3()));
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
fn turned(mut cycle: Vec<usize>) -> Vec<usize> {
    let least = (0..cycle.len()).min_by_key(|&k| cycle[k]).unwrap_or(0);
    cycle.rotate_left(least);
    cycle
}

#[test]
fn rings_and_triangles_are_those_found_by_looking_at_all_points() {
    for (text, half) in [
        ("x^2 + 2y^2 + 3z^2 = 1", 1.2),
        ("(x^2 + y^2 + z^2 + 0.5)^2 = 3.2 (x^2 + y^2)", 1.6),
        ("sin(3x) cos(3y) + sin(3y) cos(3z) + sin(3z) cos(3x)", 1.0),
        ("z = 0.3 sin(2x) cos(2y)", 1.0),
    ] {
        let field = Formula::as_written(text, &[]).expect("a formula");
        let field = &mut *field.evaluator(Frame::default());
        let points = complete(crossings(field, &Bounds::cube(half)));
        assert!(points.len() > 900, "{text}: {}", points.len());
        let tree = Tree::new(&points[..900]);
        let gradient = |p: &Vec3| field.value_and_gradient(p.as_dvec3()).1.normalize_or_zero().as_vec3();
        let normal: Vec<Vec3> = tree.position.iter().map(gradient).collect();
        let (height, creases) = (vec![0.0; tree.len()], CreaseRows::default());
        let sheets = Sheets { tree: &tree, normal: &normal, height: &height, creases: &creases };
        let rings = complete(OneRings::new(&sheets, field));
        let mut open = 0;
        // How many corners see each triangle, by its smallest corner first.
        let mut seen: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        for i in 0..tree.len() {
            let found: Vec<usize> = rings.of(i).collect();
            assert_eq!(turned(found), turned(naive(&sheets, i)), "{text}, point {i}");
            let to_another =
                |j: usize| if j == i { f32::INFINITY } else { tree.position[j].distance(tree.position[i]) };
            let nearest = (0..tree.len()).map(to_another).fold(f32::INFINITY, f32::min);
            assert_eq!(rings.nearest[i], nearest, "{text}, point {i}");
            open += usize::from(!rings.closed[i]);
            for (a, b) in rings.pairs(i) {
                let mut triangle = vec![i, a, b];
                triangle.sort_unstable();
                *seen.entry(triangle).or_default() += 1;
            }
        }
        // The border of an open surface has cells that nothing closes.
        assert_eq!(open > 20, half == 1.0, "{text}: {open} open");
        let triangles = complete(Triangles::new(&rings));
        for (list, corners) in [(&triangles.unanimous, 3), (&triangles.majority, 2), (&triangles.single, 1)] {
            let mut list: Vec<Vec<usize>> = list.iter().map(|t| t.map(|i| i as usize).to_vec()).collect();
            list.iter_mut().for_each(|triangle| triangle.sort_unstable());
            list.sort_unstable();
            let expected = seen.iter().filter(|(_, count)| **count == corners);
            assert!(list.iter().eq(expected.map(|(triangle, _)| triangle)), "{text}: seen by {corners}");
        }
    }
}
