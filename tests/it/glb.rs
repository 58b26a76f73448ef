//! Binary glTF files as models: what other programs write, and what this one has written.

use crate::pointcloud_read::{read, refused};
use glam::DVec3;
use marching_particles::pointcloud::read::InputFormat;
use serde_json::{Value, json};

/// A file of this document and these bytes.
fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    let size = |bytes: usize| (bytes as u32).to_le_bytes();
    file.extend(size(28 + text.len() + binary.len()));
    for (kind, part) in [(b"JSON", &text[..]), (b"BIN\0", binary)] {
        file.extend(size(part.len()));
        file.extend(kind);
        file.extend(part);
    }
    file
}

/// The four corners of a square in the plane z = 0 of glTF, and the indices of its two triangles.
fn square() -> Vec<u8> {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let numbers = corners.iter().flatten().flat_map(|&x: &f32| x.to_le_bytes());
    numbers.chain([0_u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes)).collect()
}

/// A document in which the square is mesh 0, with these nodes, all in the scene.
fn document(nodes: &Value, roots: &Value) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "buffers": [{ "byteLength": 60 }],
    })
}

/// The document with one change, at a JSON pointer.
fn with(pointer: &str, value: Value) -> Value {
    let mut document = document(&json!([{ "mesh": 0 }]), &json!([0]));
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let parent = document.pointer_mut(parent).expect("a member of the document");
    match parent {
        Value::Array(list) => list[name.parse::<usize>().expect("an index")] = value,
        parent => parent[name] = value,
    }
    document
}

/// Twice the sum of the area vectors of all faces.
fn area(position: &[DVec3], corners: &[u32]) -> DVec3 {
    let triangles = corners.as_chunks::<3>().0.iter();
    triangles.map(|face| face.map(|v| position[v as usize])).map(|[a, b, c]| (b - a).cross(c - a)).sum()
}

#[test]
fn a_mesh_stands_where_its_nodes_place_it_with_z_up() {
    // A quarter turn about y, twice as large, then moved; and the same by a matrix and by nothing.
    let (half, zero) = (0.5_f64.sqrt(), 0.0);
    let nodes = json!([
        { "translation": [10.0, 20.0, 30.0], "children": [1] },
        { "rotation": [zero, half, zero, half], "scale": [2.0, 2.0, 2.0], "mesh": 0 },
        { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -5, 0, 0, 1], "mesh": 0 },
        { "mesh": 0 },
    ]);
    let (format, mesh) = read("a.glb", glb(&document(&nodes, &json!([0, 2])), &square()));
    assert_eq!(format, InputFormat::Glb);
    // x and y of the square are -z and y of glTF, which are y and z here.
    let placed = [[0, 0, 0], [0, 2, 0], [0, 2, 2], [0, 0, 2]].map(|[x, y, z]| [x + 10, y - 30, z + 20]);
    let moved = [[-5, 0, 0], [-4, 0, 0], [-4, 0, 1], [-5, 0, 1]];
    let expected = placed.into_iter().chain(moved).map(|p| DVec3::from_array(p.map(f64::from)));
    for (p, expected) in mesh.position.iter().zip(expected) {
        assert!(p.distance(expected) < 1e-12, "{p} is not {expected}");
    }
    assert_eq!(mesh.position.len(), 8, "the node outside of the scene is not shown");
    assert_eq!(mesh.corners, [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]);
}

#[test]
fn a_reflection_keeps_the_outside_outside() {
    let upright = document(&json!([{ "mesh": 0 }]), &json!([0]));
    let reflected = document(&json!([{ "mesh": 0, "scale": [1.0, 1.0, -1.0] }]), &json!([0]));
    for (document, outward) in [(upright, -1.0), (reflected, 1.0)] {
        let (_, mesh) = read("a.glb", glb(&document, &square()));
        assert_eq!(area(&mesh.position, &mesh.corners), DVec3::new(0.0, 2.0 * outward, 0.0));
    }
}

#[test]
fn strips_fans_points_and_lines_are_told_apart() {
    for (mode, corners, points) in [
        (4, &[0, 1, 2, 0, 2, 3][..], 4),
        // Six indices: 0 1 2 0 2 3.
        (5, &[0, 1, 2, 1, 0, 2, 2, 0, 2, 0, 3, 2], 4),
        (6, &[1, 2, 0, 2, 0, 0, 0, 2, 0, 2, 3, 0], 4),
        (0, &[], 4),
    ] {
        let (_, mesh) = read("a.glb", glb(&with("/meshes/0/primitives/0/mode", json!(mode)), &square()));
        assert_eq!((&mesh.corners[..], mesh.position.len()), (corners, points), "mode {mode}");
    }
    let lines = glb(&with("/meshes/0/primitives/0/mode", json!(1)), &square());
    assert!(refused("a.glb", lines).contains("there are no points in this GLB file"));
    // A strip of four corners is the square, both of its triangles turned as the first one is.
    let mut strip = with("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0 }, "mode": 5 }));
    let mut bytes = square();
    // Corners 2 and 3 change places.
    let (third, fourth) = (bytes[24..36].to_vec(), bytes[36..48].to_vec());
    bytes[24..36].copy_from_slice(&fourth);
    bytes[36..48].copy_from_slice(&third);
    strip["bufferViews"][0]["byteStride"] = json!(12);
    let (_, mesh) = read("a.glb", glb(&strip, &bytes));
    assert_eq!(area(&mesh.position, &mesh.corners), DVec3::new(0.0, -2.0, 0.0));
}

#[test]
fn whole_numbers_are_read_as_such_or_as_shares() {
    let bytes: Vec<u8> = [[0_i16, 0, 0, 7], [32767, 0, 0, 7], [0, -32767, -32768, 7]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    for (normalized, largest) in [(true, 1.0), (false, 32767.0)] {
        let mut document =
            with("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
        let accessor = json!({
            "bufferView": 0, "componentType": 5122, "normalized": normalized, "count": 3, "type": "VEC3",
        });
        document["accessors"][0] = accessor;
        document["bufferViews"][0] = json!({ "buffer": 0, "byteLength": 24, "byteStride": 8 });
        let (_, mesh) = read("a.glb", glb(&document, &bytes));
        let lowest = if normalized { -1.0 } else { -32768.0 };
        let expected =
            [DVec3::ZERO, DVec3::X * largest, DVec3::new(0.0, -lowest, -largest)].map(|p| p + DVec3::ZERO);
        assert_eq!(mesh.position, expected);
    }
}

#[test]
fn what_cannot_be_read_is_named_with_what_to_do() {
    let whole = square();
    for (pointer, value, message) in [
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "extensionsRequired: KHR_draco_mesh_compression is not read; export it without Draco compression",
        ),
        (
            "/buffers/0/uri",
            json!("a.bin"),
            "buffers[0]: its numbers are in another file; export the mesh as one .glb file",
        ),
        ("/accessors/0/count", json!(5), "accessors[0]: its 5 rows do not fit into the buffer"),
        ("/accessors/0/count", json!(1_u64 << 53), "accessors[0]: its 9007199254740992 rows do not fit"),
        ("/accessors/0/count", json!(3), "meshes[0].primitives[0]: index 5 is 3, and there are 3 positions"),
        ("/accessors/0/type", json!("VEC2"), "accessors[0]: its type is not VEC3"),
        ("/accessors/0/componentType", json!(5130), "accessors[0]: componentType 5130 is none of glTF 2.0"),
        ("/accessors/0/sparse", json!({}), "accessors[0]: sparse accessors are not read"),
        ("/bufferViews/0/byteOffset", json!(20), "accessors[0]: its 4 rows do not fit into the buffer"),
        ("/scenes/0/nodes/0", json!(9), "a scene or a node: it names nodes[9], and there are 1 nodes"),
        ("/nodes/0/mesh", json!(2), "nodes[0].mesh: it names meshes[2], and there are 1 meshes"),
        ("/nodes/0/children", json!([0]), "nodes[0]: two nodes, or itself, have it as a child"),
        ("/meshes/0/primitives/0/attributes", json!({}), "meshes[0].primitives[0]: it has no positions"),
        (
            "/meshes/0/primitives/0/indices",
            json!(-1),
            "meshes[0].primitives[0].indices: it is not a whole number",
        ),
        ("/accessors/0/count", json!(null), "accessors[0].count: it is not a whole number"),
        ("/nodes/0/scale", json!([1, 2]), "nodes[0].scale: it is not a list of 3 numbers"),
        (
            "/extras",
            (0..99).fold(json!(1), |inner, _| json!([inner])),
            "JSON: it is nested deeper than 64 levels",
        ),
        ("/meshes/0/primitives/0/indices", json!(7), "it names accessors[7], and there are 2 accessors"),
        ("/meshes/0", json!({ "primitives": 3 }), "meshes[0].primitives: it is not a list"),
    ] {
        let told = refused("a.glb", glb(&with(pointer, value), &whole));
        assert!(told.contains(message), "{pointer}: {told}");
    }
    let file = glb(&document(&json!([{ "mesh": 0 }]), &json!([0])), &whole);
    for end in 4..file.len() {
        assert!(refused("a.glb", &file[..end]).contains("export"), "{end} bytes");
    }
    let mut old = file.clone();
    old[4] = 1;
    assert!(refused("a.glb", old).contains("this is glTF 1; export it as glTF 2.0"));
}
