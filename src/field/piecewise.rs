//! Fields made of smooth functions of the program, which say which of them gives f at a point.

use super::differences::{Calls, Differences, Functions, field_of_functions};
use super::{Evaluator, Field, FieldError, Frame, Jet, MaybeSend, MaybeSync};
use core::fmt::{self, Debug, Formatter};
use core::marker::PhantomData;
use glam::DVec3;

/// A field made of smooth functions, its *pieces*, by functions of the program: one gives the label
/// of the piece at a point, and one the value of a piece there.
///
/// f at a point is the value of its piece. Where the surface passes from one piece to another it
/// has an edge: particles lie on it, and the mesh is closed along it, to full precision. To find
/// the edge the library evaluates a piece also a few particles beyond it, where another piece gives
/// f; it should be smooth there, too. Pieces with equal labels are the same function. f should be
/// continuous: where the values of two pieces differ at their border, the surface ends.
///
/// For a function that does not name its pieces, [`FnField`](super::FnField), edges are found in
/// the values.
///
/// ```
/// use marching_particles::field::PiecewiseFn;
/// use marching_particles::glam::DVec3;
/// use marching_particles::{Settings, sample};
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
    /// Returns the field with a limit: its pieces are evaluated at `most` points in all runs
    /// together. A run that needs more ends with [`Error::Field`](crate::Error::Field).
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

    fn piecewise(&self) -> Option<&dyn Field> {
        Some(self)
    }

    fn write_labels(&self, points: &[DVec3], labels: &mut [u32]) -> Result<(), FieldError> {
        labels.iter_mut().zip(points).for_each(|(label, &p)| *label = (self.label)(p));
        Ok(())
    }

    fn write_values(&self, labels: &[u32], points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError> {
        f.iter_mut().zip(labels.iter().zip(points)).for_each(|(f, (&label, &p))| *f = (self.piece)(label, p));
        Ok(())
    }
}

field_of_functions! {
    [L, P] PiecewiseFn<L, P>,
    L: Fn(DVec3) -> u32 + MaybeSend + MaybeSync,
    P: Fn(u32, DVec3) -> f64 + MaybeSend + MaybeSync,
}

/// [`PiecewiseFn`] by functions of batches of points, which may fail, as in a
/// [`BatchField`](super::BatchField).
///
/// One function writes the labels at points, the other one the values of a piece at points. A batch
/// has at most 512 points.
pub struct BatchPiecewise<L, P, E = FieldError> {
    labels: L,
    piece: P,
    calls: Calls,
    error: PhantomData<fn() -> E>,
}

impl<L, P, E> Debug for BatchPiecewise<L, P, E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("BatchPiecewise").field("calls", &self.calls).finish_non_exhaustive()
    }
}

impl<L, P, E> BatchPiecewise<L, P, E>
where
    L: Fn(&[DVec3], &mut [u32]) -> Result<(), E>,
    P: Fn(u32, &[DVec3], &mut [f64]) -> Result<(), E>,
{
    /// The field with these labels and pieces.
    pub fn new(labels: L, piece: P) -> Self {
        Self { labels, piece, calls: Calls::default(), error: PhantomData }
    }
}

impl<L, P, E> BatchPiecewise<L, P, E> {
    /// [`PiecewiseFn::limit_calls`].
    #[must_use]
    pub fn limit_calls(self, most: u64) -> Self {
        Self { calls: Calls::limited(most), ..self }
    }
}

impl<L, P, E> Functions for BatchPiecewise<L, P, E>
where
    L: Fn(&[DVec3], &mut [u32]) -> Result<(), E> + MaybeSend + MaybeSync,
    P: Fn(u32, &[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    E: Into<FieldError>,
{
    fn calls(&self) -> &Calls {
        &self.calls
    }

    fn piecewise(&self) -> Option<&dyn Field> {
        Some(self)
    }

    fn write_labels(&self, points: &[DVec3], labels: &mut [u32]) -> Result<(), FieldError> {
        (self.labels)(points, labels).map_err(Into::into)
    }

    fn write_values(&self, labels: &[u32], points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError> {
        let mut pieces = labels.to_vec();
        pieces.sort_unstable();
        pieces.dedup();
        for piece in pieces {
            let own = || labels.iter().enumerate().filter(move |&(_, &label)| label == piece);
            let places: Vec<DVec3> = own().map(|(k, _)| points[k]).collect();
            let mut values = vec![0.0; places.len()];
            (self.piece)(piece, &places, &mut values).map_err(Into::into)?;
            own().zip(values).for_each(|((k, _), value)| f[k] = value);
        }
        Ok(())
    }
}

field_of_functions! {
    [L, P, E] BatchPiecewise<L, P, E>,
    L: Fn(&[DVec3], &mut [u32]) -> Result<(), E> + MaybeSend + MaybeSync,
    P: Fn(u32, &[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    E: Into<FieldError>,
}
