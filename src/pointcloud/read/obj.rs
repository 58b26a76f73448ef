//! Reader of OBJ files (Wavefront, "Object Files", appendix B1). It reads the statements `v`, `vn` and `f` and skips
//! all others.

use super::input::{Input, coordinate_word, quoted, words};
use super::mesh::FileMesh;
use super::{ReadError, RowReader, push};
use glam::DVec3;

#[derive(Default)]
pub(super) struct Obj {
    normals: Vec<DVec3>,
    /// Corners of the current face.
    corners: Vec<u32>,
    has_corner_normals: bool,
    has_faces: bool,
}

impl RowReader for Obj {
    fn row(&mut self, input: &mut Input, mesh: &mut FileMesh) -> Result<bool, ReadError> {
        let Some(range) = input.line() else {
            self.finish(mesh);
            return Ok(false);
        };
        if !input.slice(range.clone()).ends_with(b"\\") {
            return self.statement(input.slice(range), input, mesh).map(|()| true);
        }
        // A backslash continues the statement on the next line.
        let mut whole = Vec::new();
        let mut next = Some(range);
        while let Some(range) = next {
            let line = input.slice(range);
            let continues = line.ends_with(b"\\");
            whole.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
            whole.push(b' ');
            next = if continues { input.line() } else { None };
        }
        self.statement(&whole, input, mesh).map(|()| true)
    }
}

impl Obj {
    fn statement(&mut self, line: &[u8], input: &Input, mesh: &mut FileMesh) -> Result<(), ReadError> {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let mut words = words(line);
        match words.next() {
            Some(b"v") => push(&mut mesh.position, vector(words, ["x", "y", "z"], input)?),
            Some(b"vn") => push(&mut self.normals, vector(words, ["nx", "ny", "nz"], input)?),
            Some(b"f") => self.face(words, input, mesh),
            _ => Ok(()),
        }
    }

    fn face<'a>(
        &mut self,
        words: impl Iterator<Item = &'a [u8]>,
        input: &Input,
        mesh: &mut FileMesh,
    ) -> Result<(), ReadError> {
        self.corners.clear();
        self.has_faces = true;
        for word in words {
            // A corner is v, v/vt, v//vn or v/vt/vn.
            let mut parts = word.split(|&byte| byte == b'/');
            let part = parts.next().unwrap_or_default();
            let corner = index(part, mesh.position.len(), "vertex", input)?;
            self.corners.push(corner);
            if let Some(part) = parts.nth(1).filter(|part| !part.is_empty()) {
                let normal = index(part, self.normals.len(), "normal", input)?;
                self.has_corner_normals = true;
                pad_normals(mesh)?;
                mesh.normal[corner as usize] += self.normals[normal as usize].normalize_or_zero();
            }
        }
        mesh.add_polygon(&self.corners)
    }

    fn finish(&mut self, mesh: &mut FileMesh) {
        if self.has_corner_normals {
            mesh.normal.resize(mesh.position.len(), DVec3::ZERO);
        } else if !self.has_faces && self.normals.len() == mesh.position.len() {
            // In a file without faces the normals belong to the points in order.
            mesh.normal = core::mem::take(&mut self.normals);
        }
    }
}

/// Pads the normals with zeros to the number of positions.
fn pad_normals(mesh: &mut FileMesh) -> Result<(), ReadError> {
    let missing = mesh.position.len() - mesh.normal.len();
    if missing > 0 {
        mesh.normal.try_reserve(missing).map_err(|_| ReadError::Memory)?;
        mesh.normal.resize(mesh.position.len(), DVec3::ZERO);
    }
    Ok(())
}

fn vector<'a>(
    mut words: impl Iterator<Item = &'a [u8]>,
    names: [&str; 3],
    input: &Input,
) -> Result<DVec3, ReadError> {
    let mut vector = DVec3::ZERO;
    for (k, name) in names.into_iter().enumerate() {
        let word = words
            .next()
            .ok_or_else(|| input.line_error(format!("three numbers are needed, {name} is missing")))?;
        vector[k] = coordinate_word(word, name).map_err(|message| input.line_error(message))?;
    }
    Ok(vector)
}

/// Index from 0 of the `word`, which counts from 1, or backwards from −1, among `count` items called `what`.
fn index(word: &[u8], count: usize, what: &str, input: &Input) -> Result<u32, ReadError> {
    let written = core::str::from_utf8(word).ok().and_then(|word| word.parse::<i64>().ok());
    let Some(written) = written else {
        let word = quoted(word);
        return Err(input.line_error(format!(
            "`{word}` is no number of a {what}; a face is like `f 1 2 3` or `f 1//1 2//1 3//1`"
        )));
    };
    let count = count as i64;
    let index = if written < 0 { count.saturating_add(written) } else { written - 1 };
    if (0..count).contains(&index) && index < i64::from(u32::MAX) {
        Ok(index as u32)
    } else {
        Err(input.line_error(format!("the face has {what} {written}, and {count} stand before this line")))
    }
}
