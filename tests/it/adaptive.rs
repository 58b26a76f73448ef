//! Tests of the adaptive front (paper §5): children touch their parents, particles cover the
//! surface, and a run does not depend on how it is cut into steps.

use crate::runs::{assert_fates, begun, figures, gallery_figures, of_gallery, sampled, sampled_in_any_steps};
use crate::smooth::smooth;
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::internal::spatial::CellGrid;
use marching_particles::mesh::triangulation::triangulate;
use marching_particles::particles::Particles;
use marching_particles::sampler::{GapPolicy, LawKind, Phase, Sampling, Settings, SizeMode, StopReason};

/// Settings for about 4,000 particles without relaxation.
fn settings() -> Settings {
    settings!(sampling: Sampling::Adaptive,
        size_mode: SizeMode::Count,
        count: 4_000,
        relax_steps: 0; ..Settings::default())
}

#[test]
fn on_ripples_about_as_wide_as_particles_they_do_not_crowd() {
    let bounds = Bounds::cube(1.5);
    let settings = settings!(sampling: Sampling::Adaptive, chord_error: 5e-4; ..Settings::default());
    for (ripple, most) in [("0.004*sin(50x)", 10), ("0.003*sin(80x)", 20)] {
        let field = Formula::as_written(&format!("x^2+y^2+z^2-1+{ripple}"), &[]).expect("a formula");
        let sampler = sampled(&field, &bounds, &settings, 100_000);
        let particles = sampler.particles();
        let figures = figures(&field, &bounds, particles, Some(&particles.radius));
        assert!(figures.edges.overlap_min > 0.6, "{ripple}: {}", figures.edges.overlap_min);
        assert!(
            figures.spacing.crowded.is_some_and(|crowded| crowded <= most),
            "{ripple}: {:?}",
            figures.spacing.crowded
        );
    }
}

/// Largest circumradius of a triangle of neighbours, relative to that of three touching discs of
/// their mean radius.
fn largest_hole(particles: &Particles) -> f32 {
    let mut largest = 0.0_f32;
    for triangle in triangulate(particles, None).triangles {
        let [a, b, c] = triangle.map(|i| particles.local[i as usize]);
        let twice_area = (b - a).cross(c - a).length();
        let around = (b - a).length() * (c - a).length() * (b - c).length() / (2.0 * twice_area);
        let radius = triangle.iter().map(|&i| particles.radius[i as usize]).sum::<f32>() / 3.0;
        largest = largest.max(around / (radius * 2.0 / 3.0_f32.sqrt()));
    }
    largest
}

/// Smallest distance between two particles of a sheet, relative to r_i + r_j.
fn closest(particles: &Particles) -> f32 {
    let largest = particles.radius.iter().fold(0.0_f32, |a, &b| a.max(b));
    let mut grid = CellGrid::new(3.0 * largest);
    let mut found = Vec::new();
    let mut least = f32::INFINITY;
    for i in 0..particles.len() {
        grid.gather(particles.local[i], particles.radius[i] + largest, &mut found);
        for near in &found {
            let j = near.index as usize;
            if particles.normal[i].dot(particles.normal[j]) > 0.0 {
                least = least.min(near.distance_sq.sqrt() / (particles.radius[i] + particles.radius[j]));
            }
        }
        grid.insert(particles.local[i], i as u32);
    }
    least
}

/// 98th percentile of the relative deviation of a child's distance to its parent from r_i + r_j.
/// The other children are left out because, where the radius law is steep, grading lowers a radius
/// after the children are placed.
fn untouched(particles: &Particles) -> f32 {
    let mut deviation: Vec<f32> = (0..particles.len())
        .filter(|&i| particles.parent[i] != Particles::NO_PARENT)
        .map(|i| {
            let parent = particles.parent[i] as usize;
            let distance = particles.local[i].distance(particles.local[parent]);
            (distance / (particles.radius[i] + particles.radius[parent]) - 1.0).abs()
        })
        .collect();
    deviation.sort_by(f32::total_cmp);
    deviation[(deviation.len() - 1) * 49 / 50]
}

#[test]
fn children_touch_their_parents() {
    for (surface, _) in smooth() {
        // The particles are so small that grading lowers no radius behind the front.
        let fine = settings!(size_mode: SizeMode::Radius, chord_error: 1e-4; ..settings());
        let sampler = of_gallery(surface, &fine);
        assert!(untouched(sampler.particles()) <= 2e-3, "{surface}: {}", untouched(sampler.particles()));
    }
}

#[test]
fn particles_cover_and_crowd_nothing() {
    for (surface, euler) in smooth() {
        let sampler = of_gallery(surface, &settings());
        let particles = sampler.particles();
        let figures = gallery_figures(surface, particles, Some(&particles.radius));
        let context = format!("{surface}, {} particles: {figures:?}", particles.len());
        assert_eq!((figures.order.open, figures.connectivity.components), (0, 1), "{context}");
        assert!((figures.connectivity.euler - euler).abs() <= 1, "{context}");
        let hole = largest_hole(particles);
        assert!(hole <= 1.6, "{context}: a hole of {hole}");
        // The bound is the match tolerance plus rounding.
        assert!(closest(particles) >= 0.7 - 1e-4, "{context}: {}", closest(particles));
        assert!(figures.accuracy.error_max <= 3e-4, "{context}");
    }
}

#[test]
fn ten_steps_even_the_sizes_out() {
    for (surface, _) in smooth() {
        let sampler = of_gallery(surface, &settings!(relax_steps: 10; ..settings()));
        let particles = sampler.particles();
        let figures = gallery_figures(surface, particles, Some(&particles.radius));
        let context = format!("{surface}, {} particles: {figures:?}", particles.len());
        assert!(figures.edges.size_variation <= 0.12, "{context}");
        assert!(largest_hole(particles) <= 1.6, "{context}: {}", largest_hole(particles));
        assert!(closest(particles) >= 0.6, "{context}: {}", closest(particles));
    }
}

#[test]
fn the_bunny_is_even_after_ten_steps() {
    use marching_particles::field::{model, rbf::RbfField};
    use marching_particles::pointcloud::fit_model;
    let bunny = model::find("bunny").expect("a built-in model");
    let fit = fit_model(bunny);
    let field = RbfField::new(fit.data).expect("the data is whole");
    let settings = settings!(sampling: Sampling::Adaptive, chord_error: 1e-4; ..Settings::default());
    let sampler = sampled(&field, &fit.bounds, &settings, 10_000);
    let particles = sampler.particles();
    let figures = figures(&field, &fit.bounds, particles, Some(&particles.radius));
    let context = format!("{} particles: {figures:?}", particles.len());
    assert!(figures.edges.size_variation <= 0.12, "{context}");
    assert!(figures.coverage.cover_local <= 1.6, "{context}");
    assert!(figures.edges.overlap_min >= 0.6, "{context}");
}

#[test]
fn a_particle_takes_no_more_than_two_evaluations() {
    for (surface, _) in smooth() {
        // A given radius takes one front; a given count would take the search for the radius too.
        let settings = settings!(chord_error: 1e-4, size_mode: SizeMode::Radius; ..settings());
        let sampler = of_gallery(surface, &settings);
        let each = sampler.counts().front_evaluations as f64 / sampler.particles().len() as f64;
        assert!(each <= 2.0, "{surface}: {each}");
    }
}

#[test]
fn how_a_run_is_cut_into_steps_does_not_change_it() {
    for surface in ["ellipsoid", "gyroid", "torus"] {
        let surface = gallery::find(surface).expect("a gallery surface");
        let settings = settings!(count: 2_000, relax_steps: 3; ..settings());
        sampled_in_any_steps(&surface.field(), &surface.bounds, &settings);
    }
}

#[test]
fn equal_radii_give_a_lattice_as_the_uniform_front_does() {
    for (surface, _) in smooth() {
        let equal = settings!(size_mode: SizeMode::Radius,
            radius_min_share: 0.006,
            radius_max_share: 0.006; ..settings());
        let sampler = of_gallery(surface, &equal);
        let radii = &sampler.particles().radius;
        assert!(radii.iter().all(|r| (r / radii[0] - 1.0).abs() < 1e-5), "{surface}");
        let uniform = of_gallery(surface, &settings!(sampling: Sampling::Uniform; ..equal));
        let [adaptive, uniform] = [&sampler, &uniform]
            .map(|s| gallery_figures(surface, s.particles(), Some(&s.particles().radius)));
        let context = format!("{surface}: {adaptive:?} {uniform:?}");
        assert!(adaptive.order.six_neighbours >= 0.85 && adaptive.edges.size_variation <= 0.11, "{context}");
        assert!(adaptive.edges.size_variation <= uniform.edges.size_variation, "{context}");
    }
}

#[test]
fn a_wanted_count_is_met() {
    for (surface, radius_law, count) in [
        ("ellipsoid", LawKind::ChordError, 3_000),
        ("torus", LawKind::MaxCurvature, 12_000),
        ("tanglecube", LawKind::SumOfCurvatures, 9_000),
    ] {
        let sampler = of_gallery(surface, &settings!(count, radius_law; ..settings()));
        let miss = sampler.particles().len() as f64 / f64::from(count) - 1.0;
        assert!(miss.abs() <= 0.03, "{surface}, {radius_law:?}: {} of {count}", sampler.particles().len());
    }
}

#[test]
fn radii_follow_the_curvature_and_neighbours_differ_little() {
    let settings = settings();
    let sampler = of_gallery("ellipsoid", &settings);
    let particles = sampler.particles();
    let (least, most) =
        particles.radius.iter().fold((f32::INFINITY, 0.0_f32), |(a, b), &r| (a.min(r), b.max(r)));
    // The curvature ranges from 1.4 to 4, and the radius varies with its inverse square root.
    assert!(most / least > 1.6, "{least} to {most}");
    let ratio = ((1.0 + settings.grading) / (1.0 - settings.grading)) as f32;
    for i in 1..particles.len() {
        let (a, b) = (particles.radius[i], particles.radius[particles.parent[i] as usize]);
        assert!(a / b < 1.02 * ratio && b / a < 1.02 * ratio, "{i}: {a} beside {b}");
    }
}

#[test]
fn the_limit_and_the_stop_button_leave_whole_particles() {
    let capped =
        of_gallery("torus", &settings!(size_mode: SizeMode::Radius, max_particles: 700; ..settings()));
    assert_eq!(capped.particles().len(), 700);
    assert!(capped.counts().fates.capped > 0);

    let surface = gallery::find("torus").expect("a gallery surface");
    let field = surface.field();
    let settings = settings();
    let mut sampler = begun(&field, &surface.bounds, &settings);
    let settled = loop {
        let progress = sampler.step(37);
        if progress.particles > 500 && progress.phase == Phase::Generation {
            break progress.particles;
        }
    };
    sampler.cancel();
    let progress = sampler.step(1);
    assert_eq!(progress.stop_reason, Some(StopReason::Cancelled));
    assert_eq!((progress.particles, sampler.particles().len()), (settled, settled));
}

#[test]
fn every_run_on_the_gallery_ends_with_particles_inside_the_box() {
    for surface in gallery::SURFACES.iter() {
        let field = surface.field();
        let settings = settings!(count: 1_500, relax_steps: 2; ..settings());
        let sampler = sampled(&field, &surface.bounds, &settings, 10_000);
        let particles = sampler.particles();
        let context = format!("{}, {} particles", surface.id, particles.len());
        assert!(particles.len() > 500, "{context}");
        for i in 0..particles.len() {
            assert!(surface.bounds.contains(particles.local[i]), "{context}: {i}");
            assert!((particles.normal[i].length() - 1.0).abs() < 1e-5, "{context}: {i}");
            assert!(particles.radius[i] > 0.0 && particles.radius[i].is_finite(), "{context}: {i}");
        }
    }
}

#[test]
fn a_surface_cut_by_its_box_ends_there() {
    let sampler = of_gallery("gyroid", &settings());
    assert!(sampler.counts().fates.outside > 50, "{:?}", sampler.counts().fates);
}

#[test]
fn fates_of_slots_agree_with_the_counts() {
    for surface in ["torus", "gyroid", "kummer"] {
        let sampler =
            of_gallery(surface, &settings!(size_mode: SizeMode::Radius, chord_error: 3e-4; ..settings()));
        assert_fates(&sampler, surface);
    }
}

#[test]
fn particles_that_fill_gaps_are_counted() {
    let settings = settings!(size_mode: SizeMode::Radius, chord_error: 3e-4; ..settings());
    let left = of_gallery("kummer", &settings!(gaps: GapPolicy::Leave; ..settings));
    let filled = of_gallery("kummer", &settings);
    let count = filled.counts().gaps_filled as usize;
    assert!(count > 0 && left.counts().gaps_filled == 0, "{count}");
    assert_eq!(filled.particles().len(), left.particles().len() + count);
}

#[test]
fn levels_increase_along_the_columns() {
    let sampler = of_gallery("ellipsoid", &settings!(gaps: GapPolicy::Leave; ..settings()));
    let particles = sampler.particles();
    assert!(particles.level.is_sorted());
    assert!(particles.parent[1..].is_sorted());
}

/// The paper pushes one child after the other and has no limit on how steeply sizes change. Its
/// particles are others, but there are as many, and they are as large.
#[test]
fn a_front_of_many_sizes_has_as_many_and_as_large_particles_as_the_paper_s() {
    use marching_particles::internal::lesson::{self, Lesson, Matched};
    for id in ["sphere", "ellipsoid", "torus"] {
        let surface = gallery::find(id).expect("a gallery surface");
        let diagonal = surface.bounds.diagonal();
        let (least, largest, scale) = (0.008, 0.04, 0.12);
        let settings = settings!(size_mode: SizeMode::Radius,
            radius_law: LawKind::MaxCurvature,
            curvature_scale: scale,
            radius_min_share: least,
            radius_max_share: largest,
            grading: 0.5,
            gaps: GapPolicy::Leave; ..settings());
        let sampler = of_gallery(id, &settings);
        let fast = sampler.particles();
        let same = lesson::LessonSettings {
            sampling: Sampling::Adaptive,
            law: LawKind::MaxCurvature,
            law_scale: scale,
            radius_min: least * diagonal,
            radius_max: largest * diagonal,
            seeds: vec![fast.local[0].as_dvec3().to_array()],
            matched: Matched::Stay,
            relax_steps: 0,
            ..lesson::LessonSettings::default()
        };
        let mut run = Lesson::new(Box::new(surface.field()), &surface.bounds, &same).expect("valid settings");
        while !run.step(1_000).is_done {}
        run.seek(u32::MAX);
        let of_paper = run.particles();
        let mean = |sum: f64, count: usize| sum / count as f64;
        let radius = mean(fast.radius.iter().map(|&r| f64::from(r)).sum(), fast.len());
        let wanted = mean(of_paper.iter().map(|p| p.radius).sum(), of_paper.len());
        let count = fast.len() as f64 / of_paper.len() as f64;
        let context = format!(
            "{id}: {} particles of mean radius {radius:.5}, by the paper {} of {wanted:.5}",
            fast.len(),
            of_paper.len()
        );
        assert!((count - 1.0).abs() < 0.06, "{context}");
        assert!((radius / wanted - 1.0).abs() < 0.03, "{context}");
    }
}
