//! Three-dimensional images as fields: CT and MR volumes, cubes of densities, arrays.
//!
//! An [`Image`] is a grid of voxels with a placement in space. An [`ImageField`] is the surface in
//! it at one grey value, the *iso value*: the zero set of iso value minus a cubic spline through
//! all voxels. [`Image::read`] reads a file, [`Image::new`] takes a program's array.

mod border;
mod bounds;
mod bricks;
mod choice;
mod coarser;
mod field;
mod filter;
mod kernel;
mod labels;
mod otsu;
mod placement;
mod read;
mod section;
mod smooth;
mod voxels;

pub use choice::{ImageChoice, ImageSurface};
pub use field::ImageField;
pub use labels::Label;
pub use placement::Placement;
pub(crate) use read::opened;
pub use read::{ImageFormat, ImageOutline, ImageReadError, MAX_IMAGE_BYTES, RawVoxels};
pub use section::Section;
pub(crate) use smooth::blur;
pub use voxels::{Voxel, VoxelType};

use crate::slices;
use core::fmt::{self, Debug, Formatter};
use glam::{DMat3, DVec3};
use otsu::Histogram;
use std::sync::{Arc, OnceLock};
use voxels::{Layout, Voxels};

/// Why an image cannot become a field. The message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The image has a single voxel along an axis.
    #[error(
        "the image has {} × {} × {} voxels, and a surface takes two or more along each axis; \
         give a volume, not a single slice",
        size[0], size[1], size[2]
    )]
    Flat {
        /// Voxels along each axis.
        size: [usize; 3],
    },
    /// The number of values is not the product of the numbers of voxels along the axes.
    #[error(
        "an image of {} × {} × {} voxels takes {wanted} values, and {found} were given; check the order and \
         the length of its axes",
        size[0], size[1], size[2]
    )]
    Size {
        /// Voxels along each axis.
        size: [usize; 3],
        /// Their product.
        wanted: u64,
        /// Number of values that were given.
        found: u64,
    },
    /// A voxel is NaN, infinite, or so large that single precision overflows.
    #[error(
        "{count} voxels are not finite, or beyond ±1e30, the first one at ({}, {}, {}); give them a value, such as that of \
         the background",
        first[0], first[1], first[2]
    )]
    NotFinite {
        /// Number of such voxels.
        count: usize,
        /// Indices of the first one.
        first: [usize; 3],
    },
    /// All voxels have the same value.
    #[error("all voxels have the value {value}, so there is no surface between them; choose another image")]
    Constant {
        /// The value.
        value: f64,
    },
    /// The iso value is not between the smallest and the largest voxel.
    #[error(
        "the iso value {iso} is outside the image, whose voxels are {min} to {max}; choose one between them"
    )]
    Outside {
        /// The iso value.
        iso: f64,
        /// Smallest voxel.
        min: f64,
        /// Largest voxel.
        max: f64,
    },
    /// The width of a Gaussian is out of its range.
    #[error("the width {width} of the Gaussian is not between 0 and 100 voxels")]
    Width {
        /// The width in voxels.
        width: f64,
    },
    /// No voxel, or every voxel, has the label.
    #[error("{}", no_label(*value, *count, known))]
    NoLabel {
        /// The label.
        value: f64,
        /// Number of voxels that have it.
        count: usize,
        /// The labels of the image; empty if its voxels are not labels.
        known: Vec<f64>,
    },
    /// The Gaussian leaves nothing of a label.
    #[error(
        "nothing is left of the label {value}, whose parts are thinner than the Gaussian of {width} voxels; use a smaller width"
    )]
    Thin {
        /// The label.
        value: f64,
        /// The width of the Gaussian in voxels.
        width: f64,
    },
    /// The axes of the image do not span space.
    #[error(
        "the axes of the image are {}, {} and {}, which are not finite or lie in a plane; give spacings above \
         zero, or an affine matrix with an inverse",
        axes[0], axes[1], axes[2]
    )]
    Singular {
        /// The steps from voxel to voxel along each axis.
        axes: [DVec3; 3],
    },
}

/// Why a label has no surface.
fn no_label(value: f64, count: usize, known: &[f64]) -> String {
    /// Number of labels that a message lists, at most.
    const LISTED: usize = 20;
    if count > 0 {
        return format!("all voxels have the label {value}, so it has no boundary in the image");
    }
    if known.is_empty() {
        return format!(
            "no voxel has the label {value}; the values of this image are no labels: choose an iso value"
        );
    }
    let listed: Vec<String> = known.iter().take(LISTED).map(f64::to_string).collect();
    let more = if known.len() > LISTED { ", …" } else { "" };
    format!("no voxel has the label {value}; those of the image are {}{more}", listed.join(", "))
}

/// The axis of an array along which neighbours are next to each other in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisOrder {
    /// The first one, as in Fortran and most image files.
    #[default]
    FirstFastest,
    /// The last one, as in C and NumPy.
    LastFastest,
}

impl AxisOrder {
    /// Three values, one for each axis of the array, with that of the fastest-changing axis first.
    /// Its own inverse.
    fn sorted<T>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        match self {
            Self::FirstFastest => [a, b, c],
            Self::LastFastest => [c, b, a],
        }
    }
}

/// A grid of voxels with a placement in space.
///
/// The voxels keep the type and byte order of the file or array; copies of an image and its fields
/// share them. [`Placement`] maps the indices (i, j, k) of a voxel to its centre. The image fills
/// the box of the centres.
///
/// ```
/// use marching_particles::{Image, Settings, sample};
///
/// // A bright ball of radius 10 voxels in the dark, as an array in which x changes fastest.
/// let distance = |i: usize| {
///     let offset = |k: usize| (k % 32) as f32 - 15.5;
///     (offset(i).powi(2) + offset(i / 32).powi(2) + offset(i / 1024).powi(2)).sqrt()
/// };
/// let voxels: Vec<f32> = (0..32 * 32 * 32).map(|i| 10.0 - distance(i)).collect();
/// let image = Image::new([32, 32, 32], voxels)?.with_spacing([0.5; 3])?;
///
/// let ball = sample(image.at(0.0)?, &Settings::with_count(500))?;
/// assert_eq!(ball.report().proof.components, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Image {
    /// From the fastest-changing axis on, as are the columns of the placement.
    size: [usize; 3],
    voxels: Voxels,
    placement: Placement,
    /// How the axes are ordered for users.
    order: AxisOrder,
    range: [f64; 2],
    /// Counted when it is first asked for.
    histogram: Arc<OnceLock<Histogram>>,
    notes: Arc<[String]>,
}

impl Debug for Image {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Image")
            .field("size", &self.size())
            .field("voxel_type", &self.voxel_type())
            .field("placement", &self.placement())
            .field("range", &self.range)
            .finish_non_exhaustive()
    }
}

impl Image {
    /// The image with these voxels; the index along the first axis changes fastest: voxel (i, j, k)
    /// is `voxels[i + size[0] * (j + size[1] * k)]`. Voxels are one unit apart, and voxel (0, 0, 0)
    /// is at the origin.
    ///
    /// # Errors
    ///
    /// [`ImageError::Size`], [`Flat`](ImageError::Flat), [`NotFinite`](ImageError::NotFinite) or
    /// [`Constant`](ImageError::Constant).
    pub fn new<T: Voxel>(size: [usize; 3], voxels: impl AsRef<[T]>) -> Result<Self, ImageError> {
        slices::complete(Self::of(size, AxisOrder::FirstFastest, Voxels::new(voxels.as_ref())))
    }

    /// [`Image::new`] from the bytes of numbers, in the byte order of the machine, with the axes in
    /// either order: size, spacing and affine map are those of the axes from the first to the last.
    ///
    /// # Errors
    ///
    /// As for [`Image::new`].
    pub fn from_bytes(
        size: [usize; 3],
        order: AxisOrder,
        voxel_type: VoxelType,
        bytes: impl Into<Vec<u8>>,
    ) -> Result<Self, ImageError> {
        let bytes = bytes.into();
        let len = bytes.len() / voxel_type.bytes();
        let wanted = size.iter().fold(1_u64, |product, &n| product.saturating_mul(n as u64));
        let wrong = ImageError::Size { size, wanted, found: len as u64 };
        let layout = Layout::plain(voxel_type, cfg!(target_endian = "big"));
        slices::complete(Self::of(size, order, Voxels::of_file(bytes, layout, len).ok_or(wrong)?))
    }

    /// [`Image::new`] of the result of a filter, in slices of work.
    pub(crate) async fn filtered(size: [usize; 3], voxels: Vec<f32>) -> Result<Self, ImageError> {
        Self::of(size, AxisOrder::FirstFastest, Voxels::filtered(voxels)).await
    }

    /// The image with these voxels, one unit apart, checked in slices of work.
    async fn of(size: [usize; 3], order: AxisOrder, voxels: Voxels) -> Result<Self, ImageError> {
        let wanted = size.iter().try_fold(1_u64, |product, &n| product.checked_mul(n as u64));
        let found = voxels.len() as u64;
        if wanted != Some(found) {
            return Err(ImageError::Size { size, wanted: wanted.unwrap_or(u64::MAX), found });
        }
        if size.iter().any(|&n| n < 2) {
            return Err(ImageError::Flat { size });
        }
        let size = order.sorted(size);
        let range = voxels.range().await.map_err(|(count, first)| {
            let first = [first % size[0], first / size[0] % size[1], first / size[0] / size[1]];
            ImageError::NotFinite { count, first: order.sorted(first) }
        })?;
        if range[0] == range[1] {
            return Err(ImageError::Constant { value: range[0] });
        }
        let (histogram, notes) = Default::default();
        let placement = Placement::default().sorted(order);
        Ok(Self { size, voxels, placement, order, range, histogram, notes })
    }

    /// Sets the distances between neighbouring voxels along each axis, from the first axis of the
    /// array to the last; origin and directions stay.
    ///
    /// # Errors
    ///
    /// [`ImageError::Singular`] if a distance is not positive.
    pub fn with_spacing(self, spacing: [f64; 3]) -> Result<Self, ImageError> {
        let placement = self.placement();
        let [x, y, z] = placement.directions();
        let axes = [x * spacing[0], y * spacing[1], z * spacing[2]];
        if spacing.iter().any(|&length| length <= 0.0) {
            return Err(ImageError::Singular { axes });
        }
        let matrix = DMat3::from_cols(axes[0], axes[1], axes[2]);
        Ok(self.placed(Placement::new(matrix, placement.origin())?))
    }

    /// Moves voxel (0, 0, 0) to this point.
    ///
    /// # Errors
    ///
    /// [`ImageError::Singular`] if it is not finite.
    pub fn with_origin(self, origin: DVec3) -> Result<Self, ImageError> {
        let placement = Placement::new(self.placement().matrix(), origin)?;
        Ok(self.placed(placement))
    }

    /// Places the image by an affine map of its voxel indices: coordinate r is `rows[r]` · (i, j,
    /// k, 1), as in the affine matrix of a NIfTI file.
    ///
    /// # Errors
    ///
    /// [`ImageError::Singular`] if the map has no inverse or is not finite.
    pub fn with_affine(self, rows: [[f64; 4]; 3]) -> Result<Self, ImageError> {
        Ok(self.placed(Placement::from_rows(rows)?))
    }

    /// The image with this map from the indices along its axes.
    fn placed(self, placement: Placement) -> Self {
        Self { placement: placement.sorted(self.order), ..self }
    }

    /// The surface on which the image has the value `iso`, with brighter voxels inside. For the
    /// opposite see [`ImageField::inverted`].
    ///
    /// # Errors
    ///
    /// [`ImageError::Outside`] if no voxel, or every voxel, is brighter.
    pub fn at(&self, iso: f64) -> Result<ImageField, ImageError> {
        slices::complete(ImageField::made(self, iso, false))
    }

    /// Number of voxels along each axis, from the first axis of the array to the last.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        self.order.sorted(self.size)
    }

    /// The map from voxel indices to points.
    #[must_use]
    pub fn placement(&self) -> Placement {
        self.placement.sorted(self.order)
    }

    /// Smallest and largest value of the voxels.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The type in which the voxels are kept.
    #[must_use]
    pub fn voxel_type(&self) -> VoxelType {
        self.voxels.voxel_type()
    }

    /// What a reader decided where the file leaves a choice, in sentences for the user.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The iso value that best separates dark from bright voxels: the variance between the two
    /// classes is largest, on a histogram of 256 bins (N. Otsu, "A Threshold Selection Method from
    /// Gray-Level Histograms", IEEE Transactions on Systems, Man, and Cybernetics 9, 1979).
    #[must_use]
    pub fn otsu(&self) -> f64 {
        slices::complete(self.counted()).otsu()
    }

    /// The number of voxels in each of 256 bins of equal width, from the smallest value to the
    /// largest.
    #[must_use]
    pub fn histogram(&self) -> Vec<u64> {
        slices::complete(self.counted()).counts().to_vec()
    }

    /// The histogram, which is counted once, in slices of work.
    pub(crate) async fn counted(&self) -> &Histogram {
        if self.histogram.get().is_none() {
            let _ = self.histogram.set(Histogram::of(self).await);
        }
        self.histogram.get().expect("it was counted")
    }

    /// Bytes of memory that the voxels take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.voxels.bytes()
    }

    /// The middle of the range of the voxels. Filters work on values relative to it.
    fn middle(&self) -> f64 {
        0.5 * self.range[0] + 0.5 * self.range[1]
    }

    /// Writes the values of the voxels (0, j, k), (1, j, k), …, relative to `zero`.
    fn row(&self, j: usize, k: usize, zero: f64, out: &mut [f32]) {
        self.voxels.write(self.size[0] * (j + self.size[1] * k), zero, out);
    }

    /// The value of a voxel, by its indices from the fastest-changing axis on.
    fn voxel(&self, [i, j, k]: [usize; 3]) -> f64 {
        self.voxels.at(i + self.size[0] * (j + self.size[1] * k))
    }
}

#[cfg(test)]
mod tests;
