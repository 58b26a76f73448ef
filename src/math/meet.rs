//! How two smooth pieces of a surface meet.

use glam::DVec3;

/// Sine of the least angle between two pieces of a surface that counts as an edge: one degree, less
/// than light and shadow show.
pub(crate) const SHARP: f64 = 0.0175;

/// How two smooth pieces of a surface meet at a point of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Meet {
    /// Without an edge: their normals are equal to one degree.
    Tangent,
    /// At an edge. If the normals are opposite, the edge is a cusp.
    Sharp,
}

impl Meet {
    /// How two functions meet at a common zero, from their gradients there. None if a gradient is
    /// zero or not finite.
    pub(crate) fn of_gradients(gradients: [DVec3; 2]) -> Option<Self> {
        let [u, v] = gradients.map(DVec3::normalize_or_zero);
        (u != DVec3::ZERO && v != DVec3::ZERO).then(|| Self::of_normals([u, v]))
    }

    /// How two pieces meet whose unit normals at a common point are these.
    pub(crate) fn of_normals([u, v]: [DVec3; 2]) -> Self {
        if u.distance(v) > SHARP { Self::Sharp } else { Self::Tangent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_meet_sharply_from_an_angle_of_one_degree_on_whatever_their_slopes() {
        let turned = |degrees: f64| {
            let (sine, cosine) = libm::sincos(degrees.to_radians());
            DVec3::new(cosine, sine, 0.0)
        };
        let meet = |degrees: f64, slope: f64| Meet::of_gradients([DVec3::X, slope * turned(degrees)]);
        for slope in [1e-6, 1.0, 1e6] {
            assert_eq!(meet(0.9, slope), Some(Meet::Tangent), "{slope}");
            assert_eq!(meet(1.1, slope), Some(Meet::Sharp), "{slope}");
            assert_eq!(meet(180.0, slope), Some(Meet::Sharp), "{slope}");
        }
        assert_eq!(meet(0.0, 0.0), None);
        assert_eq!(meet(0.0, f64::NAN), None);
    }
}
