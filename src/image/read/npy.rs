//! Arrays of NumPy (NEP 1, "A Simple File Format for NumPy Arrays").

use super::header::{first_of, quoted, wrong};
use super::{Header, ImageFormat, ImageReadError, Source};
use crate::image::AxisOrder;
use crate::image::voxels::{Layout, VoxelType};
use glam::DVec3;

const FORMAT: ImageFormat = ImageFormat::Npy;
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// An array a[i, j, k] becomes an image with voxel (i, j, k) at the point (i, j, k), the order in
/// which nibabel loads images.
pub(super) fn header(start: &[u8]) -> Result<Header, ImageReadError> {
    let cut = || wrong(FORMAT, "length", "the file ends within its header; save it again");
    let version = *start.get(6).ok_or_else(cut)?;
    let (length, from): (usize, usize) = match *start.get(8..12).ok_or_else(cut)? {
        [a, b, ..] if version == 1 => (usize::from(u16::from_le_bytes([a, b])), 10),
        [a, b, c, d] => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
        _ => return Err(cut()),
    };
    let end = from.checked_add(length).ok_or_else(cut)?;
    let text = String::from_utf8_lossy(start.get(from..end).ok_or_else(cut)?).into_owned();
    let descr =
        entry(&text, "descr").ok_or_else(|| wrong(FORMAT, "descr", "it is missing; save the array again"))?;
    let (voxel_type, is_big_endian) = voxel_type(descr)?;
    let is_fortran = entry(&text, "fortran_order").is_some_and(|value| value.starts_with("True"));
    let shape = entry(&text, "shape").and_then(|value| value.strip_prefix('(')?.split(')').next());
    let shape: Option<Vec<usize>> = shape.and_then(|shape| {
        shape
            .split(',')
            .map(str::trim)
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().ok())
            .collect()
    });
    let shape = shape
        .ok_or_else(|| wrong(FORMAT, "shape", "it is no list of whole numbers; save the array again"))?;
    let mut notes = Vec::new();
    let (size, step) = match shape[..] {
        [x, y, z] => ([x, y, z], 1),
        // The volumes are along the axis that changes slowest, so the first volume comes first.
        [x, y, z, n] if is_fortran => {
            notes.push(first_of(n, "volumes"));
            ([x, y, z], 1)
        }
        [x, y, z, n] => {
            notes.push(first_of(n, "values for each voxel"));
            ([x, y, z], n.max(1))
        }
        _ => {
            let message = format!("it has {} axes, and an image has three; save one volume", shape.len());
            return Err(wrong(FORMAT, "shape", message));
        }
    };
    Ok(Header {
        format: FORMAT,
        size,
        order: if is_fortran { AxisOrder::FirstFastest } else { AxisOrder::LastFastest },
        axes: DVec3::AXES,
        origin: DVec3::ZERO,
        layout: Layout { step, ..Layout::plain(voxel_type, is_big_endian) },
        is_packed: false,
        source: Source::Here(end),
        notes,
    })
}

/// Returns the text after `'name':` in the dictionary of the header; none without that entry.
fn entry<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) =
        [format!("'{name}'"), format!("\"{name}\"")].iter().find_map(|key| text.split_once(key.as_str()))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// The type and the byte order of a `descr` such as `'<f4'`.
fn voxel_type(descr: &str) -> Result<(VoxelType, bool), ImageReadError> {
    let word = descr.trim_start_matches(['\'', '"']).split(['\'', '"', ',']).next().unwrap_or_default();
    let kind = word.trim_start_matches(['<', '>', '=', '|']);
    let known = match kind {
        "u1" | "b1" => VoxelType::U8,
        "i1" => VoxelType::I8,
        "u2" => VoxelType::U16,
        "i2" => VoxelType::I16,
        "u4" => VoxelType::U32,
        "i4" => VoxelType::I32,
        "u8" => VoxelType::U64,
        "i8" => VoxelType::I64,
        "f4" => VoxelType::F32,
        "f8" => VoxelType::F64,
        _ => {
            let message =
                format!("voxels of type {} are not read; convert them with astype('float32')", quoted(word));
            return Err(wrong(FORMAT, "descr", message));
        }
    };
    Ok((known, word.starts_with('>')))
}
