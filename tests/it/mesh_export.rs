//! Mesh files, read back. `cargo xtask test gltf` gives the GLB files that this writes to Khronos' validator.

use crate::runs::of_gallery;
use glam::Vec3;
use marching_particles::export::{MeshFile, MeshFormat, Placement, Unit, UpAxis, write_mesh};
use marching_particles::field::gallery;
use marching_particles::mesh::build::triangulate;
use marching_particles::particles::Particles;
use marching_particles::quality;
use marching_particles::sampler::Settings;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

fn sampled(id: &str, radius_share: f64) -> (Particles, Vec<[u32; 3]>) {
    let surface = gallery::find(id).expect("a surface of the gallery");
    let particles = of_gallery(id, &settings!(radius_share; ..Settings::default())).particles().clone();
    let mesh = triangulate(&particles, Some(&surface.bounds));
    assert!(mesh.triangles.len() > 1000);
    (particles, mesh.triangles)
}

fn written(format: MeshFormat, particles: &Particles, triangles: &[[u32; 3]]) -> Vec<u8> {
    placed(format, particles, triangles, &Placement::default())
}

fn placed(
    format: MeshFormat,
    particles: &Particles,
    triangles: &[[u32; 3]],
    placement: &Placement,
) -> Vec<u8> {
    let mut out = Vec::new();
    let file = MeshFile { placement: *placement, ..format.into() };
    write_mesh(&file, particles, &quality::Measurements::default(), triangles, &mut out)
        .expect("writing to memory does not fail");
    out
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn vectors(bytes: &[u8]) -> Vec<Vec3> {
    floats(bytes).chunks_exact(3).map(Vec3::from_slice).collect()
}

fn triples(bytes: &[u8]) -> Vec<[u32; 3]> {
    bytes.chunks_exact(12).map(|b| [0, 4, 8].map(|at| word(b, at))).collect()
}

/// The document of a GLB file and its buffer.
fn parts(bytes: &[u8]) -> (Value, &[u8]) {
    assert_eq!(bytes[..4], *b"glTF");
    assert_eq!((word(bytes, 4), word(bytes, 8) as usize), (2, bytes.len()));
    let text = word(bytes, 12) as usize;
    assert_eq!(bytes[16..20], *b"JSON");
    let document = serde_json::from_slice(&bytes[20..20 + text]).expect("a document");
    let rest = &bytes[20 + text..];
    if rest.is_empty() {
        return (document, rest);
    }
    assert_eq!(rest[4..8], *b"BIN\0");
    assert_eq!(word(rest, 0) as usize, rest.len() - 8);
    (document, &rest[8..])
}

/// The bytes of an accessor.
fn column<'a>(document: &Value, buffer: &'a [u8], accessor: &Value) -> &'a [u8] {
    let accessor = &document["accessors"][accessor.as_u64().expect("an accessor") as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
    let [offset, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().expect(key) as usize);
    &buffer[offset..offset + length]
}

#[test]
fn glb_holds_triangles_normals_and_levels() {
    for (id, radius_share) in [("ellipsoid", 0.015), ("schwarz-p", 0.008)] {
        let (particles, triangles) = sampled(id, radius_share);
        let bytes = written(MeshFormat::Glb, &particles, &triangles);
        std::fs::write(file(&format!("mesh-{id}.glb")), &bytes).expect("the file can be written");
        let (document, buffer) = parts(&bytes);
        let primitive = &document["meshes"][0]["primitives"][0];
        let attribute = |name: &str| column(&document, buffer, &primitive["attributes"][name]);
        assert_eq!(vectors(attribute("POSITION")), particles.position);
        assert_eq!(vectors(attribute("NORMAL")), particles.normal);
        assert_eq!(triples(column(&document, buffer, &primitive["indices"])), triangles);
        let levels: Vec<f32> = particles.level.iter().map(|&level| level as f32).collect();
        assert_eq!(floats(attribute("_LEVEL")), levels);
        // Twelve colours, one after the other from level to level.
        let colours = attribute("COLOR_0");
        let colour = |i: usize| &colours[4 * i..4 * i + 4];
        let distinct: BTreeSet<&[u8]> = (0..particles.len()).map(colour).collect();
        assert_eq!(distinct.len(), 12);
        for i in 1..particles.len() {
            let same = particles.level[i] % 12 == particles.level[i - 1] % 12;
            assert_eq!(colour(i) == colour(i - 1), same, "{id}, particle {i}");
        }
    }
}

#[test]
fn a_glb_without_triangles_is_an_empty_scene() {
    let bytes = written(MeshFormat::Glb, &Particles::default(), &[]);
    std::fs::write(file("mesh-empty.glb"), &bytes).expect("the file can be written");
    let (document, buffer) = parts(&bytes);
    assert_eq!(document["asset"]["version"], "2.0");
    assert!(document.get("meshes").is_none() && buffer.is_empty());
}

#[test]
fn obj_holds_vertices_normals_and_triangles() {
    let (particles, triangles) = sampled("torus", 0.01);
    let text = String::from_utf8(written(MeshFormat::Obj, &particles, &triangles)).expect("text");
    let rows = |key: &str| {
        let of_key = |line: &str| line.strip_prefix(&format!("{key} ")).map(str::to_owned);
        text.lines().filter_map(of_key).collect::<Vec<String>>()
    };
    let vectors = |key: &str| -> Vec<Vec3> {
        let numbers = |row: &String| -> Vec<f32> {
            row.split(' ').map(|number| number.parse().expect("a number")).collect()
        };
        rows(key).iter().map(|row| Vec3::from_slice(&numbers(row))).collect()
    };
    assert_eq!(vectors("v"), particles.position);
    assert_eq!(vectors("vn"), particles.normal);
    let faces = rows("f");
    assert_eq!(faces.len(), triangles.len());
    for (face, triangle) in faces.iter().zip(&triangles) {
        let corners = triangle.map(|v| format!("{0}//{0}", v + 1));
        assert_eq!(*face, corners.join(" "));
    }
}

#[test]
fn stl_holds_triangles_that_face_outward() {
    let (particles, triangles) = sampled("torus", 0.01);
    let bytes = written(MeshFormat::Stl, &particles, &triangles);
    assert!(!bytes.starts_with(b"solid"));
    assert_eq!(word(&bytes, 80) as usize, triangles.len());
    assert_eq!(bytes.len(), 84 + 50 * triangles.len());
    let mut volume = 0.0;
    for (record, triangle) in bytes[84..].chunks_exact(50).zip(&triangles) {
        let read = vectors(&record[..48]);
        let corners = triangle.map(|v| particles.position[v as usize]);
        assert_eq!(read[1..], corners);
        assert!((read[0].length() - 1.0).abs() < 1e-5);
        assert!(read[0].dot(particles.normal[triangle[0] as usize]) > 0.5);
        volume += f64::from(corners[0].dot(corners[1].cross(corners[2]))) / 6.0;
    }
    // 2 π² R r², a little less for the chords.
    let exact = 2.0 * core::f64::consts::PI.powi(2) * 0.16;
    assert!((volume / exact - 0.99).abs() < 0.01, "{volume} of {exact}");
}

#[test]
fn ply_holds_the_columns_and_the_triangles() {
    let (particles, triangles) = sampled("torus", 0.01);
    let bytes = written(MeshFormat::Ply, &particles, &triangles);
    let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = std::str::from_utf8(&bytes[..end]).expect("a text header");
    let (vertex, face) = header.split_once("element face ").expect("faces");
    assert!(vertex.contains(&format!("element vertex {}\n", particles.len())));
    assert!(vertex.contains("property uint level\n"));
    let face = face.strip_suffix("end_header\n").expect("the last line");
    assert_eq!(face, format!("{}\nproperty list uchar uint vertex_indices\n", triangles.len()));
    let faces = &bytes[bytes.len() - 13 * triangles.len()..];
    for (record, triangle) in faces.chunks_exact(13).zip(&triangles) {
        assert_eq!(record[0], 3);
        assert_eq!(triples(&record[1..]), [*triangle]);
    }
    let record = (bytes.len() - faces.len() - end) / particles.len();
    for (k, row) in bytes[end..bytes.len() - faces.len()].chunks_exact(record).enumerate() {
        assert_eq!(vectors(&row[..24]), [particles.position[k], particles.normal[k]]);
    }
}

/// A 3MF file's documents by their names: the archive is read by its central directory, as readers do.
fn entries(bytes: &[u8]) -> BTreeMap<String, &[u8]> {
    let half = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let end = bytes.len() - 22;
    assert_eq!(bytes[end..end + 4], *b"PK\x05\x06");
    let mut at = word(bytes, end + 16) as usize;
    let mut entries = BTreeMap::new();
    for _ in 0..half(end + 10) {
        assert_eq!(bytes[at..at + 4], *b"PK\x01\x02");
        let (size, name_length, local) =
            (word(bytes, at + 24) as usize, half(at + 28), word(bytes, at + 42) as usize);
        let name = String::from_utf8(bytes[at + 46..at + 46 + name_length].to_vec()).expect("a name");
        assert_eq!((&bytes[local..local + 4], half(local + 8)), (b"PK\x03\x04".as_slice(), 0));
        let content = local + 30 + half(local + 26) + half(local + 28);
        entries.insert(name, &bytes[content..content + size]);
        at += 46 + name_length;
    }
    assert_eq!(at, end);
    entries
}

/// The numbers in quotes of each element of this name.
fn elements(model: &str, name: &str) -> Vec<Vec<f64>> {
    let numbers =
        |element: &str| element.split('"').skip(1).step_by(2).map(|n| n.parse().expect("a number")).collect();
    model
        .split(&format!("<{name} "))
        .skip(1)
        .map(|rest| numbers(rest.split("/>").next().expect("an end")))
        .collect()
}

#[test]
fn three_mf_holds_each_particle_of_a_triangle_once_with_its_unit() {
    let (mut particles, triangles) = sampled("torus", 0.01);
    // The last row is the same particle as the first one, as on a crease.
    let n = particles.len();
    particles.position[n - 1] = particles.position[0];
    particles.twins = (0..n as u32 - 1).chain([0]).collect();
    let placement = Placement { scale: 25.0, unit: Some(Unit::Inch), ..Placement::default() };
    let bytes = placed(MeshFormat::ThreeMf, &particles, &triangles, &placement);
    let entries = entries(&bytes);
    assert!(["[Content_Types].xml", "_rels/.rels"].iter().all(|name| entries.contains_key(*name)));
    let model = std::str::from_utf8(entries["3D/3dmodel.model"]).expect("text");
    assert!(model.contains(r#"<model unit="inch""#));
    let (vertices, faces) = (elements(model, "vertex"), elements(model, "triangle"));
    assert_eq!((vertices.len(), faces.len()), (n - 1, triangles.len()));
    for (face, triangle) in faces.iter().zip(&triangles) {
        for (&v, &row) in face.iter().zip(triangle) {
            let expected = particles.place(row as usize) * 25.0;
            assert!((glam::DVec3::from_slice(&vertices[v as usize]) - expected).length() < 1e-5);
        }
    }
    let none = placed(MeshFormat::ThreeMf, &particles, &[], &placement);
    assert!(
        std::str::from_utf8(self::entries(&none)["3D/3dmodel.model"]).expect("text").contains("<build/>")
    );
}

#[test]
fn meshes_are_written_in_the_size_and_orientation_asked_for() {
    let (particles, triangles) = sampled("ellipsoid", 0.015);
    let first = particles.position[triangles[0][0] as usize].to_array();
    let corner = |placement: &Placement| {
        vectors(&placed(MeshFormat::Stl, &particles, &triangles, placement)[96..108])[0]
    };
    for (up, [x, y, z]) in [(UpAxis::X, [1, 2, 0]), (UpAxis::Y, [2, 0, 1]), (UpAxis::Z, [0, 1, 2])] {
        let placement = Placement { scale: 2.0, up, ..Placement::default() };
        assert_eq!(corner(&placement), 2.0 * Vec3::new(first[x], first[y], first[z]), "{up:?}");
    }
    // Lengths in GLB are metres.
    let placement = Placement { scale: 20.0, unit: Some(Unit::Millimetre), ..Placement::default() };
    let bytes = placed(MeshFormat::Glb, &particles, &triangles, &placement);
    let (document, buffer) = parts(&bytes);
    let position = &document["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    for (written, p) in vectors(column(&document, buffer, position)).iter().zip(&particles.position) {
        assert!((*written - *p * 0.02).length() < 1e-6);
    }
}

#[test]
fn extension_names_the_format_in_either_case() {
    assert_eq!(MeshFormat::of_extension("GLB"), Some(MeshFormat::Glb));
    assert_eq!(MeshFormat::of_extension("stl"), Some(MeshFormat::Stl));
    assert_eq!(MeshFormat::of_extension("csv"), None);
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}
