//! The options of the spacing.

use crate::arguments::SampleArguments;
use crate::failure::Failure;
use crate::options::{Length, length, number};
use marching_particles::internal::math::shortest_text;
use marching_particles::internal::session::{FaultKind, Session, SpacingText};

/// A spacing from the command line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SpacingOption {
    /// The same everywhere.
    Even(Length),
    /// By a formula.
    Formula(String),
}

/// A spacing from an argument: a length, or a formula, which the session checks.
pub(crate) fn spacing(text: &str) -> Result<SpacingOption, String> {
    if text.trim_end().ends_with('%') || number(text).is_ok() {
        return length(text).map(SpacingOption::Even);
    }
    Ok(SpacingOption::Formula(text.to_owned()))
}

/// A positive length in the units of the coordinates.
pub(crate) fn units(text: &str) -> Result<f64, String> {
    match number(text)? {
        length if length > 0.0 => Ok(length),
        _ => Err("it must be positive".to_owned()),
    }
}

impl SampleArguments {
    /// Makes a constant spacing a radius, unless other options exclude it.
    pub(crate) fn take_even_spacing(&mut self) {
        let is_limited = self.spacing_min.or(self.spacing_max).is_some();
        if let Some(SpacingOption::Even(length)) = &self.spacing
            && !(is_limited || self.sampling.is_counted() || self.sampling.is_adaptive())
        {
            self.sampling.space_evenly(*length);
            self.spacing = None;
        }
    }

    /// The spacing formula. A constant spacing becomes a radius instead, unless sizes also follow
    /// the curvature.
    pub(crate) fn spacing_text(&mut self) -> Result<Option<SpacingText>, Failure> {
        self.take_even_spacing();
        let (smallest, largest) = (self.spacing_min, self.spacing_max);
        let is_limited = smallest.or(largest).is_some();
        let refused = match &self.spacing {
            None => return Ok(None),
            Some(SpacingOption::Formula(text)) => {
                return Ok(Some(SpacingText { formula: text.clone(), smallest, largest }));
            }
            Some(SpacingOption::Even(_)) if is_limited => {
                "--spacing-min and --spacing-max have no effect without a formula in --spacing"
            }
            Some(SpacingOption::Even(_)) if self.sampling.is_counted() => {
                "--count chooses the distance of particles of one size: leave out --spacing, or give it a \
                 formula"
            }
            Some(SpacingOption::Even(Length::Share(_))) => {
                "beside --adaptive, --spacing takes a length or a formula, not a share of the box diagonal"
            }
            Some(SpacingOption::Even(Length::Units(length))) => {
                let formula = shortest_text(*length);
                return Ok(Some(SpacingText { formula, smallest, largest }));
            }
        };
        Err(Failure::Usage(refused.to_owned()))
    }
}

/// Sets the spacing for the session's runs.
pub(crate) fn space(session: &mut Session, text: Option<SpacingText>) -> Result<(), Failure> {
    let formula = text.as_ref().map_or_else(String::new, |text| text.formula.clone());
    session.space(text).map_err(|fault| match fault.kind {
        FaultKind::Spacing => Failure::Formula { text: formula, fault: Box::new(fault) },
        // Such a message begins with the name of the limit that is out of range.
        _ => Failure::Usage(fault.message.replacen("spacing_m", "--spacing-m", 1)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacing_is_a_length_or_a_formula() {
        let formula = |text: &str| Ok(SpacingOption::Formula(text.to_owned()));
        assert_eq!(spacing("1/20"), Ok(SpacingOption::Even(Length::Units(0.05))));
        assert_eq!(spacing("1 %"), Ok(SpacingOption::Even(Length::Share(0.01))));
        assert_eq!(spacing("0.1 + z"), formula("0.1 + z"));
        assert_eq!(spacing("x % 2"), formula("x % 2"));
        for bad in ["0", "-1", "0%", "z %"] {
            assert!(spacing(bad).is_err(), "{bad}");
        }
    }
}
