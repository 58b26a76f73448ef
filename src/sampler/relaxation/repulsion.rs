//! Laws of repulsion: a Gaussian for particles of one size (paper §4.5), the overlap of discs for
//! particles of many (§5).

use crate::differential::{Curvature, curvatures_of};
use crate::field::Evaluator;
use crate::field::descent::{Descent, Descents};
use crate::math::Sym3;
use crate::particles::Particles;
use crate::sampler::neighbours::constants::{GAUSSIAN_RANGE, GAUSSIAN_SKIN, OVERLAP_RANGE, OVERLAP_SKIN};
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::projection::{ResidualLimits, Tolerance};
use crate::sampler::sizing::Sizing;
use glam::{Vec3, Vec4};

/// Largest number of evaluations to bring a particle back onto the surface. Three are enough on
/// smooth formulas; where a field through points takes more than six, the particle stays.
const MAX_NEWTON: u32 = 6;

/// Largest distance that a particle moves in one step, in radii: it stays far from the next one,
/// at 2.
pub(crate) const MAX_MOVE: f32 = 0.35;

/// A batch of particles that return to the surface.
pub(crate) struct LandingBatch {
    /// Number of particles.
    pub(crate) count: usize,
    /// A Newton correction shorter than this, in radii, is not checked by another evaluation.
    pub(crate) trust: f32,
    /// Largest distance, in radii, from where a particle is to where it lands.
    pub(crate) reach: f32,
    /// Whether all radii are brought up to date.
    pub(crate) renews_radii: bool,
    pub(crate) position: [Vec3; BATCH],
    pub(crate) normal: [Vec3; BATCH],
    /// Radius, where radii change.
    pub(crate) radius: [f32; BATCH],
    /// Distance travelled since the radius was brought up to date.
    pub(crate) radius_travel: [f32; BATCH],
    /// Whether the particle has come to the surface.
    pub(crate) ok: [bool; BATCH],
}

impl LandingBatch {
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            trust: 0.0,
            reach: MAX_MOVE,
            renews_radii: false,
            position: [Vec3::ZERO; BATCH],
            normal: [Vec3::ZERO; BATCH],
            radius: [0.0; BATCH],
            radius_travel: [0.0; BATCH],
            ok: [false; BATCH],
        }
    }
}

/// A law of repulsion between two particles. Lengths are in mean radii of the pair unless stated
/// otherwise.
pub(crate) trait Repulsion {
    /// Distance beyond which two particles do not repel each other.
    const RANGE: f32;
    /// Verlet skin: how much farther than the range the neighbour lists reach, so that they serve
    /// while particles move.
    const SKIN: f32;
    /// Distance that particles may travel until the grid from which lists are renewed is filled
    /// again.
    const SLACK: f32;
    /// First step size, and the largest: a particle moves by it times the sum of `offset * weight`
    /// over its pairs.
    const STEP: f32;
    /// Whether the radii change as particles move.
    const RESIZES: bool;

    /// Returns the radius of particle `i`.
    fn radius(&self, particles: &Particles, i: usize) -> f32;

    /// Returns the largest slope of the radius along the surface, a pure number.
    fn slope(&self) -> f32;

    /// Returns the smallest and the largest radius of the particles.
    fn extent(&self, particles: &Particles) -> RadiusRange;

    /// Returns force over offset, and energy, of four pairs with these squared distances and mean
    /// radii, both in units of length.
    fn pairs(&self, distance_sq: Vec4, mean: Vec4) -> (Vec4, Vec4);

    /// Moves the particles of `landing` onto the surface and writes their normals. Brings radii up
    /// to date: of the particles that have travelled far since that was done last, or of all.
    fn land(&self, probe: &mut Probe, landing: &mut LandingBatch);
}

/// Gaussian repulsion after Witkin and Heckbert 1994, §4, without fission and death, and with one
/// radius.
///
/// A pair at distance d has the energy exp(−d²/2σ²) with σ = r, and every particle moves against
/// the gradient of the sum. The hexagonal lattice of spacing 2r is then close to equilibrium, which
/// is at 2.017 r.
///
/// # Differs from the paper
///
/// The pair energy is cut off at 3σ and shifted so that it is zero there, which keeps the sum
/// continuous in the positions.
pub(crate) struct Gaussian {
    radius: f32,
    tolerance: Tolerance,
    /// 1/2σ².
    scale: f32,
}

impl Gaussian {
    pub(crate) fn new(radius: f32, tolerance: Tolerance) -> Self {
        Self { radius, tolerance, scale: 0.5 / (radius * radius) }
    }
}

impl Repulsion for Gaussian {
    const RANGE: f32 = GAUSSIAN_RANGE;
    const SKIN: f32 = GAUSSIAN_SKIN;
    const SLACK: f32 = 0.5;
    /// The unit is σ². The stiffest mode of the hexagonal lattice at spacing 2σ has the eigenvalue
    /// 2.2 / σ², so steps below 0.9 are stable there, and steps below 0.7 where rows are squeezed
    /// to 1.7σ. Longer steps reach no lower energy in ten steps, and the squeezed rows oscillate.
    const STEP: f32 = 0.6;
    const RESIZES: bool = false;

    fn radius(&self, _: &Particles, _: usize) -> f32 {
        self.radius
    }

    fn slope(&self) -> f32 {
        0.0
    }

    fn extent(&self, _: &Particles) -> RadiusRange {
        RadiusRange::of(self.radius)
    }

    fn pairs(&self, distance_sq: Vec4, _: Vec4) -> (Vec4, Vec4) {
        // Distances are measured in σ = r.
        let half_sq = distance_sq * self.scale;
        let near = half_sq.cmplt(Vec4::splat(0.5 * Self::RANGE * Self::RANGE));
        let weight = gaussian(half_sq);
        (Vec4::select(near, weight, Vec4::ZERO), Vec4::select(near, weight - END_ENERGY, Vec4::ZERO))
    }

    fn land(&self, probe: &mut Probe, landing: &mut LandingBatch) {
        let mut descent = Descent {
            residual: self.tolerance.residual,
            reach: landing.reach * self.radius,
            trust: landing.trust * self.radius,
        };
        probe.land_along_gradient(
            &mut landing.position[..landing.count],
            &mut landing.normal,
            &mut landing.ok,
            self.tolerance.min_gradient,
            &mut descent,
            MAX_NEWTON,
        );
    }
}

/// Energy of a pair at the cut-off, exp(−RANGE²/2).
pub(crate) const END_ENERGY: f32 = 0.011_108_997;

/// Returns exp(−x) for 0 ≤ x ≤ 4.5, with a relative error below 2·10⁻⁵. The result has no meaning
/// outside that range.
///
/// The result is computed as exp(−x/16)¹⁶ by the Taylor polynomial of degree 5, whose error at
/// x/16 = 0.28 is 7·10⁻⁷.
pub(crate) fn gaussian(x: Vec4) -> Vec4 {
    let y = x * (-1.0 / 16.0);
    let e = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0)))));
    let e2 = e * e;
    let e4 = e2 * e2;
    let e8 = e4 * e4;
    e8 * e8
}

/// Returns the energy of a pair by the [`Gaussian`] repulsion, whose squared distance is given in
/// squared mean radii, up to the square of the range.
pub(crate) fn pair_energy(distance_sq: f32) -> f32 {
    gaussian(Vec4::splat(0.5 * distance_sq)).x - END_ENERGY
}

/// Forces between discs of different radii (paper §5, "a relaxation scheme based on a computation
/// of forces"): two particles push each other apart by the overlap of their discs.
///
/// The stiffness is the same for all pairs, so discs of all sizes are compressed by the same length
/// where the forces balance. The energy is that of the relative overlaps, Σ (overlap / mean
/// radius)². To first order the same forces descend it, if the change of the radii with the
/// position is counted: the radius falls towards smaller neighbours, which pushes a particle as
/// much as the unequal forces of large and small neighbours do.
///
/// # Differs from the paper
///
/// * The paper gives no formulas. The discs count as 1.15 times as large as their radii: discs that
///   barely touch would not push into gaps. Of factors from 1.0 to 1.5, 1.15 gives the most even
///   sizes after ten steps on ellipsoid, torus and tanglecube.
/// * A radius is brought up to date once its particle has travelled a tenth of it, and at the end.
pub(crate) struct Overlap<'a> {
    pub(crate) sizing: &'a Sizing,
    /// Limits for the residuals of particles.
    pub(crate) residual_limits: ResidualLimits,
    /// Smallest length of a gradient that has a direction.
    pub(crate) min_gradient: f32,
}

impl Repulsion for Overlap<'_> {
    const RANGE: f32 = OVERLAP_RANGE;
    const SKIN: f32 = OVERLAP_SKIN;
    /// The grid is filled again each time: it is arranged by radii, which change.
    const SLACK: f32 = 0.0;
    /// The stiffest mode of the hexagonal lattice has the eigenvalue 6 (1 − c), where c is the
    /// share by which the lattice is compressed, so steps below 0.36 are stable. Shorter steps mend
    /// less in ten.
    const STEP: f32 = 0.33;
    const RESIZES: bool = true;

    fn radius(&self, particles: &Particles, i: usize) -> f32 {
        particles.radius[i]
    }

    fn slope(&self) -> f32 {
        self.sizing.slope()
    }

    fn extent(&self, particles: &Particles) -> RadiusRange {
        RadiusRange::among(&particles.radius)
    }

    fn pairs(&self, distance_sq: Vec4, mean: Vec4) -> (Vec4, Vec4) {
        let reach = mean * Self::RANGE;
        let distance = distance_sq.sqrt();
        let overlap = (reach - distance).max(Vec4::ZERO);
        let share = overlap / mean;
        // Two particles at one position have no direction to move apart in.
        let parted = distance.cmpgt(Vec4::ZERO);
        (Vec4::select(parted, overlap / distance, Vec4::ZERO), share * share)
    }

    fn land(&self, probe: &mut Probe, landing: &mut LandingBatch) {
        let (n, trust) = (landing.count, landing.trust);
        // Particles whose radius is due come first: only they need a Hessian.
        let is_due =
            |k: usize| landing.renews_radii || landing.radius_travel[k] > RADIUS_LASTS * landing.radius[k];
        let mut order = [0; BATCH];
        let mut due = 0;
        for k in (0..n).filter(|&k| is_due(k)) {
            order[due] = k;
            due += 1;
        }
        for (entry, k) in order[due..].iter_mut().zip((0..n).filter(|&k| !is_due(k))) {
            *entry = k;
        }
        let mut position = [Vec3::ZERO; BATCH];
        let mut descents = CurvatureDescents {
            radius: [0.0; BATCH],
            residual_limits: self.residual_limits,
            trust,
            reach: landing.reach,
            needs_curvature: true,
            hessian: [Sym3::default(); BATCH],
            curvature: [Curvature::default(); BATCH],
            last: [Curvature::default(); BATCH],
        };
        let mut normal = [Vec3::ZERO; BATCH];
        let mut radius = [0.0; BATCH];
        let mut ok = [false; BATCH];
        for (part, needs_curvature) in [(0..due, true), (due..n, false)] {
            let count = part.len();
            let order = &order[part];
            for (m, &k) in order.iter().enumerate() {
                position[m] = landing.position[k];
                descents.radius[m] = landing.radius[k];
            }
            descents.needs_curvature = needs_curvature;
            let min_gradient = self.min_gradient;
            let place = &mut position[..count];
            probe.land_along_gradient(place, &mut normal, &mut ok, min_gradient, &mut descents, MAX_NEWTON);
            if needs_curvature {
                self.sizing.radii(&position[..count], &descents.last[..count], &mut radius[..count]);
            }
            for (m, &k) in order.iter().enumerate() {
                landing.position[k] = position[m];
                landing.normal[k] = normal[m];
                landing.ok[k] = ok[m];
                if needs_curvature {
                    landing.radius[k] = radius[m];
                    landing.radius_travel[k] = 0.0;
                }
            }
        }
    }
}

/// A radius is brought up to date once its particle has travelled this share of it. Until then the
/// law has changed by less than this share of the slope, a few thousandths on most surfaces, and a
/// Hessian costs two to three gradients.
const RADIUS_LASTS: f32 = 0.1;

/// A batch of descents to the surface that notes the curvature at each evaluation.
struct CurvatureDescents {
    radius: [f32; BATCH],
    residual_limits: ResidualLimits,
    trust: f32,
    reach: f32,
    /// Whether evaluations include the Hessian.
    needs_curvature: bool,
    hessian: [Sym3<f32>; BATCH],
    curvature: [Curvature; BATCH],
    /// Curvature at the last evaluation of each particle.
    last: [Curvature; BATCH],
}

impl Descents for CurvatureDescents {
    fn of(&self, i: usize) -> Descent {
        let radius = self.radius[i];
        Descent {
            residual: self.residual_limits.residual(radius),
            reach: self.reach * radius,
            trust: self.trust * radius,
        }
    }

    fn evaluate(
        &mut self,
        field: &mut dyn Evaluator,
        which: &[u32],
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
    ) {
        if !self.needs_curvature {
            return field.gradients(points, value, gradient);
        }
        let hessian = &mut self.hessian[..points.len()];
        field.hessians(points, value, gradient, hessian);
        curvatures_of(gradient, hessian, &mut self.curvature[..points.len()]);
        for (&i, &curvature) in which.iter().zip(&self.curvature) {
            self.last[i as usize] = curvature;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussian_is_accurate_within_the_cut_off() {
        for k in 0..=450 {
            let x = k as f32 * 0.01;
            let exact = libm::exp(-f64::from(x));
            let got = f64::from(gaussian(Vec4::splat(x)).x);
            assert!((got / exact - 1.0).abs() < 3e-5, "x = {x}: {got} against {exact}");
        }
        let end = libm::exp(-0.5 * f64::from(Gaussian::RANGE * Gaussian::RANGE));
        assert!((f64::from(END_ENERGY) / end - 1.0).abs() < 1e-6);
    }
}
