//! A wanted number of particles is met within 3 %, or the warning about it is true.

use marching_particles::{Bounds, Formula, Sample, Settings, Warning, sample};

const GYROID: &str = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
const PYRAMID: &str = "max(abs(x)*0.8 + y*0.6 - 0.6, abs(z)*0.8 + y*0.6 - 0.6, -y)";

fn sampled(formula: &str, settings: &Settings) -> Sample {
    sample(Formula::parse(formula).expect("a formula"), settings).expect("a sample")
}

/// The number of particles over the wanted one.
fn share(sample: &Sample, wanted: u32) -> f64 {
    sample.particles().count() as f64 / f64::from(wanted)
}

fn has_count_warning(sample: &Sample) -> bool {
    sample.report().warnings.iter().any(|warning| matches!(warning, Warning::Count { .. }))
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_box_of_thousands_of_periods_gets_the_wanted_number() {
    let mut misses = Vec::new();
    for (formula, half, count) in [
        (GYROID, 30.0, 20_000),
        ("cos(x) + cos(y) + cos(z)", 40.0, 30_000),
        ("sin(x)*sin(y)*sin(z) - 0.2", 40.0, 30_000),
        ("cos(3*x) + cos(2*y) + cos(z) - 0.3", 20.0, 30_000),
    ] {
        let mut settings = Settings::with_count(count).in_box(Bounds::cube(half));
        settings.relax_steps = 0;
        let share = share(&sampled(formula, &settings), count);
        if (share - 1.0).abs() > 0.03 {
            misses.push(format!("{formula}: {share} of {count}"));
        }
    }
    assert!(misses.is_empty(), "{misses:#?}");
}

#[test]
fn a_solid_of_flat_faces_gets_the_wanted_number_refined() {
    for (formula, count) in [
        (PYRAMID, 2_000),
        (PYRAMID, 8_000),
        ("max(abs(x) + 0.5*abs(y) - 1, abs(z) - 0.6, abs(y) - 1)", 5_000),
        ("max(x + y + z - 1, -x, -y, -z)", 3_000),
        ("max(abs(x)*0.9 + z*0.4 - 0.7, abs(y)*0.7 + z*0.5 - 0.6, -z)", 12_000),
    ] {
        let sample = sampled(formula, &Settings::with_count(count).refined());
        let name = format!("{formula}, {count}");
        assert!(sample.report().growth.refined_levels.is_some(), "{name}");
        let share = share(&sample, count);
        assert!((share - 1.0).abs() <= 0.03, "{name}: {share}");
        let topology = &sample.mesh().topology;
        assert!(topology.is_closed() && topology.components.len() == 1, "{name}");
    }
}

/// Faces of n rows have a lattice without a defect, of 4 n² + 2 particles in all.
#[test]
fn a_lattice_without_a_defect_stands_and_its_count_is_told() {
    let sample = sampled("abs(x) + abs(y) + abs(z) - 1", &Settings::with_count(6_000).refined());
    let rows = ((sample.particles().count() as f64 - 2.0) / 4.0).sqrt();
    assert_eq!(rows.fract(), 0.0);
    assert!(has_count_warning(&sample));
    let quality = sample.report().measures.quality.as_ref().expect("figures");
    assert_eq!(quality.order.six_neighbours, 1.0);
}

/// The search ends where no radius leads to the count, with the nearest that it has met.
#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_count_that_no_radius_leads_to_is_told() {
    let settings = Settings::with_count(1_500).in_box(Bounds::cube(30.0));
    let sample = sampled(GYROID, &settings);
    let share = share(&sample, 1_500);
    assert!(has_count_warning(&sample) != ((share - 1.0).abs() <= 0.03), "{share}");
    assert!((0.5..2.0).contains(&share), "{share}");
}
