//! Hermite radial basis functions: a smooth field near points with normals.
//!
//! The field is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. For d = x − cⱼ, the gradient ∇φ = 3 r d and
//! the Hessian 3 (r I + d dᵀ/r) vanish at d = 0. `pointcloud::fit` computes the coefficients from the conditions f = 0
//! and ∇f = n at points. The models of the paper (§6) are fields of this kind.

mod coefficients;
mod data;
mod frame;
mod kernel;
mod pulls;
mod taylor;
mod tree;

pub use data::{DataError, RbfData};
pub use frame::CentredFrame;
pub(crate) use pulls::pulled_box;
pub use pulls::{LONGEST_PULL, Pull};

use super::{Field, Jet};
use crate::math::Sym3;
use glam::{DVec3, Vec3};
use pulls::Pulls;
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
    pulls: Pulls,
}

impl RbfField {
    /// Field with the centres and coefficients `data`.
    ///
    /// # Errors
    ///
    /// If `data` fails [`RbfData::check`].
    #[doc(hidden)]
    pub fn new(data: impl Into<Arc<RbfData>>) -> Result<Self, DataError> {
        let data = data.into();
        data.check()?;
        let tree = tree::CellTree::new(&data);
        Ok(Self { data, tree, pulls: Pulls::default() })
    }

    /// Makes these pulls on the surface of the centres, in the place of those before.
    ///
    /// # Errors
    ///
    /// [`DataError::Pull`] if one is not finite, or longer than [`LONGEST_PULL`] of its reach; nothing is changed then.
    #[doc(hidden)]
    pub fn pull(&mut self, pulls: &[Pull]) -> Result<(), DataError> {
        self.pulls = Pulls::new(pulls)?;
        Ok(())
    }

    /// The pulls on the surface.
    #[must_use]
    #[doc(hidden)]
    pub fn pulls(&self) -> &[Pull] {
        self.pulls.list()
    }

    /// Centres and coefficients of the field, which its copies share.
    #[must_use]
    #[doc(hidden)]
    pub fn data(&self) -> &Arc<RbfData> {
        &self.data
    }
}

impl Field for RbfField {
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.tree.values(&self.data, self.pulls.places(points), &mut value[..points.len()]);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let (value, gradient) = (&mut value[..points.len()], &mut gradient[..points.len()]);
        self.tree.gradients(&self.data, self.pulls.places(points), value, gradient);
        if self.pulls().is_empty() {
            return;
        }
        for (p, gradient) in points.iter().zip(gradient) {
            let mut jet = Jet { gradient: gradient.as_dvec3(), ..Jet::default() };
            self.pulls.pull_back(p.as_dvec3(), &mut jet);
            *gradient = jet.gradient.as_vec3();
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let n = points.len();
        let (value, gradient, hessian) = (&mut value[..n], &mut gradient[..n], &mut hessian[..n]);
        self.tree.hessians(&self.data, self.pulls.places(points), value, gradient, hessian);
        if self.pulls().is_empty() {
            return;
        }
        for ((p, gradient), hessian) in points.iter().zip(gradient).zip(hessian) {
            let mut jet = Jet { value: 0.0, gradient: gradient.as_dvec3(), hessian: hessian.map(f64::from) };
            self.pulls.pull_back(p.as_dvec3(), &mut jet);
            (*gradient, *hessian) = (jet.gradient.as_vec3(), jet.hessian.map(|entry| entry as f32));
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let jet = self.jet(p);
        (jet.value, jet.gradient)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let mut jet = self.data.jet(self.pulls.back(p));
        self.pulls.pull_back(p, &mut jet);
        jet
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        if self.pulls().is_empty() {
            return self.data.gradients(points, value, gradient);
        }
        for (k, p) in points.iter().enumerate() {
            (value[k], gradient[k]) = self.value_and_gradient(p.as_dvec3());
        }
    }
}
