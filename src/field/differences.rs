//! Functions of the program at work in a frame: batches of them, derivatives by differences where
//! they are not given, and the count of their calls.

use super::{BATCH, Evaluator, FieldError, Frame, Jet, MaybeSend, MaybeSync, jet_of_slopes};
use crate::math::Sym3;
use core::fmt::{self, Debug, Display, Formatter};
use core::sync::atomic::{AtomicU64, Ordering};
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Steps of second differences are this many times those of first ones: ε^¼ in place of ε^⅓, the
/// best compromise between the error of the formula, of order h², and that of rounding, of order
/// ε/h².
const SECOND: f64 = 20.0;

/// f, and ∇f if it is given, at batches of points.
pub(super) trait Functions: MaybeSend + MaybeSync {
    /// The calls so far.
    fn calls(&self) -> &Calls;

    /// Whether there is a function of the gradient.
    fn has_gradient(&self) -> bool;

    /// The label of the piece that gives f at a point.
    fn label(&self, p: DVec3) -> u32 {
        let _ = p;
        0
    }

    /// Writes f, or a piece of it, at each point. Functions that know of no pieces write f.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write_values(&self, piece: Option<u32>, points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError>;

    /// Writes ∇f at each point, if it is given.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write_gradients(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), FieldError>;
}

/// The points for which functions of the program were asked, and the failure after which they are
/// asked no more.
pub(super) struct Calls {
    made: AtomicU64,
    most: u64,
    failure: OnceLock<FieldError>,
}

impl Default for Calls {
    fn default() -> Self {
        Self::limited(u64::MAX)
    }
}

/// A copy of the functions has been asked for nothing yet.
impl Clone for Calls {
    fn clone(&self) -> Self {
        Self::limited(self.most)
    }
}

impl Debug for Calls {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}, failure: {:?}", self.made(), self.most, self.failure.get())
    }
}

impl Calls {
    /// No calls yet, of which there may be so many.
    pub(super) fn limited(most: u64) -> Self {
        Self { made: AtomicU64::new(0), most, failure: OnceLock::new() }
    }

    /// The number of points so far, of values and of gradients.
    pub(super) fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// The failure, if there was one.
    pub(super) fn failure(&self) -> Option<FieldError> {
        self.failure.get().cloned()
    }

    /// Makes a call for so many points. Returns whether it was made, and has not failed.
    fn call(&self, points: usize, call: impl FnOnce() -> Result<(), FieldError>) -> bool {
        if self.failure.get().is_some() {
            return false;
        }
        let points = points as u64;
        let before = self.made.fetch_add(points, Ordering::Relaxed);
        let result = if before.saturating_add(points) > self.most {
            self.made.fetch_sub(points, Ordering::Relaxed);
            Err(TooManyCalls { most: self.most }.into())
        } else {
            call()
        };
        result.map_err(|error| self.failure.get_or_init(|| error)).is_ok()
    }
}

/// The functions of the program would have been asked for more points than they may be.
#[derive(Debug)]
struct TooManyCalls {
    most: u64,
}

impl Display for TooManyCalls {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "it was to be called for more than {} points, the limit that was set: allow more, or take \
             fewer particles, a box that is given, or a coarser survey",
            self.most
        )
    }
}

impl std::error::Error for TooManyCalls {}

/// The evaluator of functions of the program.
pub(super) struct Differences<'a> {
    functions: &'a dyn Functions,
    /// The piece that is evaluated; none for f.
    pub(super) piece: Option<u32>,
    frame: Frame,
    /// The points of a batch, in the coordinates of the field.
    points: Vec<DVec3>,
    /// The places around them whose values or gradients make differences.
    places: Vec<DVec3>,
    value: Vec<f64>,
    gradient: Vec<DVec3>,
}

impl<'a> Differences<'a> {
    pub(super) fn new(functions: &'a dyn Functions, frame: Frame) -> Self {
        let (points, places, value, gradient) = Default::default();
        Self { functions, piece: None, frame, points, places, value, gradient }
    }

    /// f at a point in the coordinates of the field.
    pub(super) fn value(&mut self, p: DVec3) -> f64 {
        self.points.clear();
        self.points.push(p);
        self.value.resize(self.points.len(), 0.0);
        write_values(self.functions, self.piece, &self.points, &mut self.value);
        self.value[0]
    }

    /// Takes points of the frame as those of the batch.
    fn take(&mut self, points: &[Vec3]) {
        let frame = self.frame;
        self.points.clear();
        self.points.extend(points.iter().map(|p| frame.place(p.as_dvec3())));
    }

    /// f and ∇f at the points of the batch.
    fn slopes(&mut self) -> impl Iterator<Item = (f64, DVec3)> + '_ {
        let Self { functions, piece, frame, points, places, value, gradient } = self;
        let is_given = functions.has_gradient();
        if is_given {
            value.resize(points.len(), 0.0);
            write_values(*functions, *piece, points, value);
            write_gradients(*functions, points, gradient);
        } else {
            places.clear();
            places.extend(points.iter().flat_map(|&p| [0, 1, 2, 3].map(|k| at_slope(p, k, frame.step(p)))));
            value.resize(places.len(), 0.0);
            write_values(*functions, *piece, places, value);
        }
        points.iter().enumerate().map(move |(k, &p)| {
            if is_given {
                return (value[k], gradient[k]);
            }
            let own = core::array::from_fn(|place| value[SLOPE * k + place]);
            (own[0], slope(own, frame.step(p)))
        })
    }

    /// f, ∇f and ∇∇f at the points of the batch.
    fn jets(&mut self) -> impl Iterator<Item = Jet> + '_ {
        let Self { functions, piece, frame, points, places, value, gradient } = self;
        let is_given = functions.has_gradient();
        places.clear();
        if is_given {
            places.extend(
                points
                    .iter()
                    .flat_map(|&p| (0..AROUND).map(move |k| (p, k)))
                    .map(|(p, k)| at_jet(p, k, frame.step(p))),
            );
            value.resize(points.len(), 0.0);
            write_values(*functions, *piece, points, value);
            write_gradients(*functions, places, gradient);
        } else {
            let places_of = |&p: &DVec3| (0..JET).map(move |k| (p, k));
            places
                .extend(points.iter().flat_map(places_of).map(|(p, k)| at_jet(p, k, SECOND * frame.step(p))));
            value.resize(places.len(), 0.0);
            write_values(*functions, *piece, places, value);
        }
        points.iter().enumerate().map(move |(k, &p)| {
            let h = frame.step(p);
            if is_given {
                let own = &gradient[AROUND * k..][..AROUND];
                let along = [1, 3, 5].map(|k| (own[k] - own[k + 1]) / (2.0 * h));
                return jet_of_slopes(value[k], own[0], along);
            }
            jet(core::array::from_fn(|place| value[JET * k + place]), SECOND * h)
        })
    }
}

/// Number of points for which a function is asked at a time, at most.
const AT_ONCE: usize = SLOPE * BATCH;

/// f, or a piece of it, at each point; NaN once a function has failed.
pub(super) fn write_values(functions: &dyn Functions, piece: Option<u32>, points: &[DVec3], f: &mut [f64]) {
    for (points, f) in points.chunks(AT_ONCE).zip(f.chunks_mut(AT_ONCE)) {
        if !functions.calls().call(points.len(), || functions.write_values(piece, points, f)) {
            f.fill(f64::NAN);
        }
    }
}

/// ∇f at each point; NaN once a function has failed.
fn write_gradients(functions: &dyn Functions, points: &[DVec3], out: &mut Vec<DVec3>) {
    out.resize(points.len(), DVec3::ZERO);
    for (points, out) in points.chunks(AT_ONCE).zip(out.chunks_mut(AT_ONCE)) {
        if !functions.calls().call(points.len(), || functions.write_gradients(points, out)) {
            out.fill(DVec3::NAN);
        }
    }
}

impl Evaluator for Differences<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(Differences { piece: self.piece, ..Differences::new(self.functions, self.frame) })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.take(points);
        self.value.resize(self.points.len(), 0.0);
        write_values(self.functions, self.piece, &self.points, &mut self.value);
        value.iter_mut().zip(&self.value).for_each(|(value, &f)| *value = self.frame.value(f));
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let frame = self.frame;
        self.take(points);
        for (k, slope) in self.slopes().enumerate() {
            (value[k], gradient[k]) = frame.gradient(slope);
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let frame = self.frame;
        self.take(points);
        for (k, jet) in self.jets().enumerate() {
            (value[k], gradient[k], hessian[k]) = frame.hessian(&jet);
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let frame = self.frame;
        self.points.clear();
        self.points.push(frame.place(p));
        let slope = self.slopes().next();
        frame.exact(slope.unwrap_or((f64::NAN, DVec3::NAN)))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let frame = self.frame;
        self.points.clear();
        self.points.push(frame.place(p));
        let jet = self.jets().next();
        frame.jet(jet.unwrap_or_default())
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        let frame = self.frame;
        self.take(points);
        for (k, slope) in self.slopes().enumerate() {
            (value[k], gradient[k]) = frame.exact(slope);
        }
    }
}

/// Number of values that a gradient takes and a second-order jet, and of gradients that a jet
/// takes.
const SLOPE: usize = 4;
const JET: usize = 19;
const AROUND: usize = 7;

/// Place `k` of the four whose values give a gradient: the point itself, then one ahead along each
/// axis.
fn at_slope(p: DVec3, k: usize, h: f64) -> DVec3 {
    if k == 0 { p } else { p + DVec3::AXES[k - 1] * h }
}

/// The gradient by forward differences, from the values at the places of [`at_slope`]. Its error is
/// of order h: less than a ten-thousandth where the surface bends within a twentieth of the box,
/// and no more where a function computes in single precision.
fn slope(f: [f64; SLOPE], h: f64) -> DVec3 {
    (DVec3::new(f[1], f[2], f[3]) - DVec3::splat(f[0])) / h
}

/// Place `k` of those whose values give a second-order jet: the point itself, one ahead and one
/// behind on each axis, and four around it in each plane of two axes.
fn at_jet(p: DVec3, k: usize, h: f64) -> DVec3 {
    const SIGNS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    const PLANES: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];
    match k.checked_sub(1) {
        None => p,
        Some(k @ 0..6) => p + DVec3::AXES[k / 2] * if k % 2 == 0 { h } else { -h },
        Some(k) => {
            let ([a, b], [s, t]) = (PLANES[(k - 6) / 4], SIGNS[(k - 6) % 4]);
            p + DVec3::AXES[a] * (s * h) + DVec3::AXES[b] * (t * h)
        }
    }
}

/// The second-order jet by central differences, from the values at the places of [`at_jet`].
fn jet(f: [f64; JET], h: f64) -> Jet {
    let value = f[0];
    let [x, y, z] = [1, 3, 5].map(|k| (f[k] - f[k + 1]) / (2.0 * h));
    let [xx, yy, zz] = [1, 3, 5].map(|k| (f[k] - 2.0 * value + f[k + 1]) / (h * h));
    let [xy, xz, yz] = [7, 11, 15].map(|k| (f[k] - f[k + 1] - f[k + 2] + f[k + 3]) / (4.0 * h * h));
    Jet { value, gradient: DVec3::new(x, y, z), hessian: Sym3 { xx, xy, xz, yy, yz, zz } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Field, FnField, Frame};

    /// f = x² y + sin z, with all derivatives known.
    fn value(p: DVec3) -> f64 {
        p.x * p.x * p.y + libm::sin(p.z)
    }

    fn gradient(p: DVec3) -> DVec3 {
        DVec3::new(2.0 * p.x * p.y, p.x * p.x, libm::cos(p.z))
    }

    fn assert_is_near(jet: &Jet, p: DVec3) {
        assert!((jet.value - value(p)).abs() < 1e-14, "{jet:?}");
        assert!((jet.gradient - gradient(p)).length() < 1e-8, "{jet:?}");
        let Sym3 { xx, xy, xz, yy, yz, zz } = jet.hessian;
        let expected = [2.0 * p.y, 2.0 * p.x, 0.0, 0.0, 0.0, -libm::sin(p.z)];
        for (found, expected) in [xx, xy, xz, yy, yz, zz].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-5, "{jet:?}");
        }
    }

    #[test]
    fn derivatives_by_differences_are_near_the_known_ones_around_any_origin() {
        for origin in [DVec3::ZERO, DVec3::new(3.0, -2.0, 1.0)] {
            for p in [DVec3::new(0.3, -0.7, 0.4), DVec3::new(-1.2, 0.1, 2.0)] {
                let plain = FnField::new(value);
                assert_is_near(&plain.evaluator(Frame::around(origin)).jet(p - origin), p);
                let given = FnField::new(value).with_gradient(gradient);
                assert_is_near(&given.evaluator(Frame::around(origin)).jet(p - origin), p);
            }
        }
    }
}
