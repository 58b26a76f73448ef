//! Local coordinates, in which a model fills a box of about one unit.

use glam::DVec3;

/// The origin is a multiple of this, in local units, so that rounding a few points does not move it.
const GRID: f64 = 1.0 / 16.0;

/// Local coordinates s (x − o): the centres' box is centred on the origin but for a sixteenth, and its longest side is
/// between one and two units. s is a power of two and o is a number of single precision, so the change costs no digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    origin: DVec3,
    scale: f64,
}

impl Frame {
    /// The frame of these points, which are finite.
    #[must_use]
    pub fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lo, hi) = points.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)));
        let side = (hi - lo).max_element();
        let scale = if side > 0.0 && side.is_finite() { power_of_two(side).recip() } else { 1.0 };
        let step = GRID / scale;
        let origin = ((lo * 0.5 + hi * 0.5) / step).round() * step;
        // A far model's origin may have no number of single precision so near; then the nearest will do.
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

    /// A point in local coordinates.
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

/// The largest power of two that is not above `x`, a positive number; of tiny numbers the least normal one.
fn power_of_two(x: f64) -> f64 {
    /// Of the sign and the exponent.
    const HEAD: u64 = 0xfff << 52;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & HEAD)
}
