//! Hermite radial basis functions: a smooth field from points with normals.
//!
//! f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³, whose gradient 3 r d and second derivative 3 (r I + d dᵀ/r)
//! vanish at d = 0. The coefficients come from `pointcloud::fit`, which asks for f = 0 and ∇f = n at every centre; the paper's
//! models (§6) are fields of this kind.

mod data;
mod frame;
mod kernel;
mod taylor;
mod tree;

pub use data::{DataError, RbfData};
pub use frame::Frame;

use super::{Field, Interval, Jet};
use crate::math::Sym3;
use glam::{DVec3, Vec3};

/// A field from centres and coefficients.
///
/// A point costs about as much as forty terms of the sum, however many centres there are: see `tree`. Where points fall
/// for the first time, memory is allocated, a few kilobytes for each of some hundred places. The value is that of the sum in
/// double precision within about 10⁻⁶ of the model's size, and jumps by as much from place to place. The field is defined
/// everywhere. The Hessian has no limit at a centre, unless β is zero; there it is the sum over the other centres.
#[derive(Clone, Debug)]
pub struct RbfField {
    data: RbfData,
    tree: tree::Tree,
}

impl RbfField {
    /// The field with these centres and coefficients.
    ///
    /// # Errors
    ///
    /// If `data` fails [`RbfData::check`].
    pub fn new(data: RbfData) -> Result<Self, DataError> {
        data.check()?;
        let tree = tree::Tree::new(&data);
        Ok(Self { data, tree })
    }

    /// Centres and coefficients.
    #[must_use]
    pub fn data(&self) -> &RbfData {
        &self.data
    }
}

impl Field for RbfField {
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.tree.values(&self.data, points, &mut value[..points.len()]);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.tree.gradients(&self.data, points, &mut value[..points.len()], &mut gradient[..points.len()]);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let n = points.len();
        self.tree.hessians(&self.data, points, &mut value[..n], &mut gradient[..n], &mut hessian[..n]);
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.data.jet(p)
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.data.gradients(points, value, gradient);
    }

    fn interval(&mut self, _lo: DVec3, _hi: DVec3) -> Interval {
        Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY, defined: true }
    }
}
