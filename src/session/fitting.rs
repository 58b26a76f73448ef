//! Before a run starts, a session finds three things, in slices: the box, which comes with the
//! field or with a gallery surface, or is fitted around the surface of a formula; the solid that is
//! made of the surface in the box; and the creases of the solid.

use super::{BeyondPoints, BoxCell, BoxMode, Fault, FaultKind, FieldAnswer, Session, SolidSettings, Source};
use crate::extent::{self, Extent, Reach};
use crate::field::Field;
use crate::field::formula::{Formula, Thickness};
use crate::field::gallery::Surface;
use crate::math::Bounds;
use crate::sampler::{FoundCreases, Settings};
use crate::slices::{self, Work};
use std::sync::Arc;

/// Search for the box around one field, in slices.
#[derive(Default)]
struct BoxSearch {
    /// The search, while it is under way.
    search: Option<Work<'static, Extent>>,
    /// The box that the search has found.
    found: Option<Extent>,
}

impl BoxSearch {
    /// Does up to `budget` slices of the search around the surface of a field, and returns its
    /// extent once it is known.
    fn step<F: Field + 'static>(&mut self, field: impl FnOnce() -> F, budget: u32) -> Option<Extent> {
        if self.found.is_none() {
            let search = self.search.get_or_insert_with(|| {
                let field = field();
                Box::pin(async move { extent::find_in_slices(&field).await })
            });
            self.found = Some(slices::advance(search.as_mut(), budget)?);
            self.search = None;
        }
        self.found
    }
}

type CreaseSearch = Work<'static, FoundCreases>;

/// State of the searches.
#[derive(Default)]
pub(super) struct Fitting {
    /// The choice of the user.
    pub(super) choice: SolidSettings,
    /// Whether the clip box was given with the field.
    pub(super) is_given: bool,
    /// The box around the surface before a box closes it.
    unclosed: BoxSearch,
    /// The box around the solid that the clip box closes.
    closed: BoxSearch,
    /// The search for the creases of the surface in the box, while it is under way.
    creases: Option<(Bounds, CreaseSearch)>,
    /// Whether the box of the next run is known.
    pub(super) is_settled: bool,
    /// Whether the present clip box was fitted.
    pub(super) is_fitted: bool,
    /// Whether the clip box was enlarged to contain the box before it.
    pub(super) is_grown: bool,
}

impl Fitting {
    /// Forgets all but the user's choice, and the search for another clip box.
    pub(super) fn discard(&mut self) {
        let (choice, closed) = (core::mem::take(&mut self.choice), core::mem::take(&mut self.closed));
        *self = Self { choice, closed, ..Self::default() };
    }

    /// Forgets what belongs to another field or another choice of the box; the box itself stays
    /// until the next one is known.
    pub(super) fn restart(&mut self) {
        (self.unclosed, self.closed, self.is_settled) = (BoxSearch::default(), BoxSearch::default(), false);
        self.creases = None;
    }
}

impl Session {
    /// Chooses the box in which the surface of a formula is sampled, and the solid made of it.
    ///
    /// # Errors
    ///
    /// If the thickness is out of its range, or a formula that does not fit the present one;
    /// nothing is changed then.
    pub fn choose(&mut self, choice: SolidSettings) -> Result<(), Fault> {
        choice.validate().map_err(|error| Fault::new(FaultKind::Settings, &error))?;
        self.check_thickness(&choice.thickness)?;
        if choice.thickness != self.fitting.choice.thickness {
            self.fitting.restart();
        }
        if choice.beyond_points != self.fitting.choice.beyond_points {
            self.trim_points(choice.beyond_points);
        }
        self.fitting.is_settled &= choice == self.fitting.choice;
        self.fitting.choice = choice;
        Ok(())
    }

    /// Ends the surface of a model from points at their border, or lets it continue.
    fn trim_points(&mut self, choice: BeyondPoints) {
        if let Source::Points { field, info, within } = self.run.field().clone()
            && field.data().border.is_some()
        {
            let field = field.untrimmed();
            let field = if choice == BeyondPoints::Cut { field.trimmed() } else { field };
            self.fitting.creases = None;
            self.run.set_field(Source::Points { field, info, within }, false);
        }
    }

    /// Finds the box of the next run and the creases of the surface in it, with up to `budget`
    /// slices of either work, some 10 to 50 microseconds each, and returns the field with its clip
    /// box once all is known. [`Session::start`] does the rest. The settings may depend on the box:
    /// lengths become shares of its diagonal. A box that `only_grows` contains the one before it as
    /// long as the formula stays the same: while a slider moves.
    ///
    /// A solid that the clip box closes is sampled in the box of the settings, or in one that fits
    /// it: the faces of the clip box are inside, and their cuts are creases.
    pub fn fit(
        &mut self,
        settings_in: &dyn Fn(&Bounds) -> Settings,
        only_grows: bool,
        budget: u32,
    ) -> Option<FieldAnswer> {
        let is_fitted = self.has_extent() && self.is_to_fit();
        let (clip, reach) = self.fit_clip(settings_in, only_grows, budget)?;
        let clip = self.make_solid(clip);
        let (bounds, reach_in) = self.fit_solid(settings_in, (clip, reach), budget)?;
        (self.clip, self.reach) = (clip, reach);
        self.run.set_bounds(bounds, reach_in);
        self.fit_creases(budget)?;
        (self.fitting.is_fitted, self.fitting.is_settled) = (is_fitted, true);
        Some(self.answer())
    }

    /// The clip box, fitted to the surface before a box closes it, or as given; with the reach of
    /// the surface if it was fitted.
    fn fit_clip(
        &mut self,
        settings_in: &dyn Fn(&Bounds) -> Settings,
        only_grows: bool,
        budget: u32,
    ) -> Option<(Bounds, Option<Reach>)> {
        if !self.has_extent() || !self.is_to_fit() {
            return Some((self.own_box(), None));
        }
        let choice = self.fitting.choice.clone();
        let search = &mut self.fitting.unclosed;
        let found = match self.run.field() {
            Source::Formula(field) => search.step(|| choice.made_of(field.clone(), None), budget),
            Source::Function(field) => search.step(|| Arc::clone(field), budget),
            #[cfg(feature = "images")]
            Source::Opened(opened) => search.step(|| opened.shared(), budget),
            Source::Points { .. } => None,
        }?;
        let spacing = self.next_spacing();
        let clip = found.with_room(|bounds| settings_in(bounds).largest_share_with(bounds, spacing.as_ref()));
        let before = (only_grows && self.fitting.is_fitted).then_some(self.clip);
        let grown = before.map_or(clip, |before| clip.joined(&before));
        self.fitting.is_grown = grown != clip;
        Some((grown, Some(found.reach)))
    }

    /// Makes the solid of the surface in a clip box the field of the next run. Returns the box,
    /// which a unit cell may have moved.
    fn make_solid(&mut self, clip: Bounds) -> Bounds {
        let choice = self.fitting.choice.clone();
        let Some(field) = self.own_formula() else { return clip };
        let closing = choice.faces(field, clip, self.is_to_choose());
        let is_cell = closing.is_some() && choice.box_cell == BoxCell::Periodic;
        let present = (field.thickness(), field.closing_box(), field.is_cell());
        if present != (choice.thickened(), closing, is_cell) {
            let solid = choice.made_of(field.clone(), closing.as_ref());
            self.fitting.closed = BoxSearch::default();
            self.fitting.creases = None;
            self.run.set_field(Source::Formula(solid), false);
        }
        closing.unwrap_or(clip)
    }

    /// The box of the next run: around the solid if the clip box closes it, else the clip box.
    fn fit_solid(
        &mut self,
        settings_in: &dyn Fn(&Bounds) -> Settings,
        (clip, reach): (Bounds, Option<Reach>),
        budget: u32,
    ) -> Option<(Bounds, Option<Reach>)> {
        let Some(solid) = self.run.field().formula().filter(|field| field.closing_box().is_some()) else {
            return Some((clip, reach));
        };
        if let Some(bounds) = settings_in(&clip).bounds {
            return Some((bounds, None));
        }
        let found = self.fitting.closed.step(|| solid.clone(), budget)?;
        let spacing = self.next_spacing();
        let bounds =
            found.with_room(|bounds| settings_in(bounds).largest_share_with(bounds, spacing.as_ref()));
        Some((bounds, Some(found.reach)))
    }

    /// Finds the creases of the surface in the box of the next run: for a formula, even with a
    /// model as an operand.
    fn fit_creases(&mut self, budget: u32) -> Option<()> {
        if self.run.field().piecewise().is_some() && !self.run.knows_creases() {
            let bounds = self.run.bounds();
            let under_way = self.fitting.creases.take().filter(|(of, _)| *of == bounds);
            let search = under_way.unwrap_or_else(|| (bounds, self.run.find_creases()));
            let found = slices::advance(self.fitting.creases.insert(search).1.as_mut(), budget)?;
            self.fitting.creases = None;
            self.run.know_creases(found);
        }
        Some(())
    }

    /// Whether a box can be fitted to the surface: a model from points brings its own.
    fn has_extent(&self) -> bool {
        match self.run.field() {
            Source::Formula(_) => self.own_formula().is_some(),
            Source::Points { .. } => false,
            #[cfg(feature = "images")]
            Source::Opened(_) => true,
            Source::Function(_) => true,
        }
    }

    /// The formula of the field, unless f is the same everywhere.
    fn own_formula(&self) -> Option<&Formula> {
        self.run.field().formula().filter(|field| !field.is_constant())
    }

    /// The clip box if it is not to be fitted.
    pub(super) fn own_box(&self) -> Bounds {
        let of_surface = self.surface.filter(|_| !self.fitting.is_given);
        of_surface.map_or(self.own, |surface| self.fitting.choice.own_box(surface))
    }

    /// Whether the user has left the choice of the box open.
    fn is_to_choose(&self) -> bool {
        self.fitting.choice.box_mode == BoxMode::Fit && !self.fitting.is_given
    }

    /// Whether the box is to be fitted: not if it was given, nor around a surface of the gallery,
    /// which has its own. Only a search for the box shows how much room a shell takes whose
    /// thickness is a formula.
    fn is_to_fit(&self) -> bool {
        let is_formula = matches!(self.fitting.choice.thickness, Thickness::Formula(_));
        let has_own_box = |surface: &Surface| !(surface.closed && is_formula);
        self.is_to_choose() && !self.surface.is_some_and(has_own_box)
    }

    /// Checks that the surface of the present formula can have a thickness.
    ///
    /// # Errors
    ///
    /// A mistake in the formula of the thickness, or a name that the present formula does not have.
    pub fn check_thickness(&self, thickness: &Thickness) -> Result<(), Fault> {
        match (self.own_formula(), thickness) {
            (Some(field), Thickness::Formula(text)) => {
                field.check_thickness(thickness).map_err(|error| Fault::in_thickness(error, text))
            }
            _ => Ok(()),
        }
    }

    /// Drops a thickness with names that another field does not have.
    pub(super) fn keep_thickness_of(&mut self, field: &Formula) {
        let thickness = &mut self.fitting.choice.thickness;
        if field.check_thickness(thickness).is_err() {
            *thickness = Thickness::default();
        }
    }
}
