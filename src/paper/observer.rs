//! Observers of a run, with a method for each event of the algorithm.

use super::buckets::Nearby;
use super::particle::{Particle, TangentFrame};
use super::surface::Trial;
use crate::particles::SlotFate;
use glam::DVec3;

/// A child that is not a particle yet: slot number `slot` of particle number `parent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChildSlot {
    /// The particle that places the child.
    pub parent: u32,
    /// Number among the parent's children.
    pub slot: u32,
}

/// A child beside the nearest particle of its sheet.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Position at which the child is compared.
    pub position: DVec3,
    /// The nearest particle; none if none is near, or if it is a child that has no number yet.
    pub against: Option<u32>,
    /// Distance to the nearest; none if nothing is near.
    pub distance: Option<f64>,
    /// Match radius: the child corresponds to a particle within this distance.
    pub limit: f64,
    /// Whether the child corresponds to the nearest particle.
    pub corresponds: bool,
}

/// A move of the relaxation.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Sum of the repulsion, in the tangent plane.
    pub force: DVec3,
    /// Target of the move, in the tangent plane.
    pub target: DVec3,
    /// Whether the particle stays, because there is no surface near the target.
    pub is_kept: bool,
}

/// Observer of a run: a method is called for each event, in the order of the events. `()` ignores them all.
#[allow(unused_variables, reason = "an observer need not listen to all")]
pub trait Observer {
    /// A front begins at a seed.
    fn seed(&mut self, particle: u32, data: &Particle) {}
    /// A particle that waits is taken.
    fn taken(&mut self, particle: u32) {}
    /// The children of a particle are placed in this frame; `form` is the second fundamental form there, if the rules ask for it.
    fn frame(&mut self, particle: u32, frame: &TangentFrame, form: Option<[f64; 3]>) {}
    /// A child begins in a direction, at an angle of the circle there.
    fn proposed(&mut self, child: ChildSlot, direction: DVec3, theta_rad: f64, place: DVec3) {}
    /// The field is evaluated on the child's way to the surface.
    fn tried(&mut self, child: ChildSlot, trial: &Trial) {}
    /// The child has come to the surface, at a distance from its parent.
    fn landed(&mut self, child: ChildSlot, position: DVec3, normal: DVec3, distance: f64) {}
    /// The neighbours of a particle are gathered.
    fn gathered(&mut self, particle: u32, reach: f64, neighbours: &[Nearby]) {}
    /// A child is compared with the particles that exist.
    fn compared(&mut self, child: ChildSlot, comparison: &Comparison, particles: &[Particle]) {}
    /// A child becomes a particle.
    fn added(&mut self, particle: u32, data: &Particle) {}
    /// The fate of a child is decided; `particle` is the new one, or the one that was there.
    fn decided(&mut self, child: ChildSlot, fate: SlotFate, particle: Option<u32>) {}
    /// A particle is marked as done, after so many evaluations of the field in all.
    fn done(&mut self, particle: u32, evaluations: u64) {}
    /// A free space around an adaptive particle: between two particles in their directions, or all around it.
    fn space(&mut self, parent: u32, between: Option<[(u32, f64); 2]>) {}
    /// An adaptive child starts on the circle of its parent, in the direction of the point I of Fig. 7c.
    fn started(&mut self, child: ChildSlot, tangent: Option<DVec3>, position: DVec3, radius: f64) {}
    /// An adaptive child is pushed away from its parent.
    fn pushed(&mut self, child: ChildSlot, position: DVec3, radius: f64) {}
    /// An adaptive child is pushed along the circle.
    fn turned(&mut self, child: ChildSlot, position: DVec3, radius: f64, overlap: f64) {}
    /// The angles φ and τ of an adaptive child are compared.
    fn room(&mut self, child: ChildSlot, phi_rad: f64, tau_rad: f64, fits: bool) {}
    /// A relaxation step begins, with this energy per particle.
    fn step_begins(&mut self, step: u32, size: f64, energy: f64) {}
    /// A particle is moved; `data` is what it is then.
    fn moved(&mut self, particle: u32, step: &Move, data: &Particle) {}
    /// A relaxation step is over.
    fn step_ends(&mut self, step: u32, energy: f64, largest_move: f64) {}
}

impl Observer for () {}
