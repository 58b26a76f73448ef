//! Hermite radial basis functions: a smooth field from points with normals.
//!
//! f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³, whose gradient 3 r d and second derivative 3 (r I + d dᵀ/r)
//! vanish at d = 0. The coefficients come from `points::fit`, which asks for f = 0 and ∇f = n at every centre; the paper's
//! models (§6) are fields of this kind.

mod data;
mod frame;
mod kernel;

pub use data::{DataError, RbfData};
pub use frame::Frame;

use super::{Field, Interval, Jet};
use crate::math::Sym3;
use glam::{DVec3, Vec3};

/// A field from centres and coefficients.
///
/// Cost is proportional to the number of centres; nothing is allocated after construction. The field is defined
/// everywhere; its third derivative is not continuous at a centre, and the Hessian there is the limit along no direction
/// but the sum over the other centres.
#[derive(Clone, Debug)]
pub struct RbfField {
    data: RbfData,
    single: kernel::Single,
}

impl RbfField {
    /// The field with these centres and coefficients.
    ///
    /// # Errors
    ///
    /// If `data` fails [`RbfData::check`].
    pub fn new(data: RbfData) -> Result<Self, DataError> {
        data.check()?;
        let single = kernel::Single::new(&data);
        Ok(Self { data, single })
    }

    /// Centres and coefficients.
    #[must_use]
    pub fn data(&self) -> &RbfData {
        &self.data
    }
}

impl Field for RbfField {
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.single.values(points, &mut value[..points.len()]);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.single.gradients(points, &mut value[..points.len()], &mut gradient[..points.len()]);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let n = points.len();
        self.single.hessians(points, &mut value[..n], &mut gradient[..n], &mut hessian[..n]);
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.data.jet(p)
    }

    fn interval(&mut self, _lo: DVec3, _hi: DVec3) -> Interval {
        Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY, defined: true }
    }
}
