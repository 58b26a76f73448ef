//! The choice of a surface in an image, the same for all interfaces.

use super::{Image, ImageError, ImageField};
use crate::slices::{self, LIGHT};

/// A surface of an image: at an iso value, or around a label.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageChoice {
    /// The value on the surface; [Otsu's](Image::otsu) if absent. Not used with a label.
    pub iso: Option<f64>,
    /// The label whose voxels are inside, instead of an iso value.
    pub label: Option<f64>,
    /// Width of the Gaussian in voxels, 0 for no Gaussian. The default is the [width against
    /// noise](Image::width_against_noise), or for a label that [against
    /// steps](Image::width_against_steps).
    pub smooth: Option<f64>,
    /// Whether the darker voxels are inside.
    pub is_dark_inside: bool,
    /// Whether a surface that the border of the image cuts is closed there, half a voxel beyond the
    /// outermost centres; otherwise it ends with a rim.
    pub is_closed: bool,
}

/// The surface that a choice leads to.
#[derive(Clone, Debug)]
pub struct ImageSurface {
    image: Image,
    choice: ImageChoice,
    filtered: Image,
    smooth: f64,
    noise: f64,
    field: ImageField,
}

impl ImageSurface {
    /// The field.
    #[must_use]
    pub fn field(&self) -> &ImageField {
        &self.field
    }

    /// The image before the Gaussian.
    #[must_use]
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Whether the surface is one of this image, or of a copy of it.
    #[must_use]
    pub fn is_of(&self, image: &Image) -> bool {
        self.image.is_same(image)
    }

    /// What was chosen.
    #[must_use]
    pub fn choice(&self) -> &ImageChoice {
        &self.choice
    }

    /// Width of the Gaussian in voxels, 0 for none.
    #[must_use]
    pub fn smooth(&self) -> f64 {
        self.smooth
    }

    /// Standard deviation of the [noise](Image::noise) of the image before the Gaussian.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Notes of the reader and the filter, in sentences for the user.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        self.filtered.notes()
    }
}

impl Image {
    /// The surface of a choice. If the surface `before` has the same image, what was made for it
    /// and stays the same is reused; the result is the same.
    ///
    /// # Errors
    ///
    /// If the iso value is outside the image, the label does not exist or the Gaussian leaves
    /// nothing of it, or the width is out of range.
    pub fn surface(
        &self,
        choice: &ImageChoice,
        before: Option<&ImageSurface>,
    ) -> Result<ImageSurface, ImageError> {
        slices::complete(self.clone().surface_in_slices(*choice, before.cloned()))
    }

    /// [`Image::surface`] in slices of work.
    ///
    /// # Errors
    ///
    /// As for [`Image::surface`].
    #[doc(hidden)]
    pub async fn surface_in_slices(
        self,
        choice: ImageChoice,
        before: Option<ImageSurface>,
    ) -> Result<ImageSurface, ImageError> {
        let before = before.filter(|before| before.image.is_same(&self));
        if let Some(before) = before.as_ref().filter(|before| before.choice == choice) {
            return Ok(before.clone());
        }
        let noise = match &before {
            Some(before) => before.noise,
            None => self.measured_noise().await,
        };
        let smooth = match (choice.smooth, choice.label, choice.iso) {
            (Some(smooth), ..) => smooth,
            (None, Some(_), _) => self.width_against_steps(),
            (None, None, Some(iso)) => self.width_at(iso, noise).await,
            (None, None, None) => self.width_at(self.counted().await.otsu(), noise).await,
        };
        let known = before.filter(|before| before.choice.label == choice.label && before.smooth == smooth);
        let filtered = match (known, choice.label) {
            (Some(known), _) => known.filtered,
            (None, Some(label)) => self.distance_from(label, smooth).await?,
            (None, None) if smooth == 0.0 => self.clone(),
            (None, None) => self.blurred(smooth).await?,
        };
        let iso = match (choice.label, choice.iso) {
            (Some(_), _) => 0.0,
            (None, Some(iso)) => iso,
            (None, None) => filtered.counted().await.otsu(),
        };
        let [min, max] = filtered.range;
        let is_there = iso > min && iso < max;
        let closed = if choice.is_closed && is_there {
            Some(filtered.closed_at(iso, choice.is_dark_inside).await?)
        } else {
            None
        };
        let field =
            ImageField::made(closed.as_ref().unwrap_or(&filtered), iso, choice.is_dark_inside).await?;
        Ok(ImageSurface { image: self, choice, filtered, smooth, noise, field })
    }

    /// Estimated number of slices of [`Image::surface_in_slices`] without a surface before.
    #[doc(hidden)]
    #[must_use]
    pub fn slices_of(&self, choice: &ImageChoice) -> u64 {
        /// Passes over all voxels: of the coefficients, of a Gaussian with the range of its result,
        /// of the distances from a label, and of a histogram.
        const FIELD: u64 = 4;
        const BLUR: u64 = 4;
        const LABEL: u64 = 7;
        const COUNT: u64 = 1;
        let passes = match (choice.label, choice.iso) {
            (Some(_), _) => LABEL + BLUR,
            (None, Some(_)) => BLUR,
            (None, None) => BLUR + 2 * COUNT,
        };
        let a_pass = self.voxels.len().div_ceil(LIGHT) as u64;
        (FIELD + passes) * a_pass
    }

    /// Whether the other image is a copy of this one that shares its voxels.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.voxels.are_shared_with(&other.voxels) && self.placement == other.placement
    }
}
