//! Octree that evaluates the field in single precision.
//!
//! A direct sum costs as many terms as there are centres, and in single precision its result on the surface is noise,
//! because hundreds of terms of both signs cancel. The octree avoids both. In each cell, one
//! [Taylor polynomial](super::taylor) replaces the terms of all far centres; its coefficients are summed in double
//! precision. Only the terms of a few near centres, which are small, are summed directly. A cell is made when the first
//! point falls into it, and depends on the field alone.
//!
//! The scheme is the dual of the tree code of J. Barnes & P. Hut (1986): the expansions are about the targets, as the
//! local expansions of the fast multipole method (L. Greengard & V. Rokhlin, 1987).

use super::coefficients::{Centre, DEGREE, Rows};
use super::data::RbfData;
use super::frame::CentredFrame;
use super::kernel::{self, LocalPoint, LocalPoints, Near};
use super::taylor::{Polynomial, TERMS, Taylor};
use crate::math::{LANES, Lanes, NONE, Sym3};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Half-width of the root cell in local units, in which the centres fill a box of half-width 1/2 to 1: the box of a fit with its
/// margin needs at most a third of it. The field outside of the root cell is evaluated in double precision.
const ROOT: f64 = 4.0;

/// Largest bound on the remainder of a far centre's Taylor series, without its coefficient of about 1/300. On the
/// surface of the bunny, half of the series then have an error below 10⁻⁷ of the model's size, which is that of
/// rounding in the near terms.
const MAX_REMAINDER: f64 = 3e-4;
/// Minimum distance of a far centre, in radii of the cell: the series converges beyond 1. With half of it 2 of 4 random clouds
/// give other particles in the same time; twice as much takes 1.1 times as long.
const MIN_DISTANCE: f64 = 1.5;
/// Maximum number of near centres of a leaf, beyond which it is split. A smaller number makes evaluation cheaper and
/// the cells costlier: with 32, the cells of a model of 200 centres pay off after about 10,000 evaluations.
/// With half of it a fit and 3,000 or 12,000 particles of a random surface take 5 % more instructions, with double 1 to 2 % fewer.
const MAX_NEAR: usize = 32;
/// Distance of the nearest centre, in radii of the cell, beyond which a cell is not split: little of the surface is there. With
/// half of it four random clouds take 1.9 times as long, with twice as much they give the same particles.
const CLOSE: f64 = 1.0;
/// Half-width at which a cell is not split, even in a cluster of centres. Half and double give the same particles on four random
/// clouds.
const MIN_HALF_WIDTH: f64 = 1.0 / 512.0;

/// Minimum number of consecutive points of a cell that are evaluated together. With 3 a run on the bunny takes 3 % more instructions, with 1
/// some 20 %.
const MIN_TOGETHER: usize = 6;

/// Bit that marks the index of a child as that of a leaf.
const LEAF: u32 = 1 << 31;

/// A cell that is split into eight.
#[derive(Clone, Debug)]
struct BranchCell {
    middle: [f32; 3],
    /// Index of each octant, with the bit [`LEAF`] for a leaf, or [`NONE`] until a point falls into it.
    octants: [u32; 8],
    half: f64,
    far: Box<Polynomial>,
    near: Vec<u32>,
}

/// A cell that is not split.
#[derive(Clone, Debug)]
struct LeafCell {
    middle: [f32; 3],
    half: f32,
    inverse: f32,
    far: Rows,
    near: Vec<Near>,
    /// Number of near centres.
    centres: usize,
}

/// Octree of the cells made so far.
#[derive(Clone, Debug)]
pub(super) struct CellTree {
    /// All centres, which copies of the tree share.
    centres: Arc<[Centre]>,
    origin: [f32; 3],
    scale: f32,
    taylor: Taylor,
    branches: Vec<BranchCell>,
    leaves: Vec<LeafCell>,
    /// Index of the root cell, with the bit [`LEAF`] for a leaf.
    root: u32,
}

impl CellTree {
    pub(super) fn new(data: &RbfData) -> Self {
        let frame = CentredFrame::of(data.centres.iter().map(|&c| DVec3::from_array(c)));
        let scale = frame.scale();
        // With g the function in local coordinates, f(x) = g(s (x − o))/s, as in `pointcloud::fit`.
        let centres: Arc<[Centre]> = (0..data.centres.len())
            .map(|j| Centre {
                position: frame.local(DVec3::from_array(data.centres[j])),
                alpha: data.alpha[j] / (scale * scale),
                beta: DVec3::from_array(data.beta[j]) / scale,
            })
            .collect();
        let mut tree = Self {
            origin: frame.origin().as_vec3().to_array(),
            scale: scale as f32,
            taylor: Taylor::new(),
            branches: Vec::new(),
            leaves: Vec::new(),
            root: 0,
            centres,
        };
        let all: Vec<u32> = (0..tree.centres.len() as u32).collect();
        tree.root = tree.add_cell(DVec3::ZERO, ROOT, &[0.0; TERMS], &all);
        tree
    }

    /// Adds a cell and returns its index, with the bit [`LEAF`] for a leaf. `far` is the polynomial of its parent,
    /// shifted to this cell, and `centres` are the near centres of its parent.
    fn add_cell(&mut self, middle: DVec3, half: f64, far: &Polynomial, centres: &[u32]) -> u32 {
        let radius = half * 3.0_f64.sqrt();
        let distance = |j: u32| self.centres[j as usize].position.distance(middle);
        let (away, near): (Vec<u32>, Vec<u32>) = centres.iter().partition(|&&j| {
            let (centre, distance) = (&self.centres[j as usize], distance(j));
            let slope = centre.alpha.abs() * distance + (DEGREE + 1) as f64 * centre.beta.length();
            let remainder = slope * distance * distance * eighth_power(radius / distance);
            distance > MIN_DISTANCE * radius && remainder <= MAX_REMAINDER
        });
        let away: Vec<Centre> = away.iter().map(|&j| self.centres[j as usize]).collect();
        let close = near.iter().any(|&j| distance(j) <= CLOSE * radius);
        let mut far = Box::new(*far);
        self.taylor.expand(&mut far, middle, half, &away);
        if near.len() > MAX_NEAR && close && half > MIN_HALF_WIDTH {
            self.branches.push(BranchCell {
                middle: middle.as_vec3().to_array(),
                octants: [NONE; 8],
                half,
                far,
                near,
            });
            self.branches.len() as u32 - 1
        } else {
            let near: Vec<Centre> = near.iter().map(|&j| self.centres[j as usize]).collect();
            self.leaves.push(LeafCell {
                middle: middle.as_vec3().to_array(),
                half: half as f32,
                inverse: (1.0 / half) as f32,
                far: self.taylor.rows(&far),
                centres: near.len(),
                near: near.chunks(LANES).map(Near::new).collect(),
            });
            (self.leaves.len() as u32 - 1) | LEAF
        }
    }

    /// Index of the leaf that contains a point of the root cell. Missing cells are added.
    fn leaf(&mut self, [x, y, z]: [f32; 3]) -> usize {
        let mut index = self.root;
        while index & LEAF == 0 {
            let branch = &self.branches[index as usize];
            let upper = [x >= branch.middle[0], y >= branch.middle[1], z >= branch.middle[2]];
            let octant = upper.iter().rev().fold(0, |bits, &bit| 2 * bits + usize::from(bit));
            let mut next = branch.octants[octant];
            if next == NONE {
                let side = upper.map(|upper| if upper { 1.0 } else { -1.0 });
                let half = 0.5 * branch.half;
                let middle = Vec3::from_array(branch.middle).as_dvec3() + DVec3::from_array(side) * half;
                let (far, near) = (self.taylor.shifted(&branch.far, side), branch.near.clone());
                next = self.add_cell(middle, half, &far, &near);
                self.branches[index as usize].octants[octant] = next;
            }
            index = next;
        }
        (index & !LEAF) as usize
    }

    /// Calls `store` for each point with its index and f and ∇f, and for `N` = 10 also ∇∇f (xx, xy, xz, yy, yz, zz).
    fn sums<const N: usize>(
        &mut self,
        data: &RbfData,
        points: &[Vec3],
        mut store: impl FnMut(usize, [f32; N]),
    ) {
        let scale = self.scale;
        let mut last = usize::MAX;
        let mut n = 0;
        while n < points.len() {
            // Up to eight of the next points, of which those in the cell of the first one are evaluated together.
            let count = LANES.min(points.len() - n);
            let mut local = [Lanes::splat(0.0); 3];
            for (lane, p) in points[n..n + count].iter().enumerate() {
                for axis in 0..3 {
                    local[axis].0[lane] = p[axis];
                }
            }
            for (local, origin) in local.iter_mut().zip(self.origin) {
                *local = (*local - Lanes::splat(origin)) * Lanes::splat(scale);
            }
            let first = local.map(|lanes| lanes.0[0]);
            if !self.leaves.get(last).is_some_and(|leaf| contains(&leaf.middle, leaf.half, &first)) {
                if !contains(&[0.0; 3], ROOT as f32, &first) {
                    store(n, exact(data, points[n]));
                    n += 1;
                    continue;
                }
                last = self.leaf(first);
            }
            let LeafCell { middle, half, inverse, far, near, centres } = &self.leaves[last];
            let together = (1..count)
                .find(|&lane| !contains(middle, *half, &local.map(|lanes| lanes.0[lane])))
                .unwrap_or(count);
            let offset: [Lanes; 3] = core::array::from_fn(|axis| {
                (local[axis] - Lanes::splat(middle[axis])) * Lanes::splat(*inverse)
            });
            // Gradients are the same in local units; values and second derivatives are not.
            if together < MIN_TOGETHER {
                for lane in 0..together {
                    let [local, offset] = [&local, &offset].map(|place| place.map(|lanes| lanes.0[lane]));
                    let mut sums =
                        kernel::sums::<N>(far, near, &LocalPoint { local, offset, inverse: *inverse });
                    sums[0] /= scale;
                    sums[4.min(N)..].iter_mut().for_each(|second| *second *= scale);
                    store(n + lane, sums);
                }
            } else {
                let mut sums =
                    kernel::sums_of_eight::<N>(far, near, *centres, &LocalPoints { local, offset }, *inverse);
                sums[0] = sums[0] / Lanes::splat(scale);
                sums[4.min(N)..].iter_mut().for_each(|second| *second = *second * Lanes::splat(scale));
                for lane in 0..together {
                    store(n + lane, core::array::from_fn(|k| sums[k].0[lane]));
                }
            }
            n += together;
        }
    }

    pub(super) fn values(&mut self, data: &RbfData, points: &[Vec3], value: &mut [f32]) {
        // Values alone are rarely needed, so they have no code of their own.
        self.sums(data, points, |n, [v, ..]: [f32; 4]| value[n] = v);
    }

    pub(super) fn gradients(
        &mut self,
        data: &RbfData,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
    ) {
        self.sums(data, points, |n, [v, x, y, z]| (value[n], gradient[n]) = (v, Vec3::new(x, y, z)));
    }

    pub(super) fn hessians(
        &mut self,
        data: &RbfData,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.sums(data, points, |n, [v, x, y, z, xx, xy, xz, yy, yz, zz]| {
            (value[n], gradient[n]) = (v, Vec3::new(x, y, z));
            hessian[n] = Sym3 { xx, xy, xz, yy, yz, zz };
        });
    }
}

/// Whether a cell, which includes its lower faces, contains a point. NaN is outside of every cell.
fn contains(middle: &[f32; 3], half: f32, place: &[f32; 3]) -> bool {
    (0..3).all(|k| middle[k] - half <= place[k] && place[k] < middle[k] + half)
}

/// x⁸, where 8 is the degree of the polynomials plus one.
fn eighth_power(x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    fourth * fourth
}

/// First `N` numbers of value, gradient and Hessian, computed in double precision.
fn exact<const N: usize>(data: &RbfData, p: Vec3) -> [f32; N] {
    let jet = data.jet(p.as_dvec3());
    let (g, h) = (jet.gradient, jet.hessian);
    let all = [jet.value, g.x, g.y, g.z, h.xx, h.xy, h.xz, h.yy, h.yz, h.zz];
    core::array::from_fn(|k| all[k] as f32)
}
