//! Export of particles to PLY, CSV, XYZ and NPY, and of triangle meshes over them to GLB, OBJ, STL and PLY.

mod glb;
mod mesh;

pub use mesh::{MeshFormat, write_mesh};

use crate::particles::Particles;
use std::io::{self, Write};

/// A file format for particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary little-endian PLY: position, normal, radius, level, parent (−1 for a seed), valence, and 1 for a particle
    /// next to a singular point.
    Ply,
    /// Comma-separated values with a header line and the columns of [`Format::Ply`].
    Csv,
    /// Text, one `x y z nx ny nz` per line.
    Xyz,
    /// NumPy array of shape (N, 6), `<f4`: position and normal.
    Npy,
}

impl Format {
    /// Every format with its file name extension.
    pub const ALL: [(&str, Self); 4] =
        [("ply", Self::Ply), ("csv", Self::Csv), ("xyz", Self::Xyz), ("npy", Self::Npy)];

    /// Format with a file name extension, in upper or lower case; `None` for an unknown one.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(extension)).map(|&(_, format)| format)
    }
}

/// Writes `particles` to `out`, which should be buffered.
///
/// `valence` is the number of natural neighbours of each particle (see [`crate::quality::Report::valence`]); particles
/// beyond its end get 0. Decimal numbers are the shortest that read back to the same bits.
///
/// # Errors
///
/// Those of `out`.
pub fn write(format: Format, particles: &Particles, valence: &[u8], out: &mut dyn Write) -> io::Result<()> {
    match format {
        Format::Ply => ply(particles, valence, None, out),
        Format::Csv => csv(particles, valence, out),
        Format::Xyz => xyz(particles, out),
        Format::Npy => npy(particles, out),
    }
}

/// Index of the parent, or −1 for a seed.
fn parent(particles: &Particles, i: usize) -> i32 {
    // The parent of a seed is `u32::MAX`, whose bits are those of −1.
    particles.parent[i].cast_signed()
}

fn ply(
    particles: &Particles,
    valence: &[u8],
    triangles: Option<&[[u32; 3]]>,
    out: &mut dyn Write,
) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment Marching Particles\n")?;
    writeln!(out, "element vertex {}", particles.len())?;
    for name in ["x", "y", "z", "nx", "ny", "nz", "radius"] {
        writeln!(out, "property float {name}")?;
    }
    write!(
        out,
        "property uint level\nproperty int parent\nproperty uchar valence\nproperty uchar singular\n"
    )?;
    if let Some(triangles) = triangles {
        write!(out, "element face {}\nproperty list uchar uint vertex_indices\n", triangles.len())?;
    }
    writeln!(out, "end_header")?;
    for i in 0..particles.len() {
        // One write per particle.
        let mut record = [0_u8; 38];
        let floats = particles.position[i]
            .to_array()
            .into_iter()
            .chain(particles.normal[i].to_array())
            .chain([particles.radius[i]]);
        for (bytes, value) in record.chunks_exact_mut(4).zip(floats) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        record[28..32].copy_from_slice(&particles.level[i].to_le_bytes());
        record[32..36].copy_from_slice(&parent(particles, i).to_le_bytes());
        record[36] = valence.get(i).copied().unwrap_or(0);
        record[37] = u8::from(particles.slots[i].is_singular());
        out.write_all(&record)?;
    }
    for triangle in triangles.unwrap_or_default() {
        let mut record = [3; 13];
        for (bytes, index) in record[1..].chunks_exact_mut(4).zip(triangle) {
            bytes.copy_from_slice(&index.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

fn csv(particles: &Particles, valence: &[u8], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "x,y,z,nx,ny,nz,radius,level,parent,valence,singular")?;
    for i in 0..particles.len() {
        let (p, n) = (particles.position[i], particles.normal[i]);
        let valence = valence.get(i).copied().unwrap_or(0);
        let (radius, level, parent) = (particles.radius[i], particles.level[i], parent(particles, i));
        let singular = u8::from(particles.slots[i].is_singular());
        write!(out, "{},{},{},{},{},{},", p.x, p.y, p.z, n.x, n.y, n.z)?;
        writeln!(out, "{radius},{level},{parent},{valence},{singular}")?;
    }
    Ok(())
}

fn xyz(particles: &Particles, out: &mut dyn Write) -> io::Result<()> {
    for (p, n) in particles.position.iter().zip(&particles.normal) {
        writeln!(out, "{} {} {} {} {} {}", p.x, p.y, p.z, n.x, n.y, n.z)?;
    }
    Ok(())
}

fn npy(particles: &Particles, out: &mut dyn Write) -> io::Result<()> {
    let mut header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 6), }}", particles.len());
    // Magic, version and length take 10 bytes. A line feed ends the header, and the data starts at a multiple of 64.
    let padding = 64 - (10 + header.len() + 1) % 64;
    header.extend(core::iter::repeat_n(' ', padding % 64));
    header.push('\n');
    out.write_all(b"\x93NUMPY\x01\x00")?;
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    for (p, n) in particles.position.iter().zip(&particles.normal) {
        let mut record = [0_u8; 24];
        for (bytes, value) in record.chunks_exact_mut(4).zip(p.to_array().into_iter().chain(n.to_array())) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Slots;
    use glam::Vec3;

    fn two() -> Particles {
        Particles {
            position: vec![Vec3::new(0.1, -2.0, 1e-9), Vec3::new(1.0 / 3.0, 4.0, 5.0)],
            normal: vec![Vec3::Z, Vec3::new(0.6, 0.8, 0.0)],
            radius: vec![0.25, 0.5],
            parent: vec![Particles::NO_PARENT, 0],
            level: vec![0, 1],
            slots: vec![Slots::default(), Slots(Slots::SINGULAR)],
        }
    }

    fn written(format: Format) -> Vec<u8> {
        let mut out = Vec::new();
        write(format, &two(), &[6], &mut out).expect("writing to memory does not fail");
        out
    }

    fn floats(bytes: &[u8]) -> Vec<f32> {
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    #[test]
    fn ply_declares_what_it_holds() {
        let bytes = written(Format::Ply);
        let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
        let header = std::str::from_utf8(&bytes[..end]).expect("a text header");
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(header.contains("element vertex 2\n"));
        let size: usize = header
            .lines()
            .filter_map(|line| line.strip_prefix("property "))
            .map(|property| match property.split(' ').next() {
                Some("float" | "uint" | "int") => 4,
                Some("uchar") => 1,
                other => panic!("unexpected type {other:?}"),
            })
            .sum();
        let data = &bytes[end..];
        assert_eq!(data.len(), 2 * size);
        assert_eq!(floats(&data[..28]), [0.1, -2.0, 1e-9, 0.0, 0.0, 1.0, 0.25]);
        assert_eq!(data[28..38], [0, 0, 0, 0, 255, 255, 255, 255, 6, 0]);
        assert_eq!(data[size + 28..], [1, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    }

    #[test]
    fn csv_reads_back_to_the_same_bits() {
        let text = String::from_utf8(written(Format::Csv)).expect("text");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("x,y,z,nx,ny,nz,radius,level,parent,valence,singular"));
        assert_eq!(lines.next(), Some("0.1,-2,0.000000001,0,0,1,0.25,0,-1,6,0"));
        let second: Vec<f32> = lines
            .next()
            .expect("a second row")
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        assert_eq!(second, [1.0 / 3.0, 4.0, 5.0, 0.6, 0.8, 0.0, 0.5, 1.0, 0.0, 0.0, 1.0]);
        assert_eq!(lines.next(), None);
    }

    #[test]
    fn xyz_has_one_point_and_normal_per_line() {
        let text = String::from_utf8(written(Format::Xyz)).expect("text");
        assert_eq!(text.lines().next(), Some("0.1 -2 0.000000001 0 0 1"));
        assert_eq!(text.lines().count(), 2);
    }

    #[test]
    fn npy_header_is_aligned_and_gives_the_shape() {
        let bytes = written(Format::Npy);
        assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00");
        let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!(data % 64, 0);
        let header = std::str::from_utf8(&bytes[10..data]).expect("a text header");
        assert!(header.contains("'shape': (2, 6)") && header.ends_with('\n'));
        assert_eq!(floats(&bytes[data..])[6..], [1.0 / 3.0, 4.0, 5.0, 0.6, 0.8, 0.0]);
    }

    #[test]
    fn extension_names_the_format_in_either_case() {
        assert_eq!(Format::of_extension("PLY"), Some(Format::Ply));
        assert_eq!(Format::of_extension("npy"), Some(Format::Npy));
        assert_eq!(Format::of_extension("obj"), None);
    }
}
