//! Finds where the surface of a function continues beyond the points that it was fitted to.
//!
//! A point of the surface is beyond the given points if its distance from all of them exceeds a
//! reach: a few times their spacing, but at least their distance from the function's centres,
//! between which it is free. The balls of the [`Border`] surround such places.

use crate::field::rbf::{Ball, Border, RbfField};
use crate::field::{Field, Frame};
use crate::math::{Bounds, sort_by_key, unkey};
use crate::slices::{HEAVY, MEDIUM, pause};
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// Reach, in spacings of the points. Larger: wider holes are bridged, and so are wider bays.
const REACH: f64 = 4.0;
/// Number of neighbours from which the spacing is measured. The disc that reaches the last of them
/// has the area of as many squares, each one spacing wide.
const NEIGHBOURS: usize = 8;
/// Radius of the largest balls, in reaches. Larger: a ball on one sheet comes near another sheet.
const LARGEST: f64 = 1.25;
/// Spacing of balls that reach the points, in reaches. Smaller: a smoother rim from more balls.
const SPACING: f64 = 1.0 / 6.0;
/// Spacing of balls farther out, in reaches; they only have to overlap.
const FAR_SPACING: f64 = 0.6;
/// Margin around the points that is searched, in the largest reaches. Balls begin one reach away,
/// and a few rows are enough.
const ROOM: f64 = 1.5;
/// Width of the smallest search cells, in the smallest reaches.
const CELL: f64 = 0.25;
/// A surface may pass through a cell up to this multiple of the distance from its middle to a
/// corner.
const SLACK: f64 = 1.5;
/// Most cells that are divided further: half a second of work.
const MOST_CELLS: usize = 200_000;
/// Steps in which the middle of a cell is moved to the surface.
const STEPS: usize = 5;
/// A point counts as on the surface within this distance from it, in widths of a cell.
const ON_SURFACE: f64 = 1e-3;

/// Points, with a search for the nearest one.
struct Points<'a> {
    position: &'a [DVec3],
    tree: Tree,
    middle: DVec3,
    /// At each point, the distance from all points beyond which a surface is cut.
    reach: Vec<f64>,
}

impl<'a> Points<'a> {
    async fn new(position: &'a [DVec3], centres: &[DVec3], bounds: &Bounds) -> Self {
        let middle = bounds.middle();
        let local = |points: &[DVec3]| points.iter().map(|p| (*p - middle).as_vec3()).collect::<Vec<_>>();
        let single = local(position);
        let (tree, of_centres) = (Tree::new(&single), Tree::new(&local(centres)));
        let (mut reach, mut nearest) = (Vec::with_capacity(position.len()), Vec::new());
        let mut from_centres = 0.0_f32;
        for points in single.chunks(HEAVY) {
            for &p in points {
                tree.nearest_many(p, NEIGHBOURS + 1, |_| true, &mut nearest);
                let farthest = nearest.last().map_or(0.0, |&key| f64::from(unkey(key).0));
                reach.push(REACH * (core::f64::consts::PI * farthest / NEIGHBOURS as f64).sqrt());
                from_centres = from_centres.max(of_centres.nearest_sq(p, u32::MAX, f32::INFINITY));
            }
            pause().await;
        }
        for reach in &mut reach {
            *reach = reach.max(f64::from(from_centres).sqrt());
        }
        Self { position, tree, middle, reach }
    }

    /// The distance from `p` to the nearest point, and the reach there.
    fn nearest(&self, p: DVec3) -> (f64, f64) {
        let (_, at) = self.tree.nearest((p - self.middle).as_vec3(), u32::MAX, f32::INFINITY);
        let index = self.tree.origin.get(at as usize).map_or(0, |&index| index as usize);
        (p.distance(self.position[index]), self.reach[index])
    }
}

/// The border of points, and the share of the surface in a box that lies beyond it; none if the
/// share is 0. The surface belongs to a function with these centres.
pub(super) async fn find(
    field: &RbfField,
    points: &[DVec3],
    centres: &[DVec3],
    bounds: &Bounds,
) -> Option<(Border, f64)> {
    let points = Points::new(points, centres, bounds).await;
    let reaches = || points.reach.iter().copied();
    let (least, largest) = (reaches().fold(f64::INFINITY, f64::min), reaches().fold(0.0, f64::max));
    let room = (ROOM * largest).min(0.5 * bounds.diagonal());
    let around = Bounds::around(points.position.iter().copied()).enlarged(room).joined(bounds);
    let places = places(field, &around, CELL * least).await;
    let mut beyond = Vec::new();
    for places in places.chunks(HEAVY) {
        pause().await;
        for &p in places {
            let (distance, reach) = points.nearest(p);
            if distance >= reach {
                beyond.push((Ball { centre: p, radius: distance.min(LARGEST * reach) }, reach));
            }
        }
    }
    let border = Border::new(spread(beyond).await, around)?;
    let (mut inside, mut all) = (0_usize, 0_usize);
    for places in places.chunks(HEAVY) {
        pause().await;
        for &p in places.iter().filter(|&&p| bounds.holds(p)) {
            all += 1;
            inside += usize::from(border.value(p) <= 0.0);
        }
    }
    let share = (all - inside) as f64 / all.max(1) as f64;
    (share > 0.0).then_some((border, share))
}

/// Points on a surface in a box, about one in each cell of this width that it passes through.
async fn places(field: &RbfField, bounds: &Bounds, width: f64) -> Vec<DVec3> {
    let mut evaluator = field.evaluator(Frame::around(bounds.middle()));
    let mut cells = vec![bounds.relative_to(bounds.middle())];
    let (mut points, mut value, mut gradient) = (Vec::new(), Vec::new(), Vec::new());
    let first = bounds.size().max_element() / 16.0;
    loop {
        let widest = cells.iter().map(|cell| cell.size().max_element()).fold(0.0, f64::max);
        if widest <= first {
            let mut kept = Vec::new();
            for cells in cells.chunks(HEAVY) {
                points.clear();
                points.extend(cells.iter().map(|cell| cell.middle().as_vec3()));
                value.resize(points.len(), 0.0);
                gradient.resize(points.len(), Vec3::ZERO);
                evaluator.gradients(&points, &mut value, &mut gradient);
                let slopes = value.iter().zip(&gradient);
                kept.extend(cells.iter().zip(slopes).filter_map(|(cell, (value, gradient))| {
                    let reach = 0.5 * SLACK * cell.diagonal();
                    (f64::from(value.abs()) <= reach * f64::from(gradient.length())).then_some(*cell)
                }));
                pause().await;
            }
            cells = kept;
            if widest <= width || cells.len() > MOST_CELLS {
                break;
            }
        }
        cells = cells.iter().flat_map(Bounds::halves).collect();
    }
    let mut found = Vec::new();
    for cells in cells.chunks(HEAVY) {
        points.clear();
        points.extend(cells.iter().map(|cell| cell.middle().as_vec3()));
        value.resize(points.len(), 0.0);
        gradient.resize(points.len(), Vec3::ZERO);
        for _ in 0..STEPS {
            evaluator.gradients(&points, &mut value, &mut gradient);
            for ((p, value), gradient) in points.iter_mut().zip(&value).zip(&gradient) {
                *p -= *gradient * (value / gradient.length_squared());
            }
        }
        evaluator.gradients(&points, &mut value, &mut gradient);
        for (k, (cell, &p)) in cells.iter().zip(&points).enumerate() {
            let width = cell.size().max_element();
            let is_on = f64::from(value[k].abs()) <= ON_SURFACE * width * f64::from(gradient[k].length());
            let half = 0.5 * cell.size();
            // One in each cell that the surface passes through, so that numbers of points are in
            // proportion to areas.
            if is_on && (p.as_dvec3() - cell.middle()).abs().cmple(half).all() {
                found.push(bounds.middle() + p.as_dvec3());
            }
        }
        pause().await;
    }
    found
}

/// Keeps balls that are spread out, beginning with those nearest to the points.
async fn spread(mut balls: Vec<(Ball, f64)>) -> Vec<Ball> {
    // Balls with a smaller radius relative to their reach are nearer to the points.
    sort_by_key(&mut balls, |(ball, reach)| (ball.radius / reach).to_bits());
    let largest = balls.iter().map(|(_, reach)| FAR_SPACING * reach).fold(0.0, f64::max);
    let lo = Bounds::around(balls.iter().map(|(ball, _)| ball.centre)).lo();
    let cell_of = |p: DVec3| ((p - lo) / largest).floor().to_array().map(|x| x as i64);
    let mut kept: Vec<Ball> = Vec::new();
    let mut in_cell: BTreeMap<[i64; 3], Vec<u32>> = Default::default();
    for balls in balls.chunks(MEDIUM) {
        pause().await;
        for &(ball, reach) in balls {
            let spacing = if ball.radius < LARGEST * reach { SPACING } else { FAR_SPACING } * reach;
            let [x, y, z] = cell_of(ball.centre);
            let beside = |k: i64| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1];
            let is_near =
                |&other: &u32| kept[other as usize].centre.distance_squared(ball.centre) < spacing * spacing;
            let near = (0..27).filter_map(|k| in_cell.get(&beside(k)));
            if !near.flatten().any(is_near) {
                in_cell.entry([x, y, z]).or_default().push(kept.len() as u32);
                kept.push(ball);
            }
        }
    }
    kept
}
