//! Reader of 3MF files (3MF Consortium, "3D Manufacturing Format, Core Specification" 1.3, and the
//! paths of its "Production Extension"): the triangles of all objects that the file builds, each
//! where its items and components place it, in the unit of the file.
//!
//! A file is a ZIP archive (PKWARE, APPNOTE 6.3) of XML documents.

use super::input::Input;
use super::mesh::FileMesh;
use super::{ReadError, wrong};
use crate::slices::{MEDIUM, pause};
use flate2::bufread::DeflateDecoder;
use glam::{DMat4, DVec3};
use std::collections::BTreeMap;
use std::io::Read;

/// Bytes with which a file begins.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";

/// Deepest nesting of components.
const DEEPEST: usize = 32;
/// Most placed objects. Objects of objects may multiply without end.
const MOST_PLACED: usize = 100_000;
/// Most placed triangles.
const MOST_TRIANGLES: usize = 20_000_000;
/// Most bytes that one byte of deflate expands to (P. Deutsch, RFC 1951, 1996).
const MOST_FROM_A_BYTE: usize = 1032;
/// Units by their names, in millimetres.
const UNITS: [(&str, f64); 6] = [
    ("micron", 1e-3),
    ("millimeter", 1.0),
    ("centimeter", 10.0),
    ("inch", 25.4),
    ("foot", 304.8),
    ("meter", 1e3),
];

/// Reads all objects that the file builds.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let bytes = input.rest();
    let mut models = BTreeMap::new();
    let mut start = None;
    for entry in entries(bytes)? {
        if entry.name.to_ascii_lowercase().ends_with(".model") {
            let model = Model::read(&entry.name, &entry.unpacked(bytes)?).await?;
            models.insert(key_of(&entry.name), model);
        } else if entry.name == "_rels/.rels" {
            start = start_of(&entry.unpacked(bytes)?)?;
        }
    }
    let start = start.unwrap_or_else(|| "3d/3dmodel.model".to_owned());
    let Some(root) = models.get(&start) else {
        return Err(wrong("archive", "it holds no model as 3MF files do; choose a file of a mesh"));
    };
    if root.unit.0 != "millimeter" {
        mesh.warnings.push(format!("The unit of this file is the {}.", root.unit.0));
    }
    let items = root.items.iter().rev();
    let mut open: Vec<(Use, DMat4, usize)> = items.map(|item| (item.clone(), DMat4::IDENTITY, 0)).collect();
    let mut placed = 0;
    while let Some((used, outer, depth)) = open.pop() {
        let path = used.path.as_ref().unwrap_or(&start);
        let name = format!("object {}", used.object);
        let model = models.get(path).ok_or_else(|| wrong(&*name, format!("there is no file {path}")))?;
        let Some(object) = model.objects.get(&used.object) else {
            return Err(wrong(name, "the file uses it and does not hold it; export the file again"));
        };
        placed += 1;
        if depth > DEEPEST || placed > MOST_PLACED {
            return Err(wrong(name, "its components nest too deep, or are too many; export the file again"));
        }
        let within = outer * used.transform;
        let scale = model.unit.1 / root.unit.1;
        object.add(&name, within * DMat4::from_scale(DVec3::splat(scale)), mesh).await?;
        for part in object.components.iter().rev() {
            let path = part.path.clone().or_else(|| Some(path.clone()));
            open.push((Use { path, ..part.clone() }, within, depth + 1));
        }
    }
    Ok(())
}

/// The path of a file in an archive, for comparisons.
fn key_of(path: &str) -> String {
    path.trim_start_matches('/').to_ascii_lowercase()
}

/// A file in the archive.
struct Entry {
    name: String,
    /// Where its header begins, and its size before and after it is unpacked.
    first: usize,
    packed: usize,
    size: usize,
    method: u16,
}

/// The directory of an archive.
fn entries(bytes: &[u8]) -> Result<Vec<Entry>, ReadError> {
    /// Bytes of the record at the end, and of each row of the directory, without what varies.
    const END: usize = 22;
    const ROW: usize = 46;
    let cut_off = || wrong("archive", "the file is cut off or damaged; export it again");
    let last = bytes.len().checked_sub(END).ok_or_else(cut_off)?;
    // A comment of up to 64 KiB may follow.
    let end = (last.saturating_sub(0xffff)..=last).rev().find(|&at| bytes[at..].starts_with(b"PK\x05\x06"));
    let end = end.ok_or_else(cut_off)?;
    let count = short(bytes, end + 10).ok_or_else(cut_off)?;
    let mut at = word(bytes, end + 16).ok_or_else(cut_off)?;
    let mut found = Vec::new();
    for _ in 0..count {
        let row = bytes.get(at..).filter(|row| row.starts_with(b"PK\x01\x02")).ok_or_else(cut_off)?;
        let (Some(flags), Some(method), Some(packed), Some(size)) =
            (short(row, 8), short(row, 10), word(row, 20), word(row, 24))
        else {
            return Err(cut_off());
        };
        let lengths = [28, 30, 32].map(|at| short(row, at).map_or(0, usize::from));
        let name = row.get(ROW..ROW + lengths[0]).ok_or_else(cut_off)?;
        let name = String::from_utf8_lossy(name).replace('\\', "/");
        if flags & 1 != 0 {
            return Err(wrong(name, "it is encrypted; export the file without a password"));
        }
        let first = word(row, 42).ok_or_else(cut_off)?;
        found.push(Entry { name, first, packed, size, method });
        at += ROW + lengths.iter().sum::<usize>();
    }
    Ok(found)
}

fn short(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|&two| u16::from_le_bytes(two))
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..)?.first_chunk().map(|&four| u32::from_le_bytes(four) as usize)
}

impl Entry {
    fn unpacked(&self, bytes: &[u8]) -> Result<Vec<u8>, ReadError> {
        /// Bytes of the header in front of the content, without its two names.
        const HEADER: usize = 30;
        let wrong = |message: &str| wrong(&*self.name, message);
        let from = short(bytes, self.first.saturating_add(26))
            .zip(short(bytes, self.first.saturating_add(28)))
            .map(|(name, extra)| self.first + HEADER + usize::from(name) + usize::from(extra));
        let packed = from.and_then(|from| bytes.get(from..)?.get(..self.packed));
        let packed = packed.ok_or_else(|| wrong("the file is cut off; export it again"))?;
        if self.method == 0 {
            return Ok(packed.to_vec());
        }
        if self.method != 8 {
            return Err(wrong("it is compressed in an unusual way; export the file again"));
        }
        let most = self.size.min(self.packed.saturating_mul(MOST_FROM_A_BYTE));
        let mut content = Vec::new();
        content.try_reserve_exact(most).map_err(|_| ReadError::Memory)?;
        let read = DeflateDecoder::new(packed).take(most as u64).read_to_end(&mut content);
        match read {
            Ok(count) if count == self.size => Ok(content),
            _ => Err(wrong("it is damaged and cannot be unpacked; export the file again")),
        }
    }
}

/// The tags of an XML document, in order.
struct Tags<'a> {
    name: &'a str,
    text: &'a str,
    at: usize,
}

/// A tag: its name without a prefix, its attributes, and how it begins and ends.
struct Tag<'a> {
    name: &'a str,
    attributes: &'a str,
    is_end: bool,
    is_empty: bool,
}

impl<'a> Tags<'a> {
    fn new(name: &'a str, bytes: &'a [u8]) -> Result<Self, ReadError> {
        let text = core::str::from_utf8(bytes);
        let text = text.map_err(|_| wrong(name, "it is no text in UTF-8; export the file again"))?;
        Ok(Self { name, text, at: 0 })
    }

    fn wrong(&self, message: &str) -> ReadError {
        wrong(format!("{}, byte {}", self.name, self.at), message)
    }

    /// The next tag; none at the end.
    fn next(&mut self) -> Result<Option<Tag<'a>>, ReadError> {
        loop {
            let Some(begin) = self.text[self.at..].find('<') else { return Ok(None) };
            self.at += begin;
            let rest = &self.text[self.at..];
            let skipped = [("<!--", "-->"), ("<?", "?>"), ("<![CDATA[", "]]>")];
            if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
                let end = rest.find(end).map(|at| at + end.len());
                self.at += end.ok_or_else(|| self.wrong("this does not end; export the file again"))?;
                continue;
            }
            if rest.starts_with("<!") {
                return Err(
                    self.wrong("documents of 3MF have no declarations of types; export the file again")
                );
            }
            let mut quote = None;
            let end = rest.bytes().position(|byte| {
                match quote {
                    Some(open) if byte == open => quote = None,
                    None if matches!(byte, b'"' | b'\'') => quote = Some(byte),
                    None => return byte == b'>',
                    Some(_) => {}
                }
                false
            });
            let end = end.ok_or_else(|| self.wrong("this tag does not end; export the file again"))?;
            let inner = &rest[1..end];
            self.at += end + 1;
            let is_end = inner.starts_with('/');
            let inner = inner.strip_prefix('/').unwrap_or(inner);
            let is_empty = inner.ends_with('/');
            let inner = inner.strip_suffix('/').unwrap_or(inner);
            let (name, attributes) =
                inner.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((inner, ""));
            return Ok(Some(Tag { name: local(name), attributes, is_end, is_empty }));
        }
    }
}

fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, local)| local)
}

impl<'a> Tag<'a> {
    /// The attribute of this name, whatever its prefix.
    fn get(&self, wanted: &str) -> Option<&'a str> {
        let mut rest = self.attributes;
        loop {
            let (name, after) = rest.split_once('=')?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            let (value, next) = after[1..].split_once(quote)?;
            if local(name.trim()) == wanted {
                return Some(value);
            }
            rest = next;
        }
    }
}

/// An object in its place.
#[derive(Clone)]
struct Use {
    /// The file that holds the object; none for the present one.
    path: Option<String>,
    object: u32,
    transform: DMat4,
}

#[derive(Default)]
struct Object {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    components: Vec<Use>,
}

/// A document with objects.
struct Model {
    unit: (&'static str, f64),
    objects: BTreeMap<u32, Object>,
    items: Vec<Use>,
}

impl Model {
    async fn read(name: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        let mut tags = Tags::new(name, bytes)?;
        let mut model = Self { unit: UNITS[1], objects: BTreeMap::new(), items: Vec::new() };
        let mut object: Option<(u32, Object)> = None;
        let mut count = 0;
        while let Some(tag) = tags.next()? {
            count += 1;
            if count % MEDIUM == 0 {
                pause().await;
            }
            match (tag.name, &mut object) {
                ("object", _) if tag.is_end => model.objects.extend(object.take()),
                _ if tag.is_end => {}
                ("model", _) => {
                    let unit = tag.get("unit").unwrap_or("millimeter");
                    let known = UNITS.iter().find(|known| known.0 == unit);
                    let message = || tags.wrong(&format!("the unit {unit} is none of 3MF"));
                    model.unit = *known.ok_or_else(message)?;
                }
                ("object", _) => {
                    let own = (number(&tags, &tag, "id")?, Object::default());
                    if tag.is_empty { model.objects.extend([own]) } else { object = Some(own) }
                }
                ("vertex", Some((_, object))) => {
                    let [x, y, z] = ["x", "y", "z"].map(|axis| number(&tags, &tag, axis));
                    super::push(&mut object.vertices, DVec3::new(x?, y?, z?))?;
                }
                ("triangle", Some((_, object))) => {
                    let [a, b, c] = ["v1", "v2", "v3"].map(|corner| number(&tags, &tag, corner));
                    let corners = [a?, b?, c?];
                    if corners.iter().any(|&corner: &u32| corner as usize >= object.vertices.len()) {
                        let count = object.vertices.len();
                        return Err(
                            tags.wrong(&format!("{corners:?} is a triangle, and there are {count} vertices"))
                        );
                    }
                    super::push(&mut object.triangles, corners)?;
                }
                ("component", Some((_, object))) => object.components.push(used(&tags, &tag)?),
                ("item", None) => model.items.push(used(&tags, &tag)?),
                _ => {}
            }
        }
        Ok(model)
    }
}

/// An attribute that is a number and has to be there.
fn number<T: core::str::FromStr>(tags: &Tags, tag: &Tag, name: &str) -> Result<T, ReadError> {
    let value = tag.get(name).ok_or_else(|| tags.wrong(&format!("<{}> has no {name}", tag.name)))?;
    value.trim().parse().map_err(|_| tags.wrong(&format!("{name}=\"{value}\" is no such number")))
}

/// The object that an item or a component places.
fn used(tags: &Tags, tag: &Tag) -> Result<Use, ReadError> {
    let transform = match tag.get("transform") {
        None => DMat4::IDENTITY,
        Some(text) => {
            let numbers: Vec<f64> = text.split_ascii_whitespace().filter_map(|n| n.parse().ok()).collect();
            let Ok([a, b, c, d, e, f, g, h, i, x, y, z]) = <[f64; 12]>::try_from(numbers) else {
                return Err(tags.wrong("a transform has 12 numbers; export the file again"));
            };
            DMat4::from_cols_array(&[a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0, x, y, z, 1.0])
        }
    };
    Ok(Use { path: tag.get("path").map(key_of), object: number(tags, tag, "objectid")?, transform })
}

/// The path of the model to begin with.
fn start_of(bytes: &[u8]) -> Result<Option<String>, ReadError> {
    let mut tags = Tags::new("_rels/.rels", bytes)?;
    while let Some(tag) = tags.next()? {
        if tag.name == "Relationship" && tag.get("Type").is_some_and(|kind| kind.ends_with("/3dmodel")) {
            return Ok(tag.get("Target").map(key_of));
        }
    }
    Ok(None)
}

impl Object {
    /// Adds the triangles in their place.
    async fn add(&self, name: &str, place: DMat4, mesh: &mut FileMesh) -> Result<(), ReadError> {
        if mesh.faces.len() + self.triangles.len() > MOST_TRIANGLES {
            return Err(wrong(name, "the file builds more than 20 million triangles; simplify it first"));
        }
        let first = u32::try_from(mesh.position.len()).map_err(|_| ReadError::Memory)?;
        for vertices in self.vertices.chunks(MEDIUM) {
            for &vertex in vertices {
                let p = place.transform_point3(vertex);
                mesh.add_point([p.x, p.y, p.z, 0.0, 0.0, 0.0], false)?;
            }
            pause().await;
        }
        // A reflection turns a surface inside out.
        let is_reflected = place.determinant() < 0.0;
        for triangles in self.triangles.chunks(MEDIUM) {
            for corners in triangles {
                let [a, b, c] = corners.map(|corner| first + corner);
                mesh.add_polygon(&if is_reflected { [a, c, b] } else { [a, b, c] })?;
            }
            pause().await;
        }
        Ok(())
    }
}
