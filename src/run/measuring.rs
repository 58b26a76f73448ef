//! Measurement of the particles of a run, in slices of work.

use crate::field::{Evaluator, Field, Frame};
use crate::math::Bounds;
use crate::mesh::stars::{Sheet, Sheets};
use crate::particles::Particles;
use crate::quality::sheets::ByField;
use crate::quality::{self, Figures};
use crate::sampler::Sampling;
use crate::sampler::sheet::repulsion_weight;
use crate::slices::{Estimated, pause};
use glam::Vec3;
use serde::Deserialize;
use std::sync::Arc;

/// Largest number of particles that are kept after the front, for the comparison before and after
/// the relaxation. Measuring them doubles the time of the report, and they take 11 MB: a choice
/// that bounds both, at twice the number allowed by default.
const MAX_KEPT: usize = 400_000;

/// The particles that a report measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(ts_rs::TS))]
pub enum Measured {
    /// Nothing. The report has no figures of quality, no number of components of the sample, and no
    /// warnings of open edges and close sheets, which come from measuring; files have no columns of
    /// measured values.
    Nothing,
    /// The particles.
    #[default]
    Particles,
    /// The particles and, if they were relaxed, also the front before, for comparison. Both are
    /// measured in full.
    FrontToo,
}

/// The measurements of a run.
#[derive(Default)]
pub(super) struct Measuring<'f> {
    /// The particles after the front, until they are measured.
    pub(super) front: Option<Arc<Particles>>,
    pub(super) front_figures: Option<Figures>,
    /// The measurement under way.
    pub(super) work: Option<Estimated<'f, MeasuringResult>>,
    /// The figures and columns of the last measurement; empty before the first.
    pub(super) measured: quality::Measurements,
    /// Number of particles that face another sheet; none if the present particles have not been
    /// measured yet.
    pub(super) facing: Option<usize>,
    /// The sheets of the present particles, if they have been measured.
    pub(super) sheets: Option<Arc<Sheets>>,
}

impl Measuring<'_> {
    /// Keeps the first `count` particles as the front's, if none are kept.
    pub(super) fn keep_front(&mut self, particles: &Particles, count: usize) {
        if self.front.is_none() && count <= MAX_KEPT {
            self.front = Some(Arc::new(measured_columns(particles)));
        }
    }

    /// Aborts a measurement under way, and marks the last one as outdated.
    pub(super) fn stop(&mut self) {
        (self.work, self.facing, self.sheets) = (None, None, None);
    }

    /// Estimated share of the measuring that is done.
    pub(super) fn fraction(&self) -> f64 {
        match (&self.work, self.facing) {
            (Some(work), _) => work.fraction(),
            (None, Some(_)) => 1.0,
            (None, None) => 0.0,
        }
    }

    /// The particles of the front, if they have yet to be measured.
    pub(super) fn open_front(&self) -> Option<Arc<Particles>> {
        self.front.clone().filter(|_| self.front_figures.is_none())
    }
}

/// Copy of the columns of particles that a later measurement needs.
pub(super) fn measured_columns(particles: &Particles) -> Particles {
    Particles {
        local: particles.local.clone(),
        normal: particles.normal.clone(),
        radius: particles.radius.clone(),
        patch: particles.patch.clone(),
        twins: particles.twins.clone(),
        segments: particles.segments.clone(),
        sides: particles.sides.clone(),
        ..Particles::default()
    }
}

/// [`quality::measure`], a slice at a time; see [`quality::in_slices`] for `crossings`. `sheets`
/// belongs to the particles, if known.
pub(super) async fn measure(
    particles: &Particles,
    field: &mut dyn Evaluator,
    bounds: &Bounds,
    sampling: Sampling,
    crossings: &mut Option<Vec<Vec3>>,
    sheets: Option<&Arc<Sheets>>,
) -> quality::Measurements {
    let radii = (sampling == Sampling::Adaptive).then_some(&particles.radius[..]);
    let options =
        quality::MeasureOptions { radii, rows: Some(particles), ..quality::MeasureOptions::default() };
    let surroundings = quality::Surroundings { bounds: Some(bounds), sheets };
    quality::in_slices(&particles.local, &particles.normal, field, surroundings, &options, crossings).await
}

/// Results of a measurement.
pub(super) struct MeasuringResult {
    pub(super) front: Option<Figures>,
    pub(super) now: quality::Measurements,
    /// Number of particles that face another sheet.
    pub(super) facing: usize,
    /// The sheets of the particles.
    pub(super) sheets: Arc<Sheets>,
}

/// Number of slices that the measurement of these particles is expected to take.
pub(super) fn expected_slices(front: Option<&Arc<Particles>>, now: &Particles) -> u64 {
    /// Slices per particle for the tree and for the particles that face each other.
    const EACH: f64 = 0.08;
    let counts = front.map(|front| front.len()).into_iter().chain([now.len()]);
    quality::expected_slices(counts) + (EACH * now.len() as f64) as u64
}

/// Input of a measurement, apart from the field.
pub(super) struct MeasuringInput {
    pub(super) front: Option<Arc<Particles>>,
    pub(super) now: Particles,
    pub(super) bounds: Bounds,
    pub(super) sampling: Sampling,
}

// These functions are not generic, so that the measurement is compiled once and not with every type
// of field.
impl MeasuringInput {
    /// The measurement in slices, of a field in the frame of the particles.
    pub(super) fn work<'f>(self, field: Arc<dyn Field + 'f>, frame: Frame) -> Estimated<'f, MeasuringResult> {
        let expected = expected_slices(self.front.as_ref(), &self.now);
        Estimated::new(Box::pin(async move { self.in_slices(&field, frame).await }), expected)
    }

    pub(super) async fn in_slices(self, field: &dyn Field, frame: Frame) -> MeasuringResult {
        let mut evaluator = field.evaluator(frame);
        let field = &mut *evaluator;
        let Self { front, now, bounds, sampling } = self;
        let crossings = &mut None;
        let front = match front {
            Some(front) => Some(measure(&front, field, &bounds, sampling, crossings, None).await.figures),
            None => None,
        };
        let sheets = Arc::new(Sheets::new(&now, &ByField::new(field)).await);
        let report = measure(&now, field, &bounds, sampling, crossings, Some(&sheets)).await;
        let facing = facing_another_sheet(&now, &sheets).await;
        MeasuringResult { front, now: report, facing, sheets }
    }
}

/// Number of rows nearer than 2r to one of the same patch that faces the other way.
async fn facing_another_sheet(particles: &Particles, sheets: &Sheets) -> usize {
    /// Particles whose normals have at least this cosine with one direction are within 120° of each
    /// other, so that they repel each other. The third digit is for rounding.
    const ALIKE: f32 = 0.505;
    let mut near = Vec::new();
    let mut count = 0;
    for Sheet { tree, normal, .. } in &sheets.all {
        for leaf in tree.leaves() {
            let reach = |i: usize| 2.0 * particles.radius[tree.origin[i] as usize];
            let mean: Vec3 = normal[leaf.range.clone()].iter().sum();
            let widest = leaf.range.clone().map(reach).fold(0.0, f32::max);
            near.clear();
            tree.within_box(leaf.lo - widest, leaf.hi + widest, &mut near);
            let mean = mean.normalize_or_zero();
            if !near.iter().all(|&k| normal[k as usize].dot(mean) >= ALIKE) {
                let is_facing = |i: usize| {
                    near.iter().any(|&k| {
                        let k = k as usize;
                        repulsion_weight(normal[k].dot(normal[i])) <= 0.0
                            && tree.position[k].distance_squared(tree.position[i]) < reach(i) * reach(i)
                    })
                };
                count += leaf.range.filter(|&i| is_facing(i)).count();
            }
            pause().await;
        }
    }
    count
}
