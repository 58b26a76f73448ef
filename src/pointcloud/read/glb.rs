//! Reader of binary glTF files (Khronos, glTF 2.0, sections 3 and 4): the triangles and points of
//! the scene that the file shows, each mesh where its nodes place it.
//!
//! The y axis of glTF, which points up there, is turned to z, as the writer of this format turns z
//! to y.

use super::input::{COMPONENTS, Input};
use super::mesh::FileMesh;
use super::{ReadError, wrong};
use glam::{DMat4, DQuat, DVec3};
use tinyjson::JsonValue;

/// Bytes with which a file begins.
pub(super) const MAGIC: &[u8] = b"glTF";

/// Extensions that change how the numbers of a mesh are read, with what to do about them.
const UNREAD: [(&str, &str); 3] = [
    ("KHR_draco_mesh_compression", "export it without Draco compression"),
    ("EXT_meshopt_compression", "export it without meshopt compression"),
    ("KHR_meshopt_compression", "export it without meshopt compression"),
];

/// Numbers of the specification: the topologies of primitives.
const POINTS: usize = 0;
const TRIANGLES: usize = 4;
const TRIANGLE_STRIP: usize = 5;
const TRIANGLE_FAN: usize = 6;

/// Deepest nesting of the JSON document: the parser calls itself for every level.
const DEEPEST: usize = 64;

/// Deepest nesting of a JSON text.
fn depth(text: &[u8]) -> usize {
    let (mut depth, mut deepest, mut in_string, mut is_escaped) = (0_usize, 0, false, false);
    for &byte in text {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = in_string,
            b'"' => in_string = !in_string,
            b'[' | b'{' if !in_string => depth += 1,
            b']' | b'}' if !in_string => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

/// A member of the document, with its name for messages: `accessors[3].count`.
struct Member<'d> {
    value: &'d JsonValue,
    name: String,
}

impl<'d> Member<'d> {
    /// The member of an object; none if it is not there.
    fn get(&self, key: &str) -> Option<Self> {
        let value = self.value.get::<std::collections::HashMap<String, JsonValue>>()?.get(key)?;
        let name = if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) };
        Some(Self { value, name })
    }

    fn wrong(&self, message: &str) -> ReadError {
        wrong(self.name.as_str(), message)
    }

    /// The elements of a list, which is empty if it is not there.
    fn list(&self, key: &str) -> Result<&'d [JsonValue], ReadError> {
        let Some(member) = self.get(key) else { return Ok(&[]) };
        let list = member.value.get::<Vec<JsonValue>>();
        list.map(Vec::as_slice).ok_or_else(|| member.wrong("it is not a list; export the file again"))
    }

    /// A whole number that is not negative.
    fn whole(&self) -> Result<usize, ReadError> {
        /// Largest whole number up to which a double holds every one.
        const LARGEST: f64 = 9_007_199_254_740_992.0;
        let number =
            self.value.get::<f64>().copied().filter(|n| n.fract() == 0.0 && (0.0..=LARGEST).contains(n));
        number
            .map(|n| n as usize)
            .ok_or_else(|| self.wrong("it is not a whole number; export the file again"))
    }

    fn whole_at(&self, key: &str) -> Result<Option<usize>, ReadError> {
        self.get(key).map(|member| member.whole()).transpose()
    }

    /// A whole number that has to be there.
    fn needed(&self, key: &str) -> Result<usize, ReadError> {
        let missing = || self.wrong(&format!("it has no {key}; export the file again"));
        self.whole_at(key)?.ok_or_else(missing)
    }

    fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, ReadError> {
        let Some(member) = self.get(key) else { return Ok(None) };
        let list: Vec<f64> = self.list(key)?.iter().filter_map(|number| number.get().copied()).collect();
        let numbers = <[f64; N]>::try_from(list);
        numbers
            .map(Some)
            .map_err(|_| member.wrong(&format!("it is not a list of {N} numbers; export the file again")))
    }

    /// The element of a list of the document that this number names.
    fn named<'a>(&self, glb: &'a Glb, list: &'static str) -> Result<Member<'a>, ReadError> {
        glb.element(list, self.whole()?, &self.name)
    }

    /// The transform of a node.
    fn transform(&self) -> Result<DMat4, ReadError> {
        if let Some(matrix) = self.numbers("matrix")? {
            return Ok(DMat4::from_cols_array(&matrix));
        }
        Ok(DMat4::from_scale_rotation_translation(
            self.numbers("scale")?.map_or(DVec3::ONE, DVec3::from_array),
            self.numbers("rotation")?.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q).normalize()),
            self.numbers("translation")?.map_or(DVec3::ZERO, DVec3::from_array),
        ))
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
    fn of(number: usize) -> Option<Self> {
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
    document: JsonValue,
    binary: &'a [u8],
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
        if depth(text) > DEEPEST {
            let message =
                format!("it is nested deeper than {DEEPEST} levels; export the file without extras");
            return Err(wrong("JSON", message));
        }
        let text =
            core::str::from_utf8(text).map_err(|_| wrong("JSON", "it is not UTF-8; export it again"))?;
        let document = text.trim_end_matches(['\0', ' ']).parse();
        let document = document
            .map_err(|error: tinyjson::JsonParseError| wrong("JSON", format!("{error}; export it again")))?;
        let glb = Self { document, binary };
        let required = glb.root().list("extensionsRequired")?;
        let is_required =
            |name: &str| required.iter().any(|other| other.get().is_some_and(|o: &String| o == name));
        if let Some((extension, advice)) = UNREAD.into_iter().find(|(name, _)| is_required(name)) {
            return Err(wrong("extensionsRequired", format!("{extension} is not read; {advice}")));
        }
        Ok(glb)
    }

    fn root(&self) -> Member<'_> {
        Member { value: &self.document, name: String::new() }
    }

    /// An element of a list of the document, which the member `by` names.
    fn element(&self, list: &'static str, index: usize, by: &str) -> Result<Member<'_>, ReadError> {
        let all = self.root().list(list)?;
        let missing = || wrong(by, format!("it names {list}[{index}], and there are {} {list}", all.len()));
        Ok(Member { value: all.get(index).ok_or_else(missing)?, name: format!("{list}[{index}]") })
    }

    /// The rows of the accessor that a number names, each of so many numbers.
    fn rows(&self, number: &Member, components: usize) -> Result<Rows<'a>, ReadError> {
        let accessor = number.named(self, "accessors")?;
        let wanted = match components {
            1 => "SCALAR",
            3 => "VEC3",
            _ => "VEC4",
        };
        let kind = accessor.get("type");
        if kind.and_then(|kind| kind.value.get::<String>()).is_none_or(|kind| kind != wanted) {
            return Err(accessor.wrong(&format!("its type is not {wanted}, which {} needs", number.name)));
        }
        let number = accessor.needed("componentType")?;
        let Some(kind) = Kind::of(number) else {
            return Err(accessor.wrong(&format!("componentType {number} is none of glTF 2.0")));
        };
        let (None, Some(view)) = (accessor.get("sparse"), accessor.get("bufferView")) else {
            return Err(accessor.wrong("sparse accessors are not read; export the file without"));
        };
        let view = view.named(self, "bufferViews")?;
        let number = view.needed("buffer")?;
        let buffer = self.element("buffers", number, &view.name)?;
        if number != 0 || buffer.get("uri").is_some() {
            return Err(buffer.wrong("its numbers are in another file; export the mesh as one .glb file"));
        }
        let size = components * kind.bytes();
        let stride = view.whole_at("byteStride")?.unwrap_or(size).max(size);
        let count = accessor.needed("count")?;
        let rows = count.checked_sub(1).map_or(Some(0), |steps| steps.checked_mul(stride)?.checked_add(size));
        let lies_within = |bytes: &'a [u8], from: Option<usize>, length: usize| {
            bytes.get(from.unwrap_or(0)..)?.get(..length)
        };
        let bytes = lies_within(self.binary, view.whole_at("byteOffset")?, view.needed("byteLength")?);
        let from = accessor.whole_at("byteOffset")?;
        let Some(bytes) = bytes.zip(rows).and_then(|(bytes, rows)| lies_within(bytes, from, rows)) else {
            let message = format!("its {count} rows do not fit into the buffer; export the file again");
            return Err(accessor.wrong(&message));
        };
        let normalized = accessor.get("normalized").is_some_and(|is| is.value.get() == Some(&true));
        Ok(Rows { bytes, stride, count, kind, normalized })
    }

    /// The rows of an accessor of colours, with three or four numbers each.
    fn colours(&self, number: &Member) -> Result<Rows<'a>, ReadError> {
        let kind = number.named(self, "accessors")?.get("type");
        let has_alpha =
            kind.is_some_and(|kind| kind.value.get::<String>().is_some_and(|kind| kind == "VEC4"));
        self.rows(number, if has_alpha { 4 } else { 3 })
    }

    /// The meshes of the scene with their transforms.
    fn placed(&self) -> Result<Vec<(Member<'_>, DMat4)>, ReadError> {
        let (nodes, root) = (self.root().list("nodes")?, self.root());
        // A library of meshes has no nodes.
        if nodes.is_empty() {
            let meshes = 0..root.list("meshes")?.len();
            return meshes.map(|mesh| Ok((self.element("meshes", mesh, "")?, DMat4::IDENTITY))).collect();
        }
        let numbers = |member: &Member, key: &str| -> Result<Vec<usize>, ReadError> {
            let name = format!("{}.{key}", member.name);
            let numbers = member.list(key)?.iter();
            numbers.map(|value| Member { value, name: name.clone() }.whole()).collect()
        };
        let roots = if root.list("scenes")?.is_empty() {
            let mut is_child = vec![false; nodes.len()];
            for node in 0..nodes.len() {
                for child in numbers(&self.element("nodes", node, "")?, "children")? {
                    if let Some(is_child) = is_child.get_mut(child) {
                        *is_child = true;
                    }
                }
            }
            (0..nodes.len()).filter(|&node| !is_child[node]).collect()
        } else {
            let scene = root.whole_at("scene")?.unwrap_or(0);
            numbers(&self.element("scenes", scene, "scene")?, "nodes")?
        };
        let mut stack: Vec<(usize, DMat4)> =
            roots.iter().rev().map(|&node| (node, DMat4::IDENTITY)).collect();
        let (mut placed, mut is_seen) = (Vec::new(), vec![false; nodes.len()]);
        while let Some((index, outer)) = stack.pop() {
            let node = self.element("nodes", index, "a scene or a node")?;
            if core::mem::replace(&mut is_seen[index], true) {
                return Err(node.wrong("two nodes, or itself, have it as a child; export the file again"));
            }
            let transform = outer * node.transform()?;
            if let Some(mesh) = node.get("mesh") {
                placed.push((mesh.named(self, "meshes")?, transform));
            }
            stack.extend(numbers(&node, "children")?.into_iter().rev().map(|child| (child, transform)));
        }
        Ok(placed)
    }
}

/// Reads the points and triangles of the scene.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let glb = Glb::open(input.rest())?;
    let mut parts = Vec::new();
    let mut left_out = 0;
    for (of_mesh, transform) in glb.placed()? {
        for (k, value) in of_mesh.list("primitives")?.iter().enumerate() {
            let primitive = Member { value, name: format!("{}.primitives[{k}]", of_mesh.name) };
            let mode = primitive.whole_at("mode")?.unwrap_or(TRIANGLES);
            if matches!(mode, POINTS | TRIANGLES | TRIANGLE_STRIP | TRIANGLE_FAN) {
                parts.push(Part { glb: &glb, primitive, transform, mode });
            } else {
                left_out += 1;
            }
        }
    }
    // Normals count if every part has them.
    let has_normals = parts.iter().all(|part| part.attribute("NORMAL").is_some());
    for part in parts {
        part.read(input, mesh, has_normals).await?;
    }
    if left_out > 0 {
        mesh.warnings.push(format!("{left_out} parts of the file that are lines were left out."));
    }
    Ok(())
}

/// The sRGB value of a linear share of light (IEC 61966-2-1).
fn srgb(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 }
}

/// A primitive in its place.
struct Part<'a> {
    glb: &'a Glb<'a>,
    primitive: Member<'a>,
    transform: DMat4,
    mode: usize,
}

impl Part<'_> {
    fn attribute(&self, name: &str) -> Option<Member<'_>> {
        self.primitive.get("attributes")?.get(name)
    }

    async fn read(
        &self,
        input: &mut Input<'_>,
        mesh: &mut FileMesh,
        has_normals: bool,
    ) -> Result<(), ReadError> {
        let Self { glb, primitive, transform, mode } = self;
        let Some(position) = self.attribute("POSITION") else {
            return Err(primitive.wrong("it has no positions; export the file again"));
        };
        let positions = glb.rows(&position, 3)?;
        let normal = self.attribute("NORMAL").filter(|_| has_normals);
        let normals = normal.map(|normal| glb.rows(&normal, 3)).transpose()?;
        let colours = self.attribute("COLOR_0").map(|colour| glb.colours(&colour)).transpose()?;
        for (rows, what) in [(&normals, "normals"), (&colours, "colours")] {
            if rows.as_ref().is_some_and(|rows| rows.count != positions.count) {
                let message =
                    format!("it has another number of {what} than of positions; export the file again");
                return Err(primitive.wrong(&message));
            }
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
            if let Some(colours) = &colours {
                mesh.add_colour([0, 1, 2].map(|k| srgb(colours.number(i, k))))?;
            }
            input.end_row().await;
        }
        if *mode == POINTS {
            return Ok(());
        }
        let indices = primitive.get("indices").map(|indices| glb.rows(&indices, 1)).transpose()?;
        let count = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let corner = |k: usize| {
            let corner = indices.as_ref().map_or(k as f64, |indices| indices.number(k, 0));
            let is_there = corner >= 0.0 && corner < positions.count as f64;
            let message = || format!("index {k} is {corner}, and there are {} positions", positions.count);
            is_there.then_some(first + corner as u32).ok_or_else(|| primitive.wrong(&message()))
        };
        let triangles = if *mode == TRIANGLES { count / 3 } else { count.saturating_sub(2) };
        for f in 0..triangles {
            let [a, b, c] = match *mode {
                TRIANGLES => [3 * f, 3 * f + 1, 3 * f + 2],
                // Every other triangle of a strip turns the other way.
                TRIANGLE_STRIP => [f, f + 1 + f % 2, f + 2 - f % 2],
                _ => [f + 1, f + 2, 0],
            };
            let (a, b, c) = (corner(a)?, corner(b)?, corner(c)?);
            mesh.add_polygon(&if is_reflected { [a, c, b] } else { [a, b, c] })?;
            input.end_row().await;
        }
        Ok(())
    }
}
