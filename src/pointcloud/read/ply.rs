//! Reader of PLY files with any elements and properties in any order, as text or binary in either
//! byte order.
//!
//! If a text has as many lines as rows, each row is a line: a line that is too short is an error,
//! and the rest of one that is too long is skipped. Otherwise line breaks mean nothing, and the
//! numbers simply follow each other.

use super::ReadError;
use super::input::{COMPONENTS, Input, number, quoted};
use super::mesh::FileMesh;
use super::ply_header::{self, Element, Encoding, Role, ScalarType};

/// Reads the header and the rows.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let (encoding, elements) = ply_header::read(input)?;
    // Elements after the last one that is used are not read.
    let end = elements.iter().rposition(Element::is_used).map_or(0, |last| last + 1);
    let vertices = elements.iter().find(|element| element.is_vertex()).map_or(0, |vertex| vertex.count);
    let mut corners = Vec::new();
    let rows = elements.iter().filter(|element| !element.properties.is_empty());
    let rows = rows.fold(0_u64, |sum, element| sum.saturating_add(element.count));
    let are_lines = encoding == Encoding::Text && input.lines_with_text() == rows;
    let mut line: &[u8] = b"";
    for element in elements[..end].iter().filter(|element| !element.properties.is_empty()) {
        if encoding != Encoding::Text {
            input.begin_records(&element.name);
        }
        let (has_normal, has_colour) = (element.has_components(3..6), element.has_colour());
        for _ in 0..element.count {
            let left = if are_lines { b"" } else { line };
            let mut row = PlyRow::begin(input, encoding, element, are_lines, left)?;
            let (mut values, mut colour) = ([0.0; COMPONENTS.len()], [1.0; 3]);
            corners.clear();
            for property in &element.properties {
                let count = match property.length {
                    Some(length) => row.length(length, property.scalar)?,
                    None => 1,
                };
                for _ in 0..count {
                    match property.role {
                        Role::Component(k) => {
                            values[k] = row.coordinate(property.scalar, COMPONENTS[k])?;
                        }
                        Role::Colour(k) => colour[k] = row.colour(property.scalar)?,
                        Role::Corners => corners.push(row.corner(property.scalar, vertices)?),
                        Role::Unused => row.skip(property.scalar)?,
                    }
                }
            }
            line = row.line;
            if element.is_vertex() {
                mesh.add_point(values, has_normal)?;
                if has_colour {
                    mesh.add_colour(colour)?;
                }
            }
            mesh.add_polygon(&corners)?;
            input.end_row().await;
        }
    }
    Ok(())
}

/// A row that is read number by number, from words of a line or from bytes.
struct PlyRow<'r, 'a> {
    input: &'r mut Input<'a>,
    encoding: Encoding,
    element: &'r Element,
    /// Whether the row is a line.
    is_line: bool,
    /// The rest of the line.
    line: &'a [u8],
}

impl<'r, 'a> PlyRow<'r, 'a> {
    /// Begins a row. `left` holds the remaining words of the current line.
    fn begin(
        input: &'r mut Input<'a>,
        encoding: Encoding,
        element: &'r Element,
        is_line: bool,
        left: &'a [u8],
    ) -> Result<Self, ReadError> {
        input.begin_record();
        let mut row = Self { input, encoding, element, is_line, line: left };
        if is_line {
            row.take_line()?;
        }
        Ok(row)
    }

    /// Continues with the next line.
    fn take_line(&mut self) -> Result<(), ReadError> {
        let Some(line) = self.input.line_with_text() else {
            return Err(self.input.error(format!(
                "the file ends before all {} {} rows; it is cut off: export it again",
                self.element.count, self.element.name
            )));
        };
        self.line = line;
        Ok(())
    }

    /// The next number as in the file: a word, or bytes.
    fn next(&mut self, scalar: ScalarType) -> Result<&'a [u8], ReadError> {
        if self.encoding != Encoding::Text {
            let cut_off = "the file ends here; it is cut off, or its header is wrong: export it again";
            return self.input.take(scalar.size).ok_or_else(|| self.input.error(cut_off));
        }
        if !self.is_line && self.line.trim_ascii().is_empty() {
            self.take_line()?;
        }
        let line = self.line.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let word;
        (word, self.line) = line.split_at(end);
        if word.is_empty() {
            let name = &self.element.name;
            return Err(self.input.error(format!("this {name} has fewer numbers than the header says")));
        }
        Ok(word)
    }

    /// Consumes a number that is not used.
    fn skip(&mut self, scalar: ScalarType) -> Result<(), ReadError> {
        self.next(scalar).map(drop)
    }

    /// The next number, which is the coordinate `name`.
    fn coordinate(&mut self, scalar: ScalarType, name: &str) -> Result<f64, ReadError> {
        let next = self.next(scalar)?;
        match self.encoding {
            Encoding::Text => self.input.coordinate_of(next, name),
            encoding => self.input.coordinate(scalar.decode(next, encoding), name),
        }
    }

    /// The next number, which is a part of a colour, from 0 to 1.
    fn colour(&mut self, scalar: ScalarType) -> Result<f64, ReadError> {
        Ok(self.number(scalar, "part of a colour")? / scalar.brightest())
    }

    /// The next number; a word that is not a number is an error that names `what` was expected.
    fn number(&mut self, scalar: ScalarType, what: &str) -> Result<f64, ReadError> {
        let next = self.next(scalar)?;
        match self.encoding {
            Encoding::Text => {
                number(next).ok_or_else(|| self.input.error(format!("`{}` is no {what}", quoted(next))))
            }
            encoding => Ok(scalar.decode(next, encoding)),
        }
    }

    /// Length of a list of numbers of type `scalar`.
    fn length(&mut self, length: ScalarType, scalar: ScalarType) -> Result<u64, ReadError> {
        let length = self.number(length, "length of a list")?;
        let left = self.input.remaining();
        if self.encoding == Encoding::Text {
            if !(length >= 0.0 && length.fract() == 0.0) {
                return Err(self.input.error(format!("`{length}` is no length of a list")));
            }
        } else if !(0.0..=left as f64).contains(&(length * scalar.size as f64)) {
            return Err(self.input.error(format!(
                "a list of {length} numbers, and {left} bytes are left; the file is damaged: export it again"
            )));
        }
        Ok(length as u64)
    }

    /// Index of a corner of a face.
    fn corner(&mut self, scalar: ScalarType, vertices: u64) -> Result<u32, ReadError> {
        let value = self.number(scalar, "number of a vertex")?;
        if value >= 0.0 && value < vertices as f64 && value.fract() == 0.0 && value < f64::from(u32::MAX) {
            Ok(value as u32)
        } else {
            Err(self.input.error(format!(
                "the face has vertex {value}, and the {vertices} vertices are counted from 0"
            )))
        }
    }
}
