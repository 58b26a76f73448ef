//! Reader of PCD files (Point Cloud Library, "The PCD (Point Cloud Data) file format", versions 0.5
//! to 0.7), as text, binary and compressed.

use super::input::{COMPONENTS, Input, component, quoted, words};
use super::mesh::FileMesh;
use super::ply_header::{Encoding, NumberKind, ScalarType};
use super::{ReadError, push};

/// Encoding of the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Data {
    Text,
    Binary,
    Compressed,
}

/// A field of every point.
#[derive(Clone, Copy, Debug)]
struct PcdField {
    scalar: ScalarType,
    /// Number of values in the field.
    count: u64,
    /// The component that the field holds, as index in [`COMPONENTS`].
    component: Option<usize>,
}

impl PcdField {
    fn bytes(&self) -> u64 {
        self.count.saturating_mul(self.scalar.size as u64)
    }
}

/// First words of the lines of a header.
const KEYS: [&[u8]; 10] = [
    b"VERSION",
    b"FIELDS",
    b"SIZE",
    b"TYPE",
    b"COUNT",
    b"WIDTH",
    b"HEIGHT",
    b"VIEWPOINT",
    b"POINTS",
    b"DATA",
];

/// Whether a file begins like a PCD file: with a comment that says so, or with the first line of a
/// header.
pub(super) fn begins_with(bytes: &[u8]) -> bool {
    /// Comments before the header are short.
    const LOOKED_AT: usize = 1024;
    let start = &bytes[..bytes.len().min(LOOKED_AT)];
    let mut lines = start.split(|&byte| matches!(byte, b'\n' | b'\r'));
    let is_comment = |line: &&[u8]| line.is_empty() || line.starts_with(b"#");
    let first = lines.find(|line| !is_comment(line)).unwrap_or_default();
    let word = words(first).next().unwrap_or_default();
    matches!(word, b"VERSION" | b"FIELDS") || words(start).take(3).any(|word| word == b".PCD")
}

struct Header {
    fields: Vec<PcdField>,
    points: u64,
    data: Data,
}

impl Header {
    /// Reads the lines up to and including `DATA`.
    fn read(input: &mut Input) -> Result<Self, ReadError> {
        let mut lines: [Vec<&[u8]>; KEYS.len()] = core::array::from_fn(|_| Vec::new());
        let [_, fields, sizes, types, counts, width, height, _, points, data] = loop {
            let Some(line) = input.line() else {
                return Err(input.error("the header has no `DATA`; the file is cut off: export it again"));
            };
            let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
            let mut words = words(line);
            let Some(word) = words.next() else { continue };
            let Some(key) = KEYS.iter().position(|key| *key == word) else {
                return Err(input.error(format!("`{}` begins no line of a PCD header", quoted(word))));
            };
            lines[key] = words.collect();
            if word == b"DATA" {
                break lines;
            }
        };
        let data = match data[..] {
            [b"ascii"] => Data::Text,
            [b"binary"] => Data::Binary,
            [b"binary_compressed"] => Data::Compressed,
            _ => {
                return Err(
                    input.error("`DATA` must be ascii, binary or binary_compressed; export the file again")
                );
            }
        };
        let number = |word: &[u8]| {
            let number = core::str::from_utf8(word).ok().and_then(|word| word.parse::<u64>().ok());
            number.ok_or_else(|| input.error(format!("`{}` in the header is no whole number", quoted(word))))
        };
        let has_counts = !counts.is_empty();
        for (name, list) in [("SIZE", &sizes), ("TYPE", &types), ("COUNT", &counts)] {
            if list.len() != fields.len() && (name != "COUNT" || has_counts) {
                let (given, needed) = (list.len(), fields.len());
                return Err(input.error(format!(
                    "`{name}` has {given} entries for {needed} fields; export the file again"
                )));
            }
        }
        let mut known: Vec<PcdField> = Vec::new();
        for (k, name) in fields.iter().enumerate() {
            let kind = match types[k] {
                b"F" => NumberKind::Float,
                b"I" => NumberKind::Signed,
                b"U" => NumberKind::Unsigned,
                other => {
                    return Err(
                        input.error(format!("`{}` is no type of a number; F, I and U are", quoted(other)))
                    );
                }
            };
            let size = number(sizes[k])?;
            if !matches!((size, kind), (4 | 8, _) | (1 | 2, NumberKind::Signed | NumberKind::Unsigned)) {
                return Err(input.error(format!("a number of {size} bytes cannot be read")));
            }
            let count = if has_counts { number(counts[k])? } else { 1 };
            let is_new = |&at: &usize| count == 1 && known.iter().all(|field| field.component != Some(at));
            let component = component(name).filter(is_new);
            known.push(PcdField { scalar: ScalarType { kind, size: size as usize }, count, component });
        }
        if (0..3).any(|axis| known.iter().all(|field| field.component != Some(axis))) {
            return Err(
                input.error("the points have no x, y and z; choose a file that holds points in space")
            );
        }
        let points = match (points.first(), width.first(), height.first()) {
            (Some(points), ..) => number(points)?,
            (None, Some(width), height) => {
                number(width)?.saturating_mul(height.map_or(Ok(1), |height| number(height))?)
            }
            (None, None, _) => {
                return Err(
                    input.error("the header does not say how many points there are; export the file again")
                );
            }
        };
        Ok(Self { fields: known, points, data })
    }

    /// Bytes of a point; as text, at least a digit and a separator for each number.
    fn point_bytes(&self) -> u64 {
        let of = |field: &PcdField| if self.data == Data::Text { 2 * field.count } else { field.bytes() };
        self.fields.iter().map(of).fold(0, u64::saturating_add)
    }

    /// Compares the number of points with the available bytes.
    fn check_claim(&self, left: u64) -> Result<(), ReadError> {
        let needed = self.points.saturating_mul(self.point_bytes());
        // The last line of a text needs no line end.
        if needed > left + u64::from(self.data == Data::Text) {
            return Err(ReadError::Claim { element: "point".to_owned(), count: self.points, needed, left });
        }
        Ok(())
    }

    fn has_normals(&self) -> bool {
        (3..6).all(|at| self.fields.iter().any(|field| field.component == Some(at)))
    }
}

/// Reads the header and the points.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let header = Header::read(input)?;
    match header.data {
        Data::Text => read_text(input, &header, mesh).await,
        Data::Binary => {
            header.check_claim(input.remaining() as u64)?;
            let size = header.point_bytes() as usize;
            input.begin_records("point");
            for _ in 0..header.points {
                input.begin_record();
                let record = input.take(size).unwrap_or_default();
                add_point(input, &header, mesh, &mut |before, field| {
                    &record[before as usize..][..field.scalar.size]
                })?;
                input.end_row().await;
            }
            Ok(())
        }
        Data::Compressed => read_compressed(input, &header, mesh).await,
    }
}

async fn read_text(input: &mut Input<'_>, header: &Header, mesh: &mut FileMesh) -> Result<(), ReadError> {
    header.check_claim(input.remaining() as u64)?;
    let mut words_of_line: Vec<&[u8]> = Vec::new();
    for _ in 0..header.points {
        let Some(line) = input.line_with_text() else {
            let count = header.points;
            return Err(input
                .error(format!("the file ends before all {count} points; it is cut off: export it again")));
        };
        words_of_line.clear();
        words_of_line.extend(words(line));
        let (mut values, mut at) = ([0.0; COMPONENTS.len()], 0_u64);
        for field in &header.fields {
            if let Some(component) = field.component {
                let few = || input.error("this point has fewer numbers than the header says");
                let word = usize::try_from(at).ok().and_then(|at| words_of_line.get(at)).ok_or_else(few)?;
                values[component] = input.coordinate_of(word, COMPONENTS[component])?;
            }
            at = at.saturating_add(field.count);
        }
        mesh.add_point(values, header.has_normals())?;
        input.end_row().await;
    }
    Ok(())
}

/// Adds a point. `bytes` returns the bytes of a field, given the number of bytes of a point before
/// that field.
fn add_point<'b>(
    input: &Input,
    header: &Header,
    mesh: &mut FileMesh,
    bytes: &mut dyn FnMut(u64, &PcdField) -> &'b [u8],
) -> Result<(), ReadError> {
    let (mut values, mut before) = ([0.0; COMPONENTS.len()], 0);
    for field in &header.fields {
        if let Some(component) = field.component {
            let value = field.scalar.decode(bytes(before, field), Encoding::LittleEndian);
            values[component] = input.coordinate(value, COMPONENTS[component])?;
        }
        before += field.bytes();
    }
    mesh.add_point(values, header.has_normals())
}

/// Reads compressed points: all values of the first field, then all of the second, and so on.
async fn read_compressed(
    input: &mut Input<'_>,
    header: &Header,
    mesh: &mut FileMesh,
) -> Result<(), ReadError> {
    let cut_off =
        |input: &Input| input.error("the compressed points are cut off or damaged; export the file again");
    input.begin_records("block");
    input.begin_record();
    let sizes = input.take(8).ok_or_else(|| cut_off(input))?;
    let [packed, unpacked] = [&sizes[..4], &sizes[4..]].map(|size| {
        let size = size.try_into().map(u32::from_le_bytes);
        size.unwrap_or_default()
    });
    let packed = input.take(packed as usize).ok_or_else(|| cut_off(input))?;
    header.check_claim(unpacked.into())?;
    let bytes = unpack(packed, unpacked as usize, input).await?.ok_or_else(|| cut_off(input))?;
    input.begin_records("point");
    for k in 0..header.points {
        input.begin_record();
        // A field follows all values of the fields before it.
        add_point(input, header, mesh, &mut |before, field| {
            let at = before * header.points + k * field.bytes();
            &bytes[at as usize..][..field.scalar.size]
        })?;
        input.end_row().await;
    }
    Ok(())
}

/// Unpacks LZF, the format of M. Lehmann's LibLZF: literal runs and references to earlier bytes.
/// None if the result has the wrong size.
async fn unpack(packed: &[u8], size: usize, input: &mut Input<'_>) -> Result<Option<Vec<u8>>, ReadError> {
    let mut out: Vec<u8> = Vec::new();
    let mut bytes = packed;
    while let Some((&control, rest)) = bytes.split_first() {
        bytes = rest;
        let control = usize::from(control);
        let mut next = || {
            let (&byte, rest) = bytes.split_first()?;
            bytes = rest;
            Some(usize::from(byte))
        };
        if control < 32 {
            let Some((run, rest)) = bytes.split_at_checked(control + 1) else { return Ok(None) };
            bytes = rest;
            out.try_reserve(run.len()).map_err(|_| ReadError::Memory)?;
            out.extend_from_slice(run);
        } else {
            let more = if control >> 5 == 7 { next() } else { Some(0) };
            let (Some(more), Some(low)) = (more, next()) else { return Ok(None) };
            let back = ((control & 31) << 8) + low + 1;
            let Some(from) = out.len().checked_sub(back) else { return Ok(None) };
            // The source may overlap the bytes that are being written.
            for k in from..from + (control >> 5) + more + 2 {
                let byte = out[k];
                push(&mut out, byte)?;
            }
        }
        if out.len() > size {
            return Ok(None);
        }
        input.end_row().await;
    }
    Ok((out.len() == size).then_some(out))
}
