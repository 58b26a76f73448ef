//! Reader of STL files. Each triangle has its own corners, of which equal ones are merged.

use super::ReadError;
use super::format::{STL_HEADER, STL_TRIANGLE, stl_size};
use super::input::{COMPONENTS, Input, quoted, words};
use super::mesh::FileMesh;
use crate::math::IndexTable;
use crate::pointcloud::thin::find_or_add;
use glam::DVec3;

/// Reads the text format, `facet … outer loop … vertex x y z … endloop … endfacet`.
///
/// The normals of the facets are ignored: many programs write zeros, and the order of the corners
/// determines them.
pub(super) async fn read_text(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let (mut table, mut corners) = (IndexTable::default(), Vec::new());
    while let Some(line) = input.line_with_text() {
        let mut words = words(line);
        let word = words.next().unwrap_or_default().to_ascii_lowercase();
        match word.as_slice() {
            b"vertex" => {
                let p = input.vector(&mut words, &COMPONENTS[..3])?;
                corners.push(find_or_add(&mut table, p, &mut mesh.position).ok_or(ReadError::Memory)?);
            }
            b"endloop" | b"endfacet" => {
                mesh.add_polygon(&corners)?;
                corners.clear();
            }
            b"facet" | b"outer" if !corners.is_empty() => {
                return Err(input.error("a facet begins within another one; export the file again"));
            }
            b"solid" | b"endsolid" | b"facet" | b"outer" => {}
            _ => {
                let word = quoted(&word);
                return Err(input.error(format!("`{word}` is no statement of an STL file; export it again")));
            }
        }
        input.end_row().await;
    }
    if corners.is_empty() {
        Ok(())
    } else {
        Err(input.error("the file ends within a facet; it is cut off: export it again"))
    }
}

/// Reads the binary format: 80 arbitrary bytes, the number of triangles, and for each triangle a
/// normal, three corners and two bytes of attributes.
pub(super) async fn read_binary(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let claim = |element: &str, count, needed, left| {
        Err(ReadError::Claim { element: element.to_owned(), count, needed, left })
    };
    let whole = input.remaining() as u64;
    let Some(size) = input.take(STL_HEADER).and_then(stl_size) else {
        return claim("header", 1, STL_HEADER as u64, whole);
    };
    let (needed, left) = (size - STL_HEADER as u64, input.remaining() as u64);
    let count = needed / STL_TRIANGLE as u64;
    if needed > left {
        return claim("triangle", count, needed, left);
    }
    let mut table = IndexTable::default();
    input.begin_records("triangle");
    for _ in 0..count {
        input.begin_record();
        let record = input.take(STL_TRIANGLE).unwrap_or_default();
        let mut corners = [0; 3];
        // Bytes 0 to 11 are the normal.
        for (corner, coordinates) in corners.iter_mut().zip(record[12..48].as_chunks::<12>().0) {
            let mut p = DVec3::ZERO;
            for (k, &bytes) in coordinates.as_chunks().0.iter().enumerate() {
                p[k] = input.coordinate(f32::from_le_bytes(bytes).into(), COMPONENTS[k])?;
            }
            *corner = find_or_add(&mut table, p, &mut mesh.position).ok_or(ReadError::Memory)?;
        }
        mesh.add_polygon(&corners)?;
        input.end_row().await;
    }
    Ok(())
}
