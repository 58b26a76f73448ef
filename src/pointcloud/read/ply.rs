//! Reader of PLY files, with any elements and properties in any order, as text or binary in either byte order.

use super::input::{Input, coordinate, coordinate_word, number, quoted, words};
use super::mesh::FileMesh;
use super::ply_header::{self, COMPONENTS, Element, Encoding, Role, ScalarType};
use super::{ReadError, RowReader, push};
use glam::DVec3;

pub(super) struct Ply {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Index of the next row's element, and of the row among its rows.
    element: usize,
    row: u64,
    vertices: u64,
    corners: Vec<u32>,
}

impl Ply {
    pub(super) fn new(input: &mut Input, mesh: &mut FileMesh) -> Result<Self, ReadError> {
        let (encoding, mut elements) = ply_header::read(input)?;
        // Elements after the last one that is used are not read.
        let end = elements.iter().rposition(Element::is_used).map_or(0, |last| last + 1);
        elements.truncate(end);
        let vertex = elements.iter().find(|element| element.is_vertex());
        let vertices = vertex.map_or(0, |vertex| vertex.count);
        // The header was compared with the size of the file, so this allocation is bounded by it.
        let count = vertices as usize;
        mesh.position.try_reserve_exact(count).map_err(|_| ReadError::Memory)?;
        if vertex.is_some_and(Element::has_normal) {
            mesh.normal.try_reserve_exact(count).map_err(|_| ReadError::Memory)?;
        }
        Ok(Self { encoding, elements, element: 0, row: 0, vertices, corners: Vec::new() })
    }
}

impl RowReader for Ply {
    fn row(&mut self, input: &mut Input, mesh: &mut FileMesh) -> Result<bool, ReadError> {
        let Some(element) = self.elements.get(self.element) else { return Ok(false) };
        if self.row == element.count || element.properties.is_empty() {
            self.element += 1;
            self.row = 0;
            return Ok(true);
        }
        self.row += 1;
        let byte = input.offset() as u64;
        let mut values = [0.0; COMPONENTS.len()];
        self.corners.clear();
        let result = match self.encoding {
            Encoding::Text => text_row(element, input, &mut values, &mut self.corners, self.vertices),
            encoding => binary_row(encoding, element, input, &mut values, &mut self.corners, self.vertices),
        };
        result.map_err(|message| match self.encoding {
            Encoding::Text => input.line_error(message),
            _ => ReadError::Row { element: element.name.clone(), row: self.row, byte, message },
        })?;
        if element.is_vertex() {
            let [x, y, z, nx, ny, nz] = values;
            push(&mut mesh.position, DVec3::new(x, y, z))?;
            if element.has_normal() {
                push(&mut mesh.normal, DVec3::new(nx, ny, nz))?;
            }
        }
        mesh.add_polygon(&self.corners)?;
        Ok(true)
    }
}

fn text_row(
    element: &Element,
    input: &mut Input,
    values: &mut [f64],
    corners: &mut Vec<u32>,
    vertices: u64,
) -> Result<(), String> {
    let Some(range) = input.line_with_text() else {
        return Err(format!(
            "the file ends before all {} {} rows; it is cut off: export it again",
            element.count, element.name
        ));
    };
    let mut words = words(input.slice(range));
    let mut next = || {
        words.next().ok_or_else(|| format!("this {} has fewer numbers than the header says", element.name))
    };
    for property in &element.properties {
        let Some(_) = property.length else {
            let word = next()?;
            if let Role::Component(component) = property.role {
                values[component] = coordinate_word(word, COMPONENTS[component])?;
            }
            continue;
        };
        let word = next()?;
        let length = number(word).filter(|length| *length >= 0.0 && length.fract() == 0.0);
        let length = length.ok_or_else(|| format!("`{}` is no length of a list", quoted(word)))?;
        for _ in 0..length as u64 {
            let word = next()?;
            if property.role == Role::Corners {
                let value =
                    number(word).ok_or_else(|| format!("`{}` is no number of a vertex", quoted(word)))?;
                corners.push(corner(value, vertices)?);
            }
        }
    }
    Ok(())
}

fn binary_row(
    encoding: Encoding,
    element: &Element,
    input: &mut Input,
    values: &mut [f64],
    corners: &mut Vec<u32>,
    vertices: u64,
) -> Result<(), String> {
    let cut_off = || "the file ends here; it is cut off, or its header is wrong: export it again".to_owned();
    for property in &element.properties {
        let Some(length) = property.length else {
            match property.role {
                Role::Component(component) => {
                    let value = value(property.scalar, encoding, input).ok_or_else(cut_off)?;
                    values[component] = coordinate(value, COMPONENTS[component])?;
                }
                _ if input.skip(property.scalar.size()) => {}
                _ => return Err(cut_off()),
            }
            continue;
        };
        let length = value(length, encoding, input).ok_or_else(cut_off)?;
        let size = length * property.scalar.size() as f64;
        if !(0.0..=input.remaining() as f64).contains(&size) {
            let left = input.remaining();
            return Err(format!(
                "a list of {length} numbers, and {left} bytes are left; the file is damaged: export it again"
            ));
        }
        if property.role != Role::Corners {
            input.skip(size as u64);
            continue;
        }
        for _ in 0..length as u64 {
            let value = value(property.scalar, encoding, input).ok_or_else(cut_off)?;
            corners.push(corner(value, vertices)?);
        }
    }
    Ok(())
}

/// Consumes a number of a binary file.
fn value(scalar: ScalarType, encoding: Encoding, input: &mut Input) -> Option<f64> {
    macro_rules! take {
        ($number:ty) => {{
            let bytes = input.take()?;
            f64::from(match encoding {
                Encoding::BigEndian => <$number>::from_be_bytes(bytes),
                _ => <$number>::from_le_bytes(bytes),
            })
        }};
    }
    Some(match scalar {
        ScalarType::I8 => take!(i8),
        ScalarType::U8 => take!(u8),
        ScalarType::I16 => take!(i16),
        ScalarType::U16 => take!(u16),
        ScalarType::I32 => take!(i32),
        ScalarType::U32 => take!(u32),
        ScalarType::F32 => take!(f32),
        ScalarType::F64 => take!(f64),
    })
}

/// Vertex index that a number stands for.
fn corner(value: f64, vertices: u64) -> Result<u32, String> {
    if value >= 0.0 && value < vertices as f64 && value.fract() == 0.0 && value < f64::from(u32::MAX) {
        Ok(value as u32)
    } else {
        Err(format!("the face has vertex {value}, and the {vertices} vertices are counted from 0"))
    }
}
