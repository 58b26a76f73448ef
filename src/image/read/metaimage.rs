//! MetaImage, the format of ITK.

use super::header::{first_of, lines, numbers, quoted, wrong};
use super::{Header, ImageFormat, ImageReadError, Source};
use crate::image::AxisOrder;
use crate::image::voxels::{Layout, VoxelType};
use glam::DVec3;

const FORMAT: ImageFormat = ImageFormat::MetaImage;

pub(super) fn begins_with(start: &[u8]) -> bool {
    lines(start).next().is_some_and(|(_, line, _)| {
        line.split_once('=').is_some_and(|(key, _)| matches!(key.trim(), "ObjectType" | "NDims" | "Comment"))
    })
}

fn type_of(name: &str) -> Option<VoxelType> {
    Some(match name {
        "MET_UCHAR" => VoxelType::U8,
        "MET_CHAR" => VoxelType::I8,
        "MET_USHORT" => VoxelType::U16,
        "MET_SHORT" => VoxelType::I16,
        "MET_UINT" | "MET_ULONG" => VoxelType::U32,
        "MET_INT" | "MET_LONG" => VoxelType::I32,
        "MET_ULONG_LONG" => VoxelType::U64,
        "MET_LONG_LONG" => VoxelType::I64,
        "MET_FLOAT" => VoxelType::F32,
        "MET_DOUBLE" => VoxelType::F64,
        _ => return None,
    })
}

pub(super) fn header(start: &[u8]) -> Result<Header, ImageReadError> {
    let (mut size, mut voxel_type, mut step) = (None, None, 1_usize);
    let (mut spacing, mut origin, mut matrix) = (vec![1.0; 3], vec![0.0; 3], Vec::new());
    let (mut is_big_endian, mut is_packed, mut skip) = (false, false, 0);
    let mut found = None;
    for (number, line, behind) in lines(start) {
        let Some((key, value)) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else {
            continue;
        };
        let entry = || format!("line {number}, {key}");
        let wrong_number = || {
            wrong(
                FORMAT,
                entry(),
                format!("{} is not what belongs here; export the file again", quoted(value)),
            )
        };
        let list = || numbers(value).ok_or_else(wrong_number);
        let is_true = value.eq_ignore_ascii_case("true");
        match key {
            "DimSize" => {
                let sizes: Option<Vec<usize>> =
                    value.split_whitespace().map(|word| word.parse().ok()).collect();
                size = Some(sizes.ok_or_else(wrong_number)?);
            }
            "ElementSpacing" => spacing = list()?,
            "ElementSize" if spacing == [1.0; 3] => spacing = list()?,
            "Offset" | "Position" | "Origin" => origin = list()?,
            "TransformMatrix" | "Rotation" | "Orientation" => matrix = list()?,
            "ElementNumberOfChannels" => step = value.parse().map_err(|_| wrong_number())?,
            "BinaryDataByteOrderMSB" | "ElementByteOrderMSB" => is_big_endian = is_true,
            "CompressedData" => is_packed = is_true,
            "HeaderSize" => {
                let message = "voxels at the end of the file are not read; set it to the bytes before them";
                skip = value.parse().map_err(|_| wrong(FORMAT, entry(), message))?;
            }
            "BinaryData" if !is_true => {
                return Err(wrong(FORMAT, entry(), "voxels as text are not read; save them as binary"));
            }
            "ElementType" => {
                let message =
                    || format!("voxels of type {} are not read; convert them to MET_FLOAT", quoted(value));
                voxel_type = Some(type_of(value).ok_or_else(|| wrong(FORMAT, entry(), message()))?);
            }
            "ElementDataFile" => {
                found = Some((value, behind));
                break;
            }
            _ => {}
        }
    }
    let missing = |entry: &str| wrong(FORMAT, entry, "it is missing; export the file again");
    let (data_file, end) = found.ok_or_else(|| missing("ElementDataFile"))?;
    let voxel_type = voxel_type.ok_or_else(|| missing("ElementType"))?;
    let size = size.ok_or_else(|| missing("DimSize"))?;
    let mut notes = Vec::new();
    let (size, axes) = match size[..] {
        [x, y, z] => ([x, y, z], 3),
        [x, y, z, n] => {
            notes.push(first_of(n, "volumes"));
            ([x, y, z], 4)
        }
        _ => {
            let message = format!("it has {} axes, and an image has three; save one volume", size.len());
            return Err(wrong(FORMAT, "DimSize", message));
        }
    };
    if step > 1 {
        notes.push(first_of(step, "values for each voxel"));
    }
    let number = |list: &[f64], k: usize, usual: f64| list.get(k).copied().unwrap_or(usual);
    // Row k of the matrix is the direction of axis k.
    let direction = |k: usize| {
        if matrix.len() == axes * axes {
            DVec3::from_slice(&matrix[axes * k..axes * k + 3])
        } else {
            DVec3::AXES[k]
        }
    };
    let source = match data_file {
        "LOCAL" | "Local" | "local" => Source::Here(end + skip),
        name if name == "LIST" || name.starts_with("LIST ") || name.contains('%') => {
            return Err(wrong(
                FORMAT,
                "ElementDataFile",
                "a list of files is not read; save the data as one",
            ));
        }
        name => Source::Beside(name.to_owned()),
    };
    Ok(Header {
        format: FORMAT,
        size,
        order: AxisOrder::FirstFastest,
        axes: [0, 1, 2].map(|k| direction(k) * number(&spacing, k, 1.0)),
        origin: DVec3::from_array([0, 1, 2].map(|k| number(&origin, k, 0.0))),
        layout: Layout { first: skip, step: step.max(1), ..Layout::plain(voxel_type, is_big_endian) },
        is_packed,
        source,
        notes,
    })
}
