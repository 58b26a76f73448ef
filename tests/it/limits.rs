//! Surfaces that are limited by conditions, from the formula to the mesh with its rim.

use core::f64::consts::{FRAC_PI_2, PI};
use glam::DVec3;
use marching_particles::field::formula::FormulaErrorKind;
use marching_particles::{Bounds, Field, Formula, Sample, Settings, sample};

fn sampled(text: &str, settings: &Settings) -> Sample {
    sample(Formula::parse(text).expect("a formula"), settings).expect("a sample")
}

/// A surface with a function that is at most 0 within its limits, and its area, if it is known.
struct Limited {
    formula: &'static str,
    beyond: fn(DVec3) -> f64,
    area: Option<f64>,
    /// Components, Euler number and borders.
    topology: [i64; 3],
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_surface_ends_at_its_limits_with_particles_on_the_rim() {
    let cases = [
        Limited {
            formula: "x^2 + y^2 + z^2 = 1 {z < 0.5}",
            beyond: |p| p.z - 0.5,
            area: Some(3.0 * PI),
            topology: [1, 1, 1],
        },
        Limited {
            formula: "x^2 + y^2 = 1 {-1 < z <= 2}",
            beyond: |p| (p.z - 2.0).max(-1.0 - p.z),
            area: Some(6.0 * PI),
            topology: [1, 0, 2],
        },
        Limited {
            formula: "z = x^2 - y^2 {x^2 + y^2 < 1}",
            beyond: |p| p.truncate().length() - 1.0,
            // ∫ √(1 + 4r²) over the disc.
            area: Some(PI / 6.0 * (125.0_f64.sqrt() - 1.0)),
            topology: [1, 1, 1],
        },
        // A corner of the rim, and conditions of which one is enough.
        Limited {
            formula: "x^2 + y^2 + z^2 = 1 {z < 0.5, x < 0.5}",
            beyond: |p| (p.z - 0.5).max(p.x - 0.5),
            area: None,
            topology: [1, 1, 1],
        },
        Limited {
            formula: "x^2 + y^2 + z^2 = 1 {z < -0.5 or z > 0.5}",
            beyond: |p| (p.z + 0.5).min(0.5 - p.z),
            area: Some(2.0 * PI),
            topology: [2, 2, 2],
        },
        // Edges of the surface itself run to its rim.
        Limited {
            formula: "max(abs(x), abs(y), abs(z)) = 1 {x + y + z < 1}",
            beyond: |p| p.x + p.y + p.z - 1.0,
            area: None,
            topology: [1, 1, 1],
        },
        // What ends where its function has no value: a root, one in another, another power, an
        // arccosine.
        Limited {
            formula: "z = sqrt(1 - x^2 - y^2)",
            beyond: |p| -p.z,
            area: Some(2.0 * PI),
            topology: [1, 1, 1],
        },
        Limited {
            formula: "z = sqrt(1 - sqrt(x^2 + y^2 - 0.1))",
            beyond: |p| (-p.z).max(0.1_f64.sqrt() - p.truncate().length()),
            area: None,
            topology: [1, 0, 2],
        },
        Limited {
            formula: "y = z^2 - x^1.5 {abs(y) < 2, abs(z) < 1}",
            beyond: |p| -p.x,
            area: None,
            topology: [1, 1, 1],
        },
        Limited {
            formula: "2 - z = 2 acos(x^2 + y^2)",
            beyond: |p| (p.z - 2.0).max(p.truncate().length() - 1.0),
            area: None,
            topology: [1, 1, 1],
        },
        // The limits are beyond the surface.
        Limited {
            formula: "x^2 + y^2 + z^2 = 1 {x^2 + y^2 + z^2 < 4}",
            beyond: |p| p.length() - 2.0,
            area: Some(4.0 * PI),
            topology: [1, 2, 0],
        },
    ];
    for Limited { formula, beyond, area, topology } in cases {
        for settings in [Settings::with_count(4_000), Settings::with_count(4_000).refined()] {
            let what = format!("{formula}, {:?}", settings.method);
            let sample = sampled(formula, &settings);
            let farthest = (0..sample.particles().len())
                .map(|i| beyond(sample.particles().place(i)))
                .fold(f64::MIN, f64::max);
            assert!(farthest < 1e-5, "{what}: a particle {farthest} beyond");
            let mesh = sample.mesh();
            assert!(mesh.unfilled.is_empty() && mesh.left_out.is_empty(), "{what}");
            let mesh = &mesh.topology;
            let found = [mesh.components.len() as i64, mesh.euler(), mesh.borders.len() as i64];
            assert_eq!(found, topology, "{what}");
            let codes: Vec<_> = sample.report().warnings.iter().map(|warning| warning.code()).collect();
            assert!(!codes.contains(&"open") && !codes.contains(&"beyond"), "{what}: {codes:?}");
            let figures = sample.report().measures.quality.as_ref().expect("figures");
            if let Some(exact) = area {
                assert!((figures.area / exact - 1.0).abs() < 0.005, "{what}: area {}", figures.area);
            }
        }
    }
}

/// Area of the half ellipsoid z = a √(1 − x² − y²): the integral for a surface of revolution, over
/// the angle, by Simpson's rule.
fn half_ellipsoid(a: f64) -> f64 {
    let parts = 1_000;
    let integrand = |k: i32| {
        let (sine, cosine) = libm::sincos(f64::from(k) * FRAC_PI_2 / f64::from(parts));
        let weight = if k == 0 || k == parts { 1.0 } else { f64::from(2 + k % 2 * 2) };
        weight * sine * (cosine * cosine + a * a * sine * sine).sqrt()
    };
    2.0 * PI * (0..=parts).map(integrand).sum::<f64>() * FRAC_PI_2 / f64::from(parts) / 3.0
}

#[test]
fn a_parameter_as_the_factor_of_a_root_leaves_the_rim_clean_for_any_value() {
    let settings = Settings::with_count(4_000).refined();
    for (text, share) in [
        ("z = a sqrt(1 - x^2 - y^2)", 1.0),
        ("z = -a sqrt(1 - x^2 - y^2)", 1.0),
        ("z = sqrt(1 - x^2 - y^2)*a/2", 0.5),
        ("z/a = sqrt(1 - x^2 - y^2)", 1.0),
        ("z = (a + 1) sqrt(1 - x^2 - y^2) {x^2 + y^2 + z^2 < 100}", f64::NAN),
    ] {
        let mut formula = Formula::parse(text).expect("a formula");
        for a in [2.0, 0.5, -1.5] {
            formula.set_parameter("a", a).expect("a parameter");
            let height = if share.is_nan() { a + 1.0 } else { share * a };
            let sample = sample(formula.clone(), &settings).expect("a sample");
            let what = format!("{text}, a = {a}");
            // Of a surface within limits it is not proven that all components were found.
            let warnings = &sample.report().warnings;
            assert!(warnings.iter().all(|warning| warning.code() == "unproven"), "{what}: {warnings:?}");
            assert_eq!(sample.report().proof.creases, Some(1), "{what}");
            let topology = &sample.mesh().topology;
            assert_eq!((topology.euler(), topology.borders.len()), (1, 1), "{what}");
            let figures = sample.report().measures.quality.as_ref().expect("figures");
            let exact = half_ellipsoid(height);
            assert!((figures.area / exact - 1.0).abs() < 0.005, "{what}: {} for {exact}", figures.area);
        }
    }
}

#[test]
fn a_function_without_its_root_has_the_sign_of_the_formula() {
    for text in [
        "z = a sqrt(1 - x^2 - y^2)",
        "a sqrt(1 - x^2 - y^2) = z",
        "a*(1 - x^2 - y^2)^(1/3) = z",
        "z = a asin(x^2 + y^2)",
        "z = a acos(x^2 + y^2)",
        "z^2 = a sqrt(x)",
    ] {
        for a in [1.0, 1.5, -1.5] {
            let [own, written] = [Formula::parse(text), Formula::as_written(text, &[])]
                .map(|formula| formula.and_then(|formula| formula.with("a", a)).expect("a formula"));
            let mut compared = 0;
            for k in 1..1_000 {
                // Places of a sequence of low discrepancy, above or below the plane z = 0 as the
                // surface is: elsewhere the limits are what counts.
                let [x, y, z] = [0.819, 0.671, 0.5497].map(|share| (f64::from(k) * share).fract());
                let p = DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 1.5 * z * a.signum());
                let [(f, _), (g, _)] = [&own, &written].map(|field| field.value_and_gradient(p));
                if g.is_finite() && g != 0.0 {
                    compared += 1;
                    assert!(f * g > 0.0, "{text}, a = {a}, at {p}: {f} for {g}");
                }
            }
            assert!(compared > 100, "{text}, a = {a}: {compared} places");
        }
    }
}

#[test]
fn a_surface_that_is_even_in_the_rest_ends_nowhere() {
    for (text, topology) in [
        ("z^2 = sqrt(x)", [1, 1]),
        ("abs(z) = sqrt(x)", [1, 1]),
        ("z^2 + y^2 = sqrt(x)", [1, 1]),
        ("z^2 + y^2 = sqrt(1 - x^2)", [2, 0]),
        ("z^2 = a sqrt(x)", [1, 1]),
    ] {
        let sample = sampled(text, &Settings::with_count(4_000).refined());
        assert_eq!(sample.report().proof.undecided_cells, Some(0), "{text}");
        let mesh = &sample.mesh().topology;
        assert_eq!([mesh.euler(), mesh.borders.len() as i64], topology, "{text}");
        let codes: Vec<_> = sample.report().warnings.iter().map(|warning| warning.code()).collect();
        assert!(sample.report().growth.refined_levels.is_some(), "{text}: {codes:?}");
    }
    // A root that is as large as a number is left: its surface does not reach the end.
    let formula = Formula::parse("sqrt(x^2 + y^2 + z^2 - x) = 1").expect("a formula");
    assert_eq!(formula.value_and_gradient(DVec3::new(0.0, 3.0, 0.0)).0, 2.0);
}

#[test]
fn a_slider_passes_zero_where_the_surface_is_a_disc() {
    let mut formula = Formula::parse("z = a sqrt(1 - x^2 - y^2)").expect("a formula");
    for a in [0.5, 0.0, -0.5, 0.0, 0.5] {
        formula.set_parameter("a", a).expect("a parameter");
        let sample = sample(formula.clone(), &Settings::with_count(2_000)).expect("a sample");
        let topology = &sample.mesh().topology;
        assert_eq!((topology.euler(), topology.borders.len()), (1, 1), "a = {a}");
        let area = sample.report().measures.quality.as_ref().expect("figures").area;
        let exact = if a == 0.0 { PI } else { half_ellipsoid(a) };
        assert!((area / exact - 1.0).abs() < 0.01, "a = {a}: {area} for {exact}");
        let heights = (0..sample.particles().len()).map(|i| sample.particles().place(i).z);
        let (least, most) = heights.fold((0.0_f64, 0.0_f64), |(l, m), z| (l.min(z), m.max(z)));
        assert!((least - a.min(0.0)).abs() < 0.01 && (most - a.max(0.0)).abs() < 0.01, "{least} to {most}");
    }
}

#[test]
fn the_box_is_fitted_to_what_is_within_the_limits() {
    let sample = sampled("z = x^2 - y^2 {x^2 + y^2 < 1}", &Settings::with_count(1_000));
    let bounds = sample.bounds();
    for corner in [bounds.min, bounds.max] {
        assert!(corner.iter().all(|x| x.abs() < 1.5), "{bounds:?}");
    }
}

#[test]
fn a_shell_within_limits_is_closed() {
    let disc = Formula::parse("z = 0 {x^2 + y^2 < 1}").expect("a formula").thickened(0.2);
    let sample = sample(disc, &Settings::with_count(4_000)).expect("a sample");
    let volume = sample.volume().expect("a closed mesh");
    assert!((volume / (0.2 * PI) - 1.0).abs() < 0.005, "{volume}");
}

#[test]
fn limits_that_leave_nothing_are_named() {
    let formula = Formula::parse("x^2 + y^2 + z^2 = 1 {x^2 + y^2 + z^2 < 0.25}").expect("a formula");
    let settings = settings!(bounds: Some(Bounds::cube(2.0)); ..Settings::with_count(1_000));
    let error = sample(formula, &settings).expect_err("no surface");
    assert!(error.to_string().contains("within its limits"), "{error}");
}

#[test]
fn conditions_in_braces_are_read_and_written() {
    for (text, normal) in [
        ("z = x y {x < 1}", "z = x*y {x < 1}"),
        ("z = x*y{x<1,y>0}{z>=a}", "z = x*y {x < 1, y > 0, z >= a}"),
        ("{x + 1}^2 + y^2 {-1 < z < 1 or x > 0}", "(x + 1)^2 + y^2 {-1 < z and z < 1 or x > 0}"),
    ] {
        let formula = Formula::as_written(text, &[]).expect(text);
        assert_eq!(formula.normal_form(), normal, "{text}");
        let again = Formula::as_written(normal, &[]).expect(normal);
        assert!(again.same_tree(&formula), "{text}");
    }
    // A parameter of a limit is one of the formula.
    let formula = Formula::parse("z = 0 {x^2 + y^2 < r^2}").expect("a formula");
    assert_eq!(formula.auto(), ["r"]);
    for (text, kind, span) in [
        ("z {x < 1} = 0", FormulaErrorKind::UnexpectedSymbol, 10..11),
        ("z = 0 {x < 1", FormulaErrorKind::UnexpectedEnd, 12..12),
        ("z = 0 {x < 1, y}", FormulaErrorKind::UnexpectedSymbol, 14..15),
    ] {
        let error = Formula::parse(text).expect_err(text);
        assert_eq!((error.kind, error.span.clone()), (kind, span), "{text}: {error}");
    }
}
