//! From millions of points to a few hundred that are far from each other.

use super::table::Table;
use super::{Cloud, CloudError};
use crate::math::Sym3;
use glam::DVec3;

/// Points kept by the grid, from which the centres are then chosen and in which normals are estimated. Twenty thousand are
/// spaced at about a hundredth of the model's size, a tenth of the distance between 200 centres.
pub const KEPT: usize = 20_000;

/// Points nearer to each other than this share of the diagonal of their box are not both taken as centres: the system for a
/// few hundred centres loses a digit each time that the distance between two of them is halved.
const SAME_SHARE: f64 = 1e-4;

/// Standard deviation across a line or a plane, as a share of that along it, up to which points lie in it. The digits of
/// coordinates in single precision end below this.
const FLAT_SHARE: f64 = 1e-5;

/// Corners of the smallest box round the points; they must not be none.
pub(super) fn corners(points: &[DVec3]) -> (DVec3, DVec3) {
    points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)))
}

/// Joins points at the same place, whose normals are added: files have a point several times where faces meet that are drawn
/// differently.
#[derive(Debug)]
pub struct Merger {
    /// Each place once up to `kept`, and the points that are not looked at from `next` on.
    cloud: Cloud,
    kept: usize,
    next: usize,
    table: Table,
}

impl Merger {
    /// Begins with `cloud`.
    #[must_use]
    pub fn new(cloud: Cloud) -> Self {
        Self { cloud, kept: 0, next: 0, table: Table::default() }
    }

    /// Looks at up to `budget` more points; true when all are looked at.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub fn step(&mut self, budget: u32) -> Result<bool, CloudError> {
        let Cloud { position, normal, .. } = &mut self.cloud;
        let end = position.len().min(self.next + budget as usize);
        for i in self.next..end {
            let p = position[i];
            let at = self.table.index_of(p, self.kept, position).ok_or(CloudError::Memory)? as usize;
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

    /// Share of the points that are looked at.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.next as f64 / self.cloud.len().max(1) as f64
    }

    /// Each place once, and how many points that joined. Points whose normals cancel are left out.
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

/// Keeps at most [`KEPT`] points of many: the first one in each cell of a grid whose cells are as small as that allows.
#[derive(Debug)]
pub struct Thinner {
    cloud: Cloud,
    lo: DVec3,
    side: f64,
    next: usize,
    table: Table,
    cells: Vec<DVec3>,
    kept: Vec<u32>,
    /// What the finest grid so far that was coarse enough kept.
    best: Vec<u32>,
    /// Whether a grid was too fine already.
    met_limit: bool,
    passes: u32,
}

/// Factors between the sides of the cells of one grid and the next.
const FINER: f64 = 0.5;
const COARSER: f64 = 1.2;
/// A grid with fewer cells than this share of [`KEPT`] is tried finer.
const ENOUGH: f64 = 0.3;
/// Grids that are tried. Halved as often, the cells are smaller than the digits of single precision can tell apart.
const MOST_PASSES: u32 = 24;
/// Cells that a surface meets, per area of a cell's face and area of the surface, times its area over that of the diagonal
/// squared: 1.5 for a plane in any direction, and 0.9 for a sphere in its box. The first guess rests on it, nothing else.
const CELLS_PER_SQUARE: f64 = 1.35;

impl Thinner {
    /// Begins with `cloud`.
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
            table: Table::default(),
            cells: Vec::new(),
            kept: Vec::new(),
            met_limit: false,
            passes: if few { MOST_PASSES } else { 0 },
        }
    }

    /// Looks at up to `budget` more points; true when the grid is found.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub fn step(&mut self, budget: u32) -> Result<bool, CloudError> {
        for _ in 0..budget {
            if self.passes >= MOST_PASSES {
                return Ok(true);
            }
            match self.cloud.position.get(self.next) {
                Some(&p) if self.cells.len() <= KEPT => {
                    let cell = ((p - self.lo) / self.side).floor();
                    let known = self.cells.len();
                    self.table.find_or_add(cell, &mut self.cells).ok_or(CloudError::Memory)?;
                    if self.cells.len() > known {
                        self.kept.push(self.next as u32);
                    }
                    self.next += 1;
                }
                _ => self.end_pass(),
            }
        }
        Ok(self.passes >= MOST_PASSES)
    }

    fn end_pass(&mut self) {
        self.passes += 1;
        let fits = self.cells.len() <= KEPT;
        if fits {
            core::mem::swap(&mut self.best, &mut self.kept);
        }
        let enough = self.best.len() as f64 >= ENOUGH * KEPT as f64;
        self.met_limit |= !fits;
        if fits && (enough || self.met_limit) || !fits && !self.best.is_empty() {
            self.passes = MOST_PASSES;
        }
        self.side *= if fits { FINER } else { COARSER };
        self.next = 0;
        self.cells.clear();
        self.kept.clear();
        self.table = Table::default();
    }

    /// What is kept, in the order of the file.
    #[must_use]
    pub fn finish(self) -> Cloud {
        self.cloud.only(&self.best)
    }
}

/// Checks that points are spread in space.
///
/// # Errors
///
/// If they lie in one place, on a line or in a plane.
pub fn check_spread(points: &[DVec3]) -> Result<(), CloudError> {
    let (lo, hi) = corners(points);
    let (middle, diagonal) = ((lo + hi) / 2.0, (hi - lo).length());
    // Of a single point both the diagonal and the coordinates can be 0.
    if points.len() < 2 || diagonal <= SAME_SHARE * SAME_SHARE * lo.abs().max(hi.abs()).max_element() {
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

/// Mean of (p − mean)(p − mean)ᵀ.
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

/// Chooses points by farthest-point sampling: each next one is farthest from all chosen so far (Gonzalez, "Clustering to
/// Minimize the Maximum Intercluster Distance", 1985), at most half as densely spread as any other choice of as many. The
/// first one is farthest from the mean; of several that are as far, the one that comes first in the file.
#[derive(Debug)]
pub struct Spreader {
    /// Squared distance of each point from the nearest one chosen.
    distance_sq: Vec<f64>,
    chosen: Vec<u32>,
    wanted: usize,
    /// Squared distance from which on points are different.
    different_sq: f64,
}

impl Spreader {
    /// Begins to choose `wanted` of `points`, which must not be none.
    #[must_use]
    pub fn new(points: &[DVec3], wanted: usize) -> Self {
        let (lo, hi) = corners(points);
        // Relative to a corner, so that the sum keeps its digits far from the origin.
        let mean = lo + points.iter().map(|p| *p - lo).sum::<DVec3>() / points.len() as f64;
        Self {
            distance_sq: points.iter().map(|p| p.distance_squared(mean)).collect(),
            chosen: Vec::new(),
            wanted,
            different_sq: SAME_SHARE * SAME_SHARE * hi.distance_squared(lo),
        }
    }

    /// Chooses one more of the same `points`; true when as many are chosen as are wanted or there are.
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
        if !self.chosen.is_empty() && self.distance_sq[farthest] <= self.different_sq {
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

    /// Share of the points that are chosen.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.chosen.len() as f64 / self.wanted.min(self.distance_sq.len()).max(1) as f64
    }

    /// Indices of the points chosen, in the order in which they were.
    #[must_use]
    pub fn chosen(&self) -> &[u32] {
        &self.chosen
    }
}
