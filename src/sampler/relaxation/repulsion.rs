//! What repels particles: a Gaussian for those of one size (paper §4.5), the overlap of discs for those of many (§5).

use crate::differential::{Curvature, curvatures_of};
use crate::field::Field;
use crate::math::Sym3;
use crate::particles::Particles;
use crate::sampler::neighbours::constants::{GAUSSIAN_RANGE, GAUSSIAN_SKIN, OVERLAP_RANGE, OVERLAP_SKIN};
use crate::sampler::projection::{BATCH, Descent, Descents, Projector, Tolerance, tolerance};
use crate::sampler::sizing::Sizing;
use glam::{Vec3, Vec4};

/// Evaluations to bring one particle back onto the surface.
const MAX_NEWTON: u32 = 6;

/// Share in which two particles repel each other whose normals have this cosine: all up to 60°, as neighbours on one sheet;
/// nothing from 120°, as neighbours on two.
///
/// In between it is linear in the cosine: no pair comes or goes at once, and the energy is one continuous function of the
/// places. The force is that of the distances alone and does not count how the share changes with the place, so the ramp
/// must not be steep. Of ramps from 60°, 75° and 90° to 90°, 105° and 120° this one spreads particles most evenly on the
/// surfaces of the gallery at radii of 1 % to 5 % of the diagonal.
pub(crate) fn same_sheet_weight(cosine: f32) -> f32 {
    (0.5 + cosine).clamp(0.0, 1.0)
}

/// No particle moves farther than this in one step, in radii.
pub(crate) const MAX_MOVE: f32 = 0.35;

/// A Newton correction shorter than this, in radii, leaves a residual of the order of its square.
pub(crate) const TRUSTED_CORRECTION: f32 = 0.02;

/// Some particles on their way back to the surface.
pub(crate) struct Points {
    pub(crate) count: usize,
    pub(crate) position: [Vec3; BATCH],
    pub(crate) normal: [Vec3; BATCH],
    /// Radius, where that changes.
    pub(crate) radius: [f32; BATCH],
    /// Way since the radius was brought up to date, a length.
    pub(crate) since: [f32; BATCH],
    /// Whether the point has come to the surface.
    pub(crate) ok: [bool; BATCH],
}

impl Points {
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            position: [Vec3::ZERO; BATCH],
            normal: [Vec3::ZERO; BATCH],
            radius: [0.0; BATCH],
            since: [0.0; BATCH],
            ok: [false; BATCH],
        }
    }
}

/// A law of repulsion between the two particles of a pair. Lengths are in mean radii of the pair unless said otherwise.
pub(crate) trait Repulsion {
    /// Distance beyond which it ends.
    const RANGE: f32;
    /// Verlet skin: what the neighbour lists reach farther, so that they serve while particles move.
    const SKIN: f32;
    /// How far particles may go until the grid in which neighbours are found is made anew.
    const SLACK: f32;
    /// Units that bringing a particle up to date at the end counts for.
    const POLISH_UNITS: u32;
    /// First step size, and the largest: a particle moves by it times the sum of `offset * weight` over its pairs.
    const STEP: f32;
    /// Whether the radii change as particles move.
    const RESIZES: bool;

    /// Radius of particle `i`.
    fn radius(&self, particles: &Particles, i: usize) -> f32;

    /// Lipschitz slope of the radius along the surface.
    fn slope(&self) -> f32;

    /// Smallest and largest radius now.
    fn extent(&self, particles: &Particles) -> (f32, f32);

    /// Force over offset, and energy, of four pairs with these squared distances and mean radii, of length.
    fn pairs(&self, distance_sq: Vec4, mean: Vec4) -> (Vec4, Vec4);

    /// Brings `points` onto the surface, and up to date the radii of those that have come far since that was done or, with
    /// no `trust`, of all. A correction below `trust` radii is not checked.
    fn land(&self, field: &mut dyn Field, projector: &mut Projector, points: &mut Points, trust: f32);
}

/// Gaussian repulsion after Witkin and Heckbert 1994, §4: no fission, no death, one radius.
///
/// Each pair has the energy exp(−d²/2σ²) with σ = r; every particle moves against its gradient. The hexagonal lattice of
/// spacing 2r is then close to equilibrium (2.017 r).
///
/// # Differs from the paper
///
/// The pair energy is cut off at 3σ and shifted so that it ends at zero: the sum is continuous in the positions.
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
    const POLISH_UNITS: u32 = 1;
    /// In units of σ². The stiffest wave of the hexagonal lattice at spacing 2σ has the eigenvalue 2.2 / σ², so steps
    /// below 0.9 are stable there; where rows are squeezed to 1.7σ, below 0.7. Longer steps reach no lower energy in ten
    /// steps and set the squeezed rows trembling.
    const STEP: f32 = 0.6;
    const RESIZES: bool = false;

    fn radius(&self, _: &Particles, _: usize) -> f32 {
        self.radius
    }

    fn slope(&self) -> f32 {
        0.0
    }

    fn extent(&self, _: &Particles) -> (f32, f32) {
        (self.radius, self.radius)
    }

    fn pairs(&self, distance_sq: Vec4, _: Vec4) -> (Vec4, Vec4) {
        // Squared distances are measured in σ² = r².
        let half_sq = distance_sq * self.scale;
        let near = half_sq.cmplt(Vec4::splat(0.5 * Self::RANGE * Self::RANGE));
        let weight = gaussian(half_sq);
        (Vec4::select(near, weight, Vec4::ZERO), Vec4::select(near, weight - END_ENERGY, Vec4::ZERO))
    }

    fn land(&self, field: &mut dyn Field, projector: &mut Projector, points: &mut Points, trust: f32) {
        let mut descent = Descent {
            residual: self.tolerance.residual,
            reach: MAX_MOVE * self.radius,
            trust: trust * self.radius,
        };
        projector.land_along_gradient(
            field,
            &mut points.position[..points.count],
            &mut points.normal,
            &mut points.ok,
            self.tolerance.min_gradient,
            &mut descent,
            MAX_NEWTON,
        );
    }
}

/// exp(−RANGE²/2).
const END_ENERGY: f32 = 0.011_108_997;

/// exp(−x) for 0 ≤ x ≤ 4.5 to 2·10⁻⁵ of its value; of no meaning elsewhere.
///
/// exp(−x) = exp(−x/16)¹⁶ with the Taylor polynomial of degree 5, whose error at x/16 = 0.28 is 7·10⁻⁷.
pub(crate) fn gaussian(x: Vec4) -> Vec4 {
    let y = x * (-1.0 / 16.0);
    let e = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0)))));
    let e2 = e * e;
    let e4 = e2 * e2;
    let e8 = e4 * e4;
    e8 * e8
}

/// Forces between discs of different radii (paper §5, "a relaxation scheme based on a computation of forces"): each pair
/// pushes apart by its overlap.
///
/// The force is the overlap, of the same stiffness for all pairs, so that discs of all sizes are compressed alike where the
/// forces balance. The energy is that of the relative overlaps, Σ (overlap / mean radius)², whose descent the same force is
/// to first order when the change of the radii with the place is counted: the radius falls where the neighbours are
/// smaller, which pushes a particle as much as the unequal forces of large and small neighbours do.
///
/// # Differs from the paper
///
/// * The paper gives no formulas. Overlap is counted against 1.15 (r_i + r_j): with discs that barely touch, gaps would push
///   nothing. Of 1.0 to 1.5, 1.15 gives the most even sizes after ten steps on ellipsoid, torus and tanglecube.
/// * A radius is brought up to date once its particle has gone a tenth of it, and at the end.
pub(crate) struct Overlap<'a> {
    pub(crate) sizing: &'a Sizing,
    /// What single precision resolves, and the least gradient that is one.
    pub(crate) resolution: f32,
    pub(crate) min_gradient: f32,
}

impl Repulsion for Overlap<'_> {
    const RANGE: f32 = OVERLAP_RANGE;
    const SKIN: f32 = OVERLAP_SKIN;
    /// The grid goes by radii, which change.
    const SLACK: f32 = 0.0;
    /// Every one asks for a Hessian.
    const POLISH_UNITS: u32 = 8;
    /// The stiffest wave of the hexagonal lattice has the eigenvalue 6 less six times the share by which it is compressed,
    /// so steps below 0.36 are stable. Shorter ones mend less in ten.
    const STEP: f32 = 0.33;
    const RESIZES: bool = true;

    fn radius(&self, particles: &Particles, i: usize) -> f32 {
        particles.radius[i]
    }

    fn slope(&self) -> f32 {
        self.sizing.slope()
    }

    fn extent(&self, particles: &Particles) -> (f32, f32) {
        particles.radius.iter().fold((f32::INFINITY, 0.0), |(least, most), &radius| {
            (if radius < least { radius } else { least }, if radius > most { radius } else { most })
        })
    }

    fn pairs(&self, distance_sq: Vec4, mean: Vec4) -> (Vec4, Vec4) {
        let reach = mean * Self::RANGE;
        let distance = distance_sq.sqrt();
        let overlap = (reach - distance).max(Vec4::ZERO);
        let share = overlap / mean;
        // Two particles in one place have no direction to part in.
        let parted = distance.cmpgt(Vec4::ZERO);
        (Vec4::select(parted, overlap / distance, Vec4::ZERO), share * share)
    }

    fn land(&self, field: &mut dyn Field, projector: &mut Projector, points: &mut Points, trust: f32) {
        let n = points.count;
        // Those whose curvature is asked for come first.
        let is_old = |k: usize| trust <= 0.0 || points.since[k] > RADIUS_LASTS * points.radius[k];
        let mut order = [0; BATCH];
        let mut old = 0;
        for k in (0..n).filter(|&k| is_old(k)) {
            order[old] = k;
            old += 1;
        }
        for (place, k) in order[old..].iter_mut().zip((0..n).filter(|&k| !is_old(k))) {
            *place = k;
        }
        let mut position = [Vec3::ZERO; BATCH];
        let mut bent = Bent {
            radius: [0.0; BATCH],
            resolution: self.resolution,
            trust,
            bends: true,
            hessian: [Sym3::default(); BATCH],
            curvature: [Curvature::default(); BATCH],
            met: [Curvature::default(); BATCH],
        };
        let mut normal = [Vec3::ZERO; BATCH];
        let mut ok = [false; BATCH];
        for (part, bends) in [(0..old, true), (old..n, false)] {
            let count = part.len();
            let order = &order[part];
            for (m, &k) in order.iter().enumerate() {
                position[m] = points.position[k];
                bent.radius[m] = points.radius[k];
            }
            bent.bends = bends;
            let min_gradient = self.min_gradient;
            let place = &mut position[..count];
            projector.land_along_gradient(
                field,
                place,
                &mut normal,
                &mut ok,
                min_gradient,
                &mut bent,
                MAX_NEWTON,
            );
            for (m, &k) in order.iter().enumerate() {
                points.position[k] = position[m];
                points.normal[k] = normal[m];
                points.ok[k] = ok[m];
                if bends {
                    points.radius[k] = self.sizing.radius(position[m], &bent.met[m]);
                    points.since[k] = 0.0;
                }
            }
        }
    }
}

/// A radius stands until its particle has gone this share of it: until then the law has changed by less than a share of
/// the slope, a few thousandths on most surfaces, and a Hessian costs two or three gradients.
const RADIUS_LASTS: f32 = 0.1;

/// Points on their way to the surface with what the field's last evaluation says of the curvature there.
struct Bent {
    radius: [f32; BATCH],
    resolution: f32,
    trust: f32,
    /// Whether the curvature is asked for.
    bends: bool,
    hessian: [Sym3<f32>; BATCH],
    curvature: [Curvature; BATCH],
    /// The last curvature met by each point.
    met: [Curvature; BATCH],
}

impl Descents for Bent {
    fn of(&self, i: usize) -> Descent {
        let radius = self.radius[i];
        Descent {
            residual: tolerance(radius, self.resolution, 0.0).residual,
            reach: MAX_MOVE * radius,
            trust: self.trust * radius,
        }
    }

    fn evaluate(
        &mut self,
        field: &mut dyn Field,
        which: &[u32],
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
    ) {
        if !self.bends {
            return field.gradients(points, value, gradient);
        }
        let hessian = &mut self.hessian[..points.len()];
        field.hessians(points, value, gradient, hessian);
        curvatures_of(gradient, hessian, &mut self.curvature[..points.len()]);
        for (&i, &curvature) in which.iter().zip(&self.curvature) {
            self.met[i as usize] = curvature;
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
