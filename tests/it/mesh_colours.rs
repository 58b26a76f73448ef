//! Colours of triangle meshes: read from each format, carried to the new mesh, and written.

use glam::DVec3;
use marching_particles::remesh::MeshOptions;
use marching_particles::{MeshFormat, Settings, TriangleMesh, sample};

/// The corners of the unit cube, whose colours are their places.
fn corners() -> impl Iterator<Item = [u8; 3]> {
    (0..8_u8).map(|k| [k & 1, k >> 1 & 1, k >> 2])
}

const FACES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

fn lines(rows: impl Iterator<Item = String>) -> String {
    rows.map(|row| row + "\n").collect()
}

/// The cube in the text formats that have colours.
fn files() -> [(&'static str, String); 4] {
    let faces = |prefix: &str, from: u32| {
        let row = |[a, b, c]: [u32; 3]| format!("{prefix} {} {} {}", a + from, b + from, c + from);
        lines(FACES.into_iter().map(row))
    };
    let bytes = |[x, y, z]: [u8; 3]| format!("{x} {y} {z} {} {} {}", 255 * x, 255 * y, 255 * z);
    let ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
               property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
               element face 12\nproperty list uchar int vertex_indices\nend_header\n";
    [
        ("cube.ply", ply.to_owned() + &lines(corners().map(bytes)) + &faces("3", 0)),
        (
            "cube.obj",
            lines(corners().map(|[x, y, z]| format!("v {x} {y} {z} {x}.0 {y}.0 {z}.0"))) + &faces("f", 1),
        ),
        (
            "cube.off",
            "COFF\n8 12 0\n".to_owned() + &lines(corners().map(|own| bytes(own) + " 255")) + &faces("3", 0),
        ),
        (
            "normals.off",
            "CNOFF\n8 12 0\n".to_owned()
                + &lines(corners().map(|[x, y, z]| format!("{x} {y} {z} 0 0 1 {x} {y} {z} 1")))
                + &faces("3", 0),
        ),
    ]
}

#[test]
fn colours_are_read_and_have_values_between_the_vertices() {
    for (name, text) in files() {
        let mesh =
            TriangleMesh::read(name, text.into_bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let wanted: Vec<[f32; 3]> = corners().map(|own| own.map(f32::from)).collect();
        assert_eq!(mesh.colours(), wanted, "{name}");
        let solid = mesh.solid().expect("a solid");
        for p in [DVec3::new(0.3, 0.8, 0.0), DVec3::new(1.0, 0.25, 0.5), DVec3::new(0.4, 1.0, 0.9)] {
            let found = solid.colour_at(p).expect("a colour").map(f64::from);
            assert!(DVec3::from(found).distance(p) < 1e-6, "{name}: {found:?} at {p}");
        }
    }
    let plain = TriangleMesh::new(corners().map(|own| own.map(f64::from).into()).collect(), FACES.to_vec());
    let plain = plain.expect("a mesh");
    assert!(
        plain.with_colours(vec![[0.0; 3]; 7]).is_err_and(|error| error.to_string().contains("7 colours"))
    );
}

#[test]
fn new_meshes_have_the_colours_of_the_old_one_in_their_files() {
    let (name, text) = files()[0].clone();
    let mesh = TriangleMesh::read(name, text.into_bytes()).expect("a mesh");
    let field = mesh.solid().and_then(|solid| solid.field(&MeshOptions::default())).expect("a field");
    let made = sample(&field, &Settings::with_count(600)).expect("a sample");
    // GLB has 16 bits for the light, which spread dark values by up to 13.
    for (format, name, within) in
        [(MeshFormat::Ply, "new.ply", 0.5 / 255.0), (MeshFormat::Glb, "new.glb", 1e-3)]
    {
        let mut bytes = Vec::new();
        made.write_mesh(format, &mut bytes).expect("written");
        let new = TriangleMesh::read(name, bytes).expect("a mesh");
        assert_eq!(new.colours().len(), new.vertices().len(), "{name}");
        let size = new.bounds().size().max_element();
        for (p, colour) in new.vertices().iter().zip(new.colours()) {
            let off = (DVec3::from(colour.map(f64::from)) - *p / size).abs().max_element();
            assert!(off < within + 1e-6, "{name}: {colour:?} at {p}");
        }
    }
}
