//! Files of points and of meshes: PLY, OBJ, STL and XYZ, told apart by their content and not by their name.
//!
//! A file is read row by row under a budget, so that whoever calls can show how far it has come, and nothing in it is
//! believed: what a header claims is compared with the size of the file before memory is asked for, and a mistake is
//! named with its place.

mod format;
mod input;
mod mesh;
mod obj;
mod ply;
mod ply_header;
mod stl;
mod xyz;

pub use format::Format;
pub use mesh::Mesh;

use input::Input;

/// The longest file that is read, in bytes. Fifty million hold some millions of points, ten thousand times more than an
/// interpolant can have centres.
pub const MAX_BYTES: u64 = 50_000_000;

/// Why a file is not read: what, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// There is nothing in it.
    #[error("the file is empty; choose one that holds points")]
    Empty,
    /// It is longer than [`MAX_BYTES`].
    #[error(
        "the file has {} MB, and up to {} MB are read; keep fewer points, for example every tenth",
        bytes.div_ceil(1_000_000), MAX_BYTES / 1_000_000
    )]
    TooLarge {
        /// Its size.
        bytes: u64,
    },
    /// It is in none of the formats.
    #[error("this is {found}, and what is read is PLY, OBJ, STL and XYZ; {advice}")]
    Unknown {
        /// What it looks like.
        found: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// A mistake in a text file or in a header.
    #[error("line {line}: {message}")]
    Line {
        /// Number of the line, from 1.
        line: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A mistake in a binary file.
    #[error("{element} {row}, {byte} bytes into the file: {message}")]
    Row {
        /// Kind of the row.
        element: String,
        /// Number of the row among its kind, from 1.
        row: u64,
        /// Where it begins.
        byte: u64,
        /// What is wrong with it.
        message: String,
    },
    /// A header that promises more than the file can hold.
    #[error(
        "the header promises {count} {element} rows, which take at least {needed} bytes, and {left} bytes follow; \
         the file is cut off or its header is wrong: export it again"
    )]
    Claim {
        /// Kind of the rows.
        element: String,
        /// Their number.
        count: u64,
        /// Bytes that all rows up to these take at the least.
        needed: u64,
        /// Bytes after the header.
        left: u64,
    },
    /// The memory does not hold it.
    #[error("there is not enough memory for this file; keep fewer points, for example every tenth")]
    Memory,
    /// It was read to the end, and nothing came of it.
    #[error("there are no points in this {format} file; choose one that holds points")]
    NoPoints {
        /// The format it was read as.
        format: Format,
    },
}

impl ReadError {
    /// A word for the kind of mistake, for programs.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::TooLarge { .. } => "too_large",
            Self::Unknown { .. } => "unknown_format",
            Self::Line { .. } => "line",
            Self::Row { .. } => "row",
            Self::Claim { .. } => "claim",
            Self::Memory => "memory",
            Self::NoPoints { .. } => "no_points",
        }
    }
}

/// Whether a file of this size is read; to be asked before its content is.
///
/// # Errors
///
/// If it is empty or longer than [`MAX_BYTES`].
pub fn check_size(bytes: u64) -> Result<(), ReadError> {
    match bytes {
        0 => Err(ReadError::Empty),
        1..=MAX_BYTES => Ok(()),
        _ => Err(ReadError::TooLarge { bytes }),
    }
}

/// Appends to a column that grows by half, and never ends the program for want of memory.
fn push<T>(column: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    /// The first room taken.
    const FIRST: usize = 1024;
    if column.len() == column.capacity() {
        column.try_reserve_exact((column.len() / 2).max(FIRST)).map_err(|_| ReadError::Memory)?;
    }
    column.push(item);
    Ok(())
}

/// What the formats have in common: one row after another.
trait Rows {
    /// Reads a row; false after the last one.
    fn row(&mut self, input: &mut Input, mesh: &mut Mesh) -> Result<bool, ReadError>;
}

/// A file on its way to a [`Mesh`].
pub struct Reader {
    format: Format,
    input: Input,
    rows: Box<dyn Rows>,
    mesh: Mesh,
    done: bool,
}

impl Reader {
    /// Looks at size, kind and header. Of `name` only the ending is used, where the content leaves a doubt.
    ///
    /// # Errors
    ///
    /// If the file is empty, too long, in none of the formats, or its header is wrong.
    pub fn new(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        check_size(bytes.len() as u64)?;
        let format = format::sniff(name, &bytes)?;
        let mut input = Input::new(bytes);
        let mut mesh = Mesh::default();
        let rows: Box<dyn Rows> = match format {
            Format::Ply => Box::new(ply::Ply::new(&mut input, &mut mesh)?),
            Format::Obj => Box::new(obj::Obj::default()),
            Format::StlText => Box::new(stl::Text::default()),
            Format::StlBinary => Box::new(stl::Binary::new(&mut input)?),
            Format::Xyz => Box::new(xyz::Xyz::new(&input, &mut mesh)),
        };
        if let Some(ending) = format.other_ending(name) {
            mesh.warnings.push(format!(
                "The name ends in .{ending}, the content is {format}; it was read as {format}."
            ));
        }
        Ok(Self { format, input, rows, mesh, done: false })
    }

    /// The format that the content has.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Reads up to `rows` rows (lines, records); true when all are read.
    ///
    /// # Errors
    ///
    /// What is wrong with a row, by its number. The reader is of no further use then.
    pub fn step(&mut self, rows: u32) -> Result<bool, ReadError> {
        for _ in 0..rows {
            if self.done {
                break;
            }
            self.done = !self.rows.row(&mut self.input, &mut self.mesh)?;
        }
        if self.done && self.mesh.position.is_empty() {
            return Err(ReadError::NoPoints { format: self.format });
        }
        Ok(self.done)
    }

    /// How much of the file is read, from 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.done { 1.0 } else { self.input.fraction() }
    }

    /// What was read.
    #[must_use]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }
}
