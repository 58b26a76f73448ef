//! Solids with sharp edges, from the formula to the mesh: closed, of the right Euler number, with the right volume.

use crate::solid_table::{SOLIDS, Solid};
use glam::DVec3;
use marching_particles::{Formula, Method, Sample, Sampling, Settings, sample};

/// Checks that the mesh of every solid is closed and keeps its edges, and that it has fewer defects once it is refined.
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
            // The mesh of a front whose sizes differ may be open beside a crease.
            if method == Method::Front && sampling == Sampling::Adaptive {
                continue;
            }
            let name = format!("{name}, {method:?}");
            assert_eq!(sample.report().growth.refined_levels.is_some(), method == Method::Refined, "{name}");
            let components = &sample.mesh().topology.components;
            assert_eq!(components.len(), 1, "{name}");
            assert_eq!((components[0].euler(), components[0].border_edges), (euler, 0), "{name}");
            // Flat faces lose nothing; round ones their distance from a chord, of the order of the square of the spacing.
            let found = sample.volume().expect("a closed mesh");
            let slack = 12.0 / f64::from(count);
            assert!((found / exact - 1.0).abs() <= slack, "{name}: volume {found} for {exact}");
            let rows = sample.particles();
            let proof = &sample.report().proof;
            assert_eq!([proof.creases, proof.corners], creases.map(Some), "{name}");
            for (i, &first) in rows.twins.iter().enumerate() {
                let [own, other] = [i, first as usize].map(|row| (rows.position[row], rows.radius[row]));
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
fn the_mesh_of_a_solid_is_closed_and_keeps_its_edges_and_refined_it_has_fewer_defects() {
    check(Settings::with_count(6_000));
}

#[test]
fn the_mesh_of_a_solid_whose_sizes_differ_is_closed_and_keeps_its_edges_once_it_is_refined() {
    check(Settings::with_count(6_000).adaptive());
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
