//! Which points lie near the border that a clip box cuts into the surface.

use crate::field::Field;
use crate::math::Bounds;
use crate::pieces::piece;
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};

/// Points nearer to the border than this many d_hex are left out of the per-point figures: their neighbourhood is cut.
const MARGIN: f64 = 4.0;
/// Step of the grid on a face, in d_hex: a border sampled that densely seems at most 0.05 % farther than it is at the
/// margin.
const STEP: f64 = 0.25;
/// Most cells of that grid along a side, however small d_hex is: two million evaluations a face.
const MOST_CELLS: f64 = 1500.0;
/// The surface must rise this far beyond a face, in d_hex, before it counts as cut: a surface that touches its box from
/// inside is whole.
const BEYOND: f64 = 0.05;

/// The curves in which the surface leaves a box, as points along them.
#[derive(Debug)]
pub(super) struct Border {
    bounds: Bounds,
    margin: f64,
    curve: Tree,
}

impl Border {
    /// Finds the border on the faces of `bounds` that one of the points of `tree` is near to; the points are spaced by
    /// about `d_hex`.
    pub(super) async fn new(field: &mut dyn Field, bounds: &Bounds, tree: &Tree, d_hex: f64) -> Self {
        let margin = MARGIN * d_hex;
        let mut curve = Vec::new();
        if bounds.is_valid() && margin > 0.0 && margin.is_finite() {
            let mut lo = DVec3::INFINITY;
            let mut hi = DVec3::NEG_INFINITY;
            for p in &tree.position {
                lo = lo.min(p.as_dvec3());
                hi = hi.max(p.as_dvec3());
            }
            for axis in 0..3 {
                let faces = [(lo[axis] - bounds.min[axis], -1.0), (bounds.max[axis] - hi[axis], 1.0)];
                for (_, sign) in faces.into_iter().filter(|face| face.0 < margin) {
                    let mut face = Face::new(bounds, axis, sign, d_hex);
                    for row in 0..=face.rows {
                        face.cross(field, row, &mut curve);
                        piece().await;
                    }
                }
            }
        }
        Self { bounds: *bounds, margin, curve: Tree::new(&curve) }
    }

    /// Whether `p`, a point of the surface, is within the margin of the border, or beyond it.
    pub(super) fn is_near(&self, p: Vec3) -> bool {
        let q = p.as_dvec3();
        let inside = (q - self.bounds.lo()).min(self.bounds.hi() - q).min_element();
        // Rounding may put a point that touches the box outside.
        if inside < -self.margin * (BEYOND / MARGIN) {
            return true;
        }
        let margin_sq = (self.margin * self.margin) as f32;
        self.curve.len() > 0
            && inside <= self.margin
            && self.curve.nearest_sq(p, u32::MAX, margin_sq) < margin_sq
    }
}

/// A face of a box with a grid on it, of which two rows are known at a time.
struct Face {
    axis: usize,
    /// Outward direction along the axis.
    sign: f64,
    d_hex: f64,
    corner: DVec3,
    size: DVec3,
    columns: usize,
    rows: usize,
    points: Vec<Vec3>,
    value: Vec<f32>,
    above: Vec<f32>,
}

impl Face {
    fn new(bounds: &Bounds, axis: usize, sign: f64, d_hex: f64) -> Self {
        let size = bounds.hi() - bounds.lo();
        let cells = |side: usize| (size[side] / (STEP * d_hex)).ceil().clamp(1.0, MOST_CELLS) as usize;
        let (columns, rows) = (cells((axis + 1) % 3), cells((axis + 2) % 3));
        let mut corner = bounds.lo();
        corner[axis] = if sign < 0.0 { bounds.min[axis] } else { bounds.max[axis] };
        let (points, value) = (vec![Vec3::ZERO; columns + 1], vec![0.0; columns + 1]);
        Self {
            axis,
            sign,
            d_hex,
            corner,
            size,
            columns,
            rows,
            points,
            value,
            above: vec![f32::NAN; columns + 1],
        }
    }

    fn place(&self, column: usize, row: usize) -> DVec3 {
        let (along, across) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut p = self.corner;
        p[along] += self.size[along] * (column as f64 / self.columns as f64);
        p[across] += self.size[across] * (row as f64 / self.rows as f64);
        p
    }

    /// Appends where the surface crosses the edges of the grid along a row and from the row before, by sign changes.
    fn cross(&mut self, field: &mut dyn Field, row: usize, curve: &mut Vec<Vec3>) {
        for column in 0..=self.columns {
            self.points[column] = self.place(column, row).as_vec3();
        }
        field.values(&self.points, &mut self.value);
        let mut crossing = |a: DVec3, fa: f32, b: DVec3, fb: f32| {
            // False where either is NaN.
            if fa < 0.0 && fb >= 0.0 || fa >= 0.0 && fb < 0.0 {
                let p = a.lerp(b, f64::from(fa) / (f64::from(fa) - f64::from(fb)));
                if is_cut(field, p, (b - a).length(), self.axis, self.sign, self.d_hex) {
                    curve.push(p.as_vec3());
                }
            }
        };
        for column in 0..=self.columns {
            let p = self.place(column, row);
            if row > 0 {
                crossing(self.place(column, row - 1), self.above[column], p, self.value[column]);
            }
            if column > 0 {
                crossing(self.place(column - 1, row), self.value[column - 1], p, self.value[column]);
            }
        }
        core::mem::swap(&mut self.above, &mut self.value);
    }
}

/// Whether the surface passes near `p`, within a cell of the length `step`, and goes on beyond the face there.
///
/// The surface is followed to second order: from `p` along the unit tangent t that climbs beyond the face with outward
/// normal e, its height is s (t·e) − s² κ (n·e)/2 with the normal curvature κ along t.
fn is_cut(field: &mut dyn Field, p: DVec3, step: f64, axis: usize, sign: f64, d_hex: f64) -> bool {
    let jet = field.jet(p);
    let slope = jet.gradient.length();
    // Not at a pole or a jump, which have sign changes too.
    if jet.value.abs() <= step * slope {
        let normal = jet.gradient / slope;
        let mut outward = DVec3::ZERO;
        outward[axis] = sign;
        let climb = outward - normal * outward.dot(normal);
        let rise = climb.length();
        let tangent = climb / rise;
        let bend = 0.5 * jet.hessian.apply(tangent).dot(tangent) / slope * normal.dot(outward);
        return rise > 0.0 && (bend <= 0.0 || rise * rise / (4.0 * bend) >= BEYOND * d_hex);
    }
    false
}
