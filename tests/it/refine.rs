//! The refinement of a coarse front: its figures, its count, and what happens where it cannot be
//! had.

use crate::runs::{begun, figures, sampled, sampled_in_any_steps, shared};
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::mesh::Topology;
use marching_particles::particles::Particles;
use marching_particles::quality::{self};
use marching_particles::sampler::{Method, Phase, Refusal, Sampling, Search, Settings, SizeMode};

fn refined(count: u32, seed: u64) -> Settings {
    settings!(method: Method::Refined, size_mode: SizeMode::Count, count, seed; ..Settings::default())
}

/// Columns that belong together: every particle but the first of a component has a parent one level
/// below.
pub(crate) fn assert_rings(particles: &Particles) {
    for i in 0..particles.len() {
        let parent = particles.parent[i];
        if parent == Particles::NO_PARENT {
            assert_eq!(particles.level[i], 0);
        } else {
            assert!((parent as usize) < i);
            assert_eq!(particles.level[i], particles.level[parent as usize] + 1);
        }
    }
}

#[test]
fn closed_surfaces_come_out_in_order() {
    // Pins, today's figures rounded down: share of six, mean smallest angle, smallest angle,
    // closest pair.
    for (id, count, seed, [six, mean, smallest, rho]) in [
        ("ellipsoid", 14_000, 0, [0.985, 56.3, 39.0, 0.76]),
        ("sphere", 14_000, 1, [0.985, 56.2, 39.0, 0.76]),
        ("torus", 14_000, 2, [0.98, 55.8, 38.0, 0.76]),
        ("tanglecube", 14_000, 3, [0.955, 55.0, 36.0, 0.74]),
    ] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        let field = surface.field();
        let sampler = sampled(&field, &surface.bounds, &refined(count, seed), 10_000);
        let counts = sampler.counts();
        assert_eq!(counts.refusal, None, "{id}");
        assert!(counts.refined_levels.is_some_and(|levels| levels > 0), "{id}: {:?}", counts.refined_levels);
        let particles = sampler.particles();
        let share = particles.len() as f64 / f64::from(count);
        assert!((share - 1.0).abs() <= 0.01, "{id}: {} particles of {count}", particles.len());
        assert_rings(particles);
        let f = figures(&field, &surface.bounds, particles, None);
        assert!(f.order.six_neighbours >= six, "{id}: six {}", f.order.six_neighbours);
        assert!(
            f.angles.mean_smallest_angle >= mean,
            "{id}: mean smallest angle {}",
            f.angles.mean_smallest_angle
        );
        assert!(f.angles.smallest_angle >= smallest, "{id}: smallest angle {}", f.angles.smallest_angle);
        assert!(f.spacing.rho >= rho, "{id}: closest pair {}", f.spacing.rho);
        assert!(f.coverage.cover <= 1.3, "{id}: cover {}", f.coverage.cover);
        assert!(f.accuracy.error_max <= 1e-4, "{id}: residual {}", f.accuracy.error_max);
        let genus = i64::from(surface.genus.expect("a closed surface has a genus"));
        assert_eq!(f.connectivity.euler, 2 - 2 * genus, "{id}");
    }
}

#[test]
fn a_radius_gives_about_as_many_particles_as_the_front() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    let field = surface.field();
    let settings = settings!(radius_share: 0.006, relax_steps: 0; ..Settings::default());
    let front = sampled(&field, &surface.bounds, &settings, 10_000).particles().len();
    let settings = settings!(method: Method::Refined; ..settings);
    let sampler = sampled(&field, &surface.bounds, &settings, 10_000);
    let share = sampler.particles().len() as f64 / front as f64;
    assert!((0.95..=1.05).contains(&share), "{} and {front} particles", sampler.particles().len());
    assert!(sampler.particles().radius.iter().all(|&r| f64::from(r) == f64::from(sampler.radius() as f32)));
}

#[test]
fn any_cut_into_steps_gives_the_same_particles() {
    let surface = gallery::find("torus").expect("a surface of the gallery");
    sampled_in_any_steps(&surface.field(), &surface.bounds, &refined(4_000, 1));
}

#[test]
fn what_is_cancelled_keeps_the_last_whole_level() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    let field = surface.field();
    let settings = refined(14_000, 0);
    let mut seen = Vec::new();
    for steps in [40, 120, 300, 600] {
        let mut sampler = begun(&field, &surface.bounds, &settings);
        for _ in 0..steps {
            sampler.step(1_000);
        }
        sampler.cancel();
        assert!(sampler.step(0).stop_reason.is_some());
        let particles = sampler.particles();
        assert_rings(particles);
        let f = figures(&field, &surface.bounds, particles, None);
        assert!(
            particles.len() > 100 && f.connectivity.euler == 2,
            "{} particles after {steps} steps",
            particles.len()
        );
        // The coarse front and the first level are too coarse for the triangles of the report to
        // agree everywhere.
        let close = if particles.len() > 300 { 0.0 } else { 0.03 };
        assert!(
            (f.connectivity.triangle_share - 1.0).abs() <= close,
            "{} particles after {steps} steps: {}",
            particles.len(),
            f.connectivity.triangle_share
        );
        seen.push(particles.len());
    }
    // Surgery changes the number of a level's particles by less than a hundredth.
    let follows = |pair: &[usize]| 100 * pair[1] >= 99 * pair[0];
    assert!(seen.windows(2).all(follows), "levels come one after the other: {seen:?}");
    assert!(seen[0] < seen[3], "no level was finished between: {seen:?}");
}

#[test]
fn where_it_cannot_be_had_the_front_stands_and_the_run_says_why() {
    let heart = gallery::find("heart").expect("a surface of the gallery");
    let sphere = gallery::find("sphere").expect("a surface of the gallery");
    let few = settings!(count: 100; ..refined(100, 0));
    let is_singular = |refusal| matches!(refusal, Refusal::Bent { .. } | Refusal::Singular { .. });
    let is_few: fn(Refusal) -> bool = |refusal| refusal == Refusal::Few { expected: 100 };
    let full = settings!(size_mode: SizeMode::Radius, max_particles: 1_000; ..refined(2_000, 0));
    let is_full: fn(Refusal) -> bool = |refusal| refusal == Refusal::Full;
    let cases = [
        (heart, refined(2_000, 0), is_singular as fn(Refusal) -> bool),
        (sphere, few, is_few),
        (sphere, full, is_full),
    ];
    for (surface, settings, is_right) in cases {
        let id = surface.id;
        let field = surface.field();
        let sampler = sampled(&field, &surface.bounds, &settings, 10_000);
        let refusal = sampler.counts().refusal;
        assert!(refusal.is_some_and(is_right), "{id}: {refusal:?}");
        let front = settings!(method: Method::Front; ..settings);
        let expected = sampled(&field, &surface.bounds, &front, 10_000);
        assert_eq!(sampler.particles().digest(), expected.particles().digest(), "{id}");
    }
}

/// Beside a sphere of radius 1 one of radius 0.12, which has 1.4 % of the area.
fn two_spheres() -> (Formula, Bounds) {
    let formula = "min(x^2 + y^2 + z^2 - 1, (x - 1.5)^2 + y^2 + z^2 - 0.0144) = 0";
    (Formula::as_written(formula, &[]).expect("a formula"), Bounds::cube(1.8))
}

fn on_small_sphere(particles: &Particles) -> usize {
    particles.local.iter().filter(|p| p.x > 1.2).count()
}

#[test]
fn each_component_is_refined_as_often_as_it_allows() {
    let (field, bounds) = two_spheres();
    // With one number of levels for both there is none with 180 particles on the small sphere, and
    // the front stands: six is 0.93, 0.965 and 0.97.
    for (count, levels, six) in [(4_000, 2, 0.965), (14_000, 3, 0.985), (40_000, 3, 0.985)] {
        let sampler = sampled(&field, &bounds, &refined(count, 0), 10_000);
        let counts = sampler.counts();
        assert_eq!((counts.refined_levels, counts.refusal), (Some(levels), None), "{count}");
        let particles = sampler.particles();
        assert_rings(particles);
        let all = particles.len() as f64;
        assert!((all / f64::from(count) - 1.0).abs() <= 0.01, "{} of {count}", particles.len());
        let f = figures(&field, &bounds, particles, None);
        assert_eq!(f.connectivity.euler, 4, "{count}: {counts:?}");
        assert!(f.order.six_neighbours >= six, "{count}: six {}", f.order.six_neighbours);
        let share = on_small_sphere(particles) as f64 / all;
        assert!((0.0135..0.0150).contains(&share), "{count}: a share of {share} on the small sphere");
    }
}

#[test]
fn a_refinement_of_two_components_can_be_cut_and_cancelled_anywhere() {
    let (field, bounds) = two_spheres();
    let settings = refined(4_000, 0);
    sampled_in_any_steps(&field, &bounds, &settings);
    // The columns change once a level, never in between.
    let mut sampler = begun(&field, &bounds, &settings);
    let mut counts = Vec::new();
    loop {
        let progress = sampler.step(1);
        if progress.phase == Phase::Refinement {
            counts.push(progress.particles);
        }
        if progress.stop_reason.is_some() {
            break;
        }
    }
    counts.dedup();
    let levels = sampler.counts().refined_levels.expect("a refined run");
    assert!(counts.len() as u32 <= levels + 1, "{counts:?} with {levels} levels");
    for steps in [60, 80, 100, 150, 200, 300] {
        let mut sampler = begun(&field, &bounds, &settings);
        for _ in 0..steps {
            sampler.step(500);
        }
        sampler.cancel();
        sampler.step(0);
        assert_rings(sampler.particles());
        let small = on_small_sphere(sampler.particles());
        assert!(small > 10, "{small} of {} after {steps} steps", sampler.particles().len());
    }
}

#[test]
fn levels_are_told_and_handed_on_from_the_coarse_one_on_and_a_cancel_keeps_the_last() {
    let surface = gallery::find("torus").expect("a surface of the gallery");
    let field = surface.field();
    let settings = refined(6_000, 1);
    let mut sampler = begun(&field, &surface.bounds, &settings);
    let (mut told, mut shown, mut fraction) = (Vec::new(), Vec::new(), 0.0);
    loop {
        let progress = sampler.step(500);
        if progress.phase == Phase::Refinement {
            let now = progress.fraction;
            assert!((fraction..=1.0).contains(&now), "{now} after {fraction}");
            fraction = now;
            told.push((progress.refine_level, progress.refine_levels));
            if progress.moved {
                shown.push(progress.particles);
            }
        } else {
            assert_eq!((progress.refine_level, progress.refine_levels), (0, 0), "{:?}", progress.phase);
        }
        if progress.stop_reason.is_some() {
            break;
        }
    }
    told.dedup();
    let levels = sampler.counts().refined_levels.expect("a refined run") + 1;
    assert!(levels > 1);
    assert_eq!(told, (1..=levels).map(|level| (level, levels)).collect::<Vec<_>>());
    // The last level ends the phase.
    assert_eq!(shown.len() as u32, levels - 1, "{shown:?}");

    sampler
        .begin(&shared(&field), glam::DVec3::ZERO, &surface.bounds, &settings, None)
        .expect("room for the particles");
    let first = loop {
        let progress = sampler.step(500);
        if progress.phase == Phase::Refinement && progress.moved {
            break progress.particles;
        }
    };
    assert_eq!(first, shown[0]);
    sampler.cancel();
    sampler.step(0);
    assert_eq!(sampler.particles().len(), first);
    let f = figures(&field, &surface.bounds, sampler.particles(), None);
    assert!(f.angles.smallest_angle > 20.0, "the coarse level is in order: {}°", f.angles.smallest_angle);
}

#[test]
fn a_refined_run_has_the_mesh_that_it_led_to() {
    let (mut two, cube) = two_spheres();
    let torus = gallery::find("torus").expect("a surface of the gallery");
    let gyroid = gallery::find("gyroid").expect("a surface of the gallery");
    for (name, field, bounds, count, components, euler) in [
        ("torus", &mut torus.field(), torus.bounds, 6_000, 1, 0),
        ("two spheres", &mut two, cube, 4_000, 2, 4),
        ("gyroid", &mut gyroid.field(), gyroid.bounds, 8_000, 1, -53),
    ] {
        let mut sampler = sampled(&*field, &bounds, &refined(count, 0), 10_000);
        let particles = sampler.particles();
        let topology = Topology::new(sampler.triangles(), particles.len());
        assert!(topology.is_manifold(), "{name}");
        assert_eq!(topology.components.len(), components, "{name}");
        let vertices: u32 = topology.components.iter().map(|component| component.vertices).sum();
        assert_eq!(vertices as usize, particles.len(), "{name}: every particle is a vertex");
        assert_eq!(topology.euler(), euler, "{name}");
        assert_eq!(topology.borders.is_empty(), name != "gyroid", "{name}");
        for &[a, b, c] in sampler.triangles() {
            let [p, q, r] = [a, b, c].map(|v| particles.local[v as usize]);
            let upright = (q - p).cross(r - p).dot(particles.normal[a as usize]);
            assert!(upright > 0.0, "{name}: the triangle of {a}, {b} and {c} faces inward");
        }
        // The particles move, and the mesh is gone.
        assert!(sampler.relax(&shared(&*field), 1));
        assert!(sampler.triangles().is_empty(), "{name}");
    }
}

#[test]
fn a_front_has_no_mesh_before_it_is_joined() {
    let surface = gallery::find("ellipsoid").expect("a surface of the gallery");
    let settings = settings!(method: Method::Front; ..refined(1_000, 0));
    let sampler = sampled(surface.field(), &surface.bounds, &settings, 10_000);
    assert!(sampler.triangles().is_empty());
}

#[test]
fn surfaces_that_bend_more_are_refined_once() {
    // Pins, today's figures rounded down: share of six and mean smallest angle. The front comes to
    // 0.795 and 52.2° at worst.
    for (id, six, mean) in [
        ("double-torus", 0.96, 55.5),
        ("decocube", 0.95, 55.5),
        ("chmutov", 0.95, 55.4),
        ("clebsch", 0.965, 56.5),
    ] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        let field = surface.field();
        let sampler = sampled(&field, &surface.bounds, &refined(20_000, 0), 10_000);
        let counts = sampler.counts();
        assert_eq!((counts.refined_levels, counts.refusal), (Some(1), None), "{id}");
        let f = figures(&field, &surface.bounds, sampler.particles(), None);
        assert!(f.order.six_neighbours >= six, "{id}: six {}", f.order.six_neighbours);
        assert!(
            f.angles.mean_smallest_angle >= mean,
            "{id}: mean smallest angle {}",
            f.angles.mean_smallest_angle
        );
        assert!(f.angles.smallest_angle >= 35.0 && f.angles.triangles_above_90 <= 1.5e-4, "{id}: {f:?}");
        assert!(f.spacing.rho >= 0.7 && f.coverage.cover <= 1.3, "{id}: {f:?}");
        if let Some(genus) = surface.genus {
            assert_eq!(f.connectivity.euler, 2 - 2 * i64::from(genus), "{id}");
        }
    }
}

#[test]
fn a_surface_that_bends_too_much_for_a_coarse_front_is_healed_at_full_resolution() {
    for id in ["decocube", "chmutov", "drilled-block"] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        let field = surface.field();
        let front =
            sampled(&field, &surface.bounds, &settings!(method: Method::Front; ..refined(4_000, 0)), 10_000);
        let sampler = sampled(&field, &surface.bounds, &refined(4_000, 0), 10_000);
        let counts = sampler.counts();
        assert_eq!((counts.refined_levels, counts.refusal), (Some(0), None), "{id}");
        assert!(sampler.particles().len().abs_diff(4_000) <= 40, "{id}: {}", sampler.particles().len());
        let [before, f] =
            [&front, &sampler].map(|s| figures(&field.clone(), &surface.bounds, s.particles(), None));
        assert!(
            f.order.six_neighbours >= before.order.six_neighbours + 0.04,
            "{id}: six {} {}",
            before.order.six_neighbours,
            f.order.six_neighbours
        );
        assert!(f.angles.mean_smallest_angle >= before.angles.mean_smallest_angle + 2.0, "{id}: {f:?}");
        assert!(f.spacing.rho > before.spacing.rho, "{id}: pair {} {}", before.spacing.rho, f.spacing.rho);
        // In half of the runs the largest hole is wider than that of the front.
        assert!(f.coverage.cover < 1.4, "{id}: hole {} {}", before.coverage.cover, f.coverage.cover);
        if let Some(genus) = surface.genus {
            let topology = Topology::new(sampler.triangles(), sampler.particles().len());
            assert_eq!(topology.euler(), 2 - 2 * i64::from(genus), "{id}");
        }
    }
}

#[test]
fn fronts_that_cannot_be_refined_are_not_tried_for_ever() {
    /// Steps of 10,000 units of work, ten times as many as it takes.
    const STEPS: usize = 900;

    // The middle of an edge of one sphere is nearer to the other one. The first of them can be
    // refined all the same.
    for outer in [1.02, 1.0002] {
        let text = format!("(x^2 + y^2 + z^2 - 1) (x^2 + y^2 + z^2 - {outer})");
        let field = Formula::as_written(&text, &[]).expect("a formula");
        let settings = settings!(method: Method::Refined, radius_share: 0.0077; ..Settings::default());
        let mut sampler = begun(&field, &Bounds::cube(1.5), &settings);
        let steps = (0..STEPS).take_while(|_| sampler.step(10_000).stop_reason.is_none()).count();
        assert!(steps < STEPS, "{outer}: {steps} steps were not enough");
        let refusal = sampler.counts().refusal;
        assert!(
            matches!(refusal, Some(Refusal::Folded { .. })) != sampler.counts().refined_levels.is_some(),
            "{outer}: {refusal:?}"
        );
        assert_eq!(sampler.search(), Search::Proven, "{outer}");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn thin_necks_and_ears_stay() {
    // Surgery would shorten them, beginning at their rims.
    let field = Formula::as_written("x^4+y^4+z^4-5*(x^2+y^2+z^2)+12", &[]).expect("a formula");
    let bounds = Bounds::cube(2.6);
    let settings = settings!(sampling: Sampling::Adaptive; ..refined(2_000, 0));
    let sampler = sampled(&field, &bounds, &settings, 10_000);
    let particles = sampler.particles();
    let found = figures(&field, &bounds, particles, Some(&particles.radius));
    assert_eq!(found.connectivity.euler, -8, "{:?}", sampler.counts().refusal);
    for (count, seed) in [(5_000, 1), (4_000, 4)] {
        use marching_particles::field::{model, rbf::RbfField};
        let fit = marching_particles::pointcloud::fit_model(model::find("bunny").expect("a built-in model"));
        let field = RbfField::new(fit.data).expect("the data is whole");
        let settings = settings!(sampling: Sampling::Adaptive; ..refined(count, seed));
        let sampler = sampled(&field, &fit.bounds, &settings, 10_000);
        let particles = sampler.particles();
        let found = figures(&field, &fit.bounds, particles, Some(&particles.radius));
        assert!(found.coverage.cover_local < 2.5, "{count}: a hole of {}", found.coverage.cover_local);
    }
}

#[test]
fn a_refusal_names_the_place() {
    // Once around a wall that is thinner than the coarse particles are wide, and once at a ridge.
    for (id, count) in [("decocube", 900), ("chmutov", 2_000)] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        let field = surface.field();
        let sampler = sampled(&field, &surface.bounds, &refined(count, 0), 10_000);
        let refusal = sampler.counts().refusal.expect("too few particles for this surface");
        let at = match refusal {
            Refusal::Bent { at } | Refusal::Doubtful { at } | Refusal::Folded { at } => at,
            other => panic!("{id}: {other:?}"),
        };
        let far = quality::measure(
            &[at.0.into()],
            &[],
            &field,
            Some(&surface.bounds),
            &quality::MeasureOptions::default(),
        );
        let spacing = 2.0 * sampler.radius() as f32;
        assert!(far.residual[0] <= spacing, "{id}: {refusal} is {} off the surface", far.residual[0]);
        assert!(refusal.to_string().contains(&at.to_string()), "{refusal}");
    }
}
