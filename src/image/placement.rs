//! The affine map from voxel indices to points.

use super::{AxisOrder, ImageError};
use crate::math::{Bounds, Interval, Sym3};
use glam::{DMat3, DVec3};

/// Volume of the cell spanned by three neighbours, as a share of the product of their distances.
/// Below this the axes count as coplanar; a shear by a thousand voxels is still above.
const FLATTEST: f64 = 1e-6;

/// Rounding error of the sums of three products below, with a margin.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// An affine map of voxel indices (i, j, k) to points, with its inverse. It may contain
/// reflections, rotations and shears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    matrix: DMat3,
    inverse: DMat3,
    origin: DVec3,
}

impl Default for Placement {
    /// Indices are coordinates.
    fn default() -> Self {
        Self { matrix: DMat3::IDENTITY, inverse: DMat3::IDENTITY, origin: DVec3::ZERO }
    }
}

impl Placement {
    /// The map with these columns, the steps from voxel to voxel, and voxel (0, 0, 0) at `origin`.
    ///
    /// # Errors
    ///
    /// [`ImageError::Singular`] if the steps are not finite or are coplanar.
    pub fn new(matrix: DMat3, origin: DVec3) -> Result<Self, ImageError> {
        let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let lengths = axes.map(DVec3::length);
        // Divided by each length separately, since their product may overflow or underflow.
        let [x, y, z] = core::array::from_fn(|k: usize| axes[k] / lengths[k]);
        let share = x.cross(y).dot(z).abs();
        let inverse = matrix.inverse();
        let is_usable = share >= FLATTEST && origin.is_finite() && inverse.is_finite();
        if is_usable { Ok(Self { matrix, inverse, origin }) } else { Err(ImageError::Singular { axes }) }
    }

    /// The map with these rows: row r times (i, j, k, 1) is coordinate r of a point.
    ///
    /// # Errors
    ///
    /// As for [`Placement::new`].
    pub fn from_rows(rows: [[f64; 4]; 3]) -> Result<Self, ImageError> {
        let column = |c: usize| DVec3::new(rows[0][c], rows[1][c], rows[2][c]);
        Self::new(DMat3::from_cols(column(0), column(1), column(2)), column(3))
    }

    /// The map of indices that are given in the other order of axes, or in the same one.
    pub(super) fn sorted(&self, order: AxisOrder) -> Self {
        let columns = |m: &DMat3| order.sorted([m.x_axis, m.y_axis, m.z_axis]);
        let [x, y, z] = columns(&self.matrix);
        let [u, v, w] = columns(&self.inverse.transpose());
        Self {
            matrix: DMat3::from_cols(x, y, z),
            inverse: DMat3::from_cols(u, v, w).transpose(),
            origin: self.origin,
        }
    }

    /// The placement whose voxel (0, 0, 0) lies at these indices of this one.
    pub(super) fn at_index(&self, index: DVec3) -> Result<Self, ImageError> {
        Self::new(self.matrix, self.point(index))
    }

    /// The placement with this many times the step from voxel to voxel.
    pub(super) fn coarser(&self, times: f64) -> Result<Self, ImageError> {
        Self::new(self.matrix * times, self.origin)
    }

    /// The point of voxel (0, 0, 0).
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The steps from voxel to voxel, as columns.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// Distances between neighbouring voxels along each axis.
    #[must_use]
    pub fn spacing(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.matrix.col(axis).length())
    }

    /// Unit vectors along the axes.
    #[must_use]
    pub fn directions(&self) -> [DVec3; 3] {
        [0, 1, 2].map(|axis| self.matrix.col(axis) / self.matrix.col(axis).length())
    }

    /// Whether every axis of the image is parallel to an axis of space, in any order and direction.
    #[must_use]
    pub fn is_aligned(&self) -> bool {
        (0..3).all(|axis| self.matrix.col(axis).to_array().iter().filter(|x| **x != 0.0).count() == 1)
    }

    /// The point with these indices.
    #[must_use]
    pub fn point(&self, index: DVec3) -> DVec3 {
        self.matrix * index + self.origin
    }

    /// The indices of a point, which need not be whole.
    #[must_use]
    pub fn index(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.origin)
    }

    /// The box around the points whose indices are in a box.
    #[must_use]
    pub fn points(&self, indices: &Bounds) -> Bounds {
        let corners = indices.corners().map(|corner| self.point(corner));
        Bounds::around(corners)
    }

    /// A box that holds the indices of all points in a box, rounded outward.
    pub(super) fn indices(&self, points: &Bounds) -> Bounds {
        let middle = points.lo() * 0.5 + points.hi() * 0.5;
        let half = points.size() * 0.5;
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let row = self.inverse.row(axis);
            let at = row.dot(middle - self.origin);
            let reach = row.abs().dot(half);
            let slack = ROUNDING * (row.abs().dot(middle.abs() + self.origin.abs() + half));
            (min[axis], max[axis]) = (at - reach - slack, at + reach + slack);
        }
        Bounds { min, max }
    }

    /// The gradient in space of a function with gradient g over indices: `inverse`ᵀ g.
    pub(super) fn gradient(&self, g: DVec3) -> DVec3 {
        DVec3::new(self.inverse.x_axis.dot(g), self.inverse.y_axis.dot(g), self.inverse.z_axis.dot(g))
    }

    /// The Hessian in space of a function with Hessian H over indices: `inverse`ᵀ H `inverse`.
    pub(super) fn hessian(&self, h: &Sym3<f64>) -> Sym3<f64> {
        let columns = [self.inverse.x_axis, self.inverse.y_axis, self.inverse.z_axis];
        let turned = columns.map(|column| h.apply(column));
        let entry = |a: usize, b: usize| columns[a].dot(turned[b]);
        Sym3::by(entry)
    }

    /// Bounds of [`Placement::gradient`].
    pub(super) fn gradient_bounds(&self, g: &[Interval; 3]) -> [Interval; 3] {
        [0, 1, 2].map(|b| {
            let column = self.inverse.col(b).to_array();
            sum((0..3).filter(|&a| column[a] != 0.0).map(|a| g[a] * column[a]))
        })
    }

    /// Bounds of [`Placement::hessian`].
    pub(super) fn hessian_bounds(&self, h: &Sym3<Interval>) -> Sym3<Interval> {
        let entry = |a: usize, b: usize| {
            let (left, right) = (self.inverse.col(a).to_array(), self.inverse.col(b).to_array());
            let terms = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
            sum(terms
                .map(|(i, j)| (left[i] * right[j], h.at(i, j)))
                .filter(|(w, _)| *w != 0.0)
                .map(|(w, x)| x * w))
        };
        Sym3::by(entry)
    }
}

/// The sum of a few intervals, rounded outward.
fn sum(terms: impl Iterator<Item = Interval>) -> Interval {
    let (total, size) = terms
        .fold((Interval::new(0.0, 0.0), 0.0), |(total, size), term| (total + term, size + term.magnitude()));
    total.widened(ROUNDING * size)
}
