//! Particles on a surface with creases: each patch is a sheet of its own, which ends at its creases.

use crate::particles::Particles;

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
