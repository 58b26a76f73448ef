//! Figures of the neighbourhoods: valence and six-fold order.

use super::figures::Order;
use super::moments::{Moments, share};
use super::points::MeasuredPoints;
use crate::math::tangent_frame;
use glam::DVec2;

/// Counts of the valences, and the bond order, of the points added so far.
#[derive(Default)]
pub(super) struct ValenceTally {
    count: usize,
    open: usize,
    six: usize,
    five_or_seven_neighbours: usize,
    valence: Moments,
    bond_order: Moments,
}

impl ValenceTally {
    /// Adds point `i`.
    pub(super) fn add(&mut self, points: &MeasuredPoints, i: usize) {
        self.count += 1;
        if points.stars.is_open[i] {
            self.open += 1;
            return;
        }
        let neighbours = points.stars.valence(i);
        self.valence.add(neighbours as f64);
        self.six += usize::from(neighbours == 6);
        self.five_or_seven_neighbours += usize::from(neighbours == 5 || neighbours == 7);
        let (u, v) = tangent_frame(points.normal[i]);
        let (u, v) = (u.as_dvec3(), v.as_dvec3());
        let p = points.tree.position[i].as_dvec3();
        let mut sum = DVec2::ZERO;
        for j in points.stars.of(i) {
            let offset = points.tree.position[j].as_dvec3() - p;
            let q = DVec2::new(offset.dot(u), offset.dot(v));
            let length_sq = q.length_squared();
            if length_sq > 0.0 {
                // exp(6iθ) is the cube of exp(2iθ), which needs no root.
                let square = q.rotate(q) / length_sq;
                sum += square.rotate(square).rotate(square);
            }
        }
        self.bond_order.add(sum.length() / neighbours as f64);
    }

    /// Adds the points of another tally.
    pub(super) fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.open += other.open;
        self.six += other.six;
        self.five_or_seven_neighbours += other.five_or_seven_neighbours;
        self.valence.join(&other.valence);
        self.bond_order.join(&other.bond_order);
    }

    pub(super) fn figures(&self) -> Order {
        Order {
            six_neighbours: share(self.six, self.count),
            five_or_seven_neighbours: share(self.five_or_seven_neighbours, self.count),
            valence_deviation: self.valence.deviation(),
            open: self.open,
            bond_order: self.bond_order.mean(),
        }
    }
}
