//! Fields from triangle meshes, and the distance of the new mesh from the old one.

use crate::arguments::SurfaceArguments;
use crate::failure::Failure;
use crate::options::number;
use crate::output::STANDARD;
use marching_particles::export::Vertices;
use marching_particles::glam::DVec3;
use marching_particles::internal::math::{counted, grouped, significant};
use marching_particles::internal::session::{MeshInfo, MeshPart, MeshScan, MeshUnion};
use marching_particles::remesh::{MeshChange, MeshEdges, MeshField, MeshOptions};
use marching_particles::{Sample, TriangleMesh};
use serde::Serialize;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What becomes of the borders of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum MeshBorders {
    /// The surface ends at them
    Keep,
    /// Holes are closed smoothly
    Close,
}

/// A line along which edges stay sharp: its segments.
#[derive(Clone, Debug)]
pub(crate) struct Line(Vec<[DVec3; 2]>);

/// The options for a triangle mesh.
#[derive(Debug, clap::Args)]
pub(crate) struct MeshArguments {
    /// File of a triangle mesh to sample anew: STL, OBJ, PLY, OFF, GLB or 3MF; `-` is standard
    /// input. Sharp edges are kept, holes of solids are closed, open surfaces end at their border,
    /// and the report says how far the new mesh is from the old one. With --formula the mesh is an
    /// operand named `model`
    #[arg(
        long, value_name = "FILE", help_heading = "Surface",
        conflicts_with_all = ["surface", "points", "image", "closed", "thickness"]
    )]
    pub(crate) mesh_in: Option<PathBuf>,

    /// Keep an edge of --mesh-in sharp if the normals of its faces differ by at least this angle,
    /// in degrees; `none` rounds all edges; `auto` is 30, but `none` for scans, smooth shapes and
    /// meshes with holes [default: auto]
    #[arg(long, value_name = "DEGREES|auto|none", value_parser = mesh_edges, requires = "mesh_in", help_heading = "Surface")]
    pub(crate) mesh_edges: Option<MeshEdges>,

    /// Keep the edges of --mesh-in along this line sharp, whatever their angle: its points, such as
    /// `0,0,0 1,0,0 1,1,0`. Repeat it for each line
    #[arg(
        long = "mesh-line", value_name = "POINTS", value_parser = line, allow_hyphen_values = true,
        requires = "mesh_in", help_heading = "Surface"
    )]
    pub(crate) mesh_lines: Vec<Line>,

    /// Whether the new surface of --mesh-in ends at the borders of the mesh, or its holes are
    /// closed [default: keep for open surfaces, such as a leaf or a terrain, else close]
    #[arg(long, value_name = "WORD", value_enum, requires = "mesh_in", help_heading = "Surface")]
    pub(crate) mesh_borders: Option<MeshBorders>,

    /// Take --mesh-in for a scan, and smooth it by a Gaussian filter of this width, in cells of the
    /// grid of distances, 0 to 10 [default: by the measured noise, 0.7 to 3]
    #[arg(long, value_name = "CELLS", value_parser = number, requires = "mesh_in", help_heading = "Surface")]
    pub(crate) mesh_smooth: Option<f64>,
}

/// Which edges of a mesh stay sharp.
fn mesh_edges(text: &str) -> Result<MeshEdges, String> {
    match text {
        "auto" => Ok(MeshEdges::Auto),
        "none" => Ok(MeshEdges::Rounded),
        _ => Ok(MeshEdges::Angle(number(text)?)),
    }
}

/// [`Line`] from an argument.
fn line(text: &str) -> Result<Line, String> {
    let point = |word: &str| {
        let numbers: Vec<f64> = word.split(',').map(|word| number(word).ok()).collect::<Option<_>>()?;
        <[f64; 3]>::try_from(numbers).ok().map(DVec3::from)
    };
    let points: Option<Vec<DVec3>> = text.split_whitespace().map(point).collect();
    match points {
        Some(points) if points.len() > 1 => Ok(Line(points.array_windows().copied().collect())),
        _ => Err(format!("`{text}` is no line of two points or more, such as `0,0,0 1,0,0`")),
    }
}

/// The mesh that is sampled again, for the report.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RemeshInfo {
    #[serde(flatten)]
    pub(crate) mesh: MeshInfo,
    /// The comparison with the new mesh; none without a new mesh.
    pub(crate) change: Option<MeshChange>,
}

/// The field of the mesh in a file, if one is requested.
pub(crate) fn of_arguments(arguments: &SurfaceArguments) -> Result<Option<(MeshField, RemeshInfo)>, Failure> {
    let given = &arguments.mesh;
    let Some(path) = &given.mesh_in else { return Ok(None) };
    let wrong = |error: &dyn std::fmt::Display| Failure::Usage(format!("{}: {error}", path.display()));
    let bytes = read(path).map_err(|error| Failure::Unreadable { path: path.clone(), error })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mesh = TriangleMesh::read(&name, bytes).map_err(|error| wrong(&error))?;
    let lines: Vec<[DVec3; 2]> = given.mesh_lines.iter().flat_map(|line| line.0.iter().copied()).collect();
    let solid = mesh.solid().map_err(|error| wrong(&error))?.with_edges_along(&lines);
    let mut options = MeshOptions::with_edges(given.mesh_edges.unwrap_or_default());
    options.borders = given.mesh_borders.map(|choice| choice == MeshBorders::Keep);
    options.smooth = given.mesh_smooth;
    let field = solid.field(&options).map_err(|error| wrong(&error))?;
    let info = RemeshInfo { mesh: MeshInfo::new(&name, mesh.notes(), &field), change: None };
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

/// How a part became a field, in words.
fn made_of_part(part: &MeshPart) -> Vec<String> {
    let &MeshPart { patches, edges, corners, faded, rim } = part;
    let mut lines = vec![format!(
        "a part with edges: {}, {} of the mesh kept, {}",
        counted(patches, "patch", "patches"),
        counted(edges, "sharp edge", "sharp edges"),
        counted(corners, "corner", "corners"),
    )];
    if let Some(rim) = rim {
        lines.push(format!(
            "an open surface, which ends at its border: {} of {}",
            counted(rim.loops, "closed curve", "closed curves"),
            counted(rim.edges, "edge", "edges")
        ));
        if rim.is_smoothed {
            lines.push("note: the border zigzags and was smoothed".to_owned());
        }
    }
    if faded > 0 {
        let faded = counted(faded, "sharp edge fades", "sharp edges fade");
        lines.push(format!("note: {faded} out within a patch and will be rounded"));
    }
    lines
}

/// How a scan became a field, in words.
fn made_of_scan(&MeshScan { size: [x, y, z], cell, smooth }: &MeshScan) -> Vec<String> {
    vec![format!(
        "a scan, without sharp edges: the distance on a grid of {x} × {y} × {z} cells of {}, smoothed by a \
         Gaussian of {} cells; --mesh-edges 30 keeps edges",
        significant(cell),
        significant(smooth)
    )]
}

/// How several bodies became a field, in words.
fn made_of_bodies(&MeshUnion { bodies, edges }: &MeshUnion) -> String {
    format!(
        "the union of {}, with {} of the mesh kept; where bodies intersect, their edges are searched for",
        counted(bodies, "body", "bodies"),
        counted(edges, "sharp edge", "sharp edges"),
    )
}

impl RemeshInfo {
    /// Compares the mesh of a sample with the old one.
    pub(crate) fn compare(&mut self, field: &MeshField, sample: &Sample) {
        let new = sample.buffers(Vertices::Joined);
        self.change = Some(field.compare(&new.positions, &new.triangles));
    }

    /// The lines of the report before the run.
    pub(crate) fn lines(&self) -> Vec<String> {
        let MeshInfo {
            name,
            vertices,
            faces,
            pieces,
            border_edges,
            fan_edges,
            mended,
            has_colours,
            notes,
            part,
            scan,
            union,
        } = &self.mesh;
        let mut lines = vec![
            format!("mesh: {name}"),
            format!(
                "{} with {} in {}",
                counted(*faces, "face", "faces"),
                counted(*vertices, "vertex", "vertices"),
                counted(*pieces, "piece", "pieces")
            ),
        ];
        if !mended.is_empty() {
            lines.push(format!("mended: {}", mended.join(", ")));
        }
        if scan.is_some() && *border_edges > 0 {
            lines.push(format!(
                "holes with {} edges at their borders are closed smoothly; --mesh-borders keep keeps them",
                grouped(*border_edges)
            ));
        }
        if scan.is_some() && *fan_edges > 0 {
            lines.push(format!(
                "{} with more than two faces: inside is where the winding number is above a half",
                counted(*fan_edges, "edge", "edges")
            ));
        }
        if *has_colours {
            lines.push("its colours are columns of the particles: red, green and blue".to_owned());
        }
        lines.extend(part.iter().flat_map(made_of_part));
        lines.extend(scan.iter().flat_map(made_of_scan));
        lines.extend(union.as_ref().map(made_of_bodies));
        lines.extend(notes.iter().map(|note| format!("note: {note}")));
        lines
    }

    /// The lines of the report that compare both meshes.
    pub(crate) fn change_lines(&self) -> Vec<String> {
        let Some(change) = &self.change else { return Vec::new() };
        let share =
            |length: f64| format!("{} ({:.4} %)", significant(length), 100.0 * length / change.diagonal);
        let distances = |name: &str, own: &marching_particles::remesh::MeshDistances| {
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
        // An open surface has no volume.
        let is_open = self.mesh.part.as_ref().is_some_and(|part| part.rim.is_some());
        let volume = if is_open { String::new() } else { format!("volume {}, ", both(change.volume)) };
        lines.push(format!("{volume}area {}", both(change.area)));
        lines
    }
}
