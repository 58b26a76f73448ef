//! Relaxation: in uniform sampling (§4.5) the repulsion of Witkin and Heckbert 1994, §4, without fission, death and adaptive
//! radii; in non-uniform sampling (§5.4) forces between discs that overlap.

use super::buckets::Buckets;
use super::event::{Event, Nearby, Vector};
use super::surface::{Landing, Surface};
use super::walk::{Setup, Walk};
use crate::sampler::Sampling;
use glam::DVec3;
use serde::Serialize;

/// The repulsion of a particle by one neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonPush"))]
pub struct Push {
    /// The particle that pushes.
    #[serde(flatten)]
    pub near: Nearby,
    /// Its repulsion, along the offset between the two.
    pub force: Vector,
    /// Energy of the pair.
    pub energy: f64,
}

/// Particles of one size repel each other up to this distance, in σ.
const RANGE: f64 = 3.0;

/// Discs of many sizes push each other up to this distance, in r_i + r_j: discs that barely touch would not push into gaps.
pub(super) const OVERLAP_REACH: f64 = 1.15;

/// Size of a relaxation step in uniform sampling: large enough to mend local faults in ten steps, and stable.
const STEP: f64 = 0.6;

/// Size of a relaxation step in non-uniform sampling.
pub(super) const OVERLAP_STEP: f64 = 0.33;

/// A particle moves by no more than this in a step, in radii.
const MAX_MOVE: f64 = 0.35;

/// Weight of a pair by the cosine between its normals: 1 on one sheet, 0 on two that face away from each other.
fn same_sheet_weight(cosine: f64) -> f64 {
    (0.5 + cosine).clamp(0.0, 1.0)
}

/// Force over offset, and energy, of a pair of particles of one size: E = exp(−d²/2σ²) with σ = r, and each of the two moves
/// along the offset between them times E. The energy is cut off at 3σ and shifted to zero there.
fn gaussian(distance: f64, sigma: f64) -> (f64, f64) {
    let share = distance / sigma;
    let energy = libm::exp(-0.5 * share * share);
    (energy, energy - libm::exp(-0.5 * RANGE * RANGE))
}

/// Force over offset, and energy, of two discs whose radii add up to `both`: they push each other apart by their overlap. The paper
/// gives no formula.
pub(super) fn overlap(distance: f64, both: f64) -> (f64, f64) {
    let overlap = (OVERLAP_REACH * both - distance).max(0.0);
    let share = 2.0 * overlap / both;
    // Two particles at one position have no direction to move apart in.
    (if distance > 0.0 { overlap / distance } else { 0.0 }, share * share)
}

/// The size of a step.
fn step_size(setup: &Setup) -> f64 {
    setup.settings.step_size.unwrap_or(match setup.settings.sampling {
        Sampling::Uniform => STEP,
        Sampling::Adaptive => OVERLAP_STEP,
    })
}

impl Walk {
    /// Begins a step: sums the repulsion on every particle where it is.
    pub(super) fn begin_step(&mut self, setup: &Setup, log: &mut Vec<Event>) {
        self.buckets = Buckets::new(setup.cube(), &self.particles);
        let energy = self.repulsion(setup);
        self.largest_move = 0.0;
        let (step, size) = (self.place.steps + 1, step_size(setup));
        log.push(Event::StepBegins { step, size, energy });
    }

    /// Fills the forces and returns the energy per particle.
    ///
    /// # Differs from the paper
    ///
    /// Pairs on two sheets do not count.
    fn repulsion(&mut self, setup: &Setup) -> f64 {
        let mut energy = 0.0;
        self.forces.clear();
        for i in 0..self.particles.len() as u32 {
            let mut force = DVec3::ZERO;
            for push in self.pushes(setup, i) {
                force += DVec3::from(push.force);
                // Each pair is met twice.
                energy += 0.5 * push.energy;
            }
            let normal = self.particles[i as usize].n();
            self.forces.push(force - normal * normal.dot(force));
        }
        energy / self.particles.len() as f64
    }

    /// Returns the repulsion of a particle by each of its neighbours at their present positions.
    pub(super) fn pushes(&self, setup: &Setup, particle: u32) -> impl Iterator<Item = Push> {
        let own = &self.particles[particle as usize];
        let reach = match setup.settings.sampling {
            Sampling::Uniform => RANGE * own.radius,
            Sampling::Adaptive => OVERLAP_REACH * (own.radius + setup.largest()),
        };
        let around = self.buckets.near(&self.particles, own.p(), reach).into_iter();
        around.filter(move |near| near.particle != particle).map(move |near| {
            let other = &self.particles[near.particle as usize];
            let (push, pair) = match setup.settings.sampling {
                Sampling::Uniform => gaussian(near.distance, own.radius),
                Sampling::Adaptive => overlap(near.distance, own.radius + other.radius),
            };
            let weight = same_sheet_weight(own.n().dot(other.n()));
            let force = (own.p() - other.p()) * (weight * push);
            Push { near, force: force.to_array(), energy: weight * pair }
        })
    }

    /// Moves a particle by its force and brings it back onto the surface.
    pub(super) fn move_particle(
        &mut self,
        surface: &mut Surface,
        setup: &Setup,
        particle: usize,
        log: &mut Vec<Event>,
    ) {
        let own = self.particles[particle];
        let force = self.forces[particle];
        let reach = MAX_MOVE * own.radius;
        let target = own.p() + (force * step_size(setup)).clamp_length_max(reach);
        let landing = surface.land_by_newton(target, reach, setup.residual(own.radius), &mut |_| {});
        let landed = match landing {
            Landing::On { position, normal } if surface.contains(position) && normal.dot(own.n()) > 0.0 => {
                Some((position, normal))
            }
            _ => None,
        };
        let (position, normal) = landed.unwrap_or((own.p(), own.n()));
        self.largest_move = self.largest_move.max(position.distance(own.p()) / own.radius);
        let radius = setup.radius_at(surface, position).unwrap_or(own.radius);
        let moved = &mut self.particles[particle];
        (moved.position, moved.normal, moved.radius) = (position.to_array(), normal.to_array(), radius);
        log.push(Event::Moved {
            particle: particle as u32,
            force: force.to_array(),
            target: target.to_array(),
            position: position.to_array(),
            normal: normal.to_array(),
            radius,
            is_kept: landed.is_none(),
        });
    }

    /// Ends a step: the energy where the particles are now.
    pub(super) fn end_step(&mut self, setup: &Setup, log: &mut Vec<Event>) {
        self.place.steps += 1;
        self.buckets = Buckets::new(setup.cube(), &self.particles);
        let energy = self.repulsion(setup);
        log.push(Event::StepEnds { step: self.place.steps, energy, largest_move: self.largest_move });
    }
}
