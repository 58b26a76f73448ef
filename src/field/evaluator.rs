//! Who evaluates a field: batches of points in single precision, single ones in double, counted
//! from a near origin.

use super::{BATCH, Enclosure, Field, Jet, STEP};
use crate::math::{Bounds, Interval, Sym3, median, power_of_two};
use glam::{DVec3, Vec3};

/// Largest gradient that needs no scale, and the inverse of the smallest. The square of such a
/// gradient, and of a value a million times smaller or larger, is a normal number in single
/// precision.
const COMFORTABLE: f64 = (1_u64 << 40) as f64;

/// How an [`Evaluator`] counts places and brings values within reach of the numbers that they are
/// computed with.
///
/// The default counts from zero and takes f as it is. A survey of the surface chooses one for a
/// whole run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point from which places and boxes are counted, in the coordinates of the field: single
    /// precision holds the places of particles that are far from zero only so.
    pub origin: DVec3,
    /// A power of two by which f is multiplied. With the right one, squares of values and gradients
    /// neither overflow nor underflow in single precision, whatever units f is in. No digit is
    /// lost.
    pub scale: f32,
    /// The s of arsinh(f/s), which batches give for f, computed in double precision; none for f
    /// itself. Single points are then evaluated to f/s. It is for fields whose values or
    /// intermediate results are beyond single precision: arsinh(f/s) has the zeros and signs of f,
    /// is f/s near the surface, and grows like a logarithm far from it.
    pub double: Option<f64>,
    /// The length of what is looked at, to which the steps of differences are small: the diagonal
    /// of the box in a run.
    pub length: f64,
}

impl Default for Frame {
    fn default() -> Self {
        Self { origin: DVec3::ZERO, scale: 1.0, double: None, length: 1.0 }
    }
}

impl Frame {
    /// The frame that counts from `origin`, with f as it is.
    #[must_use]
    pub fn around(origin: DVec3) -> Self {
        Self { origin, ..Self::default() }
    }

    /// The default frame, for differences in a box.
    pub(crate) fn for_box(bounds: &Bounds) -> Self {
        Self { length: bounds.diagonal(), ..Self::default() }
    }

    /// This frame with the power of two that brings the median magnitude of the gradient near 1, or
    /// with 1 if that is not needed. The gradient is sampled at no more than one batch of `points`:
    /// because only the exponent of the median counts, nearly all choices of points give the same
    /// scale.
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

    /// A box in the coordinates of the field that holds this box of the frame.
    #[must_use]
    pub fn outward(&self, bounds: &Bounds) -> Bounds {
        if self.origin == DVec3::ZERO {
            return *bounds;
        }
        let [lo, hi] = [bounds.lo(), bounds.hi()].map(|corner| (self.origin + corner).to_array());
        Bounds { min: lo.map(f64::next_down), max: hi.map(f64::next_up) }
    }

    /// Whether batches are to be computed in double precision: the coordinates of the field may
    /// have more digits than single precision holds.
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

    /// f and ∇f as they are given for single points.
    #[must_use]
    pub fn exact(&self, (value, gradient): (f64, DVec3)) -> (f64, DVec3) {
        let (s, scale) = (self.double.unwrap_or(1.0), f64::from(self.scale));
        (value / s * scale, gradient / s * scale)
    }

    /// f, ∇f and ∇∇f as they are given for single points.
    #[must_use]
    pub fn jet(&self, jet: Jet) -> Jet {
        let (s, scale) = (self.double.unwrap_or(1.0), f64::from(self.scale));
        let (value, gradient) = self.exact((jet.value, jet.gradient));
        Jet { value, gradient, hessian: jet.hessian.map(|entry| entry / s * scale) }
    }

    /// f as it is given in batches, from its value in double precision.
    #[must_use]
    pub fn value(&self, f: f64) -> f32 {
        self.double.map_or(f, |s| libm::asinh(f / s)) as f32 * self.scale
    }

    /// f and ∇f as they are given in batches; not finite where f is not.
    #[must_use]
    pub fn gradient(&self, (f, gradient): (f64, DVec3)) -> (f32, Vec3) {
        // d/df arsinh(f/s) = 1/√(s² + f²)
        let size = self.double.map_or(1.0, |s| libm::hypot(s, f));
        (self.value(f), (gradient / size).as_vec3() * self.scale)
    }

    /// f, ∇f and ∇∇f as they are given in batches; not finite where f is not.
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

    /// Multiplies the bounds of f and ∇f.
    pub(crate) fn scale_bounds(&self, known: &mut [Enclosure]) {
        if self.scale != 1.0 {
            let scale = f64::from(self.scale);
            for known in known {
                known.value = known.value * scale;
                known.gradient = known.gradient.map(|slope| slope * scale);
            }
        }
    }

    /// Multiplies the bounds of ∇∇f.
    pub(crate) fn scale_second(&self, known: &mut [Sym3<Interval>]) {
        if self.scale != 1.0 {
            for known in known {
                *known = known.map(|bounds| bounds * f64::from(self.scale));
            }
        }
    }
}

/// A field at work in a [`Frame`], with the memory that this takes: what the sampler calls.
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
    /// The frame in which places are counted and values are given.
    fn frame(&self) -> Frame;

    /// Another evaluator of the same function, or of the same branch of it, in the same frame, with
    /// memory of its own: threads that measure have one each. It gives the same bits.
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

    /// f and ∇f at each point in double precision.
    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (k, p) in points.iter().enumerate() {
            (value[k], gradient[k]) = self.value_and_gradient(p.as_dvec3());
        }
    }

    /// This evaluator as one that can bound f over boxes, however wide the bounds are. Of a field
    /// that cannot, which is the default, the survey samples densely, and completeness is not
    /// proven.
    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        None
    }

    /// This evaluator as one of a function that is put together of smooth [pieces](Pieces). By
    /// default it tells of none.
    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        None
    }
}

/// An evaluator that bounds values and derivatives over boxes, rounded outward: what the proofs
/// about a surface rest on.
///
/// Box `boxes[i]` belongs to `out[i]`.
pub trait Bounded: Evaluator {
    /// Number of operations that an evaluation takes, by which work is shared out; 0 if it is not
    /// known.
    fn operations(&self) -> usize {
        0
    }

    /// Number of functions among whose zeros are those of f: the factors of a product, otherwise 1.
    /// Where f has creases, those of each of its patches; where a choice keeps sheets of a surface
    /// without creases apart, those of each sheet.
    fn factors(&self) -> usize {
        1
    }

    /// Bounds of factor `factor` of f and of its gradient over each box. What an enclosure says
    /// about being defined and continuous holds for f as a whole. That of a patch or of a sheet is
    /// empty where it gives f nowhere in the box.
    ///
    /// # Panics
    ///
    /// If `factor` is not below [`Bounded::factors`], or `out` is shorter than `boxes`.
    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]);

    /// Whether f is what factor `factor` is at `p`: where f has creases or sheets that are kept
    /// apart, whether its patch or sheet gives f there.
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

    /// Number of parts in which the field names the [cells](Bounded::cells) of a factor with which
    /// the search for components begins; 0, the default, if it begins with the box of the run. It
    /// is for fields that know where their surface is, as an image with many voxels does: a search
    /// that begins with the box may have to open all of them.
    fn parts(&mut self, factor: usize) -> usize {
        let _ = factor;
        0
    }

    /// Adds boxes in the box `within`, whose sides may have no length. Each zero of the factor in
    /// `within` at which its derivatives along all of the axes `sides` vanish must be in a box of a
    /// part, and each end of the surface where f is defined no longer. Of the other zeros as many
    /// as possible should be in none.
    fn cells(&mut self, factor: usize, part: usize, within: &Bounds, sides: &[usize], out: &mut Vec<Bounds>) {
        let _ = (factor, part, within, sides, out);
    }
}

/// An evaluator of a function that is one of several smooth functions at each point, its *pieces*:
/// max(a, b) is a here and b there. Where two of them meet on the surface it may have an edge, a
/// *crease*. The part of the surface on which one piece gives f is a *patch*.
///
/// A piece has a label. Equal labels are equal functions, and they do not depend on what was asked
/// before. Places and boxes are counted in the [frame](Evaluator::frame).
///
/// Formulas with maxima, minima and absolute values, and solids that are [put
/// together](crate::union), bring their pieces; [`PiecewiseFn`](crate::PiecewiseFn) makes them of
/// functions of the program, and of other functions they are found in the values of f.
pub trait Pieces {
    /// The label of the piece that gives f at `p`; 0 where f is smooth everywhere.
    fn label(&mut self, p: DVec3) -> u32;

    /// The evaluator of a piece, also where another one gives f. Its bounds are those of the piece,
    /// its pieces still those of f.
    ///
    /// # Panics
    ///
    /// May panic if there is no such piece.
    fn piece(&mut self, label: u32) -> &mut dyn Evaluator;

    /// The labels of the pieces that may give a point of the surface in a box, each once; none if
    /// they are more than can be listed.
    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>>;

    /// Cells of a box with which a search for edges can begin: in or beside one of them each edge
    /// in the box has a point. They are no wider than `width` but where that would take too long.
    fn seams_in(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds>;

    /// Pairs of patches that meet without an edge somewhere and yet are no single patch, since they
    /// or their neighbours meet at an angle elsewhere; the smaller label first.
    fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        Vec::new()
    }

    /// Whether there are pieces that [limit](Pieces::is_limit) the surface.
    fn has_limits(&mut self) -> bool {
        false
    }

    /// Whether the zeros of a piece limit the surface and are no part of it: it ends at them.
    fn is_limit(&mut self, label: u32) -> bool {
        let _ = label;
        false
    }
}

impl<'a> dyn Evaluator + 'a {
    /// [`Pieces::label`], or 0 of a smooth function.
    #[doc(hidden)]
    pub fn label(&mut self, p: DVec3) -> u32 {
        self.pieces().map_or(0, |patches| patches.label(p))
    }

    /// The evaluator of the smooth function of a patch; of f itself where there is no patch.
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

    /// Whether a zero of f is no point of the surface: it is one of a branch that limits it.
    pub(crate) fn is_beyond_limits(&mut self, p: DVec3) -> bool {
        self.has_limits() && {
            let branch = self.label(p);
            self.is_limit(branch)
        }
    }

    /// [`Pieces::tangent_pairs`]; none of a smooth function.
    pub(crate) fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        self.pieces().map_or_else(Vec::new, |patches| patches.tangent_pairs())
    }

    /// [`Pieces::labels_in`]; none of a smooth function.
    #[doc(hidden)]
    pub fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        self.pieces().and_then(|patches| patches.labels_in(bounds))
    }
}

/// The evaluator of a field by its own methods, one point at a time.
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
