//! Reader of XYZ files, with one point per line, with or without a normal, and of CSV files with a header.

use super::input::{Input, coordinate_word, number, quoted};
use super::mesh::FileMesh;
use super::{ReadError, RowReader, push};
use glam::DVec3;

/// Names of the components of a point, in headers and messages.
const NAMES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Lengths at which a vector may be a unit normal that was written with few digits: with one digit after the point each component
/// is off by 0.05 at most, and the length by 0.087.
const UNIT: core::ops::Range<f64> = 0.9..1.1;

/// Share of the rows with such a vector from which on columns 4 to 6 are normals: a normal is missing or zero here and there.
/// With half of it twelve random clouds are read the same.
const UNIT_SHARE: f64 = 0.9;

/// Columns of a line that hold the components of a point.
pub(super) struct ColumnLayout {
    /// Column of each component.
    index: [usize; 6],
    /// Number of columns.
    count: usize,
    has_normal: bool,
    /// Whether the file names its columns.
    named: bool,
}

impl ColumnLayout {
    /// Columns by a header; `None` if the line does not name x, y and z.
    pub(super) fn named(line: &[u8]) -> Option<Self> {
        let found = NAMES.map(|name| {
            words(line).position(|word| word.trim_ascii_start().eq_ignore_ascii_case(name.as_bytes()))
        });
        let [Some(x), Some(y), Some(z), normal @ ..] = found else { return None };
        let (nx, ny, nz, has_normal) = match normal {
            [Some(nx), Some(ny), Some(nz)] => (nx, ny, nz, true),
            _ => (0, 0, 0, false),
        };
        Some(Self { index: [x, y, z, nx, ny, nz], count: words(line).count(), has_normal, named: true })
    }

    /// Columns of lines of `count` numbers without a header.
    fn usual(count: usize) -> Self {
        Self { index: [0, 1, 2, 3, 4, 5], count, has_normal: count >= 6, named: false }
    }
}

#[derive(Default)]
pub(super) struct Xyz {
    columns: Option<ColumnLayout>,
    /// Number of rows whose columns 4 to 6 may be a unit normal.
    unit_normals: usize,
}

impl Xyz {
    /// Allocates memory for as many points as there are lines, if there is enough: growing would take twice the memory.
    pub(super) fn new(input: &Input, mesh: &mut FileMesh) -> Self {
        /// Minimum number of bytes of a line with a point: three digits, two spaces and the end of the line.
        const SHORTEST: usize = 6;
        let _ = mesh.position.try_reserve_exact(input.count_lines().min(input.remaining() / SHORTEST + 1));
        Self::default()
    }

    /// Drops the normals if they are probably colours, which columns without names may be.
    fn finish(&self, mesh: &mut FileMesh) {
        let named = self.columns.as_ref().is_some_and(|columns| columns.named);
        if !named && (self.unit_normals as f64) < UNIT_SHARE * mesh.normal.len() as f64 {
            mesh.normal = Vec::new();
            mesh.warnings.push(
                "Columns 4 to 6 are not of unit length, so they are no normals (colours?) and were left out."
                    .into(),
            );
        }
    }
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
        .map(|word| word.trim_ascii())
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

impl RowReader for Xyz {
    fn row(&mut self, input: &mut Input, mesh: &mut FileMesh) -> Result<bool, ReadError> {
        let Some(range) = input.line() else {
            self.finish(mesh);
            return Ok(false);
        };
        let line = input.slice(range);
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default().trim_ascii();
        if line.is_empty() || line.starts_with(b"//") {
            return Ok(true);
        }
        if line.contains(&b',') && has_decimal_commas(line) {
            return Err(input.line_error("the numbers have decimal commas; write decimal points"));
        }
        let count = words(line).count();
        let columns = match &self.columns {
            Some(columns) => columns,
            None => {
                if let Some(columns) = ColumnLayout::named(line) {
                    self.columns = Some(columns);
                    return Ok(true);
                }
                self.columns.insert(ColumnLayout::usual(count))
            }
        };
        if count < 3 {
            return Err(input.line_error(match words(line).next() {
                Some(word) if number(word).is_none() => {
                    format!("`{}` is no number; a point is x y z", quoted(word))
                }
                _ => format!("a point takes three numbers, x y z, or six with a normal; here is {count}"),
            }));
        }
        if count != columns.count {
            return Err(
                input.line_error(format!("{count} columns, where the lines before have {}", columns.count))
            );
        }
        let mut values = [0.0; 6];
        let used = if columns.has_normal { 6 } else { 3 };
        for (k, word) in words(line).enumerate() {
            for (component, name) in NAMES.iter().enumerate().take(used) {
                if columns.index[component] == k {
                    values[component] =
                        coordinate_word(word, name).map_err(|message| input.line_error(message))?;
                }
            }
        }
        let [x, y, z, nx, ny, nz] = values;
        push(&mut mesh.position, DVec3::new(x, y, z))?;
        if columns.has_normal {
            let normal = DVec3::new(nx, ny, nz);
            self.unit_normals += usize::from(UNIT.contains(&normal.length()));
            push(&mut mesh.normal, normal)?;
        }
        Ok(true)
    }
}
