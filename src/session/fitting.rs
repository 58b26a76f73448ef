//! The box of a session: given with the field, that of a gallery surface, or fitted around the surface of a formula.

use super::{FieldAnswer, Session, Source};
use crate::extent::{BoxFit, Extent};
use crate::field::Field;
use crate::sampler::Settings;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Choice of the box in which the surface of a formula is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxMode {
    /// A box that fits the surface, where none is given. A surface of the gallery keeps its own.
    #[default]
    Fit,
    /// The box that is given, or that of the surface with which the formula began.
    Fixed,
}

/// State of the search for the box.
#[derive(Default)]
pub(super) struct Fitting {
    /// The choice of the user.
    pub(super) box_mode: BoxMode,
    /// Whether the box was given with the field.
    pub(super) is_given: bool,
    /// The search, while it is under way.
    search: Option<BoxFit>,
    /// Result of the search for the present field.
    found: Option<Extent>,
    /// Whether the box is that of the next run.
    pub(super) is_settled: bool,
    /// Whether the present box was fitted.
    pub(super) is_fitted: bool,
}

impl Fitting {
    /// Forgets all but the choice of the user.
    pub(super) fn discard(&mut self) {
        *self = Self { box_mode: self.box_mode, ..Self::default() };
    }

    /// Forgets what belongs to another field or another choice of the box; the box itself stays until the next is known.
    pub(super) fn restart(&mut self) {
        (self.search, self.found, self.is_settled) = (None, None, false);
    }
}

impl Session {
    /// Chooses the box in which the surface of a formula is sampled.
    pub fn choose_box(&mut self, box_mode: BoxMode) {
        self.fitting.box_mode = box_mode;
    }

    /// Finds the box of the next run with these settings, up to `budget` slices of the work of some 10 to 50 microseconds each: the
    /// field with its box, once it is known. [`Session::start`] does what is left. A box that `only_grows` holds the one before it
    /// as long as the formula stays the same: while a slider moves.
    pub fn fit(&mut self, settings: &Settings, only_grows: bool, budget: u32) -> Option<FieldAnswer> {
        let formula = match self.run.field() {
            Source::Formula(field) if self.is_to_fit() && !field.is_constant() => field,
            _ => {
                self.run.set_bounds(self.own, None);
                (self.fitting.is_fitted, self.fitting.is_settled) = (false, true);
                return Some(self.answer());
            }
        };
        if self.fitting.found.is_none() {
            let search = self.fitting.search.get_or_insert_with(|| {
                let mut formula = formula.clone();
                formula.set_origin(DVec3::ZERO);
                BoxFit::new(Box::new(formula))
            });
            self.fitting.found = Some(search.step(budget)?);
            self.fitting.search = None;
        }
        let found = self.fitting.found?;
        let mut bounds = found.with_room(settings.largest_share());
        if only_grows && self.fitting.is_fitted {
            bounds = bounds.joined(&self.run.bounds());
        }
        self.run.set_bounds(bounds, Some(found.reach));
        (self.fitting.is_fitted, self.fitting.is_settled) = (true, true);
        Some(self.answer())
    }

    /// Whether the box is to be fitted: not where it was given, nor around a surface of the gallery, which has its own.
    fn is_to_fit(&self) -> bool {
        self.fitting.box_mode == BoxMode::Fit && !self.fitting.is_given && self.surface.is_none()
    }
}
