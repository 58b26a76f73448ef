//! Fields f(x, y, z) whose zero set is the surface.
//!
//! A [`Field`] gives values, gradients and Hessians for batches of points, exact ones at single points, if it is [`Bounded`]
//! bounds over boxes, and if it is [`Branched`] the smooth functions that f is made of. [`formula`] makes fields from text, [`gallery`]
//! holds named formulas, and [`rbf`] sums radial functions.

pub(crate) mod descent;
pub mod formula;
mod function;
pub mod gallery;
pub mod model;
pub mod rbf;
pub(crate) mod scaled;

pub use function::FnField;

use crate::math::{Bounds, Interval, Sym3};
use crate::slices::Work;
use core::ops::DerefMut;
use glam::{DVec3, Vec3};

/// Largest number of points in a call of a field: large enough to hide the cost of a call, and of decoding a formula,
/// small enough for the first-level cache. Where a formula is decoded for half as many, six runs on random surfaces take 0.4 to 1.7 % more
/// instructions, for a quarter 1.4 to 5.2 %. The result for a point does not depend on it.
pub(crate) const BATCH: usize = 128;

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
/// One method is required, [`Field::value_and_gradient`]. The others have defaults on top of it, which a field overrides where it can
/// do better: in single precision, many points at a time, with exact second derivatives, with [bounds](Field::bounded).
///
/// A batched method reads `points` and writes the first `points.len()` entries of each output. It takes `&mut self`
/// because an implementation keeps scratch memory, so that evaluation does not allocate once it is warm. The result at
/// a point does not depend on the other points of the batch, and it has the same bits natively and in WebAssembly. Its value
/// is NaN where the field is undefined.
///
/// # Panics
///
/// If an output is shorter than `points`.
///
/// # Example
///
/// ```
/// use marching_particles::glam::DVec3;
/// use marching_particles::{Field, Settings, sample};
///
/// struct Sphere;
///
/// impl Field for Sphere {
///     fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
///         (p.length_squared() - 1.0, 2.0 * p)
///     }
/// }
///
/// let sample = sample(Sphere, &Settings::with_count(500))?;
/// assert_eq!(sample.report().proof.components, 1);
/// # Ok::<(), marching_particles::Error>(())
/// ```
pub trait Field: Send {
    /// f and ∇f at `p` in double precision.
    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3);

    /// f, ∇f and ∇∇f at `p` in double precision, which set-up, proofs and measurements use. By default the second derivatives are
    /// central differences of the gradient.
    fn jet(&mut self, p: DVec3) -> Jet {
        jet_by_differences(self, p)
    }

    /// f at each point.
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        for (k, p) in points.iter().enumerate() {
            value[k] = self.value_and_gradient(p.as_dvec3()).0 as f32;
        }
    }

    /// f and ∇f at each point.
    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        for (k, p) in points.iter().enumerate() {
            let (exact, slope) = self.value_and_gradient(p.as_dvec3());
            (value[k], gradient[k]) = (exact as f32, slope.as_vec3());
        }
    }

    /// f, ∇f and ∇∇f at each point.
    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        for (k, p) in points.iter().enumerate() {
            let jet = self.jet(p.as_dvec3());
            (value[k], gradient[k]) = (jet.value as f32, jet.gradient.as_vec3());
            hessian[k] = jet.hessian.map(|entry| entry as f32);
        }
    }

    /// f and ∇f at each point in double precision.
    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (k, p) in points.iter().enumerate() {
            (value[k], gradient[k]) = self.value_and_gradient(p.as_dvec3());
        }
    }

    /// Makes the batched methods compute in double precision and give arsinh(f/s) for f, where s is `scale`, a positive number; or
    /// f again. [`Field::jet`], [`Field::value_and_gradient`] and [`Field::exact_gradients`] then give f/s. It is for fields whose values or
    /// intermediate results are beyond single precision. The default implementation does nothing.
    fn use_double(&mut self, scale: Option<f64>) {
        let _ = scale;
    }

    /// This field as one that can bound its values over boxes, however wide the bounds are. Of a field that cannot, which is the
    /// default, the survey samples densely, and completeness is not proven. A field that wraps another one has to pass this on.
    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        None
    }

    /// The point from which the points and boxes that the other methods take are counted, in the coordinates of the field as it was
    /// given.
    fn origin(&self) -> DVec3 {
        DVec3::ZERO
    }

    /// Counts points and boxes from `origin` from now on: single precision holds the places of particles that are far from zero only
    /// so. The default implementation keeps zero.
    fn set_origin(&mut self, origin: DVec3) {
        let _ = origin;
    }

    /// The equation of the same surface that is evaluated in the place of the one that was given, if there is one.
    #[doc(hidden)]
    fn sampled_as(&self) -> Option<String> {
        None
    }

    /// A sentence for the user on why f is the same everywhere, if it is known.
    #[doc(hidden)]
    fn why_constant(&self) -> Option<String> {
        None
    }

    /// This field as one whose surface may have creases. By default there is none: the field is smooth.
    #[doc(hidden)]
    fn branched(&mut self) -> Option<&mut dyn Branched> {
        None
    }

    /// The period of f along each axis: 0 if f does not change along it, none if f is not known to be periodic.
    fn periods(&self) -> [Option<f64>; 3] {
        [None; 3]
    }

    /// The box that closes the solid f ≤ 0 as a cell, counted from the origin of the field; none by default. What its opposite faces cut
    /// is the same along every axis that it repeats.
    fn unit_cell(&self) -> Option<UnitCell> {
        None
    }
}

/// A box whose faces close a solid, so that copies of it beside each other are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCell {
    /// The box.
    pub bounds: Bounds,
    /// For each axis, whether the surface without the faces repeats after the width of the box.
    pub repeats: [bool; 3],
}

/// Length of the steps of central differences at `p`: ∛ε of its largest coordinate, or of 1 if that is smaller. It is the best
/// compromise between the error of the formula, of order h², and that of rounding, of order ε/h (Press et al., "Numerical Recipes",
/// §5.7).
pub(crate) fn difference_step(p: DVec3) -> f64 {
    /// ∛ε of double precision, rounded to a power of two so that p ± h loses no digit of h.
    const STEP: f64 = 1.0 / 131_072.0;
    STEP * p.abs().max_element().max(1.0)
}

/// [`Field::jet`], with second derivatives that are central differences of the gradient.
pub(crate) fn jet_by_differences<F: Field + ?Sized>(field: &mut F, p: DVec3) -> Jet {
    let (value, gradient) = field.value_and_gradient(p);
    let h = difference_step(field.origin() + p);
    let [x, y, z] = DVec3::AXES.map(|axis| {
        let [ahead, behind] = [p + h * axis, p - h * axis].map(|q| field.value_and_gradient(q).1);
        (ahead - behind) / (2.0 * h)
    });
    let (xy, xz, yz) = (0.5 * (x.y + y.x), 0.5 * (x.z + z.x), 0.5 * (y.z + z.y));
    Jet { value, gradient, hessian: Sym3 { xx: x.x, xy, xz, yy: y.y, yz, zz: z.z } }
}

/// A pointer to a field is a field.
impl<P: DerefMut<Target: Field> + Send> Field for P {
    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        (**self).value_and_gradient(p)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        (**self).jet(p)
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        (**self).values(points, value);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        (**self).gradients(points, value, gradient);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        (**self).hessians(points, value, gradient, hessian);
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        (**self).exact_gradients(points, value, gradient);
    }

    fn use_double(&mut self, scale: Option<f64>) {
        (**self).use_double(scale);
    }

    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        (**self).bounded()
    }

    fn origin(&self) -> DVec3 {
        (**self).origin()
    }

    fn set_origin(&mut self, origin: DVec3) {
        (**self).set_origin(origin);
    }

    fn sampled_as(&self) -> Option<String> {
        (**self).sampled_as()
    }

    fn why_constant(&self) -> Option<String> {
        (**self).why_constant()
    }

    fn branched(&mut self) -> Option<&mut dyn Branched> {
        (**self).branched()
    }

    fn periods(&self) -> [Option<f64>; 3] {
        (**self).periods()
    }

    fn unit_cell(&self) -> Option<UnitCell> {
        (**self).unit_cell()
    }
}

/// A field that bounds its values and derivatives over boxes, rounded outward: what the proofs about its surface rest on.
///
/// Box `boxes[i]` belongs to `out[i]`.
pub trait Bounded: Field {
    /// Number of operations that an evaluation takes, by which work is shared out; 0 if it is not known.
    fn operations(&mut self) -> usize {
        0
    }

    /// Number of functions among whose zeros are those of f: the factors of a product, otherwise 1. Once
    /// [creases](Branched::crease_cells) were found, those of each branch.
    fn factors(&mut self) -> usize {
        1
    }

    /// Bounds of factor `factor` of f and of its gradient over each box. What an enclosure says about being defined and continuous
    /// holds for f as a whole. That of a branch is empty where the branch gives f nowhere in the box.
    ///
    /// # Panics
    ///
    /// If `factor` is not below [`Bounded::factors`], or `out` is shorter than `boxes`.
    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]);

    /// Whether a zero of factor `factor` is one of f: one of a branch is, where the branch gives f.
    fn is_zero_of(&mut self, factor: usize, zero: DVec3) -> bool {
        let _ = (factor, zero);
        true
    }

    /// Bounds of the second derivatives of factor `factor` over each box. They are meaningless where f is undefined or its
    /// gradient jumps.
    ///
    /// # Panics
    ///
    /// Under the same conditions as [`Bounded::enclose`].
    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]);
}

/// A field that is one of several smooth functions at each point, its *branches*. Where two of them meet, its surface may have a crease.
#[doc(hidden)]
pub trait Branched {
    /// Finds cells of the box, in slices, outside of which the surface has no crease: no wider than `width` but where that would take too
    /// long; no cell if there is no crease. Where numbers are new, no branch is selected once the work is done.
    fn crease_cells(&mut self, bounds: &Bounds, width: f64, numbers: BranchNumbers) -> Work<'_, Vec<Bounds>>;

    /// The number of the smooth branch that gives f at `p`: it says which operand every maximum, minimum and absolute value takes there
    /// on which f depends. Equal numbers are equal functions. Where f is smooth there is branch 0 alone.
    fn branch_at(&mut self, p: DVec3) -> u32;

    /// The branches that may give a point of the surface in the box, each once; none if they are more than can be listed.
    fn branches_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>>;

    /// Makes every evaluation of values and derivatives one of the smooth function of `branch`, wherever that gives f or not; or of f
    /// again. The numbers are those of [`Branched::branch_at`]; bounds over boxes stay those of f.
    fn select_branch(&mut self, branch: Option<u32>);
}

/// Sine of the angle between two branches from which on they make a crease: one degree, less than light and shadow show. Half and double
/// give the same particles on 24 random solids.
pub(crate) const SHARP: f64 = 0.0175;

/// A search for creases numbers the branches anew, or keeps their numbers.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchNumbers {
    /// The branches are numbered anew, and those that meet smoothly on the surface become one.
    New,
    /// The branches keep their numbers, which an earlier search in another box has given.
    Kept,
}

impl dyn Field + '_ {
    /// [`Branched::branch_at`], or 0 in a smooth field.
    pub(crate) fn branch_at(&mut self, p: DVec3) -> u32 {
        self.branched().map_or(0, |field| field.branch_at(p))
    }

    /// [`Branched::select_branch`], if there are branches.
    pub(crate) fn select_branch(&mut self, branch: Option<u32>) {
        if let Some(field) = self.branched() {
            field.select_branch(branch);
        }
    }
}
