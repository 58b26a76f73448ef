//! Result of a run.

use crate::image::ImageInfo;
use crate::remesh::RemeshInfo;
use marching_particles::Bounds;
use marching_particles::export::{Bodies, Placement, Unit};
use marching_particles::field::formula::Thickness;
use marching_particles::field::model::ModelInfo;
use marching_particles::internal::session::SpacingText;
use marching_particles::mesh::{Body, Inside, Triangulation};
use marching_particles::sampler::Settings;
use marching_particles::{Report, Sample};
use serde::Serialize;
use std::collections::BTreeMap;

/// Wall times of the phases in seconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Seconds {
    /// Time to read points and fit a field to them, or to read an image or a mesh.
    pub(crate) points: f64,
    pub(crate) seeding: f64,
    pub(crate) generation: f64,
    pub(crate) refinement: f64,
    pub(crate) relaxation: f64,
    pub(crate) quality: f64,
    /// Time to triangulate.
    pub(crate) mesh: f64,
    pub(crate) writing: f64,
}

impl Seconds {
    /// The total time of all phases.
    pub(crate) fn all(&self) -> f64 {
        let Self { points, seeding, generation, refinement, relaxation, quality, mesh, writing } = *self;
        points + seeding + generation + refinement + relaxation + quality + mesh + writing
    }
}

/// Result of a run, as `--json` prints it.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    pub(crate) version: &'static str,
    pub(crate) surface: Option<String>,
    /// Report of the fit, for a surface near points.
    pub(crate) model: Option<ModelInfo>,
    /// The image, if the surface is in one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) image: Option<ImageInfo>,
    /// The mesh that was sampled again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) remesh: Option<RemeshInfo>,
    pub(crate) formula: String,
    pub(crate) parameters: BTreeMap<String, f64>,
    pub(crate) bounds: Bounds,
    pub(crate) settings: Settings,
    /// Thickness of the shell, if one is sampled.
    pub(crate) thickness: Option<Thickness>,
    /// Spacing by a formula, if there is one.
    pub(crate) spacing: Option<SpacingText>,
    /// The porosity, if one is requested.
    pub(crate) porosity: Option<Porosity>,
    pub(crate) predicted_count: u64,
    #[serde(flatten)]
    pub(crate) report: Report,
    /// The triangles over the particles, if a mesh file is requested.
    pub(crate) mesh: Option<MeshCounts>,
    pub(crate) seconds: Seconds,
    /// Peak resident memory of the process in 10⁶ bytes; null if the system does not report it.
    pub(crate) peak_mb: Option<f64>,
    /// Peak resident memory after sampling, before quality is measured and files are written.
    pub(crate) peak_sampling_mb: Option<f64>,
    /// Names of the files written, with replacement characters for invalid Unicode.
    pub(crate) files: Vec<String>,
    /// Whether one of the files has a format used for 3D printing.
    #[serde(skip)]
    pub(crate) is_printed: bool,
}

/// Share of the box that the solid leaves empty.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Porosity {
    pub(crate) wanted: f64,
    /// The porosity according to the volume of the mesh; none if the mesh is open.
    pub(crate) reached: Option<f64>,
}

/// Counts of a mesh, as the output gives them.
#[derive(Debug, Serialize)]
pub(crate) struct MeshCounts {
    pub(crate) triangles: usize,
    pub(crate) components: usize,
    /// Sum over the components.
    pub(crate) euler: i64,
    /// Border loops where the surface ends.
    pub(crate) borders: usize,
    /// Border loops of holes that the triangulation could not close as a manifold.
    pub(crate) holes: usize,
    /// Particles in no triangle.
    pub(crate) left_out: usize,
    /// Enclosed volume; none if the mesh is open.
    pub(crate) volume: Option<f64>,
    /// Sign of f inside the closed parts, which face outward in any case.
    pub(crate) inside: Option<Inside>,
    /// Smallest angle of all triangles in degrees, including those at borders.
    pub(crate) smallest_angle: Option<f64>,
    /// Bodies that are not chips: closed components with the walls of their hollows, and open
    /// components.
    pub(crate) parts: usize,
    /// Bodies that are small compared with the largest.
    pub(crate) chips: usize,
    /// Bodies that are not written to the files.
    pub(crate) parts_left_out: usize,
    /// Sides of the box around the bodies in the files, in their unit.
    pub(crate) size: [f64; 3],
    /// The unit of the files; none if lengths are those of the formula.
    pub(crate) unit: Option<Unit>,
}

impl MeshCounts {
    pub(crate) fn new(sample: &Sample, all: &[Body], kept: Bodies, placement: Placement) -> Self {
        let (Triangulation { triangles, topology, unfilled, left_out, inside, .. }, report) =
            (sample.mesh(), sample.report());
        Self {
            triangles: triangles.len(),
            components: topology.components.len(),
            euler: topology.euler(),
            borders: topology.borders.len() - unfilled.len(),
            holes: unfilled.len(),
            left_out: left_out.len(),
            volume: report.joined_volume,
            inside: *inside,
            smallest_angle: report.smallest_angle,
            parts: all.iter().filter(|body| !body.is_chip).count(),
            chips: all.iter().filter(|body| body.is_chip).count(),
            parts_left_out: if kept == Bodies::Largest { all.len().saturating_sub(1) } else { 0 },
            size: (kept.size(all) * placement.scale).to_array(),
            unit: placement.unit,
        }
    }
}
