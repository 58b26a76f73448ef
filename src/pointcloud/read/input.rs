//! The bytes of a file, consumed by lines or by records, and the numbers in them.

use super::ReadError;
use crate::slices::{MEDIUM, pause};
use glam::DVec3;

/// Largest magnitude of a coordinate. Areas and volumes computed from such coordinates do not
/// overflow.
const LARGEST: f64 = 1e30;

/// Most characters of a word that a message quotes. The longest number in double precision has 24,
/// such as -2.2250738585072014e-308.
const SHOWN: usize = 24;

/// Names of the components of a point and its normal, in headers and messages.
pub(super) const COMPONENTS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// The component that a column with this name holds, as index in [`COMPONENTS`]. Knows the names
/// that programs use.
pub(super) fn component(name: &[u8]) -> Option<usize> {
    /// The names in lower case, from x to nz. ParaView's are the last ones.
    const NAMES: [[&[u8]; 6]; 4] = [
        [b"x", b"y", b"z", b"nx", b"ny", b"nz"],
        [b"px", b"py", b"pz", b"normal_x", b"normal_y", b"normal_z"],
        [b"pos_x", b"pos_y", b"pos_z", b"normalx", b"normaly", b"normalz"],
        [b"points:0", b"points:1", b"points:2", b"normals:0", b"normals:1", b"normals:2"],
    ];
    NAMES.iter().find_map(|names| names.iter().position(|known| known.eq_ignore_ascii_case(name)))
}

/// The place in a file that an error names.
enum FilePlace {
    /// Number of the line, from 1.
    Line(u64),
    /// A row of a binary file: its kind, its number within its kind, from 1, and its offset.
    Row { element: String, row: u64, byte: u64 },
}

/// A file with a read position.
pub(super) struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    place: FilePlace,
    /// Number of completed rows.
    rows: usize,
    tell: &'a dyn Fn(f64),
}

impl<'a> Input<'a> {
    /// The file from its beginning; `tell` gets the fraction of the bytes consumed.
    pub(super) fn new(bytes: &'a [u8], tell: &'a dyn Fn(f64)) -> Self {
        // Skip the byte-order mark, with which some editors begin a text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, place: FilePlace::Line(0), rows: 0, tell }
    }

    /// Ends a row, which is a line or a record. Every [`MEDIUM`] rows end a slice of work.
    pub(super) async fn end_row(&mut self) {
        self.rows += 1;
        if self.rows.is_multiple_of(MEDIUM) {
            (self.tell)(self.at as f64 / self.bytes.len() as f64);
            pause().await;
        }
    }

    /// The remaining bytes.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Number of remaining bytes.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Consumes a line, which ends with a line feed, a carriage return or both. Returns it without
    /// the end.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let end = match rest[length..] {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        self.at += length + end;
        if let FilePlace::Line(number) = &mut self.place {
            *number += 1;
        }
        Some(&rest[..length])
    }

    /// Consumes lines up to the first non-blank one, and returns that line.
    pub(super) fn line_with_text(&mut self) -> Option<&'a [u8]> {
        core::iter::from_fn(|| self.line()).find(|line| !line.trim_ascii().is_empty())
    }

    /// Number of remaining non-blank lines.
    pub(super) fn lines_with_text(&self) -> u64 {
        let lines = self.bytes[self.at..].split(|byte| matches!(byte, b'\n' | b'\r'));
        lines.filter(|line| !line.trim_ascii().is_empty()).count() as u64
    }

    /// Consumes `count` bytes. Returns none and consumes nothing if fewer remain.
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let bytes = self.bytes[self.at..].get(..count)?;
        self.at += count;
        Some(bytes)
    }

    /// Sets the kind of the rows that follow in a binary file.
    pub(super) fn begin_records(&mut self, element: &str) {
        self.place = FilePlace::Row { element: element.to_owned(), row: 0, byte: 0 };
    }

    /// Begins a row of a binary file.
    pub(super) fn begin_record(&mut self) {
        if let FilePlace::Row { row, byte, .. } = &mut self.place {
            (*row, *byte) = (*row + 1, self.at as u64);
        }
    }

    /// An error in the line consumed last or the row begun last.
    #[cold]
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        let message = message.into();
        match &self.place {
            &FilePlace::Line(line) => ReadError::Line { line, message },
            FilePlace::Row { element, row, byte } => {
                ReadError::Row { element: element.clone(), row: *row, byte: *byte, message }
            }
        }
    }

    /// `value`, if it can be a coordinate; NaN if it is not finite. Error messages call the
    /// coordinate `name`.
    pub(super) fn coordinate(&self, value: f64, name: &str) -> Result<f64, ReadError> {
        if value.is_finite() && value.abs() > LARGEST {
            return Err(self.error(format!("{name} is {value:e}; up to {LARGEST:e} can be used")));
        }
        Ok(if value.is_finite() { value } else { f64::NAN })
    }

    /// The coordinate that a word spells; NaN if the word stands for a missing value. Error
    /// messages call the coordinate `name`.
    pub(super) fn coordinate_of(&self, word: &[u8], name: &str) -> Result<f64, ReadError> {
        if let Some(value) = coordinate_number(word) {
            return self.coordinate(value, name);
        }
        let with_points: Vec<u8> = word.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect();
        let word = quoted(word);
        Err(self.error(if number(&with_points).is_some() {
            format!("`{word}` has a decimal comma; write decimal points")
        } else {
            format!("{name} is `{word}`, which is not a number")
        }))
    }

    /// The vector whose components are the next three of `words`. Error messages call them `names`.
    pub(super) fn vector<'w>(
        &self,
        words: &mut impl Iterator<Item = &'w [u8]>,
        names: &[&str],
    ) -> Result<DVec3, ReadError> {
        let mut vector = DVec3::ZERO;
        for (k, name) in names.iter().enumerate() {
            let missing = || self.error(format!("three numbers are needed, {name} is missing"));
            vector[k] = self.coordinate_of(words.next().ok_or_else(missing)?, name)?;
        }
        Ok(vector)
    }
}

/// Words of a line, separated by white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A word for a quote in a message: shortened, and without control characters.
pub(super) fn quoted(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * SHOWN)]);
    let mut text: String = text.trim().chars().map(|c| if c.is_control() { '�' } else { c }).collect();
    if let Some((end, _)) = text.char_indices().nth(SHOWN) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// The number that a word spells; NaN if the word stands for a missing value.
pub(super) fn coordinate_number(word: &[u8]) -> Option<f64> {
    const NONE: [&[u8]; 9] =
        [b"", b"na", b"n/a", b"null", b"none", b"nan(ind)", b"-nan(ind)", b"1.#qnan", b"-1.#ind"];
    number(word).or_else(|| NONE.iter().any(|none| none.eq_ignore_ascii_case(word)).then_some(f64::NAN))
}

/// The number that a word spells, including `nan` and `inf`.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    core::str::from_utf8(word).ok()?.parse().ok()
}
