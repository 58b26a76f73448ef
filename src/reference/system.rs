//! The two particle systems that the paper compares its methods with: the general scheme of §3, line by line.
//!
//! ```text
//! Create a set of particles lying on the surface             add_seeds: one particle
//! while Convergence is not reached do                        is_over
//!     Compute the repulsion radius (or radii)                a part of Felt, applied with the move
//!     Compute the energy of the set of particles             feel
//!     Compute the velocity of the set of particles           feel
//!     Update the position of the particles                   move_by_system
//!     Split or kill particles when necessary                 decide_on
//! end while
//! ```
//!
//! What a particle feels and when it divides or dies is in `witkin_heckbert` and `forces`. An iteration is a chapter.
//!
//! # Differs from the paper
//!
//! * The paper detects convergence by the number of particles and their residual motion and gives no numbers (§3). Here a run has
//!   settled after [`QUIET`] consecutive iterations without fission and death and with a mean motion of at most [`REST`].
//! * The first particle does not die, so that there always is one.

use super::buckets::Buckets;
use super::event::Event;
use super::felt::{Felt, Step};
use super::settings::Method;
use super::state::Particle;
use super::surface::{Landing, Surface};
use super::walk::{ChapterKind, Setup, Walk};
use super::{forces, witkin_heckbert};
use crate::math::frame_of;
use glam::DVec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// Consecutive iterations of rest after which a run has settled.
pub(super) const QUIET: u32 = 20;

/// Mean move in an iteration, in radii, up to which particles count as not moving.
const REST: f64 = 0.005;

/// A random number in [0, 1).
fn uniform(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32() >> 8) / 16_777_216.0
}

/// A random unit vector in the tangent plane: that of a point of the square that is in the unit disc.
fn tangent(normal: [f64; 3], random: &mut Pcg32) -> DVec3 {
    let (u, v) = frame_of(normal);
    loop {
        let [a, b] = [0, 1].map(|_| 2.0 * uniform(random) - 1.0);
        let length_sq = a * a + b * b;
        if length_sq > 1e-4 && length_sq <= 1.0 {
            return (DVec3::from(u) * a + DVec3::from(v) * b) / length_sq.sqrt();
        }
    }
}

impl Walk {
    fn is_over(&self, setup: &Setup) -> bool {
        let place = &self.place;
        self.particles.is_empty()
            || place.is_capped
            || place.quiet >= QUIET
            || place.steps >= setup.settings.max_iterations
    }

    /// Begins the next iteration; `None` at the end of the run.
    pub(super) fn begin_iteration(
        &mut self,
        surface: &mut Surface,
        setup: &Setup,
        log: &mut Vec<Event>,
    ) -> Option<ChapterKind> {
        if self.particles.is_empty() {
            self.add_seeds(surface, setup, log);
            self.place.waiting.clear();
        }
        if self.is_over(setup) {
            return None;
        }
        let sum: f64 = self.particles.iter().map(|particle| particle.radius).sum();
        let mean = sum / self.particles.len() as f64;
        self.feel(setup, mean);
        let iteration = self.place.steps + 1;
        let particles = self.particles.len() as u32;
        let energy = self.felt.iter().map(|felt| felt.energy).sum::<f64>() / f64::from(particles);
        log.push(Event::IterationBegins { iteration, particles, energy });
        // Every particle moves, then every particle is decided on.
        self.left = 2 * particles;
        self.dying.clear();
        self.largest_move = 0.0;
        Some(ChapterKind::Iteration { iteration })
    }

    /// "Compute the energy", "compute the velocity": sums over all pairs within reach. `mean` is the mean radius.
    fn feel(&mut self, setup: &Setup, mean: f64) {
        let is_gaussian = setup.settings.method == Method::WitkinHeckbert;
        let reach = if is_gaussian { witkin_heckbert::RANGE } else { forces::RANGE };
        self.buckets = Buckets::new(reach * mean, &self.particles);
        self.felt.clear();
        self.felt.resize(self.particles.len(), Felt::default());
        for (i, own) in self.particles.iter().enumerate() {
            for near in self.buckets.near(&self.particles, own.p(), reach * own.radius) {
                let j = near.particle as usize;
                let other = &self.particles[j];
                // Particles that face away from each other are on two sides of a thin part.
                if j == i || own.n().dot(other.n()) <= 0.0 {
                    continue;
                }
                if is_gaussian {
                    witkin_heckbert::feel(&mut self.felt, (i, own), (j, other));
                } else {
                    forces::feel(&mut self.felt, (i, own), (j, other));
                }
            }
        }
    }

    /// One unit of an iteration.
    pub(super) fn iterate(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        // Children that are born in this iteration have their turn in the next one.
        let living = self.felt.len();
        let done = 2 * living - self.left as usize;
        if done < living {
            self.move_by_system(surface, setup, done, log);
        } else {
            self.decide_on(surface, setup, done - living, log);
        }
        self.left -= 1;
        if self.left == 0 {
            self.end_iteration(log);
        }
    }

    /// "Update the position of the particles", and the radius with it.
    fn move_by_system(&mut self, surface: &mut Surface, setup: &Setup, i: usize, log: &mut Vec<Event>) {
        let own = self.particles[i];
        let (felt, particle) = (&mut self.felt[i], &mut self.particles[i]);
        let Step { force, target, arrived } = match setup.settings.method {
            Method::WitkinHeckbert => witkin_heckbert::step(surface, setup, particle, felt),
            Method::Front | Method::Forces => forces::step(surface, setup, particle, felt),
        };
        if let Some(arrived) = arrived {
            *particle = arrived;
        }
        felt.moved = particle.p().distance(own.p()) / particle.radius;
        if setup.settings.method == Method::Forces {
            felt.is_at_rest = felt.moved < forces::AT_REST;
        }
        self.largest_move = self.largest_move.max(felt.moved);
        log.push(Event::Moved {
            particle: i as u32,
            force: force.to_array(),
            target: target.to_array(),
            position: particle.position,
            normal: particle.normal,
            radius: particle.radius,
            is_kept: arrived.is_none(),
        });
    }

    /// "Split or kill particles when necessary".
    fn decide_on(&mut self, surface: &mut Surface, setup: &Setup, i: usize, log: &mut Vec<Event>) {
        let (own, felt) = (self.particles[i], self.felt[i]);
        let chance = uniform(&mut self.place.random);
        let (dies, divides) = match setup.settings.method {
            Method::WitkinHeckbert => (
                witkin_heckbert::dies(setup, &own, &felt, chance),
                witkin_heckbert::divides(setup, &own, &felt),
            ),
            Method::Front | Method::Forces => (forces::dies(&felt, chance), forces::divides(&felt)),
        };
        if dies && i > 0 {
            self.dying.push(i as u32);
        } else if divides && self.particles.len() < setup.settings.max_particles as usize {
            let direction = tangent(own.normal, &mut self.place.random);
            let Some(data) = children(surface, setup, &own, direction) else { return };
            let child = self.particles.len() as u32;
            self.particles[i] = data[0];
            self.particles.push(data[1]);
            self.place.fissions += 1;
            log.push(Event::Divided { particle: i as u32, child, data: Box::new(data), energy: felt.energy });
            self.place.is_capped = self.particles.len() >= setup.settings.max_particles as usize;
        }
    }

    fn end_iteration(&mut self, log: &mut Vec<Event>) {
        let has_changed = !self.dying.is_empty() || self.particles.len() > self.felt.len();
        for &particle in self.dying.iter().rev() {
            self.particles.remove(particle as usize);
            let energy = self.felt[particle as usize].energy;
            log.push(Event::Died { particle, energy });
        }
        self.place.deaths += self.dying.len() as u32;
        let mean_move = self.felt.iter().map(|felt| felt.moved).sum::<f64>() / self.felt.len() as f64;
        let is_quiet = !has_changed && mean_move <= REST;
        self.place.quiet = if is_quiet { self.place.quiet + 1 } else { 0 };
        self.place.steps += 1;
        log.push(Event::IterationEnds {
            iteration: self.place.steps,
            particles: self.particles.len() as u32,
            largest_move: self.largest_move,
            mean_move,
        });
    }
}

/// The two children of a particle, half a radius to either side of it; `None` if one does not come to the surface.
///
/// The sources do not say where they are put.
fn children(
    surface: &mut Surface,
    setup: &Setup,
    parent: &Particle,
    direction: DVec3,
) -> Option<[Particle; 2]> {
    let mut child = |side: f64| {
        let start = parent.p() + direction * (side * parent.radius);
        let residual = setup.residual(parent.radius);
        let Landing::On { position, normal } =
            surface.land_by_newton(start, parent.radius, residual, &mut |_| {})
        else {
            return None;
        };
        let is_here = surface.contains(position) && normal.dot(parent.n()) > 0.0;
        let radius = match setup.settings.method {
            // Both together cover the area that their parent has covered.
            Method::WitkinHeckbert => parent.radius * core::f64::consts::FRAC_1_SQRT_2,
            Method::Front | Method::Forces => setup.radius_at(surface, position)?,
        };
        let level = parent.level + 1;
        is_here.then(|| Particle { level, ..Particle::seed(position, normal, radius, parent.front) })
    };
    Some([child(0.5)?, child(-0.5)?])
}
