//! Reader of text with a point a line: XYZ files, with or without a normal and other columns, CSV
//! files with a header, and PTS files, which begin with the number of their points.

use super::input::{self, Input, component, coordinate_number, number, quoted};
use super::mesh::FileMesh;
use super::{ReadError, push};
use crate::math::median;
use core::ops::Range;
use glam::DVec3;
use std::borrow::Cow;

/// Lengths at which a vector may be a normal that was written with few digits, over that of the
/// others: of unit normals with one digit after the point each component is off by 0.05 at most,
/// and the length by 0.087.
const ALIKE: Range<f64> = 0.9..1.1;

/// Share of the rows with such a vector from which on three columns are normals: a normal is
/// missing or zero here and there. Larger: fewer such gaps are tolerated. Smaller: columns of
/// another meaning are more easily taken for normals.
const ALIKE_SHARE: f64 = 0.9;

/// Number of points up to which no more is asked of normals than their length. More do not all face
/// one octant, as colours do, which have no negative components, and not all one way.
const FEW: usize = 8;

/// Columns among which normals are looked for: those of a point with intensity, a colour with
/// opacity, and a normal.
const LOOKED_AT: usize = 11;

/// Component of a point and its normal that each column of a file holds, if it holds one. Bytes,
/// because a line may have as many columns as half a file has bytes.
type XyzColumns = Vec<Option<u8>>;

/// The name of a column, which its unit may follow, as in `X [m]`.
fn without_unit(word: &[u8]) -> &[u8] {
    let end = word.iter().position(|byte| matches!(byte, b'[' | b'(')).unwrap_or(word.len());
    word[..end].trim_ascii()
}

/// Columns by the words of a header; `None` if they do not name x, y and z.
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

/// A word between separators, with a decimal point in the place of a decimal comma.
fn with_point(word: &[u8]) -> Cow<'_, [u8]> {
    let is_comma = |byte: &u8| *byte == b',';
    let has_digits = word.split(is_comma).all(|part| part.iter().any(u8::is_ascii_digit));
    if word.contains(&b'.') || word.iter().filter(|byte| is_comma(byte)).count() != 1 || !has_digits {
        return Cow::Borrowed(word);
    }
    let points = word.iter().map(|&byte| if byte == b',' { b'.' } else { byte });
    Cow::Owned(points.collect())
}

/// The character that separates the columns of a line, if it is one of those between which a column
/// may be empty.
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

/// The words of a line: between separators, if the line has any, where a word in quotes may hold
/// them; else between white space, commas and semicolons.
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

/// Whether the commas of a line without separators may be decimal commas: at least three words are
/// separated otherwise, and one has a comma between digits.
fn has_decimal_commas(line: &[u8]) -> bool {
    /// Number of words that are looked at. A point has three to six, with colours and other columns
    /// some more.
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

/// The text of a comment, if the line is one.
pub(super) fn comment(line: &[u8]) -> Option<&[u8]> {
    let text = [&b"#"[..], b"//", b"%"].into_iter().find_map(|mark| line.strip_prefix(mark))?;
    Some(text.trim_ascii())
}

/// The columns of the lines so far.
#[derive(Default)]
struct Known {
    /// The component that each column holds; empty before the first point and the header.
    columns: XyzColumns,
    separator: Option<u8>,
    /// Columns that a comment names, which may be a header.
    told: XyzColumns,
    /// Number of points that the file says it has.
    promised: Option<u64>,
    /// Whether a coordinate has a decimal comma, and whether one has a decimal point.
    has_commas: bool,
    has_points: bool,
}

impl Known {
    /// Takes a line that may come before the points: a header, or their number. Returns whether it
    /// is one.
    fn take_head(&mut self, words: &[&[u8]], input: &Input) -> Result<bool, ReadError> {
        let count = if let [word] = words { core::str::from_utf8(word).ok() } else { None };
        let count: Option<u64> = count.and_then(|word| word.parse().ok());
        if !self.columns.is_empty() {
            // Several clouds may follow each other, each after its number.
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
        // A comment that names no more than what is usual may be a sentence.
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
    // The columns in which normals may be, of lines without a header.
    let mut others = Others::default();
    while let Some(whole) = input.line() {
        input.end_row().await;
        let line = whole.trim_ascii();
        if let Some(text) = comment(line) {
            split(text, separator(text), &mut words);
            known.told = named(&words).unwrap_or(known.told);
            continue;
        }
        // A comment, but for the way in which an old library spells what is no number: 1.#QNAN.
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
            // The columns at the ends of the line may be empty, too.
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

/// The columns after the third of lines without a header, row by row.
#[derive(Default)]
struct Others {
    /// Number of columns.
    width: usize,
    values: Vec<f64>,
}

impl Others {
    /// Takes three columns that are normals for those of the points: of one length, and not all of
    /// them positive, as colours are.
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
        // Of another length they face all round.
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
