//! The words of the warnings about components that have no particle, or may be missing.

use super::NAMED;
use crate::math::{counted, place_text, shortest_text, text_within};
use crate::sampler::{Doubt, Unsampled};
use core::fmt;

/// A distance with two digits.
pub(super) fn about_length(x: f64) -> String {
    shortest_text(format!("{x:.1e}").parse::<f64>().unwrap_or(x))
}

/// Names the places of the components without a particle.
pub(super) fn without_particle(
    f: &mut fmt::Formatter<'_>,
    components: &[Unsampled],
    length: f64,
    is_unresolved: bool,
) -> fmt::Result {
    let named = components.iter().take(NAMED).map(|&Unsampled { position, reach, goes_on }| {
        let about = if goes_on { "more than" } else { "about" };
        format!(
            "{}, reaching {about} {} from there",
            place_text(position, length),
            text_within(reach, length)
        )
    });
    let places = named.collect::<Vec<_>>().join("; near ");
    let more = components.len().saturating_sub(NAMED);
    let rest = if more > 0 { format!("; and at {more} more places") } else { String::new() };
    let summary = if is_unresolved {
        "Parts of the surface lie too close together to be told apart."
    } else {
        "Parts of the surface have no particle: choose a smaller radius."
    };
    write!(f, "{summary} There is none near {places}{rest}.")
}

/// Says why it is not proven that every component has been found.
pub(super) fn unproven(f: &mut fmt::Formatter<'_>, doubt: &Doubt, length: f64) -> fmt::Result {
    match *doubt {
        Doubt::NoBounds => f.write_str(
            "A small component may be missing. The function has no bounds by which a proof could find it, and the grid of the search \
             may miss it.",
        ),
        Doubt::Creases => f.write_str(
            "A small component with an edge may be missing: a smaller box or radius may show it. Edges are searched for, not proven \
             to be all, where sheets cross or touch, where a condition cuts the surface, at steps and folds of f, and on surfaces \
             too intricate for the search.",
        ),
        Doubt::Unfinished => {
            f.write_str("A component may be missing, because the run was stopped during the search.")
        }
        Doubt::Unresolved { position, gap, least } => write!(
            f,
            "Two sheets are too close for single precision: move them apart. Near {} they are {} apart; sheets closer than about {} \
             may be sampled as one in this box, so that components and Euler number may be wrong. A smaller radius does not \
             help. One factor of f at a time does.",
            place_text(position, length),
            about_length(gap),
            about_length(least)
        ),
        Doubt::Cells { count, position, size } => write!(
            f,
            "A small component may be missing: a smaller box may show it. The search for components left {} of the box open, the \
             first near {} and {} wide: f is singular there, or too hard to bound.",
            counted(count as usize, "cell", "cells"),
            place_text(position, size.min(length)),
            about_length(size)
        ),
        Doubt::Witnesses { count, position } => write!(
            f,
            "A component may be missing: a smaller radius may decide it. Of {} it is not proven that a particle lies on the same \
             component, first near {}; another part of the surface may be too near.",
            counted(count as usize, "point of the surface", "points of the surface"),
            place_text(position, length)
        ),
    }
}
