//! Walks on the surface, from the places where a grid shows it to reach farthest to the ends of
//! parts that are thinner than its cells: spikes and arms.
//!
//! A walk climbs along one direction of an axis. It takes steps in the tangent plane and returns to
//! the surface by Newton's method, until the surface reaches no farther along its direction. If it
//! has left the box of the grid, walks along the other directions start at its end, as an arm may
//! bend.

use super::HALVES;
use super::grid::{CELLS, Change, Changes, NODES};
use crate::field::descent::{Descent, descend};
use crate::field::{BATCH, Evaluator};
use crate::math::{Bounds, newton};
use crate::slices::pause;
use glam::Vec3;

/// Largest number of steps of a walk. One along a straight spike takes some ten; more follow longer
/// arms that wind.
const STEPS: u32 = 400;
/// A walk ends if a step leads less far along its direction than this share of the longest side of
/// the box: a fiftieth of the room around it.
const LEAST_GAIN: f32 = 1e-3;
/// Share of the expected gain that a step must have. A smaller gain means that it has left the part
/// of the surface that it follows.
const FAITHFUL: f32 = 0.5;
/// Largest distance from the surface, in roundings of the largest coordinate.
const ROUNDINGS: f32 = 8.0;
/// Number of times that walks may start from the ends of others.
const BENDS: u32 = 16;

/// Where the walks have led.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Walked {
    /// They stay in the box.
    Inside,
    /// To places beyond the box; this box holds them.
    To(Bounds),
    /// Out of the largest cube, or farther than they could be followed.
    Away,
}

/// A point that moves along the surface.
#[derive(Clone, Copy)]
struct Walk {
    place: Vec3,
    normal: Vec3,
    /// The unit vector along which it climbs.
    way: Vec3,
    /// Length of the next step.
    length: f32,
}

impl Walk {
    /// The next step, in the tangent plane.
    fn step(&self) -> Vec3 {
        let along = self.way - self.normal * self.way.dot(self.normal);
        along.normalize_or_zero() * self.length
    }

    /// How far along its way the next step leads.
    fn gain(&self) -> f32 {
        self.step().dot(self.way)
    }
}

/// The unit vectors along the axes, both ways.
fn ways() -> impl Iterator<Item = Vec3> {
    Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis])
}

/// Walks from the changes of sign of a grid to the farthest places of the surface. `within` is the
/// box known to hold what the grid shows.
pub(super) async fn walk(field: &mut dyn Evaluator, found: &Changes, within: &Bounds) -> Walked {
    let length = found.step.max_element() as f32;
    let mut walks: Vec<Walk> = ways()
        .flat_map(|way| {
            let starts = farthest(&found.list, way);
            starts.into_iter().map(move |place| Walk { place, normal: Vec3::ZERO, way, length })
        })
        .collect();
    let mut reached: Option<Bounds> = None;
    for _ in 0..BENDS {
        let before = reached.map_or(*within, |reached| reached.joined(within));
        let mut ends = Vec::new();
        for walks in walks.chunks(BATCH) {
            let Some(found) = climb(field, walks, within).await else { return Walked::Away };
            ends.extend(found);
        }
        walks.clear();
        // Those that have led farthest continue.
        for way in ways() {
            let along = |place: &Vec3| place.dot(way);
            let Some(&place) = ends.iter().max_by(|a, b| along(a).total_cmp(&along(b))) else { continue };
            if before.holds(place.as_dvec3()) {
                continue;
            }
            let end = Bounds::point(place.as_dvec3());
            reached = Some(reached.map_or(end, |reached| reached.joined(&end)));
            let others = ways().filter(|other| *other != way);
            walks.extend(others.map(|way| Walk { place, normal: Vec3::ZERO, way, length }));
        }
        if walks.is_empty() {
            return reached.map_or(Walked::Inside, Walked::To);
        }
    }
    Walked::Away
}

/// The places of those changes of sign that have none next to them farther along this way. Of
/// several equally far ones, one is taken.
fn farthest(list: &[Change], way: Vec3) -> Vec<Vec3> {
    let axis = way.abs().max_position();
    // Its number along the way comes first.
    let own = |change: &Change| {
        let at = |k: usize| change.node[(axis + k) % 3];
        [if way[axis] > 0.0 { at(0) } else { CELLS - at(0) }, at(1), at(2)]
    };
    let number = |[i, j, k]: [usize; 3]| (i * NODES + j) * NODES + k;
    let mut places = vec![None; NODES * NODES * NODES];
    for change in list {
        places[number(own(change))].get_or_insert(change.place());
    }
    let is_beyond = |[i, j, k]: [usize; 3]| {
        let around = |at: usize| at.saturating_sub(1)..(at + 2).min(NODES);
        let beyond = |i: usize| around(j).flat_map(move |j| around(k).map(move |k| [i, j, k]));
        let near = around(i).flat_map(beyond).filter(|other| *other > [i, j, k]);
        near.map(number).any(|other| places[other].is_some())
    };
    let all = (0..places.len()).rev().map(|n| [n / NODES / NODES, n / NODES % NODES, n % NODES]);
    let last = all.filter_map(|at| places[number(at)].map(|place| (at, place)));
    last.filter(|(at, _)| !is_beyond(*at)).map(|(_, place)| place).take(BATCH).collect()
}

/// Takes walks to their ends; none if one leaves the largest cube, or is outside the box after
/// [`STEPS`] steps.
async fn climb(field: &mut dyn Evaluator, walks: &[Walk], within: &Bounds) -> Option<Vec<Vec3>> {
    let least = LEAST_GAIN * within.size().max_element() as f32;
    let mut under_way = Vec::new();
    for (walk, landed) in walks.iter().zip(land(field, walks, |walk| walk.place)) {
        under_way.extend(landed.map(|(place, normal)| Walk { place, normal, ..*walk }));
    }
    let mut ends = Vec::new();
    for _ in 0..STEPS {
        pause().await;
        under_way.retain(|walk| {
            // Written so that NaN ends it.
            let goes_on = walk.gain() > least;
            if !goes_on {
                ends.push(walk.place);
            }
            goes_on
        });
        if under_way.is_empty() {
            return Some(ends);
        }
        let landed = land(field, &under_way, |walk| walk.place + walk.step());
        for (walk, landed) in under_way.iter_mut().zip(landed) {
            let is_farther =
                |(place, _): &(Vec3, Vec3)| (place - walk.place).dot(walk.way) >= FAITHFUL * walk.gain();
            match landed.filter(is_farther) {
                Some((place, normal)) => {
                    *walk = Walk { place, normal, length: 2.0 * walk.length, ..*walk };
                }
                None => walk.length *= 0.5,
            }
            if !Bounds::cube(HALVES[0]).contains(walk.place) {
                return None;
            }
        }
    }
    let is_inside = under_way.iter().all(|walk| within.contains(walk.place));
    is_inside.then_some(ends)
}

/// For each walk, the point of the surface to which Newton's method leads from a place, within the
/// length of its step, and its unit normal.
fn land(
    field: &mut dyn Evaluator,
    walks: &[Walk],
    place: impl Fn(&Walk) -> Vec3,
) -> Vec<Option<(Vec3, Vec3)>> {
    let mut places: Vec<Vec3> = walks.iter().map(place).collect();
    let mut normals = vec![Vec3::ZERO; walks.len()];
    let (mut is_on, mut limits) = ([false; BATCH], [Descent::default(); BATCH]);
    for ((limits, place), walk) in limits.iter_mut().zip(&places).zip(walks) {
        let residual = ROUNDINGS * f32::EPSILON * place.abs().max_element();
        *limits = Descent { residual, reach: walk.length, trust: 0.0 };
    }
    descend(field, &mut places, &mut normals, &mut is_on, 0.0, &mut limits, newton::STEPS);
    places.into_iter().zip(normals).zip(is_on).map(|(landed, is_on)| is_on.then_some(landed)).collect()
}
