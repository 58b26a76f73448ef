//! Edges of the survey's grid that the surface may cross twice: f has one sign at both ends, and
//! may have the other between them.

use glam::Vec3;

/// An edge is examined between its ends if |f| there is expected to fall below this share of its
/// larger value at them. Examining every edge takes more evaluations, and finds no more.
const SHARE: f32 = 0.1;

/// An end of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) place: Vec3,
    pub(super) value: f32,
    pub(super) gradient: Vec3,
}

/// An edge along which |f| falls from both ends towards its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dip {
    ends: [End; 2],
    /// Position of the minimum of |f|, as a share of the edge.
    t: f32,
    /// The axis of the edge.
    pub(super) axis: usize,
}

/// A place where an edge meets the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) place: Vec3,
    pub(super) gradient: Vec3,
}

/// The result of an evaluation of f at the bottom of a dip.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bottom {
    /// f has the other sign there than at the ends, and vanishes on both sides of the bottom.
    Crossed([Crossing; 2]),
    /// f has the sign of the ends, but the part of the edge on one side of the bottom may dip
    /// deeper.
    SameSign(Option<Dip>),
}

impl Dip {
    /// Returns the dip of an edge along an axis, if the cubic through values and slopes at its ends
    /// has one that is deep enough.
    pub(super) fn along(axis: usize, ends: [End; 2]) -> Option<Self> {
        let [from, to] = ends;
        let sign = from.value.signum();
        let [a, b] = [sign * from.value, sign * to.value];
        let length = to.place[axis] - from.place[axis];
        let [falling, rising] = [from, to].map(|end| sign * length * end.gradient[axis]);
        if !(a > 0.0 && b > 0.0 && falling < 0.0 && rising > 0.0) {
            return None;
        }
        // The cubic is a + falling t + square t² + cube t³.
        let cube = 2.0 * (a - b) + falling + rising;
        let square = 3.0 * (b - a) - 2.0 * falling - rising;
        // Its slope changes its sign once on the edge. The root is taken in the form without a
        // difference.
        let root = (square * square - 3.0 * cube * falling).sqrt();
        let t = if square >= 0.0 { -falling / (square + root) } else { (root - square) / (3.0 * cube) };
        let least = a + t * (falling + t * (square + t * cube));
        (least <= SHARE * a.max(b)).then_some(Self { ends, t, axis })
    }

    /// The point at which |f| is expected to be least.
    pub(super) fn bottom(&self) -> Vec3 {
        self.ends[0].place.lerp(self.ends[1].place, self.t)
    }

    /// Takes the value and the gradient of f at the bottom, and returns the crossings, or the part
    /// of the edge to examine next.
    pub(super) fn look(&self, value: f32, gradient: Vec3) -> Bottom {
        let bottom = End { place: self.bottom(), value, gradient };
        let [from, to] = self.ends;
        // Where f only touches zero, as between two solids that share a face, there is no crossing.
        if !value.is_finite() || value * from.value >= 0.0 {
            let part =
                Self::along(self.axis, [from, bottom]).or_else(|| Self::along(self.axis, [bottom, to]));
            return Bottom::SameSign(part);
        }
        // From the bottom to each end f is approximated by a parabola with its vertex there.
        Bottom::Crossed(self.ends.map(|end| {
            let share = (value / (value - end.value)).sqrt();
            Crossing {
                place: bottom.place.lerp(end.place, share),
                gradient: bottom.gradient.lerp(end.gradient, share),
            }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The edge from x = 0 to x = 1 of a function of x.
    fn edge(f: impl Fn(f32) -> f32, slope: impl Fn(f32) -> f32) -> [End; 2] {
        [0.0, 1.0].map(|x| End { place: Vec3::X * x, value: f(x), gradient: Vec3::new(slope(x), 0.5, 0.0) })
    }

    #[test]
    fn two_zeros_between_ends_of_one_sign_are_found() {
        for (first, second) in [(0.4, 0.6), (0.3, 0.301), (0.05, 0.1), (0.8, 0.9)] {
            for sign in [1.0, -1.0] {
                let f = |x: f32| sign * (x - first) * (x - second);
                let slope = |x: f32| sign * (2.0 * x - first - second);
                let dip = Dip::along(0, edge(f, slope)).expect("a parabola has a bottom");
                let x = dip.bottom().x;
                assert!((x - 0.5 * (first + second)).abs() < 1e-5, "{first}, {second}: {x}");
                let Bottom::Crossed(found) = dip.look(f(x), Vec3::new(slope(x), 0.5, 0.0)) else {
                    panic!("{first}, {second}: {x}")
                };
                for (crossing, zero) in found.into_iter().zip([first, second]) {
                    assert!(
                        (crossing.place.x - zero).abs() < 1e-4,
                        "{first}, {second}: {}",
                        crossing.place.x
                    );
                    assert!((crossing.gradient.x - slope(zero)).abs() < 1e-3, "{}", crossing.gradient.x);
                }
            }
        }
    }

    #[test]
    fn zeros_beside_the_bottom_of_the_cubic_are_found_in_a_part_of_the_edge() {
        let f = |x: f32| ((1.0 + x) * (1.0 + x) - 1.69) * ((1.0 + x) * (1.0 + x) - 1.692);
        let slope = |x: f32| 2.0 * (1.0 + x) * (2.0 * (1.0 + x) * (1.0 + x) - 3.382);
        let look = |dip: Dip| dip.look(f(dip.bottom().x), Vec3::X * slope(dip.bottom().x));
        let dip = Dip::along(0, edge(f, slope)).expect("the cubic has a bottom");
        let Bottom::SameSign(Some(part)) = look(dip) else { panic!("{dip:?}") };
        let Bottom::Crossed(places) = look(part) else { panic!("{part:?}") };
        let [first, second] = places.map(|crossing| crossing.place.x);
        assert!((first - 0.3).abs() < 3e-4 && (second - 0.300_769).abs() < 3e-4, "{first}, {second}");
    }

    #[test]
    fn an_edge_without_a_second_zero_has_none() {
        // It touches zero.
        let f = |x: f32| (x - 0.5) * (x - 0.5);
        let dip = Dip::along(0, edge(f, |x| 2.0 * (x - 0.5))).expect("it comes near zero");
        for value in [f(dip.bottom().x), f32::NAN] {
            assert!(matches!(dip.look(value, Vec3::Y), Bottom::SameSign(None)), "{value}");
        }
        // It stays far from zero, falls to one end, differs in sign, or has no value at one end.
        assert!(Dip::along(0, edge(|x| 1.0 + (x - 0.5) * (x - 0.5), |x| 2.0 * (x - 0.5))).is_none());
        assert!(Dip::along(0, edge(|x| 2.0 - x, |_| -1.0)).is_none());
        assert!(Dip::along(0, edge(|x| x - 0.5, |_| 1.0)).is_none());
        assert!(Dip::along(0, edge(|x| (x - 0.5).sqrt(), |x| 0.5 / (x - 0.5).sqrt())).is_none());
    }
}
