//! Bounds over boxes of the branches that may have zeros there.

use super::branches::{BranchPart, Branches};
use super::compiled::Compiled;
use super::graph::Id;
use super::interval::{self, FactorProgram};
use crate::field::Enclosure;
use crate::math::{Bounds, Interval};

impl Branches {
    /// The functions at the edge of a part that may be zero in a box, if the part vanishes only
    /// there: its gradient is in the cone of theirs. None if it is not zero in the box.
    pub(super) fn edge_in(&mut self, part: usize, values: &[f64], bounds: &Bounds) -> Option<Vec<Id>> {
        let BranchPart { root, nodes, .. } = &self.parts[part];
        interval::bounds(&self.base.graph, nodes, values, bounds, &mut self.ranges);
        let may_vanish = !self.ranges[*root as usize].at(0).is_nonzero();
        let known = self.edges.iter().find(|known| known.0 == part);
        may_vanish.then(|| known.map_or_else(Vec::new, |known| known.1.clone()))
    }

    /// The program for the bounds of a node.
    pub(super) fn bounds_of(&self, node: Id, values: &[f64]) -> FactorProgram {
        let (graph, root) = self.base.graph.part(node);
        Compiled::from_graph(graph, root, values).whole()
    }

    /// Empties the enclosures of a factor of a branch over boxes where the branch has no zero of f.
    pub(super) fn leave_out(&mut self, number: u32, values: &[f64], boxes: &[Bounds], out: &mut [Enclosure]) {
        for (bounds, out) in boxes.iter().zip(out).filter(|(_, out)| out.may_vanish) {
            if self.within(values, bounds).is_some_and(|within| !within.contains(&number)) {
                *out = Enclosure::NOWHERE;
            }
        }
    }

    /// Empties the enclosures of f over boxes where only limits may vanish. Where the surface may
    /// end, the gradient has no bounds: an end may face any direction.
    pub(super) fn leave_out_limits(&mut self, values: &[f64], boxes: &[Bounds], out: &mut [Enclosure]) {
        if !self.has_limits() {
            return;
        }
        for (bounds, out) in boxes.iter().zip(out).filter(|(_, out)| out.may_vanish) {
            let within = self.within(values, bounds);
            let mut limits =
                |within: &Vec<u32>| within.iter().filter(|&&number| self.is_limit(number, values)).count();
            match within.as_ref().map(|within| (limits(within), within.len())) {
                Some((0, _)) => {}
                Some((limits, all)) if limits == all => *out = Enclosure::NOWHERE,
                _ => out.gradient = [Interval::EVERYTHING; 3],
            }
        }
    }
}
