//! Messages for the user of a run that has ended.

use super::{Sampler, StopReason};
use crate::math::{place_text, significant};
use crate::sampler::discovery::completeness::Doubt;
use crate::sampler::discovery::survey::Absence;
use crate::sampler::settings::SizeMode;
use glam::DVec3;

impl Sampler<'_> {
    /// A sentence for the user where the reason for the end needs one.
    pub(crate) fn message(&self) -> Option<String> {
        Some(match self.stop_reason? {
            StopReason::Complete | StopReason::Cancelled => return None,
            StopReason::Cap if self.settings.size_mode == SizeMode::Count => format!(
                "Stopped at the limit of {} particles, which do not cover the surface as {} would: raise the limit, or ask for fewer.",
                self.settings.max_particles, self.settings.count
            ),
            StopReason::Cap => format!(
                "Stopped at the limit of {} particles; raise the limit or the radius to cover the whole surface.",
                self.settings.max_particles
            ),
            StopReason::NoSurface if self.surface.survey.absence == Absence::Proven => {
                "f has no zero in this box (proven by interval arithmetic).".into()
            }
            StopReason::NoSurface if self.surface.survey.absence == Absence::Steps => format!(
                "f takes only {} and jumps between them: give a signed function, which is negative inside, positive outside, \
                 and changes gradually, such as the distance from the surface.",
                values_text(&self.surface.survey.steps)
            ),
            StopReason::NoSurface if self.surface.survey.absence == Absence::Bare => format!(
                "No surface: f comes to zero, for example near {}, but only on a curve or at a point, beside which it keeps one sign. For a \
                 surface around it enter a number on the right side, such as {level}: f = {level} instead of f = 0.",
                self.place(self.bare_place().unwrap_or_default()),
                level = significant(self.surface.survey.level),
            ),
            StopReason::NoSurface | StopReason::OneParticle
                if !self.cover.components.singular().is_empty() && (self.cover.particles.is_empty() || self.surface.survey.touches) =>
            {
                let middle = 0.5 * (self.surface.bounds.lo() + self.surface.bounds.hi());
                let distance = |p: &DVec3| (*p - middle).length_squared();
                let points = self.cover.components.singular().iter().map(|point| point.position);
                let nearest = points.min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let near = self.place(nearest.unwrap_or_default());
                format!(
                    "No surface that particles can cover: f comes to zero, for example near {near}, but its gradient \
                     vanishes there. This may be a point or a curve, as for x^2 + y^2 = 0, or a surface on which f is flat, as \
                     a power is. For a surface around it enter a small number on the right, such as x^2 + y^2 = 0.01; if f is \
                     a power, enter its base."
                )
            }
            StopReason::NoSurface if self.surface.survey.absence == Absence::NotSeen => {
                let (of_box, remedy) = if self.is_box_given {
                    ("this box", "Enlarge or move the box.")
                } else {
                    (
                        "the box that was found for it",
                        "A surface that is small against that box, or beyond it, needs a box of its own.",
                    )
                };
                let (nodes, beyond) = match self.surface.survey.defined {
                    1.0.. => ("at every grid point".to_owned(), ""),
                    share => (
                        format!("at every grid point at which it has a value, {} of all,", percent(share)),
                        " Where f ends, as a square root does at zero, there is no surface: enter what is under the root, \
                         or give f values beyond.",
                    ),
                };
                format!("f keeps one sign {nodes} of {of_box}. {remedy}{beyond}{}", self.undecided_place())
            }
            StopReason::NoSurface if self.surface.survey.absence == Absence::Limited => {
                "Nothing of the surface is within its limits in this box: change the conditions in braces.".into()
            }
            StopReason::NoSurface => format!(
                "f changes its sign in this box, but only where it jumps, has a pole or loses its gradient, or on a surface that is \
                 far smaller than the box.{}",
                self.undecided_place()
            ),
            StopReason::Constant => {
                "f has the same value wherever it is defined in the box, so there is no surface to sample.".into()
            }
            StopReason::Undefined if self.surface.survey.absence == Absence::TooLarge => {
                "f is too large for double precision wherever it has a value in the box: enter it in a form with smaller \
                 numbers, such as its logarithm, or make the box smaller."
                    .into()
            }
            StopReason::Undefined => "f has no value anywhere in the box.".into(),
            StopReason::OneParticle => {
                "The radius is too large for this surface: only one particle fits. Choose a smaller radius."
                    .into()
            }
        })
    }
}

/// A few values in words.
fn values_text(values: &[f64]) -> String {
    let text: Vec<String> = values.iter().map(|&value| significant(value)).collect();
    match text.as_slice() {
        [a, b] => format!("the values {a} and {b}"),
        [a, b, c] => format!("the values {a}, {b} and {c}"),
        [first, .., last] => format!("{} values, from {first} to {last},", text.len()),
        _ => "one value".to_owned(),
    }
}

/// A share in words.
fn percent(share: f64) -> String {
    if share < 0.001 { "less than 0.1 %".to_owned() } else { format!("{:.1} %", 100.0 * share) }
}

impl Sampler<'_> {
    /// A place in words, in the coordinates of the formula.
    fn place(&self, p: DVec3) -> String {
        place_text((self.cover.particles.origin + p).to_array(), self.surface.bounds.diagonal())
    }

    /// A sentence on the first cell that the search for components left undecided; empty if there
    /// is none.
    fn undecided_place(&self) -> String {
        let cell = self.doubts().into_iter().find_map(|doubt| match doubt {
            Doubt::Cells { position, .. } => Some(self.place(DVec3::from_array(position))),
            _ => None,
        });
        cell.map_or_else(String::new, |near| {
            format!(
                " The search for small parts could not decide near {near}: a small box there may show one."
            )
        })
    }
}
