//! Reader of OBJ files (Wavefront, "Object Files", appendix B1). It reads the statements `v`, `vn`
//! and `f` and skips all others.

use super::input::{COMPONENTS, Input, number, quoted, words};
use super::mesh::FileMesh;
use super::{ReadError, push};
use glam::DVec3;
use std::borrow::Cow;

/// Reads the statements of the file.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    // The normals of the file, to which faces refer, and the corners of a face.
    let (mut normals, mut corners) = (Vec::new(), Vec::new());
    let mut has_faces = false;
    while let Some(line) = input.line() {
        let mut line = Cow::Borrowed(line);
        // A backslash continues a statement on the next line, but not a comment.
        while line.ends_with(b"\\") && !line.contains(&b'#') {
            let line = line.to_mut();
            line.pop();
            line.push(b' ');
            line.extend_from_slice(input.line().unwrap_or_default());
        }
        let statement = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let mut words = words(statement);
        match words.next() {
            Some(b"v") => {
                push(&mut mesh.position, input.vector(&mut words, &COMPONENTS[..3])?)?;
                // Some programs write the colour of a vertex after its place.
                let mut rest = words.map(number);
                if let [Some(Some(red)), Some(Some(green)), Some(Some(blue)), None] =
                    [(); 4].map(|()| rest.next())
                {
                    mesh.add_colour([red, green, blue])?;
                }
            }
            Some(b"vn") => push(&mut normals, input.vector(&mut words, &COMPONENTS[3..])?)?,
            Some(b"f") => {
                has_faces = true;
                corners.clear();
                for word in words {
                    // A corner is v, v/vt, v//vn or v/vt/vn.
                    let mut parts = word.split(|&byte| byte == b'/');
                    let corner =
                        index(parts.next().unwrap_or_default(), mesh.position.len(), "vertex", input)?;
                    corners.push(corner);
                    if let Some(part) = parts.nth(1).filter(|part| !part.is_empty()) {
                        let normal = normals[index(part, normals.len(), "normal", input)? as usize];
                        mesh.pad_normals()?;
                        mesh.normal[corner as usize] += DVec3::normalize_or_zero(normal);
                    }
                }
                mesh.add_polygon(&corners)?;
            }
            _ => {}
        }
        input.end_row().await;
    }
    if !mesh.normal.is_empty() {
        mesh.pad_normals()?;
    } else if !has_faces && normals.len() == mesh.position.len() {
        // Without faces the normals belong to the points in order.
        mesh.normal = normals;
    }
    Ok(())
}

/// The index from 0 that `word` stands for. It counts from 1, or backwards from −1, among `count`
/// items called `what`.
fn index(word: &[u8], count: usize, what: &str, input: &Input) -> Result<u32, ReadError> {
    let written = core::str::from_utf8(word).ok().and_then(|word| word.parse::<i64>().ok());
    let Some(written) = written else {
        let word = quoted(word);
        return Err(input.error(format!(
            "`{word}` is no number of a {what}; a face is like `f 1 2 3` or `f 1//1 2//1 3//1`"
        )));
    };
    let count = count as i64;
    let index = if written < 0 { count.saturating_add(written) } else { written - 1 };
    if (0..count).contains(&index) && index < i64::from(u32::MAX) {
        Ok(index as u32)
    } else {
        Err(input.error(format!("the face has {what} {written}, and {count} stand before this line")))
    }
}
