//! Samples of the surface that do not depend on the particles: its crossings with random lines.
//!
//! The triangles do not show what the particles have missed: a component without a seed, or a
//! region where the front stopped. A line that is uniform among those that meet a convex box
//! crosses a surface in the box with a mean number of crossings proportional to its area
//! (Cauchy–Crofton formula), so the crossings are uniform random samples of the whole surface.

use super::projection::project;
use crate::field::{BATCH, Evaluator};
use crate::math::Bounds;
use crate::slices::{self, MEDIUM, pause, ranges};
use glam::{DVec3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Number of lines. A closed surface that fills its box is crossed about as often, so a component
/// with 0.1 % of the area is missed with a probability of 2 %.
const LINES: usize = 4096;
/// Points along a line at which the field is evaluated. Two crossings between consecutive points
/// are not seen: a part thinner than a 64th of the box may be missed.
const STATIONS: usize = 64;
/// Lines that are evaluated together, in one slice of work.
const LINES_AT_ONCE: usize = MEDIUM / STATIONS;
/// Slices of the work of [`crossings`].
pub(super) const SLICES: u64 = (LINES / LINES_AT_ONCE) as u64;
/// A crossing counts if its first-order distance from the surface after projection is below this
/// share of the step along the line: at poles and jumps the sign changes too.
const RESIDUAL: f32 = 1e-2;
/// Seed of the lines, different from that of the samples on triangles: the letters of `lines`.
const STREAM: u64 = 0x6c69_6e65_7300_0000;

/// Returns random samples of the surface in `bounds`, uniform over its area; at most a few for each
/// line.
pub(super) async fn crossings(field: &mut dyn Evaluator, bounds: &Bounds) -> Vec<Vec3> {
    if !bounds.is_valid() {
        return Vec::new();
    }
    let mut random = Pcg32::seed_from_u64(STREAM);
    let mut chords = Vec::with_capacity(LINES);
    for range in ranges(LINES, MEDIUM) {
        chords.extend(range.map(|_| chord(&mut random, bounds)));
        pause().await;
    }
    let shared: &dyn Evaluator = field;
    let parts = slices::map(
        LINES,
        LINES_AT_ONCE,
        || shared.another(),
        |field, lines| sign_changes(&mut **field, &chords[lines]),
    );
    let changes = parts.await.concat();
    let parts = slices::map(
        changes.len(),
        BATCH,
        || shared.another(),
        |field, range| settled(&mut **field, bounds, &changes[range]),
    );
    let mut found = parts.await.concat();
    if field.has_limits() {
        found.retain(|place| !field.is_beyond_limits(place.as_dvec3()));
    }
    found
}

/// A change of the sign of f between neighbouring points of a line.
#[derive(Clone, Copy)]
struct SignChange {
    /// The place where f is 0 if it is linear between both points.
    position: Vec3,
    /// The distance between both points.
    leash: f32,
    /// The larger |f| of both.
    end: f32,
}

/// The changes on [`LINES_AT_ONCE`] lines with these ends.
fn sign_changes(field: &mut dyn Evaluator, chords: &[(DVec3, DVec3)]) -> Vec<SignChange> {
    let mut points = [Vec3::ZERO; MEDIUM];
    let mut values = [0.0_f32; MEDIUM];
    for (line, (from, to)) in points.chunks_exact_mut(STATIONS).zip(chords) {
        for (k, point) in line.iter_mut().enumerate() {
            *point = from.lerp(*to, (k as f64 + 0.5) / STATIONS as f64).as_vec3();
        }
    }
    field.values(&points, &mut values);
    let mut changes = Vec::new();
    for (line, value) in points.chunks_exact(STATIONS).zip(values.chunks_exact(STATIONS)) {
        for k in 1..STATIONS {
            let (a, b) = (value[k - 1], value[k]);
            // This is false if either is NaN.
            if a <= 0.0 && b > 0.0 || a > 0.0 && b <= 0.0 {
                let share = a / (a - b);
                changes.push(SignChange {
                    position: line[k - 1].lerp(line[k], if share.is_finite() { share } else { 0.5 }),
                    leash: (line[k] - line[k - 1]).length(),
                    end: a.abs().max(b.abs()),
                });
            }
        }
    }
    changes
}

/// The places on the surface in the box to which changes lead by projection, at most [`BATCH`] of
/// them.
fn settled(field: &mut dyn Evaluator, bounds: &Bounds, changes: &[SignChange]) -> Vec<Vec3> {
    let mut position: Vec<Vec3> = changes.iter().map(|change| change.position).collect();
    let leash: Vec<f32> = changes.iter().map(|change| change.leash).collect();
    // All steps are taken: near a pole they lead away from it, each doubling the distance.
    project(field, &mut position, &leash, 0.0);
    let mut value = vec![0.0; position.len()];
    let mut gradient = vec![Vec3::ZERO; position.len()];
    field.gradients(&position, &mut value, &mut gradient);
    // Towards a pole |f| grows beyond its values at the ends of the step, even where |f|/|∇f|
    // becomes small.
    let is_on_surface = |k: usize, change: &SignChange| {
        let size = value[k].abs();
        size <= RESIDUAL * change.leash * gradient[k].length() && size <= change.end
    };
    let places = position.iter().zip(changes).enumerate();
    let on_surface = places.filter(|&(k, (&p, change))| is_on_surface(k, change) && bounds.contains(p));
    on_surface.map(|(_, (&p, _))| p).collect()
}

/// Returns the ends of a random chord of the box, uniform in the measure of lines: it starts at a
/// uniform point of the boundary, in an inward direction with a density proportional to the cosine
/// of the angle with the normal of the face.
fn chord(random: &mut Pcg32, bounds: &Bounds) -> (DVec3, DVec3) {
    let mut unit = move || f64::from(random.next_u32()) * (1.0 / 4_294_967_296.0);
    let (lo, size) = (bounds.lo(), bounds.hi() - bounds.lo());
    let faces = [size.y * size.z, size.z * size.x, size.x * size.y];
    let mut pick = unit() * (faces[0] + faces[1] + faces[2]);
    let mut axis = 0;
    while axis < 2 && pick >= faces[axis] {
        pick -= faces[axis];
        axis += 1;
    }
    let upper = unit() < 0.5;
    let mut from = lo + size * DVec3::new(unit(), unit(), unit());
    from[axis] = if upper { bounds.max[axis] } else { bounds.min[axis] };
    // A uniform point of the unit disc, lifted to the hemisphere, has the density of the cosine.
    let (x, y) = loop {
        let (x, y) = (2.0 * unit() - 1.0, 2.0 * unit() - 1.0);
        if x * x + y * y < 1.0 {
            break (x, y);
        }
    };
    let mut direction = DVec3::ZERO;
    direction[(axis + 1) % 3] = x;
    direction[(axis + 2) % 3] = y;
    direction[axis] = (1.0 - x * x - y * y).sqrt() * if upper { -1.0 } else { 1.0 };
    // The chord ends at the first of the three far faces that the line meets.
    let length = (0..3).fold(f64::INFINITY, |length: f64, k| {
        let face = if direction[k] > 0.0 { bounds.max[k] } else { bounds.min[k] };
        let distance = (face - from[k]) / direction[k];
        if direction[k] == 0.0 { length } else { length.min(distance.max(0.0)) }
    });
    (from, from + direction * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_have_the_mean_length_of_cauchys_formula() {
        // The mean is 4 V / S for a convex body.
        let bounds = Bounds { min: [-1.0, 0.0, 2.0], max: [1.0, 1.0, 5.0] };
        let (volume, surface) = (6.0, 2.0 * (2.0 + 3.0 + 6.0));
        let mut random = Pcg32::seed_from_u64(5);
        let n = 20_000;
        let mean = (0..n)
            .map(|_| {
                let (from, to) = chord(&mut random, &bounds);
                (to - from).length()
            })
            .sum::<f64>()
            / f64::from(n);
        assert!((mean / (4.0 * volume / surface) - 1.0).abs() < 0.02, "mean chord {mean}");
    }
}
