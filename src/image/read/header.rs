//! Shared by the readers of headers: numbers in either byte order, and lines of text.

use super::{ImageFormat, ImageReadError};
use crate::image::voxels::VoxelType;

/// Upper limit on the size of a header, in bytes.
pub(super) const LONGEST: usize = 1 << 18;

/// An error in an entry of a header.
#[cold]
pub(super) fn wrong(
    format: ImageFormat,
    entry: impl Into<String>,
    message: impl Into<String>,
) -> ImageReadError {
    ImageReadError::Header { format, entry: entry.into(), message: message.into() }
}

/// A part of a file, shortened and without control characters, to be quoted in a message.
pub(super) fn quoted(text: &str) -> String {
    /// Longer than the name of a type, shorter than a line.
    const SHOWN: usize = 40;
    let mut shown: String =
        text.trim().chars().take(SHOWN).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.trim().chars().count() > SHOWN {
        shown.push('…');
    }
    format!("`{shown}`")
}

/// Numbers at given offsets of a binary header.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) is_big_endian: bool,
}

macro_rules! field {
    ($($name:ident: $number:ty),*) => {
        $(
            /// The number at an offset; 0 beyond the end.
            pub(super) fn $name(self, at: usize) -> $number {
                let bytes = self.bytes.get(at..at + size_of::<$number>());
                let bytes = bytes.and_then(|bytes| bytes.try_into().ok()).unwrap_or_default();
                if self.is_big_endian { <$number>::from_be_bytes(bytes) } else { <$number>::from_le_bytes(bytes) }
            }
        )*
    };
}

impl Fields<'_> {
    field!(i16: i16, i32: i32, i64: i64, f32: f32, f64: f64);
}

/// The lines of a text header up to the first empty one, without line ends. Each comes with its
/// number from 1 and the offset of the byte after it.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &str, usize)> {
    let mut at = 0;
    let mut number = 0;
    core::iter::from_fn(move || {
        let rest = bytes.get(at..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        at += (end + 1).min(rest.len());
        number += 1;
        let line = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        // After the header come bytes that are not text.
        Some((number, core::str::from_utf8(line).ok()?, at))
    })
}

/// The numbers of a text, separated by white space.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

/// The type that a name stands for in NRRD files and in C.
pub(super) fn type_of_name(name: &str) -> Option<VoxelType> {
    Some(match name {
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => VoxelType::U8,
        "signed char" | "int8" | "int8_t" => VoxelType::I8,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => VoxelType::U16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => VoxelType::I16,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => VoxelType::U32,
        "int" | "signed int" | "int32" | "int32_t" => VoxelType::I32,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            VoxelType::U64
        }
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => VoxelType::I64,
        "float" => VoxelType::F32,
        "double" => VoxelType::F64,
        _ => return None,
    })
}

/// The note that only the first of several volumes or values is read.
pub(super) fn first_of(count: usize, what: &str) -> String {
    format!("The file has {count} {what}; the first is read.")
}
