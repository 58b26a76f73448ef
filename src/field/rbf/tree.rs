//! The field in single precision, cell by cell of an octree.
//!
//! Summed term by term the field costs as much as it has centres, and in single precision it is noise: hundreds of terms of
//! both signs cancel to nothing on the surface. So space is cut into cells. In each, the terms of far centres are one
//! [Taylor polynomial](super::taylor), whose coefficients were summed in double precision; those of the few near centres are
//! small and are summed one by one. A cell is made when the first point falls into it, and depends on nothing but the field.
//! (Barnes and Hut's tree of 1986, read the other way round as in the fast multipole method of Greengard and Rokhlin, 1987.)

use super::kernel::{self, Centre, Near, Place, Places, Rows};
use super::taylor::{DEGREE, Polynomial, TERMS, Taylor};
use super::{Frame, RbfData};
use crate::math::{LANES, Lanes, Sym3};
use glam::{DVec3, Vec3};

/// Half-width of the first cell, in local units, in which the centres fill a box of half-width 1/2 to 1. Points outside are
/// evaluated in double precision.
const ROOT: f64 = 4.0;

/// Largest part that a centre's Taylor series may leave out, before its falling factor of about 1/300: half of the series
/// then err by less than 10⁻⁷ of the model's size on the surface of the bunny, as much as the rounding of the near terms.
const REMAINDER: f64 = 3e-4;
/// Far centres are at least so many radii of the cell away.
const LEAST_DISTANCE: f64 = 1.5;
/// Cells with up to so many near centres are not cut. Fewer make a point cheaper and the cells dearer: with 32 a model of
/// 200 centres is paid for by some 10,000 evaluations.
const MOST_NEAR: usize = 32;
/// Nor are cells with no centre within so many radii: little of the surface is there.
const CLOSE: f64 = 1.0;
/// Nor are cells of this half-width, which a cluster of centres could ask for.
const SMALLEST: f64 = 1.0 / 512.0;

/// Fewer points of a cell than this, one after the other, are evaluated one by one: eight together cost less than three.
const FEW: usize = 3;

/// No cell yet.
const NONE: u32 = u32::MAX;
/// The bit of a leaf's index among children.
const LEAF: u32 = 1 << 31;

/// A cell that is cut into eight.
#[derive(Clone, Debug)]
struct Branch {
    middle: [f32; 3],
    /// Index of each eighth, with the bit [`LEAF`] of a leaf, or [`NONE`] until a point falls into it.
    eighths: [u32; 8],
    half: f64,
    far: Box<Polynomial>,
    near: Vec<u32>,
}

/// A cell that is not.
#[derive(Clone, Debug)]
struct Leaf {
    middle: [f32; 3],
    half: f32,
    inverse: f32,
    far: Rows,
    near: Vec<Near>,
    /// How many centres are near.
    centres: usize,
}

/// The octree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    centres: Vec<Centre>,
    origin: [f32; 3],
    scale: f32,
    taylor: Taylor,
    branches: Vec<Branch>,
    leaves: Vec<Leaf>,
    /// The first cell.
    root: u32,
}

impl Tree {
    pub(super) fn new(data: &RbfData) -> Self {
        let frame = Frame::of(data.centres.iter().map(|&c| DVec3::from_array(c)));
        let scale = frame.scale();
        // f(x) = g(s (x − o))/s, as in `pointcloud::fit`.
        let centres: Vec<Centre> = (0..data.centres.len())
            .map(|j| Centre {
                place: frame.local(DVec3::from_array(data.centres[j])),
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

    /// Makes a cell from what its parent has for it, and gives its index, with the bit [`LEAF`] of a leaf.
    fn add_cell(&mut self, middle: DVec3, half: f64, far: &Polynomial, centres: &[u32]) -> u32 {
        let radius = half * 3.0_f64.sqrt();
        let distance = |j: u32| self.centres[j as usize].place.distance(middle);
        let (away, near): (Vec<u32>, Vec<u32>) = centres.iter().partition(|&&j| {
            let (centre, distance) = (&self.centres[j as usize], distance(j));
            let slope = centre.alpha.abs() * distance + (DEGREE + 1) as f64 * centre.beta.length();
            let remainder = slope * distance * distance * eighth_power(radius / distance);
            distance > LEAST_DISTANCE * radius && remainder <= REMAINDER
        });
        let away: Vec<Centre> = away.iter().map(|&j| self.centres[j as usize]).collect();
        let close = near.iter().any(|&j| distance(j) <= CLOSE * radius);
        let mut far = Box::new(*far);
        self.taylor.expand(&mut far, middle, half, &away);
        if near.len() > MOST_NEAR && close && half > SMALLEST {
            self.branches.push(Branch {
                middle: middle.as_vec3().to_array(),
                eighths: [NONE; 8],
                half,
                far,
                near,
            });
            self.branches.len() as u32 - 1
        } else {
            let near: Vec<Centre> = near.iter().map(|&j| self.centres[j as usize]).collect();
            self.leaves.push(Leaf {
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

    /// Index of the leaf of a place in the first cell, made if it is the first of its points.
    fn leaf(&mut self, [x, y, z]: [f32; 3]) -> usize {
        let mut index = self.root;
        while index & LEAF == 0 {
            let branch = &self.branches[index as usize];
            let upper = [x >= branch.middle[0], y >= branch.middle[1], z >= branch.middle[2]];
            let eighth = upper.iter().rev().fold(0, |bits, &bit| 2 * bits + usize::from(bit));
            let mut next = branch.eighths[eighth];
            if next == NONE {
                let side = upper.map(|upper| if upper { 1.0 } else { -1.0 });
                let half = 0.5 * branch.half;
                let middle = Vec3::from_array(branch.middle).as_dvec3() + DVec3::from_array(side) * half;
                let (far, near) = (self.taylor.shifted(&branch.far, side), branch.near.clone());
                next = self.add_cell(middle, half, &far, &near);
                self.branches[index as usize].eighths[eighth] = next;
            }
            index = next;
        }
        (index & !LEAF) as usize
    }

    /// Gives to `store` with the index of each point f and ∇f, and for `N` = 10 also ∇∇f (xx, xy, xz, yy,
    /// yz, zz).
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
            // The next points, as many of them as are in the cell of the first.
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
            if !self.leaves.get(last).is_some_and(|leaf| holds(&leaf.middle, leaf.half, &first)) {
                if !holds(&[0.0; 3], ROOT as f32, &first) {
                    store(n, exact(data, points[n]));
                    n += 1;
                    continue;
                }
                last = self.leaf(first);
            }
            let Leaf { middle, half, inverse, far, near, centres } = &self.leaves[last];
            let together = (1..count)
                .find(|&lane| !holds(middle, *half, &local.map(|lanes| lanes.0[lane])))
                .unwrap_or(count);
            let offset: [Lanes; 3] = core::array::from_fn(|axis| {
                (local[axis] - Lanes::splat(middle[axis])) * Lanes::splat(*inverse)
            });
            // Gradients are those of the model; values and second derivatives have units.
            if together < FEW {
                for lane in 0..together {
                    let [local, offset] = [&local, &offset].map(|place| place.map(|lanes| lanes.0[lane]));
                    let mut sums = kernel::sums::<N>(far, near, &Place { local, offset, inverse: *inverse });
                    sums[0] /= scale;
                    sums[4.min(N)..].iter_mut().for_each(|second| *second *= scale);
                    store(n + lane, sums);
                }
            } else {
                let mut sums =
                    kernel::sums_of_eight::<N>(far, near, *centres, &Places { local, offset }, *inverse);
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
        // Values alone are asked for now and then: no code of their own.
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

/// Whether a cell, which has its lower faces, holds a place. NaN is outside of all.
fn holds(middle: &[f32; 3], half: f32, place: &[f32; 3]) -> bool {
    (0..3).all(|k| middle[k] - half <= place[k] && place[k] < middle[k] + half)
}

/// x⁸, one power more than the polynomials have.
fn eighth_power(x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    fourth * fourth
}

/// The first `N` of value, gradient and Hessian, from double precision.
fn exact<const N: usize>(data: &RbfData, p: Vec3) -> [f32; N] {
    let jet = data.jet(p.as_dvec3());
    let (g, h) = (jet.gradient, jet.hessian);
    let all = [jet.value, g.x, g.y, g.z, h.xx, h.xy, h.xz, h.yy, h.yz, h.zz];
    core::array::from_fn(|k| all[k] as f32)
}
