//! Sums over the faces of a level.

use super::net::Net;
use crate::math::SQRT_3;
use core::ops::Range;
use glam::Vec3;

/// Sums over faces, which can be interrupted and continued.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    /// Twice the area of the faces.
    coarse: f64,
    /// Twice the area of the four faces that each would be divided into, with lifted middles of
    /// edges.
    fine: f64,
    /// Area of the faces in units of the local wanted face.
    cells: f64,
    /// Length of the border in units of the local wanted spacing.
    pub(super) border: f64,
    /// A corner of the first face that faces against the normal of a corner.
    pub(super) inverted: Option<Vec3>,
    /// A corner of the first face that is stretched.
    pub(super) stretched: Option<Vec3>,
}

/// A face is stretched if its circumcircle is wider than this, relative to the lattice's faces. The
/// front that would replace it has holes of 1.25 to 1.4. Most meshes with a stretched face have
/// another Euler number than their front.
const WIDEST: f32 = 1.33;
/// A face is stretched if it has an angle with a larger cosine: below 30°. The front has angles of
/// 31° to 35°.
const LARGEST_COS: f32 = 0.866;

impl Tally {
    /// Adds the areas of some faces.
    pub(super) fn measure(&mut self, net: &Net, faces: Range<u32>) {
        self.border += net.border_of(faces.clone());
        let twice = |[a, b, c]: [Vec3; 3]| f64::from((b - a).cross(c - a).length());
        for [a, b, c] in faces.filter_map(|f| net.mesh.face(f)) {
            let at = |v: u32| net.position[v as usize];
            let (p, q, r) = (at(a), at(b), at(c));
            let (pq, qr, rp) = (net.middle(a, b), net.middle(b, c), net.middle(c, a));
            let area = twice([p, q, r]);
            self.coarse += area;
            self.fine += twice([pq, qr, rp]) + (twice([p, pq, rp]) + twice([q, qr, pq]) + twice([r, rp, qr]));
            if net.is_graded() {
                let size = f64::from(net.size_of(a) + net.size_of(b) + net.size_of(c)) / 3.0;
                self.cells += 2.0 * area / (SQRT_3 * size * size);
            }
        }
    }

    /// Checks the orientation of some finished faces.
    pub(super) fn inspect(&mut self, net: &Net, faces: Range<u32>) {
        for face in faces.filter_map(|f| net.mesh.face(f)) {
            let area = net.area_vector(face);
            let is_upright = face.iter().all(|&v| net.faces_as(area, v, 0.0));
            if !is_upright && self.inverted.is_none() {
                self.inverted = Some(net.position[face[0] as usize]);
            }
        }
    }

    /// Looks for stretched faces off the border among some faces of one size.
    pub(super) fn inspect_shapes(&mut self, net: &Net, spacing: f32, faces: Range<u32>) {
        let widest = WIDEST * spacing / SQRT_3 as f32;
        for face in faces.filter_map(|f| net.mesh.face(f)) {
            if self.stretched.is_some() || face.iter().any(|&v| net.mesh.is_border(v)) {
                continue;
            }
            let p = face.map(|v| net.position[v as usize]);
            let [a, b, c] = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
            let [la, lb, lc] = [a, b, c].map(Vec3::length);
            let radius = la * lb * lc / (2.0 * a.cross(c).length());
            let largest_cos = [-a.dot(b) / (la * lb), -b.dot(c) / (lb * lc), -c.dot(a) / (lc * la)]
                .into_iter()
                .fold(0.0, f32::max);
            // Written so that NaN counts.
            if !(radius <= widest && largest_cos <= LARGEST_COS) {
                self.stretched = Some(p[0]);
            }
        }
    }

    /// Area of the surface, by Richardson's extrapolation. The area of the faces alone would give
    /// small components too few particles.
    pub(super) fn area(&self) -> f64 {
        0.5 * (4.0 * self.fine - self.coarse) / 3.0
    }

    /// Number of equilateral faces of the wanted sizes that cover the surface, if the spacing is 1.
    pub(super) fn cells(&self) -> f64 {
        self.cells * self.area() / (0.5 * self.coarse)
    }
}
