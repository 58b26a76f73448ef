//! What a user should know about a run, in words.

use super::{Kept, Session};
use crate::math::{grouped, shortest_text};
use crate::quality::Opening;
use crate::sampler::{COUNT_TOLERANCE, Counts, Doubt, FateCounts, Sampled, SizeMode, StopReason, Unsampled};
use crate::slices::{pause, ranges};
use crate::spatial::tree::Tree;
use glam::DVec3;

/// Sheets are said to be close if at least this share of the particles face one, and at least this many.
const CLOSE_SHARE: f64 = 0.005;
const CLOSE_COUNT: usize = 8;

/// What is said where the search was left open beside places where f is beyond double precision.
pub(super) const OVERFLOW: &str = "f is too large for double precision in a part of the box, where components may be missed: enter it \
     in a form with smaller numbers, each factor by its logarithm for example, or make the box smaller.";

impl Session {
    /// Returns the warnings about the run. The places in `sampled` are coordinates of the formula; `facing` is the number of particles
    /// that face another sheet.
    pub(super) fn warnings_of_run(&self, counts: &Counts, sampled: &Sampled, facing: usize) -> Vec<String> {
        let particles = self.sampler.particles();
        let (count, origin, radius) = (particles.len(), particles.origin, self.sampler.radius());
        let mut warnings = self.warnings.clone();
        let settings = self.sampler.settings();
        let stop_reason = self.last.as_ref().and_then(|progress| progress.stop_reason);
        if settings.size_mode == SizeMode::Count
            && matches!(stop_reason, Some(StopReason::Complete | StopReason::OneParticle))
        {
            warnings.extend(about_count(count, settings.count));
        }
        let doubts = self.sampler.doubts();
        let is_unresolved = doubts.iter().any(|doubt| matches!(doubt, Doubt::Unresolved { .. }));
        let facing = if is_unresolved { 0 } else { facing };
        warnings.extend(about(count, facing, counts, sampled.missing.is_some()));
        warnings.extend(about_components(&sampled.without, radius, is_unresolved));
        if let Some(opening) = self.measured.opening.filter(|_| !is_unresolved) {
            warnings.push(about_opening(&opening, origin, radius));
        }
        // Where sheets are too near to be told apart, that is why witnesses are left open, and it is told already.
        let told = doubts.iter().filter(|doubt| !(is_unresolved && matches!(doubt, Doubt::Witnesses { .. })));
        warnings.extend(told.filter_map(|doubt| about_doubt(doubt, origin, radius)));
        warnings
    }
}

/// What is said where another equation is sampled in the place of the formula.
pub(super) fn about_powers(equation: String) -> String {
    format!(
        "f has powers, roots or absolute values of whole factors, which take its gradient on the surface. The same surface \
         with every factor once is sampled: {equation}"
    )
}

/// What is said where a wanted number of particles is missed by more than the 3 % that are promised.
fn about_count(total: usize, wanted: u32) -> Option<String> {
    let is_met = (total as f64 / f64::from(wanted) - 1.0).abs() <= COUNT_TOLERANCE;
    (!is_met).then(|| {
        format!(
            "There are {total} particles, not the {wanted} wanted: where they are large against the surface or its box, their \
             number changes by leaps."
        )
    })
}

/// Warnings about what became of `total` particles, of which `close` face another sheet that a smaller radius would tell apart.
/// Where the run `is_audited`, components without particles are named elsewhere.
fn about(total: usize, close: usize, counts: &Counts, is_audited: bool) -> Vec<String> {
    let mut warnings: Vec<String> = counts.refusal.iter().map(ToString::to_string).collect();
    let children = |count: u64| if count == 1 { "1 child".to_owned() } else { format!("{count} children") };
    // Those of a coarse front are no trouble once its mesh has been checked and refined.
    let FateCounts { not_converged, undefined, .. } =
        if counts.refined_levels.is_some() { FateCounts::default() } else { counts.fates };
    let mut troubles = Vec::new();
    if not_converged > 0 {
        troubles.push(format!("{} found no surface at the right distance", children(not_converged)));
    }
    if undefined > 0 {
        troubles.push(format!("{} met a place without a value or a normal", children(undefined)));
    }
    if !troubles.is_empty() {
        warnings.push(format!(
            "{}: an edge, a singular point or a radius too large for the curvature.",
            troubles.join(" and ")
        ));
    }
    if close >= CLOSE_COUNT && close as f64 >= CLOSE_SHARE * total as f64 {
        warnings.push(format!(
            "{close} particles face another sheet of the surface within 2r. The sheets are kept apart, but the particles are \
             too large to tell them apart by position alone: choose a smaller radius."
        ));
    }
    if counts.ended_early {
        warnings.push(format!(
            "The run was ended early: {} seeds had stayed alone beside other particles, because the particles are larger than the \
             distances between the parts of the surface. Choose a smaller radius.",
            counts.left_out
        ));
    }
    if !is_audited && counts.left_out > 0 {
        warnings.push(format!(
            "Within 2r of other particles lie features too small for a particle of their own, {} in all: a smaller radius shows \
             whether they are components of their own.",
            counts.left_out
        ));
    }
    warnings
}

/// A number rounded to a thousandth of a length.
fn short(x: f64, length: f64) -> String {
    let digits = (3.0 - libm::floor(libm::log10(length))).clamp(0.0, 15.0) as usize;
    shortest_text(format!("{x:.digits$}").parse::<f64>().unwrap_or(x) + 0.0)
}

/// A place in words, rounded to a thousandth of a length.
fn place(position: [f64; 3], length: f64) -> String {
    format!("({})", position.map(|x| short(x, length)).join(", "))
}

/// A distance with two digits.
fn about_length(x: f64) -> String {
    shortest_text(format!("{x:.1e}").parse::<f64>().unwrap_or(x))
}

/// Says why it is not proven that every component has been found. Places are counted from `origin`.
fn about_doubt(doubt: &Doubt, origin: DVec3, radius: f64) -> Option<String> {
    let place = |position: [f64; 3], length| place((origin + DVec3::from_array(position)).to_array(), length);
    let told = match *doubt {
        // It is so with every model from points, which the row of the report says.
        Doubt::NoBounds => return None,
        Doubt::Unfinished => "The run ended before the search for components did: one can be missing.".into(),
        Doubt::Unresolved { position, gap, least } => format!(
            "Near {} two sheets of the surface are {} apart. Particles have single-precision coordinates, which tell sheets apart \
             down to about {} in this box. Nearer ones may be sampled as one, and the components and the Euler number of the sample \
             need not be those of the surface. A smaller radius does not help: move the sheets apart, or sample one factor of f at \
             a time.",
            place(position, radius),
            about_length(gap),
            about_length(least)
        ),
        Doubt::Cells { count, position, size } => format!(
            "The search for components ended with {} of the box undecided, the first near {} and {} wide: f is singular there, or too \
             hard to bound with as many cells as the search may take. A component can be missing there; a smaller box may show it.",
            if count == 1 { "1 cell".into() } else { format!("{} cells", grouped(count as usize)) },
            place(position, size.min(radius)),
            about_length(size)
        ),
        Doubt::Witnesses { count, position } => format!(
            "Of {} it could not be proven whether a particle lies on the same component, first near {}. Another part of the surface \
             may be too near there for this radius: a smaller one may decide it.",
            if count == 1 {
                "1 point of the surface".into()
            } else {
                format!("{} points of the surface", grouped(count as usize))
            },
            place(position, radius)
        ),
    };
    Some(told)
}

/// Says where the triangles between particles do not close the surface. The place is counted from `origin`.
fn about_opening(opening: &Opening, origin: DVec3, radius: f64) -> String {
    let &Opening { edges, points, position } = opening;
    let counted = |count: usize, name: &str| format!("{count} {name}{}", if count == 1 { "" } else { "s" });
    let found = match (edges, points) {
        (_, 0) => format!("{} open", counted(edges, "edge")),
        (0, _) => format!("{} out", counted(points, "particle")),
        _ => format!("{} open and {} out", counted(edges, "edge"), counted(points, "particle")),
    };
    format!(
        "The triangles between the particles leave {found}, first near {}: the components and the Euler number of the sample need not be \
         those of the surface. The surface has an edge, a point or an end there, or is thinner or bends more sharply than the particles \
         are large; then choose a smaller radius.",
        place((origin + position.as_dvec3()).to_array(), radius)
    )
}

/// Names the places of the components `without` a particle. Where sheets are `unresolved`, a smaller radius is no remedy.
fn about_components(without: &[Unsampled], radius: f64, unresolved: bool) -> Option<String> {
    /// Places that are named in words; the report has all.
    const NAMED: usize = 4;
    let places: Vec<String> = without
        .iter()
        .take(NAMED)
        .map(|&Unsampled { position, reach, goes_on }| {
            let about = if goes_on { "more than" } else { "about" };
            format!("{}, reaching {about} {} from there", place(position, radius), short(reach, radius))
        })
        .collect();
    let more = without.len().saturating_sub(NAMED);
    let rest = if more > 0 { format!("; and at {more} more places") } else { String::new() };
    let cause = if unresolved {
        "is too near another one"
    } else {
        "is too small or too near another one for this radius: choose a smaller radius"
    };
    (!without.is_empty()).then(|| {
        format!(
            "No particle lies on the surface near {}{rest}. A component there, or a part of one, {cause}.",
            places.join("; near ")
        )
    })
}

/// Number of particles nearer than 2r to one that faces the other way.
pub(super) async fn facing_another_sheet(particles: &Kept) -> usize {
    /// Normals at more than 120° face each other: across a sharp edge they are nearer.
    const FACING: f32 = -0.5;
    /// Particles looked at in one slice of work.
    const SLICE: usize = 64;
    let tree = Tree::in_slices(particles.position.iter().copied().zip(0..).collect()).await;
    let mut near = Vec::new();
    let mut count = 0;
    for range in ranges(tree.len(), SLICE) {
        // In tree order: near particles look at the same memory.
        for k in range {
            let i = tree.origin[k] as usize;
            let (p, n) = (particles.position[i], particles.normal[i]);
            let reach = 2.0 * particles.radius[i];
            near.clear();
            tree.within_box(p - reach, p + reach, &mut near);
            let is_facing = near.iter().any(|&k| {
                particles.normal[tree.origin[k as usize] as usize].dot(n) < FACING
                    && tree.position[k as usize].distance_squared(p) < reach * reach
            });
            count += usize::from(is_facing);
        }
        pause().await;
    }
    count
}
