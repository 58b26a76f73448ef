//! Elementary operations, with their values and first two derivatives in double precision.

/// Operations of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Unary {
    Neg,
    Sqrt,
    Cbrt,
    Abs,
    Sign,
    Floor,
    Exp,
    Ln,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Erf,
    /// The identity, for a function whose zeros limit the surface without being part of it.
    Limit,
}

/// Operations of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    Pow,
    Atan2,
}

/// Sign −1, 0 or 1; NaN for NaN.
pub(super) fn sign(a: f64) -> f64 {
    if a > 0.0 {
        1.0
    } else if a < 0.0 {
        -1.0
    } else if a == 0.0 {
        0.0
    } else {
        a
    }
}

/// a^b. NaN if either operand is NaN, where `libm::pow` may give 1, and for a fractional power of
/// −∞, as for other negative numbers, where it gives 0 or ∞.
fn pow(a: f64, b: f64) -> f64 {
    let is_none = a == f64::NEG_INFINITY && libm::floor(b) != b;
    if is_none || a.is_nan() || b.is_nan() { f64::NAN } else { libm::pow(a, b) }
}

impl Unary {
    pub(super) fn evaluate(self, a: f64) -> f64 {
        match self {
            Self::Neg => -a,
            Self::Sqrt => a.sqrt(),
            Self::Cbrt => libm::cbrt(a),
            Self::Abs => a.abs(),
            Self::Sign => sign(a),
            Self::Floor => libm::floor(a),
            Self::Exp => libm::exp(a),
            Self::Ln => libm::log(a),
            Self::Log10 => libm::log10(a),
            Self::Sin => libm::sin(a),
            Self::Cos => libm::cos(a),
            Self::Tan => libm::tan(a),
            Self::Asin => libm::asin(a),
            Self::Acos => libm::acos(a),
            Self::Atan => libm::atan(a),
            Self::Sinh => libm::sinh(a),
            Self::Cosh => libm::cosh(a),
            Self::Tanh => libm::tanh(a),
            Self::Asinh => libm::asinh(a),
            // `libm` need not give NaN below 1, where it is undefined.
            Self::Acosh if a < 1.0 => f64::NAN,
            Self::Acosh => libm::acosh(a),
            Self::Atanh => libm::atanh(a),
            Self::Erf => libm::erf(a),
            Self::Limit => a,
        }
    }

    /// Value, first and second derivative at `a`.
    pub(super) fn jet(self, a: f64) -> [f64; 3] {
        let value = self.evaluate(a);
        let (first, second) = match self {
            Self::Neg => (-1.0, 0.0),
            Self::Limit => (1.0, 0.0),
            Self::Sqrt => (0.5 / value, -0.25 / (value * a)),
            Self::Cbrt => (1.0 / (3.0 * value * value), -2.0 / (9.0 * value * value * a)),
            Self::Abs => (sign(a), 0.0),
            Self::Sign | Self::Floor => (0.0, 0.0),
            Self::Exp => (value, value),
            Self::Ln => (1.0 / a, -1.0 / (a * a)),
            Self::Log10 => {
                let scale = core::f64::consts::LOG10_E;
                (scale / a, -scale / (a * a))
            }
            Self::Sin => (libm::cos(a), -value),
            Self::Cos => (-libm::sin(a), -value),
            Self::Tan => {
                let first = 1.0 + value * value;
                (first, 2.0 * value * first)
            }
            Self::Asin => {
                let rest = 1.0 - a * a;
                (1.0 / rest.sqrt(), a / (rest * rest.sqrt()))
            }
            Self::Acos => {
                let rest = 1.0 - a * a;
                (-1.0 / rest.sqrt(), -a / (rest * rest.sqrt()))
            }
            Self::Atan => {
                let first = 1.0 / (1.0 + a * a);
                (first, -2.0 * a * first * first)
            }
            Self::Sinh => (libm::cosh(a), value),
            Self::Cosh => (libm::sinh(a), value),
            Self::Tanh => {
                let first = 1.0 - value * value;
                (first, -2.0 * value * first)
            }
            Self::Asinh | Self::Acosh => {
                let square = if self == Self::Asinh { a * a + 1.0 } else { a * a - 1.0 };
                let first = 1.0 / square.sqrt();
                (first, -a * first / square)
            }
            Self::Atanh => {
                let first = 1.0 / (1.0 - a * a);
                (first, 2.0 * a * first * first)
            }
            Self::Erf => {
                let first = core::f64::consts::FRAC_2_SQRT_PI * libm::exp(-a * a);
                (first, -2.0 * a * first)
            }
        };
        [value, first, second]
    }
}

impl Binary {
    pub(super) fn evaluate(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            // Unlike `f64::min` and `f64::max`, these give NaN if either operand is NaN.
            Self::Min => {
                if a.is_nan() || a <= b {
                    a
                } else {
                    b
                }
            }
            Self::Max => {
                if a.is_nan() || a >= b {
                    a
                } else {
                    b
                }
            }
            Self::Pow => pow(a, b),
            Self::Atan2 => libm::atan2(a, b),
        }
    }
}
