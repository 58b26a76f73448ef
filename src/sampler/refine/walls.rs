//! The box that cuts a net, and the planes of it on which the particles lie.

use crate::field::descent;
use crate::math::{Bounds, NONE};
use glam::Vec3;

/// A step of Newton's method along the border that is shorter than this share of its reach is the
/// last one: the next would be shorter than the square of it, which single precision cannot
/// resolve. A particle may be beyond a plane by the same share of the spacing, since such a step
/// moves one that touches the box.
pub(super) const AT_REST: f32 = 1e-4;

/// The constraints of a particle besides the surface: bit 2k for the lower plane of axis k of the
/// box, bit 2k + 1 for the upper one, bit 6 for a crease, and bit 7 for an end of creases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Planes(u8);

impl Planes {
    /// No plane.
    pub(super) const INNER: Self = Self(0);
    /// A crease, on which a particle is fixed.
    pub(super) const CREASE: Self = Self(1 << 6);
    /// A point at which creases meet or end, with the planes of the box if they end there.
    pub(super) const CREASE_END: Self = Self(3 << 6);
    /// Number of planes of a box.
    pub(super) const ALL: usize = 6;

    pub(super) fn of(plane: usize) -> Self {
        Self(1 << plane)
    }

    pub(super) fn is_inner(self) -> bool {
        self.0 == 0
    }

    /// Number of planes.
    pub(super) fn count(self) -> u32 {
        self.0.count_ones()
    }

    pub(super) fn is_corner(self) -> bool {
        self.count() > 1
    }

    /// Whether planes across all three axes meet here, as in a corner of the box.
    pub(super) fn are_all(self) -> bool {
        self.free() == Vec3::ZERO
    }

    /// Whether the particle lies on a crease.
    pub(super) fn is_crease(self) -> bool {
        !self.common(Self::CREASE).is_inner()
    }

    /// Whether creases meet or end at the particle.
    pub(super) fn is_crease_end(self) -> bool {
        self.common(Self::CREASE_END) == Self::CREASE_END
    }

    /// The planes of the box alone.
    pub(super) fn of_box(self) -> Self {
        self.common(Self((1 << Self::ALL) - 1))
    }

    /// The planes that are in both sets.
    pub(super) fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The planes that are not in the other set.
    pub(super) fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The planes that are in either set.
    pub(super) fn joined(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(super) fn each(self) -> impl Iterator<Item = usize> {
        (0..Self::ALL).filter(move |plane| self.0 >> plane & 1 == 1)
    }

    /// Mask of the axes along which a particle may move: 1 along these, 0 along the others.
    pub(super) fn free(self) -> Vec3 {
        let share = |axis: u32| if self.0 >> (2 * axis) & 3 == 0 { 1.0 } else { 0.0 };
        Vec3::new(share(0), share(1), share(2))
    }
}

/// Place of a particle: its position, the normal there and the planes of the box on which it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) position: Vec3,
    /// Outward unit normal of the surface there.
    pub(super) normal: Vec3,
    /// The planes of the box on which the particle lies.
    pub(super) planes: Planes,
    /// Number of the particle on a crease, if it lies on one: see
    /// [`Net::on_crease`](super::net::Net::on_crease).
    pub(super) number: u32,
}

impl Site {
    /// A site on no crease.
    pub(super) fn smooth(position: Vec3, normal: Vec3, planes: Planes) -> Self {
        Self { position, normal, planes, number: NONE }
    }
}

/// The box of a net, and the planes on which its particles lie.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    /// The largest box of single-precision numbers in the box that is sampled.
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
    /// A particle at most this far beyond a plane is put back onto it.
    pub(super) slack: f32,
    /// The planes of each particle; empty if no particle is near the box.
    pub(super) planes: Vec<Planes>,
}

impl Walls {
    /// The walls around particles that lie on no plane yet. They have no effect if no particle is
    /// within a `spacing` of a plane, or beyond it.
    pub(super) fn new(bounds: &Bounds, position: &[Vec3], spacing: f32) -> Self {
        let [lo, hi] = bounds.single();
        let farthest = lo.abs().max(hi.abs()).max_element();
        let slack = AT_REST * spacing + 4.0 * f32::EPSILON * farthest;
        let is_near = position.iter().any(|&p| (p - lo).min(hi - p).min_element() <= spacing);
        let planes = if is_near { vec![Planes::INNER; position.len()] } else { Vec::new() };
        Self { lo, hi, slack, planes }
    }

    /// The walls of the next level, with planes still to be filled.
    pub(super) fn finer(&self, count: usize) -> Self {
        let planes = Vec::with_capacity(if self.is_near() { count } else { 0 });
        Self { slack: 0.5 * self.slack, planes, ..*self }
    }

    /// Whether particles are near the planes of the box.
    #[inline]
    pub(super) fn is_near(&self) -> bool {
        !self.planes.is_empty()
    }

    /// The planes on which a particle lies.
    #[inline]
    pub(super) fn planes(&self, v: u32) -> Planes {
        if self.is_near() { self.planes[v as usize] } else { Planes::INNER }
    }

    /// Sets the planes of a particle.
    pub(super) fn set(&mut self, v: u32, planes: Planes) {
        if self.is_near() {
            self.planes[v as usize] = planes;
        }
    }

    /// Distance of a point from a plane, negative beyond it.
    pub(super) fn depth(&self, p: Vec3, plane: usize) -> f32 {
        let axis = plane / 2;
        if plane.is_multiple_of(2) { p[axis] - self.lo[axis] } else { self.hi[axis] - p[axis] }
    }

    /// The planes on which a point lies exactly.
    pub(super) fn planes_at(&self, p: Vec3) -> Planes {
        (0..Planes::ALL)
            .filter(|&plane| self.depth(p, plane) == 0.0)
            .fold(Planes::INNER, |planes, plane| planes.joined(Planes::of(plane)))
    }

    /// The point with the coordinates of the planes.
    pub(super) fn pinned(&self, mut p: Vec3, planes: Planes) -> Vec3 {
        for plane in planes.each() {
            p[plane / 2] = if plane.is_multiple_of(2) { self.lo } else { self.hi }[plane / 2];
        }
        p
    }

    /// The part of a step that a particle with the normal `n` can make: along the surface and its
    /// planes.
    pub(super) fn along(&self, planes: Planes, n: Vec3, step: Vec3) -> Vec3 {
        let (step, n) = (step * planes.free(), n * planes.free());
        let slide = step - n * (step.dot(n) / n.length_squared());
        if planes.is_corner() || planes.is_crease() || !slide.is_finite() { Vec3::ZERO } else { slide }
    }

    /// The position of a particle at `p` after one step of Newton's method on its planes. The
    /// position is exactly on the planes, and in the box unless it `may_leave` it. None if the step
    /// is longer than `longest` or leads out of the box.
    pub(super) fn landing(
        &self,
        planes: Planes,
        p: Vec3,
        value: f32,
        gradient: Vec3,
        longest: f32,
        may_leave: bool,
    ) -> Option<Vec3> {
        if planes.is_crease() {
            return Some(p);
        }
        if planes.are_all() {
            // A particle at a corner of the box cannot follow a surface that moves away.
            let is_near = value.abs() <= gradient.length() * self.slack;
            return (!may_leave || is_near).then(|| self.pinned(p, planes));
        }
        let step = if planes.is_inner() {
            let inverse_slope = 1.0 / gradient.length();
            gradient * inverse_slope * (value * inverse_slope)
        } else {
            descent::step(value, gradient * planes.free())
        };
        let q = self.pinned(p - step, planes);
        let inside = if may_leave { q } else { q.clamp(self.lo, self.hi) };
        // Written so that NaN fails.
        (step.length() <= longest && (q - inside).abs().max_element() <= self.slack).then_some(inside)
    }
}
