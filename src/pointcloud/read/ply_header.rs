//! Header of a PLY file (G. Turk, "The PLY Polygon File Format", 1994).

use super::ReadError;
use super::input::{Input, quoted, words};

/// Encoding of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a scalar property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScalarType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl ScalarType {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Size in bytes in a binary file.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// Role of a property for the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The property is skipped.
    Unused,
    /// Component of a vertex, by its index in [`COMPONENTS`].
    Component(usize),
    /// List of the corners of a face.
    Corners,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Property {
    /// Type of the value, or of the entries of a list.
    pub(super) scalar: ScalarType,
    /// Type of the length of a list; `None` for a scalar.
    pub(super) length: Option<ScalarType>,
    pub(super) role: Role,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// Names of the components of a vertex.
pub(super) const COMPONENTS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Maximum number of lines of a header. Real headers have some dozens at most.
const MAX_LINES: u64 = 10_000;

/// Number of bytes of a line that are looked at. Only comments are longer.
const MAX_LINE_BYTES: usize = 1024;

impl Element {
    pub(super) fn is_vertex(&self) -> bool {
        self.name == "vertex"
    }

    pub(super) fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|property| property.role == role)
    }

    pub(super) fn has_normal(&self) -> bool {
        (3..6).all(|component| self.has(Role::Component(component)))
    }

    /// Whether any of its properties is used.
    pub(super) fn is_used(&self) -> bool {
        self.properties.iter().any(|property| property.role != Role::Unused)
    }

    /// Minimum number of bytes of a row.
    pub(super) fn min_row_size(&self, encoding: Encoding) -> u64 {
        let of_property = |property: &Property| match encoding {
            // A digit and a separator.
            Encoding::Text => 2,
            _ => property.length.unwrap_or(property.scalar).size(),
        };
        self.properties.iter().map(of_property).sum()
    }

    fn role(&self, name: &[u8], is_list: bool) -> Role {
        if self.is_vertex() && !is_list {
            let component = COMPONENTS.iter().position(|component| component.as_bytes() == name);
            return component.map_or(Role::Unused, Role::Component);
        }
        if self.name == "face" && is_list && matches!(name, b"vertex_indices" | b"vertex_index") {
            return Role::Corners;
        }
        Role::Unused
    }
}

/// Reads the header, up to the first row.
///
/// # Errors
///
/// If a line is wrong, if there are no vertices with x, y and z, or if the file is too small for the rows.
pub(super) fn read(input: &mut Input) -> Result<(Encoding, Vec<Element>), ReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let Some(range) = input.line().filter(|_| input.line_number() <= MAX_LINES) else {
            return Err(
                input.line_error("the header has no `end_header`; the file is cut off: export it again")
            );
        };
        let line = input.slice(range);
        let line = line[..line.len().min(MAX_LINE_BYTES)].to_vec();
        let words: Vec<&[u8]> = words(&line).collect();
        match words[..] {
            [b"format", format, version] => {
                if version != b"1.0" {
                    return Err(
                        input.line_error(format!("version {} of the format; 1.0 is read", quoted(version)))
                    );
                }
                encoding = Some(match format {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::LittleEndian,
                    b"binary_big_endian" => Encoding::BigEndian,
                    _ => {
                        return Err(
                            input.line_error(format!("`{}` is no format of a PLY file", quoted(format)))
                        );
                    }
                });
            }
            [b"element", name, count] => {
                let number = core::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                let Some(count) = number else {
                    return Err(input.line_error(format!("`{}` is no number of rows", quoted(count))));
                };
                let name = quoted(name);
                if elements.iter().any(|element| element.name == name) {
                    return Err(input.line_error(format!("the element `{name}` is declared twice")));
                }
                elements.push(Element { name, count, properties: Vec::new() });
            }
            [b"property", b"list", length, scalar, name] => {
                add(&mut elements, Some(length), scalar, name, input)?;
            }
            [b"property", scalar, name] => add(&mut elements, None, scalar, name, input)?,
            [b"end_header"] => break,
            [] | [b"ply" | b"comment" | b"obj_info", ..] => {}
            [word, ..] => {
                let word = quoted(word);
                return Err(
                    input.line_error(format!("`{word}` begins no line of a PLY header that can be read"))
                );
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(
            input.line_error("the header does not say in which format the rows are; export the file again")
        );
    };
    let complete = |element: &Element| (0..3).all(|component| element.has(Role::Component(component)));
    match elements.iter().find(|element| element.is_vertex()) {
        None => {
            return Err(input.line_error("the header declares no vertices; choose a file that holds points"));
        }
        Some(vertex) if !complete(vertex) => {
            return Err(
                input.line_error("the vertices have no x, y and z; choose a file that holds points in space")
            );
        }
        Some(_) => {}
    }
    check_claims(encoding, &elements, input)?;
    Ok((encoding, elements))
}

/// Adds a property to the last element.
fn add(
    elements: &mut [Element],
    length: Option<&[u8]>,
    scalar: &[u8],
    name: &[u8],
    input: &Input,
) -> Result<(), ReadError> {
    let of_type = |word: &[u8]| {
        ScalarType::named(word)
            .ok_or_else(|| input.line_error(format!("`{}` is no type of a number", quoted(word))))
    };
    let length = length.map(of_type).transpose()?;
    let scalar = of_type(scalar)?;
    if length.is_some_and(|length| !length.is_integer()) {
        return Err(input.line_error("the length of a list must be a whole number"));
    }
    let Some(element) = elements.last_mut() else {
        return Err(input.line_error("a property stands before the first element"));
    };
    let role = element.role(name, length.is_some());
    if role != Role::Unused && element.has(role) {
        return Err(input.line_error(format!("the property `{}` is declared twice", quoted(name))));
    }
    element.properties.push(Property { scalar, length, role });
    Ok(())
}

/// Compares the number of rows that the header claims with the bytes that follow, before memory is allocated.
fn check_claims(encoding: Encoding, elements: &[Element], input: &Input) -> Result<(), ReadError> {
    let left = input.remaining() as u64;
    // The last line of a text needs no line end.
    let available = left + u64::from(encoding == Encoding::Text);
    let mut needed = 0_u64;
    for element in elements {
        needed = needed.saturating_add(element.count.saturating_mul(element.min_row_size(encoding)));
        if needed > available {
            return Err(ReadError::Claim {
                element: element.name.clone(),
                count: element.count,
                needed,
                left,
            });
        }
    }
    Ok(())
}
