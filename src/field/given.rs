//! A program gives a field, a function of a point or a function of a batch of points to be sampled.

use super::function::{JET, SECOND, SLOPE, at_jet, at_slope, jet, slope};
use super::{BATCH, Evaluator, Field, FnField, Frame, Jet, MaybeSend, MaybeSync};
use crate::math::Sym3;
use core::fmt::{self, Debug, Display, Formatter};
use glam::{DVec3, Vec3};
use std::error::Error;
use std::sync::{Arc, OnceLock};

/// What can be sampled: a [`Field`], a reference or an `Arc` of one, a function `Fn(DVec3) -> f64`
/// that gives f at a point, or a function `Fn(&[DVec3], &mut [f64]) -> Result<(), E>` that writes f
/// at each of a batch of points and may fail.
///
/// `Kind` tells the compiler which of these it is; nobody has to name it. The type of a closure's
/// argument has to be written.
///
/// ```
/// use marching_particles::glam::DVec3;
/// use marching_particles::{Settings, sample};
///
/// let ball = sample(|p: DVec3| p.length() - 1.0, &Settings::with_count(500))?;
/// assert_eq!(ball.mesh().topology.euler(), 2);
///
/// // As a function of another language gives its values: many at a time, or an error.
/// let torus = |points: &[DVec3], f: &mut [f64]| -> Result<(), std::io::Error> {
///     for (p, f) in points.iter().zip(f) {
///         *f = (p.truncate().length() - 1.0).hypot(p.z) - 0.4;
///     }
///     Ok(())
/// };
/// assert_eq!(sample(torus, &Settings::with_count(500))?.mesh().topology.euler(), 0);
/// # Ok::<(), marching_particles::Error>(())
/// ```
pub trait IntoField<Kind> {
    /// The field.
    type Field: Field;

    /// The field of what was given.
    fn into_field(self) -> Self::Field;
}

/// The kinds of [`IntoField`].
#[doc(hidden)]
pub mod kind {
    use core::marker::PhantomData;

    /// A field.
    pub struct OfField;
    /// A function of a point.
    pub struct OfPoint;
    /// A function of a batch of points, whose error is `E`.
    pub struct OfBatch<E>(PhantomData<E>);
}

impl<F: Field> IntoField<kind::OfField> for F {
    type Field = F;

    fn into_field(self) -> F {
        self
    }
}

impl<F: Fn(DVec3) -> f64 + MaybeSend + MaybeSync> IntoField<kind::OfPoint> for F {
    type Field = FnField<F>;

    fn into_field(self) -> FnField<F> {
        FnField::new(self)
    }
}

impl<F, E> IntoField<kind::OfBatch<E>> for F
where
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    E: Into<FieldError>,
{
    type Field = BatchField<F, NoGradient, E>;

    fn into_field(self) -> Self::Field {
        BatchField::new(self)
    }
}

/// An error of a function of the program, as errors can be shared. In WebAssembly it may hold
/// values of JavaScript.
#[cfg(not(target_arch = "wasm32"))]
pub type SharedError = Arc<dyn Error + Send + Sync>;
/// An error of a function of the program, as errors can be shared. In WebAssembly it may hold
/// values of JavaScript.
#[cfg(target_arch = "wasm32")]
pub type SharedError = Arc<dyn Error>;

/// The error of a function of the program that is sampled.
#[derive(Clone)]
pub struct FieldError(SharedError);

impl FieldError {
    /// The error, as the function returned it.
    #[must_use]
    pub fn get(&self) -> &SharedError {
        &self.0
    }
}

impl Debug for FieldError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Debug::fmt(&self.0, f)
    }
}

impl Display for FieldError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Display::fmt(&self.0, f)
    }
}

/// Two errors are equal if they are one.
impl PartialEq for FieldError {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl<E: Into<Box<dyn Error + Send + Sync>>> From<E> for FieldError {
    fn from(error: E) -> Self {
        Self(error.into().into())
    }
}

#[cfg(target_arch = "wasm32")]
impl<E: Into<Box<dyn Error>>> From<E> for FieldError {
    fn from(error: E) -> Self {
        Self(error.into().into())
    }
}

/// The gradient function of a [`BatchField`] that has none.
pub type NoGradient = fn(&[DVec3], &mut [DVec3]);

/// A field given by a function of a batch of points, with its gradients or without.
///
/// The function writes f at each point; it is never asked for a point by itself, and for 512 at a
/// time at most. It may fail: the run ends then, and gives the error. A function that has failed
/// once is not asked again, by no run. Derivatives that are not given are found by differences, as
/// those of [`FnField`], which says what else is not known of such a field.
pub struct BatchField<F, G = NoGradient, E = FieldError> {
    values: F,
    gradients: Option<G>,
    failure: OnceLock<FieldError>,
    error: core::marker::PhantomData<fn() -> E>,
}

impl<F, G, E> Debug for BatchField<F, G, E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("BatchField").field("failure", &self.failure).finish_non_exhaustive()
    }
}

impl<F: Fn(&[DVec3], &mut [f64]) -> Result<(), E>, E> BatchField<F, NoGradient, E> {
    /// The field with the function `values`.
    pub fn new(values: F) -> Self {
        Self { values, gradients: None, failure: OnceLock::new(), error: core::marker::PhantomData }
    }

    /// Returns the field with `gradients` as the function that writes ∇f at each point.
    pub fn with_gradients<G: Fn(&[DVec3], &mut [DVec3]) -> Result<(), E>>(
        self,
        gradients: G,
    ) -> BatchField<F, Given<G>, E> {
        BatchField {
            values: self.values,
            gradients: Some(Given(gradients)),
            failure: self.failure,
            error: self.error,
        }
    }
}

/// A gradient function that was given.
#[doc(hidden)]
pub struct Given<G>(G);

/// What writes the gradients at a batch of points.
#[doc(hidden)]
pub trait Gradients<E>: MaybeSend + MaybeSync {
    /// Writes ∇f at each point.
    ///
    /// # Errors
    ///
    /// If the function fails.
    fn write(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), E>;
}

impl<E> Gradients<E> for NoGradient {
    fn write(&self, _: &[DVec3], _: &mut [DVec3]) -> Result<(), E> {
        unreachable!("there is no such function")
    }
}

impl<E, G: Fn(&[DVec3], &mut [DVec3]) -> Result<(), E> + MaybeSend + MaybeSync> Gradients<E> for Given<G> {
    fn write(&self, points: &[DVec3], out: &mut [DVec3]) -> Result<(), E> {
        (self.0)(points, out)
    }
}

impl<F, G, E> BatchField<F, G, E>
where
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    G: Gradients<E>,
    E: Into<FieldError>,
{
    /// f at each point; NaN once a function has failed.
    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        let f = &mut f[..points.len()];
        if self.failure.get().is_none()
            && let Err(error) = (self.values)(points, f)
        {
            self.failure.get_or_init(|| error.into());
        }
        if self.failure.get().is_some() {
            f.fill(f64::NAN);
        }
    }

    /// f and ∇f at each point, at most a [`BATCH`] of them; differences are over the steps of a frame.
    fn gradients(&self, frame: Frame, points: &[DVec3], f: &mut [f64], gradient: &mut [DVec3]) {
        let n = points.len();
        if let Some(gradients) = &self.gradients {
            self.values(points, f);
            if self.failure.get().is_none()
                && let Err(error) = gradients.write(points, &mut gradient[..n])
            {
                self.failure.get_or_init(|| error.into());
            }
            if self.failure.get().is_some() {
                gradient[..n].fill(DVec3::NAN);
            }
            return;
        }
        let places: Vec<DVec3> =
            points.iter().flat_map(|&p| [0, 1, 2, 3].map(|k| at_slope(p, k, frame.step(p)))).collect();
        let mut values = vec![0.0; places.len()];
        self.values(&places, &mut values);
        for (k, values) in values.as_chunks::<SLOPE>().0.iter().enumerate() {
            (f[k], gradient[k]) = (values[0], slope(*values, frame.step(points[k])));
        }
    }

    /// f, ∇f and ∇∇f at each point; differences are over the steps of a frame.
    fn jets(&self, frame: Frame, points: &[DVec3]) -> Vec<Jet> {
        if self.gradients.is_none() {
            let mut jets = Vec::with_capacity(points.len());
            for points in points.chunks(BATCH * SLOPE / JET) {
                let places: Vec<DVec3> = points
                    .iter()
                    .flat_map(|&p| (0..JET).map(move |k| at_jet(p, k, SECOND * frame.step(p))))
                    .collect();
                let mut values = vec![0.0; places.len()];
                self.values(&places, &mut values);
                jets.extend(
                    values
                        .as_chunks::<JET>()
                        .0
                        .iter()
                        .zip(points)
                        .map(|(values, &p)| jet(*values, SECOND * frame.step(p))),
                );
            }
            return jets;
        }
        const AROUND: usize = 7;
        let mut jets = Vec::with_capacity(points.len());
        for points in points.chunks(BATCH / AROUND) {
            let places: Vec<DVec3> = points
                .iter()
                .flat_map(|&p| {
                    let h = frame.step(p);
                    let around = DVec3::AXES.into_iter().flat_map(move |axis| [p + h * axis, p - h * axis]);
                    core::iter::once(p).chain(around)
                })
                .collect();
            let (mut f, mut g) = (vec![0.0; places.len()], vec![DVec3::ZERO; places.len()]);
            self.gradients(frame, &places, &mut f, &mut g);
            for (k, &p) in points.iter().enumerate() {
                let own = &g[AROUND * k..][..AROUND];
                let h = frame.step(p);
                let [x, y, z] = [1, 3, 5].map(|k| (own[k] - own[k + 1]) / (2.0 * h));
                jets.push(super::jet_of_slopes(f[AROUND * k], own[0], [x, y, z]));
            }
        }
        jets
    }
}

impl<F, G, E> Field for BatchField<F, G, E>
where
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    G: Gradients<E>,
    E: Into<FieldError>,
{
    fn value(&self, p: DVec3) -> f64 {
        let mut f = [0.0];
        self.values(&[p], &mut f);
        f[0]
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let (mut f, mut gradient) = ([0.0], [DVec3::ZERO]);
        self.gradients(Frame::default(), &[p], &mut f, &mut gradient);
        (f[0], gradient[0])
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.jets(Frame::default(), &[p])[0]
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(BatchEvaluator { field: self, frame })
    }

    fn failure(&self) -> Option<FieldError> {
        self.failure.get().cloned()
    }
}

struct BatchEvaluator<'a, F, G, E> {
    field: &'a BatchField<F, G, E>,
    frame: Frame,
}

impl<F, G, E> BatchEvaluator<'_, F, G, E> {
    fn places(&self, points: &[Vec3]) -> Vec<DVec3> {
        points.iter().map(|p| self.frame.place(p.as_dvec3())).collect()
    }
}

impl<F, G, E> Evaluator for BatchEvaluator<'_, F, G, E>
where
    F: Fn(&[DVec3], &mut [f64]) -> Result<(), E> + MaybeSend + MaybeSync,
    G: Gradients<E>,
    E: Into<FieldError>,
{
    fn frame(&self) -> Frame {
        self.frame
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        let mut exact = [0.0; SLOPE * BATCH];
        for (points, value) in points.chunks(exact.len()).zip(value.chunks_mut(SLOPE * BATCH)) {
            self.field.values(&self.places(points), &mut exact);
            value.iter_mut().zip(exact).for_each(|(value, exact)| *value = self.frame.value(exact));
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let (mut f, mut g) = ([0.0; BATCH], [DVec3::ZERO; BATCH]);
        for (n, points) in (0..).step_by(BATCH).zip(points.chunks(BATCH)) {
            self.field.gradients(self.frame, &self.places(points), &mut f, &mut g);
            for k in 0..points.len() {
                (value[n + k], gradient[n + k]) = self.frame.gradient((f[k], g[k]));
            }
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        for (k, jet) in self.field.jets(self.frame, &self.places(points)).iter().enumerate() {
            (value[k], gradient[k], hessian[k]) = self.frame.hessian(jet);
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let (mut f, mut gradient) = ([0.0], [DVec3::ZERO]);
        self.field.gradients(self.frame, &[self.frame.place(p)], &mut f, &mut gradient);
        self.frame.exact((f[0], gradient[0]))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.frame.jet(self.field.jets(self.frame, &[self.frame.place(p)])[0])
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        for (n, points) in (0..).step_by(BATCH).zip(points.chunks(BATCH)) {
            self.field.gradients(self.frame, &self.places(points), &mut value[n..], &mut gradient[n..]);
            for k in n..n + points.len() {
                (value[k], gradient[k]) = self.frame.exact((value[k], gradient[k]));
            }
        }
    }
}
