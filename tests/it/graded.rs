//! The refinement of a coarse front to sizes that follow the curvature.

use crate::refine::assert_rings;
use crate::runs::{begun, gallery_figures, of_gallery, sampled_in_any_steps, shared};
use marching_particles::field::Field;
use marching_particles::field::gallery;
use marching_particles::internal::differential::exact_curvature;
use marching_particles::quality::Figures;
use marching_particles::sampler::{LawKind, Method, Refusal, Sampler, Sampling, Settings, SizeMode};

fn graded(seed: u64) -> Settings {
    settings!(method: Method::Refined,
        sampling: Sampling::Adaptive,
        chord_error: 1e-4,
        seed; ..Settings::default())
}

fn counted(count: u32, seed: u64) -> Settings {
    settings!(size_mode: SizeMode::Count, count; ..graded(seed))
}

/// A run, its figures and the surface that it is on.
fn run(id: &str, settings: &Settings) -> (Sampler<'static>, Figures) {
    let sampler = of_gallery(id, settings);
    let figures = gallery_figures(id, sampler.particles(), Some(&sampler.particles().radius));
    (sampler, figures)
}

#[test]
fn sizes_that_differ_come_out_in_order() {
    // Surface, seed, and the least of six, of the mean smallest angle and of the smallest angle,
    // and the most of the spread of distances over radii. The adaptive front comes to 0.91, 55.2°,
    // 34° and 0.067.
    for (id, seed, [six, mean, smallest, spread]) in
        [("ellipsoid", 0, [0.97, 55.4, 37.0, 0.06]), ("torus", 1, [0.975, 56.2, 37.0, 0.05])]
    {
        let (sampler, f) = run(id, &graded(seed));
        let counts = sampler.counts();
        assert_eq!(counts.refusal, None, "{id}");
        assert!(counts.refined_levels.is_some_and(|levels| levels > 0), "{id}");
        assert_rings(sampler.particles());
        assert!(f.order.six_neighbours >= six, "{id}: six {}", f.order.six_neighbours);
        assert!(
            f.angles.mean_smallest_angle >= mean,
            "{id}: mean smallest angle {}",
            f.angles.mean_smallest_angle
        );
        assert!(f.angles.smallest_angle >= smallest, "{id}: smallest angle {}", f.angles.smallest_angle);
        assert!(f.edges.size_variation <= spread, "{id}: size_variation {}", f.edges.size_variation);
        assert!(f.accuracy.error_max <= 1e-4, "{id}: residual {}", f.accuracy.error_max);
    }
}

#[test]
fn a_wanted_count_of_graded_particles_is_met() {
    for (id, count) in [("ellipsoid", 4_000), ("torus", 6_000), ("sphere", 3_000)] {
        let (sampler, _) = run(id, &counted(count, 2));
        assert_eq!(sampler.counts().refusal, None, "{id}");
        let share = sampler.particles().len() as f64 / f64::from(count);
        assert!((share - 1.0).abs() <= 0.01, "{id}: {} of {count}", sampler.particles().len());
    }
}

#[test]
fn radii_are_those_of_the_law_and_their_cells_cover_the_surface() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    let settings = settings!(radius_law: LawKind::MaxCurvature, curvature_scale: 0.03; ..graded(0));
    let (sampler, f) = run("ellipsoid", &settings);
    assert_eq!(sampler.counts().refusal, None);
    let field = surface.field();
    let particles = sampler.particles();
    let mut as_law = 0;
    for (p, &r) in particles.local.iter().zip(&particles.radius) {
        let law = settings.curvature_scale / exact_curvature(&field.jet(p.as_dvec3())).max_abs();
        let law = law.min(settings.radius_max_share * surface.bounds.diagonal());
        assert!(f64::from(r) <= 1.001 * law, "{r} at {p}, the law gives {law}");
        as_law += usize::from(f64::from(r) >= 0.97 * law);
    }
    // Elsewhere the slope is what limits them.
    assert!(as_law as f64 >= 0.9 * particles.len() as f64, "{as_law} of {}", particles.len());
    // The adaptive front comes to 1.01 here. Where particles are large they lie a little closer
    // than wanted.
    let cells: f64 = particles.radius.iter().map(|&r| 12.0_f64.sqrt() * f64::from(r) * f64::from(r)).sum();
    assert!((0.98..1.09).contains(&(cells / f.area)), "cells cover {} of the surface", cells / f.area);
}

#[test]
fn any_cut_into_steps_gives_the_same_graded_particles() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    sampled_in_any_steps(&surface.field(), &surface.bounds, &counted(3_000, 1));
}

#[test]
fn where_it_cannot_be_had_the_adaptive_front_stands() {
    for settings in [graded(0), counted(10_000, 0)] {
        let (refused, _) = run("heart", &settings);
        let refusal = refused.counts().refusal;
        let is_right = |refusal| matches!(refusal, Refusal::Bent { .. } | Refusal::Singular { .. });
        assert!(refusal.is_some_and(is_right), "{refusal:?}");
        let (front, _) = run("heart", &settings!(method: Method::Front; ..settings));
        assert_eq!(refused.particles().digest(), front.particles().digest(), "{:?}", settings.size_mode);
    }
}

#[test]
fn what_is_cancelled_can_be_relaxed() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    let field = surface.field();
    for steps in [5, 100, 300] {
        let mut sampler = begun(&field, &surface.bounds, &counted(3_000, 0));
        for _ in 0..steps {
            sampler.step(500);
        }
        sampler.cancel();
        assert!(sampler.step(0).stop_reason.is_some());
        assert!(sampler.relax(&shared(&field), 1));
        while sampler.step(500).stop_reason.is_none() {}
        assert!(sampler.particles().local.iter().all(|p| p.is_finite()));
    }
}
