//! Tests on formulas without a regular surface: poles, jumps, self-intersections, singular points,
//! open surfaces. The sampler ends on all of them, places particles only on zeros, and reports what
//! it met.

use crate::runs::session;
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::Field;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::sampler::{Phase, Progress, Sampling, Settings, SizeMode, StopReason};
use marching_particles::{Report, Warning};

/// Samples `formula` in the cube of half-width `half`.
fn sampled(formula: &str, half: f64, settings: &Settings) -> (Session, Progress, Report) {
    let mut session = session(formula, Bounds::cube(half));
    session.start(settings).unwrap_or_else(|error| panic!("{formula}: {error}"));
    // The limit is far more work than any of these surfaces takes, so a run that does not end
    // fails.
    let mut progress = session.run.step(0);
    for _ in 0..2_000 {
        if progress.stop_reason.is_some() {
            break;
        }
        progress = session.run.step(5_000);
    }
    assert!(progress.stop_reason.is_some(), "{formula}: not done after 10 million units of work");
    let report = session.report();
    let columns = session.run.particles();
    for (p, n) in columns.local.iter().zip(&columns.normal) {
        assert!(p.is_finite() && (n.length() - 1.0).abs() < 1e-5, "{formula}: {p} with the normal {n}");
    }
    (session, progress, report)
}

fn coarse() -> Settings {
    settings!(radius_share: 0.01; ..Settings::default())
}

/// Number of particles of a hexagonal lattice of the report's radius on an area.
fn expected(area: f64, report: &Report) -> f64 {
    area / (2.0 * 3.0_f64.sqrt() * report.sizes.radius * report.sizes.radius)
}

#[test]
fn poles_are_not_taken_for_zeros() {
    // The last but one has its pole just beside a node of the grid.
    for formula in ["1/x", "1/(x - 0.03125)", "1/(x - 0.0312501)", "1/(x^2 + y^2 + z^2 - 0.5)"] {
        let (session, progress, _) = sampled(formula, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::NoSurface), "{formula}");
        assert_eq!(session.run.count(), 0, "{formula}");
        assert!(progress.message.is_some_and(|m| !m.contains("keeps one sign")), "{formula}");
    }
    // There are three planes of zeros, at 0 and ±π/4, and two of poles between them, at ±π/8.
    let (session, _, report) = sampled("tan(4x)", 1.0, &coarse());
    for p in &session.run.particles().local {
        let from_zero = (p.x / core::f32::consts::FRAC_PI_4).round() * core::f32::consts::FRAC_PI_4 - p.x;
        assert!(from_zero.abs() < 1e-4, "{p}");
    }
    let share = report.count as f64 / expected(12.0, &report);
    assert!((0.9..1.2).contains(&share), "{} particles are {share} of a cover", report.count);
    // Holes are measured on the zeros; the poles are no uncovered surface.
    assert!(report.measures.quality.is_some_and(|q| q.coverage.cover < 1.6), "{:?}", report.measures.quality);
}

#[test]
fn no_particle_sits_where_the_gradient_overflows() {
    // Near such a pole f is small relative to its gradient. `sampled` checks every normal.
    for (formula, half) in [("exp(x) = x y", 1e4), ("cosh(z x/y)^12 = 1.6 + z", 100.0)] {
        for sampling in [Sampling::Uniform, Sampling::Adaptive] {
            let settings = settings!(sampling, radius_share: 0.03, radius_min_share: 0.01; ..coarse());
            let (session, _, _) = sampled(formula, half, &settings);
            assert!(session.run.count() > 20, "{formula}: {} particles", session.run.count());
        }
    }
}

#[test]
fn adaptive_runs_say_that_there_is_no_surface_as_uniform_ones_do() {
    for formula in ["x^2 + y^2 + z^2 + 1", "x = 5", "1/x", "sign(x)", "1", "ln(-1 - x^2)", "x^2 + y^2", "a"] {
        let (_, uniform, _) = sampled(formula, 1.0, &coarse());
        let settings = settings!(sampling: Sampling::Adaptive; ..coarse());
        let (session, progress, report) = sampled(formula, 1.0, &settings);
        assert_eq!((session.run.count(), report.count), (0, 0), "{formula}");
        assert_eq!(progress.stop_reason, uniform.stop_reason, "{formula}");
        assert_eq!(progress.message, uniform.message, "{formula}");
    }
}

#[test]
fn no_particle_is_smaller_than_the_smallest_radius() {
    // Sheets cross at poles and steps, where the radii of neighbours are unrelated.
    for formula in ["x*(floor(y) + z^-1) = cbrt(x)", "x y z", "tan(3x) + y"] {
        for seed in [0, 4, 1_327_422_460_186_159_666] {
            let settings = settings!(sampling: Sampling::Adaptive, seed, radius_min_share: 0.005; ..coarse());
            let (session, _, report) = sampled(formula, 2.0, &settings);
            let least = 0.005 * session.run.bounds().diagonal();
            assert!(
                report.sizes.radius_min > 0.999 * least,
                "{formula}: {} < {least}",
                report.sizes.radius_min
            );
        }
    }
}

#[test]
fn an_undefined_region_ends_the_front_and_is_counted() {
    // The formula is defined on half of a sphere.
    let (session, progress, report) = sampled("x^2 + y^2 + z^2 - 0.6 + 0*ln(x)", 1.0, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Complete));
    assert!(report.growth.fates.undefined > 20, "{:?}", report.growth.fates);
    assert!(
        report.warnings.iter().any(|w| w.to_string().contains("no value or no normal")),
        "{:?}",
        report.warnings
    );
    assert!(session.run.particles().local.iter().all(|p| p.x > 0.0));
    let share = report.count as f64 / expected(core::f64::consts::TAU * 0.6, &report);
    assert!((0.9..1.2).contains(&share), "{share}");
}

#[test]
fn a_surface_at_which_f_ends_is_found_whichever_sign_f_has_there() {
    // Outside the sphere f is not defined, and one of the two normals points there.
    for sign in ["1", "-1"] {
        let formula = format!("{sign}*(1 - x^2 - y^2 - z^2)(1 + sqrt(1 - x^2 - y^2 - z^2))");
        let (_, _, report) = sampled(&formula, 1.5, &settings!(radius_share: 0.015; ..Settings::default()));
        let share = report.count as f64 / expected(4.0 * core::f64::consts::PI, &report);
        assert!(
            (0.85..1.15).contains(&share),
            "{formula}: {} particles are {share} of a cover",
            report.count
        );
    }
}

#[test]
fn singular_points_do_not_stop_the_front() {
    // The surfaces have the apex of a cone, edges and corners of an octahedron, a cusp, and planes
    // that cross, where the gradient vanishes along lines. The front passes all of them, and the
    // run ends.
    for (formula, area) in [
        ("x^2 + y^2 - z^2", 2.0 * core::f64::consts::SQRT_2 * core::f64::consts::PI),
        ("hypot(x, y) - abs(z)", 2.0 * core::f64::consts::SQRT_2 * core::f64::consts::PI),
        ("abs(x) + abs(y) + abs(z) - 1", 4.0 * 3.0_f64.sqrt()),
        ("y^2 - x^3", 2.0 * 2.0 * 1.44),
        ("x y", 8.0),
        ("(x - y)*(x + y)", 8.0 * core::f64::consts::SQRT_2),
        ("x y z", 12.0),
        ("sin(5x)*sin(5y)*sin(5z)", 36.0),
    ] {
        let (_, progress, report) = sampled(formula, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        let share = report.count as f64 / expected(area, &report);
        assert!(
            (0.85..1.35).contains(&share),
            "{formula}: {} particles are {share} of a cover",
            report.count
        );
    }
}

#[test]
fn singular_points_are_counted_and_the_particles_next_to_them_marked() {
    for (formula, half, points) in [
        ("x^2 + y^2 = z^2", 1.0, 1),
        ("4(x^2 + y^2 + z^2) + 16x y z = 1", 1.6, 4),
        (gallery::find("kummer").expect("in the gallery").formula, 2.6, 16),
        // Fifteen more cone points are at infinity.
        (gallery::find("barth-sextic").expect("in the gallery").formula, 1.9, 50),
        // These have a cusp along a line, and sheets that cross.
        ("y^2 = x^3", 1.0, 1),
        ("x^2 = y^2(1 + z^2)", 1.0, 1),
        ("x^2 + y^2 + z^2 = 0.7", 1.0, 0),
        // Its second derivatives vanish at the point, too.
        ("x^4 + y^4 = z^4", 1.0, 1),
    ] {
        let formula = formula.replace("mu", "(1.3)").replace("+ t", "");
        let (session, _, report) = sampled(&formula, half, &coarse());
        assert_eq!(report.proof.singular_points, Some(points), "{formula}");
        let columns = session.run.particles();
        let marked = |i: usize| columns.slots[i].is_singular();
        let count = (0..columns.len()).filter(|&i| marked(i)).count();
        assert!(count < columns.len() / 2 && (count > 0) == (points > 0), "{formula}: {count} marked");
        let distance = match formula.as_str() {
            "x^2 + y^2 = z^2" => |p: Vec3| p.length(),
            "y^2 = x^3" | "x^2 = y^2(1 + z^2)" => |p: Vec3| p.truncate().length(),
            _ => continue,
        };
        for (i, &p) in columns.local.iter().enumerate() {
            let share = distance(p) / (2.0 * columns.radius[i]);
            assert!((share - 1.0).abs() < 0.01 || marked(i) == (share < 1.0), "{formula}: {p} at {share}");
        }
    }
}

#[test]
fn a_surface_that_crosses_or_touches_itself_is_told() {
    let gallery = |id: &str| gallery::find(id).expect("in the gallery").formula.replace("r x", "x");
    let text = str::to_owned;
    for (formula, half, told) in [
        (
            text("((x - 1)^2 + y^2 + z^2 - 1)((x + 1)^2 + y^2 + z^2 - 1)"),
            2.2,
            Some("touches itself at 1 point."),
        ),
        (text("((x - 1)^2 + y^2 + z^2 - 1)((x - 0.3)^2 + y^2 + z^2 - 0.09)"), 2.2, Some("touches itself")),
        (text("(z - 0.1)(z - 0.1 - x^2 - 2y^2)"), 1.0, Some("touches itself at 1 point.")),
        (gallery("roman"), 0.55, Some("crosses itself")),
        (gallery("klein-bottle"), 6.0, Some("crosses itself along 1 curve.")),
        // The tip of a cone, a cusp along a line, a curve on which the gradient vanishes and the
        // surface is smooth.
        (text("x^2 + y^2 = z^2"), 1.0, None),
        (text("x^4 + y^4 = z^4"), 1.0, None),
        (text("y^2 = x^3"), 1.0, None),
        (gallery("heart").replace("d y", "2.25 y"), 1.4, None),
        (gallery("cayley").replace("= t", "= 1"), 1.6, None),
    ] {
        let (_, _, report) = sampled(&formula, half, &coarse());
        let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
        let is_told = |words: &str| warnings.iter().any(|warning| warning.contains(words));
        assert_eq!(is_told("itself"), told.is_some(), "{formula}: {warnings:?}");
        assert!(told.is_none_or(is_told), "{formula}: {warnings:?}");
        assert!(report.proof.singular_points > Some(0), "{formula}");
    }
}

#[test]
fn a_run_that_another_field_ends_marks_the_particles_next_to_its_own_singular_points() {
    let mut session = session("x^2 + y^2 = z^2", Bounds::cube(1.0));
    session.start(&settings!(radius_share: 0.01; ..Settings::default())).unwrap();
    while session.run.step(200).phase != Phase::Relaxation {}
    let request = FieldRequest { formula: Some("x^2 + y^2 + z^2 = 0.5".into()), ..FieldRequest::default() };
    session.set_field(&request).unwrap();
    let marks = |session: &Session| session.run.particles().slots.iter().filter(|s| s.is_singular()).count();
    let marked = marks(&session);
    assert!(marked > 0, "none is marked");
    assert!(
        !session.run.step(0).moved && !session.run.step(1_000).moved,
        "something is done to the particles of another field"
    );
    assert_eq!(marks(&session), marked);
}

#[test]
fn a_run_that_is_cancelled_marks_the_particles_next_to_singular_points() {
    let (mut session, _, _) = sampled("x^2 + y^2 = z^2", 1.0, &coarse());
    let whole = session.run.count();
    session.start(&settings!(relax_steps: 50; ..coarse())).expect("valid settings");
    let mut progress = session.run.step(0);
    while progress.relax_step < 2 {
        progress = session.run.step(500);
    }
    assert_eq!(session.run.cancel().stop_reason, Some(StopReason::Cancelled));
    assert_eq!(session.run.count(), whole);
    assert_eq!(session.report().proof.singular_points, Some(1));
    let columns = session.run.particles();
    for (p, slots) in columns.local.iter().zip(&columns.slots) {
        assert!(p.length() > 1.9 * columns.radius[0] || slots.is_singular(), "{p} is not marked");
    }
    assert!(columns.slots.iter().any(|slots| slots.is_singular()), "none is marked");
}

#[test]
fn powers_of_a_factor_have_the_surface_of_the_factor() {
    for (formula, factor) in [
        ("x^2", "x"),
        ("0 = x^3", "x"),
        ("-2x^4/(y^2 + 1)^2", "x/(y^2 + 1)"),
        ("sqrt(abs(x - 0.2))", "x - 0.2"),
        ("(x^2 + y^2 + z^2 - 0.5)^2 = 0", "x^2 + y^2 + z^2 - 0.5"),
        ("abs(x^2 + y^2 + z^2 - 0.5)^1.5", "x^2 + y^2 + z^2 - 0.5"),
        ("x^2 (y - 0.2)", "x (y - 0.2)"),
        ("x (x y)^3 (y - 0.7)", "x y (y - 0.7)"),
        ("(x^2 + y^2 - z^2)^2", "x^2 + y^2 - z^2"),
    ] {
        let (powers, progress, report) = sampled(formula, 1.0, &coarse());
        let (simple, _, _) = sampled(factor, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        let share = powers.run.count() as f64 / simple.run.count() as f64;
        assert!(
            (0.95..1.05).contains(&share),
            "{formula}: {} and {}",
            powers.run.count(),
            simple.run.count()
        );
        assert!(
            report.warnings.iter().any(|w| w.to_string().contains("is sampled")),
            "{formula}: {:?}",
            report.warnings
        );
        assert!(
            !report.warnings.iter().any(|w| w.to_string().contains("twice")),
            "{formula}: {:?}",
            report.warnings
        );
    }
    // In a product, the domain of a root restricts the zeros of the other factors, and a pole
    // lowers the order of a zero.
    for formula in [
        "z sqrt(1 - x^2 - y^2)",
        "y x^0.5",
        "z sqrt(x)/3",
        "(x/y)^0.5",
        "x^3/x",
        "sin(x)^2/x",
        "(x - 1)^2/(y - 2)",
    ] {
        let field = Formula::as_written(formula, &[]).expect(formula).for_sampling();
        assert_eq!(field.facts().sampled_as, None, "{formula}");
    }
    // A constant factor, an equation with two sides, and a pole are left alone without a warning.
    for formula in ["x^2 = 0.3", "a^2 x", "x^3 + y", "x/(y + 3)^2"] {
        let (_, _, report) = sampled(formula, 1.0, &coarse());
        assert_eq!(report.warnings, [], "{formula}");
    }
}

#[test]
fn a_square_that_is_not_written_as_one_is_sampled_with_a_warning() {
    let (session, progress, report) =
        sampled("(x^2 + y^2 + z^2)^2 - (x^2 + y^2 + z^2) + 0.25", 1.0, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Complete));
    assert!(
        report.warnings.iter().any(|w| w.to_string().contains("without changing its sign")),
        "{:?}",
        report.warnings
    );
    for p in &session.run.particles().local {
        assert!((p.length() - 0.5_f32.sqrt()).abs() < 1e-3, "{p}");
    }
    let (_, _, report) = sampled("x^2 + y^2 + z^2 - 0.5", 1.0, &coarse());
    assert_eq!(report.warnings, []);
}

#[test]
fn zeros_without_a_gradient_are_never_called_absent() {
    // f vanishes, without changing its sign, on a line, at a point, on another line, and on planes.
    for formula in ["x^2 + y^2", "x^2 + y^2 + z^2", "(x - 0.1)^2 + (y + z)^2", "(x + y)^2 + z^2"] {
        let (_, progress, report) = sampled(formula, 1.0, &coarse());
        assert_ne!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        let message = progress.message.unwrap_or_default();
        assert!(message.contains("f comes to zero") && message.contains("enter"), "{formula}: {message}");
        assert_ne!(report.proof.undecided_cells, Some(0), "{formula}");
    }
}

#[test]
fn a_surface_that_is_small_for_its_box_is_not_called_a_point() {
    // Beside the box the sphere and the tube are thinner than the smallest cell of the search.
    for (formula, half) in
        [("x^2 + y^2 + z^2 - 1", 1e6), ("x^2 + y^2 + z^2 - 1", 1e7), ("x^2 + y^2 - 1e-12", 1.0)]
    {
        let (_, progress, report) = sampled(formula, half, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::NoSurface), "{formula}");
        let message = progress.message.unwrap_or_default();
        assert!(
            !message.contains("f comes to zero") && message.contains("far smaller than the box"),
            "{formula}: {message}"
        );
        assert!(message.contains("could not decide near (0, 0, "), "{formula}: {message}");
        assert_eq!(report.proof.singular_points, Some(0), "{formula}");
    }
}

#[test]
fn digits_that_double_precision_does_not_hold_are_said_with_where_and_how_much() {
    // Spheres of radius 1, written as the small differences of numbers near 1.
    for (formula, is_blurred) in [
        ("sqrt(1 + 1e-5*(x^2 + y^2 + z^2)) - sqrt(1.00001)", false),
        ("sqrt(1 + 1e-13*(x^2 + y^2 + z^2)) - sqrt(1 + 1e-13)", true),
        ("cos(1e-6*hypot(x, y, z)) - cos(1e-6)", true),
    ] {
        let (session, _, report) = sampled(formula, 1.5, &coarse());
        let blur = report.warnings.iter().find_map(|warning| match warning {
            Warning::Digits { position, distance, .. } => Some((DVec3::from_array(*position), *distance)),
            _ => None,
        });
        assert_eq!(blur.is_some(), is_blurred, "{formula}: {:?}", report.warnings);
        let Some((position, distance)) = blur else { continue };
        let off = |p: DVec3| (p.length() - 1.0).abs();
        let farthest = session.run.particles().local.iter().map(|p| off(p.as_dvec3())).fold(0.0, f64::max);
        // The bound is that of every rounding at its worst, the cosine's with room.
        assert!((5e-3..1.0).contains(&(farthest / distance)), "{formula}: {farthest} against {distance}");
        assert!(off(position) <= distance, "{formula}: {position}");
    }
}

#[test]
fn jumps_are_no_surface_and_end_the_projection_along_the_circle() {
    // The steps of the first one are numbers other than 0.
    for (formula, words) in [
        ("floor(3x) + 0.5", "jumps between them"),
        ("sign(x - 0.1234) + y/100", "jumps"),
        ("sign(x)", "jumps"),
    ] {
        let (session, progress, _) = sampled(formula, 0.9, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::NoSurface), "{formula}");
        assert_eq!(session.run.count(), 0, "{formula}");
        assert!(progress.message.is_some_and(|m| m.contains(words)), "{formula}");
    }
    // The treads of the steps are surface; the risers are not.
    let (session, progress, report) = sampled("floor(5x)/5 - y", 1.0, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Complete));
    assert!(report.growth.fates.not_converged > 100, "{:?}", report.growth.fates);
    // No smaller radius helps there.
    let words: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert!(words[0].starts_with("f jumps where the surface ends"), "{words:?}");
    assert!(words[1..].iter().all(|word| word.ends_with("in no triangle of the mesh.")), "{words:?}");
    for p in &session.run.particles().local {
        assert!(((5.0 * p.x).floor() / 5.0 - p.y).abs() < 1e-4, "{p}");
    }
    // A projection takes at most 50 evaluations, and each of a particle's six slots is projected
    // once.
    let slots = 6.0 * report.count as f64;
    assert!(report.growth.evaluations_per_particle * report.count as f64 <= 50.0 * slots, "{report:?}");
}

#[test]
fn an_open_surface_ends_at_the_box_and_its_border_is_counted() {
    for formula in ["z = x^2 - y^2", "x", "sin(3x) + sin(3y) + sin(3z)"] {
        let (session, progress, report) = sampled(formula, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        assert!(report.growth.fates.outside > 50, "{formula}: {:?}", report.growth.fates);
        assert!(report.measures.quality.is_some_and(|q| q.boundary_excluded > 50), "{formula}");
        assert!(session.run.particles().local.iter().all(|p| p.abs().cmple(Vec3::ONE).all()), "{formula}");
    }
}

#[test]
fn every_component_has_a_front_and_they_are_counted() {
    // There are eight balls, which are disjoint at this level.
    let formula = "(abs(x) - 0.5)^2 + (abs(y) - 0.5)^2 + (abs(z) - 0.5)^2 = 0.06";
    let (_, progress, report) = sampled(formula, 1.0, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Complete));
    assert_eq!((report.growth.components_seeded, report.proof.components), (8, 8));
    assert_eq!(report.measures.quality.map(|q| q.connectivity.components), Some(8));
    assert_eq!(report.measures.quality.map(|q| q.connectivity.euler), Some(16));
}

#[test]
fn steep_and_flat_functions_have_the_surface_of_the_tame_ones() {
    let (_, _, tame) = sampled("x", 1.0, &coarse());
    for formula in ["exp(20x) - 1", "exp(100x) - 1", "1e12 x", "1e-12 x", "atan(1000x)"] {
        let (session, progress, report) = sampled(formula, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        assert!((report.count as f64 / tame.count as f64 - 1.0).abs() < 0.05, "{formula}: {}", report.count);
        assert!(session.run.particles().local.iter().all(|p| p.x.abs() < 1e-4), "{formula}");
    }
}

#[test]
fn sheets_nearer_than_a_spacing_are_kept_apart() {
    // Two planes are 0.01 apart, and the particles are ten times as large.
    let (session, progress, report) = sampled("z^2 - 0.000025", 1.0, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Complete));
    assert!(
        report.warnings.iter().any(|w| w.to_string().contains("face another sheet")),
        "{:?}",
        report.warnings
    );
    assert_eq!(report.proof.components, 2);
    let position = &session.run.particles().local;
    let upper = position.iter().filter(|p| p.z > 0.0).count() as f64;
    let lower = position.len() as f64 - upper;
    assert!(upper > 100.0 && (upper / lower - 1.0).abs() < 0.1, "{upper} above, {lower} below");
    assert!(position.iter().all(|p| (p.z.abs() - 0.005).abs() < 1e-4));
    // Sheets farther apart than 2r and sharp edges give no warning.
    for formula in ["z^2 - 0.01", "abs(x) + abs(y) + abs(z) - 0.9", "x^2 + y^2 + z^2 - 0.5"] {
        let (_, _, report) = sampled(formula, 1.0, &coarse());
        assert!(
            !report.warnings.iter().any(|w| w.to_string().contains("another sheet")),
            "{formula}: {:?}",
            report.warnings
        );
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn every_run_ends_whatever_the_field() {
    let formulas = [
        // Planes that cross along 500 lines, and more surface than there may be particles for.
        "sin(20 x) sin(20 y) sin(20 z)",
        "floor(5 x) floor(5 y) - z",
        "min(x, y, z)",
        "exp(20 x) - exp(20 y)",
        "tan(10 x) + tan(10 y) + tan(10 z)",
        "acos(2 x) - y",
        "atan2(y, x) - z",
        "x^1000 + y^1000 - z",
    ];
    for formula in formulas {
        sampled(formula, 1.0, &settings!(max_particles: 4_000; ..coarse()));
    }
}

#[test]
fn a_formula_may_be_in_any_units() {
    let ellipsoid = "x^2 + 2y^2 + 3z^2 - 0.7";
    let (plain, _, _) = sampled(ellipsoid, 1.0, &coarse());
    for factor in ["2^100", "2^-100"] {
        // A power of two changes no digits.
        let (session, _, report) = sampled(&format!("{factor} * ({ellipsoid})"), 1.0, &coarse());
        assert_eq!(session.run.particles().digest(), plain.run.particles().digest(), "{factor}");
        assert_eq!(report.measures.quality.expect("there are particles").connectivity.euler, 2, "{factor}");
    }
    for factor in ["1e30", "1e-30"] {
        let formula = format!("{factor} x^2 + 2 * {factor} y^2 + 3 * {factor} z^2 = 0.7 * {factor}");
        let (_, progress, report) = sampled(&formula, 1.0, &coarse());
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}");
        let figures = report.measures.quality.expect("there are particles");
        assert!(figures.coverage.cover < 1.4 && figures.connectivity.euler == 2, "{formula}: {figures:?}");
    }
}

#[test]
fn a_few_large_particles_on_many_sheets_take_little_work() {
    // Twenty-six planes, on which two particles are wanted. Every other seed stays alone beside
    // them.
    let settings = settings!(size_mode: SizeMode::Count, count: 2; ..Settings::default());
    let (session, progress, report) = sampled("cos(z)", 40.0, &settings);
    assert!(progress.stop_reason.is_some() && session.run.count() > 0);
    // Four attempts of some 260 fronts, each of which takes no more than a few hundred evaluations.
    assert!(report.growth.evaluations < 1_000_000, "{} evaluations", report.growth.evaluations);
    assert!(report.growth.components_seeded < 1_000, "{} fronts", report.growth.components_seeded);
    assert!(report.warnings.iter().any(|w| w.to_string().contains("ended early")), "{:?}", report.warnings);
    assert_eq!(report.proof.sampled.above, None, "components are without particles");
}

#[test]
fn what_single_precision_cannot_hold_is_sampled_in_double_precision() {
    let sphere = 4.0 * core::f64::consts::PI;
    for (formula, half, area) in [
        ("exp(100*(x^2+y^2+z^2))-exp(100)", 1.5, sphere),
        ("1e-300*(x^2+y^2+z^2-1)", 1.5, sphere),
        // Nearly a cube.
        ("x^40+y^40+z^40-1", 15.0, 24.0),
        ("(exp(100*(x^2+y^2+z^2-1))-1)*(exp(100*(x^2+y^2+z^2-0.25))-1)", 1.3, 1.25 * sphere),
        // The values, but not their differences.
        ("sqrt(1+1e-5*(x^2+y^2+z^2))-sqrt(1.00001)", 1.5, sphere),
        ("cos(0.001*sqrt(x^2+y^2+z^2))-cos(0.001)", 1.6, sphere),
        ("sqrt(x^2+y^2+(z+1000)^2)-1000", 2.0, 16.0),
    ] {
        let share = 0.05 / (2.0 * half * 3.0_f64.sqrt());
        let (_, progress, report) = sampled(formula, half, &settings!(radius_share: share; ..coarse()));
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{formula}: {:?}", progress.message);
        let share = report.count as f64 / expected(area, &report);
        assert!(
            (0.85..1.25).contains(&share),
            "{formula}: {} particles are {share} of a cover",
            report.count
        );
        let figures = report.measures.quality.expect("there are particles");
        assert!(figures.coverage.cover < 1.6 && figures.accuracy.error_max < 1e-3, "{formula}: {figures:?}");
    }
    // From 4e8 to 4e8 - 12 there is no number in single precision.
    let (_, progress, _) = sampled("x^2+y^2+z^2-20000^2", 2.0, &coarse());
    let message = progress.message.unwrap_or_default();
    assert!(message.contains("f has no zero in this box"), "{message}");
    // Beyond double precision too.
    let (_, progress, _) = sampled("exp(1000*(x^2+y^2+z^2)+1000)-2", 1.5, &coarse());
    assert_eq!(progress.stop_reason, Some(StopReason::Undefined));
    assert!(progress.message.is_some_and(|m| m.contains("double precision")));
}
