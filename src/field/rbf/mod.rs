//! Hermite radial basis functions: a smooth field near points with normals.
//!
//! The field is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. For d = x − cⱼ, the
//! gradient ∇φ = 3 r d and the Hessian 3 (r I + d dᵀ/r) vanish at d = 0. `pointcloud::fit` computes
//! the coefficients from the conditions f = 0 and ∇f = n at points. The models of the paper (§6)
//! are fields of this kind.

mod border;
mod coefficients;
mod data;
mod frame;
mod kernel;
mod pulls;
mod taylor;
mod tree;

pub use border::{Ball, Border};
pub use data::{DataError, RbfData};
pub use frame::CentredFrame;
pub(crate) use pulls::pulled_box;
pub use pulls::{LONGEST_PULL, Pull};

use super::combined::limited;
use super::{Evaluator, Field, Frame, Jet, Piecewise, Pointwise};
use crate::math::Sym3;
use core::fmt::{self, Debug, Formatter};
use glam::{DVec3, Vec3};
use pulls::Pulls;
use std::sync::Arc;

/// A field given by centres and coefficients, defined everywhere.
///
/// A point costs about as much as forty terms of the sum, however many centres there are (see
/// `tree`). The first point in a cell of the octree allocates a few kilobytes; a model has some
/// hundred cells near its surface.
///
/// The value equals the sum in double precision up to about 10⁻⁶ of the model's size, and it jumps
/// by as much between cells. The Hessian has no limit at a centre with β ≠ 0; at the centre itself
/// it is the sum over the other centres.
///
/// Its surface continues where there are no points, or, if [trimmed](RbfField::trimmed), ends at
/// their border.
#[derive(Clone)]
pub struct RbfField {
    data: Arc<RbfData>,
    tree: Arc<tree::CellTree>,
    pulls: Pulls,
    /// The surface that ends at the border of the points, if this surface does.
    trimmed: Option<Arc<dyn Piecewise>>,
}

impl Debug for RbfField {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let is_trimmed = self.trimmed.is_some();
        f.debug_struct("RbfField")
            .field("data", &self.data)
            .field("is_trimmed", &is_trimmed)
            .finish_non_exhaustive()
    }
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
        let tree = Arc::new(tree::CellTree::new(&data));
        Ok(Self { data, tree, pulls: Pulls::default(), trimmed: None })
    }

    /// This field with a surface that ends at the border of its points, if there is one.
    #[must_use]
    pub fn trimmed(mut self) -> Self {
        if let Some(border) = &self.data.border {
            let border = PulledBorder { border: border.clone(), pulls: self.pulls.clone() };
            self.trimmed = Some(limited(Arc::new(self.clone().untrimmed()), Arc::new(border)));
        }
        self
    }

    /// This field with a surface that continues where there are no points.
    #[must_use]
    pub fn untrimmed(self) -> Self {
        Self { trimmed: None, ..self }
    }

    /// Whether the surface ends at the border of its points.
    #[must_use]
    pub fn is_trimmed(&self) -> bool {
        self.trimmed.is_some()
    }

    /// Applies these pulls to the surface of the centres, replacing the previous ones.
    ///
    /// # Errors
    ///
    /// [`DataError::Pull`] if one is not finite, or longer than [`LONGEST_PULL`] of its reach;
    /// nothing is changed then.
    #[doc(hidden)]
    pub fn pull(&mut self, pulls: &[Pull]) -> Result<(), DataError> {
        self.pulls = Pulls::new(pulls)?;
        if self.is_trimmed() {
            *self = self.clone().trimmed();
        }
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
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let (value, gradient) = self.data.slope(self.pulls.back(p));
        let mut jet = Jet { value, gradient, ..Jet::default() };
        self.pulls.pull_back(p, &mut jet);
        (jet.value, jet.gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        if let Some(trimmed) = &self.trimmed {
            return trimmed.jet(p);
        }
        let mut jet = self.data.jet(self.pulls.back(p));
        self.pulls.pull_back(p, &mut jet);
        jet
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        match &self.trimmed {
            Some(trimmed) => trimmed.evaluator(frame),
            None => Box::new(RbfEvaluator { field: self, frame, places: Vec::new() }),
        }
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        self.trimmed.as_deref()
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn operand(&self) -> Option<Arc<dyn Field>> {
        self.is_trimmed().then(|| Arc::new(self.clone().untrimmed()) as Arc<dyn Field>)
    }
}

/// The border of the points of a model, which the pulls on its surface move.
struct PulledBorder {
    border: Border,
    pulls: Pulls,
}

impl Field for PulledBorder {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let jet = self.jet(p);
        (jet.value, jet.gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        let mut jet = self.border.jet(self.pulls.back(p));
        self.pulls.pull_back(p, &mut jet);
        jet
    }

    fn is_smooth(&self) -> bool {
        true
    }
}

/// Evaluates an interpolant.
struct RbfEvaluator<'a> {
    field: &'a RbfField,
    frame: Frame,
    /// The points that are pulled to the points of a batch.
    places: Vec<Vec3>,
}

impl RbfEvaluator<'_> {
    /// Calls `store` with the index of each point and with the first numbers of f, ∇f and ∇∇f at
    /// it, before they are scaled.
    fn sums<const N: usize>(&mut self, points: &[Vec3], store: impl FnMut(usize, [f32; N])) {
        let Self { field: RbfField { data, tree, pulls, .. }, frame, places } = self;
        let pulls = Some(pulls).filter(|pulls| !pulls.list().is_empty());
        let points = match pulls {
            None => points,
            Some(pulls) => {
                let pulled = |p: &Vec3| (pulls.back(frame.place(p.as_dvec3())) - frame.origin).as_vec3();
                places.clear();
                places.extend(points.iter().map(pulled));
                places
            }
        };
        tree.sums(data, frame.origin, points, store);
    }

    /// Applies the pulls to the derivatives at a point.
    fn pull_back(&self, p: Vec3, jet: &mut Jet) {
        self.field.pulls.pull_back(self.frame.place(p.as_dvec3()), jet);
    }

    fn is_pulled(&self) -> bool {
        !self.field.pulls().is_empty()
    }
}

impl Evaluator for RbfEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(RbfEvaluator { field: self.field, frame: self.frame, places: Vec::new() })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        if self.frame.double.is_some() {
            return Pointwise { field: self.field, frame: self.frame }.values(points, value);
        }
        let scale = self.frame.scale;
        // Values alone are rarely needed, so they have no code of their own.
        self.sums(points, |n, [v, ..]: [f32; 4]| value[n] = v * scale);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        if self.frame.double.is_some() {
            return Pointwise { field: self.field, frame: self.frame }.gradients(points, value, gradient);
        }
        let scale = self.frame.scale;
        self.sums(points, |n, [v, x, y, z]| {
            (value[n], gradient[n]) = (v * scale, Vec3::new(x, y, z) * scale);
        });
        if !self.is_pulled() {
            return;
        }
        for (&p, gradient) in points.iter().zip(gradient) {
            let mut jet = Jet { gradient: gradient.as_dvec3(), ..Jet::default() };
            self.pull_back(p, &mut jet);
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
        if self.frame.double.is_some() {
            let mut pointwise = Pointwise { field: self.field, frame: self.frame };
            return pointwise.hessians(points, value, gradient, hessian);
        }
        let scale = self.frame.scale;
        self.sums(points, |n, sums: [f32; 10]| {
            let [v, x, y, z, xx, xy, xz, yy, yz, zz] = sums.map(|entry| entry * scale);
            (value[n], gradient[n]) = (v, Vec3::new(x, y, z));
            hessian[n] = Sym3 { xx, xy, xz, yy, yz, zz };
        });
        if !self.is_pulled() {
            return;
        }
        for ((&p, gradient), hessian) in points.iter().zip(gradient).zip(hessian) {
            let mut jet = Jet { value: 0.0, gradient: gradient.as_dvec3(), hessian: hessian.map(f64::from) };
            self.pull_back(p, &mut jet);
            (*gradient, *hessian) = (jet.gradient.as_vec3(), jet.hessian.map(|entry| entry as f32));
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.frame.exact(self.field.value_and_gradient(self.frame.place(p)))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.frame.jet(self.field.jet(self.frame.place(p)))
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        if self.is_pulled() {
            for (k, p) in points.iter().enumerate() {
                (value[k], gradient[k]) = self.value_and_gradient(p.as_dvec3());
            }
            return;
        }
        self.field.data.gradients(self.frame.origin, points, value, gradient);
        for (value, gradient) in value.iter_mut().zip(gradient).take(points.len()) {
            (*value, *gradient) = self.frame.exact((*value, *gradient));
        }
    }
}
