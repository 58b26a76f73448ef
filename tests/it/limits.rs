//! Surfaces that are limited by conditions, from the formula to the mesh with its rim.

use core::f64::consts::PI;
use glam::DVec3;
use marching_particles::{Bounds, Formula, FormulaErrorKind, Sample, Settings, sample};

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

#[test]
fn the_box_is_fitted_to_what_is_within_the_limits() {
    let sample = sampled("z = x^2 - y^2 {x^2 + y^2 < 1}", &Settings::with_count(1_000));
    let bounds = sample.bounds();
    for corner in [bounds.min, bounds.max] {
        assert!(corner.iter().all(|x| x.abs() < 1.5), "{bounds:?}");
    }
}

#[test]
fn a_sheet_within_limits_is_closed() {
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
