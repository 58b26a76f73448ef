//! The evaluator of a combination, and its patches: those of its parts.

use super::Combination;
use crate::field::{BATCH, Evaluator, Field, Frame, Jet, Patches, Pointwise};
use crate::math::{Bounds, Sym3};
use crate::slices;
use glam::{DVec3, Vec3};

/// A combination at work. The branches of a minimum or maximum are those of its two parts: branch b
/// of the first one has number 2b, of the second one 2b + 1.
pub(super) struct CombinationEvaluator<'a> {
    pub(super) field: &'a Combination,
    pub(super) parts: Vec<Box<dyn Evaluator + 'a>>,
    frame: Frame,
    /// The evaluator of a branch, once it has been asked for.
    branch: Option<Box<BranchEvaluator<'a>>>,
    /// What the parts give for a batch, one after the other.
    values: Vec<f32>,
    gradients: Vec<Vec3>,
    hessians: Vec<Sym3<f32>>,
}

impl<'a> CombinationEvaluator<'a> {
    pub(super) fn new(field: &'a Combination, frame: Frame) -> Self {
        let parts: Vec<_> = field.parts.iter().map(|part| part.evaluator(frame)).collect();
        let (values, gradients, hessians) = (Vec::new(), Vec::new(), Vec::new());
        Self { field, parts, frame, branch: None, values, gradients, hessians }
    }

    /// Whether batches hold values that the rule cannot be used on: arsinh(f/s), which only a
    /// minimum or maximum goes through.
    fn is_compressed(&self) -> bool {
        self.frame.double.is_some() && !self.field.is_extreme()
    }

    fn pointwise(&self) -> Pointwise<&'a Combination> {
        Pointwise { field: self.field, frame: self.frame }
    }

    /// Asks each part with a slice of the memory for its results, and calls `store` with the index
    /// of each point and the jet of the combination there.
    fn batches(
        &mut self,
        points: &[Vec3],
        mut ask: impl FnMut(&mut dyn Evaluator, &[Vec3], &mut [f32], &mut [Vec3], &mut [Sym3<f32>]),
        mut store: impl FnMut(usize, &Jet),
    ) {
        let rule = self.field.rule.scaled(self.frame.scale.into());
        let size = self.parts.len() * BATCH;
        self.values.resize(size, 0.0);
        self.gradients.resize(size, Vec3::ZERO);
        self.hessians.resize(size, Sym3::default());
        for (first, points) in (0..).step_by(BATCH).zip(points.chunks(BATCH)) {
            let memory = self.values.chunks_mut(BATCH).zip(self.gradients.chunks_mut(BATCH));
            for ((part, (value, gradient)), hessian) in
                self.parts.iter_mut().zip(memory).zip(self.hessians.chunks_mut(BATCH))
            {
                ask(&mut **part, points, value, gradient, hessian);
            }
            for k in 0..points.len() {
                let jet = |at: usize| Jet {
                    value: self.values[at].into(),
                    gradient: self.gradients[at].as_dvec3(),
                    hessian: self.hessians[at].map(f64::from),
                };
                store(first + k, &rule.jet(&mut (k..size).step_by(BATCH).map(jet)));
            }
        }
    }

    /// The scale of single points, see [`Frame::exact`].
    fn exact_scale(&self) -> f64 {
        f64::from(self.frame.scale) / self.frame.double.unwrap_or(1.0)
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

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        if self.is_compressed() {
            return self.pointwise().values(points, value);
        }
        let ask = |part: &mut dyn Evaluator, points: &[Vec3], value: &mut [f32], _: &mut [_], _: &mut [_]| {
            part.values(points, value);
        };
        self.batches(points, ask, |k, jet| value[k] = jet.value as f32);
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        if self.is_compressed() {
            return self.pointwise().gradients(points, value, gradient);
        }
        let ask = |part: &mut dyn Evaluator, points: &[Vec3], v: &mut [f32], g: &mut [Vec3], _: &mut [_]| {
            part.gradients(points, v, g);
        };
        self.batches(points, ask, |k, jet| {
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
        let ask = |part: &mut dyn Evaluator,
                   points: &[Vec3],
                   v: &mut [f32],
                   g: &mut [Vec3],
                   h: &mut [Sym3<f32>]| part.hessians(points, v, g, h);
        self.batches(points, ask, |k, jet| {
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
        let own = |part: &mut Box<dyn Evaluator + '_>| {
            let (mut value, mut gradient) = (vec![0.0; count], vec![DVec3::ZERO; count]);
            part.exact_gradients(points, &mut value, &mut gradient);
            (value, gradient)
        };
        let results: Vec<_> = self.parts.iter_mut().map(own).collect();
        for k in 0..count {
            let jet = |(value, gradient): &(Vec<f64>, Vec<DVec3>)| Jet {
                value: value[k],
                gradient: gradient[k],
                ..Jet::default()
            };
            let jet = rule.jet(&mut results.iter().map(jet));
            (value[k], gradient[k]) = (jet.value, jet.gradient);
        }
    }

    fn patches(&mut self) -> Option<&mut dyn Patches> {
        if self.field.is_extreme() { Some(self) } else { None }
    }
}

impl Patches for CombinationEvaluator<'_> {
    fn branch_at(&mut self, p: DVec3) -> u32 {
        let part = self.part_at(p);
        2 * self.parts[part].branch_at(p) + part as u32
    }

    fn branches_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        /// Largest box, as a share of the diagonal of the box of the run, of which one point tells
        /// enough.
        const SMALL: f64 = 0.125;
        if bounds.diagonal() > SMALL * self.frame.length {
            return None;
        }
        let mut found = Vec::new();
        for (k, is_there) in (0..).zip(self.may_give(bounds)) {
            if is_there {
                let part = &mut self.parts[k as usize];
                let own = if part.patches().is_some() { part.branches_in(bounds)? } else { vec![0] };
                found.extend(own.into_iter().map(|branch| 2 * branch + k));
            }
        }
        found.sort_unstable();
        Some(found)
    }

    fn branch(&mut self, branch: u32) -> &mut dyn Evaluator {
        let (field, frame) = (self.field, self.frame);
        let own = self
            .branch
            .get_or_insert_with(|| Box::new(BranchEvaluator { whole: Self::new(field, frame), branch }));
        own.branch = branch;
        &mut **own
    }

    fn crease_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let mut found = Vec::new();
        for part in &mut self.parts {
            found.extend(part.patches().map_or(Vec::new(), |patches| patches.crease_cells(bounds, width)));
        }
        self.drop_hidden(&mut found, DVec3::ZERO);
        found.extend(slices::complete(self.tied_cells(bounds, width)));
        found
    }
}

/// The smooth function of a branch, which still knows the patches of the whole.
struct BranchEvaluator<'a> {
    whole: CombinationEvaluator<'a>,
    branch: u32,
}

impl BranchEvaluator<'_> {
    fn function(&mut self) -> &mut dyn Evaluator {
        let part = &mut *self.whole.parts[self.branch as usize % 2];
        let own = part.patches().is_some().then_some(self.branch / 2);
        part.on(own)
    }
}

impl Evaluator for BranchEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.whole.frame
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

    fn patches(&mut self) -> Option<&mut dyn Patches> {
        Some(&mut self.whole)
    }
}
