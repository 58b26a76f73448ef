//! The smooth branches of formulas: which one gives f where, which may in a box, and their values.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Sym3;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery::SURFACES;
use marching_particles::field::{Evaluator, Field, Frame, Piecewise};
use marching_particles::internal::slices::complete;
use proptest::prelude::*;
use std::sync::Arc;

fn field(text: &str) -> Formula {
    Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn at_work(field: &Formula) -> Box<dyn Evaluator + '_> {
    field.evaluator(Frame::default())
}

/// The field with its branches as they are in a box, and the cells of the box that may have
/// creases.
fn creased(field: &Formula, bounds: &Bounds) -> (Arc<dyn Piecewise>, Vec<Bounds>) {
    let (cells, field) = complete(field.pieces_in(bounds, 0.05, 64));
    (field, cells)
}

const CUBE: &str = "max(abs(x), abs(y), abs(z)) - 1";

/// Numbers of the branches at points of a grid, each once.
fn branches_of(field: &Formula) -> Vec<u32> {
    let mut field = at_work(field);
    let mut numbers: Vec<u32> = spread(&Bounds::cube(1.5)).map(|p| field.label(p)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Points of a grid of 9 × 9 × 9, off the planes of symmetry.
fn spread(bounds: &Bounds) -> impl Iterator<Item = DVec3> {
    let (lo, size) = (bounds.lo(), bounds.size());
    (0..729).map(move |i| {
        let node = DVec3::new(f64::from(i % 9), f64::from(i / 9 % 9), f64::from(i / 81));
        lo + size * (node + DVec3::new(0.41, 0.37, 0.43)) / 9.0
    })
}

/// f by every way of evaluating it at one point: single precision, then double.
fn values_of(field: &mut dyn Evaluator, p: Vec3) -> ([f32; 3], [f64; 3]) {
    let ([mut v], [mut w], [mut h]) = ([0.0], [0.0], [0.0]);
    let ([mut g], [mut second]) = ([Vec3::ZERO], [Sym3::splat(0.0)]);
    field.values(&[p], core::slice::from_mut(&mut v));
    field.gradients(&[p], core::slice::from_mut(&mut w), core::slice::from_mut(&mut g));
    field.hessians(
        &[p],
        core::slice::from_mut(&mut h),
        core::slice::from_mut(&mut g),
        core::slice::from_mut(&mut second),
    );
    let (mut exact, mut slope) = ([0.0], [DVec3::ZERO]);
    field.exact_gradients(&[p], &mut exact, &mut slope);
    let p = p.as_dvec3();
    ([v, w, h], [exact[0], field.value_and_gradient(p).0, field.jet(p).value])
}

#[test]
fn a_cube_has_six_linear_branches() {
    let cube = field(CUBE);
    assert_eq!(branches_of(&cube), [0, 1, 2, 3, 4, 5]);
    let faces = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    for (number, face) in (0..).zip(faces) {
        assert_eq!(at_work(&cube).label(face + DVec3::splat(0.1)), number, "{face}");
        // Far from the face, where other branches give f, and in every way of evaluating it.
        for p in [Vec3::ZERO, Vec3::new(-3.0, 8.0, 5.5), Vec3::new(2.0, -0.25, -9.0)] {
            let wanted = p.as_dvec3().dot(face) - 1.0;
            for double in [None, Some(1.0)] {
                let mut cube = cube.evaluator(Frame { double, ..Frame::default() });
                let (single, exact) = values_of(cube.on(Some(number)), p);
                let scaled = double.map_or(wanted, |_| libm::asinh(wanted)) as f32;
                assert_eq!((single, exact), ([scaled; 3], [wanted; 3]), "{face} at {p}");
            }
            let jet = at_work(&cube).on(Some(number)).jet(p.as_dvec3());
            assert_eq!((jet.gradient, jet.hessian), (face, Sym3::splat(0.0)), "{face} at {p}");
        }
    }
}

#[test]
fn a_box_has_the_branches_of_the_faces_that_meet_it() {
    let cube = field(CUBE);
    let mut cube = at_work(&cube);
    let around = |p: DVec3| Bounds::new(p - 0.1, p + 0.1);
    let [x, y, z] = DVec3::AXES.map(|axis| cube.label(axis));
    let mut listed = |p: DVec3| cube.labels_in(&around(p));
    assert_eq!(listed(DVec3::new(1.0, 0.3, 0.2)), Some(vec![x]));
    // Across the plane y = 0, where the branches of |y| have no zero.
    assert_eq!(listed(DVec3::new(1.0, 0.0, 0.2)), Some(vec![x]));
    assert_eq!(listed(DVec3::new(1.0, 1.0, 0.2)), Some(vec![x, y]));
    assert_eq!(listed(DVec3::ONE), Some(vec![x, y, z]));
    assert_eq!(listed(DVec3::new(0.5, 0.5, 0.5)), Some(vec![]));
    assert_eq!(listed(DVec3::new(1.5, 0.5, 0.5)), Some(vec![]));
    assert_eq!(cube.labels_in(&Bounds::cube(2.0)), Some(vec![0, 1, 2, 3, 4, 5]));
}

#[test]
fn a_box_at_a_tie_has_both_branches() {
    let slabs = field("abs(x) + y");
    let mut slabs = at_work(&slabs);
    assert_eq!(slabs.labels_in(&Bounds::new(DVec3::new(0.0, -1.0, 0.0), DVec3::ONE)), Some(vec![0, 1]));
    assert_eq!(slabs.labels_in(&Bounds::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::Y)), Some(vec![0, 1]));
    assert_eq!((slabs.label(DVec3::ZERO), slabs.label(-DVec3::X)), (0, 1));
}

/// The distance to a box, in whose formula operands change sides on the surface itself.
const DISTANCE: &str = "hypot(max(abs(x) - 1, 0), max(abs(y) - 1, 0), max(abs(z) - 1, 0))
    + min(max(abs(x) - 1, abs(y) - 1, abs(z) - 1), 0)";

#[test]
fn the_distance_to_a_box_has_the_zeros_of_its_faces_alone() {
    has_the_zeros_of_its_faces_alone(DISTANCE);
    has_the_zeros_of_its_faces_alone(&format!("-({DISTANCE})"));
}

fn has_the_zeros_of_its_faces_alone(text: &str) {
    let distance = field(text);
    let mut distance = at_work(&distance);
    let [x, y, z] = DVec3::AXES.map(|axis| distance.label(1.1 * axis));
    // The same function inside, outside, and where neither side is taken.
    for at in [0.9, 1.0] {
        assert_eq!(DVec3::AXES.map(|axis| distance.label(at * axis)), [x, y, z], "{at}");
    }
    let mut listed = |p: DVec3| distance.labels_in(&Bounds::new(p - 0.1, p + 0.1));
    assert_eq!(listed(DVec3::new(1.0, 0.3, 0.2)), Some(vec![x]));
    let mut edge = vec![x, y];
    edge.sort_unstable();
    assert_eq!(listed(DVec3::new(1.0, 1.0, 0.2)), Some(edge));
    let mut corner = vec![x, y, z];
    corner.sort_unstable();
    assert_eq!(listed(DVec3::ONE), Some(corner));
}

#[test]
fn too_many_branches_are_not_listed() {
    let waves = field("abs(x) + abs(y) + abs(z) + abs(x + y) + abs(y + z) + abs(z + x) + abs(x + y + z) = 1");
    let mut waves = at_work(&waves);
    assert_eq!(waves.labels_in(&Bounds::cube(1.0)), None);
    assert_eq!(waves.labels_in(&Bounds::new(DVec3::splat(0.05), DVec3::ONE)), Some(vec![0]));
}

#[test]
fn equal_functions_are_one_branch() {
    for (text, count) in [
        ("abs(x)^2 + y^2 + z^2 - 1", 1),
        ("abs(x)^p + abs(y)^p + z^2 - 1", 4),
        ("cos(abs(x)) + y^2 + z^2 - 1", 2),
        ("abs(x) + abs(-x) + y + z", 2),
        ("min((x - 1)^2 + y^2 + z^2, (x + 1)^2 + y^2 + z^2) - 1.2", 2),
        ("abs(x) + abs(y) + abs(z) - 1", 8),
        // The sign of y counts where |y| is taken, and nowhere else.
        ("max(x, min(z, abs(y))) - 0.5", 4),
        ("max(x, y, x) - 1", 2),
        ("sqrt(x^2) + y^2 + z^2 - 1", 2),
        ("hypot(x, 0) + sqrt((y - z)^4) + (z^2)^0.5 - 1", 4),
        ("(x^4)^0.25 + y + z", 2),
        ("sqrt(max(x, 0)^2 + max(y, 0)^2) - 0.5", 4),
        ("smin(x, y, 0) + z", 2),
        ("smin(x, y, 0.1) + z", 1),
        ("max(x, p) + y + z", 2),
        ("max(p, 2) x + y + z", 1),
        ("x^2 + y^2 + z^2 - 1", 1),
    ] {
        let field = Formula::as_written(text, &[]).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        let found = branches_of(&field);
        assert_eq!(found.len(), count, "{text}: {found:?}");
    }
}

#[test]
fn the_absolute_value_of_a_power_is_no_choice() {
    for p in [1.5, 3.0, 4.0] {
        let smooth = field("abs(x)^p + abs(y)^p + z^2 - 1").with("p", p).expect("a parameter");
        assert_eq!(branches_of(&smooth), [0], "{p}");
        let at = |x: f64| at_work(&smooth).on(Some(0)).value_and_gradient(DVec3::new(x, 0.5, 0.25)).0;
        assert_eq!(at(-0.75).to_bits(), at(0.75).to_bits(), "{p}");
    }
    assert_eq!(branches_of(&field("abs(x)^3 + y + z")), [0]);
}

#[test]
fn parameters_change_branches_and_not_their_numbers() {
    let cube = field("max(abs(x), abs(y), abs(z)) - a");
    let p = DVec3::new(0.5, -4.0, 0.5);
    assert_eq!(at_work(&cube).label(p), 3);
    assert_eq!(at_work(&cube).on(Some(3)).value_and_gradient(p).0, 3.0);
    let small = cube.clone().with("a", 0.25).expect("a parameter");
    assert_eq!(at_work(&small).label(p), 3);
    assert_eq!(values_of(at_work(&small).on(Some(3)), p.as_vec3()), ([3.75; 3], [3.75; 3]));
    assert_eq!(small.value_and_gradient(DVec3::splat(2.0)).0, 1.75);
    assert_eq!(at_work(&small).on(Some(3)).value_and_gradient(DVec3::splat(2.0)).0, -2.25);
    // The other one has not changed.
    assert_eq!(at_work(&cube).on(Some(3)).value_and_gradient(p).0, 3.0);
    // A blend that gets a width is no choice any more.
    let blend = field("smin(x, y, k) + z").with("k", 0.0).expect("a parameter");
    assert_eq!(branches_of(&blend), [0, 1]);
    let blend = blend.with("k", 1.0).expect("a parameter");
    assert_eq!(branches_of(&blend), [0]);
    let value = blend.value_and_gradient(DVec3::new(0.25, 0.25, 0.0)).0;
    assert!((value - (0.25 - 1.0 / 6.0)).abs() < 1e-15, "{value}");
}

#[test]
fn numbers_do_not_depend_on_what_was_asked_before() {
    let text = "max(abs(x) + abs(y), min(abs(z), x + y), abs(x - z)) - 1";
    let points: Vec<DVec3> = spread(&Bounds::cube(1.5)).collect();
    let (forward, backward) = (field(text), field(text));
    let (mut forward, mut backward) = (at_work(&forward), at_work(&backward));
    let numbers: Vec<u32> = points.iter().map(|&p| forward.label(p)).collect();
    let others: Vec<u32> = points.iter().rev().map(|&p| backward.label(p)).collect();
    assert!(numbers.iter().eq(others.iter().rev()));
    assert!(numbers.iter().max() > Some(&6));
}

#[test]
fn a_field_is_itself_beside_the_evaluators_of_its_branches() {
    let points: Vec<Vec3> = spread(&Bounds::cube(1.5)).map(|p| p.as_vec3()).collect();
    let (used, fresh) = (field(CUBE), field(CUBE));
    let (mut used, mut fresh) = (at_work(&used), at_work(&fresh));
    for p in points {
        let [of_branch, other] = [used.on(Some(4)).jet(DVec3::Z), used.on(Some(1)).jet(DVec3::Z)];
        assert_eq!((of_branch.value, other.value), (0.0, -1.0));
        assert_eq!(values_of(&mut *used, p), values_of(&mut *fresh, p), "{p}");
    }
}

#[test]
fn evaluators_on_several_threads_tell_the_same_branches() {
    let field = field("max(abs(x) + abs(y), min(abs(z), x + y), abs(x - z)) - 1");
    let numbers = |reverse: bool| {
        let mut evaluator = at_work(&field);
        let mut points: Vec<DVec3> = spread(&Bounds::cube(1.5)).collect();
        if reverse {
            points.reverse();
        }
        let mut numbers: Vec<u32> = points.into_iter().map(|p| evaluator.label(p)).collect();
        if reverse {
            numbers.reverse();
        }
        numbers
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> =
            [false, true, false, true].map(|reverse| scope.spawn(move || numbers(reverse))).into();
        let found: Vec<Vec<u32>> =
            threads.into_iter().map(|thread| thread.join().expect("numbers")).collect();
        assert!(found.iter().all(|own| *own == found[0]));
    });
}

#[test]
fn an_origin_counts_for_branches_too() {
    let cube = field(CUBE);
    let mut cube = cube.evaluator(Frame::around(DVec3::new(1.0, 1.0, 0.0)));
    assert_eq!(cube.label(DVec3::new(0.0, 0.1, 0.0)), 2);
    assert_eq!(cube.labels_in(&Bounds::cube(0.1)), Some(vec![0, 2]));
    assert_eq!(values_of(cube.on(Some(2)), Vec3::Y), ([1.0; 3], [1.0; 3]));
}

#[test]
fn the_branch_at_a_point_gives_the_value_of_the_gallery_there() {
    for surface in SURFACES.iter() {
        let field = surface.field();
        for p in spread(&surface.bounds) {
            agrees(&field, p, surface.id);
        }
    }
}

/// Checks that the branch at `p` has the value of f there and is among those of boxes around `p`,
/// if f is 0 in them.
fn agrees(field: &Formula, p: DVec3, text: &str) {
    let mut field = at_work(field);
    let wanted = field.value_and_gradient(p).0;
    let number = field.label(p);
    let value = field.on(Some(number)).value_and_gradient(p).0;
    let close = (value - wanted).abs() <= 1e-13 * (1.0 + wanted.abs());
    assert!(
        close || value.to_bits() == wanted.to_bits() || value.is_nan() && wanted.is_nan(),
        "{text} at {p}: {value} for {wanted}"
    );
    if wanted == 0.0 {
        // Wide enough for the rounding errors of f.
        let listed = field.labels_in(&Bounds::new(p - 1e-12, p + 1e-12));
        assert!(
            listed.as_ref().is_none_or(|listed| listed.contains(&number)),
            "{text} at {p}: {number} of {listed:?}"
        );
    }
}

/// Solids made of others by the operations of sets.
fn solids() -> impl Strategy<Value = String> {
    let number = || (-20_i32..20).prop_map(|n| f64::from(n) / 10.0);
    let leaf = prop_oneof![
        (number(), number(), number()).prop_map(|(a, b, c)| format!("hypot(x - {a}, y - {b}, z - {c}) - 1")),
        (number(), number(), number()).prop_map(|(a, b, c)| format!("{a}x + {b}y + {c}z - 0.5")),
        number().prop_map(|a| format!("x^2 + y^2 - z - {a}")),
        prop::sample::select(vec!["abs(x) - 1", "abs(y + 2z)", "sqrt(z^2)", "sin(3x) + cos(2y)"])
            .prop_map(str::to_owned),
    ];
    leaf.prop_recursive(5, 24, 3, move |inner| {
        let call = prop::sample::select(vec!["min", "max"]);
        prop_oneof![
            4 => (call, prop::collection::vec(inner.clone(), 2..4))
                .prop_map(|(name, solids)| format!("{name}({})", solids.join(", "))),
            2 => inner.clone().prop_map(|solid| format!("-({solid})")),
            1 => (inner.clone(), number()).prop_map(|(solid, a)| format!("({solid}) + {a}")),
            1 => inner.clone().prop_map(|solid| format!("abs({solid}) - 0.1")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a}) + ({b})")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("smin({a}, {b}, 0.2)")),
            1 => (inner.clone(), inner).prop_map(|(a, b)| format!("smin({a}, {b}, 0)")),
        ]
    })
}

proptest! {
    #![proptest_config(crate::cases::proptest(1000))]

    #[test]
    fn the_branch_at_a_point_gives_the_value_of_a_solid_there(
        text in solids(),
        points in prop::collection::vec([-2.0..2.0_f64, -2.0..2.0, -2.0..2.0], 20),
    ) {
        let Ok(field) = Formula::as_written(&text, &[]) else { return Ok(()) };
        for p in points.into_iter().map(DVec3::from_array) {
            agrees(&field, p, &text);
            // A point of the surface of another solid.
            let level = field.value_and_gradient(p).0;
            if let Ok(shifted) = Formula::as_written(&format!("{text} - ({level:?})"), &[]) {
                agrees(&shifted, p, &text);
            }
        }
    }
}

#[test]
fn the_branch_is_told_where_choices_tie() {
    for text in [
        "smin(min(-(abs(x) - 1), x^2 + y^2 - z), -(min(abs(x) - 1, hypot(x, y, z) - 1)), 0)",
        "min(abs(x) - 1, x^2 + y^2 - z)",
        "smin(min(abs(y + 2z), abs(y + 2z)), hypot(x, y, z) - 1 + 0.1, 0)",
    ] {
        let field = Formula::parse(text).expect("a formula");
        for p in [DVec3::ZERO, DVec3::Z * -1.338, DVec3::X * 0.27, DVec3::new(-1.54, 1.636, -1.771)] {
            agrees(&field, p, text);
        }
    }
}

#[test]
fn the_surfaces_of_the_gallery_have_no_creases() {
    for surface in SURFACES.iter() {
        let (field, cells) = creased(&surface.field(), &surface.bounds);
        assert!(cells.is_empty(), "{}", surface.id);
        let mut field = field.evaluator(Frame::default());
        assert!(spread(&surface.bounds).all(|p| field.label(p) == 0), "{}", surface.id);
        let p = Vec3::new(0.3, 0.2, 0.1);
        assert_eq!(
            format!("{:?}", values_of(field.on(Some(0)), p)),
            format!("{:?}", values_of(&mut *at_work(&surface.field()), p))
        );
    }
}

#[test]
fn choices_that_meet_smoothly_are_no_creases() {
    // A blend by hand, a rounded box, two spheres that stay apart, an edge outside the box, an edge
    // of half a degree.
    for text in [
        "min(x, y) - max(0.5 - abs(x - y), 0)^2/2 + 0.3",
        "sqrt(max(abs(x) - 0.7, 0)^2 + max(abs(y) - 0.7, 0)^2 + max(abs(z) - 0.7, 0)^2) + min(max(abs(x), abs(y), abs(z)) - 0.7, 0) - 0.2",
        "min((x - 1)^2 + y^2 + z^2, (x + 1)^2 + y^2 + z^2) - 0.9",
        "max(x - 3, y) - 0.2",
        "x x abs(x) + y + z",
        "abs(x) + 200 y",
    ] {
        let (field, cells) = creased(&field(text), &Bounds::cube(1.6));
        assert!(cells.is_empty(), "{text}");
        let mut field = field.evaluator(Frame::default());
        assert!(spread(&Bounds::cube(1.5)).all(|p| field.label(p) == 0), "{text}");
    }
}

#[test]
fn creases_are_found_whatever_their_size_and_place() {
    for (text, count) in [
        (CUBE, 6),
        ("max(abs(x - 0.777), abs(y - 0.3), abs(z + 0.41)) - 0.02", 6),
        ("abs(x) + abs(y) + abs(z) - 1", 8),
        ("min(hypot(x - 0.5, y, z), hypot(x + 0.5, y, z)) - 0.8", 2),
        ("max(hypot(x, y) - 0.5, abs(z) - 1)", 3),
        // A rounded box with a hole: the choices within the box make no creases.
        ("max(smax(smax(abs(x), abs(y), 0.3), abs(z), 0.3) - 1, 0.4 - hypot(x, y))", 2),
        ("hypot(x, y, z) - 1 + 0.1 abs(x + y - 0.2)", 2),
        // The choice counts by itself where it does not through the other one.
        ("z/4 + max(x, y) + max(max(x, y), 8) - 8", 2),
    ] {
        let (field, cells) = creased(&field(text), &Bounds::cube(1.6));
        assert!(!cells.is_empty(), "{text}");
        let mut evaluator = field.evaluator(Frame::default());
        let mut seen: Vec<u32> = on_surface(&*field).into_iter().map(|p| evaluator.label(p)).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), count, "{text}: {seen:?}");
    }
}

#[test]
fn both_sides_of_a_face_of_an_exact_distance_are_one_branch() {
    let squares = ["x", "y", "z"].map(|axis| format!("max(abs({axis}) - 0.7, 0)^2")).join(" + ");
    let distance = field(&format!("sqrt({squares}) + min(max(abs(x), abs(y), abs(z)) - 0.7, 0)"));
    let (field, cells) = creased(&distance, &Bounds::cube(1.6));
    assert!(!cells.is_empty());
    let mut field = field.evaluator(Frame::default());
    for face in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
        let [inside, outside] = [0.69, 0.71].map(|at| at * face + 0.1 * (DVec3::ONE - face.abs()));
        assert_eq!(field.label(inside), field.label(outside), "{face}");
        let branch = field.label(inside);
        let far = DVec3::new(3.0, -5.0, 2.5);
        let value = field.on(Some(branch)).value_and_gradient(far).0;
        assert!((value - (far.dot(face) - 0.7)).abs() < 1e-15, "{face}");
    }
}

/// Points of the surface, by steps along the gradient from those of a grid.
fn on_surface(field: &dyn Field) -> Vec<DVec3> {
    let mut found = Vec::new();
    for mut p in spread(&Bounds::cube(1.6)) {
        for _ in 0..30 {
            let (value, gradient) = field.value_and_gradient(p);
            if value.abs() < 1e-12 {
                break;
            }
            p -= gradient * (value / gradient.length_squared());
        }
        if field.value_and_gradient(p).0.abs() < 1e-9 {
            found.push(p);
        }
    }
    found
}
