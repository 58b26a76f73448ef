//! The bytes of a file, taken by lines or by pieces, and the numbers in them.

use super::ReadError;
use core::ops::Range;

/// The largest coordinate: the areas and volumes that are made of such stay far below the largest double.
const LARGEST: f64 = 1e30;

/// Characters of a word that a message repeats.
const SHOWN: usize = 24;

pub(super) struct Input {
    bytes: Vec<u8>,
    at: usize,
    line: u64,
}

impl Input {
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        // The mark that some editors put at the start of a text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, line: 0 }
    }

    pub(super) fn fraction(&self) -> f64 {
        self.at as f64 / self.bytes.len().max(1) as f64
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Number of the line taken last, from 1.
    pub(super) fn line_number(&self) -> u64 {
        self.line
    }

    /// Ends of lines that are left, and one more.
    pub(super) fn count_lines(&self) -> usize {
        self.bytes[self.at..].iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count() + 1
    }

    /// The next line without its end, which is a line feed, a carriage return or both.
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

    /// The next line that holds more than white space.
    pub(super) fn line_with_text(&mut self) -> Option<Range<usize>> {
        loop {
            let line = self.line()?;
            if !self.bytes[line.clone()].trim_ascii().is_empty() {
                return Some(line);
            }
        }
    }

    /// The next `N` bytes.
    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let piece = self.bytes.get(self.at..self.at + N)?.try_into().ok()?;
        self.at += N;
        Some(piece)
    }

    /// Leaves out `count` bytes; false if there are fewer.
    pub(super) fn skip(&mut self, count: u64) -> bool {
        let within = count <= self.left() as u64;
        if within {
            self.at += count as usize;
        }
        within
    }

    pub(super) fn slice(&self, range: Range<usize>) -> &[u8] {
        &self.bytes[range]
    }

    /// A mistake in the line taken last.
    #[cold]
    pub(super) fn wrong(&self, message: impl Into<String>) -> ReadError {
        ReadError::Line { line: self.line, message: message.into() }
    }
}

/// Words of a line, between white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A word as a message repeats it: not long, and nothing that moves a cursor.
pub(super) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * SHOWN)]);
    let mut text: String = text.trim().chars().map(|c| if c.is_control() { '�' } else { c }).collect();
    if let Some((end, _)) = text.char_indices().nth(SHOWN) {
        text.truncate(end);
        text.push('…');
    }
    text
}

/// A word as a number; `nan` and `inf` are numbers here.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    core::str::from_utf8(word).ok()?.parse().ok()
}

/// The number itself if it can be a coordinate called `name`.
pub(super) fn coordinate(value: f64, name: &str) -> Result<f64, String> {
    if value.abs() <= LARGEST {
        Ok(value)
    } else if value.is_finite() {
        Err(format!("{name} is {value:e}; up to {LARGEST:e} can be used"))
    } else {
        Err(format!("{name} is not a finite number; remove this point or export the file again"))
    }
}

/// A word as a coordinate called `name`.
pub(super) fn coordinate_word(word: &[u8], name: &str) -> Result<f64, String> {
    match number(word) {
        Some(value) => coordinate(value, name),
        None if word.contains(&b',') && number(&decimal_point(word)).is_some() => {
            Err(format!("`{}` has a decimal comma; write decimal points", shown(word)))
        }
        None => Err(format!("{name} is `{}`, which is not a number", shown(word))),
    }
}

fn decimal_point(word: &[u8]) -> Vec<u8> {
    word.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect()
}
