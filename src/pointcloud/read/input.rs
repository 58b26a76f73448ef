//! The bytes of a file, consumed by lines or by records, and the numbers in them.

use super::ReadError;
use core::ops::Range;

/// Largest magnitude of a coordinate. Areas and volumes computed from such coordinates do not overflow.
const LARGEST: f64 = 1e30;

/// Maximum number of characters of a word that a message quotes: the longest number in double precision has 24, as
/// -2.2250738585072014e-308.
const SHOWN: usize = 24;

/// A file with a read position.
pub(super) struct Input {
    bytes: Vec<u8>,
    at: usize,
    line: u64,
}

impl Input {
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        // Skip the byte-order mark, with which some editors begin a text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, line: 0 }
    }

    /// Fraction of the bytes consumed.
    pub(super) fn fraction(&self) -> f64 {
        self.at as f64 / self.bytes.len().max(1) as f64
    }

    /// Offset of the next byte.
    pub(super) fn offset(&self) -> usize {
        self.at
    }

    /// Number of remaining bytes.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Number, from 1, of the line consumed last.
    pub(super) fn line_number(&self) -> u64 {
        self.line
    }

    /// Upper bound of the number of remaining lines.
    pub(super) fn count_lines(&self) -> usize {
        self.bytes[self.at..].iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count() + 1
    }

    /// Consumes a line, which ends with a line feed, a carriage return or both, and returns its range without the end.
    pub(super) fn line(&mut self) -> Option<Range<usize>> {
        if self.at == self.bytes.len() {
            return None;
        }
        let start = self.at;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let end = match rest[length..] {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        self.at += length + end;
        self.line += 1;
        Some(start..start + length)
    }

    /// Consumes lines up to and including one that is not blank, and returns its range.
    pub(super) fn line_with_text(&mut self) -> Option<Range<usize>> {
        loop {
            let line = self.line()?;
            if !self.bytes[line.clone()].trim_ascii().is_empty() {
                return Some(line);
            }
        }
    }

    /// Consumes `N` bytes.
    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let bytes = self.bytes.get(self.at..self.at + N)?.try_into().ok()?;
        self.at += N;
        Some(bytes)
    }

    /// Consumes `count` bytes. Returns false, and consumes nothing, if fewer remain.
    pub(super) fn skip(&mut self, count: u64) -> bool {
        let within = count <= self.remaining() as u64;
        if within {
            self.at += count as usize;
        }
        within
    }

    /// Bytes of a range that [`Input::line`] has returned.
    pub(super) fn slice(&self, range: Range<usize>) -> &[u8] {
        &self.bytes[range]
    }

    /// Error in the line consumed last.
    #[cold]
    pub(super) fn line_error(&self, message: impl Into<String>) -> ReadError {
        ReadError::Line { line: self.line, message: message.into() }
    }
}

/// Words of a line, separated by white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Word as a message quotes it: shortened, and without control characters.
pub(super) fn quoted(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * SHOWN)]);
    let mut text: String = text.trim().chars().map(|c| if c.is_control() { '�' } else { c }).collect();
    if let Some((end, _)) = text.char_indices().nth(SHOWN) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// Number that a word spells, including `nan` and `inf`.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    core::str::from_utf8(word).ok()?.parse().ok()
}

/// `value`, if it can be a coordinate. The error message calls the coordinate `name`.
pub(super) fn coordinate(value: f64, name: &str) -> Result<f64, String> {
    if value.abs() <= LARGEST {
        Ok(value)
    } else if value.is_finite() {
        Err(format!("{name} is {value:e}; up to {LARGEST:e} can be used"))
    } else {
        Err(format!("{name} is not a finite number; remove this point or export the file again"))
    }
}

/// Coordinate that a word spells. The error message calls the coordinate `name`.
pub(super) fn coordinate_word(word: &[u8], name: &str) -> Result<f64, String> {
    match number(word) {
        Some(value) => coordinate(value, name),
        None if word.contains(&b',') && number(&decimal_point(word)).is_some() => {
            Err(format!("`{}` has a decimal comma; write decimal points", quoted(word)))
        }
        None => Err(format!("{name} is `{}`, which is not a number", quoted(word))),
    }
}

/// Word with decimal points in place of commas.
fn decimal_point(word: &[u8]) -> Vec<u8> {
    word.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect()
}
