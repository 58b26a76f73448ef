//! Fields f(x, y, z) whose zero set is the surface: values, gradients and Hessians, one point or a batch at a time.

pub mod formula;
pub mod gallery;
pub mod model;
pub mod rbf;
pub(crate) mod scaled;

use crate::math::Sym3;
use glam::{DVec3, Vec3};

/// Value, gradient and Hessian of a field at one point, in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// f.
    pub value: f64,
    /// ∇f.
    pub gradient: DVec3,
    /// ∇∇f.
    pub hessian: Sym3<f64>,
}

/// A closed interval that holds every value of an expression over a box; NaN bounds never occur. The empty
/// interval, `lo > hi`, says that the expression is defined nowhere in the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound, may be −∞.
    pub lo: f64,
    /// Upper bound, may be +∞.
    pub hi: f64,
    /// Whether the expression is certainly defined everywhere in the box: no NaN and no pole. At a pole itself the
    /// value may be an infinity outside the bounds.
    pub defined: bool,
}

/// A scalar field with its derivatives.
///
/// Batched methods read `points` and write the first `points.len()` entries of each output; they take `&mut self`
/// because an implementation keeps its scratch memory, and they do not allocate once warm. A point's result does
/// not depend on its place in the batch, has the same bits natively and in WebAssembly, and is NaN where the field
/// is undefined.
///
/// # Panics
///
/// If an output is shorter than `points`.
pub trait Field {
    /// f at each point.
    fn values(&mut self, points: &[Vec3], value: &mut [f32]);

    /// f and ∇f at each point.
    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]);

    /// f, ∇f and ∇∇f at each point.
    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    );

    /// f, ∇f and ∇∇f at `p` in double precision: the oracle that the batched methods are held to.
    fn jet(&mut self, p: DVec3) -> Jet;

    /// Bounds of f over the box from `lo` to `hi`, rounded outward: 0 outside the bounds proves that the box holds
    /// no point of the surface.
    fn interval(&mut self, lo: DVec3, hi: DVec3) -> Interval;
}
