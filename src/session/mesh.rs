//! The surface of a triangle mesh as the field of a session, and the distance of a new mesh from
//! it.

use serde::Serialize;

/// The triangle mesh that is sampled, and what was made of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshInfo {
    /// Name of the file or the array.
    pub name: String,
    /// Number of vertices after the repairs.
    pub vertices: usize,
    /// Number of faces after the repairs.
    pub faces: usize,
    /// Number of pieces that are not connected by edges of two faces.
    pub pieces: usize,
    /// Number of edges of borders, which have one face.
    pub border_edges: usize,
    /// Number of edges with more than two faces.
    pub fan_edges: usize,
    /// The repairs, in words.
    pub mended: Vec<String>,
    /// Whether it has colours, which become values at the particles.
    pub has_colours: bool,
    /// What the reader left out, in sentences.
    pub notes: Vec<String>,
    /// The smooth patches, if it counts as a part with sharp edges.
    pub part: Option<MeshPart>,
    /// The grid, if it counts as a scan.
    pub scan: Option<MeshScan>,
    /// The bodies, if several may intersect or touch.
    pub union: Option<MeshUnion>,
}

/// The union of closed bodies whose boxes overlap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshUnion {
    /// Number of bodies.
    pub bodies: usize,
    /// Sharp edges of all bodies, including those inside of others.
    pub edges: usize,
}

/// Smooth patches between sharp edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshPart {
    /// Number of patches.
    pub patches: usize,
    /// Edges of the mesh at which two patches meet.
    pub edges: usize,
    /// Vertices at which three or more of these meet.
    pub corners: usize,
    /// Sharp edges that fade out within a patch, and are rounded.
    pub faded: usize,
    /// The border at which the surface ends, if it does.
    pub rim: Option<MeshBorder>,
}

/// The border of an open surface, which is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshBorder {
    /// Number of its edges.
    pub edges: usize,
    /// Number of its closed curves.
    pub loops: usize,
    /// Whether it zigzagged and was smoothed.
    pub is_smoothed: bool,
}

/// The distance from a mesh on a grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshScan {
    /// Voxels along each axis.
    pub size: [usize; 3],
    /// Width of a cell.
    pub cell: f64,
    /// Width of the Gaussian in cells.
    pub smooth: f64,
}

#[cfg(all(feature = "images", feature = "points"))]
pub use with_meshes::OpenedMesh;
#[cfg(all(feature = "images", feature = "points"))]
pub(super) use with_meshes::{Comparison, MeshSurface};

#[cfg(all(feature = "images", feature = "points"))]
mod with_meshes {
    use super::super::opened::{Surface, Wanted};
    use super::super::{FieldAnswer, FieldRequest, Session, Source};
    use super::{MeshBorder, MeshInfo, MeshPart, MeshScan, MeshUnion};
    use crate::export::{MeshBuffers, Vertices};
    use crate::field::formula::Parameter;
    use crate::remesh::{
        MeshChange, MeshEdges, MeshError, MeshField, MeshKind, MeshOptions, MeshRim, MeshSolid, TriangleMesh,
    };
    use crate::session::{Fault, FaultKind};
    use crate::slices::{self, Work};
    use glam::DVec3;
    use std::collections::BTreeMap;
    use std::sync::Arc;

    /// The names of the choices among the parameters of a request.
    const NAMES: [&str; 3] = ["edges", "borders", "smooth"];

    /// An opened triangle mesh, repaired once for all choices.
    #[derive(Clone, Debug)]
    pub struct OpenedMesh {
        solid: MeshSolid,
        notes: Arc<[String]>,
    }

    impl OpenedMesh {
        /// Repairs a mesh.
        ///
        /// # Errors
        ///
        /// [`FaultKind::Mesh`] or [`FaultKind::NoSolid`].
        pub fn new(mesh: &TriangleMesh) -> Result<Self, Fault> {
            slices::complete(Self::mended(mesh)).map_err(|error| fault_of(&error))
        }

        /// Reads and repairs the mesh of a file: see [`TriangleMesh::read`].
        ///
        /// # Errors
        ///
        /// [`FaultKind::Mesh`], [`FaultKind::NoFaces`] or [`FaultKind::NoSolid`].
        pub fn read(name: &str, bytes: Vec<u8>) -> Result<Self, Fault> {
            slices::complete(Self::read_in_slices(name.to_owned(), bytes))
        }

        /// [`OpenedMesh::read`] in slices of work.
        ///
        /// # Errors
        ///
        /// As for [`OpenedMesh::read`].
        pub async fn read_in_slices(name: String, bytes: Vec<u8>) -> Result<Self, Fault> {
            let opened = async { Self::mended(&TriangleMesh::reading(&name, bytes).await?).await };
            opened.await.map_err(|error| fault_of(&error))
        }

        async fn mended(mesh: &TriangleMesh) -> Result<Self, MeshError> {
            Ok(Self { solid: mesh.mended().await?, notes: mesh.notes().into() })
        }

        /// [`MeshSolid::with_edges_along`] these segments, for the next field of the mesh.
        #[must_use]
        pub fn with_edges_along(self, segments: &[[DVec3; 2]]) -> Self {
            Self { solid: self.solid.with_edges_along(segments), ..self }
        }

        /// The repaired mesh.
        #[must_use]
        pub fn solid(&self) -> &MeshSolid {
            &self.solid
        }

        /// Expected number of slices to make a field.
        pub(in super::super) fn field_slices(&self) -> u64 {
            self.solid.field_slices()
        }

        pub(in super::super) fn notes(&self) -> &[String] {
            &self.notes
        }

        pub(in super::super) fn is_same(&self, other: &Self) -> bool {
            self.solid.is_same(&other.solid)
        }
    }

    /// The error without the terms that other programs use.
    fn fault_of(error: &MeshError) -> Fault {
        let kind = match error {
            MeshError::NoFaces => FaultKind::NoFaces,
            MeshError::NoVolume => FaultKind::NoSolid,
            _ => FaultKind::Mesh,
        };
        let text = error.to_string();
        let plain = match (text.find(" (--"), text.find('`')) {
            (Some(from), Some(_)) => match text[from..].find(')') {
                Some(to) => format!("{}{}", &text[..from], &text[from + to + 1..]),
                None => text,
            },
            _ => text,
        };
        Fault::new(kind, &plain)
    }

    /// The surface of a mesh.
    #[derive(Clone)]
    pub(in super::super) struct MeshSurface {
        pub(in super::super) mesh: OpenedMesh,
        pub(in super::super) field: MeshField,
        options: MeshOptions,
    }

    impl MeshSurface {
        /// The surface of a choice, unless it is the one `before`, made in slices of work.
        pub(in super::super) async fn made(
            mesh: OpenedMesh,
            options: MeshOptions,
            before: Option<Self>,
        ) -> Result<Self, Fault> {
            let is_same = |before: &Self| before.mesh.is_same(&mesh) && before.options == options;
            if let Some(before) = before.filter(is_same) {
                return Ok(before);
            }
            let field = mesh.solid.clone().into_field(options).await.map_err(|error| fault_of(&error))?;
            Ok(Self { mesh, field, options })
        }

        /// The named values that make the choice.
        pub(in super::super) fn choice(&self) -> impl Iterator<Item = (&'static str, f64)> {
            let angle = match self.options.edges {
                MeshEdges::Auto => None,
                MeshEdges::Angle(angle) => Some(angle),
                MeshEdges::Rounded => Some(0.0),
            };
            let borders = self.options.borders.map(|is_kept| f64::from(u8::from(is_kept)));
            let values = [angle, borders, self.options.smooth];
            NAMES.into_iter().zip(values).filter_map(|(name, value)| Some((name, value?)))
        }

        /// The slider of the surface: the Gaussian of a scan, or the angle of edges that was asked
        /// for.
        pub(in super::super) fn parameters(&self) -> Vec<Parameter> {
            let slider = |name: &'static str, label: &'static str, value: f64, [min, max, step]: [f64; 3]| {
                vec![Parameter {
                    name: name.into(),
                    label: label.into(),
                    value,
                    min,
                    max: f64::max(max, value),
                    step,
                }]
            };
            match (self.field.kind(), self.options.edges) {
                (MeshKind::Scan { smooth, .. }, _) => slider("smooth", "Smoothing", smooth, [0.0, 10.0, 0.1]),
                (_, MeshEdges::Angle(angle)) => slider("edges", "Edges from", angle, [1.0, 90.0, 1.0]),
                _ => Vec::new(),
            }
        }
    }

    impl MeshInfo {
        /// The description of a field from a mesh of this name, with the reader's `notes`.
        pub fn new(name: &str, notes: &[String], field: &MeshField) -> Self {
            let solid = field.solid();
            let border = |MeshRim { edges, loops, is_smoothed, .. }| MeshBorder { edges, loops, is_smoothed };
            let (mut part, mut scan, mut union) = (None, None, None);
            match field.kind() {
                MeshKind::Parts { patches, edges, corners, faded, rim } => {
                    part = Some(MeshPart { patches, edges, corners, faded, rim: rim.map(border) });
                }
                MeshKind::Scan { size, cell, smooth } => scan = Some(MeshScan { size, cell, smooth }),
                MeshKind::Union { bodies, edges } => union = Some(MeshUnion { bodies, edges }),
            }
            Self {
                name: name.to_owned(),
                vertices: solid.mesh().vertices().len(),
                faces: solid.mesh().faces().len(),
                pieces: solid.pieces(),
                border_edges: solid.border_edges(),
                fan_edges: solid.fan_edges(),
                mended: solid.repairs().words(),
                has_colours: solid.has_colours(),
                notes: notes.to_vec(),
                part,
                scan,
                union,
            }
        }
    }

    /// The choice made by named values: an angle of 0 keeps no edges, and `borders` is 1 to keep
    /// them.
    fn choice_of(values: &BTreeMap<String, f64>) -> MeshOptions {
        let [edges, borders, smooth] = NAMES.map(|name| values.get(name).copied());
        let edges = match edges {
            None => MeshEdges::Auto,
            Some(0.0) => MeshEdges::Rounded,
            Some(angle) => MeshEdges::Angle(angle),
        };
        MeshOptions { edges, borders: borders.map(|value| value != 0.0), smooth }
    }

    /// The comparison of the new mesh with the old one.
    pub(in super::super) enum Comparison {
        None,
        Measuring(Work<'static, MeshChange>),
        Known(MeshChange),
    }

    impl Session {
        /// Changes the field to the surface of a triangle mesh. In the request, the parameter
        /// `edges` is the angle in degrees from which an edge stays sharp, 0 for no sharp edges,
        /// `borders` is 1 to end the surface at the borders and 0 to close holes, and `smooth` is
        /// the width of the Gaussian for a scan: see [`MeshOptions`]. Formula, box and later
        /// changes work as in [`Session::set_image`].
        ///
        /// # Errors
        ///
        /// If the choice has no surface, the formula has a mistake or the box is not one; nothing
        /// is changed then.
        pub fn set_mesh(
            &mut self,
            mesh: &OpenedMesh,
            name: &str,
            request: &FieldRequest,
        ) -> Result<FieldAnswer, Fault> {
            self.set_opened(name, request, Wanted::Mesh(mesh.clone(), choice_of(&request.parameters)))
        }

        /// [`Session::make_image`] for a mesh.
        pub fn make_mesh(&mut self, mesh: &OpenedMesh, request: &FieldRequest, budget: u32) -> f64 {
            self.make(Wanted::Mesh(mesh.clone(), choice_of(&request.parameters)), budget)
        }

        /// Compares the mesh that [`Session::join`] has made with the opened one, with up to
        /// `budget` slices of the work; none until it is done. The answer is empty if a formula
        /// uses the surface, or no mesh has been joined.
        pub fn compare(&mut self, budget: u32) -> Option<Option<MeshChange>> {
            if self.run.mesh().is_none() {
                self.comparison = Comparison::None;
            }
            if let (Comparison::None, Source::Opened(opened)) = (&self.comparison, self.run.field())
                && let (Some(Surface::Mesh(surface)), Some(mesh)) = (opened.alone(), self.run.mesh())
            {
                let new = MeshBuffers::new(mesh, self.run.particles(), Vertices::Joined);
                let work = surface.field.clone().compared(new.positions, new.triangles);
                self.comparison = Comparison::Measuring(Box::pin(work));
            }
            if let Comparison::Measuring(work) = &mut self.comparison {
                self.comparison = Comparison::Known(slices::advance(work.as_mut(), budget)?);
            }
            Some(match &self.comparison {
                Comparison::Known(change) => Some(*change),
                _ => None,
            })
        }
    }
}

#[cfg(all(test, feature = "images", feature = "points"))]
mod tests {
    use super::{MeshPart, OpenedMesh};
    use crate::remesh::TriangleMesh;
    use crate::sampler::{Phase, Settings};
    use crate::session::{FaultKind, FieldRequest, Session};
    use std::collections::BTreeMap;

    /// A cube of side 2 as an OFF file of six squares, the first of which may be missing.
    fn cube(is_open: bool) -> Vec<u8> {
        let corners =
            (0..8).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { "-1" } else { "1" }.to_owned()));
        let corners: Vec<String> = corners.map(|corner| corner.join(" ")).collect();
        let faces = ["0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5"];
        let faces = &faces[usize::from(is_open)..];
        let rows: Vec<String> = faces.iter().map(|face| format!("4 {face}")).collect();
        format!("OFF\n8 {} 0\n{}\n{}\n", faces.len(), corners.join("\n"), rows.join("\n")).into_bytes()
    }

    fn request(values: &[(&str, f64)]) -> FieldRequest {
        let parameters: BTreeMap<String, f64> =
            values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        FieldRequest { parameters, ..FieldRequest::default() }
    }

    fn run(session: &mut Session) {
        session.start(&Settings::with_count(1_000)).expect("a run");
        while session.run.step(10_000).phase != Phase::Done {}
    }

    #[test]
    fn a_cube_is_sampled_anew_with_its_edges() {
        let mut session = Session::new();
        let mesh = OpenedMesh::read("cube.off", cube(false)).expect("a mesh");
        let answer = session.set_mesh(&mesh, "cube.off", &request(&[])).expect("a field");
        let info = answer.mesh.expect("a mesh");
        assert_eq!(info.part, Some(MeshPart { patches: 6, edges: 12, corners: 8, faded: 0, rim: None }));
        assert_eq!((info.faces, info.vertices, info.pieces), (12, 8, 1));
        assert!(answer.parameters.is_empty());
        // Nothing is compared before there is a new mesh.
        assert_eq!(session.compare(u32::MAX), Some(None));
        run(&mut session);
        session.join(u32::MAX).expect("a mesh");
        let change = session.compare(u32::MAX).flatten().expect("a comparison");
        assert!((change.volume[0] - 8.0).abs() < 1e-9 && (change.volume[1] - 8.0).abs() < 1e-4, "{change:?}");
        assert!((change.area[1] - 24.0).abs() < 1e-4, "{change:?}");
        assert!(change.to_new.largest < 1e-4 && change.edges.is_some_and(|far| far < 1e-4), "{change:?}");
        // Another run has another mesh.
        run(&mut session);
        assert_eq!(session.compare(u32::MAX), Some(None));
    }

    #[test]
    fn another_choice_gives_what_opening_with_it_gives() {
        let mesh = OpenedMesh::read("cube.off", cube(false)).expect("a mesh");
        let (mut moved, mut fresh) = (Session::new(), Session::new());
        moved.set_mesh(&mesh, "cube.off", &request(&[])).expect("a field");
        run(&mut moved);
        let first = moved.run.particles().digest();
        let answer = moved.set_field(&request(&[("smooth", 2.0)])).expect("a field");
        assert!(answer.mesh.is_some_and(|mesh| mesh.scan.is_some_and(|scan| scan.smooth == 2.0)));
        run(&mut moved);
        fresh.set_mesh(&mesh, "cube.off", &request(&[("smooth", 2.0)])).expect("a field");
        run(&mut fresh);
        assert_ne!(moved.run.particles().digest(), first);
        assert_eq!(moved.run.particles().digest(), fresh.run.particles().digest());
    }

    #[test]
    fn what_is_no_solid_is_told_apart_and_the_surface_before_it_stays() {
        let points = b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n".to_vec();
        assert_eq!(OpenedMesh::read("p.off", points).expect_err("no faces").kind, FaultKind::NoFaces);
        // A tetrahedron whose corners lie in one plane.
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| glam::dvec3(x, y, 0.0));
        let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let flat = TriangleMesh::new(corners.to_vec(), faces.to_vec());
        let fault = OpenedMesh::new(&flat.expect("a mesh")).expect_err("no volume");
        assert_eq!(fault.kind, FaultKind::NoSolid);

        let mut session = Session::new();
        let mesh = OpenedMesh::read("open.off", cube(true)).expect("a mesh");
        session.set_mesh(&mesh, "open.off", &request(&[])).expect("a field");
        for values in [&[("edges", 30.0)][..], &[("smooth", -1.0)], &[("edges", 500.0)]] {
            let fault = session.set_mesh(&mesh, "open.off", &request(values)).expect_err("refused");
            assert_eq!(fault.kind, FaultKind::Mesh, "{fault}");
            assert!(session.answer().mesh.is_some_and(|mesh| mesh.scan.is_some()));
        }
    }
}
