//! The border of the points of a model, beyond which its surface is cut off.
//!
//! A function that is fitted to points continues where there are none. Around places of its surface
//! that are far from every point lie balls without points. The border is where the balls end, as
//! for an α-shape (H. Edelsbrunner, D. G. Kirkpatrick & R. Seidel, "On the Shape of a Set of Points
//! in the Plane", 1983): a straight or bent edge of the points is kept to its last point, and a gap
//! too small for a ball is bridged.
//!
//! For a ball with centre c and radius ρ the function v = (ρ² − |x − c|²)/2ρ is positive inside,
//! and near the sphere it is the distance from it. The border's function is the smooth maximum ln(Σ
//! exp(β v))/β over all balls, and over the box outside of which no ball was searched for.

use crate::field::{Field, Jet};
use crate::math::{Bounds, Sym3};
use glam::DVec3;

/// β times the smallest radius. Larger: the rim has kinks between the balls; smaller: it is farther
/// from the points.
const SHARPNESS: f64 = 64.0;
/// Number of balls that reach an edge of the points at about the same place: along a straight edge,
/// with a spacing of a sixth of their radius and this β. Their sum is larger by this factor than
/// the largest term.
const TOGETHER: f64 = 4.0;
/// Exponents that are less than the largest by more than this are left out: e⁻⁴⁰ is below the
/// rounding of double precision.
const NEGLIGIBLE: f64 = 40.0;
/// Number of balls in a block.
const BLOCK: usize = 16;

/// A ball without points inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub centre: DVec3,
    /// Its radius.
    pub radius: f64,
}

/// Balls without points of a model, in a box around all of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// The balls, in blocks of neighbours.
    balls: Vec<Ball>,
    blocks: Vec<Block>,
    bounds: Bounds,
    /// The exponent β of the smooth maximum.
    sharpness: f64,
}

/// The box around the centres of [`BLOCK`] balls, and the largest of their radii.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    bounds: Bounds,
    radius: f64,
}

impl Border {
    /// The border of these balls in a box; none without balls, or if a number is not finite or a
    /// radius not positive.
    #[must_use]
    pub fn new(mut balls: Vec<Ball>, bounds: Bounds) -> Option<Self> {
        let is_ball = |ball: &Ball| ball.centre.is_finite() && ball.radius.is_finite() && ball.radius > 0.0;
        let least = balls.iter().map(|ball| ball.radius).reduce(f64::min)?;
        if !(balls.iter().all(is_ball) && bounds.is_valid()) {
            return None;
        }
        gather(&mut balls);
        let block = |balls: &[Ball]| Block {
            bounds: Bounds::around(balls.iter().map(|ball| ball.centre)),
            radius: balls.iter().map(|ball| ball.radius).fold(0.0, f64::max),
        };
        let blocks = balls.chunks(BLOCK).map(block).collect();
        Some(Self { balls, blocks, bounds, sharpness: SHARPNESS / least })
    }

    /// The balls.
    #[must_use]
    pub fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// The box around all points.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

/// Sorts balls so that each block holds neighbours, by repeated halving along the longest side.
fn gather(balls: &mut [Ball]) {
    if balls.len() <= BLOCK {
        return;
    }
    let size = Bounds::around(balls.iter().map(|ball| ball.centre)).size();
    let axis = size.to_array().iter().position(|side| *side == size.max_element()).unwrap_or(0);
    balls.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let half = balls.len().div_ceil(2).next_multiple_of(BLOCK);
    let (first, second) = balls.split_at_mut(half.min(balls.len()));
    gather(first);
    gather(second);
}

/// Distance from the surface of a ball, to first order, at a distance from its centre: positive
/// inside.
fn depth(radius: f64, distance_sq: f64) -> f64 {
    0.5 * (radius - distance_sq / radius)
}

impl Block {
    /// An upper bound of [`depth`] for all balls at `p`.
    fn most(&self, p: DVec3) -> f64 {
        let nearest = p.clamp(self.bounds.lo(), self.bounds.hi());
        depth(self.radius, p.distance_squared(nearest))
    }
}

impl Field for Border {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let jet = self.jet(p);
        (jet.value, jet.gradient)
    }

    /// Negative within the border, positive beyond it.
    fn jet(&self, p: DVec3) -> Jet {
        let [lo, hi] = [p - self.bounds.lo(), p - self.bounds.hi()];
        let mut largest = (-lo).max(hi).max_element();
        let blocks = || self.blocks.iter().zip(self.balls.chunks(BLOCK));
        for (block, balls) in blocks() {
            if block.most(p) > largest {
                let depths = balls.iter().map(|ball| depth(ball.radius, p.distance_squared(ball.centre)));
                largest = depths.fold(largest, f64::max);
            }
        }
        let least = largest - NEGLIGIBLE / self.sharpness;
        let (mut sum, mut slope, mut bend) = (0.0, DVec3::ZERO, Sym3::<f64>::default());
        let mut add = |value: f64, gradient: DVec3, own: f64| {
            if value < least {
                return;
            }
            let weight = libm::exp(self.sharpness * (value - largest));
            sum += weight;
            slope += weight * gradient;
            let entry = |i: usize, j: usize| {
                weight * (self.sharpness * gradient[i] * gradient[j] + if i == j { own } else { 0.0 })
            };
            bend.xx += entry(0, 0);
            bend.xy += entry(0, 1);
            bend.xz += entry(0, 2);
            bend.yy += entry(1, 1);
            bend.yz += entry(1, 2);
            bend.zz += entry(2, 2);
        };
        for axis in 0..3 {
            add(-lo[axis], -DVec3::AXES[axis], 0.0);
            add(hi[axis], DVec3::AXES[axis], 0.0);
        }
        for (block, balls) in blocks() {
            if block.most(p) >= least {
                for ball in balls {
                    let offset = p - ball.centre;
                    add(
                        depth(ball.radius, offset.length_squared()),
                        -offset / ball.radius,
                        -1.0 / ball.radius,
                    );
                }
            }
        }
        let gradient = slope / sum;
        let entry = |of: f64, i: usize, j: usize| of / sum - self.sharpness * gradient[i] * gradient[j];
        let hessian = Sym3 {
            xx: entry(bend.xx, 0, 0),
            xy: entry(bend.xy, 0, 1),
            xz: entry(bend.xz, 0, 2),
            yy: entry(bend.yy, 1, 1),
            yz: entry(bend.yz, 1, 2),
            zz: entry(bend.zz, 2, 2),
        };
        let value = largest + libm::log(sum / TOGETHER) / self.sharpness;
        Jet { value, gradient, hessian }
    }
}
