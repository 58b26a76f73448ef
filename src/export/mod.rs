//! Export of particles to PLY, CSV, XYZ and NPY, and of triangle meshes over them to GLB, OBJ, STL, PLY and 3MF.

mod file;
mod glb;
mod mesh;
mod placement;
mod record;
mod three_mf;

pub use mesh::{MeshFile, MeshFormat, write_mesh};
pub use placement::{Placement, Unit, UpAxis};
pub use record::RecordText;

pub(crate) use file::File;

use crate::particles::Particles;
use crate::quality;
use core::ops::Range;
use glam::DVec3;
use serde::Serialize;
use std::io::{self, Write};

/// A file format for particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary little-endian PLY with the [`COLUMNS`].
    Ply,
    /// Comma-separated values of the [`COLUMNS`], with a header line.
    Csv,
    /// Text, one `x y z nx ny nz` per line.
    Xyz,
    /// NumPy array of shape (N, 6), `<f4`, or `<f8` where the particles have an origin of their own: position and normal.
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

/// A file of particles: its format, and the record that it carries.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleFile {
    /// Its format.
    pub format: Format,
    /// The record that it carries, but for XYZ and NPY.
    pub record: RecordText,
}

impl From<Format> for ParticleFile {
    fn from(format: Format) -> Self {
        Self { format, record: RecordText::default() }
    }
}

/// Type of the values of a column, by its name in PLY.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum ColumnKind {
    /// A coordinate: in double precision where the particles have an origin of their own, else in single precision.
    Coordinate,
    /// Number in single precision.
    Float,
    /// Integer of 32 bits with a sign.
    Int,
    /// Integer of 32 bits without a sign.
    Uint,
    /// Integer of 8 bits without a sign.
    Uchar,
}

/// A column of PLY and CSV files, here and on the page.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Column {
    /// Name in the file.
    pub name: &'static str,
    /// Type of the values.
    pub kind: ColumnKind,
    /// Whether the column is known only once the particles are measured.
    #[serde(skip)]
    pub measured: bool,
    /// Whether the column is there only where the surface has creases.
    #[serde(skip)]
    pub creases: bool,
    /// Whether the column is there only where opposite faces of the box have the same particles.
    #[serde(skip)]
    pub periodic: bool,
    /// Whether the column is there only where the surface has moved.
    #[serde(skip)]
    pub moved: bool,
    /// Returns the value of a particle, given by its index.
    #[serde(skip)]
    read: fn(&Particles, &quality::Measurements, usize) -> CellValue,
}

/// A value of a column.
#[derive(Clone, Copy)]
enum CellValue {
    Double(f64),
    Float(f32),
    Int(i32),
    Uint(u32),
    Uchar(u8),
}

impl CellValue {
    fn write_binary(self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Double(value) => out.write_all(&value.to_le_bytes()),
            Self::Float(value) => out.write_all(&value.to_le_bytes()),
            Self::Int(value) => out.write_all(&value.to_le_bytes()),
            Self::Uint(value) => out.write_all(&value.to_le_bytes()),
            Self::Uchar(value) => out.write_all(&[value]),
        }
    }

    fn write_text(self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Double(value) => write!(out, "{value}"),
            Self::Float(value) => write!(out, "{value}"),
            Self::Int(value) => write!(out, "{value}"),
            Self::Uint(value) => write!(out, "{value}"),
            Self::Uchar(value) => write!(out, "{value}"),
        }
    }
}

/// Whether coordinates take double precision.
fn is_double(particles: &Particles) -> bool {
    particles.origin != DVec3::ZERO
}

/// A coordinate of a particle in those of the formula.
fn coordinate(particles: &Particles, i: usize, axis: usize) -> CellValue {
    if is_double(particles) {
        CellValue::Double(particles.place(i)[axis])
    } else {
        CellValue::Float(particles.position[i][axis])
    }
}

type Read = fn(&Particles, &quality::Measurements, usize) -> CellValue;

const fn float(name: &'static str, read: Read) -> Column {
    Column {
        name,
        kind: ColumnKind::Float,
        measured: false,
        creases: false,
        periodic: false,
        moved: false,
        read,
    }
}

/// The columns of PLY and CSV files, in their order.
pub const COLUMNS: &[Column] = &[
    Column { kind: ColumnKind::Coordinate, ..float("x", |particles, _, i| coordinate(particles, i, 0)) },
    Column { kind: ColumnKind::Coordinate, ..float("y", |particles, _, i| coordinate(particles, i, 1)) },
    Column { kind: ColumnKind::Coordinate, ..float("z", |particles, _, i| coordinate(particles, i, 2)) },
    float("nx", |particles, _, i| CellValue::Float(particles.normal[i].x)),
    float("ny", |particles, _, i| CellValue::Float(particles.normal[i].y)),
    float("nz", |particles, _, i| CellValue::Float(particles.normal[i].z)),
    float("radius", |particles, _, i| CellValue::Float(particles.radius[i])),
    Column {
        kind: ColumnKind::Uint,
        ..float("level", |particles, _, i| CellValue::Uint(particles.level[i]))
    },
    // All ones, the mark of a seed, is −1.
    Column {
        kind: ColumnKind::Int,
        ..float("parent", |particles, _, i| CellValue::Int(particles.parent[i].cast_signed()))
    },
    Column {
        kind: ColumnKind::Uchar,
        measured: true,
        ..float("valence", |_, measured, i| CellValue::Uchar(measured.valence.get(i).copied().unwrap_or(0)))
    },
    Column {
        measured: true,
        ..float("nearest", |_, measured, i| {
            CellValue::Float(measured.nearest.get(i).copied().unwrap_or(f32::NAN))
        })
    },
    Column {
        measured: true,
        ..float("residual", |_, measured, i| {
            CellValue::Float(measured.residual.get(i).copied().unwrap_or(f32::NAN))
        })
    },
    Column {
        kind: ColumnKind::Uchar,
        ..float("singular", |particles, _, i| CellValue::Uchar(particles.slots[i].is_singular().into()))
    },
    Column {
        kind: ColumnKind::Uint,
        creases: true,
        ..float("patch", |particles, _, i| CellValue::Uint(particles.patch.get(i).copied().unwrap_or(0)))
    },
    // The first row of the particle: a particle on a crease has one for each patch.
    Column {
        kind: ColumnKind::Uint,
        creases: true,
        ..float("particle", |particles, _, i| CellValue::Uint(particles.first_row(i) as u32))
    },
    // The particle that it is on the lowest faces of a cell: itself, but for the images on the opposite ones.
    Column {
        kind: ColumnKind::Uint,
        creases: true,
        periodic: true,
        ..float("periodic", |particles, _, i| CellValue::Uint(particles.periodic[i]))
    },
    Column {
        kind: ColumnKind::Uint,
        moved: true,
        ..float("identity", |particles, _, i| CellValue::Uint(particles.identity[i]))
    },
];

/// The columns of a file: all, but those of measurements where nothing was measured, and those of patches where there are no creases.
fn columns(particles: &Particles, measured: &quality::Measurements) -> impl Iterator<Item = &'static Column> {
    let (is_measured, is_creased) = (!measured.valence.is_empty(), !particles.patch.is_empty());
    let (is_periodic, has_moved) = (!particles.periodic.is_empty(), !particles.identity.is_empty());
    COLUMNS.iter().filter(move |column| {
        (is_measured || !column.measured)
            && (is_creased || !column.creases)
            && (is_periodic || !column.periodic)
            && (has_moved || !column.moved)
    })
}

/// Writes `particles` to `out`, which should be buffered: a record for each of their rows. `measured` is the report on them:
/// where it is empty, its columns are left out; particles beyond its end get a valence of 0 and NaN for the rest. Floats in
/// text are the shortest that read back to the same bits. PLY and CSV carry the `record`, in a comment.
///
/// # Errors
///
/// The errors of `out`.
pub fn write(
    format: Format,
    particles: &Particles,
    measured: &quality::Measurements,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    match format {
        Format::Ply => ply(particles, measured, None, record, 0..particles.len(), out),
        Format::Csv => csv(particles, measured, record, out),
        Format::Xyz => xyz(particles, out),
        Format::Npy => npy(particles, out),
    }
}

fn ply(
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: Option<&[[u32; 3]]>,
    record: &RecordText,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let n = particles.len();
    if rows.start == 0 {
        ply_header(particles, measured, triangles, record, out)?;
    }
    for i in rows.start.min(n)..rows.end.min(n) {
        for column in columns(particles, measured) {
            (column.read)(particles, measured, i).write_binary(out)?;
        }
    }
    let faces = rows.start.max(n) - n..rows.end.max(n) - n;
    for triangle in &triangles.unwrap_or_default()[faces] {
        let mut record = [3; 13];
        for (bytes, index) in record[1..].chunks_exact_mut(4).zip(triangle) {
            bytes.copy_from_slice(&index.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

fn ply_header(
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: Option<&[[u32; 3]]>,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment Marching Particles\n")?;
    write!(out, "{}", record.comment("comment"))?;
    writeln!(out, "element vertex {}", particles.len())?;
    for column in columns(particles, measured) {
        let kind = match column.kind {
            ColumnKind::Coordinate if is_double(particles) => "double",
            ColumnKind::Coordinate | ColumnKind::Float => "float",
            ColumnKind::Int => "int",
            ColumnKind::Uint => "uint",
            ColumnKind::Uchar => "uchar",
        };
        writeln!(out, "property {kind} {}", column.name)?;
    }
    if let Some(triangles) = triangles {
        write!(out, "element face {}\nproperty list uchar uint vertex_indices\n", triangles.len())?;
    }
    writeln!(out, "end_header")
}

fn csv(
    particles: &Particles,
    measured: &quality::Measurements,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    let names: Vec<&str> = columns(particles, measured).map(|column| column.name).collect();
    writeln!(out, "{}{}", record.comment("#"), names.join(","))?;
    for i in 0..particles.len() {
        for (k, column) in columns(particles, measured).enumerate() {
            out.write_all(if k == 0 { b"" } else { b"," })?;
            (column.read)(particles, measured, i).write_text(out)?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

fn xyz(particles: &Particles, out: &mut dyn Write) -> io::Result<()> {
    for (i, n) in particles.normal.iter().enumerate() {
        for axis in 0..3 {
            coordinate(particles, i, axis).write_text(out)?;
            out.write_all(b" ")?;
        }
        writeln!(out, "{} {} {}", n.x, n.y, n.z)?;
    }
    Ok(())
}

fn npy(particles: &Particles, out: &mut dyn Write) -> io::Result<()> {
    let kind = if is_double(particles) { "<f8" } else { "<f4" };
    let mut header =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}, 6), }}", particles.len());
    // Magic, version and length take 10 bytes. A line feed ends the header, and the data starts at a multiple of 64.
    let padding = 64 - (10 + header.len() + 1) % 64;
    header.extend(core::iter::repeat_n(' ', padding % 64));
    header.push('\n');
    out.write_all(b"\x93NUMPY\x01\x00")?;
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    for (i, n) in particles.normal.iter().enumerate() {
        for axis in 0..3 {
            coordinate(particles, i, axis).write_binary(out)?;
        }
        for value in n.to_array() {
            let cell =
                if is_double(particles) { CellValue::Double(value.into()) } else { CellValue::Float(value) };
            cell.write_binary(out)?;
        }
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
            origin: DVec3::ZERO,
            position: vec![Vec3::new(0.1, -2.0, 1e-9), Vec3::new(1.0 / 3.0, 4.0, 5.0)],
            normal: vec![Vec3::Z, Vec3::new(0.6, 0.8, 0.0)],
            radius: vec![0.25, 0.5],
            parent: vec![Particles::NO_PARENT, 0],
            level: vec![0, 1],
            slots: vec![Slots::default(), Slots(Slots::SINGULAR)],
            ..Particles::default()
        }
    }

    fn written(format: Format) -> Vec<u8> {
        let mut out = Vec::new();
        let measured = quality::Measurements {
            valence: vec![6],
            nearest: vec![0.5],
            residual: vec![1e-7],
            ..quality::Measurements::default()
        };
        write(format, &two(), &measured, &RecordText::default(), &mut out)
            .expect("writing to memory does not fail");
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
        assert_eq!(data[28..37], [0, 0, 0, 0, 255, 255, 255, 255, 6]);
        assert_eq!((floats(&data[37..45]), data[45]), (vec![0.5, 1e-7], 0));
        assert_eq!(data[size + 28..size + 37], [1, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert!(floats(&data[size + 37..size + 45]).iter().all(|x| x.is_nan()) && data[size + 45] == 1);
    }

    #[test]
    fn csv_reads_back_to_the_same_bits() {
        let text = String::from_utf8(written(Format::Csv)).expect("text");
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some("x,y,z,nx,ny,nz,radius,level,parent,valence,nearest,residual,singular")
        );
        assert_eq!(lines.next(), Some("0.1,-2,0.000000001,0,0,1,0.25,0,-1,6,0.5,0.0000001,0"));
        let second: Vec<f32> = lines
            .next()
            .expect("a second row")
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        assert_eq!(second[..10], [1.0 / 3.0, 4.0, 5.0, 0.6, 0.8, 0.0, 0.5, 1.0, 0.0, 0.0]);
        assert!(second[10].is_nan() && second[11].is_nan() && second[12] == 1.0);
        assert_eq!(lines.next(), None);
    }

    #[test]
    fn rows_of_a_particle_on_a_crease_tell_their_patch_and_their_particle() {
        let mut particles = two();
        particles.position[1] = particles.position[0];
        (particles.patch, particles.twins) = (vec![4, 9], vec![0, 0]);
        let mut out = Vec::new();
        write(Format::Csv, &particles, &quality::Measurements::default(), &RecordText::default(), &mut out)
            .expect("writing to memory does not fail");
        let text = String::from_utf8(out).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "x,y,z,nx,ny,nz,radius,level,parent,singular,patch,particle");
        assert!(lines[1].ends_with(",0,4,0") && lines[2].ends_with(",1,9,0"), "{text}");
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
