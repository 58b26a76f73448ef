//! *MarchingParticles: Fast Generation of Particles for the Sampling of Implicit Surfaces* (2007), to be read beside the paper.
//!
//! One particle after the other, in double precision; nothing is made for speed. Read in this order:
//!
//! | Paper | Here |
//! |---|---|
//! | §4.2 the six children in the tangent plane, §4.4 Algorithm 2 | `uniform` |
//! | §4.3 back onto the surface, along a circle | `projection`, `surface` |
//! | §5 children of different sizes | `adaptive` |
//! | §4.5 and §5.4 relaxation | `relaxation` |
//! | §4.4 "a space partitioning scheme" | `buckets` |
//!
//! [`Rules`] holds every choice that the paper discusses or leaves open. An observer is told the moments of a treatment that leave no
//! trace in the particles. Tests hold the fast fronts of the sampler to these algorithms, and the lesson is built on them.
//!
//! ```
//! use marching_particles::field::gallery;
//! use marching_particles::paper::{ImplicitSurface, PaperRun, RadiusRule, Rules};
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
//! * A child whose search for the surface does not converge is not placed; the paper says nothing of it.
//! * A surface may have several seeds, so that each of its components can have one.

mod adaptive;
mod buckets;
mod observer;
mod particle;
mod projection;
mod relaxation;
mod rules;
mod surface;
mod uniform;

pub use buckets::Nearby;
pub use observer::ChildSlot;
pub use particle::Particle;
pub use relaxation::Push;
pub use rules::{Matched, Projection, RadiusRule, Rules, SearchStart, sum_of_curvatures};
pub use surface::ImplicitSurface;

pub(crate) use buckets::Buckets;
pub(crate) use observer::{Moment, Observer};
pub(crate) use particle::TangentFrame;
pub(crate) use projection::Circle;
pub(crate) use relaxation::{GAUSSIAN_REACH, MAX_MOVE, Move, OVERLAP_REACH, RepulsionSums, overlap};
pub(crate) use rules::OVERLAP_STEP;
pub(crate) use surface::Trial;
pub(crate) use uniform::{DIRECTIONS, REACH, predicted_angle};

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

    /// "Starting from an arbitrary chosen seed particle" (§4.4): adds a seed where the surface is beside `point`, and says whether it is.
    pub fn begin_at(&mut self, point: DVec3) -> bool {
        let seed = self.seed_at(point, 0);
        seed.map(|seed| self.enter(seed)).is_some()
    }

    /// The seed of a front beside a point of the box, if the surface is near.
    pub(crate) fn seed_at(&mut self, point: DVec3, front: u32) -> Option<Particle> {
        let sizes = self.rules.sizes;
        let residual = self.rules.residual * sizes.smallest();
        let landing = self.surface.land_by_newton(point, 2.0 * sizes.largest(), residual, &mut |_| {});
        let (position, normal) = landing.ok()?;
        let radius = self.radius_at(position)?;
        self.surface.bounds.holds(position).then(|| Particle::seed(position, normal, radius, front))
    }

    /// The complete process (§4.4, §5.2): treats all particles, those that come of it too, then relaxes in `steps` steps.
    pub fn sample(&mut self, steps: u32) {
        let mut next = 0;
        // "While it exists one particle marked as not done": the one that has waited longest. The text says stack, but the rings of
        // Fig. 11 are those of a queue.
        while next < self.particles.len() {
            if !self.particles[next].is_done {
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

    /// Adds a particle and says its number.
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

    /// "Add the child (marked as not done) to the particle set", unless there are as many particles as there may be.
    pub(crate) fn add_child(&mut self, child: ChildSlot, placed: Particle) -> Option<u32> {
        if self.particles.len() >= self.rules.max_particles {
            self.decide(child, SlotFate::Capped, None);
            return None;
        }
        let particle = self.enter(placed);
        self.decide(child, SlotFate::Added, Some(particle));
        Some(particle)
    }

    /// Decides the fate of a child. `particle` is the one that was added, or the one that was there.
    pub(crate) fn decide(&mut self, child: ChildSlot, fate: SlotFate, particle: Option<u32>) {
        self.particles[child.parent as usize].slots.set(child.slot as usize, fate);
        self.tell(child, Moment::Decided { fate, particle });
    }

    /// Tells the observer what has happened.
    pub(crate) fn tell(&mut self, child: ChildSlot, moment: Moment<'_>) {
        self.seen.see(child, moment, &self.particles);
    }
}
