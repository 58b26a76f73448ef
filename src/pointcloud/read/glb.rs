//! Reader of binary glTF files (Khronos, glTF 2.0, sections 3 and 4): the triangles and points of
//! the scene that the file shows, each mesh where its nodes place it.
//!
//! The y axis of glTF, which points up there, is turned to z, as the writer of this format turns z
//! to y.

use super::ReadError;
use super::input::{COMPONENTS, Input};
use super::mesh::FileMesh;
use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;

/// Bytes with which a file begins.
pub(super) const MAGIC: &[u8] = b"glTF";

/// Extensions that change how the numbers of a mesh are read, with what to do about them.
const UNREAD: [(&str, &str); 3] = [
    ("KHR_draco_mesh_compression", "export it without Draco compression"),
    ("EXT_meshopt_compression", "export it without meshopt compression"),
    ("KHR_meshopt_compression", "export it without meshopt compression"),
];

/// Numbers of the specification: the topologies of primitives.
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// The parts of the JSON document that are read.
#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
struct Document {
    scene: Option<usize>,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Scene {
    nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Node {
    children: Vec<usize>,
    mesh: Option<usize>,
    /// By columns.
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct Mesh {
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    position: Option<usize>,
    normal: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<String>,
}

impl Node {
    fn transform(&self) -> DMat4 {
        match self.matrix {
            Some(matrix) => DMat4::from_cols_array(&matrix),
            None => DMat4::from_scale_rotation_translation(
                self.scale.map_or(DVec3::ONE, DVec3::from_array),
                self.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q).normalize()),
                self.translation.map_or(DVec3::ZERO, DVec3::from_array),
            ),
        }
    }
}

/// The numbers of an accessor: rows of so many components.
struct Rows<'a> {
    /// The bytes from the first row on.
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    kind: Kind,
    /// Whether whole numbers stand for shares of the largest one.
    normalized: bool,
}

/// The type of a component.
#[derive(Clone, Copy)]
enum Kind {
    Byte,
    UnsignedByte,
    Short,
    UnsignedShort,
    UnsignedInt,
    Float,
}

impl Kind {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::Byte,
            5121 => Self::UnsignedByte,
            5122 => Self::Short,
            5123 => Self::UnsignedShort,
            5125 => Self::UnsignedInt,
            5126 => Self::Float,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::Byte | Self::UnsignedByte => 1,
            Self::Short | Self::UnsignedShort => 2,
            Self::UnsignedInt | Self::Float => 4,
        }
    }

    /// The number at the beginning of `bytes`, and the largest one of its type.
    fn read(self, bytes: &[u8]) -> (f64, f64) {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            *bytes.first_chunk().expect("a row that lies in its buffer")
        }
        match self {
            Self::Byte => (i8::from_le_bytes(first(bytes)).into(), i8::MAX.into()),
            Self::UnsignedByte => (u8::from_le_bytes(first(bytes)).into(), u8::MAX.into()),
            Self::Short => (i16::from_le_bytes(first(bytes)).into(), i16::MAX.into()),
            Self::UnsignedShort => (u16::from_le_bytes(first(bytes)).into(), u16::MAX.into()),
            Self::UnsignedInt => (u32::from_le_bytes(first(bytes)).into(), u32::MAX.into()),
            Self::Float => (f32::from_le_bytes(first(bytes)).into(), 1.0),
        }
    }
}

impl Rows<'_> {
    /// Component `k` of row `i`.
    fn number(&self, i: usize, k: usize) -> f64 {
        let (number, largest) = self.kind.read(&self.bytes[i * self.stride + k * self.kind.bytes()..]);
        if self.normalized { (number / largest).max(-1.0) } else { number }
    }

    fn vector(&self, i: usize) -> DVec3 {
        DVec3::from_array(core::array::from_fn(|k| self.number(i, k)))
    }
}

/// A document with its binary part.
struct Glb<'a> {
    document: Document,
    binary: &'a [u8],
}

fn wrong(member: impl Into<String>, message: impl Into<String>) -> ReadError {
    ReadError::Member { member: member.into(), message: message.into() }
}

/// An element of a list of the document, by its index there.
fn element<'d, T>(list: &'d [T], name: &str, index: usize, by: &str) -> Result<&'d T, ReadError> {
    list.get(index)
        .ok_or_else(|| wrong(by, format!("it names {name}[{index}], and there are {} {name}", list.len())))
}

impl<'a> Glb<'a> {
    /// Splits a file into its two parts and reads the first of them.
    fn open(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let number = |at: usize| {
            let word = bytes.get(at..at + 4).and_then(<[u8]>::first_chunk);
            word.map(|&word| u32::from_le_bytes(word))
                .ok_or_else(|| wrong("header", "the file is cut off; export it again"))
        };
        let version = number(4)?;
        if version != 2 {
            return Err(wrong("header", format!("this is glTF {version}; export it as glTF 2.0")));
        }
        let (mut text, mut binary): (&[u8], &[u8]) = (&[], &[]);
        let mut at = 12;
        while at < bytes.len() {
            let (length, kind) = (number(at)? as usize, number(at + 4)?.to_le_bytes());
            let left = bytes.len() - (at + 8);
            let Some(chunk) = bytes[at + 8..].get(..length) else {
                let message = format!(
                    "the part at byte {at} has {length} bytes, and {left} follow; the file is cut off: export it again"
                );
                return Err(wrong("header", message));
            };
            match &kind {
                b"JSON" if text.is_empty() => text = chunk,
                b"BIN\0" if binary.is_empty() => binary = chunk,
                _ => {}
            }
            at += 8 + length;
        }
        let document: Document = serde_json::from_slice(text)
            .map_err(|error| wrong("JSON", format!("{error}; export it again")))?;
        let unread = |&(extension, _): &(&str, &str)| {
            document.extensions_required.iter().any(|required| required == extension)
        };
        if let Some((extension, advice)) = UNREAD.into_iter().find(unread) {
            return Err(wrong("extensionsRequired", format!("{extension} is not read; {advice}")));
        }
        Ok(Self { document, binary })
    }

    /// The rows of an accessor, each of so many numbers.
    fn rows(&self, index: usize, components: usize, by: &str) -> Result<Rows<'a>, ReadError> {
        let Document { accessors, buffer_views, buffers, .. } = &self.document;
        let accessor = element(accessors, "accessors", index, by)?;
        let name = format!("accessors[{index}]");
        let wanted = if components == 1 { "SCALAR" } else { "VEC3" };
        if accessor.kind != wanted {
            return Err(wrong(name, format!("its type is not {wanted}, which {by} needs")));
        }
        let Some(kind) = Kind::of(accessor.component_type) else {
            return Err(wrong(
                name,
                format!("componentType {} is none of glTF 2.0", accessor.component_type),
            ));
        };
        let (None, Some(view)) = (&accessor.sparse, accessor.buffer_view) else {
            return Err(wrong(name, "sparse accessors are not read; export it without"));
        };
        let view = element(buffer_views, "bufferViews", view, &name)?;
        let buffer = element(buffers, "buffers", view.buffer, &name)?;
        if view.buffer != 0 || buffer.uri.is_some() {
            let message = "its numbers are in another file; export the mesh as one .glb file";
            return Err(wrong(format!("buffers[{}]", view.buffer), message));
        }
        let size = components * kind.bytes();
        let (stride, count) = (view.byte_stride.unwrap_or(size).max(size), accessor.count);
        let rows = count.checked_sub(1).map_or(Some(0), |steps| steps.checked_mul(stride)?.checked_add(size));
        let lies_within = |bytes: &'a [u8], from: usize, length: usize| bytes.get(from..)?.get(..length);
        let bytes = lies_within(self.binary, view.byte_offset, view.byte_length)
            .zip(rows)
            .and_then(|(bytes, rows)| lies_within(bytes, accessor.byte_offset, rows));
        let Some(bytes) = bytes else {
            let message = format!("its {count} rows do not fit into the buffer; export the file again");
            return Err(wrong(name, message));
        };
        Ok(Rows { bytes, stride, count, kind, normalized: accessor.normalized })
    }

    /// The meshes of the scene with their transforms.
    fn placed(&self) -> Result<Vec<(usize, DMat4)>, ReadError> {
        let Document { scene, scenes, nodes, meshes, .. } = &self.document;
        // A library of meshes has no nodes.
        if nodes.is_empty() {
            return Ok((0..meshes.len()).map(|mesh| (mesh, DMat4::IDENTITY)).collect());
        }
        let mut stack: Vec<(usize, DMat4)> = if let Some(scene) = scenes.get(scene.unwrap_or(0)) {
            scene.nodes.iter().map(|&node| (node, DMat4::IDENTITY)).collect()
        } else {
            let mut is_child = vec![false; nodes.len()];
            nodes.iter().flat_map(|node| &node.children).for_each(|&child| {
                if let Some(is_child) = is_child.get_mut(child) {
                    *is_child = true;
                }
            });
            (0..nodes.len()).filter(|&node| !is_child[node]).map(|node| (node, DMat4::IDENTITY)).collect()
        };
        stack.reverse();
        let (mut placed, mut is_seen) = (Vec::new(), vec![false; nodes.len()]);
        while let Some((index, outer)) = stack.pop() {
            let name = format!("nodes[{index}]");
            let node = element(nodes, "nodes", index, "a scene or a node")?;
            if core::mem::replace(&mut is_seen[index], true) {
                return Err(wrong(name, "two nodes, or itself, have it as a child; export the file again"));
            }
            let transform = outer * node.transform();
            if let Some(mesh) = node.mesh {
                element(meshes, "meshes", mesh, &name)?;
                placed.push((mesh, transform));
            }
            stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
        }
        Ok(placed)
    }
}

/// Reads the points and triangles of the scene.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let glb = Glb::open(input.rest())?;
    let placed = glb.placed()?;
    // Normals count if every primitive has them.
    let mut primitives = placed.iter().flat_map(|&(index, _)| &glb.document.meshes[index].primitives);
    let has_normals = primitives.all(|primitive| primitive.attributes.normal.is_some());
    let mut left_out = 0;
    for (index, transform) in placed {
        for (k, primitive) in glb.document.meshes[index].primitives.iter().enumerate() {
            let mode = primitive.mode.unwrap_or(TRIANGLES);
            if !matches!(mode, POINTS | TRIANGLES | TRIANGLE_STRIP | TRIANGLE_FAN) {
                left_out += 1;
                continue;
            }
            let name = format!("meshes[{index}].primitives[{k}]");
            let part = Part { glb: &glb, primitive, name: &name, transform, mode };
            part.read(input, mesh, has_normals).await?;
        }
    }
    if left_out > 0 {
        mesh.warnings.push(format!("{left_out} parts of the file that are lines were left out."));
    }
    Ok(())
}

/// A primitive in its place.
struct Part<'a> {
    glb: &'a Glb<'a>,
    primitive: &'a Primitive,
    name: &'a str,
    transform: DMat4,
    mode: u32,
}

impl Part<'_> {
    async fn read(
        &self,
        input: &mut Input<'_>,
        mesh: &mut FileMesh,
        has_normals: bool,
    ) -> Result<(), ReadError> {
        let Self { glb, primitive, name, transform, mode } = *self;
        let Some(position) = primitive.attributes.position else {
            return Err(wrong(name, "it has no positions; export the file again"));
        };
        let positions = glb.rows(position, 3, name)?;
        let normals = match primitive.attributes.normal.filter(|_| has_normals) {
            Some(normal) => Some(glb.rows(normal, 3, name)?),
            None => None,
        };
        if normals.as_ref().is_some_and(|normals| normals.count != positions.count) {
            return Err(wrong(name, "it has another number of normals than of positions; export it again"));
        }
        let first = u32::try_from(mesh.position.len()).map_err(|_| ReadError::Memory)?;
        // A surface that is turned inside out by a reflection has its corners the other way round.
        let (of_normals, is_reflected) = (transform.inverse().transpose(), transform.determinant() < 0.0);
        let z_up = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
        for i in 0..positions.count {
            let p = z_up(transform.transform_point3(positions.vector(i)));
            let n = normals.as_ref().map_or(DVec3::ZERO, |n| z_up(of_normals.transform_vector3(n.vector(i))));
            let mut numbers = [p.x, p.y, p.z, n.x, n.y, n.z];
            for (number, component) in numbers.iter_mut().zip(COMPONENTS) {
                *number = input.coordinate(*number, component)?;
            }
            mesh.add_point(numbers, has_normals)?;
            input.end_row().await;
        }
        if mode == POINTS {
            return Ok(());
        }
        let indices = match primitive.indices {
            Some(indices) => Some(glb.rows(indices, 1, name)?),
            None => None,
        };
        let count = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let corner = |k: usize| {
            let corner = indices.as_ref().map_or(k as f64, |indices| indices.number(k, 0));
            let is_there = corner >= 0.0 && corner < positions.count as f64;
            let message = || format!("index {k} is {corner}, and there are {} positions", positions.count);
            is_there.then_some(first + corner as u32).ok_or_else(|| wrong(name, message()))
        };
        let triangles = if mode == TRIANGLES { count / 3 } else { count.saturating_sub(2) };
        for f in 0..triangles {
            let corners = match mode {
                TRIANGLES => [3 * f, 3 * f + 1, 3 * f + 2],
                // Every other triangle of a strip turns the other way.
                TRIANGLE_STRIP => [f, f + 1 + f % 2, f + 2 - f % 2],
                _ => [f + 1, f + 2, 0],
            };
            let [a, b, c] = corners;
            let (a, b, c) = (corner(a)?, corner(b)?, corner(c)?);
            mesh.add_polygon(&if is_reflected { [a, c, b] } else { [a, b, c] })?;
            input.end_row().await;
        }
        Ok(())
    }
}
