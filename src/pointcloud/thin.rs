//! Reduction of millions of points to a few hundred that are far from each other: merging, thinning on a grid, and
//! farthest-point sampling.

use super::{Cloud, CloudError};
use crate::math::{IndexTable, Sym3, hash};
use glam::DVec3;

/// Maximum number of points that thinning keeps. Normals are estimated for these points, and the centres are chosen
/// among them. The spacing of twenty thousand is about a hundredth of the model's size, a tenth of that of 200 centres.
pub const KEPT: usize = 20_000;

/// Minimum distance of two centres, as a share of the diagonal of the points' box. The system for a few hundred centres
/// loses a digit each time that the distance between two of them is halved.
const MIN_DISTANCE_SHARE: f64 = 1e-4;

/// Largest standard deviation across a line or plane, as a share of that along it, at which points count as lying in
/// it. It is above the rounding of coordinates in single precision.
const FLAT_SHARE: f64 = 1e-5;

/// Points that a column has room for at first; it grows by half.
const FIRST_POINTS: usize = 1024;

/// Smallest and largest corner of the bounding box of `points`, which must not be empty.
pub(super) fn corners(points: &[DVec3]) -> (DVec3, DVec3) {
    points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
}

/// Index in `points` of the point equal to `p`, or `fresh` if there is none.
///
/// In the latter case `p` must be stored at `fresh` before the next call. `points` must be the same column in every call. Returns
/// `None` if there is not enough memory.
fn index_of(table: &mut IndexTable, p: DVec3, fresh: usize, points: &[DVec3]) -> Option<u32> {
    // Adding 0 maps −0 to +0, which it is equal to.
    table.find_or_add(hash(p.to_array().map(|c| (c + 0.0).to_bits())), fresh, |k| points[k] == p)
}

/// Index in `points` of the point equal to `p`, which is appended if there is none; see [`index_of`].
pub(super) fn find_or_add(table: &mut IndexTable, p: DVec3, points: &mut Vec<DVec3>) -> Option<u32> {
    if points.len() == points.capacity() {
        points.try_reserve_exact((points.len() / 2).max(FIRST_POINTS)).ok()?;
    }
    let index = index_of(table, p, points.len(), points)?;
    if index as usize == points.len() {
        points.push(p);
    }
    Some(index)
}

/// Merges coincident points and adds their normals. A file has a point several times where faces with different
/// attributes meet.
#[derive(Debug)]
pub struct Merger {
    /// The distinct points in `0..kept`, and those still to be looked at from `next` on.
    cloud: Cloud,
    kept: usize,
    next: usize,
    table: IndexTable,
}

impl Merger {
    /// Begins to merge the points of `cloud`.
    #[must_use]
    pub fn new(cloud: Cloud) -> Self {
        Self { cloud, kept: 0, next: 0, table: IndexTable::default() }
    }

    /// Looks at up to `budget` more points. Returns whether all points are done.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub fn step(&mut self, budget: u32) -> Result<bool, CloudError> {
        let Cloud { position, normal, .. } = &mut self.cloud;
        let end = position.len().min(self.next + budget as usize);
        for i in self.next..end {
            let p = position[i];
            let at = index_of(&mut self.table, p, self.kept, position).ok_or(CloudError::Memory)? as usize;
            let fresh = at == self.kept;
            if fresh {
                position[at] = p;
                self.kept += 1;
            }
            match normal.get(i).copied() {
                Some(n) if fresh => normal[at] = n,
                Some(n) => normal[at] += n,
                None => {}
            }
        }
        self.next = end;
        Ok(end == position.len())
    }

    /// Fraction of the points that are done.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.next as f64 / self.cloud.len().max(1) as f64
    }

    /// Distinct points, and the number of points that merging removed. Points whose normals cancel are left out.
    #[must_use]
    pub fn finish(mut self) -> (Cloud, usize) {
        let joined = self.cloud.len() - self.kept;
        let Cloud { position, normal, .. } = &mut self.cloud;
        position.truncate(self.kept);
        normal.truncate(self.kept);
        if joined > 0 && !normal.is_empty() {
            for normal in normal.iter_mut() {
                *normal = normal.normalize_or_zero();
            }
            let mut stays = normal.iter().map(|normal| *normal != DVec3::ZERO);
            position.retain(|_| stays.next().unwrap_or(false));
            normal.retain(|normal| *normal != DVec3::ZERO);
        }
        (self.cloud, joined)
    }
}

/// Keeps at most [`KEPT`] points: the first one in each cell of a grid. The grid is the finest one, up to a factor,
/// that keeps no more.
#[derive(Debug)]
pub struct Thinner {
    cloud: Cloud,
    lo: DVec3,
    side: f64,
    next: usize,
    table: IndexTable,
    /// Cells of the current grid that hold a point.
    cells: Vec<DVec3>,
    /// First point in each of these cells.
    kept: Vec<u32>,
    /// Points kept by the finest grid so far that was coarse enough.
    best: Vec<u32>,
    /// Whether a grid was too fine.
    met_limit: bool,
    /// Number of grids tried.
    passes: u32,
}

/// Ratio of the cell sizes of a grid and the previous one, if that was too coarse.
const FINER: f64 = 0.5;
/// Ratio of the cell sizes of a grid and the previous one, if that was too fine.
const COARSER: f64 = 1.2;
/// Share of [`KEPT`] below which a finer grid is tried.
const ENOUGH: f64 = 0.3;
/// Maximum number of grids. After so many halvings, a cell is smaller than the resolution of single precision.
const MAX_PASSES: u32 = 24;
/// Estimated number of cells that a surface meets, times the ratio of a cell's face to the squared diagonal of the box.
/// It serves for the first guess of the cell size only.
///
/// It is the product of 1.5, the mean number of cells that a plane meets per face area, and 0.9, a typical ratio of the
/// area of a surface to the squared diagonal of its box (1.05 for a sphere).
const CELLS_PER_SQUARE: f64 = 1.35;

impl Thinner {
    /// Begins to thin out `cloud`.
    #[must_use]
    pub fn new(cloud: Cloud) -> Self {
        let (lo, hi) = corners(&cloud.position);
        let side = (hi - lo).length() * (CELLS_PER_SQUARE / KEPT as f64).sqrt();
        let few = cloud.len() <= KEPT;
        Self {
            best: if few { (0..cloud.len() as u32).collect() } else { Vec::new() },
            cloud,
            lo,
            side,
            next: 0,
            table: IndexTable::default(),
            cells: Vec::new(),
            kept: Vec::new(),
            met_limit: false,
            passes: if few { MAX_PASSES } else { 0 },
        }
    }

    /// Looks at up to `budget` more points. Returns whether the grid is found.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub fn step(&mut self, budget: u32) -> Result<bool, CloudError> {
        for _ in 0..budget {
            if self.passes >= MAX_PASSES {
                return Ok(true);
            }
            match self.cloud.position.get(self.next) {
                Some(&p) if self.cells.len() <= KEPT => {
                    let cell = ((p - self.lo) / self.side).floor();
                    let known = self.cells.len();
                    find_or_add(&mut self.table, cell, &mut self.cells).ok_or(CloudError::Memory)?;
                    if self.cells.len() > known {
                        self.kept.push(self.next as u32);
                    }
                    self.next += 1;
                }
                _ => self.end_pass(),
            }
        }
        Ok(self.passes >= MAX_PASSES)
    }

    /// Evaluates the current grid and begins the next one.
    fn end_pass(&mut self) {
        self.passes += 1;
        let fits = self.cells.len() <= KEPT;
        if fits {
            core::mem::swap(&mut self.best, &mut self.kept);
        }
        let enough = self.best.len() as f64 >= ENOUGH * KEPT as f64;
        self.met_limit |= !fits;
        if fits && (enough || self.met_limit) || !fits && !self.best.is_empty() {
            self.passes = MAX_PASSES;
        }
        self.side *= if fits { FINER } else { COARSER };
        self.next = 0;
        self.cells.clear();
        self.kept.clear();
        self.table = IndexTable::default();
    }

    /// The kept points, in the order of the file.
    #[must_use]
    pub fn finish(self) -> Cloud {
        self.cloud.only(&self.best)
    }
}

/// Checks that points are not degenerate.
///
/// # Errors
///
/// If the points coincide, lie on a line or lie in a plane.
pub fn check_spread(points: &[DVec3]) -> Result<(), CloudError> {
    let (lo, hi) = corners(points);
    let (middle, diagonal) = ((lo + hi) / 2.0, (hi - lo).length());
    // For a single point at the origin, both sides of the comparison are 0.
    if points.len() < 2
        || diagonal <= MIN_DISTANCE_SHARE * MIN_DISTANCE_SHARE * lo.abs().max(hi.abs()).max_element()
    {
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
    Sym3 {
        xx: sum.xx * share,
        xy: sum.xy * share,
        xz: sum.xz * share,
        yy: sum.yy * share,
        yz: sum.yz * share,
        zz: sum.zz * share,
    }
}

/// Farthest-point sampling: each chosen point is the one farthest from all those chosen before (T. F. Gonzalez,
/// "Clustering to Minimize the Maximum Intercluster Distance", 1985).
///
/// The largest distance of a point from the chosen ones is at most twice that of any other choice of as many. The first
/// choice is the point farthest from the mean. Ties go to the smaller index.
#[derive(Debug)]
pub struct Spreader {
    /// Squared distance of each point from the nearest chosen one.
    distance_sq: Vec<f64>,
    chosen: Vec<u32>,
    wanted: usize,
    /// Squared minimum distance of two chosen points.
    min_distance_sq: f64,
}

impl Spreader {
    /// Begins to choose `wanted` of `points`, which must not be empty.
    #[must_use]
    pub fn new(points: &[DVec3], wanted: usize) -> Self {
        let (lo, hi) = corners(points);
        // The sum is relative to a corner, so that it keeps its digits far from the origin.
        let mean = lo + points.iter().map(|p| *p - lo).sum::<DVec3>() / points.len() as f64;
        Self {
            distance_sq: points.iter().map(|p| p.distance_squared(mean)).collect(),
            chosen: Vec::new(),
            wanted,
            min_distance_sq: MIN_DISTANCE_SHARE * MIN_DISTANCE_SHARE * hi.distance_squared(lo),
        }
    }

    /// Chooses one more of `points`, the same in every call. Returns whether the choice is complete: enough points are
    /// chosen, or no other point is at a sufficient distance.
    pub fn step(&mut self, points: &[DVec3]) -> bool {
        if self.chosen.len() >= self.wanted.min(points.len()) {
            return true;
        }
        let mut farthest = 0;
        for (i, distance_sq) in self.distance_sq.iter().enumerate() {
            if *distance_sq > self.distance_sq[farthest] {
                farthest = i;
            }
        }
        if !self.chosen.is_empty() && self.distance_sq[farthest] <= self.min_distance_sq {
            return true;
        }
        let centre = points[farthest];
        if self.chosen.is_empty() {
            self.distance_sq.fill(f64::INFINITY);
        }
        self.chosen.push(farthest as u32);
        for (distance_sq, p) in self.distance_sq.iter_mut().zip(points) {
            *distance_sq = distance_sq.min(p.distance_squared(centre));
        }
        self.chosen.len() >= self.wanted.min(points.len())
    }

    /// Fraction of the points that are chosen.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.chosen.len() as f64 / self.wanted.min(self.distance_sq.len()).max(1) as f64
    }

    /// Indices of the chosen points, in order of choice.
    #[must_use]
    pub fn chosen(&self) -> &[u32] {
        &self.chosen
    }
}
