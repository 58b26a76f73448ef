//! Small numeric building blocks for every other module: SIMD lanes, intervals, symmetric matrices,
//! tangent frames, boxes and shared tolerances.

mod forest;
pub mod functions;
pub(crate) mod interval;
mod lanes;
mod meet;
pub(crate) mod newton;
mod real;
mod sort;
mod table;

pub(crate) use forest::Forest;
pub use interval::Interval;
pub use lanes::{LANES, Lanes};
pub(crate) use meet::{Meet, SHARP};
pub use real::Real;
pub use sort::sort_few;
pub(crate) use sort::{key, key_of, median, signed_key, sort_by_key, sort_numbers, sort_pairs, unkey};
pub(crate) use table::{GOLDEN_RATIO, IndexTable, hash};

use core::ops::RangeInclusive;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// The shortest text that reads back as `value`; with an exponent if it is very large or very
/// small.
#[must_use]
pub fn shortest_text(value: f64) -> String {
    let size = value.abs();
    let plain = size == 0.0 || !size.is_finite() || (1e-5..1e15).contains(&size);
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// A number with four significant digits.
#[must_use]
pub fn significant(number: f64) -> String {
    shortest_text(format!("{number:.3e}").parse().unwrap_or(number))
}

/// A number rounded to a thousandth of a length.
pub(crate) fn text_within(x: f64, length: f64) -> String {
    let digits = (3.0 - libm::floor(libm::log10(length))).clamp(0.0, 15.0) as usize;
    shortest_text(format!("{x:.digits$}").parse::<f64>().unwrap_or(x) + 0.0)
}

/// A place in words, rounded to a thousandth of a length.
pub(crate) fn place_text(position: [f64; 3], length: f64) -> String {
    format!("({})", position.map(|x| text_within(x, length)).join(", "))
}

/// A count, which is not negative, with commas between thousands.
#[must_use]
pub fn grouped(count: impl ToString) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number of things, in words.
#[must_use]
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

/// The index that stands for none: no particle, triangle, block or component.
pub const NONE: u32 = u32::MAX;

/// Largest relative error in double precision after as many operations as the longest formula has,
/// each of which rounds once.
pub(crate) const ROUNDING: f64 = 4096.0 * f64::EPSILON;

/// Largest relative error of a result in single precision after a few operations.
pub(crate) const SINGLE_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// √3: a hexagonal cell of spacing d has the area √3 d²/2.
pub(crate) const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Area of the cell of a hexagonal lattice, whose spacing is 2r, over r².
pub(crate) const HEXAGONAL_CELL: f64 = 2.0 * SQRT_3;

/// The FNV-1a hash of no bytes.
pub(crate) const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;

/// The FNV-1a hash of some bytes, which `hash` is the hash of, followed by more.
pub(crate) fn fnv(hash: u64, more: &[u8]) -> u64 {
    more.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// An axis-aligned box, in the field's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Bounds {
    /// Smallest corner.
    pub min: [f64; 3],
    /// Largest corner.
    pub max: [f64; 3],
}

impl Bounds {
    /// Points of a grid with `side` points on every axis, none on the faces of the box or its
    /// planes of symmetry.
    pub(crate) fn spread(&self, side: usize) -> impl ExactSizeIterator<Item = DVec3> {
        let (lo, size) = (self.lo(), self.size());
        (0..side * side * side).map(move |i| {
            let node = DVec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64);
            lo + size * (node + DVec3::new(0.41, 0.37, 0.43)) / side as f64
        })
    }

    /// The corners of the box.
    pub(crate) fn corners(&self) -> [DVec3; 8] {
        let ends = [self.lo(), self.hi()];
        core::array::from_fn(|k| DVec3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z))
    }

    /// The box from its smallest to its largest corner.
    #[must_use]
    pub const fn new(lo: DVec3, hi: DVec3) -> Self {
        Self { min: lo.to_array(), max: hi.to_array() }
    }

    /// The box that contains only `p`.
    #[must_use]
    pub const fn point(p: DVec3) -> Self {
        Self::new(p, p)
    }

    /// The smallest box that holds these points; for no points, one from +∞ to −∞.
    pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lo, hi) = points.into_iter().fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)));
        Self::new(lo, hi)
    }

    /// The box centred on the origin with half-widths `half`.
    #[must_use]
    pub const fn symmetric(half: [f64; 3]) -> Self {
        Self { min: [-half[0], -half[1], -half[2]], max: half }
    }

    /// The box from `-half` to `half` on every axis.
    #[must_use]
    pub const fn cube(half: f64) -> Self {
        Self::symmetric([half; 3])
    }

    /// Smallest corner as a vector.
    #[must_use]
    pub fn lo(&self) -> DVec3 {
        DVec3::from_array(self.min)
    }

    /// Largest corner as a vector.
    #[must_use]
    pub fn hi(&self) -> DVec3 {
        DVec3::from_array(self.max)
    }

    /// The corners of the largest box of single-precision numbers in this one.
    pub(crate) fn single(&self) -> [Vec3; 2] {
        let at_least = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
        [Vec3::from_array(self.min.map(at_least)), Vec3::from_array(self.max.map(|x| -at_least(-x)))]
    }

    /// Lengths of the sides.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.hi() - self.lo()
    }

    /// The point in the middle.
    #[must_use]
    pub fn middle(&self) -> DVec3 {
        0.5 * (self.lo() + self.hi())
    }

    /// The box that is larger by `margin` on every side, or smaller by `-margin`.
    #[must_use]
    pub fn enlarged(&self, margin: f64) -> Self {
        Self::new(self.lo() - margin, self.hi() + margin)
    }

    /// Length of the space diagonal: the unit in which the paper gives its radii (§6).
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// The halves of the box, cut at the middle of its longest side.
    pub(crate) fn halves(&self) -> [Self; 2] {
        let axis = self.size().max_position();
        let middle = self.middle().to_array()[axis];
        let (mut low, mut high) = (*self, *self);
        (low.max[axis], high.min[axis]) = (middle, middle);
        [low, high]
    }

    /// Largest absolute value of a coordinate of a corner.
    pub(crate) fn farthest(&self) -> f64 {
        self.lo().abs().max(self.hi().abs()).max_element()
    }

    /// Largest coordinate of a corner, relative to the diagonal, for a box without an origin of its
    /// own. Rounding to single precision moves a particle of the default radius by at most 1/25,000
    /// of the radius there.
    const NEAR: f64 = 4.0;

    /// The origin of the particles' single-precision coordinates in this box: that of the formula,
    /// unless the box is so far from it that rounding would move particles noticeably; then a point
    /// near the middle of the box.
    ///
    /// Its coordinates have few digits, so that adding it to a particle's position in double
    /// precision is almost exact.
    #[must_use]
    pub fn local_origin(&self) -> DVec3 {
        let diagonal = self.diagonal();
        if self.farthest() <= Self::NEAR * diagonal {
            return DVec3::ZERO;
        }
        let grid = libm::exp2(libm::floor(libm::log2(diagonal)) - 2.0);
        (self.middle() / grid).round() * grid
    }

    /// Returns the box in coordinates whose zero is `origin`.
    #[must_use]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        Self::new(self.lo() - origin, self.hi() - origin)
    }

    /// Whether `p` lies in the closed box. Non-finite points do not.
    #[must_use]
    pub fn contains(&self, p: Vec3) -> bool {
        self.holds(p.as_dvec3())
    }

    /// Whether `p` lies in the closed box, in double precision. Non-finite points do not.
    #[must_use]
    pub fn holds(&self, p: DVec3) -> bool {
        p.cmpge(self.lo()).all() && p.cmple(self.hi()).all()
    }

    /// Whether another box lies in the interior of this one.
    #[must_use]
    pub fn holds_inside(&self, other: &Self) -> bool {
        other.lo().cmpgt(self.lo()).all() && other.hi().cmplt(self.hi()).all()
    }

    /// Whether the closed boxes have no point in common.
    #[must_use]
    pub fn is_apart_from(&self, other: &Self) -> bool {
        other.lo().cmpgt(self.hi()).any() || other.hi().cmplt(self.lo()).any()
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self::new(self.lo().min(other.lo()), self.hi().max(other.hi()))
    }

    /// The intersection of two boxes. If it is empty, a smallest corner is above the largest.
    #[must_use]
    pub fn overlap(&self, other: &Self) -> Self {
        Self::new(self.lo().max(other.lo()), self.hi().min(other.hi()))
    }

    /// Diagonals of a box for which squared radii are normal numbers in single precision.
    pub const DIAGONALS: RangeInclusive<f64> = 1e-12..=1e12;

    /// Smallest side of a box, over its diagonal: a normal number in single precision.
    pub const THINNEST: f64 = 1e-12;

    /// Largest coordinate of a corner relative to the diagonal. There, the single precision of the
    /// picture moves a particle of the default radius by a hundredth of it.
    pub const FARTHEST_CORNER: f64 = 1e3;

    /// Whether [`Bounds::check`] finds no fault.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.check().is_ok()
    }

    /// Checks that particles can be placed in the box and drawn: the diagonal is in
    /// [`Bounds::DIAGONALS`], no side is shorter than [`Bounds::THINNEST`] of it, and no coordinate
    /// is larger than [`Bounds::FARTHEST_CORNER`] diagonals.
    ///
    /// # Errors
    ///
    /// The first of these that does not hold.
    pub fn check(&self) -> Result<(), BoxError> {
        let (lo, hi, diagonal) = (self.lo(), self.hi(), self.diagonal());
        let faults = [
            (!(lo.is_finite() && hi.is_finite()), BoxError::NotFinite),
            (lo.cmpge(hi).any(), BoxError::Empty),
            (!Self::DIAGONALS.contains(&diagonal), BoxError::Size),
            ((hi - lo).min_element() < Self::THINNEST * diagonal, BoxError::Thin),
            (self.farthest() > Self::FARTHEST_CORNER * diagonal, BoxError::Far),
        ];
        faults.into_iter().find(|&(is_there, _)| is_there).map_or(Ok(()), |(_, fault)| Err(fault))
    }
}

/// Why particles cannot be placed in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BoxError {
    /// A coordinate is NaN or infinite.
    #[error("the box has a corner that is not finite")]
    NotFinite,
    /// A corner is not below the other along some axis.
    #[error("the box must have a positive size on every axis")]
    Empty,
    /// The diagonal is outside [`Bounds::DIAGONALS`].
    #[error("the box must have a diagonal between {:e} and {:e}", Bounds::DIAGONALS.start(), Bounds::DIAGONALS.end())]
    Size,
    /// A side is shorter than [`Bounds::THINNEST`] of the diagonal.
    #[error("the box must be no thinner than {:e} of its diagonal", Bounds::THINNEST)]
    Thin,
    /// A corner is farther from the origin than [`Bounds::FARTHEST_CORNER`] diagonals.
    #[error(
        "the box lies more than {} diagonals from the origin, where pictures in single precision show no particle in its \
             place: shift it and the formula to the origin, as x to x + 5e6",
        Bounds::FARTHEST_CORNER
    )]
    Far,
}

/// A symmetric 3×3 matrix, by its upper triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym3<T> {
    /// Entry (0, 0).
    pub xx: T,
    /// Entry (0, 1).
    pub xy: T,
    /// Entry (0, 2).
    pub xz: T,
    /// Entry (1, 1).
    pub yy: T,
    /// Entry (1, 2).
    pub yz: T,
    /// Entry (2, 2).
    pub zz: T,
}

impl<T: Copy> Sym3<T> {
    /// The matrix whose entry in row i and column j ≥ i is `entry(i, j)`.
    pub(crate) fn by(entry: impl Fn(usize, usize) -> T) -> Self {
        Self {
            xx: entry(0, 0),
            xy: entry(0, 1),
            xz: entry(0, 2),
            yy: entry(1, 1),
            yz: entry(1, 2),
            zz: entry(2, 2),
        }
    }

    /// The matrix with the same value for every entry.
    #[must_use]
    pub const fn splat(entry: T) -> Self {
        Self { xx: entry, xy: entry, xz: entry, yy: entry, yz: entry, zz: entry }
    }

    /// The upper triangle, row by row: xx, xy, xz, yy, yz, zz.
    #[must_use]
    pub fn entries(&self) -> [T; 6] {
        [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz]
    }

    /// Entry in row `i` and column `j`, each 0 to 2.
    #[inline]
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> T {
        match (i.min(j), i.max(j)) {
            (0, 0) => self.xx,
            (0, 1) => self.xy,
            (0, _) => self.xz,
            (1, 1) => self.yy,
            (1, _) => self.yz,
            _ => self.zz,
        }
    }

    /// `f` applied to every entry.
    #[must_use]
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Sym3<U> {
        Sym3 {
            xx: f(self.xx),
            xy: f(self.xy),
            xz: f(self.xz),
            yy: f(self.yy),
            yz: f(self.yz),
            zz: f(self.zz),
        }
    }
}

impl<T: Real> Sym3<T> {
    /// The matrix times the column `[x, y, z]`.
    #[inline]
    #[must_use]
    pub fn times(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        [
            self.xx * x + self.xy * y + self.xz * z,
            self.xy * x + self.yy * y + self.yz * z,
            self.xz * x + self.yz * y + self.zz * z,
        ]
    }
}

impl Sym3<f64> {
    /// The matrix applied to `v`.
    #[must_use]
    pub fn apply(&self, v: DVec3) -> DVec3 {
        self.times(v.to_array()).into()
    }
}

impl Sym3<f32> {
    /// The matrix applied to `v`.
    #[must_use]
    pub fn apply(&self, v: Vec3) -> Vec3 {
        self.times(v.to_array()).into()
    }
}

/// Fills a column with `len` times `value`, without spare capacity.
pub(crate) fn refill<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    column.clear();
    column.reserve_exact(len);
    column.resize(len, value);
}

/// Resizes a column. If it has to grow, it gets a spare capacity of a 32nd: growing by a few items
/// must not double its memory.
pub(crate) fn grow<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    if len > column.capacity() {
        column.reserve_exact(len - column.len() + column.len() / 32);
    }
    column.resize(len, value);
}

/// Returns the larger of two numbers, neither of which is NaN. `f32::max`, which handles NaN, takes
/// five instructions.
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Appends an item; a full vector grows by a sixteenth instead of doubling.
pub(crate) fn push_gently<T>(items: &mut Vec<T>, item: T) {
    if items.len() == items.capacity() {
        items.reserve_exact(64 + items.len() / 16);
    }
    items.push(item);
}

/// Two unit vectors that span the plane perpendicular to the unit vector `n`; `(u, v, n)` is
/// right-handed.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017: no branch, no division
/// by a small number. A non-finite `n` gives non-finite vectors.
#[must_use]
pub fn tangent_frame(n: Vec3) -> (Vec3, Vec3) {
    let (u, v) = frame_of(n.to_array());
    (u.into(), v.into())
}

/// [`tangent_frame`] over any numbers.
#[inline]
#[must_use]
pub fn frame_of<T: Real>([x, y, z]: [T; 3]) -> ([T; 3], [T; 3]) {
    let one = T::of(1.0);
    let sign = z.sign();
    let a = -one / (sign + z);
    let b = x * y * a;
    ([one + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y])
}

/// Largest power of two not above `x`, which must be positive, and at least the smallest normal
/// number.
pub(crate) fn power_of_two(x: f64) -> f64 {
    /// Bits of the sign and the exponent.
    const HEAD: u64 = 0xfff << 52;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & HEAD)
}

#[cfg(test)]
mod tests {
    use super::{Bounds, grouped, shortest_text};

    #[test]
    fn a_text_of_a_number_is_short_and_reads_back() {
        let cases = [
            (0.0, "0"),
            (-0.0, "-0"),
            (0.006, "0.006"),
            (-1.5, "-1.5"),
            (1e-5, "0.00001"),
            (9.5e-6, "9.5e-6"),
            (123_456_789.0, "123456789"),
            (999_999_999_999_999.9, "999999999999999.9"),
            (1e15, "1e15"),
            (5e-324, "5e-324"),
            (f64::MAX, "1.7976931348623157e308"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (value, text) in cases {
            assert_eq!(shortest_text(value), text);
            assert_eq!(text.parse(), Ok(value));
        }
        assert_eq!(shortest_text(f64::NAN), "NaN");
    }

    #[test]
    fn a_comma_stands_between_thousands() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn boxes_in_which_single_precision_fails_are_not_valid() {
        let far = |offset: f64| Bounds { min: [offset, -1.0, -1.0], max: [offset + 2.0, 1.0, 1.0] };
        for good in [Bounds::cube(1.0), Bounds::cube(2e11), Bounds::cube(5e-13), far(3000.0), far(-3000.0)] {
            assert!(good.is_valid(), "{good:?}");
        }
        let flat = Bounds { min: [-1.0, -1.0, 0.0], max: [1.0, 1.0, 0.0] };
        let open = Bounds { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
        let turned = Bounds { min: [1.0; 3], max: [-1.0; 3] };
        let nan = Bounds { min: [0.0, f64::NAN, 0.0], max: [1.0; 3] };
        let [huge, tiny] = [1e12, 1e-13].map(Bounds::cube);
        for bad in [flat, open, turned, nan, huge, tiny, Bounds::cube(1e308), far(4000.0), far(1e9)] {
            assert!(!bad.is_valid(), "{bad:?}");
        }
    }
}
