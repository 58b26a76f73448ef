//! The two particle systems that the paper compares its methods with, following the general scheme
//! of §3 line by line.
//!
//! ```text
//! Create a set of particles lying on the surface             add_seeds: one particle
//! while Convergence is not reached do                        is_over
//!     Compute the repulsion radius (or radii)                a part of Dynamics, applied with the move
//!     Compute the energy of the set of particles             interact
//!     Compute the velocity of the set of particles           interact
//!     Update the position of the particles                   move_by_system
//!     Split or kill particles when necessary                 decide_on
//! end while
//! ```
//!
//! `witkin_heckbert` and `forces` hold each system's rules for moves, divisions and deaths. An
//! iteration is a chapter.
//!
//! # Differences from the paper
//!
//! * The paper detects convergence by the number of particles and their residual motion and gives
//!   no thresholds (§3). Here a run has settled after [`QUIET`] consecutive iterations without
//!   fission or death and with a mean move of at most [`REST`].
//! * The first particle does not die, so that at least one remains.

use super::course::{ChapterKind, Course};
use super::dynamics::{Dynamics, largest_move};
use super::event::Event;
use super::settings::LessonMethod;
use super::{forces, witkin_heckbert};
use crate::math::frame_of;
use crate::paper::{Buckets, GAUSSIAN_REACH, OVERLAP_REACH, Particle};
use core::iter::successors;
use glam::DVec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// Consecutive quiet iterations after which a run has settled; over so many a particle moves by at
/// most a tenth of its radius on average.
pub(super) const QUIET: u32 = 20;

/// Mean move in an iteration, in radii, below which the particles count as still. Larger: a run
/// ends sooner, and fewer particles have six neighbours.
const REST: f64 = 0.005;

/// A random number in [0, 1).
fn uniform(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32() >> 8) / 16_777_216.0
}

/// A random unit vector in the tangent plane: the direction of a random point in the unit disc.
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

impl Course {
    fn is_over(&self) -> bool {
        self.run.particles.is_empty()
            || self.run.seen.is_capped
            || self.quiet >= QUIET
            || self.steps >= self.setup.settings.max_iterations
    }

    /// Begins the next iteration; `None` at the end of the run.
    pub(super) fn begin_iteration(&mut self) -> Option<ChapterKind> {
        if self.run.particles.is_empty() {
            self.add_seeds();
            self.waiting.clear();
        }
        if self.is_over() {
            return None;
        }
        let sum: f64 = self.run.particles.iter().map(|particle| particle.radius).sum();
        let mean = sum / self.run.particles.len() as f64;
        self.interact(mean);
        let iteration = self.steps + 1;
        let particles = self.run.particles.len() as u32;
        let energy = self.dynamics.iter().map(|own| own.energy).sum::<f64>() / f64::from(particles);
        self.run.seen.push(Event::IterationBegins { iteration, particles, energy });
        // First every particle moves; then each may divide or die.
        self.left = 2 * particles;
        Some(ChapterKind::Iteration { iteration })
    }

    /// "Compute the energy", "compute the velocity": sums over all pairs within reach. `mean` is
    /// the mean radius.
    fn interact(&mut self, mean: f64) {
        let is_gaussian = self.setup.settings.method == LessonMethod::WitkinHeckbert;
        // A disc only meets discs that are not larger.
        let reach = if is_gaussian { GAUSSIAN_REACH } else { 2.0 * OVERLAP_REACH };
        let particles = &self.run.particles;
        self.run.buckets = Buckets::new(reach * mean, particles);
        self.dynamics.clear();
        self.dynamics.resize(particles.len(), Dynamics::default());
        for (i, own) in particles.iter().enumerate() {
            for near in self.run.buckets.near(particles, own.p(), reach * own.radius) {
                let j = near.particle as usize;
                let other = &particles[j];
                // Particles that face away from each other are on opposite sides of a thin part.
                if j == i || own.n().dot(other.n()) <= 0.0 {
                    continue;
                }
                if is_gaussian {
                    witkin_heckbert::interact(&mut self.dynamics, (i, own), (j, other));
                } else {
                    forces::interact(&mut self.dynamics, (i, own), (j, other));
                }
                self.interactions += 1;
            }
        }
    }

    /// Does one unit of an iteration.
    pub(super) fn iterate(&mut self) {
        // Children born in this iteration take part from the next one on.
        let living = self.dynamics.len();
        let done = 2 * living - self.left as usize;
        if done < living {
            self.move_by_system(done);
        } else {
            self.decide_on(done - living);
        }
        self.left -= 1;
        if self.left == 0 {
            self.end_iteration();
        }
    }

    /// "Update the position of the particles", and the radius with it.
    fn move_by_system(&mut self, i: usize) {
        let method = self.setup.settings.method;
        let own = self.run.particles[i];
        let dynamics = &mut self.dynamics[i];
        let (force, moved) = match method {
            LessonMethod::WitkinHeckbert => {
                let particle = &mut self.run.particles[i];
                witkin_heckbert::step(&mut self.run.surface, &self.setup, particle, dynamics)
            }
            LessonMethod::Front | LessonMethod::Forces => forces::step(&mut self.run, i, dynamics),
        };
        let particle = &self.run.particles[i];
        dynamics.moved = particle.p().distance(own.p()) / particle.radius;
        if method == LessonMethod::Forces {
            dynamics.is_at_rest = dynamics.moved < forces::AT_REST;
        }
        self.tell_move(i, force, &moved);
    }

    /// "Split or kill particles when necessary".
    fn decide_on(&mut self, i: usize) {
        let (own, dynamics) = (self.run.particles[i], self.dynamics[i]);
        let chance = uniform(&mut self.random);
        let (dies, divides) = match self.setup.settings.method {
            LessonMethod::WitkinHeckbert => (
                witkin_heckbert::dies(&self.setup, &own, &dynamics, chance),
                witkin_heckbert::divides(&self.setup, &own, &dynamics),
            ),
            LessonMethod::Front | LessonMethod::Forces => {
                (forces::dies(&dynamics, chance), forces::divides(&dynamics))
            }
        };
        let most = self.run.rules.max_particles;
        if dies && i > 0 {
            self.dynamics[i].dies = true;
        } else if divides && self.run.particles.len() < most {
            let direction = tangent(own.normal, &mut self.random);
            let Some(data) = self.children(&own, direction) else { return };
            let child = self.run.particles.len() as u32;
            self.run.particles[i] = data[0];
            self.run.particles.push(data[1]);
            let (data, energy) = (Box::new(data), dynamics.energy);
            self.run.seen.push(Event::Divided { particle: i as u32, child, data, energy });
            self.run.seen.is_capped = self.run.particles.len() >= most;
        }
    }

    /// The two children of a particle, half a radius to either side. If one of them cannot be
    /// returned to the surface, as around a lone particle larger than its surface, the distance is
    /// halved repeatedly, down to half the wanted radius. `None` if that fails, too.
    ///
    /// The sources do not say where children are put.
    fn children(&mut self, parent: &Particle, direction: DVec3) -> Option<[Particle; 2]> {
        let wanted = match self.setup.settings.method {
            LessonMethod::WitkinHeckbert => witkin_heckbert::wanted(&self.setup),
            LessonMethod::Front | LessonMethod::Forces => parent.radius,
        };
        let halves = successors(Some(0.5 * parent.radius), |reach| Some(0.5 * reach));
        halves.take_while(|&reach| reach >= 0.5 * wanted).find_map(|reach| {
            let offset = direction * reach;
            Some([self.child(parent, offset)?, self.child(parent, -offset)?])
        })
    }

    /// A child of a particle at an offset; `None` if it cannot be returned to the surface.
    fn child(&mut self, parent: &Particle, offset: DVec3) -> Option<Particle> {
        let (position, normal) = self.run.come_back(parent, parent.p() + offset, parent.radius)?;
        let radius = match self.setup.settings.method {
            // Together both cover the area of their parent.
            LessonMethod::WitkinHeckbert => parent.radius * core::f64::consts::FRAC_1_SQRT_2,
            LessonMethod::Front | LessonMethod::Forces => self.run.radius_at(position)?,
        };
        let placed = Particle::placed(position, normal, radius, None, parent.level + 1);
        Some(Particle { front: parent.front, ..placed })
    }

    fn end_iteration(&mut self) {
        let mut has_changed = self.run.particles.len() > self.dynamics.len();
        for (i, own) in self.dynamics.iter().enumerate().rev().filter(|(_, own)| own.dies) {
            self.run.particles.remove(i);
            self.run.seen.push(Event::Died { particle: i as u32, energy: own.energy });
            has_changed = true;
        }
        let mean_move = self.dynamics.iter().map(|own| own.moved).sum::<f64>() / self.dynamics.len() as f64;
        let is_quiet = !has_changed && mean_move <= REST;
        self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
        self.steps += 1;
        self.run.seen.push(Event::IterationEnds {
            iteration: self.steps,
            particles: self.run.particles.len() as u32,
            largest_move: largest_move(&self.dynamics),
            mean_move,
        });
    }
}
