//! 3MF: a mesh for printers, with its unit.
//!
//! The specification is the 3MF Consortium's, "3D Manufacturing Format, Core Specification" 1.3. A
//! file is a ZIP archive of an XML document and two that refer to it. The entries are not
//! compressed, which every reader accepts: compression would need several times as much code.

use super::placement::{Placement, Unit};
use super::record::RecordText;
use super::vertices::Indexed;
use crate::particles::Particles;
use std::fmt::Write as _;
use std::io::{self, Write};

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// Writes the triangles and vertices. Without triangles the model contains no object.
pub(super) fn write(
    particles: &Particles,
    vertices: &Indexed,
    placement: &Placement,
    record: &RecordText,
    out: &mut dyn Write,
) -> io::Result<()> {
    let model = model(particles, vertices, placement.unit.unwrap_or(Unit::Millimetre), record);
    let mut archive = Archive { out, directory: Vec::new(), entries: 0, length: 0 };
    for (name, content) in [
        ("[Content_Types].xml", CONTENT_TYPES),
        ("_rels/.rels", RELATIONSHIPS),
        ("3D/3dmodel.model", model.as_str()),
    ] {
        archive.add(name, content.as_bytes())?;
    }
    archive.end()
}

fn model(particles: &Particles, vertices: &Indexed, unit: Unit, record: &RecordText) -> String {
    let mut text = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="{}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><metadata name="Application">Marching Particles</metadata>"#,
        unit.name()
    );
    if let Some(words) = record.words() {
        text += &format!(r#"<metadata name="Description">{words}</metadata>"#);
    }
    if vertices.triangles.is_empty() {
        text += "<resources/><build/></model>";
        return text;
    }
    text += r#"<resources><object id="1" type="model"><mesh><vertices>"#;
    // Writing to memory does not fail.
    for &row in &vertices.rows {
        let [x, y, z] = super::coordinates(particles, row as usize);
        let _ = write!(text, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
    }
    text += "</vertices><triangles>";
    for [a, b, c] in &vertices.triangles {
        let _ = write!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    text += "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
    text
}

/// A ZIP archive of stored entries, as PKWARE's APPNOTE 6.3 describes it.
struct Archive<'a> {
    out: &'a mut dyn Write,
    /// The central directory, which comes last.
    directory: Vec<u8>,
    entries: u16,
    /// Number of bytes that are written.
    length: u32,
}

impl Archive<'_> {
    fn add(&mut self, name: &str, content: &[u8]) -> io::Result<()> {
        let size =
            u32::try_from(content.len()).map_err(|_| io::Error::other("a 3MF file holds up to 4 GiB"))?;
        // Version 2.0, no flags, stored, and the earliest date of the format: the same mesh gives
        // the same file.
        let mut fields = [20_u16, 0, 0, 0, 0x21].map(u16::to_le_bytes).as_flattened().to_vec();
        fields.extend([crc(content), size, size].map(u32::to_le_bytes).as_flattened());
        fields.extend([name.len() as u16, 0].map(u16::to_le_bytes).as_flattened());
        let header = [b"PK\x03\x04".as_slice(), &fields, name.as_bytes()].concat();
        let entry = [b"PK\x01\x02\x14\0".as_slice(), &fields, &[0; 10], &self.length.to_le_bytes()].concat();
        self.directory.extend([entry.as_slice(), name.as_bytes()].concat());
        self.out.write_all(&header)?;
        self.out.write_all(content)?;
        self.entries += 1;
        self.length = (self.length.checked_add(header.len() as u32))
            .and_then(|length| length.checked_add(size))
            .ok_or_else(|| io::Error::other("a 3MF file holds up to 4 GiB"))?;
        Ok(())
    }

    fn end(self) -> io::Result<()> {
        self.out.write_all(&self.directory)?;
        self.out.write_all(b"PK\x05\x06\0\0\0\0")?;
        self.out.write_all([self.entries; 2].map(u16::to_le_bytes).as_flattened())?;
        self.out.write_all(&(self.directory.len() as u32).to_le_bytes())?;
        self.out.write_all(&self.length.to_le_bytes())?;
        self.out.write_all(&[0; 2])
    }
}

/// CRC-32 of ZIP (ISO 3309), from a table with a value per byte.
fn crc(bytes: &[u8]) -> u32 {
    let table: [u32; 256] = core::array::from_fn(|byte| {
        (0..8).fold(byte as u32, |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    });
    !bytes.iter().fold(u32::MAX, |c, &byte| table[(c as u8 ^ byte) as usize] ^ (c >> 8))
}

#[cfg(test)]
mod tests {
    #[test]
    fn check_is_that_of_the_standard() {
        assert_eq!(super::crc(b"123456789"), 0xcbf4_3926);
    }
}
