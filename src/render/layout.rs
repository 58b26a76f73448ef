//! Layout of the instance records: one per particle, per face of a mesh, and per segment of a
//! crease.
//!
//! The pipelines are built from these lists of formats; a test compares the lists with the WGSL.

use AttributeFormat::{Float32, Float32x3, Float32x4, Snorm16x2, Unorm8x4};
use bytemuck::{Pod, Zeroable};

/// Instance record of a particle without its colour: 28 bytes.
///
/// Colours have a separate buffer of 4 bytes each: sRGB red, green, blue and opacity. A change of
/// colours then uploads 4 bytes per particle instead of 32, and no copy of the records has to be
/// kept.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Record {
    /// World position.
    pub position: [f32; 3],
    /// Repulsion radius in world units; a particle with radius 0 is not drawn. A negative radius
    /// means a particle on a crease, which is drawn as a dot facing the eye.
    pub radius: f32,
    /// Unit normal in the octahedral encoding, as two signed normalised 16-bit integers. The
    /// largest error is 0.004°.
    pub normal: [i16; 2],
    /// Time at which the particle begins to appear, in seconds on the renderer's clock.
    pub birth: f32,
    /// Generation level, or −1 for a particle without one, which is always drawn. Single precision
    /// is exact up to 2²⁴.
    pub level: f32,
}

impl Record {
    /// Packs a particle. `level` is `u32::MAX` for a particle without a level.
    ///
    /// `normal` need not have unit length; a zero or non-finite one counts as +z. A non-finite
    /// position or radius gives a record that is not drawn.
    #[must_use]
    pub fn new(position: [f32; 3], normal: [f32; 3], radius: f32, birth: f32, level: u32) -> Self {
        let drawable = radius.is_finite() && position.iter().all(|c| c.is_finite());
        Self {
            position: if drawable { position } else { [0.0; 3] },
            radius: if drawable { radius } else { 0.0 },
            normal: oct_encode(normal),
            birth,
            level: if level == u32::MAX { -1.0 } else { level as f32 },
        }
    }
}

/// Instance record of a triangle without its colours: 64 bytes. It repeats the data of its corners,
/// because WebGL2 cannot look particles up by index, and because a shader with all three corners
/// knows its position in the triangle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FaceRecord {
    /// World position and repulsion radius of each corner, counter-clockwise seen from outside. A
    /// face with a radius of 0 is not drawn.
    pub corners: [[f32; 4]; 3],
    /// Normals of the corners, as in [`Record`].
    pub normals: [[i16; 2]; 3],
    /// Newest generation level among the corners, or −1 if no corner has a level.
    pub level: f32,
}

/// Colours of a triangle's corners and of the marks on them: 24 bytes. A mark is opaque, and 0
/// means no mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FaceTint {
    /// sRGB red, green, blue and opacity of 8 bits each.
    pub colours: [u32; 3],
    /// Colours of the marks: sRGB red, green, blue and opacity of 8 bits each.
    pub marks: [u32; 3],
}

impl FaceRecord {
    /// Packs a triangle of three particles.
    #[must_use]
    pub fn new(corners: [Record; 3]) -> Self {
        Self {
            corners: corners.map(|Record { position: [x, y, z], radius, .. }| [x, y, z, radius]),
            normals: corners.map(|corner| corner.normal),
            level: corners.iter().map(|corner| corner.level).fold(-1.0, f32::max),
        }
    }
}

/// Octahedral encoding of a direction, as two signed normalised 16-bit integers (Q. Meyer et al.,
/// "On Floating-Point Normal Vectors", 2010; Z. H. Cigolle et al., "A Survey of Efficient
/// Representations for Independent Unit Vectors", JCGT 3(2), 2014).
///
/// `n` need not have unit length. A zero or non-finite `n` gives the encoding of +z.
#[must_use]
pub fn oct_encode(n: [f32; 3]) -> [i16; 2] {
    let sum = n[0].abs() + n[1].abs() + n[2].abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return [0, 0];
    }
    let (x, y) = (n[0] / sum, n[1] / sum);
    let (x, y) = if n[2] < 0.0 {
        ((1.0 - y.abs()) * 1.0_f32.copysign(x), (1.0 - x.abs()) * 1.0_f32.copysign(y))
    } else {
        (x, y)
    };
    let quantise = |c: f32| (c * f32::from(i16::MAX)).round() as i16;
    [quantise(x), quantise(y)]
}

/// Format of a vertex attribute, with its WebGPU name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeFormat {
    /// A single-precision number.
    Float32,
    /// Three single-precision numbers.
    Float32x3,
    /// Four single-precision numbers.
    Float32x4,
    /// Two signed normalised 16-bit integers.
    Snorm16x2,
    /// Four unsigned normalised bytes.
    Unorm8x4,
}

impl AttributeFormat {
    /// Size in the buffer, in bytes.
    #[must_use]
    pub const fn size(self) -> u64 {
        match self {
            Self::Float32x3 => 12,
            Self::Float32x4 => 16,
            Self::Float32 | Self::Snorm16x2 | Self::Unorm8x4 => 4,
        }
    }
}

/// Formats of the vertex attributes in the two buffers of an instance: the fields of its record,
/// then its colours. Their `@location`s count from 0 through both buffers.
pub type InstanceFormats = [&'static [AttributeFormat]; 2];

/// Formats of a particle: a [`Record`] and its colour.
pub const PARTICLE: InstanceFormats = [&[Float32x3, Float32, Snorm16x2, Float32, Float32], &[Unorm8x4]];

/// Formats of a face: a [`FaceRecord`] and its [`FaceTint`].
pub const FACE: InstanceFormats =
    [&[Float32x4, Float32x4, Float32x4, Snorm16x2, Snorm16x2, Snorm16x2, Float32], &[Unorm8x4; 6]];

/// Formats of a crease segment: the world position of each end with the repulsion radius of the
/// particle there, and the segment's colour.
pub const PIECE: InstanceFormats = [&[Float32x4; 2], &[Unorm8x4]];

/// Bytes of a record with fields of these formats.
#[must_use]
pub fn stride(formats: &[AttributeFormat]) -> u64 {
    formats.iter().map(|format| format.size()).sum()
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        reason = "the tests go round circles; nothing depends on the last bits"
    )]

    use super::*;
    use core::mem::offset_of;

    /// Unit vector with the octahedral encoding `e`, as the vertex shader computes it; the inverse
    /// of [`oct_encode`].
    fn oct_decode(e: [i16; 2]) -> [f32; 3] {
        let [x, y] = e.map(|c| (f32::from(c) / f32::from(i16::MAX)).max(-1.0));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        let v = [x - fold.copysign(x), y - fold.copysign(y), z];
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    }

    #[test]
    fn octahedral_normals_come_back_within_five_thousandths_of_a_degree() {
        let steps = 97;
        let mut worst_deg = 0.0_f64;
        for i in 0..=steps {
            for j in 0..=2 * steps {
                let theta = std::f32::consts::PI * i as f32 / steps as f32;
                let phi = std::f32::consts::PI * j as f32 / steps as f32;
                let n = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                let [n, m] = [n, oct_decode(oct_encode(n.map(|c| 3.0 * c)))].map(|v| v.map(f64::from));
                // The cross product gives small angles accurately; the dot product does not.
                let cross: f64 = (0..3)
                    .map(|k| (n[(k + 1) % 3] * m[(k + 2) % 3] - n[(k + 2) % 3] * m[(k + 1) % 3]).powi(2))
                    .sum();
                assert!((0..3).map(|k| n[k] * m[k]).sum::<f64>() > 0.0, "{n:?} became {m:?}");
                worst_deg = worst_deg.max(cross.sqrt().asin().to_degrees());
            }
        }
        assert!(worst_deg < 0.005, "largest error {worst_deg}°");
    }

    #[test]
    fn unusable_particles_become_records_that_are_not_drawn() {
        let normal = [0.0, 0.0, 1.0];
        for (position, radius) in [
            ([f32::NAN, 0.0, 0.0], 1.0),
            ([0.0, f32::INFINITY, 0.0], 1.0),
            ([0.0; 3], 0.0),
            ([0.0; 3], f32::NAN),
            ([0.0; 3], f32::INFINITY),
        ] {
            let record = Record::new(position, normal, radius, 0.0, 0);
            assert_eq!(record.radius, 0.0, "{position:?} {radius}");
            assert!(record.position.iter().all(|c| c.is_finite()));
        }
        for bad in [[0.0; 3], [f32::NAN, 1.0, 0.0], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(
                oct_decode(Record::new([0.0; 3], bad, 1.0, 0.0, 0).normal),
                [0.0, 0.0, 1.0],
                "{bad:?}"
            );
        }
    }

    #[test]
    fn a_face_has_the_newest_level_of_its_corners() {
        let corner = |level| Record::new([1.0, 2.0, 3.0], [0.0, 0.0, 1.0], 0.5, 0.0, level);
        let face = FaceRecord::new([corner(4), corner(7), corner(5)]);
        assert_eq!((face.level, face.corners[1], face.normals[2]), (7.0, [1.0, 2.0, 3.0, 0.5], [0, 0]));
        assert_eq!(FaceRecord::new([corner(u32::MAX); 3]).level, -1.0);
        let lost = Record::new([f32::NAN, 0.0, 0.0], [0.0; 3], 0.5, 0.0, 0);
        assert_eq!(FaceRecord::new([corner(0), lost, corner(0)]).corners[1][3], 0.0);
    }

    #[test]
    fn attributes_tile_their_records_without_gap_or_overlap() {
        let sizes =
            |[record, colours]: InstanceFormats| [record, colours].map(|formats| stride(formats) as usize);
        assert_eq!(sizes(PARTICLE), [size_of::<Record>(), size_of::<u32>()]);
        assert_eq!(sizes(FACE), [size_of::<FaceRecord>(), size_of::<FaceTint>()]);
        assert_eq!(sizes(PIECE), [8 * size_of::<f32>(), size_of::<u32>()]);
        // The fields are those of the structs, in order.
        let offsets = |formats: &[AttributeFormat]| -> Vec<usize> {
            (0..formats.len()).map(|k| stride(&formats[..k]) as usize).collect()
        };
        let (marks, normals) = (offset_of!(FaceTint, marks), offset_of!(FaceRecord, normals));
        assert_eq!(
            offsets(PARTICLE[0]),
            [
                offset_of!(Record, position),
                offset_of!(Record, radius),
                offset_of!(Record, normal),
                offset_of!(Record, birth),
                offset_of!(Record, level)
            ]
        );
        assert_eq!(
            offsets(FACE[0]),
            [0, 16, 32, normals, normals + 4, normals + 8, offset_of!(FaceRecord, level)]
        );
        assert_eq!(offsets(FACE[1]), [0, 4, 8, marks, marks + 4, marks + 8]);
    }
}
