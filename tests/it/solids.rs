//! Solids made of the surface of a formula: closed by a box, and thickened to a shell.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::{Enclosure, Field, Frame, Piecewise, gallery};
use marching_particles::internal::slices::complete;

pub(crate) fn field(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

/// Points of a grid of 7 × 7 × 7 in a box.
pub(crate) fn grid(bounds: &Bounds) -> impl Iterator<Item = DVec3> {
    let (lo, size) = (bounds.lo(), bounds.size());
    (0..343).map(move |i| {
        let node = DVec3::new(f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49));
        lo + size * (node + DVec3::new(0.41, 0.37, 0.43)) / 7.0
    })
}

/// Checks that single precision, differences and bounds agree with the values of a field.
pub(crate) fn is_consistent(field: &Formula, bounds: &Bounds, what: &str) {
    let mut field = field.evaluator(Frame::default());
    for p in grid(bounds) {
        let (value, gradient) = field.value_and_gradient(p);
        let mut single = [0.0];
        field.values(&[p.as_vec3()], &mut single);
        assert!((f64::from(single[0]) - value).abs() < 1e-4 * (1.0 + value.abs()), "{what} at {p}");
        let h = 1e-6;
        for (axis, slope) in DVec3::AXES.into_iter().zip(gradient.to_array()) {
            let [ahead, behind] = [p + h * axis, p - h * axis].map(|q| field.value_and_gradient(q).0);
            let difference = (ahead - behind) / (2.0 * h);
            assert!(
                (difference - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                "{what} at {p}: {difference} {slope}"
            );
        }
        let mut known = [Enclosure::UNKNOWN];
        field.bounded().expect("a formula has bounds").enclose(
            0,
            &[Bounds::new(p - 0.01, p + 0.01)],
            &mut known,
        );
        assert!(known[0].value.holds(value), "{what} at {p}");
        let number = field.label(p);
        let branch = field.on(Some(number)).value_and_gradient(p);
        assert!((branch.0 - value).abs() < 1e-12 && (branch.1 - gradient).length() < 1e-9, "{what} at {p}");
    }
}

#[test]
fn a_box_closes_what_it_cuts() {
    let gyroid = gallery::find("gyroid").expect("the gallery has a gyroid");
    let bounds = Bounds { min: [-3.0, -2.0, -1.0], max: [2.0, 3.0, 2.5] };
    let (open, closed) = (gyroid.field(), gyroid.field().closed_by(&bounds));
    let around = Bounds::cube(4.0);
    for p in grid(&around) {
        let inside = open.value_and_gradient(p).0 <= 0.0 && bounds.holds(p);
        assert_eq!(closed.value_and_gradient(p).0 <= 0.0, inside, "{p}");
    }
    is_consistent(&closed, &around, "a closed gyroid");
    assert!(!complete(closed.pieces_in(&around, 0.05, 64)).0.is_empty());
    let mut evaluator = closed.evaluator(Frame::default());
    let listed = evaluator.labels_in(&Bounds::cube(0.5)).expect("few branches");
    assert_eq!(listed, [evaluator.label(DVec3::ZERO)]);
    assert!(open.facts().periods[0].is_some());
    assert_eq!((closed.facts().periods, closed.text()), ([None; 3], open.text()));
    // Another box takes the place of the first.
    let other = closed.clone().closed_by(&around);
    assert!(other.value_and_gradient(DVec3::splat(3.9)).0 < 3.0);
}

#[test]
fn a_closed_sphere_has_seven_patches() {
    let dice = field("x^2 + y^2 + z^2 - 1.2").closed_by(&Bounds::cube(1.0));
    let (cells, dice) = complete(dice.pieces_in(&Bounds::cube(1.2), 0.05, 64));
    assert!(!cells.is_empty());
    let mut dice = dice.evaluator(Frame::default());
    let faces = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let mut seen: Vec<u32> = faces.chain([DVec3::splat(0.63)]).map(|p| dice.label(p)).collect();
    seen.sort_unstable();
    assert_eq!(seen, [0, 1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_thickened_sphere_has_two_sheets() {
    let mut shell = field("x^2 + y^2 + z^2 = a").thickened(0.2);
    // |r² − a| = 0.1 · 2r
    for a in [1.0, 2.0] {
        shell.set_parameter("a", a).expect("a parameter");
        let [outer, inner] = [0.1, -0.1].map(|h| h + (a + 0.01_f64).sqrt());
        for direction in [DVec3::X, DVec3::new(0.6, 0.0, -0.8)] {
            for r in [outer, inner] {
                let (value, gradient) = shell.value_and_gradient(direction * r);
                assert!(value.abs() < 1e-14, "{value}");
                assert_eq!(gradient.dot(direction) > 0.0, r == outer);
            }
            assert!(shell.value_and_gradient(direction * a.sqrt()).0 < 0.0);
        }
    }
    assert!(complete(shell.pieces_in(&Bounds::cube(2.0), 0.05, 64)).0.is_empty());
    is_consistent(&shell, &Bounds::cube(1.6), "a shell");
}

#[test]
fn a_thickened_cube_is_a_cube_in_a_cube() {
    let shell = field("max(abs(3x), abs(y), -z - 1, z - 1, abs(y)) - 1 + 2 (0)").thickened(0.2);
    let sheet = |p: Vec3| shell.value_and_gradient(p.as_dvec3()).0;
    for (p, is_inside) in [
        (Vec3::new(0.0, 0.0, 0.0), false),
        (Vec3::new(0.0, 0.91, 0.0), true),
        (Vec3::new(0.0, 1.09, 0.0), true),
        (Vec3::new(0.0, 0.89, 0.0), false),
        (Vec3::new(0.0, 1.11, 0.0), false),
        // The faces across x have a gradient three times as long, and the same thickness.
        (Vec3::new(1.0 / 3.0 + 0.09, 0.0, 0.0), true),
        (Vec3::new(1.0 / 3.0 + 0.11, 0.0, 0.0), false),
        (Vec3::new(1.0 / 3.0 - 0.11, 0.0, 0.0), false),
        // The sheets meet in edges.
        (Vec3::new(1.0 / 3.0 + 0.09, 1.09, 2.09), true),
        (Vec3::new(1.0 / 3.0 + 0.09, 1.11, 2.0), false),
        (Vec3::new(1.0 / 3.0 - 0.11, 0.89, 1.89), false),
        (Vec3::new(1.0 / 3.0 - 0.09, 0.89, 1.89), true),
    ] {
        assert_eq!(sheet(p) <= 0.0, is_inside, "{p}");
    }
    is_consistent(&shell, &Bounds::cube(2.5), "a thickened cube");
    assert!(!complete(shell.pieces_in(&Bounds::cube(2.5), 0.05, 64)).0.is_empty());
}

#[test]
fn a_thickened_surface_is_closed_by_a_box() {
    let gyroid = gallery::find("gyroid").expect("the gallery has a gyroid");
    let bounds = Bounds::cube(2.0);
    let [part, other] =
        [gyroid.field().thickened(0.3).closed_by(&bounds), gyroid.field().closed_by(&bounds).thickened(0.3)];
    for p in grid(&Bounds::cube(2.2)) {
        let value = part.value_and_gradient(p).0;
        assert_eq!(value, other.value_and_gradient(p).0);
        assert!(bounds.holds(p) || value > 0.0);
    }
    is_consistent(&part, &Bounds::cube(2.2), "a gyroid to print");
    assert!(!complete(part.pieces_in(&Bounds::cube(2.2), 0.05, 64)).0.is_empty());
}

#[test]
fn a_thickened_octahedron_keeps_its_branches_across_the_planes_of_symmetry() {
    let shell = field("abs(x) + abs(y) + abs(z) - 1").thickened(0.1);
    let mut shell = shell.evaluator(Frame::default());
    for (size, is_inside) in [(1.0, true), (0.9, false), (1.1, false)] {
        let p = DVec3::new(0.5, 0.3, 0.2) * size;
        assert_eq!(shell.value_and_gradient(p).0 <= 0.0, is_inside, "{p}");
        let number = shell.label(p);
        let shell = shell.on(Some(number));
        let value = shell.value_and_gradient(p).0;
        // Along the plane of this branch, beyond its edges.
        for q in
            [p + DVec3::new(0.5, -0.5, 0.0), DVec3::new(0.0, p.x + p.y, p.z), p - DVec3::new(2.0, -1.0, -1.0)]
        {
            let (there, slope) = shell.value_and_gradient(q);
            assert!((there - value).abs() < 1e-15, "{q}: {there} {value}");
            assert!((slope.abs() - 1.0).length() < 1e-15, "{q}: {slope}");
        }
    }
}
