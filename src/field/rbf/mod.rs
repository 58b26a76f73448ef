//! Hermite radial basis functions: a smooth field near points with normals.
//!
//! The field is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. For d = x − cⱼ, the gradient ∇φ = 3 r d and
//! the Hessian 3 (r I + d dᵀ/r) vanish at d = 0. `pointcloud::fit` computes the coefficients from the conditions f = 0
//! and ∇f = n at points. The models of the paper (§6) are fields of this kind.

mod coefficients;
mod data;
mod frame;
mod kernel;
mod taylor;
mod tree;

pub use data::{DataError, RbfData};
pub use frame::CentredFrame;

use super::{Field, Jet};
use crate::math::Sym3;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A field given by centres and coefficients, defined everywhere.
///
/// The cost of a point is about that of forty terms of the sum, however many centres there are (see `tree`). The first
/// point in a cell of the octree allocates a few kilobytes; a model has some hundred cells near its surface.
///
/// The value is that of the sum in double precision to about 10⁻⁶ of the model's size, and it jumps by as much between
/// cells. The Hessian has no limit at a centre with β ≠ 0; at the centre itself it is the sum over the other centres.
#[derive(Clone, Debug)]
pub struct RbfField {
    data: Arc<RbfData>,
    tree: tree::CellTree,
}

impl RbfField {
    /// Field with the centres and coefficients `data`.
    ///
    /// # Errors
    ///
    /// If `data` fails [`RbfData::check`].
    pub fn new(data: impl Into<Arc<RbfData>>) -> Result<Self, DataError> {
        let data = data.into();
        data.check()?;
        let tree = tree::CellTree::new(&data);
        Ok(Self { data, tree })
    }

    /// Centres and coefficients of the field, which its copies share.
    #[must_use]
    pub fn data(&self) -> &Arc<RbfData> {
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

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let jet = self.data.jet(p);
        (jet.value, jet.gradient)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.data.jet(p)
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.data.gradients(points, value, gradient);
    }
}
