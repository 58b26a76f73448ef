//! Distance to another sheet of the surface, in double precision: single precision may hold both at
//! one place.
//!
//! Next to another sheet at a distance g the field along the normal is about s t (1 − t/g), so that
//! its second derivative is large compared with its slope s. One evaluation rules this out nearly
//! everywhere. Elsewhere the sign of the field beyond decides, and bisection finds the distance.
//!
//! Sheets so near to each other still need rules of their own
//! ([`SheetRule`](crate::sampler::sheet::SheetRule)), because precision is not their problem. A
//! child 2r away lands on whichever sheet is nearest to its circle, however precisely that is
//! known.

use crate::field::Evaluator;
use glam::DVec3;

/// Sheets nearer than this many of the distances that single precision resolves are not
/// distinguished, in uniform and in adaptive runs: a particle may be one such distance away from
/// its sheet, and the lift of two particles has to be four times that (see
/// [`SheetRule`](crate::sampler::sheet::SheetRule)). Particles of many sizes need more. Smaller:
/// components and Euler numbers of near sheets come out wrong.
pub(crate) const UNRESOLVED: [f64; 2] = [16.0, 48.0];
/// Distances at which the sign is tested, over the distance of the quadratic's second zero. With
/// three sheets at equal distances the quadratic puts the second one at two thirds of its distance,
/// with sixty at a fifth. Neighbouring values differ by a factor of about √2, so that one of them
/// lies between a second sheet and a third one twice as far.
const LOOKS: [f64; 6] = [0.8, 1.2, 1.7, 2.4, 3.4, 4.8];
/// Newton steps to a point: near several sheets at once each step covers only a part of the way.
pub(super) const STEPS: u32 = 48;

/// Another sheet near a point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearness {
    /// The point.
    pub(crate) position: DVec3,
    /// Distance of the other sheet along the normal.
    pub(crate) gap: f64,
    /// |∇f| at the point.
    pub(crate) slope: f64,
}

/// The field along the normal of a point of the surface, to second order.
struct Profile {
    position: DVec3,
    /// Unit normal.
    normal: DVec3,
    slope: f64,
    /// Second derivative along the normal.
    bend: f64,
}

/// The profile at the point that Newton's method finds from `p`. None if another zero cannot be
/// nearer than `most`, or if there is no point.
fn profile(field: &mut dyn Evaluator, mut p: DVec3, most: f64) -> Option<Profile> {
    /// Length of a last step, over the distance of the other zero: Newton's method squares it,
    /// which leaves a relative error of 10⁻⁶.
    const LAST: f64 = 1e-3;
    let start = p;
    for _ in 0..STEPS {
        let jet = field.jet(p);
        let slope = jet.gradient.length();
        let normal = jet.gradient / slope;
        let bend = normal.dot(jet.hessian.apply(normal));
        let (step, other) = (jet.value / slope, 2.0 * slope / bend.abs());
        // From a point off the surface the other zero seems nearer or farther by the point's
        // distance. False for NaN.
        let is_near = other <= most + 4.0 * step.abs() && (p - start).length() <= 4.0 * most;
        if !is_near {
            return None;
        }
        if step.abs() <= LAST * other {
            return Some(Profile { position: p - normal * step, normal, slope, bend });
        }
        p -= normal * step;
    }
    None
}

/// The sheet next to the surface near `from`, if it is no farther than `most`.
pub(crate) fn nearness(field: &mut dyn Evaluator, from: DVec3, most: f64) -> Option<Nearness> {
    /// Bisections of the bracket around the other sheet, to a thousandth of its distance.
    const HALVINGS: u32 = 12;
    let Profile { position, normal, slope, bend } = profile(field, from, most)?;
    let second = -2.0 * slope / bend;
    let mut value = |t: f64| field.jet(position + normal * t).value;
    let sign = second.signum();
    let between = value(0.5 * second);
    if between * sign <= 0.0 {
        return None;
    }
    let (mut near, mut far) = (0.5, LOOKS.into_iter().find(|look| value(look * second) * sign < 0.0)?);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (near + far);
        if value(middle * second) * sign > 0.0 { near = middle } else { far = middle }
    }
    let gap = 0.5 * (near + far) * second.abs();
    (gap <= most).then_some(Nearness { position, gap, slope })
}

/// The nearest of the sheets found from the points, and at how many points one was found.
pub(crate) fn nearest(
    field: &mut dyn Evaluator,
    points: impl Iterator<Item = DVec3>,
    most: f64,
) -> (Option<Nearness>, usize) {
    let (mut least, mut count) = (None::<Nearness>, 0);
    for p in points {
        if let Some(found) = nearness(field, p, most) {
            count += 1;
            least = Some(least.filter(|least| least.gap <= found.gap).unwrap_or(found));
        }
    }
    (least, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};

    #[test]
    fn the_distance_of_a_near_sheet_is_found_down_to_a_billionth() {
        for gap in [1e-3, 1e-5, 1e-7, 1e-9] {
            for formula in [
                format!("(z-0.3)*(z-0.3-{gap})"),
                format!("(z-0.3)*(z-0.3-{gap})*(z-0.3-{})", 2.0 * gap),
                format!("(z-0.3)^2-{gap}*(z-0.3)"),
            ] {
                let field = Formula::as_written(&formula, &[]).expect("a formula");
                let field = &mut *field.evaluator(Frame::default());
                // From outside of all sheets, as far as a particle may be.
                let found = nearness(field, DVec3::new(0.1, 0.2, 0.3 - 0.9 * gap), 2e-3)
                    .unwrap_or_else(|| panic!("{formula}"));
                assert!((found.gap / gap - 1.0).abs() < 1e-2, "{formula}: {found:?}");
            }
        }
    }

    #[test]
    fn where_one_sheet_is_alone_none_is_near() {
        for formula in ["z-0.3", "x^2+y^2+z^2-0.14", "1-cos(z-0.3)", "exp(40*(z-0.3))-1", "(z-0.3)*(z-0.31)"]
        {
            let field = Formula::as_written(formula, &[]).expect("a formula");
            let field = &mut *field.evaluator(Frame::default());
            assert_eq!(nearness(field, DVec3::new(0.1, 0.2, 0.3), 2e-3), None, "{formula}");
        }
    }
}
