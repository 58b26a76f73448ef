//! The border along which a clip box cuts the surface, and the points near it.

use crate::field::Evaluator;
use crate::math::{Bounds, NONE};
use crate::slices;
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};

/// Points nearer to the border than this many d_hex are left out of the figures per point, since
/// their neighbourhood is cut. Smaller: `cover` comes out larger; larger: the figures are based on
/// fewer points.
const MARGIN: f64 = 4.0;
/// Step of the grid on a face, in d_hex. Sampled this densely, the border seems at most 0.05 %
/// farther away than it is, at the distance of the margin.
const STEP: f64 = 0.25;
/// Largest number of cells of that grid along a side, which limits the evaluations to two million
/// for each face.
const MOST_CELLS: f64 = 1500.0;
/// Distance that the surface must reach beyond a face to count as cut, in d_hex: a surface that
/// touches its box from inside is whole.
const BEYOND: f64 = 0.05;

/// The curves along which the surface leaves a box, as points on them.
#[derive(Debug)]
pub(super) struct Border {
    bounds: Bounds,
    margin: f64,
    curve: Tree,
}

impl Border {
    /// Finds the border on those faces of `bounds` that are near a point of `tree`; the points have
    /// a spacing of about `d_hex`.
    pub(super) async fn new(field: &dyn Evaluator, bounds: &Bounds, tree: &Tree, d_hex: f64) -> Self {
        let margin = MARGIN * d_hex;
        let mut curve = Vec::new();
        if bounds.is_valid() && margin > 0.0 && margin.is_finite() {
            let own = Bounds::around(tree.position.iter().map(|p| p.as_dvec3()));
            for axis in 0..3 {
                let faces =
                    [(own.min[axis] - bounds.min[axis], -1.0), (bounds.max[axis] - own.max[axis], 1.0)];
                for (_, sign) in faces.into_iter().filter(|face| face.0 < margin) {
                    curve.extend(Face::new(bounds, axis, sign, d_hex).crossings(field).await);
                }
            }
        }
        Self { bounds: *bounds, margin, curve: Tree::new(&curve) }
    }

    /// Returns whether `p`, a point of the surface, is within the margin of the border or beyond
    /// the border.
    pub(super) fn is_near(&self, p: Vec3) -> bool {
        let q = p.as_dvec3();
        let inside = (q - self.bounds.lo()).min(self.bounds.hi() - q).min_element();
        // Rounding may put a point that touches the box outside.
        if inside < -self.margin * (BEYOND / MARGIN) {
            return true;
        }
        let margin_sq = (self.margin * self.margin) as f32;
        self.curve.len() > 0 && inside <= self.margin && self.curve.nearest_sq(p, NONE, margin_sq) < margin_sq
    }
}

/// A face of a box with a grid.
struct Face {
    axis: usize,
    /// Outward direction along the axis, 1 or −1.
    sign: f64,
    d_hex: f64,
    corner: DVec3,
    size: DVec3,
    columns: usize,
    rows: usize,
}

impl Face {
    fn new(bounds: &Bounds, axis: usize, sign: f64, d_hex: f64) -> Self {
        let size = bounds.hi() - bounds.lo();
        let cells = |side: usize| (size[side] / (STEP * d_hex)).ceil().clamp(1.0, MOST_CELLS) as usize;
        let (columns, rows) = (cells((axis + 1) % 3), cells((axis + 2) % 3));
        let mut corner = bounds.lo();
        corner[axis] = if sign < 0.0 { bounds.min[axis] } else { bounds.max[axis] };
        Self { axis, sign, d_hex, corner, size, columns, rows }
    }

    /// Returns a node of the grid.
    fn node(&self, column: usize, row: usize) -> DVec3 {
        let (along, across) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut p = self.corner;
        p[along] += self.size[along] * (column as f64 / self.columns as f64);
        p[across] += self.size[across] * (row as f64 / self.rows as f64);
        p
    }

    /// The points of the border on the edges of the grid.
    async fn crossings(&self, field: &dyn Evaluator) -> Vec<Vec3> {
        let of_row = |field: &mut dyn Evaluator, row: usize| {
            let nodes: Vec<Vec3> =
                (0..=self.columns).map(|column| self.node(column, row).as_vec3()).collect();
            let mut value = vec![0.0; nodes.len()];
            field.values(&nodes, &mut value);
            value
        };
        let rows = self.rows + 1;
        let new_scratch = || field.another();
        let values =
            slices::map(rows, 1, new_scratch, |field, range| of_row(&mut **field, range.start)).await;
        let crossings = slices::map(rows, 1, new_scratch, |field, range| {
            let row = range.start;
            self.crossings_at(&mut **field, row, &values[row.saturating_sub(1)], &values[row])
        });
        crossings.await.concat()
    }

    /// The points of the border on the edges of a row of the grid and on those from the row before,
    /// whose values are `above`.
    fn crossings_at(&self, field: &mut dyn Evaluator, row: usize, above: &[f32], value: &[f32]) -> Vec<Vec3> {
        let mut found = Vec::new();
        let mut add = |a: [usize; 2], fa: f32, b: [usize; 2], fb: f32| {
            let [a, b] = [a, b].map(|[column, row]| self.node(column, row));
            let p = a.lerp(b, f64::from(fa) / (f64::from(fa) - f64::from(fb)));
            if is_cut(field, p, (b - a).length(), self.axis, self.sign, self.d_hex) {
                found.push(p.as_vec3());
            }
        };
        // This is false if either is NaN.
        let changes = |fa: f32, fb: f32| fa < 0.0 && fb >= 0.0 || fa >= 0.0 && fb < 0.0;
        for column in 0..=self.columns {
            if row > 0 && changes(above[column], value[column]) {
                add([column, row - 1], above[column], [column, row], value[column]);
            }
            if column > 0 && changes(value[column - 1], value[column]) {
                add([column - 1, row], value[column - 1], [column, row], value[column]);
            }
        }
        found
    }
}

/// Returns whether the surface passes `p` within a cell of length `step` and continues beyond the
/// face there.
///
/// The surface is approximated to second order. From `p` along the unit tangent t that rises
/// fastest beyond the face, whose outward normal is e, the height over the face is s (t·e) − s² κ
/// (n·e)/2, where κ is the normal curvature along t.
fn is_cut(field: &mut dyn Evaluator, p: DVec3, step: f64, axis: usize, sign: f64, d_hex: f64) -> bool {
    let jet = field.jet(p);
    let slope = jet.gradient.length();
    // This excludes poles and jumps, where the sign changes too.
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
