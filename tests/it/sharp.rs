//! Solids with sharp edges, from the formula to the mesh: closed, of the right Euler number, with
//! the right volume.

use crate::cases;
use crate::solid_table::{SOLIDS, Solid};
use core::f64::consts::PI;
use glam::{DMat3, DQuat, DVec3, DVec4};
use marching_particles::{Field, Formula, Method, Sample, Settings, Warning, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Checks that the mesh of every solid is closed and keeps its edges, and that it has fewer defects
/// once it is refined.
fn check(settings: Settings) {
    for Solid { name, formula, euler, volume: exact, creases } in SOLIDS {
        let runs = [settings, settings.refined()].map(|settings| {
            let field = Formula::parse(formula).expect("a formula");
            sample(field, &settings).expect("a sample")
        });
        let Settings { count, sampling, .. } = settings;
        let name = format!("{name}, {count} particles, {sampling:?}");
        // With few particles chance decides; the faces of the octahedron have no defects.
        let [front, refined] = runs.each_ref().map(six);
        assert!(count == 1_500 || refined > front || refined == 1.0, "{name}: {refined} after {front}");
        for (sample, method) in runs.iter().zip([Method::Front, Method::Refined]) {
            let name = format!("{name}, {method:?}");
            assert_eq!(sample.report().growth.refined_levels.is_some(), method == Method::Refined, "{name}");
            let components = &sample.mesh().topology.components;
            assert_eq!(components.len(), 1, "{name}");
            assert_eq!((components[0].euler(), components[0].border_edges), (euler, 0), "{name}");
            // Flat faces lose nothing; round ones their distance from a chord, of the order of the
            // square of the spacing.
            let found = sample.volume().expect("a closed mesh");
            let slack = 12.0 / f64::from(count);
            assert!((found / exact - 1.0).abs() <= slack, "{name}: volume {found} for {exact}");
            let rows = sample.particles();
            let proof = &sample.report().proof;
            assert_eq!([proof.creases, proof.corners], creases.map(Some), "{name}");
            for (i, &first) in rows.twins.iter().enumerate() {
                let [own, other] = [i, first as usize].map(|row| (rows.local[row], rows.radius[row]));
                assert_eq!(own, other, "{name}: row {i}");
            }
        }
    }
}

#[test]
fn the_mesh_of_a_solid_of_few_particles_is_closed_and_keeps_its_edges() {
    check(Settings::with_count(1_500));
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn the_mesh_of_a_solid_is_closed_and_keeps_its_edges_and_refined_it_has_fewer_defects() {
    check(Settings::with_count(6_000));
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn the_mesh_of_a_solid_whose_sizes_differ_is_closed_and_keeps_its_edges() {
    check(Settings::with_count(6_000).adaptive());
}

#[test]
fn parts_that_meet_without_an_edge_are_one_patch_beside_edges() {
    /// The distance to a box of 2 × 1.4 × 1.
    const BOX: &str = "hypot(max(abs(x) - 1, 0), max(abs(y) - 0.7, 0), max(abs(z) - 0.5, 0)) \
                       + min(max(abs(x) - 1, abs(y) - 0.7, abs(z) - 0.5), 0)";
    const ROD: &str = "min(max(hypot(x, y) - 0.5, abs(z) - 1), hypot(x, y, z - 1) - 0.5)";
    let shell = 2.312 + 0.044 * PI + 0.004 / 3.0 * PI;
    let half_capsule = 0.25 * PI + PI / 12.0;
    let cases = [
        // A rounded box around one with edges.
        (format!("abs({BOX}) - 0.1"), (2, 4), Some(shell), [12, 8]),
        // A ball without the box within it.
        (format!("max(hypot(x, y, z) - 1.6, -({BOX}))"), (2, 4), None, [12, 8]),
        (format!("max({BOX} - 0.2, 0.4 - hypot(x, y))"), (1, 0), None, [2, 0]),
        (format!("max({ROD}, 0.2 - hypot(x, z - 0.3))"), (1, 0), None, [3, 0]),
        ("max(hypot(x - clamp(x, -1, 1), y, z) - 0.5, y)".into(), (1, 2), Some(half_capsule), [1, 0]),
        ("max(hypot(max(hypot(x, y) - 0.6, 0), max(abs(z) - 0.5, 0)) - 0.3, x)".into(), (1, 2), None, [1, 0]),
    ];
    for (formula, (components, euler), volume, creases) in cases {
        check_closed(&formula, [components, euler], volume, creases);
    }
}

/// Checks that the refined mesh of a solid is closed and has so many components, this Euler number
/// and volume, and that its surface has so many creases and corners.
fn check_closed(formula: &str, topology: [i64; 2], volume: Option<f64>, creases: [usize; 2]) {
    let field = Formula::parse(formula).expect("a formula");
    let sample = sample(field, &Settings::with_count(6_000).refined()).expect("a sample");
    assert!(sample.report().growth.refined_levels.is_some(), "{formula}");
    let components = &sample.mesh().topology.components;
    let euler = components.iter().map(|component| component.euler()).sum::<i64>();
    let borders: u32 = components.iter().map(|component| component.border_edges).sum();
    assert_eq!(([components.len() as i64, euler], borders), (topology, 0), "{formula}");
    let proof = &sample.report().proof;
    assert_eq!([proof.creases, proof.corners], creases.map(Some), "{formula}");
    assert_eq!(proof.undecided_cells, Some(0), "{formula}");
    if let Some(exact) = volume {
        let found = sample.volume().expect("a closed mesh");
        assert!((found / exact - 1.0).abs() < 0.005, "{formula}: volume {found} for {exact}");
    }
}

#[test]
fn floors_and_folded_angles_bend_a_solid_at_edges() {
    let cases = [
        // A zigzag roof, with one slope and with another.
        ("max(abs(x) - 2, abs(y) - 1, z - abs(x - floor(x + 0.5)), -z - 1)", [1, 2], Some(10.0), [33, 22]),
        ("max(abs(x) - 3, abs(y) - 1, z - 4*abs(x/2 - round(x/2)), -z - 1)", [1, 2], Some(24.0), [27, 18]),
        ("max(z - asin(sin(x)), -z - 2, abs(x) - 2, abs(y) - 1)", [1, 2], Some(16.0), [18, 12]),
        // Rods in cells, and a hole through two of them.
        (
            "max(hypot(mod(x, 1) - 0.5, mod(y, 1) - 0.5) - 0.3, abs(x) - 2, abs(y) - 2, abs(z) - 0.5)",
            [16, 32],
            None,
            [32, 0],
        ),
        (
            "max(abs(x) - 1, abs(y) - 1, abs(z) - 1, 0.5 - max(abs(x - 2*round(x/2)), abs(y)))",
            [1, 0],
            Some(6.0),
            [24, 16],
        ),
    ];
    for (formula, topology, volume, creases) in cases {
        check_closed(formula, topology, volume, creases);
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_power_below_two_has_its_ridges_as_creases() {
    // The volume is 8 Γ(1 + 1/p)³ / Γ(1 + 3/p).
    let cases = [
        ("abs(x)^0.8 + abs(y)^0.8 + abs(z)^0.8 = 1", 0.701_51, 12),
        ("abs(x)^1.1 + abs(y)^1.1 + abs(z)^1.1 = 1", 1.669_07, 12),
        ("abs(x)^1.9 + abs(y)^1.9 + abs(z)^1.9 = 1", 3.971_86, 0),
        ("sqrt(abs(x)) + sqrt(abs(y)) + sqrt(abs(z)) = 1", 4.0 / 45.0, 12),
        // The hyperbolic octahedron.
        ("cbrt(x^2) + cbrt(y^2) + cbrt(z^2) = 1", 4.0 * PI / 35.0, 12),
        // In a solid, with a factor in the power.
        ("max((2*abs(x))^0.7 + z - 1, abs(x) - 0.5, abs(y) - 1, -z)", 2.0 - 2.0 / 1.7, 9),
        // Powers that end the solid: two roots in one function, one in a product, and one above 1.
        ("max(1 - sqrt(x) - sqrt(y), x - 2, y - 2, abs(z) - 0.2)", 1.6 - 0.4 / 6.0, 9),
        // The top of the second is upright where it meets the wall y = 0, without an edge.
        ("max(z - 0.2 - x*sqrt(y), x - 1, y - 1, -x, -z)", 0.2 + 1.0 / 3.0, 11),
        ("max(z - 1 - x^1.5, -z, x - 1, abs(y) - 1)", 2.8, 12),
    ];
    for (formula, exact, creases) in cases {
        let field = Formula::parse(formula).expect("a formula");
        let sample = sample(field, &Settings::with_count(8_000)).expect("a sample");
        let volume = sample.volume().expect("a closed mesh");
        assert!((volume / exact - 1.0).abs() < 0.02, "{formula}: volume {volume} for {exact}");
        let topology = &sample.mesh().topology;
        assert_eq!((topology.components.len(), topology.euler()), (1, 2), "{formula}");
        assert_eq!(sample.report().proof.creases.unwrap_or(0), creases, "{formula}");
    }
}

#[test]
fn a_solid_ends_where_one_of_its_functions_has_no_value() {
    let cases = [
        ("max(z - sqrt(1 - x^2), -z, abs(x) - 1, abs(y) - 1)", [1, 2], Some(PI), [6, 4]),
        ("max(z - sqrt(1 - x^2 - y^2), -z)", [1, 2], Some(2.0 / 3.0 * PI), [1, 0]),
        // A factor that is a parameter; those without a value of their own are 1.
        ("max(z - a sqrt(1 - x^2 - y^2), -z)", [1, 2], Some(2.0 / 3.0 * PI), [1, 0]),
        ("max(z + (a - 3) sqrt(1 - x^2 - y^2), -z - 0.5)", [1, 2], Some(11.0 / 6.0 * PI), [1, 0]),
        ("max(z + a sqrt(1 - x^2 - y^2), -z - 2, z + 0.5)", [1, 2], Some(31.0 / 24.0 * PI), [3, 0]),
        // A wall below the end of the root.
        ("max(z - sqrt(1 - x^2 - y^2) - 1, -z)", [1, 2], Some(5.0 / 3.0 * PI), [1, 0]),
        ("max(abs(y) - sqrt(x*(1 - x)), abs(z) - 0.2)", [1, 2], Some(0.1 * PI), [2, 0]),
        // Another power, and a root in a root.
        ("max(1 - 3*(1 - x^2 - y^2)^0.25 - z, z - 0.5)", [1, 2], None, [1, 0]),
        ("max(z - sqrt(1 - sqrt(x^2 + y^2 + 0.1)), -z)", [1, 2], None, [1, 0]),
        // f is positive inside.
        ("min(sqrt(1 - x^2) - z, z, 1 - abs(y))", [1, 2], Some(PI), [6, 4]),
    ];
    for (formula, topology, volume, creases) in cases {
        check_closed(formula, topology, volume, creases);
    }
}

#[test]
fn a_cutter_that_lies_flush_with_a_face_leaves_no_skin() {
    let blind = "max(max(hypot(x, y) - 1, -z, z - 1), -max(hypot(x, y) - 0.4, 0.5 - z, z - 1))";
    let slot = "max(max(abs(x) - 1, abs(y) - 1, abs(z) - 1), -max(abs(y) - 0.3, 0.5 - x, abs(z) - 1))";
    let cases = [
        (blind, [1, 2], Some(0.92 * PI), [4, 0], vec!["z - 1 = 0"]),
        // Written with another factor.
        (
            &blind.replace("0.4, 0.5 - z, z - 1", "0.4, 0.5 - z, 2*z - 2"),
            [1, 2],
            None,
            [4, 0],
            vec!["z - 1 = 0"],
        ),
        (slot, [1, 2], Some(8.0 - 0.6), [24, 16], vec!["z - 1 = 0", "-1 - z = 0"]),
    ];
    for (formula, topology, volume, creases, faces) in cases {
        check_closed(formula, topology, volume, creases);
        let facts = Formula::parse(formula).expect("a formula").facts();
        assert_eq!(facts.flush_faces, faces, "{formula}");
    }
    // Bodies in millimetres whose distances differ by a number around the origin.
    let rounded = "hypot(max(abs(x) - 50, 0), max(abs(y) - 50, 0), max(abs(z) - 50, 0))";
    let solid = Formula::parse(&format!("max({rounded} - 5, min({rounded} - 3, z))")).expect("a formula");
    assert_eq!(solid.value(DVec3::new(54.0, 0.0, 0.5)), 0.5);
    // Planes that coincide for one value of a parameter may part for another.
    let facts = Formula::parse("max(z - a, min(x, b - z))").expect("a formula").facts();
    assert_eq!(facts.flush_faces, Vec::<String>::new());
}

#[test]
fn creases_that_touch_share_a_particle() {
    // A ball that touches the edges of the cube in their middles. Beyond each face it has a cap of
    // the height √2 − 1.
    let [ball, cube] = ["hypot(x, y, z) - sqrt(2)", "max(abs(x), abs(y), abs(z)) - 1"];
    let height = 2.0_f64.sqrt() - 1.0;
    let caps = 6.0 * PI * height * height * (2.0_f64.sqrt() - height / 3.0);
    let whole = 4.0 / 3.0 * PI * 8.0_f64.sqrt();
    for (formula, euler, creases, exact) in [
        (format!("max({ball}, {cube})"), 2, [24, 12], whole - caps),
        (format!("min({ball}, {cube})"), 2, [48, 20], 8.0 + caps),
        // Eight pieces around the corners of the cube, which touch in twelve points.
        (format!("max({cube}, -({ball}))"), 8 * 2 - 12, [48, 20], 8.0 + caps - whole),
    ] {
        let sample = sample(Formula::parse(&formula).expect("a formula"), &Settings::with_count(8_000))
            .expect("a sample");
        let mesh = sample.mesh();
        let topology = &mesh.topology;
        assert_eq!(
            (topology.components.len(), topology.euler(), topology.borders.len()),
            (1, euler, 0),
            "{formula}"
        );
        assert!(mesh.left_out.is_empty(), "{formula}");
        // Where edges touch, it is not proven that all components were found.
        let warnings = &sample.report().warnings;
        assert!(warnings.iter().all(|warning| warning.code() == "unproven"), "{formula}: {warnings:?}");
        let proof = &sample.report().proof;
        assert_eq!([proof.creases, proof.corners], creases.map(Some), "{formula}");
        let volume = sample.volume().expect("a closed mesh");
        assert!((volume - exact).abs() < 0.02, "{formula}: volume {volume} for {exact}");
        for middle in [DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, -1.0)] {
            let is_there = |i: usize| sample.particles().place(i).distance(middle) < 1e-6;
            assert!((0..sample.particles().twins.len()).any(is_there), "{formula}: {middle}");
        }
    }
}

#[test]
fn no_particle_is_missed_on_a_face_that_two_bodies_share_inside() {
    let stacked = "min(max(hypot(x, y) - 0.5, -z, z - 1), max(hypot(x, y) - 0.3, 1 - z, z - 2))";
    check_closed(stacked, [1, 2], Some(0.34 * PI), [4, 0]);
    let sample = sample(Formula::parse(stacked).expect("a formula"), &Settings::with_count(6_000).refined())
        .expect("a sample");
    let codes: Vec<_> = sample.report().warnings.iter().map(Warning::code).collect();
    assert!(!codes.contains(&"without_particle"), "{codes:?}");
}

#[test]
fn no_warning_names_a_place_that_is_none() {
    // ∇f is infinite where the roof bends.
    let field = Formula::parse("max(z - asin(sin(x)), -z - 2, abs(x) - 2, abs(y) - 1)").expect("a formula");
    let sample = sample(field, &Settings::with_count(8_000).refined()).expect("a sample");
    assert!(sample.particles().normal.iter().all(|normal| normal.is_finite()));
    for warning in &sample.report().warnings {
        assert!(!warning.to_string().contains("NaN"), "{warning}");
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

/// A random number between two others, of three decimals.
fn between(random: &mut Pcg32, low: f64, high: f64) -> f64 {
    let share = f64::from(random.next_u32()) / f64::from(u32::MAX);
    ((low + (high - low) * share) * 1e3).round() / 1e3
}

/// A turned ball, box, cylinder, cone or half space with the origin inside.
fn body(random: &mut Pcg32) -> String {
    let turn = DVec4::from_array(core::array::from_fn(|_| between(random, -1.0, 1.0)));
    let turn = DMat3::from_quat(DQuat::from_vec4(turn.normalize_or(DVec4::W)));
    let [u, v, w] = turn.to_cols_array_2d().map(|[a, b, c]| {
        let offset = between(random, -0.2, 0.2);
        format!("({a:.4}*x + ({b:.4})*y + ({c:.4})*z + ({offset}))")
    });
    let [a, b, c] = core::array::from_fn(|_| between(random, 0.4, 0.8));
    match random.next_u32() % 5 {
        0 => format!("{u}^2 + {v}^2 + {w}^2 - {}", 2.0 * a * a),
        1 => format!("max(abs{u} - {a}, abs{v} - {b}, abs{w} - {c})"),
        2 => format!("max({u}^2 + {v}^2 - {}, abs{w} - {b})", a * a),
        3 => format!("max(hypot({u}, {v}) - {a}*({} - {w}), -{w} - {b})", 1.0 + c),
        _ => format!("{u} - {a}"),
    }
}

/// A solid of some bodies, of which each is united with those before it or cuts them.
fn random_solid(random: &mut Pcg32) -> String {
    let mut solid = format!("x^2 + y^2 + z^2 - {}", between(random, 0.8, 1.2));
    for _ in 0..2 + random.next_u32() % 3 {
        let name = if random.next_u32().is_multiple_of(4) { "min" } else { "max" };
        let own = body(random);
        // A half space would unite to something without an end.
        let own = if name == "min" { format!("max({own}, x^2 + y^2 + z^2 - 1.5)") } else { own };
        solid = format!("{name}({solid}, {own})");
    }
    solid
}

#[test]
fn the_mesh_of_a_front_on_a_random_solid_is_closed() {
    /// The share that was usual when the test was written.
    const CLOSED: f64 = 0.98;
    let (mut samples, mut closed) = (0, 0);
    for seed in cases::seeds(24) {
        let text = random_solid(&mut Pcg32::seed_from_u64(seed));
        for settings in [Settings::with_count(700), Settings::with_count(700).adaptive()] {
            samples += 1;
            closed += u64::from(cases::holds(|| {
                let sample = sample(Formula::parse(&text).expect("a formula"), &settings).expect("a sample");
                let topology = &sample.mesh().topology;
                let name = format!("{seed}, {:?}, {text}", settings.sampling);
                // All bodies are convex and hold the origin, so that from there every point of the
                // surface is seen.
                assert_eq!((topology.components.len(), topology.borders.len()), (1, 0), "{name}");
                assert_eq!(topology.components[0].euler(), 2, "{name}");
                assert!(sample.volume().is_some(), "{name}");
                let rows = sample.particles();
                for (i, &first) in rows.twins.iter().enumerate() {
                    assert_eq!(rows.radius[i], rows.radius[first as usize], "{name}: row {i}");
                }
            }));
        }
    }
    cases::assert_share(closed, samples, CLOSED, "closed meshes");
}

/// Share of the particles with six neighbours.
fn six(sample: &Sample) -> f64 {
    sample.report().measures.quality.as_ref().expect("figures").order.six_neighbours
}
