//! The spacing of a session's runs, and values at their particles, as texts.

use super::{Fault, FaultKind, Session, Source, SpacingText};
use crate::field::formula::{FormulaError, Parameter};
use crate::run::{Value, ValueError};
use crate::sampler::Spacing;

impl SpacingText {
    /// The spacing, with these parameters of the formula whose surface is sampled.
    fn spacing(&self, parameters: &[Parameter]) -> Result<Spacing, Fault> {
        let spacing = Spacing::of_formula(&self.formula, parameters)
            .map_err(|error| Fault::in_spacing(error, &self.formula))?;
        let spacing = self.smallest.into_iter().fold(spacing, Spacing::at_least);
        let spacing = self.largest.into_iter().fold(spacing, Spacing::at_most);
        spacing.check_limits().map_err(|error| Fault::new(FaultKind::Settings, &error))?;
        Ok(spacing)
    }
}

impl Session {
    /// Chooses the spacing of the next runs; none for sizes by the settings alone. It may use the
    /// parameters of the present formula. If another formula does not have them, there is no
    /// spacing.
    ///
    /// # Errors
    ///
    /// If the formula of the spacing has a mistake, or a limit is out of its range; nothing is
    /// changed then.
    pub fn space(&mut self, text: Option<SpacingText>) -> Result<(), Fault> {
        if let Some(text) = &text {
            text.spacing(self.own_parameters())?;
        }
        (self.spacing, self.spacing_function) = (text, None);
        Ok(())
    }

    /// Chooses a spacing by a function of the program for the next runs; no record can hold it.
    pub fn space_by(&mut self, spacing: Spacing) {
        self.spacing_function = Some(spacing);
    }

    /// The spacing of a run that starts now.
    pub(super) fn next_spacing(&self) -> Option<Spacing> {
        if let Some(spacing) = &self.spacing_function {
            return Some(spacing.clone());
        }
        self.spacing.as_ref()?.spacing(self.own_parameters()).ok()
    }

    /// Adds the column of a value at the particles of the last run, which is complete, with up to
    /// `budget` slices of joining the mesh if the value needs areas; none until it is there.
    pub fn add_value(&mut self, name: &str, value: &Value, budget: u32) -> Option<Result<(), ValueError>> {
        if value.needs_mesh() && self.run.mesh().is_none() {
            self.join(budget)?;
        }
        Some(self.run.add_value(name, value))
    }

    /// Whether the present surface can have a spacing by this formula.
    ///
    /// # Errors
    ///
    /// If the formula has a mistake.
    pub fn check_spacing(&self, formula: &str) -> Result<(), Fault> {
        let text = SpacingText { formula: formula.to_owned(), ..SpacingText::default() };
        text.spacing(self.own_parameters()).map(drop)
    }

    /// The value of a formula that may use the parameters of the present formula.
    ///
    /// # Errors
    ///
    /// If the formula has a mistake.
    pub fn value(&self, text: &str) -> Result<Value, Fault> {
        let fault = |error: FormulaError| {
            let message = format!("Value: {}", error.message);
            Fault { kind: FaultKind::Value, message, ..Fault::in_formula(error, text) }
        };
        Value::of_formula(text, self.own_parameters()).map_err(fault)
    }

    /// The parameters of the present formula.
    fn own_parameters(&self) -> &[Parameter] {
        match self.source() {
            Source::Formula(field) => field.parameters(),
            Source::Points { within: Some(formula), .. } => &formula.parameters,
            #[cfg(feature = "images")]
            Source::Opened(opened) => opened.formula_parameters(),
            Source::Points { .. } | Source::Function(_) => &[],
        }
    }
}
