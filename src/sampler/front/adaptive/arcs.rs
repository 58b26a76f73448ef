//! The free arcs around a parent between the particles that are there, and the children that fit
//! into them: paper §5.3.
//!
//! A child of radius r_c touches its parent, so its centre lies on a circle of radius D = r_p + r_c
//! around it. A particle at distance d, of radius r_j, blocks such a child within an angle β of its
//! own direction. β follows from the law of cosines in the triangle with the sides D, d and r_c +
//! r_j. The angles that no particle blocks form the free arcs.
//!
//! In each arc the free circumference τ is compared with φ, the angle that the child's own diameter
//! takes (Figs 7g and 8): a child has room if τ ≥ φ, and gets in, pressing its neighbours aside, if
//! τ ≥ [`FIT`] φ.
//!
//! # Differs from the paper
//!
//! * The angles are those of the curved surface, not of the tangent plane: both legs of the
//!   triangle dip below the plane.
//! * Particles that do not touch the parent but would overlap a child count too.
//! * A child is placed although τ is a little less than φ. On a perfect lattice τ equals φ, and
//!   rounding would decide.

use crate::math::functions::{acos, asin, atan2, cos, sin};
use crate::math::{LANES, Lanes};
use crate::particles::Slots;
use crate::sampler::front::adaptive::MAX_SLOPE;
use crate::sampler::front::{MAX_DIP, SIN_60};
use core::f32::consts::TAU;
use glam::{Vec2, Vec3};

/// A child has room if the free angle τ is at least this share of φ. At ½ its distance from either
/// neighbour is 0.77 (r_i + r_j). Smaller: larger overlaps; larger: larger holes.
const FIT: f32 = 0.5;

/// An arc takes another child if it has room for this share of it. With less or more, fewer
/// particles have six neighbours.
const CROWDING: f32 = 0.5;

/// Stands for no angle: an interval that ends this far from its middle is empty.
const NOWHERE: f32 = -100.0;

/// The tangent plane of a parent, with the second fundamental form and the gradient of the radius
/// there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ParentFrame {
    /// Radius of the parent.
    pub(crate) radius: f32,
    /// Unit tangent vector at angle 0.
    pub(crate) u: Vec3,
    /// Unit tangent vector at 90°.
    pub(crate) w: Vec3,
    /// Unit normal.
    pub(crate) n: Vec3,
    /// Second fundamental form in (u, w): a, b, c of [a b; b c].
    pub(crate) shape: [f32; 3],
    /// Gradient of the radius along the surface, in (u, w).
    pub(crate) slope: Vec2,
}

impl ParentFrame {
    /// Slope of the radius in a direction, bounded so that a child can touch the parent.
    fn slope_along(&self, x: f32, y: f32) -> f32 {
        limited(self.slope.x * x + self.slope.y * y, MAX_SLOPE)
    }

    /// Normal curvature in a direction.
    fn curvature_along(&self, x: f32, y: f32) -> f32 {
        let [a, b, c] = self.shape;
        a * x * x + (b + b) * x * y + c * y * y
    }

    /// Predicted radius of a child in a direction: r_c = r_p + s (r_p + r_c).
    fn child_radius(&self, x: f32, y: f32) -> f32 {
        let slope = self.slope_along(x, y);
        self.radius * (1.0 + slope) / (1.0 - slope)
    }

    /// Sine of the angle by which a chord of length `distance` dips below the tangent plane,
    /// negative below.
    fn dip(&self, x: f32, y: f32, distance: f32) -> f32 {
        limited(-0.5 * self.curvature_along(x, y) * distance, MAX_DIP)
    }

    /// Predicts the child at an angle, no larger than `largest`.
    pub(crate) fn child_at(&self, angle: f32, largest: f32) -> PredictedChild {
        let (x, y) = (cos(angle), sin(angle));
        let radius = self.child_radius(x, y);
        let radius = if radius < largest { radius } else { largest };
        let distance = self.radius + radius;
        let sin_theta = self.dip(x, y, distance);
        let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
        let direction = self.u * x + self.w * y;
        let [a, b, c] = self.shape;
        let turn = self.u * (a * x + b * y) + self.w * (b * x + c * y);
        PredictedChild {
            direction,
            turn: [cos_theta, sin_theta],
            distance,
            radius,
            largest,
            slope: self.slope_along(x, y),
            offset: (direction * cos_theta + self.n * sin_theta) * distance,
            // The turn is tangential, so the sum is never shorter than n.
            normal: (self.n + turn * (distance * cos_theta)).normalize_or(self.n),
            clearance: 0.0,
        }
    }

    /// Angle between two children that touch each other, at two angles.
    fn between(&self, one: f32, other: f32) -> f32 {
        let (x, y, z, w) = (cos(one), sin(one), cos(other), sin(other));
        let (r, q) = (self.child_radius(x, y), self.child_radius(z, w));
        let (d, e) = (self.radius + r, self.radius + q);
        let (s, t) = (self.dip(x, y, d), self.dip(z, w, e));
        wedge(d, e, r + q, s, t)
    }
}

/// Angle in the tangent plane between two chords of lengths `d` and `e`, whose ends are `apart`,
/// with the sines `s` and `t` of their dips.
fn wedge(d: f32, e: f32, apart: f32, s: f32, t: f32) -> f32 {
    let cosine = (d * d + e * e - apart * apart) / (2.0 * d * e);
    let flat = (cosine - s * t) / ((1.0 - s * s) * (1.0 - t * t)).sqrt();
    acos(limited(flat, 1.0))
}

/// The number nearest to `x` from −`most` to `most`; `most` for NaN. In lanes this is faster than
/// `clamp`.
#[inline]
fn limited(x: f32, most: f32) -> f32 {
    let x = if x < most { x } else { most };
    if x > -most { x } else { -most }
}

/// A predicted child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PredictedChild {
    /// Unit tangent vector V̂.
    pub(crate) direction: Vec3,
    /// cos θ and sin θ on the circle C.
    pub(crate) turn: [f32; 2],
    /// Distance from the parent, r_p + r_c.
    pub(crate) distance: f32,
    /// Radius r_c.
    pub(crate) radius: f32,
    /// Largest radius that the particles around allow.
    pub(crate) largest: f32,
    /// Change of the radius per length in this direction.
    pub(crate) slope: f32,
    /// Offset from the parent.
    pub(crate) offset: Vec3,
    /// Unit normal.
    pub(crate) normal: Vec3,
    /// Distance to the nearest collision, as far as it is known.
    pub(crate) clearance: f32,
}

/// A free arc of the circle around a parent, between the particle before it and the particle behind
/// it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arc {
    /// Angle at which a child touches the particle before the arc.
    pub(crate) from: f32,
    /// Angle at which a child touches the particle behind the arc; less than `from` where it does
    /// not fit between them.
    pub(crate) to: f32,
    /// Smallest angle at which a child has room.
    pub(crate) start: f32,
    /// Whether no particle is near and the arc is the whole circle.
    pub(crate) whole: bool,
}

/// Eight neighbours. A lane without a neighbour is infinitely far away.
#[derive(Clone, Copy, Debug)]
struct NeighbourLanes {
    x: Lanes,
    y: Lanes,
    z: Lanes,
    radius: Lanes,
    /// 1 for a neighbour whose radius enters the fit of the gradient of the radius, else 0.
    weight: Lanes,
    /// Direction in the tangent plane.
    angle: Lanes,
    /// Angles within which a neighbour blocks a child, towards smaller and larger angles.
    before: Lanes,
    behind: Lanes,
    /// Angles within which no child has room even if it is pressed in.
    closed_before: Lanes,
    closed_behind: Lanes,
}

const NO_NEIGHBOURS: NeighbourLanes = {
    let (none, far) = (Lanes::splat(0.0), Lanes::splat(f32::INFINITY));
    NeighbourLanes {
        x: far,
        y: far,
        z: far,
        radius: none,
        weight: none,
        angle: none,
        before: none,
        behind: none,
        closed_before: none,
        closed_behind: none,
    }
};

/// The particles of the parent's sheet around it.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParentRing {
    len: usize,
    chunks: Vec<NeighbourLanes>,
    /// Start and end of the closed intervals, sorted by start.
    closed: Vec<(f32, f32)>,
    pub(crate) arcs: Vec<Arc>,
    pub(crate) children: Vec<f32>,
}

impl NeighbourLanes {
    /// Finds, of each particle, the angle to its direction and how far before and behind it no
    /// child fits.
    fn find_closed(&mut self, frame: &ParentFrame) {
        let p = frame.radius;
        for lane in 0..LANES {
            let (x, y, z) = (self.x.0[lane], self.y.0[lane], self.z.0[lane]);
            let fx = x * frame.u.x + y * frame.u.y + z * frame.u.z;
            let fy = x * frame.w.x + y * frame.w.y + z * frame.w.z;
            let rise = x * frame.n.x + y * frame.n.y + z * frame.n.z;
            let flat_sq = fx * fx + fy * fy;
            let distance = (x * x + y * y + z * z).sqrt();
            let inverse = 1.0 / flat_sq.sqrt();
            let (cx, cy) = (fx * inverse, fy * inverse);
            let t = limited(rise / distance, MAX_DIP);
            self.angle.0[lane] = atan2(fy, fx);
            let other = self.radius.0[lane];
            let mut side = [[0.0; 2]; 2];
            for (out, sixty) in side.iter_mut().zip([-SIN_60, SIN_60]) {
                // The child that touches it is about 60° away.
                let (dx, dy) = (0.5 * cx - sixty * cy, sixty * cx + 0.5 * cy);
                let r = frame.child_radius(dx, dy);
                let d = p + r;
                let wide = wedge(d, distance, r + other, frame.dip(dx, dy, d), t);
                let pressed = wide - (1.0 - FIT) * asin(r / d);
                // A particle that no child beside it touches is no neighbour.
                *out = if pressed > 0.0 { [wide, pressed] } else { [NOWHERE; 2] };
            }
            self.before.0[lane] = side[0][0];
            self.behind.0[lane] = side[1][0];
            self.closed_before.0[lane] = side[0][1];
            self.closed_behind.0[lane] = side[1][1];
        }
    }
}

impl ParentRing {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Adds a neighbour by its offset from the parent. `counts` says whether its radius is exact
    /// and enters the fit.
    pub(crate) fn push(&mut self, offset: Vec3, radius: f32, counts: bool) {
        let (chunk, lane) = (self.len / LANES, self.len % LANES);
        if chunk == self.chunks.len() {
            self.chunks.push(NO_NEIGHBOURS);
        }
        let chunk = &mut self.chunks[chunk];
        if lane == 0 {
            *chunk = NO_NEIGHBOURS;
        }
        chunk.x.0[lane] = offset.x;
        chunk.y.0[lane] = offset.y;
        chunk.z.0[lane] = offset.z;
        chunk.radius.0[lane] = radius;
        chunk.weight.0[lane] = if counts { 1.0 } else { 0.0 };
        self.len += 1;
    }

    /// Direction in the tangent plane of neighbour `i`.
    pub(crate) fn angle(&self, i: usize) -> f32 {
        self.chunks[i / LANES].angle.0[i % LANES]
    }

    /// Gradient of the radius in the plane (u, w), fitted to the neighbours whose radius is exact;
    /// what they leave open is as `inherited`.
    pub(crate) fn slope(&self, u: Vec3, w: Vec3, radius: f32, inherited: Vec2) -> Vec2 {
        let mut sums = [Lanes::splat(0.0); 5];
        for chunk in &self.chunks[..self.len.div_ceil(LANES)] {
            for lane in 0..LANES {
                let (x, y, z) = (chunk.x.0[lane], chunk.y.0[lane], chunk.z.0[lane]);
                let counts = chunk.weight.0[lane] > 0.0;
                let fx = if counts { x * u.x + y * u.y + z * u.z } else { 0.0 };
                let fy = if counts { x * w.x + y * w.y + z * w.z } else { 0.0 };
                let dr = if counts { chunk.radius.0[lane] - radius } else { 0.0 };
                sums[0].0[lane] += fx * fx;
                sums[1].0[lane] += fx * fy;
                sums[2].0[lane] += fy * fy;
                sums[3].0[lane] += fx * dr;
                sums[4].0[lane] += fy * dr;
            }
        }
        let [xx, xy, yy, xr, yr] = sums.map(Lanes::sum);
        let pull = SLOPE_PULL * (xx + yy);
        let (a, c) = (xx + pull, yy + pull);
        let (xr, yr) = (xr + pull * inherited.x, yr + pull * inherited.y);
        let slope = Vec2::new(c * xr - xy * yr, a * yr - xy * xr) / (a * c - xy * xy);
        if slope.is_finite() { slope } else { inherited }
    }

    /// Finds the free arcs, in the order of their angles.
    pub(crate) fn find_arcs(&mut self, frame: &ParentFrame) {
        self.closed.clear();
        for (k, chunk) in self.chunks[..self.len.div_ceil(LANES)].iter_mut().enumerate() {
            chunk.find_closed(frame);
            for lane in 0..LANES.min(self.len - k * LANES) {
                let (before, behind) = (chunk.closed_before.0[lane], chunk.closed_behind.0[lane]);
                let angle = chunk.angle.0[lane];
                let (mut start, mut end) = (angle - before, angle + behind);
                if start >= end || before == NOWHERE || behind == NOWHERE {
                    chunk.before.0[lane] = NOWHERE;
                    chunk.behind.0[lane] = NOWHERE;
                    continue;
                }
                if start < 0.0 {
                    (start, end) = (start + TAU, end + TAU);
                }
                let at = self.closed.partition_point(|closed| closed.0 <= start);
                self.closed.insert(at, (start, end));
            }
        }
        self.open_between_closed();
    }

    /// Finds the arcs between the closed ones.
    fn open_between_closed(&mut self) {
        self.arcs.clear();
        if self.closed.is_empty() {
            self.arcs.push(Arc { from: 0.0, to: TAU, start: 0.0, whole: true });
            return;
        }
        let mut reached = self.closed.iter().fold(f32::NEG_INFINITY, |most, c| most.max(c.1)) - TAU;
        for k in 0..self.closed.len() {
            let (start, end) = self.closed[k];
            if start > reached {
                let arc = self.between(reached, start - reached);
                self.arcs.push(arc);
            }
            reached = reached.max(end);
        }
    }

    /// Returns the arc that begins at `start` and is `length` long, with the angles between which a
    /// child touches nothing.
    fn between(&self, start: f32, length: f32) -> Arc {
        let mut from = Lanes::splat(0.0);
        let mut to = Lanes::splat(length);
        for (k, chunk) in self.chunks[..self.len.div_ceil(LANES)].iter().enumerate() {
            for lane in 0..LANES {
                let angle = chunk.angle.0[lane] - start;
                let angle = if angle < 0.0 { angle + TAU } else { angle };
                let angle = if angle < 0.0 { angle + TAU } else { angle };
                let angle = if angle >= TAU { angle - TAU } else { angle };
                let exists = k * LANES + lane < self.len;
                let end = if exists { angle + chunk.behind.0[lane] - TAU } else { 0.0 };
                let begin = if exists { angle - chunk.before.0[lane] } else { length };
                from.0[lane] = if end > from.0[lane] { end } else { from.0[lane] };
                to.0[lane] = if begin < to.0[lane] { begin } else { to.0[lane] };
            }
        }
        let most = from.0.iter().fold(0.0_f32, |a, &b| if b > a { b } else { a });
        let least = to.0.iter().fold(length, |a, &b| if b < a { b } else { a });
        Arc { from: start + most, to: start + least, start, whole: false }
    }

    /// Returns the angles of the children of an arc: as many as fit, evenly spread, so that all
    /// gaps are equally wide.
    pub(crate) fn spread(&mut self, frame: &ParentFrame, arc: Arc) -> &[f32] {
        /// First guess of the angle between two children, in radians: about 60°.
        const SIXTY: f32 = 1.05;
        self.children.clear();
        let mut at = arc.from;
        loop {
            self.children.push(at);
            let mut step = frame.between(at, at + SIXTY);
            step = frame.between(at, at + step);
            let room = (arc.to - at) / step;
            if room.is_nan() || room < CROWDING || self.children.len() > Slots::COUNT {
                break;
            }
            at += step;
        }
        let count = self.children.len();
        if arc.whole {
            // The last one stands where the first one does.
            self.children.pop();
            let stretch = TAU / (at - arc.from);
            self.children.iter_mut().for_each(|angle| *angle *= stretch);
        } else {
            let slack = (arc.to - at) / (count + 1) as f32;
            for (k, angle) in self.children.iter_mut().enumerate() {
                *angle += slack * (k + 1) as f32;
            }
        }
        &self.children
    }

    /// Returns two limits that the neighbours set to a particle at `offset` with the radius
    /// `radius`: the least distance beyond `share` (r_i + r_j), negative where one is nearer, and
    /// the largest radius that the slope `grading` allows beside those whose radius is exact. A
    /// predicted one may be far too small: a limit by it would be handed on from child to child.
    pub(crate) fn limits(&self, offset: Vec3, radius: f32, share: f32, grading: f32) -> (f32, f32) {
        let (ox, oy, oz) = (Lanes::splat(offset.x), Lanes::splat(offset.y), Lanes::splat(offset.z));
        let mut room = Lanes::splat(f32::INFINITY);
        let mut largest = Lanes::splat(f32::INFINITY);
        for chunk in &self.chunks[..self.len.div_ceil(LANES)] {
            let (dx, dy, dz) = (chunk.x - ox, chunk.y - oy, chunk.z - oz);
            let distance = (dx * dx + dy * dy + dz * dz).sqrt();
            let beyond = distance - (chunk.radius + Lanes::splat(radius)) * Lanes::splat(share);
            let allowed = chunk.radius + distance * Lanes::splat(grading);
            for lane in 0..LANES {
                let is_exact = chunk.weight.0[lane] > 0.0;
                let (a, b) = (beyond.0[lane], if is_exact { allowed.0[lane] } else { f32::INFINITY });
                room.0[lane] = if a < room.0[lane] { a } else { room.0[lane] };
                largest.0[lane] = if b < largest.0[lane] { b } else { largest.0[lane] };
            }
        }
        let least = |lanes: Lanes| lanes.0.iter().fold(f32::INFINITY, |a, &b| if b < a { b } else { a });
        (least(room), least(largest))
    }
}

/// Ridge parameter of the fit of the radius's gradient, as a share of the squared distances. A
/// choice.
const SLOPE_PULL: f32 = 0.02;
