//! Triangle meshes as fields, to sample the surface of a mesh again with its edges.
//!
//! A [`TriangleMesh`] is [repaired](TriangleMesh::solid) to a [`MeshSolid`], which becomes a
//! [`MeshField`] in one of two ways:
//!
//! * *Parts with edges*. The faces are divided into patches along edges whose faces meet at an
//!   angle (`patches`). Each patch has a smooth function (`sheet`); f is their maximum at convex
//!   edges and their minimum at concave ones (`parts`, `rule`).
//! * *Scans and smooth shapes*. The signed distance from the mesh, computed on a grid, becomes an
//!   image, and a spline through its voxels is f (`scan`).

mod compare;
mod cross;
mod edges;
mod mesh;
mod parts;
mod patches;
mod prepare;
mod rule;
mod scan;
mod sheet;
mod tree;

pub use compare::{MeshChange, MeshDistances};
pub use mesh::TriangleMesh;
pub use prepare::{MeshRepairs, MeshSolid};

use crate::field::{Evaluator, Facts, Field, Frame, Jet, Piecewise};
use crate::math::{grouped, significant};
use crate::pointcloud::read::ReadError;
use crate::slices;
use core::ops::RangeInclusive;
use glam::DVec3;
use parts::PartsField;
use patches::Patches;
use scan::{Chosen, ScanField};
use std::sync::Arc;

/// Most triangles of a mesh. The search trees of so many take some gigabytes.
pub const MAX_TRIANGLES: usize = 10_000_000;
/// Default angle between faces, in degrees, above which an edge stays sharp. Meshes usually divide
/// arcs into steps of up to about 25°.
pub const DEFAULT_EDGE_ANGLE: f64 = 30.0;
/// Angles that a caller may set, in degrees.
pub const EDGE_ANGLES: RangeInclusive<f64> = 1.0..=180.0;

/// Why a mesh cannot become a field. The message says what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] ReadError),
    /// There are no faces.
    #[error("there are no faces, only points; fit a surface to them (--points, `fit_points`)")]
    NoFaces,
    /// There are too many faces.
    #[error(
        "the mesh has {} triangles, and up to {} are taken; simplify it first",
        grouped(*count), grouped(MAX_TRIANGLES)
    )]
    TooMany {
        /// Number of faces.
        count: usize,
    },
    /// A face has a corner that is no vertex.
    #[error("face {face} has a corner {index}, and there are {count} vertices, counted from 0")]
    Index {
        /// Index of the face.
        face: usize,
        /// The corner.
        index: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A vertex is not finite or is beyond ±1e30.
    #[error("vertex {vertex}, counted from 0, is not finite or beyond ±1e30; give it a place")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// The mesh is far from the origin for its size.
    #[error(
        "the mesh lies more than 1,000 of its diagonals from the origin, where single precision shows no \
         particle in its place; move it to the origin first"
    )]
    Far,
    /// No face has an area.
    #[error("no face of the mesh has an area; check its vertices and its unit")]
    NoArea,
    /// The mesh encloses nothing.
    #[error(
        "the mesh is a sheet that encloses no volume, with {} edges at its border; give it a thickness \
         first, or fit a surface to its points (--points, `fit_points`)",
        grouped(*borders)
    )]
    Sheet {
        /// Number of edges with one face.
        borders: usize,
    },
    /// Edges are to be kept, but the mesh is not closed.
    #[error(
        "edges are kept of closed meshes, and this one has {} edges with one face and {} with more than \
         two; close it first, or have it rounded (--mesh-edges none, `MeshEdges::Rounded`)",
        grouped(*borders), grouped(*fans)
    )]
    Open {
        /// Number of edges with one face.
        borders: usize,
        /// Number of edges with more than two faces.
        fans: usize,
    },
    /// Edges are to be kept, but faces of the mesh intersect.
    #[error(
        "faces intersect near ({}, {}, {}), so that edges cannot be kept; unite the parts first, or have \
         the mesh rounded (--mesh-edges none, `MeshEdges::Rounded`)",
        significant(place.x), significant(place.y), significant(place.z)
    )]
    Intersects {
        /// A point where two faces intersect.
        place: DVec3,
    },
    /// The caller asks both to keep edges and to blur them.
    #[error("a Gaussian is for scans: give its width or an angle of edges, and not both")]
    Both,
    /// The angle of edges is out of its range.
    #[error("the angle of edges is {angle}°, and can be from 1° to 180°")]
    Angle {
        /// The angle in degrees.
        angle: f64,
    },
    /// The whole mesh is narrower than a cell of the grid.
    #[error(
        "all of the mesh is narrower than {}, a cell of the grid that a scan is put on; keep its edges \
         (--mesh-edges 30, `MeshEdges::Angle`)",
        significant(*cell)
    )]
    Narrow {
        /// Width of a cell.
        cell: f64,
    },
    /// The width of the Gaussian is out of its range.
    #[error("the width {width} of the Gaussian is not between 0 and 10 cells")]
    Width {
        /// The width in cells of the grid.
        width: f64,
    },
}

/// Which edges of a mesh stay sharp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MeshEdges {
    /// Edges whose faces meet at 30° or more, if the mesh is closed, its faces do not intersect,
    /// and such edges form curves. A scan or a smooth shape keeps no edges.
    #[default]
    Auto,
    /// Edges whose faces meet at this angle or more, in degrees.
    Angle(f64),
    /// No edges: the mesh is treated as a scan.
    Rounded,
}

/// How a mesh became a field.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshKind {
    /// Smooth patches between sharp edges.
    Parts {
        /// Number of patches.
        patches: usize,
        /// Edges of the mesh at which two patches meet.
        edges: usize,
        /// Vertices where three or more of these edges meet.
        corners: usize,
        /// Sharp edges that fade out within a patch, and are rounded.
        faded: usize,
    },
    /// The signed distance on a grid.
    Scan {
        /// Voxels along each axis.
        size: [usize; 3],
        /// Width of a cell.
        cell: f64,
        /// Width of the Gaussian in cells.
        smooth: f64,
    },
}

/// The field of a mesh, from [`MeshSolid::field`]: near the surface it is the signed distance. It
/// can be [combined](crate::difference) with other fields, and [offset](crate::offset).
///
/// Without bounds over boxes the number of components is not proven. Copies share its data.
#[derive(Clone, Debug)]
pub struct MeshField {
    solid: MeshSolid,
    kind: MeshKind,
    function: Function,
}

#[derive(Clone, Debug)]
enum Function {
    Parts(PartsField),
    Scan(Arc<ScanField>),
}

impl MeshSolid {
    /// Makes the field of the mesh. `smooth` is the width of a Gaussian in cells of a grid, 0 to
    /// 10; giving it treats the mesh as a scan. The default is 0.7 to 3 cells, depending on the
    /// noise of the vertices, and at least 1.5 where there are sharp edges.
    ///
    /// # Errors
    ///
    /// [`MeshError::Angle`] and [`MeshError::Width`] if a number is out of range,
    /// [`MeshError::Open`] if edges are to be kept but the mesh is not closed, and
    /// [`MeshError::Narrow`] if a whole scan is narrower than a cell.
    pub fn field(&self, edges: MeshEdges, smooth: Option<f64>) -> Result<MeshField, MeshError> {
        slices::in_pool(|| slices::complete(self.clone().field_in_slices(edges, smooth)))
    }

    /// [`MeshSolid::field`] in slices of work.
    pub(crate) async fn field_in_slices(
        self,
        edges: MeshEdges,
        smooth: Option<f64>,
    ) -> Result<MeshField, MeshError> {
        if let Some(width) = smooth.filter(|width| !(0.0..=10.0).contains(width)) {
            return Err(MeshError::Width { width });
        }
        let usual = DEFAULT_EDGE_ANGLE.to_radians();
        let may_keep = edges != MeshEdges::Rounded && smooth.is_none() && self.is_closed();
        let intersection = if may_keep { self.intersection().await } else { None };
        let patches = match edges {
            MeshEdges::Auto if may_keep && intersection.is_none() => {
                Some(Patches::new(&self, usual)).filter(Patches::are_of_part)
            }
            MeshEdges::Auto | MeshEdges::Rounded => None,
            MeshEdges::Angle(angle) => {
                if !EDGE_ANGLES.contains(&angle) {
                    return Err(MeshError::Angle { angle });
                }
                if smooth.is_some() {
                    return Err(MeshError::Both);
                }
                if !self.is_closed() {
                    return Err(MeshError::Open { borders: self.border_edges(), fans: self.fan_edges() });
                }
                if let Some(place) = intersection {
                    return Err(MeshError::Intersects { place: self.origin + place });
                }
                Some(Patches::new(&self, angle.to_radians()))
            }
        };
        let (kind, function) = match patches.map(|patches| patches.with_corners(&self)) {
            Some(patches) => {
                let kind = MeshKind::Parts {
                    patches: patches.count,
                    edges: patches.creases.len(),
                    corners: patches.corners.len(),
                    faded: patches.faded,
                };
                (kind, Function::Parts(PartsField::new(&self, patches)))
            }
            None => {
                let (field, Chosen { size, cell, width }) =
                    ScanField::made(&self, patches::sharp_count(&self), smooth).await?;
                (MeshKind::Scan { size, cell, smooth: width }, Function::Scan(Arc::new(field)))
            }
        };
        Ok(MeshField { solid: self, kind, function })
    }
}

impl MeshField {
    /// The repaired mesh from which the field was made.
    #[must_use]
    pub fn solid(&self) -> &MeshSolid {
        &self.solid
    }

    /// How the mesh became this field.
    #[must_use]
    pub fn kind(&self) -> MeshKind {
        self.kind
    }

    /// Points along the sharp edges, relative to the origin of the mesh.
    fn edge_points(&self) -> Vec<DVec3> {
        /// Points on each edge of the mesh.
        const EACH: u32 = 8;
        let Function::Parts(parts) = &self.function else { return Vec::new() };
        let along = |[a, b]: &[DVec3; 2]| {
            let (a, b) = (*a, *b);
            (0..=EACH).map(move |k| a.lerp(b, f64::from(k) / f64::from(EACH)))
        };
        parts.segments().iter().flat_map(along).collect()
    }

    fn function(&self) -> &dyn Field {
        match &self.function {
            Function::Parts(field) => field,
            Function::Scan(field) => &**field,
        }
    }
}

impl Field for MeshField {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        self.function().value_and_gradient(p)
    }

    fn value(&self, p: DVec3) -> f64 {
        self.function().value(p)
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.function().jet(p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        self.function().evaluator(frame)
    }

    fn facts(&self) -> Facts {
        self.function().facts()
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        self.function().piecewise()
    }

    fn is_smooth(&self) -> bool {
        self.function().is_smooth()
    }
}
