//! Functions of which nothing but values is known, with edges.

use crate::black_box_table::{Function, Solid, block, fading_solids, more_solids, smooth_min, solids};
use crate::cases;
use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};
use marching_particles::field::{FnField, PiecewiseFn};
use marching_particles::{Bounds, Method, Sample, Settings, sample, smooth_union, union};
use rand_core::SeedableRng;
use rand_pcg::Pcg32;

/// A place of a solid that is turned and moved.
fn turned(p: DVec3) -> DVec3 {
    DMat3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize_or_zero(), 0.7) * (p - dvec3(0.123, -0.2, 0.3))
}

/// Checks that a solid, straight or turned, comes out closed and with its edges.
fn check(Solid { name, euler, creases, corners, volume, f }: Solid, settings: &Settings, is_turned: bool) {
    let field = move |p: DVec3| f(if is_turned { turned(p) } else { p });
    let sample = sample(field, settings).unwrap_or_else(|error| panic!("{name}: {error}"));
    let (topology, report) = (&sample.mesh().topology, sample.report());
    assert!(topology.is_closed(), "{name}: {:?}", report.warnings);
    let found = (topology.euler(), report.proof.creases, report.proof.corners);
    assert_eq!(found, (euler, Some(creases), Some(corners)), "{name}");
    if let (Some(volume), Some(found)) = (volume, sample.volume()) {
        assert!((found / volume - 1.0).abs() < 3e-3, "{name}: {found} of {volume}");
    }
}

#[test]
fn functions_with_edges_are_closed() {
    for solid in solids().into_iter().step_by(4) {
        check(solid, &Settings::with_count(2_000), false);
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn all_functions_with_edges_are_closed_however_they_are_turned() {
    for is_turned in [false, true] {
        for solid in solids() {
            check(solid, &Settings::with_count(8_000), is_turned);
        }
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn most_functions_as_people_write_them_are_closed() {
    /// A share that was usual when the test was written.
    const CLOSED: f64 = 0.8;
    let (mut closed, mut all) = (0, 0);
    for is_turned in [false, true] {
        for (name, f) in more_solids() {
            let field = move |p: DVec3| f(if is_turned { turned(p) } else { p });
            let settings = Settings::with_count(8_000).in_box(Bounds::cube(1.8));
            let sample = sample(field, &settings).unwrap_or_else(|error| panic!("{name}: {error}"));
            all += 1;
            if sample.mesh().topology.is_closed() {
                closed += 1;
            } else {
                println!("{name}, turned: {is_turned}: {:?}", sample.report().warnings);
            }
        }
    }
    cases::assert_share(closed, all, CLOSED, "functions that are closed");
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn functions_with_edges_are_refined() {
    for solid in solids().into_iter().step_by(3) {
        let mut settings = Settings::with_count(8_000);
        settings.method = Method::Refined;
        let (name, f) = (solid.name, solid.f);
        let sample = sample(f, &settings).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(sample.report().growth.refined_levels.is_some(), "{name}: {:?}", sample.report().warnings);
        assert!(sample.mesh().topology.is_closed(), "{name}");
    }
}

#[test]
fn functions_whose_edges_fade_out_are_closed() {
    for is_turned in [false, true] {
        for solid in fading_solids() {
            check(solid, &Settings::with_count(3_000).in_box(Bounds::cube(1.9)), is_turned);
        }
    }
}

#[test]
fn edges_that_are_nowhere_sharp_are_left_out_where_they_fade_out() {
    for height in [0.01, 0.02, 0.05, 0.1] {
        let f = move |p: DVec3| {
            let up = p.z.max(0.0);
            p.length() - 1.0 + height * p.x.abs() * up * up
        };
        let settings = Settings::with_count(3_000).in_box(Bounds::cube(1.9));
        let sample = sample(f, &settings).unwrap_or_else(|error| panic!("{height}: {error}"));
        assert!(sample.mesh().topology.is_closed(), "{height}: {:?}", sample.report().warnings);
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn most_blocks_that_are_smoothly_joined_to_a_ball_are_closed() {
    /// A share that was usual when the test was written.
    const CLOSED: f64 = 0.75;
    let (mut closed, mut all) = (0, 0);
    for seed in cases::seeds(60) {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut between = |lo, hi| cases::between(&mut random, lo, hi);
        let half = DVec3::from_array([0; 3].map(|_| between(0.4, 0.8)));
        let way = dvec3(between(-1.0, 1.0), between(-1.0, 1.0), 1.0).normalize_or_zero();
        let turn = DMat3::from_axis_angle(way, between(0.0, 3.0));
        let aside = DVec3::from_array([0; 3].map(|_| between(-1.0, 1.0)));
        let centre = half * aside / aside.abs().max_element();
        let (radius, reach) = (between(0.25, 0.6), between(0.1, 0.3));
        // Every other one has rounded edges outside the block, since it is the exact distance.
        let is_exact = seed % 2 == 0;
        let f = move |p: DVec3| {
            let p = turn * p;
            let beyond = (p.abs() - half).max(DVec3::ZERO).length();
            let from_block = if is_exact && beyond > 0.0 { beyond } else { block(p, half) };
            smooth_min(from_block, p.distance(centre) - radius, reach)
        };
        let settings = Settings::with_count(8_000).in_box(Bounds::cube(1.9));
        let sample = sample(f, &settings).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        all += 1;
        if sample.mesh().topology.is_closed() {
            closed += 1;
        } else {
            println!("seed {seed}: {:?}", sample.report().warnings);
        }
    }
    cases::assert_share(closed, all, CLOSED, "blocks that are closed");
}

/// Largest distance of the particles on creases of a cube from its edges, over its side.
fn off_the_edges(sample: &Sample, half: f64) -> f64 {
    let particles = sample.particles();
    let on_creases = particles.twins.len();
    assert!(on_creases > 0);
    let off = (0..on_creases).map(|row| {
        let p = (particles.origin + particles.local[row].as_dvec3()).abs().to_array();
        let mut off = p.map(|x| (x - half).abs());
        off.sort_by(f64::total_cmp);
        off[1]
    });
    off.fold(0.0, f64::max) / (2.0 * half)
}

#[test]
fn particles_lie_on_the_edges() {
    let cube = |half: f64, scale: f64| move |p: DVec3| scale * block(p, DVec3::splat(half));
    for (half, scale) in [(0.8, 1.0), (800.0, 50.0), (0.8, 1e-6)] {
        let sample = sample(cube(half, scale), &Settings::with_count(1_000)).expect("a cube");
        assert!(off_the_edges(&sample, half) < 1e-6, "{half} {scale}");
    }
}

#[test]
fn the_report_says_how_edges_were_found_and_more_survey_cells_find_finer_ones() {
    let cube = |p: DVec3| block(p, DVec3::splat(0.8));
    let found = |settings: &Settings| {
        let sample = sample(cube, settings).expect("a cube");
        sample.report().proof.edges_found.map(|search| search.to_string())
    };
    let mut settings = Settings::with_count(500).in_box(Bounds::cube(1.0));
    assert_eq!(found(&settings).as_deref(), Some("in the values of f to 1/64 of the box"));
    settings.survey_cells = Some(40);
    assert_eq!(found(&settings).as_deref(), Some("in the values of f to 1/40 of the box"));
    // Whoever tells the pieces needs no search.
    let piece = |label: u32, p: DVec3| if label == 0 { p.length() - 1.0 } else { p.z - 0.5 };
    let label = move |p: DVec3| u32::from(piece(1, p) > piece(0, p));
    let told = sample(PiecewiseFn::new(label, piece), &Settings::with_count(500)).expect("a cut ball");
    assert_eq!(told.report().proof.edges_found, None);
    // A union is no better than its operands.
    let both = union((cube, |p: DVec3| p.distance(DVec3::X) - 0.5));
    let both = sample(both, &Settings::with_count(1_000).in_box(Bounds::cube(2.0))).expect("a solid");
    assert!(both.report().proof.edges_found.is_some());
}

#[test]
fn a_mesh_that_is_open_along_edges_says_what_to_do() {
    let noise = |p: DVec3| libm::sin(1e7 * p.x) * libm::cos(1.3e7 * p.y) + libm::sin(1.7e7 * p.z);
    let noisy = |p: DVec3| block(p, DVec3::splat(0.8)) + 1e-6 * noise(p);
    let settings = Settings::with_count(2_000).in_box(Bounds::cube(1.3));
    let sample = sample(noisy, &settings).expect("a cube");
    let told: Vec<String> = sample.report().warnings.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("too noisy to show its edges")), "{told:?}");
    assert!(told.iter().all(|text| !text.contains("gradient does not fit")), "{told:?}");
    let half = |p: DVec3| if p.x > 0.2 { f64::NAN } else { block(p, DVec3::splat(0.8)) };
    let sample = marching_particles::sample(half, &settings).expect("a part of a cube");
    let told: Vec<String> = sample.report().warnings.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|text| text.contains("the surface ends where f does")), "{told:?}");
}

#[test]
fn a_particle_on_the_plane_of_a_shared_face_does_not_grow_into_the_solid() {
    let step = |p: DVec3, y: f64, height: f64| {
        block(p - dvec3(0.0, y, 0.5 * height - 0.5), dvec3(0.6, 0.25, 0.5 * height))
    };
    // Turned like this, a particle lies on the plane of a shared face to within the step of the
    // differences.
    let steps = |p: DVec3| {
        let q = turned(p + dvec3(0.0, 0.0, 0.2));
        step(q, -0.5, 0.3).min(step(q, 0.0, 0.6)).min(step(q, 0.5, 0.9))
    };
    let settings = Settings::with_count(8_000).in_box(Bounds::cube(1.8));
    let sample = sample(steps, &settings).expect("three steps");
    assert!(sample.mesh().topology.is_closed(), "{:?}", sample.report().warnings);
    assert_eq!(sample.mesh().topology.euler(), 2);
}

#[test]
fn smooth_functions_have_no_edges() {
    let torus = |p: DVec3| libm::hypot(p.truncate().length() - 0.7, p.z) - 0.25;
    let gyroid = |p: DVec3| {
        let [x, y, z] = (5.0 * p).to_array().map(libm::sincos);
        x.0 * y.1 + y.0 * z.1 + z.0 * x.1
    };
    let rounded = |radius: f64| {
        move |p: DVec3| {
            let q = p.abs() - 0.8 + radius;
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - radius
        }
    };
    let all =
        [Box::new(torus) as Function, Box::new(gyroid), Box::new(rounded(0.05)), Box::new(rounded(0.01))];
    for (k, f) in all.into_iter().enumerate() {
        let sample = sample(f, &Settings::with_count(1_000).in_box(Bounds::cube(1.0))).expect("a surface");
        assert_eq!(sample.report().proof.creases, None, "{k}");
    }
}

#[test]
fn what_functions_with_edges_are_put_together_to_has_all_of_them() {
    let cube = |at: DVec3| move |p: DVec3| block(p - at, DVec3::splat(0.5));
    let ball = |p: DVec3| p.distance(dvec3(0.6, 0.6, 0.6)) - 0.4;
    let made = sample(union((cube(DVec3::ZERO), ball)), &Settings::with_count(3_000)).expect("a solid");
    assert!(made.mesh().topology.is_closed(), "{:?}", made.report().warnings);
    assert_eq!(made.mesh().topology.euler(), 2);
    // The blend of two cubes that are apart has the edges of both.
    let blend = smooth_union(cube(DVec3::ZERO), cube(2.0 * DVec3::X), 0.1);
    let blended = sample(blend, &Settings::with_count(3_000)).expect("a solid");
    assert!(blended.mesh().topology.is_closed(), "{:?}", blended.report().warnings);
    assert_eq!(blended.report().proof.creases, Some(24));
}

#[test]
fn bodies_that_touch_along_a_part_of_a_face_are_one() {
    for seed in cases::seeds(4) {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut between = |lo, hi| cases::between(&mut random, lo, hi);
        let half = DVec3::from_array([0; 3].map(|_| between(0.5, 0.7)));
        let (aside, radius, height) = (between(-0.15, 0.15), between(0.15, 0.25), between(0.3, 0.6));
        let way = dvec3(between(-1.0, 1.0), between(-1.0, 1.0), 1.0).normalize_or_zero();
        let turn = DMat3::from_axis_angle(way, between(0.2, 1.2));
        // A round peg on a block.
        let f = move |p: DVec3| {
            let p = turn * p;
            let on = p - dvec3(0.1, aside, half.z + height);
            block(p, half).min((on.truncate().length() - radius).max(on.z.abs() - height))
        };
        let settings = Settings::with_count(3_000).in_box(Bounds::cube(2.2));
        let sample = sample(f, &settings).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let (topology, report) = (&sample.mesh().topology, sample.report());
        assert!(topology.is_closed(), "seed {seed}: {:?}", report.warnings);
        assert_eq!((topology.euler(), report.proof.creases), (2, Some(12 + 2)), "seed {seed}");
    }
}

#[test]
fn pieces_that_bend_between_points_of_their_edges_end_at_corners() {
    type Figure = Box<dyn Fn(DVec2) -> f64 + Send + Sync>;
    for seed in cases::seeds(4) {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut between = |lo, hi| cases::between(&mut random, lo, hi);
        let way = dvec3(between(-1.0, 1.0), between(-1.0, 1.0), 1.0).normalize_or_zero();
        let turn = DMat3::from_axis_angle(way, between(0.0, 1.2));
        let (half, radius) = (dvec2(between(0.3, 0.6), between(0.2, 0.4)), between(0.15, 0.3));
        let rounded = move |q: DVec2| (q.abs() - half).max(DVec2::ZERO).length() - radius;
        let (teeth, height) = (between(5.0, 10.0).round(), between(0.04, 0.1));
        let gear = move |q: DVec2| {
            let tooth = (0.25 * libm::sin(teeth * libm::atan2(q.y, q.x))).clamp(-height, height);
            (q.length() - 0.8 - tooth).max(0.25 - q.length())
        };
        let figures: [(&str, i64, Figure); 2] =
            [("rounded", 2, Box::new(rounded)), ("gear", 0, Box::new(gear))];
        for (name, euler, figure) in figures {
            let f = move |p: DVec3| {
                let p = turn * p;
                figure(p.truncate()).max(p.z.abs() - 0.3)
            };
            let settings = Settings::with_count(6_000).in_box(Bounds::cube(1.8));
            let sample = sample(f, &settings).unwrap_or_else(|error| panic!("{name}, seed {seed}: {error}"));
            let (topology, report) = (&sample.mesh().topology, sample.report());
            assert!(topology.is_closed(), "{name}, seed {seed}: {:?}", report.warnings);
            assert_eq!(topology.euler(), euler, "{name}, seed {seed}");
        }
    }
}

#[test]
fn edges_whose_angle_vanishes_at_points_are_found() {
    // What three cylinders of one radius have in common: 24 edges, four at each of six points where
    // two cylinders touch.
    let turn = DMat3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize_or_zero(), 0.7);
    let f = move |p: DVec3| {
        let p = turn * (p - dvec3(0.123, -0.2, 0.1));
        p.truncate().length().max(libm::hypot(p.y, p.z)).max(libm::hypot(p.x, p.z)) - 0.8
    };
    let settings = Settings::with_count(8_000).in_box(Bounds::cube(1.8));
    let sample = sample(f, &settings).expect("a solid");
    let (topology, report) = (&sample.mesh().topology, sample.report());
    assert!(topology.is_closed(), "{:?}", report.warnings);
    assert_eq!((topology.euler(), report.proof.creases), (2, Some(24)));
}

#[test]
fn functions_that_name_their_pieces_have_exact_edges() {
    /// A cube less a ball at one of its corners: its faces, and the ball as the last piece.
    fn piece(label: u32, p: DVec3) -> f64 {
        match label {
            6 => 0.7 - p.distance(DVec3::splat(0.8)),
            _ => (if label.is_multiple_of(2) { p } else { -p })[label as usize / 2] - 0.8,
        }
    }
    let value = |p: DVec3| (0..7).map(|label| piece(label, p)).fold(f64::NEG_INFINITY, f64::max);
    let label = move |p: DVec3| (0..7).find(|&label| piece(label, p) == value(p)).unwrap_or(0);
    let field = PiecewiseFn::new(label, piece);
    let settings = Settings::with_count(3_000).in_box(Bounds::cube(1.0));
    let named = sample(&field, &settings).expect("a solid");
    let found = sample(FnField::new(value), &settings).expect("a solid");
    for sample in [&named, &found] {
        let topology = &sample.mesh().topology;
        assert!(topology.is_closed(), "{:?}", sample.report().warnings);
        assert_eq!((topology.euler(), sample.report().proof.creases), (2, Some(15)));
    }
    assert!(named.report().growth.calls < found.report().growth.calls, "nothing is searched for");
}
