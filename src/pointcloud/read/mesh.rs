//! Contents of a file: positions, normals and faces.

use super::{ReadError, push};
use crate::field::model::{DEFAULT_CENTRES, GivenMesh, GivenTopology};
use crate::math::{IndexTable, NONE, counted};
use crate::pointcloud::thin::find_or_add;
use crate::pointcloud::{Cloud, NormalSource};
use crate::slices::{MEDIUM, pause};
use crate::topology::Topology;
use glam::DVec3;

/// Number of points that a mesh of large faces gets on them: five for each centre. Fewer: the area
/// of a coarsely meshed ball is less accurate; more do not help.
const ON_FACES: f64 = 5.0 * DEFAULT_CENTRES as f64;

/// Points and faces, as in the file.
#[derive(Clone, Debug, Default)]
pub struct FileMesh {
    /// Positions, all finite.
    pub position: Vec<DVec3>,
    /// Normals as in the file, of any length: one for each position, or none at all.
    pub normal: Vec<DVec3>,
    /// Colours in sRGB, from 0 to 1: one for each position, or none at all.
    pub colour: Vec<[f32; 3]>,
    /// Indices of the corners of all faces, face by face.
    pub corners: Vec<u32>,
    /// Index in `corners` of the end of each face.
    pub faces: Vec<u32>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl FileMesh {
    /// Appends a point with these components. If it `has_normal`, the last three are its normal.
    pub(super) fn add_point(
        &mut self,
        [x, y, z, nx, ny, nz]: [f64; 6],
        has_normal: bool,
    ) -> Result<(), ReadError> {
        push(&mut self.position, DVec3::new(x, y, z))?;
        if has_normal {
            push(&mut self.normal, DVec3::new(nx, ny, nz))?;
        }
        Ok(())
    }

    /// Gives the last point a colour: red, green and blue.
    pub(super) fn add_colour(&mut self, colour: [f64; 3]) -> Result<(), ReadError> {
        self.pad_colours(self.position.len().saturating_sub(1))?;
        push(&mut self.colour, colour.map(|part| part as f32))
    }

    /// Pads the colours with white.
    fn pad_colours(&mut self, count: usize) -> Result<(), ReadError> {
        let missing = count.saturating_sub(self.colour.len());
        self.colour.try_reserve(missing).map_err(|_| ReadError::Memory)?;
        self.colour.extend(core::iter::repeat_n([1.0; 3], missing));
        Ok(())
    }

    /// Makes the colours, if there are any, one for each point and from 0 to 1. In a text they may
    /// be from 0 to 255.
    pub(super) fn complete_colours(&mut self) -> Result<(), ReadError> {
        if self.colour.is_empty() {
            return Ok(());
        }
        self.pad_colours(self.position.len())?;
        let largest = self.colour.as_flattened().iter().copied().fold(0.0, f32::max);
        let most = if largest > 1.0 { 255.0 } else { 1.0 };
        for part in self.colour.as_flattened_mut() {
            *part = if part.is_finite() { (*part / most).clamp(0.0, 1.0) } else { 1.0 };
        }
        Ok(())
    }

    /// Removes the points with a coordinate that is not finite, and their faces, and adds a
    /// warning. A normal that is not finite counts as missing.
    pub(super) fn leave_out_undefined(&mut self) -> Result<(), ReadError> {
        self.normal.iter_mut().filter(|normal| !normal.is_finite()).for_each(|normal| *normal = DVec3::ZERO);
        let (total, before) = (self.position.len(), self.faces.len());
        if self.position.iter().all(|p| p.is_finite()) {
            return Ok(());
        }
        let mut place = Vec::new();
        place.try_reserve_exact(total).map_err(|_| ReadError::Memory)?;
        let mut kept = 0;
        place.extend(self.position.iter().map(|p| {
            if p.is_finite() {
                kept += 1;
                kept - 1
            } else {
                NONE
            }
        }));
        let mut places = place.iter();
        self.normal.retain(|_| places.next() != Some(&NONE));
        let mut places = place.iter();
        self.colour.retain(|_| places.next() != Some(&NONE));
        self.position.retain(|p| p.is_finite());
        let (faces, corners) = (core::mem::take(&mut self.faces), core::mem::take(&mut self.corners));
        let mut from = 0;
        for to in faces {
            let polygon = &corners[core::mem::replace(&mut from, to as usize)..to as usize];
            if polygon.iter().all(|&corner| place[corner as usize] != NONE) {
                polygon.iter().try_for_each(|&corner| push(&mut self.corners, place[corner as usize]))?;
                push(&mut self.faces, self.corners.len() as u32)?;
            }
        }
        let points = total - self.position.len();
        let with = match before - self.faces.len() {
            0 => String::new(),
            count => format!(", and {}", counted(count, "face", "faces")),
        };
        self.warnings.push(format!(
            "Left out for a coordinate that is not a finite number (NaN): {} of {total}{with}.",
            counted(points, "point", "points")
        ));
        Ok(())
    }

    /// Pads the normals with zeros to the number of positions.
    pub(super) fn pad_normals(&mut self) -> Result<(), ReadError> {
        let missing = self.position.len() - self.normal.len();
        self.normal.try_reserve(missing).map_err(|_| ReadError::Memory)?;
        self.normal.resize(self.position.len(), DVec3::ZERO);
        Ok(())
    }

    /// Appends a face. A face with fewer than three corners has no area and is skipped.
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

    /// The points with unit normals, and the warnings for the user. `tell` gets the fraction of the
    /// work done.
    ///
    /// The normal of a point is the one in the file, else the area-weighted mean of its faces'
    /// normals. Points without either are removed; but if no point has a normal, all are kept and
    /// the cloud has no normals.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub async fn into_cloud(mut self, tell: impl Fn(f64)) -> Result<(Cloud, Vec<String>), ReadError> {
        let mut area = self.areas(tell).await?;
        let has_given = !self.normal.is_empty();
        let mut normal = core::mem::take(if has_given { &mut self.normal } else { &mut area });
        let (mut kept, mut given) = (0, false);
        for (i, normal) in normal.iter_mut().enumerate() {
            *normal = normal.normalize_or_zero();
            if *normal != DVec3::ZERO {
                given |= has_given;
            } else if let Some(area) = area.get(i) {
                *normal = area.normalize_or_zero();
            }
            kept += usize::from(*normal != DVec3::ZERO);
        }
        if kept == 0 {
            let cloud =
                Cloud { position: self.position, normal: Vec::new(), source: NormalSource::Estimated };
            return Ok((cloud, self.warnings));
        }
        let left_out = normal.len() - kept;
        if left_out > 0 {
            self.warnings.push(format!(
                "{left_out} of {} points have no normal (no face with an area has them as a corner) and were left out.",
                normal.len()
            ));
        }
        let source = if given { NormalSource::Given } else { NormalSource::FromMesh };
        let mut cloud = Cloud { position: self.position, normal, source };
        cloud.retain_with_normal();
        Ok((cloud, self.warnings))
    }

    /// Points inside faces, in proportion to each face's share of the `total` area, with the
    /// normals of the faces. A surface fitted to the corners alone may leave a large face. Faces
    /// with less than a thousandth of the area get no points.
    pub async fn on_faces(&self, total: f64) -> Cloud {
        /// Steps of the two coordinates of evenly spread points: 1/p and 1/p² with p³ = p + 1 (M.
        /// Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
        const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        let mut inside = Cloud { source: NormalSource::FromMesh, ..Cloud::default() };
        for (k, triangle) in self.triangles().enumerate() {
            if k % MEDIUM == 0 {
                pause().await;
            }
            let area = self.area_vector(triangle);
            let [a, b, c] = triangle.map(|corner| self.position[corner]);
            let Some(mut normal) = area.try_normalize() else { continue };
            // Normals in the file decide which side is outside.
            let given: DVec3 = triangle.iter().filter_map(|&corner| self.normal.get(corner)).sum();
            if given.dot(normal) < 0.0 {
                normal = -normal;
            }
            for k in 1..=(ON_FACES * area.length() / (2.0 * total)) as u32 {
                let [mut u, mut v] = STEPS.map(|step| (f64::from(k) * step).fract());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                inside.position.push(a + (b - a) * u + (c - a) * v);
                inside.normal.push(normal);
            }
        }
        inside
    }

    /// Area and connectivity of the faces; none without faces.
    ///
    /// # Errors
    ///
    /// If there is not enough memory.
    pub async fn given(&self) -> Result<Option<GivenMesh>, ReadError> {
        let (mut table, mut welded, mut triangles) = (IndexTable::default(), Vec::new(), Vec::new());
        let mut area = 0.0;
        for (k, triangle) in self.triangles().enumerate() {
            if k % MEDIUM == 0 {
                pause().await;
            }
            area += 0.5 * self.area_vector(triangle).length();
            let mut corners = [0; 3];
            for (welded_corner, corner) in corners.iter_mut().zip(triangle) {
                // Copies of a corner may differ in their last digits.
                let p = self.position[corner].as_vec3().as_dvec3();
                *welded_corner = find_or_add(&mut table, p, &mut welded).ok_or(ReadError::Memory)?;
            }
            let [a, b, c] = corners;
            if a != b && b != c && c != a {
                push(&mut triangles, corners)?;
            }
        }
        if triangles.is_empty() {
            return Ok(None);
        }
        let topology = Topology::in_slices(&triangles, welded.len()).await;
        let topology = topology.is_manifold().then(|| GivenTopology {
            components: topology.components.len(),
            euler: topology.euler(),
            borders: topology.borders.len(),
        });
        Ok(Some(GivenMesh { area, topology }))
    }

    /// The corners of each face.
    fn polygons(&self) -> impl Iterator<Item = &[u32]> {
        let mut from = 0;
        self.faces
            .iter()
            .map(move |&to| &self.corners[core::mem::replace(&mut from, to as usize)..to as usize])
    }

    /// The triangles into which the faces are divided, as indices of their corners.
    fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        self.polygons().flat_map(|corners| {
            (2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]].map(|corner| corner as usize))
        })
    }

    /// Twice the area of a triangle times its normal.
    fn area_vector(&self, triangle: [usize; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|corner| self.position[corner]);
        (b - a).cross(c - a)
    }

    /// Twice the sum of the area vectors of the faces around each point; empty without faces.
    ///
    /// A polygon need not be planar: each corner gets the area vector of the whole polygon.
    async fn areas(&self, tell: impl Fn(f64)) -> Result<Vec<DVec3>, ReadError> {
        let mut area = Vec::new();
        if self.faces.is_empty() {
            return Ok(area);
        }
        area.try_reserve_exact(self.position.len()).map_err(|_| ReadError::Memory)?;
        area.resize(self.position.len(), DVec3::ZERO);
        for (k, corners) in self.polygons().enumerate() {
            if k.is_multiple_of(MEDIUM) {
                tell(k as f64 / self.faces.len() as f64);
                pause().await;
            }
            let at = |k: usize| self.position[corners[k] as usize];
            let origin = at(0);
            let sum: DVec3 = (2..corners.len()).map(|k| (at(k - 1) - origin).cross(at(k) - origin)).sum();
            for &corner in corners {
                area[corner as usize] += sum;
            }
        }
        Ok(area)
    }
}
