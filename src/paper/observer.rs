//! The observer of a run is told the moments of the treatment of a particle that leave no trace in the particles: where a child was tried,
//! and with what it was compared. All other events, such as seeds and moves, can be read off the particles between two steps.

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

/// A moment in the treatment of a particle, or of one of its children. Lengths are in the field's coordinates, angles in radians.
pub enum Moment<'a> {
    /// The tangent frame is laid (§4.2, Fig. 3); with the second form [a, b, c] in it, where it was asked for.
    Frame(&'a TangentFrame, Option<[f64; 3]>),
    /// The child is proposed in this direction V̂, at an angle on its circle and the position there ("place its six children").
    Proposed(DVec3, f64, DVec3),
    /// The field is evaluated on the child's way to the surface (§4.3).
    Tried(Trial),
    /// The child has come to the surface: its position, its normal, and its distance to the parent.
    Landed(DVec3, DVec3, f64),
    /// The particles within this distance are gathered.
    Gathered(f64, &'a [Nearby]),
    /// The child is compared with the nearest particle of its sheet ("if an existing particle correspond").
    Compared(Comparison),
    /// The fate of the child is decided. The particle is the one that was added, or the one that was there.
    Decided(SlotFate, Option<u32>),
    /// A free space is found on the circle, between two particles that touch the parent (§5.3, Fig. 8a): these particles, none if the whole
    /// circle is free, and their directions as angles.
    Space(Option<[u32; 2]>, [f64; 2]),
    /// An adaptive child starts (§5.1, Figs 7a and 7c): the point I of Fig. 7c, which the first child of a seed has not, its position and its
    /// radius.
    Started(Option<DVec3>, DVec3, f64),
    /// An adaptive child has been pushed away from its parent (Figs 7b and 7e): its position and radius.
    Pushed(DVec3, f64),
    /// An adaptive child has been pushed along the circle (Fig. 7f): its position, its radius and its largest overlap.
    Turned(DVec3, f64, f64),
    /// The angle φ that an adaptive child takes is compared with the free angle τ (Figs 7g, 8c and 8e): φ, τ, and whether the child fits.
    Room(f64, f64, bool),
}

/// Comparison of a child with the nearest particle of its sheet.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Position at which the child was compared: the predicted one, or that of the landing.
    pub(crate) position: DVec3,
    /// The nearest particle; none if none is near, or if it is a child that still has to be projected.
    pub(crate) against: Option<u32>,
    /// Distance to the nearest; none if nothing is near.
    pub(crate) distance: Option<f64>,
    /// Match radius.
    pub(crate) limit: f64,
    /// Whether the distance is within the match radius.
    pub(crate) corresponds: bool,
}

/// Observer of a run. `()` looks at nothing.
pub trait Observer {
    /// Something has happened to a child, or to its parent; `particles` are those that there are then.
    fn see(&mut self, child: ChildSlot, moment: Moment<'_>, particles: &[Particle]);
}

impl Observer for () {
    fn see(&mut self, _: ChildSlot, _: Moment<'_>, _: &[Particle]) {}
}
