//! The choice of a surface in an image, the same for all interfaces.

use super::{DEFAULT_LABEL_WIDTH, Image, ImageError, ImageField};

/// A surface of an image: at an iso value, or around a label.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageChoice {
    /// The value on the surface; [Otsu's](Image::otsu) if absent. Not used with a label.
    pub iso: Option<f64>,
    /// The label whose voxels are inside, instead of an iso value.
    pub label: Option<f64>,
    /// Width of the Gaussian in voxels, 0 for no Gaussian. The default is the [width against
    /// noise](Image::width_against_noise), or [`DEFAULT_LABEL_WIDTH`].
    pub smooth: Option<f64>,
    /// Whether the darker voxels are inside.
    pub is_dark_inside: bool,
}

/// The surface that a choice leads to.
#[derive(Clone, Debug)]
pub struct ImageSurface {
    image: Image,
    choice: ImageChoice,
    filtered: Image,
    smooth: f64,
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

    /// Notes of the reader and the filter, in sentences for the user.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        self.filtered.notes()
    }
}

impl Image {
    /// The surface of a choice. If the surface `before` has the same image, label and width, its
    /// filtered image is reused; the result is the same.
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
        let smooth = choice.smooth.unwrap_or_else(|| match choice.label {
            Some(_) => DEFAULT_LABEL_WIDTH,
            None => self.width_against_noise(choice.iso.unwrap_or_else(|| self.otsu())),
        });
        let known = before.filter(|before| {
            before.choice.label == choice.label && before.smooth == smooth && before.image.is_same(self)
        });
        let filtered = match (known, choice.label) {
            (Some(known), _) => known.filtered.clone(),
            (None, Some(label)) => self.label(label, smooth)?,
            (None, None) if smooth == 0.0 => self.clone(),
            (None, None) => self.smoothed(smooth)?,
        };
        let iso = match choice.label {
            Some(_) => 0.0,
            None => choice.iso.unwrap_or_else(|| filtered.otsu()),
        };
        let field = ImageField::new(&filtered, iso, choice.is_dark_inside)?;
        Ok(ImageSurface { image: self.clone(), choice: *choice, filtered, smooth, field })
    }

    /// Whether the other image is a copy of this one that shares its voxels.
    fn is_same(&self, other: &Self) -> bool {
        self.voxels.are_shared_with(&other.voxels) && self.placement == other.placement
    }
}
