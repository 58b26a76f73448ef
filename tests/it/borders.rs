//! Surfaces that the box cuts, by the second method: the border lies on the box, and nothing is
//! lost without a word.

use crate::cases;
use crate::runs::{begun, figures, sampled, sampled_in_any_steps};
use glam::{DMat3, DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::gallery;
use marching_particles::mesh::Topology;
use marching_particles::mesh::triangulation::{Triangulation, triangulate};
use marching_particles::particles::{Particles, SlotFate, Slots};
use marching_particles::sampler::{Method, Phase, Refusal, Sampler, Sampling, Settings, SizeMode};
use proptest::prelude::*;
use rand_core::SeedableRng;
use rand_pcg::Pcg32;

fn settings(method: Method, count: u32, seed: u64) -> Settings {
    settings!(method, size_mode: SizeMode::Count, count, seed; ..Settings::default())
}

fn refined(formula: &str, bounds: &Bounds, count: u32) -> Sampler<'static> {
    let field = Formula::as_written(formula, &[]).expect("a formula");
    sampled(field, bounds, &settings(Method::Refined, count, 0), 10_000)
}

fn mesh_of(particles: &Particles, bounds: &Bounds) -> Triangulation {
    triangulate(particles, Some(bounds))
}

fn assert_inside(particles: &Particles, bounds: &Bounds) {
    let outside = particles.local.iter().find(|&&p| !bounds.contains(p));
    assert_eq!(outside, None, "outside the box");
}

/// The triangles over the particles are a manifold with this Euler number, and its border lies on
/// the box.
fn assert_border_on_box(particles: &Particles, bounds: &Bounds, euler: i64, name: &str) {
    let mesh = mesh_of(particles, bounds);
    assert!(mesh.topology.is_manifold() && mesh.left_out.is_empty(), "{name}: {:?}", mesh.left_out);
    assert_eq!(mesh.topology.euler(), euler, "{name}");
    let slack = 1e-6 * bounds.diagonal();
    for &v in mesh.topology.borders.iter().flatten() {
        let p = particles.local[v as usize].as_dvec3();
        let depth = (p - bounds.lo()).min(bounds.hi() - p).min_element();
        assert!(depth <= slack, "{name}: {p} is on the border and not on the box");
    }
}

fn half_space(z: f64) -> Bounds {
    Bounds { min: [-2.0, -2.0, -2.0], max: [2.0, 2.0, z] }
}

#[test]
fn gyroid_and_schwarz_surface_come_out_in_order() {
    for id in ["gyroid", "schwarz-p"] {
        let surface = gallery::find(id).expect("a surface of the gallery");
        let field = surface.field();
        let settings = settings(Method::Refined, 20_000, 0);
        let sampler = sampled(&field, &surface.bounds, &settings, 10_000);
        let (counts, particles) = (sampler.counts(), sampler.particles());
        assert_eq!((counts.refusal, counts.refined_levels), (None, Some(2)), "{id}");
        assert!((particles.len() as f64 / 20_000.0 - 1.0).abs() <= 0.01, "{id}: {}", particles.len());
        let f = figures(&field, &surface.bounds, particles, None);
        assert!(f.order.six_neighbours >= 0.96, "{id}: six {}", f.order.six_neighbours);
        assert!(
            f.angles.mean_smallest_angle >= 55.5,
            "{id}: mean smallest angle {}",
            f.angles.mean_smallest_angle
        );
        assert!(
            f.angles.smallest_angle >= 36.0 && f.angles.triangles_above_90 <= 5e-4,
            "{id}: angles {} {}",
            f.angles.smallest_angle,
            f.angles.triangles_above_90
        );
        assert!(
            f.spacing.rho >= 0.72 && f.coverage.cover <= 1.4,
            "{id}: rho {}, cover {}",
            f.spacing.rho,
            f.coverage.cover
        );
        assert!(f.accuracy.error_max <= 1e-5, "{id}: residual {}", f.accuracy.error_max);
    }
}

/// A gyroid of up to two and a half periods in a box of ±1, turned and moved at random.
fn random_gyroid(random: &mut impl FnMut(f64, f64) -> f64) -> String {
    let way = DVec3::new(random(-1.0, 1.0), random(-1.0, 1.0), random(-1.0, 1.0)).normalize_or(DVec3::X);
    let turn = DMat3::from_axis_angle(way, random(0.0, 3.0));
    let scale = core::f64::consts::PI * random(1.0, 2.5);
    let [a, b, c] = [0, 1, 2].map(|k| {
        let row = turn.row(k) * scale;
        format!("({}*x + ({})*y + ({})*z + {})", row.x, row.y, row.z, random(0.0, 6.3))
    });
    format!("sin{a}*cos{b} + sin{b}*cos{c} + sin{c}*cos{a}")
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn most_gyroids_are_refined_wherever_the_box_cuts_them() {
    /// A share that was usual when the test was written.
    const REFINED: f64 = 0.85;
    let (mut done, mut all) = (0, 0);
    for seed in cases::seeds(30) {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut between = |lo, hi| cases::between(&mut random, lo, hi);
        let (formula, bounds) = (random_gyroid(&mut between), Bounds::cube(1.0));
        let sampler = refined(&formula, &bounds, if seed % 2 == 0 { 3_000 } else { 8_000 });
        all += 1;
        match sampler.counts().refusal {
            None => {
                let particles = sampler.particles();
                let topology = Topology::new(sampler.triangles(), particles.len());
                assert!(topology.is_manifold(), "seed {seed}");
                let place = |&v: &u32| particles.local[v as usize].as_dvec3();
                let is_on_box = |p: &DVec3| 1.0 - p.abs().max_element() <= 1e-6;
                let off = topology.borders.iter().flatten().map(place).find(|p| !is_on_box(p));
                assert_eq!(off, None, "seed {seed}: on the border and not on the box");
                done += 1;
            }
            Some(refusal) => println!("seed {seed}: {refusal:?}"),
        }
    }
    cases::assert_share(done, all, REFINED, "gyroids that are refined");
}

#[test]
fn the_border_lies_on_the_box_and_the_topology_is_that_of_the_surface() {
    let sphere = "x^2 + y^2 + z^2 = 1";
    let gyroid = "sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x) = 0";
    // Formula, box, particles, Euler number.
    for (formula, bounds, count, euler) in [
        (gyroid, Bounds::cube(6.2), 8_000, -53),
        // Through corners of the box.
        (gyroid, Bounds::cube(core::f64::consts::TAU), 3_000, -53),
        ("cos(x) + cos(y) + cos(z) = 0", Bounds::cube(6.3), 8_000, -32),
        ("z = 0", Bounds::cube(1.0), 1_500, 1),
        ("z = 0.1 sin(3 x)", Bounds::cube(1.0), 1_500, 1),
        ("x + y + z = 0", Bounds::cube(1.0), 1_500, 1),
        (sphere, half_space(0.3), 1_500, 1),
        (sphere, Bounds { min: [0.0; 3], max: [2.0; 3] }, 1_500, 1),
        (sphere, Bounds::cube(0.8), 3_000, -4),
        (sphere, Bounds::cube(0.6), 4_000, 8),
        ("x^2 + y^2 = 0.25", Bounds::cube(1.0), 1_500, 0),
        ("sin(4 z) = 0", Bounds::cube(1.0), 4_000, 3),
        // It lies in a face of the box.
        ("z = 0", Bounds { min: [-1.0, -1.0, 0.0], max: [1.0; 3] }, 1_500, 1),
        // It touches the faces of the box.
        (sphere, Bounds::cube(1.0), 1_500, 2),
    ] {
        let name = format!("{formula} in {bounds:?}");
        let sampler = refined(formula, &bounds, count);
        assert_eq!(sampler.counts().refusal, None, "{name}");
        let particles = sampler.particles();
        assert!(
            (particles.len() as f64 / f64::from(count) - 1.0).abs() <= 0.015,
            "{name}: {}",
            particles.len()
        );
        assert_inside(particles, &bounds);
        assert_border_on_box(particles, &bounds, euler, &name);
        let is_cut = |slots: &Slots| (0..6).any(|k| slots.get(k) == SlotFate::Outside);
        let cut = particles.slots.iter().filter(|slots| is_cut(slots)).count();
        let on_border = mesh_of(particles, &bounds).topology.borders.iter().map(Vec::len).sum::<usize>();
        assert_eq!(cut, on_border, "{name}: particles with slots outside the box");
    }
}

#[test]
fn acute_corners_hold_no_crowded_pair() {
    // Eight pieces that meet the edges of the box at 16° and at 30°, and a corner that comes to lie
    // beside a particle.
    let sphere = "x^2 + y^2 + z^2 = 1";
    for (formula, bounds, euler) in [
        (sphere, Bounds::cube(0.7), 8),
        (sphere, Bounds::cube(0.68), 8),
        ("z = x^2 - y^2", Bounds::cube(0.9), 1),
    ] {
        for count in [4_000, 20_000] {
            let name = format!("{formula} in {bounds:?}, {count} particles");
            let sampler = refined(formula, &bounds, count);
            assert_eq!(sampler.counts().refusal, None, "{name}");
            let position = &sampler.particles().local;
            assert!(
                (position.len() as f64 / f64::from(count) - 1.0).abs() <= 0.02,
                "{name}: {}",
                position.len()
            );
            let triangles = sampler.triangles();
            let topology = Topology::new(triangles, position.len());
            assert!(topology.is_manifold(), "{name}");
            assert_eq!(topology.euler(), euler, "{name}");
            let sides = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let length = |[a, b]: [u32; 2]| position[a as usize].distance(position[b as usize]);
            let mean = sides().map(length).sum::<f32>() / sides().count() as f32;
            let shortest = sides().map(length).fold(f32::INFINITY, f32::min);
            assert!(
                shortest >= 0.57 * mean,
                "{name}: the closest pair is at {} of the mean",
                shortest / mean
            );
        }
    }
}

#[test]
fn a_sliver_in_a_corner_of_the_box_is_on_the_surface() {
    // A piece smaller than the particles is left of a sheet in the corner, and one step of Newton's
    // method leads out of the box there.
    let waves = "0.857*sin(-2.742*x-0.235*y+0.902*z+3.248) + 0.746*sin(0.738*x-0.41*y-0.765*z+2.977) + 0.792*cos(2.702*x-0.49*y-2.892*z+1.312) \
        + 0.489*sin(1.819*x-1.653*y-2.218*z+0.169) + 0.528*cos(-2.271*x+1.143*y+2.634*z+4.389) = 0.21";
    let bounds = Bounds { min: [0.9, 1.0, -1.1], max: [1.6, 1.6, 0.0] };
    for count in [1_500, 2_500] {
        let field = Formula::as_written(waves, &[]).expect("a formula");
        let settings = settings!(sampling: Sampling::Adaptive; ..settings(Method::Refined, count, 0));
        let sampler = sampled(&field, &bounds, &settings, 10_000);
        assert_eq!(sampler.counts().refusal, None, "{count}");
        let found = figures(&field, &bounds, sampler.particles(), None);
        assert!(found.accuracy.error_max <= 1e-3, "{count}: residual {}", found.accuracy.error_max);
    }
}

#[test]
fn a_bad_box_ends_with_the_front_or_better() {
    let sphere = "x^2 + y^2 + z^2 = 1";
    for (formula, bounds, count) in [
        // Eight specks, six holes smaller than a particle, necks, acute corners, a cap.
        (sphere, Bounds::cube(0.578), 1_000),
        (sphere, Bounds::cube(0.999), 1_500),
        (sphere, Bounds::cube(core::f64::consts::FRAC_1_SQRT_2), 1_500),
        (sphere, Bounds::cube(0.7), 1_500),
        (sphere, half_space(-0.999), 1_500),
        (sphere, Bounds::cube(0.5), 1_500),
        ("z = 1", Bounds::cube(1.0), 1_500),
        ("x + y + z = 2.999", Bounds::cube(1.0), 1_000),
        ("sin(6 x) sin(6 y) sin(6 z) = 0.01", Bounds::cube(1.0), 1_500),
        ("z = 0", Bounds { min: [-1.0, -1.0, -1e-7], max: [1.0, 1.0, 1e-7] }, 1_500),
        ("z = 0", Bounds::cube(1.0), 1),
        ("z = 0.1 x", Bounds::cube(1.0), 720),
    ] {
        let name = format!("{formula} in {bounds:?}");
        let sampler = refined(formula, &bounds, count);
        assert_inside(sampler.particles(), &bounds);
        let counts = sampler.counts();
        assert!(
            sampler.particles().is_empty() || counts.refusal.is_some() != counts.refined_levels.is_some(),
            "{name}: {counts:?}"
        );
    }
}

#[test]
fn where_the_surface_ends_inside_the_box_the_front_stands_and_the_run_says_where() {
    let bounds = Bounds::cube(1.0);
    for formula in ["z = 0.3 x y + 0*ln(x^2 + y^2 - 0.4)", "z = 0.3 x y + 0*sqrt(0.5 - x)"] {
        let refusal = refined(formula, &bounds, 2_000).counts().refusal;
        let Some(Refusal::Border { at }) = refusal else { panic!("{formula}: {refusal:?}") };
        let [x, y, _] = at.0;
        assert!((x * x + y * y - 0.4).abs() < 0.3 || (x - 0.5).abs() < 0.2, "{formula}: {at:?}");
        let message = Refusal::Border { at }.to_string();
        let (_, place) = message.split_once("near (").expect("a place");
        let told: Vec<f32> =
            place.split([',', ')']).take(2).map(|x| x.trim().parse().expect("a number")).collect();
        assert!((told[0] - x).abs() < 1e-3 && (told[1] - y).abs() < 1e-3, "{message}: {at:?}");
    }
}

#[test]
fn a_field_that_ends_at_the_box_is_refined_to_its_end() {
    // The front cannot grow beyond x = 1, and ends before it.
    let bounds = Bounds::cube(1.0);
    let sampler = refined("z = 0.3 x y + 0*sqrt(1.000001 - x)", &bounds, 2_000);
    assert_eq!(sampler.counts().refusal, None);
    assert_inside(sampler.particles(), &bounds);
    assert_border_on_box(sampler.particles(), &bounds, 1, "a saddle");
}

#[test]
fn any_cut_into_steps_gives_the_same_particles_at_a_border() {
    let field = Formula::as_written("z = 0.1 sin(3 x)", &[]).expect("a formula");
    let bounds = Bounds::cube(1.0);
    let sampler = sampled_in_any_steps(&field, &bounds, &settings(Method::Refined, 2_000, 1));
    assert_eq!(sampler.counts().refusal, None);
}

#[test]
fn what_is_cancelled_has_no_particle_outside_the_box() {
    let gyroid = gallery::find("gyroid").expect("a surface of the gallery");
    let field = gyroid.field();
    let mut has_cut_front = false;
    for steps in [5, 20, 60, 200, 600, 1_000] {
        let settings = settings(Method::Refined, 8_000, 0);
        let mut sampler = begun(&field, &gyroid.bounds, &settings);
        for _ in 0..steps {
            sampler.step(1_000);
        }
        let is_marching = sampler.progress().phase == Phase::Generation;
        sampler.cancel();
        let last = sampler.step(0);
        assert!(last.stop_reason.is_some());
        // What was beyond the box is gone.
        has_cut_front |= is_marching && last.moved;
        let particles = sampler.particles();
        assert_inside(particles, &gyroid.bounds);
        for i in 0..particles.len() {
            let parent = particles.parent[i];
            let level = if parent == Particles::NO_PARENT { 0 } else { particles.level[parent as usize] + 1 };
            assert_eq!(particles.level[i], level, "particle {i} after {steps} steps");
        }
    }
    assert!(has_cut_front, "no run was cancelled while its front was beyond the box");
}

proptest! {
    #![proptest_config(crate::cases::proptest(16))]

    #[test]
    fn no_box_makes_a_hole_without_a_word(
        lo in prop::array::uniform3(-1.2_f64..-0.2),
        size in prop::array::uniform3(0.4_f64..1.8),
    ) {
        let bounds = Bounds { min: lo, max: core::array::from_fn(|k| lo[k] + size[k]) };
        let field = Formula::as_written("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
        let sampler = sampled(&field, &bounds, &settings(Method::Refined, 900, 0), 10_000);
        assert_inside(sampler.particles(), &bounds);
        if sampler.counts().refined_levels.is_some() {
            let front = sampled(&field, &bounds, &settings(Method::Front, 900, 0), 10_000);
            // Wherever the front has a particle, there is one.
            let reach = 3.0 * sampler.radius() as f32;
            for &p in &front.particles().local {
                let is_near = |q: &&Vec3| q.distance(p) <= reach;
                let found = sampler.particles().local.iter().find(is_near);
                prop_assert!(found.is_some(), "nothing near {p} in {bounds:?}");
            }
        }
    }
}

#[test]
fn what_a_coarse_front_places_beyond_the_box_is_not_shown() {
    let surface = gallery::find("gyroid").expect("a surface of the gallery");
    let field = surface.field();
    let mut sampler = begun(&field, &surface.bounds, &settings(Method::Refined, 8_000, 0));
    let mut shown: Vec<Vec3> = Vec::new();
    loop {
        let progress = sampler.step(300);
        let particles = sampler.particles();
        assert_eq!(particles.local.len(), particles.slots.len());
        assert!(progress.particles <= particles.len());
        let now = &particles.local[..progress.particles];
        let outside = now.iter().find(|&&p| !surface.bounds.contains(p));
        assert_eq!(outside, None, "outside the box");
        // What is shown stays, but where the run says that it has moved.
        if !progress.moved {
            assert!(now.starts_with(&shown), "{} of {}", now.len(), shown.len());
        }
        shown = now.to_vec();
        if progress.stop_reason.is_some() {
            break;
        }
    }
    assert_eq!(sampler.counts().refusal, None);
}
