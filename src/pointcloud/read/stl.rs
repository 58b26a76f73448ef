//! Reader of STL files. Each triangle has corners of its own, of which equal ones are merged.

use super::format::{STL_HEADER, STL_TRIANGLE, stl_size};
use super::input::{Input, coordinate, coordinate_word, quoted, words};
use super::mesh::FileMesh;
use super::{ReadError, RowReader};
use crate::math::IndexTable;
use crate::pointcloud::thin::find_or_add;
use glam::DVec3;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Reader of the text format, `facet … outer loop … vertex x y z … endloop … endfacet`.
///
/// The normals of the facets are ignored: many programs write zeros, and the order of the corners gives them.
#[derive(Default)]
pub(super) struct TextStl {
    table: IndexTable,
    corners: Vec<u32>,
}

impl RowReader for TextStl {
    fn row(&mut self, input: &mut Input, mesh: &mut FileMesh) -> Result<bool, ReadError> {
        let Some(range) = input.line_with_text() else {
            if self.corners.is_empty() {
                return Ok(false);
            }
            return Err(input.line_error("the file ends within a facet; it is cut off: export it again"));
        };
        let line = input.slice(range);
        let mut words = words(line);
        let word = words.next().unwrap_or_default().to_ascii_lowercase();
        match word.as_slice() {
            b"vertex" => {
                let mut p = DVec3::ZERO;
                for (k, axis) in AXES.iter().enumerate() {
                    let word = words
                        .next()
                        .ok_or_else(|| input.line_error("a vertex takes three numbers, x y z"))?;
                    p[k] = coordinate_word(word, axis).map_err(|message| input.line_error(message))?;
                }
                let corner = find_or_add(&mut self.table, p, &mut mesh.position).ok_or(ReadError::Memory)?;
                self.corners.push(corner);
            }
            b"endloop" | b"endfacet" => {
                mesh.add_polygon(&self.corners)?;
                self.corners.clear();
            }
            b"facet" | b"outer" if !self.corners.is_empty() => {
                return Err(input.line_error("a facet begins within another one; export the file again"));
            }
            b"solid" | b"endsolid" | b"facet" | b"outer" => {}
            _ => {
                let word = quoted(&word);
                return Err(
                    input.line_error(format!("`{word}` is no statement of an STL file; export it again"))
                );
            }
        }
        Ok(true)
    }
}

/// Reader of the binary format: 80 arbitrary bytes, the number of triangles, and for each triangle a normal, three
/// corners and two bytes of attributes.
pub(super) struct BinaryStl {
    table: IndexTable,
    row: u64,
    count: u64,
}

impl BinaryStl {
    pub(super) fn new(input: &mut Input) -> Result<Self, ReadError> {
        let header = input.slice(0..input.remaining().min(STL_HEADER)).to_vec();
        let Some(size) = stl_size(&header) else {
            return Err(ReadError::Claim {
                element: "header".into(),
                count: 1,
                needed: STL_HEADER as u64,
                left: header.len() as u64,
            });
        };
        input.skip(STL_HEADER as u64);
        let count = (size - STL_HEADER as u64) / STL_TRIANGLE as u64;
        let (needed, left) = (count * STL_TRIANGLE as u64, input.remaining() as u64);
        if needed > left {
            return Err(ReadError::Claim { element: "triangle".into(), count, needed, left });
        }
        Ok(Self { table: IndexTable::default(), row: 0, count })
    }
}

impl RowReader for BinaryStl {
    fn row(&mut self, input: &mut Input, mesh: &mut FileMesh) -> Result<bool, ReadError> {
        let byte = input.offset() as u64;
        if self.row == self.count {
            return Ok(false);
        }
        self.row += 1;
        let record = input.take::<STL_TRIANGLE>().unwrap_or([0; STL_TRIANGLE]);
        let mut corners = [0; 3];
        // Bytes 0 to 11 are the normal.
        for (corner, bytes) in corners.iter_mut().zip(record[12..48].chunks_exact(12)) {
            let mut p = DVec3::ZERO;
            for (k, bytes) in bytes.chunks_exact(4).enumerate() {
                let value = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                p[k] = coordinate(value.into(), AXES[k]).map_err(|message| ReadError::Row {
                    element: "triangle".into(),
                    row: self.row,
                    byte,
                    message,
                })?;
            }
            *corner = find_or_add(&mut self.table, p, &mut mesh.position).ok_or(ReadError::Memory)?;
        }
        mesh.add_polygon(&corners)?;
        Ok(true)
    }
}
