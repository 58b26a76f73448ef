//! Tests that every component of the surface gets particles, however small or near another one, and
//! that the report says whether this is proven.

use crate::runs::{finished, run, session};
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::Report;
use marching_particles::field::Enclosure;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::field::{Field, Frame};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::particles::Particles;
use marching_particles::sampler::{Method, Sampling, Search, Settings, StopReason};

/// Samples in the cube of half-width `half`, with `share` of its diagonal as radius.
fn sampled(formula: &str, half: f64, share: f64) -> (Session, Report) {
    finished(formula, Bounds::cube(half), &settings!(radius_share: share; ..Settings::default()))
}

fn is_proven(report: &Report, context: &str) {
    assert_eq!(
        report.proof.search,
        Search::Proven,
        "{context}: {:?} undecided, {:?}",
        report.proof.undecided_cells,
        report.warnings
    );
    assert_eq!(report.proof.undecided_cells, Some(0), "{context}");
}

/// Product of the functions of balls, each given by its centre and radius.
fn balls(balls: &[([f64; 3], f64)]) -> String {
    let factors: Vec<String> = balls
        .iter()
        .map(|([x, y, z], r)| format!("((x - ({x}))^2 + (y - ({y}))^2 + (z - ({z}))^2 - ({r})^2)"))
        .collect();
    factors.join("*")
}

/// Number of particles relative to that of a hexagonal lattice on the area.
fn cover(report: &Report, area: f64) -> f64 {
    report.count as f64 * 2.0 * 3.0_f64.sqrt() * report.sizes.radius * report.sizes.radius / area
}

/// Function of the union of solids given by their functions.
fn least(parts: &[String]) -> String {
    parts.iter().skip(1).fold(parts[0].clone(), |all, part| format!("min({all}, {part})"))
}

#[test]
fn two_spheres_a_thousandth_apart_are_two_components() {
    let pair = [([-0.4005, 0.013, 0.021], 0.4), ([0.4005, 0.013, 0.021], 0.4)];
    for formula in [balls(&pair), least(&pair.map(|ball| balls(&[ball])))] {
        let (session, report) = sampled(&formula, 1.0, 0.01);
        is_proven(&report, &formula);
        assert_eq!(report.proof.components, 2, "{formula}");
        assert_eq!(report.measures.quality.map(|q| q.connectivity.euler), Some(4), "{formula}");
        // The component labels distinguish the two.
        let component = &session.run.measured().component;
        for (p, &label) in session.run.particles().local.iter().zip(component) {
            let left = session.run.particles().local.iter().zip(component).find(|(q, _)| q.x < 0.0);
            let same = left.is_some_and(|(_, &other)| other == label);
            assert_eq!(p.x < 0.0, same, "{formula}: {p} has the label {label}");
        }
    }
}

/// Distance from a box of these half-widths, negative inside, with edges rounded by `round`.
fn rounded_box(half: [f64; 3], round: f64) -> String {
    let sides: Vec<String> =
        ["x", "y", "z"].iter().zip(half).map(|(axis, half)| format!("abs({axis}) - {half}")).collect();
    let beyond: Vec<String> = sides.iter().map(|side| format!("max({side}, 0)")).collect();
    format!("hypot({}) + min(max({}), 0) - {round}", beyond.join(","), sides.join(","))
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn the_sheets_of_thin_shells_are_proven_to_be_found() {
    let ball = "hypot(x, y, z)";
    let torus = "hypot(hypot(x, y) - 1, z) - 0.35";
    let [side, end] = ["hypot(x, y) - 0.6", "abs(z) - 0.8"];
    let cylinder = format!("hypot(max({side}, 0), max({end}, 0)) + min(max({side}, {end}), 0) - 0.2");
    let mut cases: Vec<(String, usize, i64)> = Vec::new();
    for inner in [0.8, 0.9, 0.95, 0.99] {
        cases.push((format!("max({ball} - 1, {inner} - {ball})"), 2, 4));
        cases.push((format!("max(x^2 + y^2 + z^2 - 1, {inner}^2 - (x^2 + y^2 + z^2))"), 2, 4));
    }
    let shell_at = |x: f64| format!("max(hypot(x - ({x}), y, z) - 0.6, 0.55 - hypot(x - ({x}), y, z))");
    cases.extend([
        (format!("abs({ball} - 1) - 0.02"), 2, 4),
        (format!("abs({torus}) - 0.03"), 2, 0),
        (format!("abs({cylinder}) - 0.05"), 2, 4),
        (format!("abs({}) - 0.05", rounded_box([1.0, 0.7, 0.5], 0.2)), 2, 4),
        // Differences of two distances.
        (format!("max({ball} - 1, 0.88 - hypot(x - 0.07, y, z))"), 2, 4),
        (format!("max({torus}, 0.3 - hypot(x - 1, y, z))"), 2, 2),
        (format!("max({}, 0.95 - {ball})", rounded_box([0.8; 3], 0.2)), 2, 4),
        (format!("max({ball} - 1, -({}))", rounded_box([0.45; 3], 0.1)), 2, 4),
        // Four sheets, and a ball within a shell, through which both sides of the shell pass.
        (format!("min({}, {})", shell_at(-0.8), shell_at(0.8)), 4, 8),
        (format!("max(abs({torus}) - 0.1, hypot(x - 1.35, y, z) - 0.08)"), 1, 2),
    ]);
    for (formula, components, euler) in cases {
        let (_, report) = sampled(&formula, 1.5, 0.008);
        is_proven(&report, &formula);
        assert_eq!(report.proof.components, components, "{formula}");
        assert_eq!(report.measures.quality.map(|q| q.connectivity.euler), Some(euler), "{formula}");
    }
}

#[test]
fn the_components_of_plain_solids_with_edges_are_proven_to_be_found() {
    let cube = "max(abs(x), abs(y), abs(z))";
    let ball = |x: f64, r: f64| format!("(x - ({x}))^2 + y^2 + z^2 - {}", r * r);
    let (one, beside) = (ball(0.0, 1.0), ball(0.6, 0.8));
    let cases = [
        (format!("{cube} - 1"), 1, 2),
        ("max(x^2 + y^2, abs(z)) - 1".to_owned(), 1, 2),
        ("abs(x) + abs(y) + abs(z) - 1".to_owned(), 1, 2),
        ("max(0.866*abs(x) + 0.5*y, -y, abs(z) - 0.6) - 0.5".to_owned(), 1, 2),
        ("max(hypot(x, y) - (1 - z)/2, -z - 0.1)".to_owned(), 1, 2),
        ("max(x^2 + y^2, y^2 + z^2) - 1".to_owned(), 1, 2),
        (format!("min({one}, {beside})"), 1, 2),
        (format!("max({one}, {beside})"), 1, 2),
        (format!("max({one}, -({beside}))"), 1, 2),
        // With a hole, hollow, drilled along three axes, two halves with a gap, two of a kind.
        ("max(x^2 + y^2 - 1, abs(z) - 0.7, 0.3 - x^2 - y^2)".to_owned(), 1, 0),
        (format!("max({cube} - 1, 0.6 - {cube})"), 2, 4),
        (format!("max({cube} - 1, 1.3 - x^2 - y^2 - z^2)"), 1, -8),
        (format!("max({one}, 0.05 - abs(x + 0.2*y))"), 2, 4),
        ("max(abs(abs(x) - 0.7), abs(y), abs(z)) - 0.4".to_owned(), 2, 4),
        // Cut by the box.
        ("max(x, y, z) - 0.4".to_owned(), 1, 1),
    ];
    for (formula, components, euler) in cases {
        let (_, report) = sampled(&formula, 1.5, 0.012);
        is_proven(&report, &formula);
        assert_eq!(report.proof.components, components, "{formula}");
        assert_eq!(report.measures.quality.map(|q| q.connectivity.euler), Some(euler), "{formula}");
    }
}

#[test]
fn a_search_of_a_formula_that_proves_nothing_says_why() {
    // Spheres that cross, a sphere cut by a condition, steps, two cones that touch.
    for formula in [
        "(x^2 + y^2 + z^2 - 1)*((x - 0.8)^2 + y^2 + z^2 - 1)",
        "x^2 + y^2 + z^2 = 1 {z < 0.3}",
        "max(abs(x), abs(y), abs(z) + 0.3*floor(2*x)) - 0.8",
        "max(x^2 + y^2 - z^2, abs(z) - 1)",
    ] {
        let (_, report) = sampled(formula, 1.5, 0.015);
        let says = report.warnings.iter().any(|warning| warning.code() == "unproven");
        assert_eq!(says, report.proof.search == Search::Searched, "{formula}: {:?}", report.warnings);
    }
}

#[test]
fn a_component_that_goes_past_a_choice_stays_one() {
    // |x| is tied inside a capsule and a rounded box, where nothing depends on it.
    for formula in ["hypot(max(abs(x) - 1, 0), y, z) - 0.3".to_owned(), rounded_box([1.0, 0.7, 0.5], 0.2)] {
        let (_, report) = sampled(&formula, 1.5, 0.008);
        is_proven(&report, &formula);
        assert_eq!((report.proof.components, report.growth.components_seeded), (1, 1), "{formula}");
    }
}

#[test]
fn two_spheres_ten_diameters_apart_are_two_components() {
    let formula = balls(&[([-0.9, 0.1, 0.0], 0.09), ([0.9, -0.1, 0.05], 0.09)]);
    let (_, report) = sampled(&formula, 1.0, 0.004);
    is_proven(&report, &formula);
    assert_eq!((report.proof.components, report.growth.components_seeded), (2, 2));
}

#[test]
fn each_of_nested_spheres_is_a_component() {
    let formula = balls(&[([0.0; 3], 0.9), ([0.0; 3], 0.88), ([0.0; 3], 0.5), ([0.02, 0.0, 0.0], 0.3)]);
    let (session, report) = sampled(&formula, 1.0, 0.01);
    is_proven(&report, &formula);
    assert_eq!(report.proof.components, 4);
    // Labels are in order of size.
    let mut counts = [0_usize; 4];
    session.run.measured().component.iter().for_each(|&label| counts[label as usize] += 1);
    assert!(counts.is_sorted_by(|a, b| a >= b) && counts[3] > 0, "{counts:?}");
}

/// Sum of ten Gaussian densities on a ring.
fn metaballs(level: f64) -> String {
    let bells: Vec<String> = (0..10)
        .map(|k| {
            let angle = f64::from(k) * core::f64::consts::TAU / 10.0;
            let (x, y) = (libm::cos(angle), libm::sin(angle));
            format!("exp(-16*((x - ({x}))^2 + (y - ({y}))^2 + z^2))")
        })
        .collect();
    format!("{level} = {}", bells.join(" + "))
}

#[test]
fn ten_metaballs_are_ten_components_or_two() {
    let (_, apart) = sampled(&metaballs(0.7), 1.5, 0.006);
    is_proven(&apart, "apart");
    assert_eq!(
        (apart.proof.components, apart.measures.quality.map(|q| q.connectivity.euler)),
        (10, Some(20))
    );
    let (_, merged) = sampled(&metaballs(0.3), 1.5, 0.002);
    is_proven(&merged, "merged");
    assert_eq!(
        (merged.proof.components, merged.measures.quality.map(|q| q.connectivity.euler)),
        (1, Some(0))
    );
}

#[test]
fn each_link_of_a_chain_of_tori_is_a_component() {
    let torus = |centre: f64, flat: bool| {
        let (y, z) = if flat { ("y", "z") } else { ("z", "y") };
        format!("hypot(hypot(x - ({centre}), {y}) - 0.4, {z}) - 0.07")
    };
    let chain: Vec<String> = (0..4).map(|k| torus(-0.9 + 0.6 * f64::from(k), k % 2 == 0)).collect();
    let (_, report) = sampled(&least(&chain), 1.5, 0.0013);
    assert_eq!(
        (report.proof.components, report.measures.quality.map(|q| q.connectivity.euler)),
        (4, Some(0))
    );
    is_proven(&report, "chain");
}

#[test]
fn a_sphere_of_two_radii_in_a_large_box_is_found() {
    // The sphere is between the nodes of any grid of 32 cells a side, which are 0.0625 apart.
    let radius = 0.004;
    for centre in [[0.03, 0.03, 0.03], [-0.41, 0.72, 0.345], [0.97, -0.97, 0.03]] {
        let settings = settings!(radius_share: 0.5 * radius / 12.0_f64.sqrt(); ..Settings::default());
        let (session, report) = finished(&balls(&[(centre, radius)]), Bounds::cube(1.0), &settings);
        is_proven(&report, "tiny");
        assert_eq!(
            (report.stop_reason, report.proof.components),
            (Some(StopReason::Complete), 1),
            "{centre:?}"
        );
        let cover = cover(&report, 4.0 * core::f64::consts::PI * radius * radius);
        assert!((0.7..1.5).contains(&cover), "{centre:?}: {} particles are {cover} of a cover", report.count);
        for p in &session.run.particles().local {
            let d = p.as_dvec3() - glam::DVec3::from_array(centre);
            assert!((d.length() - radius).abs() < 1e-3 * radius, "{centre:?}: {p}");
        }
    }
}

#[test]
fn a_component_between_the_nodes_of_the_survey_is_found_beside_a_large_one() {
    let formula = least(&[
        balls(&[([-0.3, 0.0, 0.0], 0.5)]),
        format!("({}) / 0.05", balls(&[([0.53, 0.53, 0.53], 0.025)])),
    ]);
    let (session, report) = sampled(&formula, 1.0, 0.002);
    is_proven(&report, &formula);
    assert_eq!(report.proof.components, 2);
    let small = session.run.measured().component.iter().filter(|&&label| label == 1).count();
    assert!(small > 20, "{small} particles on the small sphere");
}

#[test]
fn each_of_many_pieces_of_one_factor_between_the_nodes_of_the_survey_is_found() {
    // Balls of radius 0.006: f is flat everywhere else, so that no node leads to them. Their
    // witnesses face the same way.
    let place = |k: i32| {
        DVec3::new(f64::from(k % 4) - 1.47, f64::from(k / 4 % 2) - 0.53, f64::from(k / 8) - 0.98) * 0.4
    };
    let centres: Vec<DVec3> = (0..24).map(place).collect();
    let bump = |c: &DVec3| format!(" - exp(-20000*((x-({}))^2+(y-({}))^2+(z-({}))^2))", c.x, c.y, c.z);
    let formula = format!("0.5{}", centres.iter().map(bump).collect::<String>());
    let (session, report) = sampled(&formula, 1.0, 0.0005);
    is_proven(&report, &formula);
    assert_eq!(
        (report.proof.components, report.proof.sampled.missing),
        (24, Some(0)),
        "{:?}",
        report.warnings
    );
    for centre in centres {
        let is_near = |p: &Vec3| (p.as_dvec3() - centre).length() < 0.01;
        assert!(session.run.particles().local.iter().any(is_near), "{centre}");
    }
}

#[test]
fn a_count_is_met_on_a_component_that_the_survey_misses() {
    let settings = settings!(size_mode: marching_particles::sampler::SizeMode::Count,
        count: 1_000; ..Settings::default());
    let (_, report) = finished(&balls(&[([0.03; 3], 0.01)]), Bounds::cube(1.0), &settings);
    assert!((970..=1_030).contains(&report.count), "{}", report.count);
}

#[test]
fn a_clipped_gyroid_is_proven_to_be_found_whole() {
    let formula = "sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x)";
    let (_, report) = sampled(formula, 6.3, 0.006);
    is_proven(&report, formula);
    assert!((1..=report.growth.components_seeded as usize).contains(&report.proof.components), "{report:?}");
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn gallery_surfaces_are_proven_to_be_found_and_their_boxes_cut_off_no_slivers() {
    // Thin parts, long blends and a high degree keep the search for further components from a
    // proof.
    const UNPROVEN: [&str; 3] = ["decocube", "drilled-block", "chmutov"];
    for surface in gallery::SURFACES.iter() {
        for share in [0.02, 0.006] {
            let mut session = Session::new();
            let request = FieldRequest { surface: Some(surface.id.into()), ..FieldRequest::default() };
            session.set_field(&request).unwrap();
            let report = run(&mut session, &settings!(radius_share: share; ..Settings::default()));
            let context = format!("{} at {share}", surface.id);
            if surface.id == "cayley" || surface.smooth && !UNPROVEN.contains(&surface.id) {
                is_proven(&report, &context);
            }
            let mut counts = vec![0; report.proof.components];
            session.run.measured().component.iter().for_each(|&label| counts[label as usize] += 1);
            // At 2 % the decocube's ridges are narrower than a spacing, and it is chance which
            // particles the triangles connect. Of ten seeds, three to five leave one or two
            // particles unconnected, with or without relaxation.
            let is_resolved = surface.smooth && (surface.id != "decocube" || share < 0.01);
            assert!(!is_resolved || counts.iter().all(|&count| count > 2), "{context}: {counts:?}");
        }
    }
}

#[test]
fn a_surface_that_touches_its_box_is_proven_to_be_found() {
    // The sphere touches all faces from inside, touches one face only, or is cut by one.
    for (centre, components) in [([0.0; 3], 1), ([0.0, 0.0, 1e-9], 1), ([0.3, 0.0, 0.0], 1)] {
        let formula = balls(&[(centre, 1.0)]);
        let (_, report) = sampled(&formula, 1.0, 0.01);
        is_proven(&report, &formula);
        assert_eq!(report.proof.components, components, "{formula}");
    }
    // The plane coincides with a face of the box.
    let bounds = Bounds { min: [-1.0, -1.0, 0.0], max: [1.0, 1.0, 1.0] };
    let (_, report) = finished("z", bounds, &settings!(radius_share: 0.01; ..Settings::default()));
    is_proven(&report, "z");
    assert_eq!(report.proof.components, 1);
}

#[test]
fn caps_that_the_box_cuts_off_are_components() {
    // Of a sphere larger than the box eight corners are left. Another one reaches through a face by
    // a hundredth.
    let (_, report) = sampled("x^2 + y^2 + z^2 - 2.5", 1.0, 0.008);
    is_proven(&report, "corners");
    assert_eq!(report.proof.components, 8);
    for axis in 0..3 {
        let mut centre = [0.013, -0.021, 0.017];
        centre[axis] = 1.09;
        let formula = balls(&[(centre, 0.1)]);
        let (_, report) = sampled(&formula, 1.0, 0.002);
        is_proven(&report, &formula);
        assert_eq!(report.proof.components, 1, "{formula}");
    }
}

#[test]
fn an_empty_surface_is_proven_empty() {
    for (formula, half) in [
        ("x^2 + y^2 + z^2 + 0.0001", 1.0),
        ("sin(x) + sin(y) + sin(z) - 3.01", 6.0),
        ("(x - 3)^2 + y^2 + z^2 - 0.9", 2.0),
        ("1/(x^2 + y^2 + z^2 - 0.5)", 1.0),
        ("x^4 + y^4 + z^4 - 2x^2 - 2y^2 - 2z^2 + 3.01", 2.0),
    ] {
        let mut session = session(formula, Bounds::cube(half));
        session.start(&Settings::default()).unwrap();
        let progress = session.run.step(1_000);
        assert_eq!(progress.stop_reason, Some(StopReason::NoSurface), "{formula}");
        assert!(progress.message.is_some_and(|m| m.contains("proven")), "{formula}");
        is_proven(&session.report(), formula);
    }
}

#[test]
fn cone_points_leave_nothing_undecided() {
    // A cone off the centre, so that its circle in a face touches no edge, and the Cayley cubic at
    // the level of its cone points and at levels close to it.
    for formula in [
        "(x - 0.1)^2 + (y + 0.05)^2 = (z - 0.02)^2",
        "4(x^2 + y^2 + z^2) + 16x y z = 1",
        "4(x^2 + y^2 + z^2) + 16x y z = 1.00001",
        "4(x^2 + y^2 + z^2) + 16x y z = 0.99",
    ] {
        for share in [0.02, 0.006] {
            let (_, report) = sampled(formula, 1.6, share);
            is_proven(&report, formula);
        }
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_small_component_beside_a_cone_point_is_found() {
    // Small spheres inside and outside of the cone, so near to its apex that the cells around the
    // apex must shrink.
    for [x, y, z] in [[0.07, 0.03, 0.01], [0.2, -0.1, 0.03], [0.02, 0.01, 0.15]] {
        let bubble = format!("exp(-((x - {x})^2 + (y - ({y}))^2 + (z - {z})^2)/0.0001)");
        let value = 1.2 * x * x + 1.1 * y * y - z * z;
        let formula = format!("1.2x^2 + 1.1y^2 - z^2 = {} {bubble}", 2.0 * value);
        let (session, report) = sampled(&formula, 0.25, 0.002);
        is_proven(&report, &formula);
        let is_near = |p: &Vec3| (p.as_dvec3() - DVec3::new(x, y, z)).length() < 0.02;
        assert!(session.run.particles().local.iter().any(is_near), "{formula}");
    }
}

#[test]
fn discontinuous_gradients_hide_no_component() {
    // All extreme points of two octahedra and two boxes are at edges and corners.
    for formula in [
        "min(abs(x - 0.31) + abs(y - 0.17) + abs(z + 0.23) - 0.4, abs(x + 0.6) + abs(y + 0.6) + abs(z - 0.6) - 0.02)",
        "min(max(abs(x - 0.31), abs(y - 0.17), abs(z + 0.23)) - 0.4, max(abs(x + 0.6), abs(y + 0.6), abs(z - 0.6)) - 0.02)",
    ] {
        let (_, report) = sampled(formula, 1.0, 0.002);
        assert_eq!(report.growth.components_seeded.min(2), 2, "{formula}: {report:?}");
    }
    // The bounds of the second derivatives would exclude the component if they were used where they
    // do not hold.
    let field = Formula::as_written("abs(x) + abs(y) + abs(z) - 0.1", &[]).unwrap();
    let across = [-0.1, 0.1].map(|from| Bounds::new(DVec3::splat(from), DVec3::splat(0.2)));
    let mut known = [Enclosure::UNKNOWN; 2];
    field
        .evaluator(Frame::default())
        .bounded()
        .expect("a formula has bounds")
        .enclose(0, &across, &mut known);
    assert_eq!(known.map(|known| (known.continuous, known.smooth)), [(true, false), (true, true)]);
}

#[test]
fn the_branches_of_a_solid_share_the_cells_of_the_search() {
    let gyroid = gallery::find("gyroid").expect("the gallery has a gyroid");
    // A seventh of the cells is not enough for the gyroid, and far too many for the six faces.
    let solid = gyroid.field().closed_by(&gyroid.bounds);
    let around = gyroid.bounds.enlarged(0.5);
    let settings = settings!(radius_share: 0.02, bounds: Some(around); ..Settings::default());
    let sample = marching_particles::sample(solid, &settings).expect("a sample");
    assert_eq!(sample.report().proof.undecided_cells, Some(0));
}

#[test]
fn the_distance_to_a_solid_is_sampled_whole() {
    let distance = |u: &[&str]| {
        let outside: Vec<String> = u.iter().map(|u| format!("max({u}, 0)")).collect();
        format!("hypot({}) + min(max({}), 0)", outside.join(", "), u.join(", "))
    };
    let upright = distance(&["abs(x) - 0.8", "abs(y) - 0.5", "abs(z) - 0.3"]);
    let turned = distance(&["abs(0.8x + 0.6y) - 0.5", "abs(0.8y - 0.6x) - 0.4", "abs(z) - 0.3"]);
    let cylinder = distance(&["hypot(x, y) - 0.5", "abs(z) - 0.5"]);
    for (text, area, creases) in
        [(&upright, 6.32, 12), (&turned, 3.76, 12), (&cylinder, 1.5 * core::f64::consts::PI, 2)]
    {
        let (_, report) = sampled(text, 1.0, 0.015);
        let figures = report.measures.quality.expect("figures of particles");
        let found = (report.proof.components, figures.connectivity.euler, report.proof.creases);
        assert_eq!(found, (1, 2, Some(creases)), "{text}");
        assert!((figures.area / area - 1.0).abs() < 0.01, "{text}: {}", figures.area);
        assert_eq!((report.proof.undecided_cells, &report.warnings[..]), (Some(0), &[][..]), "{text}");
        assert_eq!(report.proof.search, Search::Proven, "{text}");
    }
    // The branches say how the surface bends: f itself has no gradient on it.
    let settings = settings!(radius_share: 0.008, method: Method::Refined; ..Settings::default());
    let (_, report) = finished(&upright, Bounds::cube(1.0), &settings);
    assert_eq!(report.warnings, []);
}

#[test]
fn search_ends_on_singular_surfaces_and_reports_undecided_cells() {
    for (formula, half) in [
        ("y^2 - x^3", 1.0),
        ("max(x^2 + y^2 + z^2 - 0.5, 0)", 1.0),
        ("x^2 + y^2 + z^2 - 0.6 + 0*ln(x)", 1.0),
        ("floor(5x)/5 - y", 1.0),
    ] {
        let (_, report) = sampled(formula, half, 0.02);
        let open = report.proof.undecided_cells.expect("a formula is searched by proof");
        assert_eq!(report.proof.search, Search::Searched, "{formula}");
        assert!(open > 0 && open < 200_000, "{formula}: {open}");
        assert!(report.stop_reason.is_some(), "{formula}");
    }
}

#[test]
fn thin_sheets_nearer_than_a_spacing_are_never_joined() {
    // A plate, a flat ellipsoid, and nested shells have sheets a tenth and a third of a spacing
    // apart.
    let shells = balls(&[([0.0; 3], 0.7), ([0.0; 3], 0.69), ([0.0; 3], 0.66), ([0.0; 3], 0.65)]);
    let sheet = |p: Vec3| -> u32 {
        let d = p.length();
        [0.7_f32, 0.69, 0.66, 0.65].iter().position(|r| (d - r).abs() < 2e-3).expect("on a shell") as u32
    };
    let share = 0.05 / 12.0_f64.sqrt();
    let (nested, report) = sampled(&shells, 1.0, share);
    assert_eq!(report.proof.components, 4, "{report:?}");
    check(nested.run.particles(), &sheet, "shells");
    let labels = &nested.run.measured().component;
    for (p, &label) in nested.run.particles().local.iter().zip(labels) {
        let other = nested.run.particles().local.iter().zip(labels).find(|(q, _)| sheet(**q) == sheet(*p));
        assert_eq!(other.map(|(_, &label)| label), Some(label));
    }
    let cover = cover(&report, 4.0 * core::f64::consts::PI * (0.49 + 0.4761 + 0.4356 + 0.4225));
    assert!((0.9..1.2).contains(&cover), "{cover}");

    let as_placed = settings!(radius_share: share, relax_steps: 0; ..Settings::default());
    let (session, _) = finished("(x^2 + y^2)/0.81 + z^2/0.0001 - 1", Bounds::cube(1.0), &as_placed);
    // The two sheets meet at the rim.
    check(
        session.run.particles(),
        &|p| if p.truncate().length() > 0.85 { 2 } else { u32::from(p.z > 0.0) },
        "ellipsoid",
    );
    let (planes, report) = sampled("z^2 - 0.000025", 1.0, share);
    check(planes.run.particles(), &|p| u32::from(p.z > 0.0), "planes");
    assert_eq!(report.proof.components, 2);
}

#[test]
fn factors_are_searched_one_by_one() {
    // Where planes cross, their product has no gradient, but each plane has one.
    for (formula, components) in [("(x - 0.1)(x + 0.1)(x^2 + y^2 + z^2 - 4)", 2), ("-3 x / (y - 2)", 1)] {
        let (_, report) = sampled(formula, 1.0, 0.02);
        is_proven(&report, formula);
        assert_eq!(report.proof.components, components, "{formula}");
    }
}

/// Checks that every child is on the sheet of its parent.
fn check(particles: &Particles, sheet: &dyn Fn(Vec3) -> u32, context: &str) {
    assert!(particles.len() > 200, "{context}: {} particles", particles.len());
    for i in 0..particles.len() {
        let parent = particles.parent[i];
        if parent != Particles::NO_PARENT {
            let (p, q) = (particles.local[i], particles.local[parent as usize]);
            let facing = particles.normal[i].dot(particles.normal[parent as usize]);
            assert!(facing > 0.0, "{context}: {p} is a child of {q}, which faces the other way");
            let sheets = (sheet(p), sheet(q));
            assert!(
                sheets.0 == sheets.1 || sheets.0.max(sheets.1) > 1 && context == "ellipsoid",
                "{context}: {p} is a child of {q}"
            );
        }
    }
}

#[test]
fn cutting_a_run_into_steps_changes_nothing() {
    let formula = least(&[
        balls(&[([-0.3, 0.0, 0.0], 0.5)]),
        format!("({}) / 0.05", balls(&[([0.53, 0.53, 0.53], 0.025)])),
    ]);
    let run = |budget: u32| {
        let mut session = session(&formula, Bounds::cube(1.0));
        session.start(&settings!(radius_share: 0.005; ..Settings::default())).unwrap();
        while session.run.step(budget).stop_reason.is_none() {}
        (session.run.particles().digest(), session.report().proof.undecided_cells)
    };
    let whole = run(u32::MAX);
    assert_eq!(run(1), whole);
    assert_eq!(run(77), whole);
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn sheets_that_face_the_same_way_hold_particles_each_however_near() {
    // A thousandth of a radius apart on spheres, and a hundredth on planes.
    let formula = "(x^2+y^2+z^2-1)*(x^2+y^2+z^2-1.0002)*(x^2+y^2+z^2-1.0004)";
    for share in [0.006, 0.0019] {
        let (session, report) = sampled(formula, 1.5, share);
        let mut counts = [0_usize; 3];
        for p in &session.run.particles().local {
            let sheet = (p.as_dvec3().length() - 1.0) * 1e4;
            counts[(sheet + 0.5).clamp(0.0, 2.0) as usize] += 1;
        }
        let expected =
            4.0 * core::f64::consts::PI / (2.0 * 3.0_f64.sqrt() * report.sizes.radius * report.sizes.radius);
        for count in counts {
            let cover = count as f64 / expected;
            assert!((0.9..1.2).contains(&cover), "{formula} at {share}: {counts:?} for {expected}");
        }
        assert_ne!(report.proof.sampled.missing, None);
    }
    for sampling in [Sampling::Adaptive, Sampling::Uniform] {
        let settings = settings!(sampling, radius_share: 0.02; ..Settings::default());
        let (session, report) = finished("z*(z-0.001)*(z-0.002)", Bounds::cube(1.0), &settings);
        let on = |height: f32| {
            session.run.particles().local.iter().filter(|p| (p.z - height).abs() < 2e-4).count()
        };
        let counts = [0.0, 0.001, 0.002].map(on);
        let alike =
            counts.iter().all(|&count| (0.9..1.1).contains(&(3.0 * count as f64 / report.count as f64)));
        assert!(alike && counts[0] > 50, "{sampling:?}: {counts:?}");
        is_proven(&report, "planes");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn sheets_that_face_the_same_way_are_counted_apart_at_any_distance() {
    let spheres = |gap: f64| balls(&[0.0, 1.0, 2.0].map(|k| ([0.0; 3], 1.0 + k * gap)));
    for gap in [3e-2, 1e-3, 1e-4, 3e-5] {
        let (session, report) = sampled(&spheres(gap), 1.5, 0.01);
        let context = format!("gap {gap}: {:?}", report.warnings);
        is_proven(&report, &context);
        assert_eq!(
            (report.proof.components, report.measures.quality.map(|q| q.connectivity.euler)),
            (3, Some(6)),
            "{context}"
        );
        let area = report.measures.quality.map_or(0.0, |q| q.area) / (12.0 * core::f64::consts::PI);
        assert!((0.99..1.06).contains(&area), "{context}: {area}");
        // Every component is a sphere.
        for label in 0..3 {
            let of_it = session.run.particles().local.iter().zip(&session.run.measured().component);
            let distances = of_it.filter(|(_, l)| **l == label).map(|(p, _)| f64::from(p.length()));
            let [least, most] = distances.fold([2.0, 0.0_f64], |[lo, hi], d| [d.min(lo), d.max(hi)]);
            assert!(most - least < 0.5 * gap, "{context}: from {least} to {most}");
        }
    }
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        for (planes, gap) in [(3, 1e-3), (3, 1e-4), (5, 1e-3), (7, 1e-3)] {
            let factors: Vec<String> = (0..planes).map(|k| format!("(z-{})", f64::from(k) * gap)).collect();
            let settings = settings!(sampling, radius_share: 0.02; ..Settings::default());
            let (_, report) = finished(&factors.join("*"), Bounds::cube(1.0), &settings);
            is_proven(
                &report,
                &report.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "),
            );
            assert_eq!(report.proof.components, planes as usize, "{sampling:?}, {planes} planes {gap} apart");
        }
    }
}

#[test]
fn a_piece_smaller_than_a_particle_beside_a_large_one_is_sampled_or_named() {
    let r = 0.05;
    let share = r / 12.0_f64.sqrt();
    for size in [1.4 * r, 1.2 * r, 0.3 * r, 0.05 * r] {
        let tiny = ([0.0, 0.0, 0.5 + 0.3 * r + size], size);
        let formula = balls(&[([0.0; 3], 0.5), tiny]);
        let (session, report) = sampled(&formula, 1.0, share);
        is_proven(&report, &formula);
        let on_it = |p: &Vec3| ((p.as_dvec3() - DVec3::from_array(tiny.0)).length() - size).abs() < 0.01 * r;
        if session.run.particles().local.iter().any(on_it) {
            assert_eq!(
                (report.proof.sampled.missing, report.proof.sampled.above),
                (Some(0), Some(0.0)),
                "{formula}"
            );
        } else {
            assert!(size < r, "{formula}: a piece as large as a particle holds one");
            let [named] = report.proof.sampled.without[..] else {
                panic!("{formula}: {:?}", report.proof.sampled)
            };
            assert!((named.reach / (2.0 * size) - 1.0).abs() < 0.1 && !named.goes_on, "{formula}: {named:?}");
            let place = DVec3::from_array(named.position) - DVec3::from_array(tiny.0);
            assert!((place.length() / size - 1.0).abs() < 0.01, "{formula}: {named:?}");
            assert_eq!(report.proof.sampled.above, Some(named.reach), "{formula}");
            assert!(
                report.warnings.iter().any(|w| w.to_string().contains("have no particle")),
                "{:?}",
                report.warnings
            );
        }
    }
}

/// Particles and names of an ellipsoid with half-axes of `size`, `size` and 3 `size`, around a
/// place this far up the z-axis, beside the unit sphere.
fn told_of_a_small_ellipsoid(size: f64, height: f64, r: f64) -> (usize, usize, Report) {
    let formula = format!("(x^2+y^2+z^2-1)*(x^2+y^2+(z-{height})^2/9-{})", size * size);
    let (session, report) = sampled(&formula, 1.5, r / 27.0_f64.sqrt());
    let half_axes = DVec3::new(size, size, 3.0 * size);
    let is_on_it = |p: DVec3| (((p - height * DVec3::Z) / half_axes).length() - 1.0).abs() < 0.1;
    let particles = session.run.particles().local.iter().filter(|p| is_on_it(p.as_dvec3())).count();
    let names = report
        .proof
        .sampled
        .without
        .iter()
        .filter(|named| is_on_it(DVec3::from_array(named.position)))
        .count();
    (particles, names, report)
}

#[test]
fn a_small_ellipsoid_beside_a_large_sphere_holds_a_particle() {
    let r = 0.05;
    for k in 0..20 {
        // From 0.08 r to 0.5 r, at 0.1 r to 0.9 r above the sphere.
        let size = 0.08 * r * 1.1_f64.powi(k);
        let height = 1.0 + 3.0 * size + r * (0.1 + 0.2 * f64::from(k % 5));
        let (particles, names, report) = told_of_a_small_ellipsoid(size, height, r);
        is_proven(&report, &format!("{size}"));
        assert!(particles > 0 && names == 0, "{size}: {particles} particles, {:?}", report.proof.sampled);
    }
}

#[test]
fn a_small_ellipsoid_across_a_large_sphere_holds_a_particle() {
    let r = 0.05;
    for k in 0..20 {
        let size = 0.08 * r * 1.1_f64.powi(k);
        let (particles, names, report) = told_of_a_small_ellipsoid(size, 1.0, r);
        assert!(particles > 0 && names == 0, "{size}: {particles} particles, {:?}", report.proof.sampled);
    }
}

#[test]
fn sheets_within_the_probe_of_a_survey_are_not_taken_for_one_that_f_touches() {
    let says_so = |formula: &str, sampling: Sampling| {
        let settings = settings!(sampling, radius_share: 0.02, relax_steps: 0; ..Settings::default());
        let (_, report) = finished(formula, Bounds::cube(1.0), &settings);
        report.warnings.iter().any(|warning| warning.to_string().contains("without changing its sign"))
    };
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        assert!(!says_so("z*(z-0.001)*(z-0.002)", sampling), "{sampling:?}");
        assert!(!says_so("z*(z-0.0005)", sampling), "{sampling:?}");
        assert!(says_so("1 - cos(x+y+z)", sampling), "{sampling:?}");
    }
}

#[test]
fn where_the_search_is_open_because_f_is_beyond_double_precision_the_report_says_so() {
    let product = |k: f64| {
        let ball = |centre: f64| format!("(exp({k}*((x-({centre}))^2+y^2+z^2))-exp({k}))");
        format!("{}*{}", ball(0.0), ball(2.5))
    };
    let says_so =
        |report: &Report| report.warnings.iter().any(|warning| warning.to_string().contains("overflows"));
    // Beyond single precision alone.
    let (_, report) = sampled(&product(5.0), 3.6, 0.02);
    assert!(
        !says_so(&report) && report.proof.components == 2,
        "{} {:?}",
        report.proof.components,
        report.warnings
    );
    let (_, report) = sampled(&product(100.0), 3.6, 0.02);
    let is_whole = report.proof.search == Search::Proven && report.proof.components == 2;
    assert!(is_whole || says_so(&report), "{} {:?}", report.proof.components, report.warnings);
}
