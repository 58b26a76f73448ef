//! What a file holds: positions, normals as they are written, faces.

use super::{ReadError, push};
use crate::pointcloud::{Cloud, NormalSource};
use glam::DVec3;

/// Points and faces of a file, before anything is made of them.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions, all finite.
    pub position: Vec<DVec3>,
    /// Normals as they are written, of any length; none, or as many as positions.
    pub normal: Vec<DVec3>,
    /// Corners of all faces, one face after another.
    pub corners: Vec<u32>,
    /// Where the corners of each face end.
    pub faces: Vec<u32>,
    /// Things the user should know, in words.
    pub warnings: Vec<String>,
    /// Twice the sum of the area vectors of the faces round each point.
    area: Vec<DVec3>,
    /// Faces that are in it.
    summed: usize,
}

impl Mesh {
    /// Appends a face; one with fewer than three corners has no area and is left out.
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

    /// Sums the area vectors of up to `budget` more faces; true when all are in. Each corner of a polygon, plane or not, gets
    /// the polygon's.
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

    /// Share of the faces that are summed.
    #[must_use]
    pub fn summed(&self) -> f64 {
        self.summed as f64 / self.faces.len().max(1) as f64
    }

    /// The points with their normals, and what there is to say about them. A point's normal is the one that is written, else
    /// that of its faces; points that have neither, among others that do, are left out. With none anywhere, all points stay
    /// and the cloud has no normals. To be called when all areas are summed.
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
