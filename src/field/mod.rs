//! Fields f(x, y, z) whose zero set is the surface.
//!
//! A [`Field`] gives values, gradients and Hessians for batches of points, exact ones at single points, and, if it is
//! [`Bounded`], bounds over boxes. [`formula`] makes fields from text, [`gallery`] holds named formulas, and [`rbf`] interpolates points.

pub mod formula;
pub mod gallery;
pub mod model;
pub mod rbf;
pub(crate) mod scaled;

use crate::math::{Bounds, Interval, Sym3};
use glam::{DVec3, Vec3};

/// Second-order jet of a field at a point, in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// The value f.
    pub value: f64,
    /// The gradient ∇f.
    pub gradient: DVec3,
    /// The Hessian ∇∇f.
    pub hessian: Sym3<f64>,
}

/// Bounds of f and ∇f over a box, with properties that interval arithmetic has proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Bounds of f, never NaN. They are empty if f is defined nowhere in the box.
    pub value: Interval,
    /// Bounds of ∂f/∂x, ∂f/∂y and ∂f/∂z, never NaN. At a kink they contain every slope between the
    /// one-sided ones (Clarke's generalised gradient).
    pub gradient: [Interval; 3],
    /// Whether f is certainly defined everywhere in the box, without NaN or pole.
    pub defined: bool,
    /// Whether f is certainly continuous where it is defined.
    pub continuous: bool,
    /// Whether the gradient is certainly continuous. Where it jumps, bounds of the second derivatives are meaningless.
    pub smooth: bool,
    /// Whether f may vanish in the box. Zeros can be excluded even if the bounds have both signs, as those of 1/x.
    pub may_vanish: bool,
}

impl Enclosure {
    /// The enclosure that says nothing.
    pub const UNKNOWN: Self = Self {
        value: Interval::EVERYTHING,
        gradient: [Interval::EVERYTHING; 3],
        defined: false,
        continuous: false,
        smooth: false,
        may_vanish: true,
    };

    /// Value and gradient in the middle of their bounds. Of a single point these are all but exact.
    pub(crate) fn middle(&self) -> (f64, DVec3) {
        (self.value.middle(), DVec3::from_array(self.gradient.map(Interval::middle)))
    }

    /// The enclosure of a field that is defined nowhere in the box.
    pub const NOWHERE: Self = Self { value: Interval::NOTHING, may_vanish: false, ..Self::UNKNOWN };
}

/// A scalar field f with its derivatives; f < 0 inside the surface.
///
/// A batched method reads `points` and writes the first `points.len()` entries of each output. It takes `&mut self`
/// because an implementation keeps scratch memory, so that evaluation does not allocate once it is warm. The result at
/// a point does not depend on the other points of the batch, and it has the same bits natively and in WebAssembly. It
/// is NaN where the field is undefined.
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

    /// f, ∇f and ∇∇f at `p` in double precision: the reference for the batched methods, and what set-up, proofs and measurements use.
    fn jet(&mut self, p: DVec3) -> Jet;

    /// f and ∇f at each point in double precision, equal to those of [`Field::jet`] up to rounding.
    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (k, p) in points.iter().enumerate() {
            let jet = self.jet(p.as_dvec3());
            (value[k], gradient[k]) = (jet.value, jet.gradient);
        }
    }

    /// Makes the batched methods compute in double precision and give arsinh(f/s) for f, where s is `scale`, a positive number; or
    /// f again. [`Field::jet`] then gives f/s. It is for fields whose values or intermediate results are beyond single precision.
    /// The default implementation does nothing.
    fn use_double(&mut self, scale: Option<f64>) {
        let _ = scale;
    }

    /// This field as one that can bound its values over boxes, however wide the bounds are. Of a field that cannot, which is the
    /// default, the survey samples densely, and completeness is not proven.
    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        None
    }

    /// The point from which the points and boxes that the other methods take are counted, in the coordinates of the formula.
    fn origin(&self) -> DVec3 {
        DVec3::ZERO
    }

    /// The length after which f comes again along each axis: 0 if f does not change along it, none if it is not known to come
    /// again.
    fn periods(&self) -> [Option<f64>; 3] {
        [None; 3]
    }
}

/// A field that bounds its values and derivatives over boxes, rounded outward: what the proofs about its surface rest on.
///
/// Box `boxes[i]` belongs to `out[i]`.
pub trait Bounded: Field {
    /// Number of functions whose zeros together are those of f: the factors of a product, otherwise 1.
    fn factors(&mut self) -> usize {
        1
    }

    /// Bounds of factor `factor` of f and of its gradient over each box. What an enclosure says about being defined and continuous
    /// holds for f as a whole.
    ///
    /// # Panics
    ///
    /// If `factor` is not below [`Bounded::factors`], or `out` is shorter than `boxes`.
    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]);

    /// Bounds of the second derivatives of factor `factor` over each box. They are meaningless where f is undefined or its
    /// gradient jumps.
    ///
    /// # Panics
    ///
    /// Under the same conditions as [`Bounded::enclose`].
    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]);
}
