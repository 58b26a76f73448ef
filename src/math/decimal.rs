//! Decimal numbers, read and written exactly: a text gives the double nearest to it, and a double gives the shortest
//! text that reads back as it.
//!
//! The methods are those of school arithmetic on whole numbers of any length. They take longer than the standard
//! library's and do without its tables, which are a tenth of a small WebAssembly module. What is read and written here
//! are formulas, settings and reports, some hundred numbers at a time.

use core::cmp::Ordering;

/// Decimal digits that identify every double.
const MOST_DIGITS: usize = 17;

/// Digits that are read; of those after them it matters only whether one is not 0. The midpoint between two doubles has
/// up to 768.
const MOST_READ: usize = 800;

/// Bits by which a quotient may be longer than its divisor.
const QUOTIENT_BITS: u32 = 60;

/// A whole number, least part first, without leading zeros.
struct Natural(Vec<u32>);

impl Natural {
    fn from(value: u64) -> Self {
        let mut natural = Self(vec![value as u32, (value >> 32) as u32]);
        natural.trim();
        natural
    }

    fn trim(&mut self) {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
    }

    fn bits(&self) -> u32 {
        self.0.last().map_or(0, |last| 32 * self.0.len() as u32 - last.leading_zeros())
    }

    /// self · factor + term.
    #[inline(never)]
    fn multiply_add(&mut self, factor: u32, term: u32) {
        let mut carry = u64::from(term);
        for part in &mut self.0 {
            carry += u64::from(*part) * u64::from(factor);
            *part = carry as u32;
            carry >>= 32;
        }
        self.0.push(carry as u32);
        self.trim();
    }

    /// self · 10^exponent.
    fn multiply_power_of_ten(&mut self, exponent: u32) {
        for _ in 0..exponent / 9 {
            self.multiply_add(1_000_000_000, 0);
        }
        self.multiply_add(10_u32.pow(exponent % 9), 0);
    }

    /// self · 2^bits.
    #[inline(never)]
    fn shift(&mut self, bits: u32) {
        self.multiply_add(1 << (bits % 32), 0);
        self.0.splice(0..0, core::iter::repeat_n(0, (bits / 32) as usize));
        self.trim();
    }

    #[inline(never)]
    fn compare(&self, other: &Self) -> Ordering {
        self.0.len().cmp(&other.0.len()).then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }

    /// self − other, which must not be greater.
    #[inline(never)]
    fn subtract(&mut self, other: &Self) {
        let mut borrow = false;
        for (k, part) in self.0.iter_mut().enumerate() {
            let (less, first) = part.overflowing_sub(other.0.get(k).copied().unwrap_or(0));
            let (less, second) = less.overflowing_sub(u32::from(borrow));
            *part = less;
            borrow = first || second;
        }
        self.trim();
    }

    /// The whole part of self / divisor, below 2^[`QUOTIENT_BITS`], and whether anything is left.
    #[inline(never)]
    fn divide(mut self, mut divisor: Self) -> (u64, bool) {
        divisor.shift(QUOTIENT_BITS - 1);
        let mut quotient = 0;
        for _ in 0..QUOTIENT_BITS {
            quotient <<= 1;
            if self.compare(&divisor) != Ordering::Less {
                self.subtract(&divisor);
                quotient |= 1;
            }
            self.multiply_add(2, 0);
        }
        (quotient, !self.0.is_empty())
    }
}

/// The double nearest to digits · 10^exponent, of two equally near the even one.
fn nearest(digits: &[u8], exponent: i32) -> f64 {
    if digits.len() <= 15 && exponent.abs() <= 22 {
        // Both are doubles, so that one operation rounds once.
        let value = digits.iter().fold(0.0, |value, digit| value * 10.0 + f64::from(*digit));
        let power = (0..exponent.unsigned_abs()).fold(1.0, |power, _| power * 10.0);
        return if exponent < 0 { value / power } else { value * power };
    }
    let size = exponent.saturating_add(digits.len() as i32);
    if size > 310 {
        return f64::INFINITY;
    }
    if size < -330 {
        return 0.0;
    }
    let mut above = Natural(Vec::new());
    for &digit in digits {
        above.multiply_add(10, u32::from(digit));
    }
    if above.0.is_empty() {
        return 0.0;
    }
    let mut below = Natural::from(1);
    let scaled = if exponent < 0 { &mut below } else { &mut above };
    scaled.multiply_power_of_ten(exponent.unsigned_abs());
    // The quotient gets 57 or 58 bits: four more than are kept.
    let shift = 57 - (above.bits() as i32 - below.bits() as i32);
    let shifted = if shift < 0 { &mut below } else { &mut above };
    shifted.shift(shift.unsigned_abs());
    let (quotient, rest) = above.divide(below);
    // The value of the last bit that is kept is 2^last.
    let length = 64 - quotient.leading_zeros() as i32;
    let last = (length - shift - 53).max(-1074);
    let dropped = last + shift;
    if dropped >= QUOTIENT_BITS as i32 {
        return 0.0;
    }
    let half = 1 << (dropped - 1);
    let (kept, cut) = (quotient >> dropped, quotient & (2 * half - 1));
    let up = cut > half || (cut == half && (rest || kept & 1 == 1));
    // A carry out of the 53 bits is a carry into the exponent, as it should be.
    let bits = (((last + 1074) as u64) << 52) + kept + u64::from(up);
    f64::from_bits(bits.min(f64::INFINITY.to_bits()))
}

/// Reads `12`, `-1.5`, `.5`, `5.`, `2e-3`: the nearest double, which is infinite for numbers too large to be one. `None` if
/// the text is anything else.
#[must_use]
pub fn read(text: &str) -> Option<f64> {
    let (sign, text) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text),
    };
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let mut power = match exponent {
        Some(exponent) => read_exponent(exponent)?,
        None => 0,
    };
    power = power.saturating_sub(i32::try_from(fraction.len()).ok()?);
    let mut digits = Vec::new();
    for digit in whole.bytes().chain(fraction.bytes()) {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        if digits.len() < MOST_READ {
            if digit > 0 || !digits.is_empty() {
                digits.push(digit);
            }
        } else {
            power = power.saturating_add(1);
            if let Some(last) = digits.last_mut()
                && digit > 0
            {
                *last |= 1;
            }
        }
    }
    while digits.last() == Some(&0) {
        digits.pop();
        power = power.saturating_add(1);
    }
    Some(sign * if digits.is_empty() { 0.0 } else { nearest(&digits, power) })
}

fn read_exponent(text: &str) -> Option<i32> {
    let (negative, digits) = match text.as_bytes() {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let size = digits
        .iter()
        .fold(0_i32, |size, digit| size.saturating_mul(10).saturating_add(i32::from(digit - b'0')));
    Some(if negative { -size } else { size })
}

/// The fewest digits that read back as the positive number `value`, the first not 0, and the power of ten of the first.
fn shortest(value: f64) -> (Vec<u8>, i32) {
    let bits = value.to_bits();
    let biased = (bits >> 52) as i32;
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    // One digit more than is ever written; what is left after it cannot matter. The power of ten is guessed from that of two, at most one too small.
    let size = 63 - mantissa.leading_zeros() as i32 + exponent;
    let mut first = (f64::from(size) * core::f64::consts::LOG10_2).floor() as i32;
    let all = loop {
        let mut above = Natural::from(mantissa);
        let mut below = Natural::from(1);
        let shifted = if exponent < 0 { &mut below } else { &mut above };
        shifted.shift(exponent.unsigned_abs());
        let power = MOST_DIGITS as i32 - first;
        let scaled = if power < 0 { &mut below } else { &mut above };
        scaled.multiply_power_of_ten(power.unsigned_abs());
        let (quotient, _) = above.divide(below);
        if quotient < 10_u64.pow(MOST_DIGITS as u32 + 1) {
            break quotient;
        }
        first += 1;
    };
    let digits_of = |mut number: u64| {
        let mut digits = Vec::new();
        while number > 0 {
            digits.push((number % 10) as u8);
            number /= 10;
        }
        digits.reverse();
        digits
    };
    let cut = |count: usize| {
        let unit = 10_u64.pow((MOST_DIGITS + 1 - count) as u32);
        let below = all / unit;
        let left = 2 * (all % unit);
        let up = left >= unit;
        // The nearer of the two neighbours of that many digits; the other one only where the spacing of the doubles
        // changes, so that the nearer one lies with the next.
        [below + u64::from(up), below + u64::from(!up)].into_iter().find_map(|candidate| {
            let digits = digits_of(candidate);
            let carried = i32::from(digits.len() > count);
            let power = first + carried + 1 - digits.len() as i32;
            (nearest(&digits, power) == value).then_some((digits, first + carried))
        })
    };
    // What reads back with some number of digits does so with more; 15 are read much faster than 16.
    let from = if cut(15).is_some() { 1 } else { 16 };
    let (mut digits, first) = (from..=MOST_DIGITS).find_map(cut).unwrap_or_default();
    while digits.last() == Some(&0) {
        digits.pop();
    }
    (digits, first)
}

/// The shortest text that reads back as `value`; with an exponent if it is very large or very small.
#[must_use]
pub fn text(value: f64) -> String {
    if !value.is_finite() {
        return if value.is_nan() {
            "NaN"
        } else if value > 0.0 {
            "inf"
        } else {
            "-inf"
        }
        .to_owned();
    }
    let mut out = String::new();
    if value.is_sign_negative() {
        out.push('-');
    }
    let size = value.abs();
    if size == 0.0 {
        out.push('0');
        return out;
    }
    let (digits, first) = shortest(size);
    let character = |digit: u8| char::from(b'0' + digit);
    if (1e-5..1e15).contains(&size) {
        if first < 0 {
            out.push_str("0.");
            out.extend(core::iter::repeat_n('0', first.unsigned_abs() as usize - 1));
        }
        for k in 0..digits.len().max((first + 1).max(0) as usize) {
            if first >= 0 && k == first as usize + 1 {
                out.push('.');
            }
            out.push(character(digits.get(k).copied().unwrap_or(0)));
        }
    } else {
        out.push(character(digits[0]));
        out.push_str(if digits.len() > 1 { "." } else { "" });
        out.extend(digits.iter().skip(1).map(|&digit| character(digit)));
        out.push('e');
        out.push_str(&first.to_string());
    }
    out
}
