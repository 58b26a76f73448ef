//! Smooth joins: curves along which two patches meet without an edge, yet are not one patch, since
//! they or their neighbours meet at an angle elsewhere. A fillet that fades out has one.
//!
//! Next to a smooth join, too, both branches vanish up to the second order, so that their common
//! zeros hardly determine its place. It is found on the surface, by bisection between two points of
//! different patches.

use super::meeting::{MOST_TURN, Meeting, branch, limits};
use crate::math::newton;
use crate::math::newton::{step_to_curve, step_to_surface};
use crate::math::{Bounds, Meet, SQRT_3, tangent_frame};
use crate::sampler::probe::Probe;
use glam::DVec3;

/// Bisections of the way between two points on either side of a smooth join, to rounding.
const HALVINGS: u32 = 40;
/// Radius of the circle around a point of a smooth join from which its direction is found, as a
/// share of the reach.
const AROUND: f64 = 0.02;
/// Points of that circle.
const POINTS: u32 = 16;
/// Distance on either side of a chord at which a smooth join is searched for, as a share of the
/// reach.
const BESIDE_CHORD: f64 = 0.2;

/// A point of the surface.
#[derive(Clone, Copy)]
struct Landed {
    position: DVec3,
    patch: u32,
}

/// The point of the surface to which Newton's method leads from `start`, within `reach`.
fn landed(probe: &mut Probe, start: DVec3, reach: f64) -> Option<Landed> {
    let step_at = |p: DVec3| {
        let patch = probe.field.label(p);
        Some((step_to_surface(branch(probe, patch, p)), ()))
    };
    let (position, ()) = newton::land(start, limits(reach), step_at)?;
    Some(Landed { position, patch: probe.field.label(position) })
}

/// The unit normal of a patch.
fn normal(probe: &mut Probe, patch: u32, p: DVec3) -> DVec3 {
    branch(probe, patch, p).1.normalize_or_zero()
}

/// The points at which the patch changes on a circle around a point of a smooth join, seen from
/// outside: counter-clockwise from the first patch to the second, and back. None if there are other
/// changes.
fn changes_around(
    probe: &mut Probe,
    pair: [u32; 2],
    centre: DVec3,
    normal: DVec3,
    radius: f64,
) -> Option<[Option<DVec3>; 2]> {
    let (a, b) = tangent_frame(normal.as_vec3());
    let frame = [a.as_dvec3(), b.as_dvec3()];
    let place = |probe: &mut Probe, angle: f64| {
        let (sine, cosine) = libm::sincos(angle);
        landed(probe, centre + (frame[0] * cosine + frame[1] * sine) * radius, radius)
    };
    let step = core::f64::consts::TAU / f64::from(POINTS);
    let mut patches = Vec::with_capacity(POINTS as usize);
    for k in 0..POINTS {
        let patch = place(probe, f64::from(k) * step)?.patch;
        patches.push(patch);
    }
    // One arc for each of the patches.
    let mut found = [None; 2];
    for k in 0..POINTS {
        let [here, next] = [k, (k + 1) % POINTS].map(|k| patches[k as usize]);
        if here == next {
            continue;
        }
        let way = pair.iter().position(|&patch| patch == here)?;
        if next != pair[1 - way] || found[way].is_some() {
            return None;
        }
        let end = turn([here, next], |share| place(probe, (f64::from(k) + share) * step))?;
        found[way] = Some(end);
    }
    Some(found)
}

/// The place between a point of the first patch and one of the second where the patch changes. `at`
/// is the point of the surface after a share of the way.
fn turn(pair: [u32; 2], mut at: impl FnMut(f64) -> Option<Landed>) -> Option<DVec3> {
    let [mut from, mut to] = [0.0, 1.0];
    let mut place = at(from).filter(|first| first.patch == pair[0])?;
    at(to).filter(|last| last.patch == pair[1])?;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        let next = at(middle)?;
        match pair.iter().position(|&patch| patch == next.patch)? {
            0 => (from, place) = (middle, next),
            _ => to = middle,
        }
    }
    Some(place.position)
}

impl Meeting {
    /// Whether the patches meet without an edge.
    pub(super) fn is_smooth(&self) -> bool {
        self.sine == 0.0
    }

    /// A point in or near a cell where these patches meet without an edge.
    pub(super) fn on_smooth_join(probe: &mut Probe, pair: [u32; 2], cell: &Bounds) -> Option<Self> {
        let reach = cell.diagonal();
        // Pieces that meet at an angle have a crease there. A vanishing gradient decides nothing.
        let [u, v] = pair.map(|patch| normal(probe, patch, cell.middle()));
        if u != DVec3::ZERO && v != DVec3::ZERO && u.dot(v) < MOST_TURN {
            return None;
        }
        let mut ends: [Option<Landed>; 2] = [None; 2];
        // A smooth join may run along the face of a cell.
        let around = Bounds::new(cell.lo() - 0.3 * cell.size(), cell.hi() + 0.4 * cell.size());
        // Skips a cell if the corners of the box around it all have the same patch.
        let [one, others @ ..] = around.corners().map(|corner| probe.field.label(corner));
        if others.iter().all(|&other| other == one) {
            return None;
        }
        for start in around.spread(3) {
            if ends.iter().all(Option::is_some) {
                break;
            }
            let Some(place) = landed(probe, start, reach) else { continue };
            if let Some(k) = pair.iter().position(|&patch| patch == place.patch) {
                ends[k].get_or_insert(place);
            }
        }
        let [Some(first), Some(second)] = ends else { return None };
        let way = second.position - first.position;
        let position =
            turn(pair, |share| landed(probe, first.position + way * share, (0.5 * reach).max(way.length())))?;
        let [u, v] = pair.map(|patch| normal(probe, patch, position));
        if Meet::of_gradients([u, v]) != Some(Meet::Tangent) {
            return None;
        }
        let found = changes_around(probe, pair, position, u, AROUND * reach)?;
        // Counter-clockwise, the change from the first patch to the second lies in the direction
        // that has the first one on its right.
        let [Some(behind), Some(ahead)] = found else { return None };
        let tangent = (ahead - behind).normalize_or_zero();
        Some(Self { position, branches: pair, tangent, sine: 0.0 })
    }

    /// The next point of a smooth join that has a kink here, `length` away, with these patches on
    /// its left and right.
    pub(super) fn around_kink(&self, probe: &mut Probe, sides: [u32; 2], length: f64) -> Option<Self> {
        let up = normal(probe, sides[0], self.position);
        let [right, left] = [sides[1], sides[0]];
        // Counter-clockwise, the right side gives way to the left one ahead.
        let [position, _] = changes_around(probe, [right, left], self.position, up, length)?;
        self.moved(position?, length)
    }

    /// The next point of a smooth join, `length` away, with these patches on its left and right.
    pub(super) fn along_smooth_join(
        &self,
        probe: &mut Probe,
        sides: [u32; 2],
        direction: DVec3,
        length: f64,
    ) -> Option<Self> {
        let up = normal(probe, sides[0], self.position);
        let ahead = (direction - up * direction.dot(up)).normalize_or_zero();
        let aside = up.cross(ahead);
        // From 60° to the left to 60° to the right.
        let position = turn(sides, |share| {
            let slope = SQRT_3 * (1.0 - 2.0 * share);
            landed(probe, self.position + (ahead + aside * slope).normalize_or_zero() * length, length)
        })?;
        self.moved(position, length).filter(|next| next.tangent.dot(ahead) >= MOST_TURN)
    }

    /// The smooth join at a point to which a step of this length has led. None if the point is less
    /// than half of that away: a step that is projected back to its start would be repeated.
    fn moved(&self, position: DVec3, length: f64) -> Option<Self> {
        let way = position - self.position;
        (way.length() >= 0.5 * length).then(|| Self { position, tangent: way.normalize_or_zero(), ..*self })
    }

    /// The point of the smooth join near the point `place` of a chord with the direction `way`.
    pub(super) fn beside_chord(probe: &mut Probe, pair: [u32; 2], place: DVec3, way: DVec3) -> Option<DVec3> {
        let reach = way.length();
        let first = landed(probe, place, reach)?;
        let up = normal(probe, first.patch, first.position);
        let aside = up.cross(way) * BESIDE_CHORD;
        let mut across = |pair: [u32; 2], aside: DVec3| {
            turn(pair, |share| landed(probe, place + aside * (1.0 - 2.0 * share), reach))
        };
        across(pair, aside).or_else(|| across(pair, -aside)).or(Some(first.position))
    }
}

/// The point of a patch in the plane across an axis at `offset`, near `start`.
pub(super) fn in_plane(
    probe: &mut Probe,
    patch: u32,
    axis: usize,
    offset: f64,
    start: DVec3,
    reach: f64,
) -> Option<DVec3> {
    let step_at = |p: DVec3| {
        let (step, _) = step_to_curve([branch(probe, patch, p), (p[axis] - offset, DVec3::AXES[axis])]);
        Some((step, ()))
    };
    newton::land(start, limits(reach), step_at).map(|(p, ())| p)
}
