//! Mesh files, read back. `cargo xtask test gltf` gives the GLB files that this writes to Khronos'
//! validator.

use crate::runs::of_gallery;
use glam::Vec3;
use marching_particles::export::{
    Bodies, MeshBuffers, MeshFile, MeshFormat, Placement, Unit, UpAxis, Vertices, write_mesh,
};
use marching_particles::field::gallery;
use marching_particles::mesh::triangulation::{Triangulation, triangulate};
use marching_particles::mesh::{Body, Inside, Topology};
use marching_particles::particles::Particles;
use marching_particles::sampler::Settings;
use marching_particles::{Formula, Sample, TriangleMesh, Warning, quality, sample};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::path::PathBuf;

fn sampled(id: &str, radius_share: f64) -> (Particles, Triangulation) {
    let surface = gallery::find(id).expect("a surface of the gallery");
    let particles = of_gallery(id, &settings!(radius_share; ..Settings::default())).particles().clone();
    let mesh = triangulate(&particles, Some(&surface.bounds));
    assert!(mesh.triangles.len() > 1000);
    (particles, mesh)
}

fn written(format: MeshFormat, particles: &Particles, mesh: &Triangulation) -> Vec<u8> {
    placed(format, particles, mesh, &Placement::default())
}

fn placed(format: MeshFormat, particles: &Particles, mesh: &Triangulation, placement: &Placement) -> Vec<u8> {
    file_of(&MeshFile { placement: *placement, ..format.into() }, particles, mesh)
}

fn file_of(file: &MeshFile, particles: &Particles, mesh: &Triangulation) -> Vec<u8> {
    let mut out = Vec::new();
    write_mesh(file, particles, &quality::Measurements::default(), mesh, &mut out)
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

#[test]
fn a_shell_is_one_body_and_files_hold_those_that_are_wanted() {
    // A shell, a ball in its hollow, and a small ball beside it.
    let text = "r = sqrt(x^2 + y^2 + z^2); min(|r - 1| - 0.1, r - 0.5, hypot(x - 2, y, z) - 0.1)";
    let settings = settings!(radius_share: 0.006; ..Settings::default());
    let sample = sample(Formula::parse(text).expect("a formula"), &settings).expect("a surface");
    let mesh = sample.mesh();
    assert_eq!(mesh.topology.components.len(), 4);
    let bodies = mesh.bodies(sample.particles());
    let [shell, ball, chip] = &bodies[..] else { panic!("{bodies:?}") };
    // A chip of few particles is smaller than its ball.
    let is_near = |body: &Body, area: f64, middle: f64, radius: f64| {
        let close = if body.is_chip { 0.1 } else { 0.02 };
        let reaches = [[-radius; 3], [radius; 3]].map(|[x, y, z]| [middle + x, y, z]);
        let off = [body.min, body.max].into_iter().flatten().zip(reaches.into_iter().flatten());
        (body.area / area - 1.0).abs() < close && off.into_iter().all(|(a, b)| (a - b).abs() < 0.02)
    };
    assert!(is_near(shell, 4.0 * PI * (1.1 * 1.1 + 0.9 * 0.9), 0.0, 1.1), "{shell:?}");
    assert!(is_near(ball, PI, 0.0, 0.5), "{ball:?}");
    assert!(is_near(chip, 0.04 * PI, 2.0, 0.1), "{chip:?}");
    assert_eq!([shell, ball, chip].map(|body| body.is_chip), [false, false, true]);
    for (body, cubes) in bodies.iter().zip([1.1_f64.powi(3) - 0.9_f64.powi(3), 0.125, 0.001]) {
        let ball = 4.0 / 3.0 * PI * cubes;
        let close = if body.is_chip { 0.15 } else { 0.05 };
        assert!(body.volume.is_some_and(|volume| (volume / ball - 1.0).abs() < close), "{body:?}");
    }
    for (which, components, side) in
        [(Bodies::All, 4, 3.2), (Bodies::WithoutChips, 3, 2.2), (Bodies::Largest, 2, 2.2)]
    {
        assert!((which.size(&bodies).x - side).abs() < 0.02, "{which:?}: {}", which.size(&bodies));
        let mut bytes = Vec::new();
        let file = MeshFile { bodies: which, ..MeshFormat::Obj.into() };
        sample.write_mesh(file, &mut bytes).expect("writing to memory does not fail");
        let Obj { points, triangles, .. } = Obj::read(&bytes);
        let topology = Topology::new(&triangles, points.len());
        assert!(topology.is_closed());
        assert_eq!(topology.components.len(), components, "{which:?}");
    }
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
        let (particles, mesh) = sampled(id, radius_share);
        let bytes = written(MeshFormat::Glb, &particles, &mesh);
        std::fs::write(file(&format!("mesh-{id}.glb")), &bytes).expect("the file can be written");
        let (document, buffer) = parts(&bytes);
        let primitive = &document["meshes"][0]["primitives"][0];
        let attribute = |name: &str| column(&document, buffer, &primitive["attributes"][name]);
        assert_eq!(vectors(attribute("POSITION")), particles.local);
        assert_eq!(vectors(attribute("NORMAL")), particles.normal);
        assert_eq!(triples(column(&document, buffer, &primitive["indices"])), mesh.triangles);
        let read = TriangleMesh::read("a.glb", bytes.clone()).expect("what was written");
        assert_eq!(read.faces(), mesh.triangles);
        for (p, &q) in read.vertices().iter().zip(&particles.local) {
            assert!(p.distance(particles.origin + q.as_dvec3()) < 1e-12, "{id}: {p}");
        }
        let levels: Vec<f32> = particles.level.iter().map(|&level| level as f32).collect();
        assert_eq!(floats(attribute("_LEVEL")), levels);
        // Each level has a colour, from blue at the seed to sand at the last one.
        let colours = attribute("COLOR_0");
        let colour = |i: usize| &colours[4 * i..4 * i + 4];
        let distinct: BTreeSet<&[u8]> = (0..particles.len()).map(colour).collect();
        let last = particles.level.iter().copied().max().expect("a particle");
        assert_eq!(distinct.len(), last as usize + 1, "{id}");
        for i in 1..particles.len() {
            let same = particles.level[i] == particles.level[i - 1];
            assert_eq!(colour(i) == colour(i - 1), same, "{id}, particle {i}");
        }
        let end = particles.level.iter().position(|&level| level == last).expect("its last level");
        let is_blue = |c: &[u8]| c[2] > c[0] && c[2] > c[1];
        assert!(
            is_blue(colour(0)) && colour(end)[0] > colour(end)[2],
            "{id}: {:?}, {:?}",
            colour(0),
            colour(end)
        );
    }
}

#[test]
fn a_glb_without_triangles_is_an_empty_scene() {
    let bytes = written(MeshFormat::Glb, &Particles::default(), &Triangulation::default());
    std::fs::write(file("mesh-empty.glb"), &bytes).expect("the file can be written");
    let (document, buffer) = parts(&bytes);
    assert_eq!(document["asset"]["version"], "2.0");
    assert!(document.get("meshes").is_none() && buffer.is_empty());
}

#[test]
fn obj_holds_vertices_normals_and_triangles() {
    let (particles, mesh) = sampled("torus", 0.01);
    let obj = Obj::read(&written(MeshFormat::Obj, &particles, &mesh));
    assert_eq!(obj.points, particles.local);
    assert_eq!(obj.normals, particles.normal);
    assert_eq!((&obj.triangles, &obj.of_normals), (&mesh.triangles, &mesh.triangles));
}

/// The statements of an OBJ file.
struct Obj {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// The normals at the corners of the triangles.
    of_normals: Vec<[u32; 3]>,
}

impl Obj {
    fn read(bytes: &[u8]) -> Self {
        let text = std::str::from_utf8(bytes).expect("text");
        let rows = |key: &'static str| {
            let of_key = text.lines().filter_map(move |line| line.strip_prefix(key)?.strip_prefix(' '));
            of_key.map(|row| row.split(' ').collect::<Vec<&str>>())
        };
        let vectors = |key| {
            let vector = |row: Vec<&str>| {
                Vec3::from_slice(&row.iter().map(|n| n.parse().expect("a number")).collect::<Vec<f32>>())
            };
            rows(key).map(vector).collect()
        };
        let corners = |k: usize| {
            let index =
                |word: &&str| word.split("//").nth(k).expect("v//vn").parse::<u32>().expect("an index") - 1;
            let triple =
                |row: Vec<&str>| row.iter().map(index).collect::<Vec<u32>>().try_into().expect("a triangle");
            rows("f").map(triple).collect()
        };
        Self { points: vectors("v"), normals: vectors("vn"), triangles: corners(0), of_normals: corners(1) }
    }
}

#[test]
fn stl_holds_triangles_that_face_outward() {
    let (particles, mesh) = sampled("torus", 0.01);
    let triangles = &mesh.triangles;
    let bytes = written(MeshFormat::Stl, &particles, &mesh);
    assert!(!bytes.starts_with(b"solid"));
    assert_eq!(word(&bytes, 80) as usize, triangles.len());
    assert_eq!(bytes.len(), 84 + 50 * triangles.len());
    let mut volume = 0.0;
    for (record, triangle) in bytes[84..].chunks_exact(50).zip(triangles) {
        let read = vectors(&record[..48]);
        let corners = triangle.map(|v| particles.local[v as usize]);
        assert_eq!(read[1..], corners);
        assert!((read[0].length() - 1.0).abs() < 1e-5);
        assert!(read[0].dot(particles.normal[triangle[0] as usize]) > 0.5);
        volume += f64::from(corners[0].dot(corners[1].cross(corners[2]))) / 6.0;
    }
    // 2 π² R r², a little less for the chords.
    let exact = 2.0 * core::f64::consts::PI.powi(2) * 0.16;
    assert!((volume / exact - 0.99).abs() < 0.01, "{volume} of {exact}");
}

/// A PLY file: its header up to the faces and after, and the bytes that follow.
fn ply_parts(bytes: &[u8]) -> (&str, &str, &[u8]) {
    let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = std::str::from_utf8(&bytes[..end]).expect("a text header");
    let (vertex, face) = header.split_once("element face ").expect("faces");
    (vertex, face, &bytes[end..])
}

fn ply_triangles(data: &[u8], count: usize) -> Vec<[u32; 3]> {
    let faces = data[data.len() - 13 * count..].chunks_exact(13);
    faces
        .map(|record| if record[0] == 3 { triples(&record[1..])[0] } else { panic!("no triangle") })
        .collect()
}

#[test]
fn ply_of_a_mesh_holds_numbers_of_one_type_and_the_triangles() {
    let (particles, mesh) = sampled("torus", 0.01);
    let bytes = written(MeshFormat::Ply, &particles, &mesh);
    let (vertex, face, data) = ply_parts(&bytes);
    let properties: Vec<&str> = vertex.lines().filter_map(|line| line.strip_prefix("property ")).collect();
    assert_eq!(properties, ["float x", "float y", "float z", "float nx", "float ny", "float nz"]);
    assert!(vertex.contains(&format!("element vertex {}\n", particles.len())));
    let face = face.strip_suffix("end_header\n").expect("the last line");
    assert_eq!(face, format!("{}\nproperty list uchar uint vertex_indices\n", mesh.triangles.len()));
    assert_eq!(ply_triangles(data, mesh.triangles.len()), mesh.triangles);
    for (k, row) in data[..24 * particles.len()].chunks_exact(24).enumerate() {
        assert_eq!(vectors(row), [particles.local[k], particles.normal[k]]);
    }
}

#[test]
fn ply_with_columns_holds_those_of_the_particles() {
    let (particles, mesh) = sampled("torus", 0.01);
    let file = MeshFile { vertices: Vertices::Columns, ..MeshFormat::Ply.into() };
    let bytes = file_of(&file, &particles, &mesh);
    let (vertex, _, data) = ply_parts(&bytes);
    assert!(vertex.contains("property uint level\n") && vertex.contains("property int parent\n"));
    assert_eq!(ply_triangles(data, mesh.triangles.len()), mesh.triangles);
    let rows = &data[..data.len() - 13 * mesh.triangles.len()];
    for (k, row) in rows.chunks_exact(rows.len() / particles.len()).enumerate() {
        assert_eq!(vectors(&row[..24]), [particles.local[k], particles.normal[k]]);
        assert_eq!(word(row, 28), particles.level[k]);
    }
}

fn of_formula(text: &str, count: u32) -> Sample {
    sample(Formula::parse(text).expect("a formula"), &Settings::with_count(count))
        .expect("there is a surface")
}

/// Six times the volume of triangles over points.
fn volume(points: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let at = |v: u32| points[v as usize].as_dvec3();
    triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum::<f64>() / 6.0
}

/// Whether the triangles face as the normals at their corners do.
fn face_alike(points: &[Vec3], triangles: &[[u32; 3]], normals: &[Vec3], of_normals: &[[u32; 3]]) -> bool {
    triangles.iter().zip(of_normals).all(|(triangle, of_normals)| {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let mean: Vec3 = of_normals.iter().map(|&v| normals[v as usize]).sum();
        (b - a).cross(c - a).dot(mean) > 0.0
    })
}

/// Sharp edges, with the number of triangles at a corner, the Euler number and the volume of each
/// solid; f is smaller inside, or larger.
const SHARP: [(&str, i64, f64); 6] = [
    ("max(abs(x), abs(y), abs(z)) - 1", 2, 8.0),
    ("1 - max(abs(x), abs(y), abs(z))", 2, 8.0),
    ("max(x^2 + y^2 - 1, abs(z) - 1)", 2, core::f64::consts::TAU),
    ("min(1 - x^2 - y^2, 1 - abs(z))", 2, core::f64::consts::TAU),
    ("max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5, 0.36 - x^2 - y^2)", 0, 2.869),
    ("max(x^2 + y^2 + z^2 - 1, 0.25 - x^2 - y^2 - z^2, x)", 2, 1.8326),
];

#[test]
fn files_of_sharp_solids_are_closed_and_face_outward() {
    for (text, euler, expected) in SHARP {
        let sample = of_formula(text, 1500);
        let (particles, mesh) = (sample.particles(), sample.mesh());
        assert!(particles.len() > particles.count(), "{text}: creases");
        let check = |points: &[Vec3], triangles: &[[u32; 3]], what: &str| {
            let topology = Topology::new(triangles, points.len());
            assert!(topology.is_closed(), "{text}, {what}: {} borders", topology.borders.len());
            assert_eq!((topology.euler(), points.len()), (euler, particles.count()), "{text}, {what}");
            let volume = volume(points, triangles);
            assert!((volume / expected - 1.0).abs() < 0.02, "{text}, {what}: volume {volume}");
        };
        assert_eq!(Topology::new(&mesh.triangles, particles.len()), mesh.topology, "{text}");
        let told = sample.volume().expect("closed");
        assert!((told / expected - 1.0).abs() < 0.02, "{text}: volume {told}");

        let ply = written(MeshFormat::Ply, particles, mesh);
        let (_, _, data) = ply_parts(&ply);
        let triangles = ply_triangles(data, mesh.triangles.len());
        let points: Vec<Vec3> =
            data[..data.len() - 13 * triangles.len()].chunks_exact(24).map(|row| vectors(row)[0]).collect();
        check(&points, &triangles, "PLY");
        for vertices in [Vertices::Joined, Vertices::Split] {
            let obj = Obj::read(&file_of(&MeshFile { vertices, ..MeshFormat::Obj.into() }, particles, mesh));
            check(&obj.points, &obj.triangles, "OBJ");
            assert!(
                face_alike(&obj.points, &obj.triangles, &obj.normals, &obj.of_normals),
                "{text}, {vertices:?}"
            );
            assert!(obj.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5), "{text}");
            assert_eq!(obj.normals.len() > obj.points.len(), vertices == Vertices::Split, "{text}");
            assert_eq!(obj.triangles == obj.of_normals, vertices == Vertices::Joined, "{text}");

            let glb = file_of(&MeshFile { vertices, ..MeshFormat::Glb.into() }, particles, mesh);
            let (document, buffer) = parts(&glb);
            let primitive = &document["meshes"][0]["primitives"][0];
            let column = |accessor: &Value| column(&document, buffer, accessor);
            let points = self::vectors(column(&primitive["attributes"]["POSITION"]));
            let normals = self::vectors(column(&primitive["attributes"]["NORMAL"]));
            let triangles = triples(column(&primitive["indices"]));
            assert!(face_alike(&points, &triangles, &normals, &triangles), "{text}, {vertices:?}");
            if vertices == Vertices::Joined {
                check(&points, &triangles, "GLB");
            } else {
                assert!(points.len() > particles.count(), "{text}: a vertex for each side");
            }
        }
        let stl = written(MeshFormat::Stl, particles, mesh);
        let corners: Vec<Vec3> =
            stl[84..].chunks_exact(50).flat_map(|record| vectors(&record[12..48])).collect();
        let triangles: Vec<[u32; 3]> =
            (0..corners.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let volume = volume(&corners, &triangles);
        assert!((volume / expected - 1.0).abs() < 0.02, "{text}, STL: volume {volume}");
    }
}

#[test]
fn buffers_are_those_of_the_files() {
    let sample = of_formula("1 - max(abs(x), abs(y), abs(z))", 800);
    let particles = sample.particles();
    let MeshBuffers { positions, normals, triangles, rows } = sample.buffers(Vertices::Split);
    for (vertex, &row) in rows.iter().enumerate() {
        assert_eq!(positions[vertex], particles.place(row as usize));
        assert_eq!(normals[vertex], -particles.normal[row as usize], "f is larger inside");
    }
    let points: Vec<Vec3> = positions.iter().map(|p| p.as_vec3()).collect();
    assert!(face_alike(&points, &triangles, &normals, &triangles));
    assert_eq!(Topology::new(&triangles, points.len()).components.len(), 6, "six faces");
    let all = sample.buffers(Vertices::Columns);
    assert_eq!(all.rows, (0..particles.len() as u32).collect::<Vec<_>>());
    // On an edge of the cube the mean of two faces, at a corner of three.
    let joined = sample.buffers(Vertices::Joined);
    for (p, n) in joined.positions.iter().zip(&joined.normals) {
        let outward = p.as_vec3().to_array().map(|c| if c.abs() > 0.999_99 { c.signum() } else { 0.0 });
        assert!((*n - Vec3::from_array(outward).normalize_or_zero()).length() < 1e-4, "{n} at {p}");
    }
}

#[test]
fn files_face_outward_whichever_way_f_grows_and_the_report_says_so() {
    for (text, inside, volume) in [
        ("x^2 + y^2 + z^2 - 1", Some(Inside::Negative), Some(4.189)),
        ("1 - x^2 - y^2 - z^2", Some(Inside::Positive), Some(4.189)),
        ("1/sqrt(x^2 + y^2 + z^2) - 1", Some(Inside::Positive), Some(4.189)),
        ("exp(-x^2-y^2-z^2) + exp(-(x-4)^2-y^2-z^2) - 0.5", Some(Inside::Positive), Some(4.83)),
        ("max(x^2 + y^2 + z^2 - 1, 0.25 - x^2 - y^2 - z^2)", Some(Inside::Negative), Some(3.665)),
        ("min(1 - x^2 - y^2 - z^2, x^2 + y^2 + z^2 - 0.25)", Some(Inside::Positive), Some(3.665)),
        ("(x^2+y^2+z^2-1)*((x-5)^2+y^2+z^2-1)/(x-2.5)", Some(Inside::Both), Some(8.378)),
        ("z - 0.1 x y", None, None),
        ("(1 - x^2 - y^2 - z^2)*(z - 2)", Some(Inside::Negative), None),
        ("(x^2 + y^2 + z^2 - 1)*(z - 2)", Some(Inside::Positive), None),
    ] {
        let sample = of_formula(text, 1500);
        assert_eq!((sample.mesh().inside, sample.report().inside), (inside, inside), "{text}");
        let is_told = |warning: &Warning| matches!(warning, Warning::LargerInside(_));
        let expected = matches!(inside, Some(Inside::Positive | Inside::Both));
        assert_eq!(sample.report().warnings.iter().any(is_told), expected, "{text}");
        assert_eq!(sample.volume().is_some(), volume.is_some(), "{text}");
        let told = sample.volume().zip(volume);
        assert!(told.is_none_or(|(told, volume)| (told / volume - 1.0).abs() < 0.02), "{text}: {told:?}");
        // Normals of particles follow the gradient; the triangles by rows are counter-clockwise
        // round them.
        let particles = sample.particles();
        assert!(face_alike(
            &particles.local,
            sample.mesh().corners(),
            &particles.normal,
            sample.mesh().corners()
        ));
        let MeshBuffers { positions, normals, triangles, .. } = sample.buffers(Vertices::Joined);
        let points: Vec<Vec3> = positions.iter().map(|p| p.as_vec3()).collect();
        assert!(face_alike(&points, &triangles, &normals, &triangles), "{text}");
    }
}

/// A 3MF file's documents by their names: the archive is read by its central directory, as readers
/// do.
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
    let (particles, mesh) = sampled("torus", 0.01);
    let placement = Placement { scale: 25.0, unit: Some(Unit::Inch), ..Placement::default() };
    let bytes = placed(MeshFormat::ThreeMf, &particles, &mesh, &placement);
    let entries = entries(&bytes);
    assert!(["[Content_Types].xml", "_rels/.rels"].iter().all(|name| entries.contains_key(*name)));
    let model = std::str::from_utf8(entries["3D/3dmodel.model"]).expect("text");
    assert!(model.contains(r#"<model unit="inch""#));
    let (vertices, faces) = (elements(model, "vertex"), elements(model, "triangle"));
    assert_eq!((vertices.len(), faces.len()), (particles.len(), mesh.triangles.len()));
    for (face, triangle) in faces.iter().zip(&mesh.triangles) {
        for (&v, &row) in face.iter().zip(triangle) {
            let expected = particles.place(row as usize) * 25.0;
            assert!((glam::DVec3::from_slice(&vertices[v as usize]) - expected).length() < 1e-5);
        }
    }
    // A particle on an edge is one vertex.
    let cube = of_formula("max(abs(x), abs(y), abs(z)) - 1", 500);
    let bytes = written(MeshFormat::ThreeMf, cube.particles(), cube.mesh());
    let model = std::str::from_utf8(self::entries(&bytes)["3D/3dmodel.model"]).expect("text").to_owned();
    assert_eq!(elements(&model, "vertex").len(), cube.particles().count());
    let none = placed(MeshFormat::ThreeMf, &particles, &Triangulation::default(), &placement);
    assert!(
        std::str::from_utf8(self::entries(&none)["3D/3dmodel.model"]).expect("text").contains("<build/>")
    );
}

#[test]
fn meshes_are_written_in_the_size_and_orientation_asked_for() {
    let (particles, triangles) = sampled("ellipsoid", 0.015);
    let first = particles.local[triangles.triangles[0][0] as usize].to_array();
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
    for (written, p) in vectors(column(&document, buffer, position)).iter().zip(&particles.local) {
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
