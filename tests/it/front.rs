//! Tests of the uniform front (paper §4): its quality on smooth surfaces, and its agreement, though it places whole
//! levels at once, with the sequential algorithm.
#![allow(
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "the naive sampler follows the paper slot by slot, and on a smooth surface the vectors it normalises are not zero"
)]

use crate::smooth::smooth;
use glam::Vec3;
use marching_particles::field::Field;
use marching_particles::field::gallery;
use marching_particles::particles::{Particles, SlotFate};
use marching_particles::quality::{self, Figures};
use marching_particles::sampler::{GapPolicy, Sampler, Settings, SizeMode, StopReason};

/// Smallest share of particles with six neighbours and smallest mean minimum angle after the front, with 56,000
/// particles. The aim is 0.93 and 55.5° everywhere. The torus misses the angle, and the tanglecube misses both. Where
/// the curvature changes its sign, the rows of the front are compressed on one side and stretched on the other. Fronts
/// that went around a handle meet out of step. The hexagons of the paper do not adapt to either.
const ORDER: [(&str, f64, f64); 4] =
    [("sphere", 0.93, 55.5), ("ellipsoid", 0.93, 55.5), ("torus", 0.93, 54.5), ("tanglecube", 0.88, 54.0)];

fn sampled(surface: &str, settings: &Settings) -> Sampler {
    let surface = gallery::find(surface).expect("a gallery surface");
    let mut field = surface.field();
    let mut sampler = Sampler::new();
    sampler.start(&mut field, &surface.bounds, settings).expect("valid settings");
    while sampler.step(&mut field, 5_000).stop_reason.is_none() {}
    sampler
}

/// Samples by the front of the paper alone, without gap filling and relaxation.
fn front(surface: &str, radius_share: f64) -> Sampler {
    let settings = Settings { radius_share, relax_steps: 0, gaps: GapPolicy::Leave, ..Settings::default() };
    sampled(surface, &settings)
}

fn figures(surface: &str, particles: &Particles) -> Figures {
    let surface = gallery::find(surface).expect("a gallery surface");
    let mut field = surface.field();
    let options = quality::Options::default();
    quality::measure(&particles.position, &particles.normal, &mut field, Some(&surface.bounds), &options)
        .figures
}

/// The sequential front of the paper: it treats one particle after the other, searches all particles for neighbours,
/// and projects each child by itself as soon as it is proposed. Rules and arithmetic are those of the sampler; the
/// order of work, the neighbour search and the batches are not.
struct Naive {
    position: Vec<Vec3>,
    normal: Vec<Vec3>,
    parent: Vec<u32>,
    level: Vec<u32>,
    slots: Vec<[SlotFate; 6]>,
}

struct NaiveChild {
    parent: usize,
    slot: usize,
    direction: Vec3,
    guess: [f32; 2],
    place: Vec3,
    normal: Vec3,
}

const DIRECTION: [[f32; 2]; 6] = [
    [1.0, 0.0],
    [0.5, 0.866_025_4],
    [-0.5, 0.866_025_4],
    [-1.0, 0.0],
    [-0.5, -0.866_025_4],
    [0.5, -0.866_025_4],
];

impl Naive {
    fn run(field: &mut dyn Field, seed: Vec3, seed_normal: Vec3, radius: f32, match_tolerance: f32) -> Self {
        let mut all = Self {
            position: vec![seed],
            normal: vec![seed_normal],
            parent: vec![Particles::NO_PARENT],
            level: vec![0],
            slots: vec![[SlotFate::Open; 6]],
        };
        let match_radius = 2.0 * radius * match_tolerance;
        let mut level = 0..1;
        while !level.is_empty() {
            let mut children: Vec<NaiveChild> = Vec::new();
            for parent in level.clone() {
                all.free_slots(field, parent, radius, match_radius, &mut children);
            }
            let first = all.position.len();
            for child in &children {
                let (p, n) = (all.position[child.parent], all.normal[child.parent]);
                let (position, normal) = on_circle(field, p, n, child.direction, 2.0 * radius, child.guess);
                let taken = (0..all.position.len()).any(|j| {
                    let offset = all.position[j] - position;
                    offset.length() <= match_radius && same_sheet(offset, normal, all.normal[j], match_radius)
                });
                all.slots[child.parent][child.slot] = if taken { SlotFate::Matched } else { SlotFate::Added };
                if !taken {
                    all.position.push(position);
                    all.normal.push(normal);
                    all.parent.push(child.parent as u32);
                    all.level.push(all.level[child.parent] + 1);
                    all.slots.push([SlotFate::Open; 6]);
                    all.slots.last_mut().expect("just pushed")[0] = SlotFate::Parent;
                }
            }
            level = first..all.position.len();
        }
        all
    }

    fn free_slots(
        &mut self,
        field: &mut dyn Field,
        parent: usize,
        radius: f32,
        match_radius: f32,
        children: &mut Vec<NaiveChild>,
    ) {
        let (p, n) = (self.position[parent], self.normal[parent]);
        let is_seed = self.parent[parent] == Particles::NO_PARENT;
        let (u, w) = if is_seed {
            marching_particles::math::tangent_frame(n)
        } else {
            let towards = self.position[self.parent[parent] as usize] - p;
            let u = (towards - n * towards.dot(n)).normalize();
            (u, n.cross(u))
        };
        let shape = if is_seed { from_hessian(field, p, u, w) } else { self.fitted(parent, radius, u, w) };
        for slot in usize::from(!is_seed)..6 {
            let [cos, sin] = DIRECTION[slot];
            let direction = u * cos + w * sin;
            let turn = u * (shape[0] * cos + shape[1] * sin) + w * (shape[1] * cos + shape[2] * sin);
            let sin_theta = (-turn.dot(direction) * radius).clamp(-0.9, 0.9);
            let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
            let place = p + (direction * cos_theta + n * sin_theta) * (2.0 * radius);
            let normal = (n + turn * (2.0 * radius * cos_theta)).normalize();
            let occupied = |q: Vec3, m: Vec3| {
                (q - place).length() <= match_radius && same_sheet(q - place, normal, m, match_radius)
            };
            let taken = (0..self.position.len()).any(|j| occupied(self.position[j], self.normal[j]))
                || children.iter().any(|child| occupied(child.place, child.normal));
            if taken {
                self.slots[parent][slot] = SlotFate::Matched;
            } else {
                let guess = [cos_theta, sin_theta];
                children.push(NaiveChild { parent, slot, direction, guess, place, normal });
            }
        }
    }

    /// Second fundamental form fitted to the normals around `parent` by least squares, with slight regularisation
    /// towards isotropy.
    fn fitted(&self, parent: usize, radius: f32, u: Vec3, w: Vec3) -> [f32; 3] {
        let (p, n) = (self.position[parent], self.normal[parent]);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let (mut xa, mut ya, mut xb, mut yb) = (0.0, 0.0, 0.0, 0.0);
        for j in (0..self.position.len()).filter(|&j| j != parent) {
            let (offset, turn) = (self.position[j] - p, self.normal[j] - n);
            if offset.length_squared() > (2.6 * radius) * (2.6 * radius) || turn.length_squared() > 1.0 {
                continue;
            }
            let [x, y, a, b] = [offset.dot(u), offset.dot(w), turn.dot(u), turn.dot(w)];
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            (xa, ya, xb, yb) = (xa + x * a, ya + y * a, xb + x * b, yb + y * b);
        }
        let pull = 0.005 * (xx + yy);
        let m = [[xx + pull, xy, -pull], [xy, xx + yy + pull, xy], [-pull, xy, yy + pull]];
        let right = [xa, ya + xb, yb];
        // The symmetric matrix is inverted by cofactors.
        let cofactor = |i: usize, k: usize| {
            let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3);
            m[a][c] * m[b][d] - m[a][d] * m[b][c]
        };
        let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        let inverse = 1.0 / determinant;
        [0, 1, 2].map(|i| {
            (cofactor(i, 0) * right[0] + cofactor(i, 1) * right[1] + cofactor(i, 2) * right[2]) * inverse
        })
    }
}

fn same_sheet(offset: Vec3, normal: Vec3, other: Vec3, match_radius: f32) -> bool {
    let rise = offset.dot(normal);
    normal.dot(other) > 0.0
        && rise * rise <= 0.5 * (offset.length_squared() + 0.25 * match_radius * match_radius)
}

fn from_hessian(field: &mut dyn Field, p: Vec3, u: Vec3, w: Vec3) -> [f32; 3] {
    let jet = field.jet(p.as_dvec3());
    let (u, w) = (u.as_dvec3(), w.as_dvec3());
    [(u, u), (u, w), (w, w)].map(|(a, b)| (a.dot(jet.hessian.apply(b)) / jet.gradient.length()) as f32)
}

/// Point of the surface on the circle around `p` that Newton's method finds from `guess`.
fn on_circle(
    field: &mut dyn Field,
    p: Vec3,
    n: Vec3,
    direction: Vec3,
    distance: f32,
    guess: [f32; 2],
) -> (Vec3, Vec3) {
    let [mut cos, mut sin] = guess;
    for _ in 0..12 {
        let q = p + (direction * cos + n * sin) * distance;
        let (mut value, mut gradient) = ([0.0], [Vec3::ZERO]);
        field.gradients(&[q], &mut value, &mut gradient);
        let slope = gradient[0].length();
        if value[0].abs() <= 0.5e-4 * distance * slope {
            return (q, gradient[0] / slope);
        }
        let derivative = gradient[0].dot((n * cos - direction * sin) * distance);
        // Tangent of half the rotation angle.
        let t = (-0.5 * value[0] / derivative).clamp(-0.2, 0.2);
        let scale = 1.0 / (1.0 + t * t);
        let (c, s) = ((1.0 - t * t) * scale, 2.0 * t * scale);
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
    }
    panic!("the naive front needs a radius at which Newton's method converges everywhere");
}

#[test]
fn the_front_places_the_particles_of_the_sequential_algorithm() {
    for (surface, share) in [("sphere", 0.02), ("ellipsoid", 0.02), ("torus", 0.02), ("tanglecube", 0.008)] {
        let sampler = front(surface, share);
        let fast = sampler.particles();
        assert_eq!(sampler.counts().seeds, 1, "{surface}");
        let mut field = gallery::find(surface).expect("a gallery surface").field();
        let naive = Naive::run(&mut field, fast.position[0], fast.normal[0], sampler.radius() as f32, 0.7);
        assert_eq!(fast.len(), naive.position.len(), "{surface}");
        assert_eq!(fast.parent, naive.parent, "{surface}");
        assert_eq!(fast.level, naive.level, "{surface}");
        let slots: Vec<_> = fast.slots.iter().map(|s| [0, 1, 2, 3, 4, 5].map(|k| s.get(k))).collect();
        assert_eq!(slots, naive.slots, "{surface}");
        // The positions differ by rounding, since the curvature fit has another order of operations. If rounding
        // decides whether a child passes the residual of 10⁻⁴ r, the difference is of that size and grows from level to
        // level, to 0.9 % of r on the tanglecube.
        let apart =
            fast.position.iter().zip(&naive.position).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(apart < 0.02 * sampler.radius() as f32, "{surface}: {apart} apart");
    }
}

#[test]
fn a_front_covers_smooth_surfaces_regularly() {
    for (surface, euler) in smooth() {
        let sampler = sampled(
            surface,
            &Settings { size_mode: SizeMode::Count, count: 14_000, relax_steps: 0, ..Settings::default() },
        );
        assert!(sampler.counts().gaps_filled > 0, "{surface}");
        let figures = figures(surface, sampler.particles());
        let context = format!("{surface}, {} particles, seed 0: {figures:?}", sampler.particles().len());
        assert!(figures.cover <= 1.5, "{context}");
        assert_eq!(figures.open, 0, "{context}");
        assert_eq!(figures.components, 1, "{context}");
        assert_eq!(figures.euler, euler, "{context}");
        // A residual of 10⁻⁴ r is half of that in units of the spacing. Single precision adds its rounding.
        assert!(figures.err_max <= 2.5e-4, "{context}");
        // No two particles are closer than the match tolerance.
        let closest = figures.nn_min * figures.d_hex / (2.0 * sampler.radius());
        assert!(closest >= 0.7 * (1.0 - 1e-5), "{context}: closest pair {closest}");
    }
}

#[test]
fn most_particles_of_a_front_have_six_neighbours() {
    for (surface, six, angle) in ORDER {
        let settings =
            Settings { size_mode: SizeMode::Count, count: 55_748, relax_steps: 0, ..Settings::default() };
        let sampler = sampled(surface, &settings);
        let figures = figures(surface, sampler.particles());
        let context = format!("{surface}, {} particles, seed 0: {figures:?}", sampler.particles().len());
        assert!(figures.six >= six, "{context}");
        assert!(figures.ang_min_mean >= angle, "{context}");
    }
}

#[test]
fn filling_gaps_shrinks_the_largest_hole_and_crowds_nothing() {
    for (surface, _) in smooth() {
        let settings = Settings { radius_share: 0.006, relax_steps: 0, ..Settings::default() };
        let left = sampled(surface, &Settings { gaps: GapPolicy::Leave, ..settings });
        let filled = sampled(surface, &settings);
        let (left, particles) = (left.particles(), filled.particles());
        let count = filled.counts().gaps_filled as usize;
        assert_eq!(particles.len(), left.len() + count, "{surface}");
        assert_eq!(particles.position[..left.len()], left.position, "{surface}");
        let (was, is) = (figures(surface, left), figures(surface, particles));
        // The unit is 2r, because the hexagonal spacing changes with the count.
        let hole = |f: &Figures| f.cover * f.d_hex / 3.0_f64.sqrt() / (2.0 * filled.radius());
        assert!(hole(&is) < hole(&was), "{surface}: {} to {}", hole(&was), hole(&is));
        assert!(hole(&is) < 0.83, "{surface}: {}", hole(&is));
        for i in left.len()..particles.len() {
            for j in 0..i {
                let d = particles.position[i].distance(particles.position[j]);
                let near = particles.normal[i].dot(particles.normal[j]) > 0.0;
                assert!(
                    !near || f64::from(d) >= 0.8 * 2.0 * filled.radius() * (1.0 - 1e-6),
                    "{surface}: {i} {j}"
                );
            }
        }
    }
}

#[test]
fn a_particle_costs_about_two_evaluations() {
    for (surface, _) in smooth() {
        let sampler =
            sampled(surface, &Settings { radius_share: 0.006, relax_steps: 0, ..Settings::default() });
        let per_particle = sampler.counts().front_evaluations as f64 / sampler.particles().len() as f64;
        assert!(per_particle <= 2.2, "{surface}: {per_particle}");
    }
}

#[test]
fn every_child_is_two_radii_from_its_parent() {
    for (surface, _) in smooth() {
        let sampler = front(surface, 0.01);
        let particles = sampler.particles();
        let distance = 2.0 * sampler.radius() as f32;
        for i in 1..particles.len() {
            let parent = particles.parent[i] as usize;
            assert!(
                parent < i && particles.level[i] == particles.level[parent] + 1,
                "{surface}: particle {i}"
            );
            let d = particles.position[i].distance(particles.position[parent]);
            assert!((d / distance - 1.0).abs() < 1e-4, "{surface}: particle {i} is {d} from its parent");
        }
    }
}

#[test]
fn levels_increase_along_the_columns_and_grow_as_hexagons() {
    let sampler = front("sphere", 0.01);
    let particles = sampler.particles();
    assert!(particles.level.is_sorted());
    assert!(particles.parent[1..].is_sorted());
    // In the plane, level k of a hexagonal front has 6k particles.
    let count = |level| particles.level.iter().filter(|&&l| l == level).count();
    assert_eq!([0, 1, 2, 3, 4].map(count), [1, 6, 12, 18, 24]);
}

#[test]
fn fates_of_slots_agree_with_the_counts() {
    for surface in ["torus", "gyroid", "kummer"] {
        let sampler = front(surface, 0.01);
        let (particles, fates) = (sampler.particles(), sampler.counts().fates);
        let count = |fate| {
            particles.slots.iter().flat_map(|s| (0..6).map(|k| s.get(k))).filter(|&f| f == fate).count()
                as u64
        };
        assert_eq!(count(SlotFate::Added), fates.added, "{surface}");
        assert_eq!(count(SlotFate::Matched), fates.matched, "{surface}");
        assert_eq!(count(SlotFate::Outside), fates.outside, "{surface}");
        assert_eq!(count(SlotFate::NotConverged), fates.not_converged, "{surface}");
        assert_eq!(count(SlotFate::Undefined), fates.undefined, "{surface}");
        assert_eq!(count(SlotFate::Open), 0, "{surface}");
        let seeds = particles.parent.iter().filter(|&&p| p == Particles::NO_PARENT).count() as u64;
        assert_eq!(fates.added + seeds, particles.len() as u64, "{surface}");
        assert_eq!(count(SlotFate::Parent) + seeds, particles.len() as u64, "{surface}");
    }
}

#[test]
fn every_gallery_surface_is_sampled_with_finite_normals() {
    for surface in gallery::SURFACES {
        let mut field = surface.field();
        let mut sampler = Sampler::new();
        let settings = Settings { radius_share: 0.012, ..Settings::default() };
        sampler.start(&mut field, &surface.bounds, &settings).expect("valid settings");
        let progress = loop {
            let progress = sampler.step(&mut field, 5_000);
            if progress.stop_reason.is_some() {
                break progress;
            }
        };
        assert_eq!(progress.stop_reason, Some(StopReason::Complete), "{}", surface.id);
        let particles = sampler.particles();
        assert!(particles.len() > 500, "{}: {} particles", surface.id, particles.len());
        for (p, n) in particles.position.iter().zip(&particles.normal) {
            assert!(surface.bounds.contains(*p), "{}: {p} outside the box", surface.id);
            assert!((n.length() - 1.0).abs() < 1e-5, "{}: normal {n}", surface.id);
        }
    }
}
