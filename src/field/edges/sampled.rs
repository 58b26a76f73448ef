//! Evaluation of the black box: values, second-order jets by differences, roots along a line.

use crate::field::{Field, Jet};
use crate::math::{Bounds, Sym3};
use glam::DVec3;

/// Step of the differences, as a share of the size of the box. Larger steps reach over edges more
/// often; smaller ones lose digits of the second derivatives by rounding.
const STEP: f64 = 1e-4;
/// Shares of the step that are tried in turn until f is smooth within one.
const SHARES: [f64; 4] = [1.0, 0.1, 0.01, 0.001];
/// Largest [noise] of f, as a share of the size of the box, at which edges are searched. With more,
/// as of a function in single precision, second differences are nothing but noise.
const MOST_NOISE: f64 = 1e-10;
/// Places on each half diagonal of the box at which the noise of f is measured.
const LISTENED: usize = 4;
/// Largest change of the slope over a step, as a share of the slope, that counts as smooth: a
/// radius of curvature of 250 steps.
const MOST_BENT: f64 = 0.004;
/// Number of values of a jet.
pub(super) const STENCIL: usize = 13;

/// A field, with the lengths that the search in a box uses.
pub(super) struct Sampled<'a> {
    pub(super) field: &'a dyn Field,
    /// The longest side of the box.
    pub(super) size: f64,
    /// Step of the differences.
    pub(super) step: f64,
}

impl<'a> Sampled<'a> {
    /// Returns nothing for a field whose values are too noisy.
    pub(super) fn new(field: &'a dyn Field, bounds: &Bounds) -> Option<Self> {
        let sampled = Self::in_box(field, bounds);
        (noise(field, bounds, sampled.size) <= MOST_NOISE * sampled.size).then_some(sampled)
    }

    /// A field however noisy it is.
    pub(super) fn in_box(field: &'a dyn Field, bounds: &Bounds) -> Self {
        let size = bounds.size().max_element();
        Self { field, size, step: STEP * size }
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        self.field.value(p)
    }

    /// The jets at these points, each by the largest share of `step` within which f is smooth; none
    /// where there is no such share.
    pub(super) fn jets(&self, points: &[DVec3], step: f64) -> Vec<Option<Jet>> {
        let mut found: Vec<Option<Jet>> = vec![None; points.len()];
        let mut open: Vec<usize> = (0..points.len()).collect();
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for step in SHARES.map(|share| share * step) {
            if open.is_empty() {
                break;
            }
            places.clear();
            places.extend(open.iter().flat_map(|&k| stencil(points[k], step)));
            values.clear();
            values.resize(places.len(), 0.0);
            self.field.values(&places, &mut values);
            let of = values.as_chunks::<STENCIL>().0;
            for (&k, own) in open.iter().zip(of) {
                found[k] = jet(own, step);
            }
            open.retain(|&k| found[k].is_none());
        }
        found
    }

    pub(super) fn jet(&self, p: DVec3, step: f64) -> Option<Jet> {
        self.jets(&[p], step)[0]
    }
}

/// The noise of f as a length: its rounding errors over its slope. It is the median of third
/// differences at 32 places, which vanish for exact values so close to each other.
fn noise(field: &dyn Field, bounds: &Bounds, size: f64) -> f64 {
    /// Distance between values, as a share of the size of the box.
    const APART: f64 = 1e-6;
    const STEPS: usize = 8;
    let corners = bounds.corners();
    let mut found = Vec::new();
    for (k, corner) in corners.iter().enumerate() {
        for share in (1..=LISTENED).map(|share| share as f64 / (LISTENED as f64 + 0.618)) {
            let start = corner.lerp(bounds.middle(), share);
            let way = DVec3::AXES[k % 3] * (APART * size);
            let mut places = [start + (corners[7 - k] - start) * 1e-3; STEPS + 1];
            (0..STEPS).for_each(|step| places[step] = start + way * step as f64);
            let mut values = [0.0; STEPS + 1];
            field.values(&places, &mut values);
            let [values @ .., far] = values;
            let slope = (far - values[0]).abs() / (1e-3 * start.distance(corners[7 - k]));
            let third = values.windows(4).map(|f| (f[3] - f[0] - 3.0 * (f[2] - f[1])).abs());
            let third = third.reduce(f64::max).unwrap_or(0.0) / slope;
            found.extend(Some(third).filter(|third| third.is_finite()));
        }
    }
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied().unwrap_or(0.0)
}

/// The places whose values make a jet: the point, both ways along each axis, and both ways along
/// the diagonal of each pair of axes.
pub(super) fn stencil(p: DVec3, step: f64) -> [DVec3; STENCIL] {
    let [x, y, z] = DVec3::AXES.map(|axis| axis * step);
    [
        p,
        p + x,
        p - x,
        p + y,
        p - y,
        p + z,
        p - z,
        p + x + y,
        p - x - y,
        p + x + z,
        p - x - z,
        p + y + z,
        p - y - z,
    ]
}

/// The jet by differences of the values at the places of [`stencil`]; none if the slope jumps
/// between them.
pub(super) fn jet(f: &[f64; STENCIL], step: f64) -> Option<Jet> {
    let jet = jet_across(f, step);
    let most = MOST_BENT * step * jet.gradient.length();
    // Written so that NaN fails.
    let is_straight = |change: f64| change.abs() <= most;
    let bends = [1, 3, 5].map(|k| f[k] - 2.0 * f[0] + f[k + 1]);
    let corners = [[7, 1, 3], [9, 1, 5], [11, 3, 5]];
    // Both ways along a diagonal the mixed differences are the same, but where an edge passes.
    let mixed = corners.map(|[c, a, b]| {
        let [ahead, behind] = [0, 1].map(|k| f[c + k] - f[a + k] - f[b + k] + f[0]);
        ahead - behind
    });
    (bends.into_iter().all(is_straight) && mixed.into_iter().all(is_straight)).then_some(jet)
}

/// The jet by differences of the values at the places of [`stencil`], smooth or not.
fn jet_across(f: &[f64; STENCIL], step: f64) -> Jet {
    let along = |k: usize| (f[k] - f[k + 1]) / (2.0 * step);
    let twice = |k: usize| (f[k] - 2.0 * f[0] + f[k + 1]) / (step * step);
    let mixed = |c: usize, a: usize, b: usize| {
        let both = [0, 1].map(|k| f[c + k] - f[a + k] - f[b + k] + f[0]);
        0.5 * (both[0] + both[1]) / (step * step)
    };
    Jet {
        value: f[0],
        gradient: DVec3::new(along(1), along(3), along(5)),
        hessian: Sym3 {
            xx: twice(1),
            xy: mixed(7, 1, 3),
            xz: mixed(9, 1, 5),
            yy: twice(3),
            yz: mixed(11, 3, 5),
            zz: twice(5),
        },
    }
}

/// An interval of a line at whose ends f has different signs. The Illinois method narrows it (M.
/// Dowell and P. Jarratt, "A modified regula falsi method for computing the root of an equation",
/// 1971).
pub(super) struct Bracket {
    at: [f64; 2],
    /// Values of f at the ends. That of an end that stays is halved each time.
    value: [f64; 2],
    /// The end that was replaced last; 2 at the beginning.
    last: usize,
}

impl Bracket {
    pub(super) fn new(at: [f64; 2], value: [f64; 2]) -> Self {
        Self { at, value, last: 2 }
    }

    /// The zero of the straight line through both ends: where f is to be evaluated next.
    pub(super) fn root(&self) -> f64 {
        let ([a, b], [f, g]) = (self.at, self.value);
        (a * g - b * f) / (g - f)
    }

    /// Replaces an end by the value of f at [`Bracket::root`]. Returns how far the end has moved; 0
    /// where f is zero or undefined.
    pub(super) fn narrow(&mut self, root: f64, value: f64) -> f64 {
        let side = usize::from((value < 0.0) != (self.value[0] < 0.0));
        let moved = (self.at[side] - root).abs();
        (self.at[side], self.value[side]) = (root, value);
        if self.last == side {
            self.value[1 - side] *= 0.5;
        }
        self.last = side;
        if value == 0.0 || !value.is_finite() { 0.0 } else { moved }
    }

    pub(super) fn width(&self) -> f64 {
        (self.at[1] - self.at[0]).abs()
    }
}

/// The second-order Taylor polynomial of a function around a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taylor {
    pub(super) p: DVec3,
    pub(super) jet: Jet,
}

impl Taylor {
    /// The polynomial and its gradient at a place.
    pub(super) fn slope(&self, q: DVec3) -> (f64, DVec3) {
        let d = q - self.p;
        let bent = self.jet.hessian.apply(d);
        (self.jet.value + d.dot(self.jet.gradient + 0.5 * bent), self.jet.gradient + bent)
    }

    /// The polynomial's own jet at a place.
    pub(super) fn jet(&self, q: DVec3) -> Jet {
        let (value, gradient) = self.slope(q);
        Jet { value, gradient, hessian: self.jet.hessian }
    }

    /// The unit normal at the point.
    pub(super) fn normal(&self) -> DVec3 {
        self.jet.gradient.normalize_or_zero()
    }

    /// About the largest curvature at the point.
    pub(super) fn bend(&self) -> f64 {
        let most = self.jet.hessian.entries().into_iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        most / self.jet.gradient.length()
    }
}
