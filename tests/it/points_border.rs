//! Tests of the border of points: a surface that is fitted to points ends where they do, and stays
//! closed over small holes. The points are random ones on surfaces whose area is known.

use glam::{DMat3, DQuat, DVec3, dvec3};
use marching_particles::Bounds;
use marching_particles::field::Field;
use marching_particles::field::rbf::{Ball, Border, RbfData, RbfField};
use marching_particles::internal::session::{BeyondPoints, FieldRequest, Session, SolidSettings};
use marching_particles::pointcloud::fit::Fit;
use marching_particles::pointcloud::job::Job;
use marching_particles::{Sample, Settings, sample};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

struct Random(Pcg64Mcg);

impl Random {
    /// A number between 0 and 1.
    fn number(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    fn direction(&mut self) -> DVec3 {
        on_sphere(self.number(), 2.0 * self.number() - 1.0)
    }

    /// A rotation with a shift.
    fn motion(&mut self) -> impl Fn(DVec3) -> DVec3 + use<> {
        let turned = DMat3::from_quat(DQuat::from_axis_angle(self.direction(), TAU * self.number()));
        let shift = self.direction();
        move |p| turned * p + shift
    }
}

fn on_sphere(turn: f64, z: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(TAU * turn);
    dvec3(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + DVec3::Z * z
}

/// An open surface: its area, how many borders it has, and a random point with its normal.
struct Open {
    name: &'static str,
    area: f64,
    borders: usize,
    point: fn(&mut Random) -> (DVec3, DVec3),
}

const OPEN: [Open; 4] = [
    Open {
        name: "half a sphere",
        area: TAU,
        borders: 1,
        point: |random| {
            let p = on_sphere(random.number(), random.number());
            (p, p)
        },
    },
    Open {
        name: "a sphere with a wide hole",
        area: TAU * 1.8,
        borders: 1,
        point: |random| {
            let p = on_sphere(random.number(), 1.8 * random.number() - 1.0);
            (p, p)
        },
    },
    Open {
        name: "an open cylinder",
        area: TAU * 2.0,
        borders: 2,
        point: |random| {
            let n = on_sphere(random.number(), 0.0);
            (n + DVec3::Z * (2.0 * random.number() - 1.0), n)
        },
    },
    Open {
        name: "a roof of two inclined planes, rounded",
        // The length of the curve z = −√(x² + 0.04) over x from −1 to 1, by Simpson's rule.
        area: 2.0 * 2.616_76,
        borders: 1,
        point: |random| loop {
            let x = 2.0 * random.number() - 1.0;
            let slope = -x / (x * x + 0.04).sqrt();
            // As many points for the same area: the longest element is √2.
            if random.number() * 2_f64.sqrt() <= (1.0 + slope * slope).sqrt() {
                let p = dvec3(x, 2.0 * random.number() - 1.0, -(x * x + 0.04).sqrt());
                return (p, dvec3(-slope, 0.0, 1.0).normalize_or_zero());
            }
        },
    },
];

/// The fit to points and normals, or to points alone.
fn fit(points: &[(DVec3, DVec3)], has_normals: bool) -> Fit {
    let mut text = String::new();
    for (p, n) in points {
        let _ = write!(text, "{} {} {}", p.x, p.y, p.z);
        if has_normals {
            let _ = write!(text, " {} {} {}", n.x, n.y, n.z);
        }
        text.push('\n');
    }
    let job = Job::file("points.xyz", text.into_bytes(), 100).expect("a file of points");
    job.complete().expect("a surface")
}

fn sampled(fit: &Fit, field: RbfField) -> Sample {
    sample(field, &Settings::with_count(800).in_box(fit.bounds)).expect("a surface")
}

fn nearest(points: &[(DVec3, DVec3)], p: DVec3) -> f64 {
    points.iter().map(|(other, _)| p.distance(*other)).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_surface_through_points_ends_where_they_end() {
    for (k, open) in OPEN.iter().enumerate() {
        let mut random = Random(Pcg64Mcg::new(k as u128 + 7));
        let moved = random.motion();
        let turned = |n: DVec3| moved(n) - moved(DVec3::ZERO);
        let noise = if k % 2 == 0 { 0.0 } else { 0.01 };
        let points: Vec<(DVec3, DVec3)> = (0..1_500)
            .map(|_| {
                let (p, n) = (open.point)(&mut random);
                (moved(p + n * noise * (random.number() - 0.5)), turned(n))
            })
            .collect();
        let spacing = (open.area / points.len() as f64).sqrt();
        let fit = fit(&points, k < 3);
        let name = open.name;
        assert!(fit.info.beyond_share > 0.0, "{name}: {:?}", fit.info);
        let told = |text: &String| text.contains("goes on beyond its points");
        assert!(fit.info.warnings.iter().any(told), "{name}: {:?}", fit.info.warnings);

        let cut = sampled(&fit, fit.field());
        let topology = &cut.mesh().topology;
        let found = (topology.components.len(), topology.borders.len());
        assert_eq!(found, (1, open.borders), "{name}");
        let area = cut.report().measures.quality.expect("figures").area;
        assert!((area / open.area - 1.0).abs() < 0.06, "{name}: {area} of {}", open.area);
        let particles = cut.particles();
        for p in &particles.local {
            let distance = nearest(&points, particles.origin + p.as_dvec3());
            assert!(distance < 3.0 * spacing, "{name}: {distance} of {spacing} at {p}");
        }

        let kept = sampled(&fit, fit.field().untrimmed());
        let whole = kept.report().measures.quality.expect("figures").area;
        assert!(whole > 1.05 * area, "{name}: {whole} and {area}");
        // The share is that of cells of a grid, of which inclined sheets meet more.
        let share = (whole - area) / whole;
        assert!((share - fit.info.beyond_share).abs() < 0.06, "{name}: {share} {:?}", fit.info.beyond_share);
    }
}

#[test]
fn a_closed_surface_through_points_stays_closed_over_small_holes() {
    for seed in 0..3_u128 {
        let mut random = Random(Pcg64Mcg::new(seed));
        let axes = dvec3(1.0, 0.6 + 0.4 * random.number(), 0.6 + 0.4 * random.number());
        let count = 1_500;
        // Some four spacings wide.
        let hole = 2.0 * (4.0 * PI / count as f64).sqrt();
        let holes: Vec<DVec3> = (0..5).map(|_| random.direction()).collect();
        let points: Vec<(DVec3, DVec3)> = (0..count)
            .map(|_| random.direction())
            .filter(|p| holes.iter().all(|hole_at| p.distance(*hole_at) > hole))
            .map(|p| (p * axes, (p / axes).normalize_or_zero()))
            .collect();
        let fit = fit(&points, seed != 1);
        assert_eq!(fit.info.beyond_share, 0.0, "seed {seed}");
        assert!(fit.data.border.is_none(), "seed {seed}");
        let closed = sampled(&fit, fit.field());
        assert!(closed.mesh().topology.is_closed(), "seed {seed}");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_session_keeps_what_lies_beyond_points_if_asked_to() {
    let mut random = Random(Pcg64Mcg::new(3));
    let points: Vec<(DVec3, DVec3)> = (0..800).map(|_| (OPEN[0].point)(&mut random)).collect();
    let fit = fit(&points, true);
    let area = |choices: &[BeyondPoints]| {
        let mut session = Session::new();
        let choose = |session: &mut Session, beyond_points| {
            let choice = SolidSettings { beyond_points, ..SolidSettings::default() };
            session.choose(choice).expect("a choice");
        };
        // The choice holds before and after the points are there.
        choose(&mut session, choices[0]);
        let request = FieldRequest::default();
        session.set_points(fit.data.clone(), fit.info.clone(), fit.bounds, &request).expect("a field");
        choose(&mut session, choices[1]);
        let report = crate::runs::run(&mut session, &Settings::with_count(300));
        report.measures.quality.expect("figures").area
    };
    use BeyondPoints::{Cut, Kept};
    let [cut, kept] = [area(&[Cut, Cut]), area(&[Kept, Kept])];
    assert!(kept > 1.05 * cut, "{kept} and {cut}");
    assert_eq!(area(&[Kept, Cut]), cut);
    assert_eq!(area(&[Cut, Kept]), kept);
}

/// A border of random balls.
fn border(random: &mut Random) -> Border {
    let balls = (0..100)
        .map(|_| Ball { centre: 2.0 * random.direction(), radius: 0.3 + 0.2 * random.number() })
        .collect();
    Border::new(balls, Bounds::cube(3.0)).expect("balls")
}

#[test]
fn the_function_of_a_border_has_the_derivatives_that_it_gives() {
    let mut random = Random(Pcg64Mcg::new(11));
    let border = border(&mut random);
    for _ in 0..200 {
        let p = random.direction() * 2.5 * random.number();
        let (jet, h) = (border.jet(p), 1e-6);
        for axis in 0..3 {
            let along = h * DVec3::AXES[axis];
            let [ahead, behind] = [border.jet(p + along), border.jet(p - along)];
            let slope = (ahead.value - behind.value) / (2.0 * h);
            assert!((slope - jet.gradient[axis]).abs() < 1e-6, "{slope} {jet:?} at {p}");
            let bend = (ahead.gradient - behind.gradient) / (2.0 * h);
            for other in 0..3 {
                let given = jet.hessian.at(axis, other);
                assert!((bend[other] - given).abs() < 1e-3 * (1.0 + given.abs()), "{bend} {jet:?} at {p}");
            }
        }
    }
}

#[test]
fn bytes_with_a_border_are_read_back_or_refused() {
    let mut random = Random(Pcg64Mcg::new(5));
    let data = RbfData {
        centres: vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]],
        alpha: vec![1.0, -1.0],
        beta: vec![[0.5; 3]; 2],
        border: Some(border(&mut random)),
    };
    let bytes = data.to_bytes();
    assert_eq!(RbfData::from_bytes(&bytes).as_ref(), Ok(&data));
    for cut in (0..bytes.len()).step_by(101) {
        assert!(RbfData::from_bytes(&bytes[..cut]).is_err(), "{cut} bytes");
    }
    let mut wrong = bytes.clone();
    for count in [f64::NAN, f64::INFINITY, -1.0, 1e300, 0.0] {
        wrong[8..16].copy_from_slice(&count.to_le_bytes());
        assert!(RbfData::from_bytes(&wrong).is_err(), "{count} balls");
    }
}
