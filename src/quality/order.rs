//! Figures of the neighbourhoods: valence and six-fold order.

use super::figures::Order;
use super::moments::{Moments, share};
use super::one_rings::unroll;
use super::points::MeasuredPoints;
use crate::math::tangent_frame;
use glam::DVec2;

/// Counts of the valences, and the bond order, of the points seen so far.
#[derive(Default)]
pub(super) struct ValenceTally {
    count: usize,
    open: usize,
    six: usize,
    five_seven: usize,
    valence: Moments,
    psi6: Moments,
}

impl ValenceTally {
    /// Takes in point `i`.
    pub(super) fn add(&mut self, points: &MeasuredPoints, i: usize) {
        self.count += 1;
        if !points.rings.closed[i] {
            self.open += 1;
            return;
        }
        let neighbours = points.rings.valence(i);
        self.valence.add(neighbours as f64);
        self.six += usize::from(neighbours == 6);
        self.five_seven += usize::from(neighbours == 5 || neighbours == 7);
        let (u, v) = tangent_frame(points.normal[i]);
        let (u, v) = (u.as_dvec3(), v.as_dvec3());
        let p = points.tree.position[i].as_dvec3();
        let mut sum = DVec2::ZERO;
        for j in points.rings.of(i) {
            if let Some(q) = unroll(points.tree.position[j].as_dvec3() - p, u, v) {
                // exp(6iθ) is exp(iθ) to the sixth power, which takes products alone.
                let unit = q / q.length();
                let square = unit.rotate(unit);
                sum += square.rotate(square).rotate(square);
            }
        }
        self.psi6.add(sum.length() / neighbours as f64);
    }

    pub(super) fn figures(&self) -> Order {
        Order {
            six: share(self.six, self.count),
            five_seven: share(self.five_seven, self.count),
            val_sd: self.valence.deviation(),
            open: self.open,
            psi6: self.psi6.mean(),
        }
    }
}
