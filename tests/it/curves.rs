//! Zero sets that are no surface, boxes that are found around surfaces, and a search of corners
//! that ends.

use glam::DVec3;
use marching_particles::field::FnField;
use marching_particles::mesh::Topology;
use marching_particles::{Bounds, Error, Formula, Run, Settings, StopReason, Warning, sample};

fn formula(text: &str) -> Formula {
    Formula::parse(text).expect("a formula")
}

#[test]
fn a_curve_or_a_point_is_refused_whatever_the_count() {
    for text in [
        "hypot(hypot(x, y) - 1, z) = 0",
        "(x^2 + y^2 - 1)^2 + z^2 = 0",
        "(x^2 + y^2 - 1)^2 + (z - x)^2 = 0",
        "abs(x) + abs(y) = 0",
        "x^2 + y^2 = 0",
        "x^2 + y^2 + z^2 = 0",
    ] {
        for count in [500, 8_000] {
            let settings = Settings::with_count(count).in_box(Bounds::cube(2.1));
            let error = sample(formula(text), &settings).expect_err(text).to_string();
            assert!(error.contains("only on a curve or at a point"), "{text}, {count}: {error}");
        }
    }
}

#[test]
fn the_advised_level_has_a_surface_that_shows() {
    for text in [
        "(x^2 + y^2 - 1)^2 + z^2",
        "(x^2 + y^2 - 1)^2 + 40*(z - x)^2",
        "abs(x) + abs(y)",
        "-50*x^2 - 80*y^2",
        "x^2 + y^2 + z^2",
    ] {
        let settings = Settings::with_count(500).in_box(Bounds::cube(2.1));
        let error = sample(formula(text), &settings).expect_err(text).to_string();
        let (_, rest) = error.split_once("such as ").expect("advice");
        let (level, _) = rest.split_once(':').expect("a number");
        let around = sample(formula(&format!("{text} = {level}")), &settings);
        let around = around.unwrap_or_else(|error| panic!("{text} = {level}: {error}"));
        let (low, high) = around
            .particles()
            .local
            .iter()
            .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let thinnest = (high - low).min_element();
        assert!(thinnest > 0.1 * 4.2, "{text} = {level}: {thinnest} wide");
    }
}

#[test]
fn a_curve_beside_a_surface_is_left_out_and_told() {
    let text = "((x^2 + y^2 - 1)^2 + z^2)*(x^2 + y^2 + z^2 - 4) = 0";
    let sample = sample(formula(text), &Settings::with_count(1_000)).expect("a sample");
    let off = |p: &glam::Vec3| (p.length() - 2.0).abs();
    assert!(sample.particles().local.iter().all(|p| off(p) < 1e-3));
    let warnings = &sample.report().warnings;
    assert!(warnings.iter().any(|warning| matches!(warning, Warning::Bare { .. })), "{warnings:?}");
}

#[test]
fn a_surface_that_touches_zero_is_no_curve() {
    for text in ["(x^2 + y^2 + z^2 - 1)^2 = 0", "abs(z - x^2) = 0", "x^2 + y^2 = 0.01"] {
        let settings = Settings::with_count(500).in_box(Bounds::cube(1.5));
        let sample = sample(formula(text), &settings).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(sample.report().count > 400, "{text}: {}", sample.report().count);
    }
}

#[test]
fn the_box_around_a_product_of_factors_holds_all_of_it() {
    for (text, components) in [
        ("x^3*(x - 2) + y^2 + z^2 = 1", 1),
        ("x*(x - 1)*(x - 2)*(x - 3) + y^2 + z^2 = 0", 2),
        ("(y + 1)^3*(y - 1)*y^2 + x^2 + z^2 = 1", 1),
    ] {
        let count = Settings::with_count(1_000);
        let [fitted, given] = [count, count.in_box(Bounds::cube(4.0))].map(|settings| {
            sample(formula(text), &settings).unwrap_or_else(|error| panic!("{text}: {error}"))
        });
        let [found, known] = [&fitted, &given].map(|sample| sample.report().proof.components);
        assert_eq!((found, known), (components, components), "{text}");
        let [a, b] = [&fitted, &given].map(|sample| sample.volume().expect("a closed mesh"));
        assert!((a / b - 1.0).abs() < 0.02, "{text}: {a} and {b}");
    }
}

#[test]
fn a_solid_whose_edges_meet_in_points_of_contact_ends() {
    let quintic = "64(x - 1)(x^4 - 4x^3 - 10x^2 y^2 - 4x^2 + 16x - 20x y^2 + 5y^4 + 16 - 20y^2) \
        - 5sqrt(5 - sqrt(5))(2z - sqrt(5 - sqrt(5)))(4(x^2 + y^2 - z^2) + 1 + 3sqrt(5))^2";
    let solid = formula(&format!("max({quintic}, x^2 + y^2 + z^2 - 4.8^2)"));
    let sample = sample(solid, &Settings::with_count(1_000)).expect("a sample");
    assert!(sample.report().count > 500);
}

#[test]
fn the_tip_of_a_cone_is_no_lack_of_digits() {
    let bounds = Bounds { min: [-1.0, -2.0, -2.0], max: [3.0, 2.0, 2.0] };
    let settings = Settings::with_count(1_000).in_box(bounds);
    let sample = sample(formula("x^2 - 2x + 1 + y^2 - z^2 = 0"), &settings).expect("a sample");
    let warnings = &sample.report().warnings;
    assert!(!warnings.iter().any(|warning| matches!(warning, Warning::Digits { .. })), "{warnings:?}");
}

#[test]
fn a_field_without_a_value_is_told_so() {
    let nowhere = FnField::new(|_: DVec3| f64::NAN);
    let error = sample(nowhere, &Settings::with_count(100)).expect_err("no value").to_string();
    assert!(error.contains("no value"), "{error}");
    let half = FnField::new(|p: DVec3| if p.x > 0.0 { 1.0 } else { f64::NAN });
    let error = sample(half, &Settings::with_count(100)).expect_err("one sign").to_string();
    assert!(error.contains("at which it has a value"), "{error}");
}

#[test]
fn a_box_that_nobody_gave_is_not_to_be_moved() {
    let error = sample(formula("x^2 + y^2 + z^2 + 1 = 0"), &Settings::with_count(100));
    let Err(Error::Nothing { message, .. }) = error else { panic!("{error:?}") };
    assert!(!message.contains("Enlarge or move the box"), "{message}");
}

#[test]
fn a_mesh_without_triangles_is_not_closed() {
    assert!(!Topology::new(&[], 0).is_closed());
    let mut run = Run::start(formula("x^2 + y^2 + z^2 = 1"), &Settings::with_count(100)).expect("a run");
    assert_ne!(run.cancel().stop_reason, Some(StopReason::Complete));
    while run.join(u32::MAX).is_none() {}
    assert!(!run.mesh().expect("a mesh").topology.is_closed());
}
