//! Local coordinates in which the centres fill a box of about one unit.

use crate::math::{Bounds, power_of_two};
use glam::DVec3;

/// Grid of the origin in local units. The origin is a multiple of it, so that rounding of points
/// does not move it.
const GRID: f64 = 1.0 / 16.0;

/// Local coordinates s (x − o).
///
/// The box of the centres is centred at the origin up to a sixteenth, and its longest side is
/// between one and two. s is a power of two and o is representable in single precision, so the
/// transformation loses no digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentredFrame {
    origin: DVec3,
    scale: f64,
}

impl Default for CentredFrame {
    /// The frame whose local coordinates equal the model's.
    fn default() -> Self {
        Self { origin: DVec3::ZERO, scale: 1.0 }
    }
}

impl CentredFrame {
    /// Frame of `points`, which must be finite.
    #[must_use]
    pub fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let bounds = Bounds::around(points);
        let side = bounds.size().max_element();
        let scale = if side > 0.0 && side.is_finite() { power_of_two(side).recip() } else { 1.0 };
        let step = GRID / scale;
        let origin = ((bounds.lo() * 0.5 + bounds.hi() * 0.5) / step).round() * step;
        // For a model far from the origin, single precision may be coarser than the grid.
        let origin = origin.as_vec3().as_dvec3();
        Self { origin: if origin.is_finite() { origin } else { DVec3::ZERO }, scale }
    }

    /// The origin o.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The scale s.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Local coordinates of a point.
    #[must_use]
    pub fn local(&self, p: DVec3) -> DVec3 {
        (p - self.origin) * self.scale
    }

    /// A local point in the coordinates of the model.
    #[must_use]
    pub fn world(&self, p: DVec3) -> DVec3 {
        p / self.scale + self.origin
    }
}
