//! Taylor polynomials of the sum over far centres.
//!
//! Around the middle of a cell the terms of far centres are smooth, so one polynomial of a few
//! dozen coefficients replaces all of them. The recurrence for |d + t|³ follows from u ∇φ = 3 (d +
//! t) φ with u = |d + t|², φ = u^(3/2), degree by degree (Duan & Krasny, "An adaptive treecode for
//! computing nonbonded potential energy in classical molecular systems", 2001, have it for other
//! powers).

use super::coefficients::{Centre, DEGREE, Rows};
use crate::math::{LANES, Lanes};
use glam::DVec3;

/// Number of coefficients of a polynomial of degree [`DEGREE`] in three variables.
pub(super) const TERMS: usize = below(DEGREE + 1);
/// Number of coefficients for one degree more, which ∇φ needs.
const MORE_TERMS: usize = below(DEGREE + 2);
/// Powers along each axis of the cube that holds a polynomial while it is shifted.
const POWERS: usize = DEGREE + 1;

/// Returns the number of terms in three variables below a degree.
const fn below(degree: usize) -> usize {
    degree * (degree + 1) * (degree + 2) / 6
}

/// Coefficients in the order of their degree. The variables are offsets from the middle of a cell
/// in units of its half-width.
pub(super) type Polynomial = [f64; TERMS];

/// The powers of a term, and the indices of the terms next to it.
#[derive(Clone, Copy, Debug)]
struct Term {
    powers: [usize; 3],
    /// Index of the term with one power less along each axis; if there is none, [`MORE_TERMS`],
    /// whose coefficient is zero. The type is a byte, so that indices need no bounds checks.
    less: [u8; 3],
    /// Index of the term with two powers less.
    less_two: [u8; 3],
    /// Index of the term with one power more.
    more: [u8; 3],
}

/// Tables that all polynomials share.
#[derive(Clone, Debug)]
pub(super) struct Taylor {
    terms: Vec<Term>,
    /// For each row of [`Rows`] the indices of its coefficients; [`MORE_TERMS`] beyond the degree.
    rows: Vec<[usize; LANES]>,
}

/// A number for each of the centres that are expanded together.
type CentreGroup = [f64; LANES];
/// Length of the buffer for the coefficients of a group of centres: as many entries as a byte can
/// index.
const PLACES: usize = 256;

impl Taylor {
    pub(super) fn new() -> Self {
        let mut powers: Vec<[usize; 3]> = Vec::new();
        for degree in 0..=DEGREE + 1 {
            for i in 0..=degree {
                powers.extend((0..=degree - i).map(|j| [degree - i - j, j, i]));
            }
        }
        let index = |wanted: [usize; 3]| powers.iter().position(|p| *p == wanted).unwrap_or(MORE_TERMS);
        let moved = |from: [usize; 3], by: isize| {
            [0, 1, 2].map(|axis| {
                let mut to = from;
                let power = to[axis].checked_add_signed(by);
                to[axis] = power.unwrap_or(usize::MAX);
                index(to) as u8
            })
        };
        let terms = powers
            .iter()
            .map(|&p| Term { powers: p, less: moved(p, -1), less_two: moved(p, -2), more: moved(p, 1) })
            .collect();
        let mut rows = Vec::new();
        for i in (0..=DEGREE).rev() {
            for k in (0..=DEGREE - i).rev() {
                let within = |j: usize| i + j + k <= DEGREE;
                rows.push(core::array::from_fn(|j| if within(j) { index([k, j, i]) } else { MORE_TERMS }));
            }
        }
        Self { terms, rows }
    }

    /// Adds the terms of `centres`, which must not be at `middle`, to the polynomial of a cell.
    pub(super) fn expand(&self, polynomial: &mut Polynomial, middle: DVec3, half: f64, centres: &[Centre]) {
        let mut powers = vec![[0.0; LANES]; PLACES];
        for group in centres.chunks(LANES) {
            let at = |k: usize| group[k.min(group.len() - 1)];
            // In units of the cell φ has the factor half³, and ∇φ has half².
            let offset = core::array::from_fn(|k| (middle - at(k).position) / half);
            let real: [f64; LANES] =
                core::array::from_fn(|k| if k < group.len() { half * half } else { 0.0 });
            let alpha: [f64; LANES] = core::array::from_fn(|k| at(k).alpha * half * real[k]);
            let beta: [DVec3; LANES] = core::array::from_fn(|k| at(k).beta * real[k]);
            self.expand_group(polynomial, &mut powers, &offset, &alpha, &beta);
        }
    }

    /// Adds α |d + t|³ + β · ∇|d + t|³ for each d.
    fn expand_group(
        &self,
        polynomial: &mut Polynomial,
        powers: &mut [CentreGroup],
        offset: &[DVec3; LANES],
        alpha: &CentreGroup,
        beta: &[DVec3; LANES],
    ) {
        let d: [CentreGroup; 3] = [0, 1, 2].map(|axis| offset.map(|d| d[axis]));
        let beta: [CentreGroup; 3] = [0, 1, 2].map(|axis| beta.map(|b| b[axis]));
        let inverse: CentreGroup = offset.map(|d| 1.0 / d.length_squared());
        let Some(powers) = powers.first_chunk_mut::<PLACES>() else {
            unreachable!("the buffer has its places");
        };
        powers[0] = offset.map(|d| d.length_squared() * d.length());
        recur(powers, &self.terms, &d, &inverse);
        collect(polynomial, powers, &self.terms, alpha, &beta);
    }

    /// Returns the polynomial of the eighth of the cell whose middle is at `side`/2; each component
    /// of `side` is −1 or 1.
    pub(super) fn shifted(&self, polynomial: &Polynomial, side: [f64; 3]) -> Polynomial {
        let mut cube = [0.0; POWERS * POWERS * POWERS];
        let place = |[k, j, i]: [usize; 3]| (i * POWERS + j) * POWERS + k;
        for (value, term) in polynomial.iter().zip(&self.terms) {
            cube[place(term.powers)] = *value;
        }
        for (axis, stride) in [1, POWERS, POWERS * POWERS].into_iter().enumerate() {
            let middle = 0.5 * side[axis];
            for term in self.terms[..TERMS].iter().filter(|term| term.powers[axis] == 0) {
                let (first, top) = (place(term.powers), DEGREE - term.powers.iter().sum::<usize>());
                // Repeated synthetic division gives Σ cₖ (middle + t/2)ᵏ.
                for low in 0..top {
                    for k in (low..top).rev() {
                        cube[first + k * stride] += middle * cube[first + (k + 1) * stride];
                    }
                }
                let mut scale = 1.0;
                for k in 0..=top {
                    cube[first + k * stride] *= scale;
                    scale *= 0.5;
                }
            }
        }
        core::array::from_fn(|n| cube[place(self.terms[n].powers)])
    }

    /// Returns the coefficients in single precision, in the order of the kernel.
    pub(super) fn rows(&self, polynomial: &Polynomial) -> Rows {
        core::array::from_fn(|row| {
            Lanes(self.rows[row].map(|n| polynomial.get(n).map_or(0.0, |&coefficient| coefficient as f32)))
        })
    }
}

/// Computes the coefficients of |d + t|³ by the recurrence; the first one is given.
// Not inlined, as `collect`, for the SIMD registers: inlined, the two take 20 % more instructions.
#[inline(never)]
fn recur(a: &mut [CentreGroup; PLACES], terms: &[Term], d: &[CentreGroup; 3], inverse: &CentreGroup) {
    for degree in 1..=DEGREE + 1 {
        let m = degree as f64;
        let [one, two] = [(5.0 - 2.0 * m) / m, (5.0 - m) / m].map(|factor| inverse.map(|i| factor * i));
        let range = below(degree)..below(degree + 1);
        for (n, term) in range.clone().zip(&terms[range]) {
            let [x, y, z] = term.less.map(|n| &a[usize::from(n)]);
            let [xx, yy, zz] = term.less_two.map(|n| &a[usize::from(n)]);
            let along: CentreGroup =
                core::array::from_fn(|k| d[0][k] * x[k] + d[1][k] * y[k] + d[2][k] * z[k]);
            let around: CentreGroup = core::array::from_fn(|k| xx[k] + yy[k] + zz[k]);
            a[n] = core::array::from_fn(|k| one[k] * along[k] + two[k] * around[k]);
        }
    }
}

/// Adds α |d + t|³ + β · ∇|d + t|³ of all centres of a group.
// Not inlined: see `recur`.
#[inline(never)]
fn collect(
    polynomial: &mut Polynomial,
    a: &[CentreGroup; PLACES],
    terms: &[Term],
    alpha: &CentreGroup,
    beta: &[CentreGroup; 3],
) {
    // This is β along each axis times the power that a derivative brings down.
    let weighed = beta.map(|b| -> [CentreGroup; POWERS] {
        core::array::from_fn(|power| b.map(|b| b * (power + 1) as f64))
    });
    for (sum, (a_n, term)) in polynomial.iter_mut().zip(a.iter().zip(terms)) {
        let [x, y, z] = term.more.map(|n| &a[usize::from(n)]);
        let [p, q, r] = [0, 1, 2].map(|axis| &weighed[axis][term.powers[axis]]);
        let slope: CentreGroup = core::array::from_fn(|k| p[k] * x[k] + q[k] * y[k] + r[k] * z[k]);
        let [e, f, g, h, i, j, k, l]: CentreGroup = core::array::from_fn(|k| alpha[k] * a_n[k] + slope[k]);
        *sum += ((e + i) + (g + k)) + ((f + j) + (h + l));
    }
}
