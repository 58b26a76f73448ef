//! Reader of files of points and meshes: PLY, OBJ, STL, OFF, GLB, 3MF, PCD, and text with one point
//! on a line, detected by content.
//!
//! A file is read in slices of work, so the caller can show progress. Its content is not trusted:
//! the counts in a header are compared with the size of the file before memory is allocated, and
//! errors name their place in the file.

mod format;
mod glb;
mod input;
mod mesh;
mod obj;
mod off;
mod pcd;
mod ply;
mod ply_header;
mod stl;
#[cfg(feature = "images")]
mod three_mf;
mod xyz;

pub use format::InputFormat;
pub use mesh::FileMesh;

use super::thin;
use crate::field::model::MAX_FILE_BYTES;
use input::Input;

/// Why a file cannot be read. The message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file is empty.
    #[error("the file is empty; choose one that holds points")]
    Empty,
    /// The file is larger than [`MAX_FILE_BYTES`].
    #[error(
        "the file has {} MB, and up to {} MB are read; keep fewer points, for example every tenth",
        bytes.div_ceil(1_000_000), MAX_FILE_BYTES / 1_000_000
    )]
    TooLarge {
        /// Size of the file.
        bytes: u64,
    },
    /// The file is in no known format.
    #[error(
        "this is {found}, and what is read is {} and text with one point on a line (XYZ, PTS, CSV); {advice}",
        format::names()
    )]
    Unknown {
        /// Name of the format that the content resembles.
        found: &'static str,
        /// Advice for the user.
        advice: &'static str,
    },
    /// A line of a text file or of a header is wrong.
    #[error("line {line}: {message}")]
    Line {
        /// Number of the line, from 1.
        line: u64,
        /// The error in words.
        message: String,
    },
    /// A row of a binary file is wrong.
    #[error("{element} {row}, {byte} bytes into the file: {message}")]
    Row {
        /// Kind of the row.
        element: String,
        /// Number of the row among its kind, from 1.
        row: u64,
        /// Offset of the row in the file.
        byte: u64,
        /// The error in words.
        message: String,
    },
    /// The header claims more rows than the file can hold.
    #[error(
        "the header promises {count} {element} rows, which take at least {needed} bytes, and {left} bytes follow; \
         the file is cut off or its header is wrong: export it again"
    )]
    Claim {
        /// Kind of the rows.
        element: String,
        /// Number of the rows.
        count: u64,
        /// Minimum number of bytes of all rows up to and including these.
        needed: u64,
        /// Number of bytes after the header.
        left: u64,
    },
    /// A part of a glTF or 3MF document is wrong.
    #[error("{member}: {message}")]
    Member {
        /// Name of the part in the document, as `accessors[3]`.
        member: String,
        /// The error in words.
        message: String,
    },
    /// There is not enough memory for the file.
    #[error("there is not enough memory for this file; keep fewer points, for example every tenth")]
    Memory,
    /// The file has no points.
    #[error("there are no points in this {format} file; choose one that holds points")]
    NoPoints {
        /// Format in which the file was read.
        format: InputFormat,
    },
}

/// Checks the size of a file before it is loaded.
///
/// # Errors
///
/// If the file is empty or larger than [`MAX_FILE_BYTES`].
pub fn check_size(bytes: u64) -> Result<(), ReadError> {
    match bytes {
        0 => Err(ReadError::Empty),
        _ if bytes <= MAX_FILE_BYTES.into() => Ok(()),
        _ => Err(ReadError::TooLarge { bytes }),
    }
}

/// The error of a part of a glTF or 3MF document. The message may quote the document: control
/// characters are replaced.
fn wrong(member: impl Into<String>, message: impl Into<String>) -> ReadError {
    let [member, message] =
        [member.into(), message.into()].map(|text| text.replace(char::is_control, "\u{fffd}"));
    ReadError::Member { member, message }
}

/// Appends to a column.
fn push<T>(column: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    thin::push(column, item).ok_or(ReadError::Memory)
}

/// Reader of a file whose format is known.
pub struct Reader {
    format: InputFormat,
    bytes: Vec<u8>,
    mesh: FileMesh,
}

impl Reader {
    /// Checks the size and detects the format. The extension of `name` is used only if the content
    /// is ambiguous.
    ///
    /// # Errors
    ///
    /// If the file is empty, too large or of an unknown format.
    pub fn new(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        check_size(bytes.len() as u64)?;
        Self::of_any_size(name, bytes)
    }

    fn of_any_size(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let format = format::sniff(name, &bytes)?;
        let mut mesh = FileMesh::default();
        if let Some(extension) = format.contradicting_extension(name) {
            mesh.warnings.push(format!(
                "The name ends in .{extension}, the content is {format}; it was read as {format}."
            ));
        }
        Ok(Self { format, bytes, mesh })
    }

    /// [`Reader::new`] for a mesh of any size that is kept whole.
    ///
    /// # Errors
    ///
    /// As for [`Reader::new`].
    #[cfg(feature = "images")]
    pub(crate) fn of_mesh(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        Self::of_any_size(name, bytes)
    }

    /// Detected format.
    #[must_use]
    pub fn format(&self) -> InputFormat {
        self.format
    }

    /// Reads the header and all rows, that is points and faces. Points with a coordinate that is
    /// not finite are left out, with a warning that counts them. `tell` gets the fraction of the
    /// file that has been read.
    ///
    /// # Errors
    ///
    /// An error with the number of the row that cannot be read, an error in the header, or
    /// [`ReadError::NoPoints`].
    pub async fn read(self, tell: impl Fn(f64)) -> Result<FileMesh, ReadError> {
        let Self { format, bytes, mut mesh } = self;
        let mut input = Input::new(&bytes, &tell);
        match format {
            InputFormat::Ply => ply::read(&mut input, &mut mesh).await,
            InputFormat::Obj => obj::read(&mut input, &mut mesh).await,
            InputFormat::StlText => stl::read_text(&mut input, &mut mesh).await,
            InputFormat::StlBinary => stl::read_binary(&mut input, &mut mesh).await,
            InputFormat::Off => off::read(&mut input, &mut mesh).await,
            InputFormat::Pcd => pcd::read(&mut input, &mut mesh).await,
            InputFormat::Glb => glb::read(&mut input, &mut mesh).await,
            #[cfg(feature = "images")]
            InputFormat::ThreeMf => three_mf::read(&mut input, &mut mesh).await,
            InputFormat::Xyz => xyz::read(&mut input, &mut mesh).await,
        }?;
        mesh.complete_colours()?;
        mesh.leave_out_undefined()?;
        if mesh.position.is_empty() {
            return Err(ReadError::NoPoints { format });
        }
        Ok(mesh)
    }
}
