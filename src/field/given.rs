//! What a program can give to be sampled: a field, a function of a point, or a function of a batch.

use super::{BatchField, Field, FnField, MaybeSend, MaybeSync};
use core::fmt::{self, Debug, Display, Formatter};
use glam::DVec3;
use std::error::Error;
use std::sync::Arc;

/// What can be sampled: a [`Field`], a reference or an `Arc` of one, a function `Fn(DVec3) -> f64`
/// that gives f at a point, or a function `Fn(&[DVec3], &mut [f64]) -> Result<(), E>` that writes f
/// at each of a batch of points and may fail.
///
/// `Kind` tells the compiler which of these it is; nobody has to name it. A closure's argument
/// needs its type written.
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

    /// The field made of the given value.
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
    type Field = BatchField<F, E>;

    fn into_field(self) -> Self::Field {
        BatchField::new(self)
    }
}

/// Several fields to be combined, as by [`union`](super::union): an array or a vector of one type
/// that can be [sampled](IntoField), or a tuple of up to six types.
pub trait IntoFields<Kind> {
    /// The fields.
    #[doc(hidden)]
    fn into_fields(self) -> Vec<Arc<dyn Field>>;
}

/// A field as an operand.
pub(super) fn shared<A: IntoField<K, Field: 'static>, K>(given: A) -> Arc<dyn Field> {
    let field = given.into_field();
    field.operand().unwrap_or_else(|| Arc::new(field))
}

impl<A: IntoField<K, Field: 'static>, K, const N: usize> IntoFields<K> for [A; N] {
    fn into_fields(self) -> Vec<Arc<dyn Field>> {
        self.into_iter().map(shared).collect()
    }
}

impl<A: IntoField<K, Field: 'static>, K> IntoFields<K> for Vec<A> {
    fn into_fields(self) -> Vec<Arc<dyn Field>> {
        self.into_iter().map(shared).collect()
    }
}

/// Declares that tuples of these types are several fields: type and kind of each.
macro_rules! tuples {
    ($($(($name:ident $kind:ident))+,)*) => {$(
        impl<$($name: IntoField<$kind, Field: 'static>, $kind),+> IntoFields<($($kind,)+)> for ($($name,)+) {
            fn into_fields(self) -> Vec<Arc<dyn Field>> {
                #[expect(non_snake_case, reason = "values named like their types")]
                let ($($name,)+) = self;
                vec![$(shared($name)),+]
            }
        }
    )*};
}

tuples! {
    (A Ka)(B Kb),
    (A Ka)(B Kb)(C Kc),
    (A Ka)(B Kb)(C Kc)(D Kd),
    (A Ka)(B Kb)(C Kc)(D Kd)(E Ke),
    (A Ka)(B Kb)(C Kc)(D Kd)(E Ke)(F Kf),
}

/// An error of a function of the program, in shareable form. In WebAssembly it may hold values of
/// JavaScript.
#[cfg(not(target_arch = "wasm32"))]
pub type SharedError = Arc<dyn Error + Send + Sync>;
/// An error of a function of the program, in shareable form. In WebAssembly it may hold values of
/// JavaScript.
#[cfg(target_arch = "wasm32")]
pub type SharedError = Arc<dyn Error>;

/// The error of a sampled function of the program.
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

/// Two errors are equal if they are the same object.
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
