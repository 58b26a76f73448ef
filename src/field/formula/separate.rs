//! The sheets of a surface that choices keep apart: the two spheres of max(|p| − 1, 0.9 − |p|), one
//! from zeros of the first operand, the other one from zeros of the second.
//!
//! A choice that f depends on everywhere on the surface, and that is tied nowhere on it, keeps its
//! sides apart: a connected component that lay on both would cross the tie. Around the component f
//! equals the function in which the choice has taken its side, so the component belongs to the
//! zeros of that function. Points on all components of these zeros therefore include one on every
//! component of the surface. The search for components takes these functions one by one, as it
//! takes the factors of a product, and its cells can hold both sheets.
//!
//! f depends on a choice everywhere if the path from f to it passes only operations and the taken
//! sides of choices that keep their sides apart: where another choice is tied, a component may
//! bypass one of its operands.

use super::branches::{Base, BranchPart, Branches, ChoiceCondition, Holds, NodeRole, Sheet, Side};
use super::branches::{resolved, taken};
use super::derivative;
use super::graph::Id;
use super::interval;
use crate::field::Enclosure;
use crate::math::Bounds;
use glam::DVec3;
use std::collections::VecDeque;

/// Maximum number of sheets, beyond which choices stay open: each program holds all of f too, so
/// that their total size grows with the square of the number.
const MAX_SHEETS: usize = 16;

impl Branches {
    /// f as one branch, with the sheets that its choices keep apart, if there are several. The
    /// choices in `tied` are tied somewhere on the surface.
    pub(super) fn separated(&self, tied: &[Id], values: &[f64]) -> Self {
        let BranchPart { root, nodes, .. } = &self.parts[0];
        let mut whole = Self::default();
        let mut open: VecDeque<Vec<Side>> = VecDeque::from([Vec::new()]);
        let mut apart = Vec::new();
        while let Some(sides) = open.pop_front() {
            match self.base.undecided(*root, &sides, tied) {
                Some(condition) if apart.len() + open.len() + 2 <= MAX_SHEETS => {
                    open.extend([true, false].map(|holds| {
                        let mut sides = sides.clone();
                        sides.push((condition, holds));
                        sides
                    }));
                }
                _ => apart.push(sides),
            }
        }
        if apart.len() > 1 {
            whole.base = self.base.clone();
            whole.sheets =
                apart.into_iter().map(|sides| self.base.sheet(*root, nodes, sides, values)).collect();
        }
        whole
    }

    /// Empties the enclosures of a sheet over boxes that it does not meet.
    pub(super) fn leave_out_sheet(
        &mut self,
        sheet: usize,
        values: &[f64],
        boxes: &[Bounds],
        out: &mut [Enclosure],
    ) {
        let Sheet { sides, nodes, .. } = &self.sheets[sheet];
        for (bounds, out) in boxes.iter().zip(out).filter(|(_, out)| out.may_vanish) {
            interval::bounds(&self.base.graph, nodes, values, bounds, &mut self.ranges);
            let is_elsewhere = sides.iter().any(|&(condition, holds)| {
                let other = if holds { Holds::Never } else { Holds::Always };
                condition.in_box(|id| self.ranges[id as usize].at(0)) == other
            });
            if is_elsewhere {
                *out = Enclosure::NOWHERE;
            }
        }
    }

    /// Whether the function of a sheet gives f at a point.
    pub(super) fn is_on_sheet(&mut self, sheet: usize, values: &[f64], p: DVec3) -> bool {
        let Sheet { sides, nodes, .. } = &self.sheets[sheet];
        self.base.graph.evaluate(nodes, values, p, &mut self.doubles);
        let is_taken = |&(condition, holds): &Side| {
            (condition.at_point(|id| self.doubles[id as usize]) == Holds::Always) == holds
        };
        sides.iter().all(is_taken)
    }
}

impl Base {
    /// The condition of a choice that f depends on everywhere on these sides of others, and that is
    /// not tied on the surface.
    fn undecided(&self, root: Id, sides: &[Side], tied: &[Id]) -> Option<ChoiceCondition> {
        let (mut open, mut seen) = (vec![root], vec![false; root as usize + 1]);
        while let Some(id) = open.pop() {
            if core::mem::replace(&mut seen[id as usize], true) || self.graph.is_uniform(id) {
                continue;
            }
            let node = self.graph.node(id);
            match self.roles[id as usize] {
                NodeRole::Plain => node.operands(|operand| open.push(operand)),
                NodeRole::Raised(u) => open.push(u),
                NodeRole::Choice(condition) => match sides.iter().find(|side| side.0 == condition) {
                    Some(&(_, holds)) => open.extend(taken(node, holds)),
                    None if tied.contains(&id) => {}
                    None => return Some(condition),
                },
            }
        }
        None
    }

    /// The sheet on these sides of choices of the function `root`, which needs `nodes`.
    fn sheet(&self, root: Id, nodes: &[Id], sides: Vec<Side>, values: &[f64]) -> Sheet {
        let mut graph = self.graph.clone();
        let mut map: Vec<Id> = (0..graph.len() as Id).collect();
        for &id in nodes {
            let (node, new) = (self.graph.node(id), |id: Id| map[id as usize]);
            let side = match self.roles[id as usize] {
                NodeRole::Choice(condition) => sides.iter().find(|side| side.0 == condition),
                NodeRole::Plain | NodeRole::Raised(_) => None,
            };
            map[id as usize] = match side {
                Some(&(_, holds)) => resolved(&mut graph, node, holds, new),
                None => graph.built(node.mapped(new)),
            };
        }
        graph.let_zero_annihilate();
        let function = map[root as usize];
        let gradient = derivative::gradient(&mut graph, function);
        let mut programs = interval::factors(&mut graph, function, gradient, root);
        programs.iter_mut().for_each(|program| program.set_parameters(values));
        let of_conditions: Vec<Id> = sides.iter().flat_map(|(condition, _)| condition.operands()).collect();
        Sheet { nodes: self.graph.needed_by(&of_conditions), sides, programs }
    }
}

#[cfg(test)]
mod tests {
    use crate::field::formula::Formula;
    use crate::field::{Enclosure, Evaluator, Frame, Piecewise};
    use crate::math::Bounds;
    use crate::slices;
    use glam::DVec3;

    /// Calls `with` on the evaluator of a formula whose creases in a box have been looked for; it
    /// has none.
    fn on_smooth(text: &str, with: impl Fn(&mut dyn Evaluator)) {
        let field = Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let (cells, function) = slices::complete(field.pieces_in(&Bounds::cube(1.5), 0.04, 64));
        assert!(cells.is_empty(), "{text}");
        with(&mut *function.evaluator(Frame::default()));
    }

    #[test]
    fn choices_that_are_tied_nowhere_on_the_surface_keep_its_sheets_apart() {
        let torus = "hypot(hypot(x, y) - 1, z) - 0.35";
        for (text, sheets) in [
            ("max(hypot(x, y, z) - 1, 0.9 - hypot(x, y, z))", 2),
            ("abs(x^2 + y^2 + z^2 - 1) - 0.01", 2),
            ("hypot(abs(x) - 1, y, z) - 0.3", 2),
            ("min(hypot(x - 1, y, z), hypot(x + 1, y, z), hypot(x, y - 1, z)) - 0.3", 3),
            // A ball within a shell, through which the middle of the shell passes.
            (&format!("max(abs({torus}) - 0.1, hypot(x - 1.35, y, z) - 0.08)"), 3),
            // The ties are on the surface, or the surface goes past them.
            ("hypot(max(abs(x) - 1, 0), y, z) - 0.3", 1),
            ("max(x, 0)^2 + y^2 + z^2 - 1", 1),
            ("x^2 + y^2 + z^2 - 1", 1),
            // The two factors of a product: the ball of one lies across the middle of the shell.
            ("(hypot(x - 0.5, y, z) - 0.05) * max(hypot(x, y, z) - 0.6, 0.4 - hypot(x, y, z))", 2),
        ] {
            on_smooth(text, |evaluator| {
                assert_eq!(evaluator.bounded().map(|field| field.factors()), Some(sheets), "{text}");
                assert_eq!(evaluator.label(DVec3::X), 0, "{text}: the surface is one patch");
            });
        }
    }

    #[test]
    fn a_sheet_is_where_its_operand_gives_f() {
        on_smooth("max(hypot(x, y, z) - 1, 0.9 - hypot(x, y, z))", |evaluator| {
            let field = evaluator.bounded().expect("a formula has bounds");
            // On the second sheet, on both sides of the tie, and on the first sheet.
            let places = [0.9, 0.94, 0.96, 1.0];
            let near = |x: f64| Bounds::new(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 0.001, 0.0, 0.0));
            let boxes = places.map(near);
            for (factor, is_there) in [(0, [false, false, true, true]), (1, [true, true, false, false])] {
                let gives = places.map(|x| field.gives(factor, DVec3::X * x));
                assert_eq!(gives, is_there);
                let mut known = [Enclosure::UNKNOWN; 4];
                field.enclose(factor, &boxes, &mut known);
                let zero = usize::from(factor == 0) * 3;
                for (k, known) in known.iter().enumerate() {
                    assert_eq!(known.may_vanish, k == zero, "factor {factor} at {}", places[k]);
                }
            }
            // In a box that holds both sheets each has bounds of its own slope.
            let both = [Bounds::new(DVec3::new(0.85, 0.0, 0.0), DVec3::new(1.05, 0.1, 0.1))];
            for (factor, sign) in [(0, 1.0), (1, -1.0)] {
                let mut known = [Enclosure::UNKNOWN];
                field.enclose(factor, &both, &mut known);
                let slope = known[0].gradient[0];
                assert!(known[0].may_vanish && slope.lo * sign > 0.0 && slope.hi * sign > 0.0, "{slope:?}");
            }
        });
    }
}
