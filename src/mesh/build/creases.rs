//! Particles on a surface with creases: each patch is a sheet of its own, which ends at its creases.

use crate::particles::{OppositeFaces, Particles};

/// The rows of one patch, and its border.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    /// The rows, in ascending order.
    pub(super) rows: Vec<u32>,
    /// Pairs of places in `rows` that follow each other along a crease, with the patch on the left.
    pub(super) border: Vec<[u32; 2]>,
}

impl Sheet {
    /// The sheets of all patches, in the order of their numbers.
    pub(super) fn all(particles: &Particles) -> Vec<Self> {
        let mut rows: Vec<(u32, u32)> = particles.patch.iter().copied().zip(0..).collect();
        rows.sort_unstable();
        let mut sheets: Vec<Self> = Vec::new();
        // Number of the sheet of each row, and the row's place in it.
        let mut place = vec![(0, 0); rows.len()];
        let mut last = None;
        for (patch, row) in rows {
            if last.replace(patch) != Some(patch) {
                sheets.push(Self::default());
            }
            let number = sheets.len() - 1;
            place[row as usize] = (number, sheets[number].rows.len() as u32);
            sheets[number].rows.push(row);
        }
        // The rows of each particle on a crease, one particle after the other.
        let mut of_first: Vec<(u32, u32)> = particles.twins.iter().copied().zip(0..).collect();
        of_first.sort_unstable();
        let rows_of = |first: u32| {
            let start = of_first.partition_point(|&(other, _)| other < first);
            of_first[start..].iter().take_while(move |&&(other, _)| other == first).map(|&(_, row)| row)
        };
        for (&[a, b], &[left, right]) in particles.segments.iter().zip(&particles.sides) {
            for (from, to, patch) in [(a, b, left), (b, a, right)] {
                let row = |first| rows_of(first).find(|&row| particles.patch[row as usize] == patch);
                if let (Some(from), Some(to)) = (row(from), row(to)) {
                    let ((sheet, from), (_, to)) = (place[from as usize], place[to as usize]);
                    sheets[sheet].border.push([from, to]);
                }
            }
        }
        sheets
    }
}

/// Repeats what lies on the lower of two opposite faces of a cell on the upper one: triangles and the loops around holes, by rows of
/// particles on these patches.
pub(super) fn repeat(
    triangles: &mut Vec<[u32; 3]>,
    unfilled: &mut Vec<Vec<u32>>,
    faces: &OppositeFaces,
    patch: &[u32],
) {
    let mut rows = faces.rows.clone();
    rows.sort_unstable();
    let image = |row: u32| rows[rows.partition_point(|pair| pair[0] < row)][1];
    let is_lower = |row: u32| patch[row as usize] == faces.patches[0];
    let lower: Vec<[u32; 3]> = triangles.iter().copied().filter(|triangle| is_lower(triangle[0])).collect();
    triangles.extend(lower.into_iter().map(|[a, b, c]| [a, c, b].map(image)));
    let holes: Vec<Vec<u32>> = unfilled.iter().filter(|hole| is_lower(hole[0])).cloned().collect();
    unfilled.extend(holes.into_iter().map(|hole| hole.into_iter().rev().map(image).collect()));
}
