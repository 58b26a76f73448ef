//! Readers of image files (NIfTI, NRRD, NumPy, MetaImage, Gaussian cube and TIFF, detected by
//! content) and of voxels without a header.
//!
//! A file is not trusted: the sizes in its header are compared with the data before memory is
//! allocated, and compressed data is unpacked only up to the size in the header. The voxels keep
//! the bytes of the file.

mod cube;
mod header;
mod metaimage;
mod nifti;
mod npy;
mod nrrd;
mod tiff;
mod zip;

use super::voxels::{Layout, VoxelType, Voxels};
use super::{AxisOrder, Image, ImageError, Placement};
use crate::slices;
use core::fmt::{self, Display, Formatter};
use glam::{DMat3, DVec3};
use header::{quoted, wrong};
use std::io;
use std::path::Path;
use zip::Unpacked;

/// Upper limit on the size of the voxels of a file, in bytes: 1024³ voxels of 16 bits.
pub const MAX_IMAGE_BYTES: u64 = 1 << 31;

/// File formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageFormat {
    /// NIfTI-1 and NIfTI-2, in one file or as a header with a separate data file.
    Nifti,
    /// Nearly raw raster data, in one file or with a separate data file.
    Nrrd,
    /// An array of NumPy.
    Npy,
    /// MetaImage of ITK, in one file or with a separate data file.
    MetaImage,
    /// Cube file of Gaussian.
    Cube,
    /// Stack of TIFF pictures.
    Tiff,
    /// Voxels without a header.
    Raw,
}

impl Display for ImageFormat {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nifti => "NIfTI",
            Self::Nrrd => "NRRD",
            Self::Npy => "NumPy",
            Self::MetaImage => "MetaImage",
            Self::Cube => "cube",
            Self::Tiff => "TIFF",
            Self::Raw => "raw",
        })
    }
}

/// Why a file of an image cannot be read. The message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageReadError {
    /// The file is empty.
    #[error("the file is empty; choose one that holds an image")]
    Empty,
    /// The file is in no known format.
    #[error(
        "this is {found}, and what is read is NIfTI, NRRD, NumPy, MetaImage, Gaussian cube and TIFF; {advice}"
    )]
    Unknown {
        /// Name of the format that the content resembles.
        found: &'static str,
        /// Advice for the user.
        advice: &'static str,
    },
    /// An entry of the header is wrong.
    #[error("{format} header, {entry}: {message}")]
    Header {
        /// Format of the file.
        format: ImageFormat,
        /// The line or the field.
        entry: String,
        /// The error in words.
        message: String,
    },
    /// The file ends too early.
    #[error(
        "the {format} header promises {needed} bytes of voxels, and {found} follow; the file is cut off or its header \
         is wrong: export it again"
    )]
    CutOff {
        /// Format of the file.
        format: ImageFormat,
        /// Bytes that the header promises.
        needed: u64,
        /// Bytes that the file has.
        found: u64,
    },
    /// The voxels take more than [`MAX_IMAGE_BYTES`].
    #[error(
        "the image has {} MB of voxels, and up to {} MB are read; cut out the part that matters, or keep every \
         second voxel",
        bytes.div_ceil(1_000_000), MAX_IMAGE_BYTES / 1_000_000
    )]
    TooLarge {
        /// Bytes of the voxels.
        bytes: u64,
    },
    /// Compressed data cannot be unpacked.
    #[error(
        "the compressed data is damaged after {unpacked} bytes ({message}); copy or export the file again"
    )]
    Damaged {
        /// Bytes that could be unpacked.
        unpacked: u64,
        /// The error in words.
        message: String,
    },
    /// The voxels are in a separate file, which cannot be read.
    #[error(
        "the voxels of this {format} header are in the file {name} beside it, which cannot be read: {message}"
    )]
    Beside {
        /// Format of the header.
        format: ImageFormat,
        /// Name of the file.
        name: String,
        /// Why it cannot be read.
        message: String,
    },
    /// The voxels do not form an image.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// Returns the file of a given name in the folder of the header.
type Beside<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

/// The contents of a header.
struct Header {
    format: ImageFormat,
    /// Voxels along the axes of the array, and which of them changes fastest.
    size: [usize; 3],
    order: AxisOrder,
    /// The step from voxel to voxel along each of these axes, and the first voxel's position.
    axes: [DVec3; 3],
    origin: DVec3,
    layout: Layout,
    /// Whether the voxels are compressed separately from the header, by gzip or zlib.
    is_packed: bool,
    source: Source,
    notes: Vec<String>,
}

/// Where the voxels are.
enum Source {
    /// In the file itself, from this byte on.
    Here(usize),
    /// In another file with this name.
    Beside(String),
}

/// Reads a file by its name and content. The error has the path.
pub(crate) fn opened<T, E: Display>(
    path: &Path,
    read: impl FnOnce(&str, Vec<u8>) -> Result<T, E>,
) -> io::Result<T> {
    let bytes = std::fs::read(path).map_err(|error| {
        io::Error::new(error.kind(), format!("{} could not be read: {error}", path.display()))
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    read(&name, bytes)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("{}: {error}", path.display())))
}

impl Image {
    /// Opens a file: see [`Image::read`]. If its voxels are in another file, that is read from the
    /// same folder.
    ///
    /// # Errors
    ///
    /// If a file cannot be opened; as for [`Image::read`] with [`io::ErrorKind::InvalidData`]. The
    /// message begins with the path.
    ///
    /// ```no_run
    /// use marching_particles::{Image, Settings, sample};
    ///
    /// let bone = Image::open("scan.nii.gz")?.at(1_200.0)?;
    /// sample(bone, &Settings::with_count(20_000))?.save("bone.ply")?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        let path = path.as_ref();
        let beside = |name: &str| {
            // A file names no other folder.
            if Path::new(name).components().count() != 1 || Path::new(name).file_name().is_none() {
                return Err("it is not in the same folder".to_owned());
            }
            std::fs::read(path.with_file_name(name)).map_err(|error| error.to_string())
        };
        opened(path, |name, bytes| Self::read(name, bytes, beside))
    }

    /// Reads a file: NIfTI-1 or -2 (`.nii`, `.nii.gz`, or `.hdr` with `.img`), NRRD (`.nrrd`,
    /// `.nhdr`), NumPy (`.npy`), MetaImage (`.mha`, `.mhd`), Gaussian cube (`.cube`) or a stack of
    /// TIFF pictures (`.tif`). The content decides, not the name. If a file has several volumes, or
    /// several values per voxel, the first is read and a [note](Image::notes) says so. Lengths are
    /// in the unit of the file: millimetres in medical images, bohr in cubes.
    ///
    /// `name` is the name of the file without its folder. If the voxels are in another file,
    /// `beside` is called with that file's name and returns its bytes.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, or its voxels do not form an image. The error says what is
    /// wrong, where, and what to do.
    pub fn read(
        name: &str,
        bytes: Vec<u8>,
        beside: impl Fn(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ImageReadError> {
        slices::complete(Self::read_in_slices(name.to_owned(), bytes, beside))
    }

    /// [`Image::read`] in slices of work.
    ///
    /// # Errors
    ///
    /// As for [`Image::read`].
    #[doc(hidden)]
    pub async fn read_in_slices(
        name: String,
        bytes: Vec<u8>,
        beside: impl Fn(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ImageReadError> {
        if bytes.is_empty() {
            return Err(ImageReadError::Empty);
        }
        // Of a compressed file, first only the header is unpacked; it says how much follows.
        let mut file = Unpacked::new(bytes);
        let start = file.start(header::LONGEST).await?;
        match sniff(&start)? {
            ImageFormat::Cube => cube::read(file).await,
            ImageFormat::Tiff => tiff::read(file).await,
            format => image(header(format, &name, &start)?, file, &beside).await,
        }
    }
}

/// The header of a file in a format with a separate header.
fn header(format: ImageFormat, name: &str, start: &[u8]) -> Result<Header, ImageReadError> {
    match format {
        ImageFormat::Nifti => nifti::header(name, start),
        ImageFormat::Nrrd => nrrd::header(start),
        ImageFormat::Npy => npy::header(start),
        ImageFormat::MetaImage => metaimage::header(start),
        ImageFormat::Cube | ImageFormat::Tiff | ImageFormat::Raw => {
            unreachable!("these are read as a whole")
        }
    }
}

/// How the bytes of a file without a header encode voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawVoxels {
    /// Voxels along each axis, the fastest-changing one first.
    pub size: [usize; 3],
    /// Their type.
    pub voxel_type: VoxelType,
    /// Whether the most significant byte of a number comes first.
    pub is_big_endian: bool,
    /// Bytes before the first voxel.
    pub skip: u64,
}

impl Image {
    /// Reads a file that has no header, or an unknown one: its voxels, one unit apart, from byte
    /// `skip` on. A file that is compressed by gzip is unpacked.
    ///
    /// # Errors
    ///
    /// If the file is too short, or its voxels do not form an image.
    pub fn read_raw(bytes: Vec<u8>, raw: &RawVoxels) -> Result<Self, ImageReadError> {
        let RawVoxels { size, voxel_type, is_big_endian, skip } = *raw;
        let first = usize::try_from(skip).unwrap_or(usize::MAX);
        let header = Header {
            format: ImageFormat::Raw,
            size,
            order: AxisOrder::FirstFastest,
            axes: DVec3::AXES,
            origin: DVec3::ZERO,
            layout: Layout::plain(voxel_type, is_big_endian),
            is_packed: false,
            source: Source::Here(first),
            notes: Vec::new(),
        };
        slices::complete(image(header, Unpacked::new(bytes), &|_| Err(String::new())))
    }
}

/// What the header of a file says about its voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageOutline {
    /// Voxels along each axis.
    pub size: [usize; 3],
    /// Their type.
    pub voxel_type: VoxelType,
}

impl ImageOutline {
    /// Bytes of memory that the voxels take while they are read and filtered: once as they are, and
    /// twice in single precision.
    #[must_use]
    pub fn memory(&self) -> u64 {
        let voxel = self.voxel_type.bytes() as u64 + 2 * VoxelType::F32.bytes() as u64;
        self.size.iter().fold(voxel, |product, &n| product.saturating_mul(n as u64))
    }

    /// Bytes of the voxels alone.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let voxel = self.voxel_type.bytes() as u64;
        self.size.iter().fold(voxel, |product, &n| product.saturating_mul(n as u64))
    }

    /// Estimated number of slices of work to read the file and to find its facts.
    #[must_use]
    pub fn slices(&self) -> u64 {
        let count = self.size.iter().fold(1_u64, |product, &n| product.saturating_mul(n as u64));
        // Three passes over the voxels: for their range, the labels and the histogram.
        self.bytes() / zip::UNPACKED_AT_ONCE + count.saturating_mul(3) / slices::LIGHT as u64
    }
}

impl Image {
    /// Returns the size and type of the voxels from the header in the first bytes of a file; a
    /// megabyte is enough. Returns nothing for a cube file or a TIFF stack, which must be read
    /// completely.
    ///
    /// # Errors
    ///
    /// If it is not an image file, or its header is wrong.
    pub fn outline(name: &str, start: &[u8]) -> Result<Option<ImageOutline>, ImageReadError> {
        if start.is_empty() {
            return Err(ImageReadError::Empty);
        }
        let start = slices::complete(Unpacked::new(start.to_vec()).start(header::LONGEST))?;
        let format = sniff(&start)?;
        if matches!(format, ImageFormat::Cube | ImageFormat::Tiff) {
            return Ok(None);
        }
        let Header { size, layout, .. } = header(format, name, &start)?;
        Ok(Some(ImageOutline { size, voxel_type: layout.voxel_type }))
    }
}

/// Reads the voxels that a header describes.
async fn image(header: Header, file: Unpacked, beside: Beside<'_>) -> Result<Image, ImageReadError> {
    let Header { format, size, order, axes, origin, mut layout, is_packed, source, notes } = header;
    let voxel = (layout.voxel_type.bytes() as u64).saturating_mul(layout.step as u64);
    let needed = size.iter().fold(voxel, |product, &n| product.saturating_mul(n as u64));
    if needed > MAX_IMAGE_BYTES {
        return Err(ImageReadError::TooLarge { bytes: needed });
    }
    if size.contains(&0) {
        return Err(ImageError::Flat { size }.into());
    }
    let (mut file, mut first) = match source {
        Source::Here(first) => (file, first),
        Source::Beside(name) => {
            if name.contains(char::is_control) {
                let message = format!("{} has control characters; correct it", quoted(&name));
                return Err(wrong(format, "name of the data file", message));
            }
            let bytes = beside(&name).map_err(|message| {
                // The name comes from a file and is shown, so it is escaped.
                let name = name.escape_debug().take(80).collect();
                ImageReadError::Beside { format, name, message }
            })?;
            (Unpacked::new(bytes), layout.first)
        }
    };
    if is_packed {
        let mut inner = file.all(MAX_IMAGE_BYTES).await?;
        inner.drain(..first.min(inner.len()));
        (file, first) = (Unpacked::packed(inner), 0);
    }
    let data = file.all(needed.saturating_add(first as u64)).await?;
    layout.first = first;
    let found = (data.len() as u64).saturating_sub(layout.first as u64);
    let len = (needed / voxel) as usize;
    let cut_off = ImageReadError::CutOff { format, needed, found };
    let voxels = Voxels::of_file(data, layout, len).ok_or(cut_off)?;
    let image = Image::of(size, order, voxels).await?;
    let placement = Placement::new(DMat3::from_cols(axes[0], axes[1], axes[2]), origin)?;
    Ok(Image { notes: notes.into(), ..image }.placed(placement))
}

/// First bytes of other formats, with the format's name and advice for the user.
const KNOWN: [(&[u8], &str, &str); 6] = [
    (b"PK\x03\x04", "a ZIP archive (npz is such)", "unpack it first"),
    (b"\x89HDF", "an HDF5 file (MINC is such)", "convert it to NIfTI"),
    (b"ply", "a file of points", "give it as points"),
    (b"\x89PNG", "a PNG picture", "give a volume, not a single slice"),
    (b"\xff\xd8\xff", "a JPEG picture", "give a volume, not a single slice"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
];

/// Detects the format of a file by its first bytes.
fn sniff(start: &[u8]) -> Result<ImageFormat, ImageReadError> {
    if let Some(&(_, found, advice)) = KNOWN.iter().find(|(magic, ..)| start.starts_with(magic)) {
        return Err(ImageReadError::Unknown { found, advice });
    }
    if start.get(128..132) == Some(b"DICM") {
        let advice = "convert the series to NIfTI, as dcm2niix does";
        return Err(ImageReadError::Unknown { found: "a slice in DICOM", advice });
    }
    if nifti::begins_with(start) {
        return Ok(ImageFormat::Nifti);
    }
    if start.starts_with(b"NRRD0") {
        return Ok(ImageFormat::Nrrd);
    }
    if start.starts_with(npy::MAGIC) {
        return Ok(ImageFormat::Npy);
    }
    if [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| start.starts_with(*magic)) {
        return Ok(ImageFormat::Tiff);
    }
    if metaimage::begins_with(start) {
        return Ok(ImageFormat::MetaImage);
    }
    if cube::begins_with(start) {
        return Ok(ImageFormat::Cube);
    }
    let advice = "choose a file of an image";
    Err(ImageReadError::Unknown { found: "a file of no known kind", advice })
}

#[cfg(test)]
mod tests;
