//! Whether a surface ends where f jumps.
//!
//! A surface without a border ends only where f does: where it is undefined, or where it jumps. At
//! such an end f is 0 on one side and not on the other, so its sign changes across the jump, and
//! bisecting a path across does not reduce the change.

use super::RunState;
use crate::field::{Enclosure, Evaluator, Field};
use crate::math::Bounds;
use crate::particles::{Particles, SlotFate, Slots};
use glam::{DVec3, Vec3};

/// Number of bisections of a path across a jump: as many as double precision resolves.
const HALVINGS: u32 = 52;
/// f jumps if at least this share of its change is left after the bisections. A continuous power of
/// exponent 1/20 has 0.16 left.
const LEFT: f64 = 0.25;
/// Points along each side of the cube around a place, between which f is compared.
const SIDE: usize = 3;

/// Maximum number of ends of the triangles at which a jump of f is searched for. More take longer,
/// by some thousand values of f each.
const LOOKED_AT: usize = 8;

/// Places where the triangles of the particles end.
#[derive(Default)]
pub(super) struct Ends {
    /// The first one at which f jumps.
    pub(super) at_jump: Option<DVec3>,
    /// The first one at which it does not.
    pub(super) others: Option<DVec3>,
    /// Whether f has no value beside that one, so that the surface ends there.
    pub(super) is_undefined: bool,
}

impl RunState<'_> {
    /// Where the triangles of the particles end, from a selection of the places. Near the box its
    /// faces hide such an end; there, particles with a child that found no surface show it.
    pub(super) fn ends(&self, field: &dyn Field) -> Ends {
        let mut ends = Ends::default();
        let Particles { local, slots, .. } = self.particles();
        let has_lost = |slots: &Slots| (0..Slots::COUNT).any(|k| slots.get(k) == SlotFate::NotConverged);
        let places: Vec<Vec3> = match &self.measuring.measured.opening {
            Some(opening) => opening.places.clone(),
            None => slots.iter().zip(local).filter(|(slots, _)| has_lost(slots)).map(|(_, &p)| p).collect(),
        };
        let (frame, reach) = (self.evaluator(field).frame(), 2.0 * self.sampler.radius());
        // Evaluates f itself: a piece need not be right beyond an end.
        let f = |p: DVec3| field.value(frame.place(p));
        let step = places.len().div_ceil(LOOKED_AT).max(1);
        for place in places.iter().step_by(step).map(|place| place.as_dvec3()) {
            if jumps_near(&f, place, reach) {
                ends.at_jump.get_or_insert(place);
            } else if ends.others.is_none() {
                ends.others = Some(place);
                ends.is_undefined = around(&f, place, reach).iter().any(|(_, value)| !value.is_finite());
            }
        }
        ends
    }
}

/// The nodes of a small grid around a place, with their values.
fn around(f: &dyn Fn(DVec3) -> f64, place: DVec3, reach: f64) -> [(DVec3, f64); SIDE * SIDE * SIDE] {
    core::array::from_fn(|k| {
        let [x, y, z] = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)].map(|step| step as f64 - 1.0);
        let p = place + reach * DVec3::new(x, y, z);
        (p, f(p))
    })
}

/// Whether f jumps from one sign to the other within about `reach` of a place.
pub(super) fn jumps_near(f: &dyn Fn(DVec3) -> f64, place: DVec3, reach: f64) -> bool {
    let ends = around(f, place, reach);
    (0..ends.len()).any(|k| {
        [1, SIDE, SIDE * SIDE].into_iter().any(|step| {
            let is_last = k / step % SIDE == SIDE - 1;
            !is_last && is_jump(f, ends[k], ends[k + step])
        })
    })
}

/// Whether f may be discontinuous within `reach` of a place, according to its bounds.
pub(super) fn breaks_in(field: &mut dyn Evaluator, place: DVec3, reach: f64) -> bool {
    let Some(field) = field.bounded() else { return false };
    let around = Bounds::new(place - reach, place + reach);
    (0..field.factors()).any(|factor| {
        let mut known = [Enclosure::UNKNOWN];
        field.enclose(factor, &[around], &mut known);
        known[0].may_vanish && !known[0].continuous
    })
}

/// Whether f jumps from one sign to the other between two places, which are given with its values.
fn is_jump(f: &dyn Fn(DVec3) -> f64, mut a: (DVec3, f64), mut b: (DVec3, f64)) -> bool {
    let is_negative = |(_, value): (DVec3, f64)| value < 0.0;
    let change = |a: (DVec3, f64), b: (DVec3, f64)| (a.1 - b.1).abs();
    let whole = change(a, b);
    if is_negative(a) == is_negative(b) || !whole.is_finite() {
        return false;
    }
    for _ in 0..HALVINGS {
        let p = 0.5 * (a.0 + b.0);
        let middle = (p, f(p));
        if is_negative(middle) == is_negative(a) {
            a = middle;
        } else {
            b = middle;
        }
    }
    // False for NaN, where f is undefined.
    change(a, b) >= LEFT * whole
}

#[cfg(test)]
mod tests {
    use super::jumps_near;
    use crate::field::Field;
    use crate::field::formula::Formula;
    use glam::DVec3;

    #[test]
    fn a_jump_is_told_from_a_zero_however_steep() {
        for (formula, jumps) in [
            ("if(x < 0.01, z, z - 1)", true),
            ("z - floor(x)", true),
            ("z - 0.2 + sign(x + 0.03)", true),
            ("z - 1e-6 sign(x)", true),
            ("x + z", false),
            ("tanh(1000000 x) + z", false),
            ("cbrt(x) + z", false),
            ("sign(x) abs(x)^(1/9)", false),
            ("abs(x)^3 sign(x) + z", false),
            ("sqrt(x - 0.01) + z", false),
            ("max(x, z) - 0.01", false),
            ("x^2 + y^2 + z^2 + 1", false),
        ] {
            let field = Formula::parse(formula).expect("a formula");
            assert_eq!(jumps_near(&|p| field.value(p), DVec3::ZERO, 0.1), jumps, "{formula}");
        }
    }
}
