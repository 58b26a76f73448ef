//! Tests of the radius field in adaptive sampling (paper §5): radii follow the radius law, respect
//! the grading, and the relaxation evens them out.

use crate::runs::{gallery_figures, of_gallery, sampled, shared};
use marching_particles::field::gallery::{self, SURFACES};
use marching_particles::field::{Field, Frame};
use marching_particles::internal::differential::{Curvature, curvatures};
use marching_particles::internal::spatial::CellGrid;
use marching_particles::particles::Particles;
use marching_particles::sampler::{LawKind, Sampling, Settings, SettingsError, SizeMode};

const LAWS: [LawKind; 3] = [LawKind::ChordError, LawKind::MaxCurvature, LawKind::SumOfCurvatures];

fn adaptive(count: u32, relax_steps: u32) -> Settings {
    settings!(sampling: Sampling::Adaptive,
        size_mode: SizeMode::Count,
        count,
        relax_steps; ..Settings::default())
}

/// Pairs of particles of a sheet that are nearer than `reach` times the sum of their radii.
fn pairs(particles: &Particles, reach: f32) -> Vec<(usize, usize, f32)> {
    let largest = particles.radius.iter().fold(0.0_f32, |a, &b| a.max(b));
    let mut grid = CellGrid::new(largest);
    for (i, &p) in particles.local.iter().enumerate() {
        grid.insert(p, i as u32);
    }
    let (mut found, mut pairs) = (Vec::new(), Vec::new());
    for i in 0..particles.len() {
        // The larger particle of a pair finds the smaller one.
        grid.gather(particles.local[i], 2.0 * reach * particles.radius[i], &mut found);
        for near in &found {
            let j = near.index as usize;
            let (a, b) = (particles.radius[i], particles.radius[j]);
            let distance = near.distance_sq.sqrt();
            let once = b < a || b == a && j < i;
            if once && distance <= reach * (a + b) && particles.normal[i].dot(particles.normal[j]) > 0.0 {
                pairs.push((i, j, distance));
            }
        }
    }
    pairs
}

/// Neighbours differ by no more than the grading allows.
fn assert_graded(particles: &Particles, grading: f64, context: &str) {
    let neighbours = pairs(particles, 1.15);
    assert!(neighbours.len() > particles.len(), "{context} has neighbours");
    for (i, j, distance) in neighbours {
        let (a, b) = (particles.radius[i], particles.radius[j]);
        let slope = (a - b).abs() / distance;
        let rise = grading as f32 * distance;
        let is_graded = (a - b).abs() <= 1.000_01 * rise;
        assert!(is_graded, "{context}: radii {a} and {b} at {distance}, slope {slope}");
        // Particles that touch obey the documented ratio.
        if distance <= a + b {
            let most = (1.0 + grading as f32) / (1.0 - grading as f32);
            assert!(a.max(b) / a.min(b) <= 1.000_1 * most, "{context}: {a} beside {b}");
        }
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn neighbours_never_differ_by_more_than_the_grading_allows() {
    for surface in SURFACES.iter().filter(|surface| surface.smooth) {
        for (radius_law, grading, relax_steps) in [(LAWS[1], 0.1, 3), (LAWS[2], 0.2, 3), (LAWS[0], 0.1, 0)] {
            let settings = settings!(radius_law, grading; ..adaptive(2_000, relax_steps));
            let sampler = of_gallery(surface.id, &settings);
            assert_graded(sampler.particles(), grading, &format!("{} {radius_law:?}", surface.id));
        }
    }
}

#[test]
fn no_particle_is_larger_than_its_law_and_most_are_as_large() {
    for id in ["ellipsoid", "torus", "tanglecube", "gyroid"] {
        let surface = gallery::find(id).expect("in the gallery");
        let settings = settings!(sampling: Sampling::Adaptive,
            chord_error: 4e-4,
            radius_min_share: 0.002; ..Settings::default());
        let sampler = of_gallery(surface.id, &settings);
        let particles = sampler.particles();
        let mut curvature = vec![Curvature::default(); particles.len()];
        curvatures(&mut *surface.field().evaluator(Frame::default()), &particles.local, &mut curvature);
        let diagonal = surface.bounds.diagonal();
        let (error, least) = (settings.chord_error * diagonal, settings.radius_min_share * diagonal);
        let greatest = settings.radius_max_share * diagonal;
        let mut as_large = 0;
        for (k, &radius) in curvature.iter().zip(&particles.radius) {
            let bend = 1.0 / f64::from(k.max_abs());
            let law = 0.5 * (6.0 * error * bend - 3.0 * error * error).max(0.0).sqrt();
            let share = f64::from(radius) / law.clamp(least, greatest);
            assert!(share < 1.01, "{id}: {share} of the law");
            as_large += usize::from(share > 0.99);
        }
        let share = as_large as f64 / particles.len() as f64;
        assert!(share > 0.7, "{id}: {share} of the particles are as large as the law lets them");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn the_energy_of_the_overlaps_falls_at_every_step_on_every_smooth_surface_and_the_sizes_end_graded() {
    for surface in SURFACES.iter().filter(|surface| surface.smooth) {
        for radius_law in LAWS {
            let settings = settings!(radius_law; ..adaptive(2_000, 10));
            let sampler = of_gallery(surface.id, &settings);
            let energy = sampler.energy();
            assert_eq!(energy.len(), 11, "{} {radius_law:?}", surface.id);
            assert!(energy.is_sorted_by(|a, b| a > b), "{} {radius_law:?}: {energy:?}", surface.id);
            assert_graded(sampler.particles(), settings.grading, &format!("{} {radius_law:?}", surface.id));
        }
    }
}

#[test]
fn the_reported_energy_is_that_of_all_overlaps() {
    // The radius law of this surface needs no grading, which would lower radii afterwards.
    let surface = gallery::find("ellipsoid").expect("in the gallery");
    for steps in [1, 10] {
        let sampler = of_gallery(surface.id, &adaptive(4_000, steps));
        let particles = sampler.particles();
        let mut sum = 0.0;
        for (i, j, distance) in pairs(particles, 1.15) {
            let mean = 0.5 * f64::from(particles.radius[i] + particles.radius[j]);
            sum += (2.3 - f64::from(distance) / mean).powi(2);
        }
        let exact = sum / particles.len() as f64;
        let reported = *sampler.energy().last().expect("an energy");
        // The radii are updated once more after the last energy is computed.
        assert!((reported / exact - 1.0).abs() < 3e-3, "{reported} reported, {exact} summed");
    }
}

#[test]
fn ten_steps_fit_the_particles_to_their_sizes() {
    for id in ["ellipsoid", "torus", "tanglecube", "dupin-cyclide"] {
        let [front, relaxed] = [0, 10].map(|steps| {
            let sampler = of_gallery(id, &adaptive(14_000, steps));
            gallery_figures(id, sampler.particles(), Some(&sampler.particles().radius))
        });
        println!("{id}: {front:#?} {relaxed:#?}");
        for f in [&front, &relaxed] {
            assert!(f.edges.size_variation <= 0.12, "{id}: size_variation {}", f.edges.size_variation);
            assert!(f.coverage.cover_local <= 1.6, "{id}: hole {}", f.coverage.cover_local);
            assert!(f.edges.overlap_min >= 0.6, "{id}: pair {}", f.edges.overlap_min);
        }
        assert!(
            relaxed.edges.size_variation <= 0.08,
            "{id}: size_variation {}",
            relaxed.edges.size_variation
        );
        assert!(
            relaxed.edges.size_variation < 0.85 * front.edges.size_variation,
            "{id}: {} from {}",
            relaxed.edges.size_variation,
            front.edges.size_variation
        );
        assert!(relaxed.coverage.cover_local < front.coverage.cover_local, "{id}");
    }
}

#[test]
fn more_steps_can_follow_and_cutting_a_run_into_slices_changes_nothing() {
    let surface = gallery::find("ellipsoid").expect("in the gallery");
    let field = surface.field();
    let whole = sampled(&field, &surface.bounds, &adaptive(2_000, 6), u32::MAX);
    let mut sliced = sampled(&field, &surface.bounds, &adaptive(2_000, 6), 17);
    assert_eq!(sliced.particles().digest(), whole.particles().digest());
    let before = *sliced.energy().last().expect("an energy");
    assert!(sliced.relax(&shared(&field), 4));
    while sliced.step(1_000).stop_reason.is_none() {}
    assert_eq!(sliced.energy().len(), 11);
    assert!(*sliced.energy().last().expect("an energy") < before);
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let bad = |settings: Settings| match settings.validate() {
        Err(SettingsError::OutOfRange { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    let default = Settings::default();
    assert_eq!(bad(settings!(chord_error: 0.0; ..default)), "chord_error");
    assert_eq!(bad(settings!(curvature_scale: f64::NAN; ..default)), "curvature_scale");
    assert_eq!(bad(settings!(grading: 1.0; ..default)), "grading");
    assert_eq!(bad(settings!(radius_max_share: 1.0; ..default)), "radius_max_share");
    assert_eq!(bad(settings!(radius_min_share: 0.1, radius_max_share: 0.05; ..default)), "radius_min_share");
}
