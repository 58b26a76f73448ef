//! NIfTI-1 and NIfTI-2 (R. W. Cox et al., "A (Sort of) New Image Data Format Standard: NIfTI-1",
//! Human Brain Mapping 25, 2004), and the ANALYZE 7.5 header that they grew from.

use super::header::{Fields, first_of, wrong};
use super::{Header, ImageFormat, ImageReadError, Source};
use crate::image::AxisOrder;
use crate::image::voxels::{Layout, VoxelType};
use glam::{DMat3, DQuat, DVec3};

const FORMAT: ImageFormat = ImageFormat::Nifti;
/// Sizes of the two headers. Each header begins with its size.
const SIZE_1: i32 = 348;
const SIZE_2: i32 = 540;

/// The byte order of a header; none if it is not one.
fn is_big_endian(start: &[u8]) -> Option<bool> {
    [false, true].into_iter().find(|&is_big_endian| {
        let fields = Fields { bytes: start, is_big_endian };
        match fields.i32(0) {
            SIZE_1 => start.len() >= SIZE_1 as usize && (1..=7).contains(&fields.i16(40)),
            SIZE_2 => {
                start.len() >= SIZE_2 as usize
                    && start.get(4..7).is_some_and(|magic| magic == b"n+2" || magic == b"ni2")
            }
            _ => false,
        }
    })
}

pub(super) fn begins_with(start: &[u8]) -> bool {
    is_big_endian(start).is_some()
}

/// The entries of either version that are used.
struct Entries {
    /// Number of axes, then the number of voxels along each.
    dim: [i64; 8],
    datatype: i16,
    pixdim: [f64; 8],
    first: f64,
    slope: f64,
    intercept: f64,
    qform: i32,
    sform: i32,
    /// Components b, c and d of the quaternion, then the offset.
    quaternion: [f64; 6],
    rows: [[f64; 4]; 3],
    is_single: bool,
    is_analyze: bool,
}

fn entries(start: &[u8]) -> Entries {
    let fields = Fields { bytes: start, is_big_endian: is_big_endian(start).unwrap_or(false) };
    if fields.i32(0) == SIZE_2 {
        let f = |at: usize| fields.f64(at);
        let code = |at: usize| fields.i32(at);
        return Entries {
            dim: core::array::from_fn(|k| fields.i64(16 + 8 * k)),
            datatype: fields.i16(12),
            pixdim: core::array::from_fn(|k| f(104 + 8 * k)),
            first: fields.i64(168) as f64,
            slope: f(176),
            intercept: f(184),
            qform: code(344),
            sform: code(348),
            quaternion: core::array::from_fn(|k| f(352 + 8 * k)),
            rows: core::array::from_fn(|r| core::array::from_fn(|c| f(400 + 32 * r + 8 * c))),
            is_single: start[4..7] == *b"n+2",
            is_analyze: false,
        };
    }
    let f = |at: usize| f64::from(fields.f32(at));
    let magic = &start[344..347];
    Entries {
        dim: core::array::from_fn(|k| fields.i16(40 + 2 * k).into()),
        datatype: fields.i16(70),
        pixdim: core::array::from_fn(|k| f(76 + 4 * k)),
        first: f(108),
        slope: f(112),
        intercept: f(116),
        qform: fields.i16(252).into(),
        sform: fields.i16(254).into(),
        quaternion: core::array::from_fn(|k| f(256 + 4 * k)),
        rows: core::array::from_fn(|r| core::array::from_fn(|c| f(280 + 16 * r + 4 * c))),
        is_single: magic == b"n+1",
        is_analyze: magic != b"n+1" && magic != b"ni1",
    }
}

/// The type of a voxel and how many numbers each voxel has.
fn voxel_type(datatype: i16) -> Result<(VoxelType, usize), ImageReadError> {
    Ok(match datatype {
        2 => (VoxelType::U8, 1),
        4 => (VoxelType::I16, 1),
        8 => (VoxelType::I32, 1),
        16 => (VoxelType::F32, 1),
        64 => (VoxelType::F64, 1),
        128 => (VoxelType::U8, 3),
        256 => (VoxelType::I8, 1),
        512 => (VoxelType::U16, 1),
        768 => (VoxelType::U32, 1),
        1024 => (VoxelType::I64, 1),
        1280 => (VoxelType::U64, 1),
        2304 => (VoxelType::U8, 4),
        _ => {
            return Err(wrong(
                FORMAT,
                format!("datatype {datatype}"),
                "voxels of this type are not read; save them as whole numbers of up to 64 bits, float32 or float64",
            ));
        }
    })
}

pub(super) fn header(name: &str, start: &[u8]) -> Result<Header, ImageReadError> {
    let entries = entries(start);
    let axes = entries.dim[0].clamp(1, 7) as usize;
    let size = core::array::from_fn(|k| if k < axes { entries.dim[k + 1] } else { 1 });
    let more =
        entries.dim[1..=axes].iter().skip(3).fold(1, |product: i64, &n| product.saturating_mul(n.max(1)));
    if let Some(k) = size.iter().position(|&n| n < 1) {
        return Err(wrong(
            FORMAT,
            format!("dim[{}]", k + 1),
            format!("{} voxels along an axis; export the file again", size[k]),
        ));
    }
    let (voxel_type, step) = voxel_type(entries.datatype)?;
    let mut notes = Vec::new();
    if more > 1 {
        notes.push(first_of(more as usize, "volumes"));
    }
    if step > 1 {
        notes.push(first_of(step, "colours"));
    }
    let is_scaled =
        entries.slope != 0.0 && entries.slope.is_finite() && entries.intercept.is_finite() && step == 1;
    let (slope, intercept) = if is_scaled { (entries.slope, entries.intercept) } else { (1.0, 0.0) };
    let first = if entries.first.is_finite() { entries.first.max(0.0) as usize } else { 0 };
    let (matrix, origin) = placement(&entries, &mut notes);
    let source = if entries.is_single { Source::Here(first) } else { Source::Beside(data_name(name)) };
    let layout = Layout {
        first,
        step,
        slope,
        intercept,
        ..Layout::plain(voxel_type, is_big_endian(start).unwrap_or(false))
    };
    Ok(Header {
        format: FORMAT,
        size: size.map(|n| n as usize),
        order: AxisOrder::FirstFastest,
        axes: [matrix.x_axis, matrix.y_axis, matrix.z_axis],
        origin,
        layout,
        is_packed: false,
        source,
        notes,
    })
}

/// The name of the data file that belongs to a separate header.
fn data_name(name: &str) -> String {
    for (header, data) in [(".hdr", ".img"), (".HDR", ".IMG"), (".hdr.gz", ".img.gz")] {
        if let Some(stem) = name.strip_suffix(header) {
            return format!("{stem}{data}");
        }
    }
    format!("{name}.img")
}

/// The steps from voxel to voxel and the position of the first one: from the affine matrix (method
/// 3 of the standard), else from the quaternion (method 2), else from the spacings alone.
fn placement(entries: &Entries, notes: &mut Vec<String>) -> (DMat3, DVec3) {
    let spacing = DVec3::from_array(core::array::from_fn(|k| {
        let length = entries.pixdim[k + 1].abs();
        if length > 0.0 && length.is_finite() { length } else { 1.0 }
    }));
    let row = |r: usize| DVec3::from_slice(&entries.rows[r][..3]);
    if entries.sform > 0 && !entries.is_analyze {
        let origin = DVec3::from_array([0, 1, 2].map(|r| entries.rows[r][3]));
        return (DMat3::from_cols(row(0), row(1), row(2)).transpose(), origin);
    }
    if entries.qform > 0 && !entries.is_analyze {
        let [b, c, d, x, y, z] = entries.quaternion;
        let a = libm::sqrt((1.0 - (b * b + c * c + d * d)).max(0.0));
        let quaternion = DQuat::from_xyzw(b, c, d, a);
        let length = quaternion.length();
        if length > 0.5 && length < 2.0 {
            let turned = DMat3::from_quat(quaternion * (1.0 / length));
            let flip = if entries.pixdim[0] < 0.0 { -1.0 } else { 1.0 };
            let scale = DMat3::from_diagonal(DVec3::new(spacing.x, spacing.y, flip * spacing.z));
            return (turned * scale, DVec3::new(x, y, z));
        }
    }
    notes.push("The header gives no orientation; the axes of the image are those of space.".to_owned());
    (DMat3::from_diagonal(spacing), DVec3::ZERO)
}
