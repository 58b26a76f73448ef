//! Functions of which nothing but values is known, with edges.

use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};
use marching_particles::{
    Bounds, FnField, Method, PiecewiseFn, Sample, Settings, sample, smooth_union, union,
};

type Function = Box<dyn Fn(DVec3) -> f64 + Send + Sync>;

/// A solid, with the Euler number of its surface, its creases and corners, and its volume where
/// that is known.
struct Solid {
    name: &'static str,
    euler: i64,
    creases: usize,
    corners: usize,
    volume: Option<f64>,
    f: Function,
}

fn solid(
    name: &'static str,
    (euler, creases, corners): (i64, usize, usize),
    volume: impl Into<Option<f64>>,
    f: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
) -> Solid {
    Solid { name, euler, creases, corners, volume: volume.into(), f: Box::new(f) }
}

fn block(p: DVec3, half: DVec3) -> f64 {
    (p.abs() - half).max_element()
}

fn hexagon(p: DVec3, radius: f64, half: f64) -> f64 {
    let normals = [0.0, 1.0, 2.0].map(|k| DVec2::from_angle(k * core::f64::consts::FRAC_PI_3));
    let far = normals.into_iter().map(|n| p.truncate().dot(n).abs()).fold(0.0, f64::max);
    (far - radius).max(p.z.abs() - half)
}

/// A cube under a roof of this angle.
fn roof(p: DVec3, degrees: f64) -> f64 {
    let slope = (90.0 - 0.5 * degrees).to_radians();
    let n = dvec3(libm::sin(slope), 0.0, libm::cos(slope));
    block(p, DVec3::splat(0.8)).max(dvec3(p.x.abs(), p.y, p.z).dot(n) - 0.5)
}

fn nearest_of(x: f64, spacing: f64, most: f64) -> f64 {
    x - spacing * (x / spacing).round().clamp(-most, most)
}

fn solids() -> Vec<Solid> {
    let tau = core::f64::consts::TAU;
    let ball = |centre: f64, radius: f64| move |p: DVec3| p.distance(centre * DVec3::X) - radius;
    let tubes = |p: DVec3| {
        let across = [p.truncate().length(), libm::hypot(p.y, p.z), libm::hypot(p.x, p.z)];
        across.into_iter().fold(f64::INFINITY, f64::min) - 0.5
    };
    vec![
        solid("a cube", (2, 12, 8), 4.096, |p| block(p, DVec3::splat(0.8))),
        solid("a drilled block", (0, 14, 8), 4.0 - 0.16 * 0.5 * tau, |p| {
            block(p, dvec3(1.0, 1.0, 0.5)).max(0.4 - p.truncate().length())
        }),
        solid("a ball in a box, less three tubes", (-8, 24, 8), None, move |p| {
            (p.length() - 1.0).max(block(p, DVec3::splat(0.75))).max(-tubes(p))
        }),
        solid("two balls", (2, 1, 0), None, move |p| ball(0.5, 0.8)(p).min(ball(-0.5, 0.8)(p))),
        solid("a bitten ball", (2, 1, 0), None, move |p| ball(0.0, 0.9)(p).max(-ball(0.8, 0.6)(p))),
        solid("an octahedron", (2, 12, 6), 4.0 / 3.0, |p| (p.abs().element_sum() - 1.0) / 3.0_f64.sqrt()),
        solid("a bolt", (2, 18, 12), 1.8 * 2.0 * 3.0_f64.sqrt() * 0.25, |p| hexagon(p, 0.5, 0.9)),
        solid("a nut", (2, 18, 12), 0.6 * 2.0 * 3.0_f64.sqrt() * 0.81, |p| hexagon(p, 0.9, 0.3)),
        solid("a capped cone", (2, 2, 0), None, |p| {
            (p.truncate().length() - 0.5 * (0.8 - p.z)).max(p.z.abs() - 0.6)
        }),
        solid("an L", (2, 18, 12), 0.8 * (1.8 * 1.8 - 1.0 * 0.7), |p| {
            block(p, dvec3(0.9, 0.9, 0.4)).max((0.1 - p.x).min(-0.2 - p.y))
        }),
        solid("a twisted bar", (2, 12, 8), 1.6, |p| {
            let turned = DVec2::from_angle(0.7 * p.z).rotate(p.truncate());
            block(turned.extend(p.z), dvec3(0.5, 0.5, 0.8)) * 0.8
        }),
        // Within the bar its distance is that to a side, not one of the largest coordinate.
        solid("a twisted bar by its distance", (2, 12, 8), 1.92, |p| {
            let turned = DVec2::from_angle(0.8 * p.z).rotate(p.truncate());
            let q = turned.extend(p.z).abs() - dvec3(0.6, 0.4, 1.0);
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
        }),
        solid("two blocks that share a face", (2, 12, 8), 1.92, |p| {
            block(dvec3(p.x.abs() - 0.4, p.y, p.z), dvec3(0.4, 0.5, 0.6))
        }),
        solid("nine boxes by round", (18, 108, 72), 0.864, |p| {
            block(dvec3(nearest_of(p.x, 0.6, 1.0), nearest_of(p.y, 0.6, 1.0), p.z), dvec3(0.2, 0.2, 0.3))
        }),
        solid("a roof of 150°", (2, 15, 10), None, |p| roof(p, 150.0)),
        solid("a roof of 175°", (2, 15, 10), None, |p| roof(p, 175.0)),
        solid("a star", (2, 30, 20), None, move |p| {
            let angle = libm::atan2(p.y, p.x);
            let aside = (angle - (angle / tau * 5.0).round() * tau / 5.0).abs();
            let q = p.truncate().length() * dvec2(libm::cos(aside), libm::sin(aside));
            (q.x * 0.6 + q.y * 0.8 - 0.5).max(p.z.abs() - 0.4)
        }),
        solid("a lens", (2, 1, 0), None, |p| {
            (p - 0.8 * DVec3::Z).length().max((p + 0.8 * DVec3::Z).length()) - 1.0
        }),
        solid("a pipe", (0, 4, 0), 0.39 * 0.5 * tau * 1.4, |p| {
            let r = p.truncate().length();
            (r - 0.8).max(0.5 - r).max(p.z.abs() - 0.7)
        }),
        solid("stairs", (2, 24, 16), 1.4 * (1.8 * 0.6 + (1.2 + 0.6) * 0.5), |p| {
            let step = |x: f64, z: f64, half: f64| block(p - dvec3(x, 0.0, z), dvec3(half, 0.7, 0.3));
            step(0.0, -0.6, 0.9).min(step(0.3, -0.1, 0.6)).min(step(0.6, 0.4, 0.3))
        }),
        solid("a gear", (0, 4, 0), None, |p| {
            let r = p.truncate().length();
            (r - 0.8 - 0.08 * libm::sin(8.0 * libm::atan2(p.y, p.x))).max(0.3 - r).max(p.z.abs() - 0.2)
        }),
        solid("a bowl", (2, 2, 0), None, |p| ((p.length() - 0.9).abs() - 0.08).max(p.z - 0.3)),
        solid("a box of steep and flat functions", (2, 12, 8), 2.744, |p| {
            let q = p.abs() - 0.7;
            q.x.max(30.0 * q.y).max(0.05 * q.z)
        }),
        solid("a cube with its edges cut", (2, 48, 32), None, |p| {
            let q = p.abs();
            let cut = (q.x + q.y).max(q.y + q.z).max(q.z + q.x) / 2.0_f64.sqrt();
            (q.max_element() - 0.8).max(cut - 1.1)
        }),
    ]
}

/// Checks that a solid, straight or turned, comes out closed and with its edges.
fn check(Solid { name, euler, creases, corners, volume, f }: Solid, settings: &Settings, is_turned: bool) {
    let turn = DMat3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize_or_zero(), 0.7);
    let field = move |p: DVec3| if is_turned { f(turn * (p - dvec3(0.123, -0.2, 0.3))) } else { f(p) };
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
    let made = sample(union(cube(DVec3::ZERO), ball), &Settings::with_count(3_000)).expect("a solid");
    assert!(made.mesh().topology.is_closed(), "{:?}", made.report().warnings);
    assert_eq!(made.mesh().topology.euler(), 2);
    // The blend of two cubes that are apart has the edges of both.
    let blend = smooth_union(cube(DVec3::ZERO), cube(2.0 * DVec3::X), 0.1);
    let blended = sample(blend, &Settings::with_count(3_000)).expect("a solid");
    assert!(blended.mesh().topology.is_closed(), "{:?}", blended.report().warnings);
    assert_eq!(blended.report().proof.creases, Some(24));
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
