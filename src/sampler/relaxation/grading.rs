//! Grading: no radius exceeds that of a neighbour on the same sheet by more than the slope of the
//! radius field times their distance.
//!
//! The radius field has this slope by construction, but a radius is brought up to date only after
//! its particle has travelled some way. A pass over all pairs lowers the radii that are too large;
//! passes are repeated until one changes nothing, which happens because radii only fall and the
//! smallest never does.

use crate::particles::Particles;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::sheet::face_one_way;
use core::ops::Range;

/// Grades the near pairs of the particles of `range`. Returns whether a radius was lowered.
pub(super) fn grade_near(
    slope: f32,
    pairs: &PackedNeighbours,
    particles: &mut Particles,
    range: Range<usize>,
) -> bool {
    let mut has_lowered = false;
    for i in range {
        for j in pairs.near(i) {
            has_lowered |= grade(slope, particles, i, j);
        }
    }
    has_lowered
}

/// Grades the far pairs, and gives all rows of a particle the least radius of them. Returns whether
/// a radius was lowered.
pub(super) fn grade_far(slope: f32, pairs: &PackedNeighbours, particles: &mut Particles) -> bool {
    let mut has_lowered = false;
    for &[i, j] in pairs.far() {
        has_lowered |= grade(slope, particles, i as usize, j as usize);
    }
    particles.share_radii() || has_lowered
}

/// Lowers the larger of two radii to what the slope allows beside the smaller, if the particles
/// face the same way. Returns whether it was lowered.
fn grade(slope: f32, particles: &mut Particles, i: usize, j: usize) -> bool {
    let rise = slope * (particles.local[i] - particles.local[j]).length();
    let (a, b) = (particles.radius[i], particles.radius[j]);
    let is_steep = (a > b + rise || b > a + rise) && face_one_way(particles.normal[i], particles.normal[j]);
    if is_steep && a > b {
        particles.radius[i] = b + rise;
    } else if is_steep {
        particles.radius[j] = a + rise;
    }
    is_steep
}
