//! The laws of the two schemes against naive sums and finite differences.

use super::crowd::{Neighbourhood, Particle, tangent};
use super::forces::Forces;
use super::witkin_heckbert::WitkinHeckbert;
use super::{Settings, SurfaceContext};
use crate::field::formula::FormulaField;
use crate::math::Bounds;
use crate::sampler::Settings as Sizes;
use crate::sampler::discovery::survey::survey;
use crate::sampler::projection::{Accuracy, Projector, tolerance};
use crate::sampler::sizing::Sizing;
use glam::{DVec3, Vec3};
use rand_core::SeedableRng;
use rand_pcg::Pcg32;

const WANTED: f32 = 0.1;
const DIAMETER: f32 = 2.0;

fn witkin_heckbert() -> WitkinHeckbert {
    let bounds = Bounds::cube(1.5);
    WitkinHeckbert::new(
        &Settings::default(),
        tolerance(WANTED, Accuracy::UNLIMITED, 1.0),
        &bounds,
        WANTED,
        DIAMETER,
    )
}

/// Particles of many sizes, all over a part of the plane z = 0.
fn crowd(count: u32) -> Vec<Particle> {
    (0..count)
        .map(|k| {
            // A Weyl sequence: well spread, deterministic, no two places alike.
            let place = (Vec3::new(0.754_877_7, 0.569_840_3, 0.0) * k as f32).fract() * 0.6;
            Particle::new(place, Vec3::Z, WANTED * (0.6 + 0.1 * (k % 9) as f32))
        })
        .collect()
}

/// Finds everyone's neighbours and has `repel` work on them.
fn repel(
    particles: &mut [Particle],
    reach: fn(f32) -> f32,
    repel: impl Fn(&mut [Particle], usize, &[crate::spatial::Neighbour]),
) {
    let mut neighbourhood = Neighbourhood::new();
    neighbourhood.reset(particles, reach, false);
    for i in 0..particles.len() {
        neighbourhood.insert(particles, i);
    }
    for i in 0..particles.len() {
        let near = neighbourhood.around(particles, i, reach(particles[i].radius)).to_vec();
        repel(particles, i, &near);
    }
}

/// E of a particle of radius `sigma` by another at the distance `offset`, none beyond 3σ.
fn energy(offset: DVec3, sigma: f64) -> f64 {
    let share = offset.length_squared() / (2.0 * sigma * sigma);
    if share < 4.5 { 6.0 * libm::exp(-share) } else { 0.0 }
}

#[test]
fn neighbours_are_those_that_a_naive_search_finds_however_far_it_reaches() {
    let particles = crowd(200);
    let mut neighbourhood = Neighbourhood::new();
    neighbourhood.reset(&particles, WitkinHeckbert::reach, false);
    for i in 0..particles.len() {
        neighbourhood.insert(&particles, i);
    }
    // The last one is beyond what the grid is asked for.
    for reach in [0.01, 0.2, 0.5, 5.0] {
        for i in 0..particles.len() {
            let mut found: Vec<u32> =
                neighbourhood.around(&particles, i, reach).iter().map(|near| near.index).collect();
            found.sort_unstable();
            let distance =
                |j: &u32| (particles[*j as usize].position - particles[i].position).length_squared();
            let naive: Vec<u32> = (0..200).filter(|j| distance(j) <= reach * reach).collect();
            assert_eq!(found, naive, "particle {i}, reach {reach}");
        }
    }
}

#[test]
fn lists_serve_while_they_hold_every_neighbour_and_no_longer() {
    let mut particles = crowd(200);
    let mut neighbourhood = Neighbourhood::new();
    let mut made = 0;
    for step in 0..60 {
        if !neighbourhood.serves(&particles, WitkinHeckbert::reach) {
            neighbourhood.reset(&particles, WitkinHeckbert::reach, true);
            for i in 0..particles.len() {
                neighbourhood.insert(&particles, i);
            }
            made += 1;
        }
        for i in 0..particles.len() {
            let reach = WitkinHeckbert::reach(particles[i].radius);
            let mut found: Vec<u32> =
                neighbourhood.around(&particles, i, reach).iter().map(|near| near.index).collect();
            found.sort_unstable();
            let distance =
                |j: &u32| (particles[*j as usize].position - particles[i].position).length_squared();
            let naive: Vec<u32> = (0..200).filter(|j| distance(j) <= reach * reach).collect();
            assert_eq!(found, naive, "particle {i}, step {step}");
        }
        for (i, particle) in particles.iter_mut().enumerate() {
            particle.position += Vec3::new(1.0, -1.0, 0.0) * if i % 2 == 0 { 6e-4 } else { -6e-4 };
            particle.radius *= 1.0 + 1e-3 * (i % 3) as f32;
        }
    }
    assert!((3..30).contains(&made), "made {made} times in 60 steps");
}

#[test]
fn velocity_is_that_of_steepest_descent_of_both_energies_of_every_pair() {
    let scheme = witkin_heckbert();
    let mut particles = crowd(60);
    repel(&mut particles, WitkinHeckbert::reach, |particles, i, near| scheme.repel(particles, i, near));
    // −σ² ∂/∂p of Σ E_ij + E_ji, whose terms would be subtracted without the erratum.
    let total = |i: usize, place: DVec3| -> f64 {
        (0..particles.len())
            .filter(|&j| j != i)
            .map(|j| {
                let offset = place - particles[j].position.as_dvec3();
                // A pair that is cut off at the middle is so at both ends of the difference.
                let at_rest = particles[i].position.as_dvec3() - particles[j].position.as_dvec3();
                let of = |sigma: f32| {
                    let sigma = f64::from(sigma);
                    if energy(at_rest, sigma) > 0.0 {
                        6.0 * libm::exp(-offset.length_squared() / (2.0 * sigma * sigma))
                    } else {
                        0.0
                    }
                };
                of(particles[i].radius) + of(particles[j].radius)
            })
            .sum()
    };
    let h = 1e-5;
    for (i, particle) in particles.iter().enumerate() {
        let place = particle.position.as_dvec3();
        let along = |axis: DVec3| (total(i, place + axis * h) - total(i, place - axis * h)) / (2.0 * h);
        let wanted = -DVec3::new(along(DVec3::X), along(DVec3::Y), 0.0) * f64::from(particle.radius).powi(2);
        let got = scheme.velocity(particle).as_dvec3();
        assert!((got - wanted).length() < 1e-3 * (wanted.length() + 0.1), "particle {i}: {got} for {wanted}");
    }
}

#[test]
fn velocity_leaves_the_normal_to_the_way_back_to_the_surface() {
    let scheme = witkin_heckbert();
    let particle = Particle {
        force: Vec3::new(3.0, -2.0, 7.0),
        height: 0.02,
        ..Particle::new(Vec3::ZERO, Vec3::Z, WANTED)
    };
    let velocity = scheme.velocity(&particle);
    // φ = 15.
    assert!((velocity - Vec3::new(0.03, -0.02, -0.3)).length() < 1e-6, "{velocity}");
}

#[test]
fn radius_grows_as_fast_as_brings_the_energy_to_the_wanted_one() {
    let scheme = witkin_heckbert();
    let mut particles = crowd(60);
    repel(&mut particles, WitkinHeckbert::reach, |particles, i, near| scheme.repel(particles, i, near));
    for (i, particle) in particles.iter().enumerate() {
        let own = |sigma: f64| -> f64 {
            let offset = |j: usize| (particles[j].position - particle.position).as_dvec3();
            let is_near = |j: &usize| *j != i && energy(offset(*j), f64::from(particle.radius)) > 0.0;
            (0..60)
                .filter(is_near)
                .map(|j| 6.0 * libm::exp(-offset(j).length_squared() / (2.0 * sigma * sigma)))
                .sum()
        };
        let (sigma, h) = (f64::from(particle.radius), 1e-6);
        let slope = (own(sigma + h) - own(sigma - h)) / (2.0 * h);
        // ρ = 15, Ê = 4.8, β = 10 per half diameter, which is 1.
        let wanted = -15.0 * (own(sigma) - 4.8) / (slope + 10.0);
        let got = f64::from(scheme.growth(particle));
        assert!((got - wanted).abs() < 1e-3 * (wanted.abs() + 0.1), "particle {i}: {got} for {wanted}");
    }
}

#[test]
fn lone_particle_grows_and_divides_at_half_the_diameter() {
    let scheme = witkin_heckbert();
    let lone = Particle::new(Vec3::X, Vec3::X, WANTED);
    assert!((scheme.growth(&lone) - 7.2).abs() < 1e-5);
    assert!(!scheme.divides(&lone));
    assert!(!scheme.divides(&Particle { radius: 0.99, ..lone }));
    assert!(scheme.divides(&Particle { radius: 1.0, ..lone }));
}

#[test]
fn fission_and_death_are_as_in_the_source() {
    let scheme = witkin_heckbert();
    let at = |radius: f32, load: f32, speed: f32| Particle {
        load,
        speed,
        ..Particle::new(Vec3::X, Vec3::X, radius * WANTED)
    };
    // D > νÊ = 0.96 and σ > σ̂, at less than γ = 4.
    assert!(scheme.divides(&at(1.01, 1.0, 3.9)));
    for other in [at(0.99, 1.0, 3.9), at(1.01, 0.9, 3.9), at(1.01, 1.0, 4.1)] {
        assert!(!scheme.divides(&other), "{other:?}");
    }
    // σ < 0.7 σ̂, and a random number above σ/(0.7 σ̂) = 0.5.
    assert!(scheme.dies(&at(0.35, 9.0, 3.9), 0.51));
    assert!(!scheme.dies(&at(0.35, 9.0, 3.9), 0.49));
    assert!(!scheme.dies(&at(0.35, 9.0, 4.1), 0.99));
    assert!(!scheme.dies(&at(0.71, 9.0, 3.9), 0.999_999));
}

#[test]
fn children_share_the_area_of_their_parent_and_sit_on_the_surface() {
    let scheme = witkin_heckbert();
    let mut field = FormulaField::parse("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
    let mut projector = Projector::new();
    let surface = &mut SurfaceContext { field: &mut field, projector: &mut projector };
    let mut random = Pcg32::seed_from_u64(3);
    let parent = Particle::new(Vec3::X, Vec3::X, WANTED);
    let mut mean = Vec3::ZERO;
    for _ in 0..50 {
        let direction = tangent(parent.normal, &mut random);
        assert!((direction.length() - 1.0).abs() < 1e-5 && direction.dot(parent.normal).abs() < 1e-6);
        mean += direction / 50.0;
        let [one, other] = scheme.children(surface, &parent, direction).expect("two children");
        for child in [one, other] {
            assert!((child.radius - WANTED / 2.0_f32.sqrt()).abs() < 1e-7);
            assert!((child.position.length() - 1.0).abs() < 1e-5);
            assert!((child.normal - child.position).length() < 1e-4);
        }
        let apart = (one.position - other.position).length();
        assert!((apart / WANTED - 1.0).abs() < 0.01, "{apart}");
    }
    assert!(mean.length() < 0.3, "directions lean to {mean}");
    // Out of the box there are none.
    let mut corner = scheme;
    corner.bounds.min = [0.0; 3];
    assert!(corner.children(surface, &parent, Vec3::Y).is_none());
}

/// The scheme of forces on the unit sphere, where all radii are the same.
fn forces(field: &mut FormulaField) -> Forces {
    let bounds = Bounds::cube(1.5);
    let survey = survey(field, &bounds, false, &mut Projector::new());
    let mut sizing = Sizing::new(field, &bounds, &Sizes::default(), &survey, &mut 0);
    // 4π / (2√3 r²).
    sizing.scale_to(4.0 * core::f64::consts::PI / (2.0 * 3.0_f64.sqrt() * f64::from(WANTED * WANTED)));
    Forces::new(&Settings::default(), sizing, &bounds, Accuracy::UNLIMITED, 0.0)
}

#[test]
fn forces_are_the_overlaps_of_discs_each_pair_once() {
    let mut field = FormulaField::parse("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
    let scheme = forces(&mut field);
    let mut particles = crowd(120);
    repel(&mut particles, Forces::reach, |particles, i, near| scheme.repel(particles, i, near));
    for (i, particle) in particles.iter().enumerate() {
        let (mut force, mut load) = (Vec3::ZERO, 0.0);
        for other in particles.iter().take(i).chain(&particles[i + 1..]) {
            let offset = particle.position - other.position;
            let sum = particle.radius + other.radius;
            let overlap = 1.15 * sum - offset.length();
            if overlap > 0.0 {
                force += offset / offset.length() * overlap;
                load += (2.0 * overlap / sum).powi(2);
            }
        }
        assert!((particle.force - force).length() < 1e-5, "particle {i}: {} for {force}", particle.force);
        assert!(
            (particle.load - load).abs() < 1e-4 * (1.0 + load),
            "particle {i}: {} for {load}",
            particle.load
        );
    }
}

#[test]
fn free_disc_divides_and_pressed_disc_dies() {
    let mut field = FormulaField::parse("x^2 + y^2 + z^2 = 1", &[]).expect("a formula");
    let scheme = forces(&mut field);
    let surface = &mut SurfaceContext { field: &mut field, projector: &mut Projector::new() };
    let free = Particle::new(Vec3::X, Vec3::X, WANTED);
    assert!(scheme.divides(&free));
    assert!(!scheme.divides(&Particle { moved: 0.2, ..free }));
    assert!(!scheme.divides(&Particle { load: 0.02, ..free }));
    // Six neighbours at 0.7 of the spacing: 6 (2.3 − 1.4)² = 4.86.
    assert!(!scheme.dies(&Particle { load: 4.85, ..free }, 0.999_999));
    assert!(scheme.dies(&Particle { load: 9.72, ..free }, 0.51));
    assert!(!scheme.dies(&Particle { load: 9.72, ..free }, 0.49));
    let children = scheme.children(surface, &free, Vec3::Y).expect("two children");
    for child in children {
        // The law's own, not a share of the parent's.
        assert!((child.radius / WANTED - 1.0).abs() < 0.01, "{}", child.radius);
        assert!((child.position.length() - 1.0).abs() < 1e-5);
    }
}
