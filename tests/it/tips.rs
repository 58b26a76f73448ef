//! Tips: isolated points of the surface at which sheets end as cones, where one particle stands for
//! all of them.

use crate::runs::finished;
use glam::Vec3;
use marching_particles::Bounds;
use marching_particles::field::gallery;
use marching_particles::mesh::triangulation::triangulate;
use marching_particles::sampler::{Method, Refusal, Sampling, Settings};
use marching_particles::{Formula, Warning, sample};

/// A surface with its tips and its topology in a cube, whose nappes are sheets of their own.
struct Tipped {
    formula: String,
    half: f64,
    tips: usize,
    components: usize,
    euler: i64,
}

fn tipped(formula: &str, half: f64, tips: usize, components: usize, euler: i64) -> Tipped {
    Tipped { formula: formula.to_owned(), half, tips, components, euler }
}

fn surfaces() -> Vec<Tipped> {
    let gallery = |id: &str| gallery::find(id).expect("in the gallery").formula.to_owned();
    vec![
        // Two discs at the apex.
        tipped("x^2 + y^2 = z^2", 1.0, 1, 2, 2),
        // f has no gradient at the apex.
        tipped("sqrt(x^2 + y^2) = z", 1.0, 1, 1, 1),
        tipped("sqrt(x^2 + 4y^2) + 0.3x = z", 1.0, 1, 1, 1),
        // Narrow and wide cones, one that is no quadric, and one that opens along a diagonal.
        tipped("x^2 + y^2 = z^2/9", 1.0, 1, 2, 2),
        tipped("x^2 + y^2 = 9z^2", 1.0, 1, 2, 2),
        tipped("x^4 + y^4 = z^4", 1.0, 1, 2, 2),
        tipped("x y + y z + z x = x y z", 1.1, 1, 2, 2),
        // A drop on a trumpet, a spindle with a tip at either end, and two drops.
        tipped("x^2 + y^2 + z^3 = z^2", 1.3, 1, 2, 3),
        tipped("sqrt(x^2 + y^2) = 1 - z^2", 1.3, 2, 1, 2),
        tipped(&gallery("octdong").replace("a z", "z"), 1.2, 1, 2, 4),
        // A tetrahedron with a trumpet at each corner.
        tipped(&gallery("cayley").replace("= t", "= 1"), 1.6, 4, 5, 6),
        // Pieces with tips: a cone on its base, one with a ball on it, and two that touch, each
        // with a base.
        tipped("max(sqrt(x^2 + y^2) - 0.8 (1 - z), -z)", 1.3, 1, 1, 2),
        tipped(
            "min(sqrt(x^2 + y^2 + (z - 0.6)^2) - 0.5, max(sqrt(x^2 + y^2) - 0.45 (z + 0.7), z - 0.5))",
            1.3,
            1,
            1,
            2,
        ),
        tipped("max(sqrt(x^2 + y^2) - abs(z), abs(z) - 1)", 1.3, 1, 2, 4),
    ]
}

/// How a surface with tips is sampled.
const WAYS: [(Method, Sampling); 3] = [
    (Method::Front, Sampling::Uniform),
    (Method::Front, Sampling::Adaptive),
    (Method::Refined, Sampling::Uniform),
];

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn one_particle_stands_at_a_tip_and_the_sheets_close_around_it() {
    for Tipped { formula, half, tips, components, euler } in surfaces() {
        for ((method, sampling), count) in WAYS.into_iter().flat_map(|way| [(way, 1_500), (way, 5_000)]) {
            let settings = settings!(method: method, sampling: sampling; ..Settings::with_count(count));
            let (session, report) = finished(&formula, Bounds::cube(half), &settings);
            let name = format!("{formula}, {method:?}, {sampling:?}, {count}");
            let quality = report.measures.quality.expect("particles");
            assert_eq!(report.proof.singular_points, Some(tips as u64), "{name}");
            assert_eq!((report.proof.components, quality.connectivity.euler), (components, euler), "{name}");
            // Cones that run to the corners of their box touch its edges.
            if half > 1.0 {
                assert_eq!(report.proof.undecided_cells, Some(0), "{name}");
            }
            let is_open = |text: &str| text.contains("leave") || text.contains("The mesh has");
            let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
            assert!(!warnings.iter().any(|text| is_open(text)), "{name}: {warnings:?}");

            let particles = session.run.particles();
            let on_creases = particles.segments.as_flattened();
            let at_tips: Vec<usize> = (0..particles.twins.len())
                .filter(|&i| !on_creases.contains(&(particles.first_row(i) as u32)))
                .collect();
            let firsts = at_tips.iter().filter(|&&i| particles.first_row(i) == i);
            assert_eq!(firsts.count(), tips, "{name}");
            let bounds = session.run.bounds();
            let mesh = triangulate(particles, Some(&bounds));
            assert_eq!(
                (mesh.topology.components.len(), mesh.topology.euler()),
                (components, euler),
                "{name}"
            );
            assert_eq!((&mesh.unfilled[..], &mesh.left_out[..]), (&[][..], &[][..]), "{name}");
            for i in at_tips {
                let (tip, spacing) = (particles.local[i], 2.0 * particles.radius[i]);
                assert_eq!((particles.level[i], tip), (0, particles.local[particles.first_row(i)]), "{name}");
                let around: Vec<Vec3> = mesh
                    .triangles
                    .iter()
                    .filter(|triangle| triangle.contains(&(i as u32)))
                    .flatten()
                    .map(|&v| particles.local[v as usize])
                    .filter(|&p| p != tip)
                    .collect();
                assert!(around.len() >= 8, "{name}: {} corners around {tip}", around.len());
                for p in around {
                    let share = p.distance(tip) / spacing;
                    assert!((0.3..2.0).contains(&share), "{name}: {p} is {share} spacings from {tip}");
                }
            }
        }
    }
}

#[test]
fn a_tip_in_a_plane_that_ends_it_leaves_nothing_undecided() {
    for formula in ["max(x^2+y^2-z^2, abs(z+0.5)-0.5)", "max(x^2/4+y^2-(z+1)^2, abs(z-0.3)-1.3)"] {
        let sample = sample(Formula::parse(formula).unwrap(), &Settings::with_count(2_000)).unwrap();
        assert_eq!(sample.report().proof.undecided_cells, Some(0), "{formula}");
    }
}

#[test]
fn a_narrow_tip_is_named_where_it_is_not_refined() {
    let bounds = Some(Bounds::cube(1.0));
    let settings = settings!(bounds; ..Settings::with_count(4_000).refined());
    let sample = sample(Formula::parse("x^2+y^2=z^2/16").unwrap(), &settings).unwrap();
    let is_tip = |warning: &Warning| matches!(warning, Warning::NotRefined(Refusal::Tip { .. }));
    assert!(sample.report().warnings.iter().any(is_tip), "{:?}", sample.report().warnings);
}
