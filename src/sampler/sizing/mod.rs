//! The radius field of adaptive sampling: a law gives the radius from the curvature, from a
//! function of place or from both, and its slope is limited.
//!
//! r(x) = min(law(x, κ(x)), envelope(x)). The envelope is the minimum over the points y of the
//! survey and of the creases of law(y, κ(y)) + L |x − y|: the largest function of slope L that is
//! not above the law at these points. So the radius grows no faster than this away from a bend, and
//! away from a crease next to a patch so small that no point of the survey lies on it. The envelope
//! is stored on the nodes of a grid near the surface and interpolated. Near jumps of a function of
//! place it is too coarse: points are added there, and evaluated one by one.

mod envelope;
mod laws;
mod steep;

use crate::differential::{Curvature, curvatures};
use crate::field::Evaluator;
use crate::math::{Bounds, HEXAGONAL_CELL};
use crate::sampler::constraint::Creases;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::probe::Probe;
use crate::sampler::settings::{LEAST_SHARE, MOST_SHARE, Settings, SettingsError, SizeMode};
use crate::sampler::sizing::envelope::Envelope;
use crate::sampler::sizing::laws::SizingLaw;
use crate::sampler::sizing::steep::{StepPoint, Steps, step_points};
use crate::sampler::spacing::Spacing;
use glam::{DVec3, Vec3};

/// Rounds towards a predicted count. Each scales the radii by the square root of the ratio of the
/// counts; the clamps and the slope make more than one necessary.
const MAX_ROUNDS: u32 = 6;
/// Relative error at which a predicted count is accepted; the prediction itself is not more
/// accurate.
const PREDICTION_TOLERANCE: f64 = 2e-3;

/// Share by which the slope must lower a wanted radius to count as smoothing.
const SMOOTHED: f32 = 0.05;

/// Distance from the step of a function within which the envelope is too coarse, in cells: nodes
/// are up to a diagonal away, and the survey has a point within another cell.
const STEP_REACH: f32 = 3.0;

/// A spacing that is requested by a function.
#[derive(Clone, Debug)]
pub(crate) struct Wish {
    pub(crate) spacing: Spacing,
    /// Whether the radius also follows the curvature: the smaller of both is used.
    pub(crate) bends: bool,
    /// The point that places are relative to.
    pub(crate) origin: DVec3,
}

/// Where the slope keeps the radius below the requested one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothing {
    /// Share of the area where it does so by more than a twentieth.
    pub(crate) share: f64,
    /// The largest ratio of the requested radius and the actual one.
    pub(crate) ratio: f64,
    /// The place of the largest ratio, relative to the origin of the run.
    pub(crate) position: Vec3,
}

/// The radius field of a run.
#[derive(Clone, Debug)]
pub(crate) struct Sizing {
    wish: Option<Wish>,
    law: SizingLaw,
    /// Largest slope L.
    slope: f32,
    /// The points of the survey, those of the creases, and those next to jumps.
    samples: Vec<SurfaceSample>,
    envelope: Envelope,
    /// The last of the points, which lie next to jumps, by their numbers; none without any.
    steps: Option<Steps>,
    predicted: f64,
    smallest: f32,
    largest: f32,
}

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
struct SurfaceSample {
    position: Vec3,
    curvature: Curvature,
    /// Requested radius; infinite if none is.
    asked: f32,
    /// Area of the surface that the point represents; 0 on a crease or next to a jump.
    weight: f32,
}

impl Sizing {
    /// Makes the radius field that `settings` or a `wish` request. This evaluates a Hessian at
    /// every point of the survey, and on every patch at each of the `creases`.
    pub(crate) fn new(
        probe: &mut Probe,
        bounds: &Bounds,
        settings: &Settings,
        wish: Option<Wish>,
        survey: &Survey,
        creases: &Creases,
    ) -> Self {
        let mut samples = Vec::new();
        let mut add = |probe: &mut Probe, position: &[Vec3], weight: &[f32]| {
            let mut curvature = vec![Curvature::default(); position.len()];
            curvatures(probe.field, position, &mut curvature);
            probe.count(position.len() as u64);
            let rows = position.iter().zip(curvature).zip(weight);
            samples.extend(rows.map(|((&position, curvature), &weight)| SurfaceSample {
                position,
                curvature,
                asked: f32::INFINITY,
                weight,
            }));
        };
        add(probe, &survey.position, &survey.weight);
        for (position, patches) in creases.points() {
            for &patch in patches {
                add(&mut probe.on(Some(patch)), &[position], &[0.0]);
            }
        }
        if let Some(Wish { spacing, origin, .. }) = &wish {
            let places: Vec<Vec3> = samples.iter().map(|sample| sample.position).collect();
            let mut asked = vec![0.0; places.len()];
            spacing.radii(*origin, &places, &mut asked);
            samples.iter_mut().zip(asked).for_each(|(sample, asked)| sample.asked = asked);
        }
        let by_curvature = SizingLaw::new(settings, bounds.diagonal());
        let law = wish.as_ref().map_or(by_curvature, |wish| {
            let limits = limits_of(settings, bounds, &samples);
            SizingLaw::asked(wish.bends.then_some(by_curvature), limits)
        });
        let envelope = Envelope::new(bounds, samples.iter().map(|sample| sample.position));
        let steps = wish.as_ref().and_then(|wish| add_steps(wish, &mut samples, STEP_REACH * envelope.cell));
        let mut sizing = Self {
            wish,
            law,
            slope: settings.grading as f32,
            envelope,
            samples,
            steps,
            predicted: 0.0,
            smallest: 0.0,
            largest: 0.0,
        };
        sizing.grade();
        sizing
    }

    /// Returns the repulsion radius of a particle at a point of the surface with this curvature;
    /// the smallest radius if the curvature is undefined.
    #[inline]
    pub(crate) fn radius(&self, position: Vec3, curvature: &Curvature) -> f32 {
        let mut radius = [0.0];
        self.radii(&[position], core::slice::from_ref(curvature), &mut radius);
        radius[0]
    }

    /// Writes the repulsion radius of a particle at each point of the surface, with these
    /// curvatures: [`Sizing::radius`].
    #[inline]
    pub(crate) fn radii(&self, positions: &[Vec3], curvatures: &[Curvature], radii: &mut [f32]) {
        match &self.wish {
            Some(Wish { spacing, origin, .. }) => spacing.radii(*origin, positions, radii),
            None => radii.fill(f32::INFINITY),
        }
        for ((radius, &position), curvature) in radii.iter_mut().zip(positions).zip(curvatures) {
            *radius = self.law.radius(*radius, curvature).min(self.limit_at(position));
        }
    }

    /// The largest radius that the slope allows at a position.
    #[inline]
    fn limit_at(&self, position: Vec3) -> f32 {
        let mut limit = self.envelope.at(position);
        if let Some(steps) = &self.steps {
            steps.near(position, |number, distance| {
                let sample = &self.samples[number];
                let radius = self.law.radius(sample.asked, &sample.curvature);
                limit = limit.min(radius + self.slope * distance);
            });
        }
        limit
    }

    /// Checks the radii requested at the points of the survey and of the creases.
    ///
    /// # Errors
    ///
    /// The first one that is not above 0.
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let Some(Wish { spacing, origin, .. }) = &self.wish else { return Ok(()) };
        let places: Vec<Vec3> = self.samples.iter().map(|sample| sample.position).collect();
        let asked: Vec<f32> = self.samples.iter().map(|sample| sample.asked).collect();
        spacing.check(*origin, &places, &asked)
    }

    /// Where the slope keeps the radius below the requested one, if anywhere.
    pub(crate) fn smoothing(&self) -> Option<Smoothing> {
        self.wish.as_ref()?;
        let (mut area, mut smoothed, mut worst) = (0.0, 0.0, (1.0 + SMOOTHED, None));
        for sample in &self.samples {
            let wanted = self.law.radius(sample.asked, &sample.curvature);
            let ratio = wanted / self.limit_at(sample.position);
            area += f64::from(sample.weight);
            smoothed += if ratio > 1.0 + SMOOTHED { f64::from(sample.weight) } else { 0.0 };
            if ratio > worst.0 {
                worst = (ratio, Some(sample.position));
            }
        }
        let position = worst.1?;
        Some(Smoothing { share: smoothed / area, ratio: worst.0.into(), position })
    }

    /// Returns the repulsion radius of a particle at a point of the surface. This evaluates a
    /// Hessian, which is not counted.
    pub(crate) fn radius_at(&self, field: &mut dyn Evaluator, position: Vec3) -> f32 {
        let mut curvature = [Curvature::default()];
        curvatures(field, &[position], &mut curvature);
        self.radius(position, &curvature[0])
    }

    #[cfg(test)]
    /// Returns an upper bound of the radius at `position`, without a Hessian. It is not tight where
    /// the surface bends more than at the nearest points of the survey.
    #[inline]
    pub(crate) fn envelope(&self, position: Vec3) -> f32 {
        self.envelope.at(position)
    }

    /// Returns the slope L: |r(x) − r(y)| ≤ L |x − y|.
    pub(crate) fn slope(&self) -> f32 {
        self.slope
    }

    /// Returns the number of particles that cover the surface in perfect hexagons: ∫ dA / (2√3 r²).
    pub(crate) fn predicted_count(&self) -> f64 {
        self.predicted
    }

    /// Returns the smallest radius that a particle may have.
    pub(crate) fn least(&self) -> f32 {
        self.law.least()
    }

    /// Returns the smallest radius at the points of the survey.
    pub(crate) fn smallest(&self) -> f32 {
        self.smallest
    }

    /// Returns the largest radius at the points of the survey.
    pub(crate) fn largest(&self) -> f32 {
        self.largest
    }

    /// The radius field as requested by the settings, before any [`Sizing::scale`].
    pub(crate) fn unscaled(mut self, settings: &Settings) -> Self {
        self.law = self.law.unscaled();
        self.slope = settings.grading as f32;
        self.grade();
        self
    }

    /// The radius field with another largest slope, and with the law and its clamp multiplied by
    /// `factor`.
    pub(crate) fn graded(mut self, slope: f64, factor: f64) -> Self {
        self.slope = slope as f32;
        self.scale(factor);
        self
    }

    /// Multiplies the law and its clamp by `factor`, and makes the envelope anew: the slope stays.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.law = self.law.scaled(factor);
        self.grade();
    }

    /// Scales the law until the predicted count is `count`.
    pub(crate) fn scale_to(&mut self, count: f64) {
        for _ in 0..MAX_ROUNDS {
            let off = self.predicted / count;
            if !(off > 0.0 && (off - 1.0).abs() > PREDICTION_TOLERANCE) {
                break;
            }
            self.scale(off.sqrt());
        }
    }

    /// Computes the envelope of the present law, and predicts the count.
    fn grade(&mut self) {
        self.envelope.fill(self.law.greatest());
        for sample in &self.samples {
            self.envelope.lower(
                sample.position,
                self.law.radius(sample.asked, &sample.curvature),
                self.slope,
            );
        }
        self.envelope.spread(self.slope);
        (self.predicted, self.smallest, self.largest) = (0.0, f32::INFINITY, 0.0);
        for sample in &self.samples {
            let radius = self.law.radius(sample.asked, &sample.curvature).min(self.limit_at(sample.position));
            self.predicted +=
                f64::from(sample.weight) / (HEXAGONAL_CELL * f64::from(radius) * f64::from(radius));
            self.smallest = self.smallest.min(radius);
            self.largest = self.largest.max(radius);
        }
        if self.samples.is_empty() {
            // The survey has found no surface. Components that the search may still find get the
            // largest radius.
            (self.smallest, self.largest) = (self.law.greatest(), self.law.greatest());
        }
    }
}

/// The smallest and the largest of the requested radii that are used. If a number of particles is
/// wanted, the radii are only relative, and the points of the survey show how large they are.
fn limits_of(settings: &Settings, bounds: &Bounds, samples: &[SurfaceSample]) -> [f32; 2] {
    /// Between the points of the survey radii may be smaller by this factor.
    const DEEPER: f32 = 0.25;
    let asked = samples.iter().map(|sample| sample.asked).filter(|asked| *asked > 0.0 && asked.is_finite());
    let [least, greatest] =
        asked.fold([f32::INFINITY, 0.0], |[least, greatest], asked| [least.min(asked), greatest.max(asked)]);
    if settings.size_mode == SizeMode::Count && least <= greatest {
        // Their ratio is at most that of radii that are given.
        let floor = (LEAST_SHARE / MOST_SHARE) as f32 * greatest;
        return [(DEEPER * least).max(floor), greatest];
    }
    [LEAST_SHARE, MOST_SHARE].map(|share| (share * bounds.diagonal()) as f32)
}

/// Adds points next to the steps of the function, as samples without area. Returns where they are,
/// if there are any.
fn add_steps(wish: &Wish, samples: &mut Vec<SurfaceSample>, reach: f32) -> Option<Steps> {
    let places: Vec<Vec3> = samples.iter().map(|sample| sample.position).collect();
    let asked: Vec<f32> = samples.iter().map(|sample| sample.asked).collect();
    let ask = |places: &[Vec3], radii: &mut [f32]| wish.spacing.radii(wish.origin, places, radii);
    // Neighbouring points are a cell apart, or its diagonal.
    for StepPoint { position, asked, sample } in step_points(&places, &asked, 0.5 * reach, ask) {
        let curvature = samples[sample].curvature;
        samples.push(SurfaceSample { position, curvature, asked, weight: 0.0 });
    }
    let first = places.len();
    let points = (first as u32..).zip(samples[first..].iter().map(|sample| sample.position));
    (samples.len() > first).then(|| Steps::new(points, reach))
}

#[cfg(test)]
mod tests;
