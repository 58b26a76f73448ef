//! Reduces millions of points to a few hundred that are far apart: merging, thinning on a grid, and
//! farthest-point sampling.

use super::{Cloud, CloudError};
use crate::math::{Bounds, IndexTable, Sym3, hash};
use crate::slices::{MEDIUM, pause, ranges};
use glam::DVec3;

/// Most points that thinning keeps. Normals are estimated for these points, and the centres are
/// chosen among them. The spacing of twenty thousand points is about a hundredth of the model's
/// size, a tenth of the spacing of 200 centres.
pub const KEPT: usize = 20_000;

/// Least distance of two centres, as a share of the diagonal of the points' box. The system for a
/// few hundred centres loses a digit each time the least distance is halved.
const MIN_DISTANCE_SHARE: f64 = 1e-4;

/// Points count as collinear or coplanar if their standard deviation across the line or plane is at
/// most this share of that along it. It is above the rounding of coordinates in single precision,
/// 6·10⁻⁸ of the largest.
const FLAT_SHARE: f64 = 1e-5;

/// Index in `points` of the point equal to `p`, or `fresh` if there is none.
///
/// In the latter case `p` must be stored at `fresh` before the next call. `points` must be the same
/// column in every call. Returns `None` if there is not enough memory.
fn index_of(table: &mut IndexTable, p: DVec3, fresh: usize, points: &[DVec3]) -> Option<u32> {
    // Adding 0 maps −0 to +0, so that both have the same hash.
    table.find_or_add(hash(p.to_array().map(|c| (c + 0.0).to_bits())), fresh, |k| points[k] == p)
}

/// Appends to a column, whose capacity grows by half; `None` if there is not enough memory, where
/// [`Vec::push`] would abort.
pub(super) fn push<T>(column: &mut Vec<T>, item: T) -> Option<()> {
    /// Initial capacity: 24 kB of positions, from which growth by half reaches the points of a file
    /// of 50 MB in some twenty steps.
    const FIRST: usize = 1024;
    if column.len() == column.capacity() {
        column.try_reserve_exact((column.len() / 2).max(FIRST)).ok()?;
    }
    column.push(item);
    Some(())
}

/// Index in `points` of the point equal to `p`, which is appended if missing; see [`index_of`].
pub(super) fn find_or_add(table: &mut IndexTable, p: DVec3, points: &mut Vec<DVec3>) -> Option<u32> {
    let index = index_of(table, p, points.len(), points)?;
    if index as usize == points.len() {
        push(points, p)?;
    }
    Some(index)
}

/// Merges coincident points and adds their normals; a file repeats a point where faces with
/// different attributes meet. Points whose normals cancel are removed. `tell` gets the completed
/// fraction of the points.
///
/// # Errors
///
/// If there is not enough memory.
pub async fn merge(mut cloud: Cloud, tell: impl Fn(f64)) -> Result<Cloud, CloudError> {
    let Cloud { position, normal, .. } = &mut cloud;
    let (count, mut kept) = (position.len(), 0);
    let mut table = IndexTable::default();
    for range in ranges(count, MEDIUM) {
        tell(range.start as f64 / count as f64);
        for i in range {
            let p = position[i];
            let at = index_of(&mut table, p, kept, position).ok_or(CloudError::Memory)? as usize;
            let fresh = at == kept;
            if fresh {
                position[at] = p;
                kept += 1;
            }
            match normal.get(i).copied() {
                Some(n) if fresh => normal[at] = n,
                Some(n) => normal[at] += n,
                None => {}
            }
        }
        pause().await;
    }
    position.truncate(kept);
    normal.truncate(kept);
    if kept < count && !normal.is_empty() {
        for normal in normal.iter_mut() {
            *normal = normal.normalize_or_zero();
        }
        cloud.retain_with_normal();
    }
    Ok(cloud)
}

/// Factor for the cell size if a grid was too coarse: a surface then meets four times as many
/// cells.
const FINER: f64 = 0.5;
/// Factor for the cell size if a grid was too fine: a surface then meets 1.44 times fewer cells.
const COARSER: f64 = 1.2;
/// A finer grid is tried if fewer than this share of [`KEPT`] points are kept: a quarter plus a
/// margin, since the finer grid has four times as many cells.
const ENOUGH: f64 = 0.3;
/// Most grids. After so many halvings, a cell is smaller than the resolution of single precision.
const MAX_PASSES: u32 = 24;
/// Estimated number of cells that a surface meets, times a cell's face area divided by the squared
/// diagonal of the box. It is used only for the first guess of the cell size.
///
/// It is the product of 1.5, the mean number of cells that a plane meets per face area, and 0.9, a
/// typical ratio of the area of a surface to the squared diagonal of its box (1.05 for a sphere).
const CELLS_PER_SQUARE: f64 = 1.35;

/// Keeps at most [`KEPT`] points, in the order of the file: the first one in each cell of a grid.
/// The grid is nearly the finest one that keeps no more than that.
///
/// # Errors
///
/// If there is not enough memory.
pub async fn thin(cloud: Cloud) -> Result<Cloud, CloudError> {
    if cloud.len() <= KEPT {
        return Ok(cloud);
    }
    let bounds = Bounds::around(cloud.position.iter().copied());
    let mut side = bounds.diagonal() * (CELLS_PER_SQUARE / KEPT as f64).sqrt();
    let mut best = Vec::new();
    let mut was_too_fine = false;
    for _ in 0..MAX_PASSES {
        let kept = first_in_cells(&cloud.position, bounds.lo(), side).await?;
        if kept.len() <= KEPT {
            best = kept;
            if was_too_fine || best.len() as f64 >= ENOUGH * KEPT as f64 {
                break;
            }
            side *= FINER;
        } else if best.is_empty() {
            was_too_fine = true;
            side *= COARSER;
        } else {
            break;
        }
    }
    Ok(cloud.only(&best))
}

/// Indices of the first point in each cell of a grid of cubes with a corner at `lo`. Stops once it
/// has more than [`KEPT`].
async fn first_in_cells(points: &[DVec3], lo: DVec3, side: f64) -> Result<Vec<u32>, CloudError> {
    let (mut table, mut cells, mut first) = (IndexTable::default(), Vec::new(), Vec::new());
    for range in ranges(points.len(), MEDIUM) {
        for i in range {
            if first.len() > KEPT {
                return Ok(first);
            }
            let cell = ((points[i] - lo) / side).floor();
            find_or_add(&mut table, cell, &mut cells).ok_or(CloudError::Memory)?;
            if cells.len() > first.len() {
                first.push(i as u32);
            }
        }
        pause().await;
    }
    Ok(first)
}

/// Checks that points are not degenerate.
///
/// # Errors
///
/// If the points coincide, lie on a line or lie in a plane.
pub fn check_spread(points: &[DVec3]) -> Result<(), CloudError> {
    let bounds = Bounds::around(points.iter().copied());
    let (middle, diagonal) = (bounds.middle(), bounds.diagonal());
    // For a single point at the origin, both sides of the comparison are 0.
    if points.len() < 2 || diagonal <= MIN_DISTANCE_SHARE * MIN_DISTANCE_SHARE * bounds.farthest() {
        return Err(CloudError::OnePlace);
    }
    let local = || points.iter().map(|p| (*p - middle) / diagonal);
    let mean = local().sum::<DVec3>() / points.len() as f64;
    let (variances, _) = super::eigen::symmetric(&covariance(local(), mean));
    let flat = |variance: f64| variance <= FLAT_SHARE * FLAT_SHARE * variances[2];
    match variances {
        [_, middle, _] if flat(middle) => Err(CloudError::Line),
        [smallest, ..] if flat(smallest) => Err(CloudError::Plane),
        _ => Ok(()),
    }
}

/// Covariance matrix of the points: the mean of (p − mean)(p − mean)ᵀ.
pub(super) fn covariance(points: impl Iterator<Item = DVec3>, mean: DVec3) -> Sym3<f64> {
    let mut sum = Sym3::<f64>::default();
    let mut count = 0.0_f64;
    for p in points {
        let d = p - mean;
        sum.xx += d.x * d.x;
        sum.xy += d.x * d.y;
        sum.xz += d.x * d.z;
        sum.yy += d.y * d.y;
        sum.yz += d.y * d.z;
        sum.zz += d.z * d.z;
        count += 1.0;
    }
    let share = 1.0 / count.max(1.0);
    sum.map(|entry| entry * share)
}

/// Farthest-point sampling: the indices of up to `wanted` of `points`, each the one farthest from
/// all those chosen before (T. F. Gonzalez, "Clustering to Minimize the Maximum Intercluster
/// Distance", 1985).
///
/// The first choice is the point farthest from the mean. The largest distance of a point from the
/// chosen ones is at most twice that of the best choice of as many. Ties go to the smaller index.
/// The result is shorter than wanted if no other point is far enough away. `tell` gets the fraction
/// of the points that are chosen.
pub async fn spread(points: &[DVec3], wanted: usize, tell: impl Fn(f64)) -> Vec<u32> {
    let bounds = Bounds::around(points.iter().copied());
    let lo = bounds.lo();
    // The sum is relative to a corner, so that no digits are lost far from the origin.
    let mean = lo + points.iter().map(|p| *p - lo).sum::<DVec3>() / points.len() as f64;
    let min_distance_sq = MIN_DISTANCE_SHARE * MIN_DISTANCE_SHARE * bounds.size().length_squared();
    // Squared distance of each point from the nearest chosen one, or at first from the mean.
    let mut distance_sq: Vec<f64> = points.iter().map(|p| p.distance_squared(mean)).collect();
    let wanted = wanted.min(points.len());
    let mut chosen: Vec<u32> = Vec::new();
    while chosen.len() < wanted {
        let mut farthest = 0;
        for (i, distance) in distance_sq.iter().enumerate() {
            if *distance > distance_sq[farthest] {
                farthest = i;
            }
        }
        if chosen.is_empty() {
            distance_sq.fill(f64::INFINITY);
        } else if distance_sq[farthest] <= min_distance_sq {
            break;
        }
        chosen.push(farthest as u32);
        for (distance_sq, p) in distance_sq.iter_mut().zip(points) {
            *distance_sq = distance_sq.min(p.distance_squared(points[farthest]));
        }
        tell(chosen.len() as f64 / wanted as f64);
        pause().await;
    }
    chosen
}
