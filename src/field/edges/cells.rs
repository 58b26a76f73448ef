//! Look-ups of points by place.

use crate::math::Bounds;
use glam::DVec3;

/// Indices of points, sorted by the cell in which each lies.
#[derive(Debug)]
pub(super) struct Cells {
    lo: DVec3,
    side: f64,
    count: [usize; 3],
    /// The first of the points of each cell.
    start: Vec<u32>,
    points: Vec<u32>,
}

impl Cells {
    pub(super) fn new(side: f64, points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let around = Bounds::around(points.clone());
        let count = (around.size() / side).floor().to_array().map(|cells| cells as usize + 1);
        let mut cells = Self { lo: around.lo(), side, count, start: Vec::new(), points: Vec::new() };
        let mut own: Vec<(usize, u32)> =
            points.zip(0..).map(|(p, k)| (cells.index(cells.cell(p).map(|x| x as usize)), k)).collect();
        own.sort_unstable();
        let mut next = own.iter().peekable();
        for cell in 0..=count.into_iter().product() {
            cells.start.push(cells.points.len() as u32);
            while let Some(&(_, k)) = next.next_if(|(of, _)| *of == cell) {
                cells.points.push(k);
            }
        }
        cells
    }

    /// The cell of a place, which may lie outside.
    fn cell(&self, p: DVec3) -> [i64; 3] {
        ((p - self.lo) / self.side).floor().to_array().map(|x| x as i64)
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }

    /// The points in the cells of a range along each axis.
    fn between(&self, lo: [i64; 3], hi: [i64; 3]) -> impl Iterator<Item = u32> + '_ {
        let range = |axis: usize| {
            let last = self.count[axis] as i64 - 1;
            lo[axis].max(0) as usize..(hi[axis].min(last) + 1).max(0) as usize
        };
        let (xs, ys) = (range(0), range(1));
        let rows = range(2).flat_map(move |z| ys.clone().map(move |y| [y, z]));
        let ranges = rows.filter(move |_| xs.start < xs.end).map({
            let (first, end) = (range(0).start, range(0).end);
            move |[y, z]| {
                let [first, last] = [first, end - 1].map(|x| self.index([x, y, z]));
                self.start[first] as usize..self.start[last + 1] as usize
            }
        });
        ranges.flat_map(|range| self.points[range].iter().copied())
    }

    /// The points in the cell of a place and in those around it.
    pub(super) fn around(&self, p: DVec3) -> impl Iterator<Item = u32> + '_ {
        let cell = self.cell(p);
        self.between(cell.map(|x| x.saturating_sub(1)), cell.map(|x| x.saturating_add(1)))
    }

    /// The points in the cells of a box.
    pub(super) fn within(&self, bounds: &Bounds) -> impl Iterator<Item = u32> + '_ {
        self.between(self.cell(bounds.lo()), self.cell(bounds.hi()))
    }
}
