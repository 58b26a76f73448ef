//! Fields from three-dimensional images.

use crate::arguments::SurfaceArguments;
use crate::failure::Failure;
use crate::options::number;
use marching_particles::Image;
use marching_particles::image::{ImageChoice, ImageField, ImageSurface, RawVoxels, VoxelType};
use marching_particles::internal::math::{grouped, significant};
use serde::Serialize;

/// The image and its surface, for the report.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ImageInfo {
    /// Name of the file.
    pub(crate) name: String,
    /// Voxels along each axis.
    pub(crate) size: [usize; 3],
    /// Distances between voxels along each axis.
    pub(crate) spacing: [f64; 3],
    pub(crate) voxel_type: String,
    /// Smallest and largest voxel.
    pub(crate) range: [f64; 2],
    /// The value on the surface.
    pub(crate) iso: f64,
    /// Whether Otsu's method chose the value.
    pub(crate) is_otsu: bool,
    /// The label whose boundary is sampled.
    pub(crate) label: Option<f64>,
    /// Width of the Gaussian in voxels, 0 for none.
    pub(crate) smooth: f64,
    /// Whether the width was chosen: from the noise, or for a label the default.
    pub(crate) is_smooth_chosen: bool,
    /// Standard deviation of the noise, in the values of the voxels.
    pub(crate) noise: f64,
    /// Whether darker voxels are inside.
    pub(crate) is_dark_inside: bool,
    /// Whether the surface is closed at the border of the image.
    pub(crate) is_closed: bool,
    /// Notes of the reader.
    pub(crate) notes: Vec<String>,
    /// Bytes of the voxels, and further bytes of the field.
    pub(crate) bytes: [usize; 2],
}

/// The field of the image in a file, if one is requested.
pub(crate) fn of_arguments(arguments: &SurfaceArguments) -> Result<Option<(ImageField, ImageInfo)>, Failure> {
    let Some(path) = &arguments.image else { return Ok(None) };
    let unreadable = |error| Failure::Unreadable { path: path.clone(), error };
    let wrong = |error: &dyn std::fmt::Display| Failure::Usage(format!("{}: {error}", path.display()));
    std::fs::File::open(path).map_err(unreadable)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut image = match &arguments.raw {
        Some(raw) => {
            let bytes = std::fs::read(path).map_err(unreadable)?;
            Image::read_raw(bytes, raw).map_err(|error| wrong(&error))?
        }
        None => Image::open(path).map_err(|error| Failure::Usage(error.to_string()))?,
    };
    if let Some(VoxelSize(spacing)) = arguments.voxel_size {
        image = image.with_spacing(spacing).map_err(|error| wrong(&error))?;
    }
    let choice = ImageChoice {
        iso: arguments.iso,
        label: arguments.label,
        smooth: arguments.smooth,
        is_dark_inside: arguments.dark_inside,
        is_closed: arguments.close_border,
    };
    let surface = image.surface(&choice, None).map_err(|error| wrong(&error))?;
    let field = surface.field();
    let info = ImageInfo {
        name,
        size: image.size(),
        spacing: image.placement().spacing(),
        voxel_type: image.voxel_type().to_string(),
        range: image.range(),
        iso: field.iso(),
        is_otsu: arguments.iso.is_none() && arguments.label.is_none(),
        label: arguments.label,
        smooth: surface.smooth(),
        is_smooth_chosen: arguments.smooth.is_none(),
        noise: surface.noise(),
        is_dark_inside: arguments.dark_inside,
        is_closed: arguments.close_border,
        notes: notes(&image, &surface, arguments),
        bytes: [field.image().bytes(), field.bytes()],
    };
    Ok(Some((field.clone(), info)))
}

/// Notes of the reader and advice for the user.
fn notes(image: &Image, surface: &ImageSurface, arguments: &SurfaceArguments) -> Vec<String> {
    /// With at most this many different values an image may consist of labels.
    const FEW: usize = 32;
    let mut notes = surface.notes().to_vec();
    if arguments.label.is_none() && arguments.iso.is_none() {
        let labels = image.labels();
        if (2..=FEW).contains(&labels.len()) {
            let listed: Vec<String> = labels
                .iter()
                .map(|label| {
                    format!("{} ({} voxels)", significant(label.value), grouped(label.voxels as usize))
                })
                .collect();
            notes.push(format!(
                "The values look like labels, of which --label takes one: {}.",
                listed.join(", ")
            ));
        }
    }
    notes
}

/// Distances between voxels along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VoxelSize(pub(crate) [f64; 3]);

/// Three values with an `x` between them.
fn triple<T>(text: &str, value: impl Fn(&str) -> Option<T>) -> Option<[T; 3]> {
    let values: Option<Vec<T>> = text.split(['x', '×']).map(|word| value(word.trim())).collect();
    values?.try_into().ok()
}

/// [`VoxelSize`] from an argument.
pub(crate) fn voxel_size(text: &str) -> Result<VoxelSize, String> {
    let length = |word: &str| number(word).ok().filter(|length| *length > 0.0);
    let wrong = || format!("`{text}` is no three lengths above 0, such as 0.7x0.7x1.5");
    triple(text, length).map(VoxelSize).ok_or_else(wrong)
}

/// [`RawVoxels`] from an argument.
pub(crate) fn raw(text: &str) -> Result<RawVoxels, String> {
    let wrong = |what: &str| format!("{what}; an example is 256x256x128,uint16,big,skip=512");
    let mut words = text.split(',').map(str::trim);
    let size = triple(words.next().unwrap_or_default(), |word| word.parse().ok());
    let size = size.ok_or_else(|| wrong("the numbers of voxels along x, y and z come first"))?;
    let name = words.next().unwrap_or_default();
    let voxel_type = VoxelType::named(name).ok_or_else(|| {
        let names: Vec<String> = VoxelType::ALL.iter().map(VoxelType::to_string).collect();
        wrong(&format!("the type of the voxels is one of {}, not `{name}`", names.join(", ")))
    })?;
    let mut raw = RawVoxels { size, voxel_type, is_big_endian: false, skip: 0 };
    for word in words {
        match word.split_once('=') {
            None if word == "big" || word == "little" => raw.is_big_endian = word == "big",
            Some(("skip", bytes)) => {
                raw.skip = bytes.parse().map_err(|_| wrong("skip is a number of bytes"))?;
            }
            _ => return Err(wrong(&format!("`{word}` is neither big, little nor skip=BYTES"))),
        }
    }
    Ok(raw)
}

impl ImageInfo {
    /// The lines of the report.
    pub(crate) fn lines(&self) -> Vec<String> {
        let [x, y, z] = self.size;
        let spacing = self.spacing.map(significant).join(" × ");
        let [min, max] = self.range.map(significant);
        let chosen = if self.is_otsu { " (Otsu's; --iso sets another)" } else { "" };
        let inside = if self.is_dark_inside { "darker" } else { "brighter" };
        let surface = match self.label {
            Some(label) => format!("surface of the label {}", significant(label)),
            None => format!("surface at the value {}{chosen}, {inside} voxels inside", significant(self.iso)),
        };
        let surface = if self.is_closed { surface + ", closed at the border of the image" } else { surface };
        let mut lines = vec![
            format!("image: {}", self.name),
            format!("{x} × {y} × {z} voxels of {spacing}, {}, {min} to {max}", self.voxel_type),
            surface,
        ];
        if self.smooth > 0.0 {
            let width = significant(self.smooth);
            let (what, why) = match self.label {
                Some(_) => ("the distance from the label", "against the steps between voxels".to_owned()),
                None if self.noise == 0.0 => {
                    ("the voxels", "against the steps between whole numbers".to_owned())
                }
                None => ("the voxels", format!("against noise of {}", significant(self.noise))),
            };
            let chosen = if self.is_smooth_chosen { "; --smooth sets another width" } else { "" };
            lines.push(format!(
                "{what} smoothed by a Gaussian of {width} voxels {why}: it rounds corners by about as much{chosen}"
            ));
        }
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines
    }
}
