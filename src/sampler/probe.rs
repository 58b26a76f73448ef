//! The field as the sampler evaluates it: in batches, with the memory that they take, and counted.

pub(crate) use crate::field::BATCH;

use crate::field::Field;
use crate::field::descent::Descent;
use crate::math::{Bounds, Sym3};
use glam::Vec3;

/// State that outlasts a [`Probe`]: the buffers of a batch, and the count of all evaluations.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProbeMemory {
    pub(super) points: Vec<Vec3>,
    pub(super) value: Vec<f32>,
    pub(super) gradient: Vec<Vec3>,
    /// Number of field evaluations so far, one for each point and call.
    pub(crate) evaluations: u64,
    /// The branch that the field evaluates; none if it is f.
    selected: Option<u32>,
}

/// A field with the memory to evaluate it at a batch of points, and the count of these evaluations.
pub(crate) struct Probe<'a> {
    /// The field. Evaluations made of it directly are not counted.
    pub(crate) field: &'a mut dyn Field,
    pub(super) memory: &'a mut ProbeMemory,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(field: &'a mut dyn Field, memory: &'a mut ProbeMemory) -> Self {
        memory.value.resize(BATCH, 0.0);
        memory.gradient.resize(BATCH, Vec3::ZERO);
        Self { field, memory }
    }

    /// Number of field evaluations so far, one for each point and call.
    pub(crate) fn evaluations(&self) -> u64 {
        self.memory.evaluations
    }

    /// Makes all evaluations those of a branch of f, or of f.
    pub(crate) fn select(&mut self, branch: Option<u32>) {
        if self.memory.selected != branch {
            self.memory.selected = branch;
            self.field.select_branch(branch);
        }
    }

    /// Whether a point of the sheet of a patch, with its normal there, lies on the patch; a surface without creases has none, and every point
    /// does. `size` is about the size of a particle there.
    ///
    /// It is asked a little outside: within a solid, where its bodies share a plane, each of two branches gives f on its inner side alone.
    pub(crate) fn is_on_patch(&mut self, point: Vec3, normal: Vec3, size: f32, patch: Option<u32>) -> bool {
        /// Distance outside, in sizes of a particle. It is far above the residual of a point, and far below the distance of sheets that
        /// such particles tell apart.
        const OUTSIDE: f64 = 1e-4;
        patch.is_none_or(|patch| {
            let outward = normal.as_dvec3() * (OUTSIDE * f64::from(size));
            self.field.branch_at(point.as_dvec3() + outward) == patch
        })
    }

    /// Whether a patch may have points in a box: the zeros of √(u² + v²) on the edge of other patches are none.
    pub(crate) fn may_have_zeros(&mut self, patch: Option<u32>, bounds: &Bounds) -> bool {
        let known = self.field.branched().and_then(|field| field.branches_in(bounds));
        patch.zip(known).is_none_or(|(patch, known)| known.contains(&patch))
    }

    /// Counts evaluations that were made of the field directly.
    pub(crate) fn count(&mut self, evaluations: u64) {
        self.memory.evaluations += evaluations;
    }

    /// Returns value and gradient at a point.
    pub(crate) fn gradient(&mut self, point: Vec3) -> (f32, Vec3) {
        let (value, gradient) = self.gradients(&[point]);
        (value[0], gradient[0])
    }

    /// Returns values and gradients at no more than [`BATCH`] points, which are evaluated in one call.
    pub(crate) fn gradients(&mut self, points: &[Vec3]) -> (&[f32], &[Vec3]) {
        let n = points.len();
        let ProbeMemory { value, gradient, evaluations, .. } = &mut *self.memory;
        *evaluations += n as u64;
        self.field.gradients(points, &mut value[..n], &mut gradient[..n]);
        (&value[..n], &gradient[..n])
    }

    /// Moves points onto the surface along the gradient. Returns the unit normal at each that is on it within the limits.
    pub(crate) fn land_all(
        &mut self,
        points: &mut [Vec3],
        min_gradient: f32,
        mut limits: Descent,
        max_steps: u32,
    ) -> Vec<Option<Vec3>> {
        let mut landed = Vec::with_capacity(points.len());
        let (mut normal, mut ok) = ([Vec3::ZERO; BATCH], [false; BATCH]);
        for chunk in points.chunks_mut(BATCH) {
            self.land_along_gradient(chunk, &mut normal, &mut ok, min_gradient, &mut limits, max_steps);
            landed.extend((0..chunk.len()).map(|k| ok[k].then_some(normal[k])));
        }
        landed
    }

    /// Writes values, gradients and Hessians at `points`, as [`Field::hessians`] does.
    pub(crate) fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.count(points.len() as u64);
        self.field.hessians(points, value, gradient, hessian);
    }
}
