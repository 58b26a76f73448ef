//! The events of a run, as plain data in the order in which they happen.
//!
//! Events of a child name its `parent` and `slot`, because the children of a level may be placed
//! together. Lengths are in the field's coordinates, angles in radians.

use crate::paper::{Nearby, Particle};
use crate::particles::SlotFate;
use serde::Serialize;

/// A point or a direction.
pub type Vector = [f64; 3];

/// An event. [`Event::Seed`], [`Event::Added`], [`Event::Fate`], [`Event::Done`], [`Event::Moved`],
/// [`Event::Divided`] and [`Event::Died`] change the particles; the others explain why.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonEvent"))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Event {
    /// A front begins at a seed (Algorithm 2, "a particle seed").
    Seed {
        /// Index of the seed.
        particle: u32,
        /// Columns of the particle.
        data: Particle,
    },
    /// A generation level begins: these particles wait for their turn.
    LevelBegins {
        /// Number of the level.
        level: u32,
        /// Number of particles that wait.
        waiting: u32,
    },
    /// A particle that is not done is taken from the queue ("while it exists one particle marked as
    /// not done").
    Taken {
        /// The particle.
        particle: u32,
    },
    /// The tangent frame in which the children are placed (§4.2, Fig. 3).
    Frame {
        /// The particle.
        particle: u32,
        /// Unit normal N̂.
        normal: Vector,
        /// Unit tangent vector of slot 0, towards the parent; any for a seed.
        u: Vector,
        /// N̂ × u.
        w: Vector,
    },
    /// A child is proposed ("place its six children").
    Slot {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot, at an angle of slot · π/3 in uniform sampling.
        slot: u32,
        /// Unit tangent vector V̂.
        direction: Vector,
        /// Angle θ₀ on the circle.
        theta_rad: f64,
        /// Position at this angle.
        place: Vector,
    },
    /// The field is evaluated in the search for the surface (§4.3).
    Iterate {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Number of the evaluation, from 0.
        step: u32,
        /// Angle θₖ on the circle; none for Newton's method in space.
        theta_rad: Option<f64>,
        /// Position.
        position: Vector,
        /// Value f at the position.
        value: f64,
        /// Length |∇f| of the gradient at the position.
        slope: f64,
    },
    /// The child has reached the surface.
    Landed {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Position.
        position: Vector,
        /// Unit normal at `position`.
        normal: Vector,
        /// Distance to the parent: 2r on the circle.
        distance: f64,
    },
    /// The neighbouring particles are gathered.
    Gathered {
        /// The particle.
        particle: u32,
        /// Distance within which neighbours are searched.
        reach: f64,
        /// The particles found, on any sheet.
        neighbours: Vec<Nearby>,
    },
    /// A child is compared with the nearest particle of its sheet ("if an existing particle
    /// correspond").
    Compared {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Position at which the child was compared, predicted or on the surface.
        position: Vector,
        /// The nearest particle; none if none is near, or if the nearest is a child that is not yet
        /// projected.
        against: Option<u32>,
        /// Distance to the nearest; none if nothing is near.
        distance: Option<f64>,
        /// Match radius.
        limit: f64,
        /// Whether the distance is within the match radius.
        corresponds: bool,
    },
    /// The child met a particle out of step: the front meets itself or another front, and a seam
    /// begins.
    FrontsMeet {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// The particle that the child met.
        particle: u32,
        /// Whether that particle belongs to the front of another seed.
        is_other: bool,
    },
    /// The child becomes a particle, marked as not done ("add the child to the particle set").
    Added {
        /// Index of the particle.
        particle: u32,
        /// Columns of the particle.
        data: Particle,
    },
    /// The fate of a slot.
    Fate {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// The fate.
        fate: SlotFate,
        /// The new particle, or the existing one.
        particle: Option<u32>,
    },
    /// The particle is marked as done.
    Done {
        /// The particle.
        particle: u32,
        /// Evaluations of the field so far.
        evaluations: u64,
    },
    /// A free space on the circle around an adaptive particle, between two particles that touch it
    /// (§5.3, Fig. 8a).
    Arc {
        /// The particle.
        parent: u32,
        /// The particle before the free space; none if the whole circle is free.
        before: Option<u32>,
        /// The particle after the free space, in the direction of increasing angles.
        behind: Option<u32>,
        /// Directions of the particles `before` and `behind` in the frame.
        angles_rad: [f64; 2],
    },
    /// An adaptive child starts on the circle of its parent (§5.1, Figs 7a and 7c).
    Start {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// The point I of Fig. 7c, on the circle of the previous child; none for the first child of
        /// a seed.
        tangent: Option<Vector>,
        /// The point s, in the tangent plane.
        position: Vector,
        /// Repulsion radius at `position`.
        radius: f64,
    },
    /// An adaptive child is pushed away from its parent, until the two do not overlap (Figs 7b and
    /// 7e).
    Push {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Position after the push.
        position: Vector,
        /// Repulsion radius at `position`.
        radius: f64,
    },
    /// An adaptive child is pushed along the circle, until it overlaps the others least (Fig. 7f).
    PushOnCircle {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Position after the push.
        position: Vector,
        /// Repulsion radius at `position`.
        radius: f64,
        /// Largest overlap with another particle, as a share of r_i + r_j; negative without an
        /// overlap.
        overlap: f64,
    },
    /// The angle φ that an adaptive child takes on the circle is compared with the free angle τ
    /// (Figs 7g, 8c and 8e).
    Room {
        /// The particle that places the child.
        parent: u32,
        /// Number of the slot.
        slot: u32,
        /// Angle that the child's diameter occupies.
        phi_rad: f64,
        /// Angle that is free.
        tau_rad: f64,
        /// Whether there is room.
        fits: bool,
    },
    /// A gap next to a particle is examined: the widest empty circle through it and two neighbours.
    Gap {
        /// The particle.
        particle: u32,
        /// Radius of that circle; none if it is too narrow or too wide to be a gap.
        width: Option<f64>,
    },
    /// A relaxation step begins (§4.5).
    StepBegins {
        /// Number of the step, from 1.
        step: u32,
        /// Size of the step: the factor between the force and the particle's move.
        size: f64,
        /// Energy per particle before it.
        energy: f64,
    },
    /// A particle is moved by its neighbours' repulsion and returns to the surface.
    Moved {
        /// The particle.
        particle: u32,
        /// Sum of the repulsion, in the tangent plane; the move is the step size times this.
        force: Vector,
        /// Target of the move in the tangent plane; in Witkin and Heckbert's system it includes the
        /// return to the surface.
        target: Vector,
        /// Position on the surface.
        position: Vector,
        /// Unit normal at `position`.
        normal: Vector,
        /// Repulsion radius at `position`.
        radius: f64,
        /// Whether the particle stayed where it was, because the move would have left the box or
        /// the surface, or gone around a fold.
        is_kept: bool,
    },
    /// A relaxation step is over.
    StepEnds {
        /// Number of the step, from 1.
        step: u32,
        /// Energy per particle after it.
        energy: f64,
        /// Longest move, in radii.
        largest_move: f64,
    },
    /// An iteration of a particle system begins: forces and energies are summed (paper §3).
    IterationBegins {
        /// Number of the iteration, from 1.
        iteration: u32,
        /// Number of particles.
        particles: u32,
        /// Mean energy of the particles, or mean sum of their squared overlaps.
        energy: f64,
    },
    /// A particle divides into two.
    Divided {
        /// The particle, which one child replaces.
        particle: u32,
        /// Index of the other child.
        child: u32,
        /// Columns of both children.
        data: Box<[Particle; 2]>,
        /// Energy of the particle.
        energy: f64,
    },
    /// A particle dies. Later ones move up by one.
    Died {
        /// The particle.
        particle: u32,
        /// Energy of the particle.
        energy: f64,
    },
    /// An iteration is over.
    IterationEnds {
        /// Number of the iteration, from 1.
        iteration: u32,
        /// Number of particles.
        particles: u32,
        /// Longest move, in radii.
        largest_move: f64,
        /// Mean move, in radii. The system has settled once it stays small and nothing divides or
        /// dies for a while.
        mean_move: f64,
    },
}

impl Event {
    /// Changes the particles as the event did; enough for a replay.
    ///
    /// # Panics
    ///
    /// If the event belongs to other particles.
    pub fn apply(&self, particles: &mut Vec<Particle>) {
        match *self {
            Self::Seed { particle, data } | Self::Added { particle, data } => {
                assert_eq!(particle as usize, particles.len(), "particles are added in their order");
                particles.push(data);
            }
            Self::Fate { parent, slot, fate, .. } => {
                particles[parent as usize].slots.set(slot as usize, fate);
            }
            Self::Done { particle, .. } => particles[particle as usize].is_done = true,
            Self::Moved { particle, position, normal, radius, .. } => {
                let moved = &mut particles[particle as usize];
                (moved.position, moved.normal, moved.radius) = (position, normal, radius);
            }
            Self::Divided { particle, child, ref data, .. } => {
                assert_eq!(child as usize, particles.len(), "particles are added in their order");
                particles[particle as usize] = data[0];
                particles.push(data[1]);
            }
            Self::Died { particle, .. } => {
                particles.remove(particle as usize);
            }
            _ => {}
        }
    }
}
