//! Products whose factors cross: each factor is sampled by itself, up to curves on which four
//! sheets share their particles.

use crate::cases;
use core::f64::consts::PI;
use glam::DVec3;
use marching_particles::{Bounds, Formula, Method, Sample, Settings, Warning, sample};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

fn sampled(text: &str, half: f64, method: Method) -> Sample {
    let bounds = Some(Bounds::cube(half));
    let settings = settings!(method, bounds; ..Settings::with_count(3_000));
    sample(Formula::parse(text).expect("a formula"), &settings).expect("a sample")
}

fn crossings(sample: &Sample) -> usize {
    let of = |warning: &Warning| match warning {
        Warning::Crosses { curves, .. } => *curves,
        _ => 0,
    };
    sample.report().warnings.iter().map(of).sum()
}

#[test]
fn factors_that_cross_are_one_surface_of_the_right_euler_number() {
    let (refined, front) = (Method::Refined, Method::Front);
    for (text, half, method, euler, area, creases) in [
        // Euler numbers add up, less those of the curves, and more those of points on three
        // factors.
        ("(x^2+y^2+z^2-1) ((x-1)^2+y^2+z^2-1)", 2.2, refined, 4, 8.0 * PI, [1, 0]),
        ("(x^2+y^2+z^2-1) ((x-1)^2+y^2+z^2-1)", 2.2, front, 4, 8.0 * PI, [1, 0]),
        // A torus and a ball around half of its tube: both circles on the one are on the other.
        (
            "((sqrt(x^2+y^2)-1)^2+z^2-0.16) ((x-1)^2+y^2+z^2-0.36)",
            1.7,
            refined,
            2,
            4.0 * PI * (0.4 * PI + 0.36),
            [2, 0],
        ),
        // Three balls: three circles, which meet in two points.
        (
            "(x^2+y^2+z^2-1) ((x-1)^2+y^2+z^2-1) ((x-0.5)^2+(y-0.8)^2+z^2-1)",
            2.2,
            refined,
            8,
            12.0 * PI,
            [6, 2],
        ),
        ("x^2 (x^2+y^2+z^2-1)", 1.5, refined, 3, 4.0 * PI + 9.0, [1, 0]),
        ("-3 x y z", 1.6, front, 1, 3.0 * 3.2 * 3.2, [6, 7]),
    ] {
        let sample = sampled(text, half, method);
        let (report, topology) = (sample.report(), &sample.mesh().topology);
        assert_eq!((topology.components.len(), topology.euler()), (1, euler), "{text}, {method:?}");
        let figures = report.measures.quality.as_ref().expect("figures");
        assert_eq!((report.proof.components, figures.connectivity.euler), (1, euler), "{text}, {method:?}");
        assert!(!topology.is_manifold() && sample.volume().is_none(), "{text}");
        assert_eq!([report.proof.creases, report.proof.corners], creases.map(Some), "{text}, {method:?}");
        assert_eq!(crossings(&sample), creases[0], "{text}: all curves are crossings");
        assert_eq!(report.growth.refined_levels.is_some(), method == Method::Refined, "{text}");
        assert!((figures.area / area - 1.0).abs() < 0.05, "{text}: area {} for {area}", figures.area);
    }
}

#[test]
fn a_difference_of_squares_is_what_its_factors_are() {
    let is_one = |text: &str, half: f64, euler: i64| {
        let sample = sampled(text, half, Method::Front);
        let report = sample.report();
        let figures = report.measures.quality.as_ref().expect("figures");
        let found = (report.proof.components, figures.connectivity.euler, crossings(&sample));
        assert_eq!(found, (1, euler, 1), "{text}");
    };
    for text in
        ["x^2 - y^2 = 0", "-9*y^2 + 4*x^2", "x^2/a^2 = y^2/b^2", "(a*x)^2 - z^2", "x^2*(y^2 + 1)^2 = z^2"]
    {
        is_one(text, 1.5, 1);
    }
    for seed in cases::seeds(40) {
        println!("seed {seed}");
        let mut random = Pcg32::seed_from_u64(seed);
        let mut direction = || {
            let mut part = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
            DVec3::new(part(), part(), part()).normalize_or(DVec3::X)
        };
        // Two planes through one point in the box, at no small angle.
        let (n, point) = (direction(), 0.4 * direction());
        let m = (direction().cross(n).normalize_or(n.any_orthonormal_vector()) + 0.5 * n).normalize_or(n);
        let plane = |n: DVec3| format!("({:.6}*x + {:.6}*y + {:.6}*z - {:.6})", n.x, n.y, n.z, n.dot(point));
        let [p, q] = [n, m].map(plane);
        is_one(&format!("({p} + {q})^2 = ({p} - {q})^2"), 1.5, 1);
        // A plane through a sphere: the circle has the Euler number 0.
        let sphere = "(x^2 + y^2 + z^2 - 1)";
        is_one(&format!("({sphere} - {p})^2 - ({sphere} + {p})^2"), 2.0, 3);
    }
}

#[test]
fn a_particle_on_a_crossing_has_a_row_for_each_of_four_sheets() {
    let sample = sampled("(x^2+y^2+z^2-1) ((x-1)^2+y^2+z^2-1)", 2.2, Method::Front);
    let particles = sample.particles();
    let rows_of = |first: u32| (0..particles.twins.len()).filter(move |&row| particles.twins[row] == first);
    assert!(particles.segments.len() > 40);
    for &[first, _] in &particles.segments {
        let rows: Vec<usize> = rows_of(first).collect();
        assert_eq!(rows.len(), 4);
        let p = particles.place(rows[0]);
        assert!((p.length() - 1.0).abs() < 1e-6 && (p.distance(DVec3::X) - 1.0).abs() < 1e-6, "{p}");
        // Two sheets of each ball, which face opposite ways: inside of the other ball f is positive
        // within the ball.
        let normals: Vec<DVec3> = rows.iter().map(|&row| particles.normal[row].as_dvec3()).collect();
        for normal in &normals {
            assert_eq!(normals.iter().filter(|other| other.dot(*normal) < -0.999).count(), 1, "{normals:?}");
        }
    }
    // The particles beside the curve lie on one ball, to the precision of a coordinate.
    for i in particles.twins.len()..particles.len() {
        let p = particles.place(i);
        let off = (p.length() - 1.0).abs().min((p.distance(DVec3::X) - 1.0).abs());
        assert!(off < 1e-4, "{p}: {off}");
    }
}

#[test]
fn factors_that_touch_or_stay_apart_are_one_function() {
    for (apart, touches) in [("(x-2)^2+y^2+z^2-1", 1), ("(x-2.3)^2+y^2+z^2-1", 0), ("x^2+y^2+z^2-0.9", 0)] {
        let sample = sampled(&format!("(x^2+y^2+z^2-1) ({apart})"), 3.4, Method::Front);
        assert!(sample.particles().patch.is_empty() && crossings(&sample) == 0, "{apart}");
        let is_told = |warning: &Warning| matches!(warning, Warning::Meets { touches, .. } if *touches == 1);
        assert_eq!(
            sample.report().warnings.iter().filter(|warning| is_told(warning)).count(),
            touches,
            "{apart}"
        );
        assert_eq!(sample.mesh().topology.components.len(), 2, "{apart}");
    }
}

#[test]
fn planes_through_one_line_are_told_and_not_refined() {
    let sample = sampled("x y (x+y) (z-0.3)", 1.9, Method::Refined);
    let report = sample.report();
    assert!(report.growth.refined_levels.is_none());
    assert!(report.warnings.iter().any(|warning| matches!(warning, Warning::NotRefined(_))));
    assert!(report.warnings.iter().any(|warning| matches!(warning, Warning::Meets { crossings: 1, .. })));
}

#[test]
fn the_sheets_around_crossing_planes_are_one_solid() {
    let bounds = Bounds::cube(1.5);
    let solid = Formula::parse("x y z").expect("a formula").thickened(0.2).closed_by(&bounds);
    let sample = sample(solid, &Settings::with_count(6_000)).expect("a sample");
    // Three slabs, less what two share, and more what all do.
    let exact = 3.0 * 9.0 * 0.2 - 3.0 * 3.0 * 0.04 + 0.008;
    let volume = sample.volume().expect("a closed mesh");
    assert!((volume / exact - 1.0).abs() < 1e-4, "{volume} for {exact}");
    assert_eq!(sample.mesh().topology.euler(), 2);
}
