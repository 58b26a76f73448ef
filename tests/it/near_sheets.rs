//! Tests that sheets of the surface very near each other are told apart, or that the report says
//! that they are not; and that it explains figures of the sample that are not those of the surface.

use crate::runs::{finished, session};
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::sampler::{Doubt, Sampling, Search, Settings, SizeMode};
use marching_particles::{Report, Run};

fn says(report: &Report, words: &str) -> bool {
    report.warnings.iter().any(|warning| warning.to_string().contains(words))
}

/// Particles of this radius in a cube of half-width `half`.
fn of_radius(radius: f64, half: f64) -> Settings {
    settings!(radius_share: radius / (2.0 * half * 3.0_f64.sqrt()); ..Settings::default())
}

/// Particles of half to one and a half times this radius, by the curvature, in a cube of half-width
/// `half`.
fn adaptive(radius: f64, half: f64) -> Settings {
    let share = of_radius(radius, half).radius_share;
    settings!(sampling: Sampling::Adaptive,
        radius_min_share: 0.5 * share,
        radius_max_share: 1.5 * share,
        chord_error: 6e-4; ..Settings::default())
}

/// Concentric spheres about the unit sphere, and planes, at equal distances; with the number of
/// components and the Euler number.
fn layers(gap: f64) -> [(String, usize, i64); 4] {
    let spheres = |count: u32| {
        let factor = |k: u32| format!("(x^2+y^2+z^2-(1+{k}*{gap})^2)");
        (0..count).map(factor).collect::<Vec<String>>().join("*")
    };
    let planes = format!("z*(z-{gap})*(z-2*{gap})");
    [(spheres(2), 2, 4), (spheres(3), 3, 6), (planes, 3, 3), (format!("(z-0.3)*(z-0.3-{gap})"), 2, 2)]
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn sheets_as_near_as_single_precision_tells_apart_are_sampled_each() {
    for (gap, settings) in [
        (1e-5, of_radius(0.1, 1.5)),
        (6e-6, of_radius(0.1, 1.5)),
        (6e-6, of_radius(0.06, 1.5)),
        (2e-5, adaptive(0.1, 1.5)),
    ] {
        for (formula, components, euler) in layers(gap) {
            let (_, report) = finished(&formula, Bounds::cube(1.5), &settings);
            let context = format!("{formula}, {:?}: {:?}", settings.sampling, report.warnings);
            assert_eq!(report.proof.search, Search::Proven, "{context}");
            assert_eq!(report.proof.components, components, "{context}");
            assert_eq!(report.proof.singular_points, Some(0), "{context}");
            assert_eq!(report.measures.quality.map(|q| q.connectivity.euler), Some(euler), "{context}");
            assert!(!says(&report, "without changing its sign"), "{context}");
        }
    }
}

#[test]
fn the_area_of_two_near_sheets_is_that_of_both() {
    // Nearer to each other than the nodes of the survey's grid, so that no two neighbouring nodes
    // differ in sign.
    let planes = |gap: f64| format!("(z-0.31-0.2*x)*(z-0.31-{gap}-0.2*x)");
    let spheres = |gap: f64| format!("(x^2+y^2+z^2-1)*(x^2+y^2+z^2-(1+{gap})^2)");
    for gap in [0.02, 1e-3, 1e-4] {
        for (formula, area) in
            [(planes(gap), 18.0 * 1.04_f64.sqrt()), (spheres(gap), 8.0 * core::f64::consts::PI * (1.0 + gap))]
        {
            let mut field =
                Formula::as_written(&formula, &[]).unwrap_or_else(|error| panic!("{formula}: {error}"));
            let settings = settings!(size_mode: SizeMode::Count, count: 2_000; ..Settings::default());
            let run = Run::start(&mut field, &settings.in_box(Bounds::cube(1.5))).expect("valid settings");
            let found = run.start_report().area;
            assert!((found / area - 1.0).abs() < 0.05, "{formula}: {found} of {area}");
        }
    }
}

#[test]
fn of_nearer_sheets_the_report_says_how_near_they_are_and_where() {
    for gap in [1e-6, 1e-7] {
        for (formula, ..) in layers(gap) {
            for settings in [of_radius(0.1, 1.5), adaptive(0.1, 1.5)] {
                let (session, report) = finished(&formula, Bounds::cube(1.5), &settings);
                let context = format!("{formula}, {:?}: {:?}", settings.sampling, report.warnings);
                assert_eq!(
                    (report.proof.search, report.proof.sampled.above),
                    (Search::Searched, None),
                    "{context}"
                );
                let told = session.run.sampler().doubts().into_iter().find_map(|doubt| match doubt {
                    Doubt::Unresolved { position: [x, y, z], gap, least } => Some((x, y, z, gap, least)),
                    _ => None,
                });
                let Some((x, y, z, told, least)) = told else { panic!("{context}") };
                assert!((told / gap - 1.0).abs() < 0.01 && told < least, "{context}: {told}");
                let is_there =
                    if formula.contains('x') { x * x + y * y + z * z - 1.0 } else { z * (z - 0.3) };
                assert!(is_there.abs() < 1e-5, "{context}: {x}, {y}, {z}");
                assert!(says(&report, "too close for single precision"), "{context}");
                // Neither is the cause, and a smaller radius no remedy.
                assert!(!says(&report, "without changing its sign"), "{context}");
                assert!(!says(&report, "choose a smaller radius"), "{context}");
            }
        }
    }
}

#[test]
fn a_search_that_is_not_proven_says_why() {
    for (formula, words) in [
        ("y^2 - x^3", "of the box open"),
        ("floor(5x)/5 - y", "f jumps"),
        ("(x^2+y^2+z^2-1)*(x^2+y^2+z^2-1.00001)*(x^2+y^2+z^2-1.00002)", "too close for single precision"),
    ] {
        let (_, report) = finished(formula, Bounds::cube(1.5), &of_radius(0.1, 1.5));
        assert_eq!(report.proof.search, Search::Searched, "{formula}");
        assert!(says(&report, words), "{formula}: {:?}", report.warnings);
    }
    // A run that is ended, and one that comes to its limit.
    let mut ended = session("x^2+y^2+z^2-1", Bounds::cube(1.5));
    ended.start(&of_radius(0.01, 1.5)).expect("valid settings");
    ended.run.step(1_000);
    ended.run.cancel();
    let report = ended.report();
    assert!(
        report.proof.search == Search::Searched && says(&report, "stopped during the search"),
        "{:?}",
        report.warnings
    );
    let capped = settings!(max_particles: 100; ..of_radius(0.01, 1.5));
    let (_, report) = finished("x^2+y^2+z^2-1", Bounds::cube(1.5), &capped);
    assert!(
        report.proof.search == Search::Searched && says(&report, "stopped during the search"),
        "{:?}",
        report.warnings
    );
}

#[test]
fn where_the_triangles_leave_a_surface_open_the_report_says_so() {
    // Thinner than the particles are large, or with a rim sharper than they are.
    let pancake = "x^2+y^2+400z^2=1";
    let ring = "(sqrt(x^2+y^2)-1)^2+z^2=0.0025";
    let needle = "x^2+400y^2+400z^2=1";
    let shell = "(x^2/4+y^2+9z^2-1)*(x^2/4+y^2+9z^2-1.0006)";
    for (formula, half, radius) in
        [(pancake, 1.2, 0.2), (pancake, 1.2, 0.04), (needle, 1.2, 0.1), (shell, 2.1, 0.1)]
    {
        let (_, report) = finished(formula, Bounds::cube(half), &of_radius(radius, half));
        assert!(
            says(&report, "components and Euler number may be wrong"),
            "{formula}: {:?}",
            report.warnings
        );
    }
    for (formula, half, radius, euler) in [
        ("x^2+y^2+9z^2=1", 1.2, 0.04, 2),
        ("x^2/4+y^2+9z^2=1", 2.1, 0.05, 2),
        ("(sqrt(x^2+y^2)-1)^2+z^2=0.16", 1.5, 0.05, 0),
        // The mesh closes it, and is right.
        (ring, 1.5, 0.03, 0),
        // Cut by the box.
        ("(sqrt(x^2+y^2)-1)^2+z^2=0.16", 1.1, 0.03, 0),
    ] {
        let (_, report) = finished(formula, Bounds::cube(half), &of_radius(radius, half));
        assert!(
            !says(&report, "components and Euler number may be wrong"),
            "{formula}: {:?}",
            report.warnings
        );
        assert!(
            half < 1.2 || report.measures.quality.map(|q| q.connectivity.euler) == Some(euler),
            "{formula}: {:?}",
            report.measures.quality
        );
    }
}
