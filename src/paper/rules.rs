//! The choices that the paper discusses or leaves open.

use super::surface::{Circle, Landing, Note};
use super::{ImplicitSurface, Particle, TangentFrame};
use crate::differential::{Curvature, exact_curvature};
use glam::DVec3;

/// The rule for the repulsion radii of the particles.
#[derive(Clone, Copy, Debug)]
pub enum RadiusRule {
    /// The radius is this one everywhere (§4).
    Same(f64),
    /// The radius follows the curvature (§5.2), between two limits, "in order to avoid very small
    /// or very large particles".
    ByCurvature {
        /// The radius, from the principal curvatures of the level set and `scale`.
        law: fn(&Curvature<f64, DVec3>, f64) -> f64,
        /// Factor of the law, which scales the curvature "in order to be used as a distance
        /// measurement".
        scale: f64,
        /// The smallest radius.
        least: f64,
        /// The largest radius.
        most: f64,
    },
}

impl RadiusRule {
    /// Smallest radius of a particle.
    pub(crate) fn smallest(&self) -> f64 {
        match *self {
            Self::Same(radius) => radius,
            Self::ByCurvature { least, .. } => least,
        }
    }

    /// Largest radius of a particle.
    pub(crate) fn largest(&self) -> f64 {
        match *self {
            Self::Same(radius) => radius,
            Self::ByCurvature { most, .. } => most,
        }
    }

    /// Radius of a particle at a point; `None` where the curvature is undefined.
    pub(crate) fn radius_at(&self, surface: &mut ImplicitSurface, p: DVec3) -> Option<f64> {
        match *self {
            Self::Same(radius) => Some(radius),
            Self::ByCurvature { law, scale, least, most } => {
                let curvature = exact_curvature(&surface.jet(p));
                curvature.is_defined().then(|| law(&curvature, scale).clamp(least, most))
            }
        }
    }
}

/// The paper's law of the radius (§5.2): inversely as κ = κ₁ + κ₂.
#[must_use]
pub fn sum_of_curvatures(curvature: &Curvature<f64, DVec3>, scale: f64) -> f64 {
    scale / (2.0 * curvature.mean().abs())
}

/// Size of a relaxation step in uniform sampling, in σ². The stiffest mode of the hexagonal lattice
/// at the spacing 2σ has the eigenvalue 2.2 / σ², so steps below 0.9 are stable, and below 0.7
/// where rows are squeezed to 1.7 σ; with 0.2 ten steps leave seams.
const STEP: f64 = 0.6;

/// Size of a relaxation step in non-uniform sampling. The stiffest mode of the hexagonal lattice
/// has an eigenvalue below 6, so steps below a third are stable.
pub(crate) const OVERLAP_STEP: f64 = 0.33;

/// The choices of a run.
#[derive(Clone, Debug)]
pub struct Rules {
    /// The radii of the particles.
    pub sizes: RadiusRule,
    /// The method that moves a child onto the surface, within a residual (§4.3): along its circle.
    pub(crate) projection: fn(&mut ImplicitSurface, &Circle, f64, Note) -> Landing,
    /// The angles at which the searches of a particle's children start, by its frame and radius: in
    /// the tangent plane, θ₀ = 0, as in Fig. 4 (left).
    pub(crate) start_angles: fn(&mut ImplicitSurface, &TangentFrame, f64) -> [f64; 6],
    /// Whether a matched particle is removed from the neighbours of the parent (§4.4), so that no
    /// second child matches it. If not, it stays, and so do added children.
    pub(crate) removes_matched: bool,
    /// A child is identified with a particle within this distance, in r_i + r_j. The paper names no
    /// value; 0.7 gives the most particles with six neighbours on smooth surfaces.
    pub match_tolerance: f64,
    /// An adaptive child is added if the free angle τ is at least this share of φ, the angle that
    /// it takes.
    pub fit: f64,
    /// A point is on the surface if |f|/|∇f| is at most this, in r. The paper names no value.
    pub residual: f64,
    /// Size of a relaxation step: the share of the force by which a particle moves.
    pub step_size: f64,
    /// No child is added where there are this many particles.
    pub max_particles: usize,
}

impl Rules {
    /// The choices of the paper; where it names no value, those of the fast sampler.
    #[must_use]
    pub fn with_sizes(sizes: RadiusRule) -> Self {
        Self {
            sizes,
            projection: ImplicitSurface::land_on_circle,
            start_angles: |_, _, _| [0.0; 6],
            removes_matched: true,
            match_tolerance: 0.7,
            fit: 0.5,
            residual: 1e-4,
            step_size: match sizes {
                RadiusRule::Same(_) => STEP,
                RadiusRule::ByCurvature { .. } => OVERLAP_STEP,
            },
            max_particles: usize::MAX,
        }
    }

    /// Whether two particles are on one sheet: they face the same way, and the other rises by at
    /// most 45° from the tangent plane. Closer than half the match distance, their direction is
    /// meaningless and the rise does not count.
    pub(crate) fn is_same_sheet(&self, one: &Particle, other: &Particle) -> bool {
        let offset = other.p() - one.p();
        let rise = offset.dot(one.n());
        let slack = 0.5 * self.match_tolerance * (one.radius + other.radius);
        one.n().dot(other.n()) > 0.0 && rise * rise <= 0.5 * (offset.length_squared() + slack * slack)
    }
}
