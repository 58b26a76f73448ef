//! *MarchingParticles: Fast Generation of Particles for the Sampling of Implicit Surfaces* (2007),
//! to be read with the paper at hand.
//!
//! It treats one particle after the other, in double precision; nothing is optimised for speed.
//! Reading order:
//!
//! | Paper | Here |
//! |---|---|
//! | §4.2 the six children in the tangent plane, §4.4 Algorithm 2 | `uniform` |
//! | §4.3 back onto the surface, along a circle | `surface` |
//! | §5 children of different sizes | `adaptive` |
//! | §4.5 and §5.4 relaxation | `relaxation` |
//! | §4.4 "a space partitioning scheme" | `particle` |
//!
//! [`Rules`] holds every choice that the paper discusses or leaves open. Tests hold the fast fronts
//! of the sampler to these algorithms, and the lesson is built on them.
//!
//! ```
//! use marching_particles::field::gallery;
//! use marching_particles::internal::paper::{ImplicitSurface, PaperRun, RadiusRule, Rules};
//!
//! let sphere = gallery::find("sphere").expect("a surface of the gallery");
//! let surface = ImplicitSurface::new(Box::new(sphere.field()), &sphere.bounds);
//! let mut run = PaperRun::new(surface, Rules::with_sizes(RadiusRule::Same(0.1)), ());
//! run.begin_at([0.0, 0.0, 1.0].into());
//! run.sample(10);
//! // About as many as hexagons of this width fit on the unit sphere, 4π / (2√3 r²) = 363, and some more where fronts meet.
//! let count = run.particles().len();
//! assert!((363..420).contains(&count), "{count} particles");
//! ```
//!
//! # Differs from the paper
//!
//! * A child whose search for the surface does not converge is not placed; the paper does not treat
//!   this case.
//! * A surface may have several seeds, so that each of its components can have one.

mod adaptive;
mod particle;
mod relaxation;
mod rules;
mod surface;
mod uniform;

pub use particle::{Nearby, Particle};
pub use rules::{RadiusRule, Rules, sum_of_curvatures};
pub use surface::ImplicitSurface;

pub(crate) use particle::Buckets;
pub(crate) use relaxation::{GAUSSIAN_REACH, MAX_MOVE, Move, OVERLAP_REACH, overlap};
pub(crate) use rules::OVERLAP_STEP;
pub(crate) use surface::{Circle, Trial};
pub(crate) use uniform::{DIRECTIONS, REACH, TangentFrame};

use crate::particles::SlotFate;
use glam::DVec3;

/// A run of the paper's algorithm: the surface and the particles so far.
#[derive(Clone)]
pub struct PaperRun<O> {
    pub(crate) surface: ImplicitSurface,
    pub(crate) rules: Rules,
    pub(crate) particles: Vec<Particle>,
    pub(crate) buckets: Buckets,
    /// The observer of the run.
    pub(crate) seen: O,
}

impl<O: Observer> PaperRun<O> {
    /// A run without particles.
    pub fn new(surface: ImplicitSurface, rules: Rules, seen: O) -> Self {
        let buckets = Buckets::new(2.0 * rules.sizes.largest(), &[]);
        Self { surface, rules, particles: Vec::new(), buckets, seen }
    }

    /// The particles so far, in the order in which they were added.
    #[must_use]
    pub fn particles(&self) -> &[Particle] {
        &self.particles
    }

    /// "Starting from an arbitrary chosen seed particle" (§4.4): adds a seed if the surface is near
    /// `point`, and returns whether it is.
    pub fn begin_at(&mut self, point: DVec3) -> bool {
        let seed = self.seed_at(point, 0);
        seed.map(|seed| self.enter(seed)).is_some()
    }

    /// The seed of a front near a point of the box, if the surface is near.
    pub(crate) fn seed_at(&mut self, point: DVec3, front: u32) -> Option<Particle> {
        let sizes = self.rules.sizes;
        let residual = self.rules.residual * sizes.smallest();
        let landing = self.surface.land_by_newton(point, 2.0 * sizes.largest(), residual, &mut |_| {});
        let (position, normal) = landing.ok()?;
        let radius = self.radius_at(position)?;
        let seed = Particle { front, ..Particle::placed(position, normal, radius, None, 0) };
        self.surface.bounds.holds(position).then_some(seed)
    }

    /// The complete process (§4.4, §5.2): treats all particles, including new ones, then makes
    /// `steps` relaxation steps.
    pub fn sample(&mut self, steps: u32) {
        // "While it exists one particle marked as not done": takes the oldest. The text says stack,
        // but the rings of Fig. 11 are those of a queue.
        let mut next = 0;
        while let Some(particle) = self.particles.get(next) {
            if !particle.is_done {
                self.treat(next as u32);
            }
            next += 1;
        }
        for _ in 0..steps {
            self.relax();
        }
    }

    /// Treats a particle, and marks it as done.
    pub(crate) fn treat(&mut self, particle: u32) {
        match self.rules.sizes {
            RadiusRule::Same(radius) => self.treat_uniform(particle, radius),
            RadiusRule::ByCurvature { .. } => self.treat_adaptive(particle),
        }
        self.particles[particle as usize].is_done = true;
    }

    /// Radius of a particle at a point; `None` where the curvature is undefined.
    pub(crate) fn radius_at(&mut self, p: DVec3) -> Option<f64> {
        self.rules.sizes.radius_at(&mut self.surface, p)
    }

    /// Adds a particle and returns its number.
    pub(crate) fn enter(&mut self, particle: Particle) -> u32 {
        let number = self.particles.len() as u32;
        self.buckets.insert(particle.p(), number);
        self.particles.push(particle);
        number
    }

    /// A child as the particle that it would be.
    pub(crate) fn child(&self, parent: u32, (position, normal): (DVec3, DVec3), radius: f64) -> Particle {
        let Particle { level, front, .. } = self.particles[parent as usize];
        Particle { front, ..Particle::placed(position, normal, radius, Some(parent), level + 1) }
    }

    /// Decides the fate of a child. `particle` is the added particle, or the one that the child
    /// matched.
    pub(crate) fn decide(&mut self, child: ChildSlot, fate: SlotFate, particle: Option<u32>) {
        self.particles[child.parent as usize].slots.set(child.slot as usize, fate);
        self.tell(child, Moment::Decided { fate, particle });
    }

    /// Tells the observer what has happened.
    pub(crate) fn tell(&mut self, child: ChildSlot, moment: Moment<'_>) {
        self.seen.see(child, moment, &self.particles);
    }
}

/// A child that is not a particle yet: slot number `slot` of particle number `parent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChildSlot {
    /// The particle that places the child.
    pub parent: u32,
    /// Number among the parent's children.
    pub slot: u32,
}

/// A moment in the treatment of a particle, or of one of its children. Lengths are in the field's
/// coordinates, angles in radians.
#[expect(missing_docs, reason = "each variant describes its fields")]
pub enum Moment<'a> {
    /// The tangent frame is laid (§4.2, Fig. 3).
    Frame(&'a TangentFrame),
    /// The child is proposed where the search on its circle starts ("place its six children").
    Proposed(&'a Circle),
    /// The field is evaluated on the child's way to the surface (§4.3).
    Tried(Trial),
    /// The child has reached the surface.
    Landed { position: DVec3, normal: DVec3 },
    /// The particles within `reach` are gathered.
    Gathered { reach: f64, neighbours: &'a [Nearby] },
    /// The child is compared with the nearest particle of its sheet, if there is one ("if an
    /// existing particle correspond"): it corresponds within the distance `limit`.
    Compared { position: DVec3, nearest: Option<Nearby>, limit: f64, corresponds: bool },
    /// The fate of the child is decided. The particle is the added one, or the one that the child
    /// matched.
    Decided { fate: SlotFate, particle: Option<u32> },
    /// A free space is found on the circle, between two particles that touch the parent (§5.3, Fig.
    /// 8a). `ends` is `None` if the whole circle is free.
    Space { ends: Option<[u32; 2]>, angles_rad: [f64; 2] },
    /// An adaptive child starts (§5.1, Figs 7a and 7c). `tangent` is the point I of Fig. 7c; the
    /// first child of a seed has none.
    Started { tangent: Option<DVec3>, position: DVec3, radius: f64 },
    /// An adaptive child has been pushed away from its parent (Figs 7b and 7e).
    Pushed { position: DVec3, radius: f64 },
    /// An adaptive child has been pushed along the circle (Fig. 7f); `overlap` is its largest
    /// overlap with another particle there.
    Turned { position: DVec3, radius: f64, overlap: f64 },
    /// The angle φ that an adaptive child takes is compared with the free angle τ (Figs 7g, 8c and
    /// 8e).
    Room { phi_rad: f64, tau_rad: f64, fits: bool },
}

/// Observer of a run. It receives the moments of a particle's treatment that leave no trace in the
/// particles. All other events, such as seeds and moves, follow from comparing the particles of two
/// steps. `()` ignores all moments.
pub trait Observer {
    /// Something has happened to a child, or to its parent; `particles` are the present ones.
    fn see(&mut self, _child: ChildSlot, _moment: Moment<'_>, _particles: &[Particle]) {}
}

impl Observer for () {}
