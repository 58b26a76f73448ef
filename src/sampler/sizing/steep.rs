//! Places where the requested radius changes much between neighbouring points of the survey, as at
//! a jump: points are added on the smaller side, up to a small share of a cell from it.

use crate::spatial::CellGrid;
use core::fmt::{self, Debug, Formatter};
use glam::Vec3;

/// Ratio of the radii of neighbouring points above which a step between them is searched for.
/// Smaller: more points are added, without use where the function is smooth.
const STEEP: f32 = 1.25;

/// Bisections of the way between two such points: a jump is found to a 32nd of their distance.
const HALVINGS: u32 = 5;

/// Largest number of added points for each one of the survey. Larger: a function that is steep
/// everywhere takes longer.
const MOST: usize = 4;

/// A point on the smaller side of a step.
pub(super) struct StepPoint {
    pub(super) position: Vec3,
    /// Radius requested there.
    pub(super) asked: f32,
    /// The point of the survey on the same side.
    pub(super) sample: usize,
}

/// Finds points on the smaller side of steps of a function. A step lies between points of the
/// survey within `reach` of each other; `asked` are the radii requested there. `ask` writes the
/// radii at places between them, which lie off the surface by a few thousandths of a cell.
pub(super) fn step_points(
    places: &[Vec3],
    asked: &[f32],
    reach: f32,
    ask: impl Fn(&[Vec3], &mut [f32]),
) -> Vec<StepPoint> {
    let mut grid = CellGrid::new(reach);
    for (i, &p) in (0..).zip(places) {
        grid.insert(p, i);
    }
    let (mut low, mut high, mut near) = (Vec::new(), Vec::new(), Vec::new());
    'all: for (i, &p) in places.iter().enumerate() {
        grid.gather(p, reach, &mut near);
        for other in &near {
            let j = other.index as usize;
            // Once for each pair; NaN is not above anything.
            if asked[j] > STEEP * asked[i] {
                low.push(StepPoint { position: p, asked: asked[i], sample: i });
                high.push((places[j], asked[j]));
            }
            if low.len() >= MOST * places.len() {
                break 'all;
            }
        }
    }
    let mut middle = vec![Vec3::ZERO; low.len()];
    let mut radius = vec![0.0; low.len()];
    for _ in 0..HALVINGS {
        for ((middle, low), high) in middle.iter_mut().zip(&low).zip(&high) {
            *middle = 0.5 * (low.position + high.0);
        }
        ask(&middle, &mut radius);
        for (k, (&position, &asked)) in middle.iter().zip(&radius).enumerate() {
            // Continues in the half with the larger ratio.
            if asked * asked <= low[k].asked * high[k].1 {
                (low[k].position, low[k].asked) = (position, asked.max(f32::MIN_POSITIVE));
            } else {
                high[k] = (position, asked);
            }
        }
    }
    low
}

/// Points that were added, for search by place.
#[derive(Clone, Default)]
pub(super) struct Steps {
    grid: CellGrid,
    reach: f32,
}

impl Debug for Steps {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Steps").field("reach", &self.reach).finish_non_exhaustive()
    }
}

impl Steps {
    /// The points with these numbers, each of which has an effect within `reach`.
    pub(super) fn new(points: impl Iterator<Item = (u32, Vec3)>, reach: f32) -> Self {
        let mut grid = CellGrid::new(reach);
        for (number, p) in points {
            grid.insert(p, number);
        }
        Self { grid, reach }
    }

    /// Calls `lower` with the number and the distance of each point within reach of `p`.
    pub(super) fn near(&self, p: Vec3, mut lower: impl FnMut(usize, f32)) {
        if !p.is_finite() {
            return;
        }
        let mut near = Vec::new();
        self.grid.gather(p, self.reach, &mut near);
        near.iter().for_each(|near| lower(near.index as usize, near.distance_sq.sqrt()));
    }
}
