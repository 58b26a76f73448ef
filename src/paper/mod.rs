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
//! run.begin_at([0.0, 0.0, 1.0].into(), 0);
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
pub use rules::{Matched, Projection, QueueOrder, RadiusRule, Rules, SearchStart, sum_of_curvatures};
pub use surface::ImplicitSurface;

pub(crate) use buckets::Buckets;
pub(crate) use observer::{Comparison, Moment, Observer};
pub(crate) use particle::{Place, TangentFrame};
pub(crate) use projection::Circle;
pub(crate) use relaxation::{MAX_MOVE, Move, OVERLAP_REACH, OVERLAP_STEP, overlap, step_size};
pub(crate) use surface::{Landing, Trial};
pub(crate) use uniform::{DIRECTIONS, REACH, predicted_angle};

use crate::particles::SlotFate;
use glam::DVec3;
use std::collections::VecDeque;

/// A candidate for a seed is covered by a particle of its sheet within this many radii: a closed cover has no hole wider than 1.85.
const COVERED: f64 = 2.0;

/// Distance at which the size of f tells a zero from a pole, in radii: ten times the residual, where f beside a pole has a tenth of its
/// size and f beside a zero ten times as much.
const POLE_PROBE: f64 = 1e-3;

/// A run of the paper's algorithm: the surface, the particles so far, and those that wait to be treated.
#[derive(Clone)]
pub struct PaperRun<O> {
    pub(crate) surface: ImplicitSurface,
    pub(crate) rules: Rules,
    pub(crate) particles: Vec<Particle>,
    pub(crate) buckets: Buckets,
    /// The particles that are not done, in the order in which they came.
    pub(crate) waiting: VecDeque<u32>,
    /// Whether the limit on particles was reached.
    pub(crate) is_capped: bool,
    /// Relaxation steps done.
    pub(crate) steps: u32,
    /// Pushes of one particle by another that were summed for a move so far.
    pub(crate) interactions: u64,
    /// Repulsion on each particle in the relaxation step under way, in the tangent plane.
    forces: Vec<DVec3>,
    /// Longest move in the step under way, in radii.
    pub(crate) largest_move: f64,
    /// The observer of the run.
    pub(crate) seen: O,
}

impl<O: Observer> PaperRun<O> {
    /// A run without particles.
    pub fn new(surface: ImplicitSurface, rules: Rules, seen: O) -> Self {
        Self::with_particles(surface, rules, Vec::new(), seen)
    }

    /// A run whose particles so far are given; none of them waits to be treated.
    pub fn with_particles(surface: ImplicitSurface, rules: Rules, particles: Vec<Particle>, seen: O) -> Self {
        Self {
            buckets: Buckets::new(2.0 * rules.sizes.largest(), &particles),
            surface,
            rules,
            particles,
            waiting: VecDeque::new(),
            is_capped: false,
            steps: 0,
            interactions: 0,
            forces: Vec::new(),
            largest_move: 0.0,
            seen,
        }
    }

    /// The particles so far, in the order in which they were added.
    #[must_use]
    pub fn particles(&self) -> &[Particle] {
        &self.particles
    }

    /// "Starting from an arbitrary chosen seed particle" (§4.4): puts a seed beside `point` into the queue, and says whether it did.
    /// There is none if the surface is not near, if f has a pole there, or if a particle covers the place.
    pub fn begin_at(&mut self, point: DVec3, front: u32) -> bool {
        let sizes = self.rules.sizes;
        let residual = self.rules.residual * sizes.smallest();
        let landing = self.surface.land_by_newton(point, 2.0 * sizes.largest(), residual, &mut |_| {});
        let Landing::On { position, normal } = landing else { return false };
        let Some(r) = self.radius_at(position) else { return false };
        let is_covered = self
            .buckets
            .near(&self.particles, position, COVERED * r)
            .iter()
            .any(|near| self.particles[near.particle as usize].n().dot(normal) > 0.0);
        if is_covered
            || !self.surface.bounds.holds(position)
            || !self.surface.is_zero(position, normal, POLE_PROBE * r)
        {
            return false;
        }
        let seed = self.enter(Particle::seed(position, normal, r, front));
        self.waiting.push_back(seed);
        true
    }

    /// The complete process (§4.4, §5.2): treats all particles that wait, and those that come of it, then relaxes in `steps` steps.
    pub fn sample(&mut self, steps: u32) {
        while !self.is_capped
            && let Some(particle) = self.next()
        {
            self.treat(particle);
        }
        for _ in 0..steps {
            self.relax();
        }
    }

    /// "While it exists one particle marked as not done": takes the next one out of the queue.
    pub(crate) fn next(&mut self) -> Option<u32> {
        match self.rules.order {
            QueueOrder::Queue => self.waiting.pop_front(),
            QueueOrder::Stack => self.waiting.pop_back(),
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

    /// Adds a child to the particle set.
    pub(crate) fn add(&mut self, parent: u32, place: &Place) -> u32 {
        let Particle { level, front, .. } = self.particles[parent as usize];
        let Place { position, normal, radius } = *place;
        self.enter(Particle { front, ..Particle::placed(position, normal, radius, Some(parent), level + 1) })
    }

    /// Adds a child, marked as not done, unless there are as many particles as there may be.
    pub(crate) fn add_waiting(&mut self, child: ChildSlot, place: &Place) -> Option<u32> {
        if self.particles.len() >= self.rules.max_particles {
            self.is_capped = true;
            self.decide(child, SlotFate::Capped, None);
            return None;
        }
        let particle = self.add(child.parent, place);
        self.waiting.push_back(particle);
        self.decide(child, SlotFate::Added, Some(particle));
        Some(particle)
    }

    /// Decides the fate of a child. `particle` is the one that was added, or the one that was there.
    pub(crate) fn decide(&mut self, child: ChildSlot, fate: SlotFate, particle: Option<u32>) {
        self.particles[child.parent as usize].slots.set(child.slot as usize, fate);
        self.tell(child, Moment::Decided(fate, particle));
    }

    /// Tells the observer what has happened.
    pub(crate) fn tell(&mut self, child: ChildSlot, moment: Moment<'_>) {
        self.seen.see(child, moment, &self.particles);
    }
}
