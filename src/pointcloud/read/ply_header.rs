//! Header of a PLY file (G. Turk, "The PLY Polygon File Format", 1994).

use super::ReadError;
use super::input::{COMPONENTS, Input, component, quoted, words};
use core::ops::Range;

/// Encoding of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Kind of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    Signed,
    Unsigned,
    Float,
}

/// Type of a scalar property.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScalarType {
    pub(super) kind: NumberKind,
    /// Bytes of a value in a binary file.
    pub(super) size: usize,
}

impl ScalarType {
    fn named(name: &[u8]) -> Option<Self> {
        let (kind, size) = match name {
            b"char" | b"int8" => (NumberKind::Signed, 1),
            b"uchar" | b"uint8" => (NumberKind::Unsigned, 1),
            b"short" | b"int16" => (NumberKind::Signed, 2),
            b"ushort" | b"uint16" => (NumberKind::Unsigned, 2),
            b"int" | b"int32" => (NumberKind::Signed, 4),
            b"uint" | b"uint32" => (NumberKind::Unsigned, 4),
            b"float" | b"float32" => (NumberKind::Float, 4),
            b"double" | b"float64" => (NumberKind::Float, 8),
            _ => return None,
        };
        Some(Self { kind, size })
    }

    /// The value of a colour at its brightest.
    pub(super) fn brightest(self) -> f64 {
        match (self.kind, self.size) {
            (NumberKind::Float, _) => 1.0,
            (_, 1) => 255.0,
            _ => 65_535.0,
        }
    }

    /// The number that bytes of this size encode, in either byte order.
    pub(super) fn decode(self, bytes: &[u8], encoding: Encoding) -> f64 {
        let mut word = [0; 8];
        word[..self.size].copy_from_slice(bytes);
        if encoding == Encoding::BigEndian {
            word[..self.size].reverse();
        }
        let bits = u64::from_le_bytes(word);
        match self.kind {
            NumberKind::Unsigned => bits as f64,
            NumberKind::Signed => {
                let above = u64::BITS - 8 * self.size as u32;
                ((bits << above) as i64 >> above) as f64
            }
            NumberKind::Float if self.size == 4 => f32::from_bits(bits as u32).into(),
            NumberKind::Float => f64::from_bits(bits),
        }
    }
}

/// Role of a property for the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The property is skipped.
    Unused,
    /// A component of a vertex, as index in [`COMPONENTS`].
    Component(usize),
    /// Red, green or blue of a vertex, 0 to 2.
    Colour(usize),
    /// A list of the corners of a face.
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

/// Most lines of a header. Real headers have at most some dozens.
const MAX_LINES: usize = 10_000;

/// Words of a line that are read: one more than the longest statement has.
const MAX_WORDS: usize = 6;

impl Element {
    pub(super) fn is_vertex(&self) -> bool {
        self.name == "vertex"
    }

    pub(super) fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|property| property.role == role)
    }

    /// Whether the element has all of these components.
    pub(super) fn has_components(&self, mut components: Range<usize>) -> bool {
        components.all(|component| self.has(Role::Component(component)))
    }

    /// Whether the element has a colour.
    pub(super) fn has_colour(&self) -> bool {
        (0..3).all(|k| self.has(Role::Colour(k)))
    }

    /// Whether any property is used.
    pub(super) fn is_used(&self) -> bool {
        self.properties.iter().any(|property| property.role != Role::Unused)
    }

    /// Minimum number of bytes of a row.
    pub(super) fn min_row_size(&self, encoding: Encoding) -> u64 {
        let of_property = |property: &Property| match encoding {
            // A digit and a separator.
            Encoding::Text => 2,
            _ => property.length.unwrap_or(property.scalar).size as u64,
        };
        self.properties.iter().map(of_property).sum()
    }

    fn role(&self, name: &[u8], is_list: bool) -> Role {
        if self.is_vertex() && !is_list {
            let colour = || [b"red".as_slice(), b"green", b"blue"].iter().position(|own| *own == name);
            let of_colour = || colour().map_or(Role::Unused, Role::Colour);
            return component(name).map_or_else(of_colour, Role::Component);
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
/// If a line is wrong, there are no vertices with x, y and z, or the file is too small for the
/// rows.
pub(super) fn read(input: &mut Input) -> Result<(Encoding, Vec<Element>), ReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut is_complete = false;
    for _ in 0..MAX_LINES {
        let Some(line) = input.line() else { break };
        let words: Vec<&[u8]> = words(line).take(MAX_WORDS).collect();
        if words == [b"end_header"] {
            is_complete = true;
            break;
        }
        statement(&words, &mut encoding, &mut elements).map_err(|message| input.error(message))?;
    }
    let vertex = elements.iter().find(|element| element.is_vertex());
    let message = match (encoding, vertex) {
        _ if !is_complete => "the header has no `end_header`; the file is cut off: export it again",
        (None, _) => "the header does not say in which format the rows are; export the file again",
        (_, None) => "the header declares no vertices; choose a file that holds points",
        (_, Some(vertex)) if !vertex.has_components(0..3) => {
            "the vertices have no x, y and z; choose a file that holds points in space"
        }
        (Some(encoding), Some(_)) => {
            check_claims(encoding, &elements, input)?;
            return Ok((encoding, elements));
        }
    };
    Err(input.error(message))
}

/// Reads a line of the header. The error says what is wrong with it.
fn statement(
    words: &[&[u8]],
    encoding: &mut Option<Encoding>,
    elements: &mut Vec<Element>,
) -> Result<(), String> {
    match *words {
        [b"format", format, version] => {
            if version != b"1.0" {
                return Err(format!("version {} of the format; 1.0 is read", quoted(version)));
            }
            *encoding = Some(match format {
                b"ascii" => Encoding::Text,
                b"binary_little_endian" => Encoding::LittleEndian,
                b"binary_big_endian" => Encoding::BigEndian,
                _ => return Err(format!("`{}` is no format of a PLY file", quoted(format))),
            });
        }
        [b"element", name, count] => {
            let number = core::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
            let count = number.ok_or_else(|| format!("`{}` is no number of rows", quoted(count)))?;
            let name = quoted(name);
            if elements.iter().any(|element| element.name == name) {
                return Err(format!("the element `{name}` is declared twice"));
            }
            elements.push(Element { name, count, properties: Vec::new() });
        }
        [b"property", b"list", length, scalar, name] => add(elements, Some(length), scalar, name)?,
        [b"property", scalar, name] => add(elements, None, scalar, name)?,
        [] | [b"ply" | b"comment" | b"obj_info", ..] => {}
        [word, ..] => {
            return Err(format!("`{}` begins no line of a PLY header that can be read", quoted(word)));
        }
    }
    Ok(())
}

/// Adds a property to the last element.
fn add(elements: &mut [Element], length: Option<&[u8]>, scalar: &[u8], name: &[u8]) -> Result<(), String> {
    let of_type = |word: &[u8]| {
        ScalarType::named(word).ok_or_else(|| format!("`{}` is no type of a number", quoted(word)))
    };
    let length = length.map(of_type).transpose()?;
    let scalar = of_type(scalar)?;
    if length.is_some_and(|length| length.kind == NumberKind::Float) {
        return Err("the length of a list must be a whole number".to_owned());
    }
    let element = elements.last_mut().ok_or("a property stands before the first element")?;
    let mut role = element.role(name, length.is_some());
    if role != Role::Unused && element.has(role) {
        // The element may have a component under two names.
        let is_usual = role == Role::Corners || COMPONENTS.iter().any(|usual| usual.as_bytes() == name);
        if is_usual {
            return Err(format!("the property `{}` is declared twice", quoted(name)));
        }
        role = Role::Unused;
    }
    element.properties.push(Property { scalar, length, role });
    Ok(())
}

/// Compares the number of rows in the header with the bytes that follow, before memory is
/// allocated.
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
