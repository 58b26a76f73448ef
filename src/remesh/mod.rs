//! Triangle meshes as fields, to sample the surface of a mesh again with its edges.
//!
//! A [`TriangleMesh`] is [repaired](TriangleMesh::solid) to a [`MeshSolid`], which becomes a
//! [`MeshField`] in one of three ways:
//!
//! * *Parts with edges*. The faces are divided into patches along edges whose faces meet at an
//!   angle (`patches`). Each patch has a smooth function (`patch_function`); f is their maximum at
//!   convex edges and their minimum at concave ones (`parts`, `rule`).
//! * *Scans and smooth shapes*. The signed distance from the mesh, computed on a grid, becomes an
//!   image, and a spline through its voxels is f (`scan`).
//! * *Bodies that may intersect or touch*. Each becomes a field in one of these two ways, and f is
//!   their minimum (`bodies`).

mod bodies;
mod colours;
mod compare;
mod cross;
mod edges;
mod mesh;
mod parts;
mod patch_function;
mod patches;
mod prepare;
mod rim;
mod rule;
mod scan;
mod tree;

pub use compare::{MeshChange, MeshDistances};
pub use mesh::TriangleMesh;
pub use prepare::{MeshRepairs, MeshSolid};

use crate::field::{Combined, Evaluator, Facts, Field, Frame, Jet, Piecewise, Value};
use crate::math::{counted, grouped, significant};
use crate::pointcloud::read::ReadError;
use crate::slices::{self, pause};
use core::f64::consts::PI;
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
    /// There is not one colour for each vertex.
    #[error("there are {count} colours, and {vertices} vertices; give one for each vertex")]
    Colours {
        /// Number of colours.
        count: usize,
        /// Number of vertices.
        vertices: usize,
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
    /// A closed mesh encloses nothing.
    #[error(
        "the mesh is folded flat and encloses no volume; give it a thickness, or leave out one of its two \
         sides"
    )]
    NoVolume,
    /// An open surface has edges with more than two faces.
    #[error(
        "the surface is open and has {} with more than two faces, so that it has no two sides; separate the \
         parts that meet there",
        counted(*count, "edge", "edges")
    )]
    Fans {
        /// Number of edges with more than two faces.
        count: usize,
    },
    /// An open surface has one side only.
    #[error("the surface has only one side, as a Möbius strip has; cut it open along a line across it first")]
    OneSided,
    /// Edges are to be kept, but the mesh is not closed.
    #[error(
        "holes are closed by rounding, and this mesh has {} edges with one face and {} with more than two; \
         keep its borders (--mesh-borders keep, `MeshOptions::borders`) or close it first to keep edges",
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
        "faces intersect near ({}, {}, {}), so that edges and borders cannot be kept; unite the parts \
         first, or have a solid rounded (--mesh-edges none, `MeshEdges::Rounded`)",
        significant(place.x), significant(place.y), significant(place.z)
    )]
    Intersects {
        /// A point where two faces intersect.
        place: DVec3,
    },
    /// The caller asks both to keep edges or borders and to blur them.
    #[error(
        "a Gaussian rounds edges and moves borders: ask for it, or for edges and borders that are kept, not both"
    )]
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
    /// Edges whose faces meet at 30° or more, if the mesh is closed and such edges form curves; all
    /// edges of a patch with hardly more than corners on its border, as of a coarse model. A scan
    /// or a smooth shape keeps no edges. If a mesh consists of up to 32 closed bodies whose boxes
    /// overlap, each is judged by itself, and the edges at which they meet stay sharp.
    #[default]
    Auto,
    /// Edges whose faces meet at this angle or more, in degrees.
    Angle(f64),
    /// No edges: the mesh is treated as a scan.
    Rounded,
}

/// How a mesh becomes a field: see [`MeshSolid::field`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshOptions {
    /// Which edges stay sharp.
    pub edges: MeshEdges,
    /// Whether the surface ends at the borders of the mesh, where an edge has one face. Otherwise
    /// holes are closed smoothly. By default an open surface ends there, such as a leaf, a terrain
    /// or half a sphere, and a solid has its holes closed.
    pub borders: Option<bool>,
    /// Width of a Gaussian in cells of a grid, 0 to 10; giving it treats the mesh as a scan. The
    /// default is 0.7 to 3 cells, depending on the noise of the vertices, and at least 1.5 where
    /// there are sharp edges.
    pub smooth: Option<f64>,
}

impl MeshOptions {
    /// With this choice of sharp edges.
    #[must_use]
    pub fn with_edges(edges: MeshEdges) -> Self {
        Self { edges, ..Self::default() }
    }
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
        /// The border at which the surface ends, if it does.
        rim: Option<MeshRim>,
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
    /// Several closed bodies whose boxes overlap: each became a field by itself, and f is the
    /// minimum of these.
    Union {
        /// Number of bodies.
        bodies: usize,
        /// Sharp edges of all bodies, including those inside of others.
        edges: usize,
    },
}

/// The border of an open surface, which is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshRim {
    /// Number of its edges.
    pub edges: usize,
    /// Number of its closed curves.
    pub loops: usize,
    /// Whether it zigzagged and was smoothed.
    pub is_smoothed: bool,
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
    Union { united: Combined, bodies: Vec<MeshField> },
}

impl MeshSolid {
    /// Makes the field of the mesh.
    ///
    /// # Errors
    ///
    /// [`MeshError::Angle`] and [`MeshError::Width`] if a number is out of range,
    /// [`MeshError::Open`] if edges are to be kept but holes closed, [`MeshError::Intersects`],
    /// [`MeshError::Fans`] and [`MeshError::OneSided`] if the mesh does not allow to keep edges or
    /// borders, and [`MeshError::Narrow`] if a whole scan is narrower than a cell.
    pub fn field(&self, options: &MeshOptions) -> Result<MeshField, MeshError> {
        slices::in_pool(|| slices::complete(self.clone().into_field(*options)))
    }

    /// Number of slices that [`MeshSolid::into_field`] is expected to take.
    pub(crate) fn field_slices(&self) -> u64 {
        cross::slices(self) + if self.is_sheet() { 0 } else { scan::slices(self) }
    }

    /// [`MeshSolid::field`] in slices.
    pub(crate) async fn into_field(self, options: MeshOptions) -> Result<MeshField, MeshError> {
        let MeshOptions { edges, borders, smooth } = options;
        if let Some(width) = smooth.filter(|width| !(0.0..=10.0).contains(width)) {
            return Err(MeshError::Width { width });
        }
        if let MeshEdges::Angle(angle) = edges
            && !EDGE_ANGLES.contains(&angle)
        {
            return Err(MeshError::Angle { angle });
        }
        let is_rimmed = borders.unwrap_or(self.is_sheet()) && self.border_edges() > 0;
        let must_keep = is_rimmed || matches!(edges, MeshEdges::Angle(_)) || self.has_marks();
        if must_keep && smooth.is_some() {
            return Err(MeshError::Both);
        }
        let has_borders = self.border_edges() > 0;
        let may_keep = must_keep || edges == MeshEdges::Auto && smooth.is_none() && !has_borders;
        if may_keep
            && !has_borders
            && let Some(bodies) = self.bodies().await
        {
            return self.united(bodies, options).await;
        }
        if must_keep && !is_rimmed && !self.is_closed() {
            return Err(MeshError::Open { borders: self.border_edges(), fans: self.fan_edges() });
        }
        let may_keep = must_keep || may_keep && self.is_closed();
        let intersection = if may_keep { self.intersection().await } else { None };
        if let Some(place) = intersection.filter(|_| must_keep) {
            return Err(MeshError::Intersects { place: self.origin + place });
        }
        if !may_keep || intersection.is_some() {
            return self.into_scan(smooth).await;
        }
        let faces = self.mesh.faces().len();
        let angle = match edges {
            MeshEdges::Angle(angle) => Some(angle),
            MeshEdges::Rounded => None,
            MeshEdges::Auto if self.has_marks() => Some(DEFAULT_EDGE_ANGLE),
            MeshEdges::Auto => Patches::new(&self, DEFAULT_EDGE_ANGLE.to_radians(), false, (faces, PI))
                .are_of_part()
                .then_some(DEFAULT_EDGE_ANGLE),
        };
        if angle.is_none() && !is_rimmed && !self.has_marks() {
            return self.into_scan(smooth).await;
        }
        // No faces meet at more than 180°.
        let angle = angle.unwrap_or(180.0).to_radians();
        let walled = if is_rimmed { Some(self.walled()?) } else { None };
        let solid = walled.as_ref().map_or(&self, |walled| &walled.solid);
        let faces = walled.as_ref().map_or(faces, |walled| walled.faces);
        pause().await;
        // A border that was smoothed has no corners.
        let is_smoothed = walled.as_ref().is_some_and(|walled| walled.is_smoothed);
        let turn = if is_smoothed { PI } else { DEFAULT_EDGE_ANGLE.to_radians() };
        let keeps_coarse = edges == MeshEdges::Auto && angle < PI;
        let patches = Patches::new(solid, angle, keeps_coarse, (faces, turn)).with_corners(solid);
        pause().await;
        let of_surface =
            |crease: &&patches::Crease| !crease.patches.iter().any(|&patch| patches.is_wall(patch));
        let is_corner = |corner: &&patches::Corner| {
            patches.creases.iter().filter(of_surface).filter(|own| own.ends.contains(&corner.vertex)).count()
                > 2
        };
        let kind = MeshKind::Parts {
            patches: patches.count - patches.is_wall.iter().filter(|&&is_wall| is_wall).count(),
            edges: patches.creases.iter().filter(of_surface).count(),
            corners: patches.corners.iter().filter(is_corner).count(),
            faded: patches.faded,
            rim: walled.as_ref().map(|walled| MeshRim {
                edges: self.border_edges(),
                loops: self.border_loops(),
                is_smoothed: walled.is_smoothed,
            }),
        };
        let function = Function::Parts(PartsField::new(solid, patches, faces).await);
        Ok(MeshField { solid: self, kind, function })
    }

    async fn into_scan(self, smooth: Option<f64>) -> Result<MeshField, MeshError> {
        let (field, Chosen { size, cell, width }) =
            ScanField::new(&self, patches::sharp_count(&self), smooth).await?;
        let kind = MeshKind::Scan { size, cell, smooth: width };
        Ok(MeshField { solid: self, kind, function: Function::Scan(Arc::new(field)) })
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
        let along = |[a, b]: [DVec3; 2]| (0..=EACH).map(move |k| a.lerp(b, f64::from(k) / f64::from(EACH)));
        match &self.function {
            Function::Parts(parts) => parts.segments().flat_map(along).collect(),
            Function::Scan(_) => Vec::new(),
            Function::Union { bodies, .. } => {
                let of_body = |k: usize| {
                    let origin = bodies[k].solid.origin;
                    let own = bodies[k].edge_points().into_iter().map(move |p| origin + p);
                    own.filter(move |&p| self.is_outermost(k, p)).map(|p| p - self.solid.origin)
                };
                (0..bodies.len()).flat_map(of_body).collect()
            }
        }
    }

    /// The fields of the bodies that this field unites; empty if it is the field of one body.
    fn bodies(&self) -> &[Self] {
        if let Function::Union { bodies, .. } = &self.function { bodies } else { &[] }
    }

    /// Whether a point of the surface of body `own` is in no other body.
    fn is_outermost(&self, own: usize, p: DVec3) -> bool {
        /// Depth that counts as on the surface, as a share of the diagonal: the precision of a file
        /// with single-precision numbers.
        const ON: f64 = 1e-6;
        let depth = ON * self.solid.mesh.bounds().diagonal();
        self.bodies().iter().enumerate().all(|(other, body)| other == own || body.value(p) >= -depth)
    }

    fn function(&self) -> &dyn Field {
        match &self.function {
            Function::Parts(field) => field,
            Function::Scan(field) => &**field,
            Function::Union { united, .. } => &**united,
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

    fn columns(&self) -> Vec<(&'static str, Value)> {
        self.solid.colour_values()
    }

    fn operand(&self) -> Option<Arc<dyn Field>> {
        let Function::Parts(parts) = &self.function else { return None };
        Some(Arc::new(parts.continued()?))
    }
}
