//! The header of a PLY file (Turk, "The PLY Polygon File Format", 1994).

use super::ReadError;
use super::input::{Input, shown, words};

/// How the rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
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

    /// Bytes of it in a binary file.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// What a property is to us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Nothing,
    /// Number of a vertex's x, y, z, nx, ny, nz.
    Slot(usize),
    /// List of a face's corners.
    Corners,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Property {
    pub(super) number: Number,
    /// Type of the length, for a list.
    pub(super) length: Option<Number>,
    pub(super) role: Role,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// Names of a vertex's properties in the order of their slots.
pub(super) const SLOTS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Lines that a header may have; those of scanners with a long history have some dozens.
const MOST_LINES: u64 = 10_000;

/// Bytes of a line that are looked at; only comments are longer.
const LONGEST_LINE: usize = 1024;

impl Element {
    pub(super) fn is_vertex(&self) -> bool {
        self.name == "vertex"
    }

    pub(super) fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|property| property.role == role)
    }

    pub(super) fn has_normal(&self) -> bool {
        (3..6).all(|slot| self.has(Role::Slot(slot)))
    }

    /// Whether there is anything in it that is read.
    pub(super) fn matters(&self) -> bool {
        self.properties.iter().any(|property| property.role != Role::Nothing)
    }

    /// The least number of bytes that a row takes.
    pub(super) fn least_size(&self, encoding: Encoding) -> u64 {
        let of_property = |property: &Property| match encoding {
            // A digit and what sets it apart.
            Encoding::Text => 2,
            _ => property.length.unwrap_or(property.number).size(),
        };
        self.properties.iter().map(of_property).sum()
    }

    fn role(&self, name: &[u8], is_list: bool) -> Role {
        if self.is_vertex() && !is_list {
            let slot = SLOTS.iter().position(|slot| slot.as_bytes() == name);
            return slot.map_or(Role::Nothing, Role::Slot);
        }
        if self.name == "face" && is_list && matches!(name, b"vertex_indices" | b"vertex_index") {
            return Role::Corners;
        }
        Role::Nothing
    }
}

/// Reads the header, up to where the rows begin.
pub(super) fn read(input: &mut Input) -> Result<(Encoding, Vec<Element>), ReadError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let Some(range) = input.line().filter(|_| input.line_number() <= MOST_LINES) else {
            return Err(input.wrong("the header has no `end_header`; the file is cut off: export it again"));
        };
        let line = input.slice(range);
        let line = line[..line.len().min(LONGEST_LINE)].to_vec();
        let words: Vec<&[u8]> = words(&line).collect();
        match words[..] {
            [b"format", format, version] => {
                if version != b"1.0" {
                    return Err(input.wrong(format!("version {} of the format; 1.0 is read", shown(version))));
                }
                encoding = Some(match format {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::LittleEndian,
                    b"binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(input.wrong(format!("`{}` is no format of a PLY file", shown(format)))),
                });
            }
            [b"element", name, count] => {
                let number = core::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                let Some(count) = number else {
                    return Err(input.wrong(format!("`{}` is no number of rows", shown(count))));
                };
                let name = shown(name);
                if elements.iter().any(|element| element.name == name) {
                    return Err(input.wrong(format!("the element `{name}` is declared twice")));
                }
                elements.push(Element { name, count, properties: Vec::new() });
            }
            [b"property", b"list", length, number, name] => {
                add(&mut elements, Some(length), number, name, input)?;
            }
            [b"property", number, name] => add(&mut elements, None, number, name, input)?,
            [b"end_header"] => break,
            [] | [b"ply" | b"comment" | b"obj_info", ..] => {}
            [word, ..] => {
                let word = shown(word);
                return Err(input.wrong(format!("`{word}` begins no line of a PLY header that can be read")));
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(
            input.wrong("the header does not say in which format the rows are; export the file again")
        );
    };
    let complete = |element: &Element| (0..3).all(|slot| element.has(Role::Slot(slot)));
    match elements.iter().find(|element| element.is_vertex()) {
        None => return Err(input.wrong("the header declares no vertices; choose a file that holds points")),
        Some(vertex) if !complete(vertex) => {
            return Err(
                input.wrong("the vertices have no x, y and z; choose a file that holds points in space")
            );
        }
        Some(_) => {}
    }
    check_claims(encoding, &elements, input)?;
    Ok((encoding, elements))
}

fn add(
    elements: &mut [Element],
    length: Option<&[u8]>,
    number: &[u8],
    name: &[u8],
    input: &Input,
) -> Result<(), ReadError> {
    let of_type = |word: &[u8]| {
        Number::named(word).ok_or_else(|| input.wrong(format!("`{}` is no type of a number", shown(word))))
    };
    let length = length.map(of_type).transpose()?;
    let number = of_type(number)?;
    if length.is_some_and(|length| !length.is_whole()) {
        return Err(input.wrong("the length of a list must be a whole number"));
    }
    let Some(element) = elements.last_mut() else {
        return Err(input.wrong("a property stands before the first element"));
    };
    let role = element.role(name, length.is_some());
    if role != Role::Nothing && element.has(role) {
        return Err(input.wrong(format!("the property `{}` is declared twice", shown(name))));
    }
    element.properties.push(Property { number, length, role });
    Ok(())
}

/// Compares what the header promises with the bytes that follow it, before any memory is asked for.
fn check_claims(encoding: Encoding, elements: &[Element], input: &Input) -> Result<(), ReadError> {
    let left = input.left() as u64;
    // The last line of a text needs no end.
    let room = left + u64::from(encoding == Encoding::Text);
    let mut needed = 0_u64;
    for element in elements {
        needed = needed.saturating_add(element.count.saturating_mul(element.least_size(encoding)));
        if needed > room {
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
