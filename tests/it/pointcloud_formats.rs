//! Tests of the readers of files as scanners and other programs write them: OFF, PCD, PTS, colours,
//! headers, and rows without coordinates.

use crate::pointcloud_read::{CORNERS, FACES, assert_is_tetrahedron, binary_ply, cloud, read, refused};
use glam::DVec3;
use marching_particles::pointcloud::NormalSource;
use marching_particles::pointcloud::read::InputFormat;
use std::fmt::Write as _;

/// The tetrahedron as OFF: a header, `more` after the coordinates of each point and after each
/// face.
fn off(header: &str, more: &str) -> String {
    let mut text = format!("{header}\n");
    for [x, y, z] in CORNERS {
        let _ = writeln!(text, "{x} {y}\t{z}{more}");
    }
    for [a, b, c] in FACES {
        let _ = writeln!(text, "3 {a} {b} {c}{more}");
    }
    text
}

#[test]
fn off_is_read_with_its_prefixes_colours_and_comments() {
    for (header, more) in [
        ("OFF\n4 4 6", ""),
        ("OFF 4 4 6", ""),
        ("OFF\n4 4", ""),
        // As a collection of models has it.
        ("OFF4 4 0", ""),
        ("# a tetrahedron\n\nOFF # of four\n# points\n4 4 0 # and faces\n", " # one"),
        ("OFF\n4 4 6", " 255 128 0"),
        ("COFF\n4 4 6", " 255 128 0 255"),
        ("COFF\n4 4 6", " 0.5 0.25 0.125 1.0"),
        ("STOFF\n4 4 6", " 0.5 0.5"),
    ] {
        for end in ["\n", "\r\n"] {
            let text = off(header, more).replace('\n', end);
            assert_eq!(read("a.off", &text).0, InputFormat::Off);
            let (cloud, warnings) = cloud("a.off", &text);
            assert_is_tetrahedron(&cloud);
            assert_eq!(warnings, Vec::<String>::new(), "{header}");
        }
    }
    // Normals come before colours or after them: as Geomview and Open3D write them, and as MeshLab
    // does.
    for (header, before, after) in [
        ("NOFF", "", ""),
        ("CNOFF", "", " 9 9 9"),
        ("CNOFF", "", " 0.5 0.5 0.5 1"),
        ("NCOFF", "9 9 9 255 ", " "),
        ("NCOFF", "9 9 9 ", ""),
        ("STNCOFF", "9 9 9 255 ", " 0.5 0.5"),
        ("STCNOFF", "", " 9 9 9 255 0.5 0.5"),
    ] {
        let row = |p: &str, n: &str| format!("{p} {before}{n}{after}\n");
        let text = format!("{header}\n2 0 0\n{}{}", row("1 2 3", "0 0 -2"), row("4 5 6", "0 1 0"));
        let (cloud, _) = cloud("a", text);
        assert_eq!(
            (cloud.source, cloud.normal),
            (NormalSource::Given, vec![DVec3::NEG_Z, DVec3::Y]),
            "{header}"
        );
    }
    // A square and a face of two corners, which has no area.
    let (square, _) = cloud("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n2 0 1\n");
    assert_eq!(square.normal, vec![DVec3::Z; 4]);
    for (text, part) in [
        ("OFF\n", "the numbers of points and faces are needed, that of points is missing"),
        ("OFF\n4\n", "line 2: the numbers of points and faces are needed, that of faces is missing"),
        ("OFF\nfour 4 0\n", "line 2: `four` is no number of points"),
        ("OFF\n2 0 0\n1 2 3\n 4 5       \n", "line 4: three numbers are needed, z is missing"),
        ("OFF\n2 0 0\n1 2 3         \n", "line 3: the file ends before all 2 points; it is cut off"),
        ("OFF\n4000000000 0 0\n1 2 3\n", "the header promises 4000000000 point rows"),
        ("OFF\n1 4000000000 0\n1 2 3\n", "the header promises 4000000000 face rows"),
        (
            "OFF\n1 1 0\n1 2 3\n3 0 0 1\n",
            "line 4: the face has vertex 1, and the 1 vertices are counted from 0",
        ),
        ("OFF\n1 1 0\n1 2 3\n3 0 0\n", "line 4: this face has fewer corners than the 3 that it says"),
        ("OFF\n1 1 0\n1 2 3\n3 0 0 -1\n", "line 4: the face has vertex -1"),
        ("OFF\n0 0 0\n", "there are no points in this OFF file"),
        ("4OFF\n1 0 0\n1 2 3 1\n", "line 1: the points of this OFF file are not points in space"),
        ("OFF BINARY\n\0\0\0", "this is a binary OFF file"),
    ] {
        let message = refused("a.off", text);
        assert!(message.contains(part), "{text:?}\n  gives  {message}\n  not    {part}");
    }
}

/// A field of a PCD file: its name, size, type, count, and the component of the points that it
/// holds, if it holds one.
type PcdField = (&'static str, usize, char, usize, Option<usize>);

const XYZ: [PcdField; 3] = [("x", 4, 'F', 1, Some(0)), ("y", 4, 'F', 1, Some(1)), ("z", 4, 'F', 1, Some(2))];

/// The header of a PCD file of so many points.
fn pcd_header(fields: &[PcdField], points: usize, data: &str) -> String {
    let list = |of: &dyn Fn(&PcdField) -> String| fields.iter().map(of).collect::<Vec<_>>().join(" ");
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n",
        list(&|field| field.0.to_owned()),
        list(&|field| field.1.to_string()),
        list(&|field| field.2.to_string()),
        list(&|field| field.3.to_string()),
    )
}

fn number(value: f64, size: usize, kind: char) -> Vec<u8> {
    match (kind, size) {
        ('F', 4) => (value as f32).to_le_bytes().to_vec(),
        ('F', _) => value.to_le_bytes().to_vec(),
        (_, size) => (value as i64).to_le_bytes()[..size].to_vec(),
    }
}

/// The bytes of one field of a point.
fn field_bytes(&(_, size, kind, count, component): &PcdField, point: &[f64]) -> Vec<u8> {
    (0..count).flat_map(|k| number(component.map_or(k as f64 + 7.0, |c| point[c]), size, kind)).collect()
}

fn pcd_binary(fields: &[PcdField], points: &[Vec<f64>]) -> Vec<u8> {
    let mut bytes = pcd_header(fields, points.len(), "binary").into_bytes();
    points.iter().for_each(|p| fields.iter().for_each(|field| bytes.extend(field_bytes(field, p))));
    bytes
}

/// LZF of bytes: runs as they are, and equal bytes by a reference to the one before.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let (mut out, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let same = (at..bytes.len()).take(260).take_while(|&k| at > 0 && bytes[k] == bytes[at - 1]).count();
        match same {
            0..3 => {
                let run = (bytes.len() - at).min(32).min(same.max(1));
                out.push(run as u8 - 1);
                out.extend(&bytes[at..at + run]);
                at += run;
            }
            3..9 => {
                out.extend([(same as u8 - 2) << 5, 0]);
                at += same;
            }
            _ => {
                out.extend([7 << 5, (same - 9) as u8, 0]);
                at += same;
            }
        }
    }
    out
}

fn pcd_compressed(fields: &[PcdField], points: &[Vec<f64>]) -> Vec<u8> {
    let columns: Vec<u8> =
        fields.iter().flat_map(|field| points.iter().flat_map(move |p| field_bytes(field, p))).collect();
    let packed = packed(&columns);
    let mut bytes = pcd_header(fields, points.len(), "binary_compressed").into_bytes();
    for size in [packed.len(), columns.len()] {
        bytes.extend((size as u32).to_le_bytes());
    }
    bytes.extend(packed);
    bytes
}

fn pcd_text(fields: &[PcdField], points: &[Vec<f64>]) -> Vec<u8> {
    let mut text = pcd_header(fields, points.len(), "ascii");
    for p in points {
        let words = fields.iter().flat_map(|field| (0..field.3).map(move |_| field.4.map_or(7.0, |c| p[c])));
        text += &words.map(|word| word.to_string()).collect::<Vec<_>>().join(" ");
        text += "\n";
    }
    text.into_bytes()
}

#[test]
fn pcd_is_read_as_text_binary_and_compressed_with_any_fields() {
    let points: Vec<Vec<f64>> = (0..100)
        .map(|k| {
            vec![f64::from(k), f64::from(k % 7) - 3.0, 2.0, 0.0, if k % 2 == 0 { 1.0 } else { -1.0 }, 0.0]
        })
        .collect();
    let normals: [PcdField; 3] = [
        ("normal_x", 4, 'F', 1, Some(3)),
        ("normal_y", 4, 'F', 1, Some(4)),
        ("normal_z", 4, 'F', 1, Some(5)),
    ];
    let odd: [PcdField; 6] = [
        ("_", 1, 'U', 5, None),
        ("z", 8, 'F', 1, Some(2)),
        ("x", 2, 'I', 1, Some(0)),
        ("histogram", 4, 'F', 3, None),
        ("y", 4, 'I', 1, Some(1)),
        ("rgba", 4, 'U', 1, None),
    ];
    let rgb: [PcdField; 4] = [XYZ[0], XYZ[1], XYZ[2], ("rgb", 4, 'F', 1, None)];
    let with_normals = [&rgb[..], &normals].concat();
    for fields in [&XYZ[..], &rgb, &odd, &with_normals] {
        for write in [pcd_text, pcd_binary, pcd_compressed] {
            let bytes = write(fields, &points);
            assert_eq!(read("a.pcd", &bytes).0, InputFormat::Pcd);
            let (cloud, warnings) = cloud("a.pcd", &bytes);
            assert_eq!(cloud.len(), 100);
            for (p, q) in cloud.position.iter().zip(&points) {
                assert_eq!(p.to_array(), q[..3], "{fields:?}");
            }
            assert_eq!(warnings, Vec::<String>::new());
            let given: &[f64] = if cloud.normal.is_empty() { &[] } else { &points[1][3..] };
            assert_eq!(cloud.normal.get(1).map_or(vec![], |n| n.to_array().to_vec()), given, "{fields:?}");
            assert_eq!(cloud.normal.is_empty(), fields.len() != 7);
        }
    }
    // Headers of older versions, without counts and with the size alone.
    let old = "VERSION .5\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH 2\r\nHEIGHT 1\r\nDATA ascii\r\n1 2 3\r\n4 5 6\r\n";
    assert_eq!(read("scan.txt", old).1.position, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
}

#[test]
fn pcd_files_that_are_damaged_are_refused_with_what_is_wrong() {
    let header = |fields: &str, rest: &str| format!("VERSION 0.7\nFIELDS {fields}\n{rest}");
    for (text, part) in [
        (header("x y z", ""), "the header has no `DATA`; the file is cut off"),
        (
            header("x y z", "SIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
            "`SIZE` has 2 entries for 3 fields",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
            "`TYPE` has 2 entries for 3 fields",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nCOUNT 1\nDATA ascii\n"),
            "`COUNT` has 1 entries for 3 fields",
        ),
        (
            header("x y z", "SIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
            "a number of 3 bytes cannot be read",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F D\nPOINTS 1\nDATA ascii\n1 2 3\n"),
            "`D` is no type of a number",
        ),
        (
            header("x y w", "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
            "the points have no x, y and z",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n"),
            "does not say how many points there are",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA packed\n"),
            "`DATA` must be ascii, binary or",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS many\nDATA ascii\n"),
            "`many` in the header is no whole number",
        ),
        (header("x y z", "COLOUR 1\n"), "line 3: `COLOUR` begins no line of a PCD header"),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2\n  \n"),
            "this point has fewer numbers than",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 three\n"),
            "z is `three`, which is not a number",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3      \n"),
            "the file ends before all 2 points",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 4000000000\nDATA ascii\n1 2 3\n"),
            "promises 4000000000 point rows",
        ),
        (
            header("x y z", "SIZE 4 4 4\nTYPE F F F\nPOINTS 0\nDATA ascii\n"),
            "there are no points in this PCD file",
        ),
    ] {
        let message = refused("a.pcd", &text);
        assert!(message.contains(part), "{text:?}\n  gives  {message}\n  not    {part}");
    }
    let points = vec![vec![1.0, 2.0, 3.0]; 50];
    let binary = pcd_binary(&XYZ, &points);
    assert!(refused("a.pcd", &binary[..binary.len() - 1]).contains("the header promises 50 point rows"));
    let compressed = pcd_compressed(&XYZ, &points);
    let from = pcd_header(&XYZ, 50, "binary_compressed").len();
    for end in from..compressed.len() {
        let message = refused("a.pcd", &compressed[..end]);
        assert!(message.contains("cut off or damaged"), "{end}: {message}");
    }
    // A reference before the first byte, and sizes that are not those of the points.
    let mut bad = compressed.clone();
    bad[from + 8] = 0xff;
    assert!(refused("a.pcd", &bad).contains("cut off or damaged"));
    for size in [0_u32, 599, u32::MAX] {
        let mut bad = compressed.clone();
        bad[from + 4..from + 8].copy_from_slice(&size.to_le_bytes());
        let message = refused("a.pcd", &bad);
        assert!(
            message.contains("point rows") || message.contains("cut off or damaged"),
            "{size}: {message}"
        );
    }
}

const TWO: [DVec3; 2] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)];

#[test]
fn pts_begins_with_its_number_of_points() {
    for text in [
        "2\n1 2 3\n4 5 6\n",
        "2\r\n1 2 3 -1200 255 0 10\r\n4 5 6 -900 7 8 9\r\n",
        "# a scan\n  2  \n1 2 3 0.5\n4 5 6 0.25\n",
        "//X Y Z Intensity R G B\n2\n1 2 3 -1200 255 0 10\n4 5 6 -900 7 8 9\n",
        // Two clouds, one after the other.
        "1\n1 2 3\n1\n4 5 6\n",
    ] {
        let (format, mesh) = read("a.pts", text);
        assert_eq!((format, &mesh.position[..]), (InputFormat::Xyz, &TWO[..]), "{text}");
        assert!(!mesh.warnings.iter().any(|warning| warning.contains("follow")), "{:?}", mesh.warnings);
    }
    let (_, mesh) = read("a.pts", "1200\n1 2 3\n4 5 6\n");
    assert_eq!(mesh.warnings, ["The file says that it has 1200 points, and 2 follow."]);
    let message = refused("a.ptx", "2\n1\n0 0 0\n1 0 0\n");
    assert!(message.contains("line 2: a point takes three numbers") && message.contains("PTX"), "{message}");
    let message = refused("a.xyz", "1 2 3\n4\n");
    assert!(message.contains("here is 1"), "{message}");
}

#[test]
fn points_without_coordinates_are_left_out_and_counted() {
    let told = |points: usize, total: usize| {
        let points = if points == 1 { "1 point".to_owned() } else { format!("{points} points") };
        format!("Left out for a coordinate that is not a finite number (NaN): {points} of {total}.")
    };
    for (name, text, left_out) in [
        ("a.xyz", "1 2 3\nnan nan nan\n4 5 6\n", 1),
        ("a.xyz", "NaN 2 3\n1 2 3\n1 -inf 3\n4 5 6\n1 2 1e400\n", 3),
        ("a.csv", "x,y,z\n1,2,3\n,,\n4,5,6\n7,8,\n", 2),
        ("a.csv", "x;y;z;label\n1;2;3;a\n4;5;6;b\n;5;6;c\n", 1),
        ("a.csv", ",x,y,z\n0,1,2,3\n1,4,5,6\n2,NA,null,None\n", 1),
        ("a.tsv", "x\ty\tz\n1\t2\t3\n4\t\t6\n4\t5\t6\n", 1),
        ("a.tsv", "x\ty\tz\n1\t2\t3\n\t5\t6\n4\t5\t\n4\t5\t6 # last\n", 2),
        ("a.csv", "1,2,3\n4,5,6\n-nan(ind),1.#QNAN,3\n", 1),
        ("a.obj", "v 1 2 3\nv nan 0 0\nv 4 5 6\n", 1),
        ("a.off", "OFF\n3 0 0\n1 2 3\nnan nan nan\n4 5 6\n", 1),
        (
            "a.pcd",
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 3\nDATA ascii\nnan nan nan\n1 2 3\n4 5 6\n",
            1,
        ),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
             1 2 3\nnan 0 0\n4 5 6\n",
            1,
        ),
    ] {
        let (_, mesh) = read(name, text);
        assert_eq!(mesh.position, TWO, "{text}");
        assert_eq!(mesh.warnings, [told(left_out, 2 + left_out)], "{text}");
    }
    for write in [pcd_binary, pcd_compressed] {
        let points =
            vec![vec![f64::NAN; 3], vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0], vec![1.0, f64::INFINITY, 1.0]];
        let (_, mesh) = read("a.pcd", write(&XYZ, &points));
        assert_eq!((&mesh.position[..], &mesh.warnings[..]), (&TWO[..], &[told(2, 4)][..]));
    }
    assert!(refused("a.xyz", "nan nan nan\n").contains("there are no points in this XYZ file"));
    // Faces at such a point go with it, and the others keep their corners.
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let header = format!("element vertex 5\n{xyz}element face 5\nproperty list uchar int vertex_indices\n");
    let nan = [("float", f64::NAN); 3];
    let mut rows = nan.to_vec();
    CORNERS.iter().flatten().for_each(|&c| rows.push(("float", c)));
    for corners in FACES.iter().map(|face| face.map(|v| v + 1)).chain([[0, 1, 2]]) {
        rows.push(("uchar", 3.0));
        rows.extend(corners.map(|v| ("int", f64::from(v))));
    }
    for big in [false, true] {
        let (cloud, warnings) = cloud("a.ply", binary_ply(big, &header, &rows));
        assert_is_tetrahedron(&cloud);
        let expected =
            "Left out for a coordinate that is not a finite number (NaN): 1 point of 5, and 1 face.";
        assert_eq!(warnings, [expected]);
    }
    // A normal that is not finite is none.
    let (cloud, warnings) = cloud("a.csv", "x,y,z,nx,ny,nz\n1,2,3,nan,nan,nan\n4,5,6,0,0,1\n");
    assert_eq!((cloud.position, cloud.normal), (vec![TWO[1]], vec![DVec3::Z]));
    assert!(warnings[0].contains("1 of 2 points have no normal"), "{warnings:?}");
}

/// Sixteen points with unit normals on a sphere.
fn ball() -> Vec<[f64; 3]> {
    let direction = |k: u32| {
        let (x, y, z) = (f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.5, f64::from(k % 3) - 1.0);
        DVec3::new(x, y, z).normalize_or_zero().to_array()
    };
    (0..16).map(direction).collect()
}

/// Lines of the points of the ball, with what `more` gives of each.
fn lines(more: impl Fn(usize, [f64; 3]) -> String) -> String {
    ball().into_iter().enumerate().fold(String::new(), |mut text, (k, [x, y, z])| {
        let _ = writeln!(text, "{x} {y} {z} {}", more(k, [x, y, z]));
        text
    })
}

#[test]
fn colours_are_told_from_normals_by_their_values() {
    let colour = |k: usize| format!("{} {} {}", 16 * k, 255 - 3 * k, k % 2);
    let normal = |[x, y, z]: [f64; 3]| format!("{x:.3} {y:.3} {z:.3}");
    let is_read = |text: &str, has_normals: bool| {
        let (cloud, warnings) = cloud("a.xyz", text);
        assert_eq!(cloud.len(), 16, "{text}");
        assert_eq!(!cloud.normal.is_empty(), has_normals, "{text}");
        for (n, p) in cloud.normal.iter().zip(&cloud.position) {
            assert!((*n - *p).length() < 1e-2, "{n} at {p}");
        }
        assert_eq!(warnings.iter().any(|warning| warning.contains("colours")), !has_normals, "{warnings:?}");
    };
    is_read(&lines(|_, p| normal(p)), true);
    is_read(&lines(|k, _| colour(k)), false);
    is_read(&lines(|k, p| format!("{} {}", colour(k), normal(p))), true);
    is_read(&lines(|k, p| format!("{} {}", normal(p), colour(k))), true);
    // With an intensity, and with an opacity.
    is_read(&lines(|k, _| format!("-{k}00 {}", colour(k))), false);
    is_read(&lines(|k, p| format!("0.{k} {}", normal(p))), true);
    is_read(&lines(|k, p| format!("{} 255 {}", colour(k), normal(p))), true);
    is_read(&lines(|k, p| format!("0.5 {} 255 {}", colour(k), normal(p))), true);
    is_read(&lines(|k, p| format!("{} 0.03", normal(p).replace("0.000", &format!("0.00{}", k % 3)))), true);
    // Normals of another length, as MeshLab writes those that it has summed up.
    is_read(&lines(|_, [x, y, z]| format!("{:.4} {:.4} {:.4}", 6.2 * x, 6.2 * y, 6.2 * z)), true);
    is_read(&lines(|k, _| format!("-1 0 0 {}", colour(k))), false);
    // Colours between 0 and 1, also of one primary colour each, which have the length of a normal.
    is_read(&lines(|k, _| format!("0.{k} 0.5 0.25")), false);
    is_read(&lines(|k, _| ["1 0 0", "0 1 0", "0 0 1"][k % 3].to_owned()), false);
    is_read(&lines(|_, _| "0 0 0".to_owned()), false);
    // Words among the other columns.
    is_read(&lines(|k, _| format!("{} tree", colour(k))), false);
    is_read(&lines(|_, p| format!("{} tree", normal(p))), true);
    // PLY and OBJ name their colours.
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 16\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n\
         property uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float scalar_Intensity\nend_header\n{}",
        lines(|k, _| format!("{} 255 0.5", colour(k)))
    );
    let obj = lines(|k, _| colour(k)).lines().fold(String::new(), |text, line| text + "v " + line + "\n");
    for (name, text) in [("a.ply", ply), ("a.obj", obj)] {
        let (cloud, warnings) = cloud(name, text);
        assert_eq!((cloud.len(), cloud.normal.len(), warnings), (16, 0, Vec::<String>::new()));
    }
}

#[test]
fn columns_are_found_by_the_names_that_programs_give_them() {
    let rows = |header: &str, row: &dyn Fn([f64; 3]) -> String| {
        let rows: Vec<String> = ball().into_iter().map(row).collect();
        format!("{header}\n{}\n", rows.join("\n"))
    };
    type Row = fn([f64; 3]) -> String;
    let named: [(&str, Row); 8] = [
        // pandas with its index, R with its quotes, ParaView, NumPy and CloudCompare with their
        // comments, with spaces in names, and a label.
        (",x,y,z,nx,ny,nz", |[x, y, z]| format!("7,{x},{y},{z},{x},{y},{z}")),
        ("\"\",\"x\",\"y\",\"z\",\"nx\",\"ny\",\"nz\"", |[x, y, z]| format!("\"1\",{x},{y},{z},{x},{y},{z}")),
        ("\"Normals:0\",\"Normals:1\",\"Normals:2\",\"Points:0\",\"Points:1\",\"Points:2\"", |[x, y, z]| {
            format!("{x},{y},{z},{x},{y},{z}")
        }),
        ("# nx ny nz x y z", |[x, y, z]| format!("{x} {y} {z} {x} {y} {z}")),
        ("//X,Y,Z,R,G,B,Nx,Ny,Nz", |[x, y, z]| format!("{x},{y},{z},255,0,10,{x},{y},{z}")),
        ("Point ID;X;Y;Z;Normal_X;Normal_Y;Normal_Z;Note", |[x, y, z]| {
            format!("3;{x};{y};{z};{x};{y};{z};\"a; b\"")
        }),
        ("x\ty\tz\tnx\tny\tnz\tpoint class", |[x, y, z]| format!("{x}\t{y}\t{z}\t{x}\t{y}\t{z}\tlow tree")),
        ("x, y, z, normalX, normalY, normalZ,", |[x, y, z]| format!("{x}, {y}, {z}, {x}, {y}, {z},")),
    ];
    for (header, row) in named {
        for end in ["\n", "\r\n"] {
            let (cloud, warnings) = cloud("a.csv", rows(header, &row).replace('\n', end));
            assert_eq!(
                (cloud.len(), cloud.source, &warnings),
                (16, NormalSource::Given, &vec![]),
                "{header}"
            );
            for ((p, n), [x, y, z]) in cloud.position.iter().zip(&cloud.normal).zip(ball()) {
                assert_eq!(*p, DVec3::new(x, y, z), "{header}");
                assert!((*n - *p).length() < 1e-12, "{header}");
            }
        }
    }
}
