//! Blue noise and random points: held to brute force, to known areas and to counts.
#![allow(clippy::disallowed_methods, reason = "places to probe and known areas need no equal bits")]

use glam::DVec3;
use marching_particles::particles::Particles;
use marching_particles::{Bounds, Counting, Formula, Method, Pattern, Radius, Run, Sample, Settings, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

const TORUS: &str = "(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16";
const TANGLECUBE: &str = "x^4 + y^4 + z^4 - 5(x^2 + y^2 + z^2) + 11.8";
const TWO: &str = "min(norm(x - 2, y, z) - 1, norm(x + 2, y, z) - 0.3)";
const DRILLED: &str = "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5, 0.5 - norm(x, y))";

fn sampled(formula: &str, settings: &Settings) -> Sample {
    sample(Formula::parse(formula).expect("a formula"), settings).expect("a sample")
}

fn blue(count: u32) -> Settings {
    Settings::with_count(count).with_pattern(Pattern::Blue)
}

/// The particles, each once: place, normal and radius.
fn once(particles: &Particles) -> Vec<(DVec3, DVec3, f64)> {
    (0..particles.len())
        .filter(|&i| particles.first_row(i) == i)
        .map(|i| {
            let place = particles.local[i].as_dvec3();
            (place, particles.normal[i].as_dvec3(), f64::from(particles.radius[i]))
        })
        .collect()
}

fn unit(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32()) / 2_f64.powi(32)
}

/// Places on the surface of a formula: points of its box, moved along the gradient.
fn probes(formula: &str, bounds: &Bounds, count: usize) -> Vec<DVec3> {
    let formula = Formula::parse(formula).expect("a formula");
    let mut random = Pcg32::seed_from_u64(7);
    let mut probes = Vec::new();
    let (lo, size) = (bounds.lo(), bounds.hi() - bounds.lo());
    let value = |p: DVec3| marching_particles::field::Field::value_and_gradient(&formula, p);
    while probes.len() < count {
        let mut p = lo + size * DVec3::from_array([0; 3].map(|_| unit(&mut random)));
        for _ in 0..30 {
            let (f, g) = value(p);
            p -= g * (f / g.length_squared());
        }
        let (f, g) = value(p);
        if f.abs() <= 1e-9 * g.length() && bounds.holds(p) {
            probes.push(p);
        }
    }
    probes
}

/// The smallest distance of two particles over the sum of their radii.
fn closest(particles: &[(DVec3, DVec3, f64)]) -> f64 {
    let mut least = f64::INFINITY;
    for (i, (p, n, r)) in particles.iter().enumerate() {
        for (q, m, s) in &particles[..i] {
            if n.dot(*m) > -0.5 {
                least = least.min(p.distance(*q) / (r + s));
            }
        }
    }
    least
}

/// The largest distance of a probe from all particles, over the sum of the radii there, with the
/// radius of the nearest particle for that of the probe.
fn widest(particles: &[(DVec3, DVec3, f64)], probes: &[DVec3]) -> f64 {
    let of = |probe: &DVec3| {
        particles.iter().map(|(p, _, r)| p.distance(*probe) / (2.0 * r)).fold(f64::INFINITY, f64::min)
    };
    probes.iter().map(of).fold(0.0, f64::max)
}

#[test]
fn blue_noise_has_the_count_no_close_pair_and_no_hole() {
    for (name, formula, settings) in [
        ("sphere", "norm(x, y, z) - 1", blue(1_500)),
        ("torus", TORUS, blue(1_500)),
        ("tanglecube", TANGLECUBE, blue(2_000).seeded(3)),
        ("two spheres", TWO, blue(2_000)),
        ("plane", "z", blue(1_200).in_box(Bounds::cube(1.0))),
        ("few", "norm(x, y, z) - 1", blue(50)),
    ] {
        let sample = sampled(formula, &settings);
        let particles = once(sample.particles());
        assert_eq!(particles.len(), settings.count as usize, "{name}");
        let closest = closest(&particles);
        assert!(closest >= 1.0 - 1e-6, "{name}: a pair at {closest} of 2r");
        let widest = widest(&particles, &probes(formula, &sample.bounds(), 4_000));
        assert!((0.9..=1.003).contains(&widest), "{name}: a hole of {widest} of 2r");
        let radii = particles.iter().map(|particle| particle.2);
        let radius = sample.report().sizes.radius;
        assert!(radii.clone().all(|r| (r / radius - 1.0).abs() < 1e-6), "{name}");
        assert_eq!(sample.particles().local.len(), sample.particles().slots.len());
    }
}

#[test]
fn blue_noise_of_a_radius_is_maximal() {
    let settings = Settings::with_radius(Radius::Length(0.04)).with_pattern(Pattern::Blue);
    let sample = sampled(TORUS, &settings);
    let particles = once(sample.particles());
    assert!((sample.report().sizes.radius - 0.04).abs() < 1e-9);
    let closest = closest(&particles);
    assert!(closest >= 1.0 - 1e-6, "a pair at {closest} of 2r");
    let widest = widest(&particles, &probes(TORUS, &sample.bounds(), 4_000));
    assert!((0.9..=1.0005).contains(&widest), "a hole of {widest} of 2r");
    // Discs that fall at random cover 0.547 of a plane.
    let area = 4.0 * std::f64::consts::PI.powi(2) * 0.4;
    let covered = particles.len() as f64 * std::f64::consts::PI * 0.04 * 0.04 / area;
    assert!((covered / 0.547 - 1.0).abs() < 0.03, "{covered} is covered");
}

#[test]
fn blue_noise_keeps_sharp_edges_and_corners() {
    let sample = sampled(DRILLED, &blue(3_000));
    let particles = once(sample.particles());
    assert_eq!(particles.len(), 3_000);
    let corner = DVec3::new(1.0, 1.0, 0.5);
    let origin = sample.particles().origin;
    assert!(particles.iter().any(|(p, _, _)| (origin + *p).distance(corner) < 1e-6));
    let on_edge = |p: DVec3| (p.x.abs() - 1.0).abs() < 1e-6 && (p.z.abs() - 0.5).abs() < 1e-6;
    assert!(particles.iter().filter(|(p, _, _)| on_edge(origin + *p)).count() > 60);
    let closest = closest(&particles);
    assert!(closest >= 1.0 - 1e-6, "a pair at {closest} of 2r");
    let mut random = Pcg32::seed_from_u64(5);
    let mut probes = Vec::new();
    while probes.len() < 4_000 {
        let [u, v] = [0; 2].map(|_| 2.0 * unit(&mut random) - 1.0);
        // A face, a side and the hole.
        if u.hypot(v) >= 0.5 {
            probes.push(DVec3::new(u, v, 0.5));
        }
        probes.push(DVec3::new(1.0, u, 0.5 * v));
        let (sin, cos) = (std::f64::consts::PI * u).sin_cos();
        probes.push(DVec3::new(0.5 * cos, 0.5 * sin, 0.5 * v));
    }
    probes.iter_mut().for_each(|p| *p -= origin);
    let widest = widest(&particles, &probes);
    assert!(widest <= 1.003, "a hole of {widest} of 2r");
}

#[test]
fn blue_noise_of_varying_sizes_keeps_its_radii_apart() {
    let formula = "x^2/4 + y^2 + 4z^2 - 1";
    let sample = sampled(formula, &blue(2_000).adaptive());
    let particles = once(sample.particles());
    assert_eq!(particles.len(), 2_000);
    let radii = particles.iter().map(|particle| particle.2);
    let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
    assert!(most > 2.0 * least, "{least} to {most}");
    let closest = closest(&particles);
    assert!(closest >= 1.0 - 1e-5, "a pair at {closest} of the sum of its radii");
    // The radius at the probe may be larger than at the nearest particle, by the slope.
    let widest = widest(&particles, &probes(formula, &sample.bounds(), 4_000));
    assert!(widest <= 1.25, "a hole of {widest} of 2r");
}

/// χ² of counts that are expected to be equal, less its mean, over its standard deviation.
fn chi_square(counts: &[f64], expected: &[f64]) -> f64 {
    let chi: f64 = counts.iter().zip(expected).map(|(n, e)| (n - e).powi(2) / e).sum();
    let freedom = counts.len() as f64 - 1.0;
    (chi - freedom) / (2.0 * freedom).sqrt()
}

#[test]
fn random_points_are_even_by_area_and_independent() {
    let random = |count: u32, seed| Settings::with_count(count).with_pattern(Pattern::Random).seeded(seed);
    // Slices of a sphere of equal height have equal area, along every axis (Archimedes).
    let sample = sampled("norm(x, y, z) - 1", &random(20_000, 1));
    assert_eq!(sample.particles().count(), 20_000);
    for axis in 0..3 {
        let mut counts = [0.0; 40];
        for p in &sample.particles().local {
            counts[((f64::from(p[axis]) + 1.0) * 20.0).clamp(0.0, 39.0) as usize] += 1.0;
        }
        let off = chi_square(&counts, &[500.0; 40]);
        assert!(off.abs() < 4.0, "axis {axis}: χ² is off by {off}");
    }
    // Of a torus a slice of the tube has the area (R + r cos θ) r dθ 2π.
    let sample = sampled(TORUS, &random(20_000, 2));
    let mut counts = [0.0; 36];
    for p in &sample.particles().local {
        let theta = f64::from(p.z).atan2(f64::from(p.x).hypot(f64::from(p.y)) - 1.0);
        counts[((theta / std::f64::consts::TAU + 0.5) * 36.0).clamp(0.0, 35.0) as usize] += 1.0;
    }
    let share = |k: usize| {
        let [a, b] = [k, k + 1].map(|k| std::f64::consts::TAU * (k as f64 / 36.0 - 0.5));
        20_000.0 * ((b - a) + 0.4 * (b.sin() - a.sin())) / std::f64::consts::TAU
    };
    let expected: Vec<f64> = (0..36).map(share).collect();
    let off = chi_square(&counts, &expected);
    assert!(off.abs() < 4.0, "χ² is off by {off}");
    // Distances to the nearest of independent points of density ρ: a share of exp(-ρπd²) is larger.
    let sample = sampled("z", &random(4_000, 3).in_box(Bounds::cube(1.0)));
    let places: Vec<_> = sample.particles().local.clone();
    let inner: Vec<f32> = places
        .iter()
        .filter(|p| p.x.abs() < 0.9 && p.y.abs() < 0.9)
        .map(|p| places.iter().map(|q| p.distance(*q)).filter(|d| *d > 0.0).fold(f32::INFINITY, f32::min))
        .collect();
    for d in [0.005_f64, 0.01, 0.02] {
        let wanted = (-1000.0 * std::f64::consts::PI * d * d).exp();
        let share = inner.iter().filter(|near| f64::from(**near) > d).count() as f64 / inner.len() as f64;
        assert!((share - wanted).abs() < 0.03, "{d}: {share}, not {wanted}");
    }
}

#[test]
fn fronts_get_exactly_the_wanted_number() {
    for (name, formula, settings) in [
        ("sphere", "norm(x, y, z) - 1", Settings::with_count(3_001)),
        ("torus", TORUS, Settings::with_count(5_000).adaptive()),
        ("drilled", DRILLED, Settings::with_count(4_000)),
        ("sphere 500", "norm(x, y, z) - 1", Settings::with_count(500).seeded(5)),
        ("two spheres", TWO, Settings::with_count(1_000).seeded(2)),
    ] {
        let settings = settings.exactly();
        assert_eq!(settings.counting, Counting::Exactly);
        let sample = sampled(formula, &settings);
        assert_eq!(sample.particles().count(), settings.count as usize, "{name}");
        let figures = sample.report().measures.quality.expect("figures");
        assert!(figures.order.six_neighbours > 0.75, "{name}: six {}", figures.order.six_neighbours);
        assert!(figures.spacing.nearest_ratio > 0.6, "{name}: {}", figures.spacing.nearest_ratio);
    }
}

#[test]
fn a_pattern_does_not_depend_on_how_its_run_is_cut_into_steps() {
    let exactly = Settings::with_count(1_503).exactly();
    for settings in [blue(1_500), Settings::with_count(1_500).with_pattern(Pattern::Random), exactly] {
        let digest = |budget| {
            let formula = Formula::parse(TANGLECUBE).expect("a formula");
            let mut run = Run::start(formula, &settings).expect("a run");
            while run.step(budget).stop_reason.is_none() {}
            run.particles().digest()
        };
        assert_eq!(digest(37), digest(u32::MAX), "{:?}", settings.pattern);
    }
}

#[test]
fn a_pattern_that_is_stopped_leaves_what_it_has() {
    let formula = Formula::parse(TANGLECUBE).expect("a formula");
    let mut run = Run::start(formula, &blue(4_000)).expect("a run");
    let mut most = 0;
    while run.step(500).stop_reason.is_none() {
        most = most.max(run.count());
        if run.progress().is_some_and(|progress| progress.fraction > 0.8) {
            break;
        }
    }
    run.cancel();
    let progress = run.step(u32::MAX);
    assert!(progress.stop_reason.is_some() && run.count() > 0);
    // Nothing to relax: the pattern would be lost.
    assert!(!run.relax(5));
}

/// Largest deviation of the directions to near neighbours from evenness, in standard deviations.
fn unevenness(sample: &Sample) -> f64 {
    let places = &sample.particles().local;
    let reach = 4.0 * sample.report().sizes.radius as f32;
    let mut counts = [0.0; 12];
    for (i, p) in places.iter().enumerate() {
        for q in &places[..i] {
            if p.distance(*q) < reach {
                let angle = f64::from((q.y - p.y).atan2(q.x - p.x)).rem_euclid(std::f64::consts::PI);
                counts[((angle / std::f64::consts::PI * 12.0) as usize).min(11)] += 1.0;
            }
        }
    }
    let expected = counts.iter().sum::<f64>() / 12.0;
    chi_square(&counts, &[expected; 12])
}

#[test]
fn blue_noise_prefers_no_direction() {
    let plane = |settings: Settings| sampled("z", &settings.in_box(Bounds::cube(1.0)));
    let blue = unevenness(&plane(blue(4_000)));
    assert!(blue < 4.0, "{blue}");
    let hexagonal = unevenness(&plane(Settings::with_count(4_000)));
    assert!(hexagonal > 50.0, "the rows of a lattice show: {hexagonal}");
}

#[test]
fn the_refined_method_has_its_own_pattern() {
    let settings = blue(2_000).refined();
    assert_eq!(settings.method, Method::Refined);
    let sample = sampled("norm(x, y, z) - 1", &settings);
    assert!(sample.report().growth.refined_levels.is_some());
}
