//! The evaluator of a combination, whose pieces are those of its parts.

use super::Combination;
use crate::field::{BATCH, Evaluator, Field, Frame, Jet, Pieces, Pointwise};
use crate::math::{Bounds, Sym3};
use crate::slices;
use glam::{DVec3, Vec3};

/// Evaluates a combination. The pieces of a minimum or maximum are those of its two parts: label l
/// of the first part becomes 2l, of the second part 2l + 1.
pub(super) struct CombinationEvaluator<'a> {
    pub(super) field: &'a Combination,
    pub(super) parts: Vec<Box<dyn Evaluator + 'a>>,
    frame: Frame,
    /// The evaluator of a piece, once one is needed.
    piece: Option<Box<PieceEvaluator<'a>>>,
    /// Values and derivatives of the parts at the points of a batch: of the first part, then of the
    /// second one.
    values: Vec<f32>,
    gradients: Vec<Vec3>,
    hessians: Vec<Sym3<f32>>,
    /// Values and gradients of the parts at the points of a batch, in double precision.
    exact: (Vec<f64>, Vec<DVec3>),
}

/// The highest derivatives that a batch needs.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Order {
    Values,
    Gradients,
    Hessians,
}

impl<'a> CombinationEvaluator<'a> {
    pub(super) fn new(field: &'a Combination, frame: Frame) -> Self {
        let parts: Vec<_> = field.parts.iter().map(|part| part.evaluator(frame)).collect();
        Self {
            field,
            parts,
            frame,
            piece: None,
            values: Vec::new(),
            gradients: Vec::new(),
            hessians: Vec::new(),
            exact: Default::default(),
        }
    }

    /// Whether batches hold values that the rule cannot be applied to: arsinh(f/s), which commutes
    /// only with a minimum or maximum.
    fn is_compressed(&self) -> bool {
        self.frame.double.is_some() && !self.field.is_extreme()
    }

    fn pointwise(&self) -> Pointwise<'a, Combination> {
        Pointwise { field: self.field, frame: self.frame }
    }

    /// Evaluates the parts, and calls `store` with the index of each point and the jet of the
    /// combination there, up to this order.
    fn batches(&mut self, order: Order, points: &[Vec3], mut store: impl FnMut(usize, &Jet)) {
        let rule = self.field.rule.scaled(self.frame.scale.into());
        let size = self.parts.len() * BATCH;
        let (has_gradients, has_hessians) = (order >= Order::Gradients, order == Order::Hessians);
        self.values.resize(size, 0.0);
        self.gradients.resize(size, Vec3::ZERO);
        self.hessians.resize(size, Sym3::default());
        for (first, points) in (0..).step_by(BATCH).zip(points.chunks(BATCH)) {
            for (part, own) in self.parts.iter_mut().zip((0..).step_by(BATCH)) {
                let own = own..own + BATCH;
                let (value, gradient) = (&mut self.values[own.clone()], &mut self.gradients[own.clone()]);
                match order {
                    Order::Values => part.values(points, value),
                    Order::Gradients => part.gradients(points, value, gradient),
                    Order::Hessians => part.hessians(points, value, gradient, &mut self.hessians[own]),
                }
            }
            for k in 0..points.len() {
                let jet = |at: usize| Jet {
                    value: self.values[at].into(),
                    gradient: if has_gradients { self.gradients[at].as_dvec3() } else { DVec3::ZERO },
                    hessian: if has_hessians { self.hessians[at].map(f64::from) } else { Sym3::default() },
                };
                store(first + k, &rule.jet(&mut (k..size).step_by(BATCH).map(jet)));
            }
        }
    }

    /// The scale of single points, see [`Frame::exact`].
    fn exact_scale(&self) -> f64 {
        f64::from(self.frame.scale) / self.frame.double.unwrap_or(1.0)
    }

    /// The branches of a part in a box.
    pub(super) fn branches_of(&mut self, part: usize, bounds: &Bounds) -> Option<Vec<u32>> {
        let part = &mut self.parts[part];
        if part.pieces().is_some() { part.labels_in(bounds) } else { Some(vec![0]) }
    }

    /// The function of a branch of a part.
    pub(super) fn function(&mut self, part: usize, branch: u32) -> &mut dyn Evaluator {
        let part = &mut *self.parts[part];
        let own = part.pieces().is_some().then_some(branch);
        part.on(own)
    }

    /// The part that gives f at `p`, where this is a minimum or maximum.
    pub(super) fn part_at(&mut self, p: DVec3) -> usize {
        let [a, b] = [0, 1].map(|k: usize| self.parts[k].value_and_gradient(p).0);
        self.field.rule.taken(a, b)
    }
}

impl Evaluator for CombinationEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(Self::new(self.field, self.frame))
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        if self.is_compressed() {
            return self.pointwise().values(points, value);
        }
        self.batches(Order::Values, points, |k, jet| value[k] = jet.value as f32);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        if self.is_compressed() {
            return self.pointwise().gradients(points, value, gradient);
        }
        self.batches(Order::Gradients, points, |k, jet| {
            (value[k], gradient[k]) = (jet.value as f32, jet.gradient.as_vec3());
        });
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        if self.is_compressed() {
            return self.pointwise().hessians(points, value, gradient, hessian);
        }
        self.batches(Order::Hessians, points, |k, jet| {
            (value[k], gradient[k]) = (jet.value as f32, jet.gradient.as_vec3());
            hessian[k] = jet.hessian.map(|entry| entry as f32);
        });
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let of = |part: &mut Box<dyn Evaluator + '_>| {
            let (value, gradient) = part.value_and_gradient(p);
            Jet { value, gradient, ..Jet::default() }
        };
        let rule = self.field.rule.scaled(self.exact_scale());
        let Jet { value, gradient, .. } = rule.jet(&mut self.parts.iter_mut().map(of));
        (value, gradient)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let rule = self.field.rule.scaled(self.exact_scale());
        rule.jet(&mut self.parts.iter_mut().map(|part| part.jet(p)))
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        let (count, rule) = (points.len(), self.field.rule.scaled(self.exact_scale()));
        let (values, gradients) = &mut self.exact;
        let size = self.parts.len() * count;
        values.resize(size, 0.0);
        gradients.resize(size, DVec3::ZERO);
        for (k, part) in self.parts.iter_mut().enumerate() {
            let own = k * count..(k + 1) * count;
            part.exact_gradients(points, &mut values[own.clone()], &mut gradients[own]);
        }
        for k in 0..count {
            let jet = |at: usize| Jet { value: values[at], gradient: gradients[at], ..Jet::default() };
            let jet = rule.jet(&mut (k..size).step_by(count).map(jet));
            (value[k], gradient[k]) = (jet.value, jet.gradient);
        }
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        if self.field.is_extreme() { Some(self) } else { None }
    }
}

impl Pieces for CombinationEvaluator<'_> {
    fn label(&mut self, p: DVec3) -> u32 {
        let part = self.part_at(p);
        2 * self.parts[part].label(p) + part as u32
    }

    fn has_limits(&mut self) -> bool {
        self.field.is_limited
    }

    fn is_limit(&mut self, branch: u32) -> bool {
        self.field.is_limited && !branch.is_multiple_of(2)
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        /// Largest box that one point represents well enough, as a share of the diagonal of the box
        /// of the run.
        const SMALL: f64 = 0.125;
        if bounds.diagonal() > SMALL * self.frame.length {
            return None;
        }
        let mut found = Vec::new();
        for (k, is_there) in (0..).zip(self.may_give(bounds)) {
            if is_there {
                let own = self.branches_of(k as usize, bounds)?;
                found.extend(own.into_iter().map(|branch| 2 * branch + k));
            }
        }
        found.sort_unstable();
        Some(found)
    }

    fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        let mut found = self.field.tangent_pairs.clone();
        for (k, part) in (0..).zip(&mut self.parts) {
            found.extend(part.tangent_pairs().into_iter().map(|pair| pair.map(|branch| 2 * branch + k)));
        }
        found
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, frame) = (self.field, self.frame);
        let new = || Box::new(PieceEvaluator { whole: Self::new(field, frame), label });
        let own = self.piece.get_or_insert_with(new);
        own.label = label;
        &mut **own
    }

    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let mut found = Vec::new();
        for part in &mut self.parts {
            found.extend(part.pieces().map_or(Vec::new(), |pieces| pieces.edge_cells(bounds, width)));
        }
        slices::complete(self.drop_hidden(&mut found, DVec3::ZERO));
        found.extend(slices::complete(self.tied_cells(bounds, width)));
        found
    }
}

/// The smooth function of a piece, which also knows the pieces of the whole.
struct PieceEvaluator<'a> {
    whole: CombinationEvaluator<'a>,
    label: u32,
}

impl PieceEvaluator<'_> {
    fn function(&mut self) -> &mut dyn Evaluator {
        self.whole.function(self.label as usize % 2, self.label / 2)
    }
}

impl Evaluator for PieceEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.whole.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(PieceEvaluator {
            whole: CombinationEvaluator::new(self.whole.field, self.whole.frame),
            label: self.label,
        })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.function().values(points, value);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.function().gradients(points, value, gradient);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.function().hessians(points, value, gradient, hessian);
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.function().value_and_gradient(p)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.function().jet(p)
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.function().exact_gradients(points, value, gradient);
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        Some(&mut self.whole)
    }
}
