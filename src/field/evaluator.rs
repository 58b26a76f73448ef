//! How a field is evaluated: batches of points in single precision, single points in double,
//! relative to a near origin.

use super::{BATCH, Enclosure, Field, Jet, STEP};
use crate::math::{Bounds, Interval, Sym3, median, power_of_two};
use glam::{DVec3, Vec3};

/// Gradients from the inverse of this to this need no scale. The square of such a gradient, and of
/// a value a million times smaller or larger, is a normal number in single precision.
const COMFORTABLE: f64 = (1_u64 << 40) as f64;

/// The origin of an [`Evaluator`]'s places, and the scale that keeps values in the range of the
/// numbers they are computed with.
///
/// The default has origin zero and leaves f as it is. A survey of the surface chooses one for a
/// whole run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point that places and boxes are relative to, in the coordinates of the field: only so
    /// does single precision resolve particles that are far from zero.
    pub origin: DVec3,
    /// A power of two that multiplies f. With the right one, squares of values and gradients
    /// neither overflow nor underflow in single precision, whatever units f is in. No digit is
    /// lost.
    pub scale: f32,
    /// The s of arsinh(f/s), which batches give instead of f, computed in double precision; none
    /// for f itself. Single points then give f/s. It is for fields whose values or intermediate
    /// results exceed single precision: arsinh(f/s) has the zeros and signs of f, is about f/s near
    /// the surface, and grows like a logarithm far from it.
    pub double: Option<f64>,
    /// The length scale, which the steps of differences are small against: in a run the diagonal of
    /// the box.
    pub length: f64,
}

impl Default for Frame {
    fn default() -> Self {
        Self { origin: DVec3::ZERO, scale: 1.0, double: None, length: 1.0 }
    }
}

impl Frame {
    /// The frame with this `origin`, and f as it is.
    #[must_use]
    pub fn around(origin: DVec3) -> Self {
        Self { origin, ..Self::default() }
    }

    /// The default frame, for differences in a box.
    pub(crate) fn for_box(bounds: &Bounds) -> Self {
        Self { length: bounds.diagonal(), ..Self::default() }
    }

    /// This frame with the power of two that brings the median magnitude of the gradient near 1, or
    /// with 1 if no scale is needed. The gradient is sampled at most at one batch of `points`: only
    /// the exponent of the median matters, so nearly all choices of points give the same scale.
    pub(crate) fn scaled_to(self, field: &dyn Field, points: impl ExactSizeIterator<Item = Vec3>) -> Self {
        let stride = points.len().div_ceil(BATCH).max(1);
        let points: Vec<Vec3> = points.step_by(stride).collect();
        let (mut value, mut gradient) = (vec![0.0; points.len()], vec![Vec3::ZERO; points.len()]);
        field.evaluator(Self { scale: 1.0, ..self }).gradients(&points, &mut value, &mut gradient);
        let sizes = gradient.iter().map(|g| g.abs().max_element()).filter(|s| s.is_finite() && *s > 0.0);
        let size = median(sizes.collect()).map_or(1.0, |size| power_of_two(size.into()));
        let scale = if (1.0 / COMFORTABLE..=COMFORTABLE).contains(&size) { 1.0 } else { 1.0 / size };
        Self { scale: scale.clamp(f32::MIN_POSITIVE.into(), (1.0 / f32::MIN_POSITIVE).into()) as f32, ..self }
    }

    /// A place of the frame, in the coordinates of the field.
    #[must_use]
    pub fn place(&self, p: DVec3) -> DVec3 {
        // Adding 0 would take the sign off −0, to the other side of a jump.
        if self.origin == DVec3::ZERO { p } else { self.origin + p }
    }

    /// A box in the coordinates of the field that contains this box of the frame.
    #[must_use]
    pub fn outward(&self, bounds: &Bounds) -> Bounds {
        if self.origin == DVec3::ZERO {
            return *bounds;
        }
        let [lo, hi] = [bounds.lo(), bounds.hi()].map(|corner| (self.origin + corner).to_array());
        Bounds { min: lo.map(f64::next_down), max: hi.map(f64::next_up) }
    }

    /// Whether batches are computed in double precision: the coordinates of the field may have more
    /// digits than single precision holds.
    #[must_use]
    pub fn is_double(&self) -> bool {
        self.double.is_some() || self.origin != DVec3::ZERO
    }

    /// Length of the steps of differences at a point in the coordinates of the field: a 131,072nd
    /// of the length, but far above the rounding of the point. It is a power of two, so that p ± h
    /// loses no digit of h.
    pub(super) fn step(&self, p: DVec3) -> f64 {
        /// √ε of double precision.
        const ROUNDING: f64 = 1.0 / 67_108_864.0;
        let size = p.abs().max_element();
        let least = if size.is_normal() { ROUNDING * power_of_two(size) } else { 0.0 };
        least.max(STEP * power_of_two(self.length))
    }

    /// f and ∇f in the form for single points.
    #[must_use]
    pub fn exact(&self, (value, gradient): (f64, DVec3)) -> (f64, DVec3) {
        let (s, scale) = (self.double.unwrap_or(1.0), f64::from(self.scale));
        (value / s * scale, gradient / s * scale)
    }

    /// f, ∇f and ∇∇f in the form for single points.
    #[must_use]
    pub fn jet(&self, jet: Jet) -> Jet {
        let (s, scale) = (self.double.unwrap_or(1.0), f64::from(self.scale));
        let (value, gradient) = self.exact((jet.value, jet.gradient));
        Jet { value, gradient, hessian: jet.hessian.map(|entry| entry / s * scale) }
    }

    /// f in the form for batches, from its value in double precision.
    #[must_use]
    pub fn value(&self, f: f64) -> f32 {
        self.double.map_or(f, |s| libm::asinh(f / s)) as f32 * self.scale
    }

    /// f and ∇f in the form for batches; not finite where f is not.
    #[must_use]
    pub fn gradient(&self, (f, gradient): (f64, DVec3)) -> (f32, Vec3) {
        // d/df arsinh(f/s) = 1/√(s² + f²)
        let size = self.double.map_or(1.0, |s| libm::hypot(s, f));
        (self.value(f), (gradient / size).as_vec3() * self.scale)
    }

    /// f, ∇f and ∇∇f in the form for batches; not finite where f is not.
    #[must_use]
    pub fn hessian(&self, jet: &Jet) -> (f32, Vec3, Sym3<f32>) {
        let (value, slope) = self.gradient((jet.value, jet.gradient));
        let h = &jet.hessian;
        let Some(s) = self.double else {
            return (value, slope, h.map(|entry| entry as f32 * self.scale));
        };
        // The second derivative of arsinh(f/s) is −f/√(s² + f²)³.
        let size = libm::hypot(s, jet.value);
        let (g, bend) = (jet.gradient / size, -jet.value / size);
        let second = |h: f64, a: f64, b: f64| (h / size + bend * a * b) as f32 * self.scale;
        let hessian = Sym3 {
            xx: second(h.xx, g.x, g.x),
            xy: second(h.xy, g.x, g.y),
            xz: second(h.xz, g.x, g.z),
            yy: second(h.yy, g.y, g.y),
            yz: second(h.yz, g.y, g.z),
            zz: second(h.zz, g.z, g.z),
        };
        (value, slope, hessian)
    }

    /// Scales bounds of f and ∇f.
    pub(crate) fn scale_bounds(&self, known: &mut [Enclosure]) {
        if self.scale != 1.0 {
            let scale = f64::from(self.scale);
            for known in known {
                known.value = known.value * scale;
                known.gradient = known.gradient.map(|slope| slope * scale);
            }
        }
    }

    /// Scales bounds of ∇∇f.
    pub(crate) fn scale_second(&self, known: &mut [Sym3<Interval>]) {
        if self.scale != 1.0 {
            for known in known {
                *known = known.map(|bounds| bounds * f64::from(self.scale));
            }
        }
    }
}

/// Evaluates a field in a [`Frame`], with the memory for it: what the sampler calls.
///
/// A batched method reads `points` and writes the first `points.len()` entries of each output.
/// Evaluation does not allocate once it is warm. The result at a point does not depend on the other
/// points of the batch, and it has the same bits natively and in WebAssembly. A value is NaN where
/// the field is undefined.
///
/// # Panics
///
/// If an output is shorter than `points`.
pub trait Evaluator: super::MaybeSend + super::MaybeSync {
    /// The frame of its places and values.
    fn frame(&self) -> Frame;

    /// Another evaluator of the same function or branch, in the same frame, with its own memory:
    /// each measuring thread has one. It gives the same bits.
    fn another(&self) -> Box<dyn Evaluator + '_>;

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

    /// f and ∇f at `p` in double precision.
    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3);

    /// f, ∇f and ∇∇f at `p` in double precision, which set-up, proofs and measurements use.
    fn jet(&mut self, p: DVec3) -> Jet;

    /// Lets [`values`](Evaluator::values), [`gradients`](Evaluator::gradients) and
    /// [`hessians`](Evaluator::hessians) continue f smoothly beyond the border of its domain, if
    /// the field can. The box of a run may end at that border, and fronts grow beyond the box.
    fn continue_beyond(&mut self) {}

    /// f and ∇f at each point in double precision.
    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (k, p) in points.iter().enumerate() {
            (value[k], gradient[k]) = self.value_and_gradient(p.as_dvec3());
        }
    }

    /// This evaluator as one that can bound f over boxes, however wide the bounds. A field without
    /// bounds, the default, is surveyed densely, and completeness is not proven.
    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        None
    }

    /// This evaluator as one of a function made of smooth [pieces](Pieces). By default it has none.
    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        None
    }
}

/// An evaluator that bounds values and derivatives over boxes, rounded outward: the basis of proofs
/// about a surface.
///
/// Box `boxes[i]` belongs to `out[i]`.
pub trait Bounded: Evaluator {
    /// Number of operations of an evaluation, used to share out work; 0 if unknown.
    fn operations(&self) -> usize {
        0
    }

    /// Number of functions whose zeros include those of f: the factors of a product, otherwise 1.
    /// If f has creases, the factors of each patch count; if a choice keeps sheets of a surface
    /// without creases apart, those of each sheet.
    fn factors(&self) -> usize {
        1
    }

    /// Bounds of factor `factor` of f and of its gradient over each box. In an enclosure, being
    /// defined and continuous refers to f as a whole. The enclosure of a patch or sheet is empty
    /// where it does not give f anywhere in the box.
    ///
    /// # Panics
    ///
    /// If `factor` is not below [`Bounded::factors`], or `out` is shorter than `boxes`.
    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]);

    /// Whether factor `factor` gives f at `p`: if f has creases or separate sheets, whether its
    /// patch or sheet gives f there.
    fn gives(&mut self, factor: usize, p: DVec3) -> bool {
        let _ = (factor, p);
        true
    }

    /// Bounds of the second derivatives of factor `factor` over each box. They are meaningless
    /// where f is undefined or its gradient jumps.
    ///
    /// # Panics
    ///
    /// Under the same conditions as [`Bounded::enclose`].
    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]);

    /// The factor's number that stands for f as a whole in [`Bounded::enclose`] and
    /// [`Bounded::gives`], if f has edges and [`Bounded::pieces_in`] knows its pieces; by default
    /// none.
    fn edged(&mut self) -> Option<usize> {
        None
    }

    /// Replaces `out` by the bounds of each smooth piece of f that may be zero in a box and give f
    /// there, and then those of each in the middle of the box; returns whether these are all. Where
    /// all pieces rise along a direction, f rises along it at each of its zeros in the box. Being
    /// defined and continuous refers to f as a whole.
    fn pieces_in(&mut self, bounds: &Bounds, out: &mut Vec<Enclosure>) -> bool {
        let _ = (bounds, out);
        false
    }

    /// Number of parts in which the field names the [cells](Bounded::cells) of a factor where the
    /// search for components begins; 0, the default, if it begins with the box of the run. For
    /// fields that know where their surface is, such as an image with many voxels: a search that
    /// begins with the box may have to open all of them.
    fn parts(&mut self, factor: usize) -> usize {
        let _ = factor;
        0
    }

    /// Adds boxes in the box `within`, whose sides may have no length. Each zero of the factor in
    /// `within` at which its derivatives along all axes `sides` vanish must be in a box of a part,
    /// and so must each place where the surface ends because f is undefined beyond. As few other
    /// zeros as possible should be.
    fn cells(&mut self, factor: usize, part: usize, within: &Bounds, sides: &[usize], out: &mut Vec<Bounds>) {
        let _ = (factor, part, within, sides, out);
    }
}

/// An evaluator of a function that is one of several smooth functions at each point, its *pieces*:
/// max(a, b) is a here and b there. Where two of them meet, the surface may have an edge, a
/// *crease*. The part of the surface on which one piece gives f is a *patch*.
///
/// A piece has a label. Equal labels mean equal functions, whatever was called before. Places and
/// boxes are relative to the [frame](Evaluator::frame).
///
/// Formulas with maxima, minima and absolute values, and [combined](crate::union) solids, know
/// their pieces; [`PiecewiseFn`](crate::field::PiecewiseFn) takes them from functions of the
/// program; for other functions they are found in the values of f.
pub trait Pieces {
    /// The label of the piece that gives f at `p`; 0 where f is smooth everywhere.
    fn label(&mut self, p: DVec3) -> u32;

    /// The evaluator of a piece, even where another one gives f. It has the bounds of the piece,
    /// but the pieces of f.
    ///
    /// # Panics
    ///
    /// May panic if there is no such piece.
    fn piece(&mut self, label: u32) -> &mut dyn Evaluator;

    /// The labels of the pieces that may give a point of the surface in a box, each once; none if
    /// there are too many to list.
    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>>;

    /// Cells of a box in which a search for edges can begin: each edge in the box has a point in or
    /// next to one of them. They are no wider than `width`, unless that would take too long.
    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds>;

    /// Pairs of patches that meet without an edge somewhere and yet are not one patch, since they
    /// or their neighbours meet at an angle elsewhere; the smaller label first.
    fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        Vec::new()
    }

    /// Whether there are pieces that [limit](Pieces::is_limit) the surface.
    fn has_limits(&mut self) -> bool {
        false
    }

    /// Whether the zeros of a piece limit the surface without being part of it: it ends at them.
    fn is_limit(&mut self, label: u32) -> bool {
        let _ = label;
        false
    }
}

impl<'a> dyn Evaluator + 'a {
    /// [`Pieces::label`]; 0 for a smooth function.
    #[doc(hidden)]
    pub fn label(&mut self, p: DVec3) -> u32 {
        self.pieces().map_or(0, |patches| patches.label(p))
    }

    /// The evaluator of the smooth function of a patch; f itself if there is no patch.
    #[doc(hidden)]
    pub fn on(&mut self, patch: Option<u32>) -> &mut dyn Evaluator {
        match patch {
            Some(patch) => self.pieces().expect("a surface with patches").piece(patch),
            None => self,
        }
    }

    /// [`Pieces::has_limits`]; a smooth function has none.
    pub(crate) fn has_limits(&mut self) -> bool {
        self.pieces().is_some_and(|patches| patches.has_limits())
    }

    /// [`Pieces::is_limit`].
    pub(crate) fn is_limit(&mut self, branch: u32) -> bool {
        self.pieces().is_some_and(|patches| patches.is_limit(branch))
    }

    /// Whether a zero of f is no point of the surface, because it belongs to a limiting branch.
    pub(crate) fn is_beyond_limits(&mut self, p: DVec3) -> bool {
        self.has_limits() && {
            let branch = self.label(p);
            self.is_limit(branch)
        }
    }

    /// [`Pieces::tangent_pairs`]; empty for a smooth function.
    pub(crate) fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        self.pieces().map_or_else(Vec::new, |patches| patches.tangent_pairs())
    }

    /// [`Pieces::labels_in`]; none for a smooth function.
    #[doc(hidden)]
    pub fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        self.pieces().and_then(|patches| patches.labels_in(bounds))
    }
}

/// Evaluates a field by its own methods, one point at a time.
pub(super) struct Pointwise<'a, F: ?Sized> {
    pub(super) field: &'a F,
    pub(super) frame: Frame,
}

impl<F: Field + ?Sized> Evaluator for Pointwise<'_, F> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(Pointwise { field: self.field, frame: self.frame })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        for (k, p) in points.iter().enumerate() {
            value[k] = self.frame.value(self.field.value(self.frame.place(p.as_dvec3())));
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        for (k, p) in points.iter().enumerate() {
            let exact = self.field.value_and_gradient(self.frame.place(p.as_dvec3()));
            (value[k], gradient[k]) = self.frame.gradient(exact);
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        for (k, p) in points.iter().enumerate() {
            let jet = self.field.jet(self.frame.place(p.as_dvec3()));
            (value[k], gradient[k], hessian[k]) = self.frame.hessian(&jet);
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.frame.exact(self.field.value_and_gradient(self.frame.place(p)))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.frame.jet(self.field.jet(self.frame.place(p)))
    }
}
