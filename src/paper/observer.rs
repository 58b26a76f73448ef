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
    Frame { frame: &'a TangentFrame, form: Option<[f64; 3]> },
    /// The child is proposed in the direction V̂, at an angle on its circle ("place its six children").
    Proposed { direction: DVec3, theta_rad: f64, position: DVec3 },
    /// The field is evaluated on the child's way to the surface (§4.3).
    Tried(Trial),
    /// The child has come to the surface, at a distance from its parent.
    Landed { position: DVec3, normal: DVec3, distance: f64 },
    /// The particles within `reach` are gathered.
    Gathered { reach: f64, neighbours: &'a [Nearby] },
    /// The child is compared with the nearest particle of its sheet, if there is one ("if an existing particle correspond"): it corresponds
    /// within the distance `limit`.
    Compared { position: DVec3, against: Option<u32>, distance: Option<f64>, limit: f64, corresponds: bool },
    /// The fate of the child is decided. The particle is the one that was added, or the one that was there.
    Decided { fate: SlotFate, particle: Option<u32> },
    /// A free space is found on the circle, between two particles that touch the parent (§5.3, Fig. 8a). There are none if the whole
    /// circle is free.
    Space { ends: Option<[u32; 2]>, angles_rad: [f64; 2] },
    /// An adaptive child starts (§5.1, Figs 7a and 7c). `tangent` is the point I of Fig. 7c, which the first child of a seed has not.
    Started { tangent: Option<DVec3>, position: DVec3, radius: f64 },
    /// An adaptive child has been pushed away from its parent (Figs 7b and 7e).
    Pushed { position: DVec3, radius: f64 },
    /// An adaptive child has been pushed along the circle (Fig. 7f), to where `overlap` is its largest with another particle.
    Turned { position: DVec3, radius: f64, overlap: f64 },
    /// The angle φ that an adaptive child takes is compared with the free angle τ (Figs 7g, 8c and 8e).
    Room { phi_rad: f64, tau_rad: f64, fits: bool },
}

/// Observer of a run. `()` looks at nothing.
pub trait Observer {
    /// Something has happened to a child, or to its parent; `particles` are those that there are then.
    fn see(&mut self, child: ChildSlot, moment: Moment<'_>, particles: &[Particle]);
}

impl Observer for () {
    fn see(&mut self, _: ChildSlot, _: Moment<'_>, _: &[Particle]) {}
}
