//! Octree that evaluates the field in single precision.
//!
//! A direct sum costs as many terms as there are centres, and in single precision its result on the
//! surface is noise, because hundreds of terms of both signs cancel. The octree avoids both. In
//! each cell, one [Taylor polynomial](super::taylor) replaces the terms of all far centres; its
//! coefficients are summed in double precision. Only the terms of a few near centres, which are
//! small, are summed directly. A cell is made when the first point falls into it, and depends on
//! the field alone.
//!
//! The scheme is the dual of the tree code of J. Barnes & P. Hut (1986): the expansions are about
//! the targets, as the local expansions of the fast multipole method (L. Greengard & V. Rokhlin,
//! 1987).

use super::coefficients::{Centre, DEGREE, Rows};
use super::data::RbfData;
use super::frame::CentredFrame;
use super::kernel::{self, LocalPoint, LocalPoints, Near};
use super::taylor::{Polynomial, TERMS, Taylor};
use crate::math::{LANES, Lanes};
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Half-width of the root cell in local units, in which the centres fill a box of half-width 1/2 to
/// 1: the box of a fit with its margin needs at most a third of it. Outside of the root cell the
/// field is evaluated in double precision.
const ROOT: f64 = 4.0;

/// Largest bound on the remainder of a far centre's Taylor series, without its coefficient of about
/// 1/300. On the surface of the bunny, half of the series then have an error below 10⁻⁷ of the
/// model's size, about the rounding of the near terms.
const MAX_REMAINDER: f64 = 3e-4;
/// Minimum distance of a far centre, in radii of the cell. The series converges beyond 1. Larger:
/// fewer centres are far, and an evaluation takes longer.
const MIN_DISTANCE: f64 = 1.5;
/// Maximum number of near centres of a leaf, beyond which it is split. A smaller number makes
/// evaluation cheaper and the cells costlier: with 32, the cells of a model of 200 centres pay off
/// after about 10,000 evaluations.
const MAX_NEAR: usize = 32;
/// A cell is not split if its nearest centre is farther than this, in radii of the cell: little of
/// the surface is there. Smaller: evaluation takes longer.
const CLOSE: f64 = 1.0;
/// Half-width at which a cell is not split, even in a cluster of centres.
const MIN_HALF_WIDTH: f64 = 1.0 / 512.0;

/// Minimum number of consecutive points of a cell that are evaluated together. With 3 a run on the
/// bunny takes 3 % more instructions, with 1 some 20 %.
const MIN_TOGETHER: usize = 6;

/// A cell of the octree.
#[derive(Debug)]
enum Cell {
    Branch(BranchCell),
    Leaf(Box<LeafCell>),
}

/// A cell that is split into eight. Each is made when a point falls into it.
#[derive(Debug)]
struct BranchCell {
    middle: [f32; 3],
    octants: [OnceLock<Box<Cell>>; 8],
    half: f64,
    far: Box<Polynomial>,
    near: Vec<u32>,
}

/// A cell that is not split.
#[derive(Debug)]
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
#[derive(Debug)]
pub(super) struct CellTree {
    /// All centres.
    centres: Vec<Centre>,
    origin: DVec3,
    scale: f32,
    taylor: Taylor,
    root: Cell,
}

impl CellTree {
    pub(super) fn new(data: &RbfData) -> Self {
        let frame = CentredFrame::of(data.centres.iter().map(|&c| DVec3::from_array(c)));
        let scale = frame.scale();
        // With g the function in local coordinates, f(x) = g(s (x − o))/s, as in `pointcloud::fit`.
        let centres: Vec<Centre> = (0..data.centres.len())
            .map(|j| Centre {
                position: frame.local(DVec3::from_array(data.centres[j])),
                alpha: data.alpha[j] / (scale * scale),
                beta: DVec3::from_array(data.beta[j]) / scale,
            })
            .collect();
        let taylor = Taylor::new();
        let all: Vec<u32> = (0..centres.len() as u32).collect();
        let root = cell(&taylor, &centres, DVec3::ZERO, ROOT, &[0.0; TERMS], &all);
        Self { centres, origin: frame.origin(), scale: scale as f32, taylor, root }
    }

    /// The leaf that contains a point of the root cell. Missing cells are made.
    fn leaf(&self, [x, y, z]: [f32; 3]) -> &LeafCell {
        let mut at = &self.root;
        loop {
            let branch = match at {
                Cell::Leaf(leaf) => return leaf,
                Cell::Branch(branch) => branch,
            };
            let upper = [x >= branch.middle[0], y >= branch.middle[1], z >= branch.middle[2]];
            let octant = upper.iter().rev().fold(0, |bits, &bit| 2 * bits + usize::from(bit));
            at = branch.octants[octant].get_or_init(|| {
                let side = upper.map(|upper| if upper { 1.0 } else { -1.0 });
                let half = 0.5 * branch.half;
                let middle = Vec3::from_array(branch.middle).as_dvec3() + DVec3::from_array(side) * half;
                let far = self.taylor.shifted(&branch.far, side);
                Box::new(cell(&self.taylor, &self.centres, middle, half, &far, &branch.near))
            });
        }
    }

    /// Calls `store` for each point, relative to `origin`, with its index and f and ∇f, and for `N`
    /// = 10 also ∇∇f (xx, xy, xz, yy, yz, zz).
    pub(super) fn sums<const N: usize>(
        &self,
        data: &RbfData,
        origin: DVec3,
        points: &[Vec3],
        mut store: impl FnMut(usize, [f32; N]),
    ) {
        let scale = self.scale;
        let own_origin = (self.origin - origin).as_vec3().to_array();
        let mut last: Option<&LeafCell> = None;
        let mut n = 0;
        while n < points.len() {
            // Up to eight of the next points; those in the cell of the first one are evaluated
            // together.
            let count = LANES.min(points.len() - n);
            let mut local = [Lanes::splat(0.0); 3];
            for (lane, p) in points[n..n + count].iter().enumerate() {
                for axis in 0..3 {
                    local[axis].0[lane] = p[axis];
                }
            }
            for (local, origin) in local.iter_mut().zip(own_origin) {
                *local = (*local - Lanes::splat(origin)) * Lanes::splat(scale);
            }
            let first = local.map(|lanes| lanes.0[0]);
            let known = last.filter(|leaf| contains(&leaf.middle, leaf.half, &first));
            if known.is_none() && !contains(&[0.0; 3], ROOT as f32, &first) {
                store(n, exact(data, origin + points[n].as_dvec3()));
                n += 1;
                continue;
            }
            let leaf = known.unwrap_or_else(|| self.leaf(first));
            last = Some(leaf);
            let LeafCell { middle, half, inverse, far, near, centres } = leaf;
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
}

/// A cell. `far` is its parent's polynomial, shifted to this cell, and `among` are the near centres
/// of its parent.
fn cell(
    taylor: &Taylor,
    centres: &[Centre],
    middle: DVec3,
    half: f64,
    far: &Polynomial,
    among: &[u32],
) -> Cell {
    let radius = half * 3.0_f64.sqrt();
    let distance = |j: u32| centres[j as usize].position.distance(middle);
    let (away, near): (Vec<u32>, Vec<u32>) = among.iter().partition(|&&j| {
        let (centre, distance) = (&centres[j as usize], distance(j));
        let slope = centre.alpha.abs() * distance + (DEGREE + 1) as f64 * centre.beta.length();
        let remainder = slope * distance * distance * eighth_power(radius / distance);
        distance > MIN_DISTANCE * radius && remainder <= MAX_REMAINDER
    });
    let away: Vec<Centre> = away.iter().map(|&j| centres[j as usize]).collect();
    let close = near.iter().any(|&j| distance(j) <= CLOSE * radius);
    let mut far = Box::new(*far);
    taylor.expand(&mut far, middle, half, &away);
    let place = middle.as_vec3().to_array();
    if near.len() > MAX_NEAR && close && half > MIN_HALF_WIDTH {
        return Cell::Branch(BranchCell { middle: place, octants: Default::default(), half, far, near });
    }
    let near: Vec<Centre> = near.iter().map(|&j| centres[j as usize]).collect();
    Cell::Leaf(Box::new(LeafCell {
        middle: place,
        half: half as f32,
        inverse: (1.0 / half) as f32,
        far: taylor.rows(&far),
        centres: near.len(),
        near: near.chunks(LANES).map(Near::new).collect(),
    }))
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
fn exact<const N: usize>(data: &RbfData, p: DVec3) -> [f32; N] {
    let jet = data.jet(p);
    let (g, h) = (jet.gradient, jet.hessian);
    let all = [jet.value, g.x, g.y, g.z, h.xx, h.xy, h.xz, h.yy, h.yz, h.zz];
    core::array::from_fn(|k| all[k] as f32)
}
