//! Gaussian cube files: densities and orbitals of molecules on a grid, as text.

use super::header::{first_of, lines, numbers, quoted, wrong};
use super::zip::Unpacked;
use super::{ImageFormat, ImageReadError, MAX_IMAGE_BYTES};
use crate::image::voxels::Voxels;
use crate::image::{AxisOrder, Image, Placement};
use crate::slices::{MEDIUM, pause};
use glam::{DMat3, DVec3};

const FORMAT: ImageFormat = ImageFormat::Cube;
/// Upper limits on the size of a header and of a value in the text, in bytes: a number in double
/// precision has up to 24 characters, and some programs add spaces.
const HEADER: u64 = 1 << 20;
const VALUE: u64 = 32;

/// The numbers of a header: in line 3 the number of atoms and the origin, in lines 4 to 6 the
/// number of voxels along an axis and the step between them.
struct Head {
    atoms: i64,
    origin: DVec3,
    size: [usize; 3],
    axes: [DVec3; 3],
    /// Values for each voxel: the fifth number of line 3, else 1.
    values: usize,
}

/// The four or five numbers of a line of the header, counted from 1; none if it has others.
fn row(start: &[u8], number: usize) -> Option<Vec<f64>> {
    let (_, line, _) = lines(start).nth(number - 1)?;
    numbers(line).filter(|row| (4..=5).contains(&row.len()) && row[0].fract() == 0.0)
}

pub(super) fn begins_with(start: &[u8]) -> bool {
    (3..=6).all(|number| row(start, number).is_some())
}

fn head(start: &[u8]) -> Result<Head, ImageReadError> {
    let row = |number: usize| {
        row(start, number).ok_or_else(|| {
            wrong(
                FORMAT,
                format!("line {number}"),
                "it is no whole number with a vector; export the file again",
            )
        })
    };
    let vector = |row: &[f64]| DVec3::from_slice(&row[1..4]);
    let first = row(3)?;
    let rows = [row(4)?, row(5)?, row(6)?];
    // A negative number of voxels means that lengths are in ångström.
    let size = [0, 1, 2].map(|k| rows[k][0].abs() as usize);
    let values = first.get(4).map_or(1, |values| values.max(1.0) as usize);
    Ok(Head {
        atoms: first[0] as i64,
        origin: vector(&first),
        size,
        axes: [0, 1, 2].map(|k| vector(&rows[k])),
        values,
    })
}

/// Reads a cube file, whose last axis changes fastest, in slices of work.
pub(super) async fn read(mut file: Unpacked) -> Result<Image, ImageReadError> {
    let start = file.start(super::header::LONGEST).await?;
    let Head { atoms, origin, size, axes, mut values } = head(&start)?;
    let count = size.iter().try_fold(1_u64, |product, &n| product.checked_mul(n as u64));
    let bytes = |values: usize| count.and_then(|count| count.checked_mul(4)?.checked_mul(values as u64));
    let too_large = |values: usize| bytes(values).filter(|bytes| *bytes <= MAX_IMAGE_BYTES).is_none();
    if too_large(values) {
        return Err(ImageReadError::TooLarge { bytes: bytes(values).unwrap_or(u64::MAX) });
    }
    let count = count.unwrap_or(0);
    let limit = HEADER.saturating_add(count.saturating_mul(VALUE * values.max(64) as u64));
    let text = file.all(limit).await?;
    // The header has two comments, four rows and the atoms; a negative number of atoms means that a
    // list of orbitals follows.
    let mut at = lines(&text)
        .nth(5 + atoms.unsigned_abs().min(1 << 20) as usize)
        .map_or(text.len(), |(.., behind)| behind);
    let mut notes = Vec::new();
    let mut words = words(&text[at..]);
    if atoms < 0 {
        let orbitals = words.next().and_then(|(_, word)| word.parse::<usize>().ok()).unwrap_or(0);
        values = values.max(orbitals).max(1);
        if too_large(values) {
            return Err(ImageReadError::TooLarge { bytes: bytes(values).unwrap_or(u64::MAX) });
        }
        let last = if orbitals > 0 { words.nth(orbitals - 1) } else { None };
        at += last.map_or(0, |(end, _)| end);
        words = self::words(&text[at..]);
    }
    if values > 1 {
        notes.push(first_of(values, "values for each voxel"));
    }
    let mut voxels: Vec<f32> = Vec::new();
    for index in 0..count {
        let Some((_, word)) = words.next() else {
            let (needed, found) = (count * values as u64, index * values as u64);
            let message = format!(
                "{needed} values are promised and {found} follow; the file is cut off: export it again"
            );
            return Err(wrong(FORMAT, "values", message));
        };
        let value: Option<f64> = word.replace(['D', 'd'], "E").parse().ok();
        let value = value.ok_or_else(|| {
            wrong(FORMAT, format!("value {}", index + 1), format!("{} is not a number", quoted(word)))
        })?;
        voxels.push(value as f32);
        for _ in 1..values {
            words.next();
        }
        if index % MEDIUM as u64 == 0 {
            pause().await;
        }
    }
    let image = Image::of(size, AxisOrder::LastFastest, Voxels::filtered(voxels)).await?;
    let placement = Placement::new(DMat3::from_cols(axes[0], axes[1], axes[2]), origin)?;
    Ok(Image { notes: notes.into(), ..image }.placed(placement))
}

/// The words of a text, each with the position after it.
fn words(text: &[u8]) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 0;
    core::iter::from_fn(move || {
        let start = at + text[at..].iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = text[start..].iter().position(u8::is_ascii_whitespace);
        at = length.map_or(text.len(), |length| start + length);
        Some((at, core::str::from_utf8(&text[start..at]).unwrap_or("?")))
    })
}
