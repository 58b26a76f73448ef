//! Built-in models of 200 points each, like those of the paper (§6).
//!
//! A file in `data` begins with the smallest corner and the side of a cube, as four little-endian
//! floats. Then each point has five 16-bit integers: its position in the cube and its normal in
//! octahedral encoding (Q. Meyer et al., "On Floating-Point Normal Vectors", 2010).
//! `tests/it/models.rs` makes the files and states the source of the points.

use super::{Cloud, ModelInfo, NormalSource};
use crate::field::model::Model;
use glam::{DVec2, DVec3};

/// Largest 16-bit integer.
const STEPS: f64 = u16::MAX as f64;
/// Number of floats before the points.
const HEAD: usize = 4;
/// Number of integers per point.
const NUMBERS: usize = 5;

/// The points of the built-in model `id`.
#[must_use]
pub fn cloud(id: &str) -> Option<Cloud> {
    let (bytes, source): (&[u8], _) = match id {
        "bunny" => (include_bytes!("data/bunny.bin"), NormalSource::FromMesh),
        "bunny-joined" => (include_bytes!("data/bunny-joined.bin"), NormalSource::FromMesh),
        "rabbit" => (include_bytes!("data/rabbit.bin"), NormalSource::Given),
        "sack-and-hat" => (include_bytes!("data/sack-and-hat.bin"), NormalSource::Given),
        _ => return None,
    };
    Some(Cloud { source, ..decode(bytes) })
}

/// Report of a built-in model before it is solved.
pub(super) fn info(model: &Model) -> ModelInfo {
    ModelInfo { name: model.name.into(), credit: model.credit.into(), ..ModelInfo::default() }
}

/// Decodes a data file.
fn decode(bytes: &[u8]) -> Cloud {
    let (head, points) = bytes.split_at(HEAD * size_of::<f32>());
    let head = head.as_chunks().0;
    let [x, y, z, side] = core::array::from_fn(|k| f64::from(f32::from_le_bytes(head[k])));
    let mut cloud = Cloud::default();
    for numbers in points.as_chunks().0.as_chunks::<NUMBERS>().0 {
        let [i, j, k, u, v] = numbers.map(|bytes| f64::from(u16::from_le_bytes(bytes)) / STEPS);
        cloud.position.push(DVec3::new(x, y, z) + DVec3::new(i, j, k) * side);
        cloud.normal.push(octahedral_decode(2.0 * DVec2::new(u, v) - 1.0));
    }
    cloud
}

/// Decodes a direction from its octahedral encoding, a point in the square from −1 to 1.
///
/// The upper half of the octahedron |x| + |y| + |z| = 1 is projected along z. The lower half is
/// unfolded over its edges: the inner diamond of the square is exchanged with its four corners.
fn octahedral_decode(flat: DVec2) -> DVec3 {
    let z = 1.0 - flat.x.abs() - flat.y.abs();
    if z < 0.0 {
        let unfolded = 1.0 - DVec2::new(flat.y, flat.x).abs();
        (unfolded * DVec2::new(1.0_f64.copysign(flat.x), 1.0_f64.copysign(flat.y)))
            .extend(z)
            .normalize_or(DVec3::Z)
    } else {
        flat.extend(z).normalize_or(DVec3::Z)
    }
}
