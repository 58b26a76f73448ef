//! Reader of XYZ files, with one point per line, with or without a normal, and of CSV files with a header.

use super::ReadError;
use super::input::{COMPONENTS, Input, number, quoted};
use super::mesh::FileMesh;

/// Lengths at which a vector may be a unit normal that was written with few digits: with one digit after the point each component
/// is off by 0.05 at most, and the length by 0.087.
const UNIT: core::ops::Range<f64> = 0.9..1.1;

/// Share of the rows with such a vector from which on columns 4 to 6 are normals: a normal is missing or zero here and there.
/// With half of it twelve random clouds are read the same.
const UNIT_SHARE: f64 = 0.9;

/// Component of a point and its normal that each column of a file holds, if it holds one. Bytes, because a line may have as many columns
/// as half a file has bytes.
type XyzColumns = Vec<Option<u8>>;

/// Columns by a header; `None` if the line does not name x, y and z.
pub(super) fn named(line: &[u8]) -> Option<XyzColumns> {
    let found =
        COMPONENTS.map(|name| words(line).position(|word| word.eq_ignore_ascii_case(name.as_bytes())));
    let used = if found.contains(&None) { 3 } else { 6 };
    let mut columns = vec![None; words(line).count()];
    for (component, column) in (0..).zip(found).take(used) {
        columns[column?] = Some(component);
    }
    Some(columns)
}

/// Columns of lines of `count` numbers without a header.
fn usual(count: usize) -> XyzColumns {
    let used = if count < 6 { 3 } else { 6 };
    (0..count).map(|column| (column < used).then_some(column as u8)).collect()
}

/// Words of a line, separated by white space, commas or semicolons.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';'))
        .filter(|word| !word.is_empty())
}

/// Whether the commas of a line are decimal commas: at least three words are separated otherwise, and one has a comma
/// between digits.
fn has_decimal_commas(line: &[u8]) -> bool {
    /// Number of words that are looked at. A point has three to six, with colours and other columns some more.
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

/// Reads the points.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let mut header = None;
    let mut columns = XyzColumns::new();
    let mut unit_normals = 0_usize;
    while let Some(line) = input.line() {
        input.end_row().await;
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default().trim_ascii();
        if line.is_empty() || line.starts_with(b"//") {
            continue;
        }
        if line.contains(&b',') && has_decimal_commas(line) {
            return Err(input.error("the numbers have decimal commas; write decimal points"));
        }
        let count = words(line).count();
        if columns.is_empty() {
            header = named(line);
            columns = header.clone().unwrap_or_else(|| usual(count));
            if header.is_some() {
                continue;
            }
        }
        if count < 3 {
            return Err(input.error(match words(line).next() {
                Some(word) if number(word).is_none() => {
                    format!("`{}` is no number; a point is x y z", quoted(word))
                }
                _ => format!("a point takes three numbers, x y z, or six with a normal; here is {count}"),
            }));
        }
        if count != columns.len() {
            let before = columns.len();
            return Err(input.error(format!("{count} columns, where the lines before have {before}")));
        }
        let mut values = [0.0; COMPONENTS.len()];
        for (word, &component) in words(line).zip(&columns) {
            if let Some(component) = component.map(usize::from) {
                values[component] = input.coordinate_of(word, COMPONENTS[component])?;
            }
        }
        mesh.add_point(values, columns.contains(&Some(5)))?;
        if let Some(normal) = mesh.normal.last() {
            unit_normals += usize::from(UNIT.contains(&normal.length()));
        }
    }
    // Columns without names may be colours.
    if header.is_none() && (unit_normals as f64) < UNIT_SHARE * mesh.normal.len() as f64 {
        mesh.normal = Vec::new();
        mesh.warnings.push(
            "Columns 4 to 6 are not of unit length, so they are no normals (colours?) and were left out."
                .into(),
        );
    }
    Ok(())
}
