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

/// What is known of a field and its gradient over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Lower and upper bound of f, never NaN; the lower one is above the upper one where f is defined nowhere.
    pub value: [f64; 2],
    /// Lower and upper bounds of ∂f/∂x, ∂f/∂y and ∂f/∂z where they exist, and of every slope between the one-sided ones
    /// where they do not; never NaN.
    pub gradient: [[f64; 2]; 3],
    /// Whether f is certainly defined everywhere in the box: no NaN and no pole.
    pub defined: bool,
    /// Whether f is certainly continuous where it is defined.
    pub continuous: bool,
    /// Whether the gradient is certainly continuous too: where it jumps, bounds of second derivatives say nothing of it.
    pub smooth: bool,
    /// Whether f may be 0 somewhere in the box. It can be excluded even where the bounds have both signs, as for 1/x.
    pub may_vanish: bool,
}

impl Enclosure {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        value: [f64::NEG_INFINITY, f64::INFINITY],
        gradient: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
        defined: false,
        continuous: false,
        smooth: false,
        may_vanish: true,
    };

    /// f is defined nowhere in the box.
    pub const NOWHERE: Self =
        Self { value: [f64::INFINITY, f64::NEG_INFINITY], may_vanish: false, ..Self::UNKNOWN };
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
pub trait Field: Send {
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

    /// f and ∇f at each point in double precision: those of [`Field::jet`] up to rounding.
    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (k, p) in points.iter().enumerate() {
            let jet = self.jet(p.as_dvec3());
            (value[k], gradient[k]) = (jet.value, jet.gradient);
        }
    }

    /// Bounds of f over the box from `lo` to `hi`, rounded outward: 0 outside the bounds proves that the box holds
    /// no point of the surface.
    fn interval(&mut self, lo: DVec3, hi: DVec3) -> Interval;

    /// Whether there are bounds of f: without them [`Field::enclose`] is not asked, the survey is dense, and no proof is
    /// attempted. They may still be too wide to say anything.
    fn has_bounds(&self) -> bool {
        false
    }

    /// Number of functions whose zeros together are those of f, for [`Field::enclose`]: the factors of a product, else 1.
    fn parts(&mut self) -> usize {
        1
    }

    /// Bounds of one of the functions that f falls into, and of its gradient, over each box, given by its smallest and
    /// largest corner; `out[i]` belongs to `boxes[i]`. What it says about being defined and continuous holds for f too. By
    /// default nothing is known.
    ///
    /// # Panics
    ///
    /// If `part` is not below [`Field::parts`], or `out` is shorter than `boxes`.
    fn enclose(&mut self, part: usize, boxes: &[[DVec3; 2]], out: &mut [Enclosure]) {
        let _ = part;
        out[..boxes.len()].fill(Enclosure::UNKNOWN);
    }

    /// Bounds of the second derivatives of the same function over each box, in the order xx, xy, xz, yy, yz, zz; they hold
    /// where f is defined and its gradient continuous and have no meaning elsewhere. By default nothing is known.
    ///
    /// # Panics
    ///
    /// As [`Field::enclose`].
    fn enclose_second(&mut self, part: usize, boxes: &[[DVec3; 2]], out: &mut [[[f64; 2]; 6]]) {
        let _ = part;
        out[..boxes.len()].fill([[f64::NEG_INFINITY, f64::INFINITY]; 6]);
    }
}
