//! Triangle meshes: vertices, faces, area and volume.

use super::{MAX_TRIANGLES, MeshError};
use crate::image::opened;
use crate::math::Bounds;
use crate::pointcloud::read::{FileMesh, Reader};
use crate::slices;
use glam::DVec3;
use std::io;
use std::path::Path;

/// A triangle mesh, as a file or a program gives it.
///
/// ```
/// use marching_particles::glam::dvec3;
/// use marching_particles::remesh::MeshOptions;
/// use marching_particles::{Settings, TriangleMesh, sample};
///
/// // A tetrahedron, whose corners and edges are kept.
/// let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
/// let corners = corners.map(|[x, y, z]| dvec3(x.into(), y.into(), z.into()));
/// let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
/// let solid = TriangleMesh::new(corners.to_vec(), faces.to_vec())?.solid()?;
/// let sample = sample(solid.field(&MeshOptions::default())?, &Settings::with_count(1_000))?;
/// assert_eq!(sample.mesh().topology.euler(), 2);
/// assert_eq!(sample.report().proof.creases, Some(6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    /// One for each vertex, or none at all.
    colours: Vec<[f32; 3]>,
    notes: Vec<String>,
}

impl TriangleMesh {
    /// The mesh with these vertices, in any unit of length, and these faces: three vertex indices
    /// each, counter-clockwise seen from outside.
    ///
    /// # Errors
    ///
    /// [`MeshError::NoFaces`], [`TooMany`](MeshError::TooMany), [`Index`](MeshError::Index) or
    /// [`NotFinite`](MeshError::NotFinite).
    pub fn new(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if faces.is_empty() {
            return Err(MeshError::NoFaces);
        }
        if faces.len() > MAX_TRIANGLES {
            return Err(MeshError::TooMany { count: faces.len() });
        }
        let count = vertices.len();
        for (face, corners) in faces.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= count) {
                return Err(MeshError::Index { face, index, count });
            }
        }
        // Areas and volumes of larger numbers overflow.
        let is_usable = |p: &DVec3| p.is_finite() && p.abs().max_element() < 1e30;
        if let Some(vertex) = vertices.iter().position(|p| !is_usable(p)) {
            return Err(MeshError::NotFinite { vertex });
        }
        Ok(Self::of_parts(vertices, faces))
    }

    /// With these colours of its vertices: red, green and blue in sRGB, from 0 to 1. [`MeshSolid`]
    /// has the colour at any place.
    ///
    /// # Errors
    ///
    /// [`MeshError::Colours`] unless there is one for each vertex.
    ///
    /// [`MeshSolid`]: crate::remesh::MeshSolid
    pub fn with_colours(self, colours: Vec<[f32; 3]>) -> Result<Self, MeshError> {
        if colours.len() != self.vertices.len() {
            return Err(MeshError::Colours { count: colours.len(), vertices: self.vertices.len() });
        }
        Ok(Self { colours, ..self })
    }

    /// Opens the file of a mesh: see [`TriangleMesh::read`].
    ///
    /// # Errors
    ///
    /// If the file cannot be opened; as for [`TriangleMesh::read`] with
    /// [`io::ErrorKind::InvalidData`]. The message begins with the path.
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        opened(path.as_ref(), Self::read)
    }

    /// Reads a mesh from an STL, OBJ, PLY, OFF, GLB or 3MF file; the content decides which.
    /// Polygons are divided into triangles from their first corner.
    ///
    /// # Errors
    ///
    /// [`MeshError::File`] if the file cannot be read, [`MeshError::NoFaces`] if it holds only
    /// points, and the errors of [`TriangleMesh::new`].
    pub fn read(name: &str, bytes: Vec<u8>) -> Result<Self, MeshError> {
        slices::complete(Self::reading(name, bytes))
    }

    /// [`TriangleMesh::read`] in slices.
    pub(crate) async fn reading(name: &str, bytes: Vec<u8>) -> Result<Self, MeshError> {
        let reader = Reader::of_mesh(name, bytes)?;
        let FileMesh { position, colour, corners, faces, warnings, .. } = reader.read(|_| ()).await?;
        let mut triangles = Vec::new();
        let mut from = 0;
        for to in faces {
            let polygon = &corners[core::mem::replace(&mut from, to as usize)..to as usize];
            triangles.extend((2..polygon.len()).map(|k| [polygon[0], polygon[k - 1], polygon[k]]));
        }
        Ok(Self { colours: colour, notes: warnings, ..Self::new(position, triangles)? })
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The faces, as indices of their corners.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The colours of the vertices, red, green and blue in sRGB from 0 to 1; empty if the mesh has
    /// none. They are read from PLY, OBJ, OFF and GLB files.
    #[must_use]
    pub fn colours(&self) -> &[[f32; 3]] {
        &self.colours
    }

    /// What the reader left out of the file, in sentences for the user.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The area of all faces.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area_vectors().map(|vector| vector.length()).sum()
    }

    /// The volume that the faces enclose, negative if they face inward. For an open mesh it depends
    /// on the origin.
    #[must_use]
    pub fn volume(&self) -> f64 {
        volume(&self.vertices, self.faces.iter())
    }

    /// The box of the faces.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.faces.iter().flat_map(|face| self.corners(face)))
    }

    pub(super) fn corners(&self, face: &[u32; 3]) -> [DVec3; 3] {
        face.map(|corner| self.vertices[corner as usize])
    }

    pub(super) fn all_corners(&self) -> Vec<[DVec3; 3]> {
        self.faces.iter().map(|face| self.corners(face)).collect()
    }

    /// Half the cross product of two sides of each face: its area times its normal.
    pub(super) fn area_vectors(&self) -> impl Iterator<Item = DVec3> {
        self.faces.iter().map(|face| {
            let [a, b, c] = self.corners(face);
            0.5 * (b - a).cross(c - a)
        })
    }

    /// The mesh of these faces of prepared vertices.
    pub(super) fn of_parts(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Self {
        Self { vertices, faces, colours: Vec::new(), notes: Vec::new() }
    }
}

/// The volume that faces enclose. It is summed about one of their vertices, so that no digits are
/// lost far from the origin.
pub(super) fn volume<'a>(vertices: &[DVec3], mut faces: impl Iterator<Item = &'a [u32; 3]>) -> f64 {
    let Some(first) = faces.next() else { return 0.0 };
    let origin = vertices[first[0] as usize];
    faces
        .map(|face| {
            let [a, b, c] = face.map(|corner| vertices[corner as usize] - origin);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}
