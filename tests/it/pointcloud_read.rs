//! Tests of the readers of point and mesh files: every format and every kind of error.

use core::cell::Cell;
use glam::{DVec3, Vec3};
use marching_particles::export;
use marching_particles::field::model::MAX_FILE_BYTES;
use marching_particles::internal::slices::complete;
use marching_particles::particles::{Particles, Slots};
use marching_particles::pointcloud::read::{FileMesh, InputFormat, ReadError, Reader, check_size};
use marching_particles::pointcloud::{Cloud, NormalSource};
use marching_particles::quality;
use proptest::prelude::*;
use std::fmt::Write as _;

/// Reads a file to its end.
fn read_all(name: &str, bytes: &[u8]) -> Result<(InputFormat, FileMesh), ReadError> {
    let reader = Reader::new(name, bytes.to_vec())?;
    let format = reader.format();
    let before = Cell::new(0.0);
    let mesh = complete(reader.read(|fraction| {
        assert!((before.get()..=1.0).contains(&fraction), "{fraction} after {}", before.get());
        before.set(fraction);
    }))?;
    Ok((format, mesh))
}

pub(crate) fn read(name: &str, bytes: impl AsRef<[u8]>) -> (InputFormat, FileMesh) {
    let result = read_all(name, bytes.as_ref());
    result.unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Cloud of a file, with the warnings.
pub(crate) fn cloud(name: &str, bytes: impl AsRef<[u8]>) -> (Cloud, Vec<String>) {
    let (_, mesh) = read(name, bytes);
    complete(mesh.into_cloud(|_| {})).expect("memory enough")
}

/// Makes a cloud of what was read from damaged bytes.
fn made((_, mesh): (InputFormat, FileMesh)) {
    let (cloud, _) = complete(mesh.into_cloud(|_| {})).expect("memory enough");
    assert!(cloud.position.iter().all(|p| p.is_finite()));
    assert!(cloud.normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-9), "{:?}", cloud.normal);
}

#[track_caller]
pub(crate) fn refused(name: &str, bytes: impl AsRef<[u8]>) -> String {
    read_all(name, bytes.as_ref())
        .map(|(format, _)| panic!("{name} was read as {format}"))
        .unwrap_err()
        .to_string()
}

/// Corners of a tetrahedron, and its faces, oriented outward.
pub(crate) const CORNERS: [[f64; 3]; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]];
pub(crate) const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn corners() -> Vec<DVec3> {
    CORNERS.iter().map(|&p| DVec3::from_array(p)).collect()
}

/// Area-weighted normals at the corners of the tetrahedron.
fn tetrahedron_normals() -> Vec<DVec3> {
    let p = corners();
    let mut sum = [DVec3::ZERO; 4];
    for face in FACES {
        let [a, b, c] = face.map(|i| p[i as usize]);
        for i in face {
            sum[i as usize] += (b - a).cross(c - a);
        }
    }
    sum.iter().map(|n| n.normalize_or_zero()).collect()
}

#[track_caller]
pub(crate) fn assert_is_tetrahedron(cloud: &Cloud) {
    assert_eq!(cloud.source, NormalSource::FromMesh);
    assert_eq!(cloud.len(), 4);
    // An STL file has the corners in the order of the faces.
    for (p, n) in corners().iter().zip(tetrahedron_normals()) {
        let i = cloud.position.iter().position(|q| q == p).unwrap_or_else(|| panic!("{p} is missing"));
        assert!((cloud.normal[i] - n).length() < 1e-12, "{p}: {} for {n}", cloud.normal[i]);
    }
}

/// Binary PLY in either byte order: `header` follows the format line, and rows of numbers follow
/// the header.
pub(crate) fn binary_ply(big: bool, header: &str, rows: &[(&str, f64)]) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\n{header}end_header\n").into_bytes();
    for &(number, value) in rows {
        let mut number = match number {
            "char" => (value as i8).to_le_bytes().to_vec(),
            "uchar" => (value as u8).to_le_bytes().to_vec(),
            "short" => (value as i16).to_le_bytes().to_vec(),
            "ushort" => (value as u16).to_le_bytes().to_vec(),
            "int" => (value as i32).to_le_bytes().to_vec(),
            "uint" => (value as u32).to_le_bytes().to_vec(),
            "float" => (value as f32).to_le_bytes().to_vec(),
            "double" => value.to_le_bytes().to_vec(),
            other => panic!("{other}"),
        };
        if big {
            number.reverse();
        }
        bytes.extend(number);
    }
    bytes
}

/// PLY of the tetrahedron, with scalars of the given types.
fn tetrahedron_ply(big: bool, coordinate: &str, index: &str, length: &str) -> Vec<u8> {
    let header = format!(
        "comment a tetrahedron\nelement face 4\nproperty uchar red\nproperty list {length} {index} vertex_indices\n\
         element vertex 4\nproperty {coordinate} z\nproperty uchar quality\nproperty {coordinate} x\nproperty {coordinate} y\n"
    );
    let mut rows = Vec::new();
    for face in FACES {
        rows.extend([("uchar", 9.0), (length, 3.0)]);
        rows.extend(face.map(|i| (index, f64::from(i))));
    }
    for [x, y, z] in CORNERS {
        rows.extend([(coordinate, z), ("uchar", 200.0), (coordinate, x), (coordinate, y)]);
    }
    binary_ply(big, &header, &rows)
}

fn stl_binary(name: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..name.len()].copy_from_slice(name);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_triangles() -> Vec<[[f32; 3]; 3]> {
    FACES.iter().map(|face| face.map(|i| CORNERS[i as usize].map(|x| x as f32))).collect()
}

#[test]
fn ply_is_read_in_any_order_type_and_byte_order() {
    for big in [false, true] {
        for coordinate in ["float", "double", "char", "short", "int", "uchar", "ushort", "uint"] {
            for (index, length) in [("int", "uchar"), ("uchar", "int"), ("ushort", "uint"), ("short", "char")]
            {
                let bytes = tetrahedron_ply(big, coordinate, index, length);
                let (cloud, warnings) = cloud("a.ply", &bytes);
                assert_is_tetrahedron(&cloud);
                assert_eq!(warnings, Vec::<String>::new());
            }
        }
    }
}

#[test]
fn ply_as_text_has_any_line_ends_and_faces_of_any_size() {
    // The square base of the pyramid is one face.
    let text = "ply\nformat ascii 1.0\nobj_info x\nelement vertex 5\nproperty float32 x\nproperty float32 y\nproperty float32 z\n\
                element face 5\nproperty list uint8 int32 vertex_index\nelement edge 1\nproperty int a\nend_header\n\
                -1 -1 0\n1 -1 0\n1 1 0\n\n-1 1 0\n0 0 1\n4 0 3 2 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";
    for end in ["\n", "\r\n", "\r"] {
        let (cloud, _) = cloud("a.ply", text.replace('\n', end));
        assert_eq!(cloud.len(), 5);
        assert_eq!(cloud.normal[4], DVec3::Z);
        // A corner of the base gets the area vector of the base, 4 downwards, and those of two
        // sides of area √2, each with 1 upwards.
        for (n, p) in cloud.normal.iter().zip(&cloud.position).take(4) {
            assert!(
                (*n - DVec3::new(p.x, p.y, -2.0).normalize_or_zero()).length() < 1e-12,
                "{:?}",
                cloud.normal
            );
        }
        assert_eq!(cloud.source, NormalSource::FromMesh);
    }
}

#[test]
fn given_normals_win_over_faces_and_are_made_unit() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float nx\nproperty float ny\nproperty float nz\n\
                property float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n\
                0 0 -2 0 0 0\n0 0 0 1 0 0\n3 4 0 0 1 0\n3 0 1 2\n";
    let (cloud, _) = cloud("a.ply", text);
    assert_eq!(cloud.source, NormalSource::Given);
    // The second normal is zero in the file, so that of its face takes its place.
    let expected = [DVec3::NEG_Z, DVec3::Z, DVec3::new(0.6, 0.8, 0.0)];
    assert!(
        cloud.normal.iter().zip(&expected).all(|(n, e)| (*n - *e).length() < 1e-15),
        "{:?}",
        cloud.normal
    );
}

#[test]
fn obj_is_read_with_every_form_of_index() {
    let vertices: String = CORNERS.iter().fold(String::new(), |mut text, [x, y, z]| {
        let _ = writeln!(text, "v {x} {y}\t{z} 1.0 # a corner");
        text
    });
    for face in [
        |i: u32| format!("{}", i + 1),
        |i: u32| format!("{}/1", i + 1),
        |i: u32| format!("{}/{}", i as i32 - 4, 1),
        |i: u32| format!("{}//", i as i32 - 4),
    ] {
        let mut text =
            format!("# by hand, C:\\models\\\nmtllib a.mtl\no tetrahedron\n{vertices}vt 0 0\ns off\n");
        for corners in FACES {
            let [a, b, c] = corners.map(face);
            let _ = writeln!(text, "f {a} {b} \\\n {c}");
        }
        assert_is_tetrahedron(&cloud("a.obj", &text).0);
    }
    // The normal of a point is the mean of those at its corners.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//-2 3//-2\nf 1//2 2//1 3/7/1\n";
    let (with_normals, _) = cloud("a.obj", text);
    assert_eq!(with_normals.source, NormalSource::Given);
    assert!((with_normals.normal[0] - DVec3::new(0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt())).length() < 1e-15);
    assert_eq!(with_normals.normal[1], DVec3::Z);
    // The file has points with a normal each and no faces.
    let (points, _) = cloud("a.obj", "v 0 0 0\nvn 0 0 1\nv 1 0 0\nvn 0 1 0\n");
    assert_eq!((points.source, points.normal), (NormalSource::Given, vec![DVec3::Z, DVec3::Y]));
}

#[test]
fn stl_is_read_as_text_and_binary_and_its_corners_are_merged() {
    // Many programs begin a binary file with `solid`, like a text file.
    for name in [&b""[..], b"solid tetrahedron"] {
        let (format, _) = read("a.stl", stl_binary(name, &stl_triangles()));
        assert_eq!(format, InputFormat::StlBinary);
        assert_is_tetrahedron(&cloud("a.stl", stl_binary(name, &stl_triangles())).0);
    }
    let mut text = "solid a tetrahedron\n".to_owned();
    for triangle in stl_triangles() {
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in triangle {
            let _ = writeln!(text, "   VERTEX {x:e} {y:+e} {z}");
        }
        text += "  endloop\n endfacet\n";
    }
    for end in ["endsolid a tetrahedron\n", ""] {
        let (format, _) = read("a.stl", format!("{text}{end}"));
        assert_eq!(format, InputFormat::StlText);
        assert_is_tetrahedron(&cloud("a.stl", format!("{text}{end}")).0);
    }
}

#[test]
fn xyz_is_read_with_any_separator_comments_and_names() {
    for text in [
        "1 2 3 0 0 1\n4 5 6 0 1 0\n",
        "# points\n\n1,2,3,0,0,1\r\n4,5,6,0,1,0",
        "1\t2\t3\t0\t0\t1 # one\n// two\n4  5 6  0 1 0\n",
        "1, 2, 3, 0, 0, 1\n4, 5, 6, 0, 1, 0\n",
        "1;2;3;0;0;1\n4;5;6;0;1;0\n",
        "\u{feff}x,y,z,nx,ny,nz\n1,2,3,0,0,1\n4,5,6,0,1,0\n",
        "nz NX ny label z x y\n1 0 0 7 3 1 2\n0 0 1 8 6 4 5\n",
        "X [m],Y [m],Z (m),nx,ny,nz\n1,2,3,0,0,1\n4,5,6,0,1,0\n",
    ] {
        let (cloud, warnings) = cloud("a.xyz", text);
        assert_eq!(cloud.position, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)], "{text}");
        assert_eq!(cloud.normal, [DVec3::Z, DVec3::Y], "{text}");
        assert_eq!(warnings, Vec::<String>::new(), "{text}");
    }
    for text in ["1 2 3\n4 5 6\n", "1 2 3 0.5\n4 5 6 0.25\n"] {
        let (cloud, warnings) = cloud("a.xyz", text);
        assert_eq!(
            (cloud.len(), cloud.normal.len(), cloud.source),
            (2, 0, NormalSource::Estimated),
            "{text}"
        );
        assert_eq!(warnings, Vec::<String>::new());
    }
    // Colours are not taken for normals.
    let (cloud, warnings) = cloud("a.xyz", "1 2 3 255 0 10\n4 5 6 7 8 9\n");
    assert_eq!((cloud.len(), cloud.normal.len()), (2, 0));
    assert!(warnings[0].contains("colours"), "{warnings:?}");
}

#[test]
fn files_of_our_own_are_read_back_to_the_same_bits() {
    let count = 100;
    let point = |i: usize| Vec3::new((i as f32).sqrt(), 1.0 / (i + 1) as f32, i as f32 * 1e-9);
    let particles = Particles {
        origin: glam::DVec3::ZERO,
        local: (0..count).map(point).collect(),
        normal: (0..count).map(|i| Vec3::new(1.0, i as f32, -0.3).normalize_or(Vec3::Z)).collect(),
        radius: vec![0.25; count],
        parent: vec![Particles::NO_PARENT; count],
        level: vec![0; count],
        slots: vec![Slots::default(); count],
        ..Particles::default()
    };
    for (ending, format) in export::Format::ALL {
        if format == export::Format::Npy {
            continue;
        }
        let mut bytes = Vec::new();
        let record = export::RecordText::new(r#"{"formula":"x"}"#);
        let file = export::ParticleFile { format, record };
        export::write(&file, &particles, &quality::Measurements::default(), &mut bytes)
            .expect("writing to memory does not fail");
        let (_, mesh) = read(&format!("a.{ending}"), bytes);
        assert!(mesh.position.iter().zip(&particles.local).all(|(read, p)| read.as_vec3() == *p), "{ending}");
        assert!(mesh.normal.iter().zip(&particles.normal).all(|(read, n)| read.as_vec3() == *n), "{ending}");
        assert_eq!((mesh.position.len(), mesh.normal.len()), (count, count), "{ending}");
    }
}

#[test]
fn content_decides_and_a_wrong_extension_gives_a_warning() {
    let (cloud, warnings) = cloud("scan.stl", tetrahedron_ply(true, "float", "int", "uchar"));
    assert_is_tetrahedron(&cloud);
    assert_eq!(warnings, ["The name ends in .stl, the content is PLY; it was read as PLY."]);
    assert_eq!(read("points", "1 2 3\n").0, InputFormat::Xyz);
    assert_eq!(read("points.ply", "v 1 2 3\n").0, InputFormat::Obj);
}

#[test]
fn errors_name_their_place_and_give_advice() {
    let ply = |header: &str, rows: &str| format!("ply\nformat ascii 1.0\n{header}end_header\n{rows}");
    let xyz = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
    let face = format!("{xyz}element face 1\nproperty list uchar int vertex_indices\n");
    let table: Vec<(&str, String, &str)> = vec![
        // File name, content, part of the message.
        ("a.xyz", String::new(), "the file is empty; choose one that holds points"),
        ("a.xyz", " \n\n".into(), "there are no points in this XYZ file"),
        ("a", "\n# nothing\n".into(), "a text file without content"),
        ("a.xyz", "1 2 3\n\n4 5 1e31\n".into(), "line 3: z is 1e31; up to 1e30 can be used"),
        (
            "a.xyz",
            "1 2 3\n4 5\n".into(),
            "line 2: a point takes three numbers, x y z, or six with a normal; here is 2",
        ),
        ("a.xyz", "1 2 3 4 5 6\n4 5 6\n".into(), "line 2: 3 columns, where the lines before have 6"),
        ("a.xyz", "1 2 three\n".into(), "line 1: z is `three`, which is not a number"),
        ("a.xyz", "0,5 1,5 2,5\n".into(), "line 1: the numbers have decimal commas; write decimal points"),
        ("a.csv", "0,5;1;2\n0.5;1;2\n".into(), "line 2: some numbers have a decimal comma, others a point"),
        ("a.csv", "1.234,5;1;2\n".into(), "line 1: x is `1.234,5`, which is not a number"),
        ("a.xyz", "hello\n".into(), "line 1: `hello` is no number; a point is x y z"),
        ("a", "hello world\n".into(), "a text file of no known kind"),
        ("a.obj", "v 1 2\n".into(), "line 1: three numbers are needed, z is missing"),
        ("a.obj", "v 1 2 x\n".into(), "line 1: z is `x`, which is not a number"),
        ("a.obj", "v 0 0 0\nf 1 2 3\n".into(), "line 2: the face has vertex 2, and 1 stand before this line"),
        ("a.obj", "v 0 0 0\nf 0 1 1\n".into(), "line 2: the face has vertex 0"),
        ("a.obj", "v 0 0 0\nf -2 1 1\n".into(), "line 2: the face has vertex -2"),
        ("a.obj", "v 0 0 0\nf 1//1 1//1 1//1\n".into(), "line 2: the face has normal 1, and 0 stand before"),
        (
            "a.obj",
            "v 0 0 0\nf a b c\n".into(),
            "line 2: `a` is no number of a vertex; a face is like `f 1 2 3`",
        ),
        ("a.obj", "v 0 0 0\nf 99999999999999999999 1 1\n".into(), "is no number of a vertex"),
        ("a.obj", "vt 0 0\n".into(), "there are no points in this OBJ file"),
        ("a.stl", "solid a\nendsolid a\n".into(), "there are no points in this STL file"),
        (
            "a.stl",
            "solid a\nfacet\nvertex 1 2 3\n".into(),
            "line 3: the file ends within a facet; it is cut off",
        ),
        (
            "a.stl",
            "solid a\nfacet\nvertex 1 2 3\nfacet\n".into(),
            "line 4: a facet begins within another one",
        ),
        ("a.stl", "solid a\ntriangle\n".into(), "line 2: `triangle` is no statement of an STL file"),
        ("a.ply", "ply\n".into(), "line 1: the header has no `end_header`"),
        ("a.ply", "ply\nend_header\n".into(), "line 2: the header does not say in which format the rows are"),
        ("a.ply", "ply\nformat ascii 2.0\n".into(), "line 2: version 2.0 of the format; 1.0 is read"),
        ("a.ply", "ply\nformat utf8 1.0\n".into(), "line 2: `utf8` is no format of a PLY file"),
        ("a.ply", ply("", ""), "the header declares no vertices"),
        ("a.ply", ply("element vertex 1\nproperty float x\n", "1\n"), "the vertices have no x, y and z"),
        ("a.ply", ply("property float x\n", ""), "line 3: a property stands before the first element"),
        ("a.ply", ply("element vertex many\n", ""), "line 3: `many` is no number of rows"),
        ("a.ply", ply("element vertex -1\n", ""), "line 3: `-1` is no number of rows"),
        ("a.ply", ply("element vertex 1\nproperty half x\n", ""), "line 4: `half` is no type of a number"),
        (
            "a.ply",
            ply("element vertex 1\nproperty float x\nproperty int x\n", ""),
            "line 5: the property `x` is declared twice",
        ),
        (
            "a.ply",
            ply("element vertex 1\nelement vertex 1\n", ""),
            "line 4: the element `vertex` is declared twice",
        ),
        (
            "a.ply",
            ply("element face 1\nproperty list float int vertex_indices\n", ""),
            "the length of a list must be a whole",
        ),
        ("a.ply", ply("elements 3\n", ""), "line 3: `elements` begins no line of a PLY header"),
        ("a.ply", ply(xyz, "1 2 3000\n4 5\n"), "line 9: this vertex has fewer numbers than the header says"),
        ("a.ply", ply(xyz, "1 2 3000000\n"), "line 8: the file ends before all 2 vertex rows; it is cut off"),
        (
            "a.ply",
            ply(xyz, "1 2 3\n"),
            "the header promises 2 vertex rows, which take at least 12 bytes, and 6 bytes follow",
        ),
        (
            "a.ply",
            ply(&face, "1 2 3\n4 5 6\n3 0 1 2\n"),
            "line 12: the face has vertex 2, and the 2 vertices are counted from 0",
        ),
        ("a.ply", ply(&face, "1 2 3\n4 5 6\n3 0 1 x\n"), "line 12: `x` is no number of a vertex"),
        ("a.ply", ply(&face, "1 2 3\n4 5 6\n-3 0 1 1\n"), "line 12: `-3` is no length of a list"),
        ("a.ply", ply(&face, "1 2 3\n4 5 6\n4 0 1 1\n"), "line 12: this face has fewer numbers"),
        ("a.html", "<!doctype html>".into(), "this is an XML or HTML document"),
        ("a.gltf", "{\"asset\":{}}".into(), "this is JSON"),
    ];
    for (name, content, part) in table {
        let message = refused(name, &content);
        assert!(message.contains(part), "{content:?}\n  gives  {message}\n  not    {part}");
    }
}

#[test]
fn binary_files_that_are_damaged_are_refused_by_row() {
    let mut huge = tetrahedron_ply(true, "float", "int", "uchar");
    let end = huge.len();
    huge[end - 4..].copy_from_slice(&1e32_f32.to_be_bytes());
    let message = refused("a.ply", &huge);
    assert!(message.starts_with("vertex 4, "), "{message}");
    assert!(message.contains(&format!("{} bytes into the file: y is 1", end - 13)), "{message}");

    let header = "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 2\nproperty list int uint vertex_indices\n";
    let vertex = [("double", 1.0), ("double", 2.0), ("double", 3.0)];
    for (length, part) in [
        (
            -1.0,
            "face 1, 195 bytes into the file: a list of -1 numbers, and 4 bytes are left; the file is damaged",
        ),
        (2e9, "a list of 2000000000 numbers"),
        (
            1.0,
            "face 1, 195 bytes into the file: the face has vertex 7, and the 1 vertices are counted from 0",
        ),
    ] {
        let rows = [&vertex[..], &[("int", length), ("uint", 7.0)]].concat();
        let message = refused("a.ply", binary_ply(false, header, &rows));
        assert!(message.contains(part), "{message}");
    }
    let rows = [&vertex[..], &[("int", 0.0), ("short", 7.0), ("short", 7.0)]].concat();
    let message = refused("a.ply", binary_ply(true, header, &rows));
    assert!(message.contains("face 2, 196 bytes into the file: a list of 458759 numbers"), "{message}");

    let mut triangles = stl_triangles();
    triangles[2][1][0] = 1e32;
    let message = refused("a.stl", stl_binary(b"", &triangles));
    assert!(message.starts_with("triangle 3, 184 bytes into the file: x is 1"), "{message}");
}

#[test]
fn headers_with_false_counts_are_refused_before_memory_is_allocated() {
    let xyz = "property double x\nproperty double y\nproperty double z\n";
    for count in ["4000000000", "18446744073709551615"] {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let text = format!("ply\nformat {format} 1.0\nelement vertex {count}\n{xyz}end_header\n1 2 3\n");
            let message = refused("a.ply", text);
            assert!(message.starts_with(&format!("the header promises {count} vertex rows")), "{message}");
            assert!(
                message.contains("and 6 bytes follow; the file is cut off or its header is wrong"),
                "{message}"
            );
            // Each element alone would fit.
            let text = format!(
                "ply\nformat {format} 1.0\nelement a 3\nproperty char a\nelement vertex 1\n{xyz}end_header\n1 2 3\n"
            );
            assert!(refused("a.ply", text).starts_with("the header promises 1 vertex rows"));
        }
        // Rows without properties take no time.
        let text =
            format!("ply\nformat ascii 1.0\nelement a {count}\nelement vertex 1\n{xyz}end_header\n1 2 3\n");
        assert_eq!(read("a.ply", text).1.position, [DVec3::new(1.0, 2.0, 3.0)]);
    }
    let mut stl = stl_binary(b"", &stl_triangles());
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let message = refused("a.stl", stl);
    assert!(
        message.starts_with(
            "the header promises 4294967295 triangle rows, which take at least 214748364750 bytes"
        )
    );
    assert!(refused("a.stl", b"solid\0").contains("the header promises 1 header rows"));
}

#[test]
fn files_of_other_formats_and_sizes_are_refused_with_advice() {
    for (bytes, part) in [
        (&b"\x89PNG\r\n\x1a\n"[..], "this is a PNG picture"),
        (b"PK\x03\x04rest", "archive: the file is cut off or damaged"),
        (
            b"\x1f\x8b\x08",
            "this is a gzip archive, and what is read is PLY, OBJ, STL, OFF, GLB, 3MF, PCD and text with one point on a line (XYZ, PTS, CSV); unpack it",
        ),
        (
            b"\x93NUMPY\x01\x00",
            "save points as text, one on a line (XYZ); the command line reads an array of voxels (--image)",
        ),
        (b"{\"asset\":{\"version\":\"2.0\"}}", "this is JSON (glTF is such)"),
        (b"\xff\xfe1\x00 \x00", "this is text in UTF-16"),
        (b"\x00\x01\x02\x03", "this is a binary file of no known kind"),
    ] {
        let message = refused("a.ply", bytes);
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(check_size(0), Err(ReadError::Empty));
    assert_eq!(check_size(MAX_FILE_BYTES.into()), Ok(()));
    let error = check_size(2_000_000_001).expect_err("two gigabytes");
    assert_eq!(
        error.to_string(),
        "the file has 2001 MB, and up to 50 MB are read; keep fewer points, for example every tenth"
    );
    assert!(matches!(
        Reader::new("a.xyz", vec![b'1'; 50_000_001]),
        Err(ReadError::TooLarge { bytes: 50_000_001 })
    ));
}

/// First bytes that select each of the readers.
const BEGINNINGS: [&str; 14] = [
    "glTF\x02\0\0\0\0\0\0\0",
    "OFF\n2 1 0\n0 0 0\n1 0 0\n",
    "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n",
    "VERSION 0.7\nFIELDS _ x y z normal_x\nSIZE 1 4 4 8 4\nTYPE U F F F F\nCOUNT 3 1 1 1 2\nWIDTH 2\nHEIGHT 1\nDATA binary\n",
    "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA binary_compressed\n",
    "2\n1 2 3 4 5 6\n",
    "",
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list char int vertex_index\nend_header\n",
    "ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list int uchar vertex_index\nelement vertex 2\nproperty char x\nproperty char y\nproperty char z\nend_header\n",
    "ply\nformat binary_little_endian 1.0\n",
    "v 0 0 0\nv 1 0 0\nf ",
    "solid a\nfacet\n",
    "1 2 3\n",
    "x,y,z,nx,ny,nz\n",
];

proptest! {
    #![proptest_config(crate::cases::proptest(4000))]

    #[test]
    fn no_bytes_make_a_reader_panic(
        beginning in 0..BEGINNINGS.len(),
        rest in proptest::collection::vec(any::<u8>(), 0..200),
        name in prop_oneof!["a.stl", "a.obj", "a.xyz", "a.off", "a.pcd", "a"],
    ) {
        let bytes = [BEGINNINGS[beginning].as_bytes(), &rest].concat();
        let _ = read_all(&name, &bytes).map(made);
    }

    #[test]
    fn no_text_makes_a_reader_panic(
        beginning in 0..BEGINNINGS.len(),
        words in proptest::collection::vec(
            prop_oneof!["-?[0-9]{1,3}", "[-+.,;/#eE0-9]{1,6}", "[a-z]{1,4}", "\n", "vertex|endloop|element|property|list|float|int",
                "end_header\n", "f|v|vn", "nan|inf|1e400", "OFF|COFF|NOFF", "FIELDS|DATA|SIZE|binary"],
            0..40,
        ),
    ) {
        let bytes = [BEGINNINGS[beginning], &words.join(" ")].concat().into_bytes();
        let _ = read_all("a", &bytes).map(made);
    }

    #[test]
    fn a_damaged_byte_makes_no_reader_panic_and_a_file_that_is_cut_off_is_refused(
        big in any::<bool>(), at in any::<prop::sample::Index>(), value in any::<u8>(),
    ) {
        let mut bytes = tetrahedron_ply(big, "float", "int", "uchar");
        let at = at.index(bytes.len());
        bytes[at] = value;
        let _ = read_all("a", &bytes).map(made);
        let cut = tetrahedron_ply(big, "float", "int", "uchar");
        prop_assert!(read_all("a", &cut[..at]).is_err());
    }
}

/// Some numbers with up to three decimals, as they are drawn from a seed.
fn decimals(seed: u64, count: usize) -> Vec<f64> {
    use rand_core::Rng;
    let mut random = rand_pcg::Pcg64Mcg::new(seed.into());
    (0..count).map(|_| f64::from(random.next_u32() % 20_001) / 1000.0 - 10.0).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Where the lines of a PLY file end says nothing, unless each holds a row.
    #[test]
    fn the_numbers_of_a_ply_text_may_stand_on_any_lines(
        seed in 0_u64..1000,
        ends in proptest::collection::vec(1_usize..9, 40),
        has_tags in any::<bool>(),
        end in prop_oneof![Just("\n"), Just("\r\n")],
    ) {
        let numbers = decimals(seed, 15);
        let mut words: Vec<String> = Vec::new();
        for (k, p) in numbers.chunks(3).enumerate() {
            if has_tags {
                // A list in front of the position.
                words.extend([vec!["0"], vec!["2", "7", "8"]][k % 2].iter().map(|word| (*word).to_owned()));
            }
            words.extend(p.iter().map(f64::to_string));
        }
        words.extend(["3", "0", "1", "2", "4", "0", "2", "3", "4"].map(str::to_owned));
        let tags = if has_tags { "property list uchar int tags\n" } else { "" };
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex 5\n{tags}property float x\nproperty float y\n\
             property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        );
        let (mut left, mut lines) = (words.as_slice(), 0);
        for count in ends.into_iter().cycle() {
            let (line, rest) = left.split_at(count.min(left.len()));
            text.push_str(&line.join(" "));
            text.push_str(end);
            (left, lines) = (rest, lines + 1);
            if left.is_empty() {
                break;
            }
        }
        // As many lines as rows would be rows.
        prop_assume!(lines != 7);
        let (_, mesh) = read("a.ply", &text);
        let read: Vec<f64> = mesh.position.iter().flat_map(|p| p.to_array()).collect();
        prop_assert_eq!(read, numbers, "{}", text);
        prop_assert_eq!(mesh.faces.len(), 2, "{}", text);
    }

    /// A table has one reading, whatever separates its columns and decimals.
    #[test]
    fn tables_are_read_with_decimal_commas_where_something_else_separates(
        seed in 0_u64..1000,
        (separator, comma) in prop_oneof![
            Just((";", true)), Just(("; ", true)), Just(("\t", true)), Just((";", false)),
            Just(("\t", false)), Just((",", false)), Just((" ", false)),
        ],
        order in prop_oneof![Just([0, 1, 2]), Just([2, 0, 1]), Just([1, 2, 0])],
        has_name in any::<bool>(),
        is_quoted in any::<bool>(),
        end in prop_oneof![Just("\n"), Just("\r\n")],
    ) {
        let numbers = decimals(seed, 30);
        let is_named = has_name || order != [0, 1, 2];
        let mut text = String::new();
        if is_named {
            let names = order.map(|k| ["x", "y", "z"][k]);
            let first = if has_name { format!("id{separator}") } else { String::new() };
            let _ = write!(text, "{first}{}{end}", names.join(separator));
        }
        for (row, p) in numbers.chunks(3).enumerate() {
            if has_name {
                let _ = write!(text, "{row}{separator}");
            }
            let words = order.map(|k| {
                let word = p[k].to_string();
                let word = if comma { word.replace('.', ",") } else { word };
                if is_quoted && separator != " " { format!("\"{word}\"") } else { word }
            });
            let _ = write!(text, "{}{end}", words.join(separator));
        }
        let (_, mesh) = read("a.csv", &text);
        let read: Vec<f64> = mesh.position.iter().flat_map(|p| p.to_array()).collect();
        prop_assert_eq!(read, numbers, "{}", text);
    }
}
