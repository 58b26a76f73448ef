//! Contents of a file: positions, normals and faces.

use super::{ReadError, push};
use crate::pointcloud::{Cloud, NormalSource};
use glam::DVec3;

/// Points and faces as they are in a file.
#[derive(Clone, Debug, Default)]
pub struct FileMesh {
    /// Positions, all finite.
    pub position: Vec<DVec3>,
    /// Normals as they are in the file, of any length: one for each position, or none at all.
    pub normal: Vec<DVec3>,
    /// Indices of the corners of all faces, face by face.
    pub corners: Vec<u32>,
    /// Index in `corners` of the end of each face.
    pub faces: Vec<u32>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Twice the sum of the area vectors of the faces around each point.
    area: Vec<DVec3>,
    /// Number of faces included in `area`.
    summed: usize,
}

impl FileMesh {
    /// Appends a face. One with fewer than three corners has no area and is dropped.
    pub(super) fn add_polygon(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        if corners.len() < 3 {
            return Ok(());
        }
        for &corner in corners {
            push(&mut self.corners, corner)?;
        }
        let end = u32::try_from(self.corners.len()).map_err(|_| ReadError::Memory)?;
        push(&mut self.faces, end)
    }

    /// Adds the area vectors of up to `budget` more faces to those of their corners. Returns whether all faces are
    /// done.
    ///
    /// A polygon need not be planar: each of its corners gets the area vector of the whole.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub fn sum_areas(&mut self, budget: u32) -> Result<bool, ReadError> {
        if self.area.len() < self.position.len() && !self.faces.is_empty() {
            self.area.try_reserve_exact(self.position.len()).map_err(|_| ReadError::Memory)?;
            self.area.resize(self.position.len(), DVec3::ZERO);
        }
        let end = self.faces.len().min(self.summed + budget as usize);
        let mut from = self.summed.checked_sub(1).map_or(0, |before| self.faces[before] as usize);
        for &to in &self.faces[self.summed..end] {
            let corners = &self.corners[from..to as usize];
            from = to as usize;
            let at = |k: usize| self.position[corners[k] as usize];
            let origin = at(0);
            let area: DVec3 = (2..corners.len()).map(|k| (at(k - 1) - origin).cross(at(k) - origin)).sum();
            for &corner in corners {
                self.area[corner as usize] += area;
            }
        }
        self.summed = end;
        Ok(end == self.faces.len())
    }

    /// Fraction of the faces whose areas are summed.
    #[must_use]
    pub fn fraction_summed(&self) -> f64 {
        self.summed as f64 / self.faces.len().max(1) as f64
    }

    /// The points with unit normals, and the warnings for the user. All areas must be summed before.
    ///
    /// The normal of a point is the one in the file, or else the area-weighted mean of those of its faces. If only some
    /// points have neither, these are left out; if none has any, all points are kept and the cloud has no normals.
    #[must_use]
    pub fn into_cloud(mut self) -> (Cloud, Vec<String>) {
        let has_given = !self.normal.is_empty();
        let mut normal = core::mem::take(if has_given { &mut self.normal } else { &mut self.area });
        let (mut kept, mut given) = (0, false);
        for (i, normal) in normal.iter_mut().enumerate() {
            *normal = normal.normalize_or_zero();
            if *normal != DVec3::ZERO {
                given |= has_given;
            } else if let Some(area) = self.area.get(i) {
                *normal = area.normalize_or_zero();
            }
            kept += usize::from(*normal != DVec3::ZERO);
        }
        if kept == 0 {
            let cloud =
                Cloud { position: self.position, normal: Vec::new(), source: NormalSource::Estimated };
            return (cloud, self.warnings);
        }
        let left_out = normal.len() - kept;
        if left_out > 0 {
            self.warnings.push(format!(
                "{left_out} of {} points have no normal (no face with an area has them as a corner) and were left out.",
                normal.len()
            ));
        }
        let mut stays = normal.iter().map(|normal| *normal != DVec3::ZERO);
        self.position.retain(|_| stays.next().unwrap_or(false));
        normal.retain(|normal| *normal != DVec3::ZERO);
        let source = if given { NormalSource::Given } else { NormalSource::FromMesh };
        (Cloud { position: self.position, normal, source }, self.warnings)
    }
}
