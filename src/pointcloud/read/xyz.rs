//! XYZ: a point a line, with or without a normal; also CSV with a line of names.

use super::input::{Input, coordinate_word, number, shown};
use super::mesh::Mesh;
use super::{ReadError, Rows, push};
use glam::DVec3;

/// Names of the numbers of a point, as a header and the messages have them.
const NAMES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Lengths between which a vector can be meant as a unit normal, written with few digits.
const UNIT: core::ops::Range<f64> = 0.9..1.1;

/// Share of the rows that must have such for columns 4 to 6 to be normals.
const UNIT_SHARE: f64 = 0.9;

/// Where in a line the numbers of a point are.
pub(super) struct Columns {
    place: [usize; 6],
    count: usize,
    has_normal: bool,
    /// Whether the file names them.
    named: bool,
}

impl Columns {
    /// The columns of a line of names, if it is one that names x, y and z.
    pub(super) fn named(line: &[u8]) -> Option<Self> {
        let found = NAMES.map(|name| {
            words(line).position(|word| word.trim_ascii_start().eq_ignore_ascii_case(name.as_bytes()))
        });
        let [Some(x), Some(y), Some(z), normal @ ..] = found else { return None };
        let (nx, ny, nz, has_normal) = match normal {
            [Some(nx), Some(ny), Some(nz)] => (nx, ny, nz, true),
            _ => (0, 0, 0, false),
        };
        Some(Self { place: [x, y, z, nx, ny, nz], count: words(line).count(), has_normal, named: true })
    }

    /// The usual columns in lines of `count` numbers.
    fn usual(count: usize) -> Self {
        Self { place: [0, 1, 2, 3, 4, 5], count, has_normal: count >= 6, named: false }
    }
}

#[derive(Default)]
pub(super) struct Xyz {
    columns: Option<Columns>,
    /// Rows whose columns 4 to 6 can be a unit normal.
    unit: usize,
}

impl Xyz {
    /// Takes room for as many points as there are lines, where there is so much: a column that grows takes twice its room.
    pub(super) fn new(input: &Input, mesh: &mut Mesh) -> Self {
        /// Bytes of the shortest line with a point.
        const SHORTEST: usize = 6;
        let _ = mesh.position.try_reserve_exact(input.count_lines().min(input.left() / SHORTEST + 1));
        Self::default()
    }

    /// Columns without names can be colours as well as normals.
    fn finish(&self, mesh: &mut Mesh) {
        let named = self.columns.as_ref().is_some_and(|columns| columns.named);
        if !named && (self.unit as f64) < UNIT_SHARE * mesh.normal.len() as f64 {
            mesh.normal = Vec::new();
            mesh.warnings.push(
                "Columns 4 to 6 are not of unit length, so they are no normals (colours?) and were left out."
                    .into(),
            );
        }
    }
}

/// Words of a line, between white space, commas and semicolons.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';'))
        .filter(|word| !word.is_empty())
}

/// Whether the commas of a line stand in its numbers: some words are set apart by something else, and a comma has no white
/// space beside it.
fn has_decimal_commas(line: &[u8]) -> bool {
    /// Words that are looked at.
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

impl Rows for Xyz {
    fn row(&mut self, input: &mut Input, mesh: &mut Mesh) -> Result<bool, ReadError> {
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
            return Err(input.wrong("the numbers have decimal commas; write decimal points"));
        }
        let count = words(line).count();
        let columns = match &self.columns {
            Some(columns) => columns,
            None => {
                if let Some(columns) = Columns::named(line) {
                    self.columns = Some(columns);
                    return Ok(true);
                }
                self.columns.insert(Columns::usual(count))
            }
        };
        if count < 3 {
            return Err(input.wrong(match words(line).next() {
                Some(word) if number(word).is_none() => {
                    format!("`{}` is no number; a point is x y z", shown(word))
                }
                _ => format!("a point takes three numbers, x y z, or six with a normal; here is {count}"),
            }));
        }
        if count != columns.count {
            return Err(
                input.wrong(format!("{count} columns, where the lines before have {}", columns.count))
            );
        }
        let mut values = [0.0; 6];
        let used = if columns.has_normal { 6 } else { 3 };
        for (k, word) in words(line).enumerate() {
            for (slot, name) in NAMES.iter().enumerate().take(used) {
                if columns.place[slot] == k {
                    values[slot] = coordinate_word(word, name).map_err(|message| input.wrong(message))?;
                }
            }
        }
        let [x, y, z, nx, ny, nz] = values;
        push(&mut mesh.position, DVec3::new(x, y, z))?;
        if columns.has_normal {
            let normal = DVec3::new(nx, ny, nz);
            self.unit += usize::from(UNIT.contains(&normal.length()));
            push(&mut mesh.normal, normal)?;
        }
        Ok(true)
    }
}
