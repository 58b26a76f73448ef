//! Fields put together of smooth functions of the program, which tell which of them gives f where.

use super::differences::{self, Calls, Differences, Functions};
use super::{Evaluator, Field, FieldError, Frame, Jet, MaybeSend, MaybeSync, Pieces, edges};
use crate::math::{Bounds, Sym3};
use core::fmt::{self, Debug, Formatter};
use glam::{DVec3, Vec3};

/// A field put together of smooth functions, its *pieces*, by functions of the program: one that
/// gives the label of the piece at a point, and one that gives the value of a piece there.
///
/// f at a point is the value of its piece. Where the surface passes from one piece to another it
/// has an edge: particles lie on it, and the mesh is closed along it, to the digits of the numbers.
/// To find the edge the library evaluates a piece also a few particles beyond it, where another
/// piece gives f; it should be smooth there, too. Pieces with equal labels are the same function. f
/// should be continuous: where the values of two pieces differ at their border, the surface ends.
///
/// Of a function that tells nothing about its pieces, [`FnField`](super::FnField), the edges are
/// found in its values.
///
/// ```
/// use marching_particles::glam::DVec3;
/// use marching_particles::{PiecewiseFn, Settings, sample};
///
/// // A ball with its top cut off.
/// let piece = |label: u32, p: DVec3| if label == 0 { p.length() - 1.0 } else { p.z - 0.5 };
/// let label = move |p: DVec3| u32::from(piece(1, p) > piece(0, p));
/// let sample = sample(PiecewiseFn::new(label, piece), &Settings::with_count(2_000))?;
/// assert!(sample.mesh().topology.is_closed());
/// assert_eq!(sample.report().proof.creases, Some(1));
/// # Ok::<(), marching_particles::Error>(())
/// ```
pub struct PiecewiseFn<L, P> {
    label: L,
    piece: P,
    calls: Calls,
}

impl<L, P> Debug for PiecewiseFn<L, P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("PiecewiseFn").field("calls", &self.calls).finish_non_exhaustive()
    }
}

impl<L: Fn(DVec3) -> u32, P: Fn(u32, DVec3) -> f64> PiecewiseFn<L, P> {
    /// The field with these labels and pieces.
    pub fn new(label: L, piece: P) -> Self {
        Self { label, piece, calls: Calls::default() }
    }
}

impl<L, P> PiecewiseFn<L, P> {
    /// Returns the field whose pieces are asked for `most` points at most, by all runs together. A
    /// run that needs more ends with [`Error::Field`](crate::Error::Field).
    #[must_use]
    pub fn limit_calls(self, most: u64) -> Self {
        Self { calls: Calls::limited(most), ..self }
    }
}

impl<L, P> Functions for PiecewiseFn<L, P>
where
    L: Fn(DVec3) -> u32 + MaybeSend + MaybeSync,
    P: Fn(u32, DVec3) -> f64 + MaybeSend + MaybeSync,
{
    fn calls(&self) -> &Calls {
        &self.calls
    }

    fn has_gradient(&self) -> bool {
        false
    }

    fn label(&self, p: DVec3) -> u32 {
        (self.label)(p)
    }

    fn write_values(&self, piece: Option<u32>, points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError> {
        for (&p, f) in points.iter().zip(f) {
            *f = (self.piece)(piece.unwrap_or_else(|| (self.label)(p)), p);
        }
        Ok(())
    }

    fn write_gradients(&self, _: &[DVec3], _: &mut [DVec3]) -> Result<(), FieldError> {
        Ok(())
    }
}

impl<L, P> Field for PiecewiseFn<L, P>
where
    L: Fn(DVec3) -> u32 + MaybeSend + MaybeSync,
    P: Fn(u32, DVec3) -> f64 + MaybeSend + MaybeSync,
{
    fn value(&self, p: DVec3) -> f64 {
        let mut value = [0.0];
        self.values(&[p], &mut value);
        value[0]
    }

    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        differences::write_values(self, None, points, f);
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        PiecewiseEvaluator::new(self, self, Frame::default()).value_and_gradient(p)
    }

    fn jet(&self, p: DVec3) -> Jet {
        PiecewiseEvaluator::new(self, self, Frame::default()).jet(p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(PiecewiseEvaluator::new(self, self, frame))
    }

    fn calls(&self) -> Option<u64> {
        Some(self.calls.made())
    }

    fn failure(&self) -> Option<FieldError> {
        self.calls.failure()
    }
}

/// The evaluator of a field that knows its pieces, or of one piece.
struct PiecewiseEvaluator<'a> {
    field: &'a dyn Field,
    functions: &'a dyn Functions,
    own: Differences<'a>,
    /// The piece that is evaluated; none for f.
    label: Option<u32>,
    piece: Option<Box<Self>>,
    /// The labels at the points of a batch.
    labels: Vec<u32>,
}

impl<'a> PiecewiseEvaluator<'a> {
    fn new(field: &'a dyn Field, functions: &'a dyn Functions, frame: Frame) -> Self {
        let own = Differences::new(functions, frame);
        Self { field, functions, own, label: None, piece: None, labels: Vec::new() }
    }

    /// Calls `call` for each range of points with the same piece, with the evaluator of that piece.
    /// So no difference reaches over an edge.
    fn on_pieces(
        &mut self,
        points: &[Vec3],
        mut call: impl FnMut(&mut Differences<'a>, core::ops::Range<usize>),
    ) {
        let frame = self.own.frame();
        self.labels.clear();
        match self.label {
            Some(label) => self.labels.resize(points.len(), label),
            None => {
                let label = |p: &Vec3| self.functions.label(frame.place(p.as_dvec3()));
                self.labels.extend(points.iter().map(label));
            }
        }
        let mut first = 0;
        for labels in self.labels.chunk_by(|a, b| a == b) {
            self.own.piece = labels.first().copied();
            call(&mut self.own, first..first + labels.len());
            first += labels.len();
        }
    }

    /// The differences of the piece at a point.
    fn at(&mut self, p: DVec3) -> &mut Differences<'a> {
        let place = self.own.frame().place(p);
        self.own.piece = Some(self.label.unwrap_or_else(|| self.functions.label(place)));
        &mut self.own
    }
}

impl Evaluator for PiecewiseEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.own.frame()
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        let label = self.label;
        Box::new(PiecewiseEvaluator {
            label,
            ..PiecewiseEvaluator::new(self.field, self.functions, self.own.frame())
        })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.own.piece = self.label;
        self.own.values(points, value);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.on_pieces(points, |piece, at| {
            piece.gradients(&points[at.clone()], &mut value[at.clone()], &mut gradient[at]);
        });
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.on_pieces(points, |piece, at| {
            let (value, gradient) = (&mut value[at.clone()], &mut gradient[at.clone()]);
            piece.hessians(&points[at.clone()], value, gradient, &mut hessian[at]);
        });
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.at(p).value_and_gradient(p)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.at(p).jet(p)
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.on_pieces(points, |piece, at| {
            piece.exact_gradients(&points[at.clone()], &mut value[at.clone()], &mut gradient[at]);
        });
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        Some(self)
    }
}

impl Pieces for PiecewiseEvaluator<'_> {
    fn label(&mut self, p: DVec3) -> u32 {
        self.functions.label(self.own.frame().place(p))
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        /// Largest box in which the labels at some points stand for all, as a share of the diagonal
        /// of the box of the run.
        const SMALL: f64 = 0.125;
        /// Points along each of its sides.
        const SIDE: usize = 3;
        if bounds.diagonal() > SMALL * self.own.frame().length {
            return None;
        }
        let around = bounds.enlarged(0.25 * bounds.diagonal());
        let places = around.spread(SIDE).chain(around.corners());
        let mut found: Vec<u32> = places.map(|p| self.label(p)).collect();
        found.sort_unstable();
        found.dedup();
        Some(found)
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, functions, frame) = (self.field, self.functions, self.own.frame());
        let own = self.piece.get_or_insert_with(|| Box::new(Self::new(field, functions, frame)));
        own.label = Some(label);
        &mut **own
    }

    fn seams_in(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let frame = self.own.frame();
        let label = |p: DVec3| self.functions.label(p);
        let cells = edges::seams_between(self.field, &label, &frame.outward(bounds), width);
        cells.iter().map(|cell| cell.relative_to(frame.origin)).collect()
    }
}
