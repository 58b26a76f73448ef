//! Export of particles to PLY, CSV, XYZ and NPY, and of triangle meshes over them to GLB, OBJ, STL,
//! PLY and 3MF.

mod file;
mod glb;
mod mesh;
mod placement;
mod record;
mod three_mf;
mod vertices;

pub use crate::mesh::bodies::Bodies;
#[doc(hidden)]
pub use mesh::write_mesh;
pub use mesh::{MeshFile, MeshFormat};
pub use placement::{Placement, Unit, UpAxis};
pub use record::RecordText;
pub use vertices::{MeshBuffers, Vertices};
#[doc(hidden)]
pub use vertices::{VERTICES, VerticesChoice};

pub(crate) use file::{File, FileContent};

use crate::particles::Particles;
use crate::quality::{self, CHANNELS};
use core::fmt;
use core::ops::Range;
use glam::DVec3;
use serde::Serialize;
use std::io::{self, Write};
use vertices::Indexed;

/// A file format for particles. Their normals follow the gradient: they point to larger f, which is
/// outward if f is smaller inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Binary little-endian PLY with all columns.
    Ply,
    /// Comma-separated values of all columns: a line with their names, and a line per row.
    Csv,
    /// Text, one `x y z nx ny nz` per line.
    Xyz,
    /// NumPy array of shape (N, 6), `<f4`, or `<f8` where the particles have an origin of their
    /// own: position and normal, and a column for each of the [values](crate::Sample::add_value).
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

/// A particle file: its format, and the record.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleFile {
    /// Format of the file.
    pub format: Format,
    /// The record, which PLY carries. For the other formats a program writes it to a separate file:
    /// [`RecordText::document`].
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
#[doc(hidden)]
pub enum ColumnKind {
    /// A coordinate: in double precision where the particles have an origin of their own, else in
    /// single precision.
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
#[doc(hidden)]
pub struct Column {
    /// Name in the file.
    pub name: &'static str,
    /// Type of the values.
    pub kind: ColumnKind,
    /// The particles that have the column.
    #[serde(skip)]
    pub(crate) presence: Presence,
    /// Returns the value of a particle, given by its index.
    #[serde(skip)]
    read: fn(&Particles, &quality::Measurements, usize) -> CellValue,
}

impl Column {
    /// The column where it is not in every file.
    const fn only(self, presence: Presence) -> Self {
        Self { presence, ..self }
    }
}

/// Which particles have a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    /// All particles.
    Always,
    /// Particles that are measured.
    Measured,
    /// Particles of a surface of several patches.
    Creased,
    /// Particles of a periodic cell, whose opposite faces have the same ones.
    Periodic,
    /// Particles that have followed a moving surface.
    Moved,
}

/// A value of a column; `Display` gives it as text.
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
}

impl fmt::Display for CellValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Double(value) => value.fmt(f),
            Self::Float(value) => value.fmt(f),
            Self::Int(value) => value.fmt(f),
            Self::Uint(value) => value.fmt(f),
            Self::Uchar(value) => value.fmt(f),
        }
    }
}

/// Whether coordinates are in double precision.
fn is_double(particles: &Particles) -> bool {
    particles.origin != DVec3::ZERO
}

/// The place of a particle in the coordinates of the formula.
fn coordinates(particles: &Particles, i: usize) -> [CellValue; 3] {
    if is_double(particles) {
        let p = particles.place(i);
        [CellValue::Double(p.x), CellValue::Double(p.y), CellValue::Double(p.z)]
    } else {
        let p = particles.local[i];
        [CellValue::Float(p.x), CellValue::Float(p.y), CellValue::Float(p.z)]
    }
}

const fn column(
    name: &'static str,
    kind: ColumnKind,
    read: fn(&Particles, &quality::Measurements, usize) -> CellValue,
) -> Column {
    Column { name, kind, presence: Presence::Always, read }
}

/// The columns of PLY and CSV files, in their order.
#[doc(hidden)]
pub const COLUMNS: &[Column] = &[
    column("x", ColumnKind::Coordinate, |particles, _, i| coordinates(particles, i)[0]),
    column("y", ColumnKind::Coordinate, |particles, _, i| coordinates(particles, i)[1]),
    column("z", ColumnKind::Coordinate, |particles, _, i| coordinates(particles, i)[2]),
    column("nx", ColumnKind::Float, |particles, _, i| CellValue::Float(particles.normal[i].x)),
    column("ny", ColumnKind::Float, |particles, _, i| CellValue::Float(particles.normal[i].y)),
    column("nz", ColumnKind::Float, |particles, _, i| CellValue::Float(particles.normal[i].z)),
    column("radius", ColumnKind::Float, |particles, _, i| CellValue::Float(particles.radius[i])),
    column("level", ColumnKind::Uint, |particles, _, i| CellValue::Uint(particles.level[i])),
    // All ones, the mark of a seed, is −1.
    column("parent", ColumnKind::Int, |particles, _, i| CellValue::Int(particles.parent[i].cast_signed())),
    column("valence", ColumnKind::Uchar, |_, measured, i| {
        CellValue::Uchar(measured.valence.get(i).copied().unwrap_or(0))
    })
    .only(Presence::Measured),
    column("nearest", ColumnKind::Float, |_, measured, i| {
        CellValue::Float(measured.nearest.get(i).copied().unwrap_or(f32::NAN))
    })
    .only(Presence::Measured),
    column("residual", ColumnKind::Float, |_, measured, i| {
        CellValue::Float(measured.residual.get(i).copied().unwrap_or(f32::NAN))
    })
    .only(Presence::Measured),
    column("singular", ColumnKind::Uchar, |particles, _, i| {
        CellValue::Uchar(particles.slots[i].is_singular().into())
    }),
    column("patch", ColumnKind::Uint, |particles, _, i| CellValue::Uint(particles.patch[i]))
        .only(Presence::Creased),
    // The first row of the particle: where patches meet, a particle has a row for each patch.
    column("particle", ColumnKind::Uint, |particles, _, i| CellValue::Uint(particles.first_row(i) as u32))
        .only(Presence::Creased),
    // For an image on an upper face of a periodic cell, the same particle on the lower face; else
    // the particle itself.
    column("periodic", ColumnKind::Uint, |particles, _, i| CellValue::Uint(particles.periodic[i]))
        .only(Presence::Periodic),
    column("identity", ColumnKind::Uint, |particles, _, i| CellValue::Uint(particles.identity[i]))
        .only(Presence::Moved),
];

/// The columns of a file: those that its particles have.
fn columns(particles: &Particles, measured: &quality::Measurements) -> Vec<&'static Column> {
    let is_there = |column: &&Column| match column.presence {
        Presence::Always => true,
        Presence::Measured => !measured.valence.is_empty(),
        Presence::Creased => !particles.patch.is_empty(),
        Presence::Periodic => !particles.periodic.is_empty(),
        Presence::Moved => !particles.identity.is_empty(),
    };
    COLUMNS.iter().filter(is_there).collect()
}

/// The added columns of a colour, if it is complete. PLY has them in eight bits and GLB as the
/// colours of its vertices, as programs expect.
fn colour_columns(measured: &quality::Measurements) -> Option<[&quality::NamedValues; 3]> {
    let column = |name: &&str| measured.values.iter().find(|added| added.name == **name);
    let [red, green, blue] = &CHANNELS;
    Some([column(red)?, column(green)?, column(blue)?])
}

/// Whether an added column is a part of a colour.
fn is_of_colour(measured: &quality::Measurements, name: &str) -> bool {
    CHANNELS.contains(&name) && colour_columns(measured).is_some()
}

/// The type of each added column in PLY, where the others have this type.
fn kinds_of_added(
    measured: &quality::Measurements,
    kind: ColumnKind,
) -> impl Iterator<Item = (ColumnKind, &str)> + '_ {
    measured.values.iter().map(move |added| {
        let kind = if is_of_colour(measured, &added.name) { ColumnKind::Uchar } else { kind };
        (kind, &*added.name)
    })
}

/// A number as one of this type.
fn cell_of(kind: ColumnKind, number: f32) -> CellValue {
    match kind {
        ColumnKind::Uchar => CellValue::Uchar((255.0 * number).round() as u8),
        ColumnKind::Coordinate => CellValue::Double(number.into()),
        _ => CellValue::Float(number),
    }
}

/// The values of a row in the added columns.
fn added(measured: &quality::Measurements, row: usize) -> impl Iterator<Item = CellValue> + '_ {
    measured.values.iter().map(move |added| CellValue::Float(added.values[row]))
}

/// Writes `particles` to `out`, which should be buffered: a record per row. `measured` is the
/// report on them: if it is empty, its columns are left out; particles beyond its end get a valence
/// of 0 and NaN for the rest. Floats in text are the shortest that read back to the same bits. PLY
/// carries the record, in comments.
///
/// # Errors
///
/// The errors of `out`.
#[doc(hidden)]
pub fn write(
    ParticleFile { format, record }: &ParticleFile,
    particles: &Particles,
    measured: &quality::Measurements,
    out: &mut dyn Write,
) -> io::Result<()> {
    match format {
        Format::Ply => ply_columns(particles, measured, None, record, 0..particles.len(), out),
        Format::Csv => csv(particles, measured, out),
        Format::Xyz => xyz(particles, out),
        Format::Npy => npy(particles, measured, out),
    }
}

/// PLY with all columns: rows of particles, and of triangles if there are any.
fn ply_columns(
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: Option<&[[u32; 3]]>,
    record: &RecordText,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let (n, columns) = (particles.len(), columns(particles, measured));
    let kinds: Vec<(ColumnKind, &str)> = kinds_of_added(measured, ColumnKind::Float).collect();
    if rows.start == 0 {
        let properties = columns.iter().map(|column| (column.kind, column.name)).chain(kinds.iter().copied());
        ply_header(particles, n, properties, triangles.map(<[_]>::len), record, out)?;
    }
    for i in rows.start.min(n)..rows.end.min(n) {
        for column in &columns {
            (column.read)(particles, measured, i).write_binary(out)?;
        }
        for ((kind, _), added) in kinds.iter().zip(&measured.values) {
            cell_of(*kind, added.values[i]).write_binary(out)?;
        }
    }
    ply_faces(&triangles.unwrap_or_default()[rows.start.max(n) - n..rows.end.max(n) - n], out)
}

/// PLY of a mesh: rows of vertices and of triangles. All properties of a vertex but its colour have
/// one type, because some readers require it.
fn ply_mesh(
    particles: &Particles,
    measured: &quality::Measurements,
    vertices: &Indexed,
    record: &RecordText,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let (n, is_double) = (vertices.rows.len(), is_double(particles));
    let own = if is_double { ColumnKind::Coordinate } else { ColumnKind::Float };
    let kinds: Vec<(ColumnKind, &str)> = kinds_of_added(measured, own).collect();
    if rows.start == 0 {
        let names = COLUMNS[..6].iter().map(|column| column.name);
        let properties = names.map(|name| (ColumnKind::Coordinate, name)).chain(kinds.iter().copied());
        ply_header(particles, n, properties, Some(vertices.triangles.len()), record, out)?;
    }
    for i in rows.start.min(n)..rows.end.min(n) {
        let of_kind = |c: f32| if is_double { CellValue::Double(c.into()) } else { CellValue::Float(c) };
        let (row, normal) = (vertices.rows[i] as usize, vertices.normals[i].to_array().map(of_kind));
        let added =
            kinds.iter().zip(&measured.values).map(|((kind, _), added)| cell_of(*kind, added.values[row]));
        for value in coordinates(particles, row).into_iter().chain(normal).chain(added) {
            value.write_binary(out)?;
        }
    }
    ply_faces(&vertices.triangles[rows.start.max(n) - n..rows.end.max(n) - n], out)
}

fn ply_faces(triangles: &[[u32; 3]], out: &mut dyn Write) -> io::Result<()> {
    for triangle in triangles {
        let mut record = [3; 13];
        for (bytes, index) in record[1..].chunks_exact_mut(4).zip(triangle) {
            bytes.copy_from_slice(&index.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

fn ply_header<'a>(
    particles: &Particles,
    vertices: usize,
    properties: impl Iterator<Item = (ColumnKind, &'a str)>,
    triangles: Option<usize>,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment Marching Particles\n")?;
    write!(out, "{}", record.comment("comment"))?;
    writeln!(out, "element vertex {vertices}")?;
    for (kind, name) in properties {
        let kind = match kind {
            ColumnKind::Coordinate if is_double(particles) => "double",
            ColumnKind::Coordinate | ColumnKind::Float => "float",
            ColumnKind::Int => "int",
            ColumnKind::Uint => "uint",
            ColumnKind::Uchar => "uchar",
        };
        writeln!(out, "property {kind} {name}")?;
    }
    if let Some(triangles) = triangles {
        write!(out, "element face {triangles}\nproperty list uchar uint vertex_indices\n")?;
    }
    writeln!(out, "end_header")
}

/// CSV begins with the names of the columns, as spreadsheets and data frames expect, so there is no
/// place for a record.
fn csv(particles: &Particles, measured: &quality::Measurements, out: &mut dyn Write) -> io::Result<()> {
    let columns = columns(particles, measured);
    let of_program = measured.values.iter().map(|added| &*added.name);
    let names: Vec<&str> = columns.iter().map(|column| column.name).chain(of_program).collect();
    writeln!(out, "{}", names.join(","))?;
    for i in 0..particles.len() {
        for (k, column) in columns.iter().enumerate() {
            out.write_all(if k == 0 { b"" } else { b"," })?;
            write!(out, "{}", (column.read)(particles, measured, i))?;
        }
        for value in added(measured, i) {
            write!(out, ",{value}")?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

fn xyz(particles: &Particles, out: &mut dyn Write) -> io::Result<()> {
    for (i, n) in particles.normal.iter().enumerate() {
        let [x, y, z] = coordinates(particles, i);
        writeln!(out, "{x} {y} {z} {} {} {}", n.x, n.y, n.z)?;
    }
    Ok(())
}

fn npy(particles: &Particles, measured: &quality::Measurements, out: &mut dyn Write) -> io::Result<()> {
    let (kind, width) = (if is_double(particles) { "<f8" } else { "<f4" }, 6 + measured.values.len());
    let mut header =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}, {}), }}", particles.len(), width);
    // Magic, version and length take 10 bytes. A line feed ends the header, and the data starts at
    // a multiple of 64.
    let padding = 64 - (10 + header.len() + 1) % 64;
    header.extend(core::iter::repeat_n(' ', padding % 64));
    header.push('\n');
    out.write_all(b"\x93NUMPY\x01\x00")?;
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    for (i, n) in particles.normal.iter().enumerate() {
        let of_kind = |value: f32| {
            if is_double(particles) { CellValue::Double(value.into()) } else { CellValue::Float(value) }
        };
        let added = measured.values.iter().map(|added| of_kind(added.values[i]));
        let normal = n.to_array().map(of_kind);
        for value in coordinates(particles, i).into_iter().chain(normal).chain(added) {
            value.write_binary(out)?;
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
            local: vec![Vec3::new(0.1, -2.0, 1e-9), Vec3::new(1.0 / 3.0, 4.0, 5.0)],
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
        write(&format.into(), &two(), &measured, &mut out).expect("writing to memory does not fail");
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
        particles.local[1] = particles.local[0];
        (particles.patch, particles.twins) = (vec![4, 9], vec![0, 0]);
        let mut out = Vec::new();
        write(&Format::Csv.into(), &particles, &quality::Measurements::default(), &mut out)
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
