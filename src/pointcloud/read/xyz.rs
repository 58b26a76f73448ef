//! Reader of text with one point per line: XYZ files, with or without normals and other columns,
//! CSV files with a header, and PTS files, which begin with the number of points.

use super::input::{self, Input, component, coordinate_number, number, quoted};
use super::mesh::FileMesh;
use super::{ReadError, push};
use crate::math::median;
use core::ops::Range;
use glam::DVec3;
use std::borrow::Cow;

/// Range of a normal's length relative to the usual one, to allow for few digits: in a unit normal
/// with one decimal each component is off by at most 0.05, and the length by 0.087.
const ALIKE: Range<f64> = 0.9..1.1;

/// Share of rows with such a vector above which three columns count as normals; some normals may be
/// missing or zero. Larger: fewer gaps are tolerated. Smaller: columns with another meaning are
/// more easily mistaken for normals.
const ALIKE_SHARE: f64 = 0.9;

/// Up to this number of points only the length of normals is checked. More normals must not all lie
/// in one octant, as colours do, which are never negative, and must not all be equal.
const FEW: usize = 8;

/// Columns that are searched for normals: those of a point with intensity, a colour with opacity,
/// and a normal.
const LOOKED_AT: usize = 11;

/// The component of a point or normal that each column holds, if any. Bytes, because a line may
/// have half as many columns as a file has bytes.
type XyzColumns = Vec<Option<u8>>;

/// The name of a column without its unit, as in `X [m]`.
fn without_unit(word: &[u8]) -> &[u8] {
    let end = word.iter().position(|byte| matches!(byte, b'[' | b'(')).unwrap_or(word.len());
    word[..end].trim_ascii()
}

/// Columns according to a header; `None` if it does not name x, y and z.
fn named(words: &[&[u8]]) -> Option<XyzColumns> {
    let found: [Option<usize>; 6] =
        core::array::from_fn(|k| words.iter().position(|word| component(without_unit(word)) == Some(k)));
    let used = if found.contains(&None) { 3 } else { 6 };
    let mut columns = vec![None; words.len()];
    for (component, column) in (0..).zip(found).take(used) {
        columns[column?] = Some(component);
    }
    Some(columns)
}

/// Whether a line may be the first of such a file: it begins with a number, or names x, y and z.
pub(super) fn begins_with(line: &[u8]) -> bool {
    let mut words = Vec::new();
    split(line, separator(line), &mut words);
    words.first().is_some_and(|word| number(&with_point(word)).is_some()) || named(&words).is_some()
}

/// A word with a decimal point instead of a decimal comma.
fn with_point(word: &[u8]) -> Cow<'_, [u8]> {
    let is_comma = |byte: &u8| *byte == b',';
    let has_digits = word.split(is_comma).all(|part| part.iter().any(u8::is_ascii_digit));
    if word.contains(&b'.') || word.iter().filter(|byte| is_comma(byte)).count() != 1 || !has_digits {
        return Cow::Borrowed(word);
    }
    let points = word.iter().map(|&byte| if byte == b',' { b'.' } else { byte });
    Cow::Owned(points.collect())
}

/// The character that separates the columns of a line, if it is one of those that allow empty
/// columns.
fn separator(line: &[u8]) -> Option<u8> {
    let mut words = Vec::new();
    [b';', b',', b'\t'].into_iter().find(|&separator| {
        split(line, Some(separator), &mut words);
        let is_single = |word: &&[u8]| !word.iter().any(u8::is_ascii_whitespace);
        line.contains(&separator)
            && words.len() >= 3
            && (words.iter().all(is_single) || named(&words).is_some())
    })
}

/// The words of a line. If the line contains the separator, words are between separators, and a
/// word in quotes may contain them; otherwise words are between white space, commas and semicolons.
fn split<'a>(line: &'a [u8], separator: Option<u8>, words: &mut Vec<&'a [u8]>) {
    words.clear();
    if let Some(separator) = separator.filter(|separator| line.contains(separator)) {
        let mut is_quoted = false;
        words.extend(line.split(|&byte| {
            is_quoted ^= byte == b'"';
            byte == separator && !is_quoted
        }));
    } else {
        let words_of = line.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';'));
        words.extend(words_of.filter(|word| !word.is_empty()));
    }
    for word in words {
        *word = word.trim_ascii();
        let inner = word.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        *word = inner.unwrap_or(word);
    }
}

/// Whether commas in a line without separators may be decimal commas: at least three words are
/// separated otherwise, and one has a comma between digits.
fn has_decimal_commas(line: &[u8]) -> bool {
    /// Number of words that are checked. A point has three to six; colours and other columns add
    /// some.
    const LOOKED_AT: usize = 16;
    let by_others: Vec<&[u8]> = line
        .split(|byte| byte.is_ascii_whitespace() || *byte == b';')
        .filter(|word| !word.is_empty())
        .take(LOOKED_AT)
        .collect();
    by_others.len() >= 3
        && by_others.iter().any(|word| {
            let comma = word.iter().position(|&byte| byte == b',');
            comma.is_some_and(|at| {
                0 < at && at + 1 < word.len() && word[at + 1..].iter().all(u8::is_ascii_digit)
            })
        })
}

/// The text of a comment, if the line is a comment.
pub(super) fn comment(line: &[u8]) -> Option<&[u8]> {
    let text = [&b"#"[..], b"//", b"%"].into_iter().find_map(|mark| line.strip_prefix(mark))?;
    Some(text.trim_ascii())
}

/// What the lines so far tell about the columns.
#[derive(Default)]
struct Known {
    /// The component that each column holds; empty before the first point and the header.
    columns: XyzColumns,
    separator: Option<u8>,
    /// Columns that a comment names; it may be a header.
    told: XyzColumns,
    /// Number of points according to the file.
    promised: Option<u64>,
    /// Whether a coordinate has a decimal comma, and whether one has a decimal point.
    has_commas: bool,
    has_points: bool,
}

impl Known {
    /// Handles a line that may come before the points: a header, or their number. Returns whether
    /// it is one.
    fn take_head(&mut self, words: &[&[u8]], input: &Input) -> Result<bool, ReadError> {
        let count = if let [word] = words { core::str::from_utf8(word).ok() } else { None };
        let count: Option<u64> = count.and_then(|word| word.parse().ok());
        if !self.columns.is_empty() {
            // Several clouds may follow each other, each after its number of points.
            self.promised = self.promised.map(|promised| promised.saturating_add(count.unwrap_or(0)));
            return Ok(self.promised.is_some() && count.is_some());
        }
        if count.is_some() {
            if self.promised.is_some() {
                return Err(input.error(
                    "a point takes three numbers, x y z; here is 1. A PTX scan begins with the size of its grid: export it as PTS or PLY",
                ));
            }
            self.promised = count;
            return Ok(true);
        }
        let told = core::mem::take(&mut self.told);
        if let Some(columns) = named(words) {
            self.columns = columns;
            return Ok(true);
        }
        // A comment that names only x, y and z may be a sentence.
        let is_usual = told.starts_with(&[Some(0), Some(1), Some(2)]) && !told.contains(&Some(5));
        if told.len() == words.len() && !is_usual {
            self.columns = told;
        }
        Ok(false)
    }
}

/// Reads the points.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let mut known = Known::default();
    let mut words: Vec<&[u8]> = Vec::new();
    // Columns of lines without a header, which may hold normals.
    let mut others = Others::default();
    while let Some(whole) = input.line() {
        input.end_row().await;
        let line = whole.trim_ascii();
        if let Some(text) = comment(line) {
            split(text, separator(text), &mut words);
            known.told = named(&words).unwrap_or(known.told);
            continue;
        }
        // Find a comment, but not in 1.#QNAN, an old library's NaN.
        let end = (0..line.len()).find(|&at| line[at] == b'#' && line[at - 1] != b'.');
        let line = line[..end.unwrap_or(line.len())].trim_ascii();
        if line.is_empty() {
            continue;
        }
        if known.columns.is_empty() {
            known.separator = separator(line);
        }
        if known.separator.is_none() && line.contains(&b',') && has_decimal_commas(line) {
            return Err(input.error("the numbers have decimal commas; write decimal points"));
        }
        split(line, known.separator, &mut words);
        if known.separator == Some(b'\t') && words.len() < known.columns.len() {
            // The first and last columns of the line may be empty, too.
            let start = whole.len() - whole.trim_ascii_start().len();
            let end = end.map_or(whole.len(), |end| start + end);
            split(&whole[..end], known.separator, &mut words);
        }
        // A separator may end the line.
        let most = if known.columns.is_empty() { 0 } else { known.columns.len() };
        if words.len() > most && words.last().is_some_and(|word| word.is_empty()) {
            words.pop();
        }
        if known.take_head(&words, input)? {
            continue;
        }
        let count = words.len();
        if count < 3 {
            return Err(input.error(match words.first() {
                Some(word) if number(word).is_none() => {
                    format!("`{}` is no number; a point is x y z", quoted(word))
                }
                _ => format!("a point takes three numbers, x y z, or six with a normal; here is {count}"),
            }));
        }
        if known.columns.is_empty() {
            known.columns = (0..count).map(|column| (column < 3).then_some(column as u8)).collect();
            others.width = count.clamp(3, LOOKED_AT) - 3;
        }
        if count != known.columns.len() {
            let before = known.columns.len();
            return Err(input.error(format!("{count} columns, where the lines before have {before}")));
        }
        let mut values = [0.0; 6];
        for (word, &component) in words.iter().zip(&known.columns) {
            if let Some(component) = component.map(usize::from) {
                let number = with_point(word);
                known.has_commas |= matches!(number, Cow::Owned(_));
                known.has_points |= word.contains(&b'.');
                values[component] = input.coordinate_of(&number, input::COMPONENTS[component])?;
            }
        }
        if known.has_commas && known.has_points {
            return Err(
                input.error("some numbers have a decimal comma, others a point; write decimal points")
            );
        }
        mesh.add_point(values, known.columns.contains(&Some(5)))?;
        for word in &words[3..3 + others.width] {
            push(&mut others.values, coordinate_number(&with_point(word)).unwrap_or(f64::NAN))?;
        }
    }
    if let Some(promised) = known.promised.filter(|&promised| promised != mesh.position.len() as u64) {
        let count = mesh.position.len();
        mesh.warnings.push(format!("The file says that it has {promised} points, and {count} follow."));
    }
    others.become_normals(mesh)
}

/// The columns after the third, row by row, of lines without a header.
#[derive(Default)]
struct Others {
    /// Number of columns.
    width: usize,
    values: Vec<f64>,
}

impl Others {
    /// Uses three columns as normals if their vectors have one length and, unlike colours, are not
    /// all positive.
    fn become_normals(self, mesh: &mut FileMesh) -> Result<(), ReadError> {
        let rows = mesh.position.len();
        let Some(triples) = self.width.checked_sub(2).filter(|_| rows > 0) else { return Ok(()) };
        let vectors = |from: usize| {
            let rows = self.values.chunks_exact(self.width);
            rows.map(move |row| DVec3::new(row[from], row[from + 1], row[from + 2]))
        };
        // Whether nearly all vectors have about this length.
        let are_of = |from: usize, usual: f64| {
            let alike = vectors(from).filter(|vector| ALIKE.contains(&(vector.length() / usual))).count();
            alike as f64 >= ALIKE_SHARE * rows as f64
        };
        let varies = |from: usize| {
            let first = vectors(from).next();
            vectors(from).any(|vector| vector.min_element() < 0.0)
                && vectors(from).any(|vector| Some(vector) != first)
        };
        let are_unit = |&from: &usize| are_of(from, 1.0) && (rows <= FEW || varies(from));
        // Vectors of another length must face all directions.
        let are_alike = |&from: &usize| {
            let (low, high) = vectors(from)
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), vector| {
                    (low.min(vector), high.max(vector))
                });
            let faces_all_round = low.max_element() < 0.0 && high.min_element() > 0.0;
            let usual = || median(vectors(from).map(DVec3::length).collect()).unwrap_or(1.0);
            rows > FEW && faces_all_round && are_of(from, usual())
        };
        if let Some(from) = (0..triples).find(are_unit).or_else(|| (0..triples).find(are_alike)) {
            mesh.normal.try_reserve_exact(rows).map_err(|_| ReadError::Memory)?;
            mesh.normal.extend(vectors(from));
        } else {
            mesh.warnings.push(format!(
                "Columns 4 to {} are no normals (colours? intensity?) and were left out.",
                self.width + 3
            ));
        }
        Ok(())
    }
}
