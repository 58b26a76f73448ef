//! Varying sizes: those of the radius field, and the slope at which a level can follow them.

use super::net::{Ground, Net};
use crate::differential::{Curvature, curvatures};
use crate::sampler::sizing::Sizing;
use core::ops::Range;

/// Steepest slope of the spacing along the surface, whatever the level. The sizes of neighbours
/// then differ by a factor of 1.7 at most; beyond it triangles of the wanted sizes have angles that
/// are impossible with six neighbours each. Larger: angles are smaller, and the closest pairs
/// farther apart.
const MAX_SLOPE: f32 = 0.5;

/// Slope of the spacing at the level with `to_come` levels after it, if the radius has the slope
/// `grading`: with the spacing, the slope doubles from level to level.
pub(super) fn slope(grading: f32, to_come: u32) -> f32 {
    let own = 2.0 * grading;
    (own * (1_u32 << to_come) as f32).min(own.max(MAX_SLOPE))
}

impl Net {
    /// Takes the sizes of some particles from the radius field, in units of the radius `unit`:
    /// fully, or halfway from one size everywhere.
    pub(super) fn find_sizes(
        &mut self,
        ground: &mut Ground,
        sizing: &Sizing,
        unit: f32,
        is_whole: bool,
        particles: Range<u32>,
    ) {
        self.size.resize(self.position.len(), 1.0);
        let range = particles.start as usize..particles.end as usize;
        let curvature = &mut ground.block.curvature;
        curvature.resize(range.len(), Curvature::default());
        ground.probe.count(range.len() as u64);
        let points = &self.position[range.clone()];
        curvatures(ground.probe.field, points, curvature);
        let sizes = &mut self.size[range];
        sizing.radii(points, curvature, sizes);
        for size in sizes {
            let whole = *size / unit;
            *size = if is_whole { whole } else { whole.sqrt() };
        }
    }

    /// Lowers the sizes of some particles as far as their neighbours require, so that sizes differ
    /// by at most `rise` per unit of length.
    pub(super) fn limit_sizes(&mut self, rise: f32, particles: impl Iterator<Item = u32>) {
        for v in particles {
            let p = self.position[v as usize];
            let highest = |least: f32, other: u32| {
                let distance = (self.position[other as usize] - p).length();
                least.min(self.size[other as usize] + rise * distance)
            };
            self.size[v as usize] = self.mesh.neighbours(v).fold(self.size[v as usize], highest);
        }
    }
}
