//! Fields given by functions of the program: of a point, or of a batch of points.

use super::differences::{Calls, Differences, Functions, field_of_functions};
use super::{Evaluator, Field, FieldError, Frame, Jet, MaybeSend, MaybeSync};
use core::fmt::{self, Debug, Formatter};
use core::marker::PhantomData;
use glam::DVec3;

/// A field given by a function of a point, with its gradient or without.
///
/// f is negative inside the surface; where it is undefined it returns NaN. Derivatives that are not
/// given are computed by differences, with four evaluations for a gradient and nineteen for a
/// Hessian: a given gradient makes sampling several times as fast. Without bounds there is no proof
/// that every component of the surface was found.
///
/// Edges, such as those of a union of two bodies by `min`, are found in the values of f, on a grid
/// of 64 cells along the longest side of the box, or as many as
/// [`Settings::survey_cells`](crate::Settings::survey_cells) says: particles lie on them, and the
/// mesh is closed along them. Edges smaller than a cell may be missed, and those of a function in
/// single precision are not found: the mesh is open there, and the report says where. A
/// [`PiecewiseFn`](crate::field::PiecewiseFn) says where its edges are, and so do separate bodies
/// joined by [`union`](crate::union).
///
/// Give the box of the surface if it is known ([`Settings::in_box`](crate::Settings::in_box)).
/// Without one, grids of 32 cells a side look for changes of sign over cubes around the origin,
/// from ±4 to ±10,000, each four or five times as wide as the one before. The box is fitted to what
/// lies in the smallest cube whose faces the surface does not cross. Spikes and arms that become
/// thinner than the grid's cells are followed to their ends. A separate part smaller than a cell is
/// not found, and a small part far away is missed without notice. If a larger grid shows more, a
/// warning says so ([`Warning::Beyond`](crate::Warning::Beyond)); if none shows anything, the error
/// is [`Error::NoBox`](crate::Error::NoBox).
///
/// A slow function is called less often with a given box, with its gradient, with a coarser survey
/// ([`Settings::survey_cells`](crate::Settings::survey_cells)) and without measuring
/// ([`Run::complete`](crate::Run::complete)); [`FnField::limit_calls`] sets a limit.
///
/// ```
/// use glam::DVec3;
/// use marching_particles::field::FnField;
/// use marching_particles::{Settings, sample};
///
/// let sphere = FnField::new(|p: DVec3| p.length() - 1.0).with_gradient(|p| p.normalize_or_zero());
/// assert_eq!(sample(sphere, &Settings::with_count(500))?.report().proof.components, 1);
/// # Ok::<(), marching_particles::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FnField<F, G = fn(DVec3) -> DVec3> {
    value: F,
    gradient: Option<G>,
    calls: Calls,
}

impl<F: Fn(DVec3) -> f64> FnField<F> {
    /// The field with the function `value`.
    pub fn new(value: F) -> Self {
        Self { value, gradient: None, calls: Calls::default() }
    }
}

impl<F, G> FnField<F, G> {
    /// Returns the field with `gradient` as its gradient function.
    pub fn with_gradient<H: Fn(DVec3) -> DVec3>(self, gradient: H) -> FnField<F, H> {
        FnField { value: self.value, gradient: Some(gradient), calls: self.calls }
    }

    /// Returns the field with a limit: its functions are evaluated at `most` points in all runs
    /// together. A run that needs more ends with [`Error::Field`](crate::Error::Field).
    #[must_use]
    pub fn limit_calls(self, most: u64) -> Self {
        Self { calls: Calls::limited(most), ..self }
    }
}

impl<F, G> Functions for FnField<F, G>
where
    F: Fn(DVec3) -> f64 + MaybeSend + MaybeSync,
    G: Fn(DVec3) -> DVec3 + MaybeSend + MaybeSync,
{
    fn calls(&self) -> &Calls {
        &self.calls
    }

    fn has_gradient(&self) -> bool {
        self.gradient.is_some()
    }

    fn write_values(&self, _: &[u32], points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError> {
        f.iter_mut().zip(points).for_each(|(f, &p)| *f = (self.value)(p));
        Ok(())
    }

    fn write_gradients(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), FieldError> {
        let gradient = self.gradient.iter().flat_map(|gradient| points.iter().map(|&p| gradient(p)));
        out.iter_mut().zip(gradient).for_each(|(out, gradient)| *out = gradient);
        Ok(())
    }
}

field_of_functions! {
    [F, G] FnField<F, G>,
    F: Fn(DVec3) -> f64 + MaybeSend + MaybeSync,
    G: Fn(DVec3) -> DVec3 + MaybeSend + MaybeSync,
}

/// A field given by a function of a batch of points, with its gradients or without.
///
/// The function writes f at each of at most 512 points. It may fail: the run then ends with its
/// error. After a failure no run calls the function again; with the feature `parallel` other
/// threads may be calling it at that moment. Otherwise [`FnField`] says what applies.
pub struct BatchField<F, E = FieldError, G = fn(&[DVec3], &mut [DVec3]) -> Result<(), E>> {
    values: F,
    gradients: Option<G>,
    calls: Calls,
    error: PhantomData<fn() -> E>,
}

impl<F, E, G> Debug for BatchField<F, E, G> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("BatchField").field("calls", &self.calls).finish_non_exhaustive()
    }
}

impl<F: Fn(&[DVec3], &mut [f64]) -> Result<(), E>, E> BatchField<F, E> {
    /// The field with the function `values`.
    pub fn new(values: F) -> Self {
        Self { values, gradients: None, calls: Calls::default(), error: PhantomData }
    }
}

impl<F, E, G> BatchField<F, E, G> {
    /// Returns the field with `gradients` as the function that writes ∇f at each point.
    pub fn with_gradients<H: Fn(&[DVec3], &mut [DVec3]) -> Result<(), E>>(
        self,
        gradients: H,
    ) -> BatchField<F, E, H> {
        let Self { values, calls, error, .. } = self;
        BatchField { values, gradients: Some(gradients), calls, error }
    }

    /// Returns the field with a limit: its functions are evaluated at `most` points in all runs
    /// together. A run that needs more ends with [`Error::Field`](crate::Error::Field).
    #[must_use]
    pub fn limit_calls(self, most: u64) -> Self {
        Self { calls: Calls::limited(most), ..self }
    }
}

impl<F, E, G> Functions for BatchField<F, E, G>
where
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    G: Fn(&[DVec3], &mut [DVec3]) -> Result<(), E> + MaybeSend + MaybeSync,
    E: Into<FieldError>,
{
    fn calls(&self) -> &Calls {
        &self.calls
    }

    fn has_gradient(&self) -> bool {
        self.gradients.is_some()
    }

    fn write_values(&self, _: &[u32], points: &[DVec3], f: &mut [f64]) -> Result<(), FieldError> {
        (self.values)(points, f).map_err(Into::into)
    }

    fn write_gradients(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), FieldError> {
        self.gradients.as_ref().map_or(Ok(()), |gradients| gradients(points, out)).map_err(Into::into)
    }
}

field_of_functions! {
    [F, E, G] BatchField<F, E, G>,
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    G: Fn(&[DVec3], &mut [DVec3]) -> Result<(), E> + MaybeSend + MaybeSync,
    E: Into<FieldError>,
}
