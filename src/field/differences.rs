//! Evaluates functions of the program in a frame: batches, derivatives by differences where none
//! are given, and the count of calls.

use super::{
    BATCH, Evaluator, Field, FieldError, Frame, Jet, MaybeSend, MaybeSync, Pieces, edges, jet_of_slopes,
};
use crate::math::{Bounds, Sym3};
use core::fmt::{self, Debug, Display, Formatter};
use core::sync::atomic::{AtomicU64, Ordering};
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Steps of second differences are this many times those of first differences: ε^¼ instead of ε^⅓
/// balances the truncation error, of order h², and the rounding error, of order ε/h².
const SECOND: f64 = 20.0;

/// f, and ∇f if it is given, at batches of points.
pub(super) trait Functions: MaybeSend + MaybeSync {
    /// The calls so far.
    fn calls(&self) -> &Calls;

    /// Whether there is a function of the gradient.
    fn has_gradient(&self) -> bool {
        false
    }

    /// The field of these functions, if they name its pieces.
    fn piecewise(&self) -> Option<&dyn Field> {
        None
    }

    /// Writes the label of the piece that gives f at each point.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write_labels(&self, points: &[DVec3], labels: &mut [u32]) -> Result<(), FieldError> {
        let _ = points;
        labels.fill(0);
        Ok(())
    }

    /// Writes the value of the piece with the label at each point. Functions that name no pieces
    /// write f.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write_values(&self, labels: &[u32], points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError>;

    /// Writes ∇f at each point, if it is given.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write_gradients(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), FieldError> {
        let _ = (points, out);
        Ok(())
    }
}

/// Makes a field of functions of the program.
macro_rules! field_of_functions {
    ([$($parameters:tt)*] $functions:ty, $($bounds:tt)*) => {
        impl<$($parameters)*> Field for $functions
        where
            $($bounds)*
        {
            fn value(&self, p: DVec3) -> f64 {
                let mut value = [0.0];
                self.values(&[p], &mut value);
                value[0]
            }

            fn values(&self, points: &[DVec3], f: &mut [f64]) {
                Differences::new(self, Frame::default()).write(points, f);
            }

            fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
                let Jet { value, gradient, .. } = self.jet(p);
                (value, gradient)
            }

            fn jet(&self, p: DVec3) -> Jet {
                Differences::new(self, Frame::default()).jet(p)
            }

            fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
                Box::new(Differences::new(self, frame))
            }

            fn calls(&self) -> Option<u64> {
                Some(self.calls.made())
            }

            fn failure(&self) -> Option<FieldError> {
                self.calls.failure()
            }
        }
    };
}

pub(super) use field_of_functions;

/// The points at which functions of the program were evaluated, and the failure after which they
/// are no longer called.
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

/// A copy of the functions has made no calls yet.
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
    /// No calls yet, with a limit of `most` points.
    pub(super) fn limited(most: u64) -> Self {
        Self { made: AtomicU64::new(0), most, failure: OnceLock::new() }
    }

    /// The number of points so far, for values and for gradients.
    pub(super) fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// The failure, if there was one.
    pub(super) fn failure(&self) -> Option<FieldError> {
        self.failure.get().cloned()
    }

    /// Makes a call for this many points. Returns whether it was made and succeeded.
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

/// The functions of the program would have been called for more points than allowed.
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

/// The evaluator of functions of the program, or of one of the pieces that they name.
pub(super) struct Differences<'a> {
    functions: &'a dyn Functions,
    /// The piece that is evaluated; none for f.
    label: Option<u32>,
    /// The evaluator of a piece, if one was used.
    piece: Option<Box<Self>>,
    frame: Frame,
    /// The points of a batch, in the coordinates of the field.
    points: Vec<DVec3>,
    /// The labels of their pieces; empty if the functions name none.
    labels: Vec<u32>,
    /// The places around the points that differences use. Those around a point take values of its
    /// piece, so that no difference crosses an edge.
    places: Vec<DVec3>,
    labels_of_places: Vec<u32>,
    value: Vec<f64>,
    gradient: Vec<DVec3>,
}

impl<'a> Differences<'a> {
    pub(super) fn new(functions: &'a dyn Functions, frame: Frame) -> Self {
        Self {
            functions,
            label: None,
            piece: None,
            frame,
            points: Vec::new(),
            labels: Vec::new(),
            places: Vec::new(),
            labels_of_places: Vec::new(),
            value: Vec::new(),
            gradient: Vec::new(),
        }
    }

    /// Writes f at points in the coordinates of the field; NaN once a function has failed.
    pub(super) fn write(&mut self, points: &[DVec3], f: &mut [f64]) {
        for (points, f) in points.chunks(AT_ONCE).zip(f.chunks_mut(AT_ONCE)) {
            self.take(points.iter().copied());
            write_values(self.functions, &self.labels, points, f);
        }
    }

    /// Sets the points of a batch, in the coordinates of the field.
    fn take(&mut self, points: impl Iterator<Item = DVec3>) {
        self.points.clear();
        self.points.extend(points);
        self.labels.clear();
        if self.functions.piecewise().is_some() {
            self.labels.resize(self.points.len(), self.label.unwrap_or_default());
            if self.label.is_none() {
                write_labels(self.functions, &self.points, &mut self.labels);
            }
        }
    }

    /// Sets places around the points of the batch, `around` for each.
    fn take_places(&mut self, around: usize, at: impl Fn(DVec3, usize) -> DVec3) {
        self.places.clear();
        self.places.extend(
            self.points.iter().flat_map(|&p| (0..around).map(move |k| (p, k))).map(|(p, k)| at(p, k)),
        );
        self.labels_of_places.clear();
        self.labels_of_places
            .extend(self.labels.iter().flat_map(|&label| core::iter::repeat_n(label, around)));
    }

    fn write_values_at_points(&mut self) {
        self.value.resize(self.points.len(), 0.0);
        write_values(self.functions, &self.labels, &self.points, &mut self.value);
    }

    fn write_values_at_places(&mut self) {
        self.value.resize(self.places.len(), 0.0);
        write_values(self.functions, &self.labels_of_places, &self.places, &mut self.value);
    }

    /// f and ∇f at the points of the batch.
    fn slopes(&mut self) -> impl Iterator<Item = (f64, DVec3)> + '_ {
        let frame = self.frame;
        let is_given = self.functions.has_gradient();
        if is_given {
            self.write_values_at_points();
            write_gradients(self.functions, &self.points, &mut self.gradient);
        } else {
            self.take_places(SLOPE, |p, k| at_slope(p, k, frame.step(p)));
            self.write_values_at_places();
        }
        let Self { points, value, gradient, .. } = self;
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
        let frame = self.frame;
        let is_given = self.functions.has_gradient();
        if is_given {
            self.take_places(AROUND, |p, k| at_jet(p, k, frame.step(p)));
            self.write_values_at_points();
            write_gradients(self.functions, &self.places, &mut self.gradient);
        } else {
            self.take_places(JET, |p, k| at_jet(p, k, SECOND * frame.step(p)));
            self.write_values_at_places();
        }
        let Self { points, value, gradient, .. } = self;
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

/// Maximum number of points in one call of a function.
const AT_ONCE: usize = SLOPE * BATCH;

/// The label of the piece at each point; 0 once a function has failed. Calls for labels do not
/// count.
fn write_labels(functions: &dyn Functions, points: &[DVec3], labels: &mut [u32]) {
    for (points, labels) in points.chunks(AT_ONCE).zip(labels.chunks_mut(AT_ONCE)) {
        if !functions.calls().call(0, || functions.write_labels(points, labels)) {
            labels.fill(0);
        }
    }
}

/// The piece with the label at each point, or f without labels; NaN once a function has failed.
fn write_values(functions: &dyn Functions, labels: &[u32], points: &[DVec3], f: &mut [f64]) {
    for (k, (points, f)) in points.chunks(AT_ONCE).zip(f.chunks_mut(AT_ONCE)).enumerate() {
        let labels = if labels.is_empty() { labels } else { &labels[AT_ONCE * k..][..points.len()] };
        if !functions.calls().call(points.len(), || functions.write_values(labels, points, f)) {
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
        Box::new(Differences { label: self.label, ..Differences::new(self.functions, self.frame) })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        let frame = self.frame;
        self.take(points.iter().map(|p| frame.place(p.as_dvec3())));
        self.write_values_at_points();
        value.iter_mut().zip(&self.value).for_each(|(value, &f)| *value = frame.value(f));
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let frame = self.frame;
        self.take(points.iter().map(|p| frame.place(p.as_dvec3())));
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
        self.take(points.iter().map(|p| frame.place(p.as_dvec3())));
        for (k, jet) in self.jets().enumerate() {
            (value[k], gradient[k], hessian[k]) = frame.hessian(&jet);
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let frame = self.frame;
        self.take(core::iter::once(frame.place(p)));
        let slope = self.slopes().next();
        frame.exact(slope.unwrap_or((f64::NAN, DVec3::NAN)))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let frame = self.frame;
        self.take(core::iter::once(frame.place(p)));
        let jet = self.jets().next();
        frame.jet(jet.unwrap_or_default())
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        let frame = self.frame;
        self.take(points.iter().map(|p| frame.place(p.as_dvec3())));
        for (k, slope) in self.slopes().enumerate() {
            (value[k], gradient[k]) = frame.exact(slope);
        }
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        self.functions.piecewise().is_some().then_some(self)
    }
}

impl Pieces for Differences<'_> {
    fn label(&mut self, p: DVec3) -> u32 {
        let mut label = [0];
        write_labels(self.functions, &[self.frame.place(p)], &mut label);
        label[0]
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        /// Largest box in which the labels at some points are taken for all labels, as a share of
        /// the diagonal of the box of the run.
        const SMALL: f64 = 0.125;
        /// Points along each of its sides.
        const SIDE: usize = 3;
        if bounds.diagonal() > SMALL * self.frame.length {
            return None;
        }
        let around = bounds.enlarged(0.25 * bounds.diagonal());
        let places = around.spread(SIDE).chain(around.corners());
        let places: Vec<DVec3> = places.map(|p| self.frame.place(p)).collect();
        let mut found = vec![0; places.len()];
        write_labels(self.functions, &places, &mut found);
        found.sort_unstable();
        found.dedup();
        Some(found)
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let piece = self.piece.get_or_insert_with(|| Box::new(Self::new(self.functions, self.frame)));
        piece.label = Some(label);
        &mut **piece
    }

    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let Some(field) = self.functions.piecewise() else {
            return Vec::new();
        };
        let labels = |points: &[DVec3], labels: &mut [u32]| write_labels(self.functions, points, labels);
        let cells = edges::edge_cells_between(field, &labels, &self.frame.outward(bounds), width);
        cells.iter().map(|cell| cell.relative_to(self.frame.origin)).collect()
    }
}

/// Number of values for a gradient and for a second-order jet, and of gradients for a jet.
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
/// even for a function in single precision.
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
