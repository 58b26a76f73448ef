//! Binary glTF 2.0: a triangle mesh that viewers and modelling tools open at once.
//!
//! The specification is Khronos', <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.

use super::vertices::Indexed;
use super::{RecordText, colour_columns, is_of_colour};
use crate::math::functions::{cos, pow, sin_cos};
use crate::particles::Particles;
use crate::quality::{Measurements, NamedValues};
use glam::{DVec3, Vec3};
use std::borrow::Cow;
use std::io::{self, Write};

/// Numbers of the specification: types of components and kinds of buffers.
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// One material, through which the vertex colours show.
const MATERIALS: &str =
    r#""materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.7},"doubleSided":true}]"#;

/// A column of the binary buffer, with its accessor.
struct BufferColumn {
    name: Cow<'static, str>,
    target: u32,
    /// Members of the accessor, which say how the numbers are read.
    accessor: String,
    bytes: Vec<u8>,
}

/// Writes the triangles with vertex normals, the colours that were added or those of the particles'
/// generation levels, which programs find as the attribute `_LEVEL`, and added values. The z axis,
/// which points up here, is turned to glTF's y. A mesh without triangles is an empty scene.
pub(super) fn write(
    particles: &Particles,
    measured: &Measurements,
    vertices: &Indexed,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    let columns = columns(particles, measured, vertices);
    let length: usize = columns.iter().map(|column| column.bytes.len()).sum();
    let mut text = document(&columns, length, particles.origin, record).into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    // The header, then each part after its length and its kind.
    let whole = 12 + 8 + text.len() + if length > 0 { 8 + length } else { 0 };
    let size = |bytes: usize| u32::try_from(bytes).map_err(|_| io::Error::other("glTF holds up to 4 GiB"));
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&size(whole)?.to_le_bytes())?;
    out.write_all(&size(text.len())?.to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if length > 0 {
        out.write_all(&size(length)?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
    }
    columns.iter().try_for_each(|column| out.write_all(&column.bytes))
}

/// The contents of the buffer; each column is a multiple of four bytes long. The triangles come
/// last.
fn columns(
    particles: &Particles,
    measured: &Measurements,
    Indexed { rows, normals, triangles }: &Indexed,
) -> Vec<BufferColumn> {
    if triangles.is_empty() {
        return Vec::new();
    }
    let positions: Vec<Vec3> = rows.iter().map(|&row| particles.local[row as usize]).collect();
    let mut lo = Vec3::INFINITY;
    let mut hi = Vec3::NEG_INFINITY;
    for &p in &positions {
        (lo, hi) = (lo.min(p), hi.max(p));
    }
    let accessor = |kind: u32, shape: &str, rest: &str| {
        format!(r#""componentType":{kind},"type":"{shape}","count":{}{rest}"#, rows.len())
    };
    let vectors =
        |vectors: &[Vec3]| vectors.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect();
    let levels = rows.iter().map(|&row| particles.level[row as usize]);
    let colours = colours(levels.clone().max().unwrap_or(0));
    let attribute = |name: &'static str, accessor, bytes| BufferColumn {
        name: name.into(),
        target: ARRAY_BUFFER,
        accessor,
        bytes,
    };
    let painted = colour_columns(measured);
    let light =
        |column: &NamedValues, row: u32| (65_535.0 * linear(column.values[row as usize])).round() as u16;
    let colour = match painted {
        Some(parts) => attribute(
            "COLOR_0",
            accessor(UNSIGNED_SHORT, "VEC4", r#","normalized":true"#),
            rows.iter()
                .flat_map(|&row| parts.map(|part| light(part, row)).into_iter().chain([u16::MAX]))
                .flat_map(u16::to_le_bytes)
                .collect(),
        ),
        None => attribute(
            "COLOR_0",
            accessor(UNSIGNED_BYTE, "VEC4", r#","normalized":true"#),
            levels.clone().flat_map(|level| colours[level as usize]).collect(),
        ),
    };
    let others = measured.values.iter().filter(|added| !is_of_colour(measured, &added.name));
    let added = others.map(|added| BufferColumn {
        name: format!("_{}", added.name.to_ascii_uppercase()).into(),
        target: ARRAY_BUFFER,
        accessor: accessor(FLOAT, "SCALAR", ""),
        bytes: rows.iter().flat_map(|&row| added.values[row as usize].to_le_bytes()).collect(),
    });
    let extent = format!(r#","min":{:?},"max":{:?}"#, lo.as_dvec3().to_array(), hi.as_dvec3().to_array());
    let index_count = 3 * triangles.len();
    let mut columns = vec![
        attribute("POSITION", accessor(FLOAT, "VEC3", &extent), vectors(&positions)),
        attribute("NORMAL", accessor(FLOAT, "VEC3", ""), vectors(normals)),
        colour,
        // Attributes cannot be 32-bit integers.
        attribute(
            "_LEVEL",
            accessor(FLOAT, "SCALAR", ""),
            levels.flat_map(|level| (level as f32).to_le_bytes()).collect(),
        ),
    ];
    columns.extend(added);
    columns.push(BufferColumn {
        name: "indices".into(),
        target: ELEMENT_ARRAY_BUFFER,
        accessor: format!(r#""componentType":{UNSIGNED_INT},"type":"SCALAR","count":{index_count}"#),
        bytes: triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()).collect(),
    });
    columns
}

/// The linear share of light of a value in sRGB (IEC 61966-2-1).
fn linear(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { pow((value + 0.055) / 1.055, 2.4) }
}

/// The text part, JSON: a scene with one mesh, and where its columns are in the buffer.
fn document(columns: &[BufferColumn], length: usize, origin: DVec3, record: &RecordText) -> String {
    let extras = record.member();
    let asset = format!(r#""asset":{{"version":"2.0","generator":"Marching Particles"{extras}}},"scene":0"#);
    if columns.is_empty() {
        return format!(r#"{{{asset},"scenes":[{{}}]}}"#);
    }
    let (mut views, mut accessors, mut attributes) = (Vec::new(), Vec::new(), Vec::new());
    let mut offset = 0;
    for (k, BufferColumn { name, target, accessor, bytes }) in columns.iter().enumerate() {
        let size = bytes.len();
        views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{size},"target":{target}}}"#));
        accessors.push(format!(r#"{{"bufferView":{k},{accessor}}}"#));
        if *target == ARRAY_BUFFER {
            attributes.push(format!(r#""{name}":{k}"#));
        }
        offset += size;
    }
    let [views, accessors, attributes] = [views, accessors, attributes].map(|list| list.join(","));
    let indices = columns.len() - 1;
    // A quarter turn about x: z becomes y.
    let half = core::f32::consts::FRAC_1_SQRT_2;
    let translation = if origin == DVec3::ZERO {
        String::new()
    } else {
        format!(r#","translation":[{},{},{}]"#, origin.x, origin.z, -origin.y)
    };
    let members = [
        asset,
        r#""scenes":[{"nodes":[0]}]"#.to_owned(),
        format!(r#""nodes":[{{"mesh":0,"rotation":[-{half},0,0,{half}]{translation}}}]"#),
        format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{{attributes}}},"indices":{indices},"material":0}}]}}]"#
        ),
        MATERIALS.to_owned(),
        format!(r#""buffers":[{{"byteLength":{length}}}],"bufferViews":[{views}],"accessors":[{accessors}]"#),
    ];
    format!("{{{}}}", members.join(","))
}

/// Colours of the generation levels up to `last`, linear, with opacity: those of the page in its
/// light theme around a seed, from blue to sand with a light ring every eight levels. They are
/// computed in OKLab (Björn Ottosson, "A perceptual color space for image processing", 2020).
fn colours(last: u32) -> Vec<[u8; 4]> {
    /// Levels from one light ring to the next, and exponent of the blend from blue to sand.
    const RING: f32 = 8.0;
    const WAY: f32 = 1.4;
    (0..=last)
        .map(|level| {
            let ring = 0.5 - 0.5 * cos(core::f32::consts::TAU * level as f32 / RING);
            let way = pow(level as f32 / last.max(1) as f32, WAY);
            let (sin, cos) = sin_cos((262.0 - 177.0 * way).to_radians());
            let chroma = 0.072 - 0.030 * ring;
            bytes_from_oklab(0.79 + 0.10 * ring, chroma * cos, chroma * sin)
        })
        .collect()
}

/// A colour of OKLab as linear sRGB, with opacity.
fn bytes_from_oklab(lightness: f32, a: f32, b: f32) -> [u8; 4] {
    let cube = |x: f32| x * x * x;
    let l = cube(lightness + 0.396_337_78 * a + 0.215_803_76 * b);
    let m = cube(lightness - 0.105_561_346 * a - 0.063_854_17 * b);
    let s = cube(lightness - 0.089_484_18 * a - 1.291_485_5 * b);
    let linear = [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ];
    let [red, green, blue] = linear.map(|share| (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    [red, green, blue, u8::MAX]
}
