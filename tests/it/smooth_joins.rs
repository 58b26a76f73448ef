//! Pieces that meet without an edge along one part of their border and at an angle along another,
//! as where a fillet fades out.

use glam::DVec3;
use marching_particles::export::Vertices;
use marching_particles::{Bounds, Field, Formula, Sample, Settings, sample};

/// Places on each axis of the grid on which a volume is summed up.
const SIDE: u32 = 100;

/// Volume of the solid f < 0 in a cube of this half-width, from a grid.
fn volume(field: &Formula, half: f64) -> f64 {
    let at = |k: u32| half * ((2.0 * f64::from(k) + 1.0) / f64::from(SIDE) - 1.0);
    let evaluator = &mut *field.evaluator(Default::default());
    let mut inside = 0_u32;
    for x in (0..SIDE).map(at) {
        for y in (0..SIDE).map(at) {
            for z in (0..SIDE).map(at) {
                inside += u32::from(evaluator.value_and_gradient(DVec3::new(x, y, z)).0 < 0.0);
            }
        }
    }
    f64::from(inside) * (2.0 * half / f64::from(SIDE)).powi(3)
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_solid_is_closed_where_an_edge_of_it_fades_out() {
    for text in [
        // A fillet between two planes, whose width falls to 0 and stays so.
        "max(smin(z, x, max(0, -y)), hypot(x, y, z) - 1)",
        "max(smin2(z, x, max(0, -y)), hypot(x, y, z) - 1)",
        // One between a plane and a ball, along half a circle.
        "max(smin(z, hypot(x, y, z) - 0.5, max(0, -y)), hypot(x, y, z) - 1)",
        // A plane, and beside it two sheets that rise from it: one without an edge, one with.
        "max(z - max(x, 0)*(x + max(y, 0)), hypot(x, y, z) - 1)",
        "max(z - max(x, 0)*(x + max(y, 0)^2), hypot(x, y, z) - 1)",
        // The same, turned and moved: no plane of a grid runs along the seam.
        "u = 0.6x - 0.8y - 0.03; v = 0.8x + 0.6y + 0.07; \
         max(z - max(u, 0)*(u + max(v, 0)), hypot(x, y, z) - 1)",
    ] {
        let field = Formula::parse(text).expect("a formula");
        let exact = volume(&field, 1.0);
        for settings in [Settings::with_count(5_000), Settings::with_count(5_000).refined()] {
            let what = format!("{text}, {:?}", settings.method);
            let sample = sample(field.clone(), &settings).expect("a sample");
            let topology = &sample.mesh().topology;
            assert!(topology.is_closed(), "{what}: {} borders", topology.borders.len());
            assert_eq!((topology.components.len(), topology.euler()), (1, 2), "{what}");
            let found = sample.volume().expect("a closed mesh");
            assert!((found / exact - 1.0).abs() < 0.01, "{what}: volume {found} for {exact}");
            let accuracy = &sample.report().measures.quality.as_ref().expect("figures").accuracy;
            assert!(accuracy.error_max < 1e-4, "{what}: off by {}", accuracy.error_max);
        }
    }
}

/// Checks that the mesh of a solid is closed, of one part without a hole, and has its volume. The
/// solid lies in a cube of this half-width.
fn check_closed(text: &str, half: f64, counts: &[u32]) {
    let field = Formula::parse(text).expect("a formula");
    let exact = volume(&field, half);
    for &count in counts {
        let sample = sample(field.clone(), &Settings::with_count(count)).expect("a sample");
        let topology = &sample.mesh().topology;
        assert!(topology.is_closed(), "{text}, {count}: {} borders", topology.borders.len());
        assert_eq!((topology.components.len(), topology.euler()), (1, 2), "{text}, {count}");
        let found = sample.volume().expect("a closed mesh");
        assert!((found / exact - 1.0).abs() < 0.01, "{text}, {count}: volume {found} for {exact}");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_solid_is_closed_where_a_fillet_begins_on_an_edge() {
    // There the fillet has two normals.
    let text = "max(smin(z, hypot(x, y, z) - 0.5, max(0, -y)), hypot(x, y, z) - 1.2)";
    check_closed(text, 1.2, &[3_000, 8_000]);
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_solid_is_closed_where_a_fillet_becomes_narrower_than_a_particle() {
    // Where it does so, its parts meet at an angle; beside it the same patches meet without one.
    for width in [0.005, 0.01, 0.02] {
        let text = format!("max(smin(z, x, max({width}, -y)), hypot(x, y, z) - 1)");
        check_closed(&text, 1.0, &[3_000, 8_000, 20_000]);
    }
}

#[test]
fn a_smooth_join_that_runs_to_the_box_ends_on_its_faces() {
    let field = Formula::parse("z = max(x, 0)*max(y, 0)").expect("a formula");
    let bounds = Bounds::cube(2.0);
    for settings in [Settings::with_count(4_000), Settings::with_count(4_000).refined()] {
        let sample = sample(field.clone(), &settings.in_box(bounds)).expect("a sample");
        let what = format!("{:?}", settings.method);
        assert_eq!(sample.report().warnings, [], "{what}");
        let topology = &sample.mesh().topology;
        assert_eq!((topology.components.len(), topology.euler()), (1, 1), "{what}");
        assert_eq!(topology.borders.len(), 1, "{what}");
        // Both smooth joins have a particle on the face to which they run.
        for end in [DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, -2.0, 0.0)] {
            let distances = (0..sample.particles().len()).map(|i| sample.particles().place(i).distance(end));
            let least = distances.fold(f64::MAX, f64::min);
            assert!(least < 1e-4, "{what}: {least} from {end}");
        }
    }
}

/// The sample of z = max(x, 0) max(y, 0) in a cube, which has an edge where one coordinate is 0 and
/// the other positive, and a smooth join where it is negative: the angle at the edge is that other
/// one's.
fn half_edged(settings: &Settings) -> Sample {
    let field = Formula::parse("z = max(x, 0)*max(y, 0)").expect("a formula");
    sample(field, &settings.in_box(Bounds::cube(2.0))).expect("a sample")
}

#[test]
fn a_piece_of_a_curve_has_an_edge_where_the_normals_of_its_patches_differ() {
    for settings in [Settings::with_count(4_000), Settings::with_count(4_000).refined()] {
        let what = format!("{:?}", settings.method);
        let sample = half_edged(&settings);
        let particles = sample.particles();
        let edges = particles.edges();
        assert_eq!(edges.len(), particles.segments.len(), "{what}");
        for (ends, is_edge) in particles.segments.iter().zip(edges) {
            let places = ends.map(|row| particles.place(row as usize));
            assert!(places.iter().all(|p| p.x.abs().min(p.y.abs()) < 1e-6), "{what}: {places:?}");
            let most = places.map(|p| p.x.max(p.y)).into_iter().fold(f64::MIN, f64::max);
            assert_eq!(is_edge, most > 1.0_f64.to_radians(), "{what}: {places:?}");
        }
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn creases_are_counted_without_the_smooth_joins_that_prolong_them() {
    let count = |text: &str, count, bounds: Option<Bounds>| {
        let field = Formula::parse(text).expect("a formula");
        let settings = Settings::with_count(count);
        let settings = bounds.map_or(settings, |bounds| settings.in_box(bounds));
        let report = sample(field, &settings).expect("a sample").report().clone();
        [report.proof.creases, report.proof.corners, report.proof.seams]
    };
    // From the box to the middle and to the box again, both of them.
    let half_edged = count("z = max(x, 0)*max(y, 0)", 3_000, Some(Bounds::cube(2.0)));
    assert_eq!(half_edged, [Some(1), Some(2), Some(1)]);
    for number in [3_000, 8_000] {
        // The edge before the fillet begins, which ends there, and the rim of the solid, closed at
        // the other end of that edge. The smooth joins on both sides of the fillet meet where it
        // begins.
        let found = count("max(smin(z, x, max(0, -y)), hypot(x, y, z) - 1)", number, None);
        assert_eq!(found, [Some(2), Some(2), Some(1)], "{number}");
        // Two edges that meet where both fade out, and the rim, of which they are chords.
        let found = count("max(z - max(x, 0)*(x + max(y, 0)), hypot(x, y, z) - 1)", number, None);
        assert_eq!(found, [Some(3), Some(2), Some(1)], "{number}");
    }
    let cube = count("max(abs(x), abs(y), abs(z)) - 1", 3_000, None);
    assert_eq!(cube, [Some(12), Some(8), None]);
    // Flat and round parts that meet without an edge anywhere are one patch.
    let rounded = "hypot(max(abs(x) - 1, 0), max(abs(y) - 1, 0), max(abs(z) - 1, 0)) - 0.4";
    assert_eq!(count(rounded, 3_000, None), [None; 3]);
}

#[test]
fn vertices_are_split_at_edges_and_not_at_smooth_joins() {
    let sample = half_edged(&Settings::with_count(4_000));
    let particles = sample.particles();
    let [joined, split] =
        [Vertices::Joined, Vertices::Split].map(|vertices| sample.buffers(vertices).positions.len());
    let is_sharp = |&row: &usize| {
        let p = particles.place(row);
        p.x.min(p.y).abs() < 1e-6 && p.x.max(p.y) > 1.0_f64.to_radians()
    };
    let firsts = (0..particles.twins.len()).filter(|&row| particles.first_row(row) == row);
    let (sharp, all) = (firsts.clone().filter(is_sharp).count(), firsts.count());
    assert!(sharp > 30 && all > sharp + 30, "{sharp} of {all}");
    assert_eq!(split, joined + sharp);
}
