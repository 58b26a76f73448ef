//! Solids with sharp edges, from the formula to the mesh: closed, of the right Euler number, with the right volume.

use core::f64::consts::PI;
use glam::DVec3;
use marching_particles::{Formula, Method, Sample, Settings, sample};

/// A solid, with what is known of it.
struct Solid {
    name: &'static str,
    formula: &'static str,
    euler: i64,
    volume: f64,
    /// Number of creases and corners.
    creases: [usize; 2],
}

const fn solid(
    name: &'static str,
    formula: &'static str,
    euler: i64,
    volume: f64,
    creases: [usize; 2],
) -> Solid {
    Solid { name, formula, euler, volume, creases }
}

/// Volume of the union of two unit balls whose centres are 1 apart: two balls less their lens of 5π/12.
const TWO_BALLS: f64 = 8.0 * PI / 3.0 - 5.0 * PI / 12.0;

const SOLIDS: [Solid; 14] = [
    solid("cube", "max(abs(x), abs(y), abs(z)) - 1", 2, 8.0, [12, 8]),
    solid(
        "turned cube",
        "max(abs(0.36x + 0.48y - 0.8z), abs(-0.8x + 0.6y), abs(0.48x + 0.64y + 0.6z)) - 1",
        2,
        8.0,
        [12, 8],
    ),
    solid("octahedron", "abs(x) + abs(y) + abs(z) - 1", 2, 4.0 / 3.0, [12, 6]),
    solid("cylinder", "max(x^2 + y^2 - 1, abs(z) - 1)", 2, 2.0 * PI, [2, 0]),
    solid(
        "lens",
        "max((z - 0.5)^2 + x^2 + y^2 - 1, (z + 0.5)^2 + x^2 + y^2 - 1)",
        2,
        5.0 * PI / 12.0,
        [1, 0],
    ),
    solid("two balls", "min((x - 0.5)^2 + y^2 + z^2 - 1, (x + 0.5)^2 + y^2 + z^2 - 1)", 2, TWO_BALLS, [1, 0]),
    solid("bitten ball", "max(x^2 + y^2 + z^2 - 1, 1 - (x - 1)^2 - y^2 - z^2)", 2, 11.0 * PI / 12.0, [1, 0]),
    solid(
        "drilled block",
        "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.4, 0.16 - x^2 - y^2)",
        0,
        0.8 * (4.0 - 0.16 * PI),
        [14, 8],
    ),
    solid(
        "plate with four holes",
        "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.2, 0.04 - (abs(x) - 0.5)^2 - (abs(y) - 0.5)^2)",
        -6,
        0.4 * (4.0 - 0.16 * PI),
        [20, 8],
    ),
    // The edges of each pair cross where the surface is smooth.
    solid("three cylinders", "max(x^2 + y^2, y^2 + z^2, z^2 + x^2) - 1", 2, 4.686_291_501, [24, 14]),
    solid(
        "L",
        "max(min(max(abs(x - 0.5) - 0.5, abs(y - 1) - 1), max(abs(x - 1) - 1, abs(y - 0.5) - 0.5)), abs(z) - 0.5)",
        2,
        3.0,
        [18, 12],
    ),
    solid(
        "wedge of 10°",
        "max(z, 0.176327x - z, abs(y) - 1, -x - 1.5)",
        2,
        2.0 * 0.5 * 1.5 * 1.5 * 0.176_327,
        [9, 6],
    ),
    solid("half ball", "max(x^2 + y^2 + z^2 - 1, z)", 2, 2.0 * PI / 3.0, [1, 0]),
    solid(
        "prism",
        "max(abs(z) - 1, y - 0.5, 0.866025x - 0.5y - 0.5, -0.866025x - 0.5y - 0.5)",
        2,
        2.598_076 * 1.0,
        [9, 6],
    ),
];

#[test]
fn the_mesh_of_a_solid_is_closed_and_keeps_its_edges() {
    for Solid { name, formula, euler, volume: exact, creases } in SOLIDS {
        let runs = [1_500, 6_000].into_iter().flat_map(|count| {
            let settings = Settings::with_count(count);
            [settings, settings.refined()]
        });
        for settings in runs {
            let Settings { count, method, .. } = settings;
            let field = Formula::parse(formula).expect("a formula");
            let sample = sample(field, &settings).expect("a sample");
            let name = format!("{name}, {count} particles, {method:?}");
            assert_eq!(sample.report().growth.refined_levels.is_some(), method == Method::Refined, "{name}");
            let components = &sample.mesh().topology.components;
            assert_eq!(components.len(), 1, "{name}");
            assert_eq!((components[0].euler(), components[0].border_edges), (euler, 0), "{name}");
            // Flat faces lose nothing; round ones their distance from a chord, of the order of the square of the spacing.
            let found = sample.volume().expect("a closed mesh");
            let slack = 8.0 / f64::from(count);
            assert!((found / exact - 1.0).abs() <= slack, "{name}: volume {found} for {exact}");
            let rows = sample.particles();
            let proof = &sample.report().proof;
            assert_eq!([proof.creases, proof.corners], creases.map(Some), "{name}");
            for (i, &first) in rows.twins.iter().enumerate() {
                assert_eq!(rows.position[i], rows.position[first as usize], "{name}: row {i}");
            }
        }
    }
}

#[test]
fn particles_on_a_crease_lie_on_it() {
    let field =
        Formula::parse("min((x - 0.5)^2 + y^2 + z^2 - 1, (x + 0.5)^2 + y^2 + z^2 - 1)").expect("a formula");
    let sample = sample(field, &Settings::with_count(3_000)).expect("a sample");
    let particles = sample.particles();
    let spacing = 2.0 * f64::from(particles.radius[0]);
    assert!(particles.twins.len() > 100);
    for i in 0..particles.twins.len() {
        // The circle x = 0, y² + z² = 3/4.
        let DVec3 { x, y, z } = particles.place(i);
        let off = x.abs().max(((y * y + z * z).sqrt() - 0.75_f64.sqrt()).abs());
        assert!(off < 1e-5 * spacing.max(1.0), "{off}");
    }
}

/// Share of the particles with six neighbours.
fn six(sample: &Sample) -> f64 {
    sample.report().measures.quality.as_ref().expect("figures").order.six
}

#[test]
fn a_refined_solid_has_fewer_defects_than_its_front() {
    for Solid { name, formula, .. } in SOLIDS {
        let settings = Settings::with_count(6_000);
        let [front, refined] = [settings, settings.refined()].map(|settings| {
            sample(Formula::parse(formula).expect("a formula"), &settings).expect("a sample")
        });
        // The faces of the octahedron have none.
        let is_better = six(&refined) > six(&front) || six(&refined) == 1.0;
        assert!(is_better, "{name}: {} after {}", six(&refined), six(&front));
    }
}
