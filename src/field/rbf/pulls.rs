//! Pulls, which draw out or push in a surface around a place and leave the rest of it.
//!
//! A pull by the vector b takes the surface {f = 0} to {f ∘ w = 0}, where w(x) = x − g b moves
//! points back. The weight g = (1 − q)³ with q = |x − c|²/R² is 1 at the place c that the surface
//! is pulled to, and 0 beyond the distance R. It has two continuous derivatives, and for |b| ≤ R/2
//! the map w is one to one: the slope of g is at most 1.72/R, so the surface neither tears nor
//! meets itself. Several pulls are made one after the other.

use super::DataError;
use crate::field::Jet;
use crate::math::{Bounds, Sym3};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Largest length of a pull, over its reach. Space folds from 0.58 on: one over the largest slope
/// of (1 − s²)³, which is 1.717, at s = 1/√5.
pub const LONGEST_PULL: f64 = 0.5;

/// A pull on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Pull {
    /// The place that is pulled, on the surface as the pulls before have left it.
    pub at: [f64; 3],
    /// The vector of the pull.
    pub by: [f64; 3],
    /// Distance from the pulled place's destination beyond which nothing moves. It is at least
    /// twice the length of `by`.
    pub reach: f64,
}

impl Pull {
    fn is_valid(&self) -> bool {
        let by = DVec3::from(self.by).length();
        self.at.iter().all(|x| x.is_finite())
            && self.reach.is_finite()
            && self.reach > 0.0
            && by <= LONGEST_PULL * self.reach
    }

    /// The offset of a point from the destination, over the reach, and 1 minus its square; none
    /// beyond the reach.
    fn offset(&self, p: DVec3) -> Option<(DVec3, f64)> {
        let offset = (p - DVec3::from(self.at) - DVec3::from(self.by)) / self.reach;
        let rest = 1.0 - offset.length_squared();
        (rest > 0.0).then_some((offset, rest))
    }

    /// The point that is moved to `p`.
    fn back(&self, p: DVec3) -> DVec3 {
        self.offset(p).map_or(p, |(_, rest)| p - DVec3::from(self.by) * (rest * rest * rest))
    }

    /// Turns the derivatives in `jet`, of a function at [`Pull::back`], into those of the pulled
    /// function at `p`.
    fn pull_back(&self, p: DVec3, jet: &mut Jet) {
        let Some((offset, rest)) = self.offset(p) else { return };
        let by = DVec3::from(self.by);
        // ∇g, and with b · ∇f the second derivatives of g.
        let slope = offset * (-6.0 * rest * rest / self.reach);
        let along = by.dot(jet.gradient);
        let bend = along * 6.0 * rest / (self.reach * self.reach);
        let curved = jet.hessian.apply(by);
        let twice = by.dot(curved);
        let entry = |i: usize, j: usize| {
            let own = if i == j { rest } else { 0.0 };
            jet.hessian.at(i, j) - slope[i] * curved[j] - curved[i] * slope[j]
                + twice * slope[i] * slope[j]
                + bend * (own - 4.0 * offset[i] * offset[j])
        };
        jet.hessian = Sym3::by(entry);
        jet.gradient -= slope * along;
    }
}

/// A box with room for the places that are pulled out of it.
pub(crate) fn pulled_box(bounds: &Bounds, pulls: &[Pull]) -> Bounds {
    pulls.iter().fold(*bounds, |bounds, pull| {
        let by = DVec3::from(pull.by);
        bounds.joined(&Bounds::new(bounds.lo() + by, bounds.hi() + by))
    })
}

/// Pulls that are made one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Pulls(Vec<Pull>);

impl Pulls {
    pub(super) fn new(list: &[Pull]) -> Result<Self, DataError> {
        match list.iter().position(|pull| !pull.is_valid()) {
            Some(index) => Err(DataError::Pull { index }),
            None => Ok(Self(list.to_vec())),
        }
    }

    pub(super) fn list(&self) -> &[Pull] {
        &self.0
    }

    /// The point that is moved to `p`.
    pub(super) fn back(&self, p: DVec3) -> DVec3 {
        self.0.iter().rev().fold(p, |p, pull| pull.back(p))
    }

    /// Turns the derivatives in `jet`, of a function at [`Pulls::back`], into those of the pulled
    /// function at `p`.
    pub(super) fn pull_back(&self, p: DVec3, jet: &mut Jet) {
        pull_back(&self.0, p, jet);
    }
}

fn pull_back(pulls: &[Pull], p: DVec3, jet: &mut Jet) {
    let Some((last, before)) = pulls.split_last() else { return };
    pull_back(before, last.back(p), jet);
    last.pull_back(p, jet);
}
