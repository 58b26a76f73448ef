//! The box of a session: given with the field, that of a gallery surface, or fitted around the surface of a formula.

use super::{FieldAnswer, Session, Source};
use crate::extent::{BoxFit, Extent, Reach};
use crate::field::formula::FormulaField;
use crate::math::Bounds;
use crate::sampler::{BoxMode, Sampling, Settings, SizeMode};
use glam::DVec3;
use serde::Serialize;

/// Why particles lie at the border of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// The surface goes on beyond any box.
    Endless,
    /// The box was given, and the surface reaches beyond it.
    Fixed,
}

/// What is known of the box.
#[derive(Default)]
pub(super) struct Fitting {
    /// Whether the box was given with the field.
    pub(super) is_given: bool,
    /// The search, while it is under way.
    search: Option<BoxFit>,
    /// What the search has found for the present field.
    found: Option<Extent>,
    /// Whether the box is that of the next run.
    pub(super) is_settled: bool,
    /// Whether the present box was fitted.
    is_fitted: bool,
}

impl Fitting {
    /// Forgets what belongs to another field or another choice of the box; the box itself stays until the next is known.
    pub(super) fn restart(&mut self) {
        (self.search, self.found, self.is_settled) = (None, None, false);
    }

    /// Forgets the box too.
    pub(super) fn discard(&mut self) {
        *self = Self { is_given: self.is_given, ..Self::default() };
    }

    /// Whether the present box was fitted.
    pub(super) fn is_fitted(&self) -> bool {
        self.is_fitted
    }

    /// How far the surface reaches, where its box was fitted.
    pub(super) fn reach(&self) -> Option<Reach> {
        self.found.filter(|_| self.is_fitted).map(|extent| extent.reach)
    }
}

impl Session {
    /// Finds the box of the next run with these settings, up to `budget` slices of the work of some 10 to 50 microseconds each: the
    /// field with its box, once it is known. [`Session::start`] does what is left. A box that `only_grows` holds the one before it
    /// as long as the formula stays the same: while a slider moves.
    pub fn fit(&mut self, settings: &Settings, only_grows: bool, budget: u32) -> Option<FieldAnswer> {
        let formula = match &self.source {
            Source::Formula(field) if self.is_to_fit(settings) && !field.is_constant() => field,
            _ => {
                self.take_box(self.own);
                self.fitting.is_fitted = false;
                return Some(self.answer());
            }
        };
        if self.fitting.found.is_none() {
            let search = self.fitting.search.get_or_insert_with(|| {
                let mut formula = formula.clone();
                formula.set_origin(DVec3::ZERO);
                let operations = formula.operations();
                BoxFit::new(formula, operations)
            });
            self.fitting.found = Some(search.step(budget)?);
            self.fitting.search = None;
        }
        let mut bounds = self.fitting.found?.with_room(largest_share(settings));
        if only_grows && self.fitting.is_fitted {
            for axis in 0..3 {
                bounds.min[axis] = bounds.min[axis].min(self.bounds.min[axis]);
                bounds.max[axis] = bounds.max[axis].max(self.bounds.max[axis]);
            }
        }
        self.take_box(bounds);
        self.fitting.is_fitted = true;
        Some(self.answer())
    }

    fn take_box(&mut self, bounds: Bounds) {
        self.end_run_unless(bounds == self.bounds);
        self.bounds = bounds;
        self.fitting.is_settled = true;
    }

    /// Whether the box is to be fitted: not where it was given, nor around a surface of the gallery, which has its own.
    fn is_to_fit(&self, settings: &Settings) -> bool {
        settings.box_mode == BoxMode::Fit && !self.fitting.is_given && self.surface.is_none()
    }

    /// Why particles lie at the border of the box, where some do and the box was not chosen for the surface.
    pub(super) fn cut(&self, border: usize) -> Option<Cut> {
        if border == 0 || self.source.formula().is_none_or(FormulaField::is_constant) {
            return None;
        }
        match self.fitting.reach() {
            // Particles that are large against the surface may have a child outside of a box that holds it.
            Some(Reach::Bounded) => None,
            Some(Reach::Endless | Reach::Nowhere | Reach::Unknown) => Some(Cut::Endless),
            None => (self.fitting.is_given || self.surface.is_none()).then_some(Cut::Fixed),
        }
    }
}

/// The largest radius that is accepted, as a share of the diagonal.
const MOST_SHARE: f64 = 0.2;

/// The radius of the largest particle as a share of the diagonal, estimated where a number of particles is wanted.
fn largest_share(settings: &Settings) -> f64 {
    let share = match (settings.size_mode, settings.sampling) {
        // On an area of one squared diagonal, about that of a sphere; each particle takes 2√3 r².
        (SizeMode::Count, _) => (1.0 / (12_f64.sqrt() * f64::from(settings.count))).sqrt(),
        (SizeMode::Radius, Sampling::Uniform) => settings.radius_share,
        (SizeMode::Radius, Sampling::Adaptive) => settings.radius_max_share,
    };
    // Settings out of their ranges are refused at the start.
    share.min(MOST_SHARE)
}
