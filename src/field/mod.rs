//! Fields f(x, y, z) whose zero set is the surface.
//!
//! A [`Field`] is a function that does not change. Its [`Evaluator`] has the memory to evaluate
//! batches of points, and if it is [`Bounded`] it bounds f over boxes. [`formula`] makes fields
//! from text, and [`gallery`] holds named formulas. [`FnField`], [`BatchField`], [`PiecewiseFn`]
//! and [`BatchPiecewise`] take functions of the program.

mod combined;
pub(crate) mod crossing;
pub(crate) mod descent;
mod differences;
pub(crate) mod edges;
mod evaluator;
pub mod formula;
mod function;
pub mod gallery;
mod given;
#[doc(hidden)]
pub mod model;
mod piecewise;
#[doc(hidden)]
pub mod rbf;

pub use crate::math::{Interval, Sym3};
pub use crate::slices::{MaybeSend, MaybeSync};
pub use combined::{Combined, difference, intersection, offset, smooth_union, union};
pub use evaluator::{Bounded, Evaluator, Frame, Pieces};
pub use formula::Value;
pub use function::{BatchField, FnField};
pub use given::{FieldError, IntoField, IntoFields, SharedError, kind};
pub use piecewise::{BatchPiecewise, PiecewiseFn};

use evaluator::Pointwise;
use formula::Formula;

use crate::math::Bounds;
use crate::slices::Work;
use core::any::Any;
use core::ops::Deref;
use glam::DVec3;
use std::sync::Arc;

/// Largest number of points in a call of a field: large enough to hide the cost of a call, and of
/// decoding a formula, small enough for the first-level cache. The result for a point does not
/// depend on it.
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
    /// Whether the gradient is certainly continuous. Where it jumps, bounds of the second
    /// derivatives are meaningless.
    pub smooth: bool,
    /// Whether f may vanish in the box. Zeros can be excluded even if the bounds have both signs,
    /// as for 1/x.
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

    /// Value and gradient in the middle of their bounds. For a single point these are nearly exact.
    pub(crate) fn middle(&self) -> (f64, DVec3) {
        (self.value.middle(), DVec3::from_array(self.gradient.map(Interval::middle)))
    }

    /// Intersects bounds over a box with the mean value forms around its middle, from those there
    /// and those of the second derivatives over the box; `half` is half its size.
    pub(crate) fn tighten(&mut self, middle: &Self, second: &Sym3<Interval>, half: DVec3) {
        if !(self.defined && self.continuous) {
            return;
        }
        let swing = |slope: &dyn Fn(usize) -> Interval| -> f64 {
            (0..3).filter(|&k| half[k] > 0.0).map(|k| slope(k).magnitude() * half[k]).sum()
        };
        for axis in (0..3).filter(|_| self.smooth) {
            let form = middle.gradient[axis].mean_value(swing(&|k| second.at(axis, k)));
            self.gradient[axis] = self.gradient[axis].cut_to(form);
        }
        let form = middle.value.mean_value(swing(&|k| self.gradient[k]));
        self.value = self.value.cut_to(form);
    }

    /// The enclosure of a field that is defined nowhere in the box.
    pub const NOWHERE: Self = Self { value: Interval::NOTHING, may_vanish: false, ..Self::UNKNOWN };
}

/// A scalar field f with its derivatives; f < 0 inside the surface.
///
/// A field is a function: it does not change, so it can be shared between runs, threads and
/// measurements. One method is required, [`Field::value_and_gradient`]. The sampler calls a field
/// through an [`Evaluator`], which has the memory for it; a field that can do better than one point
/// at a time, in double precision and without bounds, provides its own evaluator.
///
/// f is NaN where it is undefined. Repeated evaluations give the same bits.
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
///     fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
///         (p.length_squared() - 1.0, 2.0 * p)
///     }
/// }
///
/// let sample = sample(Sphere, &Settings::with_count(500))?;
/// assert_eq!(sample.report().proof.components, 1);
/// # Ok::<(), marching_particles::Error>(())
/// ```
pub trait Field: MaybeSend + MaybeSync {
    /// f and ∇f at `p`.
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3);

    /// f at `p`, for fields that compute it faster than with the gradient.
    fn value(&self, p: DVec3) -> f64 {
        self.value_and_gradient(p).0
    }

    /// Writes f at each point, for fields that are evaluated at many points at a time.
    ///
    /// # Panics
    ///
    /// If `f` is shorter than `points`.
    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        points.iter().zip(f).for_each(|(&p, f)| *f = self.value(p));
    }

    /// f, ∇f and ∇∇f at `p`. By default the second derivatives are central differences of the
    /// gradient.
    fn jet(&self, p: DVec3) -> Jet {
        jet_by_differences(self, p)
    }

    /// An evaluator of the field in `frame`. A field that wraps another one passes this on. By
    /// default it calls the methods above, one point at a time.
    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(Pointwise { field: self, frame })
    }

    /// Returns the field's own facts: periods, a cell, the equation that is sampled.
    fn facts(&self) -> Facts {
        Facts::default()
    }

    /// The points at which functions of the program were evaluated so far, for values and
    /// gradients; none without such functions, or if they are not counted.
    fn calls(&self) -> Option<u64> {
        None
    }

    /// Why the field has no values any more, if a function of the program has failed. A run then
    /// ends with this error.
    fn failure(&self) -> Option<FieldError> {
        None
    }

    /// This field as one that finds the places where its [pieces](Pieces) meet. For a field whose
    /// evaluator knows its pieces, the library searches where labels change; in any other field it
    /// searches the values for edges.
    #[doc(hidden)]
    fn piecewise(&self) -> Option<&dyn Piecewise> {
        None
    }

    /// Whether f is known to be smooth everywhere. Otherwise its values are searched for edges.
    #[doc(hidden)]
    fn is_smooth(&self) -> bool {
        false
    }

    /// Values that the field gives to its particles, with the names of their columns: the colours
    /// of a mesh or of a formula.
    #[doc(hidden)]
    fn columns(&self) -> Vec<(&'static str, Value)> {
        Vec::new()
    }

    /// The field that replaces this one as an operand of a [combination](union), if any: the
    /// function without what ends its surface.
    #[doc(hidden)]
    fn operand(&self) -> Option<Arc<dyn Field>> {
        None
    }

    /// The formula, if the field is one by itself: the records of files name it.
    #[doc(hidden)]
    fn formula(&self) -> Option<&Formula> {
        None
    }
}

/// Facts about a field that its values do not show.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Facts {
    /// The period of f along each axis: 0 if f does not change along it, none if f is not known to
    /// be periodic.
    pub periods: [Option<f64>; 3],
    /// The box that closes the solid f ≤ 0 as a cell. Its opposite faces cut the surface equally
    /// along every axis that it repeats.
    pub unit_cell: Option<UnitCell>,
    /// The equivalent equation that is evaluated instead of the given one, if any.
    pub sampled_as: Option<String>,
    /// The faces of a solid, as equations, that a cutter leaves flush: the rest of them has no
    /// thickness and is not part of the surface.
    pub flush_faces: Vec<String>,
    /// Names that the field defines, and that nothing in it uses.
    pub unused: Vec<String>,
    /// A sentence for the user on why f is the same everywhere, if it is known.
    pub why_constant: Option<String>,
    /// A box that contains the whole surface, if the field knows one. The box of a run is fitted to
    /// it, and the surface is not searched for elsewhere.
    pub within: Option<Within>,
    /// The box in which f is known, such as an image's, if it is not known everywhere.
    pub domain: Option<Bounds>,
    /// The distance between the values that f is interpolated from, such as the voxels of an image,
    /// if it is. Finer details are unknown.
    pub resolution: Option<f64>,
    /// Cells along the longest side of the box of the grid on which edges were found in the values
    /// of f, if any were; of several grids the coarsest.
    pub edge_cells: Option<u32>,
}

/// A box that contains the whole surface of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within {
    /// The box.
    pub bounds: Bounds,
    /// Whether the surface would continue through faces of the box, as an image's does at its
    /// border. A run then takes the box as it is; otherwise it leaves room around it.
    pub is_cut: bool,
}

/// A field that finds the places where its [pieces](Pieces) meet.
#[doc(hidden)]
pub trait Piecewise: Field + Any {
    /// Finds, in slices, cells of a box that contain all places where pieces meet at an angle on
    /// the surface: no wider than `width`, unless that would take too long; empty if none meet.
    /// Also returns the field, to evaluate from then on, in which pieces that meet smoothly on the
    /// surface in the box are one. Where parts of the field are known by their values alone, edges
    /// are searched on a grid with `cells` along the longest side of the box.
    fn pieces_in<'a>(
        &'a self,
        bounds: &Bounds,
        width: f64,
        cells: u32,
    ) -> Work<'a, (Vec<Bounds>, Arc<dyn Piecewise>)>;

    /// This field with the pieces of another one, [found](Piecewise::pieces_in) before, if it is
    /// the same function with other parameters; otherwise with its own.
    fn with_pieces_of(&self, other: &dyn Piecewise) -> Arc<dyn Piecewise>;

    /// The field f − shift, or −f − shift, with its pieces.
    fn turned(&self, is_negative: bool, shift: f64) -> Arc<dyn Field>;
}

/// A box whose faces close a solid, so that adjacent copies of it join.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCell {
    /// The box.
    pub bounds: Bounds,
    /// For each axis, whether the surface without the faces repeats after the width of the box.
    pub repeats: [bool; 3],
}

impl UnitCell {
    /// The cell with its places relative to `origin`.
    #[must_use]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        Self { bounds: self.bounds.relative_to(origin), ..*self }
    }
}

/// ∛ε of double precision, rounded to a power of two so that p ± h loses no digit of h.
const STEP: f64 = 1.0 / 131_072.0;

/// Length of the steps of central differences at `p`: ∛ε of its largest coordinate, or of 1 if that
/// is smaller. It balances the truncation error, of order h², and the rounding error, of order ε/h
/// (Press et al., "Numerical Recipes", §5.7).
pub(crate) fn difference_step(p: DVec3) -> f64 {
    STEP * p.abs().max_element().max(1.0)
}

/// [`Field::jet`], with second derivatives that are central differences of the gradient.
fn jet_by_differences<F: Field + ?Sized>(field: &F, p: DVec3) -> Jet {
    let h = difference_step(p);
    let (value, gradient) = field.value_and_gradient(p);
    let [x, y, z] = DVec3::AXES.map(|axis| {
        let [ahead, behind] = [p + h * axis, p - h * axis].map(|q| field.value_and_gradient(q).1);
        (ahead - behind) / (2.0 * h)
    });
    jet_of_slopes(value, gradient, [x, y, z])
}

/// The jet with these derivatives of the gradient along the axes, made symmetric: rounding leaves
/// them slightly asymmetric.
fn jet_of_slopes(value: f64, gradient: DVec3, [x, y, z]: [DVec3; 3]) -> Jet {
    let (xy, xz, yz) = (0.5 * (x.y + y.x), 0.5 * (x.z + z.x), 0.5 * (y.z + z.y));
    Jet { value, gradient, hessian: Sym3 { xx: x.x, xy, xz, yy: y.y, yz, zz: z.z } }
}

/// A pointer to a field is a field.
impl<P: Deref<Target: Field> + MaybeSend + MaybeSync> Field for P {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        (**self).value_and_gradient(p)
    }

    fn value(&self, p: DVec3) -> f64 {
        (**self).value(p)
    }

    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        (**self).values(points, f);
    }

    fn jet(&self, p: DVec3) -> Jet {
        (**self).jet(p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        (**self).evaluator(frame)
    }

    fn facts(&self) -> Facts {
        (**self).facts()
    }

    fn calls(&self) -> Option<u64> {
        (**self).calls()
    }

    fn failure(&self) -> Option<FieldError> {
        (**self).failure()
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        (**self).piecewise()
    }

    fn is_smooth(&self) -> bool {
        (**self).is_smooth()
    }

    fn columns(&self) -> Vec<(&'static str, Value)> {
        (**self).columns()
    }

    fn operand(&self) -> Option<Arc<dyn Field>> {
        (**self).operand()
    }

    fn formula(&self) -> Option<&Formula> {
        (**self).formula()
    }
}

/// Share of a box's longest side by which the box is enlarged for proofs about the surface in it,
/// so that a surface that touches it from inside is inside.
pub(crate) const MARGIN: f64 = 1.0 / 65_536.0;
