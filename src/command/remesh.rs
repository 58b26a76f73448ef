//! Fields from triangle meshes, and the distance of the new mesh from the old one.

use crate::arguments::SurfaceArguments;
use crate::failure::Failure;
use crate::output::STANDARD;
use marching_particles::math::{counted, grouped, significant};
use marching_particles::{MeshChange, MeshEdges, MeshField, MeshKind, Sample, TriangleMesh, Vertices};
use serde::Serialize;
use std::io::Read;
use std::path::Path;

/// The mesh that is sampled again, for the report.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RemeshInfo {
    /// Name of the file.
    pub(crate) name: String,
    /// Vertices and faces after the repairs.
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Pieces, each connected through edges with two faces.
    pub(crate) pieces: usize,
    /// Edges with one face, and with more than two.
    pub(crate) border_edges: usize,
    pub(crate) fan_edges: usize,
    /// The repairs, in words.
    pub(crate) mended: Vec<String>,
    /// How the mesh became a field, in words.
    pub(crate) made: Vec<String>,
    /// What the reader left out.
    pub(crate) notes: Vec<String>,
    /// The comparison with the new mesh; none without a new mesh.
    pub(crate) change: Option<MeshChange>,
}

/// The field of the mesh in a file, if one is requested.
pub(crate) fn of_arguments(arguments: &SurfaceArguments) -> Result<Option<(MeshField, RemeshInfo)>, Failure> {
    let Some(path) = &arguments.mesh_in else { return Ok(None) };
    let wrong = |error: &dyn std::fmt::Display| Failure::Usage(format!("{}: {error}", path.display()));
    let bytes = read(path).map_err(|error| Failure::Unreadable { path: path.clone(), error })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mesh = TriangleMesh::read(&name, bytes).map_err(|error| wrong(&error))?;
    let solid = mesh.solid().map_err(|error| wrong(&error))?;
    let edges = arguments.mesh_edges.unwrap_or_default();
    let field = solid.field(edges, arguments.mesh_smooth).map_err(|error| wrong(&error))?;
    let info = RemeshInfo {
        name,
        vertices: solid.mesh().vertices().len(),
        faces: solid.mesh().faces().len(),
        pieces: solid.pieces(),
        border_edges: solid.border_edges(),
        fan_edges: solid.fan_edges(),
        mended: solid.repairs().words(),
        made: made(&field, edges),
        notes: mesh.notes().to_vec(),
        change: None,
    };
    Ok(Some((field, info)))
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    if path != Path::new(STANDARD) {
        return std::fs::read(path);
    }
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// How the mesh became a field, in words.
fn made(field: &MeshField, edges: MeshEdges) -> Vec<String> {
    match field.kind() {
        MeshKind::Parts { patches, edges, corners, faded, .. } => {
            let mut lines = vec![format!(
                "a part with edges: {}, {} of the mesh kept, {}",
                counted(patches, "patch", "patches"),
                counted(edges, "sharp edge", "sharp edges"),
                counted(corners, "corner", "corners"),
            )];
            if faded > 0 {
                let faded = counted(faded, "sharp edge fades", "sharp edges fade");
                lines.push(format!("note: {faded} out within a patch and will be rounded"));
            }
            lines
        }
        MeshKind::Scan { size: [x, y, z], cell, smooth, .. } => {
            let other = if edges == MeshEdges::Auto { "; --mesh-edges 30 keeps edges" } else { "" };
            vec![format!(
                "a scan, without sharp edges: the distance on a grid of {x} × {y} × {z} cells of {}, smoothed by a \
                 Gaussian of {} cells{other}",
                significant(cell),
                significant(smooth)
            )]
        }
        _ => Vec::new(),
    }
}

impl RemeshInfo {
    /// Compares the mesh of a sample with the old one.
    pub(crate) fn compare(&mut self, field: &MeshField, sample: &Sample) {
        let new = sample.buffers(Vertices::Joined);
        self.change = Some(field.compare(&new.positions, &new.triangles));
    }

    /// The lines of the report before the run.
    pub(crate) fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!("mesh: {}", self.name),
            format!(
                "{} with {} in {}",
                counted(self.faces, "face", "faces"),
                counted(self.vertices, "vertex", "vertices"),
                counted(self.pieces, "piece", "pieces")
            ),
        ];
        if !self.mended.is_empty() {
            lines.push(format!("mended: {}", self.mended.join(", ")));
        }
        if self.border_edges > 0 {
            lines.push(format!(
                "holes with {} edges at their borders are closed smoothly",
                grouped(self.border_edges)
            ));
        }
        if self.fan_edges > 0 {
            lines.push(format!(
                "{} with more than two faces: inside is where the winding number is above a half",
                counted(self.fan_edges, "edge", "edges")
            ));
        }
        lines.extend(self.made.iter().cloned());
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines
    }

    /// The lines of the report that compare both meshes.
    pub(crate) fn change_lines(&self) -> Vec<String> {
        let Some(change) = &self.change else { return Vec::new() };
        let share =
            |length: f64| format!("{} ({:.4} %)", significant(length), 100.0 * length / change.diagonal);
        let distances = |name: &str, own: &marching_particles::MeshDistances| {
            format!(
                "{name}: mean {}, 99 % below {}, largest {} of the diagonal",
                share(own.mean),
                share(own.most),
                share(own.largest)
            )
        };
        let both = |[old, new]: [f64; 2]| {
            format!("{} → {} ({:+.3} %)", significant(old), significant(new), 100.0 * (new / old - 1.0))
        };
        let mut lines = vec![
            distances("distance of the old mesh from the new one", &change.to_new),
            distances("distance of the new mesh from the old one", &change.to_old),
        ];
        if let Some(edges) = change.edges {
            lines.push(format!("sharp edges: largest distance from the new mesh {}", share(edges)));
        }
        lines.push(format!("volume {}, area {}", both(change.volume), both(change.area)));
        lines
    }
}
