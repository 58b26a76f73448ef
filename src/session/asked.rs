//! Settings as a program gives them: with lengths instead of shares of the diagonal of a box, which
//! may not be known yet.

use crate::math::Bounds;
use crate::sampler::Settings;
use serde::Deserialize;

/// Settings of a run, some of whose sizes are lengths in the units of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// The settings.
    pub settings: Settings,
    /// The lengths, which replace shares.
    pub lengths: Lengths,
}

/// Lengths that replace shares of the diagonal of the box. For the radius there is
/// [`Settings::radius`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lengths {
    /// Replaces [`Settings::chord_error`].
    pub chord_error: Option<f64>,
    /// Replaces [`Settings::radius_min_share`].
    pub radius_min_share: Option<f64>,
    /// Replaces [`Settings::radius_max_share`].
    pub radius_max_share: Option<f64>,
}

impl Asked {
    /// The settings of a run in this box.
    #[must_use]
    pub fn within(&self, bounds: &Bounds) -> Settings {
        let Self { mut settings, lengths } = *self;
        let put = |share: &mut f64, length: Option<f64>| {
            if let Some(length) = length {
                *share = length / bounds.diagonal();
            }
        };
        put(&mut settings.chord_error, lengths.chord_error);
        put(&mut settings.radius_min_share, lengths.radius_min_share);
        put(&mut settings.radius_max_share, lengths.radius_max_share);
        settings
    }
}

impl From<Settings> for Asked {
    fn from(settings: Settings) -> Self {
        Self { settings, lengths: Lengths::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_shares_of_the_diagonal_of_the_box() {
        let lengths = Lengths { chord_error: Some(0.01), radius_max_share: Some(0.2), ..Lengths::default() };
        let asked = Asked { lengths, ..Settings::with_count(100).adaptive().into() };
        let bounds = Bounds::cube(2.0);
        let settings = asked.within(&bounds);
        assert_eq!(settings.chord_error, 0.01 / bounds.diagonal());
        assert_eq!(settings.radius_max_share, 0.2 / bounds.diagonal());
        assert_eq!(settings.radius_min_share, Settings::DEFAULT.radius_min_share);
        assert_eq!(settings.count, 100);
    }
}
