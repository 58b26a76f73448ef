//! How the values of two fields, or of one, make a new value.

use crate::field::Jet;
use crate::math::Sym3;

/// A function of the values of fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rule {
    /// The least of two values.
    Least,
    /// The greatest of two values.
    Greatest,
    /// The smooth minimum of two values by a cubic polynomial, where they differ by less than the
    /// width: `smin` of formulas.
    Blend { width: f64 },
    /// A value, or its negative, minus the shift.
    Turned { is_negative: bool, shift: f64 },
}

impl Rule {
    /// The rule for values multiplied by a positive number.
    pub(super) fn scaled(self, scale: f64) -> Self {
        match self {
            Self::Blend { width } => Self::Blend { width: width * scale },
            Self::Turned { is_negative, shift } => Self::Turned { is_negative, shift: shift * scale },
            rule => rule,
        }
    }

    /// The jet of the function, from the jets of the fields; NaN if one of them is NaN.
    ///
    /// # Panics
    ///
    /// If there are fewer fields than the rule needs.
    pub(super) fn jet(self, jets: &mut dyn Iterator<Item = Jet>) -> Jet {
        let mut next = || jets.next().expect("as many fields as the rule takes");
        match self {
            Self::Turned { is_negative, shift } => {
                let mut jet = next();
                if is_negative {
                    jet = Jet {
                        value: -jet.value,
                        gradient: -jet.gradient,
                        hessian: jet.hessian.map(|entry| -entry),
                    };
                }
                jet.value -= shift;
                jet
            }
            Self::Blend { width } => blend(next(), next(), width),
            rule => {
                let jets = [next(), next()];
                jets[rule.taken(jets[0].value, jets[1].value)]
            }
        }
    }

    /// Which of two values a minimum or maximum takes: the first one if they are equal or it is
    /// NaN.
    pub(super) fn taken(self, a: f64, b: f64) -> usize {
        let is_first = a.is_nan() || if self == Self::Least { a <= b } else { a >= b };
        usize::from(!is_first)
    }
}

/// The smooth minimum of two fields: (a + b)/2 − k d(u) with u = (a − b)/k and d(u) = 1/6 + u²/2 −
/// |u|³/6, where |u| < 1. Elsewhere it is exactly the lesser one.
fn blend(a: Jet, b: Jet, width: f64) -> Jet {
    let u = (a.value - b.value) / width;
    let size = u.abs();
    if size >= 1.0 {
        return if u < 0.0 { a } else { b };
    }
    let depth = 1.0 / 6.0 + 0.5 * u * u - size * size * size / 6.0;
    let (first, second) = (u - 0.5 * u * size, (1.0 - size) / width);
    let apart = a.gradient - b.gradient;
    let mixed = |a: f64, b: f64| 0.5 * (a + b) - first * (a - b);
    let (of_a, of_b) = (a.hessian, b.hessian);
    let entry = |a: f64, b: f64, i: usize, j: usize| mixed(a, b) - second * apart[i] * apart[j];
    Jet {
        value: 0.5 * (a.value + b.value) - width * depth,
        gradient: 0.5 * (a.gradient + b.gradient) - first * apart,
        hessian: Sym3 {
            xx: entry(of_a.xx, of_b.xx, 0, 0),
            xy: entry(of_a.xy, of_b.xy, 0, 1),
            xz: entry(of_a.xz, of_b.xz, 0, 2),
            yy: entry(of_a.yy, of_b.yy, 1, 1),
            yz: entry(of_a.yz, of_b.yz, 1, 2),
            zz: entry(of_a.zz, of_b.zz, 2, 2),
        },
    }
}
